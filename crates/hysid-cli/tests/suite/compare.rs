//! `hysid compare` as a user runs it, and models that are no networks in the other commands.

use hysid_core::elementary::sin;

use crate::workbench::{Workbench, json, must_contain};

#[test]
fn models_are_sorted_by_their_error_on_unseen_data() {
    let bench = Workbench::with_data();
    let models = "prandtl-ishlinskii,pnn,preisach,random-stops,rate-dependent-prandtl-ishlinskii";
    let compared =
        bench.run(&format!("compare good.csv --test good.csv --models {models} --json --rate none"));
    let rows = json(&compared);
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 6);
    let errors: Vec<f64> = rows.iter().filter_map(|row| row["test"]["nrmse_std_percent"].as_f64()).collect();
    assert_eq!(errors.len(), 4);
    assert!(errors.is_sorted(), "{errors:?}");
    // The same data for both: the same errors.
    assert!(rows[..4].iter().all(|row| row["test"] == row["train"]));
    assert!(rows[..4].iter().all(|row| row["simulate_ns_per_sample"].as_f64().unwrap() > 0.0));
    // One that cannot be fitted does not stop the others, and says why.
    for row in &rows[4..] {
        assert_eq!(row["model"], "rate-dependent-prandtl-ishlinskii");
        assert!(row["error"].as_str().unwrap().contains("needs the rate"), "{row}");
    }
    let page = bench.text("good-compared.html");
    must_contain(&page, &["Error against size", "prandtl-ishlinskii", "needs the rate", "<svg"]);
}

#[test]
fn the_table_fits_a_terminal() {
    let bench = Workbench::with_data();
    let ran =
        bench.succeeds("compare good.csv --models gpnn,bouc-wen,generalized-prandtl-ishlinskii --no-report");
    assert!(ran.stdout.lines().all(|line| line.chars().count() <= 80), "{}", ran.stdout);
    assert!(ran.stdout.contains("the training data (name test data with --test)"), "{}", ran.stdout);
    assert!(ran.stderr.contains("6/6"), "{}", ran.stderr);
    assert!(!bench.path("good-compared.html").exists());
}

#[test]
fn a_fit_that_was_stopped_is_marked() {
    let bench = Workbench::with_data();
    let ran = bench.succeeds("compare good.csv --models xpnn+ --time-limit 0.05");
    let row = ran.stdout.lines().find(|line| line.starts_with("xpnn+")).unwrap();
    assert!(row.contains("* "), "{}", ran.stdout);
    for text in [ran.stdout, bench.text("good-compared.html")] {
        assert!(text.contains("* stopped early"), "{text}");
    }
    let whole = bench.run("compare good.csv --models prandtl-ishlinskii --no-report");
    assert!(!whole.stdout.contains('*'), "{}", whole.stdout);
}

#[test]
fn a_law_is_compared_in_all_its_variants() {
    let bench = Workbench::with_data();
    let rows = bench.json("compare good.csv --models bouc-wen --no-report --json --time-limit 2");
    let mut labels: Vec<&str> =
        rows.as_array().unwrap().iter().map(|row| row["label"].as_str().unwrap()).collect();
    labels.sort_unstable();
    let expected = ["bouc-wen", "bouc-wen (degradation)", "bouc-wen (degradation, rate)", "bouc-wen (rate)"];
    assert_eq!(labels, expected);
    assert!(rows.as_array().unwrap().iter().all(|row| row["model"] == "bouc-wen"));
}

/// Two plays under a drive whose amplitude grows and falls; the test record begins after a past of its own.
#[test]
fn a_record_that_begins_in_the_middle_is_told() {
    let bench = Workbench::with_data();
    let drive = |row: usize, phase: f64| {
        let angle = row as f64 * 0.05 + phase;
        sin(angle) * (0.4 + 0.6 * sin(0.0037 * row as f64 + phase).abs())
    };
    let table = |phase: f64, states: [f64; 2]| {
        let (mut text, mut states) = ("x,y\n".to_string(), states);
        for row in 0..1200 {
            let x = drive(row, phase);
            for (state, threshold) in states.iter_mut().zip([0.3, 0.7]) {
                *state = state.clamp(x - threshold, x + threshold);
            }
            text += &format!("{x},{}\n", x + 0.6 * states[0] + 0.5 * states[1]);
        }
        text
    };
    bench.put("train.csv", table(0.0, [0.0, 0.0]));
    bench.put("virgin.csv", table(1.3, [0.0, 0.0]));
    bench.put("cut.csv", table(0.3, [0.9, 0.9]));
    let compare = |test: &str| {
        let models = "prandtl-ishlinskii,masing --no-report";
        let text = bench.succeeds(&format!("compare train.csv --test {test} --models {models}")).stdout;
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let words = "With the best model, record \"cut\": the error falls from";
    let text = compare("cut.csv");
    assert!(text.contains(words) && text.contains("it may begin in the middle"), "{text}");
    for test in ["virgin.csv", "cut.csv --known 100"] {
        let text = compare(test);
        assert!(!text.contains("begin in the middle"), "{test}: {text}");
    }
}

/// A model of one specimen, judged on another: the error is far above that of its validation, and `evaluate` says so.
#[test]
fn data_of_another_specimen_are_told() {
    let bench = Workbench::with_data();
    let table = |threshold: f64, shift: f64| {
        let (mut text, mut state) = ("x,y\n".to_string(), 0.0f64);
        for row in 0..400 {
            let x = sin(0.05 * row as f64 + shift) * (0.3 + 0.7 * row as f64 / 400.0);
            state = state.clamp(x - threshold, x + threshold);
            text += &format!("{x},{}\n", 0.1 * x + state);
        }
        text
    };
    bench.put("own.csv", table(0.2, 0.0));
    bench.put("like.csv", table(0.2, 0.1));
    bench.put("other.csv", table(0.9, 0.1));
    let models = "--model prandtl-ishlinskii --members 3";
    bench.succeeds(&format!("fit own.csv {models} -o own.json --no-report"));
    let told = |test: &str| bench.succeeds(&format!("evaluate own.json {test}")).stderr;
    let words = "far above that of the validation";
    assert!(told("other.csv").contains(words) && !told("like.csv").contains(words), "{}", told("other.csv"));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let bench = Workbench::with_data();
    bench.put("other.csv", "a,b\n1,2\n");
    bench.refuses_in_part(
        "
        2 compare good.csv --models xpnn,presach => presach
        1 compare good.csv --test other.csv --models pnn => other.csv
        1 compare none.csv => none.csv
        2 compare good.csv --models pnn -o good.csv => would be overwritten
    ",
    );
}

#[test]
fn a_law_is_fitted_reported_judged_and_simulated_like_a_network() {
    let bench = Workbench::with_data();
    let ran = bench.succeeds("fit good.csv --model bouc-wen -o law.json --starts 2 --epochs 10");
    assert!(ran.stdout.contains("bouc-wen with 7 parameters; multi-start search"), "{}", ran.stdout);
    let page = bench.text("law.html");
    must_contain(&page, &["Parameters", "yield displacement", "Convergence", "multi-start search"]);
    bench.succeeds("evaluate law.json good.csv");
    let simulated = bench.run("simulate law.json good.csv");
    assert!(simulated.stdout.starts_with("t,x,y,y_model\n"), "{}", simulated.stdout);
    bench.refuses_in_part(
        "
        2 fit good.csv --model bouc-wen --checkpoint c.bin -o m.json => has no checkpoints
        2 fit good.csv --model rate-dependent-prandtl-ishlinskii --rate none -o m.json => needs the rate
        2 fit good.csv --model prandtl-ishlinskii --thresholds 0.2,0.1 -o m.json => threshold
        2 fit good.csv --model preisach --operators 5000 => --operators
        2 fit good.csv --model preisach --operators 300 => operators 300: preisach has at most 200
        2 fit good.csv --model duhem-nn --states 0 => states 0: duhem-nn has at least 1
    ",
    );
    let useless =
        bench.succeeds("fit good.csv --model preisach --starts 3 --degradation --operators 6 -o m.json");
    for option in ["--starts", "--degradation"] {
        assert!(useless.stderr.contains(&format!("preisach ignores {option}")), "{}", useless.stderr);
    }
}
