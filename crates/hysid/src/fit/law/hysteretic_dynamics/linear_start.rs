//! The linear system that a search begins with: modes one after the other, each the best of a grid of frequencies and
//! damping ratios, then all together by Levenberg-Marquardt.

use hysid_core::elementary::{ln, powf, square};

use super::records::Records;
use super::task::{DrivenRecord, DynamicsTask, DynamicsValue, InitialMotion};
use super::{DynamicsSpec, StartKind};
use crate::law::hysteretic_dynamics::{
    DAMPING_RATIOS, Dynamics, DynamicsDrive, DynamicsForm, DynamicsLayout, DynamicsRun, ElementShape, Hold,
    Mode,
};
use crate::linear_algebra::{Gram, Symmetric};
use crate::optimise::levenberg_marquardt::LevenbergMarquardt;
use crate::optimise::parallel;
use crate::stop_check::StopCheck;

/// Rows of the grid at most, at the beginning of the records.
const ROWS_OF_GRID: usize = 6000;

const FREQUENCIES: usize = 60;

/// Damping ratios of the grid, of an oscillator and of a state space model.
const RATIOS: [f64; 3] = [0.02, 0.1, 0.4];
const RATIOS_OF_STATE_SPACE: [f64; 5] = [0.02, 0.1, 0.4, 1.5, 6.0];

/// Highest frequency of the grid, as a share of the sampling rate.
const HIGHEST: f64 = 0.35;

/// Iterations that improve all modes together, and with which holds are compared.
const EPOCHS: usize = 25;

/// Steps in a period of the fastest mode that vibrates.
const STEPS_PER_PERIOD: f64 = 60.0;

/// Largest variance of the fourth difference of a smooth input, as a share of that of a random sequence.
const SMOOTH: f64 = 0.02;
const OF_RANDOM_SEQUENCE: f64 = 70.0;

/// A hold replaces a likelier one only if its mean square error is below this share of the other's. The modes of a
/// state space model follow a constant and a linear hold equally well, because a velocity in the output shifts it in time.
const CLEARLY_BETTER: f64 = 0.95;

/// Rows at most from which the beginning of a motion is found.
const MOST_FIRST_ROWS: f64 = 1000.0;

/// Largest distance of the first rows from a motion from rest, in standard deviations, for a record at rest.
const LEAST_MOTION: f64 = 0.1;

/// Records whose beginnings are searched, at most: the first. Each adds parameters.
const MOST_IN_MOTION: usize = 50;

/// Rows at the beginning of a record whose input bounds the error of the hold between the first of them.
const FIRST_ROWS: usize = 4;

/// An expected displacement or velocity below this, in standard deviations of the output, is rest.
const LEAST_KICK: f64 = 1e-4;

/// A small penalty that keeps coefficients without influence at 0.
const RIDGE: f64 = 1e-10;

pub(super) struct LinearStarts {
    all_modes: Dynamics,
    /// One mode that moves, and the others, which do not.
    one_mode: Dynamics,
    are_in_motion: Vec<bool>,
}

impl LinearStarts {
    /// `None` once stopped.
    pub fn find(records: &Records, asked: &DynamicsSpec, stop: StopCheck<'_>) -> Option<Self> {
        let rows: usize = records.drives.iter().map(|drive| drive.x.len()).sum();
        let few = records.first(ROWS_OF_GRID as f64 / rows as f64);
        let systems = mode_by_mode(records, &few, asked, stop)?;
        let finished = |system: &Dynamics| finished(system, records, few.clone(), asked, stop);
        let (all_modes, are_in_motion) = finished(systems.last()?)?;
        let mut one_mode = all_modes.clone();
        if asked.modes > 1 {
            one_mode = finished(&systems[0])?.0;
            let first = ln(one_mode.modes[0].frequency);
            // The mode that is nearest to it is left out.
            let distance = |mode: &Mode| (ln(mode.frequency) - first).abs();
            let mut others = all_modes.modes.clone();
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            one_mode.modes.extend(others[1..].iter().map(|mode| Mode { gain: 0.0, ..*mode }));
        }
        Some(Self { all_modes, one_mode, are_in_motion })
    }

    /// The system that a start of this kind begins with.
    pub fn of(&self, kind: StartKind) -> &Dynamics {
        if kind.has_one_mode_first { &self.one_mode } else { &self.all_modes }
    }

    /// Records with how they begin.
    pub fn begun(&self, drives: Vec<DynamicsDrive>) -> Vec<DrivenRecord> {
        let mut records = begun(drives, &self.are_in_motion);
        for record in records.iter_mut().take(MOST_IN_MOTION) {
            let kicks = self.all_modes.modes.iter().map(|mode| kick(mode, &self.all_modes, &record.drive));
            let kicks: Vec<f64> = kicks.collect();
            if record.beginning == InitialMotion::AtRest && kicks.iter().any(|kick| *kick > LEAST_KICK) {
                record.beginning = InitialMotion::NearRest(kicks);
            }
        }
        records
    }
}

/// Expected error of the velocity `p` of a mode after the first rows of a record, theory.md (15.24). A straight line
/// between two samples misses `Δ²u h/12` of the impulse of a curved input. In later rows this acts like a fixed linear
/// filter, which the modes compensate.
fn kick(mode: &Mode, system: &Dynamics, drive: &DynamicsDrive) -> f64 {
    let has_interpolation = drive.x.len() >= FIRST_ROWS && drive.steps[1].is_finite();
    if system.hold == Hold::Constant || !has_interpolation {
        return LEAST_KICK;
    }
    let second_difference = first_second_difference(&drive.x) / system.input_scale;
    (mode.frequency * drive.steps[1] * mode.gain.abs() * second_difference / 12.0).max(LEAST_KICK)
}

/// Largest second difference of the first four rows of an input: large if the record begins with a jump.
pub(crate) fn first_second_difference(input: &[f64]) -> f64 {
    let curved = |x: &[f64]| (x[0] - 2.0 * x[1] + x[2]).abs();
    input[..input.len().min(FIRST_ROWS)].windows(3).map(curved).fold(0.0, f64::max)
}

fn begun(drives: Vec<DynamicsDrive>, are_in_motion: &[bool]) -> Vec<DrivenRecord> {
    let records = drives.into_iter().zip(are_in_motion);
    let begun = |(drive, &is_in_motion)| DrivenRecord {
        drive,
        beginning: if is_in_motion { InitialMotion::InMotion } else { InitialMotion::AtRest },
    };
    records.map(begun).collect()
}

/// How the input may go between the rows, the likelier first.
fn holds(records: &Records) -> &'static [Hold] {
    if is_smooth(&records.drives) { &[Hold::Cubic] } else { &[Hold::Linear, Hold::Constant] }
}

/// Records of which it is not known how they begin: the first may be in motion.
fn perhaps_in_motion(few: Vec<DynamicsDrive>) -> Vec<DrivenRecord> {
    let may_be: Vec<bool> = (0..few.len()).map(|record| record < MOST_IN_MOTION).collect();
    begun(few, &may_be)
}

/// Linear systems of one mode, of two and so on, each with one mode more than the last; `None` once stopped.
fn mode_by_mode(
    records: &Records,
    few: &[DynamicsDrive],
    asked: &DynamicsSpec,
    stop: StopCheck<'_>,
) -> Option<Vec<Dynamics>> {
    let mut system = Dynamics {
        input_scale: records.input_scale,
        output_offset: records.output_mean,
        output_scale: records.output_scale,
        direct: 0.0,
        hold: holds(records)[0],
        longest_step: f64::MAX.sqrt(),
        begins_under_input: false,
        modes: Vec::new(),
        elements: Vec::new(),
    };
    let begun = perhaps_in_motion(few.to_vec());
    let mut systems = Vec::new();
    for _ in 0..asked.modes {
        system.modes.push(best_of_grid(&system, few, records, asked, stop)?);
        system = improved(system, asked, &begun, stop)?.0;
        systems.push(system.clone());
    }
    Some(systems)
}

/// A linear system improved on all rows, and which records begin in mid-motion; `None` once stopped.
fn finished(
    system: &Dynamics,
    records: &Records,
    few: Vec<DynamicsDrive>,
    asked: &DynamicsSpec,
    stop: StopCheck<'_>,
) -> Option<(Dynamics, Vec<bool>)> {
    let mut system = system.clone();
    let few = perhaps_in_motion(few);
    let vibrating = system.modes.iter().filter(|mode| mode.damping < 1.0);
    let fastest = vibrating.map(|mode| mode.frequency).fold(0.0, f64::max);
    system.longest_step = match fastest > 0.0 {
        true => std::f64::consts::TAU / (STEPS_PER_PERIOD * fastest),
        false => records.step,
    };
    let mut best: Option<(Dynamics, f64)> = None;
    for &hold in holds(records) {
        let found = improved(Dynamics { hold, ..system.clone() }, asked, &few, stop)?;
        if best.as_ref().is_none_or(|best| found.1 < CLEARLY_BETTER * best.1) {
            best = Some(found);
        }
    }
    let (at_rest, half_square) = best?;
    let under_input = Dynamics { begins_under_input: true, ..at_rest.clone() };
    let first = records.first_rows(first_rows(&at_rest, records.step));
    let square = |dynamics: &Dynamics| DynamicsRun::from_rest(dynamics, &first, stop).half_square();
    let begins = if square(&under_input)? < square(&at_rest)? { under_input } else { at_rest };
    let are_in_motion = are_in_motion(&begins, records, (2.0 * half_square).sqrt(), stop)?;
    let (system, _) = improved(begins, asked, &begun(records.drives.clone(), &are_in_motion), stop)?;
    Some((system, are_in_motion))
}

/// Which records begin in mid-motion: those whose first rows are further from a motion from rest than the linear system
/// is from the records, whose error is given. Records after the first 50 count as at rest. `None` once stopped.
fn are_in_motion(system: &Dynamics, records: &Records, error: f64, stop: StopCheck<'_>) -> Option<Vec<bool>> {
    let vibrating = system.modes.iter().filter(|mode| mode.damping < 1.0);
    let slowest = vibrating.map(|mode| mode.frequency).fold(f64::INFINITY, f64::min);
    let rows = match slowest.is_finite() {
        true => rows_of_quarter(slowest, records.step),
        false => first_rows(system, records.step),
    };
    let of_record = |drive: &DynamicsDrive| {
        let run = DynamicsRun::from_rest(system, std::slice::from_ref(drive), stop);
        let mean_square = 2.0 * run.half_square()? / drive.rows().max(1.0);
        Some(mean_square.sqrt() > error.max(LEAST_MOTION))
    };
    let mut are_in_motion: Vec<bool> =
        records.first_rows(rows).iter().map(of_record).collect::<Option<_>>()?;
    are_in_motion.iter_mut().skip(MOST_IN_MOTION).for_each(|is_in_motion| *is_in_motion = false);
    Some(are_in_motion)
}

/// Rows of a quarter of a period, in which a motion is still as it began.
fn first_rows(system: &Dynamics, step: f64) -> usize {
    rows_of_quarter(system.modes.iter().map(|mode| mode.frequency).fold(0.0, f64::max), step)
}

fn rows_of_quarter(frequency: f64, step: f64) -> usize {
    let quarter = 0.25 * std::f64::consts::TAU / (frequency * step);
    quarter.clamp(2.0, MOST_FIRST_ROWS).ceil() as usize
}

/// True if the input has next to no power at the highest frequencies, by the variance of its fourth difference.
fn is_smooth(drives: &[DynamicsDrive]) -> bool {
    let (mut difference, mut squares) = (0.0, 0.0);
    for drive in drives {
        let mean = drive.x.iter().sum::<f64>() / drive.x.len() as f64;
        squares += drive.x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        let fourth = |x: &[f64]| x[0] - 4.0 * x[1] + 6.0 * x[2] - 4.0 * x[3] + x[4];
        difference += drive.x.windows(5).map(|x| square(fourth(x))).sum::<f64>();
    }
    difference < SMOOTH * OF_RANDOM_SEQUENCE * squares
}

/// The mode that lowers the error most beside those that there are.
fn best_of_grid(
    system: &Dynamics,
    drives: &[DynamicsDrive],
    records: &Records,
    asked: &DynamicsSpec,
    stop: StopCheck<'_>,
) -> Option<Mode> {
    let longest = drives.iter().map(|drive| drive.steps.iter().filter(|step| step.is_finite()).sum::<f64>());
    let lowest = std::f64::consts::TAU / longest.fold(records.step, f64::max);
    let highest = std::f64::consts::TAU * HIGHEST / records.step;
    let ratios: &[f64] =
        if asked.form == DynamicsForm::Oscillator { &RATIOS } else { &RATIOS_OF_STATE_SPACE };
    let points: Vec<(f64, f64)> = (0..FREQUENCIES)
        .flat_map(|k| {
            let share = k as f64 / (FREQUENCIES - 1) as f64;
            let frequency = lowest * powf(highest / lowest, share);
            ratios.iter().map(move |&ratio| (frequency, ratio))
        })
        .collect();
    let layout = DynamicsLayout::new(asked.form, system.modes.len() + 1, 0, NO_ELEMENT);
    let of_point = |&(frequency, damping): &(f64, f64)| {
        let mut tried = system.clone();
        tried.modes.push(Mode { frequency, damping, gain: 1.0, velocity_in_output: 0.0 });
        let run = DynamicsRun::from_rest(&tried, drives, stop);
        let (square, gain, velocity) = linear_part(&run.gram(&layout)?, &layout)?;
        Some((square, Mode { gain, velocity_in_output: velocity, ..tried.modes[system.modes.len()] }))
    };
    let found = parallel::each(&points, of_point).into_iter().flatten();
    found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
}

const NO_ELEMENT: ElementShape = ElementShape { stops: 0, states: 0, neurons: 1, deteriorates: false };

/// Least square with the best linear coefficients, and gain and velocity of the last mode; `None` if not determined.
fn linear_part(gram: &Gram, layout: &DynamicsLayout) -> Option<(f64, f64, f64)> {
    let mut places = vec![0, 1];
    for mode in &layout.modes {
        places.push(mode.gain);
        places.extend(mode.velocity_in_output.clone());
    }
    let target = layout.count();
    let size = places.iter().map(|&i| gram.at(i, i)).fold(0.0, f64::max);
    let mut matrix = Symmetric::from_fn(places.len(), |i, j| gram.at(places[i], places[j]));
    (0..places.len()).for_each(|i| matrix.add_to_diagonal(i, RIDGE * size));
    let right: Vec<f64> = places.iter().map(|&place| -gram.at(target, place)).collect();
    let mut by = right.clone();
    matrix.cholesky(StopCheck::never())?.solve(&mut by);
    let fall: f64 = by.iter().zip(&right).map(|(by, right)| by * right).sum();
    let last = layout.modes.last()?;
    let of = |place: usize| places.iter().position(|&p| p == place).map_or(0.0, |i| by[i]);
    let gain = 1.0 + of(last.gain);
    // The share of the velocity multiplies a mode that has its gain already.
    let velocity = last.velocity_in_output.clone().next().map_or(0.0, |place| of(place) / gain);
    let square = gram.at(target, target) - fall;
    (square.is_finite() && gain.is_finite() && velocity.is_finite()).then_some((square, gain, velocity))
}

/// A linear system improved by Levenberg-Marquardt, with half its mean square error; `None` once stopped.
fn improved(
    system: Dynamics,
    asked: &DynamicsSpec,
    records: &[DrivenRecord],
    stop: StopCheck<'_>,
) -> Option<(Dynamics, f64)> {
    let mut system = system;
    for mode in &mut system.modes {
        mode.damping = mode.damping.clamp(DAMPING_RATIOS.0, DAMPING_RATIOS.1);
    }
    let layout = DynamicsLayout::new(asked.form, system.modes.len(), 0, NO_ELEMENT);
    let task = DynamicsTask::new(&layout, &system, records, stop);
    let mut search: LevenbergMarquardt<DynamicsValue> =
        LevenbergMarquardt::new(&task, task.parameters(&system));
    for _ in 0..EPOCHS {
        if search.advance(&task).is_some() {
            break;
        }
    }
    let value = search.known_value()?.objective;
    value.is_finite().then(|| (layout.dynamics(search.parameters(), &system), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola and the line between its ends, over one of two steps, give the mode impulses that differ by the kick.
    #[test]
    fn a_kick_is_the_impulse_that_a_straight_line_misses() {
        let mode = Mode { frequency: 30.0, damping: 0.02, gain: -1.5, velocity_in_output: 0.0 };
        let parabola = |share: f64| 2.0 - 3.0 * share + 4.0 * share * share;
        let (step, parts) = (0.01, 100_000);
        let missed = |part: i32| {
            let share = (f64::from(part) + 0.5) / f64::from(parts);
            parabola(share) - (parabola(0.0) + share * (parabola(1.0) - parabola(0.0)))
        };
        // The velocity is in units of the frequency: `p' = ω b u`.
        let impulse = (0..parts).map(missed).sum::<f64>() * step / f64::from(parts);
        let expected = (mode.frequency * mode.gain * impulse).abs();
        let mut system = Dynamics {
            input_scale: 1.0,
            output_offset: 0.0,
            output_scale: 1.0,
            direct: 0.0,
            hold: Hold::Cubic,
            longest_step: step,
            begins_under_input: false,
            modes: vec![mode],
            elements: Vec::new(),
        };
        let drive = DynamicsDrive {
            x: (0..4).map(|row| parabola(f64::from(row))).collect(),
            steps: vec![step; 4],
            targets: vec![0.0; 4],
            weights: vec![1.0; 4],
        };
        assert!((kick(&mode, &system, &drive) / expected - 1.0).abs() < 1e-6);
        // What is held constant is known.
        system.hold = Hold::Constant;
        assert_eq!(kick(&mode, &system, &drive), LEAST_KICK);
    }
}
