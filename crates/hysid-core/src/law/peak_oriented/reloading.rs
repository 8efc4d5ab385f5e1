//! Shapes of the branches between two passages through zero force.
//!
//! ```text
//! reloading:  τ = {2w t(1-t) τ_b + t²}/Q,   φ = {2w t(1-t) φ_ω + t²}/Q,   Q = (1-t)² + 2w t(1-t) + t²
//!                                                                           theory.md (8.42)
//! unloading:  f/f_r = (1 - q)/(1 + c q)                                     theory.md (8.44)
//! ```
//!
//! `τ` and `φ` are the shares of the way and of the force between zero force and the target, and `t` runs from zero
//! to one. The curve begins and ends along the lines to the pinch point `(τ_b, φ_ω)`; `w` determines how closely it
//! follows them.

use crate::elementary::ln_1p;

/// A rational parabola from (0, 0) to (1, 1) with its control point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bend {
    /// `τ_b`, between 0 and 1.
    pub place: f64,
    /// `φ_ω`, between 0 and 1.
    pub height: f64,
    /// `w > 0`.
    pub weight: f64,
}

impl Bend {
    /// `φ` at `τ`: `[(1 - 2wτ_b) + 2τ(w - 1)] t² + [2wτ_b - 2τ(w - 1)] t = τ` has one solution within 0 to 1.
    pub fn height_at(&self, share: f64) -> f64 {
        let twice = 2.0 * self.weight;
        let linear = twice * self.place - 2.0 * share * (self.weight - 1.0);
        let square = 1.0 - linear;
        let root = (linear * linear + 4.0 * square * share).max(0.0).sqrt();
        // Of the two forms of the solution, the one without a difference of equal numbers.
        let t = if linear > 0.0 { 2.0 * share / (linear + root) } else { (root - linear) / (2.0 * square) };
        let t = t.clamp(0.0, 1.0);
        let middle = twice * t * (1.0 - t);
        let end = t * t;
        (middle * self.height + end) / ((1.0 - t) * (1.0 - t) + middle + end)
    }
}

/// `f/f_r` after the share `q` of the way from the turning point to zero force (theory.md (8.44)).
pub(super) fn unloading_share(q: f64, curvature: f64) -> f64 {
    (1.0 - q) / (1.0 + curvature * q)
}

/// The integral of [`unloading_share`] over `q` from 0 to 1.
pub(super) fn unloading_area(curvature: f64) -> f64 {
    if curvature < 1e-4 {
        return 0.5 - curvature / 6.0;
    }
    ((1.0 + curvature) * ln_1p(curvature) - curvature) / (curvature * curvature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bend_runs_through_its_own_points() {
        for weight in [0.1_f64, 0.7, 1.0, 3.0, 30.0] {
            for (place, height) in [(0.02, 0.9), (0.3, 0.6), (0.5, 0.5), (0.8, 0.1), (0.98, 0.02)] {
                let bend = Bend { place, height, weight };
                for t in [0.0, 0.01, 0.3, 0.5, 0.9, 1.0] {
                    let middle = 2.0 * weight * t * (1.0 - t);
                    let below = (1.0 - t) * (1.0 - t) + middle + t * t;
                    let (share, expected) =
                        ((middle * place + t * t) / below, (middle * height + t * t) / below);
                    assert!((bend.height_at(share) - expected).abs() < 1e-9, "{bend:?} at {t}");
                }
            }
        }
    }

    #[test]
    fn the_area_below_unloading_is_its_integral() {
        for curvature in [0.0, 1e-5, 0.3, 8.0] {
            let parts = 20_000;
            let middle = |k: i32| unloading_share((f64::from(k) + 0.5) / f64::from(parts), curvature);
            let sum: f64 = (0..parts).map(middle).sum::<f64>() / f64::from(parts);
            assert!((sum - unloading_area(curvature)).abs() < 1e-8, "{curvature}");
        }
    }
}
