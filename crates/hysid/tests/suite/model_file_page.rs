//! `docs/model-file.md` is complete and true: its tables have every field that model files have, and no other, and its
//! examples are model files that compute what the page says.

use crate::noisy_record::waved;
use crate::scaffold::*;
use crate::small_models;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use hysid::options::input_options::InputOptions;
use hysid::options::table::FitOption;
use hysid_core::elementary::tanh;
use serde_json::{Value, json};

/// The fields of each object, by the path of the object from the root.
type Fields = BTreeMap<String, BTreeSet<String>>;

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/model-file.md");
    std::fs::read_to_string(path).unwrap().replace("\r\n", "\n")
}

fn in_backticks(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// Fields that the page documents: the first cells of the tables that begin with `field`, below headings with paths.
fn documented(page: &str) -> Fields {
    let mut fields = Fields::new();
    let mut objects = Vec::new();
    let mut in_table = false;
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("### ") {
            objects = in_backticks(heading).into_iter().map(|path| path.replace("root", "")).collect();
        }
        in_table = line.starts_with("| field |") || in_table && line.starts_with('|');
        let first = line.strip_prefix("| `").and_then(|rest| rest.split_once('`'));
        if let Some((field, _)) = first.filter(|_| in_table) {
            for object in &objects {
                fields.entry(object.clone()).or_default().insert(field.to_owned());
            }
        }
    }
    fields
}

/// Adds the fields of a value. Objects that occur at several places have one path.
fn collect(value: &Value, path: &str, fields: &mut Fields) {
    let path = match path {
        "ensemble.members[]" => "",
        "ensemble.group.voices[].who.group" => "ensemble.group",
        "training.options.only" => "training.options",
        path => path,
    };
    match value {
        Value::Object(object) => {
            let known = fields.entry(path.to_owned()).or_default();
            known.extend(object.keys().cloned());
            for (key, value) in object {
                let dot = if path.is_empty() { "" } else { "." };
                collect(value, &format!("{path}{dot}{key}"), fields);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| collect(value, &format!("{path}[]"), fields)),
        _ => {}
    }
}

fn data(offset: f64) -> Dataset {
    let shifted = |name| {
        let record = waved(120, name);
        let x = record.inputs()[0].iter().map(|x| x + offset).collect();
        Record::new(name, vec![x], record.output().to_vec())
            .and_then(|shifted| shifted.with_time(record.time().unwrap().to_vec()))
            .unwrap()
    };
    let records = ["one", "two", "three"].map(shifted).into();
    let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
    Dataset::new(names, records).unwrap()
}

fn fitted(spec: &FitSpec, offset: f64) -> Model {
    model_of(&data(offset), spec)
}

/// The same request with the parts of a model that its default leaves out.
fn with_other_parts(spec: FitSpec) -> FitSpec {
    match spec {
        FitSpec::Classical(mut options) => {
            options.free_weights = Some(false);
            FitSpec::Classical(options)
        }
        other => other,
    }
}

/// The same request with everything that adds parts to a model.
fn with_all_parts(spec: FitSpec) -> FitSpec {
    let shaping = |history| InputOptions {
        compression: Some(0.2),
        rate_compression: Some(0.2),
        history,
        warm_up: 4,
        initial_state: Some(InitialState::SaturatedUp),
    };
    match spec {
        FitSpec::Network(mut options) => {
            options.shaping = shaping(options.model == Family::XpnnPlus);
            FitSpec::Network(options)
        }
        FitSpec::Classical(mut options) => {
            options.free_weights = Some(true);
            options.logarithmic_thresholds = true;
            options.degradation = true;
            options.asymmetric = true;
            options.shaping = shaping(false);
            options.states = Some(3);
            options.modes = Some(2);
            options.relaxation = Some(1);
            options.resonance = true;
            options.lagged_input = true;
            options.deterioration = Some(true);
            FitSpec::Classical(options)
        }
        automatic => automatic,
    }
}

/// The file with parts that only rare data give a model, which its reader must know.
fn with_rare_parts(model: &Model) -> Model {
    let mut file: Value = serde_json::from_str(&model.to_json()).unwrap();
    let training = &mut file["training"];
    training["runs"] = json!([{
        "phase": "starts", "start": 0, "method": "genetic", "history": [], "termination": "stalled", "fold": 1,
        "validation_nrmse_percent": 1.0
    }]);
    training["lead_ins"] = json!([{"record": "one", "lead_in": [1.0]}]);
    training["weighted"] = json!(true);
    let options = training["options"].as_object_mut().unwrap();
    options.insert("ridge".into(), json!(1e-6));
    options.insert("decay".into(), json!(1e-6));
    options.insert("initial_state".into(), json!("unknown"));
    options.insert("only".into(), only());
    let selection = &mut training["selection"];
    selection["one_loop"] = json!(true);
    selection["dropped"] = json!(["lugre"]);
    selection["found_states"] = json!({"found_percent": 1.0, "virgin_percent": 2.0});
    selection["warm_up"] = json!({"rows": 4, "without_percent": 1.0, "with_percent": 2.0});
    selection["single"] = json!({"name": "lugre", "distilled": false, "distilled_percent": null, "plain_percent": 1.0, "is_law": true});
    selection["beyond"] = json!({"folds": ["100 Hz"], "percent": 9.0});
    file.as_object_mut().unwrap().remove("lead_in");
    file["periodic"] = json!(true);
    let text = file.to_string();
    Model::from_json(&with_checksum(&text)).unwrap()
}

/// Options of a classical model, as a file has them.
fn only() -> Value {
    let model = ModelName::all().last().unwrap();
    serde_json::to_value(small_models::small(model, None)).unwrap()
}

/// Puts the checksum last and makes it right.
fn with_checksum(text: &str) -> String {
    let mut file: serde_json::Map<String, Value> = serde_json::from_str(text).unwrap();
    file.remove("checksum");
    let body = Value::Object(file).to_string();
    let head = format!("{},", body.strip_suffix('}').unwrap());
    // Compact JSON has no white space outside of texts.
    format!("{head}\"checksum\":\"{:08x}\"}}", crc32fast::hash(head.as_bytes()))
}

#[test]
fn the_page_has_every_field_and_no_other() {
    let mut written = Fields::new();
    let mut add = |model: &Model| collect(&serde_json::from_str(&model.to_json()).unwrap(), "", &mut written);
    for name in ModelName::all() {
        let spec = small_models::small(name, Some(RateMethod::Backward));
        add(&fitted(&with_other_parts(spec.clone()), 0.0));
        add(&fitted(&with_all_parts(spec), 5.0));
    }
    let automatic = fitted(&small_models::small(ModelName::AUTO, Some(RateMethod::Backward)), 0.0);
    add(&automatic);
    add(&with_rare_parts(&automatic));

    let mut documented = documented(&page());
    // Those that docs/options.md describes.
    let is_option = |field: &&String| FitOption::named(field).is_some();
    let of_options = written["training.options"].iter().filter(is_option).cloned();
    documented.get_mut("training.options").unwrap().extend(of_options);
    let every = |fields: &Fields| -> BTreeSet<String> {
        let names = fields.iter().flat_map(|(object, names)| names.iter().map(move |name| (object, name)));
        names.map(|(object, name)| format!("{object}: {name}")).collect()
    };
    let (written, documented) = (every(&written), every(&documented));
    assert!(written.len() > 200);
    let missing: Vec<_> = written.difference(&documented).collect();
    let unknown: Vec<_> = documented.difference(&written).collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "not on the page: {missing:#?}\nin no file: {unknown:#?}"
    );
}

fn examples(page: &str) -> Vec<Model> {
    let blocks = page.split("```json\n").skip(1).map(|rest| rest.split_once("```").unwrap().0);
    blocks.map(|text| Model::from_json(text).unwrap()).collect()
}

/// The numbers of the table whose first column has this heading.
fn table(page: &str, first: &str) -> Vec<Vec<f64>> {
    let rows = page.lines().skip_while(|line| !line.starts_with(&format!("| `{first}` |")));
    let rows = rows.skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().parse().unwrap()).collect())
        .collect()
}

fn assert_row(printed: &[f64], computed: &[f64]) {
    assert_eq!(printed.len(), computed.len());
    for (printed, computed) in printed.iter().zip(computed) {
        assert!((printed - computed).abs() < 6e-7, "{printed} on the page, {computed} computed");
    }
}

#[test]
fn the_network_of_the_page_computes_what_the_page_says() {
    let page = page();
    let model = &examples(&page)[0];
    let rows = table(&page, "t");
    assert_eq!(rows.len(), 5);
    let column = |column: usize| -> Vec<f64> { rows.iter().map(|row| row[column]).collect() };
    let record = Record::new("r", vec![column(1)], vec![f64::NAN; 5]).unwrap().with_time(column(0)).unwrap();
    let simulated = model.simulate(&record).unwrap();
    let (mut p, mut s) = (0.0_f64, 0.0);
    for (k, row) in rows.iter().enumerate() {
        let (t, x) = (row[0], row[1]);
        let rate = if k == 0 { 0.0 } else { (x - rows[k - 1][1]) / (t - rows[k - 1][0]) };
        let v = 2.0 * (x / 2.0) + 0.5 * (rate / 4.0);
        let before = p;
        p = p.max(v - 1.0).min(v + 1.0);
        if k > 0 {
            s += (p - before).abs();
        }
        let memory = (v - p) * (1.0 - s / 2.0).max(0.0);
        let hidden = tanh(0.1 + 0.3 * (x / 2.0) + 0.8 * memory);
        let y = 10.0 + 5.0 * (0.2 + 1.5 * hidden);
        assert_row(row, &[t, x, rate, v, p, v - p, s, memory, hidden, y]);
        assert!((simulated[k] - y).abs() < 1e-12, "{} simulated, {y} by hand", simulated[k]);
    }
}

#[test]
fn the_law_of_the_page_computes_what_the_page_says() {
    let page = page();
    let model = &examples(&page)[1];
    let rows = table(&page, "x");
    assert_eq!(rows.len(), 5);
    let x: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let simulated = model.run(&x).unwrap();
    let mut plays = [0.0_f64; 2];
    for (k, row) in rows.iter().enumerate() {
        for (play, threshold) in plays.iter_mut().zip([0.5, 1.5]) {
            *play = play.max(x[k] - threshold).min(x[k] + threshold);
        }
        let y = 1.0 + 2.0 * x[k] - 0.8 * plays[0] - 0.6 * plays[1];
        assert_row(row, &[x[k], plays[0], plays[1], y]);
        assert!((simulated[k] - y).abs() < 1e-12, "{} simulated, {y} by hand", simulated[k]);
    }
}
