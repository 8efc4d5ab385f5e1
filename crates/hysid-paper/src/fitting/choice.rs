//! The choice of input, penalties and iterations by cross-validation on training data.

use hysid::Result;
use hysid::data::record::Dataset;
use hysid::options::network::Regularisation;
use hysid::validation::{Fold, folds, folds_of_cycles};
use hysid_core::elementary::{exp, ln};
use hysid_core::network::Family;
use hysid_document::{Cell, Table, number};
use rayon::prelude::*;

use super::{TrainingEffort, effort, network, networks, seeds, training_error};
use crate::conditions::{Observer, Settings};
use crate::spread::median;

const FOLDS: usize = 5;

/// Mean error on the folds, relative to that without, below which direction is an input or capacities are left out.
/// Designed, with knowledge of errors on unseen data.
const CLEAR_GAIN: f64 = 0.75;

/// Where unseen data lie; the folds of a single record imitate that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoldKind {
    /// After the training data, or in other records.
    After,
    /// Between the training data: cycles among others.
    Between,
}

/// How a network of a family is trained on data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainingChoice {
    /// The rate is an input.
    pub has_rate: bool,
    /// The stops deteriorate; otherwise their capacities are unlimited, as the paper's 10⁷ is.
    pub deteriorates: bool,
    pub penalties: Regularisation,
    /// Iterations of a start.
    pub iterations: usize,
}

#[derive(Debug, Clone)]
struct ChoiceTrial {
    choice: TrainingChoice,
    /// Error of each fold on its training data, in percent of std.
    training: Vec<f64>,
    /// Error on what was held out, in percent of its std.
    percents: Vec<f64>,
}

/// Chosen training, and the trials behind it.
#[derive(Debug, Clone)]
pub struct ChoiceResult {
    pub choice: TrainingChoice,
    trials: Vec<ChoiceTrial>,
    why_rate: &'static str,
}

/// Chooses how networks of a family are trained on data: first whether the rate is an input, then whether stops of an
/// XPNN deteriorate, then the penalties, then the number of iterations. Penalties and iterations are those with the
/// lowest mean error on the folds. A single record has one speed, at which the rate tells the direction and no more: it is an
/// input only with a [clear gain](CLEAR_GAIN). Capacities are part of the paper's network, and left out only with such
/// a gain.
pub fn choose(
    what: &str,
    data: &Dataset,
    family: Family,
    kind: FoldKind,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<ChoiceResult> {
    let TrainingEffort { iterations, penalties, .. } = effort(settings);
    let folds = match kind {
        FoldKind::Between => folds_of_cycles(data, FOLDS),
        FoldKind::After => folds(data, FOLDS),
    };
    let can_have_rate = family.uses_rate() && data.has_time();
    let differs_in_rate = data.records().len() > 1;
    let first = TrainingChoice {
        has_rate: can_have_rate && differs_in_rate,
        deteriorates: family.deteriorates(),
        penalties: penalties[0],
        iterations: iterations[0],
    };
    let mut bench = ChoiceBench { what, folds, family, settings, observer, trials: Vec::new() };
    let mut best = first;
    let why_rate = match (can_have_rate, differs_in_rate) {
        (false, _) if family.uses_rate() => "The record has no time, so x is the only input.",
        (false, _) => "The family has no rate.",
        (true, true) => "The records differ in rate, so x' is an input.",
        (true, false) => {
            best = bench.if_clearly_better(first, TrainingChoice { has_rate: true, ..first })?;
            match best.has_rate {
                true => {
                    "The record has one speed, so that x' tells only the direction; it is an input because it lowers the mean error on the folds by a quarter or more."
                }
                false => {
                    "The record has one speed, so that x' tells only the direction; it is no input because it does not lower the mean error on the folds by a quarter."
                }
            }
        }
    };
    if family == Family::Xpnn {
        best = bench.if_clearly_better(best, TrainingChoice { deteriorates: false, ..best })?;
    }
    let of_penalties = penalties.iter().map(|&penalties| TrainingChoice { penalties, ..best });
    best = bench.best(of_penalties.collect())?;
    let of_iterations = iterations.iter().map(|&iterations| TrainingChoice { iterations, ..best });
    best = bench.best(of_iterations.collect())?;
    Ok(ChoiceResult { choice: best, trials: bench.trials, why_rate })
}

struct ChoiceBench<'a> {
    what: &'a str,
    folds: Vec<Fold>,
    family: Family,
    settings: Settings,
    observer: &'a dyn Observer,
    trials: Vec<ChoiceTrial>,
}

impl ChoiceBench<'_> {
    /// The alternative if it has a [clear gain](CLEAR_GAIN), otherwise the default.
    fn if_clearly_better(
        &mut self,
        default: TrainingChoice,
        alternative: TrainingChoice,
    ) -> Result<TrainingChoice> {
        let limit = CLEAR_GAIN * mean(&self.percents(default)?);
        Ok(if mean(&self.percents(alternative)?) < limit { alternative } else { default })
    }

    fn best(&mut self, candidates: Vec<TrainingChoice>) -> Result<TrainingChoice> {
        if self.folds.is_empty() || candidates.len() == 1 {
            return Ok(candidates[0]);
        }
        let mut best = (f64::INFINITY, candidates[0]);
        for candidate in candidates {
            let error = mean(&self.percents(candidate)?);
            if error < best.0 {
                best = (error, candidate);
            }
        }
        Ok(best.1)
    }

    /// Error on each fold of the network with the lowest training error, of one from each seed.
    fn percents(&mut self, choice: TrainingChoice) -> Result<Vec<f64>> {
        if let Some(trial) = self.trials.iter().find(|trial| trial.choice == choice) {
            return Ok(trial.percents.clone());
        }
        let errors: Vec<(f64, f64)> =
            self.folds.par_iter().map(|fold| self.errors(fold, choice)).collect::<Result<_>>()?;
        let (training, percents): (Vec<f64>, Vec<f64>) = errors.into_iter().unzip();
        self.observer.say(&format!(
            "  {}: {} on five folds {} % of std",
            self.what,
            choice.words(),
            number(mean(&percents), 3)
        ));
        self.trials.push(ChoiceTrial { choice, training, percents: percents.clone() });
        Ok(percents)
    }

    fn errors(&self, fold: &Fold, choice: TrainingChoice) -> Result<(f64, f64)> {
        let TrainingEffort { seeds_on_folds, .. } = effort(self.settings);
        let seeds: Vec<u64> = seeds(self.settings).take(seeds_on_folds).collect();
        let of_seed = |place: u64| network(self.family, choice, seeds[place as usize], 0);
        let models = networks(&fold.train, of_seed, seeds.len(), self.observer)?;
        let held_out = models[0].evaluate(&fold.held_out)?.nrmse_std_percent;
        Ok((training_error(&models[0]), held_out.unwrap_or(f64::INFINITY)))
    }
}

/// The medians, row by row, of several outputs.
pub fn medians(outputs: &[Vec<f64>]) -> Vec<f64> {
    let rows = outputs.first().map_or(0, Vec::len);
    let of_row = |row: usize| {
        let mut values: Vec<f64> = outputs.iter().map(|output| output[row]).collect();
        median(&mut values).unwrap_or(f64::NAN)
    };
    (0..rows).map(of_row).collect()
}

/// Geometric mean: one fold with a large error does not decide.
fn mean(percents: &[f64]) -> f64 {
    exp(percents.iter().map(|percent| ln(*percent)).sum::<f64>() / percents.len() as f64)
}

impl TrainingChoice {
    pub fn words(self) -> String {
        format!(
            "{}, {}, ridge {:e} and decay {:e}, {} iterations",
            if self.has_rate { "x and x'" } else { "x alone" },
            if self.deteriorates { "capacities" } else { "no capacities" },
            self.penalties.ridge,
            self.penalties.decay,
            self.iterations
        )
    }
}

impl ChoiceResult {
    /// The choice in a sentence or two.
    pub fn words(&self, name: &str) -> String {
        let by =
            if self.trials.is_empty() { "" } else { ", chosen by cross-validation on the training data" };
        format!("{name}: {}{by}. {}", self.choice.words(), self.why_rate)
    }

    /// Table of the trials, with the errors on the folds; `None` if there was nothing to choose from.
    pub fn table(&self, heading: &str) -> Option<Table> {
        let folds = self.trials.first()?.percents.len();
        let columns = ["tried", "training", "mean"].map(String::from).into_iter();
        let columns = columns.chain((1..=folds).map(|fold| format!("fold {fold}")));
        let row = |trial: &ChoiceTrial| {
            let is_chosen = trial.choice == self.choice;
            let name = trial.choice.words() + if is_chosen { " (chosen)" } else { "" };
            let percents = trial.percents.iter().map(|&percent| percent.into());
            let means = [mean(&trial.training), mean(&trial.percents)].map(Cell::from);
            std::iter::once(name.into()).chain(means).chain(percents).collect()
        };
        let heading = format!(
            "{heading}: error on what five folds of the training data hold out, % of std, with geometric means of that and of the error on the rest"
        );
        Some(Table::new(columns).headed(heading).with_rows(self.trials.iter().map(row)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_outputs_is_that_of_each_row() {
        let outputs = [vec![1.0, 5.0], vec![3.0, 4.0], vec![2.0, 9.0]];
        assert_eq!(medians(&outputs), [2.0, 5.0]);
        assert_eq!(medians(&outputs[..2]), [2.0, 4.5]);
    }
}
