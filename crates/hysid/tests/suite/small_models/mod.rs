//! A record that every model can be fitted to, and requests small enough that all of them are quick.

use hysid::data::rate::RateMethod;
use hysid::data::record::Record;
use hysid::operator::{Operator, Stop};
use hysid::options::classical::ClassicalOptions;
use hysid::options::fit_spec::AutoOptions;
use hysid::options::network::FitOptions;
use hysid::options::{FitSpec, ModelName};
use hysid_core::elementary::sin;
use hysid_core::network::Sizes;

/// A play-like output that lags behind its input; another name is another measurement.
pub fn record(rows: usize, name: &str) -> Record {
    let letters: u32 = name.bytes().map(u32::from).sum();
    let pace = 0.19 + 0.004 * f64::from((letters + 1) % 7);
    let x: Vec<f64> =
        (0..rows).map(|k| sin(pace * k as f64) * (0.4 + 0.6 * sin(0.011 * k as f64).abs())).collect();
    let mut stop = Stop::new(0.25).unwrap();
    let y = x.iter().map(|x| 20.0 + 3.0 * x - 1.8 * stop.step(*x)).collect();
    let time = (0..rows).map(|k| 0.1 * k as f64).collect();
    Record::new(name, vec![x], y).unwrap().with_time(time).unwrap()
}

pub fn small(model: ModelName, rate: Option<RateMethod>) -> FitSpec {
    match FitSpec::of(model, rate, 3) {
        FitSpec::Network(options) => FitSpec::Network(FitOptions {
            sizes: Sizes { stops: 3, hidden: 2, relaxation: 1 },
            starts: 1,
            epochs: 4,
            ..options
        }),
        FitSpec::Classical(options) => FitSpec::Classical(ClassicalOptions {
            operators: Some(8),
            starts: options.model.is_searched().then_some(2),
            epochs: options.model.is_searched().then_some(6),
            ..options
        }),
        FitSpec::Auto(options) => FitSpec::Auto(AutoOptions {
            members: 6,
            starts: 2,
            epochs: Some(3),
            operators: Some(8),
            ..options
        }),
    }
}
