//! The inverse of a model: from the wanted output, the input that gives it.
//!
//! Each step searches the input whose trial output is the wanted one, from the state that the model has reached, and
//! commits it. So the inverse has the memory of the model, its rate and its wear. Every model has such an inverse where
//! its output depends on the next input without gap; the result says where it does not.

mod search;

use crate::error::{InverseError, Result, SampleError};
use crate::model::inverse::search::{Ending, Found, Point, Wanted};
use crate::model::{Model, Stepper};

/// Deviation at which the search of an input ends, as a share of the trained range of the output.
const TOLERANCE: f64 = 1e-12;

/// Largest number of model steps for a step of the inverse.
pub const MOST_TRIALS: usize =
    2 + search::MOST_STRIDES + search::SCANNED + search::GOLDEN + 3 * search::MOST_HALVINGS + 1;

/// Whether an output was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// The model has the wanted output.
    Reached,
    /// The wanted output is beyond that of the lowest input.
    LowLimit,
    /// The wanted output is beyond that of the highest input.
    HighLimit,
    /// The input cannot change so quickly.
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
}

/// A step of the inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inverted {
    /// The first input, in its unit.
    pub input: f64,
    /// The output of the model at this input, in its unit. It is the wanted one, or the nearest.
    pub output: f64,
    /// Whether it is the wanted one.
    pub reach: Reach,
    /// Steps of the model that the search needed, at most [`MOST_TRIALS`].
    pub trials: usize,
}

/// The inverse of a model, sample by sample: see [`Model::inverse`].
#[derive(Debug, Clone)]
pub struct Inverse<'m> {
    stepper: Stepper<'m>,
    limits: (f64, f64),
    /// Largest change of the input per unit of time, or per sample for a model without time.
    slew: Option<f64>,
    tolerance: f64,
    /// The last sample.
    last: Option<(Point, f64)>,
    /// Slope of the output by the input, as last seen.
    slope: f64,
    /// Inputs of a trial.
    inputs: Vec<f64>,
}

impl<'m> Inverse<'m> {
    pub(super) fn new(stepper: Stepper<'m>) -> Self {
        let ranges = stepper.model().trained_ranges();
        let (low, high) = ranges.output;
        Self {
            limits: ranges.inputs[0],
            slew: None,
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

    /// The same with the arithmetic that every machine has: see [`Stepper::portable`].
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.stepper = self.stepper.portable();
        self
    }

    /// The deviation of an output at which a search ends, in the unit of the output.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Advances to the next sample, at which the model has the output `wanted`, in its unit, if that can be.
    ///
    /// `others` are the further inputs of the model, in their units. `time` is that of the sample; a model without rate
    /// ignores it, unless there is a slew limit. A rate is the backward difference of the inputs that the inverse gives.
    ///
    /// A step needs at most [`MOST_TRIALS`] steps of the model; in our tests, 1 to 7 on average where the model is
    /// monotone.
    ///
    /// # Errors
    /// A value that is not finite, another number of inputs, or time that does not increase. The state is then
    /// unchanged.
    pub fn step(&mut self, wanted: f64, others: &[f64], time: f64) -> Result<Inverted> {
        if !wanted.is_finite() {
            return Err(SampleError::NotFinite(wanted).into());
        }
        let (window, is_slew) = self.window(time)?;
        let wanted = Wanted { value: wanted, tolerance: self.tolerance, window };
        let first = self.guess(wanted.value);
        self.inputs.clear();
        self.inputs.push(first);
        self.inputs.extend(others);
        let (stepper, inputs) = (&mut self.stepper, &mut self.inputs);
        let (mut last_trial, mut trials) = (f64::NAN, 0);
        let mut output = |input: f64| {
            last_trial = input;
            trials += 1;
            inputs[0] = input;
            stepper.trial(inputs, time, None)
        };
        let searched = (|| {
            if self.slope.is_nan() || self.slope == 0.0 {
                let (low, high) = window;
                self.slope = (output(high)? - output(low)?) / (high - low);
            }
            wanted.search(first, self.slope, &mut output)
        })();
        let Found { point: Point { argument: input, value: output }, ending, slope } = match searched {
            Ok(found) => found,
            Err(error) => {
                self.stepper.revert();
                return Err(error);
            }
        };
        if last_trial != input {
            self.inputs[0] = input;
            trials += 1;
            self.stepper.trial(&self.inputs, time, None)?;
        }
        self.stepper.commit();
        // A slope of the other sign is that of a place where the model is not monotone.
        if let Some(slope) = slope.filter(|slope| slope * self.slope > 0.0 && slope.is_finite()) {
            self.slope = slope;
        }
        self.last = Some((Point { argument: input, value: output }, time));
        let at_low = input == self.limits.0;
        let at_high = input == self.limits.1;
        let reach = match ending {
            Ending::Reached => Reach::Reached,
            Ending::Low if at_low || !is_slew => Reach::LowLimit,
            Ending::High if at_high || !is_slew => Reach::HighLimit,
            Ending::Low | Ending::High => Reach::Slew,
            Ending::Extremum => Reach::NotMonotone,
            Ending::Jump => Reach::Jump,
        };
        Ok(Inverted { input, output, reach, trials })
    }

    /// Returns to the initial state of the model.
    pub fn reset(&mut self) {
        self.stepper.reset();
        self.last = None;
        self.slope = f64::NAN;
    }

    /// Inputs that the next sample may have, and whether the slew limit is among what bounds them.
    fn window(&self, time: f64) -> Result<((f64, f64), bool)> {
        let (low, high) = self.limits;
        let (Some(slew), Some((Point { argument, .. }, before))) = (self.slew, self.last) else {
            return Ok(((low, high), false));
        };
        let elapsed = time - before;
        if !(elapsed > 0.0 && elapsed.is_finite()) {
            return Err(SampleError::Time(time).into());
        }
        let way = slew * elapsed;
        let window = ((argument - way).max(low), (argument + way).min(high));
        Ok((window, true))
    }

    /// The input from which a search begins.
    fn guess(&self, wanted: f64) -> f64 {
        match self.last {
            Some((Point { argument, value }, _)) => {
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
