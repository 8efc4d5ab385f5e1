//! Identification of a Duhem neural network from random starts: output weights by ridge least squares, all other
//! parameters by Levenberg-Marquardt with exact derivatives of the free run (theory.md (8.33), (8.34)).
//!
//! ```text
//! F(θ) = min_w [ ½ Σ_k (y_k - ŷ_k)²/N + ½ λ |w|² ] + ½ κ |θ|²               theory.md (8.36)
//! ```
//!
//! `ŷ` is the measured output, scaled, at the `N` rows that are compared; the memory runs through all rows. The
//! constant, the weights of the stops and the logarithms of leaks and relaxation times bear no penalty.
//!
//! Of several starts the error on held-out data selects the best, and the epoch in which it was; it is then
//! trained on all data for a few further epochs. A single start is trained on all data from the beginning.

mod by_record;

use std::cmp::Ordering;
use std::ops::ControlFlow;

use crate::data::FEWEST_ROWS;
use crate::data::initial_state::InitialState;
use crate::data::known_beginning::KnownBeginning;
use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Record};
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::fit::law::Identify;
use crate::fit::law::candidates::{CandidateRequest, RankedLaw, with_compressed_rate};
use crate::fit::law::duhem_nn::by_record::{FreeCurvature, RecordWeights, square_error};
use crate::fit::law::grids::spaced;
use crate::fit::law::search::{IdentifiedLaw, MemoryKind, check_effort, measured, spread, thinned_to};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::progress::{PartialLaw, SearchObserver, SearchProgress};
use crate::fit::sums::output_weights::{OutputProblem, OutputSolution};
use crate::law::Law;
use crate::law::duhem_nn::{
    Cell, CellLayout, CellRun, CellShape, DuhemNn, FurtherInput, Input, LARGEST_WEIGHT, MOST_NEURONS,
};
use crate::law::series::Series;
use crate::linear_algebra::{Gram, Symmetric};
use crate::model::input_transform::common_magnitude;
use crate::optimise::levenberg_marquardt::{
    DescentSettings, LeastSquaresProblem, LevenbergMarquardt, Slope, step_within,
};
use crate::optimise::multi_start::{MultiStart, RoundPlan, SearchStart};
use crate::optimise::parallel;
use crate::optimise::random::{generator, normal};
use crate::options::classical::{ClassicalModel, ClassicalOptions, FittedError};
use crate::options::input_options::InputOptions;
use crate::options::table::check_counts;
use crate::stop_check::StopCheck;
use crate::termination::Termination;
use hysid_core::elementary::ln;
use rand::RngExt;

/// Share of the data that the starts are validated on.
const HELD_OUT: f64 = 0.25;

/// λ: penalty on the squared output weights.
const RIDGE: f64 = 1e-6;

/// κ: penalty on the other squared parameters that have one.
const DECAY: f64 = 1e-5;

/// Epochs of a candidate of `auto`. Designed.
const EPOCHS_OF_CANDIDATE: usize = 40;

/// Most rows compared with the measured output.
const MOST_COMPARED: usize = 2000;

/// The same limit for an objective that is a sum over records.
const MOST_COMPARED_BY_RECORD: usize = 8000;

/// Epochs after which half of the starts are given up, and again after as many more.
const EPOCHS_TO_PROVE_ITSELF: usize = 12;

const PATH_LEAKS: (f64, f64) = (1e-3, 1e3);

/// First path constants `1/c`, as shares of half the range of the input.
const FIRST_PATHS: (f64, f64) = (0.03, 1.0);

/// First thresholds of the stops, as shares of half the range of the input.
const FIRST_THRESHOLDS: (f64, f64) = (0.02, 1.0);

impl Identify for DuhemNn {
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        check_effort(options)?;
        let options = &ClassicalOptions { error: Some(options.fitted_error(data)), ..options.clone() };
        let frame = DuhemFrame::new(data, options)?;
        let whole = DuhemTask::new(&frame, data, options, stop)?;
        // Nothing is to be chosen from a single start, so that it is trained on all data.
        // Free states overfit the training records: held-out records choose the epoch.
        let is_split = options.starts() > 1 || is_free(options);
        let split = if is_split { data.split_for_validation(HELD_OUT) } else { None };
        let split = split.filter(|(kept, held)| !is_free(options) || !shares_records(kept, held));
        let Some((kept, held)) = split else {
            return DuhemTraining::new(&whole, None, options)?.run(&whole, observer);
        };
        let (kept, held) =
            (DuhemTask::new(&frame, &kept, options, stop)?, DuhemTask::new(&frame, &held, options, stop)?);
        DuhemTraining::new(&kept, Some(&held), options)?.run(&whole, observer)
    }

    fn memory_need(data: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let starts = options.starts() as f64;
        let layout = CellLayout::new(shape_of(options, data.has_time()));
        let (p, m) = (layout.count() as f64, layout.shape.terms() as f64);
        let busy = size.threads.min(starts);
        // Gram matrix, curvature and its damped copy, two at a time, each written below its diagonal only.
        let derivatives = busy * (1.5 * (m + p) * (m + p) + p * m + 270.0 * (m + p));
        let all = derivatives + starts * 6.0 * (p + m * m) + 2.0 * size.copies;
        let taken_by = format!("derivatives by {p} searched parameters");
        let advice = "choose fewer hidden, states or operators";
        MemoryNeed::largest_of(all, [(derivatives, taken_by, advice), size.part_of_copies()])
    }

    /// With and without stops; with a rate also where it is compressed.
    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        let CandidateRequest { data, options, .. } = request;
        let rate = options.rate.filter(|_| data.has_time());
        if options.initial_state == Some(InitialState::Free) {
            return with_free_states(model, request, rate).into_iter().enumerate().collect();
        }
        // Held-out errors are relative to the records only where a known beginning is asked for.
        let error = options.known.is_none().then_some(FittedError::Row);
        let of = |(shaping, (states, stops, hidden))| ClassicalOptions {
            rate,
            error,
            shaping,
            states: Some(states),
            operators: Some(stops),
            hidden: Some(options.hidden.unwrap_or(hidden).min(MOST_NEURONS)),
            starts: Some(1),
            epochs: Some(options.epochs.unwrap_or_else(|| options.effort.scaled(EPOCHS_OF_CANDIDATE))),
            seed: options.seed,
            ..ClassicalOptions::of(model)
        };
        let shapings = [InputOptions::default(), with_compressed_rate()];
        let shapings = shapings.into_iter().take(if rate.is_some() { 2 } else { 1 });
        let shapes = [(3, 6, 8), (5, 0, 10)];
        let all = shapings.flat_map(|shaping| shapes.map(|shape| of((shaping, shape))));
        all.enumerate().collect()
    }
}

struct DuhemTraining<'a> {
    /// Training and validation data.
    kept: &'a DuhemTask<'a>,
    held: Option<&'a DuhemTask<'a>>,
    walks: MultiStart<DuhemWalk>,
    epochs: usize,
}

impl<'a> DuhemTraining<'a> {
    fn new(
        kept: &'a DuhemTask<'a>,
        held: Option<&'a DuhemTask<'a>>,
        options: &ClassicalOptions,
    ) -> Result<Self> {
        let begin = |start| DuhemWalk::new(kept, kept.random(options.seed, start));
        let mut walks = MultiStart::new(parallel::numbered(options.starts(), begin));
        walks.sort();
        if walks.best().value().objective == f64::INFINITY {
            return Err(Error::Stopped);
        }
        Ok(Self { kept, held, walks, epochs: options.epochs() })
    }

    fn run(
        mut self,
        whole: &DuhemTask<'_>,
        observer: &mut SearchObserver<'_>,
    ) -> Result<IdentifiedLaw<DuhemNn>> {
        let last = if self.held.is_some() { self.epochs.div_ceil(6) } else { 0 };
        let rounds = self.epochs + last;
        let mut tell = |round, evaluations, best: &DuhemWalk| {
            let law = || {
                let (parameters, value, residual_rows) = best.least();
                whole.law(parameters, value, residual_rows).ok().map(Into::into)
            };
            let (train_nrmse_percent, law) = (best.value().nrmse_percent(), PartialLaw(Some(&law)));
            let told = observer(SearchProgress { round, rounds, evaluations, train_nrmse_percent, law });
            if whole.stop.is_asked() { ControlFlow::Break(()) } else { told }
        };
        let Self { kept, held, ref mut walks, epochs } = self;
        let plan =
            RoundPlan { rounds: epochs, spared: 0, to_prove_itself: EPOCHS_TO_PROVE_ITSELF, finalists: 1 };
        let advance = |walk: &mut DuhemWalk, _| {
            if walk.ended.is_none() {
                walk.advance(kept);
                held.iter().for_each(|held| walk.judge(kept, held));
            }
        };
        let mut termination =
            walks.run(plan, advance, |walks, round| tell(round, walks.evaluations(), walks.best()));
        let evaluations = walks.evaluations();
        let (parameters, value, residual_rows) = walks.best().least();
        if held.is_none() || termination == Termination::Stopped {
            return whole.identified((parameters, value, residual_rows), evaluations, termination);
        }
        // What was held out is learnt from where it was judged best, in few epochs.
        let mut walk = DuhemWalk::new(whole, whole.begun_from(kept, parameters, value));
        if walk.value().objective == f64::INFINITY {
            return whole.identified((parameters, value, residual_rows), evaluations, Termination::Stopped);
        }
        for epoch in 1..=last {
            walk.advance(whole);
            let flow = tell(epochs + epoch, evaluations + walk.evaluations(), &walk);
            if flow.is_break() {
                termination = Termination::Stopped;
                break;
            }
            if let Some(ended) = walk.ended {
                termination = ended;
                break;
            }
        }
        let evaluations = evaluations + walk.evaluations();
        whole.identified((walk.search.parameters(), walk.value(), residual_rows), evaluations, termination)
    }
}

/// States and neurons of candidates with free states, their compression of the rate, and their epochs. Designed.
const FREE_SHAPE: (usize, usize) = (6, 10);
const FREE_RATE_COMPRESSION: f64 = 0.2;
const EPOCHS_OF_FREE: usize = 45;

/// Largest mean of what lies about zero, in standard deviations. Designed.
const ABOUT_ZERO: f64 = 0.3;

/// Candidates of `auto` with free states, with and without the acceleration: odd ones first where input and output lie about
/// zero.
fn with_free_states(
    model: ClassicalModel,
    CandidateRequest { data, options, .. }: &CandidateRequest<'_>,
    rate: Option<RateMethod>,
) -> Vec<ClassicalOptions> {
    let of = |odd, acceleration| ClassicalOptions {
        rate,
        shaping: InputOptions {
            initial_state: Some(InitialState::Free),
            rate_compression: rate.map(|_| FREE_RATE_COMPRESSION),
            ..InputOptions::default()
        },
        states: Some(FREE_SHAPE.0),
        operators: Some(0),
        hidden: Some(options.hidden.unwrap_or(FREE_SHAPE.1)),
        starts: Some(1),
        epochs: Some(options.epochs.unwrap_or_else(|| options.effort.scaled(EPOCHS_OF_FREE))),
        odd,
        acceleration,
        seed: options.seed,
        ..ClassicalOptions::of(model)
    };
    let is_about_zero = |values: fn(&Record) -> &[f64]| {
        let all = data.records().iter().flat_map(values).copied().filter(|value| !value.is_nan());
        let (mean, deviation) = spread(&all.collect::<Vec<f64>>());
        mean.abs() <= ABOUT_ZERO * deviation
    };
    let is_odd = is_about_zero(|record| &record.inputs()[0]) && is_about_zero(Record::output);
    let variants: &[(bool, bool)] = match (is_odd, rate.is_some()) {
        (true, true) => &[(true, true), (true, false), (false, false)],
        (true, false) => &[(true, false), (false, false)],
        (false, true) => &[(false, true), (false, false)],
        (false, false) => &[(false, false)],
    };
    variants.iter().map(|&(odd, acceleration)| of(odd, acceleration)).collect()
}

fn is_free(options: &ClassicalOptions) -> bool {
    options.shaping.initial_state == Some(InitialState::Free)
}

/// True if parts of one record are in both.
fn shares_records(kept: &Dataset, held: &Dataset) -> bool {
    held.records().iter().any(|record| kept.records().iter().any(|other| other.name() == record.name()))
}

/// The requested numbers of parts, for data with or without time stamps.
fn shape_of(options: &ClassicalOptions, has_time: bool) -> CellShape {
    let has_rate = options.rate.is_some();
    CellShape {
        channels: if has_rate { 2 } else { 1 },
        stops: options.operators(),
        states: options.states(),
        neurons: options.hidden(),
        has_time: has_time && has_rate,
        has_acceleration: has_time && has_rate && options.acceleration,
        direct: 0,
        modulators: 0,
        is_odd: options.odd,
    }
}

fn check_shape(shape: CellShape) -> Result<()> {
    check_counts(DuhemNn::FACTS.limits, |option| match option {
        "hidden" => shape.neurons,
        "operators" => shape.stops,
        "states" => shape.states,
        _ => unreachable!("a network consists of neurons, stops and states"),
    })
}

/// The scales of the data, and what the network consists of.
struct DuhemFrame {
    /// Without a network.
    law: DuhemNn,
    layout: CellLayout,
    bounds: Vec<(f64, f64)>,
    /// Mean time step and duration of the longest record.
    times: (f64, f64),
    acceleration_scale: Option<f64>,
}

impl DuhemFrame {
    fn new(data: &Dataset, options: &ClassicalOptions) -> Result<Self> {
        let series = Series::all(data, options.rate)?;
        let times = time_scales(&series);
        let further = further_inputs(data, options.odd);
        let shape = CellShape {
            direct: further.iter().filter(|input| input.is_direct).count(),
            modulators: further.iter().filter(|input| input.is_modulating).count(),
            ..shape_of(options, times.1 > 0.0)
        };
        check_shape(shape)?;
        let layout = CellLayout::new(shape);
        let (mut low, mut high) = data.input_range(0);
        let (mut output_mean, output_scale) = spread(&measured(&series));
        if shape.is_odd {
            (high, output_mean) = (high.abs().max(low.abs()), 0.0);
            low = -high;
        }
        let rates = series.iter().flat_map(|series| &series.samples).map(|sample| sample.rate.abs());
        let law = DuhemNn {
            input_centre: 0.5 * low + 0.5 * high,
            input_scale: 0.5 * high - 0.5 * low,
            rate_scale: options.rate.map(|_| common_magnitude(rates.collect())),
            output_mean,
            output_scale,
            cell: layout.cell(&vec![0.0; layout.count()], vec![0.0; layout.shape.terms()]),
            further,
            beginning: None,
        };
        let acceleration_scale = shape.has_acceleration.then(|| acceleration_scale(&series, law.input_scale));
        let bounds = (0..layout.count()).map(|index| bounds(&layout, index, times)).collect();
        Ok(Self { law, layout, bounds, times, acceleration_scale })
    }

    fn cell(&self, parameters: &[f64], output: Vec<f64>) -> Cell {
        let acceleration_scale = self.acceleration_scale;
        Cell { acceleration_scale, ..self.layout.cell(&parameters[..self.layout.count()], output) }
    }
}

/// Share of the common second derivative beyond which the acceleration is compressed.
const ACCELERATION_SHARE: f64 = 0.2;

/// The scale `ς` of the acceleration, in scaled units.
fn acceleration_scale(series: &[Series], input_scale: f64) -> f64 {
    let mut all = Vec::new();
    for series in series {
        for rows in series.samples.windows(3) {
            let velocity = |k: usize| (rows[k].x - rows[k - 1].x) / rows[k].step;
            let acceleration = (velocity(2) - velocity(1)) / rows[2].step;
            if acceleration.is_finite() {
                all.push(acceleration.abs() / input_scale);
            }
        }
    }
    if all.is_empty() {
        return 1.0;
    }
    let place = (0.95 * (all.len() - 1) as f64) as usize;
    let (_, &mut common, _) = all.select_nth_unstable_by(place, f64::total_cmp);
    if common > 0.0 { ACCELERATION_SHARE * common } else { 1.0 }
}

/// Largest mean variation within a record, as a share of the whole range, of a slow input. Designed.
const SLOW: f64 = 0.05;

/// The inputs beside the first: slow ones modulate; an odd network takes these only as modulators.
fn further_inputs(data: &Dataset, is_odd: bool) -> Vec<FurtherInput> {
    let of = |input: usize| {
        let (low, high) = data.input_range(input);
        let within = |record: &Record| {
            let (low, high) = record.input_range(input);
            high - low
        };
        let mean = data.records().iter().map(within).sum::<f64>() / data.records().len() as f64;
        let is_slow = mean <= SLOW * (high - low);
        let scale = 0.5 * high - 0.5 * low;
        FurtherInput {
            centre: 0.5 * low + 0.5 * high,
            scale: if scale > 0.0 { scale } else { 1.0 },
            is_direct: !(is_slow && is_odd),
            is_modulating: is_slow,
        }
    };
    (1..data.names().inputs.len()).map(of).collect()
}

/// Scaled records that a start is trained or validated on.
struct DuhemTask<'a> {
    frame: &'a DuhemFrame,
    drives: Vec<Vec<Input>>,
    further: Vec<Vec<f64>>,
    targets: Vec<Vec<f64>>,
    /// Outputs of all rows, if states are free.
    whole_targets: Vec<Vec<f64>>,
    /// Rows of the known beginning of each record with which it is judged.
    known: Vec<usize>,
    rows: usize,
    /// Weights of the records, if the objective is a sum over records.
    by_record: Option<RecordWeights>,
    stop: StopCheck<'a>,
}

impl<'a> DuhemTask<'a> {
    fn new(
        frame: &'a DuhemFrame,
        data: &Dataset,
        options: &ClassicalOptions,
        stop: StopCheck<'a>,
    ) -> Result<Self> {
        let law = &frame.law;
        let is_free = is_free(options);
        let error = options.fitted_error(data);
        let is_by_record = is_free || error == FittedError::Record;
        let (memory, most) = match is_by_record {
            true => (MemoryKind::EveryRow, MOST_COMPARED_BY_RECORD),
            false => (MemoryKind::Path, MOST_COMPARED),
        };
        let scaled = |series: &Series| series.samples.iter().map(|&sample| law.scaled(sample)).collect();
        let blank = if is_free { frame.layout.shape.rows_without_derivatives() } else { 0 };
        let target = |series: &Series| {
            let mut scaled: Vec<f64> =
                series.output.iter().map(|y| (y - law.output_mean) / law.output_scale).collect();
            scaled.iter_mut().take(blank).for_each(|y| *y = f64::NAN);
            scaled
        };
        let further_of = |series: &Series| law.scaled_columns(&series.further, series.samples.len());
        let all = Series::all(data, options.rate)?;
        let whole_targets = if is_free { all.iter().map(target).collect() } else { Vec::new() };
        let series = thinned_to(all, memory, most);
        let targets: Vec<Vec<f64>> = series.iter().map(target).collect();
        let rows = targets.iter().flatten().filter(|y| !y.is_nan()).count();
        let further = series.iter().map(further_of).collect();
        let (known, state) = (options.known.as_ref(), options.shaping.initial_state);
        let beginning = KnownBeginning::judged(known, state, data.names())?;
        let scored = data.records().iter().filter(|record| record.scored() > 0);
        let known = scored.map(|record| beginning.rows(record)).collect();
        let by_record = is_by_record.then(|| RecordWeights::of(&targets, error, is_free));
        let drives = series.iter().map(scaled).collect();
        Ok(Self { frame, drives, further, targets, whole_targets, known, rows, by_record, stop })
    }

    fn random(&self, seed: u64, start: usize) -> Vec<f64> {
        let mut generator = generator(seed, start);
        let DuhemFrame { layout, times: (step, duration), .. } = self.frame;
        let shape = layout.shape;
        let is_free = self.by_record.as_ref().is_some_and(RecordWeights::is_free);
        let of_records = if is_free { self.drives.len() * shape.states } else { 0 };
        let mut parameters = vec![0.0; layout.count() + of_records];
        let spread = 1.2 / (shape.inputs() as f64).sqrt();
        for place in layout.hidden.clone() {
            parameters[place] = spread * normal(&mut generator);
        }
        for place in layout.targets.clone() {
            parameters[place] = 0.1 * normal(&mut generator);
        }
        parameters[layout.rate_gains.clone()].fill(1.0);
        for (i, place) in layout.ln_path_leaks.clone().enumerate() {
            parameters[place] = -ln(spaced(FIRST_PATHS, i, shape.states));
        }
        let (shortest, longest) = (ln(2.0 * step), ln((0.25 * duration).max(4.0 * step)));
        for place in layout.ln_relaxation_times.clone() {
            parameters[place] = shortest + (longest - shortest) * generator.random::<f64>();
        }
        for (i, place) in layout.stops.clone().enumerate() {
            parameters[place] = match i < shape.stops {
                true => 1.0 / spaced(FIRST_THRESHOLDS, i, shape.stops),
                false => 0.5 * normal(&mut generator),
            };
        }
        parameters
    }

    /// The network with these parameters and the output weights there.
    fn law(&self, parameters: &[f64], value: &DuhemValue, residual_rows: f64) -> Result<DuhemNn> {
        let cell = self.frame.cell(parameters, value.solution.weights.clone());
        let free = self.by_record.as_ref().filter(|weights| weights.is_free());
        let beginning = free.map(|weights| weights.prior(self, parameters, value, residual_rows));
        DuhemNn { cell, beginning, ..self.frame.law.clone() }.validated()
    }

    fn identified(
        &self,
        (parameters, value, residual_rows): (&[f64], &DuhemValue, f64),
        evaluations: usize,
        termination: Termination,
    ) -> Result<IdentifiedLaw<DuhemNn>> {
        let law = self.law(parameters, value, residual_rows)?;
        let train_nrmse_percent = value.nrmse_percent();
        Ok(IdentifiedLaw { law, train_nrmse_percent, evaluations, termination, searched: Vec::new() })
    }

    /// The Gram matrix of the terms of the output and the target, and of the Jacobian for given output weights.
    fn gram(&self, parameters: &[f64], output: Option<&[f64]>) -> Option<Gram> {
        let weights = output.map_or_else(|| vec![0.0; self.frame.layout.shape.terms()], <[f64]>::to_vec);
        let run = CellRun {
            cell: &self.frame.cell(parameters, weights),
            drives: &self.drives,
            further: &self.further,
            initial: &[],
            targets: &self.targets,
            with_jacobian: output.is_some(),
            stop: self.stop,
        };
        run.gram()
    }

    /// Mean square error of the network with these output weights; `None` once stopped.
    fn mean_square(&self, parameters: &[f64], value: &DuhemValue) -> Option<f64> {
        let gram = self.gram(parameters, None)?;
        Some(square_error(&gram, &value.solution.weights) / self.rows as f64)
    }

    /// The output weights from a Gram matrix over so many rows, each with its weight.
    fn output_problem<'g>(&'g self, gram: &'g Gram, rows: f64) -> OutputProblem<'g> {
        OutputProblem {
            gram,
            features: self.frame.layout.shape.terms(),
            rows,
            ridge: RIDGE,
            constant: !self.frame.layout.shape.is_odd,
            stop: self.stop,
        }
    }

    fn weights<'p>(&'p self, parameters: &'p [f64]) -> impl Iterator<Item = (usize, &'p f64)> {
        let layout = &self.frame.layout;
        parameters[..layout.count()].iter().enumerate().filter(|(index, _)| layout.has_decay(*index))
    }
}

/// Mean finite time step and duration of the longest record; 0 without time stamps.
fn time_scales(series: &[Series]) -> (f64, f64) {
    let steps = |series: &Series| -> f64 {
        series.samples.iter().map(|sample| sample.step).filter(|step| step.is_finite()).sum()
    };
    let durations = series.iter().map(steps);
    let steps: usize = series.iter().map(|series| series.samples.len() - 1).sum();
    (durations.clone().sum::<f64>() / steps.max(1) as f64, durations.fold(0.0, f64::max))
}

fn bounds(layout: &CellLayout, index: usize, (step, duration): (f64, f64)) -> (f64, f64) {
    if layout.ln_path_leaks.contains(&index) {
        (ln(PATH_LEAKS.0), ln(PATH_LEAKS.1))
    } else if layout.ln_relaxation_times.contains(&index) {
        let usable = |time: f64| ln(time.clamp(f64::MIN_POSITIVE, LARGEST_VALUE));
        (usable(0.1 * step), usable(100.0 * duration))
    } else {
        (-LARGEST_WEIGHT, LARGEST_WEIGHT)
    }
}

/// The objective at a point, with the output weights there; infinite if it was broken off.
#[derive(Debug, Clone)]
struct DuhemValue {
    objective: f64,
    mean_square: f64,
    solution: OutputSolution,
    /// Weights of the records, if states are free.
    record_weights: Vec<f64>,
}

impl DuhemValue {
    fn nrmse_percent(&self) -> f64 {
        100.0 * self.mean_square.sqrt()
    }
}

impl LeastSquaresProblem for DuhemTask<'_> {
    type Value = DuhemValue;
    type Curvature = DuhemCurvature;
    const RULES: DescentSettings = DescentSettings::SMOOTH;

    fn value(&self, parameters: &[f64]) -> DuhemValue {
        if let Some(weights) = &self.by_record {
            return weights.value(self, parameters);
        }
        let solution = match self.gram(parameters, None) {
            Some(gram) => self.output_problem(&gram, self.rows as f64).solve(),
            None => OutputSolution::broken_off(self.frame.layout.shape.terms()),
        };
        let decay: f64 = self.weights(parameters).map(|(_, w)| w * w).sum();
        let objective = solution.objective + 0.5 * DECAY * decay; // (8.36)
        DuhemValue { objective, mean_square: solution.mean_square, solution, record_weights: Vec::new() }
    }

    fn objective(value: &DuhemValue) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], value: &DuhemValue) -> Option<Slope<DuhemCurvature>> {
        if let Some(weights) = &self.by_record {
            return weights.slope(self, parameters, value);
        }
        let gram = self.gram(parameters, Some(&value.solution.weights))?;
        let (mut gradient, mut curvature) =
            self.output_problem(&gram, self.rows as f64).linearise(&value.solution, parameters.len());
        for (index, weight) in self.weights(parameters) {
            gradient[index] += DECAY * weight; // (3.3)
            curvature.add_to_diagonal(index, DECAY);
        }
        let diagonal = (0..gradient.len()).map(|index| curvature.diagonal(index)).collect();
        let curvature = DuhemCurvature::Fixed(curvature);
        (!self.stop.is_asked()).then_some(Slope { gradient, diagonal, curvature, evaluations: 1 })
    }

    fn step(&self, slope: &Slope<DuhemCurvature>, parameters: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let leaves = |i: usize, by: f64| {
            let (low, high) = self.frame.bounds[i];
            parameters[i] <= low && by < 0.0 || parameters[i] >= high && by > 0.0
        };
        match &slope.curvature {
            DuhemCurvature::Fixed(matrix) => step_within(matrix, &slope.gradient, damping, leaves, self.stop),
            DuhemCurvature::Free(curvature) => curvature.step(damping, leaves, self.stop),
        }
    }

    fn limit(&self, parameters: &mut [f64]) {
        for (parameter, &(low, high)) in parameters.iter_mut().zip(&self.frame.bounds) {
            *parameter = parameter.clamp(low, high);
        }
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}

/// Curvature of the objective.
enum DuhemCurvature {
    /// By the parameters, with the best output weights.
    Fixed(Symmetric),
    /// By output weights, parameters and the states of each record.
    Free(FreeCurvature),
}

struct DuhemWalk {
    search: LevenbergMarquardt<DuhemValue>,
    ended: Option<Termination>,
    /// Evaluations of what was held out.
    judged: usize,
    /// Smallest error on what was held out, where it was, and the rows within which a residual falls to 1/e there.
    least_on_held_out: Option<(f64, Vec<f64>, DuhemValue, f64)>,
}

impl DuhemWalk {
    fn new(task: &DuhemTask<'_>, parameters: Vec<f64>) -> Self {
        let search = LevenbergMarquardt::new(task, parameters);
        Self { search, ended: None, judged: 0, least_on_held_out: None }
    }

    fn advance(&mut self, task: &DuhemTask<'_>) {
        self.ended = self.search.advance(task);
    }

    /// Remembers the parameters if they do better than any before on what was held out.
    fn judge(&mut self, kept: &DuhemTask<'_>, held: &DuhemTask<'_>) {
        let (parameters, value) = (self.search.parameters(), self.value());
        let judged = match &kept.by_record {
            Some(weights) if weights.is_free() => {
                weights.error_after_beginning(kept, held, parameters, value)
            }
            _ => held.mean_square(parameters, value).map(|error| (error, 0.0)),
        };
        let Some((error, residual_rows)) = judged else { return };
        self.judged += 1;
        if self.least_on_held_out.as_ref().is_none_or(|(least, ..)| error < *least) {
            let parameters = self.search.parameters().to_vec();
            self.least_on_held_out = Some((error, parameters, self.value().clone(), residual_rows));
        }
    }

    fn value(&self) -> &DuhemValue {
        self.search.known_value().expect("a walk begins at a known value")
    }

    /// Where the error on held-out data is smallest, and the value there; the present place if it was not validated.
    fn least(&self) -> (&[f64], &DuhemValue, f64) {
        self.least_on_held_out.as_ref().map_or_else(
            || (self.search.parameters(), self.value(), 0.0),
            |(_, parameters, value, residual_rows)| (parameters.as_slice(), value, *residual_rows),
        )
    }
}

impl SearchStart for DuhemWalk {
    /// By the error on held-out data, if there is one.
    fn order(&self, other: &Self) -> Ordering {
        let rank = |walk: &DuhemWalk| walk.least_on_held_out.as_ref().map(|(error, ..)| *error);
        match (rank(self), rank(other)) {
            (None, None) => self.value().objective.total_cmp(&other.value().objective),
            (a, b) => a.unwrap_or(f64::INFINITY).total_cmp(&b.unwrap_or(f64::INFINITY)),
        }
    }

    fn evaluations(&self) -> usize {
        self.search.evaluations() + self.judged
    }

    fn ended(&self) -> Option<Termination> {
        self.ended
    }
}
