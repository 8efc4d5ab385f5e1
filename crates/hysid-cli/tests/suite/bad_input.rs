//! Broken tables of every kind: one line with the place and a remedy, and exit status 1.

use crate::workbench::{Workbench, csv, rows, table, with_cell, with_column};

/// A quick fit of a file.
const QUICK: &str = "--no-report --model xpnn+ --starts 1 --epochs 1 -o out.json";

/// Runs a quick fit of each text and compares the last line of stderr with that of the table.
fn check_fits(texts: &[(&str, Vec<u8>)], table: &str) {
    let bench = Workbench::new();
    let mut said = table.lines().filter_map(|line| line.trim().split_once(" => "));
    for (name, content) in texts {
        let (of, expected) = said.next().unwrap();
        assert_eq!(of, *name, "the table is in another order");
        bench.put("data.csv", content);
        let ran = bench.run(&format!("fit data.csv {QUICK}"));
        assert_eq!(ran.last_line(), format!("error: data.csv{expected}"), "case: {name}");
        assert_eq!((ran.status, ran.stdout.as_str()), (Some(1), ""), "case: {name}");
        assert_eq!(ran.stderr.matches("error").count(), 1, "case: {name}: {}", ran.stderr);
        assert!(!bench.path("out.json").exists(), "case: {name}");
    }
    assert_eq!(said.next(), None);
}

#[test]
fn files_that_are_no_table() {
    let gzip = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x2d\x95".to_vec();
    check_fits(
        &[
            ("empty", b"".into()),
            ("blank lines", b"\n\n# nothing\n".into()),
            ("truncated gzip", gzip),
            ("spreadsheet", b"PK\x03\x04".into()),
            ("binary", b"t,x\0,y\n".into()),
            ("JSON", b"{\"a\": 1}".into()),
            ("header only", b"t,x,y\n".into()),
        ],
        r#"
        empty => : is empty (expected a header line and rows of numbers)
        blank lines => : is empty (expected a header line and rows of numbers)
        truncated gzip => : cannot be read: incomplete deflate stream
        spreadsheet => : is a spreadsheet or an archive that cannot be read: it is damaged or cut off
        binary => : is a binary file, not a table of numbers
        JSON => : is a JSON file that cannot be read: there is no numeric variable with more than one row (save columns of numbers)
        header only => : has a header but no rows
    "#,
    );
}

#[test]
fn headers() {
    check_fits(
        &[
            ("wrong delimiter", csv("t:x:y", ":", "\n", &rows()).into()),
            ("output alone", b"t,y\n0,1\n".into()),
        ],
        r#"
        wrong delimiter => , line 1: there is only one column, "t:x:y" (what separates the columns? name it with --delimiter; input and output in two files? hysid look FILE FILE --join -o both.csv joins them)
        output alone => : no column is left for the input besides output "y" (columns: t, y; input and output in two files? hysid look FILE FILE --join -o both.csv joins them)
    "#,
    );
}

#[test]
fn rows_and_cells() {
    let german = |delimiter: &str| {
        let commas: Vec<Vec<String>> =
            rows().iter().map(|row| row.iter().map(|cell| cell.replace('.', ",")).collect()).collect();
        csv("t,x,y".replace(',', delimiter).as_str(), delimiter, "\n", &commas)
    };
    let mixed = german(";").replacen("\n0,1;", "\n0.1;", 1);
    let alternating = with_column(0, |t| if t.ends_with('0') { "a".into() } else { "b".into() });
    check_fits(
        &[
            ("long row", with_cell(5, 2, "1,2").into()),
            ("short row", b"t,x,y\r\n0,1,2\r\n1,2\r\n".into()),
            ("open quote", with_cell(4, 1, "\"0.5").into()),
            ("decimal commas", german(",").into()),
            ("quoted comma", with_cell(0, 1, "\"0,5\"").into()),
            ("comma and point", mixed.into()),
            ("infinite output", with_cell(15, 2, "-inf").into()),
            ("NaN input", with_cell(15, 1, "nan").into()),
            ("infinite input", with_cell(15, 1, "inf").into()),
            ("text in a number", with_cell(15, 1, "0.5V").into()),
            ("text column", with_column(1, |_| "run".into()).into()),
            ("empty input", with_cell(15, 1, " ").into()),
            ("empty time", with_cell(15, 0, "").into()),
            ("overflow", with_cell(4, 1, "1e999").into()),
            ("records torn apart", alternating.replacen("t,", "record,", 1).into()),
            ("record without name", with_cell(3, 0, "").replacen("t,", "Record,", 1).into()),
        ],
        r#"
        long row => , line 7: has 4 cells where the header has 3 (decimal commas? separate the columns by semicolons)
        short row => , line 3: has 2 cells where the header has 3 (see `hysid look data.csv`)
        open quote => , line 6: has 2 cells where the header has 3 (is a quotation mark not closed?)
        decimal commas => , line 2: has 6 cells where the header has 3 (decimal commas? separate the columns by semicolons)
        quoted comma => , line 2, column "x": "0,5" has a decimal comma, line 2 a decimal point (use one of them)
        comma and point => , line 3, column "t": "0.1" has a decimal point, line 2 a decimal comma (use one of them)
        infinite output => , line 17, column "y": "-inf" is not a finite number (if it stands for a missing value: --missing=-inf)
        NaN input => , line 17, column "x": "nan" is a missing value (only the output may be blank; choose rows with --rows)
        infinite input => , line 17, column "x": "inf" is not a finite number (see `hysid look data.csv`)
        text in a number => , line 17, column "x": "0.5V" is not a number (see `hysid look data.csv`)
        text column => , line 2, column "x": "run" is not a number (not an input? name the inputs with --input)
        empty input => , line 17, column "x": the cell is empty (only the output may be blank; choose rows with --rows)
        empty time => , line 17, column "t": the cell is empty (only the output may be blank; choose rows with --rows)
        overflow => , line 6, column "x": "1e999" is too large for a number (see `hysid look data.csv`)
        records torn apart => , line 12, column "record": record "a" continues after another record (keep its rows together, or give each run a name of its own)
        record without name => , line 5, column "Record": the cell is empty (every row needs the name of its record)
    "#,
    );
}

#[test]
fn values_that_nothing_can_be_learnt_from() {
    let twice = rows().into_iter().chain(rows()).map(|row| [row, vec!["a".into()]].concat());
    let again = csv("t,x,y,record", ",", "\n", &twice.collect::<Vec<_>>());
    let scaled = |column, power: &str| with_column(column, |cell| format!("{cell}{power}"));
    check_fits(
        &[
            ("one row", b"t,x,y\n0,1,2\n".into()),
            ("few rows", csv("t,x,y", ",", "\n", &rows()[..8]).into()),
            ("constant input", with_column(1, |_| "5".into()).into()),
            ("constant output", with_column(2, |_| "5".into()).into()),
            ("blank output", with_column(2, |_| String::new()).into()),
            ("time runs back", with_cell(9, 0, "0.05").into()),
            ("time starts again in a record", again.clone().into()),
            ("huge input", with_cell(4, 1, "1e200").into()),
            ("huge output", with_cell(4, 2, "-1e200").into()),
            ("tiny output", scaled(2, "e-200").into()),
            ("ranges far apart", scaled(1, "e-90").into()),
        ],
        r#"
        one row => : only 1 row has an output: at least 10 are needed
        few rows => : only 8 rows have an output: at least 10 are needed
        constant input => : column "x" is constant (5): there is nothing to identify
        constant output => : column "y" is constant (5): there is nothing to identify
        blank output => : column "y" is blank in every row: there is nothing to compare with
        time runs back => , line 11, column "t": time 0.05 does not come after 0.8 (sort the rows, or name the records in a column `record`)
        time starts again in a record => , line 62, column "t": time 0 does not come after 5.9, and "record" keeps its value (sort the rows, or give each run a name of its own)
        huge input => , line 6, column "x": 1e200 is too large: at most 1e100 in magnitude (choose another unit)
        huge output => , line 6, column "y": -1e200 is too large: at most 1e100 in magnitude (choose another unit)
        tiny output => : column "y" is constant (-9.95e-201): there is nothing to identify
        ranges far apart => : column "x" has a range of 1.9e-90, and the output one of 1.9: their ratio must be from 1e-50 to 1e50 (choose other units)
    "#,
    );
    let bench = Workbench::new();
    bench.put("freq.csv", again.replacen("record", "freq", 1).replace(",a", ",2"));
    let ran = bench.run("look freq.csv --record freq");
    assert!(ran.last_line().ends_with(
        "\"freq\" keeps its value (sort the rows, or number the runs in another column for --record, or leave it out: a run begins where time starts again)"
    ), "{}", ran.stderr);
    bench.put(
        "branch.csv",
        csv("H,B", ",", "\n", &(0..40).map(|k| vec![format!("-{k}"), format!("0.{k}")]).collect::<Vec<_>>()),
    );
    let ran = bench.run("fit branch.csv --input H --output B --model jiles-atherton");
    let told = r#"error: branch.csv: column "H" never turns: one branch does not determine the parameters of jiles-atherton"#;
    assert!(ran.last_line().starts_with(told), "{}", ran.stderr);
    bench.put("steps.csv", scaled(0, "e-300"));
    let ran = bench.run("fit steps.csv --model xpnn --rate backward");
    let told = r#"line 3, column "t": the rate here is "#;
    assert!(ran.status == Some(1) && ran.stderr.contains(told), "{}", ran.stderr);
    assert!(ran.stderr.contains("the time step is too small (is the time column right?)"), "{}", ran.stderr);
}

#[test]
fn unusual_input_that_is_accepted() {
    let bench = Workbench::new();
    let commas: Vec<Vec<String>> =
        rows().iter().map(|row| row.iter().map(|cell| cell.replace('.', ",")).collect()).collect();
    let accepted: [(&str, String); 15] = [
        ("byte order mark", format!("\u{feff}{}", table())),
        ("CR LF", csv("t,x,y", ",", "\r\n", &rows())),
        ("no header", csv("", ",", "\n", &rows()).trim_start().into()),
        ("commented header", format!("# {}", table())),
        ("bars", csv("t|x|y", "|", "\n", &rows())),
        ("missing output", with_cell(15, 2, "n/a")),
        ("NaN output", with_cell(15, 2, "NaN")),
        ("time that stands still", with_cell(9, 0, "0.8")),
        ("comments and blank lines", format!("# measured\n\n{}\n  \n", table())),
        ("decimal commas, semicolons", csv("t;x;y", ";", "\n", &commas)),
        ("decimal commas, tabs", csv("t\tx\ty", "\t", "\r\n", &commas)),
        ("quotes", with_cell(3, 1, "\"0.5\"").replacen("x", "\"x, across\"", 1)),
        ("blank outputs", with_cell(3, 2, "")),
        ("small values", with_column(1, |cell| format!("{cell}e-40"))),
        ("large values", with_column(2, |cell| format!("{cell}e40"))),
    ];
    for (name, text) in accepted {
        eprintln!("case: {name}");
        bench.put("data.csv", text);
        bench.succeeds(&format!("fit data.csv {QUICK}"));
        bench.succeeds("evaluate out.json data.csv --json");
    }
}
