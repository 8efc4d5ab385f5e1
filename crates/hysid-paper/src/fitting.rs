//! How the networks of all experiments but that on training are trained: one architecture, one way. What is chosen
//! is chosen by cross-validation on training data.

mod choice;

use std::ops::ControlFlow;

use hysid::data::rate::RateMethod;
use hysid::data::record::Dataset;
use hysid::fit::identify;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::network::{FitOptions, Regularisation, Trainer};
use hysid::{Error, Result};
use hysid_core::network::{Family, Sizes};
use hysid_document::{Piece, Text};
use rayon::prelude::*;

use crate::conditions::{Observer, Settings};
pub use choice::{ChoiceResult, FoldKind, TrainingChoice, choose, medians};

/// The one architecture for everything, as the paper claims there is. Chosen by looking at all specimens
/// together: among 10 and 20 stops with 10, 15 and 20 tanh neurons, 10 tanh neurons leave 1.4 to 1.9 times the
/// error on the rate-dependent specimens, and 20 stops take three times as long for little.
pub const ARCHITECTURE: Sizes = Sizes { stops: 10, hidden: 20, relaxation: 4 };

/// Seeds from which every model is fitted.
pub const SEEDS: u64 = 3;

/// Networks whose median is taken: those with the lowest training errors of one seed.
pub const MEMBERS: usize = 8;

/// Random networks that are trained from each seed, and by how many iterations where these are not chosen.
#[derive(Debug, Clone, Copy)]
pub struct TrainingEffort {
    /// Random networks of each seed.
    pub starts: usize,
    /// Seeds of which a network is trained on each fold.
    pub seeds_on_folds: usize,
    /// Iterations to compare penalties with, and those to choose from.
    pub iterations: &'static [usize],
    /// Penalties to choose from, the first of them where nothing is chosen.
    pub penalties: &'static [Regularisation],
}

const FULL: TrainingEffort = TrainingEffort {
    starts: 24,
    seeds_on_folds: 3,
    iterations: &[60, 200],
    penalties: &[
        Regularisation { ridge: 1e-6, decay: 1e-7 },
        Regularisation { ridge: 1e-8, decay: 1e-9 },
        Regularisation { ridge: 1e-4, decay: 1e-6 },
    ],
};

/// A quick run, in which only the inputs and the capacities are chosen.
const QUICK: TrainingEffort = TrainingEffort {
    starts: 2,
    seeds_on_folds: 1,
    iterations: &[25],
    penalties: &[Regularisation { ridge: 1e-6, decay: 1e-7 }],
};

/// Starts and iterations of a classical model in a quick run; otherwise its own defaults.
const QUICK_RIVAL: (usize, usize) = (8, 20);

/// The effort of these settings.
pub fn effort(settings: Settings) -> TrainingEffort {
    if settings.quick { QUICK } else { FULL }
}

/// The seeds of these settings.
pub fn seeds(settings: Settings) -> impl Iterator<Item = u64> + Clone {
    (0..SEEDS).map(move |number| settings.seed.wrapping_add(number))
}

/// A network from one random start.
pub fn network(family: Family, choice: TrainingChoice, seed: u64, start: u64) -> FitOptions {
    FitOptions {
        model: family,
        sizes: ARCHITECTURE,
        rate: choice.has_rate.then_some(RateMethod::Central),
        starts: 1,
        no_deterioration: !choice.deteriorates,
        epochs: choice.iterations,
        // No start of a seed is one of another.
        seed: seed.wrapping_mul(1_000_003).wrapping_add(start),
        ridge: Some(choice.penalties.ridge),
        decay: Some(choice.penalties.decay),
        ..FitOptions::of(Trainer::LevenbergMarquardt)
    }
}

/// Networks from this number of random starts, the one with the lowest training error first.
pub fn networks(
    data: &Dataset,
    options: impl Fn(u64) -> FitOptions + Sync,
    starts: usize,
    observer: &dyn Observer,
) -> Result<Vec<Model>> {
    let of_start = |start: u64| fit(data, &FitSpec::Network(options(start)), observer);
    let mut models: Vec<Model> = (0..starts as u64).into_par_iter().map(of_start).collect::<Result<_>>()?;
    models.sort_by(|a, b| training_error(a).total_cmp(&training_error(b)));
    Ok(models)
}

/// Error on the training data in percent of the output's standard deviation.
pub fn training_error(model: &Model) -> f64 {
    model.provenance().train.nrmse_std_percent.unwrap_or(f64::INFINITY)
}

/// The way of training in words.
pub fn words(settings: Settings) -> Text {
    let TrainingEffort { starts, .. } = effort(settings);
    let how = format!(
        "XPNN: {} stops and {} tanh neurons for all specimens, trained by Levenberg-Marquardt from {starts} random \
         starts of each of {SEEDS} seeds. One network is that with the lowest training error of a seed; the median \
         of networks is that of the outputs of the {} with the lowest training errors. Inputs, capacities, penalties \
         and iterations are chosen by five-fold cross-validation on the training data; a choice counts for all seeds. \
         Capacities are left out only if that lowers the mean error on the folds by a quarter. \
         Figures are medians of the seeds. The paper trains by its hybrid of genetic algorithm and sub-gradient \
         method; the experiment ",
        ARCHITECTURE.stops,
        ARCHITECTURE.hidden,
        MEMBERS.min(starts)
    );
    let rest = " compares the two. No unseen data were trained on or chosen by, but the test was not blind: the \
                architecture, the rules of the choice, some specimens and their paths were designed with knowledge of \
                errors on unseen data.";
    Text::from(how).with(Piece::Code("training".into())).with(Piece::Plain(rest.into()))
}

/// A rival's request with the starts and iterations of these settings.
pub fn rival(request: FitSpec, settings: Settings) -> FitSpec {
    match request {
        FitSpec::Classical(mut options) if settings.quick && options.model.is_searched() => {
            (options.starts, options.epochs) = (Some(QUICK_RIVAL.0), Some(QUICK_RIVAL.1));
            FitSpec::Classical(options)
        }
        request => request,
    }
}

/// Fits a model; an error as of [`identify`], or if stopped.
pub fn fit(data: &Dataset, request: &FitSpec, observer: &dyn Observer) -> Result<Model> {
    let fit = identify(data, request, &mut |_| match observer.is_stopped() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    })?;
    if observer.is_stopped() { Err(Error::Stopped) } else { Ok(fit.model) }
}
