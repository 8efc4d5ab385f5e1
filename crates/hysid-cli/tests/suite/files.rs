//! Files as instruments and tools write them: each has the same record, and is read without an option, or with the first
//! hint that the error gives. `generate-files` of the laboratory (`lab/`) writes them.

use std::fs;
use std::path::Path;

use hysid_core::elementary::sin;

use crate::workbench::{self, Ran, Workbench, must_contain};

/// A column of numbers; NaN where there is none.
type Column = Vec<f64>;

/// The columns of a CSV table with their names, and without the names of records.
fn columns(text: &str) -> (Vec<String>, Vec<Column>) {
    let (names, columns) = workbench::columns(text);
    let is_number = |name: &String| name != "record";
    let kept = names.into_iter().zip(columns).filter(|(name, _)| is_number(name));
    kept.unzip()
}

fn path(file: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(file).display().to_string()
}

fn look(bench: &Workbench, file: &str, options: &str) -> Ran {
    bench.run(&format!("look {} -o clean.csv --force {options}", path(file)))
}

/// The columns that were read are those of the record, times these factors.
fn check(bench: &Workbench, ran: &Ran, file: &str, names: &[&str], factors: [f64; 3]) {
    assert_eq!(ran.status, Some(0), "{file}: {}{}", ran.stdout, ran.stderr);
    let (found, columns) = columns_of(bench);
    assert_eq!(found, names, "{file}");
    let (_, truth) = self::columns(&fs::read_to_string(path("plain.csv")).unwrap());
    // A file of two columns has no time.
    let first = truth.len() - names.len();
    for (place, truth) in truth.iter().enumerate().skip(first) {
        let column = &columns[place - first];
        assert_eq!(column.len(), truth.len(), "{file}");
        for (row, (found, truth)) in column.iter().zip(truth).enumerate() {
            let is_missing = file.starts_with("missing") && place == 2 && row % 10 == 7;
            let expected = if is_missing { f64::NAN } else { factors[place] * truth };
            // Time that starts again is that of another record.
            let expected =
                if file == "time-restarting.csv" && place == 0 && row >= 24 { truth - 2.4 } else { expected };
            let is_equal = (found - expected).abs() < 1e-9 || found.is_nan() && expected.is_nan();
            assert!(is_equal, "{file}, {}, row {row}: {found} and not {expected}", names[place - first]);
        }
    }
}

fn columns_of(bench: &Workbench) -> (Vec<String>, Vec<Column>) {
    columns(&bench.text("clean.csv"))
}

/// Files that are read without an option: theirs and the names of their columns.
const READ: &str = "\
bar.txt blanks.dat carriage-returns.csv comma-and-blank.csv comment-header.txt comments.csv: t | x | y
compressed.csv.gz constant-column.csv exponents.csv fortran-exponents.dat index-named.csv: t | x | y
index-unnamed.csv index-without-name.txt matlab-5.mat matlab-7.3.mat matlab-structure.mat: t | x | y
missing-dash.csv missing-empty.csv missing-na.csv missing-nan.csv missing-null.csv plain.csv: t | x | y
plus-signs.csv quoted-decimal-comma.csv quoted.csv record-column.csv status-column.csv text-behind.csv: t | x | y
time-restarting.csv trailing-delimiter.csv windows-lines.csv: t | x | y
blanks-comma.dat excel-second-sheet.xlsx excel.xlsx semicolon-comma.csv semicolon-point.csv tab-comma.txt tab.txt: Time (s) | Displacement (mm) | Force (kN)
chinese.csv gbk.csv: 时间(s) | 位移(mm) | 荷载(kN)
cp1251.csv russian.csv: Время, с | Перемещение, мм | Сила, кН
duplicate-names.csv: t | Channel | Channel (2)
excel-dates.xlsx: Time [s] | Displacement (mm) | Force (kN)
excel-preamble.xlsx names-units-remarks.txt units-in-cells.csv units-row-brackets.csv units-row.csv: Time [s] | Displacement [mm] | Force [kN]
finite-elements.out: TIME | U1 | RF1
french.csv: Temps (s) | Déplacement (mm) | Effort (kN)
german.csv logger.csv utf16-big.txt utf16-little.txt utf16-unmarked.txt: Zeit [s] | Weg [mm] | Kraft [kN]
japanese.csv shift-jis.csv: 時間(s) | 変位(mm) | 荷重(kN)
labview.lvm: X_Value | Displacement | Force
latin1.csv utf8-mark.csv: Zeit [s] | Längung [µm] | Kraft [kN]
magnetometer.txt: H [A/m] | B [T]
no-header-blanks.dat no-header-semicolon.csv no-header-tab.txt no-header.csv: c1 | c2 | c3
no-time.csv: x | y
oscilloscope.csv: TIME | CH1 | CH2
servo-hydraulic.txt: Running Time [Sec] | Axial Displacement [mm] | Axial Force [kN]
spanish.csv: Tiempo (s) | Desplazamiento (mm) | Fuerza (kN)
testing-machine.csv: Time [s] | Extension [mm] | Load [kN]
time-american.csv: Date/Time [s] | x | y
time-clock.csv: clock [s] | x | y
time-date-and-clock.txt: Time [s] | x | y
time-german.csv: Datum und Uhrzeit [s] | x | y
time-iso-blank.csv time-iso.csv: timestamp [s] | x | y
time-rounded.csv: Elapsed | x | y
two-header-lines.csv: Time (s) | Value (mm) | Value (kN)
";

/// The same where a column is in another unit.
const IN_OTHER_UNITS: [(&str, [&str; 3], [f64; 3]); 5] = [
    ("thousands-apostrophe.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]),
    ("thousands-blank.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]),
    ("thousands-comma.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]),
    ("thousands-point.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]),
    ("time-milliseconds.csv", ["time_ms", "x", "y"], [1000.0, 1.0, 1.0]),
];

/// Files that are refused with a hint, and read with the option that it names.
const HINTED: [(&str, &str, &str, [&str; 3]); 5] = [
    ("colons.txt", "name it with --delimiter", "--delimiter :", ["t", "x", "y"]),
    ("command-and-measured.csv", "with --input", "--input measured", ["t", "measured", "y"]),
    ("growing-column.csv", "if it is time, --time position", "--time position", ["position", "x", "y"]),
    ("many-columns.csv", "name them with --input", "--input x", ["t", "x", "y"]),
    ("missing-word.csv", "--missing overflow", "--missing overflow", ["t", "x", "y"]),
];

#[test]
fn files_are_read_without_an_option() {
    let bench = Workbench::new();
    for (files, names) in READ.lines().map(|line| line.split_once(": ").unwrap()) {
        for file in files.split(' ') {
            let names: Vec<&str> = names.split(" | ").collect();
            check(&bench, &look(&bench, file, ""), file, &names, [1.0; 3]);
        }
    }
    for (file, names, factors) in IN_OTHER_UNITS {
        check(&bench, &look(&bench, file, ""), file, &names, factors);
    }
}

#[test]
fn files_are_read_with_the_option_that_the_error_names() {
    let bench = Workbench::new();
    for (file, hint, options, names) in HINTED {
        let refused = look(&bench, file, "");
        assert_eq!(refused.status, Some(1), "{file}: {}", refused.stdout);
        assert!(refused.last_line().contains(hint), "{file}: {}", refused.last_line());
        check(&bench, &look(&bench, file, options), file, &names, [1.0; 3]);
    }
}

/// The roles of the columns of a file that has them in no usual order.
#[test]
fn a_look_tells_what_each_column_is() {
    let bench = Workbench::new();
    let ran = bench.run(&format!("look {} --json", path("temperature-last.csv")));
    let told: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let columns = told["files"][0]["columns"].as_array().unwrap();
    let roles: Vec<&str> = columns.iter().map(|column| column["role"].as_str().unwrap()).collect();
    assert_eq!(roles, ["time", "input", "output", "unused"]);
    assert_eq!(columns[2]["unit"], "kN");
    assert_eq!(columns[2]["missing"], 0);
    assert_eq!(told["files"][0]["delimiter"], "comma");

    let ran = bench.run(&format!("look {}", path("labview.lvm")));
    for line in [
        "read as  text, UTF-8; columns separated by tabs, decimal point, 21 lines before\n         the table, names in line 22",
        "rows     48, in lines 23 to 70",
        "Displacement   input",
    ] {
        assert!(ran.stdout.contains(line), "{line}\n{}", ran.stdout);
    }
}

/// Columns without roles are shown, and the error says what to do.
#[test]
fn a_look_shows_columns_also_where_their_roles_are_unclear() {
    let bench = Workbench::new();
    let ran = bench.run(&format!("look {}", path("command-and-measured.csv")));
    assert_eq!(ran.status, Some(1));
    assert!(
        ran.stdout.lines().any(|line| line.starts_with("command ") && line.contains(" ? ")),
        "{}",
        ran.stdout
    );
    assert!(ran.last_line().contains("--input measured"), "{}", ran.last_line());

    let ran = bench.succeeds(&format!("look {}", path("force-first.csv")));
    assert!(ran.stderr.contains("(to change it: --output force_kN)"), "{}", ran.stderr);
    let ran = bench.run(&format!("look {} --output force_kN", path("force-first.csv")));
    assert!(ran.stdout.contains("disp_mm    input    mm"), "{}", ran.stdout);
}

/// Every command takes the options of reading.
#[test]
fn options_of_reading_choose_lines_rows_and_offsets() {
    let bench = Workbench::new();
    let look = |file: &str, options: &str| {
        let ran = look(&bench, file, options);
        assert_eq!(ran.status, Some(0), "{file} {options}: {}", ran.stderr);
        columns_of(&bench)
    };
    let (names, all) = look("plain.csv", "");
    let (_, some) = look("plain.csv", "--rows 11:30 --every 3");
    assert_eq!(some[1], all[1][10..30].iter().step_by(3).copied().collect::<Column>());
    let (numbered, columns) = look("plain.csv", "--skip 1 --no-header");
    assert_eq!(numbered, ["c1", "c2", "c3"]);
    assert_eq!(columns, all);
    assert_eq!(look("units-row.csv", "--units-row").0, ["Time [s]", "Displacement [mm]", "Force [kN]"]);
    assert_eq!(look("cp1251.csv", "--encoding cp1251").0[0], "Время, с");
    assert_eq!(look("semicolon-comma.csv", "--delimiter semicolon --decimal comma").1, all);
    assert_eq!(look("excel-second-sheet.xlsx", "--sheet 2").1, all);

    let (_, shifted) = look("plain.csv", "--zero 5");
    let mean = |column: &Column| column[..5].iter().sum::<f64>() / 5.0;
    for place in [1, 2] {
        let offset = mean(&all[place]);
        for (found, value) in shifted[place].iter().zip(&all[place]) {
            assert!((found - (value - offset)).abs() < 1e-12, "{}", names[place]);
        }
    }
    assert_eq!(shifted[0], all[0]);
}

#[test]
fn a_missing_input_is_told_with_its_line() {
    let bench = Workbench::new();
    let ran = look(&bench, "missing-input.csv", "");
    assert!(
        ran.last_line().ends_with(
            "line 2, column \"x\": the cell is empty (only the output may be blank; choose rows with --rows)"
        ),
        "{ran}"
    );
    let ran = look(&bench, "missing-input.csv", "--rows 2:");
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    assert_eq!(columns_of(&bench).1[0].len(), 47);
}

/// A model of one file runs over every other form of it with the same result.
#[test]
fn a_table_that_is_streamed_is_read_as_one_that_is_not() {
    let bench = Workbench::new();
    let fit = format!("fit {} --model prandtl-ishlinskii --no-report -o m.json", path("plain.csv"));
    bench.succeeds(&fit);
    let errors = |file: &str, options: &str| {
        let errors = bench.json(&format!("evaluate m.json {} --json {options}", path(file)));
        (errors["samples"].as_u64().unwrap(), errors["rmse"].as_f64().unwrap())
    };
    let expected = errors("plain.csv", "");
    for file in [
        "blanks.dat",
        "comments.csv",
        "fortran-exponents.dat",
        "matlab-5.mat",
        "text-behind.csv",
        "utf8-mark.csv",
    ] {
        let options =
            if file == "utf8-mark.csv" { "--input Längung --output Kraft --same-units" } else { "" };
        assert_eq!(errors(file, options), expected, "{file}");
    }
    assert_eq!(errors("missing-nan.csv", "").0, 43);
    assert_eq!(errors("missing-999.csv", "--missing -999").0, 43);
    assert_eq!(errors("plain.csv", "--rows :20").0, 20);
}

/// A number may stand for a missing value; only a person can decide.
#[test]
fn a_number_that_stands_for_a_missing_value_is_told_with_the_option_that_names_it() {
    let bench = Workbench::new();
    let ran = look(&bench, "missing-999.csv", "");
    assert_eq!(ran.status, Some(0));
    must_contain(&ran.stderr, &["warning: \"y\" is -999 in 5 rows", "(--missing -999)"]);
    let ran = look(&bench, "missing-999.csv", "--missing -999");
    check(&bench, &ran, "missing-999.csv", &["t", "x", "y"], [1.0, 1.0, 1.0]);
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
}

#[test]
fn a_clean_table_can_go_to_standard_output_and_come_from_standard_input() {
    let bench = Workbench::new();
    let piped = bench.shell(&format!("hysid look {} -o - | hysid look - --json", path("utf16-little.txt")));
    let told: serde_json::Value = serde_json::from_str(&piped.stdout).unwrap();
    assert_eq!(told["files"][0]["file"], "standard input");
    assert_eq!(told["files"][0]["rows"], 48);
    assert_eq!(told["files"][0]["columns"][2]["name"], "Kraft [kN]");
    let refused = bench.run(&format!("look {} -o - --json", path("plain.csv")));
    assert_eq!(refused.status, Some(2), "{}", refused.stderr);
}

#[test]
fn every_file_has_a_test_and_a_place_on_the_page() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("../../docs/files.md")).unwrap();
    let files = fs::read_dir(root.join("tests/files")).unwrap();
    let names: Vec<String> = files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    assert!(names.len() >= 60, "{}", names.len());
    let tested: Vec<&str> =
        include_str!("files.rs").split(|c: char| c.is_whitespace() || "\":".contains(c)).collect();
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "docs/files.md lacks {name}");
        assert!(tested.contains(&name.as_str()), "{name} has no test");
    }
}

/// Errors about how a file is read, and the option that each names.
#[test]
fn hints_about_reading_work_when_they_are_followed() {
    let bench = Workbench::new();
    let rows = |row: &dyn Fn(usize) -> String, count: usize| (0..count).map(row).collect::<String>();
    let x = |k: usize| format!("{:.2}", sin(0.3 * k as f64));
    let too_many_names = format!("t,x,y,z\n{}", rows(&|k| format!("{k}.5,{},{}\n", x(k), x(k + 1)), 20));
    let forces = ["850", "920", "990", "1.012", "1.234", "-1.100", "870", "1.250"];
    let thousands = format!("x;F\n{}", rows(&|k| format!("{};{}\n", x(k), forces[k % 8]), 24));
    let mut late = format!("t,x,y,note\n{}", rows(&|k| format!("{k}.5,{},{},ok\n", x(k), x(k + 1)), 30_000))
        .into_bytes();
    late.extend(b"30000.5,0.1,0.2,20\xb0\n");
    for (content, hint, options) in [
        (too_many_names.into_bytes(), "(skip the header with --skip 1 --no-header)", "--skip 1 --no-header"),
        (
            thousands.clone().into_bytes(),
            "(choose with --decimal point or --decimal comma)",
            "--decimal point",
        ),
        (
            late,
            "(name the encoding with --encoding, such as windows-1252, or save",
            "--encoding windows-1252",
        ),
    ] {
        bench.put("data.csv", content);
        let refused = bench.run("look data.csv");
        assert_eq!(refused.status, Some(1), "{hint}: {}", refused.stdout);
        assert!(refused.last_line().contains(hint), "{}", refused.last_line());
        bench.succeeds(&format!("look data.csv {options}"));
    }
}

#[test]
fn what_comes_from_standard_input_is_called_data() {
    let bench = Workbench::new();
    let plain = path("plain.csv");
    for (command, file) in [
        ("hysid fit - --model prandtl-ishlinskii --no-report", "data.json"),
        ("hysid diagnose -", "data.diagnosis.html"),
        ("hysid cycles - --no-report", "data.cycles.csv"),
    ] {
        let ran = bench.shell(&format!("cat {plain} | {command}"));
        assert_eq!(ran.status, Some(0), "{command}: {}", ran.stderr);
        assert!(bench.path(file).exists(), "{command}: {}", ran.stderr);
    }
}

/// The output goes on where the input of the other file is.
#[test]
fn input_and_output_in_two_files_are_joined() {
    let bench = Workbench::new();
    let (_, truth) = columns(&fs::read_to_string(path("plain.csv")).unwrap());
    let file = |place: usize| -> String {
        truth[0].iter().zip(&truth[place]).map(|(t, value)| format!("{t} {value}\n")).collect()
    };
    bench.put("Disp.out", file(1));
    bench.put("RFrc.out", file(2));
    let refused = bench.run("look Disp.out RFrc.out");
    must_contain(refused.last_line(), &["(hysid look Disp.out RFrc.out --join -o both.csv joins"]);
    let ran = bench.run("look Disp.out RFrc.out --join -o clean.csv");
    check(&bench, &ran, "Disp.out", &["t", "Disp", "RFrc"], [1.0; 3]);
}

#[test]
fn several_tables_of_a_file_are_records() {
    let bench = Workbench::new();
    let ran = bench.succeeds(&format!("look {}", path("two-tables.csv")));
    must_contain(
        &ran.stdout,
        &["text, UTF-8, table 1, table 2;", "51, all scored, in 2 records: table 1, table 2"],
    );
    check(&bench, &look(&bench, "two-tables.csv", "--sheet 1"), "two-tables.csv", &["t", "x", "y"], [1.0; 3]);
    let refused = look(&bench, "two-tables.csv", "--sheet 3");
    assert!(
        refused.last_line().ends_with("no table \"3\" for --sheet (tables: table 1, table 2)"),
        "{refused}"
    );
    // A loop with names of its own is more than a summary; an error names the line of the file.
    let rows = |scale: f64| -> String {
        (0..40)
            .map(|k| {
                format!("{:.3}\t{:.3}\n", sin(0.3 * f64::from(k)), scale * sin(0.3 * f64::from(k) - 0.2))
            })
            .collect()
    };
    let text = format!(
        "Results\nNo\tVc [V]\tPr [C/m2]\n1\t0.5\t2\n2\t0.6\t3\n3\t0.7\t4\n\nSample A\nV [V]\tP [C/m2]\n{}\nSample B\n\
         V [V]\tP [C/m2]\n{}",
        rows(1.0),
        rows(2.0)
    );
    bench.put("tester.dat", &text);
    let ran = bench.succeeds("look tester.dat");
    must_contain(
        &ran.stdout,
        &["left out table 1 (3 rows)", "80, all scored, in 2 records: table 2, table 3"],
    );
    bench.put(
        "tester.dat",
        text.replacen("Sample B\nV [V]\tP [C/m2]\n0.000", "Sample B\nV [V]\tP [C/m2]\n?", 1),
    );
    let refused = bench.run("look tester.dat");
    assert!(
        refused.last_line().starts_with("error: tester.dat, line 52, column \"V [V]\": \"?\""),
        "{refused}"
    );
}

#[test]
fn loops_side_by_side_and_lying_tables_are_read() {
    let bench = Workbench::new();
    let x = |k: usize| sin(0.3 * k as f64);
    let loops: String =
        (0..40).map(|k| format!("{:.3},{:.3},{:.3},{:.3}\n", x(k), x(k + 1), 2.0 * x(k), x(k + 2))).collect();
    for (header, records) in [
        ("H (Oe),M (emu),H (Oe),M (emu)", "2 records: 1, 2"),
        ("up,,down,\nH (Oe),M (emu),H (Oe),M (emu)", "2 records: up, down"),
    ] {
        bench.put("pairs.csv", format!("{header}\n{loops}"));
        let ran = bench.succeeds("look pairs.csv");
        must_contain(&ran.stdout, &["text, UTF-8, 2 groups of columns;", records]);
    }
    bench.put("stages.csv", format!("Raw,Raw,Adjusted,Adjusted\nField,Moment,Field,Moment\n{loops}"));
    must_contain(&bench.succeeds("look stages.csv").stdout, &["Adjusted Field    input", "in 1 record"]);
    // A magnetometer labels the adjusted columns alone, and writes names in columns of blanks over rows with commas.
    let head = "                      Adjusted    Adjusted\n  Field      Moment      Field      Moment\n";
    bench.put("stages.csv", format!("{head}{loops}"));
    let asked = bench.run("look stages.csv").stderr;
    must_contain(&asked, &["--input 'Adjusted Field' --output 'Adjusted Moment'"]);
    let row =
        |of: &dyn Fn(usize) -> f64| (0..60).map(|k| format!("{:.3}", of(k))).collect::<Vec<_>>().join(",");
    bench.put("lying.csv", format!("x,{}\ny,{}\n", row(&x), row(&|k| 2.0 * x(k))));
    let ran = bench.succeeds("look lying.csv");
    must_contain(&ran.stdout, &["its rows as columns", "rows     60", "x        input", "y       output"]);
}
