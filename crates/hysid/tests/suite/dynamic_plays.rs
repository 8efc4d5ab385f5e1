//! Dynamic Prandtl-Ishlinskii models are recovered from their own runs, and the default finds them.

use crate::scaffold::*;
use approx::assert_relative_eq;
use hysid::data::record::ColumnNames;
use hysid::law::dynamic_prandtl_ishlinskii::{DeadZone, DynamicPrandtlIshlinskii, Relaxation, Resonance};
use hysid::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid::law::series::{run, samples};
use hysid::{Dataset, Fit, Model, Record};
use hysid_core::elementary::{exp, sin};
use serde_json::json;

const STEP: f64 = 0.01;

/// Several sines whose amplitude grows and falls.
fn drive(rows: usize, phase: f64) -> Vec<f64> {
    let of = |t: f64| {
        let grown = 1.0 - 0.7 * sin(0.9 * t + phase).abs();
        (1.0 - exp(-3.0 * t))
            * grown
            * (40.0 * sin(4.3 * t + phase) + 30.0 * sin(15.0 * t) + 15.0 * sin(38.0 * t))
    };
    (0..rows).map(|row| of(STEP * row as f64)).collect()
}

/// A current in pulses, which charges and discharges.
fn pulses(rows: usize, phase: f64) -> Vec<f64> {
    let of = |t: f64| {
        let level = 2.0 * sin(0.9 * t + phase) + 1.5 * sin(3.7 * t) + sin(0.31 * t);
        if t == 0.0 { 0.0 } else { level.round() }
    };
    (0..rows).map(|row| of(STEP * row as f64)).collect()
}

fn data(law: &DynamicPrandtlIshlinskii, x: &[f64]) -> Dataset {
    let time: Vec<f64> = (0..x.len()).map(|row| STEP * row as f64).collect();
    let with_output =
        |y: Vec<f64>| Record::new("r", vec![x.to_vec()], y).unwrap().with_time(time.clone()).unwrap();
    let y = run(law, &samples(&with_output(x.to_vec()).excitation(), None).unwrap());
    Dataset::new(ColumnNames::plain(1), vec![with_output(y)]).unwrap()
}

/// Plays with thresholds among those of a fit to inputs of this range.
fn plays(range: f64) -> PrandtlIshlinskii {
    let thresholds = [1.0, 3.0, 5.0, 7.0].map(|place| place * range / 10.5).to_vec();
    PrandtlIshlinskii::new(0.3, 0.4, thresholds, vec![0.5, 0.3, 0.4, 0.2]).unwrap()
}

fn base(range: f64) -> DynamicPrandtlIshlinskii {
    DynamicPrandtlIshlinskii {
        lag: None,
        plays: plays(range),
        dead_zones: Vec::new(),
        relaxations: Vec::new(),
        resonance: None,
        direct: 0.0,
    }
}

fn range_of(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

fn relaxation(time_constant: f64, share: f64) -> Relaxation {
    Relaxation { time_constant, share, input_weight: 0.0 }
}

fn fitted(law: &DynamicPrandtlIshlinskii, x: &[f64], options: &[(&str, serde_json::Value)]) -> Model {
    let fit = Fit::new().model("dynamic-prandtl-ishlinskii");
    let fit = options.iter().fold(fit, |fit, (name, value)| fit.option(name, value.clone()));
    fit.run(&data(law, x)).unwrap()
}

fn parameter(model: &Model, symbol: &str) -> f64 {
    let law = model.law().expect("a classical law");
    let parameters = law.parameters();
    let found = parameters.iter().find(|parameter| parameter.symbol == symbol);
    found.unwrap_or_else(|| panic!("no {symbol}: {parameters:?}")).value
}

#[test]
fn creep_behind_plays_is_recovered_with_its_time_constants() {
    let law = DynamicPrandtlIshlinskii {
        relaxations: vec![relaxation(0.05, -0.3), relaxation(1.5, -0.4)],
        ..base(range_of(&drive(1500, 0.0)))
    };
    let model = fitted(&law, &drive(1500, 0.0), &[]);
    let mut found =
        [1, 2].map(|k| [parameter(&model, &format!("τ_{k}")), parameter(&model, &format!("b_{k}"))]);
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (found, expected) in found.iter().zip([[0.05, -0.3], [1.5, -0.4]]) {
        assert_relative_eq!(found[0], expected[0], max_relative = 0.01);
        assert_relative_eq!(found[1], expected[1], max_relative = 0.01);
    }
    let unseen = error_percent(&model, &data(&law, &drive(900, 1.0)));
    assert!(unseen < 0.1, "{unseen}");
}

#[test]
fn a_resonance_behind_plays_is_recovered() {
    let resonance = Some(Resonance { frequency: 60.0, damping: 0.2 });
    let law = DynamicPrandtlIshlinskii { resonance, ..base(range_of(&drive(1500, 0.0))) };
    let model = fitted(&law, &drive(1500, 0.0), &[("resonance", json!(true))]);
    assert_relative_eq!(parameter(&model, "ω"), 60.0, max_relative = 0.01);
    assert_relative_eq!(parameter(&model, "ζ"), 0.2, max_relative = 0.01);
    let unseen = error_percent(&model, &data(&law, &drive(900, 1.0)));
    assert!(unseen < 0.1, "{unseen}");
}

/// The voltage of a cell: a curve and hysteresis of the charge, the integral of the current, and relaxation of the
/// current beside them.
#[test]
fn a_cell_is_fitted_with_its_charge_and_the_relaxation_beside_it_by_itself_and_by_default() {
    let part = |time_constant, input_weight| Relaxation { time_constant, share: 0.0, input_weight };
    let charge = DynamicPrandtlIshlinskii {
        lag: Some(800.0),
        plays: PrandtlIshlinskii::new(0.0, 1.0, vec![], vec![]).unwrap(),
        ..base(1.0)
    };
    let range = range_of(data(&charge, &pulses(1500, 0.0)).records()[0].output());
    let law = DynamicPrandtlIshlinskii {
        plays: plays(range),
        dead_zones: vec![DeadZone { threshold: range / 3.0, weight: 1.5 }],
        relaxations: vec![part(0.1, 0.2 * range), part(2.0, -0.3 * range)],
        direct: 0.4 * range,
        ..charge
    };
    let (seen, unseen) = (pulses(1500, 0.0), data(&law, &pulses(900, 1.0)));
    let alone = fitted(&law, &seen, &[("lagged_input", json!(true))]);
    let alone = error_percent(&alone, &unseen);
    assert!(alone < 2.0, "{alone}");
    let default = Fit::new().option("effort", json!("quick")).run(&data(&law, &seen)).unwrap();
    let default = error_percent(&default, &unseen);
    assert!(default < 3.0, "{default}");
}
