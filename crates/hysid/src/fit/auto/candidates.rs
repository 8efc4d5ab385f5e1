//! The candidates: networks, recurrent networks, random stops and classical models, each with the input
//! transforms that may suit it. The list depends on the columns of the data (time, further inputs), on the options, and
//! on whether the data look like a resonance; otherwise never on the values.

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::diagnosis::resonance::Resonance;
use crate::diagnosis::{Diagnosis, DiagnosisOptions, Property, Verdict};
use crate::fit::law::candidates::{
    COMPRESSION, CandidateRequest, RATE_COMPRESSION, RankedLaw, compressed, with_compressed_rate,
};
use crate::fit::{initial_state, law};
use crate::law::facts::LawKind;
use crate::network::{Family, Sizes};
use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::fit_spec::AutoOptions;
use crate::options::input_options::InputOptions;
use crate::options::network::ENSEMBLE_PENALTIES;
use crate::options::network::{FitOptions, Regularisation, Trainer};

/// A kind of candidates. The best of each kind pass the first folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CandidateKind {
    Networks,
    RandomStops,
    /// Classical models: relays, plays and the like.
    Classical,
    Recurrent,
    Dynamic,
}

impl CandidateKind {
    pub const ALL: [CandidateKind; 5] = [
        CandidateKind::Classical,
        CandidateKind::Networks,
        CandidateKind::RandomStops,
        CandidateKind::Recurrent,
        CandidateKind::Dynamic,
    ];

    fn of(request: &FitSpec) -> Self {
        match request {
            FitSpec::Network(_) => CandidateKind::Networks,
            FitSpec::Classical(options) => match options.model.facts().kind {
                LawKind::RandomNetwork => CandidateKind::RandomStops,
                LawKind::Recurrent => CandidateKind::Recurrent,
                LawKind::Inertia => CandidateKind::Dynamic,
                LawKind::Law => CandidateKind::Classical,
            },
            FitSpec::Auto(_) => CandidateKind::Classical,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            CandidateKind::Networks => "networks",
            CandidateKind::RandomStops => "random stops",
            CandidateKind::Classical => "classical",
            CandidateKind::Recurrent => "recurrent",
            CandidateKind::Dynamic => "dynamic",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub kind: CandidateKind,
    request: FitSpec,
}

/// Penalties that the best networks are also tried with: those of a single fit, and near-zero ones for noise-free data.
const OTHER_PENALTIES: [Regularisation; 2] =
    [Regularisation { ridge: 1e-6, decay: 1e-7 }, Regularisation { ridge: 1e-10, decay: 1e-12 }];

/// Epochs of a network. Designed.
const EPOCHS: usize = 25;

/// Starts and epochs of a model with inertia on a fold: fewer, because the folds only rank the candidates.
const STARTS_ON_A_FOLD: usize = 2;
const EPOCHS_ON_A_FOLD: usize = 80;

/// Starts of a search on a fold beside the parameters found on all data, and rows with an output that a search is
/// fitted to at most.
const STARTS_OF_A_SEARCH: usize = 4;
const ROWS_OF_A_SEARCH: usize = 1500;

/// Rows that a network's early iterations use at most.
const THIN: usize = 1500;

impl Candidate {
    /// A model that the user has decided for.
    pub fn alone(request: &FitSpec) -> Self {
        Self { kind: CandidateKind::of(request), request: request.clone() }
    }

    /// The same with this number of rows of each record that only drive the memory.
    pub fn warmed_up(&self, rows: usize) -> Self {
        let mut warmed = self.clone();
        match &mut warmed.request {
            FitSpec::Network(options) => options.shaping.warm_up = rows,
            FitSpec::Classical(options) => options.shaping.warm_up = rows,
            FitSpec::Auto(_) => {}
        }
        warmed
    }

    /// True if its force can depend on the largest or the whole path of the input so far.
    fn can_deteriorate(&self) -> bool {
        match &self.request {
            FitSpec::Network(options) => !options.no_deterioration || options.shaping.history,
            FitSpec::Classical(options) => {
                options.deterioration == Some(true) || options.degradation || options.shaping.history
            }
            FitSpec::Auto(_) => false,
        }
    }

    /// Specification of the first start.
    pub fn asked(&self) -> &FitSpec {
        &self.request
    }

    /// Specification of one of its starts.
    pub fn request(&self, start: usize) -> FitSpec {
        let mut request = self.request.clone();
        let seed = match &mut request {
            FitSpec::Network(options) => &mut options.seed,
            FitSpec::Classical(options) => &mut options.seed,
            FitSpec::Auto(_) => unreachable!("no candidate is made of candidates"),
        };
        *seed = seed.wrapping_add((start as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        request
    }

    /// True if another start gives another model; a classical model is searched from several in any case.
    pub fn is_random(&self) -> bool {
        match &self.request {
            FitSpec::Network(_) => true,
            FitSpec::Classical(options) => options.model.is_random(),
            FitSpec::Auto(_) => false,
        }
    }

    /// The same with fewer starts on a fold for a law that was searched on all data, and with fewer starts and epochs
    /// for a model with inertia and hysteresis.
    pub fn on_a_fold(&self) -> Cow<'_, Self> {
        let FitSpec::Classical(options) = &self.request else { return Cow::Borrowed(self) };
        if !options.near.is_empty() {
            let starts = options.starts.unwrap_or(STARTS_OF_A_SEARCH).min(STARTS_OF_A_SEARCH);
            let few = ClassicalOptions { starts: Some(starts), ..options.clone() };
            return Cow::Owned(Self { request: FitSpec::Classical(few), ..self.clone() });
        }
        if !self.is_dynamic() || self.has_no_hysteresis() {
            return Cow::Borrowed(self);
        }
        let quicker = ClassicalOptions {
            starts: Some(options.starts.map_or(STARTS_ON_A_FOLD, |starts| starts.min(STARTS_ON_A_FOLD))),
            epochs: options.epochs.or(Some(EPOCHS_ON_A_FOLD)),
            ..options.clone()
        };
        Cow::Owned(Self { request: FitSpec::Classical(quicker), ..self.clone() })
    }

    /// The same network with other penalties, the weakest only for data without noise; none for what is no network.
    pub fn with_other_penalties(&self, is_without_noise: bool) -> Vec<Self> {
        let FitSpec::Network(options) = &self.request else { return Vec::new() };
        let with = |Regularisation { ridge, decay }| {
            let options = FitOptions { ridge: Some(ridge), decay: Some(decay), ..options.clone() };
            Self { kind: self.kind, request: FitSpec::Network(options) }
        };
        let count = if is_without_noise { OTHER_PENALTIES.len() } else { 1 };
        OTHER_PENALTIES[..count].iter().copied().map(with).collect()
    }

    /// The same, whose pasts are found together with its parameters; `None` for a model that begins with other states.
    pub fn with_found_pasts(&self) -> Option<Self> {
        if self.request.initial_state().is_some() || self.is_dynamic() {
            return None;
        }
        Some(Self { kind: self.kind, request: self.request.with_initial_state(Some(InitialState::Free)) })
    }

    /// True for a model with free states, which are found together with its parameters.
    pub fn has_free_states(&self) -> bool {
        self.request.has_free_states() && self.request.model().has_free_states()
    }

    /// True for a model with inertia, which is fitted to rows without gaps.
    pub fn is_dynamic(&self) -> bool {
        self.kind == CandidateKind::Dynamic
    }

    /// True for a model with inertia whose force follows from displacement and velocity alone.
    fn has_no_hysteresis(&self) -> bool {
        self.is_dynamic() && matches!(&self.request, FitSpec::Classical(options) if options.has_no_memory())
    }

    /// True if this has hysteresis or another kind, and the other has inertia only; or for more modes of models that nest
    /// them.
    pub fn has_more_parts_than(&self, other: &Self) -> bool {
        let nested_modes = |candidate: &Self| match &candidate.request {
            FitSpec::Classical(options) if options.model.facts().nests_modes => options.modes,
            _ => None,
        };
        let modes = nested_modes(self).zip(nested_modes(other));
        other.has_no_hysteresis() && !self.has_no_hysteresis()
            || modes.is_some_and(|(of_this, of_other)| of_this > of_other)
    }

    /// True for a law whose parameters are searched from several starts in one fit.
    pub fn is_searched(&self) -> bool {
        !self.is_random()
            && matches!(&self.request, FitSpec::Classical(options) if options.model.is_searched())
    }

    /// The same that on a fold is searched from few starts: parameters found on all data, if any, and random ones.
    pub fn near(&self, searched: Vec<f64>) -> Self {
        let mut near = self.clone();
        if let FitSpec::Classical(options) = &mut near.request {
            options.near = searched;
        }
        near
    }

    /// The rows that it is fitted to: all, or some of many. The memory runs through all.
    pub fn rows_of<'d>(&self, data: &'d Dataset) -> Cow<'d, Dataset> {
        if self.is_searched() && data.scored() > ROWS_OF_A_SEARCH {
            return Cow::Owned(data.thinned(ROWS_OF_A_SEARCH));
        }
        Cow::Borrowed(data)
    }

    /// Name of the candidate, in a few words.
    pub fn name(&self) -> String {
        self.request.label()
    }
}

pub(super) fn quick(options: &AutoOptions) -> Candidate {
    let quick = initial_state::quick();
    let request = FitSpec::Classical(ClassicalOptions {
        rate: options.rate,
        deterioration: options.deterioration.or(quick.deterioration),
        seed: options.seed,
        ..quick
    });
    Candidate::alone(&request)
}

/// All candidates for data like these: those that are usually good or quick before the others.
pub(super) fn candidates(data: &Dataset, options: &AutoOptions) -> Vec<Candidate> {
    if options.initial_state == Some(InitialState::Free) {
        let request = &CandidateRequest { data, options, resonance: None };
        let all = laws(request, |model| model.facts().has_free_states);
        return all.into_iter().map(|law| Candidate::alone(&FitSpec::Classical(law))).collect();
    }
    let resonance = Resonance::of(data).filter(Resonance::is_found);
    let resonance = resonance.map(|resonance| resonance.oscillator.compared);
    let request = &CandidateRequest { data, options, resonance };
    if resonance.is_some() {
        let all = candidates_with_inertia(request);
        if !all.is_empty() {
            return all;
        }
    }
    let most = options.effort.candidates_of_a_kind();
    let of_kind =
        |is_wanted: fn(ClassicalModel) -> bool| laws(request, is_wanted).into_iter().map(FitSpec::Classical);
    let mut networks = networks(options).into_iter().take(most).map(FitSpec::Network);
    let mut random = of_kind(ClassicalModel::is_network).take(most);
    let mut linear = of_kind(|model| !model.is_random() && !model.is_searched()).take(most);
    let mut recurrent = of_kind(is_recurrent).take(most);
    let mut requests = Vec::new();
    // A network and a quick one at a time.
    loop {
        let next = [networks.next(), recurrent.next(), linear.next(), random.next()];
        if next.iter().all(Option::is_none) {
            break;
        }
        requests.extend(next.into_iter().flatten());
    }
    requests.extend(of_kind(|model| !model.is_random() && model.is_searched()));
    let mut all: Vec<Candidate> = requests.iter().map(Candidate::alone).collect();
    all.retain(|candidate| is_allowed(candidate, request));
    if options.known.is_some() && options.initial_state.is_none() {
        let free = AutoOptions { initial_state: Some(InitialState::Free), ..options.clone() };
        all.extend(candidates(data, &free));
    }
    all
}

/// Those that suit what the diagnosis finds: what has begun to lose strength loses more beyond the data, where models that
/// cannot lose any fail.
pub(super) fn suited(mut all: Vec<Candidate>, data: &Dataset, options: &AutoOptions) -> Vec<Candidate> {
    let is_open = options.only.is_none() && options.deterioration.is_none();
    let is_some_dynamic = all.iter().any(Candidate::is_dynamic);
    if is_open && !is_some_dynamic && all.iter().any(Candidate::can_deteriorate) && loses_strength(data) {
        all.retain(Candidate::can_deteriorate);
    }
    all
}

/// True if the diagnosis finds that loops lose energy or strength by repetition or with amplitude.
fn loses_strength(data: &Dataset) -> bool {
    let lost = [Property::Deterioration, Property::StrengthLoss];
    Diagnosis::of(data, &DiagnosisOptions::default()).is_ok_and(|diagnosis| {
        let mut findings = diagnosis.properties.iter().filter(|finding| lost.contains(&finding.property));
        findings.any(|finding| finding.verdict == Verdict::Yes)
    })
}

fn networks(options: &AutoOptions) -> Vec<FitOptions> {
    use Family::{PreisachNn, Xpnn, XpnnPlus};
    let as_it_is = InputOptions::default();
    let [tenth, fiftieth] = COMPRESSION.map(compressed);
    let rate_tenth = with_compressed_rate();
    let both = InputOptions { rate_compression: Some(RATE_COMPRESSION), ..tenth };
    let history = InputOptions { history: true, ..as_it_is };
    let mut networks = Vec::new();
    let mut add = |model, deterioration, shaping, rate, relaxation| {
        networks.push(of_network(options, model, deterioration, shaping, rate, relaxation));
    };
    let rate = options.rate;
    if rate.is_some() {
        for (model, deterioration, shaping, relaxation) in [
            (XpnnPlus, true, as_it_is, 0),
            (XpnnPlus, true, as_it_is, 4),
            (XpnnPlus, false, rate_tenth, 0),
            (XpnnPlus, false, rate_tenth, 4),
            (Xpnn, true, as_it_is, 0),
            (XpnnPlus, true, rate_tenth, 0),
            (Xpnn, false, rate_tenth, 0),
            (XpnnPlus, false, both, 0),
        ] {
            add(model, deterioration, shaping, rate, relaxation);
        }
    }
    for (model, deterioration, shaping) in [
        (XpnnPlus, true, as_it_is),
        (XpnnPlus, false, as_it_is),
        (Xpnn, true, as_it_is),
        (PreisachNn, false, as_it_is),
        (XpnnPlus, false, tenth),
        (Xpnn, true, tenth),
    ] {
        add(model, deterioration, shaping, None, 0);
    }
    if rate.is_none() {
        add(XpnnPlus, false, fiftieth, None, 0);
        add(XpnnPlus, true, history, None, 0);
    }
    networks
}

/// Models with inertia, a network and a recurrent network.
fn candidates_with_inertia(request: &CandidateRequest<'_>) -> Vec<Candidate> {
    let mut models: Vec<ClassicalOptions> = Vec::new();
    for model in laws(request, ClassicalModel::has_inertia) {
        // With a number of modes that the user has decided, some are alike.
        if !models.contains(&model) {
            models.push(model);
        }
    }
    let recurrent = laws(request, is_recurrent).into_iter().take(1);
    let others = models.into_iter().chain(recurrent).map(FitSpec::Classical);
    let all = others.chain(networks(request.options).into_iter().take(1).map(FitSpec::Network));
    let mut all: Vec<Candidate> = all.map(|request| Candidate::alone(&request)).collect();
    all.retain(|candidate| is_allowed(candidate, request));
    if all.iter().any(Candidate::is_dynamic) { all } else { Vec::new() }
}

fn is_recurrent(model: ClassicalModel) -> bool {
    model.facts().kind == LawKind::Recurrent
}

/// The candidates of some classical models, in the order of their ranks.
fn laws(request: &CandidateRequest<'_>, is_wanted: impl Fn(ClassicalModel) -> bool) -> Vec<ClassicalOptions> {
    let wanted = ClassicalModel::ALL.iter().copied().filter(|model| is_wanted(*model));
    let mut ranked: Vec<RankedLaw> = wanted.flat_map(|model| law::candidates_of(model, request)).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, law)| law).collect()
}

fn of_network(
    options: &AutoOptions,
    model: Family,
    deterioration: bool,
    shaping: InputOptions,
    rate: Option<RateMethod>,
    relaxation: usize,
) -> FitOptions {
    let sizes = Sizes::default();
    FitOptions {
        model,
        sizes: Sizes {
            stops: options.stops.unwrap_or(sizes.stops),
            hidden: options.hidden.unwrap_or(sizes.hidden),
            relaxation: if relaxation > 0 { options.relaxation.unwrap_or(relaxation) } else { 0 },
        },
        no_deterioration: !deterioration,
        rate,
        shaping,
        starts: 1,
        epochs: options.epochs.unwrap_or_else(|| options.effort.scaled(EPOCHS)),
        seed: options.seed,
        ridge: Some(options.ridge.unwrap_or(ENSEMBLE_PENALTIES.ridge)),
        decay: Some(options.decay.unwrap_or(ENSEMBLE_PENALTIES.decay)),
        thin: THIN,
        ..FitOptions::of(Trainer::LevenbergMarquardt)
    }
}

/// False for a candidate that does not fit the data or contradicts what the user has decided.
fn is_allowed(candidate: &Candidate, to: &CandidateRequest<'_>) -> bool {
    let (request, data, decided) = (&candidate.request, to.data, to.options);
    let (shaping, deteriorates) = match request {
        FitSpec::Network(options) => (options.shaping, !options.no_deterioration),
        FitSpec::Classical(options) => {
            (options.shaping, options.deterioration == Some(true) || options.degradation)
        }
        FitSpec::Auto(_) => return false,
    };
    let is_network = matches!(request, FitSpec::Network(_));
    let relaxes = matches!(request, FitSpec::Network(options) if options.sizes.relaxation > 0);
    let takes_several = request.model().takes_further_inputs();
    request.model().check_data(data, request.rate()).is_ok()
        && (!shaping.history || takes_several)
        && decided.deterioration.is_none_or(|wanted| wanted == deteriorates)
        && (!decided.always_rate || request.rate().is_some())
        && decided.relaxation.is_none_or(|wanted| !is_network || relaxes == (wanted > 0))
        && decided.compression.is_none_or(|wanted| wanted == shaping.compression.is_some())
        && decided.history.is_none_or(|wanted| wanted == shaping.history)
        && (data.names().inputs.len() == 1 || is_network || takes_several)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::known_beginning::KnownSpan;
    use crate::data::record::{ColumnNames, Record};

    #[test]
    fn free_states_are_tried_for_records_with_a_known_beginning() {
        let x: Vec<f64> = (0..100).map(|row| f64::from(row % 20)).collect();
        let record = Record::new("r", vec![x.clone()], x).unwrap();
        let data = Dataset::new(ColumnNames::of(None, &["x"], "y"), vec![record]).unwrap();
        let free = |known, initial_state| {
            let options = AutoOptions { known, initial_state, ..AutoOptions::default() };
            let all = candidates(&data, &options);
            (all.len(), all.iter().filter(|candidate| candidate.has_free_states()).count())
        };
        let (all, none) = free(None, None);
        let (with_free, some) = free(Some(KnownSpan::Rows(10)), None);
        assert!(none == 0 && some > 0 && with_free == all + some);
        assert_eq!(free(Some(KnownSpan::Rows(10)), Some(InitialState::Virgin)), (all, 0));
    }

    #[test]
    fn odd_candidates_with_free_states_are_tried_for_data_about_zero() {
        let odd = |low: f64| {
            let x: Vec<f64> = (0..100).map(|row| low + f64::from(row % 21)).collect();
            let record = Record::new("r", vec![x.clone()], x).unwrap();
            let data = Dataset::new(ColumnNames::of(None, &["x"], "y"), vec![record]).unwrap();
            let options = AutoOptions { known: Some(KnownSpan::Rows(10)), ..AutoOptions::default() };
            let free = candidates(&data, &options).into_iter().filter(Candidate::has_free_states);
            let is_odd = |one: Candidate| matches!(one.asked(), FitSpec::Classical(options) if options.odd);
            free.map(is_odd).collect::<Vec<bool>>()
        };
        assert_eq!(odd(-10.0), [true, false]);
        assert_eq!(odd(0.0), [false]);
    }
}
