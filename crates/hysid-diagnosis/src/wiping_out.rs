//! Wiping-out, or return-point memory: an excursion of the input that comes back to where it left a branch
//! leaves no trace. Index: the gap left by a closed excursion, over the range of the output.
//!
//! `|y(return to x_a) - y(x_a)| / R`                                                 theory.md (10.4)

use hysid_core::elementary::hypot;

use super::branch::{Branch, BranchSet, Closing};
use super::comparison::{Comparison, GAP, NARROW_BOUND, judge};
use super::{Evidence, Finding, Picture, Property, Verdict};

/// A gap that matters, as a share of the range of the output.
pub(super) const EFFECT: f64 = 0.01;

/// Excursions shorter than this share of the range of the input say nothing.
const SHORTEST: f64 = 0.05;

const EXPERIMENT: &str = "on the way up and on the way down, reverse the input by a third of the range, \
                          return past the turning point and continue to the end; at least two such \
                          excursions";

pub(crate) fn verdict(survey: &BranchSet, equal_speed: bool) -> Finding {
    let mut comparisons = Vec::new();
    for (index, branch) in survey.branches.iter().enumerate() {
        for closing in &branch.closes {
            let arrived = &survey.branches[closing.arrived];
            if !equal_speed || survey.similar_speed_at(branch, arrived, closing.x) {
                comparisons.extend(gap(survey, index, closing));
            }
        }
    }
    if comparisons.len() < 2 {
        return Finding::not_testable(
            Property::WipingOut,
            format!("{} closed excursions of the input with an output; 2 are needed", comparisons.len()),
            EXPERIMENT,
        );
    }
    let judgement = judge(&comparisons, EFFECT, NARROW_BOUND).expect("there are comparisons");
    let percent = 100.0 * judgement.index;
    let statement = match judgement.verdict {
        Verdict::Yes => format!("excursions close: the largest gap is {percent:.2} % of the output's range"),
        Verdict::No => format!("an excursion leaves a gap of {percent:.1} % of the output's range"),
        Verdict::NotTestable => judgement.doubt.into(),
    };
    survey.finding(Property::WipingOut, &judgement, &comparisons, statement, EXPERIMENT)
}

/// The gap at the end of an excursion.
fn gap(survey: &BranchSet, returning: usize, closing: &Closing) -> Option<Comparison> {
    let back = &survey.branches[returning];
    let arriving = &survey.branches[closing.arrived];
    let leaving = &survey.branches[closing.arrived + 1];
    if (back.from - closing.x).abs() < SHORTEST * survey.width() {
        return None;
    }
    // A branch that turns just before it reaches the point is compared where it turns.
    let x = if back.rises() { closing.x.min(back.to) } else { closing.x.max(back.to) };
    let first = arriving.curve.at(x)?;
    let second = back.curve.at(x)?;
    let (before, deviation) = match leaving.curve.at(x) {
        // Both branches know the output at their common point; away from it they differ.
        Some(other) if x == closing.x => {
            (0.5 * (first.y + other.y), 0.5 * hypot(first.deviation, other.deviation))
        }
        _ => (first.y, first.deviation),
    };
    let height = survey.height();
    let rows = |branch: &Branch| survey.piece(branch);
    let apart = survey.rows_between(arriving, back, x);
    Some(Comparison {
        index: (second.y - before).abs() / height,
        deviation: hypot(hypot(deviation, second.deviation), survey.wander(apart)) / height,
        bend: (first.bend + second.bend) / height,
        freedom: GAP,
        other: survey.turn_error(leaving) / height,
        pieces: vec![rows(arriving), rows(back)],
        curves: vec![
            survey.curve("before", arriving),
            survey.curve("excursion", leaving),
            survey.curve("return", back),
        ],
    })
}

/// Axes of a picture of the output over the input.
pub(super) fn loops(curves: Vec<super::PictureCurve>) -> Picture {
    Picture { x_label: String::new(), y_label: String::new(), curves }
}

/// Experiment where a model leaves a doubt: its own probes have no noise.
pub(super) const OF_A_MODEL: &str =
    "diagnose the data of the fit, or fit the model to a record with loops over a larger range of the input";

impl BranchSet<'_> {
    /// A finding from comparisons of branches.
    pub(super) fn finding(
        &self,
        property: Property,
        judgement: &super::comparison::PropertyResult,
        comparisons: &[Comparison],
        statement: String,
        experiment: &str,
    ) -> Finding {
        const SHOWN: usize = 5;
        let evidence = judgement.order.iter().take(SHOWN).map(|&place| Evidence {
            index: comparisons[place].index,
            pieces: comparisons[place].pieces.clone(),
        });
        Finding {
            property,
            verdict: judgement.verdict,
            index: Some(judgement.index),
            threshold: Some(judgement.threshold),
            noise: Some(judgement.noise),
            comparisons: judgement.count,
            statement,
            experiment: (judgement.verdict == Verdict::NotTestable).then(|| match self.turns_on_rows {
                true => OF_A_MODEL.into(),
                false => format!("measure with less noise, or repeat and average; {experiment}"),
            }),
            evidence: evidence.collect(),
            picture: Some(loops(comparisons[judgement.order[0]].curves.clone())),
        }
    }
}
