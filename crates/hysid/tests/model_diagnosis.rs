//! The diagnosis of models against what their equations guarantee.

use std::ops::ControlFlow;

use hysid::classical::identification::ClassicalOptions;
use hysid::diagnosis::{ModelDiagnosis, Property};
use hysid::identification::{ModelName, Request, identify};
use hysid::model::Model;
use hysid::network::Sizes;
use hysid::operator::{Operator, Stop};
use hysid::rate::RateMethod;
use hysid::record::{ColumnNames, Dataset, Record};
use hysid::training::FitOptions;

/// A play-like output that lags behind its input, so that every model has something to find.
fn record(rows: usize, name: &str) -> Record {
    let x: Vec<f64> =
        (0..rows).map(|k| (0.19 * k as f64).sin() * (0.4 + 0.6 * (0.011 * k as f64).sin().abs())).collect();
    let mut stop = Stop::new(0.25).unwrap();
    let y = x.iter().map(|x| 20.0 + 3.0 * x - 1.8 * stop.step(*x)).collect();
    let time = (0..rows).map(|k| 0.1 * k as f64).collect();
    Record::new(name, vec![x], y).unwrap().with_time(time).unwrap()
}

fn data() -> Dataset {
    Dataset::new(ColumnNames::plain(1), vec![record(180, "a"), record(120, "b")]).unwrap()
}

fn fitted(name: ModelName) -> Model {
    let request = match Request::of(name, Some(RateMethod::Central), 3) {
        Request::Network(options) => Request::Network(FitOptions {
            sizes: Sizes { stops: 3, hidden: 2, relaxation: 1 },
            starts: 1,
            epochs: 4,
            ..options
        }),
        Request::Classical(options) => Request::Classical(ClassicalOptions {
            operators: Some(8),
            starts: options.model.is_searched().then_some(2),
            epochs: options.model.is_searched().then_some(6),
            ..options
        }),
    };
    identify(&data(), &request, &mut |_| ControlFlow::Continue(())).unwrap().model
}

#[test]
fn explore() {
    for name in ModelName::all() {
        let model = fitted(name);
        let start = std::time::Instant::now();
        let diagnosis = ModelDiagnosis::of(&model).unwrap();
        println!("=== {} {:?}", name.name(), start.elapsed());
        for finding in &diagnosis.properties {
            println!("  {:18} {:12} {:?} {}", finding.property.name(), finding.verdict.to_string(), finding.index, finding.statement);
        }
        println!("  promises {:?}", diagnosis.promises.iter().map(|p| (p.property.name(), p.verdict, p.agrees)).collect::<Vec<_>>());
        println!("  widths {:?}", diagnosis.loop_widths);
        println!("  memory {:#?}", diagnosis.memory);
        println!("  probing {:?}", diagnosis.probing);
        if let Some(w) = &diagnosis.weights {
            for c in &w.criteria { println!("  C {} {:.4} {} agrees {:?}: {}", c.property, c.value, c.verdict, c.agrees, c.statement); }
            for n in &w.neurons { println!("  N {n:?}"); }
        }
        let _ = Property::ALL;
    }
}
