//! How many measured outputs lie within a model's band.

use hysid::data::record::Dataset;
use hysid::model::Prediction;
use hysid::significant::Significant;

/// Share of the measured outputs that lie within a band.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BandCoverage {
    /// What was asked for.
    pub probability: f64,
    /// What was found, in percent of the rows with an output.
    pub coverage_percent: f64,
    /// Rows with an output.
    pub samples: usize,
}

impl BandCoverage {
    /// Of so many outputs within the band, and so many in all.
    pub fn of((covered, samples): (usize, usize), probability: f64) -> Self {
        Self { probability, coverage_percent: 100.0 * covered as f64 / samples.max(1) as f64, samples }
    }

    /// Of bands that are there already, one for each record.
    pub fn counted(predictions: &[Prediction], data: &Dataset, probability: f64) -> Self {
        let of_records = predictions.iter().zip(data.records());
        let of_records = of_records.map(|(predicted, record)| predicted.covered(record.output()));
        let (covered, samples) = of_records.fold((0, 0), |sum, next| (sum.0 + next.0, sum.1 + next.1));
        Self::of((covered, samples), probability)
    }

    /// In words.
    pub fn words(&self) -> String {
        format!(
            "{:.3} % of the measured outputs lie within the band of {:.3} %",
            Significant(self.coverage_percent),
            Significant(100.0 * self.probability)
        )
    }
}
