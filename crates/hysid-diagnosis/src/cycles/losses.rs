//! Loss over frequency: the mean loss of the cycles of one amplitude and one frequency.

use serde::Serialize;

use super::row::CycleRow;

/// Cycles whose amplitudes and frequencies differ by less than this share are taken together.
const ALIKE: f64 = 0.05;

/// The loss of the cycles of one amplitude at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LossAtFrequency {
    /// Amplitude of the input, in its unit.
    pub amplitude: f64,
    /// Frequency, in cycles per unit of time.
    pub frequency: f64,
    /// Mean energy lost in a cycle.
    pub energy: f64,
    /// Mean energy lost per unit of time.
    pub power: f64,
    /// Number of cycles.
    pub cycles: usize,
}

/// The losses of all cycles with a frequency, by amplitude, then by frequency.
pub(super) fn losses(rows: &[CycleRow]) -> Vec<LossAtFrequency> {
    let mut groups: Vec<Vec<[f64; 3]>> = Vec::new();
    for row in rows {
        let (Some(amplitude), Some(frequency), Some(energy)) = (row.amplitude, row.frequency, row.energy)
        else {
            continue;
        };
        let is_same =
            |group: &&mut Vec<[f64; 3]>| alike(group[0][0], amplitude) && alike(group[0][1], frequency);
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push([amplitude, frequency, energy]),
            None => groups.push(vec![[amplitude, frequency, energy]]),
        }
    }
    let mut losses: Vec<LossAtFrequency> = groups.iter().map(|group| mean(group)).collect();
    losses.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
    for one_amplitude in losses.chunk_by_mut(|a, b| alike(a.amplitude, b.amplitude)) {
        one_amplitude.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    }
    losses
}

fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= ALIKE * a.abs().max(b.abs())
}

fn mean(group: &[[f64; 3]]) -> LossAtFrequency {
    let mean = |of: &dyn Fn(&[f64; 3]) -> f64| group.iter().map(of).sum::<f64>() / group.len() as f64;
    LossAtFrequency {
        amplitude: mean(&|cycle| cycle[0]),
        frequency: mean(&|cycle| cycle[1]),
        energy: mean(&|cycle| cycle[2]),
        power: mean(&|cycle| cycle[1] * cycle[2]),
        cycles: group.len(),
    }
}
