//! What is certain of a model's memory, and how it is known.

use serde::Serialize;

use super::bound::{whatever_the_input, within_trained_ranges};
use super::direct::ROUNDING;
use super::neurons::{MATTERS, Neuron};
use super::probe::{Probe, extent, path, times};
use super::properties::PROTOCOL;
use super::structure::sees_time;
use super::weights::WeightDiagnosis;
use crate::{Finding, Property, Verdict};
use hysid_core::error::Result;
use hysid_core::model::Predictor;
use hysid_core::significant::Significant;

/// Rows to half the range of the path that is refined.
const COARSE: u32 = 20;

/// How a claim is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// From the model's equations, whatever the parameters.
    Structure,
    /// From the values of its parameters.
    Weights,
    /// From what it does when driven.
    Probing,
}

/// A claim about a model's memory.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Whether it is true.
    pub holds: bool,
    /// How that is known.
    pub basis: Basis,
    /// What probing measured, as a share of the range of the output.
    pub measured: Option<f64>,
    /// All of it in words.
    pub statement: String,
}

/// Bounds of the output, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bound {
    /// Outputs that are possible while inputs and rate stay within the trained ranges; `None` if the output grows
    /// with the path for ever.
    pub in_trained_ranges: Option<(f64, f64)>,
    /// Outputs that are possible whatever the input; `None` if the output grows with the input for ever.
    pub whatever_the_input: Option<(f64, f64)>,
    /// Outputs that were reached on the way through the trained range.
    pub reached: (f64, f64),
    /// How the bounds are known.
    pub basis: Basis,
}

/// Largest change of the output at the same instants when a path is given in finer steps, as a share of the
/// output's range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refinement {
    /// In half the steps.
    pub by_two: f64,
    /// In a tenth of the steps.
    pub by_ten: f64,
    /// Whether the step does not matter.
    pub independent: Claim,
}

/// What is certain of a model's memory.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MemoryCertificate {
    /// A bounded input gives a bounded output.
    pub bound: Bound,
    /// The output does not depend on the steps in which a path is given.
    pub refinement: Refinement,
    /// The output does not depend on the speed.
    pub rate_independent: Claim,
    /// A closed excursion leaves no trace; at a vanishing speed, for a model that sees it.
    pub return_point_memory: Claim,
}

impl MemoryCertificate {
    /// # Errors
    /// A rate that cannot be computed.
    pub(super) fn of(
        probe: &Probe,
        findings: &[Finding],
        promised: &dyn Fn(Property) -> Option<Verdict>,
        weights: Option<&WeightDiagnosis>,
    ) -> Result<Self> {
        let finding = |property| findings.iter().find(|finding| finding.property == property);
        let index = |property| finding(property).and_then(|finding| finding.index);
        let refinement = refine(probe)?;
        let rate = index(Property::RateDependence);
        let gap = index(Property::WipingOut);
        let found = finding(Property::WipingOut).map(|finding| finding.verdict);
        Ok(Self {
            bound: bound(probe)?,
            refinement,
            rate_independent: rate_independent(probe, rate),
            return_point_memory: return_point_memory(promised(Property::WipingOut), found, gap, weights),
        })
    }
}

fn bound(probe: &Probe) -> Result<Bound> {
    let trained = within_trained_ranges(probe.model);
    let mut reached = (f64::INFINITY, f64::NEG_INFINITY);
    for speed in [probe.speeds.vanishing, probe.speeds.middle] {
        for &y in probe.run("protocol", &probe.path(&PROTOCOL).x, speed)?.output() {
            reached = (reached.0.min(y), reached.1.max(y));
        }
    }
    Ok(Bound {
        in_trained_ranges: (trained.0.is_finite() && trained.1.is_finite()).then_some((trained.0, trained.1)),
        whatever_the_input: whatever_the_input(probe.model).map(|all| (all.0, all.1)),
        reached,
        basis: Basis::Weights,
    })
}

/// The same path in steps, halves of them and tenths, theory.md (10.43).
fn refine(probe: &Probe) -> Result<Refinement> {
    let run = |finer: u32| -> Result<Vec<f64>> {
        let path = path(probe.centre, probe.half, &PROTOCOL, COARSE * finer);
        let record = probe.record("refined", &path.x, &times(&path.x, probe.speeds.middle))?;
        let y = probe.model.simulate(&record)?;
        Ok(y.into_iter().step_by(finer as usize).collect())
    };
    let coarse = run(1)?;
    let height = extent(&coarse).max(f64::MIN_POSITIVE);
    let change = |finer: u32| -> Result<f64> {
        let fine = run(finer)?;
        Ok(coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / height)
    };
    let (by_two, by_ten) = (change(2)?, change(10)?);
    let exact = by_two.max(by_ten) <= ROUNDING;
    let statement = if exact {
        "a path in finer steps gives the same outputs, up to rounding".into()
    } else {
        format!(
            "with twice the {} steps of a branch the outputs differ by up to {} % of their range, with ten \
             times as many by {} %",
            2 * COARSE,
            Significant(100.0 * by_two),
            Significant(100.0 * by_ten)
        )
    };
    let basis =
        if exact && step_is_free(probe.model.predictor()) { Basis::Structure } else { Basis::Probing };
    let independent = Claim { holds: exact, basis, measured: Some(by_two.max(by_ten)), statement };
    Ok(Refinement { by_two, by_ten, independent })
}

/// True for what consists of plays, stops and turning points, where clamps of one direction join to one.
fn step_is_free(body: &Predictor) -> bool {
    match body {
        Predictor::Ensemble(ensemble) => {
            ensemble.members().iter().all(|member| step_is_free(member.predictor()))
        }
        Predictor::Network { network, .. } => !sees_time(network.architecture()),
        Predictor::Law(law) => law.is_step_free(),
    }
}

fn sees_rate_or_time(body: &Predictor) -> bool {
    match body {
        Predictor::Network { network, .. } => sees_time(network.architecture()),
        Predictor::Law(law) => law.sees_rate() || law.facts().needs_time,
        Predictor::Ensemble(ensemble) => {
            ensemble.members().iter().any(|member| sees_rate_or_time(member.predictor()))
        }
    }
}

fn rate_independent(probe: &Probe, index: Option<f64>) -> Claim {
    let sees = sees_rate_or_time(probe.model.predictor());
    let measured = index.unwrap_or(0.0);
    let (holds, basis, statement) = if !sees {
        let basis = if probe.speeds.matter() { Basis::Weights } else { Basis::Structure };
        (true, basis, "no part of the model has rate or time as an input".to_string())
    } else if measured <= ROUNDING {
        (true, Basis::Probing, "the output is the same at all trained speeds, up to rounding".into())
    } else {
        let percent = Significant(100.0 * measured);
        let text = format!("at 30 times the speed the output differs by {percent} % of its range");
        (false, Basis::Probing, text)
    };
    Claim { holds, basis, measured: index, statement }
}

fn return_point_memory(
    promised: Option<Verdict>,
    found: Option<Verdict>,
    gap: Option<f64>,
    weights: Option<&WeightDiagnosis>,
) -> Claim {
    let unworn = weights.is_some_and(|weights| {
        let wear = weights.criteria.iter().find(|criterion| criterion.property == Property::Deterioration);
        let fades = |neuron: &Neuron| neuron.relaxation_time.is_some() && neuron.influence >= MATTERS;
        wear.is_some_and(|criterion| criterion.value <= ROUNDING) && !weights.neurons.iter().any(fades)
    });
    let measured = gap.map_or("; at vanishing speed the output hardly changes".into(), |gap| {
        format!("; the largest gap found is {} % of the output's range", Significant(100.0 * gap))
    });
    let (holds, basis, text) = match (promised, found) {
        (Some(Verdict::Yes), _) => {
            (true, Basis::Structure, "the memory consists of turning points that are wiped out")
        }
        _ if unworn => (true, Basis::Weights, "no stop with influence deteriorates noticeably"),
        (_, Some(Verdict::Yes)) => (true, Basis::Probing, "excursions leave no gap that matters"),
        (_, Some(Verdict::No)) => (false, Basis::Probing, "excursions leave a gap"),
        _ => (false, Basis::Probing, "there is no memory to test"),
    };
    Claim { holds, basis, measured: gap, statement: format!("{text}{measured}") }
}
