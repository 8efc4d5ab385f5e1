//! Figures read from the branches of a loop: where they pass a level, how far they are apart, the slope of a secant.

use std::f64::consts::PI;

use hysid_core::elementary::{hypot, square};

use super::CLOSED;
use crate::branch::Branch;
use crate::smoothing::{BranchRow, Parabola};

/// Fewest rows of a parabola at an end of a branch.
const FEWEST_AT_AN_END: usize = 8;

/// Deviations of the noise below which a figure is not distinguished from noise.
pub(super) const SURE: f64 = 3.0;

/// Input at which a branch first passes a level of the output, in the order of time.
pub(super) fn crossing(branch: &Branch, level: f64) -> Option<f64> {
    let mut points: Vec<(f64, f64)> = branch.curve.points().collect();
    if !branch.rises() {
        points.reverse();
    }
    points.windows(2).find(|pair| (pair[0].1 - level) * (pair[1].1 - level) <= 0.0).map(|pair| {
        let rise = pair[1].1 - pair[0].1;
        let share = if rise == 0.0 { 0.0 } else { (level - pair[0].1) / rise };
        pair[0].0 + share * (pair[1].0 - pair[0].0)
    })
}

/// Distance along the input of two branches at a level of the output.
pub(super) fn apart_along_input(one: &Branch, other: &Branch, level: f64) -> Option<f64> {
    Some((crossing(one, level)? - crossing(other, level)?).abs())
}

/// Output at an end of a branch; the curve of a noisy input may stop a little before.
pub(super) fn output_at_end(branch: &Branch, x: f64) -> Option<f64> {
    let (low, high) = branch.curve.range();
    let nearest = x.max(low).min(high);
    let is_end = (nearest - x).abs() <= CLOSED * branch.travel();
    if is_end { branch.curve.at(nearest).map(|reading| reading.y) } else { None }
}

/// Share of the way to a turning point in which an output that relaxes there is looked for.
const LAST_PART: f64 = 0.1;

/// Relaxation that is taken away, as a share of the output.
const RELAXES: f64 = 0.02;

/// The output with which a branch from the side of `level` turns. Where a machine stops, the force of a specimen relaxes: then
/// it is the largest on the last tenth of the way, if it falls from there at the end, above the noise.
pub(super) fn output_before_rest(branch: &Branch, level: f64, noise: f64) -> Option<f64> {
    let end = output_at_end(branch, branch.to)?;
    let sign = if branch.rises() { 1.0 } else { -1.0 };
    let from = branch.to - LAST_PART * (branch.to - level);
    let near = branch.curve.points().filter(|(x, _)| sign * (x - from) >= 0.0).map(|(_, y)| sign * y);
    let largest = near.fold(sign * end, f64::max);
    let sure = SURE * noise;
    let below = |x: f64| branch.curve.at(x).map(|reading| largest - sign * reading.y);
    // The fall is near the end: behind a rise, or a plateau.
    let middle = 0.5 * (from + branch.to);
    let is_peak =
        below(from).is_none_or(|fall| fall > sure) || below(middle).is_some_and(|fall| fall <= sure);
    let relaxes = largest - sign * end > sure.max(RELAXES * largest);
    Some(if is_peak && relaxes { sign * largest } else { end })
}

/// Slope of the line through two points.
pub(super) fn secant(a: (f64, f64), b: (f64, f64)) -> f64 {
    (b.1 - a.1) / (b.0 - a.0)
}

/// The largest distance of two branches along the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Widest {
    /// The distance.
    pub apart: f64,
    /// The input where it is.
    pub x: f64,
    /// Its standard deviation from the noise.
    pub deviation: f64,
}

/// Where two branches are furthest apart within a range of inputs, at the inputs of the points of both and at the ends of
/// the range.
pub(super) fn widest(one: &Branch, other: &Branch, (low, high): (f64, f64)) -> Option<Widest> {
    let points = one.curve.points().chain(other.curve.points());
    let inputs = points.map(|(x, _)| x).chain([low, high]).filter(|x| (low..=high).contains(x));
    let apart = |x: f64| {
        let (p, q) = (one.curve.at(x)?, other.curve.at(x)?);
        Some(Widest { apart: (p.y - q.y).abs(), x, deviation: hypot(p.deviation, q.deviation) })
    };
    inputs.filter_map(apart).max_by(|a, b| a.apart.total_cmp(&b.apart))
}

/// The input at an end of a branch, of the parabola through its last or its first quarter; `None` for a few rows.
pub(super) fn end_without_noise(x: &[f64], branch: &Branch, is_last: bool) -> Option<f64> {
    let count = branch.rows.len() / 4;
    if count < FEWEST_AT_AN_END {
        return None;
    }
    let rows = match is_last {
        true => branch.rows.end - count..branch.rows.end,
        false => branch.rows.start..branch.rows.start + count,
    };
    let end = if is_last { rows.end - 1 } else { rows.start } as f64;
    let places: Vec<BranchRow> =
        rows.map(|row| BranchRow { station: row as f64, x: x[row], y: x[row] }).collect();
    let parabola = Parabola::over(&places, end);
    Some(places.iter().map(|place| parabola.weight(place) * place.x).sum())
}

/// Equivalent viscous damping ratio: that of the viscous damper which loses as much energy in a cycle of the same amplitude
/// at resonance; `None` if the energy or the stiffness is not positive.
///
/// ```text
/// ζ = E_D / (4π E_S),    E_S = ½ K a²,    a half the swing                (Jacobsen 1930; ASCE/SEI 7-16, eq. 17.8-2)
/// ```
pub(super) fn damping(energy: f64, stiffness: f64, swing: f64) -> Option<f64> {
    let stored = 0.5 * stiffness * square(0.5 * swing);
    (stored > 0.0 && energy >= 0.0).then(|| energy / (4.0 * PI * stored))
}
