//! The error on new data, estimated by cross-validation: the model is fitted without one part of the data and simulates
//! that part.

use hysid::specimens::Specimen;
use hysid::{Fit, Result};

/// What the example prints.
pub fn report() -> Result<String> {
    let rod = Specimen::named("terfenol-rod").expect("a specimen of the catalogue").train();
    let validation = Fit::new().model("prandtl-ishlinskii").option("operators", 12).validate(&rod)?;

    let mut text = String::new();
    for fold in &validation.folds {
        let (train, unseen) = (fold.train.rmse, fold.unseen.rmse);
        text += &format!("{}: training error {train:.4}, unseen error {unseen:.4}\n", fold.held_out);
    }
    Ok(text + &format!("all that was held out: {:.4}\n", validation.unseen.rmse))
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
