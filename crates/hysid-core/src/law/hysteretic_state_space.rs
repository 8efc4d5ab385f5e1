//! Hysteretic state space model: a linear system with hysteretic elements that are driven by any sum of its states and
//! its input, and act on all of them.
//!
//! ```text
//! X' = Ω X + B u + G r,   r = R(C_δ X + U u, C_ν X),   y = y_0 + σ (C_y X + d u + μ r)   theory.md (15.14)
//! ```
//!
//! `X` are displacements and velocities of the modes, and `R` is a hysteretic element. `Ω` is in modal form with positive
//! frequencies and damping ratios, so that it is stable for any parameters; modes with a damping ratio of more than 1 do
//! not vibrate. The equations, their integration and the bound of the output are those of [`hysteretic_dynamics`](super::hysteretic_dynamics). A hysteretic oscillator is the case in which outputs
//! and displacements of elements are displacements of modes.

use serde::{Deserialize, Serialize};

use crate::law::hysteretic_dynamics::{Dynamics, DynamicsForm, law_of_dynamics};

/// A hysteretic state space model in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct HystereticStateSpace(pub Dynamics);

law_of_dynamics! {
    HystereticStateSpace, DynamicsForm::StateSpace, 2, "hysteretic state space model",
    "hysteretic-state-space", "linear state space model with hysteretic elements, for data with a resonance; needs time",
    &[]
}
