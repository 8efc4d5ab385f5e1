//! Models of all kinds, fitted to short synthetic records, and paths that they have not seen.

#![allow(dead_code)]

mod dynamics;

use hysid::data::record::ColumnNames;
use hysid::{Dataset, Fit, Model, Record};
use hysid_core::elementary::{cos, ln, sin};
use serde_json::{Value, json};

/// A spring, two plays and a term of the rate, with time stamps, a further input and a temperature.
pub fn data(inputs: usize) -> Dataset {
    let records = (0..2).map(|number| {
        let rows = 240;
        let time: Vec<f64> = (0..rows).map(|k| 0.02 * f64::from(k)).collect();
        let x: Vec<f64> = time
            .iter()
            .map(|t| 40.0 + 3.0 * ln(1.0 + 0.3 * t) * sin(2.1 * t + f64::from(number)) + sin(7.3 * t))
            .collect();
        let further: Vec<f64> = time.iter().map(|t| 5.0 + cos(0.9 * t)).collect();
        let mut plays: [f64; 2] = [40.0, 40.0];
        let mut before = x[0];
        let y: Vec<f64> = x
            .iter()
            .zip(&further)
            .map(|(&x, f)| {
                for (play, r) in plays.iter_mut().zip([0.4, 1.1]) {
                    *play = f64::clamp(*play, x - r, x + r);
                }
                let rate = (x - before) / 0.02;
                before = x;
                let second = if inputs > 1 { 0.2 * f } else { 0.0 };
                100.0 + 3.0 * (x - 40.0) + 4.0 * plays[0] + 2.0 * plays[1] + 0.02 * rate + second
            })
            .collect();
        let temperature = vec![20.0 + 15.0 * f64::from(number); x.len()];
        let columns = [x, further, temperature].into_iter().take(inputs).collect();
        Record::new(format!("record {number}"), columns, y).unwrap().with_time(time).unwrap()
    });
    Dataset::new(ColumnNames::plain(inputs), records.collect()).unwrap()
}

fn fitted(name: &str, inputs: usize, options: &[(&str, Value)]) -> (String, Model) {
    let mut fit = Fit::new().model(name).seed(3);
    for (option, value) in options {
        fit = fit.option(option, value.clone());
    }
    let label = options.iter().map(|(name, value)| format!(" {name}={value}")).collect::<String>();
    let model = fit.run(&data(inputs)).unwrap_or_else(|error| panic!("{name}{label}: {error}"));
    (format!("{name}{label} of {inputs}"), model)
}

const SMALL: [(&str, i64); 4] = [("starts", 1), ("epochs", 3), ("stops", 9), ("hidden", 7)];

/// Networks of all families, with every input transform.
pub fn networks() -> Vec<(String, Model)> {
    let small = || SMALL.map(|(name, value)| (name, json!(value))).to_vec();
    let linear = || small().into_iter().filter(|(name, _)| *name != "hidden").collect::<Vec<_>>();
    let with = |mut options: Vec<(&'static str, Value)>, more: &[(&'static str, Value)]| {
        options.extend(more.iter().cloned());
        options
    };
    vec![
        fitted("pnn", 1, &linear()),
        fitted("gpnn", 1, &linear()),
        fitted("preisach-nn", 1, &with(small(), &[("compression", json!(0.2))])),
        fitted("xpnn", 1, &with(small(), &[("rate_compression", json!(0.5))])),
        fitted("xpnn+", 1, &with(small(), &[("history", json!(true)), ("compression", json!(0.1))])),
        fitted(
            "xpnn+",
            2,
            &with(small(), &[("initial_state", json!("saturated-up")), ("history", json!(true))]),
        ),
        fitted("random-stops", 1, &[("operators", json!(20))]),
    ]
}

/// Classical laws, with all variants that differ in code.
pub fn laws() -> Vec<(String, Model)> {
    let starts = || vec![("starts", json!(1)), ("epochs", json!(3))];
    let with = |more: &[(&'static str, Value)]| [starts(), more.to_vec()].concat();
    vec![
        fitted("prandtl-ishlinskii", 1, &[("operators", json!(13))]),
        fitted("modified-prandtl-ishlinskii", 1, &[("operators", json!(6))]),
        fitted("generalized-prandtl-ishlinskii", 1, &with(&[("operators", json!(5))])),
        fitted("rate-dependent-prandtl-ishlinskii", 1, &with(&[("operators", json!(5))])),
        fitted(
            "rate-dependent-prandtl-ishlinskii",
            1,
            &with(&[("logarithmic_thresholds", json!(true)), ("free_weights", json!(false))]),
        ),
        fitted("dynamic-prandtl-ishlinskii", 1, &with(&[("lagged_input", json!(true))])),
        fitted("masing", 1, &[("sign", json!("any"))]),
        fitted("preisach", 1, &[("operators", json!(7))]),
        fitted("neuro-madelung", 1, &with(&[("hidden", json!(4))])),
        fitted("bouc-wen", 1, &starts()),
        fitted("bouc-wen", 1, &with(&[("degradation", json!(true))])),
        fitted("lugre", 1, &starts()),
        fitted("jiles-atherton", 1, &starts()),
        fitted("jiles-atherton", 1, &with(&[("differential_form", json!(true))])),
        fitted("duhem-nn", 1, &with(&[("operators", json!(3)), ("hidden", json!(10))])),
        fitted("duhem-nn", 2, &with(&[("acceleration", json!(true)), ("operators", json!(2))])),
        fitted(
            "duhem-nn",
            3,
            &with(&[("odd", json!(true)), ("acceleration", json!(true)), ("operators", json!(0))]),
        ),
        fitted("menegotto-pinto", 1, &starts()),
        fitted("menegotto-pinto", 1, &with(&[("asymmetric", json!(true))])),
        fitted("ramberg-osgood", 1, &starts()),
        fitted("peak-oriented", 1, &starts()),
        fitted("peak-oriented", 1, &with(&[("degradation", json!(true)), ("asymmetric", json!(true))])),
    ]
}

/// Laws with inertia: one fitted with a lead-in, and others.
pub fn laws_with_inertia() -> Vec<(String, Model)> {
    let options = [("starts", 1), ("epochs", 3), ("operators", 3), ("hidden", 3)];
    let mut options = options.map(|(name, value)| (name, json!(value))).to_vec();
    options.push(("initial_state", json!("saturated-up")));
    let (name, model) = fitted("hysteretic-oscillator", 1, &options);
    assert!(!model.lead_in().is_empty());
    let variants = dynamics::variants(&model);
    let with_resonance = fitted(
        "dynamic-prandtl-ishlinskii",
        1,
        &[("starts", 1), ("epochs", 3), ("resonance", 1), ("relaxation", 1), ("operators", 5)]
            .map(|(name, value)| (name, if name == "resonance" { json!(true) } else { json!(value) })),
    );
    [vec![(name, model), with_resonance], variants].concat()
}

/// The default ensemble, of hasty members.
pub fn ensembles() -> Vec<(String, Model)> {
    vec![fitted("auto", 1, &[("starts", json!(1)), ("epochs", json!(2))])]
}

pub fn all() -> Vec<(String, Model)> {
    [networks(), laws(), laws_with_inertia(), ensembles()].concat()
}

/// Rows that no model has seen: reversals inside and outside the trained range, rest, large values.
pub fn path(rows: usize, inputs: usize) -> Vec<Vec<f64>> {
    (0..rows)
        .map(|k| {
            let t = k as f64;
            let rest = if k % 97 < 6 { 0.0 } else { 1.0 };
            let size = 2.0 + sin(0.001 * t) * 4.0 + if k % 1000 > 980 { 30.0 } else { 0.0 };
            let x = 40.0 + rest * size * (sin(0.211 * t) + 0.4 * sin(1.7 * t));
            [x, 5.0 + cos(0.013 * t), 28.0 + 9.0 * sin(0.0004 * t)][..inputs].to_vec()
        })
        .collect()
}

/// The time step before a row: some are equal, most are not.
pub fn time_step(row: usize) -> f64 {
    if row % 90 > 70 {
        return 0.05;
    }
    0.004 + 0.01 * ((row * 7919) % 13) as f64
}
