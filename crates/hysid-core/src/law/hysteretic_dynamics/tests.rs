//! Motion against exact laws and itself; derivatives against differences.

use super::*;
use crate::elementary::{exp, sin};
use crate::random::mix;
use crate::stop_check::StopCheck;

/// Numbers between -1 and 1.
struct UnitNumbers(u64);

impl UnitNumbers {
    fn new(seed: u64) -> Self {
        Self(mix(seed))
    }

    fn next(&mut self) -> f64 {
        self.0 = mix(self.0);
        2.0 * (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }

    fn many(&mut self, count: usize, size: f64) -> Vec<f64> {
        (0..count).map(|_| size * self.next()).collect()
    }
}

fn element(numbers: &mut UnitNumbers, shape: ElementShape, modes: usize, size: f64) -> Element {
    let ElementShape { stops, states, neurons, deteriorates } = shape;
    let constant = shape.first_free_input();
    Element {
        of_displacements: numbers.many(modes, 1.0),
        of_velocities: numbers.many(modes, 0.5),
        of_input: numbers.next(),
        compliances: numbers.many(modes, 0.3),
        in_output: numbers.next(),
        thresholds: numbers.many(stops, 1.0).iter().map(|t| 0.3 * exp(*t)).collect(),
        stop_velocities: numbers.many(stops, 0.3),
        strength_losses: numbers
            .many(if deteriorates { stops } else { 0 }, 0.2)
            .iter()
            .map(|k| k.abs())
            .collect(),
        layer: [vec![0.0; constant * neurons], numbers.many((shape.inputs() - constant) * neurons, size)]
            .concat(),
        rising: numbers.many(states * neurons, size),
        falling: numbers.many(states * neurons, size),
        path_leaks: numbers.many(states, 1.0).iter().map(|c| 2.0 * exp(*c)).collect(),
        initial: numbers.many(states, 0.5),
        force: numbers.many(stops + states + neurons, size),
    }
}

/// A model with random coefficients, whose modes have frequencies of 1, 2, ... radians per unit of time.
pub(super) fn model(seed: u64, modes: usize, elements: usize, shape: ElementShape, size: f64) -> Dynamics {
    let mut numbers = UnitNumbers::new(seed);
    let mode = |i: usize, numbers: &mut UnitNumbers| Mode {
        frequency: 1.0 + i as f64,
        damping: 0.05 * exp(numbers.next()),
        gain: 1.0 + 0.5 * numbers.next(),
        velocity_in_output: 0.5 * numbers.next(),
    };
    Dynamics {
        input_scale: 2.0,
        output_offset: 0.5,
        output_scale: 3.0,
        direct: 0.2,
        hold: Hold::Cubic,
        longest_step: 0.08,
        begins_under_input: false,
        modes: (0..modes).map(|i| mode(i, &mut numbers)).collect(),
        elements: (0..elements).map(|_| element(&mut numbers, shape, modes, size)).collect(),
    }
}

pub(super) fn drive(seed: u64, rows: usize, step: f64) -> DynamicsDrive {
    let mut numbers = UnitNumbers::new(seed);
    let phases = numbers.many(5, std::f64::consts::PI);
    let tones =
        |t: f64| (1..).zip(&phases).map(|(k, phase)| sin(0.37 * f64::from(k) * t + phase)).sum::<f64>();
    DynamicsDrive {
        x: (0..rows).map(|k| tones(k as f64 * step)).collect(),
        steps: (0..rows).map(|k| if k == 0 { 0.0 } else { step }).collect(),
        targets: numbers.many(rows, 1.0),
        weights: (0..rows).map(|k| 1.0 + (k % 3) as f64).collect(),
    }
}

pub(super) fn samples(drive: &DynamicsDrive) -> Vec<Sample> {
    let rows = drive.x.iter().zip(&drive.steps);
    rows.map(|(&x, &step)| Sample { x, rate: 0.0, step }).collect()
}

fn outputs(dynamics: &Dynamics, samples: &[Sample]) -> Vec<f64> {
    let mut motion = dynamics.virgin();
    samples.iter().map(|&sample| dynamics.step(&mut motion, sample)).collect()
}

pub(super) const SHAPE: ElementShape = ElementShape { stops: 2, states: 2, neurons: 9, deteriorates: true };

/// A run over records that begin in mid-motion.
pub(super) fn in_motion<'a>(
    dynamics: &'a Dynamics,
    drives: &'a [DynamicsDrive],
    beginnings: &'a [f64],
) -> DynamicsRun<'a> {
    DynamicsRun { dynamics, drives, beginnings, is_in_motion: true, stop: StopCheck::never() }
}

#[test]
fn a_motion_that_has_begun_is_found_from_its_first_outputs() {
    for (modes, elements, begins_under_input) in [(1, 1, false), (2, 1, true), (3, 2, false)] {
        let mut dynamics = model(17, modes, elements, SHAPE, 0.5);
        dynamics.begins_under_input = begins_under_input;
        let mut drive = drive(9, 120, 0.21);
        let beginning = UnitNumbers::new(23).many(2 * modes, 1.0);
        let mut motion = dynamics.begun_with(&beginning);
        let outputs: Vec<f64> =
            samples(&drive).iter().map(|&sample| dynamics.step(&mut motion, sample)).collect();
        // The run of the fit begins in the same motion.
        drive.targets = outputs.iter().map(|y| y / dynamics.output_scale).collect();
        let drives = [drive];
        let from_rest = DynamicsRun::from_rest(&dynamics, &drives, StopCheck::never());
        let of_fit = DynamicsRun { beginnings: &beginning, ..from_rest };
        let (begun, resting) = (of_fit.half_square().unwrap(), from_rest.half_square().unwrap());
        assert!(begun < 1e-20 && resting > 0.1, "{begun} in this motion, {resting} from rest");
        let known: Vec<f64> =
            outputs[..60].iter().enumerate().map(|(k, &y)| if k % 7 == 3 { f64::NAN } else { y }).collect();
        let found = dynamics.found_states(&samples(&drives[0])[..60], &known);
        for (found, true_one) in found.iter().zip(&beginning) {
            assert!((found - true_one).abs() < 0.01, "{modes} modes: {found} for {true_one}");
        }
    }
}

#[test]
fn derivatives_equal_differences() {
    for (form, modes, elements, shape, begins_under_input, hold) in [
        (DynamicsForm::Oscillator, 1, 1, SHAPE, false, Hold::Cubic),
        (DynamicsForm::Oscillator, 2, 2, SHAPE, true, Hold::Linear),
        (DynamicsForm::StateSpace, 2, 2, SHAPE, false, Hold::Constant),
        (
            DynamicsForm::StateSpace,
            3,
            1,
            ElementShape { stops: 0, states: 3, neurons: 4, deteriorates: false },
            true,
            Hold::Cubic,
        ),
        (DynamicsForm::Oscillator, 2, 0, SHAPE, false, Hold::Cubic),
        (
            DynamicsForm::Oscillator,
            1,
            1,
            ElementShape { states: 0, deteriorates: false, ..SHAPE },
            false,
            Hold::Cubic,
        ),
    ] {
        let layout = DynamicsLayout::new(form, modes, elements, shape).with_beginning();
        let mut template = model(7, modes, elements, shape, 0.7);
        (template.begins_under_input, template.hold) = (begins_under_input, hold);
        let drives = [drive(3, 40, 0.11), drive(5, 25, 0.2)];
        let mut parameters = layout.parameters(&template);
        parameters[layout.beginning.clone()].copy_from_slice(&UnitNumbers::new(11).many(2 * modes, 1.0));
        // Both records begin alike, so that one column serves both.
        let beginnings = |parameters: &[f64]| parameters[layout.beginning.clone()].repeat(2);
        let errors = |parameters: &[f64]| -> Vec<f64> {
            let (dynamics, beginnings) = (layout.dynamics(parameters, &template), beginnings(parameters));
            let rows = in_motion(&dynamics, &drives, &beginnings).rows(&layout).unwrap();
            rows.iter().map(|row| row[layout.count()]).collect()
        };
        let (dynamics, beginnings) = (layout.dynamics(&parameters, &template), beginnings(&parameters));
        let run = in_motion(&dynamics, &drives, &beginnings);
        let rows = run.rows(&layout).unwrap();
        for place in 0..layout.count() {
            let by = 4e-6;
            let at = |by: f64| {
                let mut moved = parameters.clone();
                moved[place] += by;
                errors(&moved)
            };
            let (up, down) = (at(by), at(-by));
            for (k, row) in rows.iter().enumerate() {
                let difference = (up[k] - down[k]) / (2.0 * by);
                assert!(
                    (row[place] - difference).abs() < 2e-6 * (1.0 + difference.abs()),
                    "{form:?} {modes} {elements}: parameter {place}, row {k}: {} {difference}",
                    row[place]
                );
            }
        }
        let gram = run.gram(&layout).unwrap();
        let square: f64 = rows.iter().map(|row| row[layout.count()] * row[layout.count()]).sum();
        assert!((gram.at(layout.count(), layout.count()) / square - 1.0).abs() < 1e-12);
        assert!((2.0 * run.half_square().unwrap() / square - 1.0).abs() < 1e-12);
    }
}

#[test]
fn outputs_are_finite_whatever_the_parameters_and_the_steps() {
    for seed in 0..60 {
        let size = [0.5, 3.0, 30.0][seed as usize % 3];
        let mut dynamics = model(seed, 1 + seed as usize % 3, 1 + seed as usize % 2, SHAPE, size);
        dynamics.begins_under_input = seed % 2 == 0;
        dynamics.hold = Hold::ALL[seed as usize % 3];
        dynamics.modes[0].damping = [1e-4, 0.3, 1.0, 7.0][seed as usize % 4];
        let mut numbers = UnitNumbers::new(seed);
        let mut motion = dynamics.virgin();
        for _ in 0..400 {
            let step = exp(8.0 * numbers.next());
            let sample = Sample { x: 5.0 * numbers.next().signum(), rate: 0.0, step };
            assert!(dynamics.step(&mut motion, sample).is_finite(), "{seed}");
        }
    }
}

/// With one element there is a force that follows from itself, and it is found even where steps are far too long.
#[test]
fn the_force_of_a_single_element_is_always_found() {
    for seed in 0..40 {
        let dynamics = model(seed, 2, 1, SHAPE, 5.0);
        let mut numbers = UnitNumbers::new(seed);
        let mut motion = dynamics.virgin();
        for k in 0..200 {
            let step = if k % 20 == 0 { f64::INFINITY } else { exp(6.0 * numbers.next()) };
            dynamics.step(&mut motion, Sample { x: 3.0 * numbers.next(), rate: 0.0, step });
            let (largest, found) = (dynamics.elements[0].bounds().0, &motion);
            let mismatch = found.points[0].force - found.forces[0];
            assert!(mismatch.abs() <= 1e-8 * largest, "{seed} {k}: {mismatch} of {largest}");
        }
    }
}

#[test]
fn shorter_steps_converge_to_second_order() {
    let mut dynamics = model(11, 2, 2, SHAPE, 0.7);
    dynamics.hold = Hold::Linear;
    // Without stops, whose kinks lie within steps.
    dynamics.elements.iter_mut().for_each(|element| element.thresholds.fill(1e3));
    let drive = drive(1, 200, 0.4);
    let at = |longest_step: f64| outputs(&Dynamics { longest_step, ..dynamics.clone() }, &samples(&drive));
    let fine = at(0.4 / 64.0);
    let error = |longest_step: f64| {
        let squares = at(longest_step).iter().zip(&fine).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        (squares / fine.len() as f64).sqrt()
    };
    let (coarse, half, quarter) = (error(0.2), error(0.1), error(0.05));
    assert!(coarse / half > 3.0 && half / quarter > 3.0, "{coarse} {half} {quarter}");
}

/// A stop of large threshold is a spring: the mode under it is a mode of another frequency.
#[test]
fn an_element_that_is_a_spring_shifts_the_frequency() {
    let mut dynamics =
        model(2, 1, 1, ElementShape { stops: 1, states: 0, neurons: 1, deteriorates: false }, 0.0);
    let (stiffness, mode) = (3.0, Mode { frequency: 1.0, damping: 0.05, gain: 1.0, velocity_in_output: 0.0 });
    dynamics.modes = vec![mode];
    dynamics.direct = 0.0;
    dynamics.longest_step = 0.002;
    let element = &mut dynamics.elements[0];
    (element.of_displacements, element.of_velocities, element.of_input) = (vec![1.0], vec![0.0], 0.0);
    (element.compliances, element.in_output) = (vec![1.0], 0.0);
    (element.thresholds, element.force) = (vec![1e6], vec![stiffness, 0.0]);
    element.stop_velocities = vec![0.0];
    let root = f64::sqrt(1.0 + stiffness);
    let stiffer = Dynamics {
        modes: vec![Mode { frequency: root, damping: 0.05 / root, gain: 1.0 / (root * root), ..mode }],
        elements: Vec::new(),
        ..dynamics.clone()
    };
    let samples = samples(&drive(9, 300, 0.1));
    for (a, b) in outputs(&dynamics, &samples).iter().zip(outputs(&stiffer, &samples)) {
        assert!((a - b).abs() < 5e-5, "{a} {b}");
    }
}

#[test]
fn a_record_begins_at_rest() {
    let mut dynamics = model(6, 2, 1, SHAPE, 0.5);
    dynamics.begins_under_input = true;
    let rest = |step: f64| Sample { x: 1.3, rate: 0.0, step };
    let still = outputs(&dynamics, &[rest(0.0), rest(0.1), rest(0.1), rest(5.0)]);
    assert!(still.iter().all(|y| (y - still[0]).abs() < 1e-6), "{still:?}");
    dynamics.begins_under_input = false;
    dynamics.elements.clear();
    let moving = outputs(&dynamics, &[rest(0.0), rest(0.1)]);
    let direct =
        dynamics.output_offset + dynamics.output_scale * dynamics.direct * 1.3 / dynamics.input_scale;
    assert!((moving[0] - direct).abs() < 1e-12 && moving[1] != moving[0], "{moving:?} {direct}");
}

#[test]
fn parameters_that_are_listed_are_those_that_are_free() {
    for (form, modes) in
        [(DynamicsForm::Oscillator, 1), (DynamicsForm::Oscillator, 2), (DynamicsForm::StateSpace, 1)]
    {
        let listed = model(1, modes, 1, SHAPE, 0.5).parameters(form);
        assert_eq!(listed.len(), DynamicsLayout::new(form, modes, 1, SHAPE).count(), "{form:?} {modes}");
    }
}

/// The stops of an element are those of the networks.
#[test]
fn a_stop_deteriorates_as_the_operator_does() {
    use crate::operator::{DeterioratingStop, Operator};
    let shape = ElementShape { stops: 2, states: 0, neurons: 1, deteriorates: true };
    let mut element = element(&mut UnitNumbers::new(3), shape, 1, 0.5);
    let capacity = 4.0;
    element.strength_losses = element.thresholds.iter().map(|r| 1.0 / (r * capacity)).collect();
    element.stop_velocities = vec![0.0, 0.4];
    let (mut point, mut step) = (element::PathPoint::virgin(&element), element::PathStep::new(&element));
    let stop = |i: usize| DeterioratingStop::new(element.thresholds[i], capacity).unwrap();
    let (mut plain, mut of_rate) = (stop(0), stop(1));
    plain.step(0.0);
    of_rate.step(0.0);
    let mut numbers = UnitNumbers::new(4);
    for _ in 0..40 {
        let (displacement, velocity) = (numbers.next(), numbers.next());
        step.take::<pulp::Scalar>(&element, &point, displacement, velocity);
        point.copy_from(&step.end);
        let expected = [plain.step(displacement), of_rate.step(displacement + 0.4 * velocity)];
        assert!((0..2).all(|i| (point.inputs[3 + i] - expected[i]).abs() < 1e-12), "{expected:?}");
    }
    assert!(plain.is_dead() || of_rate.is_dead());
}

#[test]
fn an_element_of_deteriorating_stops_is_odd() {
    let shape = ElementShape { states: 0, ..SHAPE };
    let mut dynamics = model(6, 1, 1, shape, 0.7);
    dynamics.output_offset = 0.0;
    let there = samples(&drive(2, 60, 0.1));
    let back: Vec<Sample> = there.iter().map(|sample| Sample { x: -sample.x, ..*sample }).collect();
    let opposite = outputs(&dynamics, &back);
    assert!(outputs(&dynamics, &there).iter().zip(opposite).all(|(a, b)| (a + b).abs() < 1e-9));
}

/// `exp(ln x)` is not always `x`.
#[test]
fn parameters_at_their_bounds_are_accepted() {
    let layout = DynamicsLayout::new(DynamicsForm::StateSpace, 1, 1, SHAPE);
    let mut sound = model(1, 1, 1, SHAPE, 0.5);
    sound.output_offset = 0.0;
    for damping in [DAMPING_RATIOS.0, DAMPING_RATIOS.1] {
        sound.modes[0].damping = damping;
        sound.elements[0].thresholds.fill(LARGEST_WEIGHT);
        sound.elements[0].path_leaks.fill(LARGEST_WEIGHT);
        let parameters = layout.parameters(&sound);
        layout.dynamics(&parameters, &sound).check("test").unwrap();
    }
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let sound = model(1, 2, 1, SHAPE, 0.5);
    assert!(sound.check("test").is_ok());
    type Change = fn(&mut Dynamics);
    let broken: [(&str, Change); 8] = [
        ("have a constant", |d| d.elements[0].layer[2] = 0.1),
        ("not positive", |d| d.longest_step = 0.0),
        ("or none", |d| d.modes.clear()),
        ("go together", |d| d.elements[0].force.truncate(3)),
        ("go together", |d| d.elements[0].compliances.clear()),
        ("ζ_1", |d| d.modes[0].damping = -0.1),
        ("ω_2", |d| d.modes[1].frequency = f64::NAN),
        ("γ_1,1", |d| d.elements[0].path_leaks[0] = 0.0),
    ];
    for (words, change) in broken {
        let mut changed = sound.clone();
        change(&mut changed);
        let error = changed.check("test").unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
