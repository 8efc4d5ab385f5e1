//! How many measured outputs lie within a model's band.

use hysid::data::record::Dataset;
use hysid::model::{BAND_OF_TEN, BandLevel, Prediction};
use hysid_core::significant::Significant;

/// Share of the measured outputs that lie within a band.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BandCoverage {
    pub probability: f64,
    /// Data sets of ten in which the band is to contain that share; left out for five, on average.
    #[serde(skip_serializing_if = "is_average")]
    pub of_ten: usize,
    /// Measured coverage, in percent of the rows with an output.
    pub coverage_percent: f64,
    /// Rows with an output.
    pub samples: usize,
}

impl BandCoverage {
    /// Of so many outputs within the band, and so many in all.
    pub fn of((covered, samples): (usize, usize), level: impl Into<BandLevel>) -> Self {
        let BandLevel { probability, of_ten } = level.into();
        Self {
            probability,
            of_ten,
            coverage_percent: 100.0 * covered as f64 / samples.max(1) as f64,
            samples,
        }
    }

    /// Of bands that are there already, one for each record.
    pub fn counted(predictions: &[Prediction], data: &Dataset, probability: f64) -> Self {
        let of_records = predictions.iter().zip(data.records());
        let of_records = of_records.map(|(predicted, record)| predicted.covered(record.output()));
        let (covered, samples) = of_records.fold((0, 0), |sum, next| (sum.0 + next.0, sum.1 + next.1));
        Self::of((covered, samples), probability)
    }

    pub fn words(&self) -> String {
        let widened = match self.of_ten {
            of_ten if is_average(&of_ten) => String::new(),
            of_ten => format!(" in {of_ten} of 10 data sets"),
        };
        format!(
            "{:.3} % of the measured outputs lie within the band of {:.3} %{widened}",
            Significant(self.coverage_percent),
            Significant(100.0 * self.probability)
        )
    }
}

/// True for a band that contains its share on average over data sets.
fn is_average(of_ten: &usize) -> bool {
    of_ten == BAND_OF_TEN.start()
}
