//! Loss over frequency: the mean loss of the cycles of one amplitude and one frequency.

use serde::Serialize;

use super::loss_separation::Separation;
use super::row::CycleRow;

/// Cycles whose amplitudes and frequencies differ by less than this share are taken together.
const ALIKE: f64 = 0.05;

/// The loss of the cycles of one amplitude at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LossAtFrequency {
    /// Amplitude of the input, in its unit.
    pub amplitude: f64,
    /// Half the range of the output.
    pub output_amplitude: f64,
    /// Frequency, in cycles per unit of time.
    pub frequency: f64,
    /// Mean energy lost in a cycle.
    pub energy: f64,
    /// Mean energy lost per unit of time.
    pub power: f64,
    /// The same per mass, if the mass density is known.
    pub power_per_mass: Option<f64>,
    /// Hysteresis loss of a cycle, by the separation of the losses of all amplitudes and frequencies.
    pub hysteresis: Option<f64>,
    /// Eddy-current loss of a cycle, by the same.
    pub eddy: Option<f64>,
    /// Excess loss of a cycle, by the same.
    pub excess: Option<f64>,
    /// Number of cycles.
    pub cycles: usize,
}

/// The losses of all cycles with a frequency, by amplitude, then by frequency; per mass for magnets of a density.
pub(super) fn losses(
    rows: &[CycleRow],
    separation: Option<&Separation>,
    density: Option<f64>,
) -> Vec<LossAtFrequency> {
    let mut groups: Vec<Vec<[f64; 4]>> = Vec::new();
    for row in rows {
        let figures = (row.amplitude, row.frequency, row.energy, row.output_min.zip(row.output_max));
        let (Some(amplitude), Some(frequency), Some(energy), Some((low, high))) = figures else { continue };
        let loss = [amplitude, frequency, energy, 0.5 * (high - low)];
        let is_same =
            |group: &&mut Vec<[f64; 4]>| alike(group[0][0], amplitude) && alike(group[0][1], frequency);
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push(loss),
            None => groups.push(vec![loss]),
        }
    }
    let mut losses: Vec<LossAtFrequency> =
        groups.iter().map(|group| mean(group, separation, density)).collect();
    losses.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
    for one_amplitude in losses.chunk_by_mut(|a, b| alike(a.amplitude, b.amplitude)) {
        one_amplitude.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    }
    losses
}

fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= ALIKE * a.abs().max(b.abs())
}

fn mean(group: &[[f64; 4]], separation: Option<&Separation>, density: Option<f64>) -> LossAtFrequency {
    let mean = |of: &dyn Fn(&[f64; 4]) -> f64| group.iter().map(of).sum::<f64>() / group.len() as f64;
    let (output_amplitude, frequency) = (mean(&|cycle| cycle[3]), mean(&|cycle| cycle[1]));
    let parts = separation.map(|separation| separation.parts(output_amplitude, frequency));
    let power = mean(&|cycle| cycle[1] * cycle[2]);
    LossAtFrequency {
        output_amplitude,
        hysteresis: parts.map(|parts| parts[0]),
        eddy: parts.map(|parts| parts[1]),
        excess: parts.map(|parts| parts[2]),
        amplitude: mean(&|cycle| cycle[0]),
        frequency,
        energy: mean(&|cycle| cycle[2]),
        power,
        power_per_mass: density.map(|density| power / density),
        cycles: group.len(),
    }
}
