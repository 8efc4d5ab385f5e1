//! Which pieces a drive is made of: first those that make a property testable, then greedily those that gain most.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::candidates::{Candidate, candidates};
use super::coverage::CLASSES;
use super::draft::Draft;
use super::path::Leg;
use super::segment::Kind;
use super::survey::Survey;
use crate::error::Result;
use hysid_diagnosis::Verdict;

/// Shares of the rows that a test of one property may take, and all of them together.
const OF_A_TEST: f64 = 0.25;
const OF_ALL_TESTS: f64 = 0.4;

/// Amplitudes of such a test, as shares of half the range: the largest that fits.
const AMPLITUDES: [f64; 5] = [0.6, 0.45, 0.3, 0.2, 0.12];

/// Share of the rows of a hold, and the fewest.
const HOLD: f64 = 0.03;
const FEWEST_ROWS_OF_A_HOLD: usize = 8;

/// Places of the holds in the range.
const HOLDS: [f64; 2] = [0.75, 0.3];

/// Where the specimen may deteriorate, the reach of the input at first, and the share of the rows until it is the
/// whole range: large swings would spoil what small ones show.
const FIRST_REACH: f64 = 0.35;
const WHOLE_REACH_AT: f64 = 0.6;

/// Fills a draft.
pub(super) fn fill(draft: &mut Draft<'_>, survey: &Survey, seed: u64) -> Result<()> {
    let timed = draft.path.limits.step.is_some();
    let speed_matters = timed && survey.rate_dependence != Verdict::No;
    let spares = survey.deterioration == Verdict::Yes
        || survey.is_structure && survey.deterioration == Verdict::NotTestable;
    let (low, high) = draft.path.limits.range;
    if survey.unknown_start && !spares {
        add_if_it_fits(draft, Kind::Conditioning, &swings(&[high, low], 1.0))?;
    }
    if speed_matters && survey.rate_dependence == Verdict::NotTestable {
        // More than twice as fast tells, and the slowest would take most of the rows.
        let slow = CLASSES[1];
        test_of_a_loop(draft, Kind::TwoSpeeds, |up, down| {
            [swings(&[up, down, up], 1.0), swings(&[down, up], slow)].concat()
        })?;
    }
    if survey.deterioration == Verdict::NotTestable {
        test_of_a_loop(draft, Kind::RepeatedLoop, |up, down| swings(&[up, down, up, down, up], 1.0))?;
    }
    if speed_matters && survey.no_hold {
        let rows = (HOLD * draft.path.limits.rows as f64) as usize;
        for place in HOLDS {
            let swing = Leg::Swing { to: low + place * (high - low), speed: 1.0 };
            add_if_it_fits(draft, Kind::Hold, &[swing, Leg::Hold(rows.max(FEWEST_ROWS_OF_A_HOLD))])?;
        }
    }
    let classes = if speed_matters { &CLASSES[..] } else { &CLASSES[..1] };
    greedily(draft, classes, spares, seed)
}

fn swings(turns: &[f64], speed: f64) -> Vec<Leg> {
    turns.iter().map(|&to| Leg::Swing { to, speed }).collect()
}

/// True if a test may still be added: it leaves rows for the rest.
fn may_test(draft: &Draft<'_>, legs: &[Leg]) -> bool {
    let (all, rows) = (draft.path.limits.rows as f64, draft.path.rows_of(draft.now(), legs));
    let together = (draft.inputs.len() + rows) as f64;
    rows as f64 <= OF_A_TEST * all && together <= OF_ALL_TESTS * all && draft.fits(legs)
}

fn add_if_it_fits(draft: &mut Draft<'_>, kind: Kind, legs: &[Leg]) -> Result<()> {
    if may_test(draft, legs) { draft.add(kind, legs) } else { Ok(()) }
}

/// Adds a test of a loop about the middle, as large as fits.
fn test_of_a_loop(draft: &mut Draft<'_>, kind: Kind, legs: impl Fn(f64, f64) -> Vec<Leg>) -> Result<()> {
    let limits = draft.path.limits;
    let (middle, half) = (0.5 * (limits.range.0 + limits.range.1), 0.5 * limits.width());
    let all = AMPLITUDES.map(|share| legs(middle + share * half, middle - share * half));
    match all.iter().find(|legs| may_test(draft, legs)) {
        Some(legs) => draft.add(kind, legs),
        None => Ok(()),
    }
}

/// Adds the piece that gains most per row, again and again. The rows are divided evenly among speeds.
fn greedily(draft: &mut Draft<'_>, classes: &[f64], spares: bool, seed: u64) -> Result<()> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut rows = vec![0; classes.len()];
    loop {
        let range = reach(draft, spares);
        let mut order: Vec<usize> = (0..classes.len()).collect();
        order.sort_by_key(|&class| rows[class]);
        let fitting = order.into_iter().find_map(|class| {
            let mut all = candidates(draft.now(), range, classes[class], &mut generator);
            all.retain(|candidate| draft.fits(&candidate.legs));
            (!all.is_empty()).then_some((class, all))
        });
        let Some((class, all)) = fitting else { return Ok(()) };
        let before = draft.inputs.len();
        let Candidate { kind, legs } = best(draft, all)?;
        draft.add(kind, &legs)?;
        rows[class] += draft.inputs.len() - before;
    }
}

/// The candidate that gains most; of equal ones the first.
fn best(draft: &mut Draft<'_>, mut all: Vec<Candidate>) -> Result<Candidate> {
    let legs: Vec<Vec<Leg>> = all.iter().map(|candidate| candidate.legs.clone()).collect();
    let worth = draft.worth(&legs)?;
    let mut best = 0;
    for (place, one) in worth.iter().enumerate() {
        if one.gain > worth[best].gain {
            best = place;
        }
    }
    Ok(all.swap_remove(best))
}

/// The range of the input that may be visited now.
fn reach(draft: &Draft<'_>, spares: bool) -> (f64, f64) {
    let limits = draft.path.limits;
    let (low, high) = limits.range;
    if !spares {
        return (low, high);
    }
    let done = draft.inputs.len() as f64 / (WHOLE_REACH_AT * limits.rows as f64);
    let share = (FIRST_REACH + (1.0 - FIRST_REACH) * done).min(1.0);
    let towards = |end: f64| if share < 1.0 { limits.start + share * (end - limits.start) } else { end };
    (towards(low), towards(high))
}
