//! Work that needs more memory than there is is refused, and the estimate is near to what is taken.

use std::fs;
use std::process::Stdio;
use std::time::Duration;

use crate::workbench::Workbench;
use hysid::data::rate::RateMethod;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::fit::memory_need;
use hysid::options::chosen::NamedOptions;
use hysid_core::elementary::sin;
use serde_json::json;

/// Largest ratio between estimate and measured peak, either way.
const FACTOR: f64 = 3.0;

fn columns(rows: usize, inputs: usize) -> (Vec<f64>, Vec<Vec<f64>>, Vec<f64>) {
    let time: Vec<f64> = (0..rows).map(|k| 0.1 * k as f64).collect();
    let input = |c: usize| -> Vec<f64> {
        (0..rows).map(|k| sin((0.3 + 0.07 * c as f64) * k as f64) * (1.0 + k as f64 / rows as f64)).collect()
    };
    let inputs: Vec<Vec<f64>> = (0..inputs).map(input).collect();
    let y = (0..rows).map(|k| inputs[0][k] + 0.3 * sin(0.3 * k as f64 - 0.7)).collect();
    (time, inputs, y)
}

/// A table, and the same as data.
fn data(bench: &Workbench, rows: usize, inputs: usize) -> Dataset {
    let (time, columns, y) = columns(rows, inputs);
    let names: Vec<String> = (0..inputs).map(|c| format!("x{c}")).collect();
    let mut text = format!("t,{},y\n", names.join(","));
    for row in 0..rows {
        text += &format!("{}", time[row]);
        columns.iter().for_each(|column| text += &format!(",{}", column[row]));
        text += &format!(",{}\n", y[row]);
    }
    bench.put("data.csv", text);
    let record = Record::new("r", columns, y).unwrap().with_time(time).unwrap();
    Dataset::new(ColumnNames::plain(inputs), vec![record]).unwrap()
}

fn named(inputs: usize) -> String {
    (0..inputs).map(|c| format!(" --input x{c}")).collect()
}

/// Peak of the program's memory in bytes.
fn peak(bench: &Workbench, options: &str) -> f64 {
    let mut child = bench
        .command(&format!("fit data.csv --no-report --force -o model.json --threads 2 {options}"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak: f64 = 0.0;
    let status_code = loop {
        if let Some(code) = child.try_wait().unwrap() {
            break code;
        }
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok());
        peak = peak.max(1024.0 * kilobytes.unwrap_or_default());
        std::thread::sleep(Duration::from_millis(2));
    };
    assert!(status_code.success(), "{options}: {status_code}");
    peak
}

/// The same by the trainer that needs a matrix.
fn with_matrix(mut options: serde_json::Value) -> serde_json::Value {
    options["training"] = json!("levenberg-marquardt");
    options
}

#[test]
fn estimates_are_near_to_what_is_taken() {
    let bench = Workbench::new();
    let cases = [
        // A Gauss-Newton matrix of a thousand parameters; the dilated space of as many; few rows of many inputs; cells
        // of a plane; derivatives of a recurrent network.
        (
            2000,
            1,
            with_matrix(json!({ "model": "xpnn", "stops": 30, "hidden": 30, "starts": 2, "epochs": 1 })),
        ),
        (2000, 1, json!({ "model": "xpnn", "stops": 30, "hidden": 30, "starts": 2, "epochs": 40 })),
        (50, 99, with_matrix(json!({ "model": "xpnn+", "starts": 2, "epochs": 1 }))),
        (50, 99, json!({ "model": "xpnn+", "starts": 2, "epochs": 40 })),
        (300, 1, json!({ "model": "preisach", "operators": 50 })),
        (20_000, 1, json!({ "model": "modified-prandtl-ishlinskii", "operators": 40 })),
        (
            2000,
            1,
            json!({ "model": "duhem-nn", "hidden": 30, "operators": 40, "states": 4, "starts": 2, "epochs": 1 }),
        ),
    ];
    for (rows, inputs, options) in cases {
        let set = data(&bench, rows, inputs);
        let serde_json::Value::Object(map) = options.clone() else { panic!("a map") };
        let request = NamedOptions::of(map.clone()).unwrap().request(Some(RateMethod::Central), false);
        let estimate = memory_need(&set, &request, 2).unwrap().bytes;
        let flags: Vec<String> = map
            .iter()
            .map(|(name, value)| format!("--{name} {}", value.to_string().trim_matches('"')))
            .collect();
        // What the program takes anyway.
        let base = peak(&bench, "--model pnn --starts 1 --epochs 1 --input x0 --rate none");
        let taken = peak(&bench, &format!("{}{}", flags.join(" "), named(inputs))) - base;
        let ratio = estimate / taken;
        eprintln!("{options}: {:.0} MB estimated, {:.0} MB taken", estimate / 1e6, taken / 1e6);
        assert!((1.0 / FACTOR..FACTOR).contains(&ratio), "{options}: {estimate:.2e} of {taken:.2e} bytes");
    }
}

#[test]
fn what_needs_more_than_there_is_is_refused_at_once() {
    let bench = Workbench::new();
    data(&bench, 100_000, 1);
    let sizes = "--stops 1000 --hidden 1000 --relaxation 1000 --training levenberg-marquardt";
    for command in [
        format!("fit data.csv -o model.json --model xpnn+ {sizes}"),
        format!("validate data.csv --model xpnn+ {sizes}"),
    ] {
        let ran = bench.run(&command);
        assert_eq!(ran.status, Some(1), "{}", ran.stderr);
        for words in ["error: this needs about", "GB are available: choose fewer hidden"] {
            assert!(ran.last_line().contains(words), "{}", ran.stderr);
        }
        assert!(!bench.path("model.json").exists());
    }
}
