//! A curve that begins with the slope 1 and approaches 1: elastic loading that becomes yielding.
//!
//! ```text
//! b(z) = z/(1 + z^n)^{1/n}      theory.md (8.38), (8.48)
//! ```

use crate::elementary::{exp, ln, ln_1p};

/// `b(z)` for `z ≥ 0`; the larger `n > 0`, the sharper is the bend at 1.
///
/// It is `min(z, 1) exp{-ln(1 + e^{-n |ln z|})/n}`, which has no power that overflows and takes half the time of two
/// powers.
pub(crate) fn yielding(z: f64, n: f64) -> f64 {
    let beyond = exp(-n * ln(z).abs());
    z.min(1.0) * exp(-ln_1p(beyond) / n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::powf;

    #[test]
    fn it_is_the_quotient() {
        for n in [0.3_f64, 0.7, 1.0, 2.0, 5.5, 20.0, 50.0] {
            for z in [1e-9_f64, 0.03, 0.5, 0.99, 1.0, 1.01, 3.0, 200.0] {
                let quotient = z / powf(1.0 + powf(z, n), 1.0 / n);
                assert!((yielding(z, n) - quotient).abs() < 1e-14 * quotient, "{z} {n}");
            }
        }
    }

    #[test]
    fn its_ends_are_exact() {
        for n in [0.3, 50.0] {
            assert_eq!(yielding(0.0, n), 0.0);
            assert_eq!(yielding(f64::INFINITY, n), 1.0);
            assert!((yielding(1e300, n) - 1.0).abs() < 1e-15);
        }
    }
}
