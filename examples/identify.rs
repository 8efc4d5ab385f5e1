//! From columns of measured data to a model file: fit, error on data that the model has not seen, save, load.

use hysid::specimens::Specimen;
use hysid::{Fit, Model, Result};

/// What the example prints.
pub fn report() -> Result<String> {
    // In place of measured columns: `Dataset::from_columns(Some(("t_s", &t)), &[("H", &x)], ("B", &y))`.
    let magnet = Specimen::named("ferromagnet").expect("a specimen of the catalogue");
    let (train, test) = (magnet.train(), magnet.test());

    // `hysid::fit(&train)` cross-validates all models; one named model is quicker.
    let model = Fit::new().model("preisach").seed(1).run(&train)?;
    let file = model.to_json();
    let loaded = Model::from_json(&file)?;

    let unseen = loaded.evaluate(&test)?;
    Ok(format!(
        "{} with {} parameters\nunseen error {:.3} % of the standard deviation\n",
        loaded.name().name(),
        loaded.parameters(),
        unseen.nrmse_std_percent.unwrap_or(f64::NAN)
    ))
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
