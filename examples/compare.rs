//! Several models on the same data, compared by their error on data that none has seen.

use hysid::specimens::Specimen;
use hysid::{Fit, Result};

/// What the example prints.
pub fn report() -> Result<String> {
    let rod = Specimen::named("terfenol-rod").expect("a specimen of the catalogue");
    let models = ["masing", "prandtl-ishlinskii", "modified-prandtl-ishlinskii"];
    let mut errors = Vec::new();
    for name in models {
        let model = Fit::new().model(name).run(&rod.train())?;
        errors.push((name, model.evaluate(&rod.test())?.rmse));
    }
    errors.sort_by(|a, b| a.1.total_cmp(&b.1));
    Ok(errors.into_iter().map(|(name, rmse)| format!("{name}: {rmse:.4}\n")).collect())
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
