//! Names, cells and arguments that would move a terminal's cursor, inject script or never end.

use std::time::{Duration, Instant};

use hysid_core::elementary::sin;

use crate::workbench::{Ran, Workbench, csv, rows};

/// A name with a colour, a clear screen in one byte, a line end, a turned direction and HTML.
const NAME: &str = "x\x1b[31m\u{9b}2J\n\u{202e}</title><script>alert(1)</script>\"'&";

/// The name as a cell of CSV.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// True for what a terminal obeys instead of showing it.
fn is_obeyed(letter: char) -> bool {
    letter != '\n' && letter.is_control() || ('\u{202a}'..='\u{202e}').contains(&letter)
}

fn check_streams(ran: &Ran, command: &str) {
    for text in [&ran.stdout, &ran.stderr] {
        assert!(!text.contains(is_obeyed), "hysid {command}: {text:?}");
    }
}

/// Records with hostile names of input, output and record.
fn bench() -> Workbench {
    let bench = Workbench::new();
    let header = format!("record,t,{},{}", quoted(NAME), quoted(&NAME.replacen('x', "y", 1)));
    let rows: Vec<Vec<String>> = (0..2)
        .flat_map(|record| {
            let named = move |row: Vec<String>| [vec![quoted(&format!("{record}{NAME}"))], row].concat();
            rows().into_iter().map(named)
        })
        .collect();
    bench.put("evil.csv", csv(&header, ",", "\n", &rows));
    bench
}

#[test]
fn names_reach_neither_the_terminal_nor_a_page_as_they_are() {
    let bench = bench();
    let quick = "--model xpnn+ --starts 1 --epochs 2";
    for command in [
        format!("fit evil.csv -o m.json {quick}"),
        "evaluate m.json evil.csv".into(),
        "diagnose evil.csv".into(),
        "diagnose m.json -o model.html".into(),
        format!("validate evil.csv {quick}"),
        "compare evil.csv --models pnn,masing,rate-dependent-prandtl-ishlinskii --time-limit 1".into(),
        // A name that is too long, or wrong, is in an error too.
        "fit evil.csv --input nope".into(),
        "fit evil.csv --sign nope\u{1b}[2J".into(),
    ] {
        let ran = bench.run(&command);
        check_streams(&ran, &command);
        if !command.contains("nope") {
            assert_eq!(ran.status, Some(0), "hysid {command}: {}", ran.stderr);
        }
    }
    for page in ["m.html", "evil.diagnosis.html", "model.html", "evil-compared.html"] {
        let page = bench.page(page);
        assert!(page.contains("&lt;script&gt;"), "the name is there");
        assert!(!page.contains("<script") && !page.contains(is_obeyed_by_xml), "{page}");
        // Nothing ends an attribute early: of every tag only names that Hysid writes are left.
        assert!(!page.contains("alert(1)\"") && !page.contains("</script>"));
    }
    let out = bench.run("simulate m.json evil.csv");
    assert!(out.stdout.contains(NAME.split('"').next().unwrap()), "a table is for programs: {}", out.stdout);
}

fn is_obeyed_by_xml(letter: char) -> bool {
    letter.is_control() && letter != '\n'
}

#[test]
fn json_shows_nothing_raw_and_keeps_every_name() {
    let bench = bench();
    assert_eq!(
        bench.run("fit evil.csv -o m.json --model pnn --starts 1 --epochs 1 --no-report").status,
        Some(0)
    );
    for command in [
        "evaluate m.json evil.csv --json",
        "diagnose evil.csv --json --no-report",
        "validate evil.csv --model pnn --json",
    ] {
        let ran = bench.run(command);
        check_streams(&ran, command);
        let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
        let output = value.get("output").or_else(|| value.pointer("/unseen/output")).unwrap();
        assert_eq!(output, &NAME.replacen('x', "y", 1), "hysid {command}");
    }
}

#[test]
fn errors_are_one_short_line_whatever_the_file_or_the_arguments_hold() {
    let bench = Workbench::new();
    let long = "z".repeat(200_000);
    let cell = |cell: &str| format!("t,x,y\n0,1,{cell}\n1,2,3\n");
    let tables = [
        (cell("\"a\nb\x1b[2J\""), r#"line 2, column "y": "a\nb\x1b[2J" is not a number"#.to_string()),
        (cell(&long), format!("\"{}… (200000 characters)\" is not a number", &long[..60])),
        (format!("t,x,{long}\n0,1,w\n"), "the name of a column has 200000 characters, and 10000 are".into()),
        (format!("t,x,{}\n0,1,w\n", &long[..9000]), format!("column \"{}… (9000 characters)\"", &long[..60])),
        (format!("{}:x\n1:2\n", &long[..9000]), "there is only one column, \"zzz".into()),
        (
            format!("t,x,{}\n0,1,w\n1,2,3\n", quoted("a\u{7}")),
            r#"column "a\x07": "w" is not a number"#.into(),
        ),
        (
            format!("record,x,y\n{0},1,2\nb,1,2\n{0},1,2\n", quoted("a\r\u{85}b")),
            r#"record "a\r\u{85}b" continues"#.into(),
        ),
    ];
    for (table, expected) in tables {
        bench.put("data.csv", table);
        let ran = bench.run("fit data.csv -o m.json");
        check_streams(&ran, &expected);
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{expected}: {}", ran.stderr);
        assert!(ran.stderr.contains(&expected) && ran.stderr.len() < 400, "{expected}: {}", ran.stderr);
    }
    let arguments: [&[&str]; 6] = [
        &["fit", "a\nUsage: \x1b[2J.csv"],
        &["f\nit\x1b[2J"],
        &["fit", "data.csv", "--mod\nel\u{9b}2J"],
        &["fit", "data.csv", "--model", "a\nUsage: b\x1b"],
        &["fit", "data.csv", "--training", &long[..100_000]],
        &["fit", &long[..3000]],
    ];
    for given in arguments {
        let ran = Ran::from(bench.command("").args(given).output().unwrap());
        check_streams(&ran, &format!("{given:?}"));
        assert_eq!(ran.stderr.lines().count(), 1, "{given:?}: {}", ran.stderr);
        assert!(ran.stderr.starts_with("error: ") && ran.stderr.len() < 2500, "{given:?}: {}", ran.stderr);
        assert!(matches!(ran.status, Some(1 | 2)) && ran.stdout.is_empty(), "{given:?}");
    }
}

#[test]
fn many_records_and_columns_are_read_quickly_and_told_briefly() {
    let bench = Workbench::new();
    let mut table = String::from("record,t,x,y\n");
    for record in 0..5_000 {
        // A wild time step in each record, and a constant output in every other.
        for (row, time) in [0, 1, 2, 1000].into_iter().enumerate() {
            let x = sin(f64::from(record)) + row as f64;
            let y = if record % 2 == 0 { 1.0 } else { x };
            table += &format!("r{record},{time},{x:.4},{y:.4}\n");
        }
    }
    bench.put("records.csv", table);
    let wide: Vec<String> = (0..5_000).map(|column| format!("c{column}")).collect();
    let row =
        |k: usize| (0..5_000).map(|column| ((k * k + column) % 97).to_string()).collect::<Vec<_>>().join(",");
    let rows: Vec<String> = (1..=20).map(row).collect();
    bench.put("columns.csv", format!("{}\n{}\n", wide.join(","), rows.join("\n")));

    // Seconds without optimisation; the bound is for what grows with the square.
    let quickly = |command: &str, lines: usize| {
        let began = Instant::now();
        let ran = bench.run(command);
        assert!(began.elapsed() < Duration::from_secs(60), "hysid {command} took {:?}", began.elapsed());
        assert_eq!(ran.status, Some(0), "hysid {command}: {}", ran.stderr);
        let said = ran.stdout.lines().count() + ran.stderr.lines().count();
        assert!(said < lines, "hysid {command} says {said} lines");
        ran
    };
    let fit = quickly("fit records.csv -o m.json --model pnn --starts 1 --epochs 1 --no-report", 60);
    for more in ["and 4995 more of this kind", "and 2495 more of this kind"] {
        assert!(fit.stderr.contains(&format!("warning: {more}\n")), "{more}: {}", fit.stderr);
    }
    quickly("evaluate m.json records.csv", 20);
    quickly("diagnose records.csv --no-report", 120);
    quickly("diagnose columns.csv --input c5 --input c7 --no-report", 140);
    let refused = bench.run("diagnose columns.csv --no-report");
    assert_eq!(
        refused.stderr,
        "error: columns.csv: 4999 columns could be inputs: name them with --input, for instance --input c0 --output c4999 (columns: c0, c1, c2, c3, c4 and 4994 more)\n"
    );
    quickly(
        "fit columns.csv --input c5 --input c7 -o c.json --model xpnn+ --starts 1 --epochs 1 --no-report",
        40,
    );
    quickly("evaluate c.json columns.csv", 20);
    let refused = bench.run("fit columns.csv --input nope");
    assert_eq!(
        refused.stderr,
        "error: columns.csv: there is no column \"nope\" for --input (columns: c0, c1, c2, c3, c4, c5 and 4994 more)\n"
    );
}
