//! Several models on the same data, compared by their error on data that none has seen.

use hysid::specimens::Specimen;
use hysid::{Result, compare};

/// What the example prints.
pub fn report() -> Result<String> {
    let rod = Specimen::named("terfenol-rod").expect("a specimen of the catalogue");
    let models = ["masing", "prandtl-ishlinskii", "modified-prandtl-ishlinskii"];
    let mut text = String::new();
    for compared in compare(&rod.train(), &rod.test(), &models, 1)? {
        let (_, unseen) = compared.outcome?;
        text += &format!("{}: {:.4}\n", compared.label, unseen.rmse);
    }
    Ok(text)
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
