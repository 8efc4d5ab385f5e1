//! Which classical models there are, what can be chosen of each, and how each is fitted.

use serde::{Deserialize, Serialize};

use crate::classical::Classical;
use crate::classical::bouc_wen::{BoucWen, BoucWenOptions};
use crate::classical::generalized_prandtl_ishlinskii::{
    GeneralizedPrandtlIshlinskii, GeneralizedPrandtlIshlinskiiOptions,
};
use crate::classical::jiles_atherton::{JilesAtherton, JilesAthertonForm, JilesAthertonOptions};
use crate::classical::linear_fit::Sign;
use crate::classical::masing::{Masing, MasingOptions};
use crate::classical::modified_prandtl_ishlinskii::{
    ModifiedPrandtlIshlinskii, ModifiedPrandtlIshlinskiiOptions,
};
use crate::classical::neuro_madelung::{NeuroMadelung, NeuroMadelungOptions};
use crate::classical::prandtl_ishlinskii::{PrandtlIshlinskii, PrandtlIshlinskiiOptions};
use crate::classical::preisach::{Preisach, PreisachOptions};
use crate::classical::rate_dependent_prandtl_ishlinskii::{
    RateDependentPrandtlIshlinskii, RateDependentPrandtlIshlinskiiOptions, ThresholdForm,
};
use crate::classical::search::{Identified, SearchObserver};
use crate::error::{Error, Result};
use crate::preprocessing::{Origin, Shaping};
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::stop_check::StopCheck;
use crate::training::Termination;

/// The models that are no networks of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rival {
    /// [`Masing`].
    Masing,
    /// [`PrandtlIshlinskii`].
    PrandtlIshlinskii,
    /// [`ModifiedPrandtlIshlinskii`].
    ModifiedPrandtlIshlinskii,
    /// [`GeneralizedPrandtlIshlinskii`].
    GeneralizedPrandtlIshlinskii,
    /// [`RateDependentPrandtlIshlinskii`].
    RateDependentPrandtlIshlinskii,
    /// [`Preisach`].
    Preisach,
    /// [`NeuroMadelung`].
    NeuroMadelung,
    /// [`BoucWen`].
    BoucWen,
    /// [`JilesAtherton`].
    JilesAtherton,
    /// Random deteriorating stops and a ridge: a network whose stops are not trained,
    /// [`crate::training::random_stops`].
    RandomStops,
}

impl Rival {
    /// All of them.
    pub const ALL: [Rival; 10] = [
        Rival::Masing,
        Rival::PrandtlIshlinskii,
        Rival::ModifiedPrandtlIshlinskii,
        Rival::GeneralizedPrandtlIshlinskii,
        Rival::RateDependentPrandtlIshlinskii,
        Rival::Preisach,
        Rival::NeuroMadelung,
        Rival::BoucWen,
        Rival::JilesAtherton,
        Rival::RandomStops,
    ];

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Rival::Masing => "masing",
            Rival::PrandtlIshlinskii => "prandtl-ishlinskii",
            Rival::ModifiedPrandtlIshlinskii => "modified-prandtl-ishlinskii",
            Rival::GeneralizedPrandtlIshlinskii => "generalized-prandtl-ishlinskii",
            Rival::RateDependentPrandtlIshlinskii => "rate-dependent-prandtl-ishlinskii",
            Rival::Preisach => "preisach",
            Rival::NeuroMadelung => "neuro-madelung",
            Rival::BoucWen => "bouc-wen",
            Rival::JilesAtherton => "jiles-atherton",
            Rival::RandomStops => "random-stops",
        }
    }

    /// True if the model can make use of the rate of the input.
    pub fn uses_rate(self) -> bool {
        matches!(
            self,
            Rival::RateDependentPrandtlIshlinskii
                | Rival::NeuroMadelung
                | Rival::BoucWen
                | Rival::RandomStops
        )
    }

    /// True if there is no such model without a rate.
    pub fn needs_rate(self) -> bool {
        self == Rival::RateDependentPrandtlIshlinskii
    }

    /// True if it takes more than one input.
    pub fn takes_further_inputs(self) -> bool {
        self == Rival::RandomStops
    }

    /// From where the input is measured. A field of 0 is part of the law of Jiles and Atherton; all other laws
    /// are the same wherever the input is.
    pub(crate) fn origin(self) -> Origin {
        if self == Rival::JilesAtherton { Origin::Zero } else { Origin::OfData }
    }

    /// True if it is found by a search from several starts; otherwise by linear least squares.
    pub fn is_searched(self) -> bool {
        !matches!(
            self,
            Rival::Masing
                | Rival::PrandtlIshlinskii
                | Rival::ModifiedPrandtlIshlinskii
                | Rival::Preisach
                | Rival::RandomStops
        )
    }
}

/// What the user can choose; every field has the name of its command-line option. What a model has no use
/// for is left alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassicalOptions {
    /// The model.
    pub model: Rival,
    /// Plays, breakpoints, intervals of each axis of a Preisach plane, or random stops; the model's own
    /// default if `None`.
    pub operators: Option<usize>,
    /// Thresholds of the plays of a Masing, Prandtl-Ishlinskii or modified Prandtl-Ishlinskii model, in the
    /// unit of the input.
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the weights of plays or cells; chosen by cross-validation if `None`.
    pub sign: Option<Sign>,
    /// Dead zones on each side of a modified Prandtl-Ishlinskii model; its own default if `None`.
    pub dead_zones: Option<usize>,
    /// A weight for each play in place of an exponential law; the model's own default if `None`.
    pub free_weights: Option<bool>,
    /// Thresholds of a rate-dependent Prandtl-Ishlinskii model grow with the logarithm of the rate.
    pub logarithmic_thresholds: bool,
    /// Bouc-Wen with the degradation and pinching of Baber and Noori.
    pub degradation: bool,
    /// Jiles-Atherton in its differential form of 1992 in place of that of 1986.
    pub differential_form: bool,
    /// Tanh neurons of a neuro-Madelung model or beside random stops.
    pub hidden: Option<usize>,
    /// Whether random stops deteriorate; chosen by cross-validation if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deterioration: Option<bool>,
    /// How the rate is found; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// What the model sees of the input.
    #[serde(default, skip_serializing_if = "Shaping::is_none")]
    pub shaping: Shaping,
    /// Starts of a search; the model's own default if `None`.
    pub starts: Option<usize>,
    /// Iterations of each start; the model's own default if `None`.
    pub epochs: Option<usize>,
    /// Seed of all randomness.
    pub seed: u64,
}

impl ClassicalOptions {
    /// The defaults of a model.
    pub fn of(model: Rival) -> Self {
        Self {
            model,
            operators: None,
            thresholds: None,
            sign: None,
            dead_zones: None,
            free_weights: None,
            logarithmic_thresholds: false,
            degradation: false,
            differential_form: false,
            hidden: None,
            deterioration: None,
            rate: None,
            shaping: Shaping::default(),
            starts: None,
            epochs: None,
            seed: 1,
        }
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
