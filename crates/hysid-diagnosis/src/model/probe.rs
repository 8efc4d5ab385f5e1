//! Driving a model: paths of its input within the range that it was trained on, at speeds within the trained
//! rates, theory.md (10.30).

use serde::Serialize;

use hysid_core::data::rate::RateMethod;
use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::exp;
use hysid_core::error::{Error, Result};
use hysid_core::model::{Model, Predictor};
use hysid_core::network::ParameterLayout;

/// Rows from the middle of the range to its end. Every tenth of the way falls on a row, and a branch over the
/// whole range has few enough rows that none are averaged.
pub(super) const STEPS: u32 = 160;

/// Rows of a model whose steps need much work: the first number with which the paths stay below [`MOST_WORK`], or the last.
/// Tenths of the way fall on rows of all.
const FEWER_STEPS: [u32; 4] = [80, 40, 20, 10];

/// Operations that the paths of a diagnosis may need, some seconds, and rows of all paths with [`STEPS`].
const MOST_WORK: f64 = 3e9;
const ROWS: f64 = 60_000.0;

/// A vanishing speed, as a share of the fastest.
const VANISHING: f64 = 1e-6;

/// Ratio of the fastest speed to the middle one.
const FASTEST: f64 = 3.0;

/// Speeds that a model is driven at, as shares of the middle one.
const TRIED: [f64; 4] = [0.1, 0.3, 1.0, FASTEST];

/// Trained rates to one side that are below this share of those to the other side set no limit.
const ONE_SIDED: f64 = 0.1;

/// Where the speeds of probing come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeScale {
    /// The rates of training, of which the largest is the fastest speed.
    TrainedRates,
    /// The median of the relaxation times: the middle speed passes half the range in it. No rates are
    /// stored.
    RelaxationTimes,
    /// None: the model uses neither rate nor time.
    None,
}

/// Drives of a model: ranges, speeds and rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Probing {
    /// Smallest and largest input, in its unit: the trained range.
    pub input: (f64, f64),
    /// Values at which the further inputs were held: the middle of their trained ranges.
    pub held: Vec<f64>,
    /// Where the speeds come from.
    pub time_scale: TimeScale,
    /// Speed of all probes that do not test the rate, next to 0, in the unit of the input over that of time.
    pub vanishing_speed: f64,
    /// Speeds of those that do.
    pub speeds: Vec<f64>,
    /// Rows from the middle of the range to its end: 160, or fewer of a model whose rows need much work.
    pub steps: u32,
    /// Excursions of the drives beyond the trained ranges, in words, if there had to be any.
    pub outside: Option<String>,
}

impl Probing {
    /// Note on the rows, where they are fewer than usual.
    pub fn rows_in_words(&self) -> Option<String> {
        let steps = self.steps;
        (steps < STEPS).then(|| {
            format!(
                "{steps} in half the range instead of {STEPS}, because each row of this model needs much work"
            )
        })
    }
}

/// A way of the input through turning points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ProbePath {
    pub x: Vec<f64>,
    /// Row of each turning point, the first row and the last with them.
    pub turns: Vec<usize>,
}

/// A model with what it takes to drive it.
#[derive(Debug)]
pub(super) struct Probe<'m> {
    pub model: &'m Model,
    pub centre: f64,
    pub half: f64,
    pub speeds: ProbeSpeeds,
    /// Rows from the middle of the range to its end.
    pub steps: u32,
    held: Vec<f64>,
}

/// Speeds, in the unit of the input over that of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ProbeSpeeds {
    pub scale: TimeScale,
    pub vanishing: f64,
    pub middle: f64,
    /// Rates of one sign only were trained.
    one_sided: bool,
}

impl ProbeSpeeds {
    fn of(model: &Model, half: f64) -> Self {
        let rate = model.trained_ranges().rate.map(|(low, high)| {
            let (most, least) = (high.abs().max(low.abs()), high.min(-low));
            if least >= ONE_SIDED * most { (least, false) } else { (most, true) }
        });
        let (scale, fastest, one_sided) = match (rate, median_relaxation_time(model)) {
            (Some((fastest, one_sided)), _) if fastest > 0.0 => (TimeScale::TrainedRates, fastest, one_sided),
            (Some(_), _) => (TimeScale::TrainedRates, half, false),
            (None, Some(time)) => (TimeScale::RelaxationTimes, FASTEST * half / time, false),
            (None, None) => (TimeScale::None, half, false),
        };
        Self { scale, vanishing: VANISHING * fastest, middle: fastest / FASTEST, one_sided }
    }

    /// The slowest first.
    pub fn tried(&self) -> [f64; 4] {
        TRIED.map(|share| share * self.middle)
    }

    /// True if the model depends on the speed of the input.
    pub fn matter(&self) -> bool {
        self.scale != TimeScale::None
    }
}

/// `None` for a model without relaxation neurons; of an ensemble, of the first member that has any.
fn median_relaxation_time(model: &Model) -> Option<f64> {
    if let Some(ensemble) = model.ensemble() {
        return ensemble.members().iter().find_map(median_relaxation_time);
    }
    let Predictor::Network { network, .. } = model.predictor() else { return None };
    let ln_tau = &network.parameters()[ParameterLayout::new(*network.architecture()).ln_tau];
    if ln_tau.is_empty() {
        return None;
    }
    let mut sorted = ln_tau.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some(exp(sorted[sorted.len() / 2]))
}

impl<'m> Probe<'m> {
    pub fn new(model: &'m Model) -> Result<Self> {
        let ranges = &model.trained_ranges().inputs;
        let middle = |(low, high): &(f64, f64)| 0.5 * low + 0.5 * high;
        let (low, high) = ranges[0];
        let half = 0.5 * high - 0.5 * low;
        if !(half > 0.0 && half.is_finite()) {
            return Err(Error::Parts(format!(
                "the model was trained on inputs from {low} to {high}: there is no range to probe"
            )));
        }
        let speeds = ProbeSpeeds::of(model, half);
        Ok(Self {
            model,
            centre: middle(&ranges[0]),
            half,
            steps: steps(model, half, speeds.vanishing),
            speeds,
            held: ranges[1..].iter().map(middle).collect(),
        })
    }

    pub fn description(&self) -> Probing {
        Probing {
            input: (self.centre - self.half, self.centre + self.half),
            held: self.held.clone(),
            time_scale: self.speeds.scale,
            vanishing_speed: self.speeds.vanishing,
            speeds: if self.speeds.matter() { self.speeds.tried().to_vec() } else { Vec::new() },
            outside: self
                .speeds
                .one_sided
                .then(|| "only rates of one sign were trained: the probing also uses the other sign".into()),
            steps: self.steps,
        }
    }

    /// Where the model's memory is virgin, in the unit of the first input.
    pub fn origin(&self) -> f64 {
        origin(self.model)
    }

    /// All inputs of a sample: the first, and those that are held.
    pub fn inputs(&self, x: f64) -> Vec<f64> {
        [&[x], &self.held[..]].concat()
    }

    /// A path over the trained range: turning points from -1, its lower end, to 1, its upper end.
    pub fn path(&self, turning: &[f64]) -> ProbePath {
        path(self.centre, self.half, turning, self.steps)
    }

    /// Drives the model from its virgin state along a path at one speed. The record has the first input, time stamps
    /// and the model's output.
    pub fn run(&self, name: &str, x: &[f64], speed: f64) -> Result<Record> {
        let driven = self.record(name, x, &times(x, speed))?;
        let y = self.model.simulate(&driven)?;
        let time = driven.time().map(<[f64]>::to_vec).unwrap_or_default();
        Record::new(name, vec![x.to_vec()], y)?.with_time(time)
    }

    /// [`Probe::run`] at a vanishing speed, without the time stamps, which say nothing then.
    pub fn run_slowly(&self, name: &str, x: &[f64]) -> Result<Record> {
        let record = self.run(name, x, self.speeds.vanishing)?;
        Record::new(name, vec![x.to_vec()], record.output().to_vec())
    }

    /// Record that drives the model: all inputs, time, the rate where it has to be given. No output.
    pub fn record(&self, name: &str, x: &[f64], time: &[f64]) -> Result<Record> {
        let mut inputs = vec![x.to_vec()];
        inputs.extend(self.held.iter().map(|&value| vec![value; x.len()]));
        let record = Record::new(name, inputs, vec![f64::NAN; x.len()])?.with_time(time.to_vec())?;
        let record = record.with_lead_in(Vec::new())?;
        if self.model.rate() == Some(RateMethod::Given) {
            let rate = RateMethod::Central.rate(&record)?;
            return record.with_given_rate(rate);
        }
        Ok(record)
    }
}

/// Rows from the middle of the range to its end.
fn steps(model: &Model, half: f64, slowest: f64) -> u32 {
    let is_quick = |steps: &u32| {
        let travel = half / f64::from(*steps);
        let rows = ROWS * f64::from(*steps) / f64::from(STEPS);
        rows * model.work_of_row(travel, travel / slowest) <= MOST_WORK
    };
    let all = [STEPS].into_iter().chain(FEWER_STEPS);
    all.clone().find(is_quick).unwrap_or(FEWER_STEPS[FEWER_STEPS.len() - 1])
}

/// Where the memory of a model is virgin, in the unit of the first input; of an ensemble's members that do not
/// agree, 0.
fn origin(model: &Model) -> f64 {
    let Some(ensemble) = model.ensemble() else { return model.input_transform().origin(0) };
    let mut origins = ensemble.members().iter().map(origin);
    let first = origins.next().unwrap_or_default();
    if origins.all(|other| other == first) { first } else { 0.0 }
}

/// A path in equal steps, `steps` to each half of the range: equal places on different ways are equal numbers.
pub(super) fn path(centre: f64, half: f64, turning: &[f64], steps: u32) -> ProbePath {
    let place = |turning: f64| (turning * f64::from(steps)).round() as i64;
    let input = |place: i64| centre + half * (place as f64 / f64::from(steps));
    let mut here = place(turning[0]);
    let mut path = ProbePath { x: vec![input(here)], turns: vec![0] };
    for end in turning[1..].iter().map(|&turning| place(turning)) {
        while here != end {
            here += (end - here).signum();
            path.x.push(input(here));
        }
        path.turns.push(path.x.len() - 1);
    }
    path
}

/// Time stamps of a path at one speed.
pub(super) fn times(x: &[f64], speed: f64) -> Vec<f64> {
    let mut time = 0.0;
    let mut all = vec![0.0];
    all.extend(x.windows(2).map(|pair| {
        time += (pair[1] - pair[0]).abs() / speed;
        time
    }));
    all
}

/// Records of a model's first input and output as data.
pub(super) fn data(records: Vec<Record>) -> Result<Dataset> {
    Dataset::new(ColumnNames::plain(1), records)
}

pub(super) fn extent(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
}
