//! Many comparisons, one verdict: what is larger than the noise, and large enough to matter.

use hysid_core::elementary::{hypot, square};

use super::branch::CurveReading;
use super::significance;
use super::{PictureCurve, Piece, Verdict};

/// A property holds if no difference can be larger than this multiple of the effect that matters. Designed.
pub(crate) const BOUND: f64 = 3.0;

/// The same where one turning point decides: return points and congruency. Designed.
pub(crate) const NARROW_BOUND: f64 = 2.0;

/// A property does not hold if a gap, which is read at one point, is this multiple of its limit. Designed.
const CLEAR_GAP: f64 = 1.2;

/// A difference beyond this share of the effect that matters is too close to it for a property to hold.
const CLOSE: f64 = 0.6;

/// Deviations by which a difference may be larger than it was found.
const UP_TO: f64 = 1.28;

/// Factor by which reading between rows and other causes may exceed their estimate.
const UNSURE: f64 = 2.5;

/// Independent numbers in a gap, and in a difference of shapes: a branch is smoothed over up to a fifth of it, and its
/// beginning has a noise that shifts all of it.
pub(crate) const GAP: f64 = 1.0;
pub(crate) const SHAPE: f64 = 3.0;

/// A difference whose deviation is below this share of it is no noise.
const CLEAR: f64 = 0.1;

/// Differences of this share of the effect that matters, on average, are near it.
const NEAR: f64 = 0.3;

/// Deviations by which the sum of squares of many differences may be too large.
const TOGETHER: f64 = 2.3;

/// A difference that vanishes if the property holds.
#[derive(Debug, Clone)]
pub(crate) struct Comparison {
    /// Its magnitude, as a share.
    pub index: f64,
    /// Standard deviation of the noise in it.
    pub deviation: f64,
    /// Largest error of it from reading between rows.
    pub bend: f64,
    /// Independent numbers in it: 1 for a gap, several for a shape.
    pub freedom: f64,
    /// Largest error of it from other causes: turning points between rows, wear.
    pub other: f64,
    pub pieces: Vec<Piece>,
    pub curves: Vec<PictureCurve>,
}

impl Comparison {
    /// Of two readings that should be equal, between which slow noise may have wandered so far. Nothing is drawn.
    pub fn of_readings(height: f64, [a, b]: [CurveReading; 2], wander: f64) -> Self {
        Self {
            index: (a.y - b.y).abs() / height,
            deviation: hypot(hypot(a.deviation, b.deviation), wander) / height,
            bend: (a.bend + b.bend) / height,
            freedom: GAP,
            other: 0.0,
            pieces: Vec::new(),
            curves: Vec::new(),
        }
    }
}

/// Result of all comparisons of a property.
#[derive(Debug, Clone)]
pub(crate) struct PropertyResult {
    /// `Yes` if no difference is distinguishable from noise or close to the relevant size.
    pub verdict: Verdict,
    /// The difference that decides.
    pub index: f64,
    /// Size that noise alone gives.
    pub noise: f64,
    /// The difference beyond which the property does not hold.
    pub threshold: f64,
    /// Without a verdict: why there is none.
    pub doubt: &'static str,
    pub count: usize,
    /// Places of the comparisons, the one that decides first.
    pub order: Vec<usize>,
}

/// True if many differences that noise may cause, each by itself, are too large together, by a chance of about 1 in 100
/// (normal approximation of the chi-squared distribution), and near the effect that matters.
fn are_doubtful_together(comparisons: &[Comparison], effect: f64) -> bool {
    let count = comparisons.len() as f64;
    let beyond = |c: &Comparison| (c.index - c.bend - c.other).max(0.0);
    let squares: f64 =
        comparisons.iter().map(|c| square(beyond(c) / c.deviation.max(f64::MIN_POSITIVE))).sum();
    let mean = comparisons.iter().map(beyond).sum::<f64>() / count;
    let spread: f64 = comparisons.iter().map(|c| 2.0 / c.freedom).sum();
    mean > NEAR * effect && squares > count + TOGETHER * spread.sqrt()
}

/// Judges comparisons: a difference counts if it is above `effect` and cannot be noise, theory.md (10.3).
///
/// `bound` is [`BOUND`] or [`NARROW_BOUND`].
pub(crate) fn judge(comparisons: &[Comparison], effect: f64, bound: f64) -> Option<PropertyResult> {
    let count = comparisons.len();
    let (critical, doubtful) = (significance::critical_value(count), significance::doubtful_value(count));
    let limit = |c: &Comparison| (effect + UNSURE * (c.bend + c.other)).max(critical * c.deviation);
    let excess = |c: &Comparison| c.index / limit(c);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| excess(&comparisons[b]).total_cmp(&excess(&comparisons[a])));
    let deciding = &comparisons[*order.first()?];
    // The root mean square of several numbers strays less from its deviation than one does.
    let in_doubt = |c: &Comparison| match c.freedom > GAP {
        true => (1.0 + doubtful * (2.0 / c.freedom).sqrt()).sqrt(),
        false => doubtful,
    };
    let is_doubtful = |c: &Comparison| c.index > (CLOSE * effect).max(in_doubt(c) * c.deviation);
    let at_most = |c: &Comparison| (c.index + UP_TO * c.deviation + c.bend).max(2.0 * c.other);
    let mut bounds: Vec<f64> = comparisons.iter().map(at_most).collect();
    let clearly = if deciding.freedom > GAP { 1.0 } else { CLEAR_GAP };
    let verdict = if excess(deciding) > clearly {
        Verdict::No
    } else if excess(deciding) > 1.0
        || comparisons.iter().any(is_doubtful)
        || are_doubtful_together(comparisons, effect)
        || significance::median(&mut bounds) > bound * effect
    {
        Verdict::NotTestable
    } else {
        Verdict::Yes
    };
    // Far above the noise, but not above what matters.
    let is_close = |c: &Comparison| is_doubtful(c) && c.deviation < CLEAR * c.index;
    let doubt = match comparisons.iter().any(is_close) {
        true => "with its uncertainty, the largest difference may be below or above the size that matters",
        false => "noise or widely spaced rows may hide a relevant difference",
    };
    Some(PropertyResult {
        doubt,
        verdict,
        index: deciding.index,
        noise: deciding.deviation * significance::typical_largest(count),
        threshold: limit(deciding),
        count,
        order,
    })
}
