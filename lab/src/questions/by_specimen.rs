//! Tables with a row for each specimen and a column for each kind of fit.

use anyhow::Result;

use crate::cases::row;
use crate::statistics::{geometric_mean, shown};

/// A row for each specimen with the geometric means over the seeds 1 to `seeds`, and one with those over all specimens.
/// `values` gives the values of a specimen and a seed; `suffix` follows the names.
pub fn rows<const N: usize>(
    specimens: &[&str],
    seeds: u64,
    suffix: &str,
    values: impl Fn(&str, u64) -> Result<[f64; N]>,
) -> Result<Vec<Vec<String>>> {
    let means = |columns: &[Vec<f64>; N]| columns.each_ref().map(|values| shown(geometric_mean(values)));
    let mut rows = Vec::new();
    let mut all: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for name in specimens {
        let mut of_specimen: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
        for seed in 1..=seeds {
            for (column, value) in of_specimen.iter_mut().zip(values(name, seed)?) {
                column.push(value);
            }
        }
        rows.push(row(&format!("{name}{suffix}"), &means(&of_specimen)));
        for (column, values) in all.iter_mut().zip(of_specimen) {
            column.extend(values);
        }
    }
    rows.push(row(&format!("geometric mean{suffix}"), &means(&all)));
    Ok(rows)
}
