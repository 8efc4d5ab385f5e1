//! Masing's rule: every branch is the virgin curve, twice as large.
//!
//! ```text
//! virgin:   y = c + g(x)                                              theory.md (7.3)
//! branch:   y = y* + 2 g((x - x*)/2)      from the turning point (x*, y*)
//! g(x) = Σ_j m_j [clip(x; -r_j, r_j) - clip(x; -r_{j-1}, r_{j-1})]
//! ```
//!
//! The virgin curve `g` is odd and a polygon: `m_j` is its slope between the thresholds `r_{j-1}` and
//! `r_j`, and the last slope goes on for ever. A branch that meets the one before goes on along that
//! (Madelung), see [`turning_point_stack`](crate::law::turning_point_stack). The rule so extended
//! is the Prandtl model: along the stack the terms of `g` add up to stops,
//! `y = c + Σ_j (m_j - m_{j+1}) ε_{r_j}[x] + m_{n+1} x`, theory.md (7.13), so the model is linear in its slopes.

use serde::{Deserialize, Serialize};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::law::linear_fit::{
    Bounds, FoldSums, Folds, Gatherer, Penalty, Sign, identifiable_series, logarithmic, lowest,
};
use crate::law::series::Series;
use crate::law::thresholds::{self, check_thresholds, check_weights, fits_on_grids, limited};
use crate::law::turning_point_stack::{Branch, TurningPointStack};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::network::scaling::Scaling;
use crate::operator::{play, stop};
use crate::stop_check::StopCheck;

/// A model by Masing's rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MasingParts", into = "MasingParts")]
pub struct Masing {
    parts: MasingParts,
    /// `g` at each threshold.
    heights: Vec<f64>,
}

/// What a model by Masing's rule consists of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MasingParts {
    /// Constant `c`, in the unit of the output.
    pub constant: f64,
    /// Thresholds `r_1 < r_2 < ...` where the virgin curve bends, in the unit of the input, positive.
    pub thresholds: Vec<f64>,
    /// Slopes `m_j` of the virgin curve, output for input: one below each threshold, one beyond the
    /// last.
    pub slopes: Vec<f64>,
}

/// How a model by Masing's rule is fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MasingOptions {
    /// Number of thresholds, 1 to 1000.
    pub operators: usize,
    /// The thresholds, in the unit of the input, positive and rising; without them they are spread over
    /// the range of the input.
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the slopes: a virgin curve that rises, falls, or does both; chosen by cross-validation if
    /// `None`.
    pub sign: Option<Sign>,
}

impl Default for MasingOptions {
    fn default() -> Self {
        Self { operators: 30, thresholds: None, sign: None }
    }
}

impl TryFrom<MasingParts> for Masing {
    type Error = Error;

    fn try_from(parts: MasingParts) -> Result<Self> {
        Self::new(parts)
    }
}

impl From<Masing> for MasingParts {
    fn from(model: Masing) -> Self {
        model.parts
    }
}

impl Masing {
    /// A model from its parts.
    ///
    /// # Errors
    /// Thresholds that are not positive, finite and rising; not one slope more than thresholds; a slope
    /// or constant that is not finite or beyond 1e100.
    pub fn new(parts: MasingParts) -> Result<Self> {
        check_thresholds(&parts.thresholds)?;
        check_weights(&parts.slopes)?;
        check_weights(&[parts.constant])?;
        if parts.slopes.len() != parts.thresholds.len() + 1 {
            return Err(Error::Option(format!(
                "{} slopes where {} thresholds need {}",
                parts.slopes.len(),
                parts.thresholds.len(),
                parts.thresholds.len() + 1
            )));
        }
        let (mut height, mut from) = (0.0, 0.0);
        let mut rise = |(&r, &slope): (&f64, &f64)| {
            height += slope * (r - from);
            from = r;
            height
        };
        let heights = parts.thresholds.iter().zip(&parts.slopes).map(&mut rise).collect();
        Ok(Self { parts, heights })
    }

    /// Fits a model: least squares with a penalty on the bends of the virgin curve, chosen by
    /// cross-validation.
    ///
    /// # Errors
    /// Data that nothing can be identified from, several inputs, options outside their meaning.
    pub fn fit(data: &Dataset, options: &MasingOptions) -> Result<Self> {
        Self::fit_until(data, options, StopCheck::never())
    }

    /// As [`Masing::fit`]; asked to stop, with the grids and penalties compared so far.
    pub(crate) fn fit_until(data: &Dataset, options: &MasingOptions, stop: StopCheck<'_>) -> Result<Self> {
        let series = identifiable_series(data)?;
        let scaling = Scaling::of(data, None)?;
        let grids =
            thresholds::candidates(options.thresholds.as_deref(), options.operators, scaling.inputs[0])?;
        let fits = fits_on_grids(&grids, |grid| slopes_on_grid(&series, &scaling, grid, options.sign, stop))?;
        let scores: Vec<f64> = fits.iter().map(|fit| fit.0).collect();
        let best = lowest(&scores);
        let slope = scaling.output_deviation / scaling.inputs[0];
        Self::new(MasingParts {
            constant: scaling.output(fits[best].1[0]),
            thresholds: grids[best].clone(),
            slopes: fits[best].1[1..].iter().map(|weight| weight * slope).collect(),
        })
    }

    /// Its parts.
    pub fn parts(&self) -> &MasingParts {
        &self.parts
    }

    /// The virgin curve `g` at an input.
    pub fn virgin_curve(&self, x: f64) -> f64 {
        let (size, thresholds) = (x.abs(), &self.parts.thresholds);
        let piece = thresholds.partition_point(|&r| r <= size);
        let (from, height) =
            if piece == 0 { (0.0, 0.0) } else { (thresholds[piece - 1], self.heights[piece - 1]) };
        (height + self.parts.slopes[piece] * (size - from)).copysign(x) * if x == 0.0 { 0.0 } else { 1.0 }
    }
}

/// Score by cross-validation, and weights (constant, slopes) in scaled units.
fn slopes_on_grid(
    series: &[Series],
    scaling: &Scaling,
    grid: &[f64],
    sign: Option<Sign>,
    stop: StopCheck<'_>,
) -> Result<(f64, Vec<f64>)> {
    let sums = slope_sums(series, scaling, grid, stop)?;
    let features = grid.len() + 2;
    // Bends of the curve are what costs; all slopes alike cost next to nothing.
    let mut penalty = Penalty::ridge((0..features).map(|i| if i == 0 { 0.0 } else { 1e-3 }));
    for i in 2..features {
        penalty.add_square(&[(i, 1.0), (i - 1, -1.0)], 1.0);
    }
    let reversible = 1..1;
    let factors = logarithmic(1e-9, 1e-1, 17);
    let choice = sums.choose(&penalty, &factors, sign, &reversible, stop);
    let mut penalised = sums.into_total().quadratic();
    penalised.penalise(&penalty, choice.factor);
    let bounds = Bounds::new(choice.sign, reversible, features);
    Ok((choice.score, penalised.last_minimum(&bounds, stop)?))
}

/// Sums of constant and slopes: the feature of a slope is a stop less the one before.
fn slope_sums(series: &[Series], scaling: &Scaling, grid: &[f64], stop: StopCheck<'_>) -> Result<FoldSums> {
    let folds = Folds::of_series(series);
    let mut features = vec![1.0; grid.len() + 2];
    let mut gatherer = Gatherer::new(features.len(), &folds, stop);
    let factor = 1.0 / scaling.inputs[0];
    for (series, fold) in series.iter().zip(&folds.of_rows) {
        let mut plays = vec![0.0; grid.len()];
        let targets = scaling.scaled_output(&series.output);
        for ((sample, &fold), target) in series.samples.iter().zip(fold).zip(targets) {
            if gatherer.is_over(6 * features.len()) {
                break;
            }
            let mut before = 0.0;
            for ((play, &r), feature) in plays.iter_mut().zip(grid).zip(&mut features[1..]) {
                *play = play::follow(*play, sample.x, r);
                let elongation = stop::elongation(sample.x, *play);
                *feature = (elongation - before) * factor;
                before = elongation;
            }
            features[grid.len() + 1] = (sample.x - before) * factor;
            gatherer.add(fold, &features, target);
        }
    }
    gatherer.finish()
}

impl Law for Masing {
    /// Turning points with the output there, the constant left out.
    type State = TurningPointStack<f64>;

    fn virgin(&self) -> Self::State {
        TurningPointStack::default()
    }

    fn step(&self, stack: &mut Self::State, sample: Sample) -> f64 {
        let x = limited(sample.x);
        stack.advance(x, 0.0);
        let y = match stack.branch() {
            Branch::Virgin => self.virgin_curve(x),
            Branch::From { start, .. } => start.value + 2.0 * self.virgin_curve(0.5 * (x - start.x)),
        };
        stack.set_value(y);
        self.parts.constant + y
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let parameter =
            |symbol: String, meaning, value, bounds, unit| Parameter { symbol, meaning, value, bounds, unit };
        let mut all =
            vec![parameter("c".into(), "output constant", self.parts.constant, any, Dimension::OUTPUT)];
        for (j, &r) in self.parts.thresholds.iter().enumerate() {
            let positive = (0.0, f64::INFINITY);
            all.push(parameter(
                format!("r_{}", j + 1),
                "bend of the virgin curve",
                r,
                positive,
                Dimension::INPUT,
            ));
        }
        for (j, &m) in self.parts.slopes.iter().enumerate() {
            all.push(parameter(
                format!("m_{}", j + 1),
                "slope of the virgin curve",
                m,
                any,
                Dimension::SLOPE,
            ));
        }
        all
    }
}
