//! A specimen of the generated cases in its testing machine: the paths it can be driven along, and what is measured.

pub mod drives;

use anyhow::{Context, Result};
use hysid::Model;
use hysid::data::record::{Dataset, Record};
use hysid::plan::{DrivePath, Limits, Wave};
use hysid::specimens::with_noise;
use hysid_lab::generated::{DrivenSpecimen, driven_specimen};

/// Rows of a swing over the whole range at the largest rate.
pub const ROWS_OF_A_SWING: f64 = 50.0;

/// Noise of a measurement, in percent of the standard deviation of the output.
pub const NOISE: f64 = 1.0;

/// Unseen tests and their rows.
const UNSEEN: u64 = 3;
const ROWS_UNSEEN: usize = 700;

/// A specimen in its machine.
pub struct Rig {
    pub specimen: DrivenSpecimen,
    /// What the machine can do: as fast as half the specimen's highest frequency over the whole range.
    pub path: DrivePath,
}

impl Rig {
    /// The specimen of a plan of cases with the parameters of a seed, for tests of so many rows.
    pub fn new(name: &str, seed: u64, rows: usize) -> Result<Self> {
        Self::sampled(name, seed, rows, ROWS_OF_A_SWING)
    }

    /// The same with so many rows in the fastest swing over the whole range.
    pub fn sampled(name: &str, seed: u64, rows: usize, rows_of_a_swing: f64) -> Result<Self> {
        let specimen = driven_specimen(name, seed)?.with_context(|| format!("there is no plan `{name}`"))?;
        let (low, high) = specimen.range;
        let start = 0.0_f64.clamp(low, high);
        let wave = if specimen.frequencies.is_some() { Wave::Smooth } else { Wave::Triangle };
        let step = specimen.frequencies.map(|(_, highest)| 1.0 / (0.5 * highest * 2.0 * rows_of_a_swing));
        let max_rate = wave.peak() * (high - low) / (rows_of_a_swing * step.unwrap_or(1.0));
        let limits = Limits { range: (low, high), start, step, max_rate, rows };
        Ok(Self { specimen, path: DrivePath { limits, wave } })
    }

    /// An untouched specimen along a drive, without noise.
    pub fn run(&self, name: &str, drive: &[f64]) -> Result<Record> {
        Ok(self.specimen.run(name, drive, self.path.limits.step)?)
    }

    /// The same with the noise of a measurement.
    pub fn measured(&self, name: &str, drive: &[f64], noise: u64) -> Result<Record> {
        let data = with_noise(&self.data([self.run(name, drive)?])?, NOISE, noise)?;
        Ok(data.records()[0].clone())
    }

    /// Random reversals over the whole range with the noise of a measurement, to fit to.
    pub fn training(&self, rows: usize, seed: u64) -> Result<Dataset> {
        self.data([self.measured("test", &drives::random(&self.path, rows, 1000 * seed + 500), seed)?])
    }

    /// Records as one data set.
    pub fn data<const N: usize>(&self, records: [Record; N]) -> Result<Dataset> {
        Ok(Dataset::new(self.specimen.names.clone(), records.into())?)
    }

    /// Random reversals over the whole range, without noise, that no model has seen.
    pub fn unseen(&self, seed: u64) -> Result<Dataset> {
        let records = (0..UNSEEN)
            .map(|number| self.run("unseen", &drives::random(&self.path, ROWS_UNSEEN, 1000 * seed + number)))
            .collect::<Result<Vec<_>>>()?;
        Ok(Dataset::new(self.specimen.names.clone(), records)?)
    }
}

/// The error of a free run, NRMSE in percent of the standard deviation of the output.
pub fn error_of(model: &Model, data: &Dataset) -> Result<f64> {
    model.evaluate(data)?.nrmse_std_percent.context("the output does not vary")
}
