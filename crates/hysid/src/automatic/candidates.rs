//! What is tried: networks, random stops and classical models of plays and relays, each with the ways of
//! seeing the input that may serve it. The list depends on what the data have (time, further inputs) and
//! on what the user has decided, never on the numbers in them.

use crate::automatic::AutoOptions;
use crate::classical::identification::{ClassicalOptions, Rival};
use crate::identification::{ModelName, Request};
use crate::network::{Family, Sizes};
use crate::preprocessing::Shaping;
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::training::{FitOptions, Regularisation};

/// Candidates of one kind, which agree among themselves before they answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Trained networks.
    Networks,
    /// Networks of random stops.
    RandomStops,
    /// Classical models: relays, plays and the like.
    Classical,
}

impl Kind {
    pub const ALL: [Kind; 3] = [Kind::Classical, Kind::Networks, Kind::RandomStops];

    pub fn name(self) -> &'static str {
        match self {
            Kind::Networks => "networks",
            Kind::RandomStops => "random stops",
            Kind::Classical => "classical",
        }
    }
}

/// A model that may serve, with its options.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub kind: Kind,
    request: Request,
}

/// Scale of the companding of the input: for what happens within a tenth or a fiftieth of its range.
const COMPANDING: [f64; 2] = [0.1, 0.02];

/// Scale of the companding of the rate.
const RATE_COMPANDING: f64 = 0.1;

/// Penalties of networks that answer together. Chosen on measured and generated cases: docs/accuracy.md.
const PENALTIES: Regularisation = Regularisation { ridge: 3e-4, decay: 1e-7 };

/// Epochs of a network. As above.
const EPOCHS: usize = 25;

/// Random stops with a linear readout, and with a random tanh layer: numbers of stops and tanh neurons. As
/// above.
const LINEAR_RANDOM_STOPS: (usize, usize) = (300, 0);
const LAYERED_RANDOM_STOPS: (usize, usize) = (100, 100);

/// Starts of a search that is repeated on every fold.
const STARTS_OF_JILES_ATHERTON: usize = 3;

/// Rows that a network's early iterations use at most.
const THIN: usize = 3000;

impl Candidate {
    /// A model that the user has decided for.
    pub fn alone(request: &Request) -> Self {
        let kind = match request {
            Request::Network(_) => Kind::Networks,
            Request::Classical(options) if options.model == Rival::RandomStops => Kind::RandomStops,
            Request::Classical(_) | Request::Auto(_) => Kind::Classical,
        };
        Self { kind, request: request.clone() }
    }

    /// The same with so many rows of each record that only drive the memory.
    pub fn warmed_up(&self, rows: usize) -> Self {
        let mut warmed = self.clone();
        match &mut warmed.request {
            Request::Network(options) => options.shaping.warm_up = rows,
            Request::Classical(options) => options.shaping.warm_up = rows,
            Request::Auto(_) => {}
        }
        warmed
    }

    /// What is asked for, for a start of its own.
    pub fn request(&self, start: usize) -> Request {
        let mut request = self.request.clone();
        let seed = match &mut request {
            Request::Network(options) => &mut options.seed,
            Request::Classical(options) => &mut options.seed,
            Request::Auto(_) => unreachable!("no candidate is made of candidates"),
        };
        *seed = seed.wrapping_add((start as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        request
    }

    /// True if another start gives another model; a classical model is searched from several in any case.
    pub fn is_random(&self) -> bool {
        match &self.request {
            Request::Network(_) => true,
            Request::Classical(options) => options.model == Rival::RandomStops,
            Request::Auto(_) => false,
        }
    }

    /// What it is, in a few words.
    pub fn name(&self) -> String {
        let (shaping, deterioration) = match &self.request {
            Request::Network(options) => {
                (options.shaping, Some(!options.no_deterioration && options.model != Family::PreisachNn))
            }
            Request::Classical(options) => (options.shaping, options.deterioration),
            Request::Auto(_) => (Shaping::default(), None),
        };
        let mut name = self.request.model().name().to_string();
        let mut with = Vec::new();
        if deterioration == Some(true) {
            with.push("deterioration".to_string());
        }
        if self.request.rate().is_some() {
            with.push("rate".into());
        }
        if matches!(&self.request, Request::Network(options) if options.sizes.relaxation > 0) {
            with.push("relaxation".into());
        }
        if let Some(share) = shaping.companding {
            with.push(format!("input companded {share}"));
        }
        if let Some(share) = shaping.rate_companding {
            with.push(format!("rate companded {share}"));
        }
        if shaping.history {
            with.push("history".into());
        }
        if matches!(&self.request, Request::Classical(options) if options.hidden.is_some_and(|hidden| hidden > 0))
        {
            with.push("tanh layer".into());
        }
        if !with.is_empty() {
            name += &format!(" ({})", with.join(", "));
        }
        name
    }
}

/// All candidates for data like these.
pub(super) fn candidates(data: &Dataset, options: &AutoOptions) -> Vec<Candidate> {
    let rate = options.rate;
    let timed = rate.is_some();
    let mut all: Vec<Candidate> = Vec::new();
    let mut add = |kind, request| all.push(Candidate { kind, request });

    let as_it_is = Shaping::default();
    let [tenth, fiftieth] = COMPANDING.map(|share| Shaping { companding: Some(share), ..as_it_is });
    let rate_tenth = Shaping { rate_companding: Some(RATE_COMPANDING), ..as_it_is };
    let both = Shaping { rate_companding: Some(RATE_COMPANDING), ..tenth };
    let history = Shaping { history: true, ..as_it_is };

    use Family::{PreisachNn, Xpnn, XpnnPlus};
    let network = |model, deterioration, shaping, rate, relaxation| {
        Request::Network(of_network(options, model, deterioration, shaping, rate, relaxation))
    };
    for (model, deterioration, shaping) in [
        (XpnnPlus, true, as_it_is),
        (XpnnPlus, false, as_it_is),
        (Xpnn, true, as_it_is),
        (PreisachNn, false, as_it_is),
        (XpnnPlus, false, tenth),
        (Xpnn, true, tenth),
    ] {
        add(Kind::Networks, network(model, deterioration, shaping, None, 0));
    }
    if timed {
        for (model, deterioration, shaping, relaxation) in [
            (XpnnPlus, true, as_it_is, 0),
            (XpnnPlus, true, as_it_is, 4),
            (Xpnn, true, as_it_is, 0),
            (XpnnPlus, false, rate_tenth, 0),
            (XpnnPlus, false, rate_tenth, 4),
            (XpnnPlus, true, rate_tenth, 0),
            (Xpnn, false, rate_tenth, 0),
            (XpnnPlus, false, both, 0),
        ] {
            add(Kind::Networks, network(model, deterioration, shaping, rate, relaxation));
        }
    } else {
        add(Kind::Networks, network(XpnnPlus, false, fiftieth, None, 0));
        add(Kind::Networks, network(XpnnPlus, true, history, None, 0));
    }

    let random_stops = |shaping, rate, deterioration, (stops, hidden)| {
        Request::Classical(ClassicalOptions {
            rate,
            shaping,
            deterioration: Some(deterioration),
            operators: Some(options.operators.unwrap_or(stops)),
            hidden: Some(hidden),
            seed: options.seed,
            ..ClassicalOptions::of(Rival::RandomStops)
        })
    };
    let (linear, layered) = (LINEAR_RANDOM_STOPS, LAYERED_RANDOM_STOPS);
    let mut random = vec![(as_it_is, None, false, linear), (tenth, None, false, linear)];
    if timed {
        random.extend([(rate_tenth, rate, false, linear), (as_it_is, rate, true, layered)]);
    } else {
        random.extend([(as_it_is, None, true, linear), (as_it_is, None, true, layered)]);
    }
    for (shaping, rate, deterioration, sizes) in random {
        add(Kind::RandomStops, random_stops(shaping, rate, deterioration, sizes));
    }

    let classical = |model, shaping| {
        let operators = options.operators;
        Request::Classical(ClassicalOptions { shaping, operators, ..ClassicalOptions::of(model) })
    };
    for model in [Rival::Preisach, Rival::ModifiedPrandtlIshlinskii] {
        for shaping in [as_it_is, tenth, fiftieth] {
            add(Kind::Classical, classical(model, shaping));
        }
    }
    if !timed {
        let starts = Some(STARTS_OF_JILES_ATHERTON);
        add(
            Kind::Classical,
            Request::Classical(ClassicalOptions {
                starts,
                epochs: options.epochs,
                seed: options.seed,
                ..ClassicalOptions::of(Rival::JilesAtherton)
            }),
        );
    }
    all.retain(|candidate| options.allows(candidate, data));
    all
}

fn of_network(
    options: &AutoOptions,
    model: Family,
    deterioration: bool,
    shaping: Shaping,
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
        epochs: options.epochs.unwrap_or(EPOCHS),
        seed: options.seed,
        regularisation: PENALTIES,
        thin: THIN,
        ..FitOptions::default()
    }
}

impl AutoOptions {
    /// False for a candidate that does not fit the data or contradicts what the user has decided.
    fn allows(&self, candidate: &Candidate, data: &Dataset) -> bool {
        let request = &candidate.request;
        let (shaping, deteriorates) = match request {
            Request::Network(options) => (options.shaping, !options.no_deterioration),
            Request::Classical(options) => (options.shaping, options.deterioration == Some(true)),
            Request::Auto(_) => return false,
        };
        let is_network = matches!(request, Request::Network(_));
        let relaxes = matches!(request, Request::Network(options) if options.sizes.relaxation > 0);
        let is_random_stops = request.model() == ModelName::Rival(Rival::RandomStops);
        let takes_history = request.model().takes_further_inputs();
        request.model().hindrance(data, request.rate()).is_none()
            && (!shaping.history || takes_history)
            && self.deterioration.is_none_or(|wanted| wanted == deteriorates)
            && (!self.always_rate || request.rate().is_some())
            && self.relaxation.is_none_or(|wanted| !is_network || relaxes == (wanted > 0))
            && self.companding.is_none_or(|wanted| wanted == shaping.companding.is_some())
            && self.history.is_none_or(|wanted| wanted == shaping.history)
            && (data.names().inputs.len() == 1 || is_network || is_random_stops)
    }
}
