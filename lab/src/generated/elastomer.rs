//! Rubber bush: a spring that stiffens, friction after Berg, and Maxwell elements.
//!
//! ```text
//! f = k x + k_3 x³ + F + Σ_i m_i σ_i,   σ_i' = x' - σ_i/τ_i                 theory.md (6.37), (1.10)
//! F = F_s ± |x - x_s|/{x_2 (1 ∓ μ) + |x - x_s|} (F_f ∓ F_s),   μ = F_s/F_f  theory.md (6.38)
//! ```
//!
//! `x` is the displacement in mm, `f` the force in N, `F` its friction part and `σ_i` the states of the
//! Maxwell elements. The upper signs hold upwards. `(x_s, F_s)` is the last turning point; from there `F`
//! approaches `±F_f`, half of it within `x_2` from rest. Source: Berg (1998). *Designed*: the values.

use hysid_core::operator::relaxation;

/// Values of a bush.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ElastomerParameters {
    /// `k` in N/mm.
    pub stiffness: f64,
    /// `k_3` in N/mm³.
    pub stiffening: f64,
    /// `F_f` in N.
    pub friction: f64,
    /// `x_2` in mm.
    pub friction_displacement: f64,
    /// `m_i` in N/mm and `τ_i` in s.
    pub elements: Vec<(f64, f64)>,
}

/// A bush with its memory, at rest at first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Elastomer {
    parameters: ElastomerParameters,
    x: f64,
    direction: f64,
    friction: f64,
    /// `x_s`, `F_s`.
    turned: (f64, f64),
    stresses: Vec<f64>,
}

impl Elastomer {
    pub fn new(parameters: ElastomerParameters) -> Self {
        let stresses = vec![0.0; parameters.elements.len()];
        Self { parameters, x: 0.0, direction: 0.0, friction: 0.0, turned: (0.0, 0.0), stresses }
    }

    /// The force in N at the next displacement in mm, `duration` s later; the displacement goes there
    /// straight.
    pub fn step(&mut self, x: f64, duration: f64) -> f64 {
        let values = &self.parameters;
        let by = x - self.x;
        if by != 0.0 {
            if by.signum() != self.direction {
                self.turned = (self.x, self.friction);
                self.direction = by.signum();
            }
            let (from, start) = self.turned;
            let way = (x - from).abs();
            let start = self.direction * start;
            let reach = values.friction_displacement * (1.0 - start / values.friction);
            self.friction = self.direction * (start + way / (reach + way) * (values.friction - start));
        }
        let mut force = values.stiffness * x + values.stiffening * x * x * x + self.friction;
        for (stress, (stiffness, tau)) in self.stresses.iter_mut().zip(&values.elements) {
            *stress = relaxation::advance(*stress, by, relaxation::decay(duration, *tau));
            force += stiffness * *stress;
        }
        self.x = x;
        force
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    fn bush(elements: Vec<(f64, f64)>) -> Elastomer {
        Elastomer::new(ElastomerParameters {
            stiffness: 0.0,
            stiffening: 0.0,
            friction: 30.0,
            friction_displacement: 0.5,
            elements,
        })
    }

    /// By hand: half of the friction at `x_2` from rest; from there `μ = 1/2`, and on the way back
    /// `F = 15 - way/(0.75 + way) 45`.
    #[test]
    fn friction_by_hand() {
        let mut bush = bush(Vec::new());
        let force = [0.5, 0.25, -0.25].map(|x| bush.step(x, 0.0));
        for (force, expected) in force.into_iter().zip([15.0, 3.75, -7.5]) {
            assert!((force - expected).abs() < 1e-8, "{force} {expected}");
        }
    }

    #[test]
    fn the_friction_never_exceeds_its_limit() {
        let mut bush = bush(vec![(0.0, 1.0)]);
        for k in 0..1000 {
            let force = bush.step(3.0 * sin(0.37 * f64::from(k)) + 2.0 * sin(0.11 * f64::from(k)), 0.01);
            assert!(force.abs() < 30.0);
        }
    }
}
