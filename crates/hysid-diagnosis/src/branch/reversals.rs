//! Which reversals of an input are turning points.
//!
//! By default the noise decides, at every amplitude: a cycle of 1 mm counts beside one of 100 mm. Means of `w` rows have
//! less noise than rows, so that they show smaller cycles, as long as a half cycle has several of them. The width `w` that
//! shows the most turning points is taken; each is then found to the row.

use hysid_core::data::turning_points::turning_points;

use crate::noise::{resolution, roughness};
use crate::significance;

/// Rule by which reversals count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ReversalRule {
    /// Reversals of at least this size, in the unit of the input.
    Size(f64),
    /// Reversals that noise does not explain and that are no wobble of a longer half cycle.
    Noise,
}

/// Steps between two half cycles are a wobble below this share of both.
const WOBBLE: f64 = 0.02;

/// Fewest means of rows among which reversals are sought.
const FEWEST_MEANS: usize = 32;

/// Rounding of the numbers of a file, as a share of the range.
const ROUNDING: f64 = 1e-6;

/// The turning points of an input, and the size of the smallest reversal that could be one.
pub(crate) fn reversals(x: &[f64], rule: ReversalRule) -> (Vec<usize>, f64) {
    match rule {
        ReversalRule::Size(size) => (turning_points(x, size), size),
        ReversalRule::Noise => above_noise(x),
    }
}

/// Turning points that noise does not explain.
fn above_noise(x: &[f64]) -> (Vec<usize>, f64) {
    let (low, high) = super::range(x);
    let least = (ROUNDING * (high - low)).max(1.5 * resolution(x.iter()));
    let mut best: (Vec<usize>, f64) = (Vec::new(), f64::INFINITY);
    let mut width = 1;
    while width == 1 || x.len() / width >= FEWEST_MEANS {
        let means: Vec<f64> =
            x.chunks_exact(width).map(|rows| rows.iter().sum::<f64>() / width as f64).collect();
        let noise =
            2.0 * roughness([means.as_slice()].into_iter()) * significance::critical_value(means.len());
        let smallest = noise.max(least);
        let found = without_wobbles(&means, turning_points(&means, smallest));
        if width == 1 || found.len() > best.0.len() {
            best = (on_rows(x, &found, width), smallest);
        }
        if noise <= least {
            break;
        }
        width *= 2;
    }
    best
}

/// Turning points without those of wobbles: an actuator that holds at its furthest point, or goes back a little on its
/// way. Several small steps on the way are small cycles.
fn without_wobbles(x: &[f64], turns: Vec<usize>) -> Vec<usize> {
    let mut places = vec![0];
    places.extend(turns);
    places.push(x.len().saturating_sub(1));
    let way = |places: &[usize], step: usize| (x[places[step + 1]] - x[places[step]]).abs();
    let mut long = 0;
    while long + 1 < places.len() {
        let steps = places.len() - 1;
        let limit = WOBBLE * way(&places, long);
        let next = (long + 1..steps).find(|&step| way(&places, step) >= limit).unwrap_or(steps);
        let between = long + 1..next;
        let is_small = |step: usize| next < steps && way(&places, step) < WOBBLE * way(&places, next);
        let count = between.len();
        if count == 0 || !between.clone().all(is_small) || (count > 1 && count % 2 == 1) {
            long += 1;
        } else if count == 1 {
            // The way goes on after it.
            places.drain(long + 1..=long + 2);
            long = long.saturating_sub(1);
        } else {
            let up = x[places[long + 1]] > x[places[long]];
            let ends = &places[long + 1..=next];
            let further = |a: &&usize, b: &&usize| {
                if up { x[**a].total_cmp(&x[**b]) } else { x[**b].total_cmp(&x[**a]) }
            };
            let furthest = *ends.iter().max_by(further).expect("the end of a step");
            places.splice(long + 1..=next, [furthest]);
            long += 1;
        }
    }
    // A first or last step has a neighbour on one side only.
    if places.len() > 3 && way(&places, 0) < WOBBLE * way(&places, 1) {
        places.remove(1);
    }
    if places.len() > 3 && way(&places, places.len() - 2) < WOBBLE * way(&places, places.len() - 3) {
        places.remove(places.len() - 2);
    }
    places[1..places.len() - 1].to_vec()
}

/// The rows of turning points of means: each the furthest row between the middles of its neighbours.
fn on_rows(x: &[f64], turns: &[usize], width: usize) -> Vec<usize> {
    if width == 1 {
        return turns.to_vec();
    }
    let end = x.len() - 1;
    let middle = |mean: usize| (mean * width + width / 2).min(end);
    let rises = |place: usize| {
        let before = if place == 0 { x[0] } else { x[middle(turns[place - 1])] };
        x[middle(turns[place])] > before
    };
    let furthest = |place: usize| {
        let first = (turns[place].saturating_sub(1) * width).max(1);
        let last = ((turns[place] + 2) * width).min(end);
        let sign = if rises(place) { 1.0 } else { -1.0 };
        (first..last).max_by(|&a, &b| (sign * x[a]).total_cmp(&(sign * x[b])))
    };
    let mut rows: Vec<usize> = (0..turns.len()).filter_map(furthest).collect();
    rows.dedup();
    rows
}

#[cfg(test)]
mod tests {
    use hysid_core::random::uniform;

    use super::*;

    /// Triangles of the given amplitudes about 0, a row each 0.05.
    fn triangles(amplitudes: &[f64], step: f64) -> Vec<f64> {
        let turning = amplitudes.iter().flat_map(|a| [*a, -a]).chain([0.0]);
        let mut x = vec![0.0];
        for to in turning {
            let from = x[x.len() - 1];
            let rows = ((to - from).abs() / step).ceil().max(4.0);
            x.extend((1..rows as usize).map(|k| from + (to - from) * k as f64 / rows).chain([to]));
        }
        x
    }

    #[test]
    fn reversals_of_every_size_count_without_noise() {
        let amplitudes = [0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 5.0, 0.1, 0.1, 0.05];
        let x = triangles(&amplitudes, 0.05);
        let found = reversals(&x, ReversalRule::Noise).0;
        let sizes: Vec<f64> = found.iter().map(|&row| x[row].abs()).collect();
        let expected: Vec<f64> = amplitudes.iter().flat_map(|a| [*a, *a]).collect();
        assert_eq!(sizes, expected);
    }

    #[test]
    fn a_wobble_of_an_actuator_is_no_reversal() {
        let mut x = triangles(&[5.0, 5.0], 0.1);
        let peak = x.iter().position(|x| *x == 5.0).unwrap();
        x.splice(peak + 1..peak + 1, [4.97, 4.99, 4.96]);
        x.splice(20..20, [x[20] - 0.05, x[20] + 0.01]);
        x.splice(1..1, [-0.02, -0.01]);
        assert_eq!(reversals(&x, ReversalRule::Noise).0.len(), 4);
    }

    #[test]
    fn noise_is_no_reversal_and_hides_none_that_many_rows_show() {
        let uniform = |k: u64| uniform(k) - 0.5;
        let normal = |row: usize| (0..12).map(|k| uniform(12 * row as u64 + k)).sum::<f64>();
        // Cycles of 1/50 of the largest, with noise of 1/5 of theirs.
        let amplitudes = [0.1, 0.1, 1.0, 5.0, 5.0, 0.1];
        let exact = triangles(&amplitudes, 5e-4);
        let x: Vec<f64> = exact.iter().enumerate().map(|(row, x)| x + 0.02 * normal(row)).collect();
        assert_eq!(reversals(&x, ReversalRule::Noise).0.len(), 12);
        let still: Vec<f64> = (0..4000).map(|row| 0.02 * normal(row) + 1e-3 * row as f64).collect();
        assert_eq!(reversals(&still, ReversalRule::Noise).0.len(), 0);
    }
}
