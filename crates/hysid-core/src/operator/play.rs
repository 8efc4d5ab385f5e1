//! Play: a slider dragged along by a slot of width `2 r`, the backlash of a pair of gears.
//!
//! ```text
//! p_k = min(x_k + r, max(x_k - r, p_{k-1}))                  theory.md (1.2)
//!
//! virgin: p = 0, hence p_0 = clip(0; x_0 - r, x_0 + r)
//! ```
//!
//! Only comparisons with `x ± r`: no rounding accumulates, however long the signal. The stop and
//! the deteriorating stop therefore keep their memory as a play.

use super::{InvalidOperator, Operator, is_usable};

/// The play after input `x`, given the `play` before: `min(x + r, max(x - r, play))`,
/// theory.md (1.2). All three in the unit of `x`, `r >= 0`.
///
/// Written as selects in place of [`f64::min`] and [`f64::max`], so that each is one machine
/// instruction. Their order is such that a NaN `x` leaves the play as it was.
#[inline(always)]
pub fn follow(play: f64, x: f64, r: f64) -> f64 {
    let (lower, upper) = (x - r, x + r);
    let pushed_up = if lower > play { lower } else { play };
    if upper < pushed_up { upper } else { pushed_up }
}

/// Play with threshold `r`: theory.md (1.2).
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
    ///
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
