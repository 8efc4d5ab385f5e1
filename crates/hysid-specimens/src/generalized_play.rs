//! Generalized Prandtl-Ishlinskii law: plays between two bent envelopes in place of two straight lines.
//!
//! ```text
//! S_k  = max(γ_l(v_k) - r, min(γ_r(v_k) + r, S_{k-1}))                     theory.md (6.13)
//! γ(v) = a0 tanh(a1 v + a2) + a3                                           theory.md (6.14)
//! y    = c + Σ_j p_j S_j,   r_j = α j,   p_j = ρ e^{-τ r_j}                theory.md (6.15)
//! ```
//!
//! Each play follows `γ_l - r` upwards and `γ_r + r` downwards and rests in between; `γ_l ≤ γ_r` over
//! the range of the input `v`. Source: Al Janaideh, Rakheja and Su; form, envelopes and weights as in
//! the programs of Al Janaideh (IEEE Control Systems Magazine lecture, 2022) and of Basaeri.

/// An envelope `a0 tanh(a1 v + a2) + a3`: theory.md (6.14).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// `a0, a1, a2, a3`: height, steepness in one over the unit of the input, shift, offset.
    pub a: [f64; 4],
}

impl Envelope {
    /// The envelope at input `v`.
    pub fn value(&self, v: f64) -> f64 {
        let [a0, a1, a2, a3] = self.a;
        a0 * (a1 * v + a2).tanh() + a3
    }
}

/// Where the plays are at the first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// As near to 0 as the envelopes allow: the virgin state of a play.
    Virgin,
    /// On `γ_r + r`, as after a large input that has been lowered.
    Lowered,
}

/// One play of the sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPlay {
    /// Threshold `r`, not negative, in the unit of the envelopes.
    pub threshold: f64,
    /// Weight `p`, in the unit of the output for a unit of the envelopes.
    pub weight: f64,
}

/// A weighted sum of generalized plays, with its memory.
///
/// ```
/// use hysid_specimens::generalized_play::{Envelope, GeneralizedPlays, Start, WeightedPlay};
/// // One play on straight ground (nearly: tanh bends far away) is an ordinary play.
/// let line = Envelope { a: [1e6, 1e-6, 0.0, 0.0] };
/// let play = WeightedPlay { threshold: 1.0, weight: 1.0 };
/// let mut law = GeneralizedPlays::new([line, line], vec![play], 0.0, Start::Virgin);
/// let y = law.run(&[0.0, 3.0, 2.0, 0.0, -3.0]);
/// for (y, expected) in y.iter().zip([0.0, 2.0, 2.0, 1.0, -2.0]) {
///     assert!((y - expected).abs() < 1e-9);
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedPlays {
    /// `γ_l`, followed upwards.
    pub left: Envelope,
    /// `γ_r`, followed downwards; nowhere below `γ_l` in the range of the input.
    pub right: Envelope,
    /// `c`, in the unit of the output.
    pub offset: f64,
    /// Where the plays are at first.
    pub start: Start,
    terms: Vec<WeightedPlay>,
    /// `S` of each play; empty before the first sample.
    state: Vec<f64>,
}

impl GeneralizedPlays {
    /// The law with the envelopes `γ_l` and `γ_r`, before its first sample.
    pub fn new([left, right]: [Envelope; 2], terms: Vec<WeightedPlay>, offset: f64, start: Start) -> Self {
        Self { left, right, offset, start, terms, state: Vec::new() }
    }

    /// Plays with thresholds `α j` and weights `ρ e^{-τ α j}`, `j = 0, 1, ... count - 1`.
    pub fn exponential_terms(count: usize, alpha: f64, rho: f64, tau: f64) -> Vec<WeightedPlay> {
        let term = |j| {
            let threshold = alpha * j as f64;
            WeightedPlay { threshold, weight: rho * (-tau * threshold).exp() }
        };
        (0..count).map(term).collect()
    }

    /// The plays of the sum.
    pub fn terms(&self) -> &[WeightedPlay] {
        &self.terms
    }

    /// Back to before the first sample.
    pub fn reset(&mut self) {
        self.state.clear();
    }

    /// The output at the next input. An input that is not finite gives NaN and leaves the memory as it
    /// was.
    pub fn step(&mut self, v: f64) -> f64 {
        if !v.is_finite() {
            return f64::NAN;
        }
        let (left, right) = (self.left.value(v), self.right.value(v));
        if self.state.is_empty() {
            let first = match self.start {
                Start::Virgin => 0.0,
                Start::Lowered => f64::INFINITY,
            };
            self.state = vec![first; self.terms.len()];
        }
        let mut y = self.offset;
        for (term, s) in self.terms.iter().zip(&mut self.state) {
            *s = (left - term.threshold).max((right + term.threshold).min(*s));
            y += term.weight * *s;
        }
        y
    }

    /// The outputs at all inputs, from before the first sample.
    pub fn run(&mut self, v: &[f64]) -> Vec<f64> {
        self.reset();
        v.iter().map(|&v| self.step(v)).collect()
    }
}
