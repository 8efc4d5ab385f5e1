//! Identification of laws with few parameters: Levenberg-Marquardt from several starts, with the linear
//! parameters found by least squares at each step (variable projection).
//!
//! ```text
//! y_k ≈ Σ_i c_i φ_i,k(θ)          φ: features of a free run, c by least squares    theory.md (8.1)
//! θ_j = l + (h - l) u_j   or   l (h/l)^{u_j},   0 ≤ u_j ≤ 1                        theory.md (8.2)
//! (JᵀJ + μ D) du = -Jᵀ r,   r(u) the residual with the best c                      theory.md (8.3)
//! ```
//!
//! `y_k` is the measured output at row `k`, `θ_j` a parameter found by search within the bounds `l` and `h`,
//! `J` the derivative of `r` by `u`, `D = diag(JᵀJ)` and `μ` the damping.
//!
//! Laws of hysteresis have kinks, regions without slope and several minima. Many random points are therefore
//! evaluated first; the search starts from the best of them that are far enough apart, and drops starts with
//! large errors. The Jacobian is that of the whole residual by finite differences, so it includes the
//! dependence of `c` on `u`.

mod descent;
mod projection;
mod rows;

use std::ops::ControlFlow;
use std::sync::Mutex;

use hysid_core::elementary::{ln, powf, square};
use rand::RngExt;
use serde_json::json;

use crate::error::{Error, Result};
use crate::fit::law::linearised::LawFamily;
use crate::fit::progress::{PartialLaw, SearchObserver, SearchProgress};
use crate::law::series::Series;
use crate::law::{Classical, Law};
use crate::optimise::multi_start::{MultiStart, RoundPlan};
use crate::optimise::parallel;
use crate::optimise::random::generator;
use crate::options::classical::ClassicalOptions;
use crate::options::table::check;
use crate::stop_check::StopCheck;
use crate::termination::Termination;
use descent::Descent;
pub(crate) use projection::FeatureColumns;
use projection::{Projection, UNFINISHED};

use rows::roots_of_weights;
pub(crate) use rows::{MemoryKind, measured, spread, thinned, thinned_to};

/// Points that are evaluated side by side.
const SIDE_BY_SIDE: usize = 4;

/// Random points looked at for each start.
const DRAWS_PER_START: usize = 24;

/// Least distance of starts, root mean square of the differences in `u`, where there are enough points.
const APART: f64 = 0.12;

/// Rounds after which half of the starts are given up, and again after as many more.
const ROUNDS_TO_PROVE_ITSELF: usize = 6;

const FINALISTS: usize = 2;

/// Bounds of a searched parameter and the scale it is searched on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SearchVariable {
    pub low: f64,
    pub high: f64,
    /// Searched by its logarithm; needs `low > 0`.
    pub logarithmic: bool,
}

impl SearchVariable {
    pub fn linear(low: f64, high: f64) -> Self {
        Self { low, high, logarithmic: false }
    }

    pub fn logarithmic(low: f64, high: f64) -> Self {
        debug_assert!(low > 0.0 && high > low);
        Self { low, high, logarithmic: true }
    }

    /// The parameter at `u`: `l + (h - l) u`, or `l (h/l)^u` on a logarithmic scale (theory.md (8.2)).
    pub fn value(self, u: f64) -> f64 {
        let value = if self.logarithmic {
            self.low * powf(self.high / self.low, u) // (8.2)
        } else {
            self.low + (self.high - self.low) * u // (8.2)
        };
        value.clamp(self.low, self.high)
    }

    /// The inverse of [`SearchVariable::value`].
    pub fn place(self, value: f64) -> f64 {
        let u = if self.logarithmic {
            ln(value / self.low) / ln(self.high / self.low)
        } else {
            (value - self.low) / (self.high - self.low)
        };
        u.clamp(0.0, 1.0)
    }
}

/// Search variables, and for each feature whether its weight must not be negative.
pub(crate) struct Unknowns {
    pub variables: Vec<SearchVariable>,
    pub non_negative: Vec<bool>,
}

/// A family of laws, in the form of the search. The search takes it by reference only, so that the compiler makes one
/// search for all families: a call costs nothing beside its run over a record.
pub(crate) trait SearchFamily: Sync {
    fn unknowns(&self) -> &Unknowns;

    /// Appends the features of every row with an output; ends early once [`FeatureColumns::is_over`].
    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>);

    /// The features of several points, each as by [`SearchFamily::features`]. Laws that are advanced side by side take less time.
    fn features_side_by_side(
        &self,
        points: &[Vec<f64>],
        series: &Series,
        columns: &mut [FeatureColumns<'_>],
    ) {
        for (parameters, columns) in points.iter().zip(columns) {
            self.features(parameters, series, columns);
        }
    }

    /// Starting points that the data suggest, better than random ones.
    fn suggestions(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }
}

/// A function that makes a law of searched parameters and weights.
type MakesLaw<'a> = dyn Fn(&[f64], &[f64]) -> Option<Classical> + Sync + 'a;

/// An identified law with the result of its search.
#[derive(Debug, Clone)]
pub struct IdentifiedLaw<L> {
    /// The law with its searched parameters and weights.
    pub law: L,
    /// Error over the training rows, in percent of the standard deviation of the output.
    pub train_nrmse_percent: f64,
    /// Free runs of the law, all starts together.
    pub evaluations: usize,
    /// Why the search ended.
    pub termination: Termination,
    /// The parameters found by search ([`ClassicalOptions::near`]); empty for a law that is not searched in this way.
    pub searched: Vec<f64>,
}

impl<L> IdentifiedLaw<L> {
    /// A law that least squares found from one start, without rounds.
    pub(crate) fn by_least_squares(law: L) -> Self {
        let (termination, searched) = (Termination::Converged, Vec::new());
        Self { law, train_nrmse_percent: f64::NAN, evaluations: 1, termination, searched }
    }

    pub(crate) fn try_map<M>(self, make: impl FnOnce(L) -> Result<M>) -> Result<IdentifiedLaw<M>> {
        let Self { law, train_nrmse_percent, evaluations, termination, searched } = self;
        Ok(IdentifiedLaw { law: make(law)?, train_nrmse_percent, evaluations, termination, searched })
    }
}

pub(crate) fn check_effort(options: &ClassicalOptions) -> Result<()> {
    check([("starts", json!(options.starts())), ("epochs", json!(options.epochs()))])
}

/// The squared residual over the variance of the output, as a function of `u`.
pub(super) struct LawObjective<'a> {
    family: &'a dyn SearchFamily,
    series: &'a [Series],
    /// Measured outputs, times the roots of the weights.
    target: Vec<f64>,
    /// Roots of the weights of the rows; empty if all count alike.
    roots: Vec<f64>,
    variation: f64,
    stop: StopCheck<'a>,
}

impl LawObjective<'_> {
    fn parameters(&self, u: &[f64]) -> Vec<f64> {
        self.family.unknowns().variables.iter().zip(u).map(|(variable, &u)| variable.value(u)).collect()
    }

    fn value(&self, u: &[f64]) -> Projection {
        self.values(&[u.to_vec()]).remove(0)
    }

    /// The values at points, which are evaluated side by side.
    fn values(&self, points: &[Vec<f64>]) -> Vec<Projection> {
        if self.stop.is_asked() {
            return vec![Projection::unfinished(); points.len()];
        }
        let parameters: Vec<Vec<f64>> = points.iter().map(|u| self.parameters(u)).collect();
        let non_negative = &self.family.unknowns().non_negative;
        let mut columns =
            vec![FeatureColumns::new(non_negative.len(), self.target.len(), self.stop); points.len()];
        for series in self.series {
            match parameters.as_slice() {
                [alone] => self.family.features(alone, series, &mut columns[0]),
                several => self.family.features_side_by_side(several, series, &mut columns),
            }
        }
        // One of several that was asked to stop ends all of them.
        if self.stop.is_asked() {
            return vec![Projection::unfinished(); points.len()];
        }
        let project = |columns: &mut FeatureColumns<'_>| {
            columns.scale_rows(&self.roots);
            columns.project(&self.target, non_negative) // (8.1)
        };
        columns.iter_mut().map(project).collect()
    }

    fn nrmse_percent(&self, projection: &Projection) -> f64 {
        100.0 * (projection.square_residual / self.variation).sqrt()
    }
}

/// Searches a law of a family. The result depends on data, options and seed alone, not on the number of threads: a
/// start is walked by itself, and the starts are compared in their order.
///
/// # Errors
/// No start requested, or a stop before any start was evaluated. The data must have been found identifiable
/// before.
pub(crate) fn search<F: LawFamily>(
    family: &F,
    series: &[Series],
    options: &ClassicalOptions,
    observer: &mut SearchObserver<'_>,
    stop: StopCheck<'_>,
) -> Result<IdentifiedLaw<F::Law>>
where
    F::Law: Into<Classical>,
{
    let law = |parameters: &[f64], weights: &[f64]| family.whole(parameters, weights).validated();
    let so_far = |parameters: &[f64], weights: &[f64]| law(parameters, weights).ok().map(Into::into);
    let found = search_parameters(family, &so_far, series, options, observer, stop)?;
    let searched = found.searched.clone();
    found.try_map(|weights| law(&searched, &weights))
}

/// Searches parameters and weights; `law` is made of both for an observer that needs it.
fn search_parameters(
    family: &dyn SearchFamily,
    law: &MakesLaw<'_>,
    series: &[Series],
    options: &ClassicalOptions,
    observer: &mut SearchObserver<'_>,
    stop: StopCheck<'_>,
) -> Result<IdentifiedLaw<Vec<f64>>> {
    check_effort(options)?;
    let mut target = measured(series);
    let (mean, deviation) = spread(&target);
    let mut variation = target.len() as f64 * deviation * deviation;
    let roots = roots_of_weights(series);
    if !roots.is_empty() {
        variation = target.iter().zip(&roots).map(|(y, root)| square(root * (y - mean))).sum();
        target.iter_mut().zip(&roots).for_each(|(y, root)| *y *= root);
    }
    let objective = LawObjective { family, series, target, roots, variation, stop };

    let begun = beginnings(&objective, options);
    if begun.first().is_none_or(|best| best.value().square_residual == UNFINISHED) {
        return Err(Error::Stopped);
    }
    let drawn = options.starts() * DRAWS_PER_START;
    let rounds = options.epochs();
    let plan = RoundPlan { rounds, spared: 0, to_prove_itself: ROUNDS_TO_PROVE_ITSELF, finalists: FINALISTS };
    let mut descents = MultiStart::new(begun);
    let tell = |descents: &MultiStart<Descent>, round| {
        let best = descents.best();
        let law = || law(&objective.parameters(best.u()), &best.value().weights);
        let told = observer(SearchProgress {
            round,
            rounds,
            evaluations: drawn + descents.evaluations(),
            train_nrmse_percent: objective.nrmse_percent(best.value()),
            law: PartialLaw(Some(&law)),
        });
        if stop.is_asked() { ControlFlow::Break(()) } else { told }
    };
    let termination = descents.run(plan, |descent, _| descent.advance(&objective), tell);
    let best = descents.best();
    Ok(IdentifiedLaw {
        law: best.value().weights.clone(),
        searched: objective.parameters(best.u()),
        train_nrmse_percent: objective.nrmse_percent(best.value()),
        evaluations: drawn + descents.evaluations(),
        termination,
    })
}

/// The best of many points that lie apart: those of a similar fit, suggested and random ones.
fn beginnings(objective: &LawObjective<'_>, options: &ClassicalOptions) -> Vec<Descent> {
    let variables = &objective.family.unknowns().variables;
    let starts = options.starts();
    let mut suggested = objective.family.suggestions();
    if options.near.len() == variables.len() {
        suggested.insert(0, options.near.clone());
    }
    let draw = |index: usize| -> Vec<f64> {
        if let Some(values) = suggested.get(index) {
            return variables.iter().zip(values).map(|(variable, &value)| variable.place(value)).collect();
        }
        let mut generator = generator(options.seed, index);
        variables.iter().map(|_| generator.random()).collect()
    };
    let count = suggested.len().max(starts * DRAWS_PER_START);
    // Only the best point keeps its residual: thousands of them would be gigabytes.
    let best: Mutex<Option<Descent>> = Mutex::new(None);
    let reached = |group: usize| -> Vec<(f64, Vec<f64>)> {
        let first = group * SIDE_BY_SIDE;
        let drawn: Vec<Vec<f64>> = (first..count.min(first + SIDE_BY_SIDE)).map(draw).collect();
        let values = objective.values(&drawn);
        let mut best = best.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let found = drawn.into_iter().zip(values).map(|(u, value)| {
            let square_residual = value.square_residual;
            if best.as_ref().is_none_or(|best| square_residual < best.value().square_residual) {
                *best = Some(Descent::new(u.clone(), value));
            }
            (square_residual, u)
        });
        found.collect()
    };
    let groups = count.div_ceil(SIDE_BY_SIDE);
    let mut points: Vec<(f64, Vec<f64>)> = parallel::numbered(groups, reached).concat();
    if objective.stop.is_asked() {
        return best.into_inner().ok().flatten().into_iter().collect();
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let distance = |a: &[f64], b: &[f64]| {
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        (square / a.len().max(1) as f64).sqrt()
    };
    let mut chosen: Vec<Vec<f64>> = Vec::new();
    let mut near = Vec::new();
    for (_, point) in points {
        if chosen.len() == starts {
            break;
        }
        let is_apart = chosen.iter().all(|other| distance(&point, other) >= APART);
        (if is_apart { &mut chosen } else { &mut near }).push(point);
    }
    let missing = starts - chosen.len();
    chosen.extend(near.into_iter().take(missing));
    let begin = |u: Vec<f64>| {
        let value = objective.value(&u);
        Descent::new(u, value)
    };
    let begun: Vec<Descent> = parallel::each_taken(chosen, begin);
    match begun[0].value().square_residual {
        UNFINISHED => best.into_inner().ok().flatten().into_iter().collect(),
        _ => begun,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use rand::RngExt;

    use super::*;

    /// Several points evaluated side by side give the features of each alone, to the last bit.
    pub(crate) fn assert_side_by_side(family: &dyn SearchFamily, series: &[Series]) {
        let mut generator = generator(1, 0);
        let Unknowns { variables, non_negative } = family.unknowns();
        for count in 2..=SIDE_BY_SIDE {
            let mut draw = || variables.iter().map(|variable| variable.value(generator.random())).collect();
            let points: Vec<Vec<f64>> = (0..count).map(|_| draw()).collect();
            let empty = || FeatureColumns::new(non_negative.len(), 0, StopCheck::never());
            let mut together: Vec<FeatureColumns<'_>> = points.iter().map(|_| empty()).collect();
            series.iter().for_each(|series| family.features_side_by_side(&points, series, &mut together));
            for (point, together) in points.iter().zip(together) {
                let mut alone = empty();
                series.iter().for_each(|series| family.features(point, series, &mut alone));
                assert_eq!(alone.into_columns(), together.into_columns(), "{point:?}");
            }
        }
    }
}
