//! An actuator whose gain drifts while its output is measured: the error of its model with and without corrections.

use hysid::model::{ADAPTATION_ROWS, Stepper, Tracking};
use hysid::specimens::Specimen;
use hysid::{Fit, Result};

/// Sampling interval in s, and the rows of a minute.
const STEP: f64 = 1.0 / 3000.0;
const ROWS: u32 = 180_000;
/// Rows of a period of the voltage, a sum of tones at 5, 30 and 60 Hz.
const PERIOD: usize = 600;

/// Gain of the actuator, which falls by a tenth in a minute.
fn gain(row: u32) -> f64 {
    1.0 - 0.1 * f64::from(row) / f64::from(ROWS)
}

type Take = fn(&mut Stepper<'_>, f64) -> Result<()>;

/// What the example prints.
pub fn report() -> Result<String> {
    let specimen = Specimen::named("rate-dependent-actuator").expect("a specimen of the catalogue");
    let model = Fit::new().model("rate-dependent-prandtl-ishlinskii").seed(1).run(&specimen.train())?;
    let test = specimen.test();
    let tones = &test.records()[2];
    let (voltage, displacement) = (&tones.inputs()[0][PERIOD..], &tones.output()[PERIOD..]);

    let uses: [(&str, Take); 4] = [
        ("none", |_, _| Ok(())),
        ("adapt", |stepper, y| stepper.adapt(y, ADAPTATION_ROWS)),
        ("correct", |stepper, y| stepper.correct(y)),
        ("adapt and correct", |stepper, y| {
            stepper.adapt(y, ADAPTATION_ROWS)?;
            stepper.correct(y)
        }),
    ];
    let mut text = "RMS error in um over a minute\n".to_string();
    let mut found = model.stepper().tracking();
    for (name, take) in uses {
        let (mut stepper, mut squares, mut noise) = (model.stepper(), 0.0, 1_u64);
        for row in 0..ROWS {
            let place = row as usize % PERIOD;
            let predicted = stepper.step(&[voltage[place]], STEP * f64::from(row), None)?;
            let output = gain(row) * displacement[place];
            squares += (predicted - output) * (predicted - output);
            // The sensor has noise of up to 0.1 um.
            noise = (1_103_515_245 * noise + 12_345) % (1 << 31);
            take(&mut stepper, output + 0.1 * (2.0 * noise as f64 / f64::from(1_u32 << 31) - 1.0))?;
        }
        text += &format!("{name:<18} {:.3}\n", (squares / f64::from(ROWS)).sqrt());
        found = stepper.tracking();
    }
    let Tracking { gain, offset, residual, .. } = found;
    text += &format!("gain after the minute {gain:.3}, offset {offset:.2} um, ");
    Ok(text + &format!("recent residual {:.3} um\n", residual.unwrap_or_default()))
}

fn main() -> Result<()> {
    print!("{}", report()?);
    Ok(())
}
