//! `hysid reproduce` as a user runs it.

use crate::workbench::Workbench;

#[test]
fn an_experiment_by_name_leaves_its_page_and_tables() {
    let bench = Workbench::new();
    let ran = bench.run("reproduce nds -o out");
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("page    out/nds.html"), "{}", ran.stdout);
    assert_eq!(bench.files("out"), ["nds.csv", "nds.html", "nds.json", "nds.md"]);
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
    let ran = bench.run("reproduce example7 --quick -o out --seed 4");
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
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
        let ran = bench.run(&format!("reproduce {name} --quick -o out"));
        assert_eq!(ran.status, Some(0), "{}", ran.stderr);
        let too_long: Vec<&str> = ran.stdout.lines().filter(|line| line.chars().count() > 80).collect();
        assert!(too_long.is_empty(), "{name}: {too_long:#?}");
    }
}

#[test]
fn finished_experiments_are_taken_up_if_they_were_made_in_the_same_way() {
    let bench = Workbench::new();
    assert_eq!(bench.run("reproduce nds -o out").status, Some(0));
    let (page, stored) = (bench.text("out/nds.html"), bench.text("out/nds.json"));
    let again = bench.run("reproduce nds -o out");
    assert!(again.stderr.contains("nds: already finished, read from out/nds.json"), "{}", again.stderr);
    assert_eq!((bench.text("out/nds.html"), bench.text("out/nds.json")), (page, stored.clone()));
    // Another seed, an older version, or a broken file: it is run again.
    let older = stored.replace(env!("CARGO_PKG_VERSION"), "0.0.0");
    for (arguments, content) in
        [("--seed 2", stored.clone()), ("", older), ("", stored[..stored.len() / 2].to_string())]
    {
        bench.put("out/nds.json", content);
        let ran = bench.run(&format!("reproduce nds -o out {arguments}"));
        assert_eq!(ran.status, Some(0), "{}", ran.stderr);
        assert!(ran.stderr.contains("1/1 nds: finished"), "{}", ran.stderr);
    }
    assert_eq!(bench.run("reproduce example8").status, Some(2));
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_finished() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let bench = Workbench::new();
    // One experiment is there already; the whole takes minutes.
    assert_eq!(bench.run("reproduce nds -o out").status, Some(0));
    let mut running =
        bench.command("reproduce -o out").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let stderr = BufReader::new(running.stderr.take().unwrap());
    let mut lines = stderr.lines();
    let under_way = lines.by_ref().map_while(Result::ok).find(|line| line.starts_with("  "));
    assert!(under_way.is_some(), "a fit or a training tells of itself");
    let killed = Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let rest: Vec<String> = lines.map_while(Result::ok).collect();
    assert_eq!(running.wait().unwrap().code(), Some(130), "{rest:?}");
    let text = bench.text("out/reproduction.md");
    assert!(text.contains("Interrupted: ") && text.contains("## nds: One neuron"), "{text}");
    assert!(bench.path("out/reproduction.html").exists() && bench.path("out/reproduction.csv").exists());
}

#[test]
fn a_stored_experiment_that_was_changed_injects_nothing() {
    let bench = Workbench::new();
    assert_eq!(bench.run("reproduce nds -o out").status, Some(0));
    let stored = bench.text("out/nds.json");
    let change = |pointer: &str, value: serde_json::Value| {
        let mut changed: serde_json::Value = serde_json::from_str(&stored).unwrap();
        *changed.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value;
        changed.to_string()
    };
    let parts: serde_json::Value = serde_json::from_str(&stored).unwrap();
    let parts = parts["chapter"]["parts"].as_array().unwrap().clone();
    let place = |kind: &str| parts.iter().position(|part| part.get(kind).is_some()).unwrap();
    let (charts, table, words) = (place("charts"), place("table"), place("note"));
    let chart = format!("/chapter/parts/{charts}/charts/0");
    let script = "<script>alert(1)</script>";
    // What Hysid did not write, or what cannot be drawn: the experiment is run again. (The keys are in another order now, so
    // the file is not known as Hysid's own.)
    for (pointer, value) in [
        ("/chapter/files".to_string(), serde_json::json!([["../escaped.txt", { "text": "x" }]])),
        ("/chapter/name".into(), "../escaped".into()),
        (format!("/chapter/parts/{table}/table/columns"), serde_json::json!([])),
        (chart.clone(), format!("<svg>{script}</svg>").into()),
        (format!("{chart}/size/0"), 1e12.into()),
        (format!("{chart}/x/low"), 2.0.into()),
        (format!("{chart}/curves/0/width"), (-1.0).into()),
        (format!("{chart}/curves/0/points/0"), serde_json::json!(["x", 1.0])),
    ] {
        bench.put("out/nds.json", change(&pointer, value));
        let ran = bench.run("reproduce nds -o out --force");
        assert_eq!(ran.status, Some(0), "{pointer}: {}", ran.stderr);
        assert!(ran.stderr.contains("1/1 nds: finished"), "{pointer}: {}", ran.stderr);
        assert!(!bench.text("out/nds.html").contains("alert(1)"), "{pointer}");
    }
    assert_eq!((bench.files("."), bench.files("out").len()), (vec!["out".to_string()], 4));
    // Words are taken as they are, and shown as words.
    let note = format!("/chapter/parts/{words}/note/0/plain");
    for pointer in [note.clone(), format!("{chart}/title"), format!("{chart}/description")] {
        bench.put("out/nds.json", change(&pointer, script.into()));
        let ran = bench.run("reproduce nds -o out --force");
        assert!(ran.stderr.contains("already finished"), "{pointer}: {}", ran.stderr);
        let page = bench.page("out/nds.html");
        assert!(
            page.contains("&lt;script&gt;alert(1)&lt;/script&gt;") && !page.contains("<script"),
            "{pointer}"
        );
        assert_eq!(
            bench.text("out/nds.md").contains("\\<script>alert(1)\\</script>"),
            pointer == note,
            "{pointer}"
        );
    }
}
