//! Classical models as candidates of `auto`: what laws have in common.

use crate::data::record::Dataset;
use crate::diagnosis::resonance::ComparedSignal;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::effort::Effort;
use crate::options::fit_spec::AutoOptions;
use crate::options::input_options::InputOptions;
use crate::options::variants::variants;

/// Scale of the compression of the input: for what happens within a tenth or a fiftieth of its range.
pub(crate) const COMPRESSION: [f64; 2] = [0.1, 0.02];

pub(crate) const RATE_COMPRESSION: f64 = 0.1;

/// Rank of a law that is not known to be good.
const LAST: usize = usize::MAX;

/// The data and the options that candidates depend on.
pub struct CandidateRequest<'a> {
    pub data: &'a Dataset,
    pub options: &'a AutoOptions,
    /// Where the data show a resonance, if they do.
    pub resonance: Option<ComparedSignal>,
}

/// A rank, the lowest of which is tried first, and the law.
pub type RankedLaw = (usize, ClassicalOptions);

/// The law with what the user has decided of laws.
pub(crate) fn of_law(model: ClassicalModel, options: &AutoOptions) -> ClassicalOptions {
    ClassicalOptions {
        operators: options.operators,
        epochs: options.epochs,
        seed: options.seed,
        ..ClassicalOptions::of(model)
    }
}

pub(crate) fn compressed(share: f64) -> InputOptions {
    InputOptions { compression: Some(share), ..InputOptions::default() }
}

pub(crate) fn with_compressed_rate() -> InputOptions {
    InputOptions { rate_compression: Some(RATE_COMPRESSION), ..InputOptions::default() }
}

/// The law with the input as it is and compressed, with these ranks.
pub(crate) fn in_all_compressions(
    model: ClassicalModel,
    options: &AutoOptions,
    ranks: [usize; 3],
) -> Vec<RankedLaw> {
    let [tenth, fiftieth] = COMPRESSION.map(compressed);
    let shaped = |shaping| ClassicalOptions { shaping, ..of_law(model, options) };
    ranks.into_iter().zip([InputOptions::default(), tenth, fiftieth].map(shaped)).collect()
}

/// A searched law in all variants, or another as it is.
pub(super) fn by_default(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
    let laws = match model.is_searched() {
        _ if !model.facts().is_candidate => return Vec::new(),
        true => searched(model, request.options),
        false => vec![of_law(model, request.options)],
    };
    laws.into_iter().map(|law| (LAST, law)).collect()
}

/// With a rate, variants without it are left out, because its weight may be 0.
fn searched(model: ClassicalModel, options: &AutoOptions) -> Vec<ClassicalOptions> {
    if (model.needs_rate() || model.needs_time()) && options.rate.is_none() {
        return Vec::new();
    }
    let rate = options.rate.filter(|_| model.uses_rate());
    let searched = |law: ClassicalOptions| match options.effort {
        Effort::Normal => law,
        effort => ClassicalOptions {
            starts: Some(effort.scaled(law.starts())),
            epochs: law.epochs.or_else(|| Some(effort.scaled(law.epochs()))),
            ..law
        },
    };
    let all = variants(&ClassicalOptions { rate, ..of_law(model, options) }).into_iter();
    all.filter(|law| law.rate.is_some() || rate.is_none()).map(searched).collect()
}
