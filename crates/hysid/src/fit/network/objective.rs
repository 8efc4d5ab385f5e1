//! The objective of all trainers: value, gradient, Gauss-Newton matrix.
//!
//! ```text
//! F(θ) = min_c [ ½ ‖Φ(θ) c - y‖²/N + ½ λ ‖c‖² ] + ½ κ ‖θ‖²_w               theory.md (3.1)
//! g    = Jᵀr/N + κ θ_w,    r = Φc - y,    J = (∂Φ/∂θ) c                     theory.md (3.3)
//! B    = JᵀJ/N - JᵀΦ (ΦᵀΦ + λN I)⁻¹ ΦᵀJ/N                                   theory.md (3.4)
//! ```
//!
//! `θ` are the parameters found by search and `θ_w` the weights among them; `c` are the output weights, found
//! by least squares for each `θ` (variable projection), with the constant exempt from `λ`. `Φ` has one row
//! for each of the `N` scored samples and one column for each output weight; `y` is the scaled measured
//! output.

use crate::data::polyline::{PolylineColumn, noise, polyline};
use crate::data::record::{Dataset, Thinning};
use crate::error::Result;
use crate::fit::network::curvature::{self, Curvature, has_few_rows};
use crate::fit::sums::output_weights::{OutputProblem, OutputSolution};
use crate::network::scaling::Scaling;
use crate::network::{
    Architecture, GradientOverRecords, GramOverRecords, JacobianColumns, NetworkDrive, ParameterLayout,
    RowsOverRecords,
};
use crate::optimise::levenberg_marquardt::{DescentSettings, LeastSquaresProblem, Slope};
use crate::options::network::{FitOptions, Regularisation};
use crate::stop_check::StopCheck;

/// The objective on given data.
#[derive(Debug, Clone)]
pub struct Objective<'a> {
    architecture: Architecture,
    layout: ParameterLayout,
    regularisation: Regularisation,
    drives: Vec<NetworkDrive>,
    targets: Vec<Vec<f64>>,
    /// Mean time step and duration of the longest record as measured.
    time_scales: Option<(f64, f64)>,
    rows: usize,
    stop: StopCheck<'a>,
    /// Evaluations take long enough to be broken off.
    is_long: bool,
}

/// The objective at a point, with the output weights there.
#[derive(Debug, Clone)]
pub struct ObjectiveValue {
    /// The objective `F`, in scaled units.
    pub objective: f64,
    /// Mean square residual in scaled units.
    pub mean_square: f64,
    solution: OutputSolution,
}

impl ObjectiveValue {
    /// Output weights at the point.
    pub fn output_weights(&self) -> &[f64] {
        &self.solution.weights
    }
}

/// Operations of an evaluation with slope, about ten milliseconds, from which on it is worth breaking off.
const LONG: usize = 20_000_000;

/// Tolerance of the polyline of an input, in standard deviations of its noise.
const NOISE_OFF_PATH: f64 = 4.0;
/// Limits of that tolerance, as shares of the largest magnitude of the input. The rate, mostly noise, has no upper
/// limit.
const LEAST_OFF_PATH: f64 = 1e-3;
const MOST_OFF_PATH: f64 = 1e-2;

impl<'a> Objective<'a> {
    /// Scales the data for the architecture.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn new(
        data: &Dataset,
        scaling: &Scaling,
        architecture: Architecture,
        options: &FitOptions,
    ) -> Result<Self> {
        let used = || data.records().iter().filter(|record| record.scored() > 0);
        let drives = used().map(|record| scaling.drive(record, &architecture, options.rate));
        let drives: Vec<NetworkDrive> = drives.collect::<Result<_>>()?;
        let targets: Vec<Vec<f64>> = used().map(|record| scaling.target(record)).collect();
        Ok(Self {
            architecture,
            layout: ParameterLayout::new(architecture),
            regularisation: options.penalties(),
            time_scales: time_scales(&drives),
            drives,
            targets,
            rows: data.scored(),
            stop: StopCheck::never(),
            is_long: false,
        })
    }

    /// The same objective, whose long evaluations check `stop`; a value is then infinite, and a gradient invalid.
    pub(crate) fn until(self, stop: StopCheck<'a>) -> Self {
        let columns = self.layout.len() + self.architecture.output_weights();
        // Rows without a target are run through, but not gathered.
        let run: usize = self.drives.iter().map(NetworkDrive::len).sum();
        let is_long =
            columns.saturating_mul(columns.saturating_mul(self.rows).saturating_add(10 * run)) > LONG;
        if is_long { Self { stop, is_long, ..self } } else { self }
    }

    pub(crate) fn is_long(&self) -> bool {
        self.is_long
    }

    /// Number of scored rows.
    pub fn scored(&self) -> usize {
        self.rows
    }

    /// The same objective on at most `most` scored rows. If the records have more than `most` rows, scored or not, the
    /// rows that are not scored are left out on straight parts of the input path; elsewhere they advance the memory.
    pub fn thinned(mut self, most: usize) -> Self {
        self.rows = Thinning::new(self.rows, most).blank(self.targets.iter_mut().flatten());
        if self.drives.iter().map(NetworkDrive::len).sum::<usize>() > most {
            for (drive, target) in self.drives.iter_mut().zip(&mut self.targets) {
                let rows = rows_of_path(drive, self.architecture.rate, target);
                *target = rows.iter().map(|&row| target[row]).collect();
                *drive = drive.through(&rows);
            }
        }
        self
    }

    /// The architecture.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }

    /// Names and bounds of the parameters.
    pub fn layout(&self) -> &ParameterLayout {
        &self.layout
    }

    /// Mean time step and duration of the longest record as measured, in the unit of time; `None` without time stamps.
    pub(crate) fn time_scales(&self) -> Option<(f64, f64)> {
        self.time_scales
    }

    pub(crate) fn half_range_of_input(&self) -> f64 {
        let inputs = self.drives.iter().flat_map(|drive| &drive.channels[0]);
        let (low, high) =
            inputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        0.5 * (high - low)
    }

    /// The value at a point.
    pub fn value(&self, parameters: &[f64]) -> ObjectiveValue {
        if self.stop.is_asked() {
            let solution = OutputSolution::broken_off(self.architecture.output_weights());
            return ObjectiveValue { objective: f64::INFINITY, mean_square: f64::INFINITY, solution };
        }
        let gram = self.gram(parameters, None);
        let solution = self.output_problem(&gram).solve();
        let decay: f64 = self.weights(parameters).map(|(_, w)| w * w).sum();
        ObjectiveValue {
            objective: solution.objective + 0.5 * self.regularisation.decay * decay,
            mean_square: solution.mean_square,
            solution,
        }
    }

    /// Gradient `g` of `F`, at a point with its value.
    pub fn gradient(&self, parameters: &[f64], value: &ObjectiveValue) -> Vec<f64> {
        let sums = GradientOverRecords {
            architecture: &self.architecture,
            parameters,
            output: &value.solution.weights,
            drives: &self.drives,
            targets: &self.targets,
            stop: self.stop,
        };
        let mut gradient = sums.sum();
        gradient.iter_mut().for_each(|g| *g /= self.rows as f64);
        for (index, weight) in self.weights(parameters) {
            gradient[index] += self.regularisation.decay * weight;
        }
        gradient
    }

    fn slope_by_matrix(&self, parameters: &[f64], value: &ObjectiveValue) -> Option<Slope<Curvature>> {
        let gram = self.gram(parameters, Some(&value.solution.weights));
        let (mut gradient, mut matrix) =
            self.output_problem(&gram).linearise(&value.solution, parameters.len());
        for (index, weight) in self.weights(parameters) {
            gradient[index] += self.regularisation.decay * weight;
            matrix.add_to_diagonal(index, self.regularisation.decay);
        }
        (!self.stop.is_asked()).then(|| slope(gradient, Curvature::Matrix(matrix)))
    }

    fn slope_of_few_rows(&self, parameters: &[f64], value: &ObjectiveValue) -> Option<Slope<Curvature>> {
        let output = Some(value.solution.weights.as_slice());
        let columns = JacobianColumns { architecture: &self.architecture, parameters, output };
        let (drives, targets, stop) = (&self.drives, &self.targets, self.stop);
        let columns = RowsOverRecords { columns, first: 0, drives, targets, stop }.columns();
        let mut decay = vec![0.0; parameters.len()];
        self.weights(parameters).for_each(|(index, _)| decay[index] = self.regularisation.decay);
        if stop.is_asked() {
            return None;
        }
        let rows = curvature::CurvatureRows::new(columns, &value.solution, decay, parameters, stop)?;
        Some(slope(rows.gradient(), Curvature::Rows(rows)))
    }

    fn gram(&self, parameters: &[f64], output: Option<&[f64]>) -> crate::linear_algebra::Gram {
        let columns = JacobianColumns { architecture: &self.architecture, parameters, output };
        let (drives, targets, stop) = (&self.drives, &self.targets, self.stop);
        GramOverRecords { columns, drives, targets, stop }.gram()
    }

    fn output_problem<'g>(&'g self, gram: &'g crate::linear_algebra::Gram) -> OutputProblem<'g> {
        OutputProblem {
            gram,
            features: self.architecture.output_weights(),
            rows: self.rows as f64,
            ridge: self.regularisation.ridge,
            constant: self.architecture.constant,
            stop: self.stop,
        }
    }

    fn weights<'p>(&self, parameters: &'p [f64]) -> impl Iterator<Item = (usize, &'p f64)> {
        parameters.iter().enumerate().filter(|(index, _)| self.layout.is_weight(*index))
    }
}

/// Indices of the kept rows of a long record: rows with a target, and those of a polyline that follows the inputs.
fn rows_of_path(drive: &NetworkDrive, rate: bool, target: &[f64]) -> Vec<usize> {
    let is_rate = |channel: usize| rate && channel == 1;
    let tolerance = |channel: usize, values: &[f64]| {
        let most = if is_rate(channel) { f64::INFINITY } else { MOST_OFF_PATH };
        (NOISE_OFF_PATH * noise(values)).clamp(LEAST_OFF_PATH, most)
    };
    let columns = drive.channels.iter().enumerate().map(|(channel, values)| PolylineColumn {
        values,
        tolerance: tolerance(channel, values),
        longest: f64::INFINITY,
    });
    let columns: Vec<PolylineColumn> = columns.collect();
    let step = |row: usize| drive.steps.get(row).copied().unwrap_or(1.0);
    polyline(&columns, step, |row| !target[row].is_nan())
}

fn time_scales(drives: &[NetworkDrive]) -> Option<(f64, f64)> {
    // The rows of a lead-in take an infinite time.
    fn measured(drive: &NetworkDrive) -> impl Iterator<Item = &f64> {
        drive.steps.iter().filter(|step| step.is_finite())
    }
    let durations = drives.iter().map(|drive| measured(drive).sum::<f64>());
    let longest = durations.clone().fold(0.0, f64::max);
    let steps: usize = drives.iter().map(|drive| measured(drive).count().saturating_sub(1)).sum();
    let step = durations.sum::<f64>() / steps.max(1) as f64;
    (longest > 0.0).then_some((step, longest))
}

/// Gradient `g` of `F` and Gauss-Newton matrix `B` with decay, `B + κI` (theory.md (3.3), (3.4)).
fn slope(gradient: Vec<f64>, curvature: Curvature) -> Slope<Curvature> {
    let diagonal = (0..gradient.len()).map(|index| curvature.diagonal(index)).collect();
    Slope { gradient, diagonal, curvature, evaluations: 1 }
}

impl LeastSquaresProblem for Objective<'_> {
    type Value = ObjectiveValue;
    type Curvature = Curvature;
    const RULES: DescentSettings = DescentSettings::SMOOTH;

    fn value(&self, parameters: &[f64]) -> ObjectiveValue {
        self.value(parameters)
    }

    fn objective(value: &ObjectiveValue) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], value: &ObjectiveValue) -> Option<Slope<Curvature>> {
        match has_few_rows(parameters.len(), self.architecture.output_weights(), self.rows) {
            true => self.slope_of_few_rows(parameters, value),
            false => self.slope_by_matrix(parameters, value),
        }
    }

    fn step(&self, slope: &Slope<Curvature>, _: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        slope.curvature.step(&slope.gradient, damping, self.stop)
    }

    fn limit(&self, parameters: &mut [f64]) {
        self.layout.clamp(parameters);
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;
    use crate::data::record::{ColumnNames, Record};
    use crate::network::{Family, Sizes};

    /// The rows of the curvature give the step that the matrix gives, to rounding.
    #[test]
    fn few_rows_give_the_same_step_as_the_matrix() {
        let rows = 40;
        let x: Vec<f64> = (0..rows).map(|k| sin(0.3 * k as f64) * (1.0 + 0.02 * k as f64)).collect();
        let y = (0..rows).map(|k| sin(0.3 * k as f64 - 0.6) + 0.1 * x[k]).collect();
        let record = Record::new("r", vec![x], y).unwrap();
        let data = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
        let sizes = Sizes { stops: 20, hidden: 20, relaxation: 0 };
        let options = FitOptions { model: Family::XpnnPlus, sizes, ..FitOptions::default() };
        let scaling = Scaling::of(&data, None).unwrap();
        let architecture = options.architecture(&data).unwrap();
        let objective = Objective::new(&data, &scaling, architecture, &options).unwrap();
        let p = objective.layout().len();
        assert!(!has_few_rows(p, architecture.output_weights(), rows), "compare with the matrix");
        let point = crate::fit::random_start::random(objective.architecture(), objective.time_scales(), 1, 0);
        let value = objective.value(&point);
        let by_matrix = LeastSquaresProblem::slope(&objective, &point, &value).unwrap();
        let by_rows = objective.slope_of_few_rows(&point, &value).unwrap();
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let assert_near = |a: &[f64], b: &[f64], tolerance: f64| {
            let size = largest(a);
            assert!(size > 0.0);
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < tolerance * size, "{a} and {b} of {size}");
            }
        };
        assert_near(&by_matrix.gradient, &by_rows.gradient, 1e-9);
        let diagonal =
            |slope: &Slope<Curvature>| (0..p).map(|i| slope.curvature.diagonal(i)).collect::<Vec<f64>>();
        assert_near(&diagonal(&by_matrix), &diagonal(&by_rows), 1e-9);
        let scale = largest(&diagonal(&by_matrix));
        for damping in [1e-1, 1e-3] {
            let damping = vec![damping * scale; p];
            let step = |slope: &Slope<Curvature>| {
                slope.curvature.step(&slope.gradient, &damping, StopCheck::never()).unwrap()
            };
            assert_near(&step(&by_matrix), &step(&by_rows), 1e-6);
        }
    }

    /// Of a long record, thinned data have nearly the errors of all rows, with and without noise of the input.
    #[test]
    fn thinned_data_have_nearly_the_errors_of_all_rows() {
        let rows = 60_000;
        for noise in [0.0, 2e-4] {
            let x = |k: usize| {
                let of_noise = noise * (hysid_core::random::uniform(k as u64) - 0.5);
                sin(2e-3 * k as f64) * (1.0 + 0.5 * sin(1e-4 * k as f64)) + of_noise
            };
            let x: Vec<f64> = (0..rows).map(x).collect();
            let y = (0..rows).map(|k| sin(2e-3 * k as f64 - 0.6) + 0.1 * x[k]).collect();
            let time = (0..rows).map(|k| 0.1 * k as f64).collect();
            let record = Record::new("r", vec![x], y).unwrap().with_time(time).unwrap();
            let data = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
            let rate = Some(crate::data::rate::RateMethod::Central);
            let options = FitOptions { model: Family::XpnnPlus, rate, ..FitOptions::default() };
            let scaling = Scaling::of(&data, rate).unwrap();
            let architecture = options.architecture(&data).unwrap();
            let whole = Objective::new(&data, &scaling, architecture, &options).unwrap();
            let thinned = whole.clone().thinned(4000);
            assert_eq!(thinned.scored(), 4000);
            let run: usize = thinned.drives.iter().map(NetworkDrive::len).sum();
            assert!(run < if noise == 0.0 { 12_000 } else { 30_000 }, "{run} rows");
            assert_eq!(thinned.time_scales(), whole.time_scales());
            let point = crate::fit::random_start::random(whole.architecture(), whole.time_scales(), 1, 0);
            let error = |objective: &Objective| objective.value(&point).mean_square;
            let ratio = error(&thinned) / error(&whole);
            assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        }
    }

    #[test]
    fn the_gradient_is_the_same_with_and_without_the_jacobian() {
        for family in Family::ALL {
            for rows in [64, 200, 331] {
                let x: Vec<f64> = (0..rows).map(|k| sin(0.17 * k as f64) * (1.0 + 0.01 * k as f64)).collect();
                let mut y: Vec<f64> = (0..rows).map(|k| sin(0.17 * k as f64 - 0.6) + 0.1 * x[k]).collect();
                y[5] = f64::NAN;
                let time = (0..rows).map(|k| 0.1 * k as f64).collect();
                let record = Record::new("r", vec![x], y).unwrap().with_time(time).unwrap();
                let data = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
                let sizes = Sizes { stops: 11, hidden: 3, relaxation: 2 };
                let rate = Some(crate::data::rate::RateMethod::Central);
                let options = FitOptions { model: family, sizes, rate, ..FitOptions::default() };
                let scaling = Scaling::of(&data, rate).unwrap();
                let architecture = options.architecture(&data).unwrap();
                let objective = Objective::new(&data, &scaling, architecture, &options).unwrap();
                let point =
                    crate::fit::random_start::random(objective.architecture(), objective.time_scales(), 1, 0);
                let value = objective.value(&point);
                let of_slope = LeastSquaresProblem::slope(&objective, &point, &value).unwrap().gradient;
                let size = of_slope.iter().fold(0.0, |size: f64, g| size.max(g.abs()));
                assert!(size > 1e-4);
                for (a, b) in of_slope.iter().zip(objective.gradient(&point, &value)) {
                    assert!((a - b).abs() < 1e-11 * size, "{family:?}, {rows} rows: {a} and {b}");
                }
            }
        }
    }
}
