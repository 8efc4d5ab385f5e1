//! The program of a step, run here, gives the outputs of the library's stepper to the last bit, and its tangent is the
//! slope of trial steps.

mod models;

use hysid::Model;
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::program::Precision;
use hysid_export::program::interpreter::Machine;
use hysid_export::program::tangent::with_tangent;
use models::{laws, networks, path, time_step};

/// Arguments of a row.
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
        let mut stepper = model.stepper().portable();
        let mut time = 0.0;
        for (row, inputs) in path(2500, model.names().inputs.len()).iter().enumerate() {
            let before = time;
            time += time_step(row);
            let rate = (0.3 * row as f64).sin();
            let given = (source == RateSource::Argument).then_some(rate);
            let expected = stepper.step(inputs, time, given).unwrap();
            // The stepper takes time stamps, whose difference is rounded.
            let found = machine.step(&arguments(&description, inputs, time - before, rate))[0];
            assert!(found.to_bits() == expected.to_bits(), "{name}, row {row}: {found:e}, not {expected:e}");
        }
    }
}

#[test]
fn laws_give_the_outputs_of_the_stepper() {
    for (name, model) in laws() {
        agrees(&name, &model);
    }
}

#[test]
fn networks_give_the_outputs_of_the_stepper() {
    for (name, model) in networks() {
        agrees(&name, &model);
    }
}

#[test]
fn the_tangent_is_the_slope_of_trial_steps() {
    for (name, model) in networks() {
        let description = Description::of(&model, RateSource::Backward, Precision::Double);
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
        assert!(good * 100 >= rows.len() * 99, "{name}: {good} of {}", rows.len());
    }
}
