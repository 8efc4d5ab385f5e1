//! Prandtl-Ishlinskii model in its play form.
//!
//! ```text
//! y = c + w_0 x + Σ_i w_i P_{r_i}[x]                                   theory.md (7.4)
//! ```
//!
//! `P_r` is the play of theory.md (1.2). Because a stop is the input less its play, sums of stops have
//! the same form. The model wipes out, is congruent, obeys Masing's rule from the virgin state, and its
//! loops are symmetric about their middle; it can be inverted where all partial sums of the `w_i` are
//! positive.

use serde::{Deserialize, Serialize};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::law::linear_fit::{
    Bounds, FoldSums, Folds, Gatherer, Penalty, Sign, identifiable_series, logarithmic, lowest,
};
use crate::law::series::Series;
use crate::law::thresholds::{self, check_thresholds, check_weights, fits_on_grids, limited};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::network::scaling::Scaling;
use crate::operator::play;
use crate::stop_check::StopCheck;

/// A Prandtl-Ishlinskii model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, try_from = "Parts", into = "Parts")]
pub struct PrandtlIshlinskii {
    constant: f64,
    linear: f64,
    thresholds: Vec<f64>,
    weights: Vec<f64>,
}

/// What a model is stored as.
#[derive(Debug, Clone, Serialize, Deserialize)]
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

impl From<PrandtlIshlinskii> for Parts {
    fn from(model: PrandtlIshlinskii) -> Self {
        let PrandtlIshlinskii { constant, linear, thresholds, weights } = model;
        Self { constant, linear, thresholds, weights }
    }
}

/// How a Prandtl-Ishlinskii model is fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrandtlIshlinskiiOptions {
    /// Number of plays, 1 to 1000.
    pub operators: usize,
    /// Their thresholds in the unit of the input, positive and rising; without them they are spread over
    /// the range of the input, evenly or denser towards 0 as cross-validation finds better.
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the weights of the plays; chosen by cross-validation if `None`.
    pub sign: Option<Sign>,
}

impl Default for PrandtlIshlinskiiOptions {
    fn default() -> Self {
        Self { operators: 30, thresholds: None, sign: None }
    }
}

impl PrandtlIshlinskii {
    /// A model from its constant `c` (unit of the output), `w_0`, and the thresholds (unit of the input)
    /// and weights (output for input) of its plays.
    ///
    /// # Errors
    /// Thresholds that are not positive, finite and rising; a weight that is not finite or beyond 1e50;
    /// different numbers of both.
    pub fn new(constant: f64, linear: f64, thresholds: Vec<f64>, weights: Vec<f64>) -> Result<Self> {
        check_thresholds(&thresholds)?;
        check_weights(&[&[constant, linear], weights.as_slice()].concat())?;
        if thresholds.len() != weights.len() {
            return Err(Error::Option(format!(
                "{} thresholds and {} weights: there must be one weight for each threshold",
                thresholds.len(),
                weights.len()
            )));
        }
        Ok(Self { constant, linear, thresholds, weights })
    }

    /// Fits a model: least squares with a ridge penalty chosen by cross-validation.
    ///
    /// # Errors
    /// Data that nothing can be identified from, several inputs, options outside their meaning.
    pub fn fit(data: &Dataset, options: &PrandtlIshlinskiiOptions) -> Result<Self> {
        Self::fit_until(data, options, StopCheck::never())
    }

    /// As [`PrandtlIshlinskii::fit`]; asked to stop, with the grids and penalties compared so far.
    pub(crate) fn fit_until(
        data: &Dataset,
        options: &PrandtlIshlinskiiOptions,
        stop: StopCheck<'_>,
    ) -> Result<Self> {
        let series = identifiable_series(data)?;
        let scaling = Scaling::of(data, None)?;
        let grids =
            thresholds::candidates(options.thresholds.as_deref(), options.operators, scaling.inputs[0])?;
        let fits =
            fits_on_grids(&grids, |grid| weights_on_grid(&series, &scaling, grid, options.sign, stop))?;
        let scores: Vec<f64> = fits.iter().map(|fit| fit.0).collect();
        let best = lowest(&scores);
        let slope = scaling.output_deviation / scaling.inputs[0];
        let weights = &fits[best].1;
        Self::new(
            scaling.output(weights[0]),
            weights[1] * slope,
            grids[best].clone(),
            weights[2..].iter().map(|weight| weight * slope).collect(),
        )
    }

    /// The constant `c`, in the unit of the output.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// The weight `w_0` of the input, output for input.
    pub fn linear(&self) -> f64 {
        self.linear
    }

    /// Thresholds `r_i` of the plays, in the unit of the input, rising.
    pub fn thresholds(&self) -> &[f64] {
        &self.thresholds
    }

    /// Weights `w_i` of the plays, output for input.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}

/// Score by cross-validation and weights (constant, input, plays) in scaled units.
fn weights_on_grid(
    series: &[Series],
    scaling: &Scaling,
    thresholds: &[f64],
    sign: Option<Sign>,
    stop: StopCheck<'_>,
) -> Result<(f64, Vec<f64>)> {
    let sums = play_sums(series, scaling, thresholds, stop)?;
    let features = 2 + thresholds.len();
    // The constant is free, the input nearly.
    let of = |i: usize| match i {
        0 => 0.0,
        1 => 1e-3,
        _ => 1.0,
    };
    let penalty = Penalty::ridge((0..features).map(of));
    let penalties = logarithmic(1e-9, 1e-1, 17);
    let choice = sums.choose(&penalty, &penalties, sign, &PLAYS_BEGIN, stop);
    let mut penalised = sums.into_total().quadratic();
    penalised.penalise(&penalty, choice.factor);
    let bounds = Bounds::new(choice.sign, PLAYS_BEGIN, features);
    Ok((choice.score, penalised.last_minimum(&bounds, stop)?))
}

/// Constant and input come first and are free.
const PLAYS_BEGIN: std::ops::Range<usize> = 2..2;

/// Sums of constant, input and plays, inputs and plays in units of the largest input.
fn play_sums(
    series: &[Series],
    scaling: &Scaling,
    thresholds: &[f64],
    stop: StopCheck<'_>,
) -> Result<FoldSums> {
    let folds = Folds::of_series(series);
    let mut gatherer = Gatherer::new(2 + thresholds.len(), &folds, stop);
    let mut features = vec![0.0; 2 + thresholds.len()];
    features[0] = 1.0;
    let factor = 1.0 / scaling.inputs[0];
    for (series, fold) in series.iter().zip(&folds.of_rows) {
        let mut plays = vec![0.0; thresholds.len()];
        let targets = scaling.scaled_output(&series.output);
        for ((sample, &fold), target) in series.samples.iter().zip(fold).zip(targets) {
            if gatherer.is_over(4 * features.len()) {
                break;
            }
            features[1] = sample.x * factor;
            for ((play, &r), feature) in plays.iter_mut().zip(thresholds).zip(&mut features[2..]) {
                *play = play::follow(*play, sample.x, r);
                *feature = *play * factor;
            }
            gatherer.add(fold, &features, target);
        }
    }
    gatherer.finish()
}

impl Law for PrandtlIshlinskii {
    /// The plays.
    type State = Vec<f64>;

    fn virgin(&self) -> Vec<f64> {
        vec![0.0; self.thresholds.len()]
    }

    fn step(&self, plays: &mut Vec<f64>, sample: Sample) -> f64 {
        let x = limited(sample.x);
        self.constant + self.linear * x + sum_of_plays(plays, x, &self.thresholds, &self.weights)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let parameter =
            |symbol: String, meaning, value, bounds, unit| Parameter { symbol, meaning, value, bounds, unit };
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let mut all = vec![
            parameter("c".into(), "output constant", self.constant, any, Dimension::OUTPUT),
            parameter("w_0".into(), "weight of the input", self.linear, any, Dimension::SLOPE),
        ];
        for (i, (&r, &w)) in self.thresholds.iter().zip(&self.weights).enumerate() {
            let positive = (0.0, f64::INFINITY);
            all.push(parameter(format!("r_{}", i + 1), "threshold of a play", r, positive, Dimension::INPUT));
            all.push(parameter(format!("w_{}", i + 1), "weight of a play", w, any, Dimension::SLOPE));
        }
        all
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
