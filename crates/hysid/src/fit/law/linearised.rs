//! A fitted law as a linear function of small changes of what the fit determined.
//!
//! ```text
//! ŷ_t(z + dz) ≈ ŷ_t(z) + Σ_j J_tj dz_j,     p_i(z + dz) ≈ p_i(z) + Σ_j G_ij dz_j      theory.md (13.9)
//! ```
//!
//! `z` are the variables of the fit: the searched parameters on the scale of the search, 0 to 1, and the weights that
//! follow by least squares. `ŷ_t` is the free run at the scored rows of the fit and `p_i` are the parameters of the law.

use hysid_core::elementary::square;

use crate::data::record::Thinning;
use crate::fit::law::search::{FeatureColumns, SearchFamily, Unknowns, measured};
use crate::law::Law;
use crate::law::series::Series;
use crate::optimise::parallel;
use crate::stop_check::StopCheck;

/// Step of a difference, as a share of the range of the search.
const DIFFERENCE: f64 = 1e-4;

/// A variable of a search so close to an end of its range is at its bound.
const AT_BOUND: f64 = 1e-6;

/// Least relative difference of the differences to both sides that shows a kink.
const KINK: f64 = 0.2;

/// Most rows of a law whose variables are all weights; of more, evenly spaced stretches.
const MOST_ROWS: usize = 40_000;

/// Rows of such a stretch.
const STRETCH: usize = 4000;

#[derive(Debug, Clone)]
pub(crate) struct FitVariable {
    /// Derivative of the free run, row by row.
    pub column: Vec<f64>,
    /// True if the fit left it at an end of its range.
    pub at_bound: bool,
    /// True if the derivatives to both sides differ.
    pub is_kinked: bool,
    /// Length of its range, if it has one.
    pub range: Option<f64>,
}

impl FitVariable {
    /// A weight of a feature.
    pub fn weight(column: Vec<f64>, at_bound: bool) -> Self {
        Self { column, at_bound, is_kinked: false, range: None }
    }
}

/// A law about the result of its fit, from which the [intervals](crate::fit::intervals) of its parameters follow.
#[derive(Debug, Clone)]
pub struct LinearisedLaw {
    pub(crate) records: Vec<usize>,
    /// Simulated less measured output at the scored rows, record by record.
    pub(crate) residual: Vec<f64>,
    pub(crate) variables: Vec<FitVariable>,
    /// Derivatives of each parameter of the law by each variable; empty for a parameter that the fit did not change.
    pub(crate) gradients: Vec<Vec<f64>>,
    /// Rows that stand for one of these, where only stretches are used.
    pub(crate) rows_each: f64,
}

pub(crate) trait LawFamily: SearchFamily {
    type Law: Law;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> Self::Law;

    fn searched(&self, law: &Self::Law) -> Vec<f64>;
}

/// A law that was found by a search over a family, about the result.
pub(crate) fn of_search<F: LawFamily>(family: &F, series: &[Series], law: &F::Law) -> LinearisedLaw {
    let Unknowns { variables, non_negative } = family.unknowns();
    let u: Vec<f64> =
        variables.iter().zip(family.searched(law)).map(|(variable, value)| variable.place(value)).collect();
    let value = |u: &[f64]| -> Vec<f64> { variables.iter().zip(u).map(|(v, &u)| v.value(u)).collect() };
    let target = measured(series);
    let columns = |u: &[f64]| {
        let searched = value(u);
        let mut columns = FeatureColumns::new(non_negative.len(), target.len(), StopCheck::never());
        series.iter().for_each(|series| family.features(&searched, series, &mut columns));
        columns
    };
    let mut here = columns(&u);
    let projection = here.project(&target, non_negative);
    let weights = projection.weights;
    let run = |u: &[f64]| columns(u).sum(&weights);
    let at_rest = here.sum(&weights);
    let of_search = |j: usize| {
        let moved = |by: f64| {
            let mut u = u.clone();
            u[j] = (u[j] + by).clamp(0.0, 1.0);
            (run(&u), u[j])
        };
        let ((above, high), (below, low)) = (moved(DIFFERENCE), moved(-DIFFERENCE));
        let column = above.iter().zip(&below).map(|(a, b)| (a - b) / (high - low)).collect();
        FitVariable {
            column,
            at_bound: !(AT_BOUND..=1.0 - AT_BOUND).contains(&u[j]),
            is_kinked: is_kinked(&above, &at_rest, &below),
            range: Some(1.0),
        }
    };
    let mut found: Vec<FitVariable> = parallel::numbered(u.len(), of_search);
    let of_weights = here.into_columns().into_iter().zip(&weights).zip(non_negative);
    found.extend(
        of_weights.map(|((column, &weight), &bounded)| FitVariable::weight(column, bounded && weight == 0.0)),
    );

    let z = [u.as_slice(), &weights].concat();
    let parameters = |z: &[f64]| -> Vec<f64> {
        let law = family.whole(&value(&z[..u.len()]), &z[u.len()..]);
        law.parameters().iter().map(|parameter| parameter.value).collect()
    };
    let typical = |j: usize| weights[j - u.len()].abs().max(f64::MIN_POSITIVE.sqrt());
    let steps: Vec<f64> =
        (0..z.len()).map(|j| DIFFERENCE * if j < u.len() { 1.0 } else { typical(j) }).collect();
    let derivative = |j: usize| -> Vec<f64> {
        let (mut above, mut below) = (z.clone(), z.clone());
        (above[j], below[j]) = (z[j] + steps[j], z[j] - steps[j]);
        if j < u.len() {
            (above[j], below[j]) = (above[j].min(1.0), below[j].max(0.0));
        }
        let by = above[j] - below[j];
        parameters(&above).iter().zip(parameters(&below)).map(|(a, b)| (a - b) / by).collect()
    };
    let by_variable: Vec<Vec<f64>> = (0..z.len()).map(derivative).collect();
    let count = by_variable.first().map_or(0, Vec::len);
    let gradients = (0..count).map(|i| by_variable.iter().map(|column| column[i]).collect()).collect();
    LinearisedLaw {
        records: scored(series).map(Iterator::count).collect(),
        residual: projection.residual,
        variables: found,
        gradients,
        rows_each: 1.0,
    }
}

fn scored(series: &[Series]) -> impl Iterator<Item = impl Iterator<Item = f64> + '_> + '_ {
    series.iter().map(|series| series.output.iter().copied().filter(|y| !y.is_nan()))
}

/// True if a run changes differently to both sides.
fn is_kinked(above: &[f64], here: &[f64], below: &[f64]) -> bool {
    let (mut bend, mut change) = (0.0, 0.0);
    for ((a, h), b) in above.iter().zip(here).zip(below) {
        bend += square(a - 2.0 * h + b);
        change += square(a - b);
    }
    bend > KINK * KINK * change
}

/// Series with at most this number of scored rows, in stretches, and how many rows each stands for.
pub(crate) fn in_stretches(mut series: Vec<Series>) -> (Vec<Series>, f64) {
    let rows: usize = scored(&series).map(Iterator::count).sum();
    if rows <= MOST_ROWS {
        return (series, 1.0);
    }
    let stretches = Thinning::new(rows.div_ceil(STRETCH), MOST_ROWS / STRETCH);
    let outputs = series.iter_mut().flat_map(|series| &mut series.output).filter(|y| !y.is_nan());
    for (place, y) in outputs.enumerate() {
        if !stretches.keeps(place / STRETCH) {
            *y = f64::NAN;
        }
    }
    let kept: usize = scored(&series).map(Iterator::count).sum();
    (series, rows as f64 / kept.max(1) as f64)
}

/// The features of weights at the scored rows, column by column, as a law that is linear in its weights has them.
pub(crate) struct WeightRows {
    pub columns: Vec<Vec<f64>>,
    pub target: Vec<f64>,
    pub records: Vec<usize>,
}

impl WeightRows {
    pub fn new(features: usize) -> Self {
        Self { columns: vec![Vec::new(); features], target: Vec::new(), records: Vec::new() }
    }

    /// Begins the next record.
    pub fn begin(&mut self) {
        self.records.push(0);
    }

    /// Adds a row, unless its target is blank.
    pub fn add(&mut self, features: &[f64], target: f64) {
        if target.is_nan() {
            return;
        }
        self.columns.iter_mut().zip(features).for_each(|(column, &feature)| column.push(feature));
        self.target.push(target);
        if let Some(rows) = self.records.last_mut() {
            *rows += 1;
        }
    }

    /// The law with these weights, of which those that are bounded and 0 are at their bound. `gradients` has for each
    /// parameter of the law the derivatives by the weights.
    pub fn linearised(
        self,
        weights: &[f64],
        bounded: &[bool],
        gradients: Vec<Vec<f64>>,
        rows_each: f64,
    ) -> LinearisedLaw {
        let mut residual: Vec<f64> = self.target.iter().map(|y| -y).collect();
        for (column, &weight) in self.columns.iter().zip(weights) {
            residual.iter_mut().zip(column).for_each(|(residual, feature)| *residual += weight * feature);
        }
        let sides = weights.iter().zip(bounded);
        let variables = self
            .columns
            .into_iter()
            .zip(sides)
            .map(|(column, (&weight, &bounded))| FitVariable::weight(column, bounded && weight == 0.0))
            .collect();
        LinearisedLaw { records: self.records, residual, variables, gradients, rows_each }
    }
}

/// The derivatives of a parameter that is one of `count` weights.
pub(crate) fn unit_gradient(count: usize, at: usize) -> Vec<f64> {
    (0..count).map(|j| if j == at { 1.0 } else { 0.0 }).collect()
}
