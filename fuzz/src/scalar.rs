//! The networks as theory.md has them, (2.2) to (2.6): one sample and one neuron at a time, from the operators alone.

use hysid::operator::{DeterioratingStop, Operator, Relaxation};
use hysid_core::elementary::{exp, tanh};
use hysid_core::network::{Network, NetworkDrive, ParameterLayout};

/// The scaled outputs of a network, from the virgin state.
pub fn outputs(network: &Network, drive: &NetworkDrive) -> Vec<f64> {
    let (a, all) = (network.architecture(), network.parameters());
    let layout = ParameterLayout::new(*a);
    let weights: Vec<&[f64]> = all[layout.stop_weights].chunks_exact(a.channels()).collect();
    let linear = &all[layout.linear];
    let hidden: Vec<&[f64]> = all[layout.hidden].chunks_exact(1 + a.memory_neurons()).collect();
    let beta = |j: usize| all[layout.ln_beta.clone()].get(j).map_or(f64::INFINITY, |ln_beta| exp(*ln_beta));
    let stop = |j: usize| DeterioratingStop::new(1.0, beta(j)).expect("a capacity above 0");
    let mut stops: Vec<DeterioratingStop> = (0..a.stops).map(stop).collect();
    let element = |ln_tau: &f64| Relaxation::new(exp(*ln_tau)).expect("a time above 0");
    let mut relaxing: Vec<Relaxation> = all[layout.ln_tau].iter().map(element).collect();

    let row = |k: usize| {
        let u: Vec<f64> = drive.channels.iter().map(|channel| channel[k]).collect();
        let mut z = Vec::new();
        if a.linear {
            z.push(dot(linear, &u));
        }
        z.extend(stops.iter_mut().zip(&weights).map(|(stop, w)| stop.step(dot(w, &u))));
        for (m, element) in relaxing.iter_mut().enumerate() {
            let input = m / a.relaxation;
            let channel = if input > 0 && a.rate { input + 1 } else { input };
            z.push(element.step(u[channel], drive.steps[k]));
        }
        let h = hidden.iter().map(|neuron| tanh(neuron[0] + dot(&neuron[1..], &z)));
        let mut features = vec![1.0];
        features.extend(h);
        if a.direct || a.hidden == 0 {
            features.extend(&z);
        }
        dot(network.output(), &features)
    };
    (0..drive.len()).map(row).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
