//! Identification of the classical models.

pub mod bouc_wen;
pub(crate) mod candidates;
pub mod duhem_nn;
pub mod dynamic_prandtl_ishlinskii;
pub mod generalized_prandtl_ishlinskii;
mod grids;
pub mod hysteretic_dynamics;
pub mod hysteretic_oscillator;
pub mod hysteretic_state_space;
pub mod jiles_atherton;
pub mod linearised;
pub mod lugre;
pub mod masing;
pub mod menegotto_pinto;
pub mod modified_prandtl_ishlinskii;
pub mod neuro_madelung;
pub mod peak_oriented;
pub mod prandtl_ishlinskii;
pub mod preisach;
pub mod ramberg_osgood;
pub mod random_stops;
pub mod rate_dependent_prandtl_ishlinskii;
pub mod search;

use hysid_core::for_each_law;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::candidates::{CandidateRequest, RankedLaw};
use crate::fit::law::linearised::{LawFamily, LinearisedLaw};
use crate::fit::law::search::{IdentifiedLaw, search};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::progress::SearchObserver;
use crate::law::series::Series;
use crate::law::{Classical, Law};
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::stop_check::StopCheck;

/// A law that can be identified from data.
pub trait Identify: Law {
    /// True if the fit minimises a sum of squares in which rows may have weights.
    const TAKES_WEIGHTS: bool = false;

    /// Identifies a law. The observer is called after every round of a search; long computations check `stop`
    /// in between, and end with the best result so far.
    ///
    /// # Errors
    /// Data from which no model can be identified, invalid options, a rate that cannot be computed, or a stop
    /// before there was a law.
    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>>;

    /// The law about the result of a fit with these options to these data, from which the intervals of its parameters
    /// follow; `None` for a law without intervals.
    ///
    /// # Errors
    /// As [`Identify::identify`].
    fn linearised(&self, data: &Dataset, options: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let _ = (data, options);
        Ok(None)
    }

    /// The peak memory of a fit with these options to data of this size.
    fn memory_need(data: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let _ = data;
        size.of_search(options)
    }

    /// The candidates of `auto` that are this law, each with its rank among the laws of its kind; by default a searched
    /// law in all variants, and another as it is, after those that are known to be good.
    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        candidates::by_default(model, request)
    }

    /// As [`Identify::identify`], without a check within a round.
    fn fit(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        Self::identify(data, options, observer, StopCheck::never())
    }
}

/// A law that is found by a search over a family.
pub(crate) trait SearchedLaw: Law + Into<Classical> {
    type Family: LawFamily<Law = Self>;

    /// The family to search, and the rows that it is compared with.
    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(Self::Family, Vec<Series>)>;
}

impl<L: SearchedLaw> Identify for L {
    const TAKES_WEIGHTS: bool = true;

    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let (family, series) = L::family(data, options)?;
        search(&family, &series, options, observer, stop)
    }

    fn linearised(&self, data: &Dataset, options: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let (family, series) = L::family(data, options)?;
        Ok(Some(linearised::of_search(&family, &series, self)))
    }
}

macro_rules! fit {
    ($($module:ident::$law:ident),* $(,)?) => {
        /// Fits a classical law, but no random stops, which are a network. A fit without rounds checks `stop`.
        pub(crate) fn fit(
            data: &Dataset,
            options: &ClassicalOptions,
            observer: &mut SearchObserver<'_>,
            stop: StopCheck<'_>,
        ) -> Result<IdentifiedLaw<Classical>> {
            match options.model {
                $(ClassicalModel::$law => {
                    crate::law::$module::$law::identify(data, options, observer, stop)?
                        .try_map(|law| Ok(law.into()))
                })*
                ClassicalModel::RandomStops => unreachable!("random stops are a network"),
            }
        }

        /// Names of the laws that can be fitted with weights of rows.
        fn weight_takers() -> Vec<&'static str> {
            let laws = [$((crate::law::$module::$law::TAKES_WEIGHTS, ClassicalModel::$law)),*];
            laws.into_iter().filter_map(|(takes, law)| takes.then(|| law.name())).collect()
        }

        /// As [`Identify::memory_need`], with this number of threads.
        pub(crate) fn memory_need(data: &Dataset, options: &ClassicalOptions, threads: usize) -> MemoryNeed {
            let size = LawFitSize::of(data, threads);
            match options.model {
                $(ClassicalModel::$law => crate::law::$module::$law::memory_need(data, options, &size),)*
                ClassicalModel::RandomStops => random_stops::memory_need(data, options, &size),
            }
        }

        /// As [`Identify::candidates`].
        pub(crate) fn candidates_of(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
            match model {
                $(ClassicalModel::$law => crate::law::$module::$law::candidates(model, request),)*
                ClassicalModel::RandomStops => random_stops::candidates(model, request.options),
            }
        }
    };
}

for_each_law!(fit);

/// Refuses weights of rows for a model that does not take them.
pub(crate) fn check_weights(data: &Dataset, model: &'static str) -> Result<()> {
    let takers = weight_takers();
    match data.is_weighted() && !takers.contains(&model) {
        true => Err(Error::Weights { model, takers }),
        false => Ok(()),
    }
}

macro_rules! linearised {
    ($($module:ident::$law:ident),* $(,)?) => {
        /// As [`Identify::linearised`].
        pub(crate) fn linearised(
            law: &Classical,
            data: &Dataset,
            options: &ClassicalOptions,
        ) -> Result<Option<LinearisedLaw>> {
            match law {
                $(Classical::$law(law) => law.linearised(data, options),)*
            }
        }
    };
}

for_each_law!(linearised);
