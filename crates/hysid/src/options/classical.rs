//! The models that are no networks of the family, and what can be chosen of each.

use serde::{Deserialize, Serialize};

use crate::data::rate::RateMethod;
use crate::options::shaping::{Origin, Shaping};

/// The models that are no networks of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rival {
    /// [`Masing`](crate::law::masing::Masing).
    Masing,
    /// [`PrandtlIshlinskii`](crate::law::prandtl_ishlinskii::PrandtlIshlinskii).
    PrandtlIshlinskii,
    /// [`ModifiedPrandtlIshlinskii`](crate::law::modified_prandtl_ishlinskii::ModifiedPrandtlIshlinskii).
    ModifiedPrandtlIshlinskii,
    /// [`GeneralizedPrandtlIshlinskii`](crate::law::generalized_prandtl_ishlinskii::GeneralizedPrandtlIshlinskii).
    GeneralizedPrandtlIshlinskii,
    /// [`RateDependentPrandtlIshlinskii`](crate::law::rate_dependent_prandtl_ishlinskii::RateDependentPrandtlIshlinskii).
    RateDependentPrandtlIshlinskii,
    /// [`Preisach`](crate::law::preisach::Preisach).
    Preisach,
    /// [`NeuroMadelung`](crate::law::neuro_madelung::NeuroMadelung).
    NeuroMadelung,
    /// [`BoucWen`](crate::law::bouc_wen::BoucWen).
    BoucWen,
    /// [`JilesAtherton`](crate::law::jiles_atherton::JilesAtherton).
    JilesAtherton,
    /// Random deteriorating stops and a ridge: a network whose stops are not trained,
    /// [`crate::fit::network::random_stops`].
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

/// Sign that weights may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sign {
    /// Any sign.
    Any,
    /// At least 0: the output lags behind the input, as that of magnets and actuators.
    NonNegative,
    /// At most 0, beside a reversible part that rises: the output runs ahead, as a force behind a
    /// displacement does where energy is lost.
    NonPositive,
}

impl Sign {
    /// All of them; the strictest last.
    pub const ALL: [Sign; 3] = [Sign::Any, Sign::NonNegative, Sign::NonPositive];
}
