//! Motion at the first sample of a record that begins in mid-motion, found from outputs at its beginning.
//!
//! ```text
//! min_u Σ_k (y_k - ŷ_k(u))²/(σ_f σ)² + |u|²,    u = [Q, P],   σ_f = 0.01       theory.md (15.25)
//! ```
//!
//! `Q` and `P` are displacements and velocities of the modes at the first sample, beside those at rest. The memory of the
//! elements is that of a record from rest.

use super::{Dynamics, DynamicsMotion};
use crate::law::{Sample, state_search};
use crate::linear_algebra::Symmetric;

/// `σ_f`: error of the output in scaled units beside which motions of 1 are as likely as rest. Designed.
const DEVIATION: f64 = 0.01;

const STEPS: usize = 20;

/// Step of a finite difference.
const DIFFERENCE: f64 = 1e-6;

impl Dynamics {
    /// Before the first sample, with these displacements and then velocities of the modes at it.
    pub(crate) fn begun_with(&self, beginning: &[f64]) -> DynamicsMotion {
        let mut motion = self.virgin();
        motion.beginning = beginning.to_vec();
        motion
    }

    /// Displacements and then velocities at the first sample, from known outputs, NaN where they are not known.
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
