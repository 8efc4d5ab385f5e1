//! Identification of models that are linear in their weights: least squares with a penalty, chosen by
//! cross-validation.
//!
//! ```text
//! w = argmin ½ wᵀ(A + λP) w - bᵀw,    A = ΦᵀΦ/N,  b = Φᵀy/N          theory.md (7.1)
//! ```
//!
//! `Φ` has one row of features for each of the `N` scored rows, and does not depend on the weights `w`; `y`
//! is the measured output, `P` a penalty and `λ` its factor.
//!
//! Features are computed once over whole records, so that memory continues from one block of rows to the
//! next. The sums of each block are separate; the training sum of a fold is the total minus the held-out
//! block. Rows with a blank output are not used.

pub mod output_weights;

use std::ops::Range;

use hysid_core::elementary::{exp, ln};

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{DataProblem, Error, Result};
use crate::law::series::Series;
use crate::linear_algebra::{Batch, Gram, Symmetric};
use crate::network::scaling::Scaling;
use crate::optimise::non_negative::{Penalty, Quadratic, WeightBounds};
use crate::optimise::parallel;
use crate::options::classical::Sign;
use crate::stop_check::{Pace, StopCheck};
use crate::validation::RowFolds;

/// Rows that are copied into a batch together: a cache line.
const LINE: usize = 8;

#[derive(Debug, Clone)]
pub(crate) struct TrainingRows {
    pub series: Vec<Series>,
    /// Folds of the rows of all series.
    pub folds: RowFolds,
    pub scaling: Scaling,
}

impl TrainingRows {
    /// All rows of identifiable data with one input.
    pub fn of(data: &Dataset) -> Result<Self> {
        data.check_identifiable(FEWEST_ROWS)?;
        let found = data.names().inputs.len();
        if found != 1 {
            return Err(data.records()[0].defect(None, None, DataProblem::Inputs { expected: 1, found }));
        }
        let scaling = Scaling::of(data, None)?;
        Ok(Self { series: Series::all(data, None)?, folds: RowFolds::of(data), scaling })
    }
}

/// `ΦᵀΦ`, `Φᵀy` and `yᵀy` of some rows.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    /// Gram matrix of the features, then the target.
    gram: Gram,
    /// Number of rows, or the sum of their weights.
    rows: f64,
    features: usize,
}

impl Sums {
    pub fn new(gram: Gram, features: usize, rows: f64) -> Self {
        Self { gram, rows, features }
    }

    /// Number of features.
    pub fn features(&self) -> usize {
        self.features
    }

    /// Mean square error of weights on these rows.
    pub fn mean_square_error(&self, weights: &[f64]) -> f64 {
        let n = self.features;
        let mut sum = self.gram.at(n, n);
        for (i, &weight) in weights.iter().enumerate() {
            let row: f64 = (0..i).map(|j| self.gram.at(i, j) * weights[j]).sum();
            sum += weight * (2.0 * row + self.gram.at(i, i) * weight - 2.0 * self.gram.at(n, i));
        }
        // The terms cancel up to rounding.
        sum.max(1e-14 * self.gram.at(n, n)) / self.rows_or_one()
    }

    /// The quadratic form `½ wᵀAw - bᵀw`, without penalty (theory.md (7.1)).
    pub fn quadratic(&self) -> Quadratic {
        let (n, rows) = (self.features, self.rows_or_one());
        Quadratic {
            matrix: Symmetric::from_fn(n, |i, j| self.gram.at(i, j) / rows),
            right: (0..n).map(|i| self.gram.at(n, i) / rows).collect(),
        }
    }

    /// Adds the rows of `other` for the factor 1, and takes them away for -1.
    pub fn add(&mut self, other: &Sums, factor: f64) {
        self.gram.add_multiple(&other.gram, factor);
        self.rows += factor.signum() * other.rows;
    }

    fn rows_or_one(&self) -> f64 {
        if self.rows > 0.0 { self.rows } else { 1.0 }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct FoldSums {
    folds: Vec<Sums>,
    judged: Vec<usize>,
}

impl FoldSums {
    pub fn new(folds: Vec<Sums>, judged: Vec<usize>) -> Self {
        Self { folds, judged }
    }

    /// Sums of all rows.
    pub fn total(&self) -> Sums {
        self.clone().into_total()
    }

    /// Sums of all rows, without a copy.
    pub fn into_total(self) -> Sums {
        let mut folds = self.folds.into_iter();
        let mut total = folds.next().expect("there is at least one fold");
        folds.for_each(|fold| total.add(&fold, 1.0));
        total
    }

    /// The weights with the penalty and the sign of a choice.
    pub fn weights(
        self,
        penalty: &Penalty,
        choice: PenaltyChoice,
        reversible: Range<usize>,
        stop: StopCheck<'_>,
    ) -> Result<Vec<f64>> {
        let bounds = WeightBounds::new(choice.sign, reversible, self.folds[0].features);
        let mut penalised = self.into_total().quadratic();
        penalised.penalise(penalty, choice.factor);
        penalised.last_minimum(&bounds, stop)
    }

    /// For every candidate, the mean over the folds of the logarithm of the mean square error on a fold
    /// when trained on the others. `solve` gives the weights of all candidates for some sums, in order,
    /// so that each may start from the one before.
    ///
    /// The logarithm keeps one fold that lies beyond the others from deciding everything. Asked to stop, those
    /// folds decide that were done; `None` if there is none.
    pub fn scores(
        &self,
        solve: impl Fn(&Quadratic) -> Option<Vec<Vec<f64>>> + Sync,
        stop: StopCheck<'_>,
    ) -> Option<Vec<f64>> {
        let total = self.total();
        let judged = self.judged.iter().map(|&fold| &self.folds[fold]);
        let held_out: Vec<&Sums> = judged.filter(|fold| fold.rows > 0.0).collect();
        let judge = |fold: &&Sums| -> Option<Vec<f64>> {
            if stop.is_asked() {
                return None;
            }
            let mut rest = total.clone();
            rest.add(fold, -1.0);
            let candidates = solve(&rest.quadratic())?;
            Some(candidates.iter().map(|weights| ln(fold.mean_square_error(weights))).collect())
        };
        let by_fold: Vec<Option<Vec<f64>>> = parallel::each(&held_out, judge);
        let by_fold: Vec<Vec<f64>> = by_fold.into_iter().flatten().collect();
        let mut mean = vec![0.0; by_fold.first()?.len()];
        for scores in &by_fold {
            mean.iter_mut().zip(scores).for_each(|(mean, score)| *mean += score / by_fold.len() as f64);
        }
        Some(mean)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PenaltyChoice {
    /// Mean over the folds of the logarithm of the mean square error.
    pub score: f64,
    /// Factor of the penalty.
    pub factor: f64,
    /// Sign of the weights.
    pub sign: Sign,
}

impl FoldSums {
    /// Chooses sign (one of all, if none is given) and factor of the penalty; weights of `reversible` are
    /// bounded as those of [`WeightBounds::new`]. Asked to stop before anything was compared, it is a factor in the
    /// middle and the first of the signs.
    pub fn choose(
        &self,
        penalty: &Penalty,
        factors: &[f64],
        sign: Option<Sign>,
        reversible: &Range<usize>,
        stop: StopCheck<'_>,
    ) -> PenaltyChoice {
        let features = self.folds[0].features;
        let signs = sign.map_or(Sign::ALL.to_vec(), |sign| vec![sign]);
        let mut candidates = Vec::new();
        for &sign in &signs {
            let bounds = WeightBounds::new(sign, reversible.clone(), features);
            let path = |rest: &Quadratic| rest.path(penalty, factors, &bounds, stop);
            let Some(scores) = self.scores(path, stop) else { break };
            let choices = scores.iter().zip(factors);
            candidates.extend(choices.map(|(&score, &factor)| PenaltyChoice { score, factor, sign }));
        }
        if candidates.is_empty() {
            return PenaltyChoice {
                score: f64::INFINITY,
                factor: factors[factors.len() / 2],
                sign: signs[0],
            };
        }
        let scores: Vec<f64> = candidates.iter().map(|choice| choice.score).collect();
        candidates[lowest(&scores)]
    }
}

pub(crate) fn lowest(scores: &[f64]) -> usize {
    let order = (0..scores.len()).min_by(|&a, &b| scores[a].total_cmp(&scores[b]));
    order.expect("at least one candidate")
}

pub(crate) struct SumGatherer<'a> {
    pace: Pace<'a>,
    folds: Vec<Sums>,
    judged: Vec<usize>,
    batch: Batch,
    lines: Vec<[f64; LINE]>,
    filled: usize,
    fold: usize,
}

impl<'a> SumGatherer<'a> {
    pub fn new(features: usize, folds: &RowFolds, stop: StopCheck<'a>) -> Self {
        Self {
            pace: Pace::new(stop),
            folds: vec![Sums::new(Gram::new(features + 1), features, 0.0); folds.count],
            judged: folds.judged.clone(),
            batch: Batch::new(features + 1),
            lines: vec![[0.0; LINE]; features + 1],
            filled: 0,
            fold: 0,
        }
    }

    /// Counts the operations of one more row; true once stopped.
    pub fn is_over(&mut self, operations: usize) -> bool {
        self.pace.is_over(operations)
    }

    /// Adds a row, unless its target is blank.
    pub fn add(&mut self, fold: usize, features: &[f64], target: f64) {
        self.add_weighted(fold, features, target, 1.0);
    }

    /// Adds a row that counts as many times as its weight says, unless its target is blank.
    pub fn add_weighted(&mut self, fold: usize, features: &[f64], target: f64, weight: f64) {
        if target.is_nan() {
            return;
        }
        if fold != self.fold {
            self.flush();
            self.fold = fold;
        }
        // The squares of the root are the weight.
        let root = weight.sqrt();
        for (line, &value) in self.lines.iter_mut().zip(features) {
            line[self.filled] = root * value;
        }
        self.lines[features.len()][self.filled] = root * target;
        self.filled += 1;
        self.folds[fold].rows += weight;
        if self.filled == LINE {
            self.batch.append(self.lines.iter(), LINE);
            self.filled = 0;
            if self.batch.free() < LINE {
                self.folds[fold].gram.gather(&mut self.batch, &mut self.pace);
            }
        }
    }

    fn flush(&mut self) {
        self.batch.append(self.lines.iter(), self.filled);
        self.filled = 0;
        self.folds[self.fold].gram.gather(&mut self.batch, &mut self.pace);
    }

    /// The sums; an error if a stop left out rows.
    pub fn finish(mut self) -> Result<FoldSums> {
        self.flush();
        if self.pace.is_over(0) {
            return Err(Error::Stopped);
        }
        Ok(FoldSums { folds: self.folds, judged: self.judged })
    }
}

/// Logarithmically even values from `first` to `last`, both included.
pub(crate) fn logarithmic(first: f64, last: f64, count: usize) -> Vec<f64> {
    let ratio = ln(last / first) / (count.max(2) - 1) as f64;
    (0..count).map(|k| first * exp(ratio * k as f64)).collect()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{sin, square};

    use super::*;

    /// Weights 1, 2 and 4, whose roots or squares of roots are exact enough, against rows that are added so many times.
    #[test]
    fn a_weight_is_a_row_added_so_many_times() {
        let one = RowFolds::one();
        let [mut weighted, mut repeated] = [0, 1].map(|_| SumGatherer::new(2, &one, StopCheck::never()));
        for k in 0..300 {
            let (x, times) = (0.01 * f64::from(k), [1, 2, 4][k as usize % 3]);
            let (features, target) = ([1.0, x], sin(3.0 * x));
            weighted.add_weighted(0, &features, target, f64::from(times));
            (0..times).for_each(|_| repeated.add(0, &features, target));
        }
        let [weighted, repeated] = [weighted, repeated].map(|sums| sums.finish().unwrap().total());
        assert_eq!(weighted.rows, 700.0);
        let fit = |sums: &Sums| sums.quadratic().minimum(StopCheck::never()).unwrap();
        let (a, b) = (fit(&weighted), fit(&repeated));
        for (a, b) in a.iter().zip(&b) {
            approx::assert_relative_eq!(*a, *b, max_relative = 1e-11);
        }
        approx::assert_relative_eq!(
            weighted.mean_square_error(&a),
            repeated.mean_square_error(&b),
            max_relative = 1e-11
        );
    }

    #[test]
    fn the_error_from_sums_is_that_of_the_rows() {
        let one = RowFolds::one();
        let mut gatherer = SumGatherer::new(2, &one, StopCheck::never());
        for k in 0..1000 {
            let x = f64::from(k) * 0.01;
            gatherer.add(0, &[1.0, x], if k % 10 == 0 { f64::NAN } else { 2.0 + 3.0 * x + sin(x * 7.0) });
        }
        let sums = gatherer.finish().unwrap().total();
        let rows = (0..1000).filter(|k| k % 10 != 0).map(|k| square(sin(f64::from(k) * 0.07)));
        approx::assert_relative_eq!(
            sums.mean_square_error(&[2.0, 3.0]),
            rows.sum::<f64>() / 900.0,
            epsilon = 1e-9
        );
        let fitted = sums.quadratic().minimum(StopCheck::never()).unwrap();
        assert!((fitted[0] - 2.0).abs() < 0.1 && (fitted[1] - 3.0).abs() < 0.05);
    }
}
