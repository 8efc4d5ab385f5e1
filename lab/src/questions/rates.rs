//! What a causal rate costs: the error on unseen data with the rate as a central difference, as a backward difference,
//! and without rate.

use anyhow::Result;
use hysid::data::metrics::ErrorSums;
use hysid::data::rate::RateMethod;
use hysid::data::record::Dataset;
use hysid::{Fit, Model};

use super::by_specimen;
use crate::cases::{aligned, row};
use crate::rig::{Rig, error_of};

const SPECIMENS: [&str; 5] = [
    "damper-random",
    "bush-random",
    "rate-actuator-frequencies",
    "creeping-piezo-frequencies",
    "ferroelectric-frequencies",
];
const SEEDS: u64 = 2;

/// Rows of the fastest swing: a fine and a coarse sampling.
const SAMPLINGS: [usize; 2] = [50, 10];

/// Swings of the whole range at the largest rate that training data are as long as.
const SWINGS: usize = 20;

const COLUMNS: [&str; 4] = ["central", "central, in steps", "backward", "none"];

/// A row for each specimen and sampling.
pub fn table() -> Result<String> {
    let mut rows = vec![row("specimen, rows a swing", &COLUMNS)];
    for sampling in SAMPLINGS {
        let errors = |name: &str, seed: u64| errors(name, sampling, seed);
        rows.extend(by_specimen::rows(&SPECIMENS, SEEDS, &format!(", {sampling}"), errors)?);
    }
    Ok(aligned(&rows))
}

fn errors(name: &str, rows_of_a_swing: usize, seed: u64) -> Result<[f64; 4]> {
    let rows = SWINGS * rows_of_a_swing;
    let rig = Rig::sampled(name, seed, rows, rows_of_a_swing as f64)?;
    let (train, unseen) = (rig.training(rows, seed)?, rig.unseen(seed)?);
    let fit = |rate| -> Result<Model> { Ok(Fit::new().model("xpnn").rate(rate).seed(seed).run(&train)?) };
    let central = fit(Some(RateMethod::Central))?;
    Ok([
        error_of(&central, &unseen)?,
        error_in_steps(&central, &unseen)?,
        error_of(&fit(Some(RateMethod::Backward))?, &unseen)?,
        error_of(&fit(None)?, &unseen)?,
    ])
}

/// The error of a model that is run sample by sample without a rate, as in a controller: it forms backward differences.
fn error_in_steps(model: &Model, unseen: &Dataset) -> Result<f64> {
    let mut sums = ErrorSums::default();
    for record in unseen.records() {
        let mut stepper = model.stepper();
        let time = record.time().unwrap_or_default();
        let output = record.inputs()[0]
            .iter()
            .zip(time)
            .map(|(x, t)| stepper.step(&[*x], *t, None))
            .collect::<hysid::Result<Vec<f64>>>()?;
        sums.add(record.output(), &output);
    }
    let errors = sums.errors(&unseen.names().output);
    Ok(errors.and_then(|errors| errors.nrmse_std_percent).unwrap_or(f64::NAN))
}
