//! Which column is what, where no option says so: guesses are told before the fit, and bad ones are refused.

use crate::workbench::{Workbench, csv, rows};

const QUICK: &str = "--no-report --model xpnn+ --starts 1 --epochs 1 -o out.json";

/// The record with further cells before or behind each row's own.
fn table(header: &str, cells: impl Fn(usize, [f64; 3]) -> Vec<String>) -> String {
    let rows = rows().into_iter().enumerate().map(|(k, row)| {
        let numbers: Vec<f64> = row.iter().map(|cell| cell.parse().unwrap()).collect();
        cells(k, [numbers[0], numbers[1], numbers[2]])
    });
    csv(header, ",", "\n", &rows.collect::<Vec<_>>())
}

fn texts(cells: &[&dyn ToString]) -> Vec<String> {
    cells.iter().map(|cell| cell.to_string()).collect()
}

#[track_caller]
fn told(data: String, options: &str, lines: &[&str]) {
    let bench = Workbench::new();
    bench.put("data.csv", data);
    let ran = bench.run(&format!("fit data.csv {QUICK} {options}"));
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    for line in lines {
        assert!(ran.stderr.contains(line), "{line}\n{}", ran.stderr);
    }
}

#[track_caller]
fn refused(data: String, options: &str, line: &str) {
    let bench = Workbench::new();
    bench.put("data.csv", data);
    let ran = bench.run(&format!("fit data.csv {QUICK} {options}"));
    assert_eq!((ran.last_line(), ran.status), (line, Some(1)), "{}", ran.stderr);
    assert!(!bench.path("out.json").exists());
}

#[test]
fn time_has_many_names() {
    for name in ["timestamp", "elapsed", "Zeit", "Elapsed Time (sec)", "clock_ms", "time [sec]"] {
        let data = table(&format!("{name},x,y"), |_, [t, x, y]| texts(&[&t, &x, &y]));
        told(data, "", &[&format!("time     {name}: steps of 0.1"), "input    x: "]);
    }
    let data = table("t,Zeit,x,y", |_, [t, x, y]| texts(&[&t, &(2.0 * t), &x, &y]));
    told(data, "", &["time     t: ", "input    x: ", "ignored  Zeit: a second time"]);
    // The name alone does not decide.
    let data = table("t,tempo,y", |_, [t, x, y]| texts(&[&t, &x, &y]));
    told(data, "", &["input    tempo: "]);
}

#[test]
fn what_no_input_is_is_set_aside_and_told() {
    let data =
        table("sample,t,x,note,room,y,n", |k, [t, x, y]| texts(&[&k, &t, &x, &"ok", &21.5, &y, &(k + 1)]));
    let lines = [
        "input    x: ",
        "output   y: ",
        "ignored  sample: counts the rows",
        "ignored  note: text",
        "ignored  room: constant",
        "ignored  n: counts the rows",
        "guessed  input and output, from names and values (change: --input, --output)",
    ];
    told(data.clone(), "", &lines);
    told(data.clone(), "--input x --input sample", &["input    sample: ", "ignored  room: constant"]);
    told(data, "--input x --input sample --output y", &["input    sample: ", "output   y: "]);
}

#[test]
fn columns_that_only_grow_are_refused_where_others_are_left() {
    let growing = |header: &str| table(header, |_, [t, x, y]| texts(&[&(0.3 * t + 1.0), &x, &y]));
    refused(
        growing("position,x,y"),
        "",
        "error: data.csv: column \"position\" grows from row to row: name it with --time, or name input and output with \
         --input and --output",
    );
    told(growing("position,x,y"), "--time position", &["time     position"]);
    told(growing("position,x,y"), "--input position --input x", &["input    position: "]);
    told(growing("position,x,y"), "--input x --output y", &["input    x: "]);
    let data = table("cycle,x,y", |k, [_, x, y]| texts(&[&(k / 20), &x, &y]));
    refused(
        data,
        "",
        "error: data.csv: column \"cycle\" counts up in steps: name it with --record, or name input and output with \
         --input and --output",
    );
}

#[test]
fn command_and_measurement_are_not_both_inputs() {
    let data = table("t,command,measured,y", |_, [t, x, y]| {
        texts(&[&t, &x, &(1.02 * x + 0.01 * (9.0 * t).cos()), &y])
    });
    refused(
        data.clone(),
        "",
        "error: data.csv: columns \"command\" and \"measured\" are nearly the same signal (correlation 0.9999), such as a \
         command and its measurement: name the input with --input",
    );
    told(data, "--input measured", &["input    measured: "]);
    let data = table("t,x,temperature,y", |_, [t, x, y]| texts(&[&t, &x, &(1.3 * t).sin(), &y]));
    told(data, "", &["input    x: ", "input    temperature: "]);
}

#[test]
fn many_columns_are_not_all_inputs() {
    let gauges: Vec<String> = (1..=60).map(|gauge| format!("gauge_{gauge}")).collect();
    let data = table(&format!("t,{},force_kN", gauges.join(",")), |_, [t, x, y]| {
        let gauges = (0..60).map(|gauge| (x + (0.1 * f64::from(gauge) * t).sin()).to_string());
        std::iter::once(t.to_string()).chain(gauges).chain([y.to_string()]).collect()
    });
    let names = "gauge_1, gauge_2, gauge_3, gauge_4, gauge_5, gauge_6 and 54 more";
    refused(
        data.clone(),
        "",
        &format!("error: data.csv: 60 columns could be inputs: name them with --input ({names})"),
    );
    told(data, "--input gauge_7", &["input    gauge_7: ", "output   force_kN: "]);
}

#[test]
fn a_force_is_not_taken_for_the_input_silently() {
    let data = |header: &str| table(header, |_, [_, x, y]| texts(&[&y, &x]));
    refused(
        data("force_kN,disp_mm"),
        "",
        "error: data.csv: \"disp_mm\" is in the last column, but \"force_kN\" looks more like the output: choose with \
         --output force_kN or --output disp_mm",
    );
    told(data("force_kN,disp_mm"), "--output force_kN", &["input    disp_mm: ", "output   force_kN: "]);
    told(data("force_kN,disp_mm"), "--output disp_mm", &["input    force_kN: ", "output   disp_mm: "]);
    told(data("force_kN,disp_mm"), "--input force_kN", &["output   disp_mm: "]);
}
