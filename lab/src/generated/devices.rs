//! Actuators, dampers and bushes of the cases.

use std::f64::consts::TAU;

use super::elastomer::{Elastomer, ElastomerParameters};
use super::magnetorheological_damper::{MagnetorheologicalDamper, MagnetorheologicalDamperParameters};
use super::phase_transformation::{PhaseTransformation, PhaseTransformationParameters};
use hysid::specimens::generalized_play::{Envelope, GeneralizedPlays, PlayStart};
use hysid::specimens::{MagnetostrictiveActuator, RateDependentActuator};
use hysid_core::elementary::exp;
use hysid_core::error::Result;
use hysid_core::law::Law;
use hysid_core::law::bouc_wen::BoucWen;
use hysid_core::law::modified_prandtl_ishlinskii::{DeadZoneParts, DeadZones, ModifiedPrandtlIshlinskii};
use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid_core::operator::Relaxation;

use super::draw::Draw;
use super::subject::Subject;

/// A shape-memory actuator by generalized plays: the published law with its values perturbed. Steepness and
/// shift of an envelope have one factor, so that it stays where it is.
pub(super) fn shape_memory_actuator(draw: &mut Draw) -> Result<Subject> {
    let mut envelope = |[a0, a1, a2, a3]: [f64; 4]| {
        let (height, steepness) = (draw.factor(0.1), draw.factor(0.1));
        Envelope::new([height * a0, steepness * a1, steepness * a2, height * a3])
    };
    let envelopes =
        [envelope([0.8380, 6.4364, -9.9631, 0.5618]), envelope([15.7940, 2.7649, -5.6356, 15.5400])];
    let spacing = draw.around(0.0395);
    let weights = GeneralizedPlays::exponential(21, spacing, draw.around(10.959), draw.around(2.5785));
    let plays = GeneralizedPlays::new(envelopes, spacing, weights, draw.around(17.72), PlayStart::Lowered);
    Ok(Subject::of_law((0.0, 2.4), plays.law))
}

/// A shape-memory wire by the cosine law.
pub(super) fn shape_memory_wire(draw: &mut Draw) -> Result<Subject> {
    let (austenite, martensite) = (draw.between(62.0, 72.0), draw.between(48.0, 58.0));
    let parameters = PhaseTransformationParameters {
        austenite: (austenite, austenite + draw.around(16.0)),
        martensite: (martensite, martensite - draw.around(16.0)),
        stroke: draw.around(5.0),
        expansion: draw.around(0.004),
    };
    let (low, high) = (parameters.martensite.1 - 4.0, parameters.austenite.1 + 4.0);
    let mut wire = PhaseTransformation::new(parameters);
    Ok(Subject::new((low, high), move |sample| wire.step(sample.x)))
}

/// Envelopes and plays of a Terfenol-D actuator, perturbed: current in A to displacement in µm.
fn terfenol_plays(draw: &mut Draw) -> GeneralizedPlays {
    let (height, steepness) = (draw.around(4.0), draw.around(1.0));
    let envelopes = [
        Envelope::new([height, 1.35 * steepness, -draw.around(0.35), 0.0]),
        Envelope::new([height, 1.25 * steepness, draw.around(0.05), draw.around(0.15)]),
    ];
    let spacing = draw.around(0.25);
    let weights = GeneralizedPlays::exponential(11, spacing, draw.around(2.4), draw.around(0.55));
    GeneralizedPlays::new(envelopes, spacing, weights, draw.around(24.0), PlayStart::Virgin)
}

/// A Terfenol-D actuator at low speed.
pub(super) fn terfenol_actuator(draw: &mut Draw) -> Result<Subject> {
    Ok(Subject::of_law((-0.7, 1.2), terfenol_plays(draw).law))
}

/// A magnetostrictive actuator: such plays between a lag and a resonance.
pub(super) fn magnetostrictive_actuator(draw: &mut Draw) -> Result<Subject> {
    let (plays, lag) = (terfenol_plays(draw), draw.around(1.5e-4));
    let (resonance, damping) = (TAU * draw.around(1500.0), draw.around(0.12));
    let bias = 0.1;
    let mut actuator = MagnetostrictiveActuator::at_rest(plays, lag, resonance, damping, bias);
    Ok(Subject::new((bias - 0.8, bias + 0.8), move |sample| {
        // The first sample has no way behind it: the actuator rests there.
        actuator.step(sample.x, if sample.step > 0.0 { sample.step } else { 1.0 })
    }))
}

/// Weights and thresholds of plays that spread over a swing of the input.
fn plays(draw: &mut Draw, half: f64, slope: f64) -> (Vec<f64>, Vec<f64>) {
    let count = draw.whole(8, 14);
    let decline = draw.between(0.5, 2.5);
    let thresholds: Vec<f64> = (1..=count).map(|j| 0.9 * half * j as f64 / (count + 1) as f64).collect();
    let weight = |&r: &f64| slope * draw.around(exp(-decline * r / half)) / count as f64;
    let weights = thresholds.iter().map(weight).collect();
    (thresholds, weights)
}

/// A stack actuator that saturates on one side: plays behind dead zones.
pub(super) fn stack_actuator(draw: &mut Draw) -> Result<Subject> {
    let half = draw.around(50.0);
    let (thresholds, weights) = plays(draw, half, 0.12);
    let hysteresis = PrandtlIshlinskii::new(0.0, draw.around(0.08), thresholds, weights)?;
    let reach = 0.1 * half;
    let superposition = DeadZones::new(DeadZoneParts {
        constant: draw.around(8.0),
        linear: 1.0,
        thresholds: vec![-0.8 * reach, -0.3 * reach, 0.3 * reach, 0.7 * reach],
        weights: vec![draw.around(0.15), draw.around(0.1), -draw.around(0.15), -draw.around(0.2)],
    })?;
    Ok(Subject::of_law((-half, half), ModifiedPrandtlIshlinskii::new(hysteresis, superposition)))
}

/// A bender at low speed: plays, and a little cubic.
pub(super) fn bender(draw: &mut Draw) -> Result<Subject> {
    let half = draw.around(60.0);
    let (thresholds, weights) = plays(draw, half, 1.2);
    let law = PrandtlIshlinskii::new(0.0, draw.around(1.0), thresholds, weights)?;
    let bend = draw.around(0.15) / (half * half);
    let mut state = law.virgin();
    Ok(Subject::new((-half, half), move |sample| {
        let y = law.step(&mut state, sample);
        y * (1.0 - bend * sample.x * sample.x)
    }))
}

/// An actuator whose thresholds grow with the rate.
pub(super) fn rate_dependent_actuator(draw: &mut Draw) -> Result<Subject> {
    let decline = draw.around(0.12);
    let weights = (1..=10).map(|i| 0.4 * draw.factor(0.1) * exp(-decline * f64::from(i))).collect();
    let mut actuator =
        RateDependentActuator::new(draw.around(0.5), weights, draw.around(0.6), draw.around(1e-3));
    Ok(Subject::new((-10.0, 10.0), move |sample| actuator.step(sample.x, sample.rate)))
}

/// A piezo stack that creeps: plays, and a drift that three relaxation times bring after the voltage.
pub(super) fn creeping_piezo(draw: &mut Draw) -> Result<Subject> {
    let half = draw.around(50.0);
    let (thresholds, weights) = plays(draw, half, 0.12);
    let law = PrandtlIshlinskii::new(draw.around(3.0), draw.around(0.1), thresholds, weights)?;
    let mut creep = Vec::new();
    for time_constant in [0.01, 0.1, 1.0] {
        let element = Relaxation::new(draw.around(time_constant)).expect("the time constant is positive");
        creep.push((draw.around(0.015), element));
    }
    let mut state = law.virgin();
    Ok(Subject::new((0.0, 2.0 * half), move |sample| {
        // What a relaxation element has lost of the input is what has crept after.
        let crept = creep
            .iter_mut()
            .map(|(share, element)| *share * (sample.x - element.step(sample.x, sample.step)));
        let crept: f64 = crept.sum();
        law.step(&mut state, sample) + crept
    }))
}

/// A magnetorheological damper: displacement in mm to force in N.
pub(super) fn magnetorheological_damper(draw: &mut Draw) -> Result<Subject> {
    let yield_displacement = draw.around(0.6);
    let yield_force = draw.around(180.0);
    let friction = BoucWen::new(draw.around(1.5), yield_force / yield_displacement, yield_displacement)?;
    let friction = BoucWen {
        offset: -draw.around(20.0),
        b: draw.between(0.4, 0.8),
        n: draw.between(1.0, 2.0),
        ..friction
    };
    let mut damper = MagnetorheologicalDamper::new(MagnetorheologicalDamperParameters {
        friction: friction.validated()?,
        damping: draw.around(0.5),
        viscous_force: draw.around(220.0),
        viscous_speed: draw.around(50.0),
        lag: draw.around(6e-3),
    });
    let largest = draw.around(12.0);
    Ok(Subject::new((-largest, largest), move |sample| damper.step(sample.x, sample.step)))
}

/// A rubber bush: displacement in mm to force in N.
pub(super) fn rubber_bush(draw: &mut Draw) -> Result<Subject> {
    let mut bush = Elastomer::new(ElastomerParameters {
        stiffness: draw.around(80.0),
        stiffening: draw.around(2.0),
        friction: draw.around(90.0),
        friction_displacement: draw.around(0.4),
        elements: vec![(draw.around(60.0), draw.around(0.02)), (draw.around(40.0), draw.around(0.3))],
    });
    let largest = draw.around(4.0);
    Ok(Subject::new((-largest, largest), move |sample| bush.step(sample.x, sample.step)))
}
