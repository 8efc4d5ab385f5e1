//! Properties that the equations of a model guarantee whatever its parameters, theory.md (10.35), and whether probing
//! agrees.

use serde::Serialize;

use super::direct::about_origin;
use super::probe::Probe;
use crate::{Finding, Property, Verdict};
use hysid_core::law::Classical;
use hysid_core::law::properties::{CONGRUENT, MASING, ODD, RATE_INDEPENDENT, WIPES_OUT};
use hysid_core::model::{Ensemble, Model, Predictor};
use hysid_core::network::Architecture;

/// A property that the equations of a model decide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructuralProperty {
    /// The property.
    #[serde(rename = "name")]
    pub property: Property,
    /// Whether every model with these equations has it or none has; at a vanishing speed, for what is a
    /// property of memory.
    pub verdict: Verdict,
    /// Whether probing agrees; `None` where it does not decide.
    pub agrees: Option<bool>,
}

pub(super) fn promises(probe: &Probe, findings: &[Finding]) -> Vec<StructuralProperty> {
    let of_model = of_model(probe.model, about_origin(probe));
    let promise = |(property, holds): (Property, bool)| {
        let verdict = if holds { Verdict::Yes } else { Verdict::No };
        let found = findings.iter().find(|finding| finding.property == property)?.verdict;
        let agrees = (found != Verdict::NotTestable).then_some(found == verdict);
        Some(StructuralProperty { property, verdict, agrees })
    };
    of_model.into_iter().filter_map(promise).collect()
}

fn of_model(model: &Model, about_origin: bool) -> Vec<(Property, bool)> {
    let mut all = match model.predictor() {
        Predictor::Network { network, .. } => of_network(network.architecture(), about_origin),
        Predictor::Law(law) => of_law(law, about_origin),
        Predictor::Ensemble(ensemble) => return of_ensemble(ensemble, about_origin),
    };
    if model.input_transform().compression.is_some() {
        // A branch of a compressed input is no initial curve doubled in the input itself.
        all.retain(|promise| *promise != MASING);
    }
    if model.input_transform().history.is_some() {
        // The path so far is wiped out by nothing.
        all.retain(|promise| *promise == RATE_INDEPENDENT || *promise == ODD);
    }
    all
}

/// Properties that every member guarantees, as far as a median keeps them: it does not keep the shape of increments,
/// which congruency and Masing's rule are about. An ensemble with other weights outside depends on having been there.
fn of_ensemble(ensemble: &Ensemble, about_origin: bool) -> Vec<(Property, bool)> {
    let mut members = ensemble.members().iter().map(|member| of_model(member, about_origin));
    let mut all = members.next().unwrap_or_default();
    members.for_each(|promises| all.retain(|promise| promises.contains(promise)));
    let remembers = ensemble.remembers_excursions();
    all.retain(|promise| {
        *promise == ODD || *promise == RATE_INDEPENDENT || (WIPES_OUT.contains(promise) && !remembers)
    });
    all
}

fn of_network(architecture: &Architecture, about_origin: bool) -> Vec<(Property, bool)> {
    let linear_readout = architecture.hidden == 0;
    let mut all = Vec::new();
    if !sees_time(architecture) {
        all.push(RATE_INDEPENDENT);
        if !architecture.deterioration {
            all.extend(WIPES_OUT);
            if linear_readout {
                all.extend([CONGRUENT, MASING, ODD]);
            }
        }
    }
    // A sum of stops and springs is odd about 0, worn or not.
    if linear_readout && about_origin && !all.contains(&ODD) {
        all.push(ODD);
    }
    all
}

/// True if the network has the rate for an input, or relaxation neurons.
pub(super) fn sees_time(architecture: &Architecture) -> bool {
    architecture.rate || architecture.relaxation > 0
}

fn of_law(law: &Classical, about_origin: bool) -> Vec<(Property, bool)> {
    let rate = (!law.sees_rate() && !law.facts().needs_time).then_some(RATE_INDEPENDENT);
    law.memory_properties(about_origin).into_iter().chain(rate).collect()
}
