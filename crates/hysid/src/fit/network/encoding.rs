//! The genes of a network, theory.md (3.9): its searched parameters, with thresholds `r = 1/w` in the
//! place of the stops' first weights. A threshold is what spreads evenly over a range of inputs.

use std::ops::Range;

use hysid_core::elementary::ln;
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use crate::fit::network::objective::Objective;
use crate::fit::network::soundness::NetworkFrame;
use crate::optimise::random::normal;

/// Largest threshold, in half ranges of the input: beyond 1 a stop no longer slides.
const LARGEST_THRESHOLD: f64 = 1.2;
/// Smallest threshold, in largest ones.
const SMALLEST_THRESHOLD: f64 = 1e-3;
/// Largest magnitude of a stop's weight of the rate or of a further input.
const LARGEST_WEIGHT: f64 = 3.0;
/// log10 of the smallest and the largest β; the latter stands for no deterioration.
const LOG10_BETA: (f64, f64) = (0.5, 7.0);
/// Largest magnitude of a bias, and of a weight of the linear neuron.
const LARGEST_BIAS: f64 = 2.0;
/// Largest magnitude of a tanh neuron's weight, in deviations of the first population.
const LARGEST_DEVIATION: f64 = 10.0;

/// Bounds of the genes and the way between genes and parameters.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Encoding {
    bounds: Vec<(f64, f64)>,
    /// Genes that are thresholds: the first of each run of a stop's weights.
    stop_weights: Range<usize>,
    channels: usize,
    /// Genes that are weights or biases of tanh neurons: a run for each, the bias first.
    hidden: Range<usize>,
    run: usize,
}

impl Encoding {
    pub fn new(objective: &Objective) -> Self {
        let architecture = objective.architecture();
        let layout = objective.layout();
        let channels = architecture.channels();
        let run = 1 + architecture.memory_neurons();
        let largest = LARGEST_THRESHOLD * objective.half_range_of_input().max(1e-3);
        let spread = deviation(run);
        let (shortest, longest) = objective.time_scales().unwrap_or((1.0, 1.0));
        let ln_beta = (LOG10_BETA.0 * std::f64::consts::LN_10, LOG10_BETA.1 * std::f64::consts::LN_10);
        let bound = |index: usize| {
            let (low, high) = layout.bounds(index);
            let wanted = if layout.stop_weights.contains(&index) {
                match (index - layout.stop_weights.start) % channels {
                    // A threshold is bounded as its weight is.
                    0 => return ((SMALLEST_THRESHOLD * largest).max(1.0 / high), largest),
                    _ => (-LARGEST_WEIGHT, LARGEST_WEIGHT),
                }
            } else if layout.ln_beta.contains(&index) {
                ln_beta
            } else if layout.linear.contains(&index) {
                (-LARGEST_BIAS, LARGEST_BIAS)
            } else if layout.ln_tau.contains(&index) {
                (ln(shortest), ln(longest))
            } else if (index - layout.hidden.start).is_multiple_of(run) {
                (-LARGEST_BIAS, LARGEST_BIAS)
            } else {
                (-LARGEST_DEVIATION * spread, LARGEST_DEVIATION * spread)
            };
            (wanted.0.clamp(low, high), wanted.1.clamp(low, high))
        };
        Self {
            bounds: (0..layout.len()).map(bound).collect(),
            stop_weights: layout.stop_weights.clone(),
            channels,
            hidden: layout.hidden.clone(),
            run,
        }
    }

    /// True if all that its genes can stand for are parameters of the network.
    pub fn is_sound(&self, frame: &NetworkFrame) -> bool {
        let NetworkFrame { layout, architecture, .. } = frame;
        let has_layout = self.stop_weights == layout.stop_weights
            && self.channels == architecture.channels()
            && self.hidden == layout.hidden
            && self.run == 1 + architecture.memory_neurons();
        let ends = |end: fn(&(f64, f64)) -> f64| self.bounds.iter().map(end).collect::<Vec<f64>>();
        let (low, high) = (ends(|bounds| bounds.0), ends(|bounds| bounds.1));
        has_layout
            && self.bounds.len() == layout.len()
            && low.iter().zip(&high).all(|(low, high)| low <= high)
            && frame.are_parameters(&self.parameters(&low))
            && frame.are_parameters(&self.parameters(&high))
            && low[self.stop_weights.clone()].iter().step_by(self.channels).all(|threshold| *threshold > 0.0)
    }

    /// Lowest and highest value of each gene.
    pub fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    /// Genes of a first individual: weights of tanh neurons normal, all else evenly within its bounds.
    pub fn draw(&self, generator: &mut impl Rng) -> Vec<f64> {
        let gene = |(index, &(low, high)): (usize, &(f64, f64))| {
            let is_weight =
                self.hidden.contains(&index) && !(index - self.hidden.start).is_multiple_of(self.run);
            match is_weight {
                true => deviation(self.run) * normal(generator),
                false => low + (high - low) * generator.random::<f64>(),
            }
        };
        self.bounds.iter().enumerate().map(gene).collect()
    }

    /// The parameters that genes stand for.
    pub fn parameters(&self, genes: &[f64]) -> Vec<f64> {
        let mut parameters = genes.to_vec();
        for threshold in parameters[self.stop_weights.clone()].iter_mut().step_by(self.channels) {
            *threshold = 1.0 / *threshold;
        }
        parameters
    }
}

/// Deviation of a tanh neuron's weights for sums of about 1.
fn deviation(run: usize) -> f64 {
    1.0 / (run as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{powi, sin};

    use super::*;
    use crate::data::record::{ColumnNames, Dataset, Record};
    use crate::network::scaling::Scaling;
    use crate::network::{Family, Sizes};
    use crate::options::network::FitOptions;

    #[test]
    fn every_gene_within_its_bounds_is_a_parameter_within_its_own() {
        // A range that fills the scale, and one that is a ten-thousandth of it.
        for offset in [0.0, 10_000.0] {
            let x: Vec<f64> = (0..60).map(|k| offset + sin(0.3 * k as f64)).collect();
            let y = x.iter().map(|x| powi(x - offset, 3)).collect();
            let data =
                Dataset::new(ColumnNames::plain(1), vec![Record::new("r", vec![x], y).unwrap()]).unwrap();
            let sizes = Sizes { stops: 3, hidden: 2, relaxation: 0 };
            let options = FitOptions { model: Family::Xpnn, sizes, ..FitOptions::default() };
            let scaling = Scaling::of(&data, None).unwrap();
            let architecture = options.architecture(&data).unwrap();
            let objective = Objective::new(&data, &scaling, architecture, &options).unwrap();
            let encoding = Encoding::new(&objective);
            let genes = |end: fn(&(f64, f64)) -> f64| encoding.bounds().iter().map(end).collect::<Vec<f64>>();
            for genes in [genes(|bounds| bounds.0), genes(|bounds| bounds.1)] {
                objective.layout().check(&encoding.parameters(&genes)).unwrap();
            }
        }
    }
}
