//! Facts about a law beside its equations: name, options, and how it is identified.

/// Facts that hold for a law with any parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The name on the command line and in model files.
    pub name: &'static str,
    /// Summary of the law, in a few words.
    pub summary: &'static str,
    /// Kind of model, by which `auto` groups its candidates.
    pub kind: LawKind,
    /// Whether the rate of the input is in its equations.
    pub rate: Rate,
    /// True if it needs the time between samples.
    pub needs_time: bool,
    /// True if it takes inputs beside the first.
    pub takes_further_inputs: bool,
    /// True if its states before a record can be found together with its parameters.
    pub has_free_states: bool,
    /// The origin of its input.
    pub origin: Origin,
    /// How its parameters are found.
    pub identification: Identification,
    /// Options of a fit that it uses, in addition to those of every model.
    pub options: &'static [&'static str],
    /// Smallest and largest values of such options, where they are not those of the table of options.
    pub limits: &'static [(&'static str, usize, usize)],
    /// Default values of counts (parts, starts, epochs) that differ from the general ones.
    pub defaults: Defaults,
    /// Default values with `degradation`, where they differ.
    pub defaults_with_degradation: Defaults,
    /// The options that select a variant of the law, each by itself: a further term, or another form.
    pub variants: &'static [&'static str],
    /// For data of one loop: the error to be expected on smaller loops inside it, however well the law fits the loop.
    pub errors_inside: ErrorsInside,
    /// False for a law that `auto` does not try.
    pub is_candidate: bool,
    /// True for a law of many numbers that `auto` may take by itself, because its equations hold outside the data.
    pub stands_alone: bool,
    /// True if a model with more modes contains those with fewer.
    pub nests_modes: bool,
    /// Behaviour of data for which a diagnosis advises it.
    pub advice: &'static [(Behaviour, Advised)],
}

/// Kinds of classical models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawKind {
    /// A law without random parts.
    Law,
    /// A network with random, untrained memory.
    RandomNetwork,
    /// A recurrent network.
    Recurrent,
    /// Masses on springs, dampers and hysteretic elements.
    Inertia,
}

/// Behaviour that a diagnosis finds in data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behaviour {
    /// A resonance.
    Resonance,
    /// Closed excursions of the input that change the output, without deterioration, in loops with odd symmetry.
    Traces,
    /// Branches of several shapes, and minor loops between the same inputs that do not differ.
    UnlikeBranches,
    /// Only properties that a weighted sum of plays has.
    SumOfPlays,
    /// Loss of strength by repetition or with the amplitude.
    Degradation,
    /// Loops that are narrow in the middle.
    Pinching,
    /// Dependence on the rate.
    RateDependence,
}

/// How a diagnosis advises a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advised {
    /// As the simplest model that can represent the behaviour.
    Simplest,
    /// As a model with fewer parameters than the simplest one that fits all such data; a remark, in a few words.
    FewerParameters(&'static str),
}

/// Errors on smaller loops of laws fitted to one loop, as shares of the standard deviation, by branch shape. Designed
/// (docs/accuracy.md).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorsInside {
    /// Branches that only become flatter, as of a structure that yields.
    pub softening: f64,
    /// Branches that are flat at both ends and steep between, as of a magnet that saturates.
    pub sigmoid: f64,
    /// Other branches, as of a pinched loop.
    pub other: f64,
}

/// Default values of options that count something, by their names.
pub type Defaults = &'static [(&'static str, usize)];

/// Defaults of a law that a search finds.
const OF_SEARCHES: Defaults = &[("starts", 8), ("epochs", 40)];

impl Facts {
    /// The same facts with defaults of the law's own.
    pub const fn with_defaults(self, defaults: Defaults) -> Self {
        Self { defaults, ..self }
    }

    /// Default value of an option that counts something; 0 for what the law does not have.
    pub fn default_of(&self, option: &str, degradation: bool) -> usize {
        let with_degradation = if degradation { self.defaults_with_degradation } else { &[] };
        let of_searches = if self.identification == Identification::Search { OF_SEARCHES } else { &[] };
        let mut all = [with_degradation, self.defaults, of_searches].into_iter().flatten();
        all.find(|(name, _)| *name == option).map_or(0, |(_, count)| *count)
    }

    /// A law that linear least squares finds, without a rate, limits or variants.
    pub const fn linear(
        name: &'static str,
        summary: &'static str,
        options: &'static [&'static str],
        errors_inside: ErrorsInside,
    ) -> Self {
        Self {
            name,
            summary,
            rate: Rate::Ignored,
            needs_time: false,
            takes_further_inputs: false,
            has_free_states: false,
            origin: Origin::OfData,
            identification: Identification::LeastSquares,
            options,
            limits: &[],
            defaults: &[],
            defaults_with_degradation: &[],
            variants: &[],
            errors_inside,
            kind: LawKind::Law,
            is_candidate: true,
            stands_alone: false,
            nests_modes: false,
            advice: &[],
        }
    }

    /// A law that a search finds, without a rate, limits or variants.
    pub const fn searched(
        name: &'static str,
        summary: &'static str,
        options: &'static [&'static str],
        errors_inside: ErrorsInside,
    ) -> Self {
        Self { identification: Identification::Search, ..Self::linear(name, summary, options, errors_inside) }
    }
}

/// Whether the rate of the input is in the equations of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// The rate does not occur.
    Ignored,
    /// The rate is an optional term.
    Optional,
    /// The rate is always needed.
    Needed,
}

/// The origin from which the inputs of a model are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// 0, for laws in which an input of 0 is this special state, in words.
    Zero(&'static str),
    /// 0 if it lies within the data; otherwise where the records begin, or the middle of their range.
    OfData,
}

/// How the parameters of a law are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Identification {
    /// By linear least squares, from one start.
    LeastSquares,
    /// By a search from several starts.
    Search,
}
