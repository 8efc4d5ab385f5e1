//! Relaxation: a spring and a dashpot in series (Maxwell element); what is stretched and then held
//! relaxes in time.
//!
//! ```text
//! σ' = x' - σ / τ                                            theory.md (1.10)
//!
//! σ_k = E σ_{k-1} + G (x_k - x_{k-1})                        theory.md (1.11)
//! E = e^{-h/τ},   G = (τ/h) (1 - e^{-h/τ}),   h = t_k - t_{k-1}
//!
//! virgin: σ = 0; the first sample is an instantaneous load of the spring: σ_0 = x_0
//! ```
//!
//! (1.11) is the exact solution of (1.10) for an input that runs straight from sample to sample,
//! whatever the step `h`: unlike with a difference scheme there is no step size to keep small, and
//! halving all steps of a straight piece changes nothing.
//!
//! Limits: `τ -> ∞` is a spring, `σ = x`; `τ -> 0` a dashpot, `σ = τ x'`.

use super::{InvalidOperator, is_usable};

/// The factors `(E, G)` of theory.md (1.11) for a step of length `time_step`: `E = e^{-h/τ}` for
/// the stress already there, `G = (τ/h) (1 - e^{-h/τ})` for the input increment. Both lie between 0
/// and 1.
///
/// `time_step` and `tau > 0` in the same unit of time. Without cancellation for short steps, and
/// exactly `(1, 1)` for `time_step = 0`, a jump of the input. A `time_step` that is negative or NaN
/// is taken as 0.
#[inline(always)]
pub fn decay(time_step: f64, tau: f64) -> (f64, f64) {
    let steps = time_step / tau;
    if steps > 0.0 { ((-steps).exp(), -(-steps).exp_m1() / steps) } else { (1.0, 1.0) }
}

/// The stress after the input has moved by `x_increment`, given the `stress` before and the factors
/// of [`decay`]: theory.md (1.11). In the unit of `x`.
#[inline(always)]
pub fn advance(stress: f64, x_increment: f64, (e, g): (f64, f64)) -> f64 {
    e * stress + g * x_increment
}

/// Relaxation element with relaxation time `τ`: theory.md (1.10).
///
/// It has no [`Operator`](super::Operator) trait: that one feeds inputs alone, which suffices where
/// only their sequence counts. This element must also be told how much time has passed, and to hide
/// a fixed time step in it would be wrong for every record that is not evenly sampled.
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
    /// A virgin element with relaxation time `tau`, in the unit of time of the steps. With `tau`
    /// infinite it is a spring.
    ///
    /// # Errors
    ///
    /// [`InvalidOperator::RelaxationTime`] unless `tau` is greater than 0.
    pub fn new(tau: f64) -> Result<Self, InvalidOperator> {
        // NaN is not greater than 0 either.
        if tau > 0.0 {
            Ok(Self { tau, stress: 0.0, x: 0.0, started: false })
        } else {
            Err(InvalidOperator::RelaxationTime(tau))
        }
    }

    /// Back to the virgin state, as if no input had been seen.
    pub fn reset(&mut self) {
        self.stress = 0.0;
        self.x = 0.0;
        self.started = false;
    }

    /// Takes the next input sample, `time_step` after the one before, and returns the stress there,
    /// in the unit of `x`.
    ///
    /// The first sample counts as an instantaneous load, so its `time_step` does not matter and the
    /// stress is `x`. A `time_step` that is 0 is a jump of the input, and so is one that is
    /// negative or NaN. `x` must be finite (see the [module of operators](super)).
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

    /// The stresses at all samples of a whole signal from the virgin state: resets first, and
    /// leaves the element in the state after the last sample. Equal successive times are a jump of
    /// the input.
    ///
    /// # Errors
    ///
    /// [`InvalidOperator::Lengths`] if `time` and `x` differ in length;
    /// [`InvalidOperator::TimeNotFinite`] and [`InvalidOperator::TimeDecreases`] with the first
    /// row, counted from 0, where `time` is NaN or infinite, or runs backwards. The element is then
    /// as it was before.
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
