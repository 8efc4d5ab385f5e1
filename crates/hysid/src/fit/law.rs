//! Which classical models there are, what can be chosen of each, and how each is fitted.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::law::Classical;
use crate::law::bouc_wen::{BoucWen, BoucWenOptions};
use crate::law::generalized_prandtl_ishlinskii::{
    GeneralizedPrandtlIshlinskii, GeneralizedPrandtlIshlinskiiOptions,
};
use crate::law::jiles_atherton::{JilesAtherton, JilesAthertonForm, JilesAthertonOptions};
use crate::law::masing::{Masing, MasingOptions};
use crate::law::modified_prandtl_ishlinskii::{ModifiedPrandtlIshlinskii, ModifiedPrandtlIshlinskiiOptions};
use crate::law::neuro_madelung::{NeuroMadelung, NeuroMadelungOptions};
use crate::law::prandtl_ishlinskii::{PrandtlIshlinskii, PrandtlIshlinskiiOptions};
use crate::law::preisach::{Preisach, PreisachOptions};
use crate::law::rate_dependent_prandtl_ishlinskii::{
    RateDependentPrandtlIshlinskii, RateDependentPrandtlIshlinskiiOptions, ThresholdForm,
};
use crate::law::search::{Identified, SearchObserver};
use crate::options::classical::ClassicalOptions;
use crate::options::classical::Rival;
use crate::stop_check::StopCheck;
use crate::termination::Termination;

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
            convex(PrandtlIshlinskii::fit_until(data, &options, stop)?)
        }
        Rival::Masing => {
            let defaults = MasingOptions::default();
            let operators = operators.unwrap_or(defaults.operators);
            let thresholds = options.thresholds.clone();
            convex(Masing::fit_until(data, &MasingOptions { operators, thresholds, sign }, stop)?)
        }
        Rival::ModifiedPrandtlIshlinskii => {
            let defaults = ModifiedPrandtlIshlinskiiOptions::default();
            let options = ModifiedPrandtlIshlinskiiOptions {
                operators: operators.unwrap_or(defaults.operators),
                thresholds: options.thresholds.clone(),
                sign,
                dead_zones: options.dead_zones.unwrap_or(defaults.dead_zones),
            };
            convex(ModifiedPrandtlIshlinskii::fit_until(data, &options, stop)?)
        }
        Rival::Preisach => {
            let defaults = PreisachOptions::default();
            let intervals = operators.unwrap_or(defaults.intervals);
            convex(Preisach::fit_until(data, &PreisachOptions { intervals, sign }, stop)?)
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
            searched(GeneralizedPrandtlIshlinskii::fit_until(data, &options, observer, stop)?)
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
            searched(RateDependentPrandtlIshlinskii::fit_until(data, &options, observer, stop)?)
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
            searched(NeuroMadelung::fit_until(data, &options, observer, stop)?)
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
            searched(BoucWen::fit_until(data, &options, observer, stop)?)
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
            searched(JilesAtherton::fit_until(data, &options, observer, stop)?)
        }
        Rival::RandomStops => {
            return Err(Error::Option("random-stops is a network and not fitted as a law".into()));
        }
    })
}

/// A law found by linear least squares.
fn convex(law: impl Into<Classical>) -> Identified<Classical> {
    Identified {
        law: law.into(),
        train_nrmse_percent: f64::NAN,
        evaluations: 1,
        termination: Termination::Converged,
    }
}

fn searched(found: Identified<impl Into<Classical>>) -> Identified<Classical> {
    let Identified { law, train_nrmse_percent, evaluations, termination } = found;
    Identified { law: law.into(), train_nrmse_percent, evaluations, termination }
}
