//! Small data, and small models of every kind fitted to them, made once.

use std::ops::ControlFlow;
use std::sync::OnceLock;

use hysid::data::rate::RateMethod;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::fit::identify;
use hysid::model::Model;
use hysid::options::ModelName;
use hysid::options::chosen::NamedOptions;
use hysid_core::elementary::sin;
use serde_json::json;

/// A lagging output under two hundred rows of a growing oscillation.
pub fn data() -> &'static Dataset {
    static DATA: OnceLock<Dataset> = OnceLock::new();
    DATA.get_or_init(|| {
        let x: Vec<f64> = (0..120).map(|k| sin(0.19 * k as f64) * (0.3 + 0.007 * k as f64)).collect();
        let mut play: f64 = 0.0;
        let y = x.iter().map(|x| {
            play = play.clamp(x - 0.2, x + 0.2);
            2.0 + 0.5 * x + play
        });
        let (y, time) = (y.collect(), (0..120).map(|k| 0.1 * k as f64).collect());
        let record = Record::new("r", vec![x], y).expect("a record").with_time(time).expect("with time");
        Dataset::new(ColumnNames::plain(1), vec![record]).expect("data")
    })
}

/// A model of every kind.
pub fn models() -> &'static [Model] {
    static MODELS: OnceLock<Vec<Model>> = OnceLock::new();
    MODELS.get_or_init(|| {
        let names = ModelName::all().map(|model| (model.name(), json!({}))).chain([
            ("xpnn+", json!({ "compression": 0.1, "rate_compression": 0.1, "history": true })),
            ("random-stops", json!({ "hidden": 5, "members": 3 })),
            ("auto", json!({ "members": 5 })),
        ]);
        names.map(|(name, more)| fitted(name, more)).collect()
    })
}

fn fitted(name: &str, more: serde_json::Value) -> Model {
    let mut options = json!({ "model": name, "stops": 3, "operators": 6, "epochs": 3, "starts": 2 });
    let (Some(all), serde_json::Value::Object(more)) = (options.as_object_mut(), more) else {
        panic!("maps")
    };
    all.extend(more);
    let chosen = NamedOptions::of(all.clone()).expect("options");
    let request = chosen.request(Some(RateMethod::Backward).filter(|_| chosen.model().uses_rate()), false);
    let fitted = identify(data(), &request, &mut |_| ControlFlow::Continue(()));
    fitted.unwrap_or_else(|error| panic!("{name}: {error}")).model
}
