//! Memory of a stepper at one moment, without the weights of its networks.

use crate::data::record::FadingResidual;
use crate::law::ClassicalState;
use crate::model::ensemble::Excursion;
use crate::model::input_transform::InputPast;
use crate::model::stepper::tracking::Tracker;
use crate::model::stepper::{LastSample, StepperMemory, StepperState};
use crate::network::MemoryState;

/// The memory of a [`Stepper`](crate::model::Stepper) at one moment.
#[derive(Debug, Clone)]
pub struct Snapshot {
    memory: StoredMemory,
    past: InputPast,
    last: Option<LastSample>,
    excursion: Option<Excursion>,
    residual: Option<FadingResidual>,
    pub(super) tracker: Option<Box<Tracker>>,
}

#[derive(Debug, Clone)]
enum StoredMemory {
    Network(MemoryState),
    Law(Box<ClassicalState>),
    Ensemble(Vec<Snapshot>, Excursion),
}

impl Snapshot {
    pub(super) fn of(state: &StepperState) -> Self {
        let memory = match &state.memory {
            StepperMemory::Network(simulator, _) => StoredMemory::Network(simulator.state().clone()),
            StepperMemory::Law(law) => StoredMemory::Law(law.clone()),
            StepperMemory::Ensemble(ensemble) => {
                StoredMemory::Ensemble(ensemble.members.iter().map(Self::of).collect(), ensemble.excursion)
            }
        };
        Self {
            memory,
            past: state.past,
            last: state.last,
            excursion: state.excursion,
            residual: state.residual,
            tracker: state.tracker.clone(),
        }
    }

    /// Makes the state what it was; panics for a state of another model.
    pub(super) fn restore(&self, state: &mut StepperState) {
        match (&self.memory, &mut state.memory) {
            (StoredMemory::Network(kept), StepperMemory::Network(simulator, _)) => {
                simulator.set_state(kept.clone())
            }
            (StoredMemory::Law(kept), StepperMemory::Law(law)) => law.clone_from(kept),
            (StoredMemory::Ensemble(members, excursion), StepperMemory::Ensemble(ensemble)) => {
                assert_eq!(members.len(), ensemble.members.len(), "a snapshot of this model");
                members.iter().zip(&mut ensemble.members).for_each(|(kept, member)| kept.restore(member));
                ensemble.excursion = *excursion;
            }
            _ => panic!("a snapshot of this model"),
        }
        state.past = self.past;
        state.last = self.last;
        state.excursion = self.excursion;
        state.residual = self.residual;
        state.tracker.clone_from(&self.tracker);
    }

    /// The first input of the last sample; `None` before the first.
    pub(super) fn last_input(&self) -> Option<f64> {
        self.last.map(|last| last.input)
    }
}
