//! Tracking with an actuator that has hysteresis: a PI controller, feedforward by the inverse of a model, and both.

use std::f64::consts::TAU;

use hysid::specimens::{Specimen, terfenol_actuator};
use hysid::{Fit, Model, Result};
use hysid_core::elementary::{exp, sin};

const ROWS: u32 = 1000;
/// Sampling interval in s.
const STEP: f64 = 0.01;
/// Lowest and highest current in A.
const LOW: f64 = -0.7;
const HIGH: f64 = 1.2;
/// Gains in A/µm: of those with which the loop is stable at twice the largest slope of the actuator, 64 µm/A, the best
/// for the PI controller alone.
const KP: f64 = 0.002;
const KI: f64 = 0.007;

/// The wanted displacement in µm.
fn reference(time: f64) -> f64 {
    30.0 + 19.0 * sin(TAU * 0.5 * time) + 9.0 * sin(TAU * 1.3 * time)
}

/// What the model does not know: the actuator warms up and expands by 3 µm.
fn drift(time: f64) -> f64 {
    3.0 * (1.0 - exp(-time / 2.0))
}

/// RMS tracking error in µm.
fn track(model: &Model, with_inverse: bool, with_pi: bool) -> Result<f64> {
    let mut actuator = terfenol_actuator::law();
    let mut inverse = model.inverse().limits(LOW, HIGH)?;
    let (mut integral, mut error, mut late, mut squares) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..ROWS {
        let time = STEP * f64::from(k);
        let wanted = reference(time);
        // The inverse follows its own input, not the corrected one, so that no measurement gets into its memory.
        // Its memory then differs from the actuator's by what the correction does: keep the correction small.
        let mut current = if with_inverse { inverse.step(wanted, &[], time)?.input } else { 0.0 };
        if with_pi {
            let sum = integral + KI * late;
            current += KP * late + sum;
            // Anti-windup: the integral stops while the current is beyond a limit and the error drives it further.
            if (current < HIGH || late < 0.0) && (current > LOW || late > 0.0) {
                integral = sum;
            }
        }
        let displacement = actuator.step(current.clamp(LOW, HIGH)) + drift(time);
        // The measurement arrives one sample late.
        late = error;
        error = wanted - displacement;
        squares += error * error;
    }
    Ok((squares / f64::from(ROWS)).sqrt())
}

/// What the example prints.
pub fn report() -> Result<String> {
    let train = Specimen::named("terfenol-actuator").expect("a specimen of the catalogue").train();
    let model = Fit::new().model("modified-prandtl-ishlinskii").seed(1).run(&train)?;
    let (low, high) = model.trained_ranges().output;

    let mut text = "RMS tracking error in percent of the range\n".to_string();
    for (controller, with_inverse, with_pi) in
        [("PI", false, true), ("inverse", true, false), ("inverse and PI", true, true)]
    {
        let percent = 100.0 * track(&model, with_inverse, with_pi)? / (high - low);
        text += &format!("{controller:<14} {percent:5.2}\n");
    }
    Ok(text)
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
