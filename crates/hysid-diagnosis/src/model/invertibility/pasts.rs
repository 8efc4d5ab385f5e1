//! Pasts of a model: paths of the input, and the moments on them at which the next step is examined.

use hysid_core::elementary::powi;
use hysid_core::error::Result;
use hysid_core::model::Stepper;

use crate::model::probe::{Probe, STEPS, times};
use crate::model::properties::{PROTOCOL, SHIFTED, WHOLE_LOOPS, repeated_loops};

const MOMENTS: usize = 24;
const LEAST_MOMENTS: usize = 4;

/// Turning points of the path with random reversals.
const RANDOM_REVERSALS: usize = 40;

/// Loops of the path along which they shrink, and each as a share of the one before.
const SHRINKING: (i32, f64) = (14, 0.8);

/// Turning points that describe a past.
const DESCRIBED: usize = 2;

/// A state of the model, with the path that led to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ModelPast {
    pub path: &'static str,
    /// Row of the path that was the last sample, counted from 0; `None` before the first sample.
    pub row: Option<usize>,
    /// Time of the last sample.
    pub time: f64,
    /// The first input of the last sample; where the memory is virgin before the first.
    pub input: f64,
    /// The latest turning points of the input, the last one at the end.
    pub turning_points: Vec<f64>,
}

/// A path of the input, in halves of the trained range.
pub(super) struct PastPath {
    name: &'static str,
    turning: Vec<f64>,
}

/// The paths. `worn` takes repeated loops, which wear a model out, in place of a few.
pub(super) fn ways(worn: bool) -> Vec<PastPath> {
    let (count, share) = SHRINKING;
    let shrinking = (0..2 * count).map(|turn| powi(-1.0, turn) * powi(share, turn / 2));
    let loops = if worn { repeated_loops() } else { WHOLE_LOOPS.to_vec() };
    vec![
        PastPath { name: "protocol", turning: PROTOCOL.to_vec() },
        PastPath { name: "shifted loops", turning: SHIFTED.to_vec() },
        PastPath { name: if worn { "repeated loops" } else { "whole loops" }, turning: loops },
        PastPath { name: "shrinking loops", turning: [0.0].into_iter().chain(shrinking).collect() },
        PastPath { name: "random reversals", turning: random_reversals() },
    ]
}

/// The same numbers on every machine: even numbers from a linear congruence.
fn random_reversals() -> Vec<f64> {
    let mut state: u64 = 11;
    let mut even = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    [0.0].into_iter().chain((0..RANDOM_REVERSALS).map(|_| 2.0 * even() - 1.0)).collect()
}

/// Drives the model along a path, from its initial state, and stops at moments. There `examine` may make trial steps.
pub(super) fn drive<'m>(
    probe: &Probe<'m>,
    stepper: &mut Stepper<'m>,
    way: &PastPath,
    speed: f64,
    examine: &mut impl FnMut(&mut Stepper<'m>, ModelPast) -> Result<()>,
) -> Result<()> {
    let path = probe.path(&way.turning);
    let time = times(&path.x, speed);
    let count = (MOMENTS * probe.steps as usize / STEPS as usize).max(LEAST_MOMENTS);
    let moments = moments(&path.turns, count);
    let mut moments = moments.iter().peekable();
    stepper.reset();
    let mut inputs = probe.inputs(path.x[0]);
    for (row, (&x, &time)) in path.x.iter().zip(&time).enumerate() {
        inputs[0] = x;
        stepper.step(&inputs, time, None)?;
        if moments.next_if_eq(&&row).is_some() {
            let before: Vec<f64> =
                path.turns.iter().filter(|&&turn| turn <= row).map(|&turn| path.x[turn]).collect();
            let turning_points = before[before.len().saturating_sub(DESCRIBED)..].to_vec();
            examine(stepper, ModelPast { path: way.name, row: Some(row), time, input: x, turning_points })?;
            stepper.revert();
        }
        if moments.peek().is_none() {
            break;
        }
    }
    Ok(())
}

/// Rows at turning points and on the way between them, evenly chosen.
fn moments(turns: &[usize], most: usize) -> Vec<usize> {
    // The golden section falls on other parts of each way.
    let share = |leg: usize| (0.618_034 * (leg + 1) as f64).fract();
    let candidates: Vec<usize> = turns
        .windows(2)
        .enumerate()
        .flat_map(|(leg, ends)| [ends[0] + (share(leg) * (ends[1] - ends[0]) as f64) as usize, ends[1]])
        .collect();
    let count = most.min(candidates.len());
    let mut rows: Vec<usize> =
        (0..count).map(|k| candidates[(2 * k + 1) * candidates.len() / (2 * count)]).collect();
    rows.dedup();
    rows
}
