//! Inputs of the benchmarks: an input, networks of any size, and data to fit.

use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::options::network::{FitOptions, Trainer};
use hysid_core::elementary::{cos, ln, sin};
use hysid_core::network::{Architecture, Family, Network, ParameterLayout, Sizes};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus as Generator;

/// An oscillation whose amplitude keeps changing, within -1 to 1.
pub fn path(rows: usize) -> Vec<f64> {
    (0..rows).map(|k| sin(0.07 * k as f64) * cos(0.003 * k as f64)).collect()
}

pub fn xpnn(stops: usize, hidden: usize, deterioration: bool) -> Architecture {
    let sizes = Sizes { stops, hidden, relaxation: 0 };
    let family = if deterioration { Family::Xpnn } else { Family::PreisachNn };
    Architecture::new(family, sizes, 1, false, false).unwrap()
}

/// Thresholds spread over the path, wear over its whole length, the rest at random.
pub fn parameters(architecture: Architecture, seed: u64) -> Vec<f64> {
    let layout = ParameterLayout::new(architecture);
    let mut generator = Generator::seed_from_u64(seed);
    (0..layout.len())
        .map(|k| {
            let random = generator.random::<f64>();
            if layout.stop_weights.contains(&k) {
                1.0 / (0.05 + 0.9 * random)
            } else if layout.ln_beta.contains(&k) {
                ln(1e5)
            } else {
                random - 0.5
            }
        })
        .collect()
}

pub fn network(architecture: Architecture) -> Network {
    let output = (0..architecture.output_weights()).map(|i| 0.5 - 0.1 * i as f64).collect();
    Network::new(architecture, parameters(architecture, 1), output).unwrap()
}

/// Rows of a network's output, which another one with 10 stops and 10 hidden neurons is to fit.
pub fn data(rows: usize) -> Dataset {
    let x = path(rows);
    let mut y = vec![0.0; x.len()];
    network(xpnn(6, 4, true)).simulator().run(&[&x], &[], &mut y);
    Dataset::new(ColumnNames::plain(1), vec![Record::new("r", vec![x], y).unwrap()]).unwrap()
}

pub fn options() -> FitOptions {
    let sizes = Sizes { stops: 10, hidden: 10, relaxation: 0 };
    FitOptions { model: Family::Xpnn, sizes, ..FitOptions::of(Trainer::LevenbergMarquardt) }
}
