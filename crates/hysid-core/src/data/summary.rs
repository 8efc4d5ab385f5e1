//! Summary of a data set, before a fit.

use crate::data::record::{Dataset, Record, RecordCopy, copies};
use crate::data::turning_points::turning_points;
use crate::data::warning::Warning;
use crate::elementary::square;

/// Reversals below this share of the range of the input count as noise.
const SMALLEST_REVERSAL: f64 = 0.02;

/// Below this number of turning points of all records together there is a warning.
const FEW_TURNING_POINTS: usize = 2;

/// Ratio of the longest to the shortest time step of a record above which there is a warning.
const WILD_STEPS: f64 = 100.0;

/// Counts and ranges of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Rows.
    pub rows: usize,
    /// Rows with an output.
    pub scored: usize,
    /// A summary of each record.
    pub records: Vec<RecordSummary>,
    /// Smallest and largest value of each input, in its unit.
    pub inputs: Vec<(f64, f64)>,
    /// Smallest and largest output, in its unit.
    pub output: (f64, f64),
}

/// Summary of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordSummary {
    /// Its name.
    pub name: String,
    /// Rows.
    pub rows: usize,
    /// Rows with an output.
    pub scored: usize,
    /// Number of turning points of the first input, without reversals below 2 % of its range.
    pub turning_points: usize,
    /// Shortest, median and longest time step, in the unit of time.
    pub time_steps: Option<(f64, f64, f64)>,
}

impl Summary {
    /// The summary of a data set.
    pub fn of(data: &Dataset) -> Self {
        let inputs: Vec<(f64, f64)> = (0..data.names().inputs.len()).map(|i| data.input_range(i)).collect();
        let smallest = SMALLEST_REVERSAL * (inputs[0].1 - inputs[0].0);
        let of_record = |record: &Record| RecordSummary {
            name: record.name().into(),
            rows: record.len(),
            scored: record.scored(),
            turning_points: turning_points(&record.inputs()[0], smallest).len(),
            time_steps: time_steps(record),
        };
        Self {
            rows: data.rows(),
            scored: data.scored(),
            records: data.records().iter().map(of_record).collect(),
            inputs,
            output: data.output_range(),
        }
    }

    /// Turning points of all records together.
    pub fn turning_points(&self) -> usize {
        self.records.iter().map(|record| record.turning_points).sum()
    }

    /// Warnings before a fit to these data.
    pub fn warnings(&self, data: &Dataset) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.turning_points() < FEW_TURNING_POINTS {
            for record in &self.records {
                let found = record.turning_points;
                warnings.push(Warning::FewTurningPoints { record: record.name.clone(), found });
            }
        }
        let records = data.records();
        let copies = copies(records).into_iter().map(|RecordCopy { copy, of, likeness }| {
            let [copy, of] = [copy, of].map(|place| records[place].name().to_string());
            Warning::SameMeasurement { copy, of, likeness }
        });
        warnings.extend(copies);
        for (summary, record) in self.records.iter().zip(records) {
            let name = || summary.name.clone();
            if is_without_order(&record.inputs()[0]) {
                warnings.push(Warning::RowsOutOfOrder { record: name() });
            }
            if let Some((shortest, _, longest)) = summary.time_steps
                && longest > WILD_STEPS * shortest
            {
                warnings.push(Warning::UnevenTimeSteps { record: name(), shortest, longest });
            }
            let mut outputs = record.output().iter().copied().filter(|y| !y.is_nan());
            if let Some(first) = outputs.next()
                && summary.scored > 1
                && outputs.all(|y| y == first)
            {
                warnings.push(Warning::ConstantOutput { record: name(), value: first });
            }
        }
        warnings
    }
}

/// True for values that jump at random: neighbours are uncorrelated, and two of three rows turn.
fn is_without_order(values: &[f64]) -> bool {
    const FEWEST: usize = 50;
    let rows = values.len() as f64;
    let mean = values.iter().sum::<f64>() / rows;
    let variance: f64 = values.iter().map(|value| square(value - mean)).sum();
    if values.len() < FEWEST || variance == 0.0 {
        return false;
    }
    let neighbours: f64 = values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    let turns = values.windows(3).filter(|three| (three[1] - three[0]) * (three[2] - three[1]) < 0.0).count();
    // Five standard deviations of what chance gives: 1 / sqrt(n), and sqrt(8 n / 45) about 2 n / 3.
    let is_uncorrelated = (neighbours / variance).abs() < 5.0 / rows.sqrt();
    is_uncorrelated && (turns as f64 - 2.0 * rows / 3.0).abs() < 5.0 * (8.0 * rows / 45.0).sqrt()
}

fn time_steps(record: &Record) -> Option<(f64, f64, f64)> {
    let mut steps: Vec<f64> = record.time()?.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let shortest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = steps.iter().copied().fold(0.0, f64::max);
    Some((shortest, median, longest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::ColumnNames;
    use crate::elementary::sin;

    fn data(time: Vec<f64>, x: Vec<f64>, y: Vec<f64>) -> Dataset {
        let record = Record::new("r", vec![x], y).unwrap().with_time(time).unwrap();
        Dataset::new(ColumnNames::plain(1), vec![record]).unwrap()
    }

    #[test]
    fn a_poor_record_is_warned_of() {
        let data = data(vec![0.0, 0.001, 5.0, 5.1], vec![0.0, 1.0, 2.0, 3.0], vec![1.0; 4]);
        let summary = Summary::of(&data);
        assert_eq!(summary.records[0].time_steps.unwrap().2, 4.999);
        let warnings = summary.warnings(&data);
        assert_eq!(warnings.len(), 3, "{warnings:?}");
    }

    #[test]
    fn rows_that_are_shuffled_are_noticed() {
        let n = 300;
        let at = |k: usize| sin(k as f64 * 0.1);
        let time = || (0..n).map(|k| k as f64).collect::<Vec<_>>();
        let warned = |x: Vec<f64>| {
            let data = data(time(), x.clone(), x);
            let warnings = Summary::of(&data).warnings(&data);
            warnings.iter().any(|warning| matches!(warning, Warning::RowsOutOfOrder { .. }))
        };
        let mut places: Vec<usize> = (0..n).collect();
        places.sort_by_key(|&k| crate::random::mix(k as u64));
        assert!(warned(places.iter().map(|&k| at(k)).collect()));
        assert!(!warned((0..n).map(at).collect()));
        // Few rows a period are no shuffle.
        assert!(!warned((0..n).map(|k| at(21 * k)).collect()));
    }
}
