//! Gaps, noise, offsets, several records: the error on unseen data after a fit to disturbed data, over that of a fit to
//! undisturbed ones.

use anyhow::Result;
use hysid::Fit;
use hysid::data::record::{Dataset, Record};
use hysid::specimens::with_noise;

use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};
use crate::statistics::{geometric_mean, shown};

const SPECIMENS: [&str; 2] = ["brace-irregular", "stack-reversals"];
const SEEDS: u64 = 2;
const ROWS: usize = 750;

/// What happens to the measured data.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Disturbance {
    /// Noise in percent of the standard deviation of the output.
    Noise(f64),
    /// This share of the outputs is blank, in three gaps.
    Gaps(f64),
    /// The rows of the gaps are missing altogether.
    RowsMissing(f64),
    /// The output is offset by this share of its range.
    OutputOffset(f64),
    /// The input is offset by this share of its range.
    InputOffset(f64),
    /// The record begins after this share of the test, in an unknown state.
    Late(f64),
    /// Three untouched specimens along three drives, of the same length together.
    Records,
}

const DISTURBANCES: [Disturbance; 9] = [
    Disturbance::Noise(1.0),
    Disturbance::Noise(3.0),
    Disturbance::Noise(10.0),
    Disturbance::Gaps(0.3),
    Disturbance::RowsMissing(0.3),
    Disturbance::OutputOffset(0.1),
    Disturbance::InputOffset(0.1),
    Disturbance::Late(0.3),
    Disturbance::Records,
];

/// A row for each disturbance, a column for each specimen.
pub fn table() -> Result<String> {
    let heading: Vec<&str> = SPECIMENS.into_iter().chain(["geometric mean"]).collect();
    let mut rows = vec![row("unseen error, %, after a fit to data with", &heading)];
    for disturbance in DISTURBANCES {
        let mut all = Vec::new();
        let mut cells = Vec::new();
        for name in SPECIMENS {
            let errors =
                (1..=SEEDS).map(|seed| error(name, disturbance, seed)).collect::<Result<Vec<_>>>()?;
            cells.push(shown(geometric_mean(&errors)));
            all.extend(errors);
        }
        cells.push(shown(geometric_mean(&all)));
        rows.push(row(&disturbance.words(), &cells));
    }
    Ok(aligned(&rows))
}

/// The default fit, with one start of each candidate, of disturbed data; the error on what such sensors show of the
/// unseen tests, without noise.
fn error(name: &str, disturbance: Disturbance, seed: u64) -> Result<f64> {
    let rig = Rig::new(name, seed, ROWS)?;
    let train = disturbance.training(&rig, seed)?;
    // Nothing is known of the initial state, so nothing is said of it.
    let model = Fit::new().option("starts", 1).seed(seed).run(&train)?;
    let unseen = rig.unseen(seed)?;
    let shown = unseen.records().iter().map(|record| disturbance.of_sensors(record, &rig));
    error_of(&model, &Dataset::new(unseen.names().clone(), shown.collect::<Result<_>>()?)?)
}

impl Disturbance {
    fn words(self) -> String {
        match self {
            Self::Noise(percent) => format!("noise of {percent:.0} % of std"),
            Self::Gaps(share) => format!("1 % noise, {:.0} % of the outputs blank", 100.0 * share),
            Self::RowsMissing(share) => format!("1 % noise, {:.0} % of the rows missing", 100.0 * share),
            Self::OutputOffset(share) => format!("1 % noise, output offset by {:.0} %", 100.0 * share),
            Self::InputOffset(share) => format!("1 % noise, input offset by {:.0} %", 100.0 * share),
            Self::Late(share) => format!("1 % noise, first {:.0} % of the test missing", 100.0 * share),
            Self::Records => "1 % noise, three records".into(),
        }
    }

    fn training(self, rig: &Rig, seed: u64) -> Result<Dataset> {
        let records = match self {
            Self::Records => (0..3)
                .map(|number| {
                    let drive = drives::random(&rig.path, ROWS / 3, 1000 * seed + 500 + number);
                    rig.run(&format!("test {number}"), &drive)
                })
                .collect::<Result<Vec<_>>>()?,
            _ => vec![rig.run("test", &drives::random(&rig.path, ROWS, 1000 * seed + 500))?],
        };
        let noise = if let Self::Noise(percent) = self { percent } else { crate::rig::NOISE };
        let exact = Dataset::new(rig.specimen.names.clone(), records)?;
        let noisy = with_noise(&exact, noise, seed)?;
        let seen = noisy.records().iter().map(|record| self.of_rows(self.of_sensors(record, rig)?));
        Ok(Dataset::new(noisy.names().clone(), seen.collect::<Result<_>>()?)?)
    }

    /// What is left of the rows of a test.
    fn of_rows(self, record: Record) -> Result<Record> {
        let rows = record.len();
        match self {
            Self::Gaps(share) => Ok(record.scored_where(|row| !is_in_gap(row, rows, share))),
            Self::RowsMissing(share) => kept(&record, |row| !is_in_gap(row, rows, share)),
            Self::Late(share) => kept(&record, |row| row as f64 >= share * rows as f64),
            _ => Ok(record),
        }
    }

    /// What offset sensors show.
    fn of_sensors(self, record: &Record, rig: &Rig) -> Result<Record> {
        match self {
            Self::OutputOffset(share) => {
                let (low, high) = rig.data([record.clone()])?.output_range();
                let output = record.output().iter().map(|y| y + share * (high - low)).collect();
                Ok(record.clone().with_output(output)?)
            }
            Self::InputOffset(share) => {
                let (low, high) = rig.path.limits.range;
                let input = record.inputs()[0].iter().map(|x| x + share * (high - low)).collect();
                with_time_of(record, Record::new(record.name(), vec![input], record.output().to_vec())?)
            }
            _ => Ok(record.clone()),
        }
    }
}

/// True in three gaps of this share together.
fn is_in_gap(row: usize, rows: usize, share: f64) -> bool {
    let place = 3.0 * row as f64 / rows as f64;
    place.fract() >= 0.6 && place.fract() < 0.6 + share
}

/// The rows that are kept, as if there were no others.
fn kept(record: &Record, is_kept: impl Fn(usize) -> bool) -> Result<Record> {
    let chosen = |values: &[f64]| -> Vec<f64> {
        values.iter().enumerate().filter(|(row, _)| is_kept(*row)).map(|(_, value)| *value).collect()
    };
    let left = Record::new(record.name(), vec![chosen(&record.inputs()[0])], chosen(record.output()))?;
    match record.time() {
        Some(time) => Ok(left.with_time(chosen(time))?),
        None => Ok(left),
    }
}

fn with_time_of(record: &Record, changed: Record) -> Result<Record> {
    match record.time() {
        Some(time) => Ok(changed.with_time(time.to_vec())?),
        None => Ok(changed),
    }
}
