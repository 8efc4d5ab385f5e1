//! The paper's `K` and `P`: how wide a loop is at no speed, and how much wider at speed.
//!
//! ```text
//! K = width half way up the loop, as the speed goes to 0;   P(speed) = width(speed) - K      theory.md (10.34)
//! ```

use serde::Serialize;

use super::probe::{Probe, ProbePath, data};
use super::properties::survey;
use crate::cycles::{Cycle, cycles};
use hysid_core::error::Result;

/// The loop that is measured is the second.
const LOOPS: [f64; 6] = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0];

/// Rows beside a turning point are this share of a step away from it.
const SHARP: f64 = 1e-3;

/// Loops that fill more than this share of their box have a width.
const OPEN: f64 = 1e-3;

/// Widths of the loop over the whole trained range of the input, in its unit. The direction in which the
/// widest of the loops is passed counts as positive: a loop of negative width is passed the other way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopWidths {
    /// `K`: at a vanishing speed; `None` if a branch does not pass the middle of its loop's height.
    pub static_width: Option<f64>,
    /// `P` at several speeds, the slowest first; empty for a model that does not see the speed.
    pub dynamic: Vec<WidthAtSpeed>,
}

/// The loop at one speed of the input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WidthAtSpeed {
    /// In the unit of the input over that of time.
    pub speed: f64,
    /// Width of the loop; `None` as for `K`.
    pub width: Option<f64>,
    /// `P`: by how much it is wider than at no speed.
    pub widening: Option<f64>,
}

impl LoopWidths {
    pub(super) fn of(probe: &Probe) -> Result<Self> {
        let mut speeds = vec![probe.speeds.vanishing];
        if probe.speeds.matter() {
            speeds.extend(probe.speeds.tried());
        }
        let x = with_sharp_turns(&probe.path(&LOOPS));
        let width = |speed: &f64| -> Result<Option<f64>> {
            let data = data(vec![probe.run("loop", &x, *speed)?])?;
            Ok(cycles(&survey(&data)).last().and_then(signed_width))
        };
        let widths: Vec<Option<f64>> = speeds.iter().map(width).collect::<Result<_>>()?;
        let wider = |widest: f64, &width: &f64| if width.abs() > widest.abs() { width } else { widest };
        let widest = widths.iter().flatten().fold(0.0, wider);
        let turned = |width: f64| if widest < 0.0 { 0.0 - width } else { width };
        let widths: Vec<Option<f64>> = widths.into_iter().map(|width| width.map(turned)).collect();
        let static_width = widths[0];
        let dynamic = speeds.iter().zip(&widths).skip(1).map(|(&speed, &width)| WidthAtSpeed {
            speed,
            width,
            widening: width.zip(static_width).map(|(width, at_rest)| width - at_rest),
        });
        Ok(Self { static_width, dynamic: dynamic.collect() })
    }
}

/// A path with a row more close before and after each turning point: the rate there is that of the branch, as
/// far as a sampled path can have it, so that what it does to the width does not depend on the steps.
fn with_sharp_turns(path: &ProbePath) -> Vec<f64> {
    let mut x = Vec::with_capacity(path.x.len() + 2 * path.turns.len());
    for (row, &here) in path.x.iter().enumerate() {
        let beside = |neighbour: f64| here + SHARP * (neighbour - here);
        let turns = row > 0 && row + 1 < path.x.len() && path.turns.contains(&row);
        x.extend(turns.then(|| beside(path.x[row - 1])));
        x.push(here);
        x.extend(turns.then(|| beside(path.x[row + 1])));
    }
    x
}

/// Positive for a loop that is passed clockwise.
fn signed_width(cycle: &Cycle) -> Option<f64> {
    // An open loop without width: one of its branches stays on one side of the middle.
    let missed = cycle.width == 0.0 && cycle.area > OPEN * cycle.swing() * cycle.height();
    (!missed).then_some(if cycle.energy < 0.0 { 0.0 - cycle.width } else { cycle.width })
}
