//! Notes on a model beside its errors: rows that it was not trained on, data that cannot distinguish
//! candidates, inputs that are measured from elsewhere than 0.

use crate::workbench::{Workbench, csv, must_contain};
use hysid_core::elementary::{cos, sin};
use serde_json::Value;

/// Some cycles of one loop.
fn one_loop() -> String {
    let row = |k: usize| {
        let x = sin(0.2 * k as f64);
        vec![format!("{x:.6}"), format!("{:.6}", x + 0.3 * cos(0.2 * k as f64))]
    };
    csv("H_A_m,B_T", ",", "\n", &(0..150).map(row).collect::<Vec<_>>())
}

#[test]
fn a_warm_up_is_told_with_its_effect_and_judged_both_ways() {
    let bench = Workbench::with_data();
    let fit = bench.json("fit good.csv -o m.json --model prandtl-ishlinskii --warm-up 20 --json");
    let evaluated = bench.json("evaluate m.json good.csv --json");
    assert_eq!(fit["train"]["rmse"], evaluated["rmse"]);
    assert_eq!(fit["train_after_warm_up"]["rmse"], evaluated["after_warm_up"]["rmse"]);
    assert_eq!((&evaluated["samples"], &evaluated["after_warm_up"]["samples"]), (&60.into(), &40.into()));
    assert!(fit["notes"][0].as_str().unwrap().contains("the first 20 rows of each record"), "{fit}");

    let told = bench.run("evaluate m.json good.csv");
    must_contain(&told.stdout, &["after warm-up", "without the first 20 rows of each record"]);
    let told = bench.run("fit good.csv -o m.json --model prandtl-ishlinskii --warm-up 20");
    assert!(told.stdout.contains("\nnote   warm-up: the first 20 rows"), "{}", told.stdout);
    assert!(told.stdout.lines().all(|line| line.chars().count() <= 80), "{}", told.stdout);
    let page = bench.text("m.html");
    assert!(
        page.contains("training, after warm-up") && page.contains("the first 20 rows"),
        "both in the page"
    );

    let plain = bench.json("fit good.csv -o p.json --model prandtl-ishlinskii --json");
    assert_eq!((plain.get("train_after_warm_up"), &plain["notes"]), (None, &Value::Array(Vec::new())));
}

#[test]
fn data_of_one_loop_are_told_of() {
    let bench = Workbench::new();
    bench.put("loop.csv", one_loop());
    let quick = "--members 2 --stops 3 --hidden 2 --epochs 2 --operators 10";
    let fit = bench.json(&format!("fit loop.csv -o m.json {quick} --json"));
    assert_eq!(fit["selection"]["one_loop"], true);
    let note = fit["notes"].to_string();
    must_contain(&note, &["one loop: all reversals of H_A_m", "measure loops of three or more amplitudes"]);
    assert!(bench.text("m.html").contains("one loop: all reversals of H_A_m"));
}

#[test]
fn an_input_far_from_zero_is_measured_from_elsewhere_and_the_report_says_so() {
    let bench = Workbench::new();
    let shifted = |line: &str| {
        let (x, y) = line.split_once(',').unwrap();
        x.parse::<f64>().map_or(line.to_string(), |x| format!("{},{y}", x + 200.0))
    };
    bench.put("far.csv", one_loop().lines().map(shifted).collect::<Vec<_>>().join("\n"));
    bench.succeeds("fit far.csv -o m.json --model prandtl-ishlinskii");
    assert!(bench.text("m.html").contains("Offset of H_A_m"));
    let ran = bench.run("fit far.csv -o j.json --model jiles-atherton --time-limit 1");
    let caution = "H_A_m ranges from 199 to 201, but for the law 0 is the demagnetised state";
    assert!(ran.stderr.contains(caution), "{}", ran.stderr);
}
