//! Viscoelastic laws: springs and dashpots. Christensen, Theory of Viscoelasticity (1982), section 1.3.

use hysid_core::elementary::exp;

use super::{Law, Specimen};

/// `y = k x + c x'` beside springs in series with dashpots, `y_m' = k_m x' - y_m/τ_m`.
struct Springs {
    spring: f64,
    dashpot: f64,
    /// Stiffness, relaxation time and force.
    maxwell: Option<(f64, f64, f64)>,
    x: f64,
}

impl Specimen for Springs {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        let speed = if seconds > 0.0 { (x - self.x) / seconds } else { 0.0 };
        self.x = x;
        let mut force = self.spring * x + self.dashpot * speed;
        if let Some((stiffness, time, state)) = &mut self.maxwell {
            // Exact while the speed is constant.
            let steady = *stiffness * *time * speed;
            *state = steady + (*state - steady) * exp(-seconds / *time);
            force += *state;
        }
        force
    }
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "kelvin-voigt",
            answers: "n y y  - - -  y -  n y",
            why: "spring and dashpot: the loop vanishes at rest",
            specimen: || Box::new(Springs { spring: 1.0, dashpot: 0.15, maxwell: None, x: 0.0 }),
        },
        Law {
            name: "maxwell",
            answers: "n y y  - - -  y -  n y",
            why: "a fluid: the force itself vanishes at rest",
            specimen: || {
                Box::new(Springs { spring: 0.0, dashpot: 0.0, maxwell: Some((1.0, 0.15, 0.0)), x: 0.0 })
            },
        },
        Law {
            name: "standard-linear-solid",
            answers: "n y y  - - -  y -  n y",
            why: "the loop is widest about the relaxation time and vanishes at rest",
            specimen: || {
                Box::new(Springs { spring: 0.5, dashpot: 0.0, maxwell: Some((1.0, 0.15, 0.0)), x: 0.0 })
            },
        },
    ]
}
