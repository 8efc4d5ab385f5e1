//! A Bouc-Wen damper with known parameters, and the same parameters found again from its data.

use hysid::law::bouc_wen::BoucWen;
use hysid::law::series::{run, samples_of};
use hysid::{Dataset, Fit, Result};
use hysid_core::elementary::sin;

/// What the example prints.
pub fn report() -> Result<String> {
    let x: Vec<f64> = (0..800).map(|k| 0.01 * f64::from(k) * sin(0.1 * f64::from(k))).collect();
    // 5 kN/mm beside 100 kN/mm that yields at 2 mm.
    let damper = BoucWen::new(5.0, 100.0, 2.0)?;
    let force = run(&damper, &samples_of(&x));

    let model = Fit::new().model("bouc-wen").run(&Dataset::from_slices(&x, &force)?)?;
    let parameters = model.law().expect("a law").parameters();
    let value =
        |symbol| parameters.iter().find(|parameter| parameter.symbol == symbol).expect("of the law").value;
    Ok(format!(
        "stiffness after yielding {:.3} kN/mm\nyield displacement {:.3} mm\n",
        value("αk"),
        value("z_u")
    ))
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
