//! `hysid plan`: drives from data and for kinds of specimens, their files, and what is refused.

use hysid_core::elementary::sin;

use crate::workbench::{Workbench, columns};

/// Cycles of one amplitude, 400 rows.
fn cycles(header: &str, has_time: bool) -> String {
    let mut text = format!("{header}\n");
    for row in 0..400 {
        let angle = 0.1 * f64::from(row);
        if has_time {
            text += &format!("{},", 0.01 * f64::from(row));
        }
        text += &format!("{},{}\n", 5.0 * sin(angle), 100.0 * sin(angle - 0.3));
    }
    text
}

fn bench() -> Workbench {
    let bench = Workbench::new();
    bench.put("data.csv", cycles("t_s,disp_mm,force_kN", true));
    bench.put("slow.csv", cycles("disp_mm,force_kN", false));
    bench
}

#[test]
fn a_drive_has_the_columns_of_the_data_and_a_page_beside_it() {
    let bench = bench();
    let said = bench.succeeds("plan --like data.csv");
    let (header, columns) = columns(&bench.text("data.drive.csv"));
    assert_eq!(header, ["t_s", "disp_mm"]);
    let [t, x] = &columns[..] else { panic!("two columns") };
    assert!(x.len() <= 400 && x.len() > 350 && x[0] == 0.0 && x[x.len() - 1] == 0.0);
    assert!(x.iter().all(|x| x.abs() <= 5.0));
    assert!(t.windows(2).all(|pair| (pair[1] - pair[0] - 0.01).abs() < 1e-9));
    assert!(bench.text("data.drive.html").contains("What the data do not cover"));
    for expected in ["what the data do not cover", "amplitudes: no swing", "hysid fit data.csv NEW.csv"] {
        assert!(said.stdout.contains(expected), "{expected}: {}", said.stdout);
    }
    assert!(said.stdout.contains("random reversals: many pairs of turning points"), "{}", said.stdout);
    // The range that is said is that of the drive.
    let words: Vec<&str> = said.stdout.split_whitespace().collect();
    let place = words.windows(2).position(|pair| pair == ["disp", "from"]);
    let place = place.unwrap_or_else(|| panic!("{}", said.stdout));
    let number = |word: &str| word.replace('−', "-").parse::<f64>().unwrap();
    let largest = x.iter().fold(f64::NEG_INFINITY, |largest, &x| largest.max(x));
    let smallest = x.iter().fold(f64::INFINITY, |smallest, &x| smallest.min(x));
    assert!((number(words[place + 2]) - smallest).abs() < 1e-3, "{smallest}: {}", said.stdout);
    assert!((number(words[place + 4]) - largest).abs() < 1e-3, "{largest}: {}", said.stdout);
    let widest = said.stdout.lines().map(|line| line.chars().count()).max().unwrap();
    assert!(widest <= 80, "{}", said.stdout);
    // The same again replaces the files of before.
    assert_eq!(bench.succeeds("plan --like data.csv").stdout, said.stdout);
}

#[test]
fn data_without_time_give_a_drive_without_time() {
    let bench = bench();
    let said = bench.succeeds("plan --like slow.csv -o -");
    let (header, columns) = columns(&said.stdout);
    assert_eq!(header, ["disp_mm"]);
    assert!(columns[0].len() > 300);
    // No page is left beside stdout.
    assert!(!bench.path("slow.drive.csv").exists() && !bench.path("slow.drive.html").exists());
}

#[test]
fn the_json_object_has_the_segments_with_their_reasons() {
    let bench = bench();
    let said = bench.succeeds("plan --like data.csv --json -o drive.csv --no-report");
    let told: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(told["drive"], "drive.csv");
    assert!(told["page"].is_null());
    let segments = told["segments"].as_array().unwrap();
    assert!(segments.iter().all(|segment| segment["reason"].as_str().is_some_and(|why| !why.is_empty())));
    assert_eq!(segments.last().unwrap()["rows"][1].as_u64().unwrap() + 1, told["rows"].as_u64().unwrap());
}

#[test]
fn a_kind_of_specimen_has_a_first_test() {
    let bench = bench();
    let said = bench.shell("hysid plan --for 'RC column' --range -50:50 --length 3000");
    assert_eq!(said.status, Some(0), "{}", said.stderr);
    assert!(said.stdout.contains("FEMA 461") && said.stdout.contains("hysid fit NEW.csv"), "{}", said.stdout);
    let (header, columns) = columns(&bench.text("structure.drive.csv"));
    assert_eq!(header, ["x"]);
    assert!(columns[0].len() <= 3000 && columns[0].contains(&50.0) && columns[0].contains(&-50.0));
    let said = bench.succeeds("plan --for piezo --range 0:150 --step 0.001 --duration 5 -o piezo.csv --json");
    let told: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert!(told["duration"].as_f64().unwrap() <= 5.0 && told["limits"]["range"][1] == 150.0);
}

#[test]
fn what_cannot_be_planned_is_said_in_one_line() {
    let bench = bench();
    bench.put("constant.csv", "x,y\n".to_string() + &"1,2\n".repeat(60));
    bench.put("two.csv", cycles("a,b,force", true));
    bench.refuses_in_part(
        "
        2 plan => --for: structure, damper
        2 plan --for jelly --range 0:1 => structure, damper, rubber, actuator, magnet
        2 plan --for piezo => --range LOW:HIGH
        2 plan --for piezo --range 0:1 --duration 3 => --step
        2 plan --for piezo --range 0:1 --length 60 => too few
        2 plan --for piezo --like data.csv => cannot be used with
        1 plan --like none.csv => none.csv
        1 plan --like constant.csv => constant
        2 plan --like two.csv --input a --input b --output force => --input
        2 plan --like data.csv --length 50 => too few
        2 plan --like data.csv --length 5 => length 5
        2 plan --like data.csv --range 5:1 => not below
        2 plan --like slow.csv --duration 3 => --length
        2 plan --like slow.csv --step 0.1 => step
        2 plan --like data.csv -o data.csv => would be overwritten
        2 plan --like data.csv -o drive.html => drive.html: the table and the page would have this name
        2 plan --like data.csv --json -o - => name a file
    ",
    );
    assert!(!bench.path("data.drive.csv").exists());
}
