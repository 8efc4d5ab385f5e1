//! Tables in other units than the model's, and numbers that are not what they look like.

use crate::workbench::{Ran, Workbench, csv, json, rows};
use serde_json::Value;

/// A model of `disp_mm` and `force_kN` over `t_s`, and its own data.
fn bench() -> Workbench {
    let bench = Workbench::new();
    bench.put("good.csv", csv("t_s,disp_mm,force_kN", ",", "\n", &rows()));
    bench.succeeds("fit good.csv -o model.json --no-report --model xpnn+ --starts 1 --epochs 3");
    bench
}

/// The record under another header, its columns multiplied.
fn scaled(header: &str, factors: [f64; 3]) -> String {
    let scale = |row: Vec<String>| {
        let numbers = row.iter().zip(factors).map(|(cell, factor)| factor * cell.parse::<f64>().unwrap());
        numbers.map(|number| format!("{number:.12}")).collect()
    };
    csv(header, ",", "\n", &rows().into_iter().map(scale).collect::<Vec<_>>())
}

#[test]
fn known_units_are_converted_to_the_model_s() {
    let bench = bench();
    let own = bench.json("evaluate model.json good.csv --json");
    bench.put("other.csv", scaled("clock_ms,displacement_m,force_N", [1e3, 1e-3, 1e3]));
    let named = "--time clock_ms --input displacement_m --output force_N";
    let ran = bench.run(&format!("evaluate model.json other.csv {named} --json"));
    let found = json(&ran);
    let rmse = |errors: &Value| errors["rmse"].as_f64().unwrap();
    assert!((rmse(&found) / rmse(&own) - 1.0).abs() < 1e-6, "{found} {own}");
    assert_eq!(found["output"], "force_kN");
    for told in [
        "converted: clock_ms from ms to s, the unit of the model's t_s (factor 0.001)",
        "converted: displacement_m from m to mm, the unit of the model's disp_mm (factor 1000)",
        "converted: force_N from N to kN, the unit of the model's force_kN (factor 0.001)",
    ] {
        assert!(ran.stderr.contains(told), "{}", ran.stderr);
    }
    bench.put("unknown.csv", scaled("t_s,disp_mm,force_xy", [1.0, 1.0, 1.0]));
    let ran = bench.run("evaluate model.json unknown.csv --output force_xy --json");
    let told = "not converted: force_xy, whose name tells no known unit, is taken to be in kN, the unit of the model's force_kN";
    assert!(ran.stderr.contains(told), "{}", ran.stderr);
    // The same quantity in another unit is found without being named.
    bench.put("found.csv", scaled("t_ms,disp_m,force_N", [1e3, 1e-3, 1e3]));
    let found = bench.json("evaluate model.json found.csv --json");
    assert!((rmse(&found) / rmse(&own) - 1.0).abs() < 1e-6, "{found} {own}");
    let [one, other] =
        ["good.csv", "found.csv"].map(|data| bench.run(&format!("simulate model.json {data}")));
    let last = |ran: &Ran| -> f64 { ran.stdout.trim_end().rsplit(',').next().unwrap().parse().unwrap() };
    assert!((last(&one) - last(&other)).abs() < 1e-6 * last(&one).abs(), "{} {}", last(&one), last(&other));
}

#[test]
fn other_units_are_refused_unless_they_are_said_to_be_the_same() {
    let bench = bench();
    bench.put("other.csv", csv("t_s,x [ticks],force_kN", ",", "\n", &rows()));
    let asked = ["evaluate", "--input", "x [ticks]", "model.json", "other.csv", "--json"];
    let ran: Ran = bench.command("").args(asked).output().unwrap().into();
    let told = "error: other.csv: column \"x [ticks]\" is in ticks, the model's \"disp_mm\" in mm: no \
                conversion between them is known (name another column, convert the numbers, or use them \
                unchanged with --same-units)";
    assert_eq!((ran.status, ran.last_line()), (Some(1), told));
    let ran: Ran = bench.command("--same-units").args(asked).output().unwrap().into();
    assert_ne!(ran.status, Some(0), "an option stands behind its command");
    let ran: Ran = bench.command("").args(asked).arg("--same-units").output().unwrap().into();
    assert_eq!(json(&ran), bench.json("evaluate model.json good.csv --json"));
    let ran = bench.run("simulate model.json good.csv --input force_kN");
    assert!(ran.last_line().contains("column \"force_kN\" is in kN, the model's \"disp_mm\" in mm"));
    // A column without a unit is taken as it is.
    bench.put("plain.csv", csv("t,x,y", ",", "\n", &rows()));
    bench.json("evaluate model.json plain.csv --time t --input x --output y --json");
}

#[test]
fn separators_of_thousands_are_no_decimal_points() {
    let bench = bench();
    let thousands = |cell: &str| {
        let whole = (4000.0 * cell.parse::<f64>().unwrap()).round() as i64;
        let sign = if whole < 0 { "-" } else { "" };
        match whole.abs() {
            small @ 0..1000 => format!("{sign}{small}"),
            large => format!("{sign}{}.{:03}", large / 1000, large % 1000),
        }
    };
    let mut german = rows();
    german.iter_mut().for_each(|row| row[2] = thousands(&row[2]));
    bench.put("german.csv", csv("t_s,disp_mm,force_kN", ",", "\n", &german));
    for command in ["fit german.csv -o out.json --model pnn", "evaluate model.json german.csv"] {
        let ran = bench.run(command);
        assert_eq!(ran.status, Some(1), "{}", ran.stderr);
        let told = ran.last_line();
        assert!(
            told.starts_with("error: german.csv, line ") && told.contains("thousands separator"),
            "{told}"
        );
    }
}
