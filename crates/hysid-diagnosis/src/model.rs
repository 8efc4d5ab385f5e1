//! Kind of hysteresis of a fitted model: the properties of measured data, found by driving the
//! model with probes chosen for each, and those that its equations guarantee.
//!
//! A probe stays within the input range and the rates that the model was trained on; further inputs are held in
//! the middle of theirs. Properties of memory are tested at a vanishing speed. Definitions: theory.md,
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
//! assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::Yes);
//! # Ok::<(), hysid_core::Error>(())
//! ```

mod cycles;
mod direct;
mod invertibility;
mod loop_widths;
mod magnetisation;
mod probe;
mod properties;
mod structure;
#[cfg(test)]
mod tests;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::{Finding, Property, Verdict};
pub use cycles::ModelCycles;
use hysid_core::error::Result;
use hysid_core::model::Model;
use hysid_core::options::ModelName;
pub use invertibility::{AtTimeStep, Invertibility, NonMonotonePlace, OutputDirection, PlaceKind, Scans};
pub use loop_widths::{LoopWidths, WidthAtSpeed};
pub use magnetisation::MagnetisationNode;
use probe::Probe;
pub use probe::{Probing, TimeScale};
pub use structure::StructuralProperty;

/// Everything that can be said about the hysteresis of a fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelDiagnosis {
    /// Which model it is.
    pub model: ModelName,
    /// Drives of the model.
    pub probing: Probing,
    /// The properties, in the order of [`Property::ALL`], found by driving it.
    pub properties: Vec<Finding>,
    /// Whether it can be inverted sample by sample; serialized as the last of the properties.
    pub invertibility: Invertibility,
    /// Properties that its equations guarantee.
    pub promises: Vec<StructuralProperty>,
    /// Widths of its loops, the paper's `K` and `P`.
    pub loop_widths: LoopWidths,
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
        Ok(Self {
            model: model.name(),
            probing: probe.description(),
            loop_widths: LoopWidths::of(&probe)?,
            invertibility: Invertibility::of(&probe)?,
            properties,
            promises,
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
enum PropertyEntry<'a> {
    Property(&'a Finding),
    Invertible(&'a Invertibility),
}

impl Serialize for ModelDiagnosis {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let Self { model, probing, properties, invertibility, promises, loop_widths } = self;
        let properties = properties.iter().map(PropertyEntry::Property);
        let properties: Vec<PropertyEntry> =
            properties.chain([PropertyEntry::Invertible(invertibility)]).collect();
        let mut object = serializer.serialize_struct("ModelDiagnosis", 5)?;
        object.serialize_field("model", model)?;
        object.serialize_field("probing", probing)?;
        object.serialize_field("properties", &properties)?;
        object.serialize_field("promises", promises)?;
        object.serialize_field("loop_widths", loop_widths)?;
        object.end()
    }
}
