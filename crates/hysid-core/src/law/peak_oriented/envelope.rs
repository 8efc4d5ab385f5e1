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
