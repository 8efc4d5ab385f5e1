//! The program of a step, run here, gives the outputs of the library's stepper to the last bit, and its tangent is the
//! slope of trial steps.

use std::sync::LazyLock;

use crate::models::{all, path, time_step};
use hysid::Model;
use hysid_core::elementary::{powf, sin};
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::program::Precision;
use hysid_export::program::interpreter::Machine;
use hysid_export::program::tangent::with_tangent;

static MODELS: LazyLock<Vec<(String, Model)>> = LazyLock::new(all);

fn arguments(description: &Description, inputs: &[f64], step: f64, rate: f64) -> Vec<f64> {
    let value = |argument: &Argument| match argument {
        Argument::Input(input) => inputs[*input],
        Argument::TimeStep => step,
        Argument::Rate => rate,
    };
    description.arguments.iter().map(value).collect()
}

fn agrees(name: &str, model: &Model) {
    for source in [RateSource::Backward, RateSource::Argument] {
        let description = Description::of(model, source, Precision::Double);
        let mut machine = Machine::new(&description.program);
        let mut stepper = model.stepper();
        let mut time = 0.0;
        for (row, inputs) in path(2500, model.names().inputs.len()).iter().enumerate() {
            let before = time;
            time += time_step(row);
            let rate = sin(0.3 * row as f64);
            let given = (source == RateSource::Argument).then_some(rate);
            let expected = stepper.step(inputs, time, given).unwrap();
            // The stepper takes time stamps, whose difference is rounded.
            let found = machine.step(&arguments(&description, inputs, time - before, rate))[0];
            assert!(found.to_bits() == expected.to_bits(), "{name}, row {row}: {found:e}, not {expected:e}");
        }
    }
}

#[test]
fn programs_give_the_outputs_of_the_stepper() {
    for (name, model) in MODELS.iter() {
        agrees(name, model);
    }
}

/// A number of -1 to 1 from a generator of bits.
fn random(bits: &mut u64) -> f64 {
    *bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn outputs_are_equal_and_finite_on_wild_paths() {
    const ROWS: usize = 1000;
    for (name, model) in MODELS.iter() {
        let description = Description::of(model, RateSource::Backward, Precision::Double);
        let tangent = with_tangent(&description.program);
        let mut machine = Machine::new(&tangent);
        let mut stepper = model.stepper();
        let (mut bits, mut time) = (7, 0.0);
        let mut x = 40.0;
        for row in 0..ROWS {
            // Steps of all sizes, rests, returns to 0, and huge values.
            x = match row % 50 {
                10 | 11 => x,
                20 => 0.0,
                30 if row % 300 == 30 => 1e90,
                31 if row % 300 == 31 => -1e90,
                32 => 40.0,
                _ => x + powf(10.0, 3.0 * random(&mut bits) - 1.0) * random(&mut bits).signum(),
            };
            let before = time;
            time += time_step(row);
            let inputs = [x, 5.0 + random(&mut bits), 25.0 + 20.0 * random(&mut bits)];
            let inputs = &inputs[..model.names().inputs.len()];
            let expected = stepper.step(inputs, time, None).unwrap();
            let outputs = machine.step(&arguments(&description, inputs, time - before, 0.0));
            let found = outputs[0];
            assert!(outputs.iter().all(|y| y.is_finite()), "{name}, row {row}: {outputs:?} at {x:e}");
            assert!(found.to_bits() == expected.to_bits(), "{name}, row {row}: {found:e}, not {expected:e}");
        }
    }
}

#[test]
fn the_tangent_is_the_slope_of_trial_steps() {
    for (name, model) in MODELS.iter() {
        let description = Description::of(model, RateSource::Backward, Precision::Double);
        let tangent = with_tangent(&description.program);
        let mut machine = Machine::new(&tangent);
        let mut good = 0;
        let rows = path(400, model.names().inputs.len());
        for (row, inputs) in rows.iter().enumerate() {
            let before = machine.state();
            let mut at = |by: f64| {
                let mut inputs = inputs.clone();
                inputs[0] += by;
                machine.set_state(&before);
                let outputs = machine.step(&arguments(&description, &inputs, time_step(row), 0.0));
                (outputs[0], outputs[1])
            };
            let by = 1e-6;
            let ((low, _), (high, _)) = (at(-by), at(by));
            let (here, slope) = at(0.0);
            // At a kink the tangent is one-sided.
            let differences = [(high - low) / (2.0 * by), (high - here) / by, (here - low) / by];
            let is_near = |difference: &f64| (slope - difference).abs() <= 1e-3 * slope.abs().max(1.0);
            // Where the input rests, several kinks meet.
            let rests = row > 0 && inputs[0] == rows[row - 1][0];
            good += usize::from(rests || differences.iter().any(is_near));
        }
        println!("{name}: {good} of {}", rows.len());
        assert!(good * 100 >= rows.len() * 98, "{name}: {good} of {}", rows.len());
    }
}

#[test]
fn trials_of_the_library_agree_with_the_program() {
    for (name, model) in MODELS.iter() {
        let description = Description::of(model, RateSource::Backward, Precision::Double);
        let tangent = with_tangent(&description.program);
        let mut machine = Machine::new(&tangent);
        let (mut stepper, mut plain) = (model.stepper(), model.stepper());
        let (mut time, mut near, rows) = (0.0, 0, 300);
        for (row, inputs) in path(rows, model.names().inputs.len()).iter().enumerate() {
            let before = time;
            time += time_step(row);
            let committed = stepper.snapshot();
            // Trials elsewhere leave no trace.
            let mut elsewhere = inputs.clone();
            elsewhere[0] += 1.3 * sin(row as f64);
            stepper.trial(&elsewhere, time, None).unwrap();
            let is_late = stepper.trial(&elsewhere, before - 1.0, None).is_err();
            assert!(is_late || row == 0 || !model.needs_time());
            stepper.revert();
            let (y, slope) = stepper.trial_with_tangent(inputs, time, None).unwrap();
            assert_eq!(y, stepper.trial(inputs, time, None).unwrap(), "{name}, row {row}");
            match row % 3 {
                0 => stepper.commit(),
                1 => assert_eq!(y, stepper.step(inputs, time, None).unwrap(), "{name}, row {row}"),
                _ => {
                    stepper.restore(&committed);
                    assert_eq!(y, stepper.step(inputs, time, None).unwrap(), "{name}, row {row}");
                }
            }
            assert_eq!(y, plain.step(inputs, time, None).unwrap(), "{name}, row {row}");
            let exact = machine.step(&arguments(&description, inputs, time - before, 0.0))[1];
            near += usize::from((slope - exact).abs() <= 1e-5 * exact.abs().max(0.1));
        }
        assert!(near * 100 >= rows * 93, "{name}: {near} of {rows} slopes");
    }
}
