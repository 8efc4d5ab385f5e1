//! Duffing oscillator: a mass on a damper and a spring that stiffens with the cube of its displacement, as in the
//! Silverbox benchmark. It has no hysteresis: its output depends on the history of the input by inertia alone.
//!
//! ```text
//! m y'' + c y' + k y + k_3 y³ = u                                          theory.md (6.51)
//! ```
//!
//! `u` is the force in N, `y` the displacement in m.
//!
//! *Published*: the equation (Duffing). *Designed*: all values and all forces, like those of the Silverbox benchmark in
//! resonance, band and sampling. The displacement is sampled without a filter.

use hysid_core::data::record::Record;
use hysid_core::elementary::powi;
use hysid_core::error::Result;

use super::draw::Draw;
use super::multisine::Multisine;
use super::specimen::{Specimen, SpecimenColumns};
use super::{path, runge_kutta};

/// A Duffing oscillator.
///
/// ```
/// use hysid_specimens::DuffingOscillator;
/// let oscillator = DuffingOscillator::designed();
/// let force = vec![150.0; 20_001]; // N at every half step of 0.1 ms
/// let rest = oscillator.motion(&force, 1e-4).last().unwrap().displacement; // after 1 s
/// let DuffingOscillator { stiffness, cubic_stiffness, .. } = oscillator;
/// assert!((stiffness * rest + cubic_stiffness * rest.powi(3) - 150.0).abs() < 0.1);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DuffingOscillator {
    /// `m` in kg, above 0.
    pub mass: f64,
    /// `c` in N s/m.
    pub damping: f64,
    /// `k` in N/m.
    pub stiffness: f64,
    /// `k_3` in N/m³; above 0 the spring stiffens.
    pub cubic_stiffness: f64,
}

/// State of a [`DuffingOscillator`] at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DuffingMotion {
    /// `y` in m.
    pub displacement: f64,
    /// `y'` in m/s.
    pub velocity: f64,
}

impl DuffingOscillator {
    /// An oscillator of 1 kg with a resonance at 68 Hz and 2.3 % of critical damping for small displacements. Designed.
    pub fn designed() -> Self {
        Self { mass: 1.0, damping: 20.0, stiffness: 1.83e5, cubic_stiffness: 1e10 }
    }

    /// The motion at every second of the forces in N, from rest at the first. Each step, `time_step` in s, takes the
    /// force at its beginning, in its middle and at its end. A force that is not finite makes the motion NaN from there
    /// on.
    pub fn motion(self, force: &[f64], time_step: f64) -> impl Iterator<Item = DuffingMotion> {
        let steps = force.windows(3).step_by(2).scan([0.0; 2], move |state, force| {
            let slope = |share: f64, state| self.slope(state, force[(2.0 * share) as usize]);
            *state = runge_kutta::step(*state, time_step, slope);
            Some(DuffingMotion { displacement: state[0], velocity: state[1] })
        });
        force.first().map(|_| DuffingMotion::default()).into_iter().chain(steps)
    }

    fn slope(&self, [y, v]: [f64; 2], force: f64) -> [f64; 2] {
        let spring = self.stiffness * y + self.cubic_stiffness * powi(y, 3);
        [v, (force - self.damping * v - spring) / self.mass]
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "duffing-oscillator",
    example: None,
    summary: "mass on a spring that stiffens with the cube, without hysteresis, like the Silverbox benchmark",
    published: "the equation (Duffing)",
    designed: "all values, like the Silverbox in resonance (68 Hz), damping and sampling, and all forces; the seed draws the \
               phases of the multisines",
    training: "two random-phase multisines of 8192 rows, 1 to 200 Hz, 40 N rms, each from rest; 610 Hz",
    testing: "another such multisine; and one of 16384 rows that grows from 0 to 60 N rms, beyond the forces of training",
    columns: SpecimenColumns { time: Some("t_s"), input: "excitation_force_N", output: "displacement_m" },
    train: |seed| (0..2).map(|index| multisine(seed, index)).collect(),
    test: |seed| Ok(vec![multisine(seed, 2)?, growing_multisine(seed, 3)?]),
};

const ROWS_PER_SECOND: f64 = 610.0;

const STEPS_PER_ROW: usize = 16;

/// Band of the multisines in Hz.
const BAND: (f64, f64) = (1.0, 200.0);

/// Rows of a multisine, and of the one that grows.
const ROWS: (usize, usize) = (8192, 16_384);

/// Rms value of a multisine, and of the growing one at its end, in N.
const RMS: (f64, f64) = (40.0, 60.0);

/// One period of a multisine of a seed with this number, at all half steps.
fn period(seed: u64, index: usize, rows: usize, rms: f64) -> Vec<f64> {
    let line = |frequency: f64| (frequency * rows as f64 / ROWS_PER_SECOND).round() as usize;
    let lines = line(BAND.0)..=line(BAND.1);
    Multisine::new(&mut Draw::new(seed, index), rows, lines, rms).period(2 * STEPS_PER_ROW)
}

fn multisine(seed: u64, index: usize) -> Result<Record> {
    record(&format!("multisine {}", index + 1), &period(seed, index, ROWS.0, RMS.0))
}

fn growing_multisine(seed: u64, index: usize) -> Result<Record> {
    let force = period(seed, index, ROWS.1, RMS.1);
    let steps = force.len() as f64;
    let growing: Vec<f64> =
        force.iter().enumerate().map(|(step, force)| step as f64 / steps * force).collect();
    record("growing multisine", &growing)
}

fn record(name: &str, force: &[f64]) -> Result<Record> {
    let time_step = 1.0 / (ROWS_PER_SECOND * STEPS_PER_ROW as f64);
    let motion = DuffingOscillator::designed().motion(force, time_step).step_by(STEPS_PER_ROW);
    let displacement: Vec<f64> = motion.map(|motion| motion.displacement).collect();
    let at_rows = force.iter().copied().step_by(2 * STEPS_PER_ROW).collect();
    let time = path::every(1.0 / ROWS_PER_SECOND, displacement.len());
    Record::new(name, vec![at_rows], displacement)?.with_time(time)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, exp, sin};

    use super::*;

    const STEP: f64 = 1e-4;

    /// `m y'²/2 + k y²/2 + k_3 y⁴/4` is what a constant force has done, `u y`, without damping.
    #[test]
    fn without_damping_the_energy_is_the_work_of_the_force() {
        let oscillator = DuffingOscillator { damping: 0.0, ..DuffingOscillator::designed() };
        let mut fastest = 0.0f64;
        for DuffingMotion { displacement: y, velocity: v } in oscillator.motion(&[200.0; 2001], STEP) {
            let stored = 0.5 * (oscillator.mass * v * v + oscillator.stiffness * y * y)
                + 0.25 * oscillator.cubic_stiffness * powi(y, 4);
            assert!((stored - 200.0 * y).abs() < 1e-5, "{y} {v}");
            fastest = fastest.max(v);
        }
        assert!(fastest > 0.3, "{fastest}");
    }

    /// Without the cube, a constant force swings a damped oscillator about `u/k`.
    #[test]
    fn the_linear_oscillator_has_its_step_response() {
        let oscillator = DuffingOscillator { cubic_stiffness: 0.0, ..DuffingOscillator::designed() };
        let omega = (oscillator.stiffness / oscillator.mass).sqrt();
        let decay = oscillator.damping / (2.0 * oscillator.mass);
        let damped = (omega * omega - decay * decay).sqrt();
        for (k, motion) in oscillator.motion(&[100.0; 4001], STEP).enumerate() {
            let t = k as f64 * STEP;
            let swing = cos(damped * t) + decay / damped * sin(damped * t);
            let expected = 100.0 / oscillator.stiffness * (1.0 - exp(-decay * t) * swing);
            assert!((motion.displacement - expected).abs() < 1e-8, "{t}: {motion:?} {expected}");
        }
    }
}
