//! Does the model still hold: what error, band and residual say of a specimen that has changed since the fit.

use anyhow::Result;
use hysid::Model;
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::residuals::{ResidualOptions, Residuals};
use hysid::operator::{Operator, Play};

use super::{auto, percent_in_band, validation_error};
use crate::cases::{aligned, row};
use crate::rig::{Rig, drives, error_of};
use crate::statistics::{geometric_mean, median, shown};

/// Specimens that do not deteriorate by themselves.
const SPECIMENS: [&str; 5] = [
    "brace-irregular",
    "structural-steel-growing",
    "thin-sheet-loops",
    "stack-reversals",
    "sma-actuator-reversals",
];
const SEEDS: u64 = 2;
const ROWS: usize = 1050;

/// A change of the specimen since the fit.
#[derive(Debug, Clone, Copy)]
enum Change {
    None,
    /// The output is smaller by this share.
    Gain(f64),
    /// The input has a clearance of this share of the range.
    Clearance(f64),
    /// The output is offset by this share of its range.
    Offset(f64),
}

const CHANGES: [Change; 10] = [
    Change::None,
    Change::Gain(0.01),
    Change::Gain(0.03),
    Change::Gain(0.1),
    Change::Clearance(0.01),
    Change::Clearance(0.03),
    Change::Clearance(0.1),
    Change::Offset(0.01),
    Change::Offset(0.03),
    Change::Offset(0.1),
];

/// What a check found.
struct Check {
    error: f64,
    /// The error over that of the held-out data of the fit.
    ratio: f64,
    /// Rows in the band, in percent.
    in_band: f64,
    has_structure: bool,
}

/// A row for each change.
pub fn table() -> Result<String> {
    let mut checks: Vec<Vec<Check>> = CHANGES.iter().map(|_| Vec::new()).collect();
    for name in SPECIMENS {
        for seed in 1..=SEEDS {
            let rig = Rig::new(name, seed, ROWS)?;
            let model = auto(&rig.training(ROWS, seed)?, seed)?;
            let later = drives::random(&rig.path, ROWS, 1000 * seed + 700);
            for (checks, change) in checks.iter_mut().zip(CHANGES) {
                checks.push(check(&model, &change.measured(&rig, &later, seed + 50)?)?);
            }
        }
    }
    let columns = ["error, %", "error / validation error", "rows in the 90 % band, %", "structure found in"];
    let mut rows = vec![row("since the fit", &columns)];
    for (checks, change) in checks.iter().zip(CHANGES) {
        let of = |of: fn(&Check) -> f64| -> Vec<f64> { checks.iter().map(of).collect() };
        let found = checks.iter().filter(|check| check.has_structure).count();
        let cells = [
            shown(geometric_mean(&of(|check| check.error))),
            shown(geometric_mean(&of(|check| check.ratio))),
            format!("{:.0}", median(&of(|check| check.in_band))),
            format!("{found} of {}", checks.len()),
        ];
        rows.push(row(&change.words(), &cells));
    }
    Ok(aligned(&rows))
}

fn check(model: &Model, data: &Dataset) -> Result<Check> {
    let error = error_of(model, data)?;
    let residuals = Residuals::of_model(model, data, &ResidualOptions::default())?;
    Ok(Check {
        error,
        ratio: error / validation_error(model)?,
        in_band: percent_in_band(model, data)?,
        has_structure: residuals.found().next().is_some(),
    })
}

impl Change {
    fn words(self) -> String {
        match self {
            Self::None => "nothing".into(),
            Self::Gain(share) => format!("output smaller by {:.0} %", 100.0 * share),
            Self::Clearance(share) => format!("clearance of {:.0} % of the input range", 100.0 * share),
            Self::Offset(share) => format!("output offset by {:.0} % of its range", 100.0 * share),
        }
    }

    /// What is measured of the changed specimen along a drive.
    fn measured(self, rig: &Rig, drive: &[f64], noise: u64) -> Result<Dataset> {
        let record = match self {
            Self::Clearance(share) => {
                let (low, high) = rig.path.limits.range;
                let passed_on = Play::new(0.5 * share * (high - low))?.run(drive);
                let behind = rig.measured("later", &passed_on, noise)?;
                Record::new("later", vec![drive.to_vec()], behind.output().to_vec())?
            }
            Self::None => rig.measured("later", drive, noise)?,
            Self::Gain(share) => with_output(rig.measured("later", drive, noise)?, |y, _| (1.0 - share) * y)?,
            Self::Offset(share) => {
                with_output(rig.measured("later", drive, noise)?, |y, range| y + share * range)?
            }
        };
        rig.data([record])
    }
}

/// The record with another output, from the output and its range.
fn with_output(record: Record, of: impl Fn(f64, f64) -> f64) -> Result<Record> {
    let largest = record.output().iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = record.output().iter().copied().fold(f64::INFINITY, f64::min);
    let output = record.output().iter().map(|y| of(*y, largest - smallest)).collect();
    Ok(record.with_output(output)?)
}
