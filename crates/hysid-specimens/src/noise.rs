//! Measurement noise.

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use hysid_core::data::record::{Dataset, Record};
use hysid_core::elementary::{cos, ln, square};
use hysid_core::error::{OptionError, Result};

/// The data with Gaussian noise on the output. The standard deviation of the noise is `percent` of the
/// population standard deviation of all outputs together. Blanks stay blank.
///
/// The same data, `percent` and `seed` give the same noise; training and test data therefore need different
/// seeds.
///
/// # Errors
/// `percent` is negative or not finite, or so large that an output is beyond the largest value of a record.
pub fn with_noise(data: &Dataset, percent: f64, seed: u64) -> Result<Dataset> {
    if !(percent >= 0.0 && percent.is_finite()) {
        return Err(OptionError::value("noise", percent, "a number of percent, 0 or more, is needed").into());
    }
    let deviation = 0.01 * percent * standard_deviation(data);
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let records = data.records().iter().map(|record| {
        let output = record.output().iter().map(|y| y + deviation * normal(&mut generator)).collect();
        record.clone().with_output(output)
    });
    Dataset::new(data.names().clone(), records.collect::<Result<_>>()?)
}

/// Population standard deviation of all scored outputs; 0 if there are none.
fn standard_deviation(data: &Dataset) -> f64 {
    let scored = || data.records().iter().flat_map(Record::output).filter(|y| !y.is_nan());
    let count = data.scored().max(1) as f64;
    let mean = scored().sum::<f64>() / count;
    (scored().map(|y| square(y - mean)).sum::<f64>() / count).sqrt()
}

/// A standard normal number, by Box and Muller.
pub(super) fn normal(generator: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * ln(1.0 - u)).sqrt() * cos(std::f64::consts::TAU * v)
}
