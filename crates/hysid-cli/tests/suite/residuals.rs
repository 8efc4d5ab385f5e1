//! Tests of the residual and intervals of parameters, as a user meets them.

use std::fmt::Write;

use crate::workbench::Workbench;
use hysid_core::elementary::sin;
use serde_json::Value;

/// Numbers that look random, between -1 and 1.
fn noise(row: usize) -> f64 {
    let mixed = (row as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1_e995;
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((mixed ^ (mixed >> 32)) & 0xffff_ffff) as f64 / f64::from(1u32 << 31) - 1.0
}

/// Loops of a spring beside a slider that also resists the rate, with noise; `first` numbers the noise.
fn table(rows: usize, viscosity: f64, first: usize) -> String {
    let mut text = "t_s,x_mm,force_kN\n".to_string();
    let x = |row: usize| (0.3 + 0.7 * (3.0 * row as f64 / rows as f64).fract()) * sin(0.06 * row as f64);
    let mut play = 0.0f64;
    for row in 0..rows {
        play = play.clamp(x(row) - 0.2, x(row) + 0.2);
        let rate = (x(row + 1) - x(row)) / 0.01;
        let force = 0.1 + x(row) + 0.8 * play + viscosity * rate + 0.05 * noise(first + row);
        writeln!(text, "{},{},{force}", 0.01 * row as f64, x(row)).unwrap();
    }
    text
}

const FIT: &str = "fit train.csv -o law.json --model prandtl-ishlinskii --thresholds 0.2,0.5";

/// A fitted law, data of the same specimen, and data of one that resists the rate too.
fn bench() -> (Workbench, Value) {
    let bench = Workbench::new();
    bench.put("train.csv", table(2000, 0.0, 0));
    bench.put("same.csv", table(2000, 0.0, 5000));
    bench.put("viscous.csv", table(2000, 0.05, 9000));
    let fit = bench.json(&format!("{FIT} --json"));
    (bench, fit)
}

fn finding<'v>(residuals: &'v Value, test: &str) -> &'v Value {
    residuals["findings"].as_array().unwrap().iter().find(|finding| finding["test"] == test).unwrap()
}

#[test]
fn evaluate_says_what_the_residual_tells_and_what_helps() {
    let (bench, _) = bench();
    let told = bench.succeeds("evaluate law.json viscous.csv --residuals");
    assert!(told.stdout.contains("The residual is correlated with the rate of x"), "{}", told.stdout);
    assert!(told.stdout.contains("\nrate-correlation "), "{}", told.stdout);
    assert!(told.stdout.contains("option rate") && told.stdout.contains("RMSE of force_kN, kN"), "{told}");
    assert!(told.stdout.lines().all(|line| line.chars().count() <= 80), "{}", told.stdout);

    let viscous = bench.json("evaluate law.json viscous.csv --residuals --json");
    assert_eq!(finding(&viscous["residuals"], "rate-correlation")["verdict"], "found");
    let same = bench.json("evaluate law.json same.csv --residuals --json");
    for finding in same["residuals"]["findings"].as_array().unwrap() {
        assert_ne!(finding["verdict"], "found", "{finding}");
    }
    // The RMS of the residual is the error of the run.
    let (rms, rmse) = (same["residuals"]["rms"].as_f64().unwrap(), same["rmse"].as_f64().unwrap());
    assert!((rms - rmse).abs() < 1e-9 * rmse);
    // Without the option nothing is tested.
    assert!(bench.json("evaluate law.json same.csv --json").get("residuals").is_none());
    assert!(!bench.run("evaluate law.json same.csv").stdout.contains("whiteness"));
}

#[test]
fn data_that_the_model_knows_and_short_data_are_told_apart() {
    let (bench, _) = bench();
    let known = bench.json("evaluate law.json train.csv --residuals --json");
    assert!(known["residuals"]["caution"].as_str().unwrap().contains("was fitted to these data"));
    let short: Vec<String> = table(2000, 0.0, 0).lines().take(31).map(String::from).collect();
    bench.put("short.csv", short.join("\n"));
    let refused = bench.run("evaluate law.json short.csv --residuals");
    assert_eq!(refused.status, Some(1));
    assert!(refused.last_line().contains("short.csv: has only 30 rows with an output"), "{}", refused.stderr);
    bench.succeeds("evaluate law.json short.csv");
}

/// Records, and more rows than a block of the run holds.
#[test]
fn records_of_a_table_are_tested_together() {
    let (bench, _) = bench();
    let mut text = "record,t_s,x_mm,force_kN\n".to_string();
    for (name, first) in [("a", 100), ("b", 20_000)] {
        table(6000, 0.0, first).lines().skip(1).for_each(|line| writeln!(text, "{name},{line}").unwrap());
    }
    bench.put("records.csv", text);
    let found = bench.json("evaluate law.json records.csv --residuals --json");
    assert_eq!((&found["residuals"]["rows"], &found["residuals"]["records"]), (&12_000.into(), &2.into()));
    assert_eq!(finding(&found["residuals"], "whiteness")["verdict"], "not found");
}

#[test]
fn a_law_has_intervals_in_json_and_on_its_page() {
    let (bench, fit) = bench();
    let parameters = fit["intervals"]["parameters"].as_array().unwrap();
    let of = |symbol: &str| parameters.iter().find(|parameter| parameter["symbol"] == symbol).unwrap();
    for (symbol, value) in [("c", 0.1), ("w_0", 1.0), ("w_1", 0.8)] {
        let error = of(symbol)["standard_error"].as_f64().unwrap();
        assert!((of(symbol)["value"].as_f64().unwrap() - value).abs() < 4.0 * error, "{}", of(symbol));
        assert_eq!(of(symbol)["status"], "determined");
    }
    assert_eq!((&of("r_1")["status"], &of("r_1")["low"]), (&"not fitted".into(), &Value::Null));
    let data: Vec<&str> =
        fit["residuals"].as_array().unwrap().iter().map(|one| one["data"].as_str().unwrap()).collect();
    assert_eq!(data, ["training"]);

    let page = bench.text("law.html");
    for words in
        ["95 % interval", "not fitted", "What the model leaves unexplained", "Residual on the training data"]
    {
        assert!(page.contains(words), "{words}");
    }
    // Without a title of its own, the page has that of the data and the model.
    assert!(page.contains("<h1>Force over x: prandtl-ishlinskii</h1>"));
    bench.succeeds(&format!("{FIT} --force --title Wall"));
    assert!(bench.text("law.html").contains("<h1>Wall</h1>"));
    let again = bench.json(&format!("{FIT} --json --threads 2"));
    assert_eq!((&again["intervals"], &again["residuals"]), (&fit["intervals"], &fit["residuals"]));
}

#[test]
fn a_network_has_held_out_residuals_and_no_intervals() {
    let bench = Workbench::new();
    bench.put("train.csv", table(600, 0.0, 0));
    let fit = "fit train.csv -o m.json --json --model pnn --stops 3 --epochs 20";
    for options in ["--starts 2", "--starts 2 --members 2", "--starts 1"] {
        let fit = bench.json(&format!("{fit} {options}"));
        assert!(fit.get("intervals").is_none());
        let residuals = fit["residuals"].as_array().unwrap();
        if fit["validation"].is_null() {
            assert_eq!(residuals.len(), 1, "{options}");
            continue;
        }
        assert_eq!(residuals[1]["data"], "held-out", "{options}");
        assert!(residuals[1]["rows"].as_u64().unwrap() > 300);
        // Rows of two folds count once there and twice in the validation.
        let (rms, rmse) =
            (residuals[1]["rms"].as_f64().unwrap(), fit["validation"]["rmse"].as_f64().unwrap());
        assert!((0.5..2.0).contains(&(rms / rmse)), "{options}: {rms} {rmse}");
        assert!(bench.text("m.html").contains("Residual on the held-out data"), "{options}");
    }
}
