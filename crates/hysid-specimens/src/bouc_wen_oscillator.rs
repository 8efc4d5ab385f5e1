//! Bouc-Wen oscillator: a mass on a spring, a damper and a hysteretic element, driven by a force. It is the hysteretic
//! benchmark of nonlinearbenchmark.org.
//!
//! ```text
//! m y'' + c y' + k y + r = u                                               theory.md (6.40)
//! r' = α y' - β (γ |y'| |r|^{n-1} r + δ y' |r|^n)                          theory.md (6.41)
//! ```
//!
//! `u` is the force in N, `y` the displacement in m and `r` the hysteretic force in N. The equations are integrated at
//! 15 kHz by the method of Newmark with constant average acceleration, with the trapezoidal rule for `r`; the equations
//! of a step are solved by Newton's method. The displacement is low-passed and decimated to 750 Hz by 2, 2 and 5.
//!
//! *Published*: the equations, all values, the method of Newmark, the sampling rates, the filter, and kind, band and
//! amplitude of the excitations (Noël and Schoukens, Hysteretic benchmark with a dynamic nonlinearity, 2016). The test
//! signals of the benchmark are not part of this specimen. *Designed*: the phases of the multisines, which the seed
//! draws; the trapezoidal rule for `r`, because the program of the benchmark is protected; that both tests follow one
//! after the other in one data set.

use std::f64::consts::TAU;

use hysid_core::data::record::Record;
use hysid_core::elementary::{powf, sin};
use hysid_core::error::Result;

use super::decimation::decimate;
use super::draw::Draw;
use super::multisine::Multisine;
use super::path;
use super::specimen::{Specimen, SpecimenColumns};

/// Newton's method ends where it changes the displacement by less than this share.
const TOLERANCE: f64 = 1e-12;

/// Iterations after which Newton's method ends: where a branch changes, it may alternate at the last digits.
const MOST_ITERATIONS: usize = 30;

/// A Bouc-Wen oscillator.
///
/// ```
/// use hysid_specimens::BoucWenOscillator;
/// let oscillator = BoucWenOscillator::benchmark();
/// let force = (0..3000).map(|k| 50.0 * (0.01 * f64::from(k)).sin()); // N
/// let motion: Vec<_> = oscillator.motion(force, 1.0 / 15_000.0).collect();
/// assert_eq!(motion[0].displacement, 0.0);
/// assert!(motion[2999].displacement.abs() < 0.002); // m
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoucWenOscillator {
    /// `m` in kg, above 0.
    pub mass: f64,
    /// `c` in N s/m.
    pub damping: f64,
    /// `k` in N/m: stiffness of the linear spring.
    pub stiffness: f64,
    /// `α` in N/m: initial stiffness of the hysteretic element.
    pub alpha: f64,
    /// `β` in 1/m where `n = 1`: curvature of the branches.
    pub beta: f64,
    /// `γ`: share of the curvature that dissipates.
    pub gamma: f64,
    /// `δ`: share of the curvature that depends on the sign of `r y'` only.
    pub delta: f64,
    /// `n`: sharpness of yielding, 1 or more.
    pub n: f64,
}

/// Motion of a [`BoucWenOscillator`] at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoucWenMotion {
    /// `y` in m.
    pub displacement: f64,
    /// `y'` in m/s.
    pub velocity: f64,
    /// `y''` in m/s².
    pub acceleration: f64,
    /// `r` in N.
    pub hysteretic_force: f64,
}

impl BoucWenOscillator {
    /// The oscillator of the benchmark. Published.
    pub fn benchmark() -> Self {
        Self {
            mass: 2.0,
            damping: 10.0,
            stiffness: 5e4,
            alpha: 5e4,
            beta: 1e3,
            gamma: 0.8,
            delta: -1.1,
            n: 1.0,
        }
    }

    /// The motion from rest at the times of the forces in N, `time_step` in s apart; NaN after an invalid force.
    pub fn motion(
        self,
        force: impl IntoIterator<Item = f64>,
        time_step: f64,
    ) -> impl Iterator<Item = BoucWenMotion> {
        let mut last: Option<BoucWenMotion> = None;
        force.into_iter().map(move |force| {
            let next = match last {
                None => BoucWenMotion { acceleration: force / self.mass, ..BoucWenMotion::default() },
                Some(motion) => self.step(motion, force, time_step),
            };
            last = Some(next);
            next
        })
    }

    /// `r'` in N/s, and its derivatives by `y'` and by `r`.
    fn hysteretic_rate(&self, velocity: f64, r: f64) -> (f64, f64, f64) {
        let power = powf(r.abs(), self.n - 1.0);
        let rate = self.alpha * velocity
            - self.beta * power * (self.gamma * velocity.abs() * r + self.delta * velocity * r.abs());
        let by_velocity =
            self.alpha - self.beta * power * (self.gamma * velocity.signum() * r + self.delta * r.abs());
        let by_r =
            -self.beta * self.n * power * (self.gamma * velocity.abs() + self.delta * velocity * r.signum());
        (rate, by_velocity, by_r)
    }

    /// The motion one time step `h` later, under a force in N.
    ///
    /// With the displacement `y`, constant average acceleration gives `y' = 2(y - y_0)/h - y'_0` and
    /// `y'' = 2(y' - y'_0)/h - y''_0`. The displacement and `r` follow from equilibrium and from the trapezoidal rule
    /// `r = r_0 + h (r'_0 + r')/2`.
    fn step(&self, from: BoucWenMotion, force: f64, h: f64) -> BoucWenMotion {
        let (first_rate, ..) = self.hysteretic_rate(from.velocity, from.hysteretic_force);
        let mut by = h * from.velocity; // y - y_0
        let mut r = from.hysteretic_force + h * first_rate;
        for _ in 0..MOST_ITERATIONS {
            let motion = from.after(by, r, h);
            let (rate, by_velocity, by_r) = self.hysteretic_rate(motion.velocity, r);
            let out_of_balance = self.mass * motion.acceleration
                + self.damping * motion.velocity
                + self.stiffness * motion.displacement
                + r
                - force;
            let off_the_rule = r - from.hysteretic_force - 0.5 * h * (first_rate + rate);
            let dynamic_stiffness = 4.0 * self.mass / (h * h) + 2.0 * self.damping / h + self.stiffness;
            // The second equation gives the change of r for a change of y.
            let (slope, offset) =
                (by_velocity / (1.0 - 0.5 * h * by_r), off_the_rule / (1.0 - 0.5 * h * by_r));
            let change = (offset - out_of_balance) / (dynamic_stiffness + slope);
            by += change;
            r += slope * change - offset;
            if change.abs() <= TOLERANCE * by.abs() {
                break;
            }
        }
        from.after(by, r, h)
    }
}

impl BoucWenMotion {
    /// The motion one time step later, displaced by `by` and with this hysteretic force.
    fn after(&self, by: f64, hysteretic_force: f64, time_step: f64) -> Self {
        let velocity = 2.0 * by / time_step - self.velocity;
        Self {
            displacement: self.displacement + by,
            velocity,
            acceleration: 2.0 * (velocity - self.velocity) / time_step - self.acceleration,
            hysteretic_force,
        }
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "bouc-wen-oscillator",
    example: None,
    summary: "mass on a spring, a damper and a Bouc-Wen element: the hysteretic benchmark of nonlinearbenchmark.org",
    published: "equations, all values, integration, sampling, and kind, band and amplitude of the excitations (Noël and \
                Schoukens, 2016); the test signals of the benchmark itself are not included",
    designed: "the phases of the multisines, which the seed draws",
    training: "five periods of 8192 rows of a random-phase multisine, 5 to 150 Hz, 50 N rms, from rest; 750 Hz; white \
               noise of 8e-6 m rms on the displacement, as in the benchmark",
    testing: "without noise: another multisine in its steady state, two periods, the first with blank outputs; and a \
              sine of 40 N swept from 20 to 50 Hz in 180 s, from rest",
    columns: SpecimenColumns { time: Some("t_s"), input: "excitation_force_N", output: "displacement_m" },
    train: training,
    test: tests,
};

const ROWS_PER_SECOND: f64 = 750.0;

const STEPS_PER_ROW: usize = 20;

/// Factors of the decimation, in their order.
const DECIMATION: [usize; 3] = [2, 2, 5];

/// Rows that are integrated beyond the last one, so that the low-pass filters do not reach the end of the signal.
const ROWS_BEYOND: usize = 10;

const PERIOD: usize = 8192;

/// Band of the multisines in Hz.
const BAND: (f64, f64) = (5.0, 150.0);

/// Rms value of the multisines in N.
const RMS: f64 = 50.0;

/// Periods of the training multisine, and of the test multisine up to its end.
const PERIODS: usize = 5;

/// Rms value of the noise in m.
const NOISE: f64 = 8e-6;

/// Amplitude in N of the swept sine, its first and last frequency in Hz, and its rate in Hz/s.
const SWEEP: (f64, f64, f64, f64) = (40.0, 20.0, 50.0, 10.0 / 60.0);

fn training(seed: u64) -> Result<Vec<Record>> {
    let mut draw = Draw::new(seed, 0);
    let force = multisine(&mut draw, PERIODS);
    let mut displacement = response(&force);
    displacement.iter_mut().for_each(|y| *y += NOISE * draw.normal());
    Ok(vec![record("multisine", at_rows(&force), displacement)?])
}

/// The test records of a seed: the steady multisine, then the swept sine.
fn tests(seed: u64) -> Result<Vec<Record>> {
    let force = multisine(&mut Draw::new(seed, 1), PERIODS);
    let steady = (PERIODS - 2) * PERIOD;
    let (force, mut displacement) = (at_rows(&force).split_off(steady), response(&force).split_off(steady));
    displacement[..PERIOD].fill(f64::NAN);
    let swept = swept_sine();
    Ok(vec![
        record("multisine", force, displacement)?,
        record("swept sine", at_rows(&swept), response(&swept))?,
    ])
}

fn multisine(draw: &mut Draw, periods: usize) -> Vec<f64> {
    let line = ROWS_PER_SECOND / PERIOD as f64;
    let lines = (BAND.0 / line).floor() as usize..=(BAND.1 / line).ceil() as usize;
    let period = Multisine::new(draw, PERIOD, lines, RMS).period(STEPS_PER_ROW);
    let steps = (periods * PERIOD + ROWS_BEYOND) * STEPS_PER_ROW;
    period.into_iter().cycle().take(steps).collect()
}

fn swept_sine() -> Vec<f64> {
    let (amplitude, first, last, rate) = SWEEP;
    let rows = ((last - first) / rate * ROWS_PER_SECOND).round() as usize;
    let force = |step: usize| {
        let t = step as f64 * time_step();
        amplitude * sin(TAU * (first + 0.5 * rate * t) * t)
    };
    (0..(rows + ROWS_BEYOND) * STEPS_PER_ROW).map(force).collect()
}

/// Time step of the integration in s.
fn time_step() -> f64 {
    1.0 / (ROWS_PER_SECOND * STEPS_PER_ROW as f64)
}

/// The force in N at the rows.
fn at_rows(force: &[f64]) -> Vec<f64> {
    let rows = force.len() / STEPS_PER_ROW - ROWS_BEYOND;
    force.iter().copied().step_by(STEPS_PER_ROW).take(rows).collect()
}

/// The displacement in m at the rows under a force in N at all steps.
fn response(force: &[f64]) -> Vec<f64> {
    let motion = BoucWenOscillator::benchmark().motion(force.iter().copied(), time_step());
    let displacement = motion.map(|motion| motion.displacement).collect();
    let mut rows =
        DECIMATION.iter().fold(displacement, |signal: Vec<f64>, &factor| decimate(&signal, factor));
    rows.truncate(force.len() / STEPS_PER_ROW - ROWS_BEYOND);
    rows
}

fn record(name: &str, force: Vec<f64>, displacement: Vec<f64>) -> Result<Record> {
    let time = path::every(1.0 / ROWS_PER_SECOND, force.len());
    Record::new(name, vec![force], displacement)?.with_time(time)
}

#[cfg(test)]
mod laws {
    use hysid_core::elementary::{cos, exp, square};

    use super::*;

    const STEP: f64 = 1.0 / 15_000.0;

    fn shaken(count: u32) -> impl Iterator<Item = f64> + Clone {
        (0..count).map(|k| 60.0 * sin(0.011 * f64::from(k)) + 30.0 * cos(0.037 * f64::from(k)))
    }

    /// Constant average acceleration keeps the balance of energy from step to step.
    #[test]
    fn work_becomes_energy_or_is_dissipated() {
        let oscillator = BoucWenOscillator { n: 1.5, beta: 30.0, ..BoucWenOscillator::benchmark() };
        for oscillator in [oscillator, BoucWenOscillator::benchmark()] {
            let motion: Vec<BoucWenMotion> = oscillator.motion(shaken(4000), STEP).collect();
            let force: Vec<f64> = shaken(4000).collect();
            let energy = |at: &BoucWenMotion| {
                0.5 * (oscillator.mass * square(at.velocity) + oscillator.stiffness * square(at.displacement))
            };
            let (mut work, mut dissipated) = (0.0, 0.0);
            for (motion, force) in motion.windows(2).zip(force.windows(2)) {
                let by = motion[1].displacement - motion[0].displacement;
                work += 0.5 * (force[0] + force[1]) * by;
                dissipated += 0.5 * oscillator.damping * (motion[0].velocity + motion[1].velocity) * by
                    + 0.5 * (motion[0].hysteretic_force + motion[1].hysteretic_force) * by;
            }
            let balance = work - dissipated - energy(&motion[3999]);
            assert!(work > 0.1 && balance.abs() < 1e-10 * work, "{balance} of {work}");
        }
    }

    /// Without the hysteretic element, a constant force swings a damped oscillator about `u/k`.
    #[test]
    fn the_linear_oscillator_has_its_step_response() {
        let oscillator = BoucWenOscillator { alpha: 0.0, beta: 0.0, ..BoucWenOscillator::benchmark() };
        let omega = (oscillator.stiffness / oscillator.mass).sqrt();
        let decay = oscillator.damping / (2.0 * oscillator.mass);
        let damped = (omega * omega - decay * decay).sqrt();
        let largest_error = |step: f64| {
            let motion = oscillator.motion((0..).map(|_| 100.0), step);
            let error = |(k, motion): (u32, BoucWenMotion)| {
                let t = f64::from(k) * step;
                let swing = cos(damped * t) + decay / damped * sin(damped * t);
                (motion.displacement / (100.0 / oscillator.stiffness) - 1.0 + exp(-decay * t) * swing).abs()
            };
            (0..).zip(motion.take((0.2 / step) as usize)).map(error).fold(0.0, f64::max)
        };
        let (whole, half) = (largest_error(STEP), largest_error(0.5 * STEP));
        assert!(whole < 5e-4 && (whole / half - 4.0).abs() < 0.05, "{whole} {half}");
    }

    /// From rest and as long as the mass moves on, `r = α/b (1 - e^{-b y})` with `b = β (γ + δ)`.
    #[test]
    fn the_first_branch_is_an_exponential() {
        let oscillator = BoucWenOscillator { delta: 0.5, ..BoucWenOscillator::benchmark() };
        let b = oscillator.beta * (oscillator.gamma + oscillator.delta);
        let motion = oscillator.motion((0..).map(|_| 100.0), STEP);
        let mut rows = 0;
        for motion in motion.take_while(|motion| motion.velocity >= 0.0) {
            let expected = oscillator.alpha / b * (1.0 - exp(-b * motion.displacement));
            assert!((motion.hysteretic_force - expected).abs() < 2e-3, "{motion:?} {expected}");
            rows += 1;
        }
        assert!(rows > 150, "{rows}");
    }

    #[test]
    fn a_force_that_is_none_gives_no_displacement() {
        let motion = BoucWenOscillator::benchmark().motion([0.0, 1.0, f64::NAN, 1.0], STEP);
        let displacement: Vec<f64> = motion.map(|motion| motion.displacement).collect();
        assert!(displacement[1] > 0.0 && displacement[2].is_nan() && displacement[3].is_nan());
    }
}

#[cfg(test)]
mod benchmark {
    use hysid_core::elementary::square;

    use super::*;

    #[test]
    fn records_have_the_rows_of_the_benchmark() {
        let train = &training(1).unwrap()[0];
        assert_eq!((train.len(), train.scored()), (40_960, 40_960));
        let force = &train.inputs()[0];
        let rms = (force.iter().map(|u| u * u).sum::<f64>() / 40_960.0).sqrt();
        assert!((rms - 50.0).abs() < 1e-9, "{rms}");
        assert_eq!(force[..PERIOD], force[4 * PERIOD..]);
        assert_eq!(train.time().unwrap()[750], 1.0);
    }

    /// The last two training periods differ by the noise alone, once the transient has gone.
    #[test]
    fn training_has_the_noise_of_the_benchmark() {
        let train = &training(1).unwrap()[0];
        let steady = train.output()[3 * PERIOD..4 * PERIOD].iter().zip(&train.output()[4 * PERIOD..]);
        let rms = (steady.map(|(a, b)| square(a - b)).sum::<f64>() / PERIOD as f64 / 2.0).sqrt();
        // Four standard errors of a normal sample.
        assert!((rms / NOISE - 1.0).abs() < 4.0 / (2.0 * PERIOD as f64).sqrt(), "{rms}");
    }

    #[test]
    fn tests_are_driven_before_they_count_and_start_from_rest() {
        let tests = tests(1).unwrap();
        let [multisine, sweep] = &tests[..] else { panic!("two records") };
        assert_eq!((multisine.len(), multisine.scored()), (2 * PERIOD, PERIOD));
        assert!(multisine.output()[..PERIOD].iter().all(|y| y.is_nan()));
        assert_eq!((sweep.len(), sweep.scored()), (135_000, 135_000));
        assert_eq!(sweep.inputs()[0][0], 0.0);
        assert!(sweep.output()[0].abs() < 1e-18, "{}", sweep.output()[0]);
    }
}
