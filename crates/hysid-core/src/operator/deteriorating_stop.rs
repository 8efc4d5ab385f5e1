//! Deteriorating stop: a stop that loses strength as it slides, until nothing is left.
//!
//! ```text
//! s_k = s_{k-1} + |p_k - p_{k-1}|,   s_0 = 0                 theory.md (1.5)
//! y_k = ε_k max(0, 1 - s_k / (r β))                          theory.md (1.6)
//! ```
//!
//! `p` and `ε` are play and stop of threshold `r`. The slip `s` is the way slid; while the spring
//! only stretches, it stays. The jump from the virgin state to the first sample is not counted: the
//! record starts there. The capacity `β` says how many thresholds `r` the element can slide until
//! it is dead; `β = ∞` never deteriorates.
//!
//! A cycle of amplitude `V > r` slips `4 (V - r)`, theory.md (1.8), which gives the life in cycles,
//! theory.md (1.9).
//!
//! Slip never heals, so there is neither wiping-out nor congruency, and loops do not close.

use super::{InvalidOperator, Operator, checked_threshold, is_usable, play, stop};

/// The slip after the play has moved from `play_before` to `play_after`, given the `slip` before:
/// theory.md (1.5). In the unit of `x`.
#[inline(always)]
pub fn accumulate(slip: f64, play_before: f64, play_after: f64) -> f64 {
    slip + (play_after - play_before).abs()
}

/// The share of its strength, 1 down to 0, that is left to an element after `slip`: `max(0, 1 -
/// slip * inverse_capacity)`, the factor of theory.md (1.6).
///
/// `inverse_capacity = 1 / (r β)` in one over the unit of `x`; 0 for an element that never
/// deteriorates.
#[inline(always)]
pub fn remaining_strength(slip: f64, inverse_capacity: f64) -> f64 {
    let strength = 1.0 - slip * inverse_capacity;
    if strength > 0.0 { strength } else { 0.0 }
}

/// Deteriorating stop with threshold `r` and capacity `β`: theory.md (1.6).
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
    /// A virgin deteriorating stop with threshold `r` in the unit of `x` and capacity `beta`, a
    /// pure number: it dies after sliding `r beta`. With `beta` infinite it never deteriorates and
    /// is a [`Stop`](super::Stop), bit for bit.
    ///
    /// # Errors
    ///
    /// [`InvalidOperator::Threshold`] unless `r` is finite and greater than 0,
    /// [`InvalidOperator::Capacity`] unless `beta` is greater than 0.
    pub fn new(r: f64, beta: f64) -> Result<Self, InvalidOperator> {
        let r = checked_threshold(r)?;
        // NaN is not greater than 0 either.
        if beta > 0.0 {
            Ok(Self { r, inverse_capacity: 1.0 / (r * beta), play: 0.0, slip: 0.0, started: false })
        } else {
            Err(InvalidOperator::Capacity(beta))
        }
    }

    /// The way slid since the first sample, in the unit of `x`: theory.md (1.5).
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// Whether the capacity is used up: every output from now on is 0.
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
