//! Random networks to start from.

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::training::objective::Objective;

/// Thresholds start between this share of the largest input and the whole of it.
const SMALLEST_THRESHOLD: f64 = 0.01;

/// β starts here, times or divided by about e.
const TYPICAL_BETA: f64 = 1000.0;

/// Parameters of start number `start`: thresholds spread evenly in their logarithm over the input
/// range, all else drawn at random. Each start has its own generator, so that it does not matter
/// which thread draws first.
pub(crate) fn random(objective: &Objective, seed: u64, start: usize) -> Vec<f64> {
    let architecture = objective.architecture();
    let layout = objective.layout();
    let mut generator =
        Xoshiro256PlusPlus::seed_from_u64(seed ^ (start as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut values = vec![0.0; layout.len()];
    let channels = architecture.channels();
    let first_further_input = 1 + usize::from(architecture.rate);
    for (j, weights) in values[layout.stop_weights.clone()].chunks_exact_mut(channels).enumerate() {
        let place = (j as f64 + generator.random::<f64>()) / architecture.stops as f64;
        let threshold = SMALLEST_THRESHOLD.powf(1.0 - place);
        weights[0] = 1.0 / threshold;
        if architecture.rate {
            weights[1] = normal(&mut generator) * 0.3 / threshold;
        }
        for weight in &mut weights[first_further_input..] {
            *weight = normal(&mut generator) / threshold;
        }
    }
    for ln_beta in &mut values[layout.ln_beta.clone()] {
        *ln_beta = TYPICAL_BETA.ln() + normal(&mut generator);
    }
    for (c, weight) in values[layout.linear.clone()].iter_mut().enumerate() {
        *weight = if c == 0 { 1.0 } else { 0.3 * normal(&mut generator) };
    }
    if let Some((step, longest)) = objective.time_scales() {
        for (m, ln_tau) in values[layout.ln_tau.clone()].iter_mut().enumerate() {
            let place = (m % architecture.relaxation) as f64 + generator.random::<f64>();
            let share = place / architecture.relaxation as f64;
            *ln_tau = step.ln() + share * (longest / step).ln();
        }
    }
    let run = 1 + architecture.memory_neurons();
    let spread = 1.0 / (run as f64).sqrt();
    for neuron in values[layout.hidden.clone()].chunks_exact_mut(run) {
        for weight in neuron {
            *weight = spread * normal(&mut generator);
        }
    }
    layout.clamp(&mut values);
    values
}

/// A standard normal number, by Box and Muller.
pub(crate) fn normal(generator: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}
