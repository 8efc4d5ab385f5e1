//! Optimisers, one of each kind, which are independent of hysteresis models.

pub mod genetic;
pub mod levenberg_marquardt;
pub(crate) mod multi_start;
pub(crate) mod non_negative;
pub(crate) mod parallel;
pub(crate) mod random;
pub(crate) mod ridge;
pub mod space_dilatation;
pub(crate) mod stall;

/// Most epochs or evaluations that a stored state may count.
pub(crate) const MOST_COUNTED: usize = 1 << 50;
