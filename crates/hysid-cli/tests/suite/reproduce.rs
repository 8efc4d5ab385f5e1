//! `hysid reproduce` as a user runs it.

use crate::workbench::Workbench;

#[test]
fn an_experiment_by_name_leaves_its_page_and_tables() {
    let bench = Workbench::new();
    let ran = bench.succeeds("reproduce nds -o out");
    assert!(ran.stdout.contains("page    out/nds.html"), "{}", ran.stdout);
    assert_eq!(bench.files("out"), ["nds.csv", "nds.html", "nds.md"]);
    let page = bench.text("out/nds.html");
    assert!(!page.contains("http://") || page.contains("http://www.w3.org"), "the page needs nothing else");
    assert_eq!(page.matches("<svg class=\"plot\"").count(), 7, "an input and six loops");
    // K of the first neuron: 2 (1 - 1/1.42).
    let table = bench.text("out/nds.csv");
    let k = table.lines().find(|line| line.contains("1: w (1.42, 0)") && line.contains(",K,")).unwrap();
    let k: f64 = k.rsplit(',').next().unwrap().parse().unwrap();
    assert!((k - 2.0 * (1.0 - 1.0 / 1.42)).abs() < 1e-5, "{k}");
}

#[test]
fn an_example_says_what_stands_in_for_the_measurements_and_what_was_reached() {
    let bench = Workbench::new();
    let ran = bench.succeeds("reproduce example7 --quick -o out --seed 4");
    let text = bench.text("out/example7.md");
    for word in [
        "Synthetic specimen magnetostrictive-actuator in place of the paper's measured data (example 7)",
        "seed 4",
        "A quick run",
        "| XPNN, unseen |",
        "| unseen record |",
        "at most 0.5",
        "Designed:",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    // Verdict and figures agree; one network's comes before that of the median of networks.
    let targets: Vec<&str> = text.lines().filter(|line| line.contains("| at most ")).collect();
    assert_eq!(targets.len(), 2);
    let median = |cell: &str| -> f64 { cell.split(' ').next().unwrap().parse().unwrap() };
    for target in targets {
        let cells: Vec<&str> = target.split('|').map(str::trim).collect();
        let limit: f64 = cells[4].trim_start_matches("at most ").parse().unwrap();
        let verdict = match (median(cells[5]) <= limit, median(cells[6]) <= limit) {
            (true, _) => "met",
            (false, true) => "met by several only",
            (false, false) => "missed",
        };
        assert_eq!((cells[3], cells[7]), ("paper, in words", verdict), "{target}");
    }
    // A terminal shows the targets as a list.
    let listed: Vec<&str> = ran.stdout.lines().skip_while(|line| !line.starts_with("Targets: ")).collect();
    let listed = &listed[..listed.iter().position(|line| line.starts_with("page ")).unwrap()];
    assert_eq!(listed.iter().filter(|line| line.starts_with("- ")).count(), 2, "{listed:?}");
}

#[test]
fn a_terminal_of_80_columns_has_room_for_everything() {
    let bench = Workbench::new();
    // The first has the widest tables, the second the longest names.
    for name in ["example2", "nds"] {
        let ran = bench.succeeds(&format!("reproduce {name} --quick -o out"));
        let too_long: Vec<&str> = ran.stdout.lines().filter(|line| line.chars().count() > 80).collect();
        assert!(too_long.is_empty(), "{name}: {too_long:#?}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_finished() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let bench = Workbench::new();
    let mut reproduce = bench.command("reproduce --quick -o out");
    let mut running = reproduce.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let stderr = BufReader::new(running.stderr.take().unwrap());
    let mut lines = stderr.lines();
    let one = lines.by_ref().map_while(Result::ok).find(|line| line.contains(": finished, ")).unwrap();
    let killed = Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let rest: Vec<String> = lines.map_while(Result::ok).collect();
    assert_eq!(running.wait().unwrap().code(), Some(130), "{rest:?}");
    let text = bench.text("out/reproduction.md");
    let name = one.split([' ', ':']).nth(1).unwrap();
    assert!(text.contains("Interrupted: ") && text.contains(&format!("## {name}: ")), "{one}: {text}");
    assert!(bench.path("out/reproduction.html").exists() && bench.path("out/reproduction.csv").exists());
}
