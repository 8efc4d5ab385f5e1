//! `hysid cycles` as a user runs it: CSV, text, JSON, page, cycles of a model, and what it refuses.

use std::collections::HashMap;

use crate::workbench::{Workbench, must_contain};
use hysid_core::elementary::{sin, square};
use serde_json::Value;

/// Turning points joined in steps, through a law.
fn table(header: &str, turning: &[f64], step: f64, law: &mut dyn FnMut(f64) -> f64) -> String {
    let mut text = format!("{header}\n{},{}\n", turning[0], law(turning[0]));
    for pair in turning.windows(2) {
        let count = ((pair[1] - pair[0]).abs() / step).round() as usize;
        for k in 1..=count {
            let x = pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64;
            text += &format!("{x:.6},{:.9}\n", law(x));
        }
    }
    text
}

/// An elastic-perfectly plastic member: 2 kN/mm, 2 kN.
fn member() -> impl FnMut(f64) -> f64 {
    let (mut last, mut force) = (0.0, 0.0);
    move |x: f64| {
        force = f64::clamp(force + 2.0 * (x - last), -2.0, 2.0);
        last = x;
        force
    }
}

/// Rows of a table by the names of their columns.
fn rows(text: &str) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}

#[test]
fn a_member_has_the_figures_of_its_law_in_csv_text_and_json() {
    let bench = Workbench::new();
    let turning = [0.0, 2.0, -2.0, 2.0, -2.0, 4.0, -4.0, 4.0, -4.0, 0.0];
    bench.put("member.csv", table("disp_mm,force_kN", &turning, 0.05, &mut member()));
    let ran = bench.succeeds("cycles member.csv");
    assert_eq!(
        bench.files("."),
        [
            "member.csv",
            "member.cycles.csv",
            "member.cycles.figures.csv",
            "member.cycles.html",
            "member.cycles.levels.csv"
        ]
    );
    let rows = rows(&bench.text("member.cycles.csv"));
    assert_eq!(rows.len(), 4);
    // 4 F (d - F/k), and half a stored energy less in the first cycle.
    for (row, (energy, amplitude)) in rows.iter().zip([(7.0, 2.0), (8.0, 2.0), (24.0, 4.0), (24.0, 4.0)]) {
        assert_eq!(row["complete"], "yes");
        assert!((number(row, "energy [J]") - energy).abs() < 1e-6, "{row:?}");
        assert!((number(row, "amplitude [mm]") - amplitude).abs() < 1e-6);
        assert!((number(row, "secant_stiffness [kN/mm]") - 2.0 / amplitude).abs() < 1e-6);
        assert!((number(row, "residual_after_peak [mm]") - (amplitude - 1.0)).abs() < 1e-6);
        let damping =
            100.0 * 2.0 * energy / (std::f64::consts::PI * 2.0 / amplitude * square(2.0 * amplitude));
        assert!((number(row, "damping_percent [%]") - damping).abs() < 1e-4);
        assert_eq!(row["period"], "", "there is no time");
    }
    let marked: Vec<&str> = rows.iter().map(|row| row["backbone_peak"].as_str()).collect();
    assert_eq!(marked, ["yes", "no", "yes", "no"]);
    assert!(ran.stdout.lines().all(|line| line.chars().count() <= 80), "{}", ran.stdout);
    must_contain(&ran.stdout, &["backbone: 4 points", "energy, J", "no time: no period and frequency"]);

    // The backbone has the points (2, 2) and (4, 2): K_e = 1, and 2 kN from 2 mm on have its area.
    let figures = self::rows(&bench.text("member.cycles.figures.csv"));
    for (name, expected, unit) in
        [("yield_output", 2.0, "kN"), ("yield_input", 2.0, "mm"), ("ductility", 2.0, "")]
    {
        let figure =
            figures.iter().find(|row| row["figure"] == name && row["of"] == "mean backbone").unwrap();
        assert!((number(figure, "value") - expected).abs() < 1e-6, "{figure:?}");
        assert_eq!((figure["unit"].as_str(), figure["source"].as_str()), (unit, "ASTM E2126"));
    }
    must_contain(&ran.stdout, &["levels of amplitude", "figures of the record", "ductility"]);
    let levels = self::rows(&bench.text("member.cycles.levels.csv"));
    assert_eq!(levels.len(), 2);
    assert!((number(&levels[1], "cumulative_energy [J]") - 63.0).abs() < 1e-6);
    assert!((number(&levels[1], "cumulative_ductility") - 12.0).abs() < 1e-6);

    let told = bench.json("cycles member.csv --json");
    assert_eq!((&told["units"]["yield_output"], &told["levels"][0]["cycles"]), (&"kN".into(), &2.into()));
    assert_eq!((&told["field"], &told["division"]), (&"structure".into(), &"zero".into()));
    assert_eq!((&told["units"]["energy"], &told["of_model"]), (&"J".into(), &false.into()));
    assert!((told["cycles"][3]["energy"].as_f64().unwrap() - 24.0).abs() < 1e-6);
    assert_eq!(told["backbone"].as_array().unwrap().len(), 4);
    assert_eq!(told["reversal_curves"], Value::Null);

    let page = bench.text("member.cycles.html");
    let heading = |name: &str| page.find(&format!("{name} (")).unwrap();
    assert!(heading("energy") < heading("input at peak"), "what matters stands first");
    for part in [
        "<svg",
        "Backbone",
        "Figures of the record",
        "Levels of amplitude",
        "Δ_y",
        "equivalent damping (%)",
        "secant stiffness (kN/mm)",
        "energy (J)",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_magnet_has_losses_in_its_units_at_each_frequency() {
    let bench = Workbench::new();
    // B lags behind H by a phase: the loss per cycle is π H B sin φ at any frequency.
    let mut text = String::from("t_s,H_A_per_m,B_T,record\n");
    for (record, frequency) in [("slow", 1.0), ("fast", 50.0)] {
        for row in 0..1600 {
            let time = 4.0 * f64::from(row) / 1600.0 / frequency;
            let phase = std::f64::consts::TAU * frequency * time;
            text += &format!("{time},{},{},{record}\n", 100.0 * sin(phase), 1.2 * sin(phase - 0.3));
        }
    }
    bench.put("core.csv", text);
    let ran = bench.succeeds("cycles core.csv --output B_T --input H_A_per_m --no-report");
    let rows = rows(&bench.text("core.cycles.csv"));
    let complete: Vec<_> = rows.iter().filter(|row| row["complete"] == "yes").collect();
    assert_eq!(complete.len(), 8);
    let loss = std::f64::consts::PI * 100.0 * 1.2 * sin(0.3);
    for row in complete {
        let frequency = if row["record"] == "slow" { 1.0 } else { 50.0 };
        assert!((number(row, "energy [J/m3]") / loss - 1.0).abs() < 1e-3, "{row:?}");
        assert!((number(row, "power [W/m3]") / (loss * frequency) - 1.0).abs() < 2e-3);
        assert!((number(row, "coercive_input [A/m]") / (100.0 * sin(0.3)) - 1.0).abs() < 1e-3);
        assert!((number(row, "remanent_output [T]") / (1.2 * sin(0.3)) - 1.0).abs() < 1e-3);
    }
    assert!(ran.stdout.contains("losses by amplitude and frequency"), "{}", ran.stdout);
    assert!(!bench.path("core.cycles.html").exists());
    let ran = bench.succeeds("cycles core.csv --output B_T --input H_A_per_m --no-report --density 7650");
    let rows = self::rows(&bench.text("core.cycles.csv"));
    let fast = rows.iter().find(|row| row["record"] == "fast" && row["complete"] == "yes").unwrap();
    assert!((number(fast, "power_per_mass [W/kg]") / (loss * 50.0 / 7650.0) - 1.0).abs() < 2e-3);
    must_contain(&ran.stdout, &["two amplitudes at least", "three frequencies at least"]);
}

/// Twenty files: the table of losses ends with the largest, and the page names the number of files.
#[test]
fn many_files_are_named_by_their_number_and_a_long_table_shows_its_end() {
    let bench = Workbench::new();
    let mut files = String::new();
    for amplitude in [100, 200, 400, 700, 1000] {
        for frequency in [1, 10, 50, 200] {
            let mut text = String::from("t_s,H_A_per_m,B_T\n");
            for row in 0..=400 {
                let phase = std::f64::consts::TAU * f64::from(row) / 200.0;
                let time = f64::from(row) / 200.0 / f64::from(frequency);
                let field = f64::from(amplitude) * sin(phase);
                text += &format!("{time},{field},{}\n", 1e-3 * f64::from(amplitude) * sin(phase - 0.3));
            }
            let name = format!("a{amplitude}_{frequency}Hz.csv");
            bench.put(&name, text);
            files += &format!(" {name}");
        }
    }
    let ran = bench.succeeds(&format!("cycles{files} --density 7650"));
    let losses = ran.stdout.split("losses by amplitude and frequency").nth(1).unwrap();
    let losses = losses.split("figures of the record").next().unwrap();
    let last = losses.lines().rfind(|line| !line.trim().is_empty()).unwrap();
    assert!(last.starts_with("1000 ") && last.split_whitespace().nth(1) == Some("200"), "{losses}");
    must_contain(losses, &["specific", "W/kg", "4 more"]);
    assert!(bench.text("a100_1Hz.cycles.html").contains("<title>Cycles: a100_1Hz.csv and 19 more"));
}

/// Drift ratios of levels, in percent of a height that is given with its unit.
#[test]
fn levels_have_drift_ratios_of_a_height_with_a_unit() {
    let bench = Workbench::new();
    let turning = [0.0, 2.0, -2.0, 4.0, -4.0, 0.0];
    bench.put("member.csv", table("disp_mm,force_kN", &turning, 0.05, &mut member()));
    bench.succeeds("cycles member.csv --height 0.2m --no-report");
    let drifts: Vec<f64> = rows(&bench.text("member.cycles.levels.csv"))
        .iter()
        .map(|row| number(row, "drift_percent [%]"))
        .collect();
    assert!(
        drifts.len() == 2 && (drifts[0] - 1.0).abs() < 1e-9 && (drifts[1] - 2.0).abs() < 1e-9,
        "{drifts:?}"
    );
    bench.refuses_in_part(
        "
        2 cycles member.csv --height 200 --force => give that of the height too, such as 2.4m
        2 cycles member.csv --height 2kN --force => cannot be converted to the unit of the input
    ",
    );
}

/// Polarisation of an even density of relays over the Preisach triangle of -1 to 1.
#[test]
fn reversal_curves_in_data_give_the_density_of_the_plane_as_table_and_picture() {
    let bench = Workbench::new();
    let density = 0.25;
    let mut text = String::from("H_A_per_m,B_T\n");
    let falling = |x: f64| 1.0 - density * square(1.0 - x);
    for curve in 1..=20 {
        let reversal = 1.0 - 0.1 * f64::from(curve);
        let rows = 2 * curve;
        for row in 0..=rows {
            let x = 1.0 - 0.05 * f64::from(row);
            text += &format!("{x:.3},{:.9}\n", falling(x));
        }
        for row in (0..rows).rev() {
            let x = 1.0 - 0.05 * f64::from(row);
            text += &format!("{x:.3},{:.9}\n", falling(reversal) + density * square(x - reversal));
        }
    }
    bench.put("forc.csv", text);
    let ran = bench.succeeds("cycles forc.csv -o out.csv");
    assert_eq!(bench.files("."), ["forc.csv", "out.csv", "out.forc-margins.csv", "out.forc.csv", "out.html"]);
    assert!(ran.stdout.contains("19 rising first-order reversal curves"), "{}", ran.stdout);
    let nodes = rows(&bench.text("out.forc.csv"));
    let known: Vec<f64> = nodes
        .iter()
        .filter(|node| !node["density [T/(A/m)2]"].is_empty())
        .map(|node| number(node, "density [T/(A/m)2]"))
        .collect();
    assert!(known.len() > 170, "{}", known.len());
    assert!(known.iter().all(|found| (found - density).abs() < 1e-4), "{known:?}");
    for node in &nodes {
        let lag = number(node, "input [A/m]") - number(node, "reversal_input [A/m]");
        assert!((number(node, "everett [T]") - 0.5 * density * lag * lag).abs() < 1e-6);
    }
    let page = bench.text("out.html");
    assert!(
        page.contains("FORC diagram") && page.contains("Everett function") && page.contains("#1020"),
        "a heat map"
    );
    let ran = bench.succeeds("cycles forc.csv -o out.csv --smoothing-factor 4");
    assert!(ran.stdout.replace('\n', " ").contains("smoothing factor 4 (as asked for)"), "{}", ran.stdout);
}

/// Single rows in a field of 3 before each curve, which ends at 1.
#[test]
fn calibration_points_are_no_ends_of_curves() {
    let bench = Workbench::new();
    let mut text = String::from("H_A_per_m,B_T\n");
    for curve in 1..=20 {
        let reversal = 1.0 - 0.1 * f64::from(curve);
        text += "3,1\n";
        for row in 0..=2 * curve {
            let x = reversal + 0.05 * f64::from(row);
            text +=
                &format!("{x:.3},{:.9}\n", 1.0 - 0.25 * square(1.0 - reversal) + 0.25 * square(x - reversal));
        }
    }
    bench.put("forc.csv", text);
    let ran = bench.succeeds("cycles forc.csv");
    let words = ran.stdout.replace("\n", " ").replace("  ", " ");
    must_contain(
        &words,
        &["19 rising first-order reversal curves", "that end at 1 A/m", "20 calibration points at 3"],
    );
    let nodes = rows(&bench.text("forc.cycles.forc.csv"));
    assert!(nodes.iter().all(|node| number(node, "input [A/m]") < 1.01));
    for node in nodes.iter().filter(|node| !node["density [T/(A/m)2]"].is_empty()) {
        assert!((number(node, "density [T/(A/m)2]") - 0.25).abs() < 1e-4, "{node:?}");
        let width = number(node, "input [A/m]") - number(node, "reversal_input [A/m]");
        assert!((number(node, "coercivity [A/m]") - 0.5 * width).abs() < 1e-9);
    }
    let margins = rows(&bench.text("forc.cycles.forc-margins.csv"));
    assert!(margins.iter().any(|row| row["distribution"] == "coercivity"));
    assert!(
        !ran.stdout.lines().any(|line| line.trim_end().ends_with("1/1*")),
        "no rows of dashes: {}",
        ran.stdout
    );
}

#[test]
fn a_model_is_driven_through_cycles_and_reversal_curves_and_they_are_said_to_be_its() {
    let bench = Workbench::new();
    bench.succeeds("generate ferromagnet -o sheet.csv");
    bench.succeeds("fit sheet.csv --model preisach -o model.json --no-report");
    let ran = bench.succeeds("cycles model.json --time t");
    assert!(ran.stderr.contains("ignore --time"), "{}", ran.stderr);
    assert!(ran.stdout.replace('\n', " ").contains("of the model, not of measured data"), "{}", ran.stdout);
    let cycles = rows(&bench.text("model.cycles.csv"));
    let losses: Vec<f64> = cycles
        .iter()
        .filter(|row| row["complete"] == "yes")
        .map(|row| number(row, "energy [J/m3]"))
        .collect();
    assert!(losses.len() >= 15 && losses.windows(2).all(|pair| pair[1] > 0.999 * pair[0]), "{losses:?}");
    let nodes = rows(&bench.text("model.cycles.forc.csv"));
    assert!(nodes.len() > 800, "{}", nodes.len());
    assert!(bench.text("model.cycles.html").contains("Hysid drove the model"));
    let told = bench.json("cycles model.json --json");
    assert_eq!(told["of_model"], Value::Bool(true));
    assert_eq!(told["reversal_curves"]["curves"].as_array().unwrap().len(), 40);
}

#[test]
fn the_table_goes_to_stdout_where_asked_and_files_of_others_are_kept() {
    let bench = Workbench::new();
    bench
        .put("member.csv", table("disp_mm,force_kN", &[0.0, 2.0, -2.0, 2.0, -2.0, 0.0], 0.05, &mut member()));
    let ran = bench.succeeds("cycles member.csv -o -");
    assert!(ran.stdout.starts_with("record,cycle,first_row,last_row,complete,start_time,"), "{}", ran.stdout);
    assert_eq!(bench.files("."), ["member.csv"]);
    assert_eq!(rows(&ran.stdout).len(), 2);
    bench.put("mine.csv", "a,b\n1,2\n");
    bench.refuses_in_part(
        "
        2 cycles member.csv -o mine.csv => --force
        2 cycles member.csv -o member.csv => would be overwritten
        2 cycles member.csv -o new.html => new.html: the table and the page would have this name: name the table with
        2 cycles member.csv -o - --json => name a file
        2 cycles member.csv --field wood => structure, magnet, actuator, thermal
        2 cycles member.csv --divide noon => zero, mean, reversals
        2 cycles member.csv --smoothing-factor 11 => choose 1 to 10
        2 cycles member.csv --smallest-reversal 2 => between 0 and 1
        2 cycles member.csv --density 0 => above 0
        2 cycles member.csv --density 7650 => per volume
        1 cycles nowhere.csv => nowhere.csv: cannot be read
        2 cycles => required
    ",
    );
    bench.succeeds("cycles member.csv -o other.csv");
    bench.succeeds("cycles member.csv -o other.csv --field actuator");
}

/// A code in a cell would change the energy of its cycle; that a single loop shows little of the memory matters to a fit alone.
#[test]
fn codes_for_missing_values_are_told_and_few_turning_points_are_not() {
    let bench = Workbench::new();
    let text = table("disp_mm,force_kN", &[0.0, 3.0, -3.0, 3.0, -3.0, 0.0], 0.1, &mut member());
    let place = text.lines().position(|line| line.starts_with("1.500000,")).unwrap();
    let with_code: Vec<&str> = text
        .lines()
        .enumerate()
        .map(|(line, row)| if line == place { "1.500000,-9999" } else { row })
        .collect();
    bench.put("code.csv", with_code.join("\n"));
    let ran = bench.succeeds("cycles code.csv --no-report");
    assert!(ran.stderr.contains("warning: \"force_kN\" is -9999"), "{}", ran.stderr);
    bench.put("loop.csv", table("disp_mm,force_kN", &[3.0, -3.0, 3.0], 0.1, &mut member()));
    let ran = bench.succeeds("cycles loop.csv --no-report");
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
}

#[test]
fn poor_data_leave_cells_empty_and_say_why() {
    let bench = Workbench::new();
    bench.put("half.csv", table("disp_mm,force_kN", &[0.0, 2.0, 1.0], 0.05, &mut member()));
    let ran = bench.succeeds("cycles half.csv");
    let row = &rows(&bench.text("half.cycles.csv"))[0];
    assert_eq!((row["complete"].as_str(), row["energy [J]"].as_str()), ("no", ""));
    assert!(row["notes"].contains("no whole cycle"), "{row:?}");
    assert!(ran.stdout.contains("no whole cycle"), "{}", ran.stdout);
    bench.put("constant.csv", "disp_mm,force_kN\n".to_string() + &"1,2\n".repeat(20));
    let ran = bench.run("cycles constant.csv");
    assert_eq!(ran.status, Some(1));
    assert!(ran.last_line().contains("constant.csv"), "{}", ran.stderr);
    // Output blank in half of the rows of the first cycle.
    let text = table("disp_mm,force_kN", &[0.0, 2.0, -2.0, 2.0, -2.0, 0.0], 0.05, &mut member());
    let blanked: String = text
        .lines()
        .enumerate()
        .map(|(line, row)| match line {
            20..60 => format!("{},\n", row.split(',').next().unwrap()),
            _ => format!("{row}\n"),
        })
        .collect();
    bench.put("blank.csv", blanked);
    bench.succeeds("cycles blank.csv");
    let rows = rows(&bench.text("blank.cycles.csv"));
    assert_eq!(rows[0]["energy [J]"], "");
    assert!(rows[0]["notes"].contains("40 rows of the cycle have no output"), "{:?}", rows[0]);
    assert!((number(&rows[1], "energy [J]") - 8.0).abs() < 1e-6);
}

#[test]
fn cycles_of_a_model_with_a_rate_say_at_which_speeds_they_are() {
    let bench = Workbench::with_model();
    let ran = bench.succeeds("cycles model.json --no-report");
    let line = ran.stderr.lines().find(|line| line.starts_with("speed ")).expect("a line of speeds");
    assert!(line.contains("record \"slow\" at "), "{line}");
    // The slow one is a millionth of the fastest.
    let number = |text: &str| text.trim().parse::<f64>().unwrap();
    let text = ran.stderr.replace('\n', " ");
    let slow = number(text.split("record \"slow\" at ").nth(1).unwrap().split(',').next().unwrap());
    let others = text.split("the others at ").nth(1).unwrap().split("  ").next().unwrap();
    let fastest = others.split(',').map(number).fold(0.0, f64::max);
    assert!((slow / fastest / 1e-6 - 1.0).abs() < 0.01, "{text}");
}
