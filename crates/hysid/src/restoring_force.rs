//! The restoring force of an element from the measured motion of a mass and the force on it: the restoring force method
//! of Masri and Caughey (1979).
//!
//! ```text
//! r = u - m (y'' + a)                                                      theory.md (15.20)
//! ```
//!
//! `m` is the mass, `y` its displacement relative to the base, `a` the acceleration of the base and `u` the force on the
//! mass. `r` is the force of the element (spring, damper, isolator, column) on the mass, positive in the direction of
//! negative `y`: a spring has `r = k y`. Over `y` it shows the hysteresis of the element, without inertia.
//!
//! All numbers are in consistent units: mass times acceleration is a force, such as kg, m, s and N.

mod differentiation;
mod filter;
mod local_polynomial;
mod noise;
mod search;

pub use filter::{Filter, SMALLEST_WINDOW};

use differentiation::{Derivative, derivative};
use hysid_core::elementary::{hypot, square};
use hysid_core::error::{DataProblem, Error, LARGEST_VALUE, MotionColumn, MotionError, OptionError, Result};
use search::Channel;

/// Measured motion of a mass in one record, and the force on the mass: one value a row.
#[derive(Debug, Clone, Copy, Default)]
pub struct Motion<'a> {
    /// Time stamps, increasing; steps need not be equal.
    pub time: &'a [f64],
    /// `y`: displacement relative to the base.
    pub displacement: &'a [f64],
    /// `y'`: velocity relative to the base; `None` to compute it from the displacement.
    pub velocity: Option<&'a [f64]>,
    /// Acceleration of the mass.
    pub acceleration: Acceleration<'a>,
    /// `a`: acceleration of the base; `None` for a base at rest. NaN where it was not measured.
    pub base_acceleration: Option<&'a [f64]>,
    /// `u`: force on the mass; `None` for none. NaN where it was not measured.
    pub applied_force: Option<&'a [f64]>,
}

/// Where the acceleration of the mass comes from. A measured one is NaN where it was not measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Acceleration<'a> {
    /// It is computed: from the velocity if that is measured, otherwise from the displacement.
    #[default]
    Computed,
    /// Measured relative to the base: `y''`.
    Relative(&'a [f64]),
    /// Measured as absolute acceleration `y'' + a`, as by an accelerometer on the mass.
    Absolute(&'a [f64]),
}

/// A restoring force and how uncertain it is.
#[derive(Debug, Clone, PartialEq)]
pub struct RestoringForce {
    /// The columns of each record.
    pub records: Vec<RestoringRecord>,
    /// The filter that gave the velocity; `None` for a measured one.
    pub velocity_filter: Option<Filter>,
    /// The filter that gave the acceleration; `None` for a measured one.
    pub acceleration_filter: Option<Filter>,
    /// Standard deviation of the restoring force, in its unit.
    pub deviation: f64,
    /// Standard deviation of its noise, in its unit, if noise is independent from row to row.
    pub noise: f64,
    /// Smoothing error of the restoring force, in its unit: the root mean square of the part of the motion that the filter
    /// of the acceleration does not follow, times the mass. An estimate, and 0 for a measured acceleration.
    pub smoothing: f64,
}

/// The restoring force of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct RestoringRecord {
    /// `y'` in each row.
    pub velocity: Vec<f64>,
    /// `r` in each row; NaN where something was not measured, and near the ends with a computed acceleration.
    pub force: Vec<f64>,
}

impl RestoringForce {
    /// Noise in percent of the standard deviation of the force; `None` for a constant force.
    pub fn noise_percent(&self) -> Option<f64> {
        self.percent(self.noise)
    }

    /// Smoothing error in percent of the standard deviation of the force; `None` for a constant force.
    pub fn smoothing_percent(&self) -> Option<f64> {
        self.percent(self.smoothing)
    }

    fn percent(&self, part: f64) -> Option<f64> {
        (self.deviation > 0.0).then(|| 100.0 * part / self.deviation)
    }
}

/// The restoring force `u - m (y'' + a)` in records of the motion of a mass, theory.md (15.20).
///
/// Unmeasured columns come from Savitzky-Golay filters with one window for all records; `window` sets its number of
/// rows, an odd number from 5 on. Without it, the window is chosen that has the least noise and smoothing error together.
///
/// ```
/// use hysid::restoring_force::{Motion, restoring_force};
///
/// # fn main() -> hysid::Result<()> {
/// // Free vibration of 2 kg on a spring of 200 N/m.
/// let time: Vec<f64> = (0..500).map(|row| 0.01 * f64::from(row)).collect();
/// let displacement: Vec<f64> = time.iter().map(|t| 0.03 * (10.0 * t).cos()).collect();
/// let motion = Motion { time: &time, displacement: &displacement, ..Motion::default() };
/// let found = restoring_force(&[motion], 2.0, None)?;
/// let force = found.records[0].force[250];
/// assert!((force - 200.0 * displacement[250]).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No records; a mass that is not above 0; a window that is even, too short or longer than a record; columns of different
/// length; fewer rows than a filter needs; time that does not increase; values that are not finite where a number is
/// needed; a constant displacement; no row with all that the force needs.
pub fn restoring_force(records: &[Motion<'_>], mass: f64, window: Option<usize>) -> Result<RestoringForce> {
    check_options(mass, window)?;
    if records.is_empty() {
        return Err(Error::NoRecords);
    }
    for (record, motion) in records.iter().enumerate() {
        check(motion, record, window.unwrap_or(SMALLEST_WINDOW))?;
    }
    check_that_it_moves(records)?;
    let displacements: Vec<Channel<'_>> =
        records.iter().map(|motion| (motion.time, motion.displacement)).collect();
    let velocities: Option<Vec<Channel<'_>>> =
        records.iter().map(|motion| Some((motion.time, motion.velocity?))).collect();
    // The channel that is differentiated, once for the velocity if that is not measured.
    let (channel, order) = match &velocities {
        Some(velocities) => (velocities, 0),
        None => (&displacements, 1),
    };
    let is_accelerated = is_computed(records);
    let noise = if order > 0 || is_accelerated { noise::deviation(channel) } else { 0.0 };
    let velocity = (order > 0).then(|| derivative(channel, order, noise, window));
    let acceleration = is_accelerated.then(|| derivative(channel, order + 1, noise, window));
    let force_of = |(record, motion): (usize, &Motion<'_>)| {
        let computed =
            acceleration.as_ref().map(|computed| (computed.values[record].as_slice(), computed.filter));
        force(motion, mass, computed)
    };
    let forces: Vec<Vec<f64>> = records.iter().enumerate().map(force_of).collect();
    let deviation = deviation(forces.iter().flatten().copied()).ok_or_else(|| {
        Error::Parts(
            "no row has all that the restoring force needs: force and accelerations are missing".into(),
        )
    })?;
    let of_record = |(record, force): (usize, Vec<f64>)| RestoringRecord {
        velocity: match &velocity {
            Some(computed) => computed.values[record].clone(),
            None => records[record].velocity.unwrap_or_default().to_vec(),
        },
        force,
    };
    Ok(RestoringForce {
        deviation,
        noise: noise_of(records, mass, acceleration.as_ref()),
        smoothing: acceleration.as_ref().map_or(0.0, |computed| mass * computed.smoothing),
        velocity_filter: velocity.as_ref().map(|computed| computed.filter),
        acceleration_filter: acceleration.as_ref().map(|computed| computed.filter),
        records: forces.into_iter().enumerate().map(of_record).collect(),
    })
}

fn check_options(mass: f64, window: Option<usize>) -> Result<()> {
    if !(mass > 0.0 && mass <= LARGEST_VALUE) {
        return Err(OptionError::value("mass", mass, "a number above 0 is needed").into());
    }
    match window {
        Some(window) if window < SMALLEST_WINDOW || window % 2 == 0 => {
            let needed = format!("an odd number of rows is needed, {SMALLEST_WINDOW} or more");
            Err(OptionError::value("window", window, needed).into())
        }
        _ => Ok(()),
    }
}

/// Refuses a record that has no restoring force.
fn check(motion: &Motion<'_>, record: usize, window: usize) -> Result<()> {
    let rows = motion.displacement.len();
    let defect = |row, column, problem| Err(MotionError { record, row, column, problem }.into());
    for (column, values) in columns(motion) {
        if values.len() != rows {
            let problem = DataProblem::LengthOf { expected: rows, found: values.len() };
            return defect(None, column, problem);
        }
        let may_be_missing =
            !matches!(column, MotionColumn::Time | MotionColumn::Displacement | MotionColumn::Velocity);
        let is_wrong = |value: &f64| !(value.is_finite() || may_be_missing && value.is_nan());
        if let Some(row) = values.iter().position(is_wrong) {
            return defect(Some(row), column, DataProblem::NotFinite(values[row]));
        }
        if let Some(row) = values.iter().position(|value| value.abs() > LARGEST_VALUE) {
            return defect(Some(row), column, DataProblem::TooLarge(values[row]));
        }
    }
    if rows < window {
        return defect(
            None,
            MotionColumn::Displacement,
            DataProblem::TooFewForWindow { found: rows, needed: window },
        );
    }
    if let Some(row) = (1..rows).find(|&row| motion.time[row] <= motion.time[row - 1]) {
        let (before, now) = (motion.time[row - 1], motion.time[row]);
        return defect(Some(row), MotionColumn::Time, DataProblem::TimeNotIncreasing { before, now });
    }
    Ok(())
}

fn columns<'a>(motion: &Motion<'a>) -> impl Iterator<Item = (MotionColumn, &'a [f64])> {
    let acceleration = match motion.acceleration {
        Acceleration::Computed => None,
        Acceleration::Relative(values) | Acceleration::Absolute(values) => Some(values),
    };
    let all = [
        (MotionColumn::Displacement, Some(motion.displacement)),
        (MotionColumn::Time, Some(motion.time)),
        (MotionColumn::Velocity, motion.velocity),
        (MotionColumn::Acceleration, acceleration),
        (MotionColumn::BaseAcceleration, motion.base_acceleration),
        (MotionColumn::AppliedForce, motion.applied_force),
    ];
    all.into_iter().filter_map(|(column, values)| Some((column, values?)))
}

fn check_that_it_moves(records: &[Motion<'_>]) -> Result<()> {
    let first = records[0].displacement[0];
    if records.iter().flat_map(|motion| motion.displacement).all(|&y| y == first) {
        let problem = DataProblem::ConstantInput(first);
        return Err(MotionError { record: 0, row: None, column: MotionColumn::Displacement, problem }.into());
    }
    Ok(())
}

/// True if the acceleration of some record is computed, and with one filter that of all.
fn is_computed(records: &[Motion<'_>]) -> bool {
    records.iter().any(|motion| motion.acceleration == Acceleration::Computed)
}

/// The restoring force in each row; `computed` is the acceleration from a filter.
fn force(motion: &Motion<'_>, mass: f64, computed: Option<(&[f64], Filter)>) -> Vec<f64> {
    let rows = motion.displacement.len();
    let at = |values: Option<&[f64]>, row: usize| values.map_or(0.0, |values| values[row]);
    let absolute = |row: usize| match (motion.acceleration, computed) {
        (Acceleration::Absolute(values), _) => values[row],
        (Acceleration::Relative(values), _) => values[row] + at(motion.base_acceleration, row),
        (Acceleration::Computed, Some((values, filter))) => {
            let from_end = row.min(rows - 1 - row);
            let relative = if from_end < filter.on_a_side { f64::NAN } else { values[row] };
            relative + at(motion.base_acceleration, row)
        }
        (Acceleration::Computed, None) => f64::NAN,
    };
    (0..rows).map(|row| at(motion.applied_force, row) - mass * absolute(row)).collect()
}

/// Standard deviation of the numbers that are not NaN; `None` if there are none.
fn deviation(values: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let known = values.filter(|value| !value.is_nan());
    let count = known.clone().count();
    if count == 0 {
        return None;
    }
    let mean = known.clone().sum::<f64>() / count as f64;
    Some((known.map(|value| square(value - mean)).sum::<f64>() / count as f64).sqrt())
}

/// Standard deviation of the noise of the restoring force, in its unit: what the measured channels add, in squares.
fn noise_of<'a>(records: &[Motion<'a>], mass: f64, computed: Option<&Derivative>) -> f64 {
    // An absolute acceleration has that of the base in it.
    let is_used = |motion: &Motion<'a>, column: MotionColumn| {
        column != MotionColumn::BaseAcceleration || !matches!(motion.acceleration, Acceleration::Absolute(_))
    };
    let of_channel = |wanted: MotionColumn| {
        let values = |motion: &Motion<'a>| {
            let (_, values) = columns(motion).find(|(column, _)| *column == wanted)?;
            is_used(motion, wanted).then_some((motion.time, values))
        };
        let channels: Vec<Channel<'a>> = records.iter().filter_map(values).collect();
        if channels.is_empty() { 0.0 } else { noise::deviation(&channels) }
    };
    let acceleration = of_channel(MotionColumn::Acceleration);
    let base = of_channel(MotionColumn::BaseAcceleration);
    let force = of_channel(MotionColumn::AppliedForce);
    let from_filter = computed.map_or(0.0, |computed| computed.noise);
    hypot(mass * hypot(hypot(acceleration, base), from_filter), force)
}
