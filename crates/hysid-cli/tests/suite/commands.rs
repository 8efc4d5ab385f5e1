//! The commands as a user runs them.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::workbench::{ROWS, Ran, Workbench, csv, json, must_contain, rows, table, with_cell};
use hysid_core::elementary::{cos, square};
use serde_json::Value;

fn keys(object: &Value) -> String {
    let mut keys: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys.join(" ")
}

const ERRORS: &str =
    "fit_percent max_abs_error mse nrmse_range_percent nrmse_std_percent output records rmse samples";

#[test]
fn fit_simulate_and_evaluate_agree() {
    let bench = Workbench::new();
    bench.put("loop.csv", csv("Time (s),x_mm,force [kN]", ",", "\n", &rows()));
    let fit = bench.succeeds("fit loop.csv --model xpnn+ --starts 2 --epochs 5");
    for said in [
        "data     loop.csv: 60 samples, all scored, in 1 record",
        "input x_mm: ",
        "time Time (s): ",
        "backward differences",
    ] {
        assert!(fit.stderr.contains(said), "{said}: {}", fit.stderr);
    }
    for said in ["RMSE of force [kN], kN", "% of std", "hysid evaluate loop.json", "loop.html"] {
        assert!(fit.stdout.contains(said), "{said}: {}", fit.stdout);
    }
    assert!(bench.text("loop.html").contains("<html"));

    let errors = bench.json("evaluate loop.json loop.csv --json");
    assert_eq!(keys(&errors), ERRORS);
    let simulated = bench.run("simulate loop.json loop.csv -o out.csv");
    assert_eq!((simulated.status, simulated.stdout.as_str()), (Some(0), ""), "{}", simulated.stderr);
    let squares: f64 = bench
        .text("out.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            square(cells[2] - cells[3])
        })
        .sum();
    let mse = errors["mse"].as_f64().unwrap();
    assert!((squares / ROWS as f64 - mse).abs() < 1e-12 * mse, "{squares} {mse}");
}

#[test]
fn json_has_the_promised_keys() {
    let bench = Workbench::new();
    bench.put("loop.csv", table());
    let fit = bench.json("fit loop.csv -o m.json --no-report --model xpnn+ --starts 2 --epochs 2 --json");
    let promised = "architecture evaluations members model notes parameters residuals seconds \
                    selection termination train validation";
    assert_eq!(keys(&fit), promised);
    assert_eq!(fit["model"], "m.json");
    assert_eq!(fit["termination"], "epochs-used");
    assert_eq!(keys(&fit["train"]), ERRORS);
    assert_eq!(keys(&fit["validation"]), ERRORS);
    assert!(!bench.path("m.html").exists());
}

#[test]
fn the_model_depends_on_the_seed_and_not_on_the_threads() {
    let bench = Workbench::new();
    bench.put("loop.csv", table());
    let model = |options: &str| {
        let fit = "fit loop.csv -o m.json --no-report --model xpnn+ --starts 3 --epochs 4";
        bench.succeeds(&format!("{fit} {options}"));
        bench.text("m.json")
    };
    let one = model("--threads 1");
    assert_eq!(one, model("--threads 2"));
    assert_ne!(one, model("--seed 2"));
}

#[test]
#[cfg(target_arch = "x86_64")]
fn the_model_does_not_depend_on_the_instruction_set() {
    let bench = Workbench::new();
    bench.put("loop.csv", table());
    let fit = "hysid fit loop.csv -o m.json --no-report --model xpnn+ --starts 1 --epochs 2";
    let ran = bench.shell(fit);
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    let model = bench.text("m.json");
    let ran = bench.shell(&format!("HYSID_INSTRUCTIONS=baseline {fit}"));
    assert_eq!((ran.status, bench.text("m.json")), (Some(0), model), "{}", ran.stderr);
    let ran = bench.shell(&format!("HYSID_INSTRUCTIONS=SSE9 {fit}"));
    assert_eq!(ran.status, Some(2));
    assert!(ran.stderr.starts_with("error: HYSID_INSTRUCTIONS=SSE9: "), "{}", ran.stderr);
}

#[test]
fn simulate_keeps_every_column_as_it_is() {
    let bench = Workbench::with_model();
    let text = "note,t,x\n\"a, b\",0,0.10\n,1.0,+.5\nc,2e0,-0.25\n";
    bench.put("drive.csv", text);
    let ran = bench.succeeds("simulate model.json drive.csv");
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert_eq!(lines[0], "note,t,x,y_model");
    for (line, before) in lines[1..].iter().zip(text.lines().skip(1)) {
        let (kept, value) = line.rsplit_once(',').unwrap();
        assert_eq!(kept, before);
        assert!(value.parse::<f64>().unwrap().is_finite());
    }
    let to_file = bench.run("simulate model.json drive.csv -o out.csv");
    assert_eq!((to_file.status, bench.text("out.csv")), (Some(0), ran.stdout.clone()));
    assert_eq!(bench.run("simulate model.json drive.csv -o -").stdout, ran.stdout);
}

#[test]
fn simulate_writes_a_header_that_reads_back() {
    let bench = Workbench::with_model();
    bench.put("drive.csv", "\"# note\",t,x\na,0,0.1\nb,1,0.5\nc,2,-0.2\n");
    bench.succeeds("simulate model.json drive.csv -o once.csv");
    // Read back, and the output of the model scored against itself.
    let ran = bench.run("evaluate model.json once.csv --output y_model --json");
    assert_eq!(json(&ran)["max_abs_error"], 0.0);
    assert!(bench.text("once.csv").starts_with("\"# note\",\"t\",\"x\",\"y_model\"\na,0,0.1,"));
}

#[test]
fn further_inputs_and_a_given_rate_are_found_by_name() {
    let bench = Workbench::new();
    let number = |cell: &String| cell.parse::<f64>().unwrap();
    let wide: Vec<Vec<String>> = rows()
        .iter()
        .map(|row| vec![row[1].clone(), format!("{}", cos(number(&row[0]))), row[2].clone(), row[2].clone()])
        .collect();
    bench.put("wide.csv", csv("x_mm,v_mm_s,load,y", ",", "\n", &wide));
    let fit = bench.succeeds("fit wide.csv --input x_mm --input load --rate v_mm_s --model xpnn+ --starts 1 --epochs 2 --no-report");
    must_contain(&fit.stderr, &["of x_mm from column v_mm_s", "load:"]);
    let swapped: Vec<Vec<String>> =
        wide.iter().map(|row| vec![row[1].clone(), row[2].clone(), row[0].clone()]).collect();
    bench.put("swapped.csv", csv("v_mm_s,load,x_mm", ",", "\n", &swapped));
    let last = |ran: Ran| -> Vec<String> {
        assert_eq!(ran.status, Some(0), "{}", ran.stderr);
        ran.stdout.lines().map(|line| line.rsplit(',').next().unwrap().to_string()).collect()
    };
    let plain = last(bench.run("simulate wide.json wide.csv"));
    assert_eq!(plain, last(bench.run("simulate wide.json swapped.csv")));
}

#[test]
fn several_files_and_records_are_named_after_their_origin() {
    let bench = Workbench::new();
    let cut = |name: &str| {
        let named = rows().into_iter().enumerate().map(|(k, mut row)| {
            row[0] = format!("{name}{}", k / 30);
            row
        });
        csv("record,x,y", ",", "\n", &named.collect::<Vec<_>>())
    };
    bench.put("one.csv", cut("r"));
    bench.put("two.csv", cut("r"));
    let ran = bench.succeeds("fit one.csv two.csv --model xpnn+ --starts 1 --epochs 1 --no-report");
    assert!(ran.stderr.contains("in 4 records: one/r0,"), "{}", ran.stderr);
    assert!(bench.path("one.json").exists());
}

#[test]
fn evaluate_warns_beyond_the_trained_range() {
    let bench = Workbench::with_model();
    let wider: Vec<Vec<String>> = rows()
        .into_iter()
        .map(|row| vec![row[0].clone(), format!("{}", 2.0 * row[1].parse::<f64>().unwrap()), row[2].clone()])
        .collect();
    bench.put("wider.csv", csv("t,x,y", ",", "\n", &wider));
    for command in ["evaluate", "simulate"] {
        let ran = bench.succeeds(&format!("{command} model.json wider.csv"));
        assert!(ran.stderr.starts_with("warning: x: "), "{}", ran.stderr);
    }
}

#[cfg(unix)]
#[test]
fn an_old_model_survives_a_failed_write() {
    let bench = Workbench::with_model();
    let old = bench.text("model.json");
    // The limit holds for every place that the model could go to.
    let ran = bench.shell("ulimit -f 1; hysid fit good.csv -o model.json --model pnn --seed 9 --no-report");
    assert_eq!(
        ran.last_line(),
        "error: model.json: cannot be written: the file grew beyond the size allowed here"
    );
    assert_eq!(ran.status, Some(1));
    assert_eq!(bench.text("model.json"), old);
    let page = bench.shell("ulimit -f 1; hysid diagnose good.csv -o d.html");
    assert_eq!(page.status, Some(1), "an error, not the signal: {}", page.stderr);
    let left: Vec<_> = std::fs::read_dir(bench.path(".")).unwrap().collect();
    assert_eq!(left.len(), 2, "no temporary file stays behind: {left:?}");
}

/// A fit that takes minutes, of many cheap iterations.
const LONG: &str = "--no-report --model xpnn+ --stops 20 --hidden 20 --starts 20 --epochs 100000";

/// True if this process, and so every program that it starts, ignores a closed terminal.
#[cfg(unix)]
fn hang_up_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // Signal 1 is the lowest bit.
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(unix)]
#[test]
fn ctrl_c_and_signals_save_the_best_model_so_far() {
    let bench = Workbench::with_data();
    for (signal, status) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        if signal == "-HUP" && hang_up_is_ignored() {
            println!("skipped: these tests run under nohup, which the program respects");
            continue;
        }
        let mut command = bench.command(&format!("fit good.csv -o m.json {LONG}"));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap()).lines();
        // The last thing that is said before the training.
        let said = stderr.find(|line| line.as_ref().unwrap().starts_with("model "));
        assert!(said.is_some());
        std::thread::sleep(Duration::from_millis(300));
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(killed.success());
        let began = Instant::now();
        let last = stderr.map(Result::unwrap).last().unwrap();
        let ran = Ran::from(child.wait_with_output().unwrap());
        assert_eq!(
            (ran.status, last.as_str()),
            (Some(status), "interrupted: the best model so far is in m.json"),
            "{signal}"
        );
        assert!(began.elapsed() < Duration::from_secs(10), "{:?}", began.elapsed());
        assert!(ran.stdout.contains("stopped"), "{}", ran.stdout);
        bench.succeeds("evaluate m.json good.csv");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_terminal_is_ignored_under_nohup() {
    let bench = Workbench::with_data();
    let fit = format!("fit good.csv -o m.json {LONG} --time-limit 2 --json");
    let ran = bench.shell(&format!("trap '' HUP; hysid {fit} & sleep 1; kill -HUP $!; wait $!"));
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    assert!(!ran.stderr.contains("stopping"), "{}", ran.stderr);
}

#[test]
fn the_time_limit_is_kept() {
    let bench = Workbench::with_data();
    let began = Instant::now();
    let ran = bench.run(&format!("fit good.csv {LONG} --time-limit 1 --json"));
    let took = began.elapsed();
    assert!(took > Duration::from_secs(1) && took < Duration::from_secs(10), "{took:?}");
    assert_eq!(json(&ran)["termination"], "stopped");
    bench.succeeds("evaluate good.json good.csv");
}

#[test]
fn output_to_a_pipe_has_no_colours_and_may_be_cut_off() {
    let bench = Workbench::with_model();
    let ran: Ran = bench
        .command("fit good.csv -o c.json --no-report --model xpnn+ --starts 1 --epochs 2")
        .env("NO_COLOR", "1")
        .env("CLICOLOR_FORCE", "1")
        .output()
        .unwrap()
        .into();
    assert!(!ran.stderr.contains('\x1b') && !ran.stdout.contains('\x1b'));
    #[cfg(unix)]
    {
        bench.put("other.csv", with_cell(7, 2, "0.5"));
        // The reader is gone before the program writes.
        let ran =
            bench.shell("{ sleep 0.3; hysid evaluate model.json other.csv; echo \"status $?\" >&2; } | true");
        assert_eq!(ran.stderr, "status 0\n");
    }
}

#[test]
fn the_demo_needs_nothing_and_can_be_typed_after() {
    let bench = Workbench::new();
    let ran = bench.succeeds("demo");
    must_contain(&ran.stdout, &["train", "validation", "unseen test"]);
    let page = bench.text("hysid-demo/demo.html");
    must_contain(&page, &["<svg", "The ensemble", "Candidates without weight: ", "90 % band"]);
    assert!(bench.text("hysid-demo/demo-loops.svg").starts_with("<svg"));
    let demo = bench.text("hysid-demo/demo.json");
    let typed: Vec<&str> = ran.stdout.lines().filter(|line| line.starts_with("  hysid ")).collect();
    assert_eq!(typed.len(), 3);
    for line in typed {
        let again = bench.shell(line);
        assert_eq!(again.status, Some(0), "{line}: {}", again.stderr);
    }
    assert_eq!(bench.text("hysid-demo/demo.json"), demo, "the same data and options give the same model");
    let unseen = bench.json("evaluate hysid-demo/demo.json hysid-demo/demo-test.csv --json");
    assert!(unseen["nrmse_std_percent"].as_f64().unwrap() < 5.0, "{unseen}");
}
