//! Is one loop enough: the error on smaller loops and reversal curves of models that were fitted to the major loop only.

use anyhow::{Context, Result};
use hysid_lab::generated::{Case, one_loop};

use super::fit;
use crate::cases::{aligned, row};
use crate::rig::error_of;
use crate::statistics::{geometric_mean, shown};

const MODELS: [&str; 6] =
    ["auto", "xpnn+", "preisach", "prandtl-ishlinskii", "modified-prandtl-ishlinskii", "bouc-wen"];

/// Cases: laws that need no time, of every field.
const CASES: usize = 14;
/// The prior of `auto` for data of one loop was determined on the cases of seed 1; these are others.
const SEED: u64 = 3;

/// Fields by the name of the input.
const FIELDS: [(&str, &[&str]); 3] = [
    ("structures", &["disp_mm", "strain_mm_per_m"]),
    ("magnets", &["H_A_per_m"]),
    ("actuators", &["u_V", "i_A", "T_degC"]),
];

/// A row for each model: errors on the loop, and on unseen smaller loops of each field.
pub fn table() -> Result<String> {
    let cases = one_loop(CASES, SEED)?;
    let fields: Vec<usize> = cases.iter().map(field).collect::<Result<_>>()?;
    let heading = FIELDS.iter().zip(0..).map(|((name, _), field)| {
        format!("unseen, {name} ({})", fields.iter().filter(|of| **of == field).count())
    });
    let heading: Vec<String> =
        ["training".into()].into_iter().chain(heading).chain(["unseen, all".into()]).collect();
    let mut rows = vec![row("model", &heading)];
    for name in MODELS {
        let (mut training, mut unseen) = (Vec::new(), Vec::new());
        for case in &cases {
            let model = fit(name, &case.train, SEED)?;
            training.push(error_of(&model, &case.train)?);
            unseen.push(error_of(&model, &case.test)?);
        }
        let of_field = |field: usize| -> Vec<f64> {
            unseen.iter().zip(&fields).filter(|(_, of)| **of == field).map(|(error, _)| *error).collect()
        };
        let fields = (0..FIELDS.len()).map(|field| geometric_mean(&of_field(field)));
        let means = [geometric_mean(&training)].into_iter().chain(fields).chain([geometric_mean(&unseen)]);
        rows.push(row(name, &means.map(shown).collect::<Vec<_>>()));
    }
    Ok(aligned(&rows))
}

/// The index of a case's field.
fn field(case: &Case) -> Result<usize> {
    let input = case.train.names().inputs[0].as_str();
    let found = FIELDS.iter().position(|(_, inputs)| inputs.contains(&input));
    found.with_context(|| format!("the input `{input}` has no field"))
}
