//! Orientation: which way loops are passed. Index: signed over unsigned area of all loops, theory.md (10.9):
//! 1 is clockwise, as for a force that dissipates, -1 counter-clockwise, as for an output that lags behind.

use super::Piece;
use super::branch::Survey;
use super::wiping_out::loops;
use super::{Cycle, Evidence, Finding, Property, Verdict};

/// Below this magnitude loops cross themselves, or there are none.
const CLEAR: f64 = 0.3;

/// Loops narrower than this share of their box are no loops.
const FULL: f64 = 0.003;

const EXPERIMENT: &str = "run a few closed loops over the whole range of the input";

/// Tests which way loops are passed.
pub(crate) fn test(survey: &Survey, cycles: &[Cycle]) -> Finding {
    let open = |cycle: &&Cycle| {
        let bounds = cycle.swing() * cycle.height();
        cycle.area > FULL * bounds && cycle.area > 5.0 * cycle.energy_deviation
    };
    let loops_found: Vec<&Cycle> = cycles.iter().filter(open).collect();
    let total: f64 = loops_found.iter().map(|cycle| cycle.area).sum();
    let Some(largest) = loops_found.iter().copied().max_by(|a, b| a.area.total_cmp(&b.area)) else {
        return Finding::not_testable(Property::Orientation, "no closed loop with an area", EXPERIMENT);
    };
    let index = loops_found.iter().map(|cycle| cycle.energy).sum::<f64>() / total;
    let noise = loops_found.iter().map(|cycle| cycle.energy_deviation.powi(2)).sum::<f64>().sqrt() / total;
    let (verdict, statement) = if index > CLEAR {
        (
            Verdict::Yes,
            "loops are passed clockwise: the output dissipates, as a force does over a displacement",
        )
    } else if index < -CLEAR {
        (Verdict::No, "loops are passed counter-clockwise: the output lags behind the input")
    } else {
        (Verdict::NotTestable, "loops cross themselves (butterfly), so that they have no one orientation")
    };
    let (a, b) = largest.branches;
    Finding {
        property: Property::Orientation,
        verdict,
        index: Some(index),
        threshold: Some(CLEAR),
        noise: Some(noise),
        comparisons: loops_found.len(),
        statement: statement.into(),
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: largest.energy / largest.area, pieces: vec![piece(largest)] }],
        picture: Some(loops(vec![
            survey.curve("there", &survey.branches[a]),
            survey.curve("back", &survey.branches[b]),
        ])),
    }
}

/// The rows of a cycle.
pub(super) fn piece(cycle: &Cycle) -> Piece {
    Piece { record: cycle.record.clone(), rows: cycle.rows }
}
