//! Rate-dependent Prandtl-Ishlinskii model: plays whose thresholds grow with the rate of the input, so that
//! loops widen and flatten with increasing speed.
//!
//! ```text
//! p_i,k = max(x_k - r_i, min(x_k + r_i, p_i,k-1)),   virgin: 0              theory.md (8.15)
//! r_i   = α i + β |x'|                 linear                               theory.md (8.16)
//! r_i   = α i max(0, ln(β + λ |x'|^ε)) logarithmic                          theory.md (8.17)
//! y     = c + a0 x + Σ_i a_i p_i,   a_i = ρ e^{-τ α i} or free,  i = 1 ... n   theory.md (8.18)
//! ```
//!
//! `x_k` is sample `k` of the input, `x'` its rate, `y` the output, `p_i` play `i` with the threshold `r_i`.
//!
//! Properties: at a constant rate it is a Prandtl-Ishlinskii model, with return-point memory at that rate
//! only. Source: Al Janaideh, Rakheja and Su; that all thresholds of the logarithmic form share one factor is
//! our reading.

use serde::{Deserialize, Serialize};

use crate::elementary::{ln, powf};
use crate::error::{LARGEST_VALUE, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts, Rate};
pub use crate::law::play_weights::PlayWeights;
use crate::law::properties::{CONGRUENT, MASING, ODD, WIPES_OUT};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// How the thresholds grow with the rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Thresholds {
    /// `r_i = α i + β |x'|` (theory.md (8.16)).
    Linear {
        /// `β`, in the unit of time.
        beta: f64,
    },
    /// `r_i = α i max(0, ln(β + λ |x'|^ε))` (theory.md (8.17)).
    Logarithmic {
        /// `β`: `ln β` is the factor of the thresholds at rest.
        beta: f64,
        /// `λ`: growth with the rate, in the unit of the rate to the power `-ε`.
        lambda: f64,
        /// `ε`: exponent of the rate.
        epsilon: f64,
    },
}

impl Thresholds {
    /// The sum and the factor by which all thresholds `α i` change at a rate.
    fn growth(&self, rate: f64) -> (f64, f64) {
        match *self {
            Self::Linear { beta } => (beta * rate.abs(), 1.0), // (8.16)
            Self::Logarithmic { beta, lambda, epsilon } => {
                (0.0, ln(beta + lambda * powf(rate.abs(), epsilon)).max(0.0)) // (8.17)
            }
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        let positive = (0.0, LARGEST_VALUE);
        match *self {
            Self::Linear { beta } => {
                let time = Dimension { input: 0, output: 0, time: 1 };
                vec![Parameter::new("β", "growth of every threshold with the rate", beta, positive, time)]
            }
            Self::Logarithmic { beta, lambda, epsilon } => Parameter::table([
                ("β", "its logarithm is the factor at rest", beta, (1e-6, 1e6), Dimension::NONE),
                ("λ", "growth of the factor with the rate", lambda, positive, Dimension::NONE),
                ("ε", "power of the rate", epsilon, (0.0, 2.0), Dimension::NONE),
            ]),
        }
    }
}

/// A rate-dependent Prandtl-Ishlinskii model in the user's units: `y = c + a0 x + Σ_i a_i p_i` (theory.md
/// (8.18)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateDependentPrandtlIshlinskii {
    /// `c`, in the unit of the output.
    pub offset: f64,
    /// `a0`: weight of the input, in the unit of the output divided by that of the input.
    pub spring: f64,
    /// `α`: spacing of the thresholds at rest, in the unit of the input, not negative.
    pub spacing: f64,
    /// How the thresholds grow with the rate.
    pub thresholds: Thresholds,
    /// `a_i`: weights of the plays, in the unit of the output divided by that of the input.
    pub weights: PlayWeights,
}

impl RateDependentPrandtlIshlinskii {
    /// Advances the plays to the next sample.
    pub fn advance(&self, plays: &mut [f64], sample: Sample) {
        let (added, factor) = self.thresholds.growth(sample.rate);
        for (index, play) in plays.iter_mut().enumerate() {
            let r = self.spacing * (index + 1) as f64 * factor + added;
            *play = (sample.x - r).max((sample.x + r).min(*play)); // (8.15)
        }
    }
}

impl Law for RateDependentPrandtlIshlinskii {
    type State = Vec<f64>;

    const FACTS: Facts = Facts {
        rate: Rate::Needed,
        variants: &["logarithmic_thresholds"],
        advice: &[(Behaviour::RateDependence, Advised::FewerParameters("actuators"))],
        ..Facts::searched(
            "rate-dependent-prandtl-ishlinskii",
            "plays whose thresholds grow with the rate",
            &["operators", "free_weights", "logarithmic_thresholds", "starts", "epochs", "rate_compression"],
            ErrorsInside { softening: 0.04, sigmoid: 0.7, other: 0.6 },
        )
        .with_defaults(&[("operators", 10), ("starts", 16)])
    };

    fn virgin(&self) -> Vec<f64> {
        vec![0.0; self.weights.plays()]
    }

    fn step(&self, state: &mut Vec<f64>, sample: Sample) -> f64 {
        let sample = sample.limited();
        self.advance(state, sample);
        let mut y = self.offset + self.spring * sample.x;
        self.weights.for_each(self.spacing, 1, |index, weight| y += weight * state[index]);
        y
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let mut all = Parameter::table([
            ("c", "level of the output", self.offset, any, Dimension::OUTPUT),
            ("a0", "share without memory", self.spring, any, Dimension::SLOPE),
            ("α", "spacing of the thresholds at rest", self.spacing, (0.0, LARGEST_VALUE), Dimension::INPUT),
        ]);
        all.extend(self.thresholds.parameters());
        all.extend(self.weights.parameters("a", 1, Dimension::SLOPE, Dimension::INPUT));
        all
    }

    fn validated(self) -> Result<Self> {
        const NAME: &str = "rate-dependent Prandtl-Ishlinskii";
        Parameter::check_all(&self.parameters(), NAME)?;
        self.weights.check(NAME, self.spacing, 1)?;
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        true
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT, MASING, ODD]].concat()
    }
}
