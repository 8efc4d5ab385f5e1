//! The envelope of a member: yield, hardening, and softening beyond a cap.
//!
//! ```text
//! R(d) = h d + (1 - h) d/(1 + d^n)^{1/n}                                    theory.md (8.38)
//! C(d) = 1 for d ≤ d_c,    C(d) = ρ + (1 - ρ)/{1 + [(d/d_c - 1)/κ]²} beyond theory.md (8.39)
//! ```

use crate::law::yield_curve::yielding;

/// `R(d)` (theory.md (8.38)) for `d ≥ 0`: it begins with the slope 1 and approaches `1 - h + h d`.
pub(super) fn hardening_curve(d: f64, n: f64, h: f64) -> f64 {
    h * d + (1.0 - h) * yielding(d, n)
}

/// `C(d)` (theory.md (8.39)): the share that is left beyond the cap.
pub(super) fn capped_share(d: f64, cap: f64, softening: f64, residual: f64) -> f64 {
    let beyond = (d / cap - 1.0).max(0.0) / softening;
    residual + (1.0 - residual) / (1.0 + beyond * beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_its_slope_its_bend_and_its_asymptote() {
        assert!((hardening_curve(1e-6, 3.0, 0.1) - 1e-6).abs() < 1e-15);
        // 1/(1 + 1)^{1/2}, by hand.
        assert!((hardening_curve(1.0, 2.0, 0.0) - 0.5_f64.sqrt()).abs() < 1e-15);
        assert!((hardening_curve(1e4, 4.0, 0.1) - (0.9 + 1e3)).abs() < 1e-9);
        for d in [1e90, f64::MIN_POSITIVE] {
            assert!(hardening_curve(d, 20.0, 0.3).is_finite(), "{d}");
        }
        let (below, above) = (hardening_curve(1.0 - 1e-12, 7.0, 0.2), hardening_curve(1.0 + 1e-12, 7.0, 0.2));
        assert!((above - below).abs() < 1e-11);
    }

    #[test]
    fn the_cap_leaves_half_at_its_width_and_the_residual_far_away() {
        assert_eq!(capped_share(3.9, 4.0, 0.5, 0.2), 1.0);
        assert!((capped_share(6.0, 4.0, 0.5, 0.2) - 0.6).abs() < 1e-15);
        assert!((capped_share(1e9, 4.0, 0.5, 0.2) - 0.2).abs() < 1e-9);
    }
}
