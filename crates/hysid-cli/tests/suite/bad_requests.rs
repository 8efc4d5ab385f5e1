//! Damaged model files, columns that are not there, wrong command lines, outputs that cannot be
//! written: one line that says where and what helps, and the right exit status.

use crate::workbench::{Workbench, csv, must_contain, rows, table, with_column};
use hysid::model::FORMAT_VERSION;
use hysid_core::elementary::cos;

#[test]
fn model_files() {
    let bench = Workbench::with_model();
    let model = bench.text("model.json");
    let digit = model.find("\"output_mean\": ").unwrap() + "\"output_mean\": ".len() + 4;
    let flipped = if &model[digit..=digit] == "7" { "8" } else { "7" };
    bench.put("flipped.json", format!("{}{flipped}{}", &model[..digit], &model[digit + 1..]));
    bench.put("cut.json", &model[..model.len() / 2]);
    bench.put("empty.json", "");
    let version = format!("\"version\": {FORMAT_VERSION}");
    bench.put("later.json", model.replacen(&version, "\"version\": 99", 1));
    let later = format!(
        "later.json: the model file has format version 99, this program reads up to {FORMAT_VERSION}: use a newer hysid"
    );
    bench.put("edited.json", model.replace("\"x\"", "\"u\""));
    bench.put("other.json", "{\"format\": \"other\"}");
    bench.put("binary.json", b"{\xff}");
    bench.put("latin.txt", b"t,x,Gr\xf6\xdfe\n0,1,2\n".as_slice());
    let lines = model[..model.len() / 2].lines().count();
    let cut = format!(
        "cut.json: the model file is cut off at line {lines} (fit the model anew, or restore the file from a copy)"
    );
    bench.refuses(&format!(
            "
            1 evaluate flipped.json good.csv => flipped.json: the model file was changed after it was written: its checksum does not match (fit the model anew, or restore the file from a copy)
            1 evaluate edited.json good.csv => edited.json: the model file was changed after it was written: its checksum does not match (fit the model anew, or restore the file from a copy)
            1 simulate cut.json good.csv => {cut}
            1 simulate empty.json good.csv => empty.json: the model file is empty (fit the model anew, or restore the file from a copy)
            1 evaluate later.json good.csv => {later}
            1 evaluate other.json good.csv => other.json: this is not a Hysid model file (expected the JSON that `hysid fit` writes)
            1 evaluate binary.json good.csv => binary.json: this is not a Hysid model file: it is not text
            1 evaluate good.csv model.json => good.csv: this is not a Hysid model file (swapped? model.json is one: name the model first)
            1 simulate latin.txt model.json => latin.txt: this is not a Hysid model file (swapped? model.json is one: name the model first)
            1 simulate missing.json good.csv => missing.json: cannot be read: no such file or directory
        "
        ),
    );
}

/// Rows of two inputs that go up and down, and the output.
fn two_inputs() -> Vec<Vec<String>> {
    let mut rows = rows();
    rows.iter_mut().for_each(|row| row[0] = format!("{:.4}", cos(2.0 * row[0].parse::<f64>().unwrap())));
    rows
}

#[test]
fn columns() {
    let bench = Workbench::with_model();
    bench.put("other.csv", csv("t,a,b", ",", "\n", &rows()));
    bench.put("no-time.csv", csv("k,x,y", ",", "\n", &rows()));
    bench.put("inputs.csv", csv("x1,x2,y", ",", "\n", &two_inputs()));
    bench.put("blank.csv", with_column(2, |_| String::new()));
    bench.put("lab.csv", csv("t,x,Dev1/ai1 (nm)", ",", "\n", &rows()));
    bench.succeeds("fit lab.csv -o lab.json --no-report --model pnn --starts 1 --epochs 1");
    let volts: Vec<_> = rows().into_iter().map(|row| [row, vec!["20".into()]].concat()).collect();
    bench.put("volts.csv", csv("t,x,y_um,Temp_C", ",", "\n", &volts));
    let ran = bench.succeeds("evaluate lab.json volts.csv");
    let taken = "taken: y_um, the only column with a unit of this quantity, for the model's Dev1/ai1 (nm)";
    must_contain(&ran.stderr, &[taken, "converted: y_um from um to nm"]);
    bench.put("two.csv", csv("t,x,y_um,z_mm", ",", "\n", &volts));
    bench.put("simulated.csv", csv("t,x,y_model", ",", "\n", &rows()));
    bench.refuses(r#"
            1 evaluate model.json other.csv => other.csv: there is no column "x", the model's input (columns: t, a, b; name another with --input)
            1 evaluate model.json other.csv --input a => other.csv: there is no column "y", the model's output (columns: t, a, b; name another with --output)
            1 evaluate lab.json two.csv => two.csv: there is no column "Dev1/ai1 (nm)", the model's output (columns: t, x, y_um, z_mm; name another with --output)
            1 simulate model.json no-time.csv => no-time.csv: there is no column "t", the model's time (columns: k, x, y; name another with --time)
            2 simulate model.json inputs.csv --input x1 --input x2 => --input names 2 columns, but the model's inputs are 1: x
            1 simulate model.json simulated.csv => simulated.csv: there is already a column "y_model" (rename or remove it)
            1 compare good.csv --test blank.csv => blank.csv: column "y" is blank in every row: there is nothing to compare with
            1 evaluate model.json blank.csv => blank.csv: column "y" is blank in every row: there is nothing to compare with
            2 evaluate model.json good.csv --rate none => the rate is part of the model and cannot be changed here: leave out --rate
            1 fit good.csv --input nope => good.csv: there is no column "nope" for --input (columns: t, x, y)
            2 fit good.csv --input x --output x => column "x" is named twice, by --output and --input
            2 fit inputs.csv --model pnn => pnn takes one input, not 2: use xpnn+, or choose one input with --input
            1 fit inputs.csv --rate central => inputs.csv: there is no time column to compute the rate from (name it with --time, or use --rate none)
            1 fit good.csv --warm-up 60 => good.csv: column "y" has only 0 rows with an output after a warm-up of 60 rows: at least 10 are needed to identify a model (shorten the warm-up)
            1 fit good.csv --model masing --warm-up 55 => good.csv: column "y" has only 5 rows with an output after a warm-up of 55 rows: at least 10 are needed to identify a model (shorten the warm-up)
            1 fit good.csv other.csv => other.csv: there is no column "x", as in good.csv (columns: t, a, b)
        "#,
    );
}

#[test]
fn command_lines() {
    let bench = Workbench::new();
    bench.refuses("
            2 fit => the following required arguments were not provided: <TRAIN.csv>...
            2 fot data.csv => unrecognized subcommand 'fot'; some similar subcommands exist: 'plot', 'fit'
            2 fit data.csv --start 2 => unexpected argument '--start' found; a similar argument exists: '--starts'
            2 fit data.csv --model nn => invalid value 'nn' for '--model <NAME>' [possible values: auto, pnn, gpnn, preisach-nn, xpnn, xpnn+, masing, prandtl-ishlinskii, modified-prandtl-ishlinskii, generalized-prandtl-ishlinskii, rate-dependent-prandtl-ishlinskii, dynamic-prandtl-ishlinskii, preisach, neuro-madelung, bouc-wen, peak-oriented, menegotto-pinto, ramberg-osgood, jiles-atherton, lugre, duhem-nn, hysteretic-oscillator, hysteretic-state-space, random-stops]
            2 fit data.csv --stops 0 => invalid value '0' for '--stops <N>': choose a whole number from 1 to 1000
            2 fit data.csv --starts 0 => invalid value '0' for '--starts <N>': choose a whole number from 1 to 10000
            2 fit data.csv --validation 2 => invalid value '2' for '--validation <SHARE>': a number between 0 and 1 is needed
            2 fit data.csv --time-limit 0 => invalid value '0' for '--time-limit <SECONDS>': a number of seconds above 0, below 1e9, is needed
            2 fit data.csv --training guess => invalid value 'guess' for '--training <NAME>' [possible values: subgradient, levenberg-marquardt, hybrid, genetic]
            2 fit data.csv -o data.html => data.html: use .json for the model file: the report gets the same name with .html
            1 fit data.csv => data.csv: cannot be read: no such file or directory
            1 fit . => .: is a directory, not a file
        ",
    );
    bench.refuses_in_part(
        "
            2 fit data.csv --test b.csv => found (after the fit, `hysid evaluate MODEL.json b.csv` tests the model; `hysid compare`
            2 fit data.csv --test => found (see `hysid fit --help`)
    ",
    );
}

#[test]
fn negative_numbers_are_refused_by_the_option_that_they_are_for() {
    let bench = Workbench::new();
    let whole = "a whole number, 0 or more, is needed";
    let compression = "choose 0 for off, or 1e-6 to 1e3";
    let thresholds = "numbers above 0 are needed, such as 0.1, 0.2, 0.5";
    let seconds = "a number of seconds above 0, below 1e9, is needed";
    let probability = "a probability from 0.5 to 0.99 is needed";
    let percent = "a number of percent, 0 or more, is needed";
    let epochs = "choose a whole number from 0 to 1000000";
    for (arguments, value, option, advice) in [
        ("fit data.csv --thresholds -1,2", "-1,2", "--thresholds <LIST>", thresholds),
        ("fit data.csv --thresholds 0.1,-2", "0.1,-2", "--thresholds <LIST>", thresholds),
        ("fit data.csv --compression -0.1", "-0.1", "--compression <SHARE>", compression),
        ("fit data.csv --rate-compression -1e-3", "-1e-3", "--rate-compression <SHARE>", compression),
        ("fit data.csv --seed -1", "-1", "--seed <N>", whole),
        ("generate concrete --seed -1", "-1", "--seed <N>", "choose 0 or more"),
        ("fit data.csv --warm-up -3", "-3", "--warm-up <N>", whole),
        ("fit data.csv --epochs -3", "-3", "--epochs <N>", epochs),
        ("fit data.csv --seed 1.5", "1.5", "--seed <N>", whole),
        ("fit data.csv --stops -3", "-3", "--stops <N>", "choose a whole number from 1 to 1000"),
        ("fit data.csv --threads -1", "-1", "--threads <N>", "-1 is not in 1..=1024"),
        ("fit data.csv --time-limit -1", "-1", "--time-limit <SECONDS>", seconds),
        ("simulate m.json data.csv --band -0.5", "-0.5", "--band <PROBABILITY>", probability),
        ("generate concrete --noise -1", "-1", "--noise <PERCENT>", percent),
    ] {
        let expected = format!("invalid value '{value}' for '{option}': {advice}");
        bench.refuses(&format!("2 {arguments} => {expected}"));
    }
    // A column may have any name.
    bench.put("data.csv", csv("-1,x,y", ",", "\n", &rows()));

    bench.succeeds("fit data.csv --time -1 -o m.json --no-report --model pnn --starts 1 --epochs 1");
}

#[test]
fn unwritable_outputs() {
    let bench = Workbench::with_model();
    std::fs::create_dir(bench.path("folder")).unwrap();
    bench.put("good.json", "{\"precious\": true}");
    bench.refuses("
            2 fit good.csv => good.json: a file is there already and is no model of Hysid: name another file, or replace it with --force
            1 fit good.csv -o nowhere/model.json => nowhere/model.json: cannot be written: no such file or directory
            1 fit good.csv -o folder --no-report => folder: cannot be written: is a directory
            2 fit good.csv -o good.csv --no-report => good.csv would be overwritten: name another file with --out
            2 simulate model.json good.csv -o ./good.csv => good.csv would be overwritten: name another file with --out
            2 simulate model.json good.csv -o model.json => model.json would be overwritten: name another file with --out
            1 demo -o good.csv => good.csv: cannot be made: file exists
        ",
    );
    #[cfg(target_os = "linux")]
    {
        let full = bench.run("simulate model.json good.csv -o /dev/full");
        assert_eq!(
            (full.status, full.last_line()),
            (Some(1), "error: /dev/full: cannot be written: the disk is full")
        );
        let full = bench.shell("hysid evaluate model.json good.csv >/dev/full");
        assert_eq!(
            (full.status, full.last_line()),
            (Some(1), "error: cannot write to stdout: the disk is full")
        );
    }
}

#[cfg(unix)]
#[test]
fn files_without_permission() {
    use std::fs::{Permissions, set_permissions};
    use std::os::unix::fs::PermissionsExt;

    let bench = Workbench::with_model();
    std::fs::create_dir(bench.path("locked")).unwrap();
    bench.put("locked/secret.csv", table());
    set_permissions(bench.path("locked/secret.csv"), Permissions::from_mode(0o000)).unwrap();
    set_permissions(bench.path("locked"), Permissions::from_mode(0o555)).unwrap();
    if std::fs::read(bench.path("locked/secret.csv")).is_ok() {
        eprintln!("skipped: this user (root?) may read and write everything");
        return;
    }
    bench.refuses(
        "
            1 fit locked/secret.csv => locked/secret.csv: cannot be read: permission denied
            1 fit good.csv -o locked/model.json => locked/model.json: cannot be written: permission denied
        ",
    );
}

/// A folder named `-` was made.
#[test]
fn stdout_is_no_folder() {
    let bench = Workbench::with_model();
    bench.refuses_in_part(
        "
            2 demo -o - => -o -: the files need a folder, which stdout cannot be: name one
            2 man -o - => -o -: the files need a folder, which stdout cannot be: name one
            2 reproduce -o - => -o -: the files need a folder, which stdout cannot be: name one
            2 export model.json --to c -o - => -o -: an export is a folder, which stdout cannot be: name one
        ",
    );
    assert_ne!(bench.shell("ls -d ./-").status, Some(0));
}

/// It started as many threads and did not end.
#[test]
fn threads_of_the_environment_are_not_believed() {
    let bench = Workbench::with_model();
    let line = "RAYON_NUM_THREADS=99999 hysid fit good.csv -o threads.json --no-report --model pnn --starts 1 --epochs 2";
    assert_eq!(bench.shell(line).status, Some(0));
}

/// Percentages of an output that hardly varies are absent, not infinite; ranges that no slope can have are refused.
#[test]
fn extreme_ranges() {
    let bench = Workbench::with_model();
    let scaled = |x: f64, y: f64| {
        let row = |row: Vec<String>| {
            let number = |text: &str, scale: f64| scale * text.parse::<f64>().unwrap();
            vec![row[0].clone(), format!("{:e}", number(&row[1], x)), format!("{:e}", number(&row[2], y))]
        };
        csv("t,x,y", ",", "\n", &rows().into_iter().map(row).collect::<Vec<_>>())
    };
    bench.put("denormal.csv", scaled(1.0, 1e-310));
    bench.put("apart.csv", scaled(1e-90, 1e90));
    let ran = bench.succeeds("evaluate model.json denormal.csv");
    assert!(!ran.stdout.contains("inf") && !ran.stdout.contains("NaN"), "{}", ran.stdout);
    bench.refuses_in_part(
        "
            1 fit apart.csv --model prandtl-ishlinskii => their ratio must be from 1e-50 to 1e50 (choose other units)
        ",
    );
}
