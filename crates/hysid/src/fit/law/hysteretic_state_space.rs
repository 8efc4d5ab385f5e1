//! Identification of a hysteretic state space model, as of all [modes with hysteretic elements](super::hysteretic_dynamics).

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::Identify;
use crate::fit::law::hysteretic_dynamics::{Asked, identify};
use crate::fit::law::search::{Identified, SearchObserver};
use crate::law::Law;
use crate::law::hysteretic_dynamics::Form;
use crate::law::hysteretic_state_space::HystereticStateSpace;
use crate::options::classical::ClassicalOptions;
use crate::stop_check::StopCheck;

impl Identify for HystereticStateSpace {
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<Identified<Self>> {
        let asked = Asked::of(Form::StateSpace, options)?;
        let found = identify(data, &asked, options, &|dynamics| Self(dynamics).into(), observer, stop)?;
        let Identified { law, train_nrmse_percent, evaluations, termination, searched } = found;
        let law = Self(law).validated()?;
        Ok(Identified { law, train_nrmse_percent, evaluations, termination, searched })
    }
}
