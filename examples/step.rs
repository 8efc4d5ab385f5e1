//! A model sample by sample, as in the loop of a controller: the same outputs, to the last bit, as a free run.

use hysid::operator::{Operator, Stop};
use hysid::{Dataset, Fit, Result};
use hysid_core::elementary::sin;

/// What the example prints.
pub fn report() -> Result<String> {
    let x: Vec<f64> = (0..600).map(|k| 0.01 * f64::from(k) * sin(0.1 * f64::from(k))).collect();
    let friction = Stop::new(1.0)?.run(&x);
    let y: Vec<f64> = x.iter().zip(friction).map(|(x, friction)| 0.2 * x + friction).collect();
    let model = Fit::new().model("prandtl-ishlinskii").run(&Dataset::from_slices(&x, &y)?)?;

    let free_run = model.run(&x)?;
    let mut stepper = model.stepper();
    let mut same = 0;
    for (x, expected) in x.iter().zip(&free_run) {
        let force = stepper.step(&[*x], f64::NAN, None)?;
        same += usize::from(force == *expected);
    }
    Ok(format!("{same} of {} outputs are the same\nthe last is {:.6}\n", x.len(), free_run[x.len() - 1]))
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
