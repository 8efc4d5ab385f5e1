//! Initial state: the state of the memory at the beginning of a record.
//!
//! ```text
//! virgin             no lead-in
//! saturated-up       h
//! saturated-down     l
//! demagnetised       c + (-1)^k A (1 - k/40),  k = 0 .. 39,   A = max(h - c, c - l)     theory.md (11.10)
//! periodic           the turning points of the record itself
//! ```
//!
//! A *free* state is found for each record together with the parameters of the model, and for a new record from its [known
//! beginning](crate::data::record::Record::with_known_beginning): the internal states of a law that has free states,
//! displacements and velocities of a model with inertia, or else the *past*, a lead-in of up to three turning points.
//!
//! A *lead-in* is what the first input did before the first row of a record: its turning points, in its unit.
//! `l` and `h` are the ends of the trained range of the first input, and `c` is its origin. A model is driven
//! from its virgin state along the lead-in and then to the input of the first row, with one step for each
//! leg. The legs are quasi-static: the rate is 0, and each takes an infinite time, so that relaxation is
//! complete. Further inputs have their values of the first row. The rows of a lead-in have no output.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::data::turning_points::turning_points;
use crate::error::MOST_TURNS;
use crate::named;
use crate::significant::Significant;

/// Half cycles of a demagnetisation.
const HALF_CYCLES: usize = 40;

/// Levels between the ends of the range after which an unknown initial state may be.
const LEVELS: usize = 8;

/// State of the memory at the beginning of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InitialState {
    /// No history.
    #[default]
    Virgin,
    /// After a visit of the upper end of the trained range.
    SaturatedUp,
    /// After a visit of the lower end of the trained range.
    SaturatedDown,
    /// After cycles about the origin whose amplitude fell to 0.
    Demagnetised,
    /// After one period: each record is one or more periods of a steady state.
    Periodic,
    /// To be found for each record, from its output.
    Unknown,
    /// Found for each record together with the parameters of the model.
    Free,
}

named!(
    InitialState, "initial state":
    Virgin = "virgin", SaturatedUp = "saturated-up", SaturatedDown = "saturated-down",
    Demagnetised = "demagnetised", Periodic = "periodic", Unknown = "unknown", Free = "free"
);

impl InitialState {
    /// The names of those that need no output to be found.
    pub fn known() -> Vec<&'static str> {
        let is_known = |state: &Self| !matches!(state, Self::Unknown | Self::Free);
        Self::ALL.into_iter().filter(is_known).map(Self::name).collect()
    }

    /// The lead-in for a trained range and an origin, in the unit of the input; `None` for one that depends on the record.
    pub fn lead_in(self, (low, high): (f64, f64), origin: f64) -> Option<Vec<f64>> {
        match self {
            Self::Virgin => Some(Vec::new()),
            Self::SaturatedUp => Some(vec![high]),
            Self::SaturatedDown => Some(vec![low]),
            Self::Demagnetised => {
                let amplitude = if high - origin >= origin - low { high - origin } else { low - origin };
                let turn = |k: usize| {
                    let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
                    origin + sign * amplitude * (1.0 - k as f64 / HALF_CYCLES as f64)
                };
                Some((0..HALF_CYCLES).map(turn).collect())
            }
            Self::Periodic | Self::Unknown | Self::Free => None,
        }
    }
}

/// The lead-in of a record that is one or more periods of a steady state, from its first input: all turning points of
/// the way over the record and back to its first row, or the last 10,000 of them.
pub fn lead_in_of_period(input: &[f64]) -> Vec<f64> {
    let mut way = input.to_vec();
    way.extend(input.first());
    let turns = turning_points(&way, 0.0);
    turns[turns.len().saturating_sub(MOST_TURNS)..].iter().map(|&row| way[row]).collect()
}

/// The lead-ins that are tried where the initial state is unknown, for this range of the first input, in its
/// unit: none, either end, and each of eight levels between after the farther end.
pub fn lead_ins_tried((low, high): (f64, f64)) -> Vec<Vec<f64>> {
    let level = |k: usize| low + (high - low) * k as f64 / (LEVELS + 1) as f64;
    let after = |k: usize| vec![if 2 * k > LEVELS { low } else { high }, level(k)];
    let levels = (1..=LEVELS).map(after);
    [Vec::new(), vec![high], vec![low]].into_iter().chain(levels).collect()
}

/// Most turning points of a past that is found.
const MOST_FOUND: usize = 3;

/// Share of the misfit that a further turning point must take away.
const WORTH_A_TURN: f64 = 0.05;

/// Halvings of the step of the search.
const HALVINGS: usize = 6;

/// The lead-in that best fits the known outputs of the first rows of a record, NaN where they are not known: up to three
/// turning points within this range of the input, or more if it continues `otherwise`. `misfit(past, rows)` is the sum of the
/// squared errors of these rows in a run after a past.
///
/// It is searched with the first two thirds of these outputs. If its error in the last third is larger than that after
/// `otherwise`, the lead-in of a record without known outputs, the past compensated an error of the model, and `otherwise` is
/// returned. If not, it is refined with all of them.
pub fn found_past(
    (low, high): (f64, f64),
    known: &[f64],
    otherwise: &[f64],
    mut misfit: impl FnMut(&[f64], Range<usize>) -> f64,
) -> Vec<f64> {
    if !(high - low).is_finite() {
        return otherwise.to_vec();
    }
    let rows = known.len();
    let measured: Vec<usize> = (0..rows).filter(|&row| !known[row].is_nan()).collect();
    let first = measured.get((2 * measured.len()).div_ceil(3)).copied().unwrap_or(rows);
    let tried = lead_ins_tried((low, high)).into_iter().chain([otherwise.to_vec()]);
    let found = longer_past((low, high), tried, |past| misfit(past, 0..first));
    if misfit(&found, first..rows) > misfit(otherwise, first..rows) {
        return otherwise.to_vec();
    }
    longer_past((low, high), [found], |past| misfit(past, 0..rows))
}

/// The past with the lowest misfit: the best of those given, moved, and with further turning points.
fn longer_past(
    (low, high): (f64, f64),
    given: impl IntoIterator<Item = Vec<f64>>,
    mut misfit: impl FnMut(&[f64]) -> f64,
) -> Vec<f64> {
    let mut best = Vec::new();
    let mut least = f64::INFINITY;
    for past in given {
        let found = misfit(&past);
        if found < least {
            (best, least) = (past, found);
        }
    }
    let step = (high - low) / (LEVELS + 1) as f64;
    descend(&mut best, &mut least, (low, high), step, &mut misfit);
    while best.len() < MOST_FOUND {
        let (mut longer, mut of_longer) = (Vec::new(), f64::INFINITY);
        for k in 1..=LEVELS {
            let past = [&best[..], &[low + step * k as f64]].concat();
            let found = misfit(&past);
            if found < of_longer {
                (longer, of_longer) = (past, found);
            }
        }
        descend(&mut longer, &mut of_longer, (low, high), 0.5 * step, &mut misfit);
        if of_longer >= (1.0 - WORTH_A_TURN) * least {
            break;
        }
        (best, least) = (longer, of_longer);
    }
    best
}

/// Moves one turning point at a time in ever smaller steps, as long as the misfit falls.
fn descend(
    past: &mut Vec<f64>,
    least: &mut f64,
    (low, high): (f64, f64),
    mut step: f64,
    misfit: &mut impl FnMut(&[f64]) -> f64,
) {
    for _ in 0..HALVINGS {
        step *= 0.5;
        for turn in 0..past.len() {
            for by in [step, -step] {
                let mut moved = past.clone();
                moved[turn] = (moved[turn] + by).clamp(low, high);
                let found = misfit(&moved);
                if found < *least {
                    (*past, *least) = (moved, found);
                    break;
                }
            }
        }
    }
}

/// A lead-in in a few words, for this trained range of the first input.
pub fn in_words(lead_in: &[f64], (low, high): (f64, f64)) -> String {
    let shown = |x: &f64| format!("{:.3}", Significant(*x));
    match lead_in {
        [] => InitialState::Virgin.name().into(),
        [end] if *end == high => InitialState::SaturatedUp.name().into(),
        [end] if *end == low => InitialState::SaturatedDown.name().into(),
        turns if turns.len() == HALF_CYCLES => InitialState::Demagnetised.name().into(),
        turns => format!("after {}", turns.iter().map(shown).collect::<Vec<String>>().join(", then ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_the_lead_in_of_its_definition() {
        let range = (-1.0, 3.0);
        let lead_in = |state: InitialState| state.lead_in(range, 0.5).unwrap();
        assert!(lead_in(InitialState::Virgin).is_empty());
        assert_eq!(lead_in(InitialState::SaturatedUp), [3.0]);
        assert_eq!(lead_in(InitialState::SaturatedDown), [-1.0]);
        assert_eq!(InitialState::Unknown.lead_in(range, 0.5), None);
        let turns = lead_in(InitialState::Demagnetised);
        assert_eq!((turns.len(), turns[0], turns[1]), (40, 3.0, 0.5 - 2.5 * 39.0 / 40.0));
        let falls = |pair: &[f64]| (pair[1] - 0.5) * (pair[0] - 0.5) < 0.0;
        assert!(turns.windows(2).all(falls));
        let gap = 2.5 / 40.0;
        let even = |pair: &[f64]| ((pair[0] - 0.5).abs() - (pair[1] - 0.5).abs() - gap).abs() < 1e-12;
        assert!(turns.windows(2).all(even));
        assert!(((turns[39] - 0.5).abs() - gap).abs() < 1e-12);
        // The larger end may be the lower one.
        assert_eq!(InitialState::Demagnetised.lead_in(range, 2.0).unwrap()[0], -1.0);
    }

    #[test]
    fn a_period_is_gone_round_before_the_first_row() {
        assert_eq!(lead_in_of_period(&[0.0, 1.0, 2.0, 1.0, -2.0, -1.0, -0.5]), [2.0, -2.0]);
        // The way back to the first row may turn in the last one.
        assert_eq!(lead_in_of_period(&[0.0, 3.0, 1.0, 2.0]), [3.0, 1.0, 2.0]);
        assert_eq!(lead_in_of_period(&[2.0, -2.0, 2.0]), [-2.0]);
        assert!(lead_in_of_period(&[]).is_empty() && lead_in_of_period(&[1.0, 1.0]).is_empty());
        let many: Vec<f64> = (0..20_011).map(|row| f64::from(row % 2)).collect();
        assert_eq!(lead_in_of_period(&many).len(), MOST_TURNS);
    }

    #[test]
    fn a_level_comes_after_the_farther_end() {
        let tried = lead_ins_tried((0.0, 9.0));
        assert_eq!(tried.len(), 11);
        assert_eq!(tried[..3], [vec![], vec![9.0], vec![0.0]]);
        assert_eq!(
            (&tried[3][..], &tried[6][..], &tried[7][..]),
            (&[9.0, 1.0][..], &[9.0, 4.0][..], &[0.0, 5.0][..])
        );
        assert_eq!(in_words(&tried[1], (0.0, 9.0)), "saturated-up");
        assert_eq!(in_words(&tried[2], (0.0, 9.0)), "saturated-down");
        assert_eq!(in_words(&tried[3], (0.0, 9.0)), "after 9, then 1");
    }
}
