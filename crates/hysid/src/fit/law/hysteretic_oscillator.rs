//! Identification of a hysteretic oscillator, as of all [modes with hysteretic elements](super::hysteretic_dynamics).

use crate::fit::law::hysteretic_dynamics::identified_as;
use crate::law::hysteretic_dynamics::DynamicsForm;
use crate::law::hysteretic_oscillator::HystereticOscillator;

identified_as!(HystereticOscillator, DynamicsForm::Oscillator);
