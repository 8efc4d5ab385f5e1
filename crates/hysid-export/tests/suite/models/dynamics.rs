//! Modes with hysteretic elements, of random coefficients.

use hysid::Model;
use hysid_core::elementary::exp;
use hysid_core::law::hysteretic_dynamics::{Dynamics, Element, ElementShape, Hold, Mode};
use hysid_core::law::hysteretic_oscillator::HystereticOscillator;
use hysid_core::law::hysteretic_state_space::HystereticStateSpace;
use hysid_core::law::{Classical, Law as _};
use hysid_core::model::Predictor;

use super::data;

struct RandomNumbers(u64);

impl RandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn many(&mut self, count: usize, size: f64) -> Vec<f64> {
        (0..count).map(|_| size * self.next()).collect()
    }
}

fn element(numbers: &mut RandomNumbers, shape: ElementShape, modes: usize) -> Element {
    let ElementShape { stops, states, neurons, deteriorates } = shape;
    Element {
        of_displacements: numbers.many(modes, 1.0),
        of_velocities: numbers.many(modes, 0.3),
        of_input: 0.3 * numbers.next(),
        compliances: numbers.many(modes, 0.3),
        in_output: numbers.next(),
        thresholds: numbers.many(stops, 1.0).iter().map(|t| 0.3 * exp(*t)).collect(),
        stop_velocities: numbers.many(stops, 0.3),
        strength_losses: numbers
            .many(if deteriorates { stops } else { 0 }, 0.01)
            .iter()
            .map(|k| k.abs())
            .collect(),
        layer: numbers
            .many(shape.inputs() * neurons, 0.6)
            .into_iter()
            .enumerate()
            .map(|(place, weight)| if deteriorates && place < neurons { 0.0 } else { weight })
            .collect(),
        rising: numbers.many(states * neurons, 0.6),
        falling: numbers.many(states * neurons, 0.6),
        path_leaks: numbers.many(states, 1.0).iter().map(|c| 2.0 * exp(*c)).collect(),
        initial: numbers.many(states, 0.5),
        force: numbers.many(stops + states + neurons, 0.6),
    }
}

/// Modes of 4, 11, ... radians per unit of time, the first lightly damped, the second one that creeps.
fn dynamics(
    modes: usize,
    elements: usize,
    shape: ElementShape,
    hold: Hold,
    begins_under_input: bool,
) -> Dynamics {
    let mut numbers = RandomNumbers((10 * modes + elements) as u64);
    let mode = |i: usize, numbers: &mut RandomNumbers| Mode {
        frequency: 4.0 + 7.0 * i as f64,
        damping: [0.06, 1.5][i % 2],
        gain: 1.0 + 0.5 * numbers.next(),
        velocity_in_output: 0.5 * numbers.next(),
    };
    Dynamics {
        input_scale: 20.0,
        output_offset: 100.0,
        output_scale: 3.0,
        direct: 0.2,
        hold,
        longest_step: 0.03,
        begins_under_input,
        modes: (0..modes).map(|i| mode(i, &mut numbers)).collect(),
        elements: (0..elements).map(|_| element(&mut numbers, shape, modes)).collect(),
    }
}

/// Both laws, with all variants that differ in code. The model gives them its ranges.
pub fn variants(of: &Model) -> Vec<(String, Model)> {
    let shape = |stops, states, neurons| ElementShape { stops, states, neurons, deteriorates: false };
    let deteriorating =
        |stops, states, neurons| ElementShape { deteriorates: true, ..shape(stops, states, neurons) };
    let oscillator =
        |dynamics| Classical::HystereticOscillator(HystereticOscillator(dynamics).validated().unwrap());
    let state_space =
        |dynamics| Classical::HystereticStateSpace(HystereticStateSpace(dynamics).validated().unwrap());
    let laws = [
        ("hysteretic-oscillator, linear", oscillator(dynamics(1, 0, shape(0, 1, 1), Hold::Linear, false))),
        ("hysteretic-oscillator", oscillator(dynamics(1, 1, deteriorating(2, 2, 9), Hold::Cubic, false))),
        (
            "hysteretic-state-space, two elements",
            state_space(dynamics(2, 2, shape(1, 2, 4), Hold::Linear, true)),
        ),
        (
            "hysteretic-state-space, constant hold",
            state_space(dynamics(2, 1, shape(9, 0, 8), Hold::Constant, true)),
        ),
    ];
    let model = |law| {
        let found = of.provenance().clone().into();
        Model::new(Predictor::Law(law), of.input_transform().clone(), None, &data(1), found).unwrap()
    };
    laws.into_iter().map(|(name, law)| (name.to_string(), model(law))).collect()
}
