//! Thresholds that a fit tries, and numbers spread between bounds.

use hysid_core::elementary::powf;

use crate::error::{Error, OptionError, Result};
use crate::fit::sums::lowest;
use crate::law::thresholds::check_thresholds;

/// Thresholds `r_i = X (i/(n+1))^e` with the largest input `X` (theory.md (7.5)); an error for none or more than 1000.
fn spread(count: usize, largest: f64, exponent: f64) -> Result<Vec<f64>> {
    check_count("operators", count, MOST_OPERATORS)?;
    // (7.5)
    Ok((1..=count).map(|i| largest * powf(i as f64 / (count + 1) as f64, exponent)).collect())
}

/// Rejects the value of an option that is not from 1 to `most`.
pub(crate) fn check_count(option: &'static str, count: usize, most: usize) -> Result<()> {
    match (1..=most).contains(&count) {
        true => Ok(()),
        false => Err(OptionError::value(option, count, format!("choose 1 to {most}")).into()),
    }
}

/// Exponents that thresholds are spread with: `r_i ∝ (i/n)^exponent`. Designed.
const SPREADS: [f64; 3] = [1.0, 1.5, 2.5];

/// The sets of thresholds that a fit tries: the given one, or `count` of them spread in several ways.
pub(crate) fn candidates(given: Option<&[f64]>, count: usize, largest: f64) -> Result<Vec<Vec<f64>>> {
    match given {
        Some(thresholds) => {
            check_thresholds(thresholds)?;
            Ok(vec![thresholds.to_vec()])
        }
        None => SPREADS.iter().map(|&exponent| spread(count, largest, exponent)).collect(),
    }
}

/// Fits to several grids; a stop after the first leaves out the others.
pub(crate) fn fits_on_grids<F>(grids: &[Vec<f64>], fit: impl Fn(&[f64]) -> Result<F>) -> Result<Vec<F>> {
    let mut fits = Vec::new();
    for grid in grids {
        match fit(grid) {
            Err(Error::Stopped) if !fits.is_empty() => break,
            fit => fits.push(fit?),
        }
    }
    Ok(fits)
}

const MOST_OPERATORS: usize = 1000;

/// The grid whose fit has the lowest score, with the weights found on it.
pub(crate) fn best_on_grids(
    mut grids: Vec<Vec<f64>>,
    fit: impl Fn(&[f64]) -> Result<(f64, Vec<f64>)>,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let (scores, mut weights): (Vec<f64>, Vec<Vec<f64>>) = fits_on_grids(&grids, fit)?.into_iter().unzip();
    let best = lowest(&scores);
    Ok((grids.swap_remove(best), weights.swap_remove(best)))
}

/// Number `index` of `count` between two bounds, logarithmically spaced; a single one lies in the middle.
pub(crate) fn spaced((low, high): (f64, f64), index: usize, count: usize) -> f64 {
    let share = if count == 1 { 0.5 } else { index as f64 / (count - 1) as f64 };
    low * powf(high / low, share)
}
