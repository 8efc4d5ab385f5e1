//! Relay: a switch with two thresholds, the elementary operator of the Preisach model.
//!
//! ```text
//!        +1             if x_k >= s + r
//! R_k =  -1             if x_k <= s - r                      theory.md (1.1)
//!        R_{k-1}        in between
//!
//! virgin: R = -1 if s > 0, else +1
//! ```
//!
//! `x_k` is sample `k` of the input, `r > 0` the half-width and `s` the centre of the relay, all in the unit
//! of `x`. The output is a pure number.
//!
//! `(r, s)` is a point of the Preisach half-plane. The relay is `+1` where the [play](super::play) `p` of the
//! same `r` is above `s`, and `-1` where it is below. The plays of all `r` together are therefore the whole
//! memory of a Preisach model.

use super::{InvalidOperator, Operator, checked_threshold, is_usable};

/// The output of a virgin relay with centre `s`: -1 if `s > 0`, else +1 (theory.md (1.1)).
#[inline(always)]
pub fn virgin(s: f64) -> f64 {
    if s > 0.0 { -1.0 } else { 1.0 }
}

/// The output of a relay at input `x`: +1 if `x >= upper`, -1 if `x <= lower`, else its previous `output`, -1
/// or +1 (theory.md (1.1)). `lower = s - r` and `upper = s + r` are in the unit of `x`.
#[inline(always)]
pub fn switch(output: f64, x: f64, lower: f64, upper: f64) -> f64 {
    let output = if x >= upper { 1.0 } else { output };
    if x <= lower { -1.0 } else { output }
}

/// Relay with half-width `r` and centre `s`: switches to +1 at the input `s + r` and to -1 at `s - r`
/// (theory.md (1.1)).
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
