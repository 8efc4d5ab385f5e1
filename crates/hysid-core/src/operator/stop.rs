//! Stop: a spring in series with a slider, elastic up to the threshold and then sliding at constant force.
//!
//! ```text
//! ε_k = clip(ε_{k-1} + x_k - x_{k-1}; -r, r)                 theory.md (1.3)
//! ε_k = x_k - p_k      with the play p of the same r         theory.md (1.4)
//!
//! virgin: ε_0 = clip(x_0; -r, r)
//! ```
//!
//! `x_k` is sample `k` of the input, `r > 0` the threshold, `ε_k` the output; all have the unit of `x`.
//! `clip(a; l, u) = min(u, max(l, a))`.
//!
#![doc = "<figure>"]
#![doc = include_str!("stop.svg")]
#![doc = "</figure>"]
//!
//! The output is computed as `x - p` with the [play] `p`. The sum in the first equation would accumulate a
//! rounding error with each sample; the play does not.
//!
//! A cycle of amplitude `V > r` encloses the area `4 r (V - r)` in the plane of input and output (theory.md
//! (1.7)).

use super::{InvalidOperator, Operator, checked_threshold, is_usable, play};

/// The output of a stop at input `x`: `x - play` of the same threshold, in the unit of `x` (theory.md (1.4)).
#[inline(always)]
pub fn elongation(x: f64, play: f64) -> f64 {
    x - play
}

/// Stop with threshold `r`: `ε_k = clip(ε_{k-1} + x_k - x_{k-1}; -r, r)` (theory.md (1.3)).
///
/// ```
/// use hysid_core::operator::{Operator, Stop};
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// let mut stop = Stop::new(1.0)?;
/// assert_eq!(stop.run(&[0.0, 0.5, 3.0, 2.5, 0.0]), [0.0, 0.5, 1.0, 0.5, -1.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    r: f64,
    play: f64,
}

impl Stop {
    /// A virgin stop with threshold `r` in the unit of `x`: the largest magnitude of its output.
    ///
    /// # Errors
    /// [`InvalidOperator::Threshold`] unless `r` is finite and greater than 0.
    pub fn new(r: f64) -> Result<Self, InvalidOperator> {
        Ok(Self { r: checked_threshold(r)?, play: 0.0 })
    }
}

impl Operator for Stop {
    fn reset(&mut self) {
        self.play = 0.0;
    }

    fn step(&mut self, x: f64) -> f64 {
        if !is_usable(x) {
            return f64::NAN;
        }
        self.play = play::follow(self.play, x, self.r);
        elongation(x, self.play)
    }
}
