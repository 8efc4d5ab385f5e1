//! Designs of slow experiments, where time does not matter: cyclic tests, closed loops, reversal curves.

use std::f64::consts::TAU;

use hysid_core::data::record::Record;
use hysid_core::elementary::{powf, powi, sin};
use hysid_core::error::Result;

use super::Parts;
use hysid::specimens::path;

use super::draw::Draw;
use super::subject::Subject;

/// Share of a cyclic test that is for training.
const TRAINED: f64 = 0.7;

/// Rows of a cyclic test.
const CYCLIC_ROWS: (usize, usize) = (700, 4200);

/// How far a peak misses its level: deviation of the logarithm.
const MISSED: f64 = 0.04;

/// How the amplitude of a cyclic test develops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// Levels rise evenly, one to three cycles each, sometimes with a smaller cycle after.
    Growing,
    /// A few levels, many cycles each.
    Repeated,
    /// Levels rise, but no cycle is as large as the one before.
    Irregular,
}

/// Which loop is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LeftOut {
    /// One between others.
    Inside,
    /// The largest.
    Largest,
}

/// Where reversal curves begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum From {
    /// At the lower end: up to a peak of its own and back, all of it scored.
    Below,
    /// At the upper end: a saturating path and the way down to a reversal of its own are blank, the way up
    /// is scored.
    Above,
}

/// One test, cut in two: the test goes on where training ends, with its past.
pub(super) fn cyclic(draw: &mut Draw, subject: &Subject, course: Course) -> Result<Parts> {
    let turning = turning_points(draw, subject.range, course);
    let rows = draw.whole(CYCLIC_ROWS.0, CYCLIC_ROWS.1);
    let input = path::through(&turning, path::travel(&turning) / rows as f64);
    let output = subject.run_still(&input);
    let whole = Record::new("cyclic test", vec![input], output)?;
    let end = (TRAINED * whole.len() as f64).round() as usize;
    let (train, test) = path::cut(&whole, end);
    Ok(Parts { train: vec![train], test: vec![test] })
}

/// Turning points from 0 on. Where the range begins at 0, the input goes down to a share of the peak.
fn turning_points(draw: &mut Draw, (low, high): (f64, f64), course: Course) -> Vec<f64> {
    let mut turning = vec![0.0];
    for level in levels(draw, course) {
        let top = high * level * draw.factor(MISSED);
        let bottom =
            if low < 0.0 { low * level * draw.factor(MISSED) } else { top * draw.between(0.0, 0.65) };
        turning.extend([top, bottom]);
    }
    turning
}

/// The level of every cycle, as a share of the largest.
fn levels(draw: &mut Draw, course: Course) -> Vec<f64> {
    let steps = match course {
        Course::Growing => draw.whole(7, 12),
        Course::Repeated => draw.whole(3, 5),
        Course::Irregular => draw.whole(18, 34),
    };
    let cycles = match course {
        Course::Growing => draw.whole(1, 3),
        Course::Repeated => draw.whole(5, 9),
        Course::Irregular => 1,
    };
    let smaller_cycle_after = course == Course::Growing && draw.whole(0, 2) == 0;
    let mut levels = Vec::new();
    for step in 1..=steps {
        let share = step as f64 / steps as f64;
        match course {
            Course::Growing | Course::Repeated => levels.extend(vec![share; cycles]),
            Course::Irregular => levels.push(draw.between(0.35, 1.0) * powf(share, 0.6)),
        }
        if smaller_cycle_after {
            levels.push(0.6 * share);
        }
    }
    levels
}

/// Closed loops at several amplitudes, a record each: a blank period from the untouched state, then one that
/// counts.
pub(super) fn loops(draw: &mut Draw, subject: &Subject, left_out: LeftOut) -> Result<Parts> {
    let count = draw.whole(3, 5);
    let rows = draw.whole(130, 500);
    // Below 1 the input is peaked, as the field where the flux is driven in sines.
    let roundness = draw.between(0.35, 1.0);
    let smallest = draw.between(0.1, 0.35);
    let (middle, half) = subject.swing();
    let mut records = Vec::new();
    for index in 0..count {
        let place = index as f64 / (count - 1) as f64;
        let amplitude =
            half * powf(smallest, 1.0 - place) * if index + 1 < count { draw.factor(0.05) } else { 1.0 };
        let input = |row: usize| {
            let sine = sin(TAU * row as f64 / rows as f64);
            middle + amplitude * sine * (roundness + (1.0 - roundness) * powi(sine, 4))
        };
        let input: Vec<f64> = (0..2 * rows).map(input).collect();
        let mut output = subject.run_still(&input);
        output[..rows].fill(f64::NAN);
        records.push(Record::new(format!("loop {}", index + 1), vec![input], output)?);
    }
    let unseen = match left_out {
        LeftOut::Inside => draw.whole(1, count - 2),
        LeftOut::Largest => count - 1,
    };
    let test = vec![records.remove(unseen)];
    Ok(Parts { train: records, test })
}

/// Reversal curves, a record each; every second one is left out, never the first or the last.
pub(super) fn reversals(draw: &mut Draw, subject: &Subject, from: From) -> Result<Parts> {
    let curves = 2 * draw.whole(3, 5) + 1;
    let rows = draw.whole(50, 110);
    let (low, high) = subject.range;
    let nearest = draw.between(0.3, 0.5);
    let mut parts = Parts { train: Vec::new(), test: Vec::new() };
    for index in 0..curves {
        let share = nearest + (1.0 - nearest) * index as f64 / (curves - 1) as f64;
        let (turning, blank_swings) = match from {
            From::Below => (vec![low, low + share * (high - low), low], 0),
            From::Above => {
                let first = 0.5 * (low + high);
                (vec![first, low, high, high - share * (high - low), high], 3)
            }
        };
        let mut input = turning[..1].to_vec();
        for ends in turning.windows(2) {
            input.extend((1..=rows).map(|row| ends[0] + (ends[1] - ends[0]) * row as f64 / rows as f64));
        }
        let mut output = subject.run_still(&input);
        output[..blank_swings * rows].fill(f64::NAN);
        let record = Record::new(format!("curve {}", index + 1), vec![input], output)?;
        if index % 2 == 0 { &mut parts.train } else { &mut parts.test }.push(record);
    }
    Ok(parts)
}
