//! What all models that are linear in their weights share: sums over rows of features, least squares
//! with penalties, and the choice of a penalty by cross-validation.
//!
//! ```text
//! w = argmin ½ wᵀ(A + P) w - bᵀw,    A = ΦᵀΦ/N,  b = Φᵀy/N           theory.md (7.1)
//! ```
//!
//! Features are computed once over whole records, so that memory carries over from one block of rows
//! to the next; each block's sums are kept apart, and what is trained on is the sum of all blocks less
//! the one held out. A row with a blank output enters nowhere.

use std::ops::Range;

use rayon::prelude::*;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{DataProblem, Error, Result};
use crate::law::series::Series;
use crate::linear_algebra::{Batch, Gram, Symmetric};
use crate::options::classical::Sign;
use crate::stop_check::{Pace, StopCheck};

/// Blocks that the rows are cut into for cross-validation.
const FOLDS: usize = 5;

/// Records from which on each is a fold by itself.
const RECORDS_AS_FOLDS: usize = 3;

/// Share of the range of the other records by which one may exceed it and still lie within.
const SLACK: f64 = 0.03;

/// Rows that are copied into a batch together: a cache line.
const LINE: usize = 8;

/// Series of a data set with one input, all that a classical model can be fitted to.
///
/// # Errors
/// Data that nothing can be identified from, or more than one input.
pub(crate) fn identifiable_series(data: &Dataset) -> Result<Vec<Series>> {
    data.check_identifiable(FEWEST_ROWS)?;
    let found = data.names().inputs.len();
    if found != 1 {
        return Err(data.records()[0].defect(None, None, DataProblem::Inputs { expected: 1, found }));
    }
    Series::all(data, None)
}

/// How rows are cut into folds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folds {
    /// Fold of every row of every record.
    pub of_rows: Vec<Vec<usize>>,
    /// Number of folds.
    pub count: usize,
    /// Folds that are held out in turn, in rising order.
    pub judged: Vec<usize>,
}

impl Folds {
    /// Folds for records given by their inputs and outputs (NaN where blank). From three records on, each
    /// is a fold, and those are held out whose input stays within the range of the others, so that what
    /// is judged lies between what is trained on; else blocks of rows that have an output are held out in
    /// turn.
    pub fn of(records: &[(Vec<f64>, &[f64])]) -> Self {
        if records.len() >= RECORDS_AS_FOLDS {
            let count = records.len().min(2 * FOLDS);
            let of_rows: Vec<Vec<usize>> =
                records.iter().enumerate().map(|(index, (x, _))| vec![index % count; x.len()]).collect();
            let range = |chosen: &dyn Fn(usize) -> bool| {
                let inputs = (0..records.len())
                    .filter(|index| chosen(index % count))
                    .flat_map(|index| &records[index].0);
                inputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
            };
            let is_within = |fold: &usize| {
                let (inside, outside) = (range(&|other| other == *fold), range(&|other| other != *fold));
                let slack = SLACK * (outside.1 - outside.0);
                inside.0 >= outside.0 - slack && inside.1 <= outside.1 + slack
            };
            let mut judged: Vec<usize> = (0..count).filter(is_within).collect();
            if judged.is_empty() {
                judged = (0..count).collect();
            }
            return Self { of_rows, count, judged };
        }
        let scored = records.iter().flat_map(|(_, y)| y.iter()).filter(|y| !y.is_nan()).count();
        let mut seen = 0;
        let mut fold_of = |y: &f64| {
            let fold = (seen * FOLDS / scored.max(1)).min(FOLDS - 1);
            seen += usize::from(!y.is_nan());
            fold
        };
        let of_rows = records.iter().map(|(_, y)| y.iter().map(&mut fold_of).collect()).collect();
        Self { of_rows, count: FOLDS, judged: (0..FOLDS).collect() }
    }

    /// All rows together, for sums that nothing is held out of.
    pub fn none(series: &[Series]) -> Self {
        let of_rows = series.iter().map(|series| vec![0; series.samples.len()]).collect();
        Self { of_rows, count: 1, judged: vec![0] }
    }

    /// Rows that are all in one fold, whichever record they are of.
    pub fn one() -> Self {
        Self { of_rows: Vec::new(), count: 1, judged: vec![0] }
    }

    /// Folds for series.
    pub fn of_series(series: &[Series]) -> Self {
        let inputs = |series: &Series| series.samples.iter().map(|sample| sample.x).collect();
        let records: Vec<(Vec<f64>, &[f64])> =
            series.iter().map(|series| (inputs(series), series.output.as_slice())).collect();
        Self::of(&records)
    }
}

/// `ΦᵀΦ`, `Φᵀy` and `yᵀy` of some rows.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    /// Gram matrix of the features, then the target.
    gram: Gram,
    rows: usize,
    features: usize,
}

impl Sums {
    pub fn new(gram: Gram, features: usize, rows: usize) -> Self {
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
        sum.max(1e-14 * self.gram.at(n, n)) / self.rows.max(1) as f64
    }

    /// The quadratic form of theory.md (7.1), without penalty.
    pub fn quadratic(&self) -> Quadratic {
        let (n, rows) = (self.features, self.rows.max(1) as f64);
        Quadratic {
            matrix: Symmetric::from_fn(n, |i, j| self.gram.at(i, j) / rows),
            right: (0..n).map(|i| self.gram.at(n, i) / rows).collect(),
        }
    }

    /// The same, without keeping the sums beside it.
    pub fn into_quadratic(self) -> Quadratic {
        self.quadratic()
    }

    fn add_multiple(&mut self, other: &Sums, factor: f64, rows: usize) {
        self.gram.add_multiple(&other.gram, factor);
        self.rows = rows;
    }
}

/// Sums of each fold.
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
        for fold in folds {
            let rows = total.rows + fold.rows;
            total.add_multiple(&fold, 1.0, rows);
        }
        total
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
        let held_out: Vec<&Sums> = judged.filter(|fold| fold.rows > 0).collect();
        let judge = |fold: &&Sums| -> Option<Vec<f64>> {
            if stop.is_asked() {
                return None;
            }
            let mut rest = total.clone();
            rest.add_multiple(fold, -1.0, total.rows - fold.rows);
            let candidates = solve(&rest.quadratic())?;
            Some(candidates.iter().map(|weights| fold.mean_square_error(weights).ln()).collect())
        };
        let by_fold: Vec<Option<Vec<f64>>> = held_out.par_iter().map(judge).collect();
        let by_fold: Vec<Vec<f64>> = by_fold.into_iter().flatten().collect();
        let mut mean = vec![0.0; by_fold.first()?.len()];
        for scores in &by_fold {
            mean.iter_mut().zip(scores).for_each(|(mean, score)| *mean += score / by_fold.len() as f64);
        }
        Some(mean)
    }
}

/// What cross-validation chose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Choice {
    /// Mean over the folds of the logarithm of the mean square error.
    pub score: f64,
    /// Factor of the penalty.
    pub factor: f64,
    /// Sign of the weights.
    pub sign: Sign,
}

impl FoldSums {
    /// Chooses sign (one of all, if none is given) and factor of the penalty; weights of `reversible` are
    /// bounded as those of [`Bounds::new`]. Asked to stop before anything was compared, it is a factor in the
    /// middle and the first of the signs.
    pub fn choose(
        &self,
        penalty: &Penalty,
        factors: &[f64],
        sign: Option<Sign>,
        reversible: &Range<usize>,
        stop: StopCheck<'_>,
    ) -> Choice {
        let features = self.folds[0].features;
        let signs = sign.map_or(Sign::ALL.to_vec(), |sign| vec![sign]);
        let mut candidates = Vec::new();
        for &sign in &signs {
            let bounds = Bounds::new(sign, reversible.clone(), features);
            let path = |rest: &Quadratic| rest.path(penalty, factors, &bounds, stop);
            let Some(scores) = self.scores(path, stop) else { break };
            let choices = scores.iter().zip(factors);
            candidates.extend(choices.map(|(&score, &factor)| Choice { score, factor, sign }));
        }
        if candidates.is_empty() {
            return Choice { score: f64::INFINITY, factor: factors[factors.len() / 2], sign: signs[0] };
        }
        let scores: Vec<f64> = candidates.iter().map(|choice| choice.score).collect();
        candidates[lowest(&scores)]
    }
}

/// Place of the lowest score.
pub(crate) fn lowest(scores: &[f64]) -> usize {
    let order = (0..scores.len()).min_by(|&a, &b| scores[a].total_cmp(&scores[b]));
    order.expect("at least one candidate")
}

/// Gathers rows of features, fold by fold.
pub(crate) struct Gatherer<'a> {
    pace: Pace<'a>,
    folds: Vec<Sums>,
    judged: Vec<usize>,
    batch: Batch,
    lines: Vec<[f64; LINE]>,
    filled: usize,
    fold: usize,
}

impl<'a> Gatherer<'a> {
    pub fn new(features: usize, folds: &Folds, stop: StopCheck<'a>) -> Self {
        Self {
            pace: Pace::new(stop),
            folds: vec![Sums::new(Gram::new(features + 1), features, 0); folds.count],
            judged: folds.judged.clone(),
            batch: Batch::new(features + 1),
            lines: vec![[0.0; LINE]; features + 1],
            filled: 0,
            fold: 0,
        }
    }

    /// Counts the operations of one more row; true once asked to stop.
    pub fn is_over(&mut self, operations: usize) -> bool {
        self.pace.is_over(operations)
    }

    /// Adds a row, unless its target is blank.
    pub fn add(&mut self, fold: usize, features: &[f64], target: f64) {
        if target.is_nan() {
            return;
        }
        if fold != self.fold {
            self.flush();
            self.fold = fold;
        }
        for (line, &value) in self.lines.iter_mut().zip(features) {
            line[self.filled] = value;
        }
        self.lines[features.len()][self.filled] = target;
        self.filled += 1;
        self.folds[fold].rows += 1;
        if self.filled == LINE {
            self.batch.append(&self.lines, LINE);
            self.filled = 0;
            if self.batch.free() < LINE {
                self.folds[fold].gram.gather(&mut self.batch, &mut self.pace);
            }
        }
    }

    fn flush(&mut self) {
        self.batch.append(&self.lines, self.filled);
        self.filled = 0;
        self.folds[self.fold].gram.gather(&mut self.batch, &mut self.pace);
    }

    /// # Errors
    /// A stop before all rows were gathered.
    pub fn finish(mut self) -> Result<FoldSums> {
        self.flush();
        if self.pace.is_over(0) {
            return Err(Error::Stopped);
        }
        Ok(FoldSums { folds: self.folds, judged: self.judged })
    }
}

/// Which weights are bounded, and how.
#[derive(Debug, Clone)]
pub(crate) struct Bounds {
    bounded: Vec<bool>,
    /// Of the bounded ones, those that are at most 0.
    flipped: Vec<bool>,
}

impl Bounds {
    /// Bounds of `count` weights under a sign: those after the first `reversible.end` have it, and those
    /// of `reversible` are at least 0 beside them; those before are free.
    pub fn new(sign: Sign, reversible: Range<usize>, count: usize) -> Self {
        Self {
            bounded: (0..count).map(|i| sign != Sign::Any && i >= reversible.start).collect(),
            flipped: (0..count).map(|i| sign == Sign::NonPositive && i >= reversible.end).collect(),
        }
    }

    /// Weights of `signed` have a sign, those of `positive` are at least 0, the others are free.
    pub fn apart(sign: Sign, signed: Range<usize>, positive: Range<usize>, count: usize) -> Self {
        let has_sign = |i: &usize| sign != Sign::Any && signed.contains(i);
        Self {
            bounded: (0..count).map(|i| has_sign(&i) || positive.contains(&i)).collect(),
            flipped: (0..count).map(|i| sign == Sign::NonPositive && signed.contains(&i)).collect(),
        }
    }

    /// Takes weights back to their bounds.
    pub fn limit(&self, weights: &mut [f64]) {
        let sides = self.bounded.iter().zip(&self.flipped);
        for (weight, (_, &flipped)) in weights.iter_mut().zip(sides).filter(|(_, (bounded, _))| **bounded) {
            *weight = if flipped { weight.min(0.0) } else { weight.max(0.0) };
        }
    }

    fn turn(&self, weights: &mut [f64]) {
        weights.iter_mut().zip(&self.flipped).filter(|(_, flipped)| **flipped).for_each(|(w, _)| *w = -*w);
    }
}

/// The function `½ wᵀMw - bᵀw` to be minimised.
#[derive(Debug, Clone)]
pub(crate) struct Quadratic {
    pub matrix: Symmetric,
    pub right: Vec<f64>,
}

impl Quadratic {
    /// Adds the penalty `½ factor wᵀPw`.
    pub fn penalise(&mut self, penalty: &Penalty, factor: f64) {
        for &(i, j, value) in &penalty.entries {
            self.matrix.add_at(i, j, factor * value);
        }
    }

    /// The minimum; `None` once asked to stop. Where rounding makes the matrix indefinite, a ridge is added
    /// until it is not.
    pub fn minimum(&self, stop: StopCheck<'_>) -> Option<Vec<f64>> {
        minimum(&self.matrix, self.right.clone(), stop)
    }

    /// The minimum within bounds, from a guess near it (or none: an empty one); `None` once asked to stop.
    pub fn minimum_within(mut self, bounds: &Bounds, guess: &[f64], stop: StopCheck<'_>) -> Option<Vec<f64>> {
        if !bounds.bounded.contains(&true) {
            return self.minimum(stop);
        }
        self.flip(&bounds.flipped);
        let mut guess = guess.to_vec();
        bounds.turn(&mut guess);
        let mut weights = self.non_negative_minimum(&bounds.bounded, &guess, stop)?;
        bounds.turn(&mut weights);
        Some(weights)
    }

    /// The minimum that a fit ends with. Asked to stop, it is still found where that takes little time.
    ///
    /// # Errors
    /// A stop, where it takes long.
    pub fn last_minimum(self, bounds: &Bounds, stop: StopCheck<'_>) -> Result<Vec<f64>> {
        let stop = if self.right.len() <= QUICKLY_SOLVED { StopCheck::never() } else { stop };
        self.minimum_within(bounds, &[], stop).ok_or(Error::Stopped)
    }

    /// Minima with each of several factors of a penalty, in their order (rising); `None` once asked to stop.
    pub fn path(
        &self,
        penalty: &Penalty,
        factors: &[f64],
        bounds: &Bounds,
        stop: StopCheck<'_>,
    ) -> Option<Vec<Vec<f64>>> {
        let mut path: Vec<Vec<f64>> = Vec::new();
        // From the largest on, each from the one before.
        for &factor in factors.iter().rev() {
            let mut penalised = self.clone();
            penalised.penalise(penalty, factor);
            let guess = path.last().map_or(&[] as &[f64], Vec::as_slice);
            path.push(penalised.minimum_within(bounds, guess, stop)?);
        }
        path.reverse();
        Some(path)
    }

    /// The same function of the weights with some of them of opposite sign.
    fn flip(&mut self, flipped: &[bool]) {
        let n = self.right.len();
        for i in (0..n).filter(|&i| flipped[i]) {
            self.right[i] = -self.right[i];
        }
        for i in 0..n {
            for j in (0..i).filter(|&j| flipped[i] != flipped[j]) {
                let value = self.matrix.at(i, j);
                self.matrix.add_at(i, j, -2.0 * value);
            }
        }
    }

    /// The minimum with `w_i ≥ 0` for all `i` with `bounded[i]`, from a guess which of them are positive
    /// (all, if it is empty); `None` once asked to stop. Block principal pivoting (Portugal, Júdice and Vicente 1994): variables
    /// change sides all at once while that lowers the number of those on the wrong side, else one at
    /// a time (Murty), which ends for a positive definite matrix.
    pub fn non_negative_minimum(
        &self,
        bounded: &[bool],
        guess: &[f64],
        stop: StopCheck<'_>,
    ) -> Option<Vec<f64>> {
        let n = self.right.len();
        let mut free: Vec<bool> =
            (0..n).map(|i| !bounded[i] || guess.get(i).is_none_or(|&w| w > 0.0)).collect();
        let scale = self.right.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let (mut fewest, mut patience) = (n + 1, PATIENCE);
        let mut weights = vec![0.0; n];
        for _ in 0..MOST_PIVOTS {
            let chosen: Vec<usize> = (0..n).filter(|&i| free[i]).collect();
            let right = chosen.iter().map(|&i| self.right[i]).collect();
            let solution = minimum(&self.matrix.select(&chosen), right, stop)?;
            weights.fill(0.0);
            chosen.iter().zip(&solution).for_each(|(&i, &w)| weights[i] = w);
            let product = self.matrix.times(&weights);
            let largest = solution.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
            let is_wrong = |i: &usize| {
                let slope = product[*i] - self.right[*i];
                bounded[*i]
                    && if free[*i] { weights[*i] < -ROUNDING * largest } else { slope < -ROUNDING * scale }
            };
            let wrong: Vec<usize> = (0..n).filter(is_wrong).collect();
            let Some(&last) = wrong.last() else {
                break;
            };
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                free[last] = !free[last];
                continue;
            }
            wrong.iter().for_each(|&i| free[i] = !free[i]);
        }
        (0..n).filter(|&i| bounded[i]).for_each(|i| weights[i] = weights[i].max(0.0));
        Some(weights)
    }
}

/// Exchanges of many variables without progress, before they are exchanged singly.
const PATIENCE: usize = 3;

/// Exchanges after which the result is taken as it is, with negative weights set to 0. Of the order
/// of ten are needed.
const MOST_PIVOTS: usize = 500;

/// Weights that are found within some hundredths of a second.
const QUICKLY_SOLVED: usize = 500;

/// Wrong sides up to this, relative to the largest, are rounding.
const ROUNDING: f64 = 1e-11;

/// The minimum; of a matrix that is not finite, all zeros.
fn minimum(matrix: &Symmetric, right: Vec<f64>, stop: StopCheck<'_>) -> Option<Vec<f64>> {
    let mut pace = Pace::new(stop);
    let n = right.len();
    let largest = (0..n).map(|i| matrix.diagonal(i)).fold(1e-300, f64::max);
    let mut ridge = 0.0;
    loop {
        if pace.is_over(n * n * n / 6) {
            return None;
        }
        let mut raised = matrix.clone();
        (0..n).for_each(|i| raised.add_to_diagonal(i, ridge));
        if let Some(factor) = raised.cholesky(stop) {
            let mut weights = right;
            factor.solve(&mut weights);
            return Some(weights);
        }
        // Only numbers that are none are not made definite by a ridge as large as that.
        if ridge > 1e12 * largest {
            return Some(vec![0.0; n]);
        }
        ridge = (ridge * 10.0).max(1e-14 * largest);
    }
}

/// A penalty `wᵀPw`, sparse.
#[derive(Debug, Clone, Default)]
pub(crate) struct Penalty {
    /// Entries of the lower triangle, `row ≥ column`; several of one place add up.
    entries: Vec<(usize, usize, f64)>,
}

impl Penalty {
    /// `Σ_i weight_i w_i²`
    pub fn ridge(weights: impl IntoIterator<Item = f64>) -> Self {
        let entries = weights.into_iter().enumerate().map(|(i, weight)| (i, i, weight));
        Self { entries: entries.filter(|entry| entry.2 != 0.0).collect() }
    }

    /// Adds `factor (Σ_k c_k w_k)²`, for instance of a difference.
    pub fn add_square(&mut self, combination: &[(usize, f64)], factor: f64) {
        for (k, &(i, a)) in combination.iter().enumerate() {
            for &(j, b) in &combination[..=k] {
                self.entries.push((i.max(j), i.min(j), factor * a * b));
            }
        }
    }
}

/// Logarithmically even values from `first` to `last`, both included.
pub(crate) fn logarithmic(first: f64, last: f64, count: usize) -> Vec<f64> {
    let ratio = (last / first).ln() / (count.max(2) - 1) as f64;
    (0..count).map(|k| first * (ratio * k as f64).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal equations of made-up rows; with correlated columns, so that bounds bind.
    fn problem(n: usize, rows: usize, seed: u64) -> Quadratic {
        let value = |row: usize, column: usize| {
            let mixed =
                (row as u64 * 31 + column as u64 * 17 + seed * 101).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (mixed >> 40) as f64 / (1u64 << 24) as f64 - 0.5 + 0.4 * ((row + 3 * column) as f64 * 0.37).sin()
        };
        let one = Folds::one();
        let mut gatherer = Gatherer::new(n, &one, StopCheck::never());
        for row in 0..rows {
            let features: Vec<f64> = (0..n).map(|column| value(row, column)).collect();
            gatherer.add(0, &features, value(row, n));
        }
        gatherer.finish().unwrap().total().quadratic()
    }

    fn objective(problem: &Quadratic, weights: &[f64]) -> f64 {
        let product = problem.matrix.times(weights);
        weights.iter().zip(product).zip(&problem.right).map(|((w, p), b)| w * (0.5 * p - b)).sum()
    }

    #[test]
    fn non_negative_least_squares_finds_the_best_of_all_sets() {
        let n = 7;
        let mut bound_somewhere = 0;
        for seed in 0..40 {
            let problem = problem(n, 30, seed);
            let bounded: Vec<bool> = (0..n).map(|i| i != 2).collect();
            let found = problem.non_negative_minimum(&bounded, &[], StopCheck::never()).unwrap();
            let mut best = f64::INFINITY;
            for set in 0..1usize << n {
                let chosen: Vec<usize> = (0..n).filter(|&i| !bounded[i] || set >> i & 1 == 1).collect();
                let right = chosen.iter().map(|&i| problem.right[i]).collect();
                let part = minimum(&problem.matrix.select(&chosen), right, StopCheck::never()).unwrap();
                let mut weights = vec![0.0; n];
                chosen.iter().zip(part).for_each(|(&i, w)| weights[i] = w);
                if (0..n).all(|i| !bounded[i] || weights[i] >= 0.0) {
                    best = best.min(objective(&problem, &weights));
                }
            }
            assert!((objective(&problem, &found) - best).abs() < 1e-12 * best.abs().max(1e-3));
            bound_somewhere += usize::from(found.contains(&0.0));
            // A bad guess leads to the same place.
            let from_zero =
                problem.non_negative_minimum(&bounded, &vec![0.0; n], StopCheck::never()).unwrap();
            for (a, b) in found.iter().zip(&from_zero) {
                approx::assert_relative_eq!(a, b, epsilon = 1e-9);
            }
        }
        assert!(bound_somewhere > 20, "the bounds hardly ever bound");
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_an_end() {
        let mut problem = problem(5, 30, 1);
        problem.matrix.add_at(2, 1, f64::NAN);
        assert_eq!(problem.minimum(StopCheck::never()), Some(vec![0.0; 5]));
    }

    #[test]
    fn optimality_conditions_hold_for_many_weights() {
        let n = 300;
        let mut problem = problem(n, 420, 5);
        problem.penalise(&Penalty::ridge(vec![1.0; n]), 1e-4);
        problem.right.iter_mut().skip(1).step_by(2).for_each(|right| *right = -*right);
        for sign in [Sign::NonNegative, Sign::NonPositive] {
            let bounds = Bounds::apart(sign, 10..n, 0..0, n);
            let weights = problem.clone().minimum_within(&bounds, &[], StopCheck::never()).unwrap();
            let product = problem.matrix.times(&weights);
            let side = if sign == Sign::NonNegative { 1.0 } else { -1.0 };
            let mut at_bound = 0;
            for i in 0..n {
                let slope = side * (product[i] - problem.right[i]);
                if i < 10 || weights[i] != 0.0 {
                    assert!(slope.abs() < 1e-9, "{i}: {slope}");
                    assert!(i < 10 || side * weights[i] > 0.0);
                } else {
                    assert!(slope > -1e-9, "{i}: {slope}");
                    at_bound += 1;
                }
            }
            assert!(at_bound > 50 && at_bound < n - 50, "{at_bound} at their bounds");
        }
    }

    #[test]
    fn folds_hold_out_records_within_the_range_of_the_others() {
        let record = |size: f64| vec![-size, 0.0, size];
        let y = [0.0, 1.0, f64::NAN];
        let sizes = [3.0, 1.0, 2.0];
        let records: Vec<(Vec<f64>, &[f64])> =
            sizes.iter().map(|&size| (record(size), y.as_slice())).collect();
        let folds = Folds::of(&records);
        assert_eq!((folds.count, folds.judged), (3, vec![1, 2]));
        let long: Vec<f64> = (0..100).map(|k| if k < 50 { f64::NAN } else { 0.0 }).collect();
        let folds = Folds::of(&[(vec![0.0; 100], long.as_slice())]);
        assert_eq!(folds.judged, [0, 1, 2, 3, 4]);
        assert_eq!((folds.of_rows[0][59], folds.of_rows[0][60], folds.of_rows[0][99]), (0, 1, 4));
    }

    #[test]
    fn the_error_from_sums_is_that_of_the_rows() {
        let one = Folds::one();
        let mut gatherer = Gatherer::new(2, &one, StopCheck::never());
        for k in 0..1000 {
            let x = f64::from(k) * 0.01;
            gatherer.add(0, &[1.0, x], if k % 10 == 0 { f64::NAN } else { 2.0 + 3.0 * x + (x * 7.0).sin() });
        }
        let sums = gatherer.finish().unwrap().total();
        let rows = (0..1000).filter(|k| k % 10 != 0).map(|k| ((f64::from(k) * 0.07).sin()).powi(2));
        approx::assert_relative_eq!(
            sums.mean_square_error(&[2.0, 3.0]),
            rows.sum::<f64>() / 900.0,
            epsilon = 1e-9
        );
        let fitted = sums.quadratic().minimum(StopCheck::never()).unwrap();
        assert!((fitted[0] - 2.0).abs() < 0.1 && (fitted[1] - 3.0).abs() < 0.05);
    }
}
