//! Models of known weights: closed forms, and what each neuron is.

use super::*;
use crate::classical::identification::{ClassicalOptions, Rival};
use crate::classical::{Classical, bouc_wen::BoucWen};
use crate::identification::Request;
use crate::metrics::Errors;
use crate::model::{Body, Provenance};
use crate::network::{Architecture, Family, Network, Sizes};
use crate::rate::RateMethod;
use crate::record::{ColumnNames, Dataset, Record};
use crate::scaling::Scaling;
use crate::training::{FitOptions, Termination};

/// Largest input and rate of the models here, in the user's units.
const X: f64 = 3.0;
const RATE: f64 = 6.0;

/// A model that was never trained, with the ranges of a triangle from `-X` to `X`.
fn model(body: Body, request: Request, rate: Option<RateMethod>) -> Model {
    let x: Vec<f64> = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0].map(|x| X * x).into();
    let time = (0..x.len()).map(|k| k as f64 * X / RATE).collect();
    let record = Record::new("r", vec![x.clone()], x).unwrap().with_time(time).unwrap();
    let data = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
    let train = Errors {
        output: "y".into(),
        samples: 0,
        records: 0,
        mse: 0.0,
        rmse: 0.0,
        nrmse_std_percent: None,
        nrmse_range_percent: None,
        fit_percent: None,
        max_abs_error: 0.0,
    };
    let provenance = Provenance {
        options: request,
        samples: 0,
        records: 1,
        chosen_start: 0,
        termination: Termination::Converged,
        train,
        validation: None,
        runs: Vec::new(),
    };
    Model::new(body, rate, &data, provenance).unwrap()
}

fn network(architecture: Architecture, parameters: Vec<f64>, output: Vec<f64>) -> Model {
    let rate = architecture.rate.then_some(RateMethod::Central);
    let scaling = Scaling {
        inputs: vec![X],
        rate: rate.map(|_| RATE),
        output_mean: 10.0,
        output_deviation: 2.0,
    };
    let network = Network::new(architecture, parameters, output).unwrap();
    let request = Request::Network(FitOptions { model: Family::Xpnn, ..FitOptions::default() });
    model(Body::Network { network, scaling }, request, rate)
}

/// Stops that go straight to the output.
fn stops(rate: bool, weights: Vec<f64>, ln_beta: Vec<f64>, output: Vec<f64>) -> Model {
    let sizes = Sizes { stops: output.len() - 1, hidden: 0, relaxation: 0 };
    let mut architecture = Architecture::new(Family::Gpnn, sizes, 1, false, true).unwrap();
    architecture.rate = rate;
    architecture.deterioration = !ln_beta.is_empty();
    network(architecture, [weights, ln_beta].concat(), output)
}

/// `K = 2 (X - 1/|w|)` where that is positive, else 0: the loop is a parallelogram with that width.
#[test]
fn one_stop_has_the_width_of_its_parallelogram() {
    for w in [-3.2, -1.6, -0.9, 0.4, 1.0, 1.42, 5.0, 40.0] {
        for c in [-1.5, 0.7] {
            let model = stops(false, vec![w], vec![], vec![0.3, c]);
            let diagnosis = ModelDiagnosis::of(&model).unwrap();
            // The weight is of the input over X.
            let exact = (2.0 * X * (1.0 - 1.0 / f64::abs(w))).max(0.0);
            let width = diagnosis.loop_widths.static_width;
            assert!((width - exact).abs() < 1e-9 * X, "{w}: {width}, not {exact}");
            assert!(diagnosis.loop_widths.dynamic.is_empty());
            let criterion = &diagnosis.weights.as_ref().unwrap().criteria[0];
            assert_eq!(criterion.value, 2.0 * f64::abs(w));
            let loops = if w.abs() > 1.0 { Verdict::Yes } else { Verdict::No };
            assert_eq!((criterion.verdict, diagnosis.verdict(Property::StaticHysteresis)), (loops, loops));
            assert_eq!(criterion.agrees, Some(true));
        }
    }
}

/// A triangle of the speed `q` of the fastest shifts the stop's argument by `d = w_d q` there and back:
/// `width = 2 (w - 1 + 2 d) X/w` with slip, `2 d X/w` without, as long as the jump at the turning point does not
/// pass the middle.
#[test]
fn one_stop_with_rate_widens_by_the_closed_form() {
    for (w, w_rate) in [(1.42, 0.3), (1.42, -0.1), (0.5, 0.2), (3.0, 0.45)] {
        let model = stops(true, vec![w, w_rate], vec![], vec![0.0, 2.0]);
        let diagnosis = ModelDiagnosis::of(&model).unwrap();
        let widths = &diagnosis.loop_widths;
        assert!((widths.static_width - (2.0 * X * (1.0 - 1.0 / w)).max(0.0)).abs() < 1e-4);
        assert_eq!(widths.dynamic.len(), 4);
        assert!((widths.dynamic[3].speed - RATE).abs() < 1e-12);
        for at in &widths.dynamic {
            let d: f64 = w_rate * at.speed / RATE;
            let exact = if w + d > 1.0 { 2.0 * (w - 1.0 + 2.0 * d) * X / w } else { 2.0 * d * X / w };
            assert!((at.width - exact).abs() < 1e-4, "{w} {w_rate} at {}: {}, not {exact}", at.speed, at.width);
            assert_eq!(at.widening, at.width - widths.static_width);
        }
        assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
        let kinds = &diagnosis.weights.as_ref().unwrap().neurons[0].kinds;
        assert!(kinds.contains(&NeuronKind::Dynamic), "{kinds:?}");
        assert_eq!(kinds.contains(&NeuronKind::Static), w > 1.0);
    }
}

#[test]
fn neurons_are_what_their_weights_make_them() {
    let never = 1e7f64.ln();
    let weights = [[2.0, 0.0], [0.8, 0.0], [0.5, 1.5], [3.0, 0.5], [2.5, 0.0], [6.0, 0.0], [2.2, 0.0]];
    let ln_beta = vec![never, never, never, never, 60f64.ln(), 1f64.ln(), never];
    let output = vec![0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e-5];
    let model = stops(true, weights.concat(), ln_beta, output);
    let diagnosis = ModelDiagnosis::of(&model).unwrap();
    let weights = diagnosis.weights.as_ref().unwrap();
    use NeuronKind::*;
    let expected: [&[NeuronKind]; 7] = [
        &[Static],
        &[NeverSlips],
        &[Dynamic],
        &[Static, Dynamic],
        &[Static, Deteriorating],
        &[DiesAtOnce],
        &[Static, Idle],
    ];
    for (neuron, expected) in weights.neurons.iter().zip(expected) {
        assert_eq!(neuron.kinds, expected, "{neuron:?}");
    }
    // 25 loops and the first quarter, theory.md (1.8): (w - 1) + 2 (w - 1) for each half of a loop but the first.
    let slip = 1.5 + 49.0 * 2.0 * 1.5;
    assert!((weights.neurons[4].wear.unwrap() - slip / 60.0).abs() < 1e-9);
    assert_eq!(diagnosis.verdict(Property::Deterioration), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::No);
    assert!(!diagnosis.memory.return_point_memory.holds);
    assert_eq!(diagnosis.verdict(Property::OddSymmetry), Verdict::Yes);
}

/// A readout that bends the sum of its stops is neither congruent nor Masing, and wipes out all the same.
#[test]
fn a_mixing_readout_is_not_congruent() {
    let sizes = Sizes { stops: 2, hidden: 1, relaxation: 0 };
    let architecture = Architecture::new(Family::PreisachNn, sizes, 1, false, true).unwrap();
    let of = |gain: f64, bias: f64| {
        // Stops, linear neuron, then bias and weights of linear neuron and stops.
        let parameters = vec![1.3, 6.0, 1.0, bias, 0.1 * gain, gain, gain];
        network(architecture, parameters, vec![0.0, 1.0 / gain])
    };
    let agreement = |diagnosis: &ModelDiagnosis, expected: [Verdict; 3]| {
        assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::Yes);
        let properties = [Property::Congruency, Property::Masing, Property::OddSymmetry];
        assert_eq!(properties.map(|property| diagnosis.verdict(property)), expected);
        for criterion in &diagnosis.weights.as_ref().unwrap().criteria {
            assert_eq!(criterion.agrees, Some(true), "{criterion:?}");
        }
        assert!(diagnosis.promises.iter().all(|promise| promise.agrees == Some(true)));
    };
    use Verdict::*;
    agreement(&ModelDiagnosis::of(&of(1.0, 0.0)).unwrap(), [No, No, Yes]);
    agreement(&ModelDiagnosis::of(&of(1.0, 0.7)).unwrap(), [No, No, No]);
    agreement(&ModelDiagnosis::of(&of(0.02, 0.0)).unwrap(), [Yes, Yes, Yes]);
}

/// Bouc-Wen's element drifts where its input does not reverse sign: no return-point memory.
#[test]
fn bouc_wen_does_not_wipe_out() {
    let law = BoucWen { n: 1.5, ..BoucWen::new(0.1, 1.0, 0.8).unwrap() };
    let request = Request::Classical(ClassicalOptions::of(Rival::BoucWen));
    let diagnosis = ModelDiagnosis::of(&model(Body::Law(Classical::from(law)), request, None)).unwrap();
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::OddSymmetry), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::Deterioration), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::Orientation), Verdict::Yes);
    assert_eq!(diagnosis.memory.return_point_memory.basis, Basis::Probing);
}
