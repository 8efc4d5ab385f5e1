//! Identification of a modified Prandtl-Ishlinskii model: plays `H` and dead zones `S` together.
//!
//! ```text
//! 1.  min ‖H[x] - S'(y)‖²,   S'(y) = y + Σ_j d_j hat_j(y)         convex        theory.md (7.7)
//! 2.  min ‖S(H[x]) - y‖² + penalty       Levenberg-Marquardt from there, slopes of S positive
//! ```
//!
//! Step 1 is Kuhnen's: the inverse `S'` of `S` is a polygon too, and linear in its parameters `d_j`. `hat_j`
//! is 1 at knot `j` and 0 at all others. There is no hat at the ends of the range of `y`, which excludes the
//! trivial solution. Step 1 minimizes the error before the dead zones, step 2 that of the output.

use hysid_core::elementary::{ln, square};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::candidates::{CandidateRequest, RankedLaw, in_all_compressions};
use crate::fit::law::linearised::{FitVariable, LinearisedLaw, WeightRows, in_stretches, unit_gradient};
use crate::fit::law::search::IdentifiedLaw;
use crate::fit::law::{Identify, grids};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::progress::SearchObserver;
use crate::fit::sums::{FoldSums, SumGatherer, TrainingRows, logarithmic, lowest};
use crate::law::modified_prandtl_ishlinskii::{
    DeadZoneParts, DeadZones, ModifiedPrandtlIshlinskii, dead_zone,
};
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::series::Series;
use crate::law::thresholds::check_thresholds;
use crate::linear_algebra::Symmetric;
use crate::network::scaling::Scaling;
use crate::operator::play;
use crate::optimise::levenberg_marquardt::{self, DescentSettings, LevenbergMarquardt, Slope};
use crate::optimise::non_negative::{Penalty, Quadratic, WeightBounds};
use crate::optimise::parallel;
use crate::options::classical::ClassicalModel;
use crate::options::classical::{ClassicalOptions, Sign};
use crate::stop_check::{Pace, StopCheck};
use crate::validation::RowFolds;

const MOST_DEAD_ZONES: usize = 100;

/// Smallest slope of the dead zones, where that of a straight line through the data is about 1.
const LEAST_SLOPE: f64 = 1e-3;

const ITERATIONS: usize = 40;

/// Iterations of a refinement for validation only.
const ITERATIONS_IN_VALIDATION: usize = 10;

impl Identify for ModifiedPrandtlIshlinskii {
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        _: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        // A stop leaves out priors that were not compared yet, and further refinement.
        let rows = TrainingRows::of(data)?;
        let scaling = &rows.scaling;
        let dead_zones = options.dead_zones();
        grids::check_count("dead_zones", dead_zones, MOST_DEAD_ZONES)?;
        options.thresholds.as_deref().map_or(Ok(()), check_thresholds)?;
        let given: Option<Vec<f64>> =
            options.thresholds.as_ref().map(|given| given.iter().map(|r| r / scaling.inputs[0]).collect());
        let grids = grids::candidates(given.as_deref(), options.operators(), 1.0)?;
        let problem = |grid: &[f64]| PlayRows::new(&rows, grid, dead_zones, stop);
        let problems = grids::fits_on_grids(&grids, problem)?;
        let signs = options.sign.map_or(Sign::ALL.to_vec(), |sign| vec![sign]);
        let mut candidates = Vec::new();
        for sign in signs {
            // The convex problem tells which grid is best, outputs tell the rest.
            let score = |problem: &PlayRows| match problem.convex_score(sign, stop) {
                Err(Error::Stopped) => Ok(f64::INFINITY),
                score => score,
            };
            let scores: Vec<f64> = problems.iter().map(score).collect::<Result<_>>()?;
            let grid = lowest(&scores);
            for ridge in logarithmic(1e-7, 1e-1, RIDGES) {
                candidates.push((grid, Prior { sign, ridge }));
            }
        }
        let score = |&(grid, prior): &(usize, Prior)| match problems[grid].score(prior, stop) {
            Err(Error::Stopped) => Ok(f64::INFINITY),
            score => score,
        };
        let scores: Vec<f64> = parallel::each(&candidates, score).into_iter().collect::<Result<_>>()?;
        let (grid, prior) = candidates[lowest(&scores)];
        let problem = &problems[grid];
        let start = problem.convex_start(prior, stop)?;
        let refined = problem.refine(start, ITERATIONS, stop);
        refined.in_users_units(&grids[grid], scaling).map(IdentifiedLaw::by_least_squares)
    }

    fn linearised(&self, data: &Dataset, _: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let (series, rows_each) = in_stretches(Series::all(data, None)?);
        let point = ScaledParameters::of_law(self);
        let (plays, slopes) = (point.hysteresis.len() - 2, point.slopes.len());
        let count = 2 + plays + 1 + slopes;
        let mut rows = WeightRows::new(count);
        let (mut drive, mut jacobian) = (vec![1.0; 2 + plays], vec![0.0; count]);
        let mut residual = Vec::new();
        for series in &series {
            rows.begin();
            drive[2..].fill(0.0);
            for (sample, &y) in series.samples.iter().zip(&series.output) {
                drive[1] = sample.x;
                let thresholds = self.hysteresis().thresholds();
                drive[2..]
                    .iter_mut()
                    .zip(thresholds)
                    .for_each(|(play, &r)| *play = play::follow(*play, sample.x, r));
                if !y.is_nan() {
                    residual.push(point.linearise(&drive, &mut jacobian) - y);
                    rows.add(&jacobian, y);
                }
            }
        }
        let at_bound = |i: usize| match i {
            0 | 1 => false,
            i if i < 2 + plays => point.hysteresis[i] == 0.0,
            i if i == 2 + plays => false,
            i => point.slopes[i - 3 - plays] <= LEAST_SLOPE * (1.0 + 1e-9),
        };
        let columns = rows.columns.into_iter().enumerate();
        let variables = columns.map(|(i, column)| FitVariable::weight(column, at_bound(i))).collect();
        let gradients = point.gradients();
        Ok(Some(LinearisedLaw { records: rows.records, residual, variables, gradients, rows_each }))
    }

    fn memory_need(_: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let plays = options.plays();
        let zones = 2 * options.dead_zones();
        let sums = size.of_least_squares((plays + zones + 3) as f64, plays).part();
        // Plays of every row are stored for each grid, and copied for each fold that is under way.
        let plays_of_rows = (3.0 + 2.0 * size.threads) * size.scored * (plays + 6) as f64;
        let taken_by = format!("{plays} plays at each of {} rows", size.scored);
        let advice = "choose fewer operators, or fit to fewer rows";
        MemoryNeed::largest_of(sums.0 + plays_of_rows, [sums, (plays_of_rows, taken_by, advice)])
    }

    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        in_all_compressions(model, request.options, [1, 3, 5])
    }
}

const RIDGES: usize = 7;

/// Prior of the plays.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Prior {
    sign: Sign,
    /// Factor of the ridge penalty on the weights of the plays.
    ridge: f64,
}

/// Rows in scaled units, with the plays of each.
struct PlayRows {
    /// Constant, input and plays, row after row, record after record.
    drives: Vec<Vec<f64>>,
    targets: Vec<f64>,
    fold_of: Vec<usize>,
    folds: RowFolds,
    dead_zones: usize,
}

/// Parameters in scaled units.
#[derive(Debug, Clone)]
struct ScaledParameters {
    /// Constant, input, plays.
    hysteresis: Vec<f64>,
    thresholds: Vec<f64>,
    /// Value at 0.
    constant: f64,
    slopes: Vec<f64>,
    prior: Prior,
}

impl PlayRows {
    fn new(rows: &TrainingRows, grid: &[f64], dead_zones: usize, stop: StopCheck<'_>) -> Result<Self> {
        let mut pace = Pace::new(stop);
        let TrainingRows { series, folds, scaling } = rows;
        let (mut drives, mut targets, mut fold_of) = (Vec::new(), Vec::new(), Vec::new());
        for (series, of_rows) in series.iter().zip(&folds.of_rows) {
            let mut plays = vec![0.0; grid.len()];
            let outputs = scaling.scaled_output(&series.output);
            for ((sample, &fold), target) in series.samples.iter().zip(of_rows).zip(outputs) {
                if pace.is_over(10 * grid.len()) {
                    return Err(Error::Stopped);
                }
                let x = sample.x / scaling.inputs[0];
                plays.iter_mut().zip(grid).for_each(|(play, &r)| *play = play::follow(*play, x, r));
                if !target.is_nan() {
                    drives.push([&[1.0, x], plays.as_slice()].concat());
                    targets.push(target);
                    fold_of.push(fold);
                }
            }
        }
        Ok(Self { drives, targets, fold_of, folds: folds.clone(), dead_zones })
    }

    /// Thresholds of the dead zones on both sides of 0, evenly spaced up to the ends of a range and in order.
    fn spread(&self, low: f64, high: f64) -> Vec<f64> {
        let count = self.dead_zones;
        let side = |end: f64| (1..=count).map(move |j| end * j as f64 / (count + 1) as f64);
        let mut all: Vec<f64> = side(low).chain(side(high)).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Ridge on the plays among `count` parameters.
    fn penalty(&self, count: usize, curve: std::ops::Range<usize>) -> Penalty {
        let plays = 2..self.drives[0].len();
        let of = |i: usize| {
            if plays.contains(&i) {
                1.0
            } else if curve.contains(&i) {
                0.1
            } else {
                0.0
            }
        };
        Penalty::ridge((0..count).map(of))
    }

    fn part(&self, chosen: impl Fn(usize) -> bool) -> Self {
        let rows: Vec<usize> = (0..self.targets.len()).filter(|&row| chosen(self.fold_of[row])).collect();
        Self {
            drives: rows.iter().map(|&row| self.drives[row].clone()).collect(),
            targets: rows.iter().map(|&row| self.targets[row]).collect(),
            fold_of: rows.iter().map(|&row| self.fold_of[row]).collect(),
            folds: self.folds.clone(),
            dead_zones: self.dead_zones,
        }
    }

    /// Mean over the folds of the logarithm of the mean square held-out error.
    fn score(&self, prior: Prior, stop: StopCheck<'_>) -> Result<f64> {
        let judge = |&fold: &usize| {
            if stop.is_asked() {
                return Err(Error::Stopped);
            }
            let (rest, held_out) = (self.part(|other| other != fold), self.part(|other| other == fold));
            if rest.targets.is_empty() || held_out.targets.is_empty() {
                return Ok(0.0);
            }
            let mut point = rest.refine(rest.convex_start(prior, stop)?, ITERATIONS_IN_VALIDATION, stop);
            point.prior.ridge = 0.0;
            Ok(ln(held_out.objective(&point).max(1e-30)))
        };
        let sum: f64 = self.folds.judged.iter().map(judge).sum::<Result<f64>>()?;
        Ok(sum / self.folds.judged.len() as f64)
    }

    fn convex_score(&self, sign: Sign, stop: StopCheck<'_>) -> Result<f64> {
        let (sums, penalty, _) = self.convex_problem(stop)?;
        let plays = 2..self.drives[0].len();
        let bounds = WeightBounds::apart(sign, plays, 0..0, sums.total().features());
        let factors = logarithmic(1e-8, 1e-1, 8);
        let path = |rest: &Quadratic| rest.path(&penalty, &factors, &bounds, stop);
        let scores = sums.scores(path, stop).ok_or(Error::Stopped)?;
        Ok(scores[lowest(&scores)])
    }

    fn convex_problem(&self, stop: StopCheck<'_>) -> Result<(FoldSums, Penalty, Vec<f64>)> {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let (low, high) = range(&mut self.targets.iter().copied());
        // The mean of the scaled output is 0, so that 0 lies within.
        let mut inner = self.spread(low, high);
        inner.retain(|r| *r != 0.0);
        inner.dedup();
        let knots = [&[low], inner.as_slice(), &[high]].concat();
        let first = self.drives[0].len();
        let mut gatherer = SumGatherer::new(first + inner.len(), &self.folds, stop);
        let mut features = vec![0.0; first + inner.len()];
        for ((drive, &y), &fold) in self.drives.iter().zip(&self.targets).zip(&self.fold_of) {
            if gatherer.is_over(4 * features.len()) {
                break;
            }
            features[..first].copy_from_slice(drive);
            for (j, feature) in features[first..].iter_mut().enumerate() {
                *feature = -hat(y, &knots[j..j + 3]); // (7.7)
            }
            gatherer.add(fold, &features, y);
        }
        let sums = gatherer.finish()?;
        let penalty = self.penalty(features.len(), first..features.len());
        Ok((sums, penalty, knots))
    }

    /// Step 1.
    fn convex_start(&self, prior: Prior, stop: StopCheck<'_>) -> Result<ScaledParameters> {
        let (sums, penalty, knots) = self.convex_problem(stop)?;
        let first = self.drives[0].len();
        let mut penalised = sums.total().quadratic();
        penalised.penalise(&penalty, prior.ridge);
        let bounds = WeightBounds::apart(prior.sign, 2..first, 0..0, first + knots.len() - 2);
        let weights = penalised.last_minimum(&bounds, stop)?;

        // The inverse polygon: S takes its values z to the knots.
        let mut z = vec![knots[0]];
        for k in 1..knots.len() {
            let hat = |k: usize| if k == 0 || k == knots.len() - 1 { 0.0 } else { weights[first + k - 1] };
            let rise = (knots[k] - knots[k - 1]) + hat(k) - hat(k - 1); // (7.7): S'
            z.push(z[k - 1] + rise.max(0.05 * (knots[k] - knots[k - 1])));
        }
        let value = |at: f64| {
            let k = z[1..z.len() - 1].partition_point(|&z| z <= at);
            knots[k] + (at - z[k]) * (knots[k + 1] - knots[k]) / (z[k + 1] - z[k])
        };
        // Evenly spaced thresholds in place of the images of the knots.
        let (low, high) = (z[0].min(-1e-3), z[z.len() - 1].max(1e-3));
        let thresholds = self.spread(low, high);
        let mut bends = [&[low], thresholds.as_slice(), &[high]].concat();
        // The piece around 0 lies between the innermost thresholds.
        bends.dedup();
        let slopes = bends
            .windows(2)
            .map(|pair| ((value(pair[1]) - value(pair[0])) / (pair[1] - pair[0])).max(LEAST_SLOPE))
            .collect();
        Ok(ScaledParameters {
            hysteresis: weights[..first].to_vec(),
            constant: value(0.0),
            slopes,
            thresholds,
            prior,
        })
    }

    /// Step 2, or as much of it as there is time for.
    fn refine(&self, start: ScaledParameters, iterations: usize, stop: StopCheck<'_>) -> ScaledParameters {
        let refinement = Refinement::new(self, &start, stop);
        let mut search = LevenbergMarquardt::new(&refinement, start.values());
        for _ in 0..iterations {
            if stop.is_asked() || search.advance(&refinement).is_some() {
                break;
            }
        }
        start.at(search.parameters())
    }

    /// Half the mean square error and half the penalty.
    fn objective(&self, point: &ScaledParameters) -> f64 {
        let zones = point.dead_zones();
        let rows = self.drives.iter().zip(&self.targets);
        // (7.6)
        let squares = rows.map(|(drive, y)| square(zones.value(point.before(drive)) - y)).sum::<f64>();
        let penalty: f64 = point.hysteresis[2..].iter().map(|w| w * w).sum();
        0.5 * (squares / self.targets.len() as f64 + point.prior.ridge * penalty)
    }
}

/// Step 2 as a function of the values of a point, from which its thresholds and prior are.
struct Refinement<'a> {
    problem: &'a PlayRows,
    point: &'a ScaledParameters,
    penalty: Penalty,
    bounds: WeightBounds,
    stop: StopCheck<'a>,
}

impl<'a> Refinement<'a> {
    fn new(problem: &'a PlayRows, point: &'a ScaledParameters, stop: StopCheck<'a>) -> Self {
        let first = problem.drives[0].len();
        let count = first + 1 + point.slopes.len();
        Self {
            problem,
            point,
            penalty: problem.penalty(count, count..count),
            bounds: WeightBounds::apart(point.prior.sign, 2..first, first + 1..count, count),
            stop,
        }
    }
}

impl levenberg_marquardt::LeastSquaresProblem for Refinement<'_> {
    type Value = f64;
    type Curvature = Symmetric;
    const RULES: DescentSettings =
        DescentSettings { damping: (1e-9, 1e6), stall: 1e-6, ..DescentSettings::KINKED };

    fn value(&self, values: &[f64]) -> f64 {
        self.problem.objective(&self.point.at(values))
    }

    fn objective(value: &f64) -> f64 {
        *value
    }

    fn slope(&self, values: &[f64], _: &f64) -> Option<Slope<Symmetric>> {
        let PlayRows { drives, targets, .. } = self.problem;
        let point = self.point.at(values);
        let count = values.len();
        let mut gatherer = SumGatherer::new(count, &RowFolds::one(), self.stop);
        let mut jacobian = vec![0.0; count];
        for (drive, &y) in drives.iter().zip(targets) {
            if gatherer.is_over(4 * count) {
                return None;
            }
            let residual = y - point.linearise(drive, &mut jacobian);
            gatherer.add(0, &jacobian, residual);
        }
        let mut sums = gatherer.finish().ok()?.into_total().quadratic();
        sums.penalise(&self.penalty, point.prior.ridge);
        let mut gradient: Vec<f64> = sums.right.iter().map(|right| -right).collect();
        for (slope, weight) in gradient.iter_mut().zip(&point.hysteresis).skip(2) {
            *slope += point.prior.ridge * weight;
        }
        let diagonal = (0..count).map(|i| sums.matrix.diagonal(i)).collect();
        Some(Slope { gradient, diagonal, curvature: sums.matrix, evaluations: 1 })
    }

    fn step(&self, slope: &Slope<Symmetric>, values: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let mut matrix = slope.curvature.clone();
        damping.iter().enumerate().for_each(|(i, &damping)| matrix.add_to_diagonal(i, damping));
        // The unknowns are where the step leads, so that bounds hold for them.
        let shift = matrix.times(values);
        let right = shift.iter().zip(&slope.gradient).map(|(shift, g)| shift - g).collect();
        let there = Quadratic { matrix, right }.minimum_within(&self.bounds, values, self.stop)?;
        Some(there.iter().zip(values).map(|(there, here)| there - here).collect())
    }

    fn limit(&self, values: &mut [f64]) {
        self.bounds.limit(values);
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

/// A hat over three knots: 1 at the middle one.
fn hat(y: f64, knots: &[f64]) -> f64 {
    let (left, middle, right) = (knots[0], knots[1], knots[2]);
    let share = if y < middle { (y - left) / (middle - left) } else { (right - y) / (right - middle) };
    share.max(0.0)
}

impl ScaledParameters {
    fn negative(&self) -> usize {
        self.thresholds.partition_point(|&r| r < 0.0)
    }

    fn of_law(law: &ModifiedPrandtlIshlinskii) -> Self {
        let (plays, zones) = (law.hysteresis(), law.superposition());
        Self {
            hysteresis: [&[plays.constant(), plays.linear()], plays.weights()].concat(),
            thresholds: zones.parts().thresholds.clone(),
            constant: zones.parts().constant,
            slopes: zones.slopes(),
            prior: Prior { sign: Sign::Any, ridge: 0.0 },
        }
    }

    /// The derivatives of each parameter of the law by plays, constant and slopes; empty for a threshold.
    fn gradients(&self) -> Vec<Vec<f64>> {
        let first = self.hysteresis.len();
        let count = first + 1 + self.slopes.len();
        let of = |at: usize| unit_gradient(count, at);
        let slope = |piece: usize| first + 1 + piece;
        let mut all = vec![of(0), of(1)];
        all.extend((2..first).flat_map(|play| [Vec::new(), of(play)]));
        let negative = self.negative();
        all.extend([of(first), of(slope(negative))]);
        for j in 0..self.thresholds.len() {
            // A weight is the change of the slope away from 0.
            let (from, to) = if j < negative { (j + 1, j) } else { (j, j + 1) };
            let mut weight = of(slope(to));
            weight[slope(from)] = -1.0;
            all.extend([Vec::new(), weight]);
        }
        all
    }

    fn before(&self, drive: &[f64]) -> f64 {
        self.hysteresis.iter().zip(drive).map(|(w, d)| w * d).sum()
    }

    fn dead_zones(&self) -> DeadZones {
        let negative = self.negative();
        let weights = (0..self.thresholds.len()).map(|j| {
            if j < negative {
                self.slopes[j] - self.slopes[j + 1]
            } else {
                self.slopes[j + 1] - self.slopes[j]
            }
        });
        DeadZones::unchecked(DeadZoneParts {
            constant: self.constant,
            linear: self.slopes[negative],
            weights: weights.collect(),
            thresholds: self.thresholds.clone(),
        })
    }

    /// Output of a row, and its derivatives by plays, constant and slopes.
    fn linearise(&self, drive: &[f64], jacobian: &mut [f64]) -> f64 {
        let z = self.before(drive);
        let first = self.hysteresis.len();
        let piece = self.thresholds.partition_point(|&r| r < z);
        for (j, d) in jacobian.iter_mut().zip(drive) {
            *j = self.slopes[piece] * d;
        }
        jacobian[first] = 1.0;
        let (negative, last) = (self.negative(), self.slopes.len() - 1);
        let mut y = self.constant;
        for (k, slope) in self.slopes.iter().enumerate() {
            // The length of the piece that z has passed, counted from 0.
            let low = if k == 0 { f64::NEG_INFINITY } else { self.thresholds[k - 1] };
            let high = if k == last { f64::INFINITY } else { self.thresholds[k] };
            let passed = if k == negative {
                z.clamp(low, high)
            } else if k > negative {
                dead_zone(z.min(high), low)
            } else {
                dead_zone(z.max(low), high)
            };
            jacobian[first + 1 + k] = passed;
            y += slope * passed; // (7.6)
        }
        y
    }

    /// All parameters; slopes as what they are above the least.
    fn values(&self) -> Vec<f64> {
        let slopes = self.slopes.iter().map(|slope| slope - LEAST_SLOPE);
        self.hysteresis.iter().copied().chain([self.constant]).chain(slopes).collect()
    }

    fn at(&self, values: &[f64]) -> Self {
        let first = self.hysteresis.len();
        Self {
            hysteresis: values[..first].to_vec(),
            constant: values[first],
            slopes: values[first + 1..].iter().map(|above| above.max(0.0) + LEAST_SLOPE).collect(),
            ..self.clone()
        }
    }

    fn in_users_units(&self, grid: &[f64], scaling: &Scaling) -> Result<ModifiedPrandtlIshlinskii> {
        let (x, y) = (scaling.inputs[0], scaling.output_deviation);
        let hysteresis = PrandtlIshlinskii::new(
            self.hysteresis[0] * y,
            self.hysteresis[1] * y / x,
            grid.iter().map(|r| r * x).collect(),
            self.hysteresis[2..].iter().map(|w| w * y / x).collect(),
        )?;
        let mut parts = self.dead_zones().parts().clone();
        parts.constant = scaling.output(parts.constant);
        parts.thresholds.iter_mut().for_each(|r| *r *= y);
        Ok(ModifiedPrandtlIshlinskii::new(hysteresis, DeadZones::new(parts)?))
    }
}
