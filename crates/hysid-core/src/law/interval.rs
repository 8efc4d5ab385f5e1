//! Intervals of numbers, for bounds of outputs: theory.md (10.42).

/// All numbers from the first to the second; either may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval(pub f64, pub f64);

impl Interval {
    /// All numbers.
    pub const ALL: Self = Self(f64::NEG_INFINITY, f64::INFINITY);

    /// All numbers within a distance of a value.
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

    /// Multiples; infinity times 0 is 0.
    pub fn times(self, factor: f64) -> Self {
        if factor == 0.0 {
            return Self::point(0.0);
        }
        let (a, b) = (factor * self.0, factor * self.1);
        Self(a.min(b), a.max(b))
    }

    /// The same and all up to 0.
    pub fn with_zero(self) -> Self {
        Self(self.0.min(0.0), self.1.max(0.0))
    }

    /// The same and what has the other sign.
    pub fn with_its_negative(self) -> Self {
        Self::about(0.0, self.0.abs().max(self.1.abs()))
    }

    /// What lies in both.
    pub fn common(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.min(other.1))
    }

    /// Values of a function that never falls.
    pub fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self(function(self.0), function(self.1))
    }

    /// A play of threshold `r` that was virgin once.
    pub fn play(self, r: f64) -> Self {
        Self((self.0 + r).min(0.0), (self.1 - r).max(0.0))
    }

    /// The stop that belongs to it.
    pub fn stop(self, r: f64) -> Self {
        let play = self.play(r);
        Self((self.0 - play.1).max(-r), (self.1 - play.0).min(r))
    }

    /// A relaxation element: what it holds is the input less a mean of earlier ones and of 0.
    pub fn relaxation(self) -> Self {
        let earlier = self.with_zero();
        Self(self.0 - earlier.1, self.1 - earlier.0)
    }

    /// Sums of a number of each.
    pub fn sum(terms: impl IntoIterator<Item = Self>) -> Self {
        terms.into_iter().fold(Self::point(0.0), Self::plus)
    }
}
