//! Motion at the first sample of a record that begins in mid-motion, found from outputs at its beginning.
//!
//! ```text
//! min_u Σ_k (y_k - ŷ_k(u))²/(σ_f σ)² + |u|²,    u = [Δq, Δp],   σ_f = 0.01     theory.md (15.25)
//! ```
//!
//! `Δq` and `Δp` are the differences of displacements and velocities of the modes at the first sample from those of a record
//! from rest. The memory of the elements is that of a record from rest.

use super::{Dynamics, DynamicsMotion};
use crate::law::{Sample, state_search};
use crate::linear_algebra::Symmetric;

/// `σ_f`: standard deviation of the output error in scaled units; that of `u` is 1. Designed.
const DEVIATION: f64 = 0.01;

/// Most steps of the search.
const STEPS: usize = 20;

/// Step of a finite difference.
const DIFFERENCE: f64 = 1e-6;

impl Dynamics {
    /// At rest before the first sample; there, displacements and then velocities of the modes differ by these from rest.
    pub(crate) fn begun_with(&self, beginning: &[f64]) -> DynamicsMotion {
        let mut motion = self.virgin();
        motion.beginning = beginning.to_vec();
        motion
    }

    /// Differences of displacements and then velocities from rest at the first sample, from known outputs, NaN where they are
    /// not known.
    pub(crate) fn found_states(&self, samples: &[Sample], known: &[f64]) -> Vec<f64> {
        let residuals = |u: &[f64]| -> Vec<f64> {
            let mut motion = self.begun_with(u);
            let outputs = samples.iter().map(|&sample| self.step(&mut motion, sample));
            let compared = outputs.zip(known).filter(|(_, y)| !y.is_nan());
            compared.map(|(output, y)| (output - y) / (DEVIATION * self.output_scale)).collect()
        };
        let square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let objective = |u: &[f64]| square(&residuals(u)) + square(u);
        let slope = |u: &[f64]| {
            let at = residuals(u);
            let column = |i: usize| -> Vec<f64> {
                let mut moved = u.to_vec();
                moved[i] += DIFFERENCE;
                residuals(&moved).iter().zip(&at).map(|(moved, at)| (moved - at) / DIFFERENCE).collect()
            };
            let columns: Vec<Vec<f64>> = (0..u.len()).map(column).collect();
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let gradient = columns.iter().zip(u).map(|(column, u)| u + product(column, &at)).collect();
            let mut curvature = Symmetric::from_fn(u.len(), |i, j| product(&columns[i], &columns[j]));
            (0..u.len()).for_each(|i| curvature.add_to_diagonal(i, 1.0));
            (gradient, curvature)
        };
        let rest = vec![0.0; 2 * self.modes.len()];
        let from_rest = objective(&rest);
        state_search::descended(rest, from_rest, STEPS, objective, slope)
    }
}
