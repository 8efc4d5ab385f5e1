//! `--quiet` as a user types it.

use crate::workbench::{Workbench, table, with_cell};

const FIT: &str = "fit loop.csv --model xpnn+ --starts 1 --epochs 3";

#[test]
fn a_quiet_fit_writes_the_same_files_and_results_and_says_only_warnings() {
    let bench = Workbench::new();
    bench.put("loop.csv", table());
    let told = bench.succeeds(FIT);
    assert!(told.stderr.contains("samples"), "{}", told.stderr);
    let warnings: Vec<&str> = told.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert!(warnings.len() < told.stderr.lines().count());
    let model = bench.text("loop.json");
    // The time that a fit takes is not the same twice.
    let without_time =
        |text: &str| text.lines().filter(|line| !line.ends_with(" s")).collect::<Vec<_>>().join("\n");
    for quiet in [format!("--quiet {FIT}"), format!("{FIT} -q")] {
        let ran = bench.succeeds(&quiet);
        assert_eq!(ran.stderr.lines().collect::<Vec<_>>(), warnings, "{quiet}");
        assert_eq!(without_time(&ran.stdout), without_time(&told.stdout), "{quiet}");
        assert_eq!(bench.text("loop.json"), model, "{quiet}");
    }
}

#[test]
fn warnings_and_errors_are_said_in_quiet_too() {
    let bench = Workbench::with_model();
    bench.put("far.csv", with_cell(5, 1, "9"));
    let ran = bench.succeeds("evaluate model.json far.csv -q");
    assert!(!ran.stderr.is_empty());
    assert!(ran.stderr.lines().all(|line| line.starts_with("warning: ")), "{}", ran.stderr);
    let ran = bench.run("-q evaluate model.json gone.csv");
    assert_eq!((ran.status, ran.stdout.as_str()), (Some(1), ""));
    assert!(ran.stderr.starts_with("error: gone.csv"), "{}", ran.stderr);
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
}

#[test]
fn data_on_stdout_stay() {
    let ran = Workbench::new().run("generate ferromagnet -q");
    assert_eq!((ran.status, ran.stderr.as_str()), (Some(0), ""));
    assert!(ran.stdout.lines().count() > 100);
}
