//! One training run: a start that passes through the methods of a trainer, one epoch at a time. Its state can
//! be stored and resumed, to the last bit.

use rand_xoshiro::Xoshiro256PlusPlus;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::fit::network::encoding::Encoding;
use crate::fit::network::objective::{Objective, ObjectiveValue};
use crate::fit::network::soundness::{NetworkFrame, are_finite, require};
use crate::fit::random_start::random;
use crate::model::history::{HistoryPoint, Phase, Run};
use crate::network::{Architecture, Network, ParameterLayout};
use crate::optimise::MOST_COUNTED;
use crate::optimise::genetic::{self, Genetic};
use crate::optimise::levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use crate::optimise::random::mix;
use crate::optimise::space_dilatation::{DilatationOptions, SpaceDilatation, Subdifferentiable};
use crate::optimise::stall::Stall;
use crate::options::network::{FitOptions, Method};
use crate::termination::Termination;

/// Points of a history that are all kept; of more, those at which the error fell by this share.
const POINTS_KEPT: usize = 100;
const FALL_KEPT: f64 = 0.005;

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct TrainingRun {
    phase: Phase,
    start: usize,
    /// Methods still to come, the present one first, with the epochs of each.
    plan: Vec<(Method, usize)>,
    search: Search,
    /// Epochs done by the present method, and by all.
    epoch_of_method: usize,
    epoch: usize,
    /// Evaluations of the methods before the present one.
    evaluations_before: usize,
    best: Point,
    runs: Vec<Run>,
    /// The last point of the present history, kept whatever the fall.
    last: HistoryPoint,
    termination: Option<Termination>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Point {
    pub parameters: Vec<f64>,
    /// Output weights there.
    pub output: Vec<f64>,
    pub objective: f64,
    pub mean_square: f64,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
enum Search {
    LevenbergMarquardt(LevenbergMarquardt<ObjectiveValue>),
    Genetic {
        search: Genetic,
        encoding: Encoding,
        stall: Stall,
    },
    Subgradient {
        search: SpaceDilatation,
        stall: Stall,
    },
    /// All methods are over. Their state, which may be large, is not kept.
    Over,
}

pub(crate) enum From {
    Random,
    /// At given parameters. A genetic algorithm is passed over: it has done its part.
    Parameters(Vec<f64>),
}

impl TrainingRun {
    pub fn new(
        objective: &Objective,
        options: &FitOptions,
        phase: Phase,
        start: usize,
        epochs: usize,
        from: From,
    ) -> Result<Self> {
        let mut plan = options.training.plan(epochs);
        if matches!(from, From::Parameters(_)) && plan.len() > 1 {
            plan.retain(|(method, _)| *method != Method::Genetic);
        }
        let (search, best) = match (plan[0].0, from) {
            (Method::Genetic, _) => begin_genetic(objective, options, start)?,
            (method, from) => {
                let parameters = match from {
                    From::Random => {
                        random(objective.architecture(), objective.time_scales(), options.seed, start)
                    }
                    From::Parameters(parameters) => parameters,
                };
                begin(method, objective, options, parameters)?
            }
        };
        let mut run = Self {
            phase,
            start,
            plan,
            search,
            epoch_of_method: 0,
            epoch: 0,
            evaluations_before: 0,
            last: HistoryPoint { epoch: 0, evaluations: 0, train_nrmse_percent: f64::INFINITY },
            best,
            runs: Vec::new(),
            termination: None,
        };
        run.open_history();
        run.end_method_if_over(objective, options, None)?;
        Ok(run)
    }

    /// Refuses a state of a file that no run with these options comes to.
    pub fn check(&self, frame: &NetworkFrame) -> Result<()> {
        let methods = |plan: &[(Method, usize)]| plan.iter().map(|step| step.0).collect::<Vec<Method>>();
        let (all, left) = (methods(&frame.options.training.plan(0)), methods(&self.plan));
        require(!left.is_empty() && all.ends_with(&left), "methods of a run")?;
        let search = match &self.search {
            Search::LevenbergMarquardt(search) => {
                left[0] == Method::LevenbergMarquardt
                    && search.is_sound(&Objective::RULES, |values| frame.are_parameters(values))
            }
            Search::Genetic { search, encoding, stall } => {
                left[0] == Method::Genetic
                    && encoding.is_sound(frame)
                    && search.is_sound(encoding.bounds(), frame.options.population)
                    && stall.is_sound()
            }
            Search::Subgradient { search, stall } => {
                left[0] == Method::Subgradient
                    && search.is_sound(frame.layout.len(), &DilatationOptions::default())
                    && stall.is_sound()
            }
            Search::Over => self.termination.is_some(),
        };
        require(search, "state of a method")?;
        let counts = [self.epoch, self.epoch_of_method, self.evaluations_before, self.last.evaluations];
        let steps = self.plan.iter().map(|step| step.1);
        require(counts.into_iter().chain(steps).all(|count| count <= MOST_COUNTED), "counts of a run")?;
        require(self.start < frame.options.starts, "number of a start")?;
        let Point { parameters, output, objective, mean_square } = &self.best;
        let is_point = frame.are_parameters(parameters)
            && Network::new(*frame.architecture, parameters.clone(), output.clone()).is_ok()
            && are_finite(&[*objective, *mean_square])
            && *mean_square >= 0.0;
        require(is_point, "best point of a run")?;
        // Infinite before the first epoch.
        let point = |point: &HistoryPoint| point.train_nrmse_percent >= 0.0 && point.epoch <= MOST_COUNTED;
        require(point(&self.last), "last point of a run")?;
        let errors = self.runs.iter().filter_map(|run| run.validation_nrmse_percent);
        require(errors.into_iter().all(|error| error >= 0.0), "error of a run on new data")?;
        let histories = self.runs.iter().all(|run| !run.history.is_empty() && run.history.iter().all(point));
        require(!self.runs.is_empty() && self.runs.len() <= 2 && histories, "history of a run")
    }

    /// One epoch of the present method. False, and nothing done, if that epoch found no way on.
    pub fn advance(&mut self, objective: &Objective, options: &FitOptions) -> Result<bool> {
        let before = self.best.objective;
        let ended = match &mut self.search {
            Search::LevenbergMarquardt(search) => {
                let ended = search.advance(objective);
                let value = search.value(objective).clone();
                self.best.take_if_lower(search.parameters(), &value);
                ended
            }
            Search::Genetic { search, encoding, stall } => {
                search.advance(&problem(encoding, options, self.start, &cost(objective, encoding)));
                let best = search.best();
                if best.cost < self.best.objective {
                    self.best = point(objective, encoding.parameters(&best.genes));
                }
                stall.is_reached(self.best.objective).then_some(Termination::Stalled)
            }
            Search::Subgradient { search, stall } => {
                let mut function = NetworkFunction { objective, lowest: &mut self.best };
                let ended = search.advance(&mut function);
                ended.or_else(|| stall.is_reached(self.best.objective).then_some(Termination::Stalled))
            }
            Search::Over => return Ok(false),
        };
        let nothing_done =
            matches!(ended, Some(Termination::GradientVanished | Termination::NoFurtherImprovement))
                && self.best.objective == before;
        if !nothing_done {
            self.epoch += 1;
            self.epoch_of_method += 1;
            self.record();
        }
        self.end_method_if_over(objective, options, ended)?;
        Ok(!nothing_done)
    }

    /// Ends the present method if it is over, and begins the next.
    fn end_method_if_over(
        &mut self,
        objective: &Objective,
        options: &FitOptions,
        ended: Option<Termination>,
    ) -> Result<()> {
        let used = (self.epoch_of_method >= self.plan[0].1).then_some(Termination::EpochsUsed);
        let Some(termination) = ended.or(used) else { return Ok(()) };
        if self.plan.len() == 1 {
            self.end(termination);
            return Ok(());
        }
        self.close_history(termination);
        self.plan.remove(0);
        self.evaluations_before += self.search.evaluations();
        self.epoch_of_method = 0;
        let method = self.plan[0].0;
        (self.search, self.best) = begin(method, objective, options, self.best.parameters.clone())?;
        self.open_history();
        self.end_method_if_over(objective, options, None)
    }

    fn open_history(&mut self) {
        self.runs.push(Run {
            phase: self.phase,
            start: self.start,
            method: self.plan[0].0,
            history: Vec::new(),
            termination: Termination::EpochsUsed,
            fold: None,
            validation_nrmse_percent: None,
        });
        self.record();
    }

    fn record(&mut self) {
        self.last = HistoryPoint {
            epoch: self.epoch,
            evaluations: self.evaluations(),
            train_nrmse_percent: 100.0 * self.best.mean_square.sqrt(),
        };
        let history = &mut self.runs.last_mut().expect("a history is open").history;
        let fell = history
            .last()
            .is_none_or(|kept| self.last.train_nrmse_percent < (1.0 - FALL_KEPT) * kept.train_nrmse_percent);
        if fell || history.len() < POINTS_KEPT {
            history.push(self.last);
        }
    }

    fn close_history(&mut self, termination: Termination) {
        let run = self.runs.last_mut().expect("a history is open");
        run.termination = termination;
        if run.history.last() != Some(&self.last) {
            run.history.push(self.last);
        }
    }

    /// Ends the run where it is, after a stop.
    pub fn stop(&mut self) {
        if self.termination.is_none() {
            self.end(Termination::Stopped);
        }
    }

    fn end(&mut self, termination: Termination) {
        self.close_history(termination);
        self.evaluations_before += self.search.evaluations();
        self.search = Search::Over;
        self.termination = Some(termination);
    }

    /// Takes down the error on what was held out of the fold it was trained on.
    pub fn validated(&mut self, fold: usize, error_percent: Option<f64>) {
        self.runs.iter_mut().for_each(|run| run.fold = Some(fold));
        let last = self.runs.last_mut().expect("every run has a history");
        last.validation_nrmse_percent = error_percent;
    }

    /// Appends the epochs of a run that went on from where this one ended.
    pub fn append(&mut self, next: TrainingRun) {
        let (epoch, evaluations) = (self.epoch, self.evaluations());
        let later = next.runs.iter().flat_map(|run| run.history.iter().skip(1)).map(|point| HistoryPoint {
            epoch: epoch + point.epoch,
            evaluations: evaluations + point.evaluations,
            ..*point
        });
        let run = self.runs.last_mut().expect("every run has a history");
        run.history.extend(later);
        run.termination = next.termination();
        self.evaluations_before += next.evaluations();
        self.epoch += next.epoch;
        self.best = next.best;
        self.termination = next.termination;
    }

    pub fn start(&self) -> usize {
        self.start
    }

    /// The method that did the last epoch.
    pub fn method_of_last_epoch(&self) -> Method {
        let done = self.runs.iter().rev().find(|run| run.history.len() > 1);
        done.map_or(self.plan[0].0, |run| run.method)
    }

    /// Epochs done by all methods.
    pub fn epoch(&self) -> usize {
        self.epoch
    }

    pub fn best(&self) -> &Point {
        &self.best
    }

    /// The objective at the best point.
    pub fn objective(&self) -> f64 {
        self.best.objective
    }

    pub fn last(&self) -> HistoryPoint {
        self.last
    }

    pub fn is_over(&self) -> bool {
        self.termination.is_some()
    }

    /// Why it ended; a run that could have gone on was stopped.
    pub fn termination(&self) -> Termination {
        self.termination.unwrap_or(Termination::Stopped)
    }

    /// History of each method.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Evaluations of the objective, gradients included.
    pub fn evaluations(&self) -> usize {
        self.evaluations_before + self.search.evaluations()
    }

    /// The network at the best point, its output weights by least squares on the rows it was trained on.
    pub fn network_as_trained(&self, architecture: Architecture) -> Result<Network> {
        Network::new(architecture, self.best.parameters.clone(), self.best.output.clone())
    }

    /// The network at the best point, its output weights by least squares on the objective's rows.
    pub fn network(&self, objective: &Objective) -> Result<Network> {
        let value = objective.value(&self.best.parameters);
        Network::new(*objective.architecture(), self.best.parameters.clone(), value.output_weights().to_vec())
    }
}

impl Search {
    fn evaluations(&self) -> usize {
        match self {
            Search::LevenbergMarquardt(search) => search.evaluations(),
            Search::Genetic { search, .. } => search.evaluations(),
            // A gradient is an evaluation of its own.
            Search::Subgradient { search, .. } => 2 * search.best().evaluations,
            Search::Over => 0,
        }
    }
}

impl Point {
    fn of(parameters: Vec<f64>, value: &ObjectiveValue) -> Self {
        let (objective, mean_square) = (value.objective, value.mean_square);
        Self { parameters, output: value.output_weights().to_vec(), objective, mean_square }
    }

    fn take_if_lower(&mut self, parameters: &[f64], value: &ObjectiveValue) {
        if value.objective < self.objective {
            *self = Self::of(parameters.to_vec(), value);
        }
    }
}

fn point(objective: &Objective, parameters: Vec<f64>) -> Point {
    let value = objective.value(&parameters);
    Point::of(parameters, &value)
}

fn cost<'a>(objective: &'a Objective, encoding: &'a Encoding) -> impl Fn(&[f64]) -> f64 + Sync + 'a {
    |genes| objective.value(&encoding.parameters(genes)).objective
}

fn problem<'a>(
    encoding: &'a Encoding,
    options: &FitOptions,
    start: usize,
    cost: &'a (dyn Fn(&[f64]) -> f64 + Sync),
) -> genetic::BoundedProblem<'a> {
    genetic::BoundedProblem {
        bounds: encoding.bounds(),
        seed: mix(options.seed).wrapping_add(start as u64),
        cost,
    }
}

fn begin_genetic(objective: &Objective, options: &FitOptions, start: usize) -> Result<(Search, Point)> {
    let encoding = Encoding::new(objective);
    let draw = |generator: &mut Xoshiro256PlusPlus| encoding.draw(generator);
    let search = {
        let cost = cost(objective, &encoding);
        Genetic::new(&problem(&encoding, options, start, &cost), options.population, &draw)?
    };
    let best = point(objective, encoding.parameters(&search.best().genes));
    let stall = Stall::new(best.objective, options.stall);
    Ok((Search::Genetic { search, encoding, stall }, best))
}

fn begin(
    method: Method,
    objective: &Objective,
    options: &FitOptions,
    parameters: Vec<f64>,
) -> Result<(Search, Point)> {
    if method == Method::LevenbergMarquardt {
        let mut search = LevenbergMarquardt::new(objective, parameters.clone());
        let best = Point::of(parameters, search.value(objective));
        return Ok((Search::LevenbergMarquardt(search), best));
    }
    // The search evaluates its beginning, which is the lowest point so far.
    let mut best = Point {
        parameters: parameters.clone(),
        output: Vec::new(),
        objective: f64::INFINITY,
        mean_square: f64::INFINITY,
    };
    let scales = scales(objective.layout(), &parameters);
    let mut function = NetworkFunction { objective, lowest: &mut best };
    let search = SpaceDilatation::new(parameters, scales, DilatationOptions::default(), &mut function)?;
    let stall = Stall::new(best.objective, options.stall);
    Ok((Search::Subgradient { search, stall }, best))
}

/// Typical lengths of the parameters: a weight's own magnitude, but no less than a tenth.
fn scales(layout: &ParameterLayout, parameters: &[f64]) -> Vec<f64> {
    let scale = |(index, value): (usize, &f64)| match layout.is_weight(index) {
        true => value.abs().max(0.1),
        false => 1.0,
    };
    parameters.iter().enumerate().map(scale).collect()
}

/// The objective as a function of all space: beyond their bounds the parameters are taken at them.
struct NetworkFunction<'a, 'o> {
    objective: &'a Objective<'o>,
    lowest: &'a mut Point,
}

impl Subdifferentiable for NetworkFunction<'_, '_> {
    fn evaluate(&mut self, x: &[f64], subgradient: &mut [f64]) -> f64 {
        let mut parameters = x.to_vec();
        self.objective.layout().clamp(&mut parameters);
        let value = self.objective.value(&parameters);
        subgradient.copy_from_slice(&self.objective.gradient(&parameters, &value));
        for ((g, x), clamped) in subgradient.iter_mut().zip(x).zip(&parameters) {
            if x != clamped {
                *g = 0.0;
            }
        }
        self.lowest.take_if_lower(&parameters, &value);
        value.objective
    }
}
