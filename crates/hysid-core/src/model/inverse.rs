//! The inverse of a model: from the wanted output, the input that gives it.
//!
//! Each step searches for the input whose trial output is the wanted one, from the state that the model has reached, and
//! commits it. So the inverse has the memory of the model, its rate and its wear. Every model has such an inverse where
//! its output depends on the next input without gap; the result says where it does not. Laws with a closed inverse
//! propose the input, and a single trial confirms it.
//!
//! A model whose output lags behind the input has no such inverse at short time steps: within one step the output hardly
//! follows the input, or falls while the input rises. With a [preview](Inverse::preview) the search looks further ahead
//! than one step.

mod record;
mod search;

use crate::error::{Error, InverseError, Result, SampleError};
use crate::model::inverse::search::{SearchEnding, SearchPoint, SearchResult, TargetValue};
use crate::model::ranges::with_slack;
use crate::model::{BandLevel, Model, Stepper};

pub use record::{Inversion, Reference};

/// Deviation at which the search of an input ends, as a share of the trained range of the output.
const TOLERANCE: f64 = 1e-12;

/// Largest number of model steps for a step of the inverse. A band needs two more searches.
pub const MOST_TRIALS: usize = 2 + 2 * search::MOST_VALUES + 2;

/// Whether an output was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// The model has the wanted output.
    Reached,
    /// The wanted output is beyond that of the lowest input.
    LowLimit,
    /// The wanted output is beyond that of the highest input.
    HighLimit,
    /// The slew limit, or the largest trained rate, does not allow the wanted output.
    Slew,
    /// No input within the limits has the output, and the nearest is between them: the model is not monotone.
    NotMonotone,
    /// The output jumps over the wanted one.
    Jump,
}

impl Reach {
    /// All values.
    pub const ALL: [Self; 6] =
        [Self::Reached, Self::LowLimit, Self::HighLimit, Self::Slew, Self::NotMonotone, Self::Jump];

    /// A word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::LowLimit => "low-limit",
            Self::HighLimit => "high-limit",
            Self::Slew => "slew",
            Self::NotMonotone => "not-monotone",
            Self::Jump => "jump",
        }
    }

    /// True if the nearest input was at a limit, or at the largest change that is allowed.
    pub fn is_at_a_bound(self) -> bool {
        matches!(self, Self::LowLimit | Self::HighLimit | Self::Slew)
    }
}

/// A step of the inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inverted {
    /// The first input, in its unit.
    pub input: f64,
    /// The output of the model at this input, in its unit.
    pub output: f64,
    /// Whether the wanted output was reached: at this sample, or with a preview by its end.
    pub reach: Reach,
    /// True if the input, or its rate for a model with a rate, is outside the range of the training data.
    pub is_extrapolated: bool,
    /// Lowest and highest input whose band contains the wanted output; `None` without [`Inverse::band`].
    pub band: Option<(f64, f64)>,
    /// Steps of the model that the search needed, at most [`MOST_TRIALS`] without a band.
    pub trials: usize,
}

/// The inverse of a model, sample by sample: see [`Model::inverse`].
#[derive(Debug, Clone)]
pub struct Inverse<'m> {
    stepper: Stepper<'m>,
    limits: (f64, f64),
    /// Largest change of the input per unit of time.
    slew: Option<f64>,
    /// Largest rate of the training data, for a model with a rate.
    trained_rate: Option<f64>,
    /// Time from a sample to the wanted output that it is given.
    preview: f64,
    band: Option<BandLevel>,
    /// Closed inverses are not used.
    is_search: bool,
    tolerance: f64,
    /// The last sample, and its time.
    last: Option<(SearchPoint, f64)>,
    /// Slope of the output by the input, as last seen.
    slope: f64,
    /// Inputs of a trial.
    inputs: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
struct Windows {
    /// Those that are reached at trained rates.
    trained: (f64, f64),
    /// Those within the limits and the slew limit.
    all: (f64, f64),
    /// Whether a rate is among what bounds them.
    is_of_rate: bool,
}

impl<'m> Inverse<'m> {
    pub(super) fn new(stepper: Stepper<'m>) -> Self {
        let ranges = stepper.model().trained_ranges();
        let (low, high) = ranges.output;
        Self {
            limits: ranges.inputs[0],
            slew: None,
            trained_rate: ranges
                .rate
                .map(|(low, high)| low.abs().max(high.abs()))
                .filter(|rate| *rate > 0.0 && rate.is_finite()),
            preview: 0.0,
            is_search: false,
            band: None,
            tolerance: TOLERANCE * (high - low),
            last: None,
            slope: f64::NAN,
            inputs: Vec::new(),
            stepper,
        }
    }

    /// Other limits of the input, in its unit, in place of the trained range.
    ///
    /// # Errors
    /// Limits that are not finite, or a low one that is not below the high one.
    pub fn limits(mut self, low: f64, high: f64) -> Result<Self> {
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(InverseError::Limits(low, high).into());
        }
        self.limits = (low, high);
        Ok(self)
    }

    /// The largest change of the input in a unit of time. The first sample is free.
    ///
    /// # Errors
    /// A rate that is not positive and finite.
    pub fn slew(mut self, rate: f64) -> Result<Self> {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(InverseError::Slew(rate).into());
        }
        self.slew = Some(rate);
        Ok(self)
    }

    /// Sets the preview: from the second sample on, the wanted output that is given to a step is that at `time + preview`.
    ///
    /// The search then finds the straight path of the input, from the last sample on, that leads to the wanted output at
    /// the end of the preview. The sample takes the first part of this path, and the next sample searches anew. 0 stands
    /// for no preview.
    ///
    /// # Errors
    /// A time that is negative or not finite.
    pub fn preview(mut self, time: f64) -> Result<Self> {
        if !(time.is_finite() && time >= 0.0) {
            return Err(InverseError::Preview(time).into());
        }
        self.preview = time;
        Ok(self)
    }

    /// Also gives the inputs whose prediction band contains the wanted output.
    ///
    /// # Errors
    /// A model without a band, or a level that no band is calibrated for.
    pub fn band(mut self, level: BandLevel) -> Result<Self> {
        level.check()?;
        if self.stepper.model().band().is_none() {
            return Err(Error::NoBand(self.stepper.model().name().name()));
        }
        self.band = Some(level);
        Ok(self)
    }

    /// The same without closed inverses: every step searches, as in exports.
    #[must_use]
    pub fn by_search(mut self) -> Self {
        self.is_search = true;
        self
    }

    /// The model that is inverted.
    pub fn model(&self) -> &Model {
        self.stepper.model()
    }

    /// True if samples need a time: for the memory or the rate of the model, the slew limit, or the preview.
    pub fn needs_time(&self) -> bool {
        self.sees_time() || self.slew.is_some() || self.preview > 0.0
    }

    fn sees_time(&self) -> bool {
        self.model().needs_time() || self.model().rate().is_some()
    }

    /// Largest rate of the training data, for a model with a rate.
    pub fn trained_rate(&self) -> Option<f64> {
        self.trained_rate
    }

    /// The deviation of an output at which a search ends, in the unit of the output.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Searches for the input of the next sample, and commits it. `wanted` is the output at `time`, or with a preview, from
    /// the second sample on, at `time + preview`, in its unit.
    ///
    /// Inputs that are reached at trained rates are searched first, for a model with a rate, then all others.
    ///
    /// `others` are the further inputs of the model, in their units. `time` is that of the sample; a model without
    /// rate and relaxation ignores it, unless there is a slew limit or a preview. A rate is the backward difference of the inputs that the
    /// inverse gives.
    ///
    /// A step needs at most [`MOST_TRIALS`] steps of the model; in our tests, 1 to 7 on average where the model is
    /// monotone.
    ///
    /// # Errors
    /// A value that is not finite, another number of inputs, or time that does not increase. The state is then
    /// unchanged.
    pub fn step(&mut self, wanted: f64, others: &[f64], time: f64) -> Result<Inverted> {
        if !wanted.is_finite() {
            return Err(SampleError::Wanted(wanted).into());
        }
        let elapsed = self.elapsed(time)?;
        // The first sample has no path that leads to it.
        let ahead = if elapsed.is_some() { self.preview } else { 0.0 };
        let windows = self.windows(elapsed.map(|elapsed| elapsed + ahead));
        self.inputs.clear();
        self.inputs.push(0.0);
        self.inputs.extend(others);
        let inverted = self.search(wanted, windows, time, ahead);
        if inverted.is_err() {
            self.stepper.revert();
        }
        inverted
    }

    fn search(&mut self, value: f64, windows: Windows, time: f64, ahead: f64) -> Result<Inverted> {
        let wanted = |window| TargetValue { value, tolerance: self.tolerance, window };
        let (trained, all) = (wanted(windows.trained), wanted(windows.all));
        let mut trials = 0;
        let first = self.guess(value, ahead);
        if self.slope.is_nan() || self.slope == 0.0 {
            let (low, high) = windows.trained;
            let at_high = self.trial(high, time + ahead)?;
            self.slope = (at_high - self.trial(low, time + ahead)?) / (high - low);
            trials += 2;
        }
        let band = match self.band {
            Some(level) => {
                let (low, high) = self.edges(all, first, level, time + ahead, &mut trials)?;
                Some((self.part_of_way(low, time, ahead), self.part_of_way(high, time, ahead)))
            }
            None => None,
        };
        let before = self.last;
        let (SearchResult { mut point, mut ending, mut slope }, mut last_trial) =
            self.find(trained, first, time + ahead, &mut trials, |_| Ok(0.0))?;
        if ending.is_beside() && windows.trained != windows.all {
            let (wider, trial) = self.find(all, first, time + ahead, &mut trials, |_| Ok(0.0))?;
            (point, ending, slope, last_trial) = (wider.point, wider.ending, wider.slope, trial);
        }
        if ending.is_beside() && windows.is_of_rate {
            let (end, side) = self.towards(value, windows.trained);
            point = SearchPoint { argument: end, value: self.trial(end, time + ahead)? };
            last_trial = end;
            trials += 1;
            ending = if ending == SearchEnding::Extremum { ending } else { side };
        }
        let (input, mut output) = (self.part_of_way(point.argument, time, ahead), point.value);
        if ahead > 0.0 || last_trial != input {
            output = self.trial(input, time)?;
            trials += 1;
        }
        self.stepper.commit();
        // A slope of the other sign is that of a place where the model is not monotone.
        if let Some(slope) = slope.filter(|slope| slope * self.slope > 0.0 && slope.is_finite()) {
            self.slope = slope;
        }
        self.last = Some((SearchPoint { argument: input, value: output }, time));
        Ok(Inverted {
            input,
            output,
            reach: self.reach(ending, point.argument, windows),
            is_extrapolated: self.is_extrapolated(input, time, before),
            band,
            trials,
        })
    }

    /// The input at which the output and what is added to it is the wanted one, and the last trial.
    fn find(
        &mut self,
        wanted: TargetValue,
        first: f64,
        time: f64,
        trials: &mut usize,
        added: impl Fn(&mut Stepper<'m>) -> Result<f64>,
    ) -> Result<(SearchResult, f64)> {
        let mut last_trial = f64::NAN;
        let (stepper, inputs) = (&mut self.stepper, &mut self.inputs);
        let mut output = |input: f64| -> Result<f64> {
            last_trial = input;
            *trials += 1;
            inputs[0] = input;
            let output = stepper.trial(inputs, time, None)?;
            Ok(output + added(stepper)?)
        };
        let found = wanted.search(first, self.slope, &mut output)?;
        Ok((found, last_trial))
    }

    /// The inputs at which either edge of the prediction band has the wanted output.
    fn edges(
        &mut self,
        wanted: TargetValue,
        first: f64,
        level: BandLevel,
        time: f64,
        trials: &mut usize,
    ) -> Result<(f64, f64)> {
        let mut edge = |sign: f64| -> Result<f64> {
            let half_width = |stepper: &mut Stepper<'m>| Ok(sign * stepper.half_width(level)?);
            Ok(self.find(wanted, first, time, trials, half_width)?.0.point.argument)
        };
        let (a, b) = (edge(1.0)?, edge(-1.0)?);
        Ok((a.min(b), a.max(b)))
    }

    /// The end of a window that leads to the wanted output by the slope over the whole range, past local extrema.
    fn towards(&self, wanted: f64, (low, high): (f64, f64)) -> (f64, SearchEnding) {
        let rises = self.last.is_none_or(|(last, _)| wanted > last.value);
        if rises == (self.slope > 0.0) { (high, SearchEnding::High) } else { (low, SearchEnding::Low) }
    }

    fn trial(&mut self, input: f64, time: f64) -> Result<f64> {
        self.inputs[0] = input;
        self.stepper.trial(&self.inputs, time, None)
    }

    /// The input at this time, on the way from the last sample to the input at the end of the preview.
    fn part_of_way(&self, end: f64, time: f64, ahead: f64) -> f64 {
        match self.last {
            Some((SearchPoint { argument, .. }, before)) if ahead > 0.0 => {
                argument + (end - argument) * ((time - before) / (time + ahead - before))
            }
            _ => end,
        }
    }

    fn reach(&self, ending: SearchEnding, input: f64, windows: Windows) -> Reach {
        let at_low = input == self.limits.0;
        let at_high = input == self.limits.1;
        match ending {
            SearchEnding::Reached => Reach::Reached,
            SearchEnding::Low if at_low || !windows.is_of_rate => Reach::LowLimit,
            SearchEnding::High if at_high || !windows.is_of_rate => Reach::HighLimit,
            SearchEnding::Low | SearchEnding::High => Reach::Slew,
            SearchEnding::Extremum => Reach::NotMonotone,
            SearchEnding::Jump => Reach::Jump,
        }
    }

    /// True for an input, or a rate of a model with one, outside the range of the training data.
    fn is_extrapolated(&self, input: f64, time: f64, before: Option<(SearchPoint, f64)>) -> bool {
        let is_outside = |value: f64, range: (f64, f64)| {
            let (low, high) = with_slack(range);
            value < low || value > high
        };
        let ranges = self.model().trained_ranges();
        let rate = before.map_or(0.0, |(last, before)| (input - last.argument) / (time - before));
        is_outside(input, ranges.inputs[0]) || ranges.rate.is_some_and(|range| is_outside(rate, range))
    }

    /// Returns to the initial state of the model.
    pub fn reset(&mut self) {
        self.stepper.reset();
        self.last = None;
        self.slope = f64::NAN;
    }

    /// Time since the last sample, if that is needed; `None` at the first.
    fn elapsed(&self, time: f64) -> Result<Option<f64>> {
        let is_needed = self.slew.is_some() || self.trained_rate.is_some() || self.preview > 0.0;
        if is_needed && !time.is_finite() {
            return Err(SampleError::NoTime { needed_by: "the model, its slew limit or its preview" }.into());
        }
        match self.last {
            Some((_, before)) if is_needed && time <= before => Err(SampleError::Time(time).into()),
            Some((_, before)) => Ok(Some(time - before)),
            None => Ok(None),
        }
    }

    fn windows(&self, elapsed: Option<f64>) -> Windows {
        let within = |rate: Option<f64>, (low, high): (f64, f64)| match (rate, self.last, elapsed) {
            (Some(rate), Some((SearchPoint { argument, .. }, _)), Some(elapsed)) => {
                let way = rate * elapsed;
                ((argument - way).max(low), (argument + way).min(high))
            }
            _ => (low, high),
        };
        let all = within(self.slew, self.limits);
        let trained = within(self.trained_rate, all);
        Windows { trained, all, is_of_rate: trained != self.limits }
    }

    /// The input from which a search begins.
    fn guess(&mut self, wanted: f64, ahead: f64) -> f64 {
        if ahead == 0.0
            && !self.is_search
            && let Some(input) = self.stepper.input_for(wanted)
        {
            return input;
        }
        match self.last {
            Some((SearchPoint { argument, value }, _)) => {
                let guess = argument + (wanted - value) / self.slope;
                if guess.is_finite() { guess } else { argument }
            }
            None => 0.5 * (self.limits.0 + self.limits.1),
        }
    }
}

impl Model {
    /// The inverse of the model, which gives the input for a wanted output, sample by sample. It begins in the initial
    /// state of the model, and the input stays within the trained range unless [`Inverse::limits`] says otherwise.
    ///
    /// ```
    /// # use hysid_core::model::Model;
    /// # fn inverse(model: &Model) -> hysid_core::error::Result<()> {
    /// let mut inverse = model.inverse();
    /// let displacement = 3.0;
    /// let voltage = inverse.step(displacement, &[], 0.01)?.input;
    /// # Ok(())
    /// # }
    /// ```
    pub fn inverse(&self) -> Inverse<'_> {
        Inverse::new(self.stepper())
    }

    /// As [`Model::inverse`]; the inverse owns the model.
    pub fn into_inverse(self) -> Inverse<'static> {
        Inverse::new(self.into_stepper())
    }
}
