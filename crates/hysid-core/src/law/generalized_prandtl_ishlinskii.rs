//! Generalized Prandtl-Ishlinskii model: plays between two curved envelopes, which can saturate and be
//! asymmetric.
//!
//! ```text
//! S_k  = max(γ_l(x_k) - r, min(γ_r(x_k) + r, S_{k-1}))                      theory.md (8.12), (6.13)
//! γ(x) = a0 tanh(a1 x + a2) + a3                                            theory.md (8.13), (6.14)
//! y    = c + Σ_j p(r_j) S_j,   r_j = α j,   j = 0 ... N                     theory.md (8.14), (6.15)
//! ```
//!
//! `x_k` is sample `k` of the input, `S_j` the play with the threshold `r_j`, `γ_l` and `γ_r` are the
//! envelopes, `p` the weights and `y` the output. A play follows `γ_l - r` upwards and `γ_r + r` downwards,
//! and rests in between. Thresholds and envelopes are pure numbers; the weights have the unit of the output.
//!
//! Properties: rate-independent, with return-point memory. Source: Al Janaideh, Rakheja and Su (2010, 2011);
//! the form with eleven parameters is that of the program of Basaeri et al. (2019).

use serde::{Deserialize, Serialize};

use crate::elementary::tanh;
use crate::error::{LARGEST_VALUE, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts};
pub use crate::law::play_weights::PlayWeights;
use crate::law::properties::{CONGRUENT, WIPES_OUT};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// An envelope `γ(x) = a0 tanh(a1 x + a2) + a3`, a pure number (theory.md (8.13)).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// Height, not negative.
    pub a0: f64,
    /// Steepness, not negative, in one over the unit of the input.
    pub a1: f64,
    /// Shift.
    pub a2: f64,
    /// Level.
    pub a3: f64,
}

impl Envelope {
    /// The envelope from `[a0, a1, a2, a3]`.
    pub fn new([a0, a1, a2, a3]: [f64; 4]) -> Self {
        Self { a0, a1, a2, a3 }
    }

    /// The envelope at an input.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        self.a0 * tanh(self.a1 * x + self.a2) + self.a3 // (8.13)
    }

    fn parameters(&self, side: char) -> [Parameter; 4] {
        let (any, positive) = ((-LARGEST_VALUE, LARGEST_VALUE), (0.0, LARGEST_VALUE));
        let steepness = Dimension { input: -1, output: 0, time: 0 };
        let symbol = |name: &str| format!("{name}{side}");
        [
            Parameter::new(symbol("a0_"), "height of an envelope", self.a0, positive, Dimension::NONE),
            Parameter::new(symbol("a1_"), "steepness of an envelope", self.a1, positive, steepness),
            Parameter::new(symbol("a2_"), "shift of an envelope", self.a2, any, Dimension::NONE),
            Parameter::new(symbol("a3_"), "level of an envelope", self.a3, any, Dimension::NONE),
        ]
    }
}

/// The next value of a play: `max(left - r, min(right + r, play))` between the envelopes (theory.md (8.12)).
#[inline(always)]
pub fn follow(play: f64, left: f64, right: f64, r: f64) -> f64 {
    (left - r).max((right + r).min(play)) // (8.12)
}

/// A generalized Prandtl-Ishlinskii model in the user's units: `y = c + Σ_j p(r_j) S_j` (theory.md (8.14)).
///
/// ```
/// use hysid_core::law::generalized_prandtl_ishlinskii::*;
/// use hysid_core::law::{Law, Sample};
/// let gamma = Envelope::new([6.0, 0.4, 0.0, 0.0]);
/// let law = GeneralizedPrandtlIshlinskii {
///     offset: 0.0,
///     left: gamma,
///     right: gamma,
///     initial: 0.0,
///     spacing: 0.45,
///     weights: PlayWeights::Exponential { plays: 7, rho: 0.65, tau: 7.75e-4 },
/// };
/// let mut state = law.virgin();
/// let y = law.step(&mut state, Sample { x: 5.0, rate: 0.0, step: 0.0 });
/// assert!((y - 20.157).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeneralizedPrandtlIshlinskii {
    /// `c`, in the unit of the output.
    pub offset: f64,
    /// `γ_l`, followed upwards.
    pub left: Envelope,
    /// `γ_r`, followed downwards.
    pub right: Envelope,
    /// Value of every play before the first sample: 0 for virgin; above `γ_r + r` on the descending envelope.
    pub initial: f64,
    /// `α`: spacing of the thresholds, a pure number, not negative.
    pub spacing: f64,
    /// `p_j`, in the unit of the output.
    pub weights: PlayWeights,
}

impl Law for GeneralizedPrandtlIshlinskii {
    type State = Vec<f64>;

    const FACTS: Facts = Facts {
        advice: &[(Behaviour::UnlikeBranches, Advised::FewerParameters("if its envelopes fit"))],
        ..Facts::searched(
            "generalized-prandtl-ishlinskii",
            "plays between two tanh envelopes",
            &["operators", "free_weights", "starts", "epochs"],
            ErrorsInside { softening: 0.15, sigmoid: 0.06, other: 0.6 },
        )
        .with_defaults(&[("operators", 10), ("starts", 32), ("epochs", 60)])
    };

    fn virgin(&self) -> Vec<f64> {
        vec![self.initial; self.weights.plays()]
    }

    fn step(&self, state: &mut Vec<f64>, sample: Sample) -> f64 {
        let sample = sample.limited();
        let (left, right) = (self.left.value(sample.x), self.right.value(sample.x));
        let mut y = self.offset;
        let mut r = 0.0;
        self.weights.for_each(self.spacing, 0, |index, weight| {
            let play = &mut state[index];
            *play = follow(*play, left, right, r);
            y += weight * *play; // (8.14)
            r = self.spacing * (index + 1) as f64;
        });
        y
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let mut all = vec![Parameter::new("c", "level of the output", self.offset, any, Dimension::OUTPUT)];
        all.extend(self.left.parameters('l'));
        all.extend(self.right.parameters('r'));
        all.extend(Parameter::table([
            ("S_-1", "plays before the first sample", self.initial, any, Dimension::NONE),
            ("α", "spacing of the thresholds", self.spacing, (0.0, LARGEST_VALUE), Dimension::NONE),
        ]));
        all.extend(self.weights.parameters("p", 0, Dimension::OUTPUT, Dimension::NONE));
        all
    }

    fn validated(self) -> Result<Self> {
        const NAME: &str = "generalized Prandtl-Ishlinskii";
        Parameter::check_all(&self.parameters(), NAME)?;
        self.weights.check(NAME, self.spacing, 0)?;
        Ok(self)
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT]].concat()
    }
}
