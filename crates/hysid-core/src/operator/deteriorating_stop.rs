//! Deteriorating stop: a stop whose strength decreases in proportion to its slip, down to 0.
//!
//! ```text
//! s_k = s_{k-1} + |p_k - p_{k-1}|,   s_0 = 0                 theory.md (1.5)
//! z_k = ε_k max(0, 1 - s_k / (r β))                          theory.md (1.6)
//! ```
//!
//! `p_k` and `ε_k = x_k - p_k` are the [play](super::play) and the [stop](super::stop) of threshold `r`, and
//! `z_k` is the output, all in the unit of the input `x`. The *slip* `s_k` is the path length of the slider;
//! it stays constant while only the spring deforms. The movement from the virgin state to the first sample
//! does not count, because the record begins there. The *capacity* `β > 0` is a pure number: the output is 0
//! after a slip of `r β`. `β = ∞` is the plain stop.
//!
#![doc = "<figure>"]
#![doc = include_str!("deteriorating_stop.svg")]
#![doc = "</figure>"]
//!
//! A cycle of amplitude `V > r` adds the slip `4 (V - r)` (theory.md (1.8)). The life of the element is
//! therefore about `1/4 + (r β - (V - r)) / (4 (V - r))` cycles (theory.md (1.9)).
//!
//! Slip never decreases, so there is neither wiping-out nor congruency, and loops do not close.

use super::{InvalidOperator, Operator, checked_threshold, is_usable, play, stop};

/// The slip `slip + |play_after - play_before|` after the play has moved, in the unit of `x` (theory.md (1.5)).
#[inline(always)]
pub fn accumulate(slip: f64, play_before: f64, play_after: f64) -> f64 {
    slip + (play_after - play_before).abs()
}

/// The share of its strength that an element has left after `slip`, from 1 down to 0: `max(0, 1 - slip *
/// inverse_capacity)`, the factor of theory.md (1.6).
///
/// `inverse_capacity = 1 / (r β)` has the inverse unit of `x`; it is 0 for an element that does not
/// deteriorate.
#[inline(always)]
pub fn remaining_strength(slip: f64, inverse_capacity: f64) -> f64 {
    let strength = 1.0 - slip * inverse_capacity;
    if strength > 0.0 { strength } else { 0.0 }
}

/// Deteriorating stop with threshold `r` and capacity `β`: `z = ε max(0, 1 - s/(r β))`, with the stop `ε` and
/// the slip `s` (theory.md (1.6)).
///
/// ```
/// use hysid_core::operator::{DeterioratingStop, Operator};
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// let mut stop = DeterioratingStop::new(1.0, 4.0)?;
/// assert_eq!(stop.run(&[0.0, 1.0, 2.0, 0.0, -1.0]), [0.0, 1.0, 0.75, -0.75, -0.5]);
/// assert_eq!(stop.slip(), 2.0);
///
/// stop.step(3.0); // slides by 2 more: the capacity r β = 4 is used up
/// assert!(stop.is_dead());
/// assert_eq!(stop.step(0.0), 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DeterioratingStop {
    r: f64,
    inverse_capacity: f64,
    play: f64,
    slip: f64,
    started: bool,
}

impl DeterioratingStop {
    /// A virgin deteriorating stop with threshold `r` in the unit of `x` and capacity `beta`, a pure number:
    /// its output is 0 after a slip of `r beta`. With an infinite `beta` its outputs are those of a
    /// [`Stop`](super::Stop), bit for bit.
    ///
    /// # Errors
    /// [`InvalidOperator::Threshold`] unless `r` is finite and greater than 0, [`InvalidOperator::Capacity`]
    /// unless `beta` is greater than 0.
    pub fn new(r: f64, beta: f64) -> Result<Self, InvalidOperator> {
        let r = checked_threshold(r)?;
        // NaN is not greater than 0 either.
        if beta > 0.0 {
            Ok(Self { r, inverse_capacity: 1.0 / (r * beta), play: 0.0, slip: 0.0, started: false })
        } else {
            Err(InvalidOperator::Capacity(beta))
        }
    }

    /// The slip since the first sample, `Σ |p_k - p_{k-1}|`, in the unit of `x` (theory.md (1.5)).
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// True once the slip has reached `r β`: every further output is 0.
    pub fn is_dead(&self) -> bool {
        remaining_strength(self.slip, self.inverse_capacity) == 0.0
    }
}

impl Operator for DeterioratingStop {
    fn reset(&mut self) {
        self.play = 0.0;
        self.slip = 0.0;
        self.started = false;
    }

    fn step(&mut self, x: f64) -> f64 {
        if !is_usable(x) {
            return f64::NAN;
        }
        let play = play::follow(self.play, x, self.r);
        if self.started {
            self.slip = accumulate(self.slip, self.play, play);
        }
        self.play = play;
        self.started = true;
        stop::elongation(x, play) * remaining_strength(self.slip, self.inverse_capacity)
    }
}
