//! Tables longer than any block that `simulate` and `evaluate` work on: as if they were read at once.

use hysid_core::elementary::{cos, sin};

use crate::workbench;
use std::fmt::Write;

use crate::workbench::{Workbench, table};

/// Rows of more than two blocks, in records of very different length.
const LENGTHS: [usize; 5] = [1, 9000, 3, 4096, 2];

fn numbers(record: usize, row: usize) -> [f64; 3] {
    let time = 0.1 * row as f64 + 0.01 * sin(row as f64);
    let x = sin(0.3 * row as f64 + record as f64) * 0.9;
    [time, x, x + 0.2 * cos(0.3 * row as f64)]
}

/// The table, with this text for a number.
fn long(delimiter: char, shown: impl Fn(f64) -> String) -> String {
    let mut text = format!("name{delimiter}record{delimiter}t{delimiter}x{delimiter}y\n");
    for (record, length) in LENGTHS.into_iter().enumerate() {
        for row in 0..length {
            let cells = numbers(record, row).map(&shown).join(&delimiter.to_string());
            let _ = writeln!(text, "\"a {record}\"{delimiter}r{record}{delimiter}{cells}");
        }
    }
    text
}

fn plain(value: f64) -> String {
    format!("{value:.6}")
}

/// A bench with a model for each way of finding the rate.
fn bench() -> Workbench {
    let bench = Workbench::with_data();
    for rate in ["central", "backward", "savitzky-golay"] {
        let fit = format!(
            "fit good.csv -o {rate}.json --no-report --model xpnn+ --starts 1 --epochs 2 --rate {rate}"
        );
        bench.succeeds(&fit);
    }
    let ensemble = "fit good.csv -o ensemble.json --no-report --model xpnn --members 2 --starts 2 --epochs 2";
    bench.succeeds(ensemble);
    bench
}

fn last_cells(text: &str) -> Vec<&str> {
    text.lines().skip(1).map(|line| line.rsplit([',', ';']).next().unwrap()).collect()
}

#[test]
fn records_of_a_long_table_are_simulated_as_if_each_were_alone() {
    let bench = bench();
    let long = long(',', plain);
    bench.put("long.csv", &long);
    for model in ["central", "backward", "savitzky-golay", "ensemble"] {
        let ran = bench.succeeds(&format!("simulate {model}.json long.csv"));
        let simulated = last_cells(&ran.stdout);
        assert_eq!(simulated.len(), LENGTHS.iter().sum::<usize>());
        let rows: Vec<&str> = long.lines().skip(1).collect();
        let mut first = 0;
        for length in LENGTHS {
            bench
                .put("alone.csv", format!("name,record,t,x,y\n{}\n", rows[first..first + length].join("\n")));
            let alone = bench.run(&format!("simulate {model}.json alone.csv"));
            assert!(last_cells(&alone.stdout) == simulated[first..first + length], "{model}, {length} rows");
            first += length;
        }
        let file = bench.run(&format!("simulate {model}.json long.csv -o {model}.csv"));
        assert_eq!((file.status, file.stdout.as_str()), (Some(0), ""), "{}", file.stderr);
        assert!(bench.text(&format!("{model}.csv")) == ran.stdout, "{model}");
        // Through a pipe, of which nobody knows the length.
        let piped = bench.shell(&format!("cat long.csv | hysid simulate {model}.json /dev/stdin"));
        assert!(piped.stdout == ran.stdout, "{model}: {}", piped.stderr);
    }
}

#[test]
fn the_input_alone_is_enough_to_simulate() {
    let bench = Workbench::with_data();
    let fit = "fit good.csv -o m.json --no-report --model pnn --starts 1 --epochs 2";
    bench.succeeds(fit);
    let place = table().lines().next().unwrap().split(',').position(|name| name == "x").unwrap();
    let alone: String =
        table().lines().map(|line| format!("{}\n", line.split(',').nth(place).unwrap())).collect();
    bench.put("alone.csv", &alone);
    let (whole, alone) = (bench.run("simulate m.json good.csv"), bench.run("simulate m.json alone.csv"));
    assert_eq!((whole.status, alone.status), (Some(0), Some(0)), "{}", alone.stderr);
    assert!(alone.stdout.starts_with("x,y_model\n"), "{}", alone.stdout);
    assert_eq!(last_cells(&whole.stdout), last_cells(&alone.stdout));
    // A table of one column that is not the input was separated by something else.
    bench.put("bars.csv", "t:x:y\n0:1:2\n");
    for command in ["simulate m.json bars.csv", "evaluate m.json bars.csv", "evaluate m.json alone.csv"] {
        let ran = bench.run(command);
        assert_eq!(ran.status, Some(1));
        assert!(ran.stderr.contains("line 1: there is only one column"), "{}", ran.stderr);
    }
}

#[test]
fn errors_of_a_long_table_are_those_of_its_rows() {
    let bench = bench();
    bench.put("long.csv", long(',', plain));
    let simulated = bench.run("simulate central.json long.csv");
    let (mut squares, mut rows, mut largest) = (0.0, 0usize, 0.0f64);
    for line in simulated.stdout.lines().skip(1) {
        let cells: Vec<f64> = line.rsplit(',').take(2).map(|cell| cell.parse().unwrap()).collect();
        let error = cells[0] - cells[1];
        (squares, rows, largest) = (squares + error * error, rows + 1, largest.max(error.abs()));
    }
    let ran = bench.run("evaluate central.json long.csv --json");
    let errors: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!((errors["samples"].as_u64(), errors["records"].as_u64()), (Some(rows as u64), Some(5)));
    let mse = errors["mse"].as_f64().unwrap();
    assert!((mse - squares / rows as f64).abs() < 1e-12 * mse, "{mse}");
    assert_eq!(errors["max_abs_error"].as_f64(), Some(largest));
}

#[test]
fn decimal_commas_are_written_wherever_the_first_of_them_stands() {
    let bench = bench();
    // Whole numbers for longer than a block, then a comma.
    let mut text = String::from("t;x\n");
    for row in 0..9000 {
        let x = if row == 8000 { "0,5".to_string() } else { (row % 2).to_string() };
        let _ = writeln!(text, "{row};{x}");
    }
    bench.put("late.csv", &text);
    let ran = bench.succeeds("simulate central.json late.csv");
    let numbers = last_cells(&ran.stdout);
    assert!(numbers.len() == 9000 && numbers.iter().all(|number| !number.contains('.')));
    // A pipe cannot be read twice.
    let piped = bench.shell("cat late.csv | hysid simulate central.json /dev/stdin");
    assert_eq!(piped.status, Some(1));
    assert!(piped.stderr.starts_with("error: /dev/stdin: the first decimal comma comes after"), "{piped}");

    let commas = long(';', |value| plain(value).replace('.', ","));
    bench.put("commas.csv", &commas);
    bench.put("points.csv", long(';', plain));
    let [commas, points] =
        ["commas", "points"].map(|name| bench.run(&format!("simulate central.json {name}.csv")));
    assert!(commas.stdout.replace(',', ".") == points.stdout);
    assert!(!commas.stdout.contains('.'));
}

#[test]
fn defects_far_behind_name_their_line_and_leave_no_file() {
    let bench = bench();
    let lines: Vec<String> = long(',', plain).lines().map(String::from).collect();
    let with = |line: usize, change: &dyn Fn(&str) -> String| {
        let mut lines = lines.clone();
        lines[line - 1] = change(&lines[line - 1]);
        lines.join("\n") + "\n"
    };
    let cell = |place: usize, text: &'static str| {
        move |line: &str| {
            let mut cells: Vec<&str> = line.split(',').collect();
            cells[place] = text;
            cells.join(",")
        }
    };
    let cases = [
        (with(8000, &cell(3, "z")), "line 8000, column \"x\": \"z\" is not a number"),
        (with(8000, &cell(2, "0.5")), "line 8000, column \"t\": time 0.5 does not come after 799.593974"),
        // The first row of the second block.
        (with(4099, &cell(2, "0.5")), "line 4099, column \"t\": time 0.5 does not come after"),
        (with(9000, &cell(3, "1e200")), "line 9000, column \"x\": 1e200 is too large"),
        (
            with(9500, &cell(1, "r1")),
            "line 9500, column \"record\": record \"r1\" continues after another record",
        ),
        (with(9500, &cell(1, " ")), "line 9500, column \"record\": the cell is empty"),
        (with(9500, &cell(3, "")), "line 9500, column \"x\": the cell is empty"),
        (with(9500, &|line| format!("{line},1")), "line 9500: has 6 cells where the header has 5"),
    ];
    for (table, expected) in cases {
        bench.put("bad.csv", table);
        for command in [
            "simulate central.json bad.csv -o out.csv",
            "simulate central.json bad.csv",
            "evaluate central.json bad.csv",
        ] {
            let ran = bench.run(command);
            assert!(
                ran.stderr.starts_with(&format!("error: bad.csv, {expected}")),
                "{command}: {}",
                ran.stderr
            );
            assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{command}");
            assert_eq!(ran.stdout, "", "{command}");
        }
        let left: Vec<String> =
            bench.files(".").into_iter().filter(|name| name.contains("out.csv")).collect();
        assert!(left.is_empty(), "{left:?}");
    }
    bench.put("bad.csv", "t,x,y\n\n");
    assert_eq!(
        bench.run("simulate central.json bad.csv").stderr,
        "error: bad.csv: has a header but no rows\n"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_table() {
    let bench = bench();
    let rows = |count: usize| {
        let mut text = String::from("t,x,y\n");
        for row in 0..count {
            let [_, x, y] = numbers(0, row);
            let _ = writeln!(text, "{row},{x:.5},{y:.5}");
        }
        text
    };
    bench.put("short.csv", rows(20_000));
    bench.put("long.csv", rows(1_000_000));
    let runs = |command: &str, table: &str, kilobytes: usize| {
        let command = command.replace("TABLE", table);
        bench.shell(&format!("ulimit -v {kilobytes}; hysid {command}")).status == Some(0)
    };
    for command in ["simulate ensemble.json TABLE.csv -o TABLE-out.csv", "evaluate ensemble.json TABLE.csv"] {
        // Address space that a run over the short table needs; 16 MB more are less than the long table has.
        let least = (20_000..2_000_000).step_by(4000).find(|&kilobytes| runs(command, "short", kilobytes));
        let least = least.expect("2 GB are enough");
        assert!(runs(command, "long", least + 16_000), "{command}: more than {least} + 16000 kB");
    }
    assert_eq!(bench.text("long-out.csv").lines().count(), 1_000_001);
}

#[cfg(unix)]
#[test]
fn an_interrupted_simulation_leaves_the_old_table() {
    use std::process::{Command, Stdio};

    let bench = bench();
    bench.succeeds("simulate central.json good.csv -o out.csv");
    let old = bench.text("out.csv");
    assert!(Command::new("mkfifo").arg(bench.path("drive")).status().unwrap().success());
    let mut child = bench
        .command("simulate central.json drive -o out.csv")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Rows without end, until the program has had enough of them.
    let mut drive = std::fs::OpenOptions::new().write(true).open(bench.path("drive")).unwrap();
    use std::io::Write;
    drive.write_all(b"t,x,y\n").unwrap();
    let mut row = 0u64;
    let mut block = |drive: &mut std::fs::File| {
        let rows: String = (row..row + 5000).map(|row| format!("{row},{}.5,0\n", row % 2)).collect();
        row += 5000;
        drive.write_all(rows.as_bytes())
    };
    for _ in 0..10 {
        block(&mut drive).unwrap();
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    while child.try_wait().unwrap().is_none() {
        if block(&mut drive).is_err() {
            break;
        }
    }
    let ran = workbench::Ran::from(child.wait_with_output().unwrap());
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(130), 1), "{}", ran.stderr);
    assert_eq!(bench.text("out.csv"), old);
    assert!(bench.files(".").iter().all(|name| !name.starts_with('.')));
}
