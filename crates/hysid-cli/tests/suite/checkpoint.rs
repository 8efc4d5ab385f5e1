//! Checkpoints of the program: killed at any moment, a fit can be taken up again.

use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::workbench::{Ran, Workbench, table};

/// Trainers with so many epochs that they take a second or two.
const FITS: [&str; 4] = [
    "--model xpnn+ --training hybrid --epochs 300 --population 20 --stall 0",
    "--model xpnn+ --training genetic --epochs 200 --population 20 --stall 0",
    "--model xpnn+ --training subgradient --epochs 1500 --stall 0",
    "--model xpnn+ --starts 6 --epochs 60",
];

fn fit(arguments: &str) -> String {
    format!("fit good.csv --no-report {arguments}")
}

/// Runs it to the end.
fn ran(bench: &Workbench, arguments: &str) -> Ran {
    bench.succeeds(&fit(arguments))
}

fn spawned(bench: &Workbench, arguments: &str) -> Child {
    bench.command(&fit(arguments)).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Waits until a file is there; false if the program ended before.
fn appears(bench: &Workbench, name: &str, child: &mut Child) -> bool {
    let began = Instant::now();
    while !bench.path(name).exists() {
        assert!(began.elapsed() < Duration::from_secs(60), "no {name} after a minute");
        if child.try_wait().unwrap().is_some() {
            return bench.path(name).exists();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    true
}

#[cfg(unix)]
#[test]
fn killed_at_any_moment_a_fit_is_taken_up_again_to_the_same_model() {
    let bench = Workbench::with_data();
    // Moments spread over the run by a fixed sequence that hits every part of it.
    let mut moment = 0.37;
    for options in FITS {
        let began = Instant::now();
        ran(&bench, &format!("{options} -o whole.json"));
        let takes = began.elapsed();
        let mut child = spawned(&bench, &format!("{options} -o cut.json --checkpoint fit.checkpoint"));
        assert!(appears(&bench, "fit.checkpoint", &mut child), "{options}: no checkpoint");
        for kill in 0..4 {
            moment = (moment + 0.618_034) % 1.0;
            std::thread::sleep(takes.mul_f64(0.4 * moment));
            // SIGKILL: the process has no say in it.
            child.kill().unwrap();
            child.wait().unwrap();
            child = spawned(&bench, &format!("-o cut{kill}.json --resume fit.checkpoint"));
        }
        assert!(child.wait().unwrap().success(), "{options}: the last one did not finish");
        assert_eq!(bench.text("cut3.json"), bench.text("whole.json"), "{options}");
        // Finished, it can still be taken up.
        ran(&bench, "-o again.json --resume fit.checkpoint");
        assert_eq!(bench.text("again.json"), bench.text("whole.json"), "{options}");
        std::fs::remove_file(bench.path("fit.checkpoint")).unwrap();
    }
    let hidden = std::fs::read_dir(bench.path(".")).unwrap().map(|entry| entry.unwrap().file_name());
    // A model is written once: what a kill leaves of it is replaced by the next that has its name.
    let of_checkpoint = |name: &std::ffi::OsString| name.to_string_lossy().starts_with(".fit.checkpoint");
    let hidden: Vec<_> = hidden.filter(of_checkpoint).collect();
    assert!(hidden.is_empty(), "what killed processes leave behind is gone in the end: {hidden:?}");
}

#[cfg(unix)]
#[test]
fn a_fit_that_is_interrupted_says_how_to_go_on() {
    let bench = Workbench::with_data();
    let options = "--model xpnn+ --training hybrid --epochs 100000 --stall 0 --population 20";
    let mut child = bench
        .command(&fit(&format!("{options} -o m.json --checkpoint c.bin")))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    assert!(appears(&bench, "c.bin", &mut child));
    let before = std::fs::metadata(bench.path("c.bin")).unwrap().modified().unwrap();
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let interrupted = Ran::from(child.wait_with_output().unwrap());
    assert_eq!(interrupted.status, Some(130), "{}", interrupted.stderr);
    assert!(interrupted.last_line().contains("--resume c.bin"), "{}", interrupted.stderr);
    assert!(std::fs::metadata(bench.path("c.bin")).unwrap().modified().unwrap() > before);
    let ran = bench.succeeds(&fit("-o n.json --resume c.bin --checkpoint d.bin --time-limit 0.5 --json"));
    assert!(ran.stdout.contains("\"termination\": \"stopped\""), "{}", ran.stdout);
    assert!(bench.path("d.bin").exists());
}

#[cfg(unix)]
#[test]
fn a_second_fit_on_a_checkpoint_is_refused_at_once_until_the_first_is_dead() {
    let bench = Workbench::with_data();
    let long = "--model xpnn+ --training hybrid --epochs 100000 --stall 0 --population 20";
    let mut first = spawned(&bench, &format!("{long} -o m.json --checkpoint c.bin"));
    assert!(appears(&bench, "c.bin", &mut first));
    for second in ["--model xpnn+ -o n.json --checkpoint c.bin", "-o n.json --resume c.bin"] {
        let refused = bench.run(&fit(second));
        assert_eq!(
            (refused.status, refused.stderr.as_str()),
            (
                Some(1),
                "error: c.bin: another fit writes its checkpoint to this file: wait until it ends, or name \
                 another file with --checkpoint\n"
            )
        );
    }
    // Killed without a word, the first leaves a lock file without a lock.
    first.kill().unwrap();
    first.wait().unwrap();
    let ran = ran(&bench, "-o n.json --resume c.bin --time-limit 0.5");
    assert!(ran.stdout.contains("stopped"), "{}", ran.stdout);
    let hidden: Vec<String> = bench.files(".").into_iter().filter(|name| name.starts_with('.')).collect();
    assert!(hidden.is_empty(), "{hidden:?}");
}

#[test]
fn a_fit_begun_anew_keeps_the_checkpoint_that_it_replaces() {
    let bench = Workbench::with_data();
    let fit = "--model xpnn+ --starts 2 --epochs 2 -o m.json --checkpoint c.bin";
    ran(&bench, fit);
    let first = std::fs::read(bench.path("c.bin")).unwrap();
    ran(&bench, &format!("{fit} --seed 5"));
    assert!(std::fs::read(bench.path("c.bin.bak")).unwrap() == first);
    std::fs::remove_file(bench.path("c.bin.bak")).unwrap();
    ran(&bench, "-o n.json --resume c.bin");
    assert!(!bench.path("c.bin.bak").exists(), "one that goes on replaces its own");
}

#[test]
fn resuming_is_refused_with_other_options_or_data() {
    let bench = Workbench::with_data();
    ran(&bench, "--model xpnn+ --starts 2 --epochs 2 -o m.json --checkpoint c.bin");
    let table = table();
    let all_but_the_last = table.trim_end().rsplit_once('\n').unwrap().0;
    bench.put("other.csv", format!("{all_but_the_last}\n"));
    bench.put("text.bin", "x,y\n");
    let resume = "-o n.json --no-report --resume";
    bench.refuses_in_part(&format!(
        "
        2 fit good.csv {resume} c.bin --starts 3 => cannot be used with
        2 fit good.csv {resume} c.bin --rate savitzky-golay => --rate differs from that of the checkpoint
        1 fit other.csv {resume} c.bin => belongs to other data
        1 fit good.csv {resume} text.bin => text.bin: this is not a Hysid checkpoint
        1 fit good.csv {resume} none.bin => none.bin: cannot be read
        2 fit good.csv -o m.json --checkpoint good.csv => would be overwritten
        2 fit good.csv -o n.json --checkpoint d.bin => auto has no checkpoints: only a single network has them, such as --model xpnn+
        2 fit good.csv -o n.json --model xpnn --members 3 --checkpoint d.bin => an ensemble has no checkpoints
        2 fit good.csv -o m.json --checkpoint m.json => two results would have this name
    "
    ));
}
