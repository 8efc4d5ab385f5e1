//! Relay: a switch with two thresholds, the atom of the Preisach model.
//!
//! ```text
//!        +1             if x_k >= s + r
//! R_k =  -1             if x_k <= s - r                      theory.md (1.1)
//!        R_{k-1}        in between
//!
//! virgin: R = -1 if s > 0, else +1
//! ```
//!
//! The point `(r, s)`, half-width and centre, is the relay's place in the Preisach half-plane. A
//! relay says on which side of it the memory curve `r -> P_r[x]` runs: `R = +1` if and only if the
//! [play](super::play) `P_r[x] > s`.

use super::{InvalidOperator, Operator, checked_threshold, is_usable};

/// Output of a virgin relay with centre `s`: -1 above, +1 below the demagnetised memory curve `P_r
/// = 0`: theory.md (1.1).
#[inline(always)]
pub fn virgin(s: f64) -> f64 {
    if s > 0.0 { -1.0 } else { 1.0 }
}

/// Output of a relay after input `x`, given its `output` before (-1 or +1): theory.md (1.1) with
/// `lower = s - r` and `upper = s + r`, all in the unit of `x`.
#[inline(always)]
pub fn switch(output: f64, x: f64, lower: f64, upper: f64) -> f64 {
    let output = if x >= upper { 1.0 } else { output };
    if x <= lower { -1.0 } else { output }
}

/// Relay with thresholds `s - r` and `s + r`: theory.md (1.1).
///
/// ```
/// use hysid_core::operator::{Operator, Relay};
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// let mut relay = Relay::new(1.0, 0.5)?; // switches up at 1.5, down at -0.5
/// assert_eq!(relay.run(&[0.0, 1.4, 1.5, 0.0, -0.5, 0.0]), [-1.0, -1.0, 1.0, 1.0, -1.0, -1.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Relay {
    lower: f64,
    upper: f64,
    virgin: f64,
    output: f64,
}

impl Relay {
    /// A virgin relay of half-width `r` and centre `s`, both in the unit of `x`.
    ///
    /// # Errors
    ///
    /// [`InvalidOperator::Threshold`] unless `r` is finite and greater than 0,
    /// [`InvalidOperator::Centre`] unless `s` is finite.
    pub fn new(r: f64, s: f64) -> Result<Self, InvalidOperator> {
        let r = checked_threshold(r)?;
        if !s.is_finite() {
            return Err(InvalidOperator::Centre(s));
        }
        let virgin = virgin(s);
        Ok(Self { lower: s - r, upper: s + r, virgin, output: virgin })
    }
}

impl Operator for Relay {
    fn reset(&mut self) {
        self.output = self.virgin;
    }

    fn step(&mut self, x: f64) -> f64 {
        if !is_usable(x) {
            return f64::NAN;
        }
        self.output = switch(self.output, x, self.lower, self.upper);
        self.output
    }
}
