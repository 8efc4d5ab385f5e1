//! Search for the state before a record by the Levenberg-Marquardt method.

use crate::linear_algebra::Symmetric;
use crate::stop_check::StopCheck;

/// Relative fall of the objective below which the search ends.
const LEAST_FALL: f64 = 1e-6;

/// Minimises a least-squares objective by at most so many Levenberg-Marquardt steps from `u`, where it has the value
/// `objective`, and returns the best `u`. `slope` gives half the gradient and the Gauss-Newton matrix.
pub fn descended(
    mut u: Vec<f64>,
    mut objective: f64,
    steps: usize,
    objective_at: impl Fn(&[f64]) -> f64,
    slope: impl Fn(&[f64]) -> (Vec<f64>, Symmetric),
) -> Vec<f64> {
    let mut damping = 1e-3;
    for _ in 0..steps {
        let (gradient, curvature) = slope(&u);
        let mut damped = curvature.clone();
        (0..u.len()).for_each(|i| damped.add_to_diagonal(i, damping * curvature.diagonal(i)));
        let mut step = gradient;
        let Some(factor) = damped.cholesky(StopCheck::never()) else { break };
        factor.solve(&mut step);
        let there: Vec<f64> = u.iter().zip(&step).map(|(u, step)| u - step).collect();
        let found = objective_at(&there);
        if found < objective {
            let is_small = objective - found < LEAST_FALL * objective;
            (objective, u, damping) = (found, there, 0.1 * damping);
            if is_small {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    u
}
