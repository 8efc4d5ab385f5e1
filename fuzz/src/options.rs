//! Sets of options: a fit gives a model whose free run is finite, or one line says why not.

use std::ops::ControlFlow;

use hysid::data::rate::RateMethod;
use hysid::fit::{identify, memory_need};
use hysid::options::chosen::NamedOptions;
use hysid::options::table::OPTIONS;
use serde_json::{Map, Value, json};

use crate::bytes::Bytes;
use crate::{assert_is_one_line, fixtures};

/// Times that the observer is asked before it says stop.
const PATIENCE: usize = 40;

/// Memory that a fit may need, in bytes.
const MEMORY: f64 = 100e6;

/// Options chosen at most.
const MOST: usize = 6;

pub fn run(data: &[u8]) {
    // A map as it is written, or choices by bytes.
    let options = match serde_json::from_slice(data) {
        Ok(Value::Object(options)) => options,
        _ => chosen(&mut Bytes(data)),
    };
    let chosen = match NamedOptions::of(options) {
        Ok(chosen) => chosen,
        Err(error) => return assert_is_one_line(&error.to_string()),
    };
    let rate =
        Some(RateMethod::Backward).filter(|_| data.len().is_multiple_of(2) && chosen.model().uses_rate());
    let request = chosen.request(rate, false);
    let data = fixtures::data();
    match memory_need(data, &request, 1).and_then(|need| need.check(MEMORY)) {
        Ok(()) => {}
        Err(error) => return assert_is_one_line(&error.to_string()),
    }
    let mut calls = 0;
    let fitted = identify(data, &request, &mut |_| {
        calls += 1;
        if calls > PATIENCE { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match fitted {
        Ok(fitted) => {
            let outputs = fitted.model.simulate(&data.records()[0]).expect("a free run over the data");
            assert!(outputs.iter().all(|y| y.is_finite()), "{}", request.label());
        }
        Err(error) => assert_is_one_line(&error.to_string()),
    }
}

fn chosen(bytes: &mut Bytes) -> Map<String, Value> {
    let names: Vec<&str> = OPTIONS.iter().map(|option| option.name).collect();
    let models: Vec<&str> = hysid::options::ModelName::all().map(|model| model.name()).collect();
    let mut all = Map::new();
    all.insert("model".into(), json!(bytes.one_of(&models)));
    // Small unless chosen otherwise, so that many sets are tried.
    all.insert("epochs".into(), json!(2));
    all.insert("starts".into(), json!(1 + bytes.below(3)));
    for _ in 0..bytes.below(MOST) {
        let name = names[bytes.below(names.len())].to_string();
        if name == "model" {
            continue;
        }
        let value = match bytes.below(7) {
            0 => json!(bytes.number()),
            1 => json!(bytes.byte().is_multiple_of(2)),
            2 => json!([bytes.ordinary().abs(), 1.0 + bytes.ordinary().abs()]),
            3 => json!(bytes.one_of(&[
                "hybrid",
                "genetic",
                "subgradient",
                "any",
                "non-negative",
                "non-positive"
            ])),
            4 => Value::Null,
            5 => json!(bytes.one_of(&[0u64, 1000, 10_000, u64::MAX])),
            _ => json!(bytes.below(12)),
        };
        all.insert(name, value);
    }
    all
}

pub fn seeds() -> Vec<Vec<u8>> {
    let models = hysid::options::ModelName::all();
    let set = |name: &str| json!({ "model": name, "starts": 1, "epochs": 2, "operators": 5, "stops": 2 });
    models.map(|model| set(model.name()).to_string().into_bytes()).collect()
}
