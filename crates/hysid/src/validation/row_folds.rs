//! Folds of rows whose sums are kept apart: what is trained on is the sum of all less the one held out, so each row is in
//! one fold. Protocols are dealt out as for the folds of data.

use crate::data::record::{Dataset, Record, RepeatedProtocol, protocols};
use crate::validation::deal;

/// Blocks that the rows are cut into where there are few protocols.
const BLOCKS: usize = 5;

/// Protocols from which on each is a fold by itself.
const PROTOCOLS_AS_FOLDS: usize = 3;

/// Most folds of protocols.
const MOST: usize = 10;

/// Share of the range of the other records by which one may exceed it and still lie within.
const SLACK: f64 = 0.03;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RowFolds {
    /// Fold of every row of every record that has an output, the rows of its lead-in first.
    pub of_rows: Vec<Vec<usize>>,
    /// Number of folds.
    pub count: usize,
    /// Folds that are held out in turn, in rising order.
    pub judged: Vec<usize>,
}

impl RowFolds {
    /// From three protocols on, each is a fold, and those are held out whose input stays within the range of the
    /// others, so that what is judged lies between what is trained on; else blocks of rows that have an output are
    /// held out in turn.
    pub fn of(data: &Dataset) -> Self {
        let used: Vec<usize> =
            (0..data.records().len()).filter(|&index| data.records()[index].scored() > 0).collect();
        let is_scored = |protocol: &RepeatedProtocol| data.records()[protocol.runs[0]].scored() > 0;
        let protocols: Vec<RepeatedProtocol> =
            protocols(data.records()).into_iter().filter(is_scored).collect();
        if protocols.len() < PROTOCOLS_AS_FOLDS {
            let are_single = protocols.iter().all(|protocol| protocol.records.len() == 1);
            return Self::blocks(data, &used, are_single);
        }
        let measurements = deal(&protocols, MOST);
        let count = measurements.len();
        let fold_of = |record: &usize| {
            let has_it = |held: &Vec<usize>| held.contains(record);
            measurements.iter().position(has_it).expect("every record with an output is dealt out")
        };
        let folds: Vec<usize> = used.iter().map(fold_of).collect();
        let range = |chosen: &dyn Fn(usize) -> bool| {
            let records = used.iter().zip(&folds).filter(|(_, fold)| chosen(**fold));
            let inputs = records.flat_map(|(&record, _)| &data.records()[record].inputs()[0]);
            inputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
        };
        let is_within = |fold: &usize| {
            let (inside, outside) = (range(&|other| other == *fold), range(&|other| other != *fold));
            let slack = SLACK * (outside.1 - outside.0);
            inside.0 >= outside.0 - slack && inside.1 <= outside.1 + slack
        };
        let mut judged: Vec<usize> = (0..count).filter(is_within).collect();
        if judged.is_empty() {
            judged = (0..count).collect();
        }
        let rows = |record: &usize| driven(&data.records()[*record]);
        let of_rows = used.iter().zip(&folds).map(|(record, &fold)| vec![fold; rows(record)]).collect();
        Self { of_rows, count, judged }
    }

    fn blocks(data: &Dataset, used: &[usize], of_all: bool) -> Self {
        let mut seen = 0;
        let of_rows = used.iter().map(|&record| {
            let record = &data.records()[record];
            let scored = if of_all { data.scored() } else { record.scored() };
            seen = if of_all { seen } else { 0 };
            let mut fold_of = |y: &f64| {
                let fold = (seen * BLOCKS / scored.max(1)).min(BLOCKS - 1);
                seen += usize::from(!y.is_nan());
                fold
            };
            let lead_in = vec![f64::NAN; record.lead_in_rows().len()];
            lead_in.iter().chain(record.output()).map(&mut fold_of).collect()
        });
        let of_rows = of_rows.collect();
        Self { of_rows, count: BLOCKS, judged: (0..BLOCKS).collect() }
    }

    /// All rows in one fold, for sums that nothing is held out of.
    pub fn none(data: &Dataset) -> Self {
        let used = data.records().iter().filter(|record| record.scored() > 0);
        Self { of_rows: used.map(|record| vec![0; driven(record)]).collect(), ..Self::one() }
    }

    /// One fold for rows that are of no record.
    pub fn one() -> Self {
        Self { of_rows: Vec::new(), count: 1, judged: vec![0] }
    }
}

fn driven(record: &Record) -> usize {
    record.lead_in_rows().len() + record.len()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;
    use crate::data::record::ColumnNames;

    fn data(records: Vec<Record>) -> Dataset {
        Dataset::new(ColumnNames::plain(1), records).unwrap()
    }

    /// Oscillations of a size.
    fn record(size: f64) -> Record {
        let x: Vec<f64> = (0..100).map(|k| size * sin(0.3 * f64::from(k))).collect();
        let y = x.iter().map(|x| x * x + size).collect();
        Record::new(format!("{size}"), vec![x], y).unwrap()
    }

    #[test]
    fn folds_hold_out_records_within_the_range_of_the_others() {
        let folds = RowFolds::of(&data(vec![record(3.0), record(1.0), record(2.0)]));
        assert_eq!((folds.count, folds.judged), (3, vec![1, 2]));
    }

    #[test]
    fn a_single_record_is_cut_into_blocks_of_rows_that_have_an_output() {
        let whole = record(1.0);
        let blank = (0..100).map(|k| if k < 50 { f64::NAN } else { whole.output()[k] }).collect();
        let folds = RowFolds::of(&data(vec![whole.clone().with_output(blank).unwrap()]));
        assert_eq!(folds.judged, [0, 1, 2, 3, 4]);
        assert_eq!((folds.of_rows[0][59], folds.of_rows[0][60], folds.of_rows[0][99]), (0, 1, 4));
    }

    /// A copy of what is trained on is not unseen.
    #[test]
    fn copies_are_in_one_fold() {
        let copied = record(2.0);
        let copy = Record::new(
            "copy",
            copied.inputs().iter().map(|x| x.to_vec()).collect(),
            copied.output().to_vec(),
        )
        .unwrap();
        let folds = RowFolds::of(&data(vec![record(3.0), copied, record(1.0), copy]));
        let of_records: Vec<usize> = folds.of_rows.iter().map(|rows| rows[0]).collect();
        assert_eq!((folds.count, of_records), (3, vec![0, 1, 2, 1]));
    }
}
