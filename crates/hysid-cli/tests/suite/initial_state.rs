//! The initial state of records, as a user gives it or lets it be found.

use crate::workbench::{Workbench, csv, json};
use hysid_core::elementary::sin;
use hysid_core::significant::Significant;
use serde_json::Value;

/// Rows of a play of threshold 0.5 that was driven to `past` before the record begins at 0.
fn rows(name: &str, past: f64, size: f64, pace: f64) -> Vec<Vec<String>> {
    let follow = |play: f64, x: f64| play.clamp(x - 0.5, x + 0.5);
    let mut play = follow(follow(0.0, past), 0.0);
    let row = |k: usize| {
        let x = size * sin(pace * k as f64);
        play = follow(play, x);
        vec![name.to_string(), format!("{x:.6}"), format!("{:.6}", 0.3 * x + play)]
    };
    (0..120).map(row).collect()
}

/// Training data that begin after either end of the range, and a record to come.
fn bench() -> Workbench {
    let bench = Workbench::new();
    let records =
        [("a", 1.0, 0.45, 0.11), ("b", -1.0, 0.4, 0.13), ("c", 1.0, 1.0, 0.12), ("d", 1.0, 0.48, 0.1)];
    let train: Vec<Vec<String>> =
        records.iter().flat_map(|&(name, past, size, pace)| rows(name, past, size, pace)).collect();
    bench.put("train.csv", csv("record,H_A_m,B_T", ",", "\n", &train));
    bench.put("test.csv", csv("record,H_A_m,B_T", ",", "\n", &rows("t", 1.0, 0.42, 0.115)));
    bench
}

const MODEL: &str = "--model prandtl-ishlinskii --operators 12";

#[test]
fn states_are_found_told_and_used() {
    let bench = bench();
    let fit = |state: &str, out: &str| {
        bench.json(&format!("fit train.csv -o {out} {MODEL} --initial-state {state} --json"))
    };
    let evaluate = |model: &str, options: &str| {
        bench.json(&format!("evaluate {model} test.csv --json {options}"))["rmse"].as_f64().unwrap()
    };
    let (found, virgin) = (fit("unknown", "found.json"), fit("virgin", "virgin.json"));
    assert_eq!(found["initial_state"], "saturated-up");
    assert_eq!(found["lead_ins"].as_array().unwrap().len(), 4);
    assert_eq!(found["lead_ins"][0]["record"], "a");
    let note = found["notes"].to_string();
    assert!(note.contains("3 records begin saturated-up, 1 record begins saturated-down"), "{note}");
    assert!(note.contains("new data begin saturated-up"), "{note}");
    assert_eq!((virgin.get("initial_state"), virgin.get("lead_ins")), (None, None));
    assert_eq!(virgin["notes"], Value::Array(Vec::new()));
    let page = bench.text("found.html");
    assert!(page.contains("Initial state") && page.contains("in its initial state"), "in the page");
    assert!(bench.text("virgin.html").contains("in the virgin state"), "in the page");
    let told = bench.run(&format!("fit train.csv -o found.json {MODEL} --initial-state unknown"));
    assert!(told.stdout.contains("\nnote   initial state: 3 records begin"), "{}", told.stdout);
    assert!(told.stdout.lines().all(|line| line.chars().count() <= 80), "{}", told.stdout);
    assert_eq!(
        bench.json(&format!("fit train.csv -o again.json {MODEL} --initial-state unknown --json"))["train"],
        found["train"]
    );

    let error = evaluate("found.json", "");
    assert!(error < 0.2 * evaluate("virgin.json", ""), "{error}");
    assert_eq!(evaluate("found.json", "--initial-state saturated-up"), error);
    assert!(evaluate("found.json", "--initial-state saturated-down") > 5.0 * error);
    let simulate = |options: &str| bench.run(&format!("simulate found.json test.csv {options}")).stdout;
    assert_eq!(simulate("--initial-state saturated-up"), simulate(""));
    assert_ne!(simulate("--initial-state virgin"), simulate(""));
    assert_ne!(simulate("--initial-state demagnetised"), simulate(""));
    assert_ne!(simulate("--initial-state periodic"), simulate(""));

    let validated = |state: &str| {
        let ran = bench.run(&format!("validate train.csv {MODEL} --initial-state {state} --json"));
        // Records of the only range and of the only state among the four are beyond the others.
        let folds = json(&ran)["folds"].as_array().unwrap().clone();
        let errors =
            folds.into_iter().filter(|fold| ["a", "d"].contains(&fold["held_out"].as_str().unwrap()));
        errors.map(|fold| fold["unseen"]["rmse"].as_f64().unwrap()).collect::<Vec<f64>>()
    };
    let (unknown, virgin) = (validated("unknown"), validated("virgin"));
    assert_eq!(unknown.len(), 2);
    assert!(
        unknown.iter().zip(&virgin).all(|(found, virgin)| *found < 0.2 * virgin),
        "{unknown:?} {virgin:?}"
    );
}

#[test]
fn a_state_that_is_none_is_refused() {
    let bench = bench();
    bench.succeeds(&format!("fit train.csv -o m.json --no-report {MODEL}"));
    for (arguments, words) in [
        ("fit train.csv -o n.json --initial-state saturated", "saturated"),
        (
            "evaluate m.json test.csv --initial-state up",
            "choose one of virgin, saturated-up, saturated-down,",
        ),
        ("simulate m.json test.csv --initial-state unknown", "only a fit finds an unknown state"),
    ] {
        let ran = bench.run(arguments);
        assert_eq!(ran.status, Some(2), "{arguments}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{arguments}: {}", ran.stderr);
    }
}

/// Test records after pasts of their own: with their beginning known, the error is that of the model, not of the state.
#[test]
fn models_are_compared_after_a_known_beginning() {
    let bench = bench();
    let cuts = [("e", -1.0, 0.4, 0.115), ("f", 0.9, 0.35, 0.12)];
    let cuts: Vec<Vec<String>> =
        cuts.iter().flat_map(|&(name, past, size, pace)| rows(name, past, size, pace)).collect();
    bench.put("cuts.csv", csv("record,H_A_m,B_T", ",", "\n", &cuts));
    let compare = |options: &str| {
        let models = "prandtl-ishlinskii,duhem-nn --time-limit 2";
        bench.json(&format!("compare train.csv --models {models} --json --no-report {options}"))
    };
    let row = |rows: &Value, model: &str| {
        let found = rows.as_array().unwrap().iter().find(|row| row["model"] == model);
        found.unwrap().clone()
    };
    let (without, with) = (compare("--test cuts.csv"), compare("--test cuts.csv --known 40"));
    for model in ["prandtl-ishlinskii", "duhem-nn"] {
        let (without, with) = (row(&without, model), row(&with, model));
        assert_eq!((&without["known"], &with["known"]), (&Value::Null, &Value::from(40)));
        assert_eq!((&without["test"]["samples"], &with["test"]["samples"]), (&240.into(), &160.into()));
        assert_eq!(with["train"]["samples"], 4 * 80);
        let error = |row: &Value| row["test"]["nrmse_std_percent"].as_f64().unwrap();
        assert!(error(&with) < 0.8 * error(&without), "{with}, without {without}");
    }
    // The same as a fit with this option, and its evaluation.
    bench.succeeds("fit train.csv -o m.json --no-report --model prandtl-ishlinskii --known 40");
    let evaluated = bench.json("evaluate m.json cuts.csv --known 40 --json");
    assert_eq!(evaluated["nrmse_std_percent"], row(&with, "prandtl-ishlinskii")["test"]["nrmse_std_percent"]);

    // The page of the fit has the same errors as what was printed.
    let fitted = bench.json(&format!("fit train.csv -o n.json {MODEL} --known 40 --json"))["train"].clone();
    let (page, rmse) = (bench.text("n.html"), fitted["rmse"].as_f64().unwrap());
    let row = page.lines().find(|line| line.contains("<th scope=\"row\">training</th>")).unwrap();
    assert!(row.contains(">320<") && row.contains(&format!(">{:.4}<", Significant(rmse))), "{rmse}: {row}");

    let told = bench.succeeds("compare train.csv --models prandtl-ishlinskii --known 40").stdout;
    let words = "after a known beginning of each record: 40 rows.";
    assert!(told.contains(words) && bench.text("train-compared.html").contains(words), "{told}");
    assert!(told.lines().all(|line| line.chars().count() <= 80), "{told}");

    let mut blank = rows("g", 1.0, 0.4, 0.115);
    blank.iter_mut().take(40).for_each(|row| row[2].clear());
    bench.put("blank.csv", csv("record,H_A_m,B_T", ",", "\n", &blank));
    let refused = |status: i32, options: &str, words: &str| {
        let ran = bench.run(&format!("compare train.csv --models masing --no-report {options}"));
        assert_eq!(ran.status, Some(status), "{options}: {}", ran.stderr);
        assert!(ran.stderr.contains(words) && !ran.stderr.contains("1/1"), "{options}: {}", ran.stderr);
    };
    refused(2, "--known 0", "give a number of rows, such as 100");
    refused(2, "--known soon", "give a number of rows, such as 100");
    refused(1, "--known 0.5s", "no unit of time is known");
    refused(1, "--known 120", "train.csv: column \"B_T\" is blank after the known beginning");
    refused(1, "--known 120 --test cuts.csv", "train.csv: column \"B_T\" is blank after the known beginning");
    refused(
        1,
        "--known 40 --test blank.csv",
        "blank.csv, line 2, column \"B_T\": is blank in the first 40 rows",
    );
    // Records of the training data that are longer than those of the test data.
    bench.put("short.csv", csv("record,H_A_m,B_T", ",", "\n", &cuts[..60]));
    refused(1, "--known 60 --test short.csv", "short.csv: column \"B_T\" is blank after the known beginning");
}

#[test]
fn a_state_is_found_from_a_known_beginning() {
    let bench = bench();
    bench.succeeds(&format!("fit train.csv -o found.json {MODEL} --initial-state virgin"));
    // A record after a past of its own.
    bench.put("cut.csv", csv("record,H_A_m,B_T", ",", "\n", &rows("t", -1.0, 0.4, 0.115)));
    let evaluate = |options: &str| bench.json(&format!("evaluate found.json cut.csv --json {options}"));
    let (virgin, known) = (evaluate(""), evaluate("--known 40"));
    let rmse = |errors: &Value| errors["rmse"].as_f64().unwrap();
    assert!(rmse(&known) < 0.3 * rmse(&virgin), "{known}, without {virgin}");
    // The outputs of the known rows are not scored, and the others are not used.
    assert_eq!((virgin["samples"].as_u64(), known["samples"].as_u64()), (Some(120), Some(80)));
    let mut half = rows("t", -1.0, 0.4, 0.115);
    half.iter_mut().skip(40).for_each(|row| row[2].clear());
    bench.put("half.csv", csv("record,H_A_m,B_T", ",", "\n", &half));
    let simulated = |table: &str| -> Vec<String> {
        let text = bench.succeeds(&format!("simulate found.json {table} --known 40")).stdout;
        text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().to_string()).collect()
    };
    assert_eq!(simulated("half.csv").len(), 120);
    assert_eq!(simulated("half.csv"), simulated("cut.csv"));

    half.iter_mut().for_each(|row| row[2].clear());
    half.extend(rows("later", -1.0, 0.4, 0.115));
    bench.put("blank.csv", csv("record,H_A_m,B_T", ",", "\n", &half));

    bench.refuses_in_part(
        "1 evaluate found.json blank.csv --known 40 => column \"B_T\": is blank in the first 40 rows, from which the state
         1 evaluate found.json cut.csv --known 120 => column \"B_T\" is blank after the known beginning
         1 fit train.csv -o free.json --model masing --known 100000 => column \"B_T\" is blank after the known beginning
         1 validate train.csv --model masing --known 100000 => column \"B_T\" is blank after the known beginning
         2 evaluate found.json cut.csv --known 0 => give a number of rows
         1 evaluate found.json cut.csv --known 0.5s => no unit of time is known
         2 evaluate found.json cut.csv --known 40 --initial-state virgin => cannot be used with
         2 evaluate found.json cut.csv --initial-state free => for free states, --known",
    );
}
