//! Paths of the input in the figures of the documentation, and how they are drawn.

/// Step of the input between two samples. All thresholds and amplitudes of the figures are multiples of it, so each corner
/// of a loop is a sample.
pub const STEP: f64 = 0.02;

/// The input from 0 through these turning points, in equal steps.
pub fn path(turning: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0];
    let mut at = 0_i64;
    for target in turning {
        let target = (target / STEP).round() as i64;
        while at != target {
            at += (target - at).signum();
            x.push(at as f64 * STEP);
        }
    }
    x
}

/// The points without those in the middle of a straight piece.
pub fn corners(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let is_corner = |k: usize| {
        let ((x0, y0), (x1, y1), (x2, y2)) = (points[k - 1], points[k], points[k + 1]);
        ((x1 - x0) * (y2 - y1) - (x2 - x1) * (y1 - y0)).abs() > 1e-9 || (x1 - x0) * (x2 - x1) < 0.0
    };
    let last = points.len() - 1;
    (0..=last).filter(|&k| k == 0 || k == last || is_corner(k)).map(|k| points[k]).collect()
}
