//! The ten properties of a model: probes chosen for each, evaluated by the tests of data, or directly where
//! that is stronger.

use super::direct;
use super::probe::{Probe, data, extent};
use crate::branch::BranchSet;
use crate::cycles::{Cycle, cycles};
use crate::{
    DiagnosisOptions, Finding, Property, Verdict, congruency, deterioration, loop_closure, masing,
    orientation, saturation, static_hysteresis, wiping_out,
};
use hysid_core::data::record::{Dataset, Record};
use hysid_core::error::{DataProblem, Result};

/// The protocol of theory.md (10.30): nested and shifted loops between repeated whole ones.
pub(super) const PROTOCOL: [f64; 29] = [
    0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -0.3, 0.3, -0.3, 1.0, -1.0, 0.3, -0.3, 0.3, -1.0, 1.0, 0.6, -0.6, 0.6,
    -0.6, 0.3, -0.3, 0.3, 1.0, -0.5, 0.0, -0.5, 1.0, -1.0,
];

/// Equal minor loops shifted along the way up and the way down, and loops nested four deep.
pub(super) const SHIFTED: [f64; 28] = [
    0.0, 1.0, -1.0, -0.3, -0.7, 0.2, -0.2, 0.7, 0.3, 1.0, 0.3, 0.7, -0.2, 0.2, -0.7, -0.3, -1.0, 1.0, -0.8,
    0.8, -0.6, 0.6, -0.4, 0.4, -0.2, 1.0, -1.0, 1.0,
];

/// A whole loop, three times.
pub(super) const WHOLE_LOOPS: [f64; 7] = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];

/// Repeats of a loop that is to show wear.
const REPEATS: usize = 25;

/// An output that moves less than this share at a vanishing speed has no memory worth testing there.
const HARDLY_MOVES: f64 = 0.01;

/// No smoothing: a model has no noise.
const EXACT: DiagnosisOptions = DiagnosisOptions { smallest_reversal: 0.02, smoothing: false };

const FASTER: &str =
    "the model depends only on the rate of the input; look at its loops at the trained speeds";

const LARGER: &str = "fit the model to a record with loops over a larger range of the input";

pub(super) fn survey(data: &Dataset) -> BranchSet<'_> {
    BranchSet { turns_on_rows: true, ..BranchSet::new(data, &EXACT) }
}

pub(super) fn repeated_loops() -> Vec<f64> {
    let mut turning = vec![0.0];
    turning.extend([1.0, -1.0].repeat(REPEATS));
    turning
}

/// All findings, in the order of [`Property::ALL`].
pub(super) fn findings(probe: &Probe) -> Result<Vec<Finding>> {
    let memory = data(vec![
        probe.run_slowly("protocol", &probe.path(&PROTOCOL).x)?,
        probe.run_slowly("shifted loops", &probe.path(&SHIFTED).x)?,
    ])?;
    let loops = probe.run("whole loops", &probe.path(&WHOLE_LOOPS).x, probe.speeds.middle)?;
    let (slow, moving) = (extent(memory.records()[0].output()), extent(loops.output()));
    if slow.max(moving) <= 1e-14 * loops.output()[0].abs() {
        let problem = DataProblem::ConstantOutput(loops.output()[0]);
        return Err(loops.defect(None, Some(hysid_core::error::Channel::Output), problem));
    }
    let mut findings =
        if slow > HARDLY_MOVES * moving { of_memory(probe, &memory)? } else { hardly_moving() };
    findings.extend([
        static_loops(probe)?,
        direct::rate_dependence(probe)?,
        direct::odd_symmetry(probe)?,
        wear(probe)?,
    ]);
    if findings.iter().any(|f| f.property == Property::Orientation && f.verdict == Verdict::NotTestable) {
        findings.retain(|finding| finding.property != Property::Orientation);
        findings.push(orientation_at_speed(probe, loops)?);
    }
    findings.sort_by_key(|finding| Property::ALL.iter().position(|property| *property == finding.property));
    Ok(findings)
}

/// Findings on the memory of a model, at a vanishing speed.
fn of_memory(probe: &Probe, memory: &Dataset) -> Result<Vec<Finding>> {
    let survey = survey(memory);
    let mut findings = vec![
        orientation::verdict(&survey),
        direct::with_accumulated_gap(probe, wiping_out::verdict(&survey, false), survey.height())?,
        congruency::verdict(&survey, false, false),
        masing::verdict(&survey, false),
        saturation::verdict(&survey),
        closure(probe)?,
    ];
    if probe.speeds.matter() {
        findings.iter_mut().for_each(|finding| finding.statement += " (at vanishing speed)");
    }
    Ok(findings)
}

/// In place of [`of_memory`].
fn hardly_moving() -> Vec<Finding> {
    let statement = "at vanishing speed the output hardly changes: there is no memory to test";
    let properties = [
        Property::Orientation,
        Property::WipingOut,
        Property::Congruency,
        Property::Masing,
        Property::Saturation,
        Property::LoopClosure,
    ];
    properties.map(|property| Finding::not_testable(property, statement, FASTER)).into()
}

/// Loops at two next to vanishing speeds.
fn static_loops(probe: &Probe) -> Result<Finding> {
    let path = probe.path(&WHOLE_LOOPS);
    let slowest = probe.speeds.vanishing;
    let data = data(vec![
        probe.run("slowest", &path.x, slowest)?,
        probe.run("three times as fast", &path.x, 3.0 * slowest)?,
    ])?;
    let survey = survey(&data);
    Ok(static_hysteresis::verdict(&survey, Verdict::NotTestable, || None))
}

fn orientation_at_speed(probe: &Probe, loops: Record) -> Result<Finding> {
    let data = data(vec![loops])?;
    let survey = survey(&data);
    let mut finding = orientation::verdict(&survey);
    if probe.speeds.matter() {
        finding.statement += " (at the middle of the trained speeds)";
    }
    Ok(finding)
}

/// Repeated loops, slow, and at speed for a model with the rate: what wears may do so at speed only.
fn wear(probe: &Probe) -> Result<Finding> {
    let path = probe.path(&repeated_loops());
    let test = |speed: f64| -> Result<Finding> {
        let data = data(vec![probe.run("repeated loops", &path.x, speed)?])?;
        let survey = survey(&data);
        let cycles = cycles(&survey);
        if !cycles.first().is_some_and(Cycle::is_open) {
            let statement = "there is no loop large enough to shrink";
            return Ok(Finding::not_testable(Property::Deterioration, statement, LARGER));
        }
        let mut finding = deterioration::verdict(&survey, &cycles);
        finding.statement += &format!(" ({REPEATS} loops over the whole range)");
        Ok(finding)
    };
    let slow = test(probe.speeds.vanishing)?;
    if !probe.speeds.matter() {
        return Ok(slow);
    }
    let fast = test(probe.speeds.middle)?;
    let stronger = match (slow.verdict, fast.verdict) {
        (Verdict::Yes, Verdict::Yes) => fast.index > slow.index,
        (Verdict::Yes, _) => false,
        (_, Verdict::Yes) => true,
        (Verdict::NotTestable, _) => true,
        _ => fast.index > slow.index,
    };
    let (mut finding, speed) = if stronger { (fast, "the middle speed") } else { (slow, "vanishing speed") };
    finding.statement += &format!(", at {speed}");
    Ok(finding)
}

/// Whole loops and smaller ones beside the middle, each repeated.
fn closure(probe: &Probe) -> Result<Finding> {
    const TIMES: usize = 20;
    let mut turning = repeated_loops();
    for (from, to) in [(0.2, -0.2), (0.8, 0.4), (-0.4, -0.8)] {
        turning.extend([1.0, -1.0, from]);
        turning.extend([to, from].repeat(TIMES));
    }
    let data = data(vec![probe.run_slowly("repeated loops", &probe.path(&turning).x)?])?;
    let survey = survey(&data);
    Ok(loop_closure::test(&survey, &cycles(&survey), false))
}
