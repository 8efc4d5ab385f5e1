//! Orientation: which way loops are passed. Index: signed over unsigned area between branches that follow each
//! other, theory.md (10.9): 1 is clockwise, as for a force that dissipates, -1 counter-clockwise, as for an
//! output that lags behind.

use hysid_core::elementary::square;

use super::branch::BranchSet;
use super::wiping_out::loops;
use super::{Evidence, Finding, Property, Verdict};
use crate::branch::Opening;

/// Below this magnitude loops cross themselves.
const CLEAR: f64 = 0.3;

/// Loops narrower than this share of their box are no loops.
const FULL: f64 = 0.003;

/// Openings over less than this share of the widest do not count.
const WIDE: f64 = 0.3;

const EXPERIMENT: &str = "run a few closed loops over the whole range of the input";

pub(crate) fn verdict(survey: &BranchSet) -> Finding {
    let widest = survey.openings.iter().map(|opening| opening.swing).fold(0.0, f64::max);
    let counts = |opening: &&Opening| {
        let open = opening.fullness() > FULL && opening.area > 5.0 * opening.deviation;
        opening.swing >= WIDE * widest && open
    };
    let open: Vec<&Opening> = survey.openings.iter().filter(counts).collect();
    let total: f64 = open.iter().map(|opening| opening.area).sum();
    let Some(largest) = open.iter().copied().max_by(|a, b| a.area.total_cmp(&b.area)) else {
        return Finding::not_testable(Property::Orientation, "no loop with an area", EXPERIMENT);
    };
    let index = open.iter().map(|opening| opening.signed).sum::<f64>() / total;
    let noise = open.iter().map(|opening| square(opening.deviation)).sum::<f64>().sqrt() / total;
    let (verdict, statement) = if index > CLEAR {
        (
            Verdict::Yes,
            "loops are traversed clockwise: energy is dissipated, as by a force over a displacement",
        )
    } else if index < -CLEAR {
        (Verdict::No, "loops are traversed counter-clockwise: the output lags behind the input")
    } else {
        (Verdict::NotTestable, "loops cross themselves (butterfly), so they have no single orientation")
    };
    Finding {
        property: Property::Orientation,
        verdict,
        index: Some(index),
        threshold: Some(CLEAR),
        noise: Some(noise),
        comparisons: open.len(),
        statement: statement.into(),
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: largest.signed / largest.area, pieces: largest.pieces(survey) }],
        picture: Some(loops(largest.curves(survey))),
    }
}
