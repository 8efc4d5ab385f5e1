//! Prandtl-Ishlinskii model: a weighted sum of plays.
//!
//! ```text
//! y = c + w_0 x + Σ_i w_i p_{r_i}[x]                                   theory.md (7.4)
//! ```
//!
//! `x` is the input, `y` the output and `p_r` the [play] of threshold `r`. A stop is
//! the input minus its play, so sums of stops have the same form.
//!
//! Properties: wiping-out and congruency hold; from the virgin state the model obeys Masing's rule, and its
//! loops are symmetric about their middle. It can be inverted if all partial sums `w_0 + w_1 + ... + w_i` are
//! positive.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts};
use crate::law::properties::{CONGRUENT, MASING, ODD, WIPES_OUT};
use crate::law::thresholds::{check_thresholds, check_weights, limited};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::operator::play;
use crate::property::Property;

/// A Prandtl-Ishlinskii model `y = c + w_0 x + Σ_i w_i p_{r_i}[x]` (theory.md (7.4)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts")]
pub struct PrandtlIshlinskii {
    constant: f64,
    linear: f64,
    thresholds: Vec<f64>,
    weights: Vec<f64>,
}

/// A model before its check.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    constant: f64,
    linear: f64,
    thresholds: Vec<f64>,
    weights: Vec<f64>,
}

impl TryFrom<Parts> for PrandtlIshlinskii {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::new(parts.constant, parts.linear, parts.thresholds, parts.weights)
    }
}

impl PrandtlIshlinskii {
    /// A model from its constant `c` (unit of the output), the weight `w_0` of the input (unit of the output
    /// divided by that of the input), and the thresholds `r_i` (unit of the input) and weights `w_i` (as
    /// `w_0`) of its plays.
    ///
    /// # Errors
    /// Thresholds that are not positive, finite and rising; a weight that is not finite or beyond 1e50;
    /// different numbers of both.
    pub fn new(constant: f64, linear: f64, thresholds: Vec<f64>, weights: Vec<f64>) -> Result<Self> {
        check_thresholds(&thresholds)?;
        check_weights(&[&[constant, linear], weights.as_slice()].concat())?;
        if thresholds.len() != weights.len() {
            return Err(Error::Parts(format!(
                "{} thresholds and {} weights: there must be one weight for each threshold",
                thresholds.len(),
                weights.len()
            )));
        }
        Ok(Self { constant, linear, thresholds, weights })
    }

    /// As [`PrandtlIshlinskii::new`], without checks, for parameters that a fit still changes.
    pub fn unchecked(constant: f64, linear: f64, thresholds: Vec<f64>, weights: Vec<f64>) -> Self {
        Self { constant, linear, thresholds, weights }
    }

    /// The constant `c`, in the unit of the output.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// The weight `w_0` of the input, in the unit of the output divided by that of the input.
    pub fn linear(&self) -> f64 {
        self.linear
    }

    /// Thresholds `r_i` of the plays, in the unit of the input, rising.
    pub fn thresholds(&self) -> &[f64] {
        &self.thresholds
    }

    /// Weights `w_i` of the plays, in the unit of the output divided by that of the input.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}

impl Law for PrandtlIshlinskii {
    type State = Vec<f64>;

    const FACTS: Facts = Facts {
        advice: &[(Behaviour::SumOfPlays, Advised::Simplest)],
        ..Facts::linear(
            "prandtl-ishlinskii",
            "weighted plays on a grid of thresholds",
            &["operators", "thresholds", "sign"],
            ErrorsInside { softening: 0.04, sigmoid: 0.7, other: 0.6 },
        )
        .with_defaults(&[("operators", 30)])
    };

    fn virgin(&self) -> Vec<f64> {
        vec![0.0; self.thresholds.len()]
    }

    fn step(&self, plays: &mut Vec<f64>, sample: Sample) -> f64 {
        let x = limited(sample.x);
        // (7.4)
        self.constant + self.linear * x + sum_of_plays(plays, x, &self.thresholds, &self.weights)
    }

    /// The closed inverse (theory.md (12.1)), if every slope `w_0 + w_1 + ... + w_i` is positive.
    fn input_for(&self, plays: &Vec<f64>, output: f64) -> Option<f64> {
        let each = || self.thresholds.iter().zip(&self.weights).zip(plays);
        let slope = self.linear;
        let rest = self.constant + each().map(|((_, w), play)| w * play).sum::<f64>();
        let x = |rest: f64, slope: f64| (slope > 0.0).then(|| (output - rest) / slope);
        let here = x(rest, slope)?;
        // Where all plays rest, the input is within the slot of the smallest.
        let direction = match each().next() {
            Some(((r, _), play)) if here > play + r => 1.0,
            Some(((r, _), play)) if here < play - r => -1.0,
            _ => return Some(here),
        };
        let (mut input, mut rest, mut slope) = (here, rest, slope);
        for ((r, w), play) in each() {
            // The play rests at this input: those with larger thresholds do too.
            if direction * (input - play) <= *r {
                break;
            }
            rest -= w * (play + direction * r);
            slope += w;
            input = x(rest, slope)?;
        }
        Some(input)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let (any, positive) = ((f64::NEG_INFINITY, f64::INFINITY), (0.0, f64::INFINITY));
        let (threshold, weight) = ("threshold of a play", "weight of a play");
        let mut all = Parameter::table([
            ("c", "output constant", self.constant, any, Dimension::OUTPUT),
            ("w_0", "weight of the input", self.linear, any, Dimension::SLOPE),
        ]);
        let r = Parameter::numbered("r", 1, &self.thresholds, threshold, positive, Dimension::INPUT);
        let w = Parameter::numbered("w", 1, &self.weights, weight, any, Dimension::SLOPE);
        all.extend(r.zip(w).flat_map(|(r, w)| [r, w]));
        all
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT, MASING, ODD]].concat()
    }
}

/// Advances plays and gives their weighted sum, in eight partial sums so that it becomes SIMD code.
pub(crate) fn sum_of_plays(plays: &mut [f64], x: f64, thresholds: &[f64], weights: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (groups, rest) = plays.as_chunks_mut::<LANES>();
    let (r, r_rest) = thresholds.as_chunks::<LANES>();
    let (w, w_rest) = weights.as_chunks::<LANES>();
    for ((plays, r), w) in groups.iter_mut().zip(r).zip(w) {
        for l in 0..LANES {
            plays[l] = play::follow(plays[l], x, r[l]);
            sums[l] += w[l] * plays[l];
        }
    }
    let mut sum: f64 = sums.iter().sum();
    for ((play, &r), &w) in rest.iter_mut().zip(r_rest).zip(w_rest) {
        *play = play::follow(*play, x, r);
        sum += w * *play;
    }
    sum
}
