//! Magnetorheological damper: friction that yields and a viscous force that saturates, with a lag for the
//! compressibility of the fluid.
//!
//! ```text
//! f = k x + f_0 + F_y z + c v + F_v tanh(v/v_0),   τ v' = x' - v            theory.md (6.39)
//! ```
//!
//! `x` is the displacement in mm, `f` the force in N, `v` the lagged speed in mm/s, and `z`, from -1 to 1, a
//! [Bouc-Wen element](hysid_core::law::bouc_wen). Source: the Bouc-Wen damper of Spencer, Dyke, Sain and
//! Carlson; the hyperbolic tangent of the speed of Kwok and co-workers. *Designed*: the lag before both, and
//! the values.

use hysid_core::elementary::tanh;
use hysid_core::law::bouc_wen::{BoucWen, BoucWenState};
use hysid_core::law::{Law, Sample};
use hysid_core::operator::relaxation;

/// Values of a damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MagnetorheologicalDamperParameters {
    /// Spring `k` and friction `F_y z`; without damping.
    pub friction: BoucWen,
    /// `c` in N s/mm.
    pub damping: f64,
    /// `F_v` in N.
    pub viscous_force: f64,
    /// `v_0` in mm/s.
    pub viscous_speed: f64,
    /// `τ` in s.
    pub lag: f64,
}

/// A damper with its memory, at rest at first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MagnetorheologicalDamper {
    parameters: MagnetorheologicalDamperParameters,
    state: BoucWenState,
    x: f64,
    /// `τ v`: the stress of a Maxwell element.
    squeezed: f64,
}

impl MagnetorheologicalDamper {
    pub fn new(parameters: MagnetorheologicalDamperParameters) -> Self {
        Self { parameters, state: parameters.friction.virgin(), x: 0.0, squeezed: 0.0 }
    }

    /// The force in N at the next displacement in mm, `duration` s later; the displacement goes there
    /// straight.
    pub fn step(&mut self, x: f64, duration: f64) -> f64 {
        let values = &self.parameters;
        // τ v obeys (τ v)' = x' - (τ v)/τ.
        let factors = relaxation::decay(duration, values.lag);
        self.squeezed = relaxation::advance(self.squeezed, x - self.x, factors);
        self.x = x;
        let v = self.squeezed / values.lag;
        let friction = values.friction.step(&mut self.state, Sample { x, rate: 0.0, step: duration });
        friction + values.damping * v + values.viscous_force * tanh(v / values.viscous_speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a steady speed the lag has passed and the friction has yielded.
    #[test]
    fn a_steady_speed_has_a_steady_force() {
        let friction = BoucWen::new(0.0, 100.0, 0.5).unwrap();
        let mut damper = MagnetorheologicalDamper::new(MagnetorheologicalDamperParameters {
            friction,
            damping: 0.2,
            viscous_force: 80.0,
            viscous_speed: 40.0,
            lag: 0.01,
        });
        let force = (1..=2000).map(|k| damper.step(0.06 * f64::from(k), 0.001)).last().unwrap();
        let expected = 50.0 + 0.2 * 60.0 + 80.0 * tanh(1.5);
        assert!((force - expected).abs() < 1e-9, "{force} {expected}");
    }
}
