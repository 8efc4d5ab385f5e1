//! Rate-dependent actuator: the Prandtl-Ishlinskii law whose thresholds grow with the rate of the input, so
//! that its loops widen and flatten with increasing speed.
//!
//! ```text
//! r_i = α i + β |v'|,   p_i,k = max(v_k - r_i, min(v_k + r_i, p_i,k-1))    theory.md (6.16)
//! y   = a0 v + Σ_i a_i p_i,   a_i = ρ e^{-τ α i},   i = 1 ... n            theory.md (6.17)
//! ```
//!
//! `v` is the voltage in V, `v'` its rate in V/s, `y` the displacement in µm, `p_i` play `i` with the
//! threshold `r_i`. Source: Al Janaideh, Rakheja and Su.
//!
//! *Published*: the law. *Designed*: all values; those that the paper identified for its example 6, and its
//! inputs, are not published.

use hysid_core::data::record::Record;
use hysid_core::elementary::exp;
use hysid_core::error::Result;
use hysid_core::law::rate_dependent_prandtl_ishlinskii::{
    PlayWeights, RateDependentPrandtlIshlinskii, Thresholds,
};
use hysid_core::law::{Law, Sample};

use super::specimen::{Specimen, SpecimenColumns};
use super::tones::{self, Tone};

/// A rate-dependent actuator with its memory, initially virgin: voltage in V to displacement in µm.
#[derive(Debug, Clone, PartialEq)]
pub struct RateDependentActuator {
    law: RateDependentPrandtlIshlinskii,
    plays: Vec<f64>,
}

impl RateDependentActuator {
    /// A virgin actuator of `a0` and `a_i` in µm/V, `α` in V and `β` in s.
    pub fn new(spring: f64, weights: Vec<f64>, spacing: f64, beta: f64) -> Self {
        let (thresholds, weights) = (Thresholds::Linear { beta }, PlayWeights::Free(weights));
        let law = RateDependentPrandtlIshlinskii { offset: 0.0, spring, spacing, thresholds, weights };
        Self { plays: law.virgin(), law }
    }

    /// The actuator of the catalogue: `n = 10`, `a0 = 0.5`, `a_i = 0.4 e^{-0.12 i}`, `r_i = 0.6 i + 0.002 |v'|`.
    /// Designed.
    pub fn designed() -> Self {
        Self::new(0.5, (1..=10).map(|i| 0.4 * exp(-0.12 * f64::from(i))).collect(), 0.6, 2e-3)
    }

    /// The displacement in µm at the next voltage in V, which changes at `rate` in V/s. The rate between two
    /// samples is not known, so steps must be small where it changes. A value that is not finite gives NaN
    /// and leaves the memory unchanged.
    pub fn step(&mut self, voltage: f64, rate: f64) -> f64 {
        if !(voltage.is_finite() && rate.is_finite()) {
            return f64::NAN;
        }
        self.law.step(&mut self.plays, Sample { x: voltage, rate, step: 0.0 })
    }
}

/// The displacements in µm of the virgin actuator at times in s, where the voltage in V is a straight line between them.
pub fn run(time: &[f64], voltage: &[f64]) -> Vec<f64> {
    let mut actuator = RateDependentActuator::designed();
    let mut last: Option<(f64, f64)> = None;
    let mut step = |(&t, &v): (&f64, &f64)| {
        let (before, from) = last.replace((t, v)).unwrap_or((t - 1.0, v));
        let rate = (v - from) / (t - before);
        let parts = STEPS_PER_ROW as f64;
        let on_the_way = |part: usize| from + (v - from) * (part as f64 / parts);
        (1..=STEPS_PER_ROW).map(|part| actuator.step(on_the_way(part), rate)).last().unwrap_or(f64::NAN)
    };
    time.iter().zip(voltage).map(&mut step).collect()
}

pub(super) static SPECIMEN: Specimen = ACTUATOR;

const ACTUATOR: Specimen = Specimen {
    name: "rate-dependent-actuator",
    example: Some("example 6"),
    summary: "actuator whose loops widen with speed: a Prandtl-Ishlinskii law with thresholds that grow with the rate",
    published: "the rate-dependent Prandtl-Ishlinskii law (Al Janaideh, Rakheja, Su)",
    designed: "all values and all inputs",
    training: "sines of 10 V at 1, 5, 10, 20, 30, 40, 50, 60, 80 and 100 Hz, a record each: a period with \
               blank outputs, from the virgin state, then two that count",
    testing: "sines of 10 V at 25 and at 75 Hz, likewise, and, unlike all in training, a sum of tones at 5, 30 and 60 Hz",
    columns: SpecimenColumns { time: Some("t_s"), input: "voltage_V", output: "displacement_um" },
    train: |_| FREQUENCIES.into_iter().map(|frequency| sine(frequency, PERIODS)).collect(),
    test: |_| Ok(vec![sine(25.0, PERIODS)?, sine(75.0, PERIODS)?, three_tones()?]),
};

/// The same actuator, with sums of tones among its training data.
///
/// On a sine the input and its rate lie on an ellipse, one for each frequency: pairs between these ellipses
/// occur in no sine, but in every sum of tones.
pub(super) static TONES: Specimen = Specimen {
    name: "rate-dependent-actuator-tones",
    summary: "the same rate-dependent actuator, trained on sums of tones too",
    training: "the ten sines of rate-dependent-actuator, of which one period counts, and eight sums of three tones \
               between 5 and 80 Hz that reach 10 V at most, 0.12 s each, from the virgin state",
    train: |_| {
        let sines = FREQUENCIES.into_iter().map(|frequency| sine(frequency, 2));
        sines.chain(MIXTURES.iter().enumerate().map(mixture)).collect()
    },
    ..ACTUATOR
};

/// Frequencies in Hz and amplitudes in V of the sums of tones to train on; none is that of the test.
const MIXTURES: [[(f64, f64); 3]; 8] = [
    [(5.0, 5.0), (20.0, 3.0), (70.0, 2.0)],
    [(10.0, 3.0), (35.0, 3.0), (55.0, 4.0)],
    [(5.0, 6.0), (40.0, 2.0), (80.0, 2.0)],
    [(15.0, 4.0), (30.0, 4.0), (65.0, 2.0)],
    [(10.0, 2.0), (20.0, 5.0), (60.0, 3.0)],
    [(15.0, 3.0), (45.0, 2.0), (50.0, 5.0)],
    [(5.0, 3.0), (40.0, 5.0), (70.0, 2.0)],
    [(10.0, 7.0), (30.0, 2.0), (80.0, 1.0)],
];

/// The golden ratio, whose multiples are phases that do not repeat.
const GOLDEN: f64 = 1.618_033_988_749_895;

fn mixture((index, tones): (usize, &[(f64, f64); 3])) -> Result<Record> {
    let tone = |(place, &(frequency, amplitude)): (usize, &(f64, f64))| Tone {
        amplitude,
        frequency,
        phase: std::f64::consts::TAU * (GOLDEN * (3 * index + place) as f64).fract(),
    };
    let tones: Vec<Tone> = tones.iter().enumerate().map(tone).collect();
    record(&format!("tones {}", index + 1), &tones, 1.0 / 3000.0, 360, 0)
}

/// Frequencies to train on, in Hz.
const FREQUENCIES: [f64; 10] = [1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0];

/// Rows of a period of a sine.
const ROWS_PER_PERIOD: usize = 200;

const PERIODS: usize = 3;

/// Steps of the simulation from row to row.
const STEPS_PER_ROW: usize = 20;

/// So many periods of a sine, the first without output.
fn sine(frequency: f64, periods: usize) -> Result<Record> {
    let tone = Tone::sine(10.0, frequency);
    let step = 1.0 / (frequency * ROWS_PER_PERIOD as f64);
    record(&format!("{frequency} Hz"), &[tone], step, periods * ROWS_PER_PERIOD, ROWS_PER_PERIOD)
}

/// The tones repeat after 0.2 s; twice that at 3 kHz.
fn three_tones() -> Result<Record> {
    let tones = [
        Tone { amplitude: 4.0, frequency: 5.0, phase: 0.0 },
        Tone { amplitude: 3.5, frequency: 30.0, phase: 1.0 },
        Tone { amplitude: 2.5, frequency: 60.0, phase: 2.0 },
    ];
    record("three tones", &tones, 1.0 / 3000.0, 1200, 0)
}

/// A record of a sum of tones, `rows` rows `step` seconds apart, the first `blank` without output.
fn record(name: &str, tones: &[Tone], step: f64, rows: usize, blank: usize) -> Result<Record> {
    let mut actuator = RateDependentActuator::designed();
    let (mut time, mut voltages, mut output) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..rows {
        // All steps that lead from the last row to this one; the first row has none before it.
        let first = if row == 0 { STEPS_PER_ROW } else { 1 };
        let mut last = (0.0, 0.0, 0.0);
        for part in first..=STEPS_PER_ROW {
            let steps = (row * STEPS_PER_ROW + part - STEPS_PER_ROW) as f64;
            let t = step * steps / STEPS_PER_ROW as f64;
            let voltage = tones::value(tones, t);
            last = (t, voltage, actuator.step(voltage, tones::rate(tones, t)));
        }
        time.push(last.0);
        voltages.push(last.1);
        output.push(last.2);
    }
    output[..blank].fill(f64::NAN);
    Record::new(name, vec![voltages], output)?.with_time(time)
}
