//! Hysteretic oscillator: a mass on a spring, a damper and a hysteretic element, or several such modes.
//!
//! ```text
//! m y'' + c y' + k y + r = u                                                theory.md (15.0)
//! ```
//!
//! The input `u` is a force, a base acceleration or a voltage; the output `y` is the displacement of the mass. In modal
//! form these are the equations of [`hysteretic_dynamics`](super::hysteretic_dynamics), which says how they are
//! integrated and why the output is bounded. With one mode the restoring force `r` depends on the path of that mode's
//! displacement; with several each element is between masses that the identification finds.
//!
//! For a force as input, `C = b σ`, divided by the scale of the input, is the compliance of a mode and `1/(C ω²)` its mass.
//! For a voltage or an acceleration the data do not give the mass. The stiffness `1/C` is not unique either, because `r`
//! may contain an elastic part.

use serde::{Deserialize, Serialize};

use crate::law::facts::{Advised, Behaviour};
use crate::law::hysteretic_dynamics::{Dynamics, DynamicsForm, law_of_dynamics};

/// A hysteretic oscillator in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct HystereticOscillator(pub Dynamics);

law_of_dynamics! {
    HystereticOscillator, DynamicsForm::Oscillator, 1, "hysteretic oscillator",
    "hysteretic-oscillator", "masses on springs and dampers with hysteretic elements, for data with a resonance; needs time",
    &[(Behaviour::Resonance, Advised::Simplest)]
}
