//! Relaxation: a spring in series with a dashpot (Maxwell element), whose stress decays while the input is
//! held.
//!
//! ```text
//! σ' = x' - σ / τ                                            theory.md (1.10)
//!
//! σ_k = E σ_{k-1} + G (x_k - x_{k-1})                        theory.md (1.11)
//! E = e^{-h/τ},   G = (τ/h) (1 - e^{-h/τ}),   h = t_k - t_{k-1}
//!
//! virgin: σ_0 = x_0
//! ```
//!
//! `x_k` is the input and `σ_k` the stress at the time `t_k`, both in the unit of `x`; `τ > 0` is the
//! relaxation time and `h` the time step, in one unit of time. A prime is a derivative with respect to time.
//! The first sample is an instantaneous load of the spring.
//!
//! The second equation solves the first exactly for an input that is linear between samples. The step `h` can
//! therefore have any length.
//!
//! Limits: `τ -> ∞` is a spring, `σ = x`; `τ -> 0` is a dashpot, `σ = τ x'`.

use super::{InvalidOperator, is_usable};
use crate::elementary::{exp, exp_m1};

/// The factors of one time step, `E = e^{-h/τ}` for the present stress and `G = (τ/h) (1 - e^{-h/τ})` for the
/// increment of the input, both between 0 and 1 (theory.md (1.11)).
///
/// `time_step` is `h`, and `tau > 0`, in the same unit of time. `time_step = 0`, a jump of the input, gives
/// exactly `(1, 1)`; a negative or NaN `time_step` counts as 0. An infinite `time_step`, after which nothing is
/// left of any stress, gives `(0, 0)`, except for an infinite `tau`, a spring, which gives `(1, 1)`. Short steps
/// cause no cancellation.
#[inline(always)]
pub fn decay(time_step: f64, tau: f64) -> (f64, f64) {
    let steps = time_step / tau;
    if steps > 0.0 { (exp(-steps), -exp_m1(-steps) / steps) } else { (1.0, 1.0) }
}

/// The stress `E stress + G x_increment` after a step, with the factors of [`decay`], in the unit of `x` (theory.md
/// (1.11)).
#[inline(always)]
pub fn advance(stress: f64, x_increment: f64, (e, g): (f64, f64)) -> f64 {
    e * stress + g * x_increment
}

/// Relaxation element with relaxation time `τ`: `σ' = x' - σ/τ` (theory.md (1.10)).
///
/// It does not implement [`Operator`](super::Operator), whose input is a sequence of values without times. A
/// fixed time step would be wrong for records that are not evenly sampled.
///
/// ```
/// use hysid_core::operator::Relaxation;
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// // Stretched to 1 and held: a third of the stress is left after ln 3 relaxation times.
/// let mut element = Relaxation::new(2.0)?;
/// let stress = element.run(&[0.0, 2.0 * 3f64.ln()], &[1.0, 1.0])?;
/// assert_eq!(stress[0], 1.0);
/// assert!((stress[1] - 1.0 / 3.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    tau: f64,
    stress: f64,
    x: f64,
    started: bool,
}

impl Relaxation {
    /// A virgin element with relaxation time `tau`, in the unit of time of the steps. With an infinite `tau`
    /// it is a spring.
    ///
    /// # Errors
    /// [`InvalidOperator::RelaxationTime`] unless `tau` is greater than 0.
    pub fn new(tau: f64) -> Result<Self, InvalidOperator> {
        // NaN is not greater than 0 either.
        if tau > 0.0 {
            Ok(Self { tau, stress: 0.0, x: 0.0, started: false })
        } else {
            Err(InvalidOperator::RelaxationTime(tau))
        }
    }

    /// Returns to the virgin state.
    pub fn reset(&mut self) {
        self.stress = 0.0;
        self.x = 0.0;
        self.started = false;
    }

    /// Advances to the next sample of the input, `time_step` after the previous one, and returns the stress
    /// there, in the unit of `x`.
    ///
    /// The first sample is an instantaneous load: the stress is `x`, and its `time_step` is ignored. A
    /// `time_step` that is 0, negative or NaN is a jump of the input. `x` must be finite (see the [module of
    /// operators](super)).
    pub fn step(&mut self, x: f64, time_step: f64) -> f64 {
        if !is_usable(x) {
            return f64::NAN;
        }
        let time_step = if self.started { time_step } else { 0.0 };
        self.stress = advance(self.stress, x - self.x, decay(time_step, self.tau));
        self.x = x;
        self.started = true;
        self.stress
    }

    /// Runs over a whole signal from the virgin state and returns the stress at each sample, in the unit of
    /// `x`. `time` has one value for each value of `x`; equal successive times are a jump of the input. The
    /// element is then in the state after the last sample.
    ///
    /// # Errors
    /// [`InvalidOperator::Lengths`] if `time` and `x` differ in length; [`InvalidOperator::TimeNotFinite`]
    /// and [`InvalidOperator::TimeDecreases`] with the first row, counted from 0, where `time` is not finite
    /// or decreases. The element is then unchanged.
    pub fn run(&mut self, time: &[f64], x: &[f64]) -> Result<Vec<f64>, InvalidOperator> {
        if time.len() != x.len() {
            return Err(InvalidOperator::Lengths { times: time.len(), inputs: x.len() });
        }
        for (row, &t) in time.iter().enumerate() {
            if !t.is_finite() {
                return Err(InvalidOperator::TimeNotFinite { row, time: t });
            }
            if row > 0 && t < time[row - 1] {
                return Err(InvalidOperator::TimeDecreases { row, previous: time[row - 1], time: t });
            }
        }
        self.reset();
        let mut previous = time.first().copied().unwrap_or_default();
        let step_to = |(&t, &x): (&f64, &f64)| {
            let stress = self.step(x, t - previous);
            previous = t;
            stress
        };
        Ok(time.iter().zip(x).map(step_to).collect())
    }
}
