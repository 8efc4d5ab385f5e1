//! Honest validation: a model is fitted to a part of the data and judged, in free run, on the rest.
//!
//! From several records, some are held out in turn. A single record is cut in time: the model sees its
//! beginning and foretells what follows, with the memory carried over, because that is what it will be used
//! for; blocks from its beginning and middle are held out too, which tell a model that merely follows this
//! one path from one that knows the material.

use serde::Serialize;

use crate::error::{Error, Result};
use crate::identification::{Request, identify};
use crate::metrics::{ErrorSums, Errors};
use crate::record::{Dataset, Record};
use crate::training::{FEWEST_ROWS, Observer, Progress};

/// A part to fit to and a part to judge on.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    /// What is held out, in words.
    pub name: String,
    /// What is fitted to.
    pub train: Dataset,
    /// What is judged on; of a single record, the whole of it with blanks where it is not judged, so that
    /// the memory is carried over.
    pub held_out: Dataset,
}

/// Shares of a single record that are fitted to, from its beginning, and those that follow and are judged.
const FORECASTS: [(f64, f64); 3] = [(0.5, 0.25), (0.6, 0.3), (0.7, 0.3)];

/// Shares of a single record between which a block is held out from the rest.
const BLOCKS: [(f64, f64); 2] = [(0.0, 0.35), (0.35, 0.65)];

/// The folds of a data set: of several records at most `most`, of a single one always five. None if the
/// data are too few.
pub fn folds(data: &Dataset, most: usize) -> Vec<Fold> {
    let folds = match data.records() {
        [record] => of_record(data, record),
        _ => of_records(data, most),
    };
    let is_enough =
        |fold: &Fold| fold.train.check_identifiable(FEWEST_ROWS).is_ok() && fold.held_out.scored() > 0;
    folds.into_iter().filter(is_enough).collect()
}

/// Records with an output are dealt out in their order.
fn of_records(data: &Dataset, most: usize) -> Vec<Fold> {
    let scored: Vec<usize> =
        (0..data.records().len()).filter(|&index| data.records()[index].scored() > 0).collect();
    let count = scored.len().min(most);
    if count < 2 {
        return Vec::new();
    }
    let fold = |fold: usize| {
        let held: Vec<usize> = scored.iter().copied().skip(fold).step_by(count).collect();
        let (held_out, train) = data.partition(|index| held.contains(&index));
        let names: Vec<&str> = held_out.records().iter().map(Record::name).collect();
        Fold { name: names.join(", "), train, held_out }
    };
    (0..count).map(fold).collect()
}

fn of_record(data: &Dataset, record: &Record) -> Vec<Fold> {
    let scored: Vec<usize> = (0..record.len()).filter(|&row| !record.output()[row].is_nan()).collect();
    let row = |share: f64| {
        let place = (share * scored.len() as f64).round() as usize;
        scored.get(place).copied().unwrap_or(record.len())
    };
    let percent = |share: f64| (100.0 * share).round();
    let forecast = |&(fitted, judged): &(f64, f64)| {
        let (begin, end) = (row(fitted), row(fitted + judged));
        Fold {
            name: format!("{} to {} %, from what came before", percent(fitted), percent(fitted + judged)),
            train: data.of_record(record.rows_up_to(begin)),
            held_out: data.of_record(record.rows_up_to(end).scored_where(|row| row >= begin)),
        }
    };
    let block = |&(from, to): &(f64, f64)| {
        let (begin, end) = (row(from), row(to));
        Fold {
            name: format!("{} to {} %, from the rest", percent(from), percent(to)),
            train: data.of_record(record.clone().scored_where(|row| row < begin || row >= end)),
            held_out: data.of_record(record.rows_up_to(end).scored_where(|row| row >= begin)),
        }
    };
    if scored.len() < 4 * FEWEST_ROWS {
        return Vec::new();
    }
    FORECASTS.iter().map(forecast).chain(BLOCKS.iter().map(block)).collect()
}

/// What came of a fold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoldErrors {
    /// What was held out, in words.
    pub held_out: String,
    /// Errors on what was fitted to.
    pub train: Errors,
    /// Errors on what was held out.
    pub unseen: Errors,
}

/// What came of all folds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossValidation {
    /// Fold by fold; those that were not reached before the observer said stop are missing.
    pub folds: Vec<FoldErrors>,
    /// Errors over all rows held out together; of a single record, rows are in several folds.
    pub unseen: Errors,
    /// Geometric mean over the folds of the error on what was held out, in percent of the standard
    /// deviation there: one fold that goes far beyond the others does not decide it.
    pub unseen_nrmse_std_percent: Option<f64>,
}

/// Identifies a model on each fold and judges it on what was held out. The observer is as in
/// [`identify`]; its share of the work done is that of all folds.
///
/// # Errors
/// Data too few for two folds, and as [`identify`].
pub fn cross_validate(
    data: &Dataset,
    request: &Request,
    most_folds: usize,
    observer: &mut Observer<'_>,
) -> Result<CrossValidation> {
    let folds = folds(data, most_folds);
    if folds.len() < 2 {
        return Err(Error::Option(format!(
            "the data are too few to hold any out: at least two records, or one of {} rows",
            4 * FEWEST_ROWS
        )));
    }
    let mut sums = ErrorSums::default();
    let mut done = Vec::new();
    for (place, fold) in folds.iter().enumerate() {
        let mut stopped = false;
        let mut of_fold = |progress: &Progress| {
            let share = (place as f64 + progress.done) / folds.len() as f64;
            let flow = observer(&progress.of_part(share));
            stopped = flow.is_break();
            flow
        };
        let model = identify(&fold.train, request, &mut of_fold)?.model;
        for record in fold.held_out.records() {
            sums.add(record.output(), &model.simulate(record)?);
        }
        done.push(FoldErrors {
            held_out: fold.name.clone(),
            train: model.provenance().train.clone(),
            unseen: model.evaluate(&fold.held_out)?,
        });
        if stopped {
            break;
        }
    }
    let unseen = sums.errors(&data.names().output).expect("every fold has rows to judge on");
    let logarithms: Option<Vec<f64>> =
        done.iter().map(|fold| Some(fold.unseen.nrmse_std_percent?.ln())).collect();
    let mean = |logarithms: Vec<f64>| (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
    Ok(CrossValidation { unseen_nrmse_std_percent: logarithms.map(mean), folds: done, unseen })
}
