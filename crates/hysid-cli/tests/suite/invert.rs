//! `hysid invert` as a user runs it.

use std::fs;

use hysid_core::elementary::{cos, sin};

use crate::workbench::{Workbench, cases};

/// The training data: growing loops of a spring beside a friction slider.
fn training() -> Vec<(f64, f64)> {
    let mut slider: f64 = 0.0;
    let mut before = 0.0;
    (0..400)
        .map(|k| {
            let x = sin(0.1 * f64::from(k)) * f64::from(k) / 100.0;
            slider = (slider + x - before).clamp(-0.5, 0.5);
            before = x;
            (x, 2.0 * x + slider)
        })
        .collect()
}

/// A bench with a model of plays, which increases strictly.
fn with_model() -> Workbench {
    let bench = Workbench::new();
    let rows: String = training().iter().map(|(x, y)| format!("{x},{y}\n")).collect();
    bench.put("train.csv", format!("x_mm,F_kN\n{rows}"));
    bench.succeeds("fit train.csv --model prandtl-ishlinskii -o stage.json --no-report");
    bench
}

/// The outputs that are wanted: slow, within what the model reaches.
fn wanted() -> Vec<f64> {
    (0..120).map(|k| 5.0 * sin(0.11 * f64::from(k)) * cos(0.02 * f64::from(k))).collect()
}

/// Puts the reference: time and wanted output.
fn put_wanted(bench: &Workbench) {
    let rows: String =
        wanted().iter().enumerate().map(|(k, y)| format!("{},{y}\n", 0.5 * k as f64)).collect();
    bench.put("wanted.csv", format!("t_s,F_kN\n{rows}"));
}

/// Cells of a column of a table.
fn column(text: &str, name: &str, delimiter: char) -> Vec<String> {
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(delimiter).position(|found| found == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {text}"));
    lines.map(|line| line.split(delimiter).nth(place).unwrap().to_string()).collect()
}

fn numbers(bench: &Workbench, file: &str, name: &str) -> Vec<f64> {
    column(&bench.text(file), name, ',').iter().map(|cell| cell.parse().unwrap()).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_drive_goes_straight_into_a_simulation() {
    let bench = with_model();
    put_wanted(&bench);
    let ran = bench.succeeds("invert stage.json wanted.csv -o drive.csv");
    assert!(ran.stdout.contains("rows reached: 120 of 120 rows"), "{}", ran.stdout);
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
    let header = bench.text("drive.csv").lines().next().unwrap().to_string();
    assert_eq!(header, "t_s,F_kN,x_mm,F_kN_reached,reach,extrapolated");
    bench.succeeds("simulate stage.json drive.csv -o simulated.csv");
    let simulated = numbers(&bench, "simulated.csv", "F_kN_model");
    assert!(largest_difference(&simulated, &wanted()) <= 1e-9 * 10.0);
    assert_eq!(simulated, numbers(&bench, "drive.csv", "F_kN_reached"));
    assert!(column(&bench.text("drive.csv"), "extrapolated", ',').iter().all(|cell| cell == "no"));

    // Its own result is replaced, and the report; the table could be the user's, and is kept.
    let first = bench.text("drive.csv");
    bench.succeeds("invert stage.json wanted.csv -o drive.csv --limits=-1:1");
    assert_eq!(bench.text("drive.csv.bak"), first);
    assert_eq!(
        bench.files(""),
        [
            "drive.csv",
            "drive.csv.bak",
            "drive.html",
            "simulated.csv",
            "stage.json",
            "train.csv",
            "wanted.csv"
        ]
    );
}

#[test]
fn a_reference_that_has_the_input_keeps_it() {
    let bench = with_model();
    bench.succeeds("invert stage.json train.csv -o drive.csv --no-report");
    let drive = bench.text("drive.csv");
    assert!(drive.starts_with("x_mm,F_kN,x_mm_inverse,F_kN_reached,reach,extrapolated\n"), "{drive}");
    let (given, found) = (numbers(&bench, "drive.csv", "x_mm"), numbers(&bench, "drive.csv", "x_mm_inverse"));
    assert_eq!(given[1..], training().iter().map(|row| row.0).collect::<Vec<f64>>()[1..]);
    assert!(largest_difference(&given, &found) < 0.5);
    assert!(!bench.path("drive.html").exists());
}

#[test]
fn limits_and_a_slew_limit_bound_the_input_and_the_reason_is_given() {
    let bench = with_model();
    put_wanted(&bench);
    let ran = bench.succeeds("invert stage.json wanted.csv -o drive.csv --limits=-1:1.5");
    let drive = numbers(&bench, "drive.csv", "x_mm");
    let reach = column(&bench.text("drive.csv"), "reach", ',');
    for (x, reach) in drive.iter().zip(&reach) {
        match reach.as_str() {
            "low-limit" => assert_eq!(*x, -1.0),
            "high-limit" => assert_eq!(*x, 1.5),
            reach => assert!(reach == "reached" && (-1.0..=1.5).contains(x), "{reach} {x}"),
        }
    }
    for word in ["low-limit", "high-limit"] {
        let count = reach.iter().filter(|found| *found == word).count();
        assert!(count > 0 && ran.stderr.contains(&format!("{word} {count}")), "{}", ran.stderr);
    }
    assert!(ran.stderr.contains("the model does not follow the reference"), "{}", ran.stderr);

    let ran = bench.succeeds("invert stage.json wanted.csv -o drive.csv --slew 0.3");
    let drive = numbers(&bench, "drive.csv", "x_mm");
    assert!(drive.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 0.15 + 1e-12));
    assert!(ran.stderr.contains("at most 0.3 mm/s\n"), "{}", ran.stderr);
    let slewing =
        column(&bench.text("drive.csv"), "reach", ',').iter().filter(|cell| *cell == "slew").count();
    assert!(slewing > 0 && ran.stderr.contains(&format!("slew {slewing}")), "{}", ran.stderr);
}

#[test]
fn each_record_begins_in_the_initial_state() {
    let bench = with_model();
    let rows =
        |record: &str| -> String { wanted().iter().take(40).map(|y| format!("{record},{y}\n")).collect() };
    bench.put("wanted.csv", format!("record,F_kN\n{}{}", rows("a"), rows("b")));
    bench.succeeds("invert stage.json wanted.csv -o drive.csv");
    let drive = numbers(&bench, "drive.csv", "x_mm");
    assert_eq!(drive[..40], drive[40..]);
    let page = bench.text("drive.html");
    assert!(page.contains(">a<") || page.contains(">a "), "the records are named");
}

#[test]
fn each_record_of_a_model_that_lags_has_its_preview() {
    let bench = Workbench::new();
    bench.succeeds("generate magnetostrictive-actuator -o train.csv --test test.csv");
    let fit = "fit train.csv --model rate-dependent-prandtl-ishlinskii -o stage.json --no-report";
    bench.succeeds(fit);
    let table = bench.text("test.csv");
    let rows = table.lines().filter(|line| !line.ends_with(','));
    bench.put("wanted.csv", rows.collect::<Vec<_>>().join("\n"));
    let previews = |arguments: &str| -> Vec<f64> {
        let answer = bench.json(&format!("invert stage.json wanted.csv -o drive.csv --json {arguments}"));
        serde_json::from_value(answer["previews"].clone()).unwrap()
    };
    let found = previews("");
    assert!(
        found.len() == 2 && found.iter().all(|preview| *preview > 0.0) && found[0] != found[1],
        "{found:?}"
    );
    assert_eq!(previews("--preview 0.0005"), [0.0005; 2]);
    let ran = bench.succeeds("invert stage.json wanted.csv -o drive.csv");
    assert!(ran.stderr.contains(" s, by record (chosen; change: --preview)"), "{}", ran.stderr);
    let ran = bench.succeeds("invert stage.json wanted.csv -o drive.csv --preview 1e300");
    assert!(ran.stderr.contains("the model does not follow the reference"), "{}", ran.stderr);
}

#[test]
fn further_inputs_are_read_from_the_reference() {
    let bench = Workbench::new();
    let heat = |k: usize| cos(0.013 * k as f64);
    let rows: String = training()
        .iter()
        .enumerate()
        .map(|(k, (x, y))| format!("{x},{},{}\n", heat(k), y + 0.5 * heat(k)))
        .collect();
    bench.put("train.csv", format!("x_mm,T_C,F_kN\n{rows}"));
    bench.succeeds(
        "fit train.csv --input x_mm --input T_C --model xpnn+ --starts 1 --epochs 40 -o two.json --no-report",
    );
    let rows: String =
        wanted().iter().enumerate().map(|(k, y)| format!("{},{}\n", heat(k), 0.5 * y)).collect();
    bench.put("wanted.csv", format!("T_C,F_kN\n{rows}"));
    bench.succeeds("invert two.json wanted.csv -o drive.csv");
    let header = bench.text("drive.csv").lines().next().unwrap().to_string();
    assert_eq!(header, "T_C,F_kN,x_mm,F_kN_reached,reach,extrapolated");
    bench.succeeds("simulate two.json drive.csv -o simulated.csv");
    let reached = numbers(&bench, "drive.csv", "F_kN_reached");
    let simulated = numbers(&bench, "simulated.csv", "F_kN_model");
    assert!(largest_difference(&reached, &simulated) <= 1e-9);
    bench.put("without.csv", "t_s,F_kN\n0,1\n1,2\n");
    refused(&bench, "two.json without.csv", 1, "without.csv: there is no column \"T_C\"");
}

#[test]
fn a_table_with_semicolons_and_decimal_commas_stays_one() {
    let bench = with_model();
    let comma = |value: f64| value.to_string().replace('.', ",");
    let rows: String = wanted().iter().map(|y| format!("\"remark; {y:.0}\";{}\r\n", comma(*y))).collect();
    bench.put("wanted.csv", format!("\u{feff}remark;F_kN\r\n{rows}"));
    bench.succeeds("invert stage.json wanted.csv -o drive.csv");
    let drive = bench.text("drive.csv");
    assert!(drive.starts_with("remark;F_kN;x_mm;F_kN_reached;reach;extrapolated"), "{drive}");
    let second = drive.lines().nth(2).unwrap();
    assert!(second.starts_with("\"remark; 1\";0,54") && !second.contains('.'), "{second}");
    put_wanted(&bench);
    bench.succeeds("invert stage.json wanted.csv -o point.csv");
    bench.succeeds("simulate stage.json drive.csv -o simulated.csv");
    let simulated: Vec<f64> = column(&bench.text("simulated.csv").replace("remark; ", ""), "F_kN_model", ';')
        .iter()
        .map(|cell| cell.replace(',', ".").parse().unwrap())
        .collect();
    assert_eq!(simulated, numbers(&bench, "point.csv", "F_kN_reached"));
}

#[test]
fn a_reference_in_another_unit_is_converted() {
    let bench = with_model();
    let rows: String = wanted().iter().map(|y| format!("{}\n", 1000.0 * y)).collect();
    bench.put("newton.csv", format!("F_N\n{rows}"));
    let ran = bench.succeeds("invert stage.json newton.csv -o drive.csv");
    assert!(ran.stderr.contains("F_N"), "{}", ran.stderr);
    put_wanted(&bench);
    bench.succeeds("invert stage.json wanted.csv -o kilonewton.csv");
    let (a, b) = (numbers(&bench, "drive.csv", "x_mm"), numbers(&bench, "kilonewton.csv", "x_mm"));
    assert!(largest_difference(&a, &b) <= 1e-9);
    bench.put("second.csv", "F_s\n1\n2\n");
    refused(&bench, "stage.json second.csv --output F_s", 1, "F_s");
}

#[test]
fn a_band_gives_the_inputs_whose_band_contains_the_wanted_output() {
    let bench = with_model();
    put_wanted(&bench);
    refused(&bench, "stage.json wanted.csv --band 0.9", 1, "this model has no prediction band");
    let fit = "fit train.csv --model xpnn --members 3 --starts 3 --epochs 20 -o many.json --no-report";
    bench.succeeds(fit);
    bench.succeeds("invert many.json wanted.csv -o drive.csv --band 0.9");
    let header = bench.text("drive.csv").lines().next().unwrap().to_string();
    assert_eq!(header, "t_s,F_kN,x_mm,x_mm_low,x_mm_high,F_kN_reached,reach,extrapolated");
    let [low, high] = ["x_mm_low", "x_mm_high"].map(|name| numbers(&bench, "drive.csv", name));
    assert!(low.iter().zip(&high).all(|(low, high)| low <= high));
    assert!(low.iter().zip(&high).any(|(low, high)| low < high));
    assert!(bench.text("drive.html").contains("90 % band"));
}

#[test]
fn the_result_as_json_and_the_table_on_stdout() {
    let bench = with_model();
    put_wanted(&bench);
    let answer = bench.json("invert stage.json wanted.csv -o drive.csv --json --limits=-1:1");
    let mut names: Vec<&String> = answer.as_object().unwrap().keys().collect();
    names.sort();
    let names = names.into_iter().map(String::as_str).collect::<Vec<_>>().join(" ");
    assert_eq!(
        names,
        "drive drive_range errors expected_rmse extrapolated not_reached previews reached records report rows"
    );
    let count = |reach: &str| answer["not_reached"][reach].as_u64().unwrap();
    assert_eq!(answer["reached"].as_u64().unwrap() + count("low-limit") + count("high-limit"), 120);
    assert_eq!(answer["drive_range"], serde_json::json!([-1.0, 1.0]));
    assert_eq!(answer["previews"], serde_json::json!([0.0]));
    assert_eq!((&answer["drive"], &answer["report"]), (&"drive.csv".into(), &"drive.html".into()));
    assert_eq!(answer["errors"]["samples"], 120);

    let table = bench.text("drive.csv");
    for out in ["", "-o -"] {
        let ran = bench.succeeds(&format!("invert stage.json wanted.csv --limits=-1:1 {out}"));
        assert_eq!(ran.stdout, table);
    }
    assert!(!bench.path("-").exists() && !bench.path("-.html").exists());
}

#[test]
fn the_report_is_self_contained_and_has_the_numbers() {
    let bench = with_model();
    put_wanted(&bench);
    bench.succeeds("invert stage.json wanted.csv -o drive.csv --limits=-1:1.5");
    let page = bench.text("drive.html");
    let reached =
        column(&bench.text("drive.csv"), "reach", ',').iter().filter(|cell| *cell == "reached").count();
    for text in [
        &format!("{reached} of 120 rows are reached"),
        "Inverse of prandtl-ishlinskii",
        "high-limit: the wanted output is beyond that of the highest input",
        "not reached",
        "F_kN of wanted.csv",
    ] {
        assert!(page.contains(text), "{text}");
    }
    for outside in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

/// Runs a request that is refused in one line, and leaves no files.
fn refused(bench: &Workbench, arguments: &str, status: i32, text: &str) {
    let before = bench.files("");
    let ran = bench.run(&format!("invert {arguments}"));
    assert_eq!(ran.status, Some(status), "{arguments}: {}", ran.stderr);
    let line = ran.last_line();
    assert!(line.starts_with("error: ") && line.contains(text), "{arguments}: {}", ran.stderr);
    // With --json, stdout has the error as an object.
    assert_eq!(
        ran.stdout.contains("\"error\": "),
        arguments.contains("--json"),
        "{arguments}: {}",
        ran.stdout
    );
    assert!(ran.stdout.is_empty() || arguments.contains("--json"), "{arguments}: {}", ran.stdout);
    assert_eq!(bench.files(""), before, "{arguments}");
}

#[test]
fn bad_references_are_refused_with_their_place() {
    let bench = with_model();
    bench.put("blank.csv", "t_s,F_kN\n0,1\n1,\n2,1\n");
    bench.put("word.csv", "t_s,F_kN\n0,1\n1,high\n2,1\n");
    bench.put("other.csv", "t_s,force\n0,1\n1,2\n");
    bench.put("unsorted.csv", "t_s,F_kN\n0,1\n2,1.5\n1,1\n");
    bench.put("one.csv", "t_s,F_kN\n0,1\n");
    bench.put("none.csv", "t_s,F_kN\n");
    bench.put("empty.csv", "");
    bench.put("taken.csv", "F_kN,reach\n1,far\n2,far\n");
    bench.put("taken_too.csv", "F_kN,x_mm,x_mm_inverse\n1,1,1\n2,2,2\n");
    bench.put("both.csv", "F_kN,x_mm\n1,1\n2,2\n");
    for (status, arguments, text) in cases(
        r#"
        1 stage.json blank.csv -o d.csv => blank.csv, line 3, column "F_kN": the cell is empty
        1 stage.json word.csv -o d.csv => word.csv, line 3, column "F_kN"
        1 stage.json other.csv -o d.csv => other.csv: there is no column "F_kN", the model's output
        1 stage.json unsorted.csv -o d.csv --slew 1 => unsorted.csv, line 4
        1 stage.json both.csv -o d.csv --slew 1 => both.csv: there is no column of time, which the rate, a slew limit
        1 stage.json none.csv -o d.csv => none.csv
        1 stage.json empty.csv -o d.csv => empty.csv
        1 stage.json missing.csv -o d.csv => missing.csv
        1 missing.json one.csv -o d.csv => missing.json
        1 stage.json taken.csv -o d.csv => taken.csv: there is already a column "reach"
        1 stage.json taken_too.csv -o d.csv => taken_too.csv: there is already a column "x_mm_inverse"
        2 stage.json one.csv --json => --json prints to stdout in place of the table
        2 stage.json one.csv --limits 3:1 => the low limit 3 is not below the high one
        2 stage.json one.csv --input F_kN -o d.csv => the model has no further inputs; leave --input away
        2 stage.json one.csv --slew 0 => a number above 0 is needed
        2 stage.json one.csv --preview soon => `auto` or a time of 0 or more is needed
        2 stage.json one.csv -o train.csv => train.csv
        2 stage.json one.csv -o one.csv => one.csv
    "#,
    ) {
        refused(&bench, arguments, status, text);
    }
    // Of a single row there is an input.
    let ran = bench.succeeds("invert stage.json one.csv -o d.csv");
    assert!(ran.stdout.contains("rows reached: 1 of 1 row;"), "{}", ran.stdout);
}

#[test]
fn a_foreign_file_is_replaced_by_force_only() {
    let bench = with_model();
    put_wanted(&bench);
    for file in ["drive.csv", "drive.html"] {
        bench.put(file, "mine");
        refused(&bench, "stage.json wanted.csv -o drive.csv", 2, file);
        assert_eq!(bench.text(file), "mine");
        fs::remove_file(bench.path(file)).unwrap();
    }
    bench.put("drive.csv", "mine");
    bench.succeeds("invert stage.json wanted.csv -o drive.csv --force");
    assert_ne!(bench.text("drive.csv"), "mine");
}

/// The rate of the drive is formed from the drive: a column with the rate of the measured input is not needed.
#[test]
fn a_model_with_a_measured_rate_is_inverted_with_time() {
    let bench = Workbench::new();
    let mut text = String::from("t,x,v,y\n");
    for row in 0..300 {
        let t = 0.01 * f64::from(row);
        let (x, v) = (sin(6.0 * t) * (1.0 + 0.2 * t), 6.0 * cos(6.0 * t));
        text += &format!("{t},{x},{v},{}\n", 2.0 * x + 0.01 * v);
    }
    bench.put("loops.csv", text);
    bench.succeeds(
        "fit loops.csv --rate v --model xpnn --starts 1 --epochs 20 --stops 4 --hidden 4 -o m.json --no-report",
    );
    bench.put("wanted.csv", "t,y\n0,0.1\n0.01,0.2\n0.02,0.3\n");
    bench.succeeds("invert m.json wanted.csv -o drive.csv");
    bench.put("untimed.csv", "y\n0.1\n0.2\n");
    let ran = bench.run("invert m.json untimed.csv -o drive2.csv");
    assert_eq!(ran.status, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("time") || ran.stderr.contains("column"), "{}", ran.stderr);
}
