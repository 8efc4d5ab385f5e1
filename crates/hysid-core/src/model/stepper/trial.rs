//! Trial steps, for solvers that iterate.

use crate::data::record::MemberState;
use crate::error::Result;
use crate::model::Predictor;
use crate::model::stepper::{Snapshot, Stepper, StepperMemory};

/// Length of the difference quotient of a tangent, as a share of the trained range of the first input.
const SHARE: f64 = 1e-6;

impl Stepper<'_> {
    /// The output at a sample from the committed state, which stays as it is. It may be called any number of times;
    /// [`Stepper::commit`] accepts the last one. The arguments are those of [`Stepper::step`].
    ///
    /// # Errors
    /// As [`Stepper::step`].
    pub fn trial(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        self.begin_trial();
        self.advance(inputs, time, rate)
    }

    /// As [`Stepper::trial`], and the slope `dy/dx` of the output by the first input, in the unit of the output divided
    /// by that of the input.
    ///
    /// It is a difference quotient of second order over a millionth of the trained range, in the direction in which the
    /// input moves: exact to rounding where the output is a straight line or a parabola, otherwise to about nine digits.
    /// At a kink it is that of the branch which continues. Where the model forms the rate from the inputs, the slope
    /// includes what changes with the rate.
    pub fn trial_with_tangent(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<(f64, f64)> {
        self.begin_trial();
        let before = self.committed.as_ref().and_then(Snapshot::last_input);
        let (low, high) = self.model.trained_ranges().inputs[0];
        let goes_down = before.is_some_and(|before| inputs[0] < before);
        let scale = SHARE * (high - low).max(f64::MIN_POSITIVE);
        let by = if goes_down { -scale } else { scale };
        let mut displaced = inputs.to_vec();
        // What the numbers really differ by.
        let mut at = |stepper: &mut Self, times: f64| -> Result<(f64, f64)> {
            displaced[0] = inputs[0] + times * by;
            stepper.begin_trial();
            Ok((displaced[0] - inputs[0], stepper.advance(&displaced, time, rate)?))
        };
        let ((h_1, y_1), (h_2, y_2)) = (at(self, 1.0)?, at(self, 2.0)?);
        let y = self.trial(inputs, time, rate)?;
        let (slope_1, slope_2) = ((y_1 - y) / h_1, (y_2 - y) / h_2);
        Ok((y, slope_1 + (slope_1 - slope_2) * h_1 / (h_2 - h_1)))
    }

    /// The first input at which the next output is `output`, from the committed state, for a law with a closed inverse.
    pub(in crate::model) fn input_for(&mut self, output: f64) -> Option<f64> {
        self.revert();
        let (Predictor::Law(law), StepperMemory::Law(state)) = (&self.model.body, &self.state.memory) else {
            return None;
        };
        // The beginning comes with the first sample.
        let is_virgin = || self.beginning == [MemberState::Past(Vec::new())];
        let is_begun = self.state.residual.is_none() && (self.state.last.is_some() || is_virgin());
        let seen = law.input_for(state, output).filter(|_| is_begun)?;
        Some(self.model.preprocessing.original(seen)).filter(|input| input.is_finite())
    }

    /// Makes the state of the last trial the committed one. Without a trial, nothing changes.
    pub fn commit(&mut self) {
        self.committed = None;
    }

    /// Forgets the last trial.
    pub fn revert(&mut self) {
        if let Some(committed) = self.committed.take() {
            committed.restore(&mut self.state);
        }
    }

    /// The committed state, to return to.
    pub fn snapshot(&self) -> Snapshot {
        self.committed.clone().unwrap_or_else(|| Snapshot::of(&self.state))
    }

    /// Returns to a state of the same model.
    ///
    /// # Panics
    /// A snapshot of another model.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.committed = None;
        snapshot.restore(&mut self.state);
    }

    /// Goes to the committed state, and keeps it.
    fn begin_trial(&mut self) {
        match &self.committed {
            Some(committed) => committed.restore(&mut self.state),
            None => self.committed = Some(Snapshot::of(&self.state)),
        }
    }
}
