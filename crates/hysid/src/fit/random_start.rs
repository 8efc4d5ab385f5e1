//! Random networks to start from.

use hysid_core::elementary::{ln, powf};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::network::{Architecture, ParameterLayout};
use crate::optimise::random::{normal, seed_of};

/// Smallest initial threshold, relative to the largest input; the largest is 1.
const SMALLEST_THRESHOLD: f64 = 0.01;

/// Standard deviation of the initial weights of the rate, where that of the input is 1.
const RATE_WEIGHT: f64 = 0.3;

/// Capacities that stops are drawn with: ln β is normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capacities {
    /// Median of `β`.
    pub typical: f64,
    /// Standard deviation of ln β.
    pub spread: f64,
}

const CAPACITIES: Capacities = Capacities { typical: 1000.0, spread: 1.0 };

/// The parameters of one of the starts of a network.
pub(crate) fn random(
    architecture: &Architecture,
    time_scales: Option<(f64, f64)>,
    seed: u64,
    start: usize,
) -> Vec<f64> {
    draw(architecture, CAPACITIES, time_scales, seed_of(seed, start as u64))
}

/// Random parameters; thresholds and relaxation times are spread evenly in their logarithms over the data's scales.
pub(crate) fn draw(
    architecture: &Architecture,
    capacities: Capacities,
    time_scales: Option<(f64, f64)>,
    seed: u64,
) -> Vec<f64> {
    let layout = ParameterLayout::new(*architecture);
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut values = vec![0.0; layout.len()];
    let channels = architecture.channels();
    let first_further_input = 1 + usize::from(architecture.rate);
    for (j, weights) in values[layout.stop_weights.clone()].chunks_exact_mut(channels).enumerate() {
        let place = (j as f64 + generator.random::<f64>()) / architecture.stops as f64;
        let threshold = powf(SMALLEST_THRESHOLD, 1.0 - place);
        weights[0] = 1.0 / threshold;
        if architecture.rate {
            weights[1] = RATE_WEIGHT * normal(&mut generator) / threshold;
        }
        for weight in &mut weights[first_further_input..] {
            *weight = normal(&mut generator) / threshold;
        }
    }
    for ln_beta in &mut values[layout.ln_beta.clone()] {
        *ln_beta = ln(capacities.typical) + capacities.spread * normal(&mut generator);
    }
    for (c, weight) in values[layout.linear.clone()].iter_mut().enumerate() {
        *weight = if c == 0 { 1.0 } else { RATE_WEIGHT * normal(&mut generator) };
    }
    if let Some((step, longest)) = time_scales {
        for (m, ln_tau) in values[layout.ln_tau.clone()].iter_mut().enumerate() {
            let place = (m % architecture.relaxation) as f64 + generator.random::<f64>();
            let share = place / architecture.relaxation as f64;
            *ln_tau = ln(step) + share * ln(longest / step);
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
