//! Designs of experiments where time may matter: frequencies, pairs of amplitude and frequency, random
//! histories, a steady sine.

use super::tones::{self, Tone};
use hysid_core::data::record::Record;
use hysid_core::elementary::powf;
use hysid_core::error::Result;
use hysid_core::law::Sample;

use super::Parts;
use hysid::specimens::path;

use super::draw::Draw;
use super::subject::Subject;

/// Steps of the simulation from row to row.
const STEPS_PER_ROW: usize = 10;

/// Tones of a random history.
const TONES: usize = 16;

/// Rows for a period of the fastest tone of a random history.
const ROWS_PER_PERIOD: f64 = 40.0;

/// Share of a random history that only brings the memory into use.
const BLANK: f64 = 0.05;

/// Band of a history without time: only the ratio of its ends counts.
const SLOW_BAND: Band = (0.05, 1.0);

/// A range of frequencies in Hz.
pub(super) type Band = (f64, f64);

/// Input and output of one experiment, row by row.
struct Motion {
    time: Vec<f64>,
    input: Vec<f64>,
    output: Vec<f64>,
}

impl Motion {
    /// The rows from `first` on, their time from 0, the first `blank` without output.
    fn record(mut self, name: String, first: usize, blank: usize) -> Result<Record> {
        self.output[..first + blank].fill(f64::NAN);
        let time = self.time[first..].iter().map(|t| t - self.time[first]).collect();
        let record = Record::new(name, vec![self.input.split_off(first)], self.output.split_off(first))?;
        record.with_time(time)
    }
}

/// Drives an untouched specimen with tones around a mean, `rows` rows `step` seconds apart.
fn driven(subject: &Subject, mean: f64, tones: &[Tone], step: f64, rows: usize) -> Motion {
    let sample = |index: usize| {
        let (t, parts) = (step * index as f64 / STEPS_PER_ROW as f64, STEPS_PER_ROW as f64);
        let duration = if index == 0 { 0.0 } else { step / parts };
        Sample { x: mean + tones::value(tones, t), rate: tones::rate(tones, t), step: duration }
    };
    let samples: Vec<Sample> = (0..(rows - 1) * STEPS_PER_ROW + 1).map(sample).collect();
    let of_row = |column: Vec<f64>| column.into_iter().step_by(STEPS_PER_ROW).collect();
    Motion {
        time: path::every(step, rows),
        input: of_row(samples.iter().map(|sample| sample.x).collect()),
        output: of_row(subject.run(&samples)),
    }
}

/// Sines or triangles at several frequencies, a record each: a blank period, then one or two that count.
/// One or two frequencies inside the range are left out.
pub(super) fn frequencies(draw: &mut Draw, subject: &Subject, (low, high): Band) -> Result<Parts> {
    let count = draw.whole(5, 7);
    let rows = draw.whole(100, 250);
    let periods = draw.whole(1, 2);
    let is_triangle = draw.whole(0, 2) == 0;
    let (mean, half) = subject.swing();
    let mut parts = Parts { train: Vec::new(), test: Vec::new() };
    for index in 0..count {
        let place = index as f64 / (count - 1) as f64;
        let frequency = low * powf(high / low, place) * draw.factor(0.05);
        let wave = if is_triangle {
            tones::rounded_triangle(half, frequency)
        } else {
            vec![Tone::sine(half, frequency)]
        };
        let step = 1.0 / (frequency * rows as f64);
        let motion = driven(subject, mean, &wave, step, (1 + periods) * rows);
        let record = motion.record(format!("{frequency:.4} Hz"), 0, rows)?;
        let is_unseen = index == 2 || index == 4 && count > 5;
        if is_unseen { &mut parts.test } else { &mut parts.train }.push(record);
    }
    Ok(parts)
}

/// Six pairs of amplitude and frequency, two of them left out. A record begins in steady motion: nothing of
/// the period before it is known.
pub(super) fn pairs(draw: &mut Draw, subject: &Subject, (low, high): Band) -> Result<Parts> {
    let rows = draw.whole(100, 200);
    let periods = draw.whole(2, 4);
    let (mean, half) = subject.swing();
    let amplitudes = [0.4, 0.4, 0.7, 0.7, 1.0, 1.0];
    let places = [1.0, 0.5, 0.75, 0.2, 0.6, 0.0];
    let mut parts = Parts { train: Vec::new(), test: Vec::new() };
    for (index, (share, place)) in amplitudes.into_iter().zip(places).enumerate() {
        let amplitude = half * share * draw.factor(0.05);
        let frequency = low * powf(high / low, place) * draw.factor(0.1);
        let step = 1.0 / (frequency * rows as f64);
        let motion = driven(subject, mean, &[Tone::sine(amplitude, frequency)], step, (1 + periods) * rows);
        let record = motion.record(format!("{:.3} at {frequency:.3} Hz", amplitude), rows, 0)?;
        if [1, 2].contains(&index) { &mut parts.test } else { &mut parts.train }.push(record);
    }
    Ok(parts)
}

/// A random history within a band for training and another for the test, whose amplitude differs by up to a
/// tenth.
pub(super) fn random(draw: &mut Draw, subject: &Subject, band: Band) -> Result<Parts> {
    let [train, test] = histories(draw, subject, band);
    Ok(Parts {
        train: vec![train.motion.record("first history".into(), 0, train.blank)?],
        test: vec![test.motion.record("second history".into(), 0, test.blank)?],
    })
}

/// The same without time, for a specimen that needs none.
pub(super) fn slow_random(draw: &mut Draw, subject: &Subject) -> Result<Parts> {
    let [train, test] = histories(draw, subject, SLOW_BAND).map(|History { mut motion, blank }| {
        motion.output[..blank].fill(f64::NAN);
        motion
    });
    Ok(Parts {
        train: vec![Record::new("first history", vec![train.input], train.output)?],
        test: vec![Record::new("second history", vec![test.input], test.output)?],
    })
}

/// A random history, the first `blank` rows of which only bring the memory into use.
struct History {
    motion: Motion,
    blank: usize,
}

fn histories(draw: &mut Draw, subject: &Subject, band: Band) -> [History; 2] {
    let scale = draw.between(0.9, 1.1);
    [(draw.whole(800, 3800), 1.0), (draw.whole(400, 1600), scale)].map(|(rows, scale)| {
        let (mean, half) = subject.swing();
        let step = 1.0 / (ROWS_PER_PERIOD * band.1);
        let tones = random_tones(draw, band, scale * half, step, rows);
        let blank = (BLANK * rows as f64).round() as usize;
        History { motion: driven(subject, mean, &tones, step, rows), blank }
    })
}

/// Tones spread over the band with random phases, whose sum just reaches the amplitude within these rows.
fn random_tones(draw: &mut Draw, (low, high): Band, amplitude: f64, step: f64, rows: usize) -> Vec<Tone> {
    let tone = |index: usize| {
        let place = (index as f64 + draw.between(0.0, 1.0)) / TONES as f64;
        let phase = draw.between(0.0, std::f64::consts::TAU);
        Tone { amplitude: 1.0, frequency: low + (high - low) * place, phase }
    };
    let mut tones: Vec<Tone> = (0..TONES).map(tone).collect();
    let largest = (0..rows).map(|row| tones::value(&tones, step * row as f64).abs()).fold(0.0, f64::max);
    for tone in &mut tones {
        tone.amplitude = amplitude / largest;
    }
    tones
}

/// A steady sine: trained on the first half, tested on the second.
pub(super) fn halves(draw: &mut Draw, subject: &Subject, (low, high): Band) -> Result<Parts> {
    let rows = draw.whole(100, 250);
    let periods = 2 * draw.whole(2, 5);
    let frequency = draw.logarithmic(low, high);
    let (mean, half) = subject.swing();
    let step = 1.0 / (frequency * rows as f64);
    let motion = driven(subject, mean, &[Tone::sine(half, frequency)], step, periods * rows);
    let (train, test) = path::cut(&motion.record(format!("{frequency:.4} Hz"), 0, 0)?, periods / 2 * rows);
    Ok(Parts { train: vec![train], test: vec![test] })
}
