//! Choice by validation, ensembles with their bands, and cross-validation, as a user runs them.

use std::time::{Duration, Instant};

use crate::workbench::{ROWS, Ran, Workbench, csv, json, rows};
use serde_json::Value;

/// An ensemble that takes well below a second.
const QUICK: &str = "--model xpnn --members 3 --epochs 10";

fn assert_narrow(text: &str) {
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn an_ensemble_tells_its_members_and_what_they_cost() {
    let bench = Workbench::with_data();
    let fit = bench.json(&format!("fit good.csv -o e.json {QUICK} --json"));
    let members = fit["members"].as_array().unwrap();
    assert_eq!(members.len(), 3);
    for member in members {
        assert_eq!((&member["family"], &member["stops"]), (&"xpnn".into(), &10.into()), "{member}");
    }
    let parameters = members.iter().map(|member| member["parameters"].as_u64().unwrap()).sum::<u64>();
    assert_eq!(fit["parameters"].as_u64(), Some(parameters));
    assert_eq!(fit["selection"]["candidates"].as_array().unwrap().len(), 1);
    assert_eq!(fit["selection"]["folds"].as_array().unwrap().len(), 3);

    let page = bench.text("e.html");
    for words in [
        "The ensemble",
        "ns per sample",
        "whole ensemble",
        "Folds: 3 parts",
        "The prediction band",
        "90 % band",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.contains("<polygon"), "the band is drawn");
    assert!(!page.contains("Convergence"), "this is of single models");
    let told = bench.run(&format!("fit good.csv -o e.json {QUICK}"));
    assert_narrow(&told.stdout);
    for words in [
        "\nchosen ensemble of 3 networks",
        "\nwhy    error on the rows held out (RMSE in % of std): ensemble",
        "\nensemble of 3 xpnn with ",
    ] {
        assert!(told.stdout.contains(words), "{words}: {}", told.stdout);
    }
}

#[test]
fn the_band_stands_in_columns_and_its_coverage_is_counted() {
    let bench = Workbench::with_data();
    bench.succeeds(&format!("fit good.csv -o e.json --no-report {QUICK}"));
    let simulated = bench.run("simulate e.json good.csv --band 0.6");
    let mut lines = simulated.stdout.lines();
    assert_eq!(lines.next(), Some("t,x,y,y_model,y_low,y_high"), "{}", simulated.stderr);
    let mut covered = 0;
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [y, model, low, high] = cells[2..] else { panic!("{line}") };
        assert!(low < model && model < high, "{line}");
        covered += usize::from((low..=high).contains(&y));
    }
    let evaluated = bench.json("evaluate e.json good.csv --band 0.6 --json");
    let percent = 100.0 * covered as f64 / ROWS as f64;
    assert_eq!(evaluated["band"]["coverage_percent"].as_f64(), Some(percent), "{evaluated}");
    assert_eq!(evaluated["band"]["samples"].as_u64(), Some(ROWS as u64));
    let told = bench.run("evaluate e.json good.csv --band 0.6").stdout;
    assert!(told.contains("of the measured outputs lie within the band of 60 %\n"), "{told}");
    let of_nine = bench.json("evaluate e.json good.csv --band 0.6 --in 9-of-10 --json");
    assert_eq!((evaluated["band"].get("of_ten"), &of_nine["band"]["of_ten"]), (None, &9.into()));
    assert!(of_nine["band"]["coverage_percent"].as_f64() >= Some(percent), "{of_nine}");
    let told = bench.run("evaluate e.json good.csv --band 0.6 --in 9-of-10").stdout;
    assert!(told.contains("lie within the band of 60 % in 9 of 10 data sets\n"), "{told}");
    let wide = bench.run("simulate e.json good.csv --band 0.6 --in 9-of-10");
    let halves = |ran: &Ran| -> Vec<f64> {
        let rows = ran.stdout.lines().skip(1).map(|line| line.split(',').map(str::parse));
        let rows = rows.map(|cells| cells.collect::<Result<Vec<f64>, _>>().unwrap());
        rows.map(|cells| cells[5] - cells[3]).collect()
    };
    let (narrow, wide) = (halves(&simulated), halves(&wide));
    let factor = wide[0] / narrow[0];
    assert!(factor > 1.5 && factor < 3.0, "{factor}");
    assert!(narrow.iter().zip(&wide).all(|(narrow, wide)| (wide / narrow - factor).abs() < 1e-6));
    assert_eq!(bench.run("simulate e.json good.csv --band 0.6 --in 5-of-10").stdout, simulated.stdout);
    // The model's own column is the same with and without a band.
    let column = |ran: &Ran| -> Vec<String> {
        ran.stdout.lines().map(|line| line.split(',').nth(3).unwrap().to_string()).collect()
    };
    assert_eq!(column(&simulated), column(&bench.run("simulate e.json good.csv")));
}

#[test]
fn a_band_that_is_not_there_is_refused() {
    let bench = Workbench::with_model();
    bench.put("taken.csv", csv("t,x,y_low", ",", "\n", &rows()));
    bench.refuses_in_part(
        "
        1 simulate model.json good.csv --band 0.9 => model.json: this model has no prediction band
        1 evaluate model.json good.csv --band 0.9 => model.json: this model has no prediction band
        2 simulate model.json good.csv --band 0.3 => a probability from 0.5 to 0.99 is needed
        2 evaluate model.json good.csv --band much => a probability from 0.5 to 0.99 is needed
        2 evaluate model.json good.csv --band 0.9 --in 10-of-10 => choose 5-of-10 to 9-of-10
        2 simulate model.json good.csv --band 0.9 --in 9 => choose 5-of-10 to 9-of-10
    ",
    );
    bench.succeeds(&format!("fit good.csv -o e.json --no-report {QUICK}"));
    let taken = bench.run("simulate e.json taken.csv --band 0.9");
    assert_eq!(
        taken.last_line(),
        "error: taken.csv: there is already a column \"y_low\" (rename or remove it)"
    );
}

/// Of all candidates those that see a compressed input without rate, which are few.
#[test]
fn auto_chooses_among_kinds_and_is_the_same_for_any_number_of_threads() {
    let bench = Workbench::with_data();
    let fit = |options: &str| {
        let ran = bench
            .succeeds(&format!("fit good.csv -o a.json --rate none --compression 0.1 --epochs 4 {options}"));
        (ran, bench.text("a.json"))
    };
    let (ran, model) = fit("--members 5");
    assert_narrow(&ran.stdout);
    assert!(ran.stderr.contains("model    auto: at most 5 models"), "{}", ran.stderr);
    let page = bench.text("a.html");
    assert!(page.contains("random-stops (input compressed 0.1)") && page.contains(">classical</td>"));
    assert_eq!(model, fit("--members 5 --no-report --threads 1").1);

    // One model in the place of many.
    let (ran, _) = fit("--members 1");
    assert!(ran.stdout.contains("\nchosen one "), "{}", ran.stdout);
    assert!(bench.text("a.html").contains("How it was chosen"));
    let evaluated = bench.json("evaluate a.json good.csv --json --band 0.9");
    assert!(evaluated["band"]["coverage_percent"].as_f64().unwrap() > 50.0, "{evaluated}");
}

#[test]
fn auto_keeps_its_time_limit_and_says_where_it_is() {
    let bench = Workbench::with_data();
    let began = Instant::now();
    let ran = bench.run("fit good.csv -o a.json --no-report --threads 1 --time-limit 2.5 --json");
    assert!(began.elapsed() < Duration::from_secs(12), "{:?}", began.elapsed());
    assert_eq!(json(&ran)["termination"], "stopped");
    assert!(ran.stderr.contains(" % fitting "), "{}", ran.stderr);
    bench.succeeds("evaluate a.json good.csv");
}

#[test]
fn compare_begins_with_auto_and_tells_structures() {
    let bench = Workbench::with_data();
    let rows = bench.json("compare good.csv --time-limit 0.05 --rate none --no-report --json");
    let row = |model: &str| {
        let found = rows.as_array().unwrap().iter().find(|row| row["model"] == model);
        found.unwrap_or_else(|| panic!("{model}: {rows}")).clone()
    };
    assert!(row("auto")["train"]["nrmse_std_percent"].as_f64().unwrap() > 0.0);
    assert_eq!(row("preisach-nn")["structure"], "10 stops, 10 hidden");
    assert_eq!(row("preisach")["structure"], Value::Null);
}

#[test]
fn folds_are_told_one_by_one_and_together() {
    let bench = Workbench::with_data();
    let command = "validate good.csv --model prandtl-ishlinskii";
    let ran = bench.succeeds(command);
    assert_narrow(&ran.stdout);
    let lines: Vec<&str> = ran.stdout.lines().collect();
    let heading: Vec<&str> = lines[0].split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
    assert_eq!(heading, ["held out", "train %", "unseen %", "train RMSE", "unseen RMSE"]);
    assert!(lines[5].starts_with("35 to 65 %, from the rest"), "{}", ran.stdout);
    assert!(lines[6].starts_with("all folds") && lines[7].is_empty(), "{}", ran.stdout);
    assert!(ran.stdout.contains("prandtl-ishlinskii: 5 folds in "), "{}", ran.stdout);
    assert!(ran.stderr.contains("fold 5 of 5: "), "{}", ran.stderr);

    let found = bench.json(&format!("{command} --json"));
    let folds = found["folds"].as_array().unwrap();
    assert_eq!((folds.len(), found["folds_in_all"].as_u64()), (5, Some(5)));
    assert!(found["unseen"]["nrmse_std_percent"].as_f64().unwrap() > 0.0, "{found}");
}

#[test]
fn records_are_held_out_in_turn() {
    let bench = Workbench::new();
    let named = rows().into_iter().enumerate().map(|(k, mut row)| {
        row[0] = format!("test {}", k / 15);
        row
    });
    bench.put("four.csv", csv("record,x_mm,F_kN", ",", "\n", &named.collect::<Vec<_>>()));
    let ran = bench.succeeds("validate four.csv --model pnn --starts 1 --epochs 3 --folds 2 --population 9");
    assert!(ran.stdout.contains("test 0, test 2") && ran.stdout.contains("unseen kN"), "{}", ran.stdout);
    // The same warnings as fit.
    assert!(ran.stderr.contains("subgradient ignores --population"), "{}", ran.stderr);

    bench.put(
        "few.csv",
        csv("x,y", ",", "\n", &rows()[..20].iter().map(|row| row[1..].to_vec()).collect::<Vec<_>>()),
    );
    let few = bench.run("validate few.csv --model pnn");
    assert_eq!(few.status, Some(1));
    assert!(few.last_line().starts_with("error: few.csv: too few data to hold any out"), "{}", few.stderr);
    assert_eq!(bench.run("validate four.csv --folds 1").status, Some(2));
}

/// A fit that takes minutes, of many cheap iterations.
const LONG: &str = "--model xpnn+ --stops 20 --hidden 20 --starts 20 --epochs 100000";

#[test]
fn each_fold_has_its_time() {
    let ran = Workbench::with_data().succeeds(&format!("validate good.csv {LONG} --time-limit 0.2"));
    assert!(ran.stdout.contains("xpnn+: 5 folds, 5 of them ended by the time limit, in "), "{}", ran.stdout);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_folds_that_are_done() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let bench = Workbench::with_data();
    let mut command = bench.command(&format!("validate good.csv {LONG} --time-limit 1.5"));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(stderr.any(|line| line.starts_with("fold 1 of 5: ")));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let last = stderr.last().unwrap();
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert_eq!((ran.status, last.as_str()), (Some(130), "interrupted: 1 of 5 folds are finished"));
    assert!(ran.stdout.contains("50 to 75 %") && !ran.stdout.contains("60 to 90 %"), "{}", ran.stdout);
}
