//! Identification of a Preisach model: positions of the lines of its plane, and least squares with a
//! smoothness penalty.
//!
//! ```text
//! min Σ_k (y_k - ŷ_k)²/N + λ (‖D²w‖² + ε‖w‖²),     w ≥ 0 on request                theory.md (7.12)
//! ```
//!
//! `y_k` is the measured and `ŷ_k` the simulated output at row `k` of `N`, and `w` are the weights of the
//! cells. `D²` takes second differences along both axes of the plane, counted in cells. Cross-validation
//! chooses `λ`.

use hysid_core::elementary::{powf, powi, square};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::Identify;
use crate::fit::law::candidates::{CandidateRequest, RankedLaw, in_all_compressions};
use crate::fit::law::grids::check_count;
use crate::fit::law::search::IdentifiedLaw;
use crate::fit::memory_need::{FEWER_OPERATORS, FEWER_ROWS, LawFitSize, MemoryNeed};
use crate::fit::progress::SearchObserver;
use crate::fit::sums::{FoldSums, PenaltyChoice, SumGatherer, TrainingRows, logarithmic};
use crate::law::preisach::plane::Plane;
use crate::law::preisach::{MOST_INTERVALS, Preisach, PreisachWeights};
use crate::law::series::Series;
use crate::law::turning_point_stack::{StackChange, TurningPointStack};
use crate::network::scaling::Scaling;
use crate::optimise::non_negative::Penalty;
use crate::options::classical::ClassicalModel;
use crate::options::classical::ClassicalOptions;
use crate::stop_check::{Pace, StopCheck};
use crate::validation::RowFolds;

/// Most intervals on which the penalty is chosen; what is chosen is then taken for the finer plane.
const INTERVALS_FOR_CHOICE: usize = 20;

/// Share of the lines that are spread evenly; the others go where the output changes. Designed.
const EVEN_SHARE: f64 = 0.5;

impl Identify for Preisach {
    const TAKES_WEIGHTS: bool = true;

    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        _: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        // A stop leaves out folds of the choice, and the finer plane.
        let rows = TrainingRows::of(data)?;
        let TrainingRows { series, folds, scaling } = &rows;
        let intervals = options.operators();
        check_count("operators", intervals, MOST_INTERVALS)?;
        let density = LineDensity::new(series, data.input_range(0));
        let penalties = logarithmic(1e-9, 1e2, 12);

        let coarse = PreisachProblem::new(Plane::new(density.lines(intervals.min(INTERVALS_FOR_CHOICE))));
        let sums = coarse.sums(series, scaling, folds, stop)?;
        let choice = sums.choose(&coarse.penalty, &penalties, options.sign, &coarse.reversible(), stop);
        if intervals > INTERVALS_FOR_CHOICE && !stop.is_asked() {
            let fine = PreisachProblem::new(Plane::new(density.lines(intervals)));
            // Nothing is held out here, and the sums of a fine plane are gigabytes.
            let sums = fine.sums(series, scaling, &RowFolds::none(data), stop);
            match sums.and_then(|sums| fine.weighted(sums, choice, scaling, stop)) {
                Err(Error::Stopped) => {}
                fitted => return fitted.map(IdentifiedLaw::by_least_squares),
            }
        }
        coarse.weighted(sums, choice, scaling, stop).map(IdentifiedLaw::by_least_squares)
    }

    fn memory_need(_: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let intervals = options.operators() as f64;
        let cells = 0.5 * intervals * (intervals + 1.0) + intervals + 3.0;
        let (coarse, taken_by_coarse, _) = size.of_least_squares(233.0, INTERVALS_FOR_CHOICE).part();
        let fine = 3.0 * cells * cells;
        let taken_by = format!("sums over the {cells} cells of {intervals} intervals");
        MemoryNeed::largest_of(
            coarse + fine,
            [(coarse, taken_by_coarse, FEWER_ROWS), (fine, taken_by, FEWER_OPERATORS)],
        )
    }

    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        in_all_compressions(model, request.options, [0, 2, 4])
    }
}

/// Where the lines of a plane go: the cumulative share of lines along the input, at increasing places.
struct LineDensity {
    places: Vec<f64>,
    shares: Vec<f64>,
}

impl LineDensity {
    /// Bins that the output's changes are counted in.
    const BINS: usize = 400;

    fn new(series: &[Series], (low, high): (f64, f64)) -> Self {
        let mut changes = vec![0.0; Self::BINS];
        let width = (high - low) / Self::BINS as f64;
        for series in series {
            for (pair, y) in series.samples.windows(2).zip(series.output.windows(2)) {
                let change = (y[1] - y[0]).abs();
                if change.is_nan() {
                    continue;
                }
                // Evenly over the bins passed through.
                let (from, to) = (pair[0].x.min(pair[1].x), pair[0].x.max(pair[1].x));
                let bin = |x: f64| (((x - low) / width) as usize).min(Self::BINS - 1);
                let (first, last) = (bin(from), bin(to));
                let share = change / (last - first + 1) as f64;
                changes[first..=last].iter_mut().for_each(|bin| *bin += share);
            }
        }
        let sum = changes.iter().sum::<f64>().max(1e-300);
        let mut shares = vec![0.0];
        for change in &changes {
            let before = shares[shares.len() - 1];
            shares.push(before + EVEN_SHARE / Self::BINS as f64 + (1.0 - EVEN_SHARE) * change / sum);
        }
        let places = (0..=Self::BINS).map(|k| low + width * k as f64).collect();
        Self { places, shares }
    }

    /// Lines that cut the range into `intervals` of equal share.
    fn lines(&self, intervals: usize) -> Vec<f64> {
        let last = self.shares[Self::BINS];
        let at = |k: usize| {
            let share = last * k as f64 / intervals as f64;
            let bin = self.shares[1..Self::BINS].partition_point(|&s| s <= share);
            let part = (share - self.shares[bin]) / (self.shares[bin + 1] - self.shares[bin]);
            self.places[bin] + part.clamp(0.0, 1.0) * (self.places[bin + 1] - self.places[bin])
        };
        (0..=intervals).map(at).collect()
    }
}

/// Least squares on a plane: constant, input, reversible intervals, cells; the output is scaled.
pub(crate) struct PreisachProblem {
    plane: Plane,
    penalty: Penalty,
}

/// Features before those of the intervals and cells.
const FIRST: usize = 2;

impl PreisachProblem {
    /// A plane with this number of intervals, whose lines are where the output changes.
    pub fn of(series: &[Series], range: (f64, f64), intervals: usize) -> Self {
        Self::new(Plane::new(LineDensity::new(series, range).lines(intervals)))
    }

    fn new(plane: Plane) -> Self {
        let n = plane.intervals();
        let cell = |i: usize, j: usize| FIRST + n + i * (i + 1) / 2 + j;
        // A cell on the edge has half the area of the others, so its weight counts twice.
        let term = |i: usize, j: usize, c: f64| (cell(i, j), if i == j { 2.0 * c } else { c });
        let mut penalty = Penalty::ridge([0.0, 1e-6]);
        let size = square(n as f64 / INTERVALS_FOR_CHOICE as f64);
        let (ridge, bend) = (1e-4 * size, powi(size, 3));
        for i in 0..n {
            for j in 0..=i {
                penalty.add_square(&[term(i, j, 1.0)], ridge); // (7.12): ε‖w‖²
                if j >= 2 {
                    // (7.12): ‖D²w‖²
                    penalty.add_square(&[term(i, j, 1.0), term(i, j - 1, -2.0), term(i, j - 2, 1.0)], bend);
                }
                if i >= j + 2 {
                    // (7.12)
                    penalty.add_square(&[term(i, j, 1.0), term(i - 1, j, -2.0), term(i - 2, j, 1.0)], bend);
                }
            }
        }
        for j in 0..n {
            penalty.add_square(&[(FIRST + j, 1.0)], 1e-2 * size.sqrt());
            if j >= 2 {
                let terms = [(FIRST + j, 1.0), (FIRST + j - 1, -2.0), (FIRST + j - 2, 1.0)];
                penalty.add_square(&terms, powf(size, 2.5));
            }
        }
        Self { plane, penalty }
    }

    /// Number of features, the constant among them.
    pub fn features(&self) -> usize {
        FIRST + self.plane.intervals() + self.plane.cells()
    }

    fn reversible(&self) -> std::ops::Range<usize> {
        FIRST..FIRST + self.plane.intervals()
    }

    /// The features of the rows that have an output.
    pub fn rows(&self, series: &Series, scaling: &Scaling, stop: StopCheck<'_>) -> Result<Vec<Vec<f64>>> {
        let (mut rows, mut pace) = (RelayRows::new(&self.plane), Pace::new(stop));
        let mut all = Vec::new();
        for (sample, y) in series.samples.iter().zip(&series.output) {
            if pace.is_over(4 * rows.features.len()) {
                return Err(Error::Stopped);
            }
            rows.advance(sample.x, sample.x / scaling.inputs[0], !y.is_nan());
            if !y.is_nan() {
                all.push(rows.features.clone());
            }
        }
        Ok(all)
    }

    fn sums(
        &self,
        series: &[Series],
        scaling: &Scaling,
        folds: &RowFolds,
        stop: StopCheck<'_>,
    ) -> Result<FoldSums> {
        let mut gatherer = SumGatherer::new(self.features(), folds, stop);
        for (series, fold) in series.iter().zip(&folds.of_rows) {
            let targets = scaling.scaled_output(&series.output);
            let mut rows = RelayRows::new(&self.plane);
            for (row, ((sample, &fold), target)) in series.samples.iter().zip(fold).zip(targets).enumerate() {
                if gatherer.is_over(4 * rows.features.len()) {
                    break;
                }
                rows.advance(sample.x, sample.x / scaling.inputs[0], !target.is_nan());
                gatherer.add_weighted(fold, &rows.features, target, series.weight(row));
            }
        }
        gatherer.finish()
    }

    fn weighted(
        &self,
        sums: FoldSums,
        choice: PenaltyChoice,
        scaling: &Scaling,
        stop: StopCheck<'_>,
    ) -> Result<Preisach> {
        let weights = sums.weights(&self.penalty, choice, self.reversible(), stop)?;
        Preisach::new(self.in_users_units(&weights, scaling))
    }

    fn in_users_units(&self, weights: &[f64], scaling: &Scaling) -> PreisachWeights {
        let n = self.plane.intervals();
        let scaled = |weights: &[f64]| weights.iter().map(|w| w * scaling.output_deviation).collect();
        PreisachWeights {
            constant: scaling.output(weights[0]),
            slope: weights[1] * scaling.output_deviation / scaling.inputs[0],
            lines: self.plane.lines().to_vec(),
            reversible: scaled(&weights[FIRST..FIRST + n]),
            cells: scaled(&weights[FIRST + n..]),
        }
    }
}

/// Features of one row after another: mean outputs of the relays of each interval and cell.
struct RelayRows<'a> {
    plane: &'a Plane,
    stack: TurningPointStack<()>,
    /// Mean outputs of the cells at the last turning point.
    settled: Vec<f64>,
    features: Vec<f64>,
}

impl<'a> RelayRows<'a> {
    fn new(plane: &'a Plane) -> Self {
        let n = plane.intervals();
        let settled = plane.indices().map(|(i, j)| plane.virgin_mean(i, j)).collect();
        let mut features = vec![0.0; FIRST + n + plane.cells()];
        features[0] = 1.0;
        Self { plane, stack: TurningPointStack::default(), settled, features }
    }

    /// Moves to the next input; features are computed if they are `wanted`.
    fn advance(&mut self, x: f64, scaled: f64, wanted: bool) {
        let (plane, settled) = (self.plane, &mut self.settled);
        // What was added when a point was put down is taken away again when it is wiped out.
        self.stack.advance_with(x, (), |change| match change {
            StackChange::PutDown(points) => add_last(plane, points, 1.0, settled),
            StackChange::WipedOut(points, count) => {
                for kept in 0..count {
                    add_last(plane, &points[..points.len() - kept], -1.0, settled);
                }
            }
        });
        if !wanted {
            return;
        }
        let n = plane.intervals();
        self.features[1] = scaled;
        let (reversible, cells) = self.features[FIRST..].split_at_mut(n);
        plane.below(x, reversible);
        reversible.iter_mut().for_each(|share| *share = 2.0 * *share - 1.0); // (7.8): m_j
        cells.copy_from_slice(&self.settled);
        add_branch(plane, self.stack.points().last().map(|start| start.x), x, 1.0, cells);
    }
}

/// Adds `factor` times what the branch to the last of the points switched.
fn add_last(
    plane: &Plane,
    points: &[crate::law::turning_point_stack::TurningPoint<()>],
    factor: f64,
    cells: &mut [f64],
) {
    if let [before @ .., last] = points {
        add_branch(plane, before.last().map(|start| start.x), last.x, factor, cells);
    }
}

/// Adds `factor` times what a branch from `start` to `x` switches, or the virgin curve to `x`.
fn add_branch(plane: &Plane, start: Option<f64>, x: f64, factor: f64, cells: &mut [f64]) {
    match start {
        None => {
            let change = 2.0 * factor * x.signum();
            for (cell, (i, j)) in cells.iter_mut().zip(plane.indices()) {
                *cell += change * plane.virgin_share(i, j, x); // (7.11)
            }
        }
        Some(start) => {
            let n = plane.intervals();
            let (mut below_low, mut below_high) = (vec![0.0; n], vec![0.0; n]);
            plane.below(start.min(x), &mut below_low);
            plane.below(start.max(x), &mut below_high);
            // (7.9)
            plane.add_swing(&below_high, &below_low, 2.0 * factor * (x - start).signum(), cells);
        }
    }
}
