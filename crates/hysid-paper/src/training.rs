//! The paper's comparison of trainers: genetic algorithm alone, sub-gradient method alone, the two
//! together, each for the same number of epochs, and Levenberg-Marquardt beside them.

mod page;

use std::ops::ControlFlow;

use hysid::data::metrics::Errors;
use hysid::data::rate::RateMethod;
use hysid::data::record::Dataset;
use hysid::fit::network::fit;
use hysid::options::network::{FitOptions, Trainer};
use hysid::specimens::Specimen;
use hysid::{Error, Result};
use hysid_core::network::Family;

use crate::chapter::Chapter;
use crate::conditions::{Observer, Settings};
pub use page::FILES;

/// Stands in for the paper's second example, on which it compares the trainers.
const SPECIMEN: &str = "reinforced-concrete-joint";

const SEEDS: u64 = 5;

/// Epochs of every trainer of the paper.
const EPOCHS: usize = 2000;

/// Levenberg-Marquardt gets this share of the epochs; most of its descents converge before.
const SHARE_OF_EPOCHS: usize = 10;

/// In the order of the tables.
const TRAINERS: [Trainer; 4] =
    [Trainer::Genetic, Trainer::Subgradient, Trainer::Hybrid, Trainer::LevenbergMarquardt];

struct TrainingProtocol {
    specimen: &'static Specimen,
    train: Dataset,
    test: Dataset,
    first_seed: u64,
    epochs: usize,
}

#[derive(Debug, Clone, Copy)]
struct Moment {
    epoch: usize,
    evaluations: usize,
    seconds: f64,
    /// Lowest error so far, in percent of the output's standard deviation.
    nrmse_percent: f64,
}

struct TrainerRun {
    trainer: Trainer,
    seed: u64,
    train: Errors,
    test: Errors,
    moments: Vec<Moment>,
    seconds: f64,
    evaluations: usize,
}

struct Repetition {
    trainings: Vec<TrainerRun>,
    /// Seconds until the sub-gradient method reaches the hybrid's error; `None` if not within the hybrid's time.
    seconds_to_match: Option<f64>,
}

impl Repetition {
    fn of(&self, trainer: Trainer) -> Option<&TrainerRun> {
        self.trainings.iter().find(|training| training.trainer == trainer)
    }
}

impl TrainerRun {
    /// Lowest error up to an epoch, in percent of the output's standard deviation.
    fn percent_at(&self, epoch: usize) -> Option<f64> {
        let moment = self.moments.iter().rfind(|moment| moment.epoch <= epoch)?;
        Some(moment.nrmse_percent)
    }
}

impl TrainingProtocol {
    /// The whole protocol, or a tenth of its epochs.
    fn new(first_seed: u64, quick: bool) -> Self {
        let specimen = Specimen::named(SPECIMEN).expect("the specimen is in the catalogue");
        let (train, test) = (specimen.train(), specimen.test());
        Self { specimen, train, test, first_seed, epochs: if quick { EPOCHS / 10 } else { EPOCHS } }
    }

    fn options(&self, trainer: Trainer, seed: u64) -> FitOptions {
        FitOptions {
            model: Family::Xpnn,
            rate: Some(RateMethod::Central),
            starts: 1,
            epochs: match trainer {
                Trainer::LevenbergMarquardt => self.epochs / SHARE_OF_EPOCHS,
                _ => self.epochs,
            },
            stall: 0,
            seed,
            ..FitOptions::of(trainer)
        }
    }
}

/// Runs the comparison.
pub fn chapter(settings: Settings, observer: &dyn Observer) -> Result<Chapter> {
    compared(&TrainingProtocol::new(settings.seed, settings.quick), observer)
}

fn compared(protocol: &TrainingProtocol, observer: &dyn Observer) -> Result<Chapter> {
    let seeds = protocol.first_seed..protocol.first_seed + SEEDS;
    let repetitions: Vec<Repetition> =
        seeds.map(|seed| repetition(protocol, seed, observer)).collect::<Result<_>>()?;
    Ok(page::chapter(protocol, &repetitions))
}

fn repetition(protocol: &TrainingProtocol, seed: u64, observer: &dyn Observer) -> Result<Repetition> {
    let mut trainings = Vec::new();
    for trainer in TRAINERS {
        let training = training(protocol, trainer, seed, observer)?;
        observer.say(&format!(
            "  training, seed {seed}: {:<19} {:8.4} % of std, {:6.2} s, {:>6} evaluations",
            trainer.name(),
            training.train.nrmse_std_percent.unwrap_or_default(),
            training.seconds,
            training.evaluations
        ));
        trainings.push(training);
    }
    let hybrid = trainings.iter().find(|training| training.trainer == Trainer::Hybrid);
    let hybrid = hybrid.expect("the hybrid is among the trainers");
    let seconds_to_match = seconds_to_match(protocol, seed, hybrid, observer)?;
    if observer.is_stopped() { Err(Error::Stopped) } else { Ok(Repetition { trainings, seconds_to_match }) }
}

fn training(
    protocol: &TrainingProtocol,
    trainer: Trainer,
    seed: u64,
    observer: &dyn Observer,
) -> Result<TrainerRun> {
    let mut moments: Vec<Moment> = Vec::new();
    let began = observer.clock();
    let fitted = fit(&protocol.train, &protocol.options(trainer, seed), &mut |progress| {
        moments.push(Moment {
            epoch: progress.epoch,
            evaluations: progress.evaluations,
            seconds: (observer.clock() - began).as_secs_f64(),
            nrmse_percent: progress.train_nrmse_percent,
        });
        if observer.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let seconds = (observer.clock() - began).as_secs_f64();
    if observer.is_stopped() {
        return Err(Error::Stopped);
    }
    Ok(TrainerRun {
        trainer,
        seed,
        train: fitted.model.provenance().train.clone(),
        test: fitted.model.evaluate(&protocol.test)?,
        moments,
        seconds,
        evaluations: fitted.evaluations,
    })
}

/// The sub-gradient method from start after start, until it is as low as the hybrid at its end.
fn seconds_to_match(
    protocol: &TrainingProtocol,
    seed: u64,
    hybrid: &TrainerRun,
    observer: &dyn Observer,
) -> Result<Option<f64>> {
    let target = hybrid.train.nrmse_std_percent.expect("the specimen's output varies");
    let began = observer.clock();
    let elapsed = || (observer.clock() - began).as_secs_f64();
    let mut reached = None;
    for start in 0.. {
        let over = || elapsed() > hybrid.seconds || observer.is_stopped();
        if reached.is_some() || over() {
            break;
        }
        // Seeds of other repetitions are not used twice.
        let options = FitOptions {
            epochs: protocol.epochs / 2,
            ..protocol.options(Trainer::Subgradient, seed + start * 1_000_003)
        };
        let fitted = fit(&protocol.train, &options, &mut |progress| {
            if progress.train_nrmse_percent <= target {
                reached = Some(elapsed());
            }
            if reached.is_some() || over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        match fitted {
            // The time of the hybrid ended before this start had a model.
            Ok(_) | Err(Error::Stopped) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(reached)
}

#[cfg(test)]
mod tests;
