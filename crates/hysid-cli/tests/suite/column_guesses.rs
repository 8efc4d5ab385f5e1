//! Which column is what, where no option says so: guesses are told before the fit, and bad ones are refused.

use hysid_core::elementary::{cos, sin};

use serde_json::Value;

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

/// A text in one line.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[track_caller]
fn told(data: String, options: &str, lines: &[&str]) {
    let bench = Workbench::new();
    bench.put("data.csv", data);
    let fitted = words(&bench.succeeds(&format!("fit data.csv {QUICK} {options}")).stderr);
    let look: Value =
        serde_json::from_str(&bench.run(&format!("look data.csv --json {options}")).stdout).unwrap();
    let columns = look["files"][0]["columns"].as_array().unwrap();
    for line in lines {
        let of_column = ["input", "output", "time", "ignored"].into_iter().find_map(|role| {
            let (name, more) = line.strip_prefix(role)?.trim().split_once(':')?;
            Some((role, name, more.trim()))
        });
        let Some((role, name, more)) = of_column else {
            assert!(fitted.contains(&words(line)), "{line}\n{fitted}");
            continue;
        };
        let column =
            columns.iter().find(|column| column["name"] == name).unwrap_or_else(|| panic!("{name}: {look}"));
        let role = if role == "ignored" { "unused" } else { role };
        assert_eq!(column["role"], role, "{line}\n{look}");
        assert!(
            more.is_empty() || role == "time" || column["note"].as_str().unwrap().contains(more),
            "{line}\n{look}"
        );
    }
}

#[track_caller]
fn refused(data: String, options: &str, line: &str) {
    let bench = Workbench::new();
    bench.put("data.csv", data);
    let ran = bench.run(&format!("fit data.csv {QUICK} {options}"));
    assert_eq!((ran.last_line(), ran.status), (line, Some(1)), "{}", ran.stderr);
    assert!(!bench.path("out.json").exists());
    let looked = bench.run(&format!("look data.csv --json {options}")).stdout;
    let looked: Value = serde_json::from_str(&looked).unwrap_or_else(|error| panic!("{error}: {looked}"));
    assert!(line.ends_with(looked["problem"].as_str().unwrap()), "{looked}");
}

#[test]
fn time_has_many_names() {
    for name in ["timestamp", "elapsed", "Zeit", "Elapsed Time (sec)", "clock_ms", "time [sec]"] {
        let data = table(&format!("{name},x,y"), |_, [t, x, y]| texts(&[&t, &x, &y]));
        told(data, "", &[&format!("time     {name}: steps of 0.1"), "input    x: "]);
    }
    let data = table("t,Zeit,x,y", |_, [t, x, y]| texts(&[&t, &(2.0 * t), &x, &y]));
    told(data, "", &["time     t: ", "input    x: ", "ignored  Zeit: another time column is used"]);
    // An hour that comes twice.
    let data = table("timestamp,x,y", |k, [t, x, y]| texts(&[&(t - if k > 40 { 3.0 } else { 0.0 }), &x, &y]));
    told(data, "", &["input    x: ", "ignored  timestamp: time that falls back from one row to the next"]);
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
        "guessed input and output, from names and values",
    ];
    told(data.clone(), "", &lines);
    told(data.clone(), "--input x --input sample", &["input    sample: ", "ignored  room: constant"]);
    told(data, "--input x --input sample --output y", &["input    sample: ", "output   y: "]);
}

/// A constant axial load with the error of its control beside the lateral force: the question names the force that varies.
#[test]
fn of_two_forces_the_one_that_varies_is_advised() {
    let instance =
        "could both be the output: name input and output, for instance --input disp_mm --output lateral_kN";
    for (header, is_last) in
        [("t_s,disp_mm,axial_kN,lateral_kN", true), ("t_s,disp_mm,lateral_kN,axial_kN", false)]
    {
        let data = table(header, |k, [t, x, y]| {
            let axial = 500.0 + 20.0 * cos(2.3 * k as f64);
            if is_last { texts(&[&t, &x, &axial, &y]) } else { texts(&[&t, &x, &y, &axial]) }
        });
        let [.., one, other] = header.split(',').collect::<Vec<_>>()[..] else { unreachable!() };
        refused(data, "", &format!("error: data.csv: \"{one}\" and \"{other}\" {instance}"));
    }
}

#[test]
fn a_reaction_is_told_by_its_sign() {
    let words = "warning: reaction_kN falls while disp_mm rises, as a reaction does";
    let data = |sign: f64| {
        table("t_s,disp_mm,reaction_kN", |_, [t, x, y]| texts(&[&t, &x, &(sign * (x + 0.1 * y))]))
    };
    told(data(-1.0), "", &[words]);
    let bench = Workbench::new();
    bench.put("data.csv", data(1.0));
    assert!(!bench.run("look data.csv").stderr.contains("reaction, whose"));
}

#[test]
fn columns_that_only_grow_are_refused_where_others_are_left() {
    let growing = |header: &str| table(header, |_, [t, x, y]| texts(&[&(0.3 * t + 1.0), &x, &y]));
    refused(
        growing("position,x,y"),
        "",
        "error: data.csv: column \"position\" grows from row to row: if it is time, --time position --input x --output y \
         (columns: position, x, y); otherwise name input and output",
    );
    told(growing("position,x,y"), "--time position", &["time     position:"]);
    told(growing("position,x,y"), "--input position --input x", &["input    position: "]);
    told(growing("position,x,y"), "--input x --output y", &["input    x: "]);
    let data = table("cycle,x,y", |k, [_, x, y]| texts(&[&(k / 20), &x, &y]));
    told(
        data,
        "",
        &["input    x: ", "ignored  cycle: counts up in steps (to divide the rows into records: --record"],
    );
}

#[test]
fn command_and_measurement_are_not_both_inputs() {
    let data =
        table("t,command,measured,y", |_, [t, x, y]| texts(&[&t, &x, &(1.02 * x + 0.01 * cos(9.0 * t)), &y]));
    refused(
        data.clone(),
        "",
        "error: data.csv: columns \"command\" and \"measured\" are nearly the same signal (correlation 0.9999), such as a \
         command and its measurement: name the input with --input measured --output y or --input command --output y",
    );
    told(data, "--input measured", &["input    measured: "]);
    let data = table("t,x,temperature,y", |_, [t, x, y]| texts(&[&t, &x, &sin(1.3 * t), &y]));
    told(data.clone(), "", &["input    x: ", "ignored  temperature: a condition of the test"]);
    told(data, "--input x --input temperature", &["input    temperature: "]);
}

#[test]
fn many_columns_are_not_all_inputs() {
    let gauges: Vec<String> = (1..=60).map(|gauge| format!("gauge_{gauge}")).collect();
    let data = table(&format!("t,{},force_kN", gauges.join(",")), |_, [t, x, y]| {
        let gauges = (0..60).map(|gauge| (x + sin(0.1 * f64::from(gauge) * t)).to_string());
        std::iter::once(t.to_string()).chain(gauges).chain([y.to_string()]).collect()
    });
    let names = "gauge_1, gauge_2, gauge_3, gauge_4, gauge_5 and 55 more";
    let instance = "for instance --input gauge_1 --output force_kN";
    refused(
        data.clone(),
        "",
        &format!(
            "error: data.csv: 60 columns could be inputs: name them with --input, {instance} (columns: {names})"
        ),
    );
    told(data, "--input gauge_7", &["input    gauge_7: ", "output   force_kN: "]);
}

#[test]
fn the_last_column_is_the_output_whatever_its_name_and_it_is_said() {
    let data = |header: &str| table(header, |_, [_, x, y]| texts(&[&y, &x]));
    let note = "warning: data.csv: output \"disp_mm\", because it is the last column, although \"force_kN\" looks more like \
                an output (to change it: --output force_kN)";
    told(data("force_kN,disp_mm"), "", &[note, "input    force_kN: ", "output   disp_mm: "]);
    told(data("B_T,H_A_per_m"), "", &["input    B_T: ", "(to change it: --output B_T)"]);
    let timed = table("t_s,force_N,displacement_m", |_, [t, x, y]| texts(&[&t, &y, &x]));
    told(timed, "", &["output   displacement_m: ", "(to change it: --output force_N)"]);
    told(data("force_kN,disp_mm"), "--output force_kN", &["input    disp_mm: ", "output   force_kN: "]);
    told(data("force_kN,disp_mm"), "--output disp_mm", &["input    force_kN: ", "output   disp_mm: "]);
    told(data("force_kN,disp_mm"), "--input force_kN", &["output   disp_mm: "]);
    // With further columns the order is not the documented one.
    let counted = table("Load (kN),Stroke (mm),Cycle", |k, [_, x, y]| texts(&[&y, &x, &(k / 20)]));
    refused(
        counted,
        "",
        "error: data.csv: \"Stroke (mm)\" is the last column, but \"Load (kN)\" looks more like the output: choose with \
         --output 'Load (kN)' or --output 'Stroke (mm)'",
    );
}

#[test]
fn counters_sums_and_conditions_have_no_role() {
    let counted =
        table("Strain,Stress,Cycle count", |k, [_, x, y]| texts(&[&x, &y, &(0.5 * (k / 25) as f64)]));
    told(counted, "", &["input    Strain: ", "output   Stress: ", "ignored  Cycle count: a counter"]);
    let battery = table("time,step,current,voltage,chgAh,disAh", |k, [t, x, y]| {
        texts(&[&t, &(1 + k / 40 % 2), &x, &y, &(0.01 * (k as f64).sqrt()), &(0.02 * (k as f64).sqrt())])
    });
    let lines = [
        "input    current: ",
        "output   voltage: ",
        "ignored  step: ",
        "ignored  chgAh: ",
        "ignored  disAh: ",
    ];
    told(battery, "", &lines);
    // One record for each temperature, whose noise is no change of it.
    let warm = table("Temperature (K),Field (T),Moment (emu)", |k, [_, x, y]| {
        texts(&[&([5.0, 50.0, 300.0][(k / 20).min(2)] + 0.1 * sin(k as f64)), &x, &y])
    });
    told(
        warm,
        "",
        &[
            "input    Field (T): ",
            "output   Moment (emu): ",
            "in 3 records: ",
            "ignored  Temperature (K): a condition of the test, with few values, which divide",
        ],
    );
}

#[test]
fn a_column_that_falls_is_no_time() {
    // A field that falls from its maximum and rises again, at one temperature.
    let field = |header: &str| {
        table(header, |k, [_, _, y]| {
            let field = (k as f64 - 30.0).abs() / 30.0;
            texts(&[&field, &(300.0 + 0.1 * sin(9.0 * k as f64)), &y])
        })
    };
    let bench = Workbench::new();
    for (header, input) in [("", "c1"), ("T,a,M", "T")] {
        let text = field(header);
        bench.put("data.csv", text.trim_start());
        let looked = bench.run("look data.csv").stdout;
        assert!(looked.contains("in 1 record"), "{looked}");
        assert!(!looked.contains(" time "), "{looked}");
        assert!(looked.lines().any(|line| line.starts_with(input) && line.contains("input")), "{looked}");
    }
    refused(
        table("t,x,y", |k, [_, x, y]| texts(&[&-(k as f64), &x, &y])),
        "",
        "error: data.csv: column \"t\" falls, as no time does: name another with --time, or use --time none",
    );
    let data = table("t,x,y", |_, [t, x, y]| texts(&[&t, &x, &y]));
    told(data, "--time none", &["input    x: ", "ignored  t: time, which --time none leaves out"]);
}

#[test]
fn what_names_and_values_do_not_tell_is_asked() {
    let outputs = table("t,Displacement (mm),Force1 [kN],Force2 [kN]", |_, [t, x, y]| {
        texts(&[&t, &x, &y, &(y * y + x)])
    });
    refused(
        outputs.clone(),
        "",
        "error: data.csv: \"Force1 [kN]\" and \"Force2 [kN]\" could both be the output: name input and output, for \
         instance --input 'Displacement (mm)' --output 'Force2 [kN]'",
    );
    let lines = ["input    Displacement (mm): ", "ignored  Force2 [kN]: another output"];
    told(outputs, "--output Force1", &lines);
    // A sweep of voltage, or a cell: hours and a temperature are those of a cell, which the current drives.
    let swept = |header: &str| table(header, |_, [t, x, y]| texts(&[&t, &x, &y]));
    told(swept("t [s],U [V],I [mA]"), "", &["input    U [V]: ", "output   I [mA]: "]);
    refused(
        swept("t [h],U [V],I [A]"),
        "",
        "error: data.csv: \"I [A]\" is the last column, but \"U [V]\" looks more like the output: choose with --output \
         'U [V]' or --output 'I [A]'",
    );
    let unknown = |header: &str| table(header, |_, [t, x, y]| texts(&[&t, &x, &y, &(y * y + x)]));
    let by_place = "warning: data.csv: the names do not tell input and output: \"c\" is taken for the output";
    told(unknown("t,a,b,c"), "", &[by_place, "input    a: ", "output   c: "]);
    told(unknown("t,x1,x2,y"), "--rate none", &["input    x1: ", "output   y: "]);
}

/// A temperature is measured, with noise, and kept.
#[test]
fn a_measured_column_of_records_is_divided_by_its_plateaus() {
    let data = table("T_K,x,y", |k, [_, x, y]| {
        texts(&[&(if k < 40 { 5.0 } else { 300.0 } + 0.01 * sin(40.0 * k as f64)), &x, &y])
    });
    told(data, "--record T_K", &["all scored, in 2 records: data (1: 5 K), data (2: 300 K)"]);
}

#[test]
fn a_hint_names_a_pair_that_belongs_together() {
    let header = "Disp A (mm),Force A (kN),Disp B (mm),Force B (kN)";
    let data = table(header, |_, [t, x, y]| texts(&[&x, &y, &sin(1.3 * t), &cos(1.7 * t)]));
    refused(
        data,
        "",
        "error: data.csv: \"Force A (kN)\" and \"Force B (kN)\" could both be the output: name input and output, for \
         instance --input 'Disp B (mm)' --output 'Force B (kN)'",
    );
}

/// A damper with a magnetic liquid: its force is measured, and not calculated from displacement and velocity.
#[test]
fn a_damping_force_is_an_output_and_each_current_is_a_record() {
    let header = "Time [ms],Displacement [mm],Velocity [mm/s],Current [A],Damping Force [N]";
    let data = table(header, |k, [t, x, y]| texts(&[&(1e3 * t), &x, &cos(t), &usize::from(k >= 40), &y]));
    let current =
        "ignored  Current [A]: a condition of the test, with few values, which divide the rows into records";
    let lines = ["input    Displacement [mm]: ", "output   Damping Force [N]: ", current];
    for options in ["", "--input Displacement"] {
        told(data.clone(), options, &lines);
        told(data.clone(), options, &["in 2 records: data (1: 0 A), data (2: 1 A)"]);
    }
}

#[test]
fn a_time_that_runs_through_is_preferred_to_one_that_starts_again_in_steps() {
    for name in ["Step Time (s)", "Time (s)"] {
        let header = format!("{name},Total Time (s),x_mm,F_kN");
        let steps = |gap: f64| {
            table(&header, |k, [t, x, y]| {
                let step = (k / 20) as f64;
                texts(&[&(t - 2.0 * step), &(t + gap * step), &x, &y])
            })
        };
        let again = format!("ignored  {name}: another time column is used");
        told(steps(0.0), "", &["time     Total Time (s): ", &again, "in 1 record"]);
        // Tests with a pause between them.
        told(
            steps(50.0),
            "",
            &[&format!("time     {name}: "), "ignored  Total Time (s): another time column is used"],
        );
    }
}

#[test]
fn a_branch_of_a_quantity_is_no_input_of_the_other() {
    let header = "Target RH [%],Sorption [%],Desorption [%],Remark 1";
    refused(
        table(header, |k, [_, x, y]| texts(&[&(50.0 + 10.0 * x), &y, &(y * y + x), &(k % 2)]))
            .replace("Remark 1", "Status"),
        "",
        "error: data.csv: \"Sorption [%]\" and \"Desorption [%]\" are two branches of one quantity: name input and output, \
         for instance --input 'Target RH [%]' --output 'Desorption [%]' (columns: Sorption [%])",
    );
    // Water activity is no time.
    refused(
        table("aw [-],EMC a [%],EMC b [%]", |_, [t, x, y]| texts(&[&t, &x, &y])),
        "",
        "error: data.csv: column \"aw [-]\" grows from row to row: name input and output, for instance --input 'aw [-]' \
         --output 'EMC b [%]' (columns: aw [-], EMC a [%], EMC b [%])",
    );
}

#[test]
fn a_unit_in_brackets_may_be_left_out() {
    let data = table("t_s,Drift (mm),Axial Strain (%),Deviator (kPa)", |_, [t, x, y]| {
        texts(&[&t, &x, &(x * x), &y])
    });
    told(data, "--input Drift --output Deviator", &["input    Drift (mm): ", "output   Deviator (kPa): "]);
}

/// Date and clock in two columns, with four rows a day.
#[test]
fn a_clock_belongs_to_the_date_beside_it() {
    let data = table("Datum,Uhrzeit,rF [%],Holzfeuchte [%]", |k, [_, x, y]| {
        texts(&[&format!("{}.03.2024", 1 + k / 4), &format!("{:02}:00", 6 * (k % 4)), &x, &y])
    });
    told(data, "", &["time     Datum [s]: steps of 21600", "ignored  Uhrzeit: text"]);
}
