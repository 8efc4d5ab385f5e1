//! Play: a slider dragged by a slot of width `2 r`, like the backlash of gears.
//!
//! ```text
//! p_k = min(x_k + r, max(x_k - r, p_{k-1}))                  theory.md (1.2)
//!
//! virgin: p_0 = min(x_0 + r, max(x_0 - r, 0))
//! ```
//!
//! `x_k` is sample `k` of the input, `r >= 0` the threshold, `p_k` the output; all have the unit of `x`. The
//! play rests until the input has moved `2 r` away from its last turning point, and then follows at the
//! distance `r`.
//!
#![doc = "<figure>"]
#![doc = include_str!("play.svg")]
#![doc = "</figure>"]
//!
//! A sample is only compared with `p` and never added to a sum, so no rounding error accumulates. The
//! [stop](super::stop) and the [deteriorating stop](super::deteriorating_stop) therefore store their memory
//! as a play.

use super::{InvalidOperator, Operator, is_usable};

/// The play at input `x`, from its previous value `play`: `min(x + r, max(x - r, play))` (theory.md (1.2)).
/// All three arguments are in the unit of `x`, with `r >= 0`.
///
/// The order of the comparisons is such that a NaN `x` leaves the play unchanged. They are written as selects
/// instead of [`f64::min`] and [`f64::max`], so that each is one machine instruction.
#[inline(always)]
pub fn follow(play: f64, x: f64, r: f64) -> f64 {
    let (lower, upper) = (x - r, x + r);
    let pushed_up = if lower > play { lower } else { play };
    if upper < pushed_up { upper } else { pushed_up }
}

/// Play with threshold `r`: `p_k = min(x_k + r, max(x_k - r, p_{k-1}))` (theory.md (1.2)).
///
/// ```
/// use hysid_core::operator::{Operator, Play};
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// let mut play = Play::new(1.0)?;
/// assert_eq!(play.run(&[0.0, 3.0, 2.0, 0.0, -3.0]), [0.0, 2.0, 2.0, 1.0, -2.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Play {
    r: f64,
    play: f64,
}

impl Play {
    /// A virgin play with threshold `r`, half the width of its slot, in the unit of `x`. With `r =
    /// 0` it is the identity.
    ///
    /// # Errors
    /// [`InvalidOperator::PlayThreshold`] unless `r` is finite and at least 0.
    pub fn new(r: f64) -> Result<Self, InvalidOperator> {
        if r.is_finite() && r >= 0.0 {
            Ok(Self { r, play: 0.0 })
        } else {
            Err(InvalidOperator::PlayThreshold(r))
        }
    }
}

impl Operator for Play {
    fn reset(&mut self) {
        self.play = 0.0;
    }

    fn step(&mut self, x: f64) -> f64 {
        if !is_usable(x) {
            return f64::NAN;
        }
        self.play = follow(self.play, x, self.r);
        self.play
    }
}
