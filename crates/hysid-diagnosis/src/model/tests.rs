//! Models of known weights, and closed forms.

mod invertibility;

use super::*;
use hysid_core::data::rate::RateMethod;
use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::ln;
use hysid_core::law::bouc_wen::{BoucWen, Degradation};
use hysid_core::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use hysid_core::law::rate_dependent_prandtl_ishlinskii::{
    PlayWeights, RateDependentPrandtlIshlinskii, Thresholds,
};
use hysid_core::model::input_transform::InputTransform;
use hysid_core::model::{Predictor, ProvenanceDraft};
use hysid_core::network::scaling::Scaling;
use hysid_core::network::{Architecture, Family, Network, Sizes};
use hysid_core::options::FitSpec;
use hysid_core::options::classical::{ClassicalModel, ClassicalOptions};
use hysid_core::options::network::FitOptions;
use hysid_core::termination::Termination;

/// Largest input and rate of the models here, in the user's units.
const X: f64 = 3.0;
const RATE: f64 = 6.0;

/// A model that was never trained, with the ranges of a triangle from `-X` to `X`.
fn model(body: Predictor, request: FitSpec, rate: Option<RateMethod>) -> Model {
    let x: Vec<f64> = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0].map(|x| X * x).into();
    let time = (0..x.len()).map(|k| k as f64 * X / RATE).collect();
    let record = Record::new("r", vec![x.clone()], x).unwrap().with_time(time).unwrap();
    let data = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
    let found = ProvenanceDraft::of(request, Termination::Converged);
    Model::new(body, InputTransform::default(), rate, &data, found).unwrap()
}

fn network(architecture: Architecture, parameters: Vec<f64>, output: Vec<f64>) -> Model {
    let rate = architecture.rate.then_some(RateMethod::Central);
    let scaling =
        Scaling { inputs: vec![X], rate: rate.map(|_| RATE), output_mean: 10.0, output_deviation: 2.0 };
    let network = Network::new(architecture, parameters, output).unwrap();
    let request = FitSpec::Network(FitOptions { model: Family::Xpnn, ..FitOptions::default() });
    model(Predictor::Network { network, scaling }, request, rate)
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
            let width = diagnosis.loop_widths.static_width.unwrap();
            assert!((width - exact).abs() < 1e-9 * X, "{w}: {width}, not {exact}");
            assert!(diagnosis.loop_widths.dynamic.is_empty());
            let loops = if w.abs() > 1.0 { Verdict::Yes } else { Verdict::No };
            assert_eq!(diagnosis.verdict(Property::StaticHysteresis), loops);
            // theory.md (1.7), from v to x and from ε to y.
            let probe = Probe::new(&model).unwrap();
            let loops = probe.run_slowly("loops", &probe.path(&properties::WHOLE_LOOPS).x).unwrap();
            let data = probe::data(vec![loops]).unwrap();
            let energy = super::super::cycles::cycles(&properties::survey(&data)).last().unwrap().energy;
            let area = 4.0 * (w.abs() - 1.0).max(0.0) * (2.0 * c * X / w);
            assert!((energy - area).abs() < 1e-3 * X, "{w}: {energy}, not {area}");
        }
    }
}

/// A triangle of the speed `q` of the fastest shifts the stop's argument by `d = w_d q` there and back:
/// `width = 2 (w - 1 + 2 d) X/w` with slip, `2 d X/w` without, as long as the jump at the turning point does not
/// pass the middle. Backwards, for `d < 0`, it slips at the turning points and the loop is as wide as at rest.
#[test]
fn one_stop_with_rate_widens_by_the_closed_form() {
    for (w, w_rate) in [(1.42, 0.3), (1.42, -0.1), (0.5, 0.2), (3.0, 0.45)] {
        let model = stops(true, vec![w, w_rate], vec![], vec![0.0, 2.0]);
        let diagnosis = ModelDiagnosis::of(&model).unwrap();
        let widths = &diagnosis.loop_widths;
        assert!((widths.static_width.unwrap() - (2.0 * X * (1.0 - 1.0 / w)).max(0.0)).abs() < 2e-5 * X);
        assert_eq!(widths.dynamic.len(), 4);
        assert!((widths.dynamic[3].speed - RATE).abs() < 1e-12);
        for at in &widths.dynamic {
            let d: f64 = w_rate * at.speed / RATE;
            let exact =
                if w + d > 1.0 { 2.0 * (w - 1.0 + 2.0 * d.max(0.0)) * X / w } else { 2.0 * d * X / w };
            assert!(
                (at.width.unwrap() - exact).abs() < 2e-5 * X,
                "{w} {w_rate} at {}: {:?}, not {exact}",
                at.speed,
                at.width
            );
            assert_eq!(at.widening.unwrap(), at.width.unwrap() - widths.static_width.unwrap());
        }
        assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    }
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
    use Verdict::*;
    let agreement = |diagnosis: &ModelDiagnosis, expected: [Verdict; 3]| {
        assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::Yes);
        let properties = [Property::Congruency, Property::Masing, Property::OddSymmetry];
        assert_eq!(properties.map(|property| diagnosis.verdict(property)), expected);
        assert!(diagnosis.promises.iter().all(|promise| promise.agrees == Some(true)));
    };
    agreement(&ModelDiagnosis::of(&of(1.0, 0.0)).unwrap(), [No, No, Yes]);
    agreement(&ModelDiagnosis::of(&of(1.0, 0.7)).unwrap(), [No, No, No]);
    agreement(&ModelDiagnosis::of(&of(0.02, 0.0)).unwrap(), [Yes, Yes, Yes]);
}

fn law(law: impl Into<hysid_core::law::Classical>, rival: ClassicalModel, rate: bool) -> ModelDiagnosis {
    let request = FitSpec::Classical(ClassicalOptions::of(rival));
    let model = model(Predictor::Law(law.into()), request, rate.then_some(RateMethod::Central));
    let diagnosis = ModelDiagnosis::of(&model).unwrap();
    assert!(
        diagnosis.promises.iter().all(|promise| promise.agrees != Some(false)),
        "{:?}",
        diagnosis.promises
    );
    diagnosis
}

/// Bouc-Wen's element drifts where its input does not reverse sign: no return-point memory.
#[test]
fn bouc_wen_does_not_wipe_out() {
    let plain = BoucWen { n: 1.5, ..BoucWen::new(0.1, 1.0, 0.8).unwrap() };
    let diagnosis = law(plain, ClassicalModel::BoucWen, false);
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::OddSymmetry), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::Deterioration), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::Orientation), Verdict::Yes);
    let weakening = Degradation::from_values([0.0, 0.02, 0.0, 0.0, 1.0, 0.0, 0.1, 0.0, 0.1]);
    let diagnosis = law(BoucWen { degradation: Some(weakening), ..plain }, ClassicalModel::BoucWen, false);
    assert_eq!(diagnosis.verdict(Property::Deterioration), Verdict::Yes);
}

/// Jiles and Atherton's small loops drift, theory.md (8.22).
#[test]
fn jiles_atherton_does_not_wipe_out() {
    let magnet = JilesAtherton {
        offset: 0.0,
        permeability: 0.0,
        saturation: 1.0,
        a: 0.2,
        k: 0.4,
        alpha: 0.3,
        c: 0.1,
        form: JilesAthertonForm::Original,
    };
    let diagnosis = law(magnet, ClassicalModel::JilesAtherton, false);
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::Orientation), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::Saturation), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::OddSymmetry), Verdict::Yes);
}

/// A damper beside a spring: a loop of width `2 c v/k` that vanishes with the speed.
#[test]
fn a_damper_has_a_dynamic_loop_only() {
    let damper = BoucWen { damping: 0.2, ..BoucWen::new(1.5, 0.0, 1.0).unwrap() };
    let diagnosis = law(damper, ClassicalModel::BoucWen, true);
    let widths = &diagnosis.loop_widths;
    assert!(widths.static_width.unwrap().abs() < 1e-5);
    for at in &widths.dynamic {
        let exact = 2.0 * 0.2 * at.speed / 1.5;
        assert!((at.widening.unwrap() - exact).abs() < 1e-5 * X, "{at:?}, not {exact}");
    }
    assert_eq!(diagnosis.verdict(Property::StaticHysteresis), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::Yes);
}

/// One play of threshold `α + β v`: a loop twice as wide, passed the way of a lag.
#[test]
fn a_rate_dependent_play_widens_by_twice_its_threshold() {
    let (alpha, beta) = (0.4, 0.05);
    let play = RateDependentPrandtlIshlinskii {
        offset: 1.0,
        spring: 0.0,
        spacing: alpha,
        thresholds: Thresholds::Linear { beta },
        weights: PlayWeights::Free(vec![2.0]),
    };
    let diagnosis = law(play, ClassicalModel::RateDependentPrandtlIshlinskii, true);
    let widths = &diagnosis.loop_widths;
    assert!((widths.static_width.unwrap() - 2.0 * alpha).abs() < 1e-5);
    for at in &widths.dynamic {
        assert!((at.widening.unwrap() - 2.0 * beta * at.speed).abs() < 1e-5, "{at:?}");
    }
    assert_eq!(diagnosis.verdict(Property::Orientation), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::Congruency), Verdict::Yes);
    assert_eq!(diagnosis.verdict(Property::Masing), Verdict::Yes);
}

/// Relaxation neurons alone: no static loop, and a time scale of their own.
#[test]
fn a_relaxing_network_is_driven_at_its_own_times() {
    let sizes = Sizes { stops: 1, hidden: 1, relaxation: 1 };
    let architecture = Architecture::new(Family::XpnnPlus, sizes, 1, false, true).unwrap();
    // Stop, its ln β, linear neuron, ln τ, then a tanh neuron that sees nothing.
    let parameters = vec![0.3, 10.0, 1.0, ln(0.05), 0.0, 0.0, 0.0, 0.0];
    // Constant, tanh neuron, then straight: linear neuron, stop, relaxation.
    let model = network(architecture, parameters, vec![0.0, 0.0, 1.0, 0.0, 0.8]);
    let diagnosis = ModelDiagnosis::of(&model).unwrap();
    assert_eq!(diagnosis.probing.time_scale, TimeScale::RelaxationTimes);
    assert_eq!(diagnosis.verdict(Property::StaticHysteresis), Verdict::No);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    assert!(diagnosis.loop_widths.static_width.unwrap().abs() < 1e-4 * X);
    assert!(diagnosis.loop_widths.dynamic[2].widening.unwrap().abs() > 0.05 * X);
    // Without the spring beside it nothing is left to test at a vanishing speed.
    let parameters = model.network().unwrap().parameters().to_vec();
    let diagnosis =
        ModelDiagnosis::of(&network(architecture, parameters, vec![0.0, 0.0, 0.0, 0.0, 0.8])).unwrap();
    assert_eq!(diagnosis.verdict(Property::WipingOut), Verdict::NotTestable);
    assert_eq!(diagnosis.verdict(Property::RateDependence), Verdict::Yes);
    // A spring behind a dashpot takes up energy.
    assert_eq!(diagnosis.verdict(Property::Orientation), Verdict::Yes);
}

#[test]
fn a_model_that_answers_nothing_is_refused() {
    let model = stops(false, vec![1.5], vec![], vec![0.3, 0.0]);
    let error = ModelDiagnosis::of(&model).unwrap_err().to_string();
    assert!(error.contains("constant"), "{error}");
}

/// A pinning of a millionth of the range needs the most parts of every step: it took minutes.
#[test]
fn a_model_whose_rows_need_much_work_is_probed_with_fewer() {
    let law = |k: f64| JilesAtherton {
        offset: 0.0,
        permeability: 1.5,
        saturation: 2.0,
        a: 1.0,
        k,
        alpha: 0.25,
        c: 0.2,
        form: JilesAthertonForm::Original,
    };
    let request = || FitSpec::Classical(ClassicalOptions::of(ClassicalModel::JilesAtherton));
    let of = |k: f64| model(Predictor::Law(law(k).into()), request(), None);
    assert_eq!(Probe::new(&of(0.5)).unwrap().steps, probe::STEPS);
    let heavy = of(1e-6);
    let few = Probe::new(&heavy).unwrap();
    assert!(few.steps < probe::STEPS / 2, "{}", few.steps);
    let words = few.description().rows_in_words().unwrap();
    assert!(words.starts_with(&format!("{} in half the range instead of 160", few.steps)), "{words}");
    let diagnosis = ModelDiagnosis::of(&heavy).unwrap();
    assert!(diagnosis.invertibility.scans < 100, "{}", diagnosis.invertibility.scans);
}

/// Plays follow the largest oscillation that they feel and end above and below the input by the same: the anhysteretic curve of
/// a Prandtl-Ishlinskii model is its straight line `c + (w_0 + Σ w_i) x`, and the initial one `c + w_0 x + Σ w_i max(x - r_i, 0)`.
#[test]
fn initial_and_anhysteretic_curve_of_plays_are_their_closed_forms() {
    use hysid_core::law::Classical;
    use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;

    let (c, w0, thresholds, weights) = (0.3, 0.5, [0.4, 1.0], [0.8, 0.6]);
    let law = PrandtlIshlinskii::new(c, w0, thresholds.into(), weights.into()).unwrap();
    let request = FitSpec::Classical(ClassicalOptions::of(ClassicalModel::PrandtlIshlinskii));
    let body = Predictor::Law(Classical::PrandtlIshlinskii(law));
    let x: Vec<f64> = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0].map(|x| X * x).into();
    let record = Record::new("r", vec![x.clone()], x).unwrap();
    let data = Dataset::new(ColumnNames::of(None, &["H_A_per_m"], "B_T"), vec![record]).unwrap();
    let found = ProvenanceDraft::of(request, Termination::Converged);
    let magnet = Model::new(body, InputTransform::default(), None, &data, found).unwrap();
    let cycles = ModelCycles::of(&magnet, &crate::cycles::CycleOptions::default(), None).unwrap();
    assert_eq!(cycles.magnetisation.len(), 41);
    for node in &cycles.magnetisation {
        let x = node.input;
        let plays = thresholds.iter().zip(weights);
        let initial: f64 = plays.map(|(r, w)| w * (x.abs() - r).max(0.0) * x.signum()).sum();
        assert!((node.initial - (c + w0 * x + initial)).abs() < 1e-12, "{node:?}");
        // At the ends of the range, oscillations are cut off on one side.
        if x.abs() <= X - 1.0 - X / 40.0 {
            let line = c + (w0 + weights.iter().sum::<f64>()) * x;
            assert!((node.anhysteretic - line).abs() < 0.02 * X, "{node:?} {line}");
        }
    }
}
