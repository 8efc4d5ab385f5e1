//! Generalized plays with their memory: the law of
//! [`generalized_prandtl_ishlinskii`](hysid_core::law::generalized_prandtl_ishlinskii).
//!
//! ```text
//! S_k  = max(γ_l(v_k) - r, min(γ_r(v_k) + r, S_{k-1}))                      theory.md (6.13)
//! γ(v) = a0 tanh(a1 v + a2) + a3                                            theory.md (6.14)
//! y    = c + Σ_j p_j S_j,    r_j = α j,    p_j = ρ e^{-τ r_j}               theory.md (6.15)
//! ```
//!
//! `v_k` is sample `k` of the input, `S_j` the play with the threshold `r_j`, `γ_l` and `γ_r` are the
//! envelopes, `p_j` the weights and `y` the output.
//!
//! Source of the values: the programs of Al Janaideh (IEEE Control Systems Magazine lecture, 2022) and of
//! Basaeri.

use hysid_core::elementary::exp;
pub use hysid_core::law::generalized_prandtl_ishlinskii::{
    Envelope, GeneralizedPrandtlIshlinskii, PlayWeights,
};
use hysid_core::law::{Law, Sample};

/// Initial state of the plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlayStart {
    /// As close to 0 as the envelopes allow: the virgin state of a play.
    Virgin,
    /// On `γ_r + r`, as after a large input.
    Lowered,
}

/// A weighted sum of generalized plays, with its memory.
///
/// ```
/// use hysid_specimens::generalized_play::{Envelope, GeneralizedPlays, PlayWeights, PlayStart};
/// // One play on straight ground (nearly: tanh bends far away) is an ordinary play.
/// let line = Envelope::new([1e6, 1e-6, 0.0, 0.0]);
/// let weights = PlayWeights::Free(vec![0.0, 1.0]);
/// let mut plays = GeneralizedPlays::new([line, line], 1.0, weights, 0.0, PlayStart::Virgin);
/// let y = plays.run(&[0.0, 3.0, 2.0, 0.0, -3.0]);
/// for (y, expected) in y.iter().zip([0.0, 2.0, 2.0, 1.0, -2.0]) {
///     assert!((y - expected).abs() < 1e-9);
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedPlays {
    /// The law.
    pub law: GeneralizedPrandtlIshlinskii,
    /// `S` of each play.
    state: Vec<f64>,
}

impl GeneralizedPlays {
    /// The law with the envelopes `γ_l` and `γ_r` and thresholds `spacing` times 0, 1, ..., before its first sample.
    pub fn new(
        [left, right]: [Envelope; 2],
        spacing: f64,
        weights: PlayWeights,
        offset: f64,
        start: PlayStart,
    ) -> Self {
        let initial = match start {
            PlayStart::Virgin => 0.0,
            // Above any envelope.
            PlayStart::Lowered => 1e100,
        };
        let law = GeneralizedPrandtlIshlinskii { offset, left, right, initial, spacing, weights };
        Self { state: law.virgin(), law }
    }

    /// Weights `ρ e^{-τ α j}`, `j = 0, 1, ... count - 1`.
    pub fn exponential(count: usize, alpha: f64, rho: f64, tau: f64) -> PlayWeights {
        PlayWeights::Free((0..count).map(|j| rho * exp(-tau * (alpha * j as f64))).collect())
    }

    /// Returns to the initial state.
    pub fn reset(&mut self) {
        self.state = self.law.virgin();
    }

    /// The output at the next input. An input that is not finite gives NaN and leaves the memory unchanged.
    pub fn step(&mut self, v: f64) -> f64 {
        if !v.is_finite() {
            return f64::NAN;
        }
        self.law.step(&mut self.state, Sample { x: v, rate: 0.0, step: 0.0 })
    }

    /// The outputs at all inputs, from the initial state.
    pub fn run(&mut self, v: &[f64]) -> Vec<f64> {
        self.reset();
        v.iter().map(|&v| self.step(v)).collect()
    }
}
