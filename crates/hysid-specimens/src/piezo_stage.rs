//! Piezo stage: a table on flexures, driven by a piezo stack with hysteresis between voltage and free stroke.
//!
//! ```text
//! y'' + 2ζω y' + ω² y = ω² (d u - h)                                       theory.md (6.49)
//! h' = α d u' - β |u'| h - γ u' |h|                                        theory.md (6.50)
//! ```
//!
//! `u` is the voltage in V, `y` the displacement in µm, `d` the stroke of a volt and `h` the part of the stroke in µm
//! that lags behind.
//!
//! *Published*: the equations (Low and Guo). *Designed*: all values and all voltages. Between two rows the voltage is a
//! straight line. Every record begins with the stage at rest without voltage.

use std::f64::consts::{PI, TAU};

use hysid_core::data::record::Record;
use hysid_core::elementary::{cos, sin};
use hysid_core::error::Result;

use super::draw::Draw;
use super::multisine::Multisine;
use super::specimen::{Specimen, SpecimenColumns};
use super::{path, runge_kutta};

/// A piezo stage.
///
/// ```
/// use hysid_specimens::PiezoStage;
/// let stage = PiezoStage::designed();
/// let voltage = (0..5000).map(|row| f64::from(row) * 0.02); // V, a row every 0.2 ms
/// let displacement = stage.motion(voltage, 2e-4, 4).last().unwrap().displacement;
/// assert!(displacement < 0.18 * 100.0); // µm: hysteresis takes a part of the stroke
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PiezoStage {
    /// `ω/2π` in Hz: natural frequency, above 0.
    pub frequency: f64,
    /// `ζ`: damping ratio, from 0 to below 1.
    pub damping: f64,
    /// `d` in µm/V.
    pub stroke: f64,
    /// `α`: share of the stroke that lags behind for small steps of the voltage.
    pub alpha: f64,
    /// `β` in 1/V: softening that dissipates.
    pub beta: f64,
    /// `γ` in 1/V: softening that depends on the sign of `u' h` only.
    pub gamma: f64,
}

/// State of a [`PiezoStage`] at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageMotion {
    /// `y` in µm.
    pub displacement: f64,
    /// `y'` in µm/s.
    pub velocity: f64,
    /// `h` in µm.
    pub hysteretic_stroke: f64,
}

impl PiezoStage {
    /// A stage with a resonance at 200 Hz, 3 % of critical damping and 0.18 µm/V. Designed.
    pub fn designed() -> Self {
        Self { frequency: 200.0, damping: 0.03, stroke: 0.18, alpha: 0.35, beta: 0.04, gamma: 0.01 }
    }

    /// The motion at the times of the voltages in V, `time_step` in s apart, from rest at the first voltage with `h = 0`
    /// there. The way from row to row is integrated in `parts` steps. A voltage that is not finite makes the motion NaN
    /// from there on.
    pub fn motion(
        self,
        voltage: impl IntoIterator<Item = f64>,
        time_step: f64,
        parts: usize,
    ) -> impl Iterator<Item = StageMotion> {
        let mut last = None;
        voltage.into_iter().map(move |voltage| {
            let (from, mut state) = last.unwrap_or((voltage, [self.stroke * voltage, 0.0, 0.0]));
            let rate = (voltage - from) / time_step;
            for part in 0..parts {
                let along = |share: f64| from + (voltage - from) * (part as f64 + share) / parts as f64;
                let slope = |share: f64, state| self.slope(state, along(share), rate);
                state = runge_kutta::step(state, time_step / parts as f64, slope);
            }
            last = Some((voltage, state));
            StageMotion { displacement: state[0], velocity: state[1], hysteretic_stroke: state[2] }
        })
    }

    fn slope(&self, [y, v, h]: [f64; 3], voltage: f64, rate: f64) -> [f64; 3] {
        let omega = TAU * self.frequency;
        let acceleration = omega * omega * (self.stroke * voltage - h - y) - 2.0 * self.damping * omega * v;
        let lagging =
            self.alpha * self.stroke * rate - self.beta * rate.abs() * h - self.gamma * rate * h.abs();
        [v, acceleration, lagging]
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "piezo-stage",
    example: None,
    summary: "stage on flexures, resonant at 200 Hz, driven by a piezo stack with Bouc-Wen hysteresis of the voltage",
    published: "the equations (Low and Guo)",
    designed: "all values and all voltages; the seed draws the phases of the multisines",
    training: "two records of 8192 rows at 5 kHz, each the sum of random-phase multisines of 12 V rms from 1 to 20 Hz and of \
               1.5 V rms from 20 to 350 Hz, about 50 V, raised smoothly from 0 V in 0.1 s",
    testing: "another such record; and a sine of 2 V swept from 10 to 350 Hz in 2 s about 50 V, raised likewise",
    columns: SpecimenColumns { time: Some("t_s"), input: "voltage_V", output: "displacement_um" },
    train: |seed| (0..2).map(|index| multisines(seed, index)).collect(),
    test: |seed| Ok(vec![multisines(seed, 2)?, swept_sine()?]),
};

/// Time from row to row in s.
const TIME_STEP: f64 = 2e-4;

const STEPS_PER_ROW: usize = 4;

const PERIOD: usize = 8192;

/// First and last frequency in Hz and rms value in V of the two multisines.
const BANDS: [(f64, f64, f64); 2] = [(1.0, 20.0, 12.0), (20.0, 350.0, 1.5)];

/// Mean voltage in V.
const BIAS: f64 = 50.0;

/// Time in s in which the voltage is raised from 0.
const ONSET: f64 = 0.1;

/// Amplitude in V, first and last frequency in Hz and duration in s of the swept sine.
const SWEEP: (f64, f64, f64, f64) = (2.0, 10.0, 350.0, 2.0);

/// A record of multisines of a seed, with this number.
fn multisines(seed: u64, index: usize) -> Result<Record> {
    let mut draw = Draw::new(seed, index);
    let mut voltage = vec![0.0; PERIOD];
    for (first, last, rms) in BANDS {
        let line = |frequency: f64| (frequency * TIME_STEP * PERIOD as f64).round() as usize;
        let multisine = Multisine::new(&mut draw, PERIOD, line(first)..=line(last), rms).period(1);
        voltage.iter_mut().zip(multisine).for_each(|(sum, value)| *sum += value);
    }
    record(&format!("multisines {}", index + 1), voltage)
}

fn swept_sine() -> Result<Record> {
    let (amplitude, first, last, duration) = SWEEP;
    let voltage = |row: usize| {
        let t = row as f64 * TIME_STEP;
        amplitude * sin(TAU * (first + 0.5 * (last - first) * t / duration) * t)
    };
    record("swept sine", (0..(duration / TIME_STEP).round() as usize).map(voltage).collect())
}

/// The record of a voltage in V about the bias.
fn record(name: &str, about_bias: Vec<f64>) -> Result<Record> {
    let time = path::every(TIME_STEP, about_bias.len());
    let raised = |t: f64| 0.5 * (1.0 - cos(PI * (t / ONSET).min(1.0)));
    let voltage: Vec<f64> = time.iter().zip(about_bias).map(|(&t, u)| raised(t) * (BIAS + u)).collect();
    let motion = PiezoStage::designed().motion(voltage.iter().copied(), TIME_STEP, STEPS_PER_ROW);
    let displacement = motion.map(|motion| motion.displacement).collect();
    Record::new(name, vec![voltage], displacement)?.with_time(time)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::exp;

    use super::*;

    /// On a voltage that rises steadily from 0, `h = α d/b (1 - e^{-b u})` with `b = β + γ`; on its way back from `h_r` at
    /// `u_r`, `h = (h_r + a) e^{-(β - γ)(u_r - u)} - a` with `a = α d/(β - γ)`, while `h >= 0`.
    #[test]
    fn branches_are_exponentials() {
        let stage = PiezoStage::designed();
        let PiezoStage { stroke, alpha, beta, gamma, .. } = stage;
        let up = |u: f64| alpha * stroke / (beta + gamma) * (1.0 - exp(-(beta + gamma) * u));
        let (turn, a) = (60.0, alpha * stroke / (beta - gamma));
        let down = |u: f64| (up(turn) + a) * exp(-(beta - gamma) * (turn - u)) - a;
        let voltage = (0..=120).map(|k| f64::from(60 - (60_i32 - k).abs()));
        let mut seen = 0;
        for (k, (u, motion)) in voltage.clone().zip(stage.motion(voltage, TIME_STEP, 40)).enumerate() {
            let expected = if k <= 60 { up(u) } else { down(u) };
            if expected >= 0.0 {
                assert!((motion.hysteretic_stroke - expected).abs() < 1e-9, "{u}: {motion:?} {expected}");
                seen += 1;
            }
        }
        assert!(seen > 70, "{seen}");
    }

    /// Without hysteresis a ramp of the voltage from rest drags the stage behind it:
    /// `y = d r (t - 2ζ/ω + e^{-ζωt} (2ζ/ω cos ω_d t + (2ζ² - 1)/ω_d sin ω_d t))`.
    #[test]
    fn the_linear_stage_has_its_ramp_response() {
        let stage = PiezoStage { alpha: 0.0, ..PiezoStage::designed() };
        let (zeta, omega) = (stage.damping, TAU * stage.frequency);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let rate = 1000.0;
        let ramp = (0..400).map(|row| rate * TIME_STEP * f64::from(row));
        for (row, motion) in stage.motion(ramp, TIME_STEP, 2 * STEPS_PER_ROW).enumerate() {
            let t = row as f64 * TIME_STEP;
            let swing =
                2.0 * zeta / omega * cos(damped * t) + (2.0 * zeta * zeta - 1.0) / damped * sin(damped * t);
            let expected = stage.stroke * rate * (t - 2.0 * zeta / omega + exp(-zeta * omega * t) * swing);
            assert!((motion.displacement - expected).abs() < 1e-5, "{t}: {motion:?} {expected}");
        }
    }

    #[test]
    fn voltages_stay_within_the_range_of_a_stack() {
        for seed in 1..=3 {
            for data in [SPECIMEN.train_with_seed(seed), SPECIMEN.test_with_seed(seed)] {
                for record in data.records() {
                    assert_eq!((record.inputs()[0][0], record.output()[0]), (0.0, 0.0));
                    assert!(record.inputs()[0].iter().all(|u| (-20.0..120.0).contains(u)));
                }
            }
        }
    }
}
