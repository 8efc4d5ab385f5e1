//! A lag between input and output. Around a turning point, the output of a rate-independent law is a smooth function
//! of the input on either side, and continuous: whatever the law is, the time by which the output must be taken
//! later for that to be so is the lag, theory.md (10.20) and (10.21). It is found at a single speed, and to
//! fractions of a sample. [`delay`](crate::rate_dependence) asks another question, which needs several speeds: which shift
//! makes whole branches agree. Where it has an answer, that one is given. What both share is the search for the
//! lowest place.

mod turn;

use hysid_core::elementary::{hypot, ln, powf, powi, square};
use turn::{LagEffect, TurnBranches, TurnWindow};

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::Delay;
use crate::branch::BranchSet;
use crate::minimum::lowest;

/// Shares of the shorter branch that are taken around a turning point, the narrowest first.
const SHARES: [f64; 7] = [0.025, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2];

const FIRST: [f64; 2] = [0.1, 0.3];

/// Turning points at least, and at most for one speed.
const FEWEST: usize = 2;
const MOST: usize = 24;

/// Branches shorter than this share of the range of the input are left aside.
const SHORTEST: f64 = 0.1;

/// Speeds within this factor are one speed, and speeds that are looked at.
const ONE_SPEED: f64 = 1.5;
const MOST_SPEEDS: usize = 6;

/// Parts of the turning points whose lags are compared.
const PARTS: usize = 8;

/// Lags are sought up to this share of the time of both branches.
const LONGEST: f64 = 0.1;

/// Lags tried on either side before the best is refined.
const PLACES: i32 = 4;

/// Windows agree within this many deviations.
const AGREE: f64 = 1.5;

/// Widest window that may be the narrowest with a lag: wider ones alone cannot be distinguished from a law that
/// bends.
const NARROW: f64 = 0.1;

/// Scatter of a window's lag, as a share of what was searched, from which on it shows nothing.
const BLIND: f64 = 0.05;

/// A lag is so many deviations from none, and this share of the time between rows.
const CLEAR: f64 = 10.0;
const SHORTEST_STEP: f64 = 0.1;

/// By how much the logarithm of the likelihood must be greater than without a lag.
const LIKELIER: f64 = 12.0;

/// A remainder up to this many times the noise is noise; beyond it is the law's, and shows as little as this
/// many rows do.
const NOISE: f64 = 1.1;
const ROWS_OF_A_LAW: f64 = 10.0;

/// Numbers that are fitted for each turning point.
const FREE: usize = 7;

/// Lags of several speeds agree within this share; a speed that is to confirm a lag determines it within the other.
const SAME: f64 = 0.1;
const CONFIRMS: f64 = 0.25;

#[derive(Debug, Clone, PartialEq)]
struct Lag {
    /// By which the output comes after the input, in the unit of time; negative if before.
    time: f64,
    /// Its standard deviation, from the scatter between turning points and between windows.
    deviation: f64,
    /// Way of the input for time.
    speed: f64,
    /// Time between rows.
    step: f64,
    /// Logarithm of the likelihood of a lag over that of a step at the turning points or of a part in proportion to
    /// the rate, theory.md (10.22).
    margin: f64,
}

impl Lag {
    fn is_clear(&self) -> bool {
        self.time.abs() > (CLEAR * self.deviation).max(SHORTEST_STEP * self.step) && self.margin > LIKELIER
    }

    fn agrees(&self, other: &Lag, deviations: f64, share: f64) -> bool {
        (self.time - other.time).abs()
            <= deviations * hypot(self.deviation, other.deviation) + share * self.time.abs()
    }
}

/// Problems of a lag: from whole branches at several speeds, if a delay makes them agree, since that is more precise
/// than their ends; otherwise from turning points.
pub(super) fn complaints(survey: &BranchSet, delay: Option<&Delay>) -> Vec<DataIssue> {
    match delay {
        Some(delay) => vec![between_speeds(survey, delay)],
        None => at_turning_points(survey),
    }
}

/// The longest lag that the slowest turning points allow, either way; `None` where they do not show it.
pub(super) fn longest(survey: &BranchSet) -> Option<f64> {
    const SURE: f64 = 3.0;
    let turns = turns(survey);
    let lag = at_one_speed(survey, speeds(&turns).first()?)?;
    Some(lag.time.abs() + SURE * lag.deviation)
}

/// A delay that makes all speeds agree, theory.md (10.14).
fn between_speeds(survey: &BranchSet, delay: &Delay) -> DataIssue {
    let units = ColumnUnits::of(survey);
    let statement = format!(
        "the output is {}, the same at all speeds, which explains the apparent rate dependence; shift the \
         output by {} to {} time before fitting",
        units.behind(delay.time),
        units.time(delay.time.abs()),
        if delay.time > 0.0 { "an earlier" } else { "a later" },
    );
    DataIssue::of_all(DataIssueKind::Lag, Severity::Warning, statement).measured(delay.time, &units.time)
}

fn at_turning_points(survey: &BranchSet) -> Vec<DataIssue> {
    let turns = turns(survey);
    let speeds = speeds(&turns);
    let several = speeds.len() > 1;
    let lags: Vec<Lag> = speeds.into_iter().filter_map(|turns| at_one_speed(survey, turns)).collect();
    let clear: Vec<&Lag> = lags.iter().filter(|lag| lag.is_clear()).collect();
    let Some(sharpest) = clear.iter().copied().min_by(|a, b| a.deviation.total_cmp(&b.deviation)) else {
        return Vec::new();
    };
    let units = ColumnUnits::of(survey);
    let time = |time: f64| units.time(time);
    if let Some(other) = lags.iter().find(|lag| !sharpest.agrees(lag, 3.0, SAME)) {
        let (slow, fast) = if sharpest.speed < other.speed { (sharpest, other) } else { (other, sharpest) };
        let statement = format!(
            "around turning points the output is {} at a speed of {}, and {} at {}: not one delay, so the \
             output depends on the speed",
            units.behind(slow.time),
            units.speed(slow.speed),
            units.behind(fast.time),
            units.speed(fast.speed)
        );
        return vec![DataIssue::of_all(DataIssueKind::LagChangesWithSpeed, Severity::Note, statement)];
    }
    let knows = |lag: &&Lag| lag.deviation <= CONFIRMS * sharpest.time.abs();
    if several && lags.iter().filter(knows).count() < 2 {
        return Vec::new();
    }
    let weight = |lag: &Lag| powi(lag.deviation.max(1e-6 * lag.step), -2);
    let weights: f64 = clear.iter().map(|lag| weight(lag)).sum();
    let value = clear.iter().map(|lag| weight(lag) * lag.time).sum::<f64>() / weights;
    let deviation = powf(weights, -0.5).max(1e-3 * value.abs());
    let what = match (several, value > 0.0) {
        (true, true) => {
            "the same at all speeds: a delay of the output, which looks like rate dependence".to_string()
        }
        (true, false) => {
            "the same at all speeds: a delay of the input, which looks like rate dependence".to_string()
        }
        (false, true) => {
            "a delay or a slow sensor (runs at other speeds show whether the time is constant)".to_string()
        }
        (false, false) => {
            "a delay of the input, or a viscous part (runs at other speeds show which)".to_string()
        }
    };
    let statement = format!(
        "the output is {} (± {}), {what}; shift the output by {} to {} time before fitting",
        units.behind(value),
        time(2.0 * deviation),
        time(value.abs()),
        if value > 0.0 { "an earlier" } else { "a later" },
    );
    vec![DataIssue::of_all(DataIssueKind::Lag, Severity::Warning, statement).measured(value, &units.time)]
}

/// Turning points whose lag is found together.
struct Turns<'t, 'd> {
    turns: Vec<&'t TurnBranches<'d>>,
    windows: Vec<TurnWindow>,
}

impl<'t, 'd> Turns<'t, 'd> {
    fn new(turns: &[&'t TurnBranches<'d>], share: f64, lags: (f64, f64)) -> Self {
        let (turns, windows) =
            turns.iter().filter_map(|turn| Some((*turn, turn.window(share, lags)?))).unzip();
        Self { turns, windows }
    }

    fn remainder(&self, beside: LagEffect) -> f64 {
        self.turns.iter().zip(&self.windows).map(|(turn, window)| turn.remainder(window, beside)).sum()
    }

    fn lag(&self, centre: f64, reach: f64) -> f64 {
        lowest(&|lag| self.remainder(LagEffect::Lag(lag)), centre, reach, PLACES)
    }

    /// The lag and its deviation, from that of parts of the turning points.
    fn lag_with_deviation(&self, centre: f64, reach: f64) -> (f64, f64) {
        let time = self.lag(centre, reach);
        let parts = self.turns.len().min(PARTS);
        let part = |number: usize| {
            let of_part = |lag: f64| -> f64 {
                let pairs = self.turns.iter().zip(&self.windows).skip(number).step_by(parts);
                pairs.map(|(turn, window)| turn.remainder(window, LagEffect::Lag(lag))).sum()
            };
            lowest(&of_part, time, 0.6 * reach, PLACES)
        };
        let squares: f64 = (0..parts).map(|number| square(part(number) - time)).sum();
        // The scatter of few is not well known.
        let few = 1.0 + 2.0 / (parts - 1) as f64;
        (time, few * (squares / (parts * (parts - 1)) as f64).sqrt())
    }

    /// Rows beyond those that the fit needs.
    fn rows(&self) -> f64 {
        self.windows.iter().map(|window| window.len().saturating_sub(FREE)).sum::<usize>() as f64
    }

    /// True if a lag leaves no more than the noise, with what it may be larger by chance.
    fn leaves_noise(&self, left: f64, noise: f64) -> bool {
        let rows = self.rows();
        left <= rows * square(NOISE * noise) * (1.0 + 2.0 * (2.0 / rows).sqrt())
    }

    /// Logarithm of the likelihood ratio of a lag, theory.md (10.22).
    fn margin(&self, lag: f64, noise: f64) -> f64 {
        let left = self.remainder(LagEffect::Lag(lag));
        let independent = if self.leaves_noise(left, noise) { self.rows() } else { ROWS_OF_A_LAW };
        let without = self.remainder(LagEffect::Step).min(self.remainder(LagEffect::Rate));
        0.5 * independent * ln((without / left.max(f64::MIN_POSITIVE)).max(f64::MIN_POSITIVE))
    }
}

/// All turning points between long branches, the slowest first.
fn turns<'d>(survey: &BranchSet<'d>) -> Vec<TurnBranches<'d>> {
    let mut turns: Vec<TurnBranches> = survey
        .branches
        .windows(2)
        .filter(|pair| pair[0].record == pair[1].record)
        .filter(|pair| pair[0].travel().min(pair[1].travel()) >= SHORTEST * survey.width())
        .filter_map(|pair| TurnBranches::between(survey, &pair[0], &pair[1]))
        .collect();
    turns.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    turns
}

fn speeds<'t, 'd>(turns: &'t [TurnBranches<'d>]) -> Vec<&'t [TurnBranches<'d>]> {
    let mut speeds = Vec::new();
    let mut rest = turns;
    while let Some(slowest) = rest.first() {
        let alike = rest.partition_point(|turn| turn.speed <= ONE_SPEED * slowest.speed);
        let (alike, faster) = rest.split_at(alike);
        if alike.len() >= FEWEST {
            speeds.push(alike);
        }
        rest = faster;
    }
    let every = speeds.len().div_ceil(MOST_SPEEDS).max(1);
    speeds.into_iter().step_by(every).collect()
}

fn at_one_speed(survey: &BranchSet, turns: &[TurnBranches]) -> Option<Lag> {
    let turns: Vec<&TurnBranches> = turns.iter().step_by(turns.len().div_ceil(MOST)).collect();
    let shortest = turns.iter().map(|turn| turn.duration()).fold(f64::INFINITY, f64::min);
    let reach = LONGEST * shortest;
    let first = first_search(&turns, reach)?;
    let mut found: Vec<(Lag, f64)> = Vec::new();
    for share in SHARES {
        let near = Turns::new(&turns, share, (first, first));
        if near.turns.len() < FEWEST || near.turns.len() * 2 < turns.len() {
            continue;
        }
        let (time, deviation) = near.lag_with_deviation(first, 0.5 * reach);
        let speed = turns[turns.len() / 2].speed;
        if deviation < BLIND * reach {
            found.push((Lag { time, deviation, speed, step: turns[0].step(), margin: 0.0 }, share));
        }
    }
    if found.first()?.1 > NARROW {
        return None;
    }
    let chosen = widest(&found);
    let beside = if chosen > 0 { chosen - 1 } else { 1 };
    let (mut lag, share) = found.get(chosen)?.clone();
    let other = found.get(beside).map_or(lag.time, |(other, _)| other.time);
    lag.deviation = hypot(lag.deviation, 0.5 * (lag.time - other));
    lag.margin =
        Turns::new(&turns, share, (lag.time, lag.time)).margin(lag.time, survey.output_noise.roughness());
    Some(lag)
}

/// The widest of windows that agrees with all narrower ones.
fn widest(found: &[(Lag, f64)]) -> usize {
    let agrees = |wide: usize| found[..wide].iter().all(|(lag, _)| lag.agrees(&found[wide].0, AGREE, 0.0));
    (1..found.len()).take_while(|&wide| agrees(wide)).last().unwrap_or(0)
}

/// The lag to begin with: of those found in wide and in narrow windows, and none, the one that leaves least.
fn first_search(turns: &[&TurnBranches], reach: f64) -> Option<f64> {
    let mut found = vec![0.0];
    let mut narrowest = None;
    for share in FIRST {
        let near = Turns::new(turns, share, (0.0, 0.0));
        if near.turns.len() < FEWEST {
            continue;
        }
        let lag = near.lag(0.0, reach);
        // At the end of what was searched there is no valley.
        if lag.abs() < 0.95 * reach {
            found.push(lag);
        }
        narrowest = narrowest.or(Some(share));
    }
    let ends = found.iter().fold((0.0, 0.0), |(a, b): (f64, f64), &lag| (a.min(lag), b.max(lag)));
    let near = Turns::new(turns, narrowest?, ends);
    let left = |lag: &f64| near.remainder(LagEffect::Lag(*lag));
    found.into_iter().min_by(|a, b| left(a).total_cmp(&left(b)))
}
