//! The diagnosis of models against what their equations guarantee.

use crate::scaffold::*;
use hysid::diagnosis::model::TimeScale;
use hysid::diagnosis::{ModelDiagnosis, Property, Verdict};
use hysid::operator::Stop;
use hysid_core::elementary::sin;

fn data() -> Dataset {
    Dataset::new(ColumnNames::plain(1), vec![record(180, "a"), record(120, "b")]).unwrap()
}

fn fitted(name: ModelName) -> Model {
    let data = if leads(name) { leading() } else { data() };
    fitted_to(&data, name, Some(RateMethod::Central))
}

/// True for a law whose output leads its input, as a force leads the displacement.
fn leads(name: ModelName) -> bool {
    name.name() == "ramberg-osgood"
}

fn leading() -> Dataset {
    let with_force = |record: &Record| {
        let x = &record.inputs()[0];
        let force = Stop::new(0.5).unwrap().run(x).iter().zip(x).map(|(stop, x)| stop + 0.2 * x).collect();
        record.clone().with_output(force).unwrap()
    };
    Dataset::new(ColumnNames::plain(1), data().records().iter().map(with_force).collect()).unwrap()
}

fn fitted_to(data: &Dataset, name: ModelName, rate: Option<RateMethod>) -> Model {
    model_of(data, &small(name, rate))
}

use Property::*;

/// Properties that theory guarantees for each model whatever its parameters: those it has and those it has not.
fn guaranteed(name: &str) -> (&'static [Property], &'static [Property]) {
    match name {
        "pnn" | "masing" | "prandtl-ishlinskii" | "ramberg-osgood" => {
            (&[WipingOut, Congruency, Masing, OddSymmetry, LoopClosure], &[RateDependence, Deterioration])
        }
        "preisach" | "generalized-prandtl-ishlinskii" => {
            (&[WipingOut, Congruency, LoopClosure], &[RateDependence, Deterioration])
        }
        "preisach-nn" | "modified-prandtl-ishlinskii" => {
            (&[WipingOut, LoopClosure], &[RateDependence, Deterioration])
        }
        "gpnn" => (&[OddSymmetry], &[RateDependence]),
        "jiles-atherton" => (&[OddSymmetry], &[RateDependence, Deterioration]),
        // At a vanishing speed.
        "dynamic-prandtl-ishlinskii" => (&[WipingOut, Congruency, LoopClosure], &[Deterioration]),
        "rate-dependent-prandtl-ishlinskii" => {
            (&[WipingOut, Congruency, Masing, OddSymmetry, LoopClosure], &[Deterioration])
        }
        "bouc-wen" | "lugre" => (&[OddSymmetry], &[Deterioration]),
        "peak-oriented" | "menegotto-pinto" => (&[OddSymmetry], &[RateDependence]),
        "neuro-madelung" => (&[WipingOut], &[]),
        "xpnn" | "xpnn+" | "duhem-nn" | "random-stops" => (&[], &[]),
        "hysteretic-oscillator" | "hysteretic-state-space" => (&[], &[]),
        other => panic!("what theory says of {other} is missing here"),
    }
}

fn needs_time(name: ModelName) -> bool {
    matches!(name, ModelName::Classical(law) if law.needs_time())
}

#[test]
fn verdicts_of_all_models_are_those_that_theory_guarantees() {
    for name in ModelName::all() {
        let diagnosis = ModelDiagnosis::of(&fitted(name)).unwrap();
        let (has, has_not) = guaranteed(name.name());
        for (properties, expected) in [(has, Verdict::Yes), (has_not, Verdict::No)] {
            for &property in properties {
                let finding = diagnosis.finding(property);
                assert_eq!(finding.verdict, expected, "{}: {}", name.name(), finding.statement);
                let promise = diagnosis.promises.iter().find(|promise| promise.property == property);
                assert_eq!(promise.map(|promise| promise.agrees), Some(Some(true)), "{}", name.name());
            }
        }
        assert_eq!(diagnosis.promises.len(), has.len() + has_not.len(), "{}", name.name());
        match has_not.contains(&RateDependence) {
            true => {
                assert_eq!(diagnosis.finding(RateDependence).index, Some(0.0), "{}", name.name());
                assert!(diagnosis.loop_widths.dynamic.iter().all(|at| at.widening == Some(0.0)));
            }
            false => assert!(name.uses_rate() || needs_time(name), "{}", name.name()),
        }
        // The record has a loop that lags behind its input, of which an oscillator makes a vibration.
        if needs_time(name) {
            continue;
        }
        assert_eq!(diagnosis.verdict(StaticHysteresis), Verdict::Yes, "{}", name.name());
        let orientation = if leads(name) { Verdict::Yes } else { Verdict::No };
        assert_eq!(diagnosis.verdict(Orientation), orientation, "{}", name.name());
        assert_eq!(diagnosis.properties.iter().map(|f| f.property).collect::<Vec<_>>(), Property::ALL);
        serde_json::to_string(&diagnosis).unwrap();
    }
}

/// Further inputs are held in the middle of what was trained; a rate that has to be given is given.
#[test]
fn everything_that_a_model_asks_for_is_provided() {
    let one = record(180, "a");
    let temperature: Vec<f64> = (0..one.len()).map(|k| 20.0 + 10.0 * sin(0.03 * k as f64)).collect();
    let inputs = vec![one.inputs()[0].to_vec(), temperature.clone()];
    let time = one.time().unwrap().to_vec();
    let two = Record::new("two inputs", inputs, one.output().to_vec()).unwrap().with_time(time).unwrap();
    let two = Dataset::new(ColumnNames::plain(2), vec![two]).unwrap();
    let middle = {
        let (low, high) = two.input_range(1);
        0.5 * low + 0.5 * high
    };
    for name in ModelName::all().filter(|name| name.takes_further_inputs()) {
        let diagnosis = ModelDiagnosis::of(&fitted_to(&two, name, Some(RateMethod::Central))).unwrap();
        assert_eq!(diagnosis.probing.held, [middle], "{}", name.name());
    }
    let rate = RateMethod::Central.rate(&one).unwrap();
    let given = Record::new("given rate", vec![one.inputs()[0].to_vec()], one.output().to_vec()).unwrap();
    let names = ColumnNames { time: None, rate: Some("v".into()), ..ColumnNames::plain(1) };
    let given = Dataset::new(names, vec![given.with_given_rate(rate).unwrap()]).unwrap();
    let name = ModelName::Network(Family::Xpnn);
    let diagnosis = ModelDiagnosis::of(&fitted_to(&given, name, Some(RateMethod::Given))).unwrap();
    assert_eq!(diagnosis.probing.time_scale, TimeScale::TrainedRates);
    assert_eq!(diagnosis.loop_widths.dynamic.len(), 4);
}
