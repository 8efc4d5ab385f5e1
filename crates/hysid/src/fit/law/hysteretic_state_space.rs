//! Identification of a hysteretic state space model, as of all [modes with hysteretic elements](super::hysteretic_dynamics).

use crate::fit::law::hysteretic_dynamics::identified_as;
use crate::law::hysteretic_dynamics::DynamicsForm;
use crate::law::hysteretic_state_space::HystereticStateSpace;

identified_as!(HystereticStateSpace, DynamicsForm::StateSpace);
