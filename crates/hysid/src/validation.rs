//! Cross-validation: a model is fitted to a part of the data and evaluated on the rest, in free run.
//!
//! Several records are divided into folds, each held out in turn. Records of one protocol stay in one fold, copies,
//! parts and repeats of a test: a second run of training data does not measure the error on new data. A single record, and
//! each run of a single protocol, is divided in time: a model is fitted to its beginning and predicts the following rows, with its memory continued.
//! In addition, blocks from the beginning and the middle are held out, so that every row is held out at least once.
//! `auto` uses three of these five folds.

mod pooled;
mod row_folds;

use std::collections::{HashMap, HashSet};

use serde::Serialize;

use crate::data::FEWEST_ROWS;
use crate::data::known_beginning::KnownBeginning;
use crate::data::metrics::Errors;
use crate::data::record::{Dataset, Record, RepeatedProtocol, protocols};
use crate::error::{Error, Result};
use crate::model::Model;
pub(crate) use pooled::PooledErrors;
pub(crate) use row_folds::RowFolds;

/// A fold: training data and held-out data.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    /// Name of the held-out data.
    pub name: String,
    /// The training data.
    pub train: Dataset,
    /// The held-out data; a single record is whole, with the outputs of all other rows blanked.
    pub held_out: Dataset,
}

impl Fold {
    /// True if a record that is held out as a whole lies beyond those of the training data: its amplitude or its speed is
    /// larger or smaller than any of theirs. The error on it is one of extrapolation.
    pub(crate) fn is_beyond(&self) -> bool {
        let trained = self.train.records();
        let is_whole = |record: &&Record| trained.iter().all(|other| other.name() != record.name());
        let mut spans = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        for extent in trained.iter().map(extent) {
            for (span, value) in spans.iter_mut().zip(extent) {
                *span = value.map_or(*span, |value| (span.0.min(value), span.1.max(value)));
            }
        }
        let is_outside = |((least, most), value): ((f64, f64), Option<f64>)| {
            let is_outside = |value: f64| least > value * (1.0 + SLACK) || most * (1.0 + SLACK) < value;
            least <= most && value.is_some_and(is_outside)
        };
        let lies_outside = |record: &Record| spans.into_iter().zip(extent(record)).any(is_outside);
        self.held_out.records().iter().filter(is_whole).any(lies_outside)
    }

    /// The same with a known beginning of each record that is held out as a whole, with the outputs of `all` data, of which
    /// this is a fold; unless nothing would be left to score.
    pub(crate) fn with_known_beginning(self, beginning: KnownBeginning, all: &Dataset) -> Self {
        if beginning.is_none() {
            return self;
        }
        let trained = names(&self.train);
        let whole: HashMap<&str, &Record> =
            all.records().iter().map(|record| (record.name(), record)).collect();
        let known = |record: &Record| {
            let whole = whole.get(record.name()).filter(|_| !trained.contains(record.name()));
            whole.map_or(&[][..], |whole| &whole.output()[..beginning.rows(whole)])
        };
        let held_out = self.held_out.clone().with_known_outputs(known);
        if held_out.scored() > 0 { Self { held_out, ..self } } else { self }
    }

    /// The records of `all` data that this is fitted to, with all their outputs; `None` if parts of a record are held out.
    pub(crate) fn trained_of(&self, all: &Dataset) -> Option<Dataset> {
        let trained = names(&self.train);
        let is_trained = |record: &Record| trained.contains(record.name());
        let is_cut = self.held_out.records().iter().any(is_trained);
        (!is_cut).then(|| all.partition(|index| is_trained(&all.records()[index])).0)
    }

    /// The predictions of a model for the held-out rows with an output, in free run.
    pub(crate) fn predicted_by(&self, model: &Model) -> Result<Vec<f64>> {
        let mut predicted = Vec::with_capacity(self.held_out.scored());
        for record in self.held_out.records() {
            let rows = model.simulate(record)?.into_iter().zip(record.output());
            predicted.extend(rows.filter(|(_, y)| !y.is_nan()).map(|(simulated, _)| simulated));
        }
        Ok(predicted)
    }
}

/// Names of the records.
fn names(data: &Dataset) -> HashSet<&str> {
    data.records().iter().map(Record::name).collect()
}

/// Largest difference of an amplitude or a speed, relative to those of other records, that does not count as outside.
const SLACK: f64 = 0.05;

/// Amplitude of a record, and its speed in amplitudes per unit of time where it has one.
fn extent(record: &Record) -> [Option<f64>; 2] {
    let amplitude = Some(amplitude(record)).filter(|amplitude| *amplitude > 0.0);
    let speed = record.mean_speed().zip(amplitude).map(|(speed, amplitude)| speed / amplitude);
    [amplitude, speed]
}

fn amplitude(record: &Record) -> f64 {
    let (low, high) = record.input_range(0);
    high - low
}

/// Shares of a single record that are fitted to, from its beginning, and those that follow and are judged.
const FORECASTS: [(f64, f64); 3] = [(0.5, 0.25), (0.6, 0.3), (0.7, 0.3)];

/// A forecast from at least so many percent of a record resembles one from all of it.
const MOST_OF_A_RECORD: f64 = 60.0;

/// Rows with an output of a record that is cut in time.
const FEWEST_TO_CUT: usize = 4;

/// Shares of a single record between which a block is held out from the rest.
const BLOCKS: [(f64, f64); 2] = [(0.0, 0.35), (0.35, 0.65)];

/// The folds of a data set: at most `most` of several records, five of a single one; none for too few data.
pub fn folds(data: &Dataset, most: usize) -> Vec<Fold> {
    cuts(data, most).iter().map(|cut| cut.fold(data)).collect()
}

/// Folds of a single record by its cycles, dealt to `count` folds in turn: data to predict that lie between the training
/// data. A cycle begins where the first input rises through its first value. Several records are divided as by
/// [`folds`].
pub fn folds_of_cycles(data: &Dataset, count: usize) -> Vec<Fold> {
    let [record] = data.records() else { return folds(data, count) };
    let x = &record.inputs()[0];
    let mut cycle = 0;
    let fold_of_row: Vec<usize> = (0..record.len())
        .map(|row| {
            cycle += usize::from(row > 0 && x[row - 1] < x[0] && x[row] >= x[0]);
            cycle % count
        })
        .collect();
    let fold = |fold: usize| Fold {
        name: format!("cycles {}, {}, ...", fold + 1, fold + 1 + count),
        train: data.of_record(record.clone().scored_where(|row| fold_of_row[row] != fold)),
        held_out: data.of_record(record.clone().scored_where(|row| fold_of_row[row] == fold)),
    };
    (0..count).map(fold).filter(has_enough).collect()
}

/// Blocks that the rows of a record are cut into, and folds that they are dealt to, for data of one loop.
const BLOCKS_OF_LOOP: usize = 24;
const FOLDS_OF_LOOP: usize = 4;

/// Folds of data of one loop: short blocks of rows, dealt to the folds in turn, because only rows between others tell.
pub(crate) fn folds_of_loop(data: &Dataset) -> Vec<Fold> {
    let of_fold = |fold: usize, is_held: bool| {
        let part = |record: &Record| {
            let (mut seen, scored) = (0, record.scored().max(1));
            let is_in = record.output().iter().map(|y| {
                let block = seen * BLOCKS_OF_LOOP / scored;
                seen += usize::from(!y.is_nan());
                (block % FOLDS_OF_LOOP == fold) == is_held
            });
            let is_in: Vec<bool> = is_in.collect();
            record.clone().scored_where(|row| is_in[row])
        };
        data.of_records(data.records().iter().map(part).collect())
    };
    let fold = |fold: usize| Fold {
        name: format!("parts {}, {}, ... of {BLOCKS_OF_LOOP}", fold + 1, fold + 1 + FOLDS_OF_LOOP),
        train: of_fold(fold, false),
        held_out: of_fold(fold, true),
    };
    if data.scored() < 4 * FEWEST_ROWS {
        return Vec::new();
    }
    (0..FOLDS_OF_LOOP).map(fold).filter(has_enough).collect()
}

/// Shares of two records between which blocks are held out, beside each record as a whole. Of records of one or two
/// periods they are different parts of a period.
const BLOCKS_OF_TWO: [(f64, f64); 2] = [(0.2, 0.5), (0.55, 0.85)];

/// Ranges of the first input that differ by less than this factor are alike: records then differ in their speed only.
const ALIKE: f64 = 1.25;

/// The folds by which candidates are chosen: of a single record, forecasts from most of it and the block from its
/// middle; of two of one amplitude, each record, which tests extrapolation, and blocks of both.
pub(crate) fn folds_to_choose_by(data: &Dataset, most: usize) -> Vec<Fold> {
    let mut cuts = cuts(data, most);
    if let Some(two) = two_of_one_amplitude(data, &cuts) {
        let runs = rows_to_cut(data, &two);
        let blocks = BLOCKS_OF_TWO.iter().map(|&(from, to)| block(data, &runs, from, to));
        cuts.extend(blocks.filter(|cut| has_enough(&cut.fold(data))));
    }
    let is_telling = |cut: &Cut| match cut {
        Cut::Records(_) => true,
        Cut::Forecast { percent: (from, _), .. } => *from >= MOST_OF_A_RECORD,
        Cut::Block { percent: (from, _), .. } => *from > 0.0,
    };
    if cuts.iter().filter(|cut| is_telling(cut)).count() > 1 {
        cuts.retain(is_telling);
    }
    cuts.iter().map(|cut| cut.fold(data)).collect()
}

/// The records, if each of two is held out and their amplitudes are alike.
fn two_of_one_amplitude(data: &Dataset, cuts: &[Cut]) -> Option<[usize; 2]> {
    let [Cut::Records(first), Cut::Records(second)] = cuts else { return None };
    let (&[first], &[second]) = (&first[..], &second[..]) else { return None };
    let [a, b] = [first, second].map(|record| amplitude(&data.records()[record]));
    (a.max(b) < ALIKE * a.min(b)).then_some([first, second])
}

/// Where data are cut into a fold: a fold is a copy of the data, and a thousand of them would be too many to keep.
#[derive(Debug, Clone, PartialEq)]
pub enum Cut {
    /// These records are held out.
    Records(Vec<usize>),
    /// Validates on the rows after some rows of each run of a single protocol, up to an end.
    Forecast {
        /// The rows of each run that are judged.
        judged: Vec<RowsOf>,
        /// Where the judged rows lie; shares of the rows, in percent.
        percent: (f64, f64),
    },
    /// A block of rows of each run of a single protocol is held out from the rest.
    Block {
        /// The rows of the block in each run.
        judged: Vec<RowsOf>,
        /// Where the block lies; shares of the rows, in percent.
        percent: (f64, f64),
    },
}

/// Rows of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowsOf {
    /// The record.
    pub record: usize,
    /// The first row.
    pub begin: usize,
    /// The row after the last one.
    pub end: usize,
}

impl Cut {
    fn fold(&self, data: &Dataset) -> Fold {
        match self {
            Self::Records(held) => {
                let (held_out, train) = data.partition(|index| held.binary_search(&index).is_ok());
                let names: Vec<&str> = held_out.records().iter().map(Record::name).collect();
                Fold { name: names.join(", "), train, held_out }
            }
            Self::Forecast { judged, percent: (from, to) } => {
                let cut = |part: &dyn Fn(&Record, RowsOf) -> Record| of_runs(data, judged, part);
                Fold {
                    name: format!("{from} to {to} %, from what came before"),
                    train: cut(&|record, rows| record.rows_up_to(rows.begin)),
                    held_out: cut(&held_out),
                }
            }
            Self::Block { judged, percent: (from, to) } => {
                let cut = |part: &dyn Fn(&Record, RowsOf) -> Record| of_runs(data, judged, part);
                Fold {
                    name: format!("{from} to {to} %, from the rest"),
                    train: cut(&|record, rows| {
                        record.clone().scored_where(|row| row < rows.begin || row >= rows.end)
                    }),
                    held_out: cut(&held_out),
                }
            }
        }
    }
}

fn of_runs(data: &Dataset, judged: &[RowsOf], part: &dyn Fn(&Record, RowsOf) -> Record) -> Dataset {
    data.of_records(judged.iter().map(|&rows| part(&data.records()[rows.record], rows)).collect())
}

/// A record up to the last judged row, without the outputs before the first.
fn held_out(record: &Record, rows: RowsOf) -> Record {
    record.rows_up_to(rows.end).scored_where(|row| row >= rows.begin)
}

/// The cuts whose folds have enough to fit to and to judge on: by protocols if several can be held out, else by time.
fn cuts(data: &Dataset, most: usize) -> Vec<Cut> {
    let enough =
        |cuts: Vec<Cut>| -> Vec<Cut> { cuts.into_iter().filter(|cut| has_enough(&cut.fold(data))).collect() };
    let is_scored = |protocol: &RepeatedProtocol| data.records()[protocol.runs[0]].scored() > 0;
    let protocols: Vec<RepeatedProtocol> = protocols(data.records()).into_iter().filter(is_scored).collect();
    let several = if protocols.len() > 1 { enough(of_protocols(&protocols, most)) } else { Vec::new() };
    if several.len() > 1 {
        return several;
    }
    enough(in_time(data, &protocols.into_iter().flat_map(|protocol| protocol.runs).collect::<Vec<usize>>()))
}

fn has_enough(fold: &Fold) -> bool {
    fold.train.check_identifiable(FEWEST_ROWS).is_ok() && fold.held_out.scored() > 0
}

fn of_protocols(protocols: &[RepeatedProtocol], most: usize) -> Vec<Cut> {
    deal(protocols, most).into_iter().map(Cut::Records).collect()
}

/// The records of each of at most `most` folds: protocols are dealt out in their order; copies and repeats stay together.
fn deal(protocols: &[RepeatedProtocol], most: usize) -> Vec<Vec<usize>> {
    let count = protocols.len().min(most);
    let fold = |fold: usize| {
        let records =
            protocols.iter().skip(fold).step_by(count).flat_map(|protocol| protocol.records.clone());
        let mut held: Vec<usize> = records.collect();
        held.sort_unstable();
        held
    };
    (0..count).map(fold).collect()
}

/// Some records are all cut in time at the same shares of their rows. The others are in no fold.
fn in_time(data: &Dataset, runs: &[usize]) -> Vec<Cut> {
    let runs = rows_to_cut(data, runs);
    if runs.iter().map(|(_, scored)| scored.len()).sum::<usize>() < 4 * FEWEST_ROWS {
        return Vec::new();
    }
    let forecast = |&(fitted, share): &(f64, f64)| Cut::Forecast {
        judged: judged(data, &runs, fitted, fitted + share),
        percent: percent(fitted, fitted + share),
    };
    let blocks = BLOCKS.iter().map(|&(from, to)| block(data, &runs, from, to));
    FORECASTS.iter().map(forecast).chain(blocks).collect()
}

/// Records that are cut in time, with their rows that have an output.
fn rows_to_cut(data: &Dataset, runs: &[usize]) -> Vec<(usize, Vec<usize>)> {
    let scored = |&run: &usize| -> (usize, Vec<usize>) {
        let output = data.records()[run].output();
        (run, (0..output.len()).filter(|&row| !output[row].is_nan()).collect())
    };
    runs.iter().map(scored).filter(|(_, scored)| scored.len() >= FEWEST_TO_CUT).collect()
}

fn block(data: &Dataset, runs: &[(usize, Vec<usize>)], from: f64, to: f64) -> Cut {
    Cut::Block { judged: judged(data, runs, from, to), percent: percent(from, to) }
}

fn percent(from: f64, to: f64) -> (f64, f64) {
    ((100.0 * from).round(), (100.0 * to).round())
}

/// The rows of each run between two shares of those with an output.
fn judged(data: &Dataset, runs: &[(usize, Vec<usize>)], from: f64, to: f64) -> Vec<RowsOf> {
    let of_run = |(record, scored): &(usize, Vec<usize>)| {
        let row = |share: f64| {
            let place = (share * scored.len() as f64).round() as usize;
            scored.get(place).copied().unwrap_or(data.records()[*record].len())
        };
        RowsOf { record: *record, begin: row(from), end: row(to) }
    };
    runs.iter().map(of_run).collect()
}

/// Errors on a fold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoldErrors {
    /// Name of the held-out data.
    pub held_out: String,
    /// Errors on the training data.
    pub train: Errors,
    /// Errors on the held-out data.
    pub unseen: Errors,
}

/// Result of a cross-validation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossValidation {
    /// Errors on each fold, without those that were not reached before the observer stopped.
    pub folds: Vec<FoldErrors>,
    /// Errors over all held-out rows; a row of several folds counts once, with the mean of its squared errors.
    pub unseen: Errors,
}

/// A cross-validation in progress, for callers that fit the folds themselves.
#[derive(Debug, Clone)]
pub struct CrossValidator<'d> {
    data: &'d Dataset,
    cuts: Vec<Cut>,
    output: String,
    judged: Vec<FoldErrors>,
    pooled: PooledErrors,
    beginning: KnownBeginning,
}

impl<'d> CrossValidator<'d> {
    /// Divides the data into folds, as [`folds`] does.
    ///
    /// # Errors
    /// Too few data for two folds.
    pub fn new(data: &'d Dataset, most_folds: usize) -> Result<Self> {
        let cuts = cuts(data, most_folds);
        if cuts.len() < 2 {
            return Err(Error::TooFewForFolds { rows: 4 * FEWEST_ROWS });
        }
        let output = data.names().output.clone();
        let (pooled, beginning) = (PooledErrors::default(), KnownBeginning::default());
        Ok(Self { data, cuts, output, judged: Vec::new(), pooled, beginning })
    }

    /// The same with a known beginning of each record that is held out as a whole.
    pub fn with_known_beginning(self, beginning: KnownBeginning) -> Self {
        Self { beginning, ..self }
    }

    /// Number of folds.
    pub fn folds(&self) -> usize {
        self.cuts.len()
    }

    /// Where the data are cut, a cut for each fold.
    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// A fold, counted from 0, which is a copy of the data.
    ///
    /// # Panics
    /// If there are not so many folds.
    pub fn fold(&self, place: usize) -> Fold {
        self.cuts[place].fold(self.data).with_known_beginning(self.beginning, self.data)
    }

    /// Evaluates a model, which was fitted to the training data of a fold, on its held-out data.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    pub fn judge(&mut self, fold: &Fold, model: &Model) -> Result<FoldErrors> {
        let unseen = model.evaluate(&fold.held_out)?;
        self.pooled.add(&fold.held_out, &fold.predicted_by(model)?);
        let train = model.provenance().train.clone();
        let errors = FoldErrors { held_out: fold.name.clone(), train, unseen };
        self.judged.push(errors.clone());
        Ok(errors)
    }

    /// The result over the evaluated folds; `None` if there are none.
    pub fn result(self) -> Option<CrossValidation> {
        let unseen = self.pooled.errors(&self.output)?;
        Some(CrossValidation { folds: self.judged, unseen })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use hysid_core::elementary::sin;

    use super::*;
    use crate::data::record::ColumnNames;
    use crate::fit::{cross_validate, identify};
    use crate::options::FitSpec;
    use crate::options::classical::{ClassicalModel, ClassicalOptions};

    /// A play of threshold 0.3 under growing oscillations.
    fn record(name: &str, rows: usize, size: f64) -> Record {
        let x: Vec<f64> = (0..rows).map(|k| size * sin(0.3 * k as f64) * (0.5 + k as f64 / 100.0)).collect();
        let mut play = 0.0f64;
        let y = x.iter().map(|x| {
            play = play.clamp(x - 0.3, x + 0.3);
            0.5 * x + play
        });
        let y = y.collect();
        Record::new(name, vec![x], y).unwrap()
    }

    fn data(records: Vec<Record>) -> Dataset {
        Dataset::new(ColumnNames { time: None, ..ColumnNames::plain(1) }, records).unwrap()
    }

    fn request() -> FitSpec {
        let options = ClassicalOptions {
            operators: Some(6),
            ..ClassicalOptions::of(ClassicalModel::PrandtlIshlinskii)
        };
        FitSpec::Classical(options)
    }

    #[test]
    fn every_record_is_held_out_once() {
        let all = data((0..5).map(|k| record(&format!("r{k}"), 60, 1.0 + 0.1 * f64::from(k))).collect());
        let folds = folds(&all, 2);
        let names: Vec<&str> = folds.iter().map(|fold| fold.name.as_str()).collect();
        assert_eq!(names, ["r0, r2, r4", "r1, r3"]);
        for fold in &folds {
            assert_eq!(fold.train.records().len() + fold.held_out.records().len(), 5);
        }
    }

    #[test]
    fn a_record_larger_or_faster_than_all_others_lies_beyond_them() {
        let timed = |name: &str, size: f64, step: f64| {
            let record = record(name, 60, size);
            let time = (0..60).map(|row| step * f64::from(row)).collect();
            record.with_time(time).unwrap()
        };
        let beyond = |records: Vec<Record>| -> Vec<bool> {
            let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
            let all = Dataset::new(names, records).unwrap();
            folds(&all, 5).iter().map(Fold::is_beyond).collect()
        };
        let sizes = [2.0, 1.0, 3.0].map(|size| timed(&format!("{size}"), size, 1.0));
        assert_eq!(beyond(sizes.into()), [false, true, true]);
        // Equal outputs would be copies.
        let speeds = [(1.0, 0.1), (1.01, 0.3), (0.99, 0.2), (1.02, 0.15)]
            .map(|(size, step)| timed(&format!("{step}"), size, step));
        assert_eq!(beyond(speeds.into()), [true, true, false, false]);
        assert_eq!(beyond(vec![timed("one", 1.0, 1.0)]), [false; 5]);
    }

    #[test]
    fn two_records_of_one_amplitude_are_also_cut_into_blocks() {
        let names = |sizes: [f64; 2]| -> Vec<String> {
            let two = data(vec![record("a", 200, sizes[0]), record("b", 160, sizes[1])]);
            folds_to_choose_by(&two, 5).into_iter().map(|fold| fold.name).collect()
        };
        assert_eq!(names([1.0, 1.4]), ["a", "b", "20 to 50 %, from the rest", "55 to 85 %, from the rest"]);
        assert_eq!(names([1.0, 3.0]), ["a", "b"]);
    }

    /// The known beginning of a record has all its outputs, however few are scored behind it.
    #[test]
    fn whole_records_that_are_held_out_have_a_known_beginning() {
        let all = data(vec![record("a", 200, 1.0), record("b", 150, 1.3), record("c", 100, 0.8)]);
        let few = all.thinned(90);
        let beginning = KnownBeginning::Rows(40);
        for (fold, record) in folds(&few, 3).into_iter().zip(all.records()) {
            let begun = fold.clone().with_known_beginning(beginning, &all);
            let [held] = begun.held_out.records() else { panic!("one record is held out") };
            assert_eq!((held.name(), held.known()), (record.name(), &record.output()[..40]));
            assert!(held.output()[..40].iter().all(|y| y.is_nan()) && held.scored() > 0);
            assert_eq!(begun.train.scored(), fold.train.scored());
            let trained = begun.trained_of(&all).unwrap();
            assert_eq!(trained.scored(), all.scored() - record.scored());
        }
        let one = data(vec![record("r", 200, 1.0)]);
        let cut = folds(&one, 5).swap_remove(0);
        assert!(cut.trained_of(&one).is_none());
        let scored = cut.held_out.scored();
        let begun = cut.with_known_beginning(beginning, &one).held_out;
        assert!(begun.records()[0].known().is_empty() && begun.scored() == scored);
    }

    #[test]
    fn every_cycle_is_held_out_once() {
        let all = data(vec![record("r", 400, 1.0)]);
        let folds = folds_of_cycles(&all, 5);
        assert_eq!(folds.len(), 5);
        let scored =
            |set: &Dataset| set.records()[0].output().iter().map(|y| !y.is_nan()).collect::<Vec<_>>();
        let mut held = vec![0; all.rows()];
        for fold in &folds {
            let (trained, held_out) = (scored(&fold.train), scored(&fold.held_out));
            assert!(trained.iter().zip(&held_out).all(|(trained, held)| trained != held));
            // 400 rows of 21 each are 19 cycles.
            let beginnings = held_out.windows(2).filter(|pair| !pair[0] && pair[1]).count();
            assert!((3..=4).contains(&beginnings), "{}: {beginnings}", fold.name);
            held.iter_mut().zip(held_out).for_each(|(count, is_held)| *count += usize::from(is_held));
        }
        assert!(held.iter().all(|&count| count == 1));
    }

    #[test]
    fn copies_are_held_out_together() {
        let (a, b) = (record("a", 200, 1.0), record("b", 200, 1.3));
        let copy = Record::new("copy", a.inputs().iter().map(|x| x.to_vec()).collect(), a.output().to_vec())
            .unwrap();
        let part =
            Record::new("part", vec![a.inputs()[0][50..150].to_vec()], a.output()[50..150].to_vec()).unwrap();
        let several = folds(&data(vec![a.clone(), part.clone(), b, copy.clone()]), 5);
        let names: Vec<&str> = several.iter().map(|fold| fold.name.as_str()).collect();
        assert_eq!(names, ["a, part, copy", "b"]);
        // One measurement, however often it is given, is cut in time.
        let one = folds(&data(vec![part, copy]), 5);
        assert_eq!(one.len(), 5);
        let is_of_copy = |set: &Dataset| set.records().len() == 1 && set.records()[0].name() == "copy";
        assert!(one.iter().all(|fold| is_of_copy(&fold.train) && is_of_copy(&fold.held_out)));
        let (kept, held) = data(vec![a.clone(), a.clone()]).split_for_validation(0.3).unwrap();
        assert_eq!((kept.scored(), held.scored()), (140, 60));
    }

    /// Two runs of one test, with other noise, are cut in time together: neither shows what is held out of the other.
    #[test]
    fn repeats_are_held_out_together() {
        let run = |name: &str, size: f64, seed: usize| {
            let record = record(name, 200, size);
            let noise = |k: usize| 0.01 * (1e4 * sin((seed + k) as f64)).fract();
            let output = record.output().iter().enumerate().map(|(k, y)| y + noise(k)).collect();
            record.with_output(output).unwrap()
        };
        let several = folds(&data(vec![run("a", 1.0, 1), run("b", 1.5, 2), run("again", 1.0, 3)]), 5);
        let names: Vec<&str> = several.iter().map(|fold| fold.name.as_str()).collect();
        assert_eq!(names, ["a, again", "b"]);
        for fold in folds(&data(vec![run("a", 1.0, 1), run("again", 1.0, 3)]), 5) {
            let rows = |set: &Dataset, run: usize| -> Vec<usize> {
                let output = set.records()[run].output();
                (0..output.len()).filter(|&row| !output[row].is_nan()).collect()
            };
            assert_eq!(fold.held_out.records().len(), 2, "{}", fold.name);
            assert_eq!(rows(&fold.held_out, 0), rows(&fold.held_out, 1));
            assert!(rows(&fold.held_out, 0).iter().all(|row| !rows(&fold.train, 1).contains(row)));
        }
        let rows = RowFolds::of(&data(vec![run("a", 1.0, 1), run("again", 1.0, 3)]));
        assert_eq!(rows.of_rows[0], rows.of_rows[1]);
    }

    /// Held-out rows of a single record are not among the training rows, and the way there is driven.
    #[test]
    fn a_single_record_is_cut_in_time() {
        let one = record("r", 200, 1.0);
        let folds = folds(&data(vec![one.clone()]), 2);
        assert_eq!(folds.len(), 5);
        for fold in &folds {
            let (train, held_out) = (&fold.train.records()[0], &fold.held_out.records()[0]);
            let mut judged = 0;
            for (row, y) in held_out.output().iter().enumerate() {
                assert_eq!(held_out.inputs()[0][row], one.inputs()[0][row]);
                if !y.is_nan() {
                    judged += 1;
                    assert_eq!(*y, one.output()[row]);
                    assert!(train.output().get(row).is_none_or(|y| y.is_nan()), "{}: row {row}", fold.name);
                }
            }
            assert!(judged >= 40, "{}: {judged}", fold.name);
        }
    }

    #[test]
    fn the_errors_of_all_folds_are_put_together() {
        let all = data(vec![record("a", 80, 1.0), record("b", 120, 1.3)]);
        let found = cross_validate(&all, &request(), 5, &mut |_| ControlFlow::Continue(())).unwrap();
        let [a, b] = found.folds.as_slice() else { panic!("two folds") };
        assert_eq!((a.held_out.as_str(), a.unseen.samples, a.train.samples), ("a", 80, 120));
        let mse = (80.0 * a.unseen.mse + 120.0 * b.unseen.mse) / 200.0;
        approx::assert_relative_eq!(found.unseen.mse, mse, max_relative = 1e-12);
        // It is a Prandtl-Ishlinskii law, and is found as one.
        assert!(found.unseen.nrmse_std_percent.unwrap() < 5.0, "{:?}", found.unseen);

        let by_hand =
            identify(&data(vec![record("b", 120, 1.3)]), &request(), &mut |_| ControlFlow::Continue(()));
        assert_eq!(by_hand.unwrap().model.evaluate(&data(vec![record("a", 80, 1.0)])).unwrap(), a.unseen);
        assert!(CrossValidator::new(&data(vec![record("r", 30, 1.0)]), 5).is_err());
    }
}
