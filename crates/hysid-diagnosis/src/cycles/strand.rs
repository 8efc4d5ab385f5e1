//! A way of the input from one end of a loop to the other, through all branches between them: where the output passes a
//! level, and its value at an input.

use super::CLOSED;
use crate::branch::Branch;

/// Deviations of the noise by which an output is on one side of a level.
const CLEAR: f64 = 3.0;

/// Levels at which the ways down and up are compared, and the share of their distance by which they change sides.
const LEVELS: u32 = 32;
const CROSSED: f64 = 0.15;

/// Output over input in the order of time.
#[derive(Debug, Clone, Default)]
pub(super) struct Strand {
    points: Vec<StrandPoint>,
}

/// The lowest output of a way, of outputs times a sign.
#[derive(Debug)]
pub(super) struct Extreme {
    /// Its input.
    pub x: f64,
    pub lowest: f64,
    /// Distance of the lower end of the way from it.
    pub depth: f64,
    /// Distance of the highest output from it.
    pub height: f64,
    /// Range of the inputs whose outputs do not differ from it by more than noise.
    pub flat: f64,
}

#[derive(Debug, Clone, Copy)]
struct StrandPoint {
    x: f64,
    y: f64,
    deviation: f64,
}

impl Strand {
    /// Goes on along a branch.
    pub fn extend(&mut self, branch: &Branch) {
        self.extend_where(branch, |_| true);
    }

    /// Goes on along the part of a branch after an input.
    pub fn extend_from(&mut self, branch: &Branch, from: f64) {
        let is_all = from == branch.from;
        self.extend_where(branch, |x| is_all || if branch.rises() { x >= from } else { x <= from });
    }

    /// Goes on along the part of a branch before an input.
    pub fn extend_until(&mut self, branch: &Branch, until: f64) {
        self.extend_where(branch, |x| if branch.rises() { x <= until } else { x >= until });
    }

    fn extend_where(&mut self, branch: &Branch, is_on: impl Fn(f64) -> bool) {
        let points = branch.curve.points_with_deviation().filter(|(x, ..)| is_on(*x));
        let mut points: Vec<StrandPoint> =
            points.map(|(x, y, deviation)| StrandPoint { x, y, deviation }).collect();
        if !branch.rises() {
            points.reverse();
        }
        self.points.extend(points);
    }

    /// Inputs at which the output passes a level, in the order of time. Noise about the level is one passing.
    pub fn crossings(&self, level: f64) -> Vec<f64> {
        let (mut found, mut between) = (Vec::new(), Vec::new());
        let mut side: Option<bool> = None;
        for (place, point) in self.points.iter().enumerate() {
            let away = point.y - level;
            if let Some(before) = place.checked_sub(1).map(|before| &self.points[before]) {
                let from = before.y - level;
                if from * away <= 0.0 && from != away {
                    between.push(before.x + from / (from - away) * (point.x - before.x));
                }
            }
            if away != 0.0 && away.abs() >= CLEAR * point.deviation {
                let now = away > 0.0;
                if side.is_some_and(|side| side != now)
                    && let (Some(first), Some(last)) = (between.first(), between.last())
                {
                    found.push(0.5 * (first + last));
                }
                side = Some(now);
                between.clear();
            }
        }
        let ends_there = self.points.last().is_some_and(|point| point.y == level);
        found.extend(between.last().filter(|_| ends_there && found.is_empty()));
        found
    }

    /// The lowest output, or with the sign -1 the highest.
    pub fn deepest(&self, sign: f64) -> Option<Extreme> {
        let outputs = || self.points.iter().map(|point| sign * point.y);
        let deepest = self.points.iter().min_by(|a, b| (sign * a.y).total_cmp(&(sign * b.y)))?;
        let lowest = sign * deepest.y;
        let (first, last) = (outputs().next()?, outputs().next_back()?);
        let near = self.points.iter().filter(|point| sign * point.y <= lowest + CLEAR * point.deviation);
        let (left, right) =
            near.fold((deepest.x, deepest.x), |(left, right), point| (left.min(point.x), right.max(point.x)));
        Some(Extreme {
            x: deepest.x,
            lowest,
            depth: first.min(last) - lowest,
            height: outputs().fold(lowest, f64::max) - lowest,
            flat: right - left,
        })
    }

    /// The output at an input: in the middle of all passings of it. Beyond the ends by `reach` at most.
    pub fn output_at(&self, x: f64, reach: f64) -> Option<f64> {
        let passing = |pair: &[StrandPoint]| {
            let (a, b) = (pair[0], pair[1]);
            let passes = (a.x - x) * (b.x - x) <= 0.0 && a.x != b.x;
            passes.then(|| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x))
        };
        let found: Vec<f64> = self.points.windows(2).filter_map(passing).collect();
        if !found.is_empty() {
            return Some(found.iter().sum::<f64>() / found.len() as f64);
        }
        let near = |point: &&StrandPoint| (point.x - x).abs() <= reach;
        let nearest = self.points.iter().min_by(|a, b| (a.x - x).abs().total_cmp(&(b.x - x).abs()));
        nearest.filter(near).map(|point| point.y)
    }
}

/// True if the ways down and up change sides between their ends, by more than a small part of what is between them.
pub(super) fn cross(falling: &Strand, rising: &Strand, (low, high): (f64, f64)) -> bool {
    let (mut above, mut below) = (0.0, 0.0);
    for place in 1..LEVELS {
        let x = low + (high - low) * f64::from(place) / f64::from(LEVELS);
        let within = CLOSED * (high - low);
        if let Some((down, up)) = falling.output_at(x, within).zip(rising.output_at(x, within)) {
            above += (down - up).max(0.0);
            below += (up - down).max(0.0);
        }
    }
    f64::min(above, below) > CROSSED * (above + below)
}
