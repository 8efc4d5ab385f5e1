//! `hysid generate` as a user runs it.

use crate::workbench::Workbench;

const SPECIMENS: &str = "ferromagnet reinforced-concrete-joint reinforced-concrete-joint-cycles \
    terfenol-actuator terfenol-rod shape-memory-actuator two-wire-actuator concrete piezo-actuator \
    rate-dependent-actuator rate-dependent-actuator-tones magnetostrictive-actuator bouc-wen-oscillator \
    shear-building piezo-stage duffing-oscillator";

/// The numbers in the last column of a CSV text; NaN for a blank.
fn outputs(text: &str) -> Vec<f64> {
    let last = |line: &str| line.rsplit(',').next().unwrap().parse().unwrap_or(f64::NAN);
    text.lines().skip(1).map(last).collect()
}

#[test]
fn what_is_to_be_typed_next_works() {
    let bench = Workbench::new();
    for name in SPECIMENS.split(' ').step_by(3) {
        let ran = bench.succeeds(&format!("generate {name} -o {name}.csv --test {name}-test.csv --noise 1"));
        assert_eq!(ran.stdout, "");
        for (file, what) in [(format!("{name}.csv"), "training"), (format!("{name}-test.csv"), "test")] {
            assert!(ran.stderr.contains(&format!("wrote {file}: {what} data, ")), "{}", ran.stderr);
        }
        let typed: Vec<&str> = ran.stderr.lines().filter(|line| line.starts_with("  hysid ")).collect();
        assert_eq!(typed.len(), 2, "{}", ran.stderr);
        for (line, quick) in typed.iter().zip([" --model xpnn+ --starts 1 --epochs 1 --no-report", ""]) {
            let ran = bench.shell(&format!("{line}{quick}"));
            assert_eq!(ran.status, Some(0), "{line}: {}", ran.stderr);
        }
    }
}

#[test]
fn columns_have_names_with_units_and_records_only_where_there_are_several() {
    let bench = Workbench::new();
    let header = |name: &str| {
        let text = bench.succeeds(&format!("generate {name}")).stdout;
        text.lines().next().unwrap().to_string()
    };
    assert_eq!(header("ferromagnet"), "H_A_per_m,B_T");
    assert_eq!(header("reinforced-concrete-joint"), "t_s,displacement_mm,force_kN");
    assert_eq!(header("piezo-actuator"), "record,t_s,voltage_V,displacement_um");
    let piezo = bench.succeeds("generate piezo-actuator").stdout;
    let first_row = piezo.lines().nth(1).unwrap();
    assert!(first_row.ends_with(',') && !first_row.contains("NaN"), "a blank is an empty cell: {first_row}");
}

#[test]
fn each_set_of_data_goes_where_it_is_asked_to() {
    let bench = Workbench::new();
    bench.succeeds("generate concrete -o train.csv --test test.csv");
    let (train, test) = (bench.text("train.csv"), bench.text("test.csv"));
    for (arguments, expected) in [
        ("generate concrete", &train),
        ("generate concrete -o -", &train),
        ("generate concrete --test -", &test),
        ("generate concrete -o - --test again.csv", &train),
        ("generate concrete -o once-more.csv --test -", &test),
    ] {
        assert_eq!(&bench.succeeds(arguments).stdout, expected, "hysid {arguments}");
    }
    let only_test = bench.succeeds("generate concrete --test only.csv");
    assert_eq!((only_test.stdout.as_str(), bench.text("only.csv")), ("", test));
    assert!(only_test.stderr.contains("hysid evaluate MODEL.json only.csv"), "{}", only_test.stderr);
    assert!(!only_test.stderr.contains("hysid fit"), "{}", only_test.stderr);
}

#[test]
fn noise_depends_on_the_seed_and_is_not_shared_by_training_and_test() {
    let bench = Workbench::new();
    let set = |arguments: &str| outputs(&bench.succeeds(&format!("generate ferromagnet {arguments}")).stdout);
    let noise = |arguments: &str| -> Vec<f64> {
        let clean = set(arguments.split(" --noise").next().unwrap());
        let noise: Vec<f64> = set(arguments).iter().zip(&clean).map(|(noisy, clean)| noisy - clean).collect();
        let deviation = (noise.iter().map(|v| v * v).sum::<f64>() / noise.len() as f64).sqrt();
        noise.iter().map(|v| v / deviation).collect()
    };
    let correlation = |a: &[f64], b: &[f64]| {
        let n = a.len().min(b.len());
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / n as f64
    };
    let train = noise("-o - --noise 2 --seed 7");
    assert_eq!(train, noise("-o - --noise 2 --seed 7"));
    // Five standard errors of the correlation of independent samples.
    let independent = 5.0 / (train.len() as f64).sqrt();
    for other in ["--test - --noise 2 --seed 7", "-o - --noise 2 --seed 8", "--test - --noise 2 --seed 8"] {
        let correlation = correlation(&train, &noise(other));
        assert!(correlation.abs() < independent, "{other}: {correlation}");
    }
}

#[test]
fn the_list_describes_every_specimen_in_80_columns() {
    let bench = Workbench::new();
    let list = bench.succeeds("generate --list").stdout;
    for line in list.lines() {
        assert!(line.chars().count() <= 80 && line == line.trim_end(), "{line}");
    }
    let names: Vec<&str> = list
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_lowercase()))
        .map(|line| line.split(' ').next().unwrap())
        .collect();
    assert_eq!(names.join(" "), SPECIMENS);
    for what in ["columns", "published", "designed", "training", "test"] {
        assert_eq!(list.lines().filter(|line| line.starts_with(&format!("  {what} "))).count(), 16, "{what}");
    }

    let json = bench.succeeds("generate --list --json").stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let objects = json.as_array().unwrap();
    let names: Vec<&str> = objects.iter().map(|object| object["name"].as_str().unwrap()).collect();
    assert_eq!(names.join(" "), SPECIMENS);
    for object in objects {
        assert!(object["example"].is_null() || object["example"].as_str().unwrap().starts_with("example "));
        for key in ["summary", "published", "designed", "training", "testing"] {
            assert!(!object[key].as_str().unwrap().is_empty(), "{key}");
        }
        assert!(object["columns"]["output"].is_string());
    }
}

#[test]
fn requests_that_cannot_be_met_are_refused_in_one_line() {
    let bench = Workbench::new();
    std::fs::create_dir(bench.path("folder")).unwrap();
    let names = SPECIMENS.replace(' ', ", ");
    let unknown = "invalid value 'concret' for '[SPECIMEN]'; a similar value exists: 'concrete'";
    let unnamed = format!("name a specimen: {names} (--list describes them)");
    bench.refuses(&format!(
        "
        2 generate concret => {unknown}
        2 generate => {unnamed}
        2 generate concrete --noise NaN => invalid value 'NaN' for '--noise <PERCENT>': a number of percent, 0 or more, is needed
        2 generate concrete --noise inf => invalid value 'inf' for '--noise <PERCENT>': a number of percent, 0 or more, is needed
        2 generate concrete --noise much => invalid value 'much' for '--noise <PERCENT>': a number of percent, 0 or more, is needed
        2 generate concrete --list => the argument '[SPECIMEN]' cannot be used with '--list'
        2 generate concrete -o - --test - => training and test data cannot both go to stdout: name a file with --out or --test
        2 generate concrete -o a.csv --test ./a.csv => ./a.csv: two results would have this name: name another file with --out
        1 generate concrete -o folder => folder: cannot be written: is a directory
        1 generate concrete -o a.csv --test nowhere/a.csv => nowhere/a.csv: cannot be written: no such file or directory
    "
    ));
    assert!(!bench.path("a.csv").exists(), "nothing is written before all of it can be");
}
