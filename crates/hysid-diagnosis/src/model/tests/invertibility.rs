//! Invertibility of laws and networks of known weights.

use super::*;
use hysid_core::law::Classical;
use hysid_core::law::masing::{Masing, MasingParts};
use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid_core::law::preisach::{Preisach, PreisachWeights};

fn examined(model: &Model) -> Invertibility {
    let diagnosis = ModelDiagnosis::of(model).unwrap();
    assert_eq!(diagnosis.verdict(Property::Invertible), diagnosis.invertibility.finding.verdict);
    diagnosis.invertibility
}

fn of_law(law: impl Into<Classical>, name: ClassicalModel, rate: bool) -> Invertibility {
    let request = FitSpec::Classical(ClassicalOptions::of(name));
    examined(&model(Predictor::Law(law.into()), request, rate.then_some(RateMethod::Central)))
}

fn plays(linear: f64, thresholds: &[f64], weights: &[f64]) -> Invertibility {
    let law = PrandtlIshlinskii::new(10.0, linear, thresholds.to_vec(), weights.to_vec()).unwrap();
    of_law(law, ClassicalModel::PrandtlIshlinskii, false)
}

fn near(found: (f64, f64), exact: (f64, f64)) {
    let apart = (found.0 - exact.0).abs().max((found.1 - exact.1).abs());
    assert!(apart <= 1e-9, "{found:?}, not {exact:?}");
}

/// A play goes with the input where it must: to `-X + r` at most at the lowest input, from `X - r` or from 0.
#[test]
fn plays_with_positive_weights_reach_what_their_states_allow() {
    let (linear, thresholds, weights) = (0.3, [0.4, 1.2, 2.5], [1.0, 0.7, 0.2]);
    let found = plays(linear, &thresholds, &weights);
    assert_eq!((found.finding.verdict, found.direction), (Verdict::Yes, OutputDirection::Rising));
    // Below the rounding of outputs around 10.
    assert!(found.finding.index.unwrap() < 1e-14 && found.jumps == 0 && found.flat_share == 0.0);
    let of_plays = |x: f64, play: fn(f64, f64) -> f64| {
        let plays = thresholds.iter().zip(&weights).map(|(&r, w)| w * play(x, r));
        10.0 + linear * x + plays.sum::<f64>()
    };
    // From the highest and the lowest state that any past leaves.
    let low = of_plays(-X, |x, r| f64::min(f64::max(0.0, X - r), x + r));
    let high = of_plays(X, |x, r| f64::max(f64::min(0.0, r - X), x - r));
    near(found.always.unwrap(), (low, high));
    near(found.monotone_outputs.unwrap(), (low, high));
    assert_eq!((found.shortest_time_step, found.worst, found.time_steps.len()), (None, None, 0));
    assert_eq!(found.pasts, found.scans);
}

/// Without a play that moves at once, the output rests while the input goes through the plays.
#[test]
fn plays_alone_rest_after_a_reversal() {
    let found = plays(0.0, &[1.0, 2.0], &[1.0, 1.0]);
    assert_eq!(found.finding.verdict, Verdict::Yes);
    assert!(found.flat_share > 0.1, "{}", found.flat_share);
    assert!(found.finding.statement.contains("does not change"), "{}", found.finding.statement);
}

#[test]
fn plays_with_negative_weights_fall() {
    let found = plays(-0.3, &[0.4, 1.2], &[-1.0, -0.7]);
    assert_eq!((found.finding.verdict, found.direction), (Verdict::Yes, OutputDirection::Falling));
    let (low, high) = found.always.unwrap();
    assert!(low < 10.0 && high > 10.0);
}

/// From the highest input the play of 1.5 moves below 0, and the slope is `1 + 0.8 - 2.2`.
#[test]
fn a_sum_of_weights_that_turns_negative_is_found_where_it_turns() {
    let found = plays(1.0, &[0.5, 1.5], &[0.8, -2.2]);
    assert_eq!((found.finding.verdict, found.direction), (Verdict::No, OutputDirection::Rising));
    let worst = found.worst.unwrap();
    assert_eq!((worst.kind, worst.time_step), (PlaceKind::Reversal, None));
    // By symmetry, to the lowest input or to the highest one.
    near((worst.inputs.0.min(0.0), worst.inputs.1.max(0.0)), worst.inputs);
    assert!((worst.inputs.1 - worst.inputs.0 - X).abs() < 1e-9, "{worst:?}");
    assert!((worst.outputs.0 - worst.outputs.1 - 0.4 * X).abs() < 1e-9, "{worst:?}");
    assert_eq!(found.finding.evidence[0].pieces[0].record, worst.path);
    assert_eq!(found.finding.index, Some(worst.size));
    let words = &found.finding.statement;
    assert!(words.contains("the output falls by") && words.contains("several inputs"), "{words}");
}

/// A single relay that switches at -1 and 1.
#[test]
fn a_relay_jumps() {
    let narrow = 1e-13;
    let lines = vec![-X, -1.0 - narrow, -1.0, 1.0, 1.0 + narrow, X];
    // Switches up in the interval from 1, down in that to -1: row 3, column 1.
    let cells = (0..15).map(|cell| if cell == 7 { 0.5 } else { 0.0 }).collect();
    let weights = PreisachWeights { constant: 2.0, slope: 0.01, lines, reversible: vec![0.0; 5], cells };
    let found = of_law(Preisach::new(weights).unwrap(), ClassicalModel::Preisach, false);
    assert_eq!(found.finding.verdict, Verdict::No);
    let worst = found.worst.unwrap();
    assert_eq!(worst.kind, PlaceKind::Jump);
    assert!((worst.inputs.0.abs() - 1.0).abs() < 1e-9, "{worst:?}");
    assert!((worst.outputs.1 - worst.outputs.0 - 1.0).abs() < 1e-3, "{worst:?}");
    assert!(found.jumps > 50 && found.finding.statement.contains("jumps"), "{}", found.finding.statement);
}

#[test]
fn a_flat_virgin_curve_has_many_inputs() {
    let parts = MasingParts { constant: 0.0, thresholds: vec![1.0], slopes: vec![2.0, 0.0] };
    let found = of_law(Masing::new(parts).unwrap(), ClassicalModel::Masing, false);
    assert_eq!((found.finding.verdict, found.jumps), (Verdict::Yes, 0));
    // After a reversal, it is flat beyond twice the threshold.
    assert!((0.2..0.7).contains(&found.flat_share), "{}", found.flat_share);
    near(found.always.unwrap(), (-2.0, 2.0));
}

#[test]
fn a_small_network_is_judged_by_its_weights() {
    let sizes = Sizes { stops: 2, hidden: 1, relaxation: 0 };
    let architecture = Architecture::new(Family::Xpnn, sizes, 1, false, true).unwrap();
    // Two stops, their ln β, the linear neuron, then bias and weights of linear neuron and stops.
    let of = |spring: f64, stop: f64| {
        let parameters = vec![1.3, 6.0, 12.0, 12.0, 1.0, 0.1, spring, stop, 0.3];
        examined(&network(architecture, parameters, vec![0.0, 1.0]))
    };
    let rising = of(0.5, 0.4);
    assert_eq!((rising.finding.verdict, rising.direction), (Verdict::Yes, OutputDirection::Rising));
    let falling = of(-0.5, -0.1);
    // The stop of weight 6 slips soon; before it does, it outweighs the others.
    assert_eq!((falling.finding.verdict, falling.direction), (Verdict::No, OutputDirection::Falling));
    // A stop against the spring: backwards as long as it sticks.
    assert_eq!(of(0.5, -0.9).finding.verdict, Verdict::No);
}

/// `y = k x - c x'`: from sample to sample the output rises by `k Δx - c Δx/Δt`.
#[test]
fn a_lag_needs_long_time_steps() {
    let (k, c) = (1.5, 0.2);
    let lag = |c: f64| BoucWen { damping: -c, ..BoucWen::new(k, 0.0, 1.0).unwrap() };
    let found = of_law(lag(c), ClassicalModel::BoucWen, true);
    assert_eq!((found.finding.verdict, found.direction), (Verdict::No, OutputDirection::Rising));
    // Time steps that were tried are twice as long as the one before.
    let shortest = found.shortest_time_step.unwrap();
    assert!(shortest > c / k && shortest <= 2.0 * c / k, "{shortest}");
    assert!(found.time_steps.is_sorted_by(|a, b| a.time_step < b.time_step));
    for at in &found.time_steps {
        assert_eq!(at.index > 1e-6, at.time_step < shortest, "{at:?}");
    }
    let words = &found.finding.statement;
    assert!(words.contains("with a time step of") && words.contains("or longer it rises"), "{words}");
    // The other sign helps, and too little of it does no harm at steps that decide.
    assert_eq!(of_law(lag(-c), ClassicalModel::BoucWen, true).finding.verdict, Verdict::Yes);
    let little = of_law(lag(0.001), ClassicalModel::BoucWen, true);
    assert_eq!(little.finding.verdict, Verdict::Yes);
    assert!(little.shortest_time_step.unwrap() <= 0.001 / k * 2.0);
}
