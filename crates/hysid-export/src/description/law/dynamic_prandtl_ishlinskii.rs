//! Dynamic Prandtl-Ishlinskii: plays between a lag, relaxation elements and a resonance.

use hysid_core::law::dynamic_prandtl_ishlinskii::{DeadZone, DynamicPrandtlIshlinskii, Resonance};
use hysid_core::law::hysteretic_dynamics::Mode;

use super::hysteretic_dynamics::ModeFactors;
use super::modified_prandtl_ishlinskii::add_dead_zones;
use super::prandtl_ishlinskii::sum_of_plays;
use crate::description::{PartInputs, limited};
use crate::program::Builder;
use crate::program::expression::{Real, Whole};

/// theory.md (8.53) to (8.57)
pub(super) fn step(
    builder: &mut Builder,
    name: &str,
    law: &DynamicPrandtlIshlinskii,
    sample: &PartInputs,
) -> Real {
    let before = builder.state(&format!("{name}_before"), vec![0.0; 3]);
    let x = limited(builder, &sample.inputs[0]);
    let since_before = |builder: &mut Builder, value: &Real, place: usize| {
        builder.value(sample.is_first.clone().choose(0.0, value - before.at(place)))
    };
    let risen = since_before(builder, &x, 0);
    let mut u = x.clone();
    if let Some(time_constant) = law.lag {
        let lag = builder.state(&format!("{name}_lag"), vec![0.0]);
        let (kept, gain) = decay(builder, &sample.step, &time_constant.into());
        builder.set(lag, 0_usize, kept * lag.at(0_usize) + gain * &risen);
        u = builder.value(&x - lag.at(0_usize));
    }
    let plays = &law.plays;
    let sum = sum_of_plays(builder, name, plays.thresholds(), plays.weights(), &u);
    let m = builder.variable(plays.constant() + plays.linear() * u.clone() + sum);
    let of = |pick: fn(&DeadZone) -> f64| law.dead_zones.iter().map(pick).collect::<Vec<f64>>();
    add_dead_zones(builder, name, &of(|zone| zone.threshold), &of(|zone| zone.weight), &u, m);
    let m = Real::from(m);
    let f = builder.variable(&m);
    let beside = builder.variable(law.direct * x.clone());
    let count = law.relaxations.len();
    if count > 0 {
        let m_risen = since_before(builder, &m, 1);
        let of = |pick: fn(&_) -> f64| law.relaxations.iter().map(pick).collect::<Vec<f64>>();
        let times = builder.constants(&format!("{name}_time_constant"), of(|part| part.time_constant));
        let shares = builder.constants(&format!("{name}_share"), of(|part| part.share));
        let weights = builder.constants(&format!("{name}_input_weight"), of(|part| part.input_weight));
        let stresses = builder.state(&format!("{name}_stress"), vec![0.0; count]);
        let input_stresses = builder.state(&format!("{name}_input_stress"), vec![0.0; count]);
        builder.each(0_usize, count, |builder, k| {
            let (kept, gain) = decay(builder, &sample.step, &times.at(&k));
            builder.set(stresses, &k, &kept * stresses.at(&k) + &gain * &m_risen);
            builder.set(input_stresses, &k, kept * input_stresses.at(&k) + gain * &risen);
            builder.assign(f, Real::from(f) + shares.at(&k) * stresses.at(&k));
            builder.assign(beside, Real::from(beside) + weights.at(&k) * input_stresses.at(&k));
        });
    }
    let f = Real::from(f);
    let y = law.resonance.map_or_else(
        || f.clone(),
        |resonance| moved(builder, name, resonance, sample, [&before.at(2_usize), &f]),
    );
    for (place, value) in [&x, &m, &f].into_iter().enumerate() {
        builder.set(before, place, value);
    }
    builder.value(y + Real::from(beside))
}

/// `E` and `G` of a relaxation element (theory.md (1.11)).
fn decay(builder: &mut Builder, time_step: &Real, time_constant: &Real) -> (Real, Real) {
    let steps = builder.value(time_step / time_constant);
    let moves = steps.above(0.0);
    let back = builder.value(-&steps);
    let kept = builder.value(moves.clone().choose(back.exp(), 1.0));
    let gain = builder.value(moves.choose(-back.exp_m1() / &steps, 1.0));
    (kept, gain)
}

/// The displacement `q` under a force that went from one value to the other (theory.md (8.56)).
fn moved(
    builder: &mut Builder,
    name: &str,
    Resonance { frequency, damping }: Resonance,
    sample: &PartInputs,
    [f_before, f]: [&Real; 2],
) -> Real {
    let mode = Mode { frequency, damping, gain: 1.0, velocity_in_output: 0.0 };
    let factors = ModeFactors::new(builder, name, &[mode]);
    let motion = builder.state(&format!("{name}_motion"), vec![0.0; 2]);
    builder.when_else(
        sample.is_first.clone(),
        |builder| {
            builder.set(motion, 0_usize, f);
            builder.set(motion, 1_usize, 0.0);
        },
        |builder| {
            let length = builder.value(sample.step.above(0.0).choose(&sample.step, 0.0));
            factors.set(builder, &length);
            let (q, p) = (builder.value(motion.at(0_usize)), builder.value(motion.at(1_usize)));
            let mut of = |first: usize| {
                let factor = |place: usize| factors.at(first + place, &Whole::from(0_usize));
                builder.value(factor(0) * &q + factor(1) * &p + factor(2) * f_before + factor(3) * f)
            };
            let (q, p) = (of(0), of(4));
            builder.set(motion, 0_usize, q);
            builder.set(motion, 1_usize, p);
        },
    );
    motion.at(0_usize)
}
