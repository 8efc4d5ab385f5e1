//! Hysteretic state space model: a linear system with hysteretic elements that are driven by any sum of its states and
//! its input, and act on all of them.
//!
//! ```text
//! z' = A_z z + B u + E r,   r = R(C z + U u, C_ν z),   y = y_0 + σ (C_y z + d u + m r)   theory.md (15.14)
//! ```
//!
//! `R` is a hysteretic element. `A_z` is in modal form with positive frequencies and damping ratios, so that it is stable for any parameters; modes
//! with a damping ratio of more than 1 do not vibrate. The equations, their integration and the bound of the output are
//! those of [`hysteretic_dynamics`](super::hysteretic_dynamics). A hysteretic oscillator is the case in which outputs
//! and displacements of elements are displacements of modes.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::law::facts::Facts;
use crate::law::hysteretic_dynamics::{Dynamics, FIT_OPTIONS, Form, Motion, STATE_LIMITS};
use crate::law::interval::Interval;
use crate::law::{Law, Parameter, Sample};
use crate::property::Property;

/// A hysteretic state space model in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct HystereticStateSpace(pub Dynamics);

impl Law for HystereticStateSpace {
    type State = Motion;

    const FACTS: Facts = Facts {
        needs_time: true,
        limits: STATE_LIMITS,
        ..Facts::searched(
            "hysteretic-state-space",
            "linear state space model with hysteretic elements, for data with a resonance; needs time",
            FIT_OPTIONS,
            1.5,
        )
    };

    fn virgin(&self) -> Motion {
        self.0.virgin()
    }

    fn step(&self, motion: &mut Motion, sample: Sample) -> f64 {
        self.0.step(motion, sample)
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters(Form::StateSpace)
    }

    fn validated(self) -> Result<Self> {
        self.0.check("hysteretic state space model")?;
        Ok(self)
    }

    fn needs_steps(&self) -> bool {
        true
    }

    fn is_step_free(&self) -> bool {
        false
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        Vec::new()
    }

    fn output_bound(&self, x: Interval, _: Interval) -> Interval {
        self.0.output_bound(x)
    }
}
