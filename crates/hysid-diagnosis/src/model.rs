//! What kind of hysteresis has a fitted model learnt? The properties of measured data, found by driving the
//! model with probes chosen for each, and what its equations and weights say beside that.
//!
//! A probe stays within the input range and the rates that the model was trained on; further inputs are held in
//! the middle of theirs. What is a property of memory is asked at a vanishing speed. Definitions: theory.md,
//! end of section 10.
//!
//! ```
//! use std::ops::ControlFlow;
//! use hysid_core::options::classical::ClassicalModel;
//! use hysid_diagnosis::{ModelDiagnosis, Property, Verdict};
//! use hysid_core::options::{ModelName, FitSpec};
//! use hysid::fit::identify;
//! use hysid_specimens::Specimen;
//! let data = Specimen::named("terfenol-actuator").unwrap().train();
//! let request = FitSpec::of(ModelName::Classical(ClassicalModel::PrandtlIshlinskii), None, 1);
//! let fitted = identify(&data, &request, &mut |_| ControlFlow::Continue(()))?;
//! let diagnosis = ModelDiagnosis::of(&fitted.model)?;
//! assert_eq!(diagnosis.verdict(Property::Masing), Verdict::Yes);
//! assert!(diagnosis.memory.return_point_memory.holds);
//! # Ok::<(), hysid_core::Error>(())
//! ```

mod bound;
mod certificate;
mod cycles;
mod direct;
mod invertibility;
mod loop_widths;
mod neurons;
mod probe;
mod properties;
mod structure;
#[cfg(test)]
mod tests;
mod weights;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::{Finding, Property, Verdict};
pub use certificate::{Basis, Bound, Claim, MemoryCertificate, Refinement};
pub use cycles::ModelCycles;
use hysid_core::error::Result;
use hysid_core::model::Model;
use hysid_core::options::ModelName;
pub use invertibility::{AtTimeStep, Direction, Invertibility, Place, PlaceKind, Scans};
pub use loop_widths::{LoopWidths, WidthAtSpeed};
pub use neurons::{Neuron, NeuronKind};
use probe::Probe;
pub use probe::{Probing, TimeScale};
pub use structure::StructuralProperty;
pub use weights::{Criterion, WeightDiagnosis};

/// Everything that can be said about the hysteresis of a fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelDiagnosis {
    /// Which model it is.
    pub model: ModelName,
    /// What it was driven with.
    pub probing: Probing,
    /// The properties, in the order of [`Property::ALL`], found by driving it.
    pub properties: Vec<Finding>,
    /// Whether it can be inverted sample by sample; serialized as the last of the properties.
    pub invertibility: Invertibility,
    /// What its equations promise.
    pub promises: Vec<StructuralProperty>,
    /// What its weights say; `None` for a classical law.
    pub weights: Option<WeightDiagnosis>,
    /// Widths of its loops, the paper's `K` and `P`.
    pub loop_widths: LoopWidths,
    /// What is certain of its memory.
    pub memory: MemoryCertificate,
}

impl ModelDiagnosis {
    /// Diagnoses a fitted model.
    ///
    /// # Errors
    /// A model that was trained on no range of the input, or whose output is the same everywhere.
    pub fn of(model: &Model) -> Result<Self> {
        let probe = Probe::new(model)?;
        let properties = properties::findings(&probe)?;
        let promises = structure::promises(&probe, &properties);
        let weights = WeightDiagnosis::of(&probe, &properties)?;
        let promised = |property| {
            promises.iter().find(|promise| promise.property == property).map(|promise| promise.verdict)
        };
        let memory = MemoryCertificate::of(&probe, &properties, &promised, weights.as_ref())?;
        Ok(Self {
            model: model.name(),
            probing: probe.description(),
            loop_widths: LoopWidths::of(&probe)?,
            invertibility: Invertibility::of(&probe)?,
            properties,
            promises,
            weights,
            memory,
        })
    }

    /// The findings on all properties, that on invertibility at the end.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.properties.iter().chain([&self.invertibility.finding])
    }

    /// The finding on a property.
    pub fn finding(&self, property: Property) -> &Finding {
        self.findings().find(|finding| finding.property == property).expect("a diagnosis has every property")
    }

    /// The verdict on a property.
    pub fn verdict(&self, property: Property) -> Verdict {
        self.finding(property).verdict
    }
}

/// An element of the serialized properties.
#[derive(Serialize)]
#[serde(untagged)]
enum Listed<'a> {
    Property(&'a Finding),
    Invertible(&'a Invertibility),
}

impl Serialize for ModelDiagnosis {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let Self { model, probing, properties, invertibility, promises, weights, loop_widths, memory } = self;
        let properties = properties.iter().map(Listed::Property);
        let properties: Vec<Listed> = properties.chain([Listed::Invertible(invertibility)]).collect();
        let mut object = serializer.serialize_struct("ModelDiagnosis", 7)?;
        object.serialize_field("model", model)?;
        object.serialize_field("probing", probing)?;
        object.serialize_field("properties", &properties)?;
        object.serialize_field("promises", promises)?;
        object.serialize_field("weights", weights)?;
        object.serialize_field("loop_widths", loop_widths)?;
        object.serialize_field("memory", memory)?;
        object.end()
    }
}
