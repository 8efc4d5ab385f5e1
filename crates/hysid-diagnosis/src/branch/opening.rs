//! How far a branch and the one after it stand open, whether or not they close a loop.

use crate::branch::{Branch, BranchSet};
use crate::noise::Noise;
use crate::{PictureCurve, Piece};

/// Places along the inputs that both branches go through, at most.
const MOST_PLACES: usize = 100;

/// A branch, the next, and the area between them over the inputs of both.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Opening {
    /// Number of the first branch.
    pub branch: usize,
    /// `∮ y dx`, positive if passed clockwise.
    pub signed: f64,
    /// The same with all parts counted as positive.
    pub area: f64,
    /// Standard deviation of the signed area from the noise.
    pub deviation: f64,
    /// Range of the inputs of both.
    pub swing: f64,
    pub height: f64,
    pub speed: Option<f64>,
}

impl Opening {
    /// Area as a share of its box.
    pub fn fullness(&self) -> f64 {
        self.area / (self.swing * self.height).max(f64::MIN_POSITIVE)
    }

    pub fn pieces(&self, survey: &BranchSet) -> Vec<Piece> {
        vec![survey.piece(&survey.branches[self.branch]), survey.piece(&survey.branches[self.branch + 1])]
    }

    pub fn rows(&self, survey: &BranchSet) -> usize {
        survey.branches[self.branch..self.branch + 2].iter().map(|branch| branch.rows.len()).sum()
    }

    pub fn curves(&self, survey: &BranchSet) -> Vec<PictureCurve> {
        let curve = |label, index: usize| survey.curve(label, &survey.branches[index]);
        vec![curve("there", self.branch), curve("back", self.branch + 1)]
    }
}

/// The openings between all branches that follow each other, in their order.
pub(crate) fn openings(branches: &[Branch], output_noise: &Noise) -> Vec<Opening> {
    (1..branches.len()).filter_map(|next| opening(branches, next - 1, output_noise)).collect()
}

fn opening(branches: &[Branch], branch: usize, output_noise: &Noise) -> Option<Opening> {
    let (out, back) = (&branches[branch], &branches[branch + 1]);
    if out.record != back.record || out.curve.is_empty() || back.curve.is_empty() {
        return None;
    }
    let (one, other) = (out.curve.range(), back.curve.range());
    let (from, to) = (one.0.max(other.0), one.1.min(other.1));
    let places = (out.rows.len() + back.rows.len()).min(MOST_PLACES);
    let step = (to - from) / places as f64;
    let (mut signed, mut area, mut low, mut high) = (0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY);
    for place in 0..places {
        let x = from + (place as f64 + 0.5) * step;
        let (a, b) = (out.curve.at(x)?.y, back.curve.at(x)?.y);
        // Clockwise is above on the way up.
        signed += if out.rises() { a - b } else { b - a };
        area += (a - b).abs();
        low = low.min(a).min(b);
        high = high.max(a).max(b);
    }
    let rows = out.rows.len().min(back.rows.len());
    Some(Opening {
        branch,
        signed: signed * step,
        area: area * step,
        deviation: output_noise.of_mean(rows) * (to - from) * 2.0_f64.sqrt(),
        swing: to - from,
        height: high - low,
        speed: out.speed.zip(back.speed).map(|(a, b)| 0.5 * (a + b)),
    })
}
