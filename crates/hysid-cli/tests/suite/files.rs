//! Files as instruments and tools write them: each has the same record, and is read without an option, or with the first
//! hint that the error gives. `generate-files` of the laboratory (`lab/`) writes them.

use std::fs;
use std::path::Path;

use crate::workbench::{Ran, Workbench};

/// A column of numbers; NaN where there is none.
type Column = Vec<f64>;

/// The columns of a CSV table with their names, and without the names of records.
fn columns(text: &str) -> (Vec<String>, Vec<Column>) {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let mut columns = vec![Column::new(); names.len()];
    for row in reader.records() {
        for (column, cell) in columns.iter_mut().zip(&row.unwrap()) {
            column.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
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

/// A file that is read without an option.
macro_rules! reads {
    ($test:ident, $file:literal, $names:expr) => {
        reads!($test, $file, $names, [1.0, 1.0, 1.0]);
    };
    ($test:ident, $file:literal, $names:expr, $factors:expr) => {
        #[test]
        fn $test() {
            let bench = Workbench::new();
            let ran = look(&bench, $file, "");
            check(&bench, &ran, $file, &$names, $factors);
        }
    };
}

/// A file that is refused with a hint, and read with the option that it names.
macro_rules! hinted {
    ($test:ident, $file:literal, $hint:literal, $options:literal, $names:expr) => {
        #[test]
        fn $test() {
            let bench = Workbench::new();
            let refused = look(&bench, $file, "");
            assert_eq!(refused.status, Some(1), "{}", refused.stdout);
            assert!(refused.last_line().contains($hint), "{}", refused.last_line());
            let ran = look(&bench, $file, $options);
            check(&bench, &ran, $file, &$names, [1.0, 1.0, 1.0]);
        }
    };
}

reads!(bar_txt, "bar.txt", ["t", "x", "y"]);
reads!(blanks_comma_dat, "blanks-comma.dat", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(blanks_dat, "blanks.dat", ["t", "x", "y"]);
reads!(carriage_returns_csv, "carriage-returns.csv", ["t", "x", "y"]);
reads!(chinese_csv, "chinese.csv", ["时间(s)", "位移(mm)", "荷载(kN)"]);
hinted!(colons_txt, "colons.txt", "name it with --delimiter", "--delimiter :", ["t", "x", "y"]);
reads!(comma_and_blank_csv, "comma-and-blank.csv", ["t", "x", "y"]);
hinted!(
    command_and_measured_csv,
    "command-and-measured.csv",
    "with --input",
    "--input measured",
    ["t", "measured", "y"]
);
reads!(comment_header_txt, "comment-header.txt", ["t", "x", "y"]);
reads!(comments_csv, "comments.csv", ["t", "x", "y"]);
reads!(compressed_csv_gz, "compressed.csv.gz", ["t", "x", "y"]);
reads!(constant_column_csv, "constant-column.csv", ["t", "x", "y"]);
reads!(cp1251_csv, "cp1251.csv", ["Время, с", "Перемещение, мм", "Сила, кН"]);
reads!(duplicate_names_csv, "duplicate-names.csv", ["t", "Channel", "Channel (2)"]);
reads!(excel_dates_xlsx, "excel-dates.xlsx", ["Time [s]", "Displacement (mm)", "Force (kN)"]);
reads!(excel_preamble_xlsx, "excel-preamble.xlsx", ["Time [s]", "Displacement [mm]", "Force [kN]"]);
hinted!(
    excel_second_sheet_xlsx,
    "excel-second-sheet.xlsx",
    "choose another sheet with --sheet: Data",
    "--sheet Data",
    ["Time (s)", "Displacement (mm)", "Force (kN)"]
);
reads!(excel_xlsx, "excel.xlsx", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(exponents_csv, "exponents.csv", ["t", "x", "y"]);
reads!(finite_elements_out, "finite-elements.out", ["TIME", "U1", "RF1"]);
hinted!(
    force_first_csv,
    "force-first.csv",
    "--output force_kN",
    "--output force_kN",
    ["t_s", "disp_mm", "force_kN"]
);
reads!(fortran_exponents_dat, "fortran-exponents.dat", ["t", "x", "y"]);
reads!(french_csv, "french.csv", ["Temps (s)", "Déplacement (mm)", "Effort (kN)"]);
reads!(gbk_csv, "gbk.csv", ["时间(s)", "位移(mm)", "荷载(kN)"]);
reads!(german_csv, "german.csv", ["Zeit [s]", "Weg [mm]", "Kraft [kN]"]);
hinted!(growing_column_csv, "growing-column.csv", "with --time", "--time position", ["position", "x", "y"]);
reads!(index_named_csv, "index-named.csv", ["t", "x", "y"]);
reads!(index_unnamed_csv, "index-unnamed.csv", ["t", "x", "y"]);
reads!(index_without_name_txt, "index-without-name.txt", ["t", "x", "y"]);
reads!(japanese_csv, "japanese.csv", ["時間(s)", "変位(mm)", "荷重(kN)"]);
reads!(labview_lvm, "labview.lvm", ["X_Value", "Displacement", "Force"]);
reads!(latin1_csv, "latin1.csv", ["Zeit [s]", "Längung [µm]", "Kraft [kN]"]);
reads!(logger_csv, "logger.csv", ["Zeit [s]", "Weg [mm]", "Kraft [kN]"]);
reads!(magnetometer_txt, "magnetometer.txt", ["H [A/m]", "B [T]"]);
hinted!(many_columns_csv, "many-columns.csv", "name them with --input", "--input x", ["t", "x", "y"]);
reads!(matlab_5_mat, "matlab-5.mat", ["t", "x", "y"]);
reads!(matlab_7_3_mat, "matlab-7.3.mat", ["t", "x", "y"]);
reads!(matlab_structure_mat, "matlab-structure.mat", ["t", "x", "y"]);
reads!(missing_dash_csv, "missing-dash.csv", ["t", "x", "y"]);
reads!(missing_empty_csv, "missing-empty.csv", ["t", "x", "y"]);
reads!(missing_na_csv, "missing-na.csv", ["t", "x", "y"]);
reads!(missing_nan_csv, "missing-nan.csv", ["t", "x", "y"]);
reads!(missing_null_csv, "missing-null.csv", ["t", "x", "y"]);
hinted!(missing_word_csv, "missing-word.csv", "--missing overflow", "--missing overflow", ["t", "x", "y"]);
reads!(names_units_remarks_txt, "names-units-remarks.txt", ["Time [s]", "Displacement [mm]", "Force [kN]"]);
reads!(no_header_blanks_dat, "no-header-blanks.dat", ["c1", "c2", "c3"]);
reads!(no_header_semicolon_csv, "no-header-semicolon.csv", ["c1", "c2", "c3"]);
reads!(no_header_tab_txt, "no-header-tab.txt", ["c1", "c2", "c3"]);
reads!(no_header_csv, "no-header.csv", ["c1", "c2", "c3"]);
reads!(no_time_csv, "no-time.csv", ["x", "y"]);
reads!(oscilloscope_csv, "oscilloscope.csv", ["TIME", "CH1", "CH2"]);
reads!(plain_csv, "plain.csv", ["t", "x", "y"]);
reads!(plus_signs_csv, "plus-signs.csv", ["t", "x", "y"]);
reads!(quoted_decimal_comma_csv, "quoted-decimal-comma.csv", ["t", "x", "y"]);
reads!(quoted_csv, "quoted.csv", ["t", "x", "y"]);
reads!(record_column_csv, "record-column.csv", ["t", "x", "y"]);
reads!(russian_csv, "russian.csv", ["Время, с", "Перемещение, мм", "Сила, кН"]);
reads!(semicolon_comma_csv, "semicolon-comma.csv", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(semicolon_point_csv, "semicolon-point.csv", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(
    servo_hydraulic_txt,
    "servo-hydraulic.txt",
    ["Running Time [Sec]", "Axial Displacement [mm]", "Axial Force [kN]"]
);
reads!(shift_jis_csv, "shift-jis.csv", ["時間(s)", "変位(mm)", "荷重(kN)"]);
reads!(spanish_csv, "spanish.csv", ["Tiempo (s)", "Desplazamiento (mm)", "Fuerza (kN)"]);
reads!(status_column_csv, "status-column.csv", ["t", "x", "y"]);
reads!(tab_comma_txt, "tab-comma.txt", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(tab_txt, "tab.txt", ["Time (s)", "Displacement (mm)", "Force (kN)"]);
reads!(testing_machine_csv, "testing-machine.csv", ["Time [s]", "Extension [mm]", "Load [kN]"]);
reads!(text_behind_csv, "text-behind.csv", ["t", "x", "y"]);
reads!(thousands_apostrophe_csv, "thousands-apostrophe.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]);
reads!(thousands_blank_csv, "thousands-blank.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]);
reads!(thousands_comma_csv, "thousands-comma.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]);
reads!(thousands_point_csv, "thousands-point.csv", ["t_s", "x_mm", "F_N"], [1.0, 1.0, 1000.0]);
reads!(time_american_csv, "time-american.csv", ["Date/Time [s]", "x", "y"]);
reads!(time_clock_csv, "time-clock.csv", ["clock [s]", "x", "y"]);
reads!(time_date_and_clock_txt, "time-date-and-clock.txt", ["Time [s]", "x", "y"]);
reads!(time_german_csv, "time-german.csv", ["Datum und Uhrzeit [s]", "x", "y"]);
reads!(time_iso_blank_csv, "time-iso-blank.csv", ["timestamp [s]", "x", "y"]);
reads!(time_iso_csv, "time-iso.csv", ["timestamp [s]", "x", "y"]);
reads!(time_milliseconds_csv, "time-milliseconds.csv", ["time_ms", "x", "y"], [1000.0, 1.0, 1.0]);
reads!(time_restarting_csv, "time-restarting.csv", ["t", "x", "y"]);
reads!(time_rounded_csv, "time-rounded.csv", ["Elapsed", "x", "y"]);
reads!(trailing_delimiter_csv, "trailing-delimiter.csv", ["t", "x", "y"]);
reads!(two_header_lines_csv, "two-header-lines.csv", ["Time (s)", "Value (mm)", "Value (kN)"]);
hinted!(two_tables_csv, "two-tables.csv", "with --rows 1:48", "--rows 1:48", ["t", "x", "y"]);
reads!(units_in_cells_csv, "units-in-cells.csv", ["Time [s]", "Displacement [mm]", "Force [kN]"]);
reads!(units_row_brackets_csv, "units-row-brackets.csv", ["Time [s]", "Displacement [mm]", "Force [kN]"]);
reads!(units_row_csv, "units-row.csv", ["Time [s]", "Displacement [mm]", "Force [kN]"]);
reads!(utf16_big_txt, "utf16-big.txt", ["Zeit [s]", "Weg [mm]", "Kraft [kN]"]);
reads!(utf16_little_txt, "utf16-little.txt", ["Zeit [s]", "Weg [mm]", "Kraft [kN]"]);
reads!(utf16_unmarked_txt, "utf16-unmarked.txt", ["Zeit [s]", "Weg [mm]", "Kraft [kN]"]);
reads!(utf8_mark_csv, "utf8-mark.csv", ["Zeit [s]", "Längung [µm]", "Kraft [kN]"]);
reads!(windows_lines_csv, "windows-lines.csv", ["t", "x", "y"]);

/// The roles of the columns of a file that has them in no usual order.
#[test]
fn a_look_tells_what_each_column_is() {
    let bench = Workbench::new();
    let ran = bench.run(&format!("look {} --json", path("temperature-last.csv")));
    let told: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let columns = told["files"][0]["columns"].as_array().unwrap();
    let roles: Vec<&str> = columns.iter().map(|column| column["role"].as_str().unwrap()).collect();
    assert_eq!(roles, ["time", "input", "output", "input"]);
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
    let ran = bench.run(&format!("look {}", path("force-first.csv")));
    assert_eq!(ran.status, Some(1));
    assert!(ran.stdout.contains("disp_mm      ?    mm"), "{}", ran.stdout);
    assert!(ran.last_line().contains("--output force_kN"), "{}", ran.last_line());
}

/// What can be said about a file is said to every command.
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
    assert_eq!(bench.run(&fit).status, Some(0));
    let errors = |file: &str, options: &str| {
        let ran = bench.run(&format!("evaluate m.json {} --json {options}", path(file)));
        assert_eq!(ran.status, Some(0), "{file}: {}", ran.stderr);
        let errors: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
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

/// A number may stand for a missing value; only a person knows.
#[test]
fn a_number_that_stands_for_a_missing_value_is_told_with_the_option_that_names_it() {
    let bench = Workbench::new();
    let ran = look(&bench, "missing-999.csv", "");
    assert_eq!(ran.status, Some(0));
    assert!(ran.stderr.contains("warning: \"y\" is -999 in 5 rows"), "{}", ran.stderr);
    assert!(ran.stderr.contains("(--missing -999)"), "{}", ran.stderr);
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
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "docs/files.md lacks {name}");
        assert!(include_str!("files.rs").contains(&format!("\"{name}\"")), "{name} has no test");
    }
}

/// Errors about how a file is read, and the option that each names.
#[test]
fn hints_about_reading_work_when_they_are_followed() {
    let bench = Workbench::new();
    let rows = |row: &dyn Fn(usize) -> String, count: usize| (0..count).map(row).collect::<String>();
    let x = |k: usize| format!("{:.2}", (0.3 * k as f64).sin());
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
        let ran = bench.run(&format!("look data.csv {options}"));
        assert_eq!(ran.status, Some(0), "{options}: {}", ran.stderr);
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
