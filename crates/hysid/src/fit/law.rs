//! Which classical models there are, what can be chosen of each, and how each is fitted.

pub mod bouc_wen;
pub mod generalized_prandtl_ishlinskii;
mod grids;
pub mod jiles_atherton;
pub(crate) mod linear;
pub mod masing;
pub mod modified_prandtl_ishlinskii;
pub mod neuro_madelung;
pub mod prandtl_ishlinskii;
pub mod preisach;
pub mod rate_dependent_prandtl_ishlinskii;
pub mod search;

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::bouc_wen::BoucWenOptions;
use crate::fit::law::generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskiiOptions;
use crate::fit::law::jiles_atherton::JilesAthertonOptions;
use crate::fit::law::masing::MasingOptions;
use crate::fit::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskiiOptions;
use crate::fit::law::neuro_madelung::NeuroMadelungOptions;
use crate::fit::law::prandtl_ishlinskii::PrandtlIshlinskiiOptions;
use crate::fit::law::preisach::PreisachOptions;
use crate::fit::law::rate_dependent_prandtl_ishlinskii::{
    RateDependentPrandtlIshlinskiiOptions, ThresholdForm,
};
use crate::fit::law::search::{Identified, SearchObserver};
use crate::law::bouc_wen::BoucWen;
use crate::law::generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii;
use crate::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use crate::law::masing::Masing;
use crate::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii;
use crate::law::neuro_madelung::NeuroMadelung;
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::preisach::Preisach;
use crate::law::rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii;
use crate::law::{Classical, Law};
use crate::options::classical::{ClassicalOptions, Rival};
use crate::stop_check::StopCheck;
use crate::termination::Termination;

/// A law that can be identified from data.
pub trait Identify: Law + Sized {
    /// What can be chosen.
    type Options;

    /// Identifies a law. The observer is told after every round of a search; whatever takes long asks `stop` in its
    /// midst, and ends with the best so far.
    ///
    /// # Errors
    /// Data that nothing can be identified from, options outside their meaning, a rate that cannot be computed, or a
    /// stop before there was any law.
    fn identify(
        data: &Dataset,
        options: &Self::Options,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<Identified<Self>>;

    /// The same without a stop in the midst of a round.
    ///
    /// # Errors
    /// As [`Identify::identify`].
    fn fit(
        data: &Dataset,
        options: &Self::Options,
        observer: &mut SearchObserver<'_>,
    ) -> Result<Identified<Self>> {
        Self::identify(data, options, observer, StopCheck::never())
    }
}

/// A law that is found by least squares from one start. Such a fit has no rounds that an observer could hear of.
pub trait LeastSquaresLaw: Law + Sized {
    /// What can be chosen.
    type Options;

    /// The law; after a stop, the best of what was compared until then.
    ///
    /// # Errors
    /// As [`Identify::identify`].
    fn fitted(data: &Dataset, options: &Self::Options, stop: StopCheck<'_>) -> Result<Self>;
}

impl<L: LeastSquaresLaw> Identify for L {
    type Options = L::Options;

    fn identify(
        data: &Dataset,
        options: &Self::Options,
        _: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<Identified<Self>> {
        let (law, termination) = (L::fitted(data, options, stop)?, Termination::Converged);
        Ok(Identified { law, train_nrmse_percent: f64::NAN, evaluations: 1, termination })
    }
}

/// Fits a classical law. Of a search, the observer is told after every round; a fit without rounds that may
/// take long asks `stop` in its midst.
///
/// # Errors
/// Data that nothing can be identified from, options outside their meaning.
pub(crate) fn fit(
    data: &Dataset,
    options: &ClassicalOptions,
    observer: &mut SearchObserver<'_>,
    stop: StopCheck<'_>,
) -> Result<Identified<Classical>> {
    let ClassicalOptions { operators, sign, free_weights, rate, starts, epochs, seed, .. } = *options;
    Ok(match options.model {
        Rival::PrandtlIshlinskii => {
            let defaults = PrandtlIshlinskiiOptions::default();
            let operators = operators.unwrap_or(defaults.operators);
            let thresholds = options.thresholds.clone();
            let options = PrandtlIshlinskiiOptions { operators, thresholds, sign };
            any(PrandtlIshlinskii::identify(data, &options, observer, stop)?)
        }
        Rival::Masing => {
            let defaults = MasingOptions::default();
            let operators = operators.unwrap_or(defaults.operators);
            let thresholds = options.thresholds.clone();
            any(Masing::identify(data, &MasingOptions { operators, thresholds, sign }, observer, stop)?)
        }
        Rival::ModifiedPrandtlIshlinskii => {
            let defaults = ModifiedPrandtlIshlinskiiOptions::default();
            let options = ModifiedPrandtlIshlinskiiOptions {
                operators: operators.unwrap_or(defaults.operators),
                thresholds: options.thresholds.clone(),
                sign,
                dead_zones: options.dead_zones.unwrap_or(defaults.dead_zones),
            };
            any(ModifiedPrandtlIshlinskii::identify(data, &options, observer, stop)?)
        }
        Rival::Preisach => {
            let defaults = PreisachOptions::default();
            let intervals = operators.unwrap_or(defaults.intervals);
            any(Preisach::identify(data, &PreisachOptions { intervals, sign }, observer, stop)?)
        }
        Rival::GeneralizedPrandtlIshlinskii => {
            let defaults = GeneralizedPrandtlIshlinskiiOptions::default();
            let options = GeneralizedPrandtlIshlinskiiOptions {
                operators: operators.unwrap_or(defaults.operators),
                free_weights: free_weights.unwrap_or(defaults.free_weights),
                starts: starts.unwrap_or(defaults.starts),
                epochs: epochs.unwrap_or(defaults.epochs),
                seed,
            };
            any(GeneralizedPrandtlIshlinskii::identify(data, &options, observer, stop)?)
        }
        Rival::RateDependentPrandtlIshlinskii => {
            let defaults = RateDependentPrandtlIshlinskiiOptions::default();
            let Some(rate) = rate else {
                return Err(Error::Option(
                    "rate-dependent-prandtl-ishlinskii needs the rate of the input: name a time column"
                        .into(),
                ));
            };
            let form = match options.logarithmic_thresholds {
                true => ThresholdForm::Logarithmic,
                false => ThresholdForm::Linear,
            };
            let options = RateDependentPrandtlIshlinskiiOptions {
                operators: operators.unwrap_or(defaults.operators),
                form,
                free_weights: free_weights.unwrap_or(defaults.free_weights),
                rate,
                starts: starts.unwrap_or(defaults.starts),
                epochs: epochs.unwrap_or(defaults.epochs),
                seed,
            };
            any(RateDependentPrandtlIshlinskii::identify(data, &options, observer, stop)?)
        }
        Rival::NeuroMadelung => {
            let defaults = NeuroMadelungOptions::default();
            let options = NeuroMadelungOptions {
                hidden: options.hidden.unwrap_or(defaults.hidden),
                rate,
                starts: starts.unwrap_or(defaults.starts),
                epochs: epochs.unwrap_or(defaults.epochs),
                seed,
            };
            any(NeuroMadelung::identify(data, &options, observer, stop)?)
        }
        Rival::BoucWen => {
            let defaults = BoucWenOptions::default();
            let options = BoucWenOptions {
                degradation: options.degradation,
                rate,
                starts: starts.unwrap_or(defaults.starts),
                epochs: epochs.unwrap_or(defaults.epochs),
                seed,
            };
            any(BoucWen::identify(data, &options, observer, stop)?)
        }
        Rival::JilesAtherton => {
            let defaults = JilesAthertonOptions::default();
            let form = match options.differential_form {
                true => JilesAthertonForm::Differential,
                false => JilesAthertonForm::Original,
            };
            let options = JilesAthertonOptions {
                form,
                starts: starts.unwrap_or(defaults.starts),
                epochs: epochs.unwrap_or(defaults.epochs),
                seed,
            };
            any(JilesAtherton::identify(data, &options, observer, stop)?)
        }
        Rival::RandomStops => {
            return Err(Error::Option("random-stops is a network and not fitted as a law".into()));
        }
    })
}

/// The same as one of all laws.
fn any(found: Identified<impl Into<Classical>>) -> Identified<Classical> {
    let Identified { law, train_nrmse_percent, evaluations, termination } = found;
    Identified { law: law.into(), train_nrmse_percent, evaluations, termination }
}
