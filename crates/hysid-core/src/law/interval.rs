//! Intervals of numbers, for bounds of outputs.
//!
//! ```text
//! play: min(0, l + r) … max(0, u - r);    stop: max(-r, l - p_max) … min(r, u - p_min)
//! relaxation: l - max(0, u) … u - min(0, l)                  theory.md (10.42)
//! ```
//!
//! The input lies between `l` and `u`, and the operator was virgin at first; `r` is its threshold, `p_min`
//! and `p_max` are the bounds of the play.

/// All numbers from the first to the second, both included; either may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval(pub f64, pub f64);

impl Interval {
    /// All numbers.
    pub const ALL: Self = Self(f64::NEG_INFINITY, f64::INFINITY);

    /// The numbers within a distance of a value.
    pub fn about(value: f64, by: f64) -> Self {
        Self(value - by, value + by)
    }

    /// A single number.
    pub fn point(value: f64) -> Self {
        Self(value, value)
    }

    /// Sums of a number of each.
    pub fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    /// The multiples of its numbers; infinity times 0 is 0.
    pub fn times(self, factor: f64) -> Self {
        if factor == 0.0 {
            return Self::point(0.0);
        }
        let (a, b) = (factor * self.0, factor * self.1);
        Self(a.min(b), a.max(b))
    }

    /// The interval extended to 0.
    pub fn with_zero(self) -> Self {
        Self(self.0.min(0.0), self.1.max(0.0))
    }

    /// The interval extended so that it contains the negative of each of its numbers.
    pub fn with_its_negative(self) -> Self {
        Self::about(0.0, self.0.abs().max(self.1.abs()))
    }

    /// The intersection.
    pub fn common(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.min(other.1))
    }

    /// The values of a non-decreasing function.
    pub fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self(function(self.0), function(self.1))
    }

    /// The outputs of a play of threshold `r` with inputs in this interval.
    pub fn play(self, r: f64) -> Self {
        Self((self.0 + r).min(0.0), (self.1 - r).max(0.0))
    }

    /// The outputs of a stop of threshold `r` with inputs in this interval.
    pub fn stop(self, r: f64) -> Self {
        let play = self.play(r);
        Self((self.0 - play.1).max(-r), (self.1 - play.0).min(r))
    }

    /// The outputs of a relaxation element with inputs in this interval: the input minus a mean of earlier
    /// inputs and 0.
    pub fn relaxation(self) -> Self {
        let earlier = self.with_zero();
        Self(self.0 - earlier.1, self.1 - earlier.0)
    }

    /// Sums of a number of each.
    pub fn sum(terms: impl IntoIterator<Item = Self>) -> Self {
        terms.into_iter().fold(Self::point(0.0), Self::plus)
    }
}
