//! Data that are not what they seem: copies of a record, marks of missing values, a saturated sensor, too few rows. Each
//! is told before the fit.

use crate::workbench::{ROWS, Ran, Workbench, csv, rows, table, with_column};
use hysid_core::elementary::{cos, sin};
use serde_json::Value;

const QUICK: &str = "--no-report --model prandtl-ishlinskii --operators 5";

#[track_caller]
fn succeeds(ran: Ran) -> Ran {
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    ran
}

/// The error over all folds, in percent of std.
fn unseen(ran: &Ran) -> f64 {
    let json: Value = serde_json::from_str(&ran.stdout).unwrap();
    json["unseen"]["nrmse_std_percent"].as_f64().unwrap()
}

#[test]
fn a_file_given_twice_is_not_unseen_data() {
    let bench = Workbench::new();
    bench.put("n1.csv", table());
    bench.put("copy.csv", with_column(1, |cell| format!("{:.4}", cell.parse::<f64>().unwrap())));
    bench.put("part.csv", csv("t,x,y", ",", "\n", &rows()[10..50]));
    let validate = |files: &str| {
        succeeds(bench.run(&format!("validate {files} --model prandtl-ishlinskii --operators 5 --json")))
    };
    let alone = unseen(&validate("n1.csv"));
    for (files, told) in [
        ("n1.csv n1.csv", "record \"n1.csv (2)\" is equal to record \"n1.csv\""),
        ("n1.csv copy.csv", "record \"copy\" is nearly equal to record \"n1\""),
        ("n1.csv part.csv", "record \"part\" is a part of record \"n1\""),
    ] {
        let ran = validate(files);
        assert!(ran.stderr.contains(&format!("warning: {told}: they count as one")), "{}", ran.stderr);
        assert_eq!(unseen(&ran), alone, "{files}");
    }
    let fit = succeeds(bench.run(&format!("fit n1.csv part.csv -o model.json {QUICK}")));
    assert!(fit.stderr.contains("record \"part\" is a part of record \"n1\""), "{}", fit.stderr);
    let ran = succeeds(bench.run("compare n1.csv --test part.csv --models prandtl-ishlinskii --no-report"));
    let told = "warning: record \"part\" is a part of what the model was trained on";
    assert!(ran.stderr.contains(told), "{}", ran.stderr);
}

#[test]
fn marks_of_missing_values_are_told_before_the_fit() {
    let bench = Workbench::new();
    for (mark, column) in
        [("-999", 2), ("9999", 2), ("1e30", 2), ("-999", 1), ("32767", 1), ("1e30", 1), ("250", 2)]
    {
        let mut rows = rows();
        let places: &[usize] = if mark == "250" { &[20] } else { &[20, 33, 34] };
        places.iter().for_each(|&row| rows[row][column] = mark.into());
        bench.put("data.csv", csv("t,x_mm,F_N", ",", "\n", &rows));
        let name = ["x_mm", "F_N"][column - 1];
        let ran = succeeds(bench.run(&format!("fit data.csv -o out.json {QUICK}")));
        let told = format!("warning: \"{name}\" is ");
        let line = ran.stderr.lines().find(|line| line.starts_with(&told));
        let line = line.unwrap_or_else(|| panic!("{mark} in {name}: {}", ran.stderr));
        let count = if places.len() == 1 { "1 row" } else { "3 rows" };
        assert!(line.contains(&format!("in {count} (first in row 21 of record \"data\")")), "{line}");
        let ran = succeeds(bench.run("diagnose data.csv --json --no-report"));
        let json: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(json["doctor"][0]["kind"], "missing-value-mark", "{mark} in {name}");
    }
    bench.put("data.csv", table());
    let ran = succeeds(bench.run(&format!("fit data.csv -o out.json {QUICK}")));
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
}

#[test]
fn a_saturated_sensor_is_told_before_the_fit() {
    let bench = Workbench::new();
    let record = |clip: f64| {
        let row = |k: usize| {
            let phase = 0.05 * k as f64;
            let x = sin(phase) * (0.5 + k as f64 / 1000.0);
            let y = x + 0.2 * cos(phase);
            vec![format!("{x:.6}"), format!("{:.6}", y.clamp(-clip, clip))]
        };
        csv("x_mm,F_N", ",", "\n", &(0..10 * ROWS).map(row).collect::<Vec<_>>())
    };
    bench.put("data.csv", record(0.7));
    let ran = succeeds(bench.run(&format!("fit data.csv -o out.json {QUICK}")));
    assert!(ran.stderr.contains("warning: the output stays at 0.7 N for "), "{}", ran.stderr);
    bench.put("data.csv", record(9.0));
    let ran = succeeds(bench.run(&format!("fit data.csv -o out.json {QUICK}")));
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
}

#[test]
fn more_parameters_than_rows_are_told() {
    let bench = Workbench::new();
    bench.put("data.csv", csv("t,x,y", ",", "\n", &rows()[..11]));
    let ran =
        succeeds(bench.run("fit data.csv -o out.json --no-report --model preisach-nn --starts 1 --epochs 2"));
    assert!(ran.stderr.contains(" parameters are fitted to 11 rows: "), "{}", ran.stderr);
    let ran =
        succeeds(bench.run("fit data.csv -o out.json --no-report --model preisach --operators 10 --json"));
    let json: Value = serde_json::from_str(&ran.stdout).unwrap();
    let note = json["notes"][0].as_str().unwrap_or_default();
    assert!(note.contains(" parameters are fitted to 11 rows: "), "{json}");
}
