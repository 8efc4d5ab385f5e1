//! Responses of models whose law is known.

use hysid_core::elementary::{cos, hypot};
use hysid_core::law::hysteretic_dynamics::{Dynamics, Element, Hold, Mode};
use hysid_core::law::hysteretic_oscillator::HystereticOscillator;
use hysid_core::law::{Classical, Law};
use hysid_core::model::{Model, Predictor, ProvenanceDraft};
use hysid_core::options::FitSpec;
use hysid_core::options::classical::{ClassicalModel, ClassicalOptions};
use hysid_core::termination::Termination;

use super::*;

/// The oscillator of the other tests as a model.
fn linear() -> Dynamics {
    Dynamics {
        input_scale: 1.0,
        output_offset: 1.5,
        output_scale: 1.0,
        direct: 0.2,
        hold: Hold::Linear,
        longest_step: STEP / 2.0,
        begins_under_input: true,
        modes: vec![Mode { frequency: TAU * 20.0, damping: 0.04, gain: 3.0, velocity_in_output: 0.0 }],
        elements: Vec::new(),
    }
}

fn model(dynamics: Dynamics, data: &Dataset) -> Model {
    let law = HystereticOscillator(dynamics).validated().unwrap();
    let options = ClassicalOptions::of(ClassicalModel::HystereticOscillator);
    let found = ProvenanceDraft::of(FitSpec::Classical(options), Termination::Converged);
    let body = Predictor::Law(Classical::HystereticOscillator(law));
    Model::new(body, Default::default(), None, data, found).unwrap()
}

fn responses(model: &Model, data: &Dataset) -> ModelResponses {
    let simulated: Vec<Vec<f64>> =
        data.records().iter().map(|record| model.simulate(record).unwrap()).collect();
    ModelResponses::of(model, data, &simulated).unwrap().unwrap()
}

#[test]
fn a_linear_model_has_one_response() {
    let data = dataset(vec![moved(&multisine(4000))]);
    let found = responses(&model(linear(), &data), &data);
    let (oscillator, closed) = found.oscillator.as_ref().unwrap();
    assert!((oscillator.natural_frequency - 20.0).abs() < 0.01, "{oscillator:?}");
    assert_eq!(closed.points.len(), found.measured.points.len());
    let deviations: Vec<f64> = found.model.iter().map(|at| at.input_deviation).collect();
    // 157 cosines of amplitude 1.
    let exact_deviation = (157.0_f64 / 2.0).sqrt();
    for (at, factor) in deviations.iter().zip([1.0, 0.3, 0.1]) {
        assert!((at / (factor * exact_deviation) - 1.0).abs() < 1e-6, "{deviations:?}");
    }
    for AtAmplitude { factor, response, .. } in &found.model {
        assert_eq!(response.points.len(), found.measured.points.len());
        for (point, measured) in response.points.iter().zip(&found.measured.points) {
            // The model is what was measured; the transient of the first period differs with the amplitude only in size.
            let distance = hypot(point.real - measured.real, point.imaginary - measured.imaginary);
            assert!(distance < 1e-6 * measured.magnitude().max(0.01), "{factor} {point:?} {measured:?}");
        }
    }
}

/// A spring in series with a slider: it is a spring under small inputs, and slides under large ones.
#[test]
fn a_slider_moves_the_resonance_with_the_amplitude() {
    let (share, input) = (0.5, multisine(4000));
    let element = Element {
        of_displacements: vec![1.0],
        of_velocities: vec![0.0],
        of_input: 0.0,
        compliances: vec![1.0],
        in_output: 0.0,
        thresholds: vec![20.0],
        layer: vec![0.0; 4],
        stop_velocities: vec![0.0],
        strength_losses: Vec::new(),
        rising: Vec::new(),
        falling: Vec::new(),
        path_leaks: Vec::new(),
        initial: Vec::new(),
        force: vec![share, 0.0],
    };
    let soft = Dynamics { elements: vec![element], direct: 0.0, longest_step: STEP / 16.0, ..linear() };
    let data = dataset(vec![moved(&input)]);
    let found = responses(&model(soft, &data), &data);
    let [large, middle, small] =
        [0, 1, 2].map(|k| found.model[k].response.peak(ComparedSignal::Output).unwrap());
    // With the spring the square of the frequency is 1.5 times as large: 24.5 Hz. Its lines are 0.5 Hz apart.
    let root = (1.0 + share).sqrt();
    let stiff = LinearOscillator {
        natural_frequency: 20.0 * root,
        damping_ratio: 0.04 / root,
        gain: 3.0 / (1.0 + share),
        direct: 0.0,
        ..oscillator()
    };
    let frequencies = found.model[2].response.points.iter().map(|point| point.frequency);
    let closed = FrequencyResponse::of_oscillator(&stiff, frequencies);
    assert_eq!(small.frequency, closed.peak(ComparedSignal::Output).unwrap().frequency);
    // A force that is a straight line over each row is weaker by 1.6 % at 35 Hz.
    let below = |point: &&ResponsePoint| point.frequency < 35.0;
    for (a, b) in found.model[2].response.points.iter().filter(below).zip(&closed.points) {
        assert!(hypot(a.real - b.real, a.imaginary - b.imaginary) < 0.02 * b.magnitude(), "{a:?} {b:?}");
    }
    assert!(small.coherence.unwrap() > 1.0 - 1e-5, "{small:?}");
    // Sliding softens it and takes energy.
    assert!(
        large.frequency < middle.frequency && middle.frequency <= small.frequency,
        "{large:?} {middle:?}"
    );
    assert!(large.magnitude() < 0.9 * small.magnitude(), "{large:?}");
}

/// A bias that is raised from zero in the record is raised in the runs with smaller amplitudes too: a jump to it would leave
/// a motion that is no response to the input.
#[test]
fn a_bias_is_raised_smoothly() {
    let rise = |row: usize| 0.5 - 0.5 * cos(std::f64::consts::PI * (row as f64 / 800.0).min(1.0));
    let input: Vec<f64> =
        coloured(8000, 8).iter().enumerate().map(|(row, x)| rise(row) * (20.0 + x)).collect();
    let data = dataset(vec![moved(&input)]);
    let found = responses(&model(Dynamics { begins_under_input: false, ..linear() }, &data), &data);
    for AtAmplitude { factor, response, .. } in &found.model {
        let mut compared = 0;
        for point in response.points.iter().filter(|point| (15.0..40.0).contains(&point.frequency)) {
            let (magnitude, _) = exact(point.frequency);
            assert!((point.magnitude() / magnitude - 1.0).abs() < 0.1, "{factor} {point:?} {magnitude}");
            compared += 1;
        }
        assert!(compared > 20, "{factor}: {compared}");
    }
}
