//! Identification of modes with hysteretic elements: a linear system first, then everything together on the error of
//! the free run, by Levenberg-Marquardt with exact derivatives through time.
//!
//! ```text
//! F(P) = ½ Σ_k n_k (y_k - ŷ_k)²/N + ½ κ |P_w|²                                  theory.md (15.15)
//! ```
//!
//! `ŷ_k` is the output of the free run at row `k`, scaled; `n_k` is the number of periods that the row is the mean of,
//! and `N` their sum. The penalty acts on the weights of the elements only, and falls in stages. The first stages use
//! only the beginnings of the records. The first six stages integrate with steps twice as long.

mod linear_start;
mod records;
mod task;

use std::cmp::Ordering;
use std::ops::ControlFlow;

use serde_json::json;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::diagnosis::resonance::ComparedSignal;
use crate::error::{Error, OptionError, Result};
use crate::fit::law::candidates::{CandidateRequest, RankedLaw};
use crate::fit::law::grids::spaced;
use crate::fit::law::search::{IdentifiedLaw, check_effort};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::progress::{PartialLaw, SearchObserver, SearchProgress};
use crate::law::Classical;
use crate::law::hysteretic_dynamics::{
    Dynamics, DynamicsForm, DynamicsLayout, Element, ElementShape, LIMITS, MOST_NEURONS,
};
use crate::optimise::levenberg_marquardt::LevenbergMarquardt;
use crate::optimise::multi_start::{MultiStart, RoundPlan, SearchStart};
use crate::optimise::parallel;
use crate::optimise::random::{generator, normal};
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::table::{check, check_counts};
use crate::stop_check::StopCheck;
use crate::termination::Termination;
use linear_start::LinearStarts;
pub(crate) use linear_start::first_second_difference;
use records::Records;
use task::{AT_ONCE, DynamicsTask, DynamicsValue};

/// Epochs after which half of the starts are given up, and again after as many more.
const EPOCHS_TO_PROVE_ITSELF: usize = 30;

/// Epochs that the stages are made for. Fewer pass through all of them more quickly.
const SCHEDULED: usize = 140;

/// Stages of the training. After the last the penalty follows from the error.
const STAGES: [ScheduleStage; 4] = [
    ScheduleStage { end: 12, penalty: 1e-4, is_early: true, has_one_mode: true },
    ScheduleStage { end: 24, penalty: 1e-5, is_early: true, has_one_mode: true },
    ScheduleStage { end: 36, penalty: 1e-6, is_early: true, has_one_mode: false },
    ScheduleStage { end: 50, penalty: 1e-7, is_early: false, has_one_mode: false },
];

struct ScheduleStage {
    /// The epoch after which it ends, of [`SCHEDULED`].
    end: usize,
    /// κ.
    penalty: f64,
    /// True if it uses only the beginnings of the records.
    is_early: bool,
    /// True if starts of one mode still have one.
    has_one_mode: bool,
}

/// Epochs after which the penalty follows the error again.
const EPOCHS_OF_PENALTY: usize = 20;

/// First stages with longer integration steps, which cost half and end close to the best parameters.
const COARSE_STAGES: usize = STAGES.len() + 2;

/// Length of the steps in these stages, in steps of the model.
const COARSE: f64 = 2.0;

/// Expected size of weights, squared: with the penalty `ε²/(9 N)` a weight of 3 costs as much as one standard error.
const EXPECTED_SQUARE: f64 = 9.0;

/// First leaks along the path, in standard deviations of the displacement.
const FIRST_LEAKS: (f64, f64) = (0.4, 4.0);

/// First share of each displacement in what drives an element, where the input drives it.
const SHARE_BESIDE_INPUT: f64 = 0.1;

/// First thresholds of stops, in the same unit.
const FIRST_THRESHOLDS: (f64, f64) = (0.1, 2.0);

/// First loss of strength of a stop, in the inverse unit of the displacement.
const FIRST_STRENGTH_LOSS: f64 = 1e-3;

/// Starts of a candidate of `auto` for each start of another: the search drops those with the larger errors.
const STARTS_OF_CANDIDATE: usize = 2;

/// The peak memory of a fit with these options to data of this size.
pub(super) fn memory_need(
    form: DynamicsForm,
    data: &Dataset,
    options: &ClassicalOptions,
    size: &LawFitSize,
) -> MemoryNeed {
    // Numbers that no model can have are refused by the fit itself.
    let parameters = DynamicsSpec::of(form, options).map_or(0, |asked| asked.layout().count());
    let (p, starts) = (parameters as f64, options.starts() as f64);
    let at_once = data.records().len().min(AT_ONCE) as f64;
    let busy = size.threads.min(starts * at_once);
    // As for a Duhem network. A start keeps the sums of some records until it adds them.
    let derivatives = busy * (1.5 * p * p + 300.0 * p + starts * at_once * p * p / busy);
    let taken_by = format!("derivatives by {parameters} searched parameters");
    let advice = "choose fewer hidden, states, modes or operators";
    let all = derivatives + starts * 6.0 * p + 2.0 * size.copies;
    MemoryNeed::largest_of(all, [(derivatives, taken_by, advice), size.part_of_copies()])
}

/// The candidates of `auto` for data with a resonance. With degradation if only changes show it (yielding).
pub(super) fn candidates(
    form: DynamicsForm,
    model: ClassicalModel,
    request: &CandidateRequest<'_>,
) -> Vec<RankedLaw> {
    let options = request.options;
    let of = |modes: usize| ClassicalOptions {
        modes: Some(options.modes.unwrap_or(modes)),
        hidden: options.hidden.map(|hidden| hidden.min(MOST_NEURONS)),
        operators: options.operators.map(|stops| stops.min(MOST_NEURONS)),
        starts: Some(STARTS_OF_CANDIDATE * options.starts),
        epochs: options.epochs,
        seed: options.seed,
        ..ClassicalOptions::of(model)
    };
    let degrading = |modes: usize| ClassicalOptions { degradation: true, ..of(modes) };
    let without_memory = || ClassicalOptions { states: Some(0), operators: Some(0), ..of(1) };
    let may_have_no_stops = options.operators.is_none_or(|stops| stops == 0);
    // The ranks are among both forms.
    let all = match (form, request.resonance) {
        (_, None) | (DynamicsForm::StateSpace, Some(ComparedSignal::Changes)) => vec![],
        (DynamicsForm::Oscillator, Some(ComparedSignal::Changes)) => {
            vec![Some((0, degrading(1))), Some((1, of(1))), Some((2, degrading(2)))]
        }
        (DynamicsForm::Oscillator, Some(ComparedSignal::Output)) => {
            vec![Some((0, of(1))), (options.deterioration == Some(true)).then(|| (4, degrading(1)))]
        }
        (DynamicsForm::StateSpace, Some(ComparedSignal::Output)) => {
            vec![Some((1, of(1))), Some((2, of(2))), may_have_no_stops.then(|| (3, without_memory()))]
        }
    };
    all.into_iter().flatten().collect()
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct DynamicsSpec {
    form: DynamicsForm,
    modes: usize,
    elements: usize,
    shape: ElementShape,
}

impl DynamicsSpec {
    /// The request, or an error for numbers that no model can have.
    pub fn of(form: DynamicsForm, options: &ClassicalOptions) -> Result<Self> {
        let modes = options.modes();
        let shape = ElementShape {
            stops: options.operators(),
            states: options.states(),
            neurons: options.hidden(),
            deteriorates: options.degradation,
        };
        if shape.deteriorates && shape.stops == 0 {
            let needed = "without stops nothing deteriorates: choose 1 or more, or leave out degradation";
            return Err(OptionError::value("operators", 0, needed).into());
        }
        check([("modes", json!(modes))])?;
        check_counts(LIMITS, |option| match option {
            "hidden" => shape.neurons,
            "operators" => shape.stops,
            "states" => shape.states,
            _ => unreachable!("an element consists of neurons, stops and states"),
        })?;
        // An element of a state space model may be driven by all of its modes.
        let elements = if form == DynamicsForm::Oscillator { modes } else { 1 };
        Ok(Self { form, modes, elements, shape })
    }

    /// The layout of its parameters.
    pub fn layout(&self) -> DynamicsLayout {
        DynamicsLayout::new(self.form, self.modes, self.elements, self.shape)
    }
}

/// Identifies modes and elements; `make` makes a law of them.
pub(super) fn identify(
    data: &Dataset,
    asked: &DynamicsSpec,
    options: &ClassicalOptions,
    make: &(dyn Fn(Dynamics) -> Classical + Sync),
    observer: &mut SearchObserver<'_>,
    stop: StopCheck<'_>,
) -> Result<IdentifiedLaw<Dynamics>> {
    data.check_identifiable(FEWEST_ROWS)?;
    check_effort(options)?;
    let rounds = options.epochs();
    let records = Records::of(data)?;
    let linear = LinearStarts::find(&records, asked, stop).ok_or(Error::Stopped)?;
    let layout = asked.layout();
    let beginning = |start| {
        let kind = StartKind::of(start, asked);
        with_elements(linear.of(kind), asked, options.seed, start, kind, records.input_deviation())
    };
    let template = beginning(0);
    let coarse = Dynamics { longest_step: COARSE * template.longest_step, ..template.clone() };
    let early = linear.begun(records.beginning());
    let whole = linear.begun(records.drives.clone());
    let tasks = Tasks {
        early: DynamicsTask::new(&layout, &coarse, &early, stop),
        coarse: DynamicsTask::new(&layout, &coarse, &whole, stop),
        fine: DynamicsTask::new(&layout, &template, &whole, stop),
    };

    let begin =
        |start: usize| DynamicsWalk::new(&tasks.early, &beginning(start), StartKind::of(start, asked));
    let mut walks = MultiStart::new(parallel::numbered(options.starts(), begin));
    walks.sort();
    if walks.best().value().objective == f64::INFINITY {
        return Err(Error::Stopped);
    }
    let mut tell = |round: usize, walks: &MultiStart<DynamicsWalk>| {
        let best = walks.best();
        let law = || Some(make(layout.dynamics(best.search.parameters(), &template)));
        let told = observer(SearchProgress {
            round,
            rounds,
            evaluations: walks.evaluations(),
            train_nrmse_percent: best.value().nrmse_percent(),
            law: PartialLaw(Some(&law)),
        });
        if stop.is_asked() { ControlFlow::Break(()) } else { told }
    };
    let plan = RoundPlan { rounds, spared: 0, to_prove_itself: EPOCHS_TO_PROVE_ITSELF, finalists: 1 };
    let advance = |walk: &mut DynamicsWalk, round: usize| walk.advance(round, rounds, &tasks);
    let termination = walks.run(plan, advance, |walks, round| tell(round, walks));
    let best = walks.best();
    let law = layout.dynamics(best.search.parameters(), &template);
    let mean_square = tasks.fine.mean_square(best.search.parameters()).unwrap_or(best.value().mean_square);
    Ok(IdentifiedLaw {
        law,
        train_nrmse_percent: 100.0 * mean_square.sqrt(),
        evaluations: walks.evaluations(),
        termination,
        searched: Vec::new(),
    })
}

/// Distinguishes a start, beside its random weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StartKind {
    /// True if the input drives the elements (an actuator), false if the displacement does (a structure).
    is_driven_by_input: bool,
    /// True if only the first mode moves in the first stages, which may end in a better minimum.
    has_one_mode_first: bool,
}

impl StartKind {
    /// All kinds in turn; the second differs from the first in both.
    fn of(start: usize, asked: &DynamicsSpec) -> Self {
        Self {
            is_driven_by_input: asked.form == DynamicsForm::StateSpace && start % 2 == 1,
            has_one_mode_first: asked.modes > 1 && matches!(start % 4, 1 | 2),
        }
    }
}

/// A linear system with hysteretic elements whose forces are small, different for each start.
fn with_elements(
    linear: &Dynamics,
    asked: &DynamicsSpec,
    seed: u64,
    start: usize,
    kind: StartKind,
    input_deviation: f64,
) -> Dynamics {
    let mut generator = generator(seed, start);
    let mut random =
        |count: usize, size: f64| -> Vec<f64> { (0..count).map(|_| size * normal(&mut generator)).collect() };
    let DynamicsSpec { form, modes, elements, shape } = *asked;
    let ElementShape { stops, states, neurons, deteriorates } = shape;
    let mut element = |e: usize| {
        let mut compliances = if modes == 1 { vec![1.0] } else { random(modes, 0.4) };
        compliances[e % modes] = 1.0;
        let mut of_displacements = compliances.clone();
        if kind.is_driven_by_input {
            of_displacements.iter_mut().for_each(|share| *share *= SHARE_BESIDE_INPUT);
        }
        if kind.has_one_mode_first {
            compliances[1..].fill(0.0);
        }
        let of_velocities =
            if form == DynamicsForm::StateSpace { random(modes, 0.1) } else { vec![0.0; modes] };
        let mut layer = random(shape.inputs() * neurons, 1.2 / (shape.inputs() as f64).sqrt());
        if deteriorates {
            layer[..neurons].fill(0.0);
        }
        Element {
            of_displacements,
            of_velocities,
            of_input: if kind.is_driven_by_input { 1.0 / input_deviation } else { 0.0 },
            compliances,
            in_output: 0.0,
            thresholds: (0..stops).map(|i| spaced(FIRST_THRESHOLDS, i, stops)).collect(),
            stop_velocities: vec![0.0; stops],
            strength_losses: vec![FIRST_STRENGTH_LOSS; if deteriorates { stops } else { 0 }],
            layer,
            rising: random(states * neurons, 0.1),
            falling: random(states * neurons, 0.1),
            path_leaks: (0..states).map(|i| spaced(FIRST_LEAKS, i, states)).collect(),
            initial: vec![0.0; states],
            force: random(stops + states + neurons, 0.05),
        }
    };
    Dynamics { elements: (0..elements).map(&mut element).collect(), ..linear.clone() }
}

struct Tasks<'a> {
    early: DynamicsTask<'a>,
    /// The records, with long steps.
    coarse: DynamicsTask<'a>,
    /// The records, with the steps of the model.
    fine: DynamicsTask<'a>,
}

struct DynamicsWalk {
    kind: StartKind,
    search: LevenbergMarquardt<DynamicsValue>,
    /// Penalty on the square of each parameter.
    penalties: Vec<f64>,
    stage: usize,
    /// True in the last stage, which alone may end the search.
    is_in_last: bool,
    ended: Option<Termination>,
    earlier: usize,
}

impl DynamicsWalk {
    fn new(task: &DynamicsTask<'_>, beginning: &Dynamics, kind: StartKind) -> Self {
        let penalties = task.penalties(STAGES[0].penalty);
        let search = LevenbergMarquardt::new(&task.with_penalties(&penalties), task.parameters(beginning));
        Self { kind, search, penalties, stage: 0, is_in_last: false, ended: None, earlier: 0 }
    }

    fn value(&self) -> &DynamicsValue {
        self.search.known_value().expect("a walk begins at a known value")
    }

    /// One epoch out of `epochs`, in the stage that it belongs to.
    fn advance(&mut self, epoch: usize, epochs: usize, tasks: &Tasks<'_>) {
        let stage = stage(epoch, epochs);
        self.is_in_last = stage == self::stage(epochs, epochs);
        let known = STAGES.get(stage);
        let task = match stage < COARSE_STAGES {
            true if known.is_some_and(|stage| stage.is_early) => &tasks.early,
            true => &tasks.coarse,
            false => &tasks.fine,
        };
        let has_one_mode = self.kind.has_one_mode_first && known.is_some_and(|stage| stage.has_one_mode);
        let task = task.of_one_mode(has_one_mode);
        if stage != self.stage {
            self.earlier += self.search.evaluations();
            let parameters = self.search.parameters().to_vec();
            let mean_square = self.value().mean_square;
            self.penalties = task.penalties(match known {
                Some(stage) => stage.penalty,
                None => mean_square / (EXPECTED_SQUARE * task.rows),
            });
            self.search = LevenbergMarquardt::new(&task.with_penalties(&self.penalties), parameters);
            (self.stage, self.ended) = (stage, None);
        }
        if self.ended.is_none() {
            self.ended = self.search.advance(&task.with_penalties(&self.penalties));
        }
    }
}

fn stage(epoch: usize, epochs: usize) -> usize {
    let scaled = if epochs < SCHEDULED { epoch * SCHEDULED / epochs } else { epoch };
    match STAGES.iter().position(|stage| scaled <= stage.end) {
        Some(stage) => stage,
        None => STAGES.len() + (scaled - STAGES[STAGES.len() - 1].end) / EPOCHS_OF_PENALTY,
    }
}

impl SearchStart for DynamicsWalk {
    fn order(&self, other: &Self) -> Ordering {
        self.value().objective.total_cmp(&other.value().objective)
    }

    fn evaluations(&self) -> usize {
        self.earlier + self.search.evaluations()
    }

    fn ended(&self) -> Option<Termination> {
        self.ended.filter(|_| self.is_in_last)
    }
}

/// Identifies a law that holds modes and elements, in its form.
macro_rules! identified_as {
    ($law:ident, $form:expr) => {
        impl $crate::fit::law::Identify for $law {
            fn identify(
                data: &$crate::data::record::Dataset,
                options: &$crate::options::classical::ClassicalOptions,
                observer: &mut $crate::fit::progress::SearchObserver<'_>,
                stop: $crate::stop_check::StopCheck<'_>,
            ) -> $crate::error::Result<$crate::fit::law::search::IdentifiedLaw<Self>> {
                use $crate::fit::law::hysteretic_dynamics::{DynamicsSpec, identify};
                use $crate::law::Law;
                let asked = DynamicsSpec::of($form, options)?;
                let found =
                    identify(data, &asked, options, &|dynamics| Self(dynamics).into(), observer, stop)?;
                found.try_map(|dynamics| Self(dynamics).validated())
            }

            fn memory_need(
                data: &$crate::data::record::Dataset,
                options: &$crate::options::classical::ClassicalOptions,
                size: &$crate::fit::memory_need::LawFitSize,
            ) -> $crate::fit::memory_need::MemoryNeed {
                $crate::fit::law::hysteretic_dynamics::memory_need($form, data, options, size)
            }

            fn candidates(
                model: $crate::options::classical::ClassicalModel,
                request: &$crate::fit::law::candidates::CandidateRequest<'_>,
            ) -> Vec<$crate::fit::law::candidates::RankedLaw> {
                $crate::fit::law::hysteretic_dynamics::candidates($form, model, request)
            }
        }
    };
}

pub(super) use identified_as;
