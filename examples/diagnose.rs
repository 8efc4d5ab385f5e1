//! What kind of hysteresis do the data show, and which model can represent it?

use hysid::specimens::Specimen;
use hysid::{Result, diagnose};

/// What the example prints.
pub fn report() -> Result<String> {
    let joint = Specimen::named("reinforced-concrete-joint").expect("a specimen of the catalogue").train();
    let diagnosis = diagnose(&joint)?;
    let verdicts = diagnosis.properties.iter();
    Ok(verdicts.map(|finding| format!("{}: {}\n", finding.property, finding.verdict)).collect())
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
