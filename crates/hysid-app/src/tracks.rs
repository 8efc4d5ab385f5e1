//! Where the points of curves are in their records, so that a page can show one moment or one cycle in all its charts.

use std::collections::HashMap;

use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::cycles::{CycleOptions, CycleTable};
use hysid_document::chart::Track;

/// Most cycles of a record among which a reader can select.
const MOST_CYCLES: usize = 1000;

/// Times of a record's rows, or their numbers where there is no time.
pub fn times(record: &Record) -> Vec<f64> {
    times_or_rows(record.time(), record.len())
}

/// These times, or the numbers of so many rows.
pub fn times_or_rows(time: Option<&[f64]>, rows: usize) -> Vec<f64> {
    time.map_or_else(|| (1..=rows).map(|row| row as f64).collect(), <[f64]>::to_vec)
}

/// Tracks that the curves of the records of a set share.
#[derive(Clone)]
pub struct Tracks {
    set: String,
    /// Times at which the cycles of a record begin, and that at which the last one ends.
    cycles: HashMap<String, Vec<f64>>,
}

impl Tracks {
    pub fn of(set: &str, data: &Dataset) -> Self {
        Self { set: set.into(), cycles: cycles(data) }
    }

    pub fn over_time(&self, record: &str) -> Track {
        Track { record: self.name(record), times: None, cycles: Vec::new() }
    }

    /// Those of a path, of which these rows are drawn; the points between them are gaps.
    pub fn of_path(&self, record: &Record, rows: impl Iterator<Item = Option<usize>>) -> Track {
        let times = times(record);
        let at = rows.map(|row| row.map_or(f64::NAN, |row| times[row])).collect();
        let cycles = self.cycles.get(record.name()).cloned().unwrap_or_default();
        Track { record: self.name(record.name()), times: Some(at), cycles }
    }

    fn name(&self, record: &str) -> String {
        if record.is_empty() { self.set.clone() } else { format!("{}: {record}", self.set) }
    }
}

/// The cycles of each record; none where the input does not turn.
fn cycles(data: &Dataset) -> HashMap<String, Vec<f64>> {
    let Ok(table) = CycleTable::of(data, &CycleOptions::default()) else { return HashMap::new() };
    let mut bounds: HashMap<String, Vec<f64>> = HashMap::new();
    for record in data.records() {
        let times = times(record);
        let own = table.complete().filter(|row| row.record == record.name());
        let mut of_record: Vec<f64> = own.clone().map(|row| times[row.rows.0]).collect();
        of_record.extend(own.last().map(|row| times[row.rows.1]));
        if of_record.len() <= MOST_CYCLES {
            bounds.insert(record.name().into(), of_record);
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use hysid::data::record::ColumnNames;
    use hysid_core::elementary::sin;

    use super::*;

    #[test]
    fn cycles_are_those_of_the_input() {
        let x: Vec<f64> = (0..=500).map(|k| sin(std::f64::consts::TAU * 0.01 * f64::from(k))).collect();
        let record = Record::new("a", vec![x.clone()], x).unwrap();
        let data = Dataset::new(ColumnNames { time: None, ..ColumnNames::plain(1) }, vec![record]).unwrap();
        let tracks = Tracks::of("training", &data);
        let track = tracks.of_path(&data.records()[0], [Some(0), None, Some(7)].into_iter());
        assert_eq!(track.record, "training: a");
        let times = track.times.unwrap();
        assert_eq!((times[0], times[2]), (1.0, 8.0));
        assert!(times[1].is_nan());
        assert_eq!(track.cycles.len(), 6);
        let lengths: Vec<f64> = track.cycles.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(lengths.iter().all(|length| (99.0..=101.0).contains(length)), "{lengths:?}");
    }
}
