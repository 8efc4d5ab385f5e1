//! Rate dependence: does the output along the same input path change with the speed? Index: how far
//! branches of equal course and different speed lie apart, over the range of the output.
//!
//! `rms(y_fast(x) - y_slow(x)) / R`                                                 theory.md (10.13)
//!
//! An output that lags behind by a fixed time also differs with the speed. Where shifting the output by
//! one time makes all speeds agree, that time is a delay, and the law behind it does not depend on the rate.

pub mod delay;
mod varying_speed;

use std::collections::HashMap;

use super::branch::{Branch, BranchSet, CurveReading};
use super::comparison::{BOUND, Comparison, SHAPE, judge};
use super::{Finding, Property, Verdict};
use delay::Delay;
use hysid_core::elementary::{hypot, square};
use varying_speed::Remainders;

/// A difference that matters, as a share of the range of the output.
pub(super) const EFFECT: f64 = 0.01;

/// Speeds that differ by less than this factor say nothing.
const DIFFERENT: f64 = 1.3;

/// Speeds must differ by this factor for agreement to mean something.
const FAR_APART: f64 = 2.0;

/// Speeds within this factor are taken together.
const TOGETHER: f64 = 1.15;

/// A delay that explains a difference leaves less than this share of it.
const EXPLAINED: f64 = 0.4;

/// A delay that leaves less than this share explains all of it; a rate-dependent law often looks like one.
const ALL: f64 = 0.15;

/// Ratio of mean square difference to noise from which on branches of one speed change with time.
const NOT_NOISE: f64 = 2.0;

/// Factor by which wear between the sets may be faster than within them.
const FASTER: f64 = 1.5;

/// Factor by which noise in the wear must be smaller than what it is to explain.
const CLEARLY: f64 = 3.0;

/// Number of branches in the first two cycles of a record, and the share of the output's range by which they may differ
/// from later ones.
const FIRST_BRANCHES: usize = 4;
const SETTLES: f64 = 0.01;

/// Rows by which an input may be late.
const FEW_ROWS: f64 = 3.0;

/// Branches shorter than this share of the input's range.
const SHORTEST: f64 = 0.1;

/// Branches of one course and speed at most.
const MOST: usize = 8;

/// The rate helps if the law with it leaves less than `HELPFUL` of what laws without it leave. It does not help if it
/// explains at most `UNHELPFUL` of the relevant size.
const HELPFUL: f64 = 0.4;
const UNHELPFUL: f64 = 0.3;

/// In multiples of the relevant size: a law that leaves more than `MATTERS` does not predict the record; one that leaves
/// at most `PREDICTS` does.
const MATTERS: f64 = 4.0;
const PREDICTS: f64 = 1.2;

/// Places along a branch.
const PLACES: usize = 40;

const EXPERIMENT: &str = "run the same loop at three speeds, the slowest ten times slower than the fastest";

/// Branches of one course: a slow and a fast set.
pub(crate) struct SpeedPair<'b> {
    pub slow: Vec<&'b Branch>,
    pub fast: Vec<&'b Branch>,
    /// For each set of one branch: this branch and the next of the same course.
    next: Vec<(&'b Branch, &'b Branch)>,
    /// Inputs that all go through.
    pub from: f64,
    pub to: f64,
}

impl SpeedPair<'_> {
    fn ratio(&self) -> f64 {
        let mean = |set: &[&Branch]| set.iter().filter_map(|b| b.speed).sum::<f64>() / set.len() as f64;
        mean(&self.fast) / mean(&self.slow)
    }

    /// By how much the output changes between the two sets if it goes on changing as it does within them, from branch
    /// to branch: wear, drift, or a specimen that settles. Root mean square along the way, without the noise, where it is
    /// clear; and what noise alone makes of it.
    fn wear(&self, survey: &BranchSet) -> (f64, f64) {
        let number = |branch: &Branch| {
            survey.branches.partition_point(|b| (b.record, b.rows.start) < (branch.record, branch.rows.start))
                as f64
        };
        let middle =
            |set: &[&Branch]| set.iter().map(|branch| number(branch)).sum::<f64>() / set.len() as f64;
        let apart = (middle(&self.fast) - middle(&self.slow)).abs();
        let of_set = |set: &[&Branch]| -> Option<(f64, f64)> {
            let (latest, earliest) = (set.first()?, set.last()?);
            let times = apart / (number(latest) - number(earliest)).max(1.0);
            let (mut changes, mut noise, mut places) = (0.0, 0.0, 0.0);
            for x in self.places() {
                let (late, early) = (latest.curve.at(x)?, earliest.curve.at(x)?);
                changes += square(late.y - early.y);
                noise += square(late.deviation) + square(early.deviation);
                places += 1.0;
            }
            let clear = changes > NOT_NOISE * noise;
            let wear = if clear { times * ((changes - noise) / places).sqrt() } else { 0.0 };
            Some((wear, times * (noise / places).sqrt()))
        };
        [&self.slow, &self.fast]
            .into_iter()
            .filter(|set| set.len() > 1)
            .filter_map(|set| of_set(set))
            .fold((0.0, 0.0), |(wear, noise), (w, n)| (f64::max(wear, w), f64::max(noise, n)))
    }

    /// By how much the output of a slow or fast branch that was not repeated differs from the next of its course,
    /// whose speed is another: a specimen that settles changes most at the beginning. Root mean square along the way.
    fn settling(&self) -> f64 {
        let between = |(alone, next): (&Branch, &Branch)| -> Option<f64> {
            let squares = self.places().map(|x| Some(square(alone.curve.at(x)?.y - next.curve.at(x)?.y)));
            let squares: Vec<f64> = squares.collect::<Option<_>>()?;
            Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        self.next.iter().filter_map(|pair| between(*pair)).fold(0.0, f64::max)
    }

    /// True if one of the sets is a branch of the first cycles of its record, run only once, and the other set was run
    /// later. At the beginning of records of their own, specimens settle alike.
    fn may_settle(&self, survey: &BranchSet) -> bool {
        if self.slow.iter().all(|slow| self.fast.iter().all(|fast| slow.record != fast.record)) {
            return false;
        }
        let is_first = |branch: &Branch| {
            survey.of_record(branch.record).iter().take(FIRST_BRANCHES).any(|b| b.rows == branch.rows)
        };
        [&self.slow, &self.fast].into_iter().any(|set| set.len() == 1 && is_first(set[0]))
    }

    /// True if one speed was run after the other, without repetitions that would show how the specimen wears, and the
    /// later branches are the lower ones.
    fn may_be_wear(&self, survey: &BranchSet) -> bool {
        let begins = |branch: &Branch| (branch.record, branch.rows.start);
        let last = |set: &[&Branch]| set.iter().map(|branch| begins(branch)).max();
        let first = |set: &[&Branch]| set.iter().map(|branch| begins(branch)).min();
        let (earlier, later) = if last(&self.slow) < first(&self.fast) {
            (&self.slow, &self.fast)
        } else if last(&self.fast) < first(&self.slow) {
            (&self.fast, &self.slow)
        } else {
            return false;
        };
        let height = |set: &[&Branch]| -> f64 {
            let of = |branch: &&Branch| match (branch.curve.at(self.from), branch.curve.at(self.to)) {
                (Some(from), Some(to)) => (to.y - from.y).abs(),
                _ => f64::NAN,
            };
            set.iter().map(of).sum::<f64>() / set.len() as f64
        };
        let lower = height(earlier) - height(later);
        let known = earlier.len() > 1 && later.len() > 1 && lower > CLEARLY * self.wear(survey).1;
        !known && lower > EFFECT * survey.height()
    }

    /// Inputs along the way.
    pub fn places(&self) -> impl Iterator<Item = f64> + use<'_> {
        (1..PLACES).map(|place| self.from + (self.to - self.from) * place as f64 / PLACES as f64)
    }
}

/// Tests for rate dependence; with the delay that explains what looks like it, if one does.
pub(crate) fn verdict(survey: &BranchSet) -> (Finding, Option<Delay>) {
    if !survey.data.has_time() {
        let statement = "the data have no time stamps";
        return (Finding::not_testable(Property::RateDependence, statement, EXPERIMENT), None);
    }
    let courses = courses(survey);
    let comparisons: Vec<Comparison> = courses.iter().filter_map(|speeds| compare(survey, speeds)).collect();
    let Some(mut judgement) = judge(&comparisons, EFFECT, BOUND) else {
        return (of_varying_speed(survey), None);
    };
    let ratio = courses.iter().map(SpeedPair::ratio).fold(0.0, f64::max);
    let percent = 100.0 * judgement.index;
    // The comparisons say whether the outputs agree.
    let agree = judgement.verdict;
    let delay = if agree == Verdict::No { delay::between_speeds(survey, &courses) } else { None };
    // An output that leads its input by more than a few rows is not late: it follows the speed.
    let longest_lead = FEW_ROWS * survey.time_step();
    let agrees = |delay: &Delay| {
        delay.time > -longest_lead
            && delay.remains <= EFFECT.max(0.7 * judgement.noise)
            && delay.remains < EXPLAINED * judgement.index
    };
    let explained = delay.filter(agrees);
    let all_explained = |delay: &Delay| {
        delay.time > 0.0 && delay.remains < ALL.max(0.7 * judgement.noise / judgement.index) * judgement.index
    };
    let statement = match (agree, explained) {
        (Verdict::No, Some(delay)) if !all_explained(&delay) => format!(
            "outputs differ by {percent:.1} % of their range at {ratio:.1} times the speed, and by {:.2} % when shifted \
             by {:.4} in time: a delay, or a law that depends on the rate",
            100.0 * delay.remains,
            delay.time
        ),
        (Verdict::No, Some(delay)) => format!(
            "outputs differ by {percent:.1} % of their range at {ratio:.1} times the speed, and agree within {:.2} % when \
             shifted by {:.4} in time: a delay, not a rate-dependent law",
            100.0 * delay.remains,
            delay.time
        ),
        (Verdict::No, None) => {
            format!("at {ratio:.1} times the speed the output differs by {percent:.1} % of its range (rms)")
        }
        (Verdict::Yes, _) if ratio < FAR_APART => {
            format!("outputs agree, but the speeds differ only by a factor of {ratio:.1}")
        }
        (Verdict::Yes, _) => format!(
            "at {ratio:.1} times the speed the output is the same, within {percent:.2} % of its range"
        ),
        (Verdict::NotTestable, _) => judgement.doubt.into(),
    };
    let may_be_wear = !courses.is_empty() && courses.iter().all(|speeds| speeds.may_be_wear(survey));
    let statement = if agree == Verdict::No && explained.is_none() && may_be_wear {
        format!(
            "{statement}, but one speed was run after the other, and the later output is smaller: wear would look the same"
        )
    } else {
        statement
    };
    judgement.verdict = match (agree, explained) {
        (Verdict::No, None) if may_be_wear => Verdict::NotTestable,
        (Verdict::No, Some(delay)) if !all_explained(&delay) => Verdict::NotTestable,
        (Verdict::No, Some(_)) => Verdict::No,
        (Verdict::No, None) => Verdict::Yes,
        (Verdict::Yes, _) if ratio >= FAR_APART => Verdict::No,
        _ => Verdict::NotTestable,
    };
    (survey.finding(Property::RateDependence, &judgement, &comparisons, statement, EXPERIMENT), explained)
}

/// Compares laws with and without the rate, where no path was run at two speeds.
fn of_varying_speed(survey: &BranchSet) -> Finding {
    let statement = "no input path was run at two speeds";
    let untold = Finding::not_testable(Property::RateDependence, statement, EXPERIMENT);
    let Some(remainders) = varying_speed::remainders(survey).filter(|r| r.ratio >= FAR_APART) else {
        return untold;
    };
    let Remainders { without, with_rate, noise, .. } = remainders;
    let clear = |remainder: f64| (remainder * remainder - noise * noise).max(0.0).sqrt();
    let explained = (without * without - with_rate * with_rate).max(0.0).sqrt();
    let matters = clear(without) > MATTERS * EFFECT && remainders.everywhere;
    let alone = remainders.with_more_stops.min(remainders.with_a_lag);
    let verdict = if clear(without) <= EFFECT && explained <= UNHELPFUL * EFFECT {
        Verdict::No
    } else if matters && clear(with_rate) <= (HELPFUL * clear(alone)).min(PREDICTS * EFFECT) {
        Verdict::Yes
    } else {
        return untold;
    };
    let statement = format!(
        "no input path was run at two speeds, but speeds differ by a factor of {:.1}: a law without the rate predicts \
         branches that it was not fitted to within {:.2} % of the output's range, one with the rate within {:.2} %",
        remainders.ratio,
        100.0 * without,
        100.0 * with_rate
    );
    Finding {
        verdict,
        index: Some(explained),
        threshold: Some(EFFECT),
        noise: Some(noise),
        statement,
        experiment: None,
        ..untold
    }
}

/// Branches of the same course that are gone at different speeds: same ends, same direction, same turning
/// point before.
pub(crate) fn courses<'s>(survey: &'s BranchSet) -> Vec<SpeedPair<'s>> {
    let tolerance = survey.same_input();
    let cell = |x: f64| (x / (2.0 * tolerance)).round() as i64;
    let mut groups: HashMap<(i64, i64, Option<i64>), Vec<&Branch>> = HashMap::new();
    let mut order = Vec::new();
    for branch in &survey.branches {
        if branch.speed.is_none() || branch.curve.is_empty() || branch.travel() < SHORTEST * survey.width() {
            continue;
        }
        let before = branch.beneath.iter().rev().nth(1).map(|&x| cell(x));
        let key = (cell(branch.from), cell(branch.to), before);
        groups
            .entry(key)
            .or_insert_with(|| {
                order.push(key);
                Vec::new()
            })
            .push(branch);
    }
    order.iter().filter_map(|key| speeds(&groups[key])).collect()
}

/// The slowest and the fastest branches of a course, if their speeds differ.
fn speeds<'b>(branches: &[&'b Branch]) -> Option<SpeedPair<'b>> {
    let speed = |branch: &&Branch| branch.speed.unwrap_or(0.0);
    let slowest = branches.iter().map(speed).fold(f64::INFINITY, f64::min);
    let fastest = branches.iter().map(speed).fold(0.0, f64::max);
    if fastest < DIFFERENT * slowest {
        return None;
    }
    let pick = |wanted: &dyn Fn(f64) -> bool| -> Vec<&'b Branch> {
        // The last ones are the most settled.
        branches.iter().rev().filter(|branch| wanted(speed(branch))).take(MOST).copied().collect()
    };
    let slow = pick(&|speed| speed <= TOGETHER * slowest);
    let fast = pick(&|speed| speed >= fastest / TOGETHER);
    let rises = slow[0].rises();
    let all = || slow.iter().chain(&fast);
    let lowest = all().map(|b| b.curve.range().0).fold(f64::NEG_INFINITY, f64::max);
    let highest = all().map(|b| b.curve.range().1).fold(f64::INFINITY, f64::min);
    let (from, to) = if rises { (lowest, highest) } else { (highest, lowest) };
    let alone = [&slow, &fast].into_iter().filter(|set| set.len() == 1).map(|set| set[0]);
    let after = |one: &'b Branch| {
        let at = branches.iter().position(|branch| std::ptr::eq(*branch, one))?;
        let next = branches.get(at + 1).filter(|next| speed(next) < DIFFERENT * speed(&one))?;
        Some((one, *next))
    };
    let next = alone.filter_map(after).collect();
    Some(SpeedPair { slow, fast, next, from, to })
}

/// Mean over a set of branches at an input.
fn mean(set: &[&Branch], x: f64) -> Option<CurveReading> {
    let readings: Vec<_> = set.iter().map(|branch| branch.curve.at(x)).collect::<Option<_>>()?;
    let n = readings.len() as f64;
    Some(CurveReading {
        y: readings.iter().map(|reading| reading.y).sum::<f64>() / n,
        deviation: readings.iter().map(|reading| square(reading.deviation)).sum::<f64>().sqrt() / n,
        bend: readings.iter().map(|reading| reading.bend).sum::<f64>() / n,
    })
}

fn compare(survey: &BranchSet, speeds: &SpeedPair) -> Option<Comparison> {
    let (mut squares, mut variance, mut bend, mut places) = (0.0, 0.0, 0.0, 0.0);
    // How far branches of one speed lie apart, because of their past or their wear.
    let mut own = [0.0, 0.0];
    for x in speeds.places() {
        let (slow, fast) = (mean(&speeds.slow, x)?, mean(&speeds.fast, x)?);
        squares += square(slow.y - fast.y);
        variance += square(slow.deviation) + square(fast.deviation);
        bend += square(slow.bend + fast.bend);
        places += 1.0;
        for (own, (set, mean)) in own.iter_mut().zip([(&speeds.slow, slow.y), (&speeds.fast, fast.y)]) {
            let squares =
                set.iter().filter_map(|b| b.curve.at(x)).map(|r| square(r.y - mean) - square(r.deviation));
            *own += squares.sum::<f64>().max(0.0) / (set.len() as f64 - 1.0).max(1.0);
        }
    }
    let height = survey.height();
    let apart = (squares / places).sqrt();
    let own = (own[0].max(own[1]) / places).sqrt();
    let (wear, _) = speeds.wear(survey);
    let first = if speeds.may_settle(survey) { SETTLES * survey.height() } else { 0.0 };
    let settling = speeds.settling().max(first);
    let middle = 0.5 * (speeds.from + speeds.to);
    let pairs = speeds.slow.iter().flat_map(|slow| speeds.fast.iter().map(move |fast| (slow, fast)));
    let rows =
        pairs.map(|(slow, fast)| survey.rows_between(slow, fast, middle)).fold(f64::INFINITY, f64::min);
    Some(Comparison {
        index: apart / height,
        deviation: hypot((variance / places).sqrt(), survey.wander(rows)) / height,
        bend: (bend / places).sqrt() / height,
        freedom: SHAPE,
        other: own.max(FASTER * wear).max(settling) / height,
        pieces: [speeds.slow[0], speeds.fast[0]].into_iter().map(|branch| survey.piece(branch)).collect(),
        curves: vec![survey.curve("slow", speeds.slow[0]), survey.curve("fast", speeds.fast[0])],
    })
}
