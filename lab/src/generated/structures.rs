//! Structures and metals of the cases: members in cyclic tests.

use super::cyclic_plasticity::{Backstress, CyclicPlasticity, CyclicPlasticityParameters};
use super::peak_oriented::{PeakOriented, PeakOrientedParameters};
use hysid::specimens::{BoucWenBaberNoori, Concrete, ConcreteParameters, ReinforcedConcreteJoint};
use hysid_core::elementary::powf;
use hysid_core::error::Result;
use hysid_core::law::Law;
use hysid_core::law::bouc_wen::BoucWen;
use hysid_core::law::masing::{Masing, MasingParts};
use hysid_core::operator::{DeterioratingStop, Operator};

use super::draw::Draw;
use super::subject::Subject;

/// A member after Baber and Noori with its values perturbed, driven to `ductility` displacement scales.
fn bouc_wen_baber_noori(draw: &mut Draw, mean: BoucWenBaberNoori, ductility: f64) -> Subject {
    // β and γ keep their sum positive: that sum and the share of β in it vary.
    let sum = draw.around(mean.beta + mean.gamma);
    let share = draw.around(mean.beta / (mean.beta + mean.gamma)).max(0.52);
    let parameters = BoucWenBaberNoori {
        force_scale: draw.around(mean.force_scale),
        displacement_scale: draw.around(mean.displacement_scale),
        energy_scale: draw.around(mean.energy_scale),
        alpha: draw.around(mean.alpha),
        beta: share * sum,
        gamma: (1.0 - share) * sum,
        n: draw.around(mean.n).max(1.0),
        nu_0: draw.around(mean.nu_0),
        delta_nu: draw.around(mean.delta_nu),
        a_0: draw.around(mean.a_0),
        delta_a: draw.around(mean.delta_a),
        eta_0: draw.around(mean.eta_0),
        delta_eta: draw.around(mean.delta_eta),
        p: draw.around(mean.p),
        zeta_s: draw.around(mean.zeta_s).min(0.98),
        psi_0: draw.around(mean.psi_0),
        delta_psi: draw.around(mean.delta_psi),
        lambda: draw.around(mean.lambda),
        q: draw.around(mean.q),
    };
    let largest = draw.around(ductility) * parameters.displacement_scale;
    let mut member = ReinforcedConcreteJoint::new(parameters);
    Subject::new((-largest, largest), move |sample| member.step(sample.x))
}

/// A beam-column joint that pinches and softens.
pub(super) fn joint(draw: &mut Draw) -> Result<Subject> {
    Ok(bouc_wen_baber_noori(draw, BoucWenBaberNoori::joint(), 7.0))
}

/// A column; what of it declines follows from the other values.
fn column() -> BoucWenBaberNoori {
    BoucWenBaberNoori {
        force_scale: 150.0,
        displacement_scale: 8.0,
        energy_scale: 0.03,
        alpha: 0.03,
        beta: 0.7,
        gamma: 0.3,
        n: 1.3,
        nu_0: 1.0,
        delta_nu: 0.02,
        a_0: 1.0,
        delta_a: 0.005,
        eta_0: 1.0,
        delta_eta: 0.05,
        p: 1.0,
        zeta_s: 0.3,
        psi_0: 0.2,
        delta_psi: 0.02,
        lambda: 0.5,
        q: 0.1,
    }
}

/// A column in bending: wide loops, next to no damage.
pub(super) fn stable_column(draw: &mut Draw) -> Result<Subject> {
    Ok(bouc_wen_baber_noori(draw, column(), 6.0))
}

/// A column that fails in shear: it loses most of its strength.
pub(super) fn degrading_column(draw: &mut Draw) -> Result<Subject> {
    let mean = BoucWenBaberNoori { delta_nu: 0.5, delta_a: 0.06, delta_eta: 0.3, zeta_s: 0.5, ..column() };
    Ok(bouc_wen_baber_noori(draw, mean, 6.0))
}

/// A column that pinches.
pub(super) fn pinched_column(draw: &mut Draw) -> Result<Subject> {
    let mean = BoucWenBaberNoori { delta_nu: 0.15, delta_eta: 0.3, p: 2.0, zeta_s: 0.9, q: 0.15, ..column() };
    Ok(bouc_wen_baber_noori(draw, mean, 7.0))
}

/// A nailed timber connection: pinched nearly to nothing, with a rising skeleton.
pub(super) fn timber(draw: &mut Draw) -> Result<Subject> {
    let mean = BoucWenBaberNoori {
        force_scale: 6.0,
        displacement_scale: 3.0,
        alpha: 0.07,
        delta_nu: 0.08,
        delta_eta: 0.4,
        p: 6.0,
        zeta_s: 0.95,
        psi_0: 0.3,
        lambda: 0.3,
        q: 0.05,
        ..column()
    };
    Ok(bouc_wen_baber_noori(draw, mean, 9.0))
}

/// A peak-oriented member with this pinching, softening and endurance.
fn peak_oriented(draw: &mut Draw, pinching: f64, softening: f64, endurance: f64) -> Subject {
    let parameters = PeakOrientedParameters {
        yield_force: draw.around(180.0),
        yield_displacement: draw.around(9.0),
        hardening: draw.around(0.04),
        capping: draw.around(4.0).max(2.0),
        softening: draw.around(softening),
        unloading: draw.around(0.3),
        pinching: draw.around(pinching).min(1.0),
        break_place: draw.between(0.35, 0.65),
        endurance: draw.around(endurance),
    };
    let largest = draw.around(6.5) * parameters.yield_displacement;
    let mut member = PeakOriented::new(parameters);
    Subject::new((-largest, largest), move |sample| member.step(sample.x))
}

/// A slender column: peak-oriented, little pinched.
pub(super) fn slender_column(draw: &mut Draw) -> Result<Subject> {
    Ok(peak_oriented(draw, 0.85, 0.03, 250.0))
}

/// A squat wall: peak-oriented, pinched, soon without strength.
pub(super) fn squat_wall(draw: &mut Draw) -> Result<Subject> {
    Ok(peak_oriented(draw, 0.35, 0.06, 70.0))
}

/// A masonry panel: a spring and stops that wear out, the short ones first.
pub(super) fn masonry(draw: &mut Draw) -> Result<Subject> {
    let spring = draw.around(0.4);
    let mut stops = Vec::new();
    for threshold in [0.3, 0.8, 1.8, 4.0, 8.0] {
        let stop = DeterioratingStop::new(draw.around(threshold), draw.around(700.0 / threshold))
            .expect("threshold and capacity are positive");
        stops.push((draw.around(9.0 / (1.0 + threshold)), stop));
    }
    let largest = draw.around(16.0);
    Ok(Subject::new((-largest, largest), move |sample| {
        let forces = stops.iter_mut().map(|(stiffness, stop)| *stiffness * stop.step(sample.x));
        forces.sum::<f64>() + spring * sample.x
    }))
}

/// Concrete in compression.
pub(super) fn concrete(draw: &mut Draw) -> Result<Subject> {
    let strength = draw.around(30.0);
    let strain_at_strength = draw.around(2.2);
    let parameters = ConcreteParameters {
        strength,
        strain_at_strength,
        crushing_strain: 1e3,
        // Above the chord to the strength, or there is no envelope.
        modulus: draw.between(1.5, 2.3) * strength / strain_at_strength,
    };
    let largest = draw.between(1.8, 2.6) * strain_at_strength;
    let mut concrete = Concrete::new(parameters);
    Ok(Subject::new((0.0, largest), move |sample| concrete.step(sample.x)))
}

/// A steel brace: Bouc-Wen without damage.
pub(super) fn brace(draw: &mut Draw) -> Result<Subject> {
    let yield_displacement = draw.around(3.0);
    let law = BoucWen::new(draw.around(4.0), draw.around(60.0), yield_displacement)?;
    let law = BoucWen { b: draw.between(0.4, 0.9), n: draw.between(1.0, 3.0), ..law }.validated()?;
    let largest = draw.around(7.0) * yield_displacement;
    Ok(Subject::of_law((-largest, largest), law))
}

/// Mild steel by Masing's rule on a skeleton of Ramberg and Osgood: `ε = σ/E + (σ/K)^{1/n}`, in mm/m.
pub(super) fn ramberg_osgood_steel(draw: &mut Draw) -> Result<Subject> {
    let (modulus, strength, exponent) = (draw.around(200.0), draw.around(260.0), draw.between(0.08, 0.2));
    let strain = |stress: f64| stress / modulus + powf(stress / strength, 1.0 / exponent);
    let largest = draw.between(10.0, 18.0);
    // The skeleton as a polygon through evenly spaced stresses, up to the largest branch.
    let (mut stress, mut thresholds, mut slopes) = (0.0, Vec::new(), Vec::new());
    while strain(stress) < 1.2 * largest {
        slopes.push(4.0 / (strain(stress + 4.0) - strain(stress)));
        stress += 4.0;
        thresholds.push(strain(stress));
    }
    slopes.push(4.0 / (strain(stress + 4.0) - strain(stress)));
    let law = Masing::new(MasingParts { constant: 0.0, thresholds, slopes })?;
    Ok(Subject::of_law((-largest, largest), law))
}

/// Structural steel with isotropic and kinematic hardening.
pub(super) fn structural_steel(draw: &mut Draw) -> Result<Subject> {
    let parameters = CyclicPlasticityParameters {
        modulus: draw.around(195.0),
        yield_stress: draw.around(260.0),
        isotropic: draw.around(90.0) * if draw.whole(0, 2) == 0 { -1.0 } else { 1.0 },
        isotropic_rate: draw.around(0.012),
        backstresses: vec![
            Backstress { modulus: draw.around(12.0), recovery: draw.around(0.12) },
            Backstress { modulus: draw.around(2.0), recovery: draw.around(0.012) },
        ],
    };
    let largest = draw.around(14.0);
    let mut steel = CyclicPlasticity::new(parameters);
    Ok(Subject::new((-largest, largest), move |sample| steel.step(sample.x)))
}
