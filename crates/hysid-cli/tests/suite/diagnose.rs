//! `hysid diagnose` as a user runs it: text, JSON, page, and what it refuses.

use crate::workbench::{Workbench, csv, must_contain, rows, table};
use hysid_core::elementary::sin;
use serde_json::Value;

const PROPERTIES: [&str; 10] = [
    "static-hysteresis",
    "orientation",
    "rate-dependence",
    "wiping-out",
    "congruency",
    "masing",
    "odd-symmetry",
    "saturation",
    "deterioration",
    "loop-closure",
];

const VERDICTS: [&str; 3] = ["yes", "no", "not testable"];

fn verdict<'v>(diagnosis: &'v Value, property: &str) -> &'v str {
    let found = diagnosis["properties"].as_array().unwrap().iter().find(|p| p["name"] == property);
    found.unwrap()["verdict"].as_str().unwrap()
}

/// An ideal plastic stop of threshold 1 under five loops between -3 and 3, in steps of 0.05.
fn stop_loops() -> String {
    let mut text = String::from("x_mm,F_kN\n");
    let (mut x, mut y) = (0.0, 0.0);
    for turning in [60, -60, 60, -60, 60, -60, 60, -60, 60, -60, 60] {
        let turning = f64::from(turning) / 20.0;
        while f64::abs(x - turning) > 1e-9 {
            let step = 0.05 * f64::signum(turning - x);
            x += step;
            y = f64::clamp(y + step, -1.0, 1.0);
            text += &format!("{x:.2},{y:.2}\n");
        }
    }
    text
}

#[test]
fn text_tells_every_property_and_fits_a_terminal() {
    let bench = Workbench::new();
    bench.succeeds("generate reinforced-concrete-joint -o joint.csv");
    let ran = bench.succeeds("diagnose joint.csv");
    let lines: Vec<&str> = ran.stdout.lines().collect();
    for line in &lines {
        assert!(line.chars().count() <= 80 && *line == line.trim_end(), "{line}");
    }
    assert!(lines[0].starts_with("property ") && lines[0].ends_with(" comparisons"), "{}", lines[0]);
    for property in PROPERTIES {
        let row = lines.iter().position(|line| line.starts_with(&format!("{property} "))).unwrap();
        let rest = lines[row][property.len()..].trim_start();
        assert!(VERDICTS.iter().any(|verdict| rest.starts_with(verdict)), "{rest}");
        assert!(lines[row + 1].starts_with("    "), "a statement: {}", lines[row + 1]);
    }
    must_contain(&ran.stdout, &["\ndeterioration      yes ", "\nexperiments for what could not be tested\n"]);
    must_contain(&ran.stdout, &["\nenergy, J ", "\nsecant stiffness, kN/mm "]);
    assert!(ran.stderr.starts_with("data     joint.csv: 1901 samples, "), "{}", ran.stderr);
    assert_eq!(ran.last_line(), "page    joint.diagnosis.html");
}

#[test]
fn loops_of_a_plastic_stop_have_the_numbers_of_their_geometry() {
    let bench = Workbench::new();
    bench.put("stop.csv", stop_loops());
    let diagnosis = bench.json("diagnose stop.csv --json --no-report");
    let cycles = diagnosis["cycles"].as_array().unwrap();
    // Those of `hysid cycles`, with the same figures.
    let table = bench.json("cycles stop.csv --json --no-report");
    assert_eq!(diagnosis["cycles"], table["cycles"]);
    assert!(cycles.len() >= 4);
    for cycle in &cycles[1..cycles.len() - 1] {
        // A parallelogram of width 4 and height 2, its slanting sides of slope 1.
        for (name, expected) in
            [("energy", 8.0), ("secant_stiffness", 1.0 / 3.0), ("residual_after_peak", 2.0)]
        {
            let value = cycle[name].as_f64().unwrap();
            assert!((value - expected).abs() < 1e-9, "{name}: {value}");
        }
        assert_eq!(cycle["frequency"], Value::Null, "there is no time");
    }
    assert_eq!(verdict(&diagnosis, "orientation"), "yes");
    assert_eq!(verdict(&diagnosis, "deterioration"), "no");
    assert_eq!(verdict(&diagnosis, "rate-dependence"), "not testable");
    let text = bench.succeeds("diagnose stop.csv --no-report").stdout;
    let energies = text.lines().find(|line| line.starts_with("energy, J")).unwrap();
    assert_eq!(
        energies.split_whitespace().skip(2).collect::<Vec<_>>(),
        ["7.525", "8", "8"],
        "the first begins without force"
    );
}

#[test]
fn the_doctor_speaks_and_the_advice_can_be_followed() {
    let bench = Workbench::new();
    bench.succeeds("generate reinforced-concrete-joint -o joint.csv");
    let text = bench.text("joint.csv").replacen("displacement_mm", "the way, mm", 1);
    bench.put("a joint.csv", text.replacen("the way, mm", "\"the way, mm\"", 1));
    let ran = bench.shell("hysid diagnose 'a joint.csv' --input 'the way, mm' --no-report");
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("\ndata quality"), "{}", ran.stdout);
    assert!(
        ran.stdout.contains("\nadvice\n    The simplest model that can represent these properties is gpnn"),
        "{ran}"
    );
    let next = ran.stdout.lines().find(|line| line.starts_with("  hysid fit ")).unwrap();
    assert_eq!(next, "  hysid fit 'a joint.csv' --input 'the way, mm'");
    let fitted = bench.shell(&format!("{next} --model gpnn --starts 1 --epochs 1 --no-report"));
    assert_eq!(fitted.status, Some(0), "{}", fitted.stderr);
}

/// The promised fields of each property; a model has further ones at the end.
fn check_properties(diagnosis: &Value, further: &[&str]) {
    let properties = diagnosis["properties"].as_array().unwrap();
    let names: Vec<&str> = properties.iter().map(|property| property["name"].as_str().unwrap()).collect();
    assert_eq!(names, [&PROPERTIES, further].concat());
    for property in properties {
        let verdict = property["verdict"].as_str().unwrap();
        assert!(VERDICTS.contains(&verdict), "{verdict}");
        for number in ["index", "threshold", "noise"] {
            assert!(property[number].is_number() || property[number].is_null(), "{property}");
        }
        assert!(property["comparisons"].is_u64() && !property["statement"].as_str().unwrap().is_empty());
        if verdict == "not testable" {
            assert!(!property["experiment"].as_str().unwrap().is_empty(), "what would tell: {property}");
        } else {
            assert!(property["index"].is_number() && property["threshold"].is_number(), "{property}");
        }
        for evidence in property["evidence"].as_array().unwrap() {
            assert!(evidence["index"].is_number());
            let pieces = evidence["pieces"].as_array().unwrap();
            assert!(pieces.iter().all(|piece| piece["record"].is_string() && piece["rows"].is_array()));
        }
    }
}

#[test]
fn json_has_the_promised_shape_for_data_and_models() {
    let bench = Workbench::new();
    bench.succeeds("generate ferromagnet -o sheet.csv");
    let of_data = bench.json("diagnose sheet.csv --json --no-report");
    check_properties(&of_data, &[]);
    assert_eq!((&of_data["input"], &of_data["output"]), (&"H_A_per_m".into(), &"B_T".into()));
    assert!(of_data["cycles"].is_array() && of_data["turning_points"].is_u64());
    for complaint in of_data["doctor"].as_array().unwrap() {
        for words in ["kind", "severity", "statement"] {
            assert!(!complaint[words].as_str().unwrap().is_empty(), "{words}: {complaint}");
        }
        assert!(complaint["evidence"].is_array());
    }
    let advice = &of_data["advice"];
    assert!(advice["model"].is_string() && !advice["statement"][0].as_str().unwrap().is_empty(), "{advice}");
    for need in ["needs_rate", "needs_deterioration", "needs_asymmetry"] {
        assert!(VERDICTS.contains(&advice[need].as_str().unwrap()), "{need}");
    }

    bench.succeeds("fit sheet.csv -o sheet.json --model preisach --no-report");
    let of_model = bench.json("diagnose sheet.json --json --no-report");
    check_properties(&of_model, &["invertible"]);
    let invertible = of_model["properties"].as_array().unwrap().last().unwrap();
    for field in ["direction", "always", "monotone_outputs", "pasts", "scans", "flat_share", "jumps", "worst"]
    {
        assert!(invertible.get(field).is_some(), "{field}: {invertible}");
    }
    assert_eq!(of_model["model"], "preisach");
    assert_eq!(verdict(&of_model, "congruency"), "yes", "every Preisach model has it");
    assert!(!bench.path("sheet.diagnosis.html").exists());
}

#[test]
fn a_page_shows_every_property_and_needs_nothing_else() {
    let bench = Workbench::new();
    bench.succeeds("generate reinforced-concrete-joint -o joint.csv");
    let text = bench.text("joint.csv").replacen("force_kN", "<b>&force_kN", 1);
    bench.put("joint.csv", text);
    bench.succeeds("fit joint.csv -o joint.json --model xpnn+ --starts 1 --epochs 3 --no-report");
    for (file, page, more) in [
        ("joint.csv", "joint.diagnosis.html", "Loops: 23 cycles"),
        ("joint.json", "of-model.html", "Widths of the loop"),
    ] {
        let ran = bench.succeeds(&format!("diagnose {file} -o {page}"));
        assert_eq!(ran.last_line(), format!("page    {page}"));
        let text = bench.text(page);
        for property in PROPERTIES {
            assert_eq!(text.matches(&format!("id=\"{property}\"")).count(), 1, "{property}");
        }
        assert!(text.contains(&format!("<h2>{more}</h2>")), "{page}");
        assert!(text.matches("<svg").count() >= 6, "{page}");
        assert!(!text.contains("<b>") && text.contains("&lt;b&gt;&amp;force"), "{page}: names are escaped");
        let elsewhere = bench.page(page).replace("http://www.w3.org/2000/svg", "");
        for link in ["http:", "https:", "<script", "<link", "url("] {
            assert!(!elsewhere.contains(link), "{page}: {link}");
        }
    }
}

#[test]
fn the_smallest_reversal_decides_what_is_a_turning_point() {
    let bench = Workbench::new();
    // A small excursion, 5 % of the range, on the way up of each loop.
    let mut path = Vec::new();
    for _ in 0..4 {
        path.extend([0.0, 0.5, 0.4, 1.0, -1.0]);
    }
    let mut text = String::from("x,y\n");
    for ends in path.windows(2) {
        for k in 0..20 {
            let x = ends[0] + (ends[1] - ends[0]) * f64::from(k) / 20.0;
            text += &format!("{x},{}\n", x * x * x);
        }
    }
    bench.put("data.csv", text);
    let points = |options: &str| {
        bench.json(&format!("diagnose data.csv --json --no-report {options}"))["turning_points"].clone()
    };
    // Two of each of four excursions, four upper ends, and three lower ends within the record.
    assert_eq!((points(""), points("--smallest-reversal 0.1")), (15.into(), 7.into()));
}

#[test]
fn further_inputs_and_useless_options_are_told() {
    let bench = Workbench::with_model();
    let further =
        csv("t,x,temperature,y", ",", "\n", &rows().into_iter().map(with_temperature).collect::<Vec<_>>());
    bench.put("further.csv", further);
    let ran = bench.succeeds("diagnose further.csv --input x --input temperature --no-report");
    let told = "warning: diagnosed: y over x; temperature is not diagnosed (choose with --input)";
    assert!(ran.stderr.contains(told), "{}", ran.stderr);
    let ran = bench.succeeds("diagnose further.csv --input temperature --rate central --no-report");
    assert!(ran.stdout.contains("y over temperature"), "{}", ran.stdout);
    assert!(ran.stderr.contains("warning: diagnose ignores --rate"), "{}", ran.stderr);

    let ran = bench.succeeds("diagnose model.json --time t --smoothing false --no-report");
    for option in ["--time", "--smoothing"] {
        let told = format!("warning: the diagnosis of a model ignores {option}\n");
        assert!(ran.stderr.contains(&told), "{}", ran.stderr);
    }
}

fn with_temperature(mut row: Vec<String>) -> Vec<String> {
    let angle: f64 = row[0].parse().unwrap();
    row.insert(2, format!("{:.4}", sin(1.3 * angle)));
    row
}

#[test]
fn several_tables_are_one_set_of_records() {
    let bench = Workbench::new();
    bench.put("a.csv", table());
    bench.put("b.csv", table());
    let both = bench.json("diagnose a.csv b.csv --json");
    assert_eq!((both["records"].as_u64(), both["samples"].as_u64()), (Some(2), Some(120)));
    assert!(bench.path("a.diagnosis.html").exists(), "the page is named after the first");
}

#[test]
fn requests_that_cannot_be_met_are_refused_in_one_line() {
    let bench = Workbench::with_model();
    bench.refuses(
        r#"
        2 diagnose good.csv model.json => model.json is a model: diagnose it alone, without further files
        2 diagnose good.csv -o good.csv => good.csv would be overwritten: name another file with --out
        2 diagnose model.json -o model.json => model.json would be overwritten: name another file with --out
        1 diagnose nowhere.csv => nowhere.csv: cannot be read: no such file or directory
        1 diagnose good.csv --input z => good.csv: there is no column "z" for --input (columns: t, x, y)
        1 diagnose good.csv -o nowhere/a.html => nowhere/a.html: cannot be written: no such file or directory
        2 diagnose good.csv --smallest-reversal 2 => invalid value '2' for '--smallest-reversal <FRACTION>': a number between 0 and 1 is needed
    "#,
    );
    assert!(!bench.path("good.diagnosis.html").exists());
}
