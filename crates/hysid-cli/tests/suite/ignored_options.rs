//! Options that a model ignores are named and change nothing; values that it cannot have are refused before the fit.

use crate::workbench::Workbench;

const QUICK: &str = "--starts 1 --epochs 2";

fn fitted(bench: &Workbench, options: &str, searched: bool) -> (String, String) {
    let effort = if searched { QUICK } else { "" };
    let ran = bench.succeeds(&format!("fit good.csv {options} {effort} --no-report --force -o model.json"));
    (ran.stderr, bench.text("model.json"))
}

#[test]
fn an_ignored_option_is_named_and_changes_nothing() {
    let bench = Workbench::with_data();
    for (model, searched, option, flag) in [
        ("bouc-wen", true, "--history", "--history"),
        ("pnn", true, "--hidden 7 --relaxation 9", "--relaxation"),
        ("preisach", false, "--validation 0.3", "--validation"),
    ] {
        let (plain, model_file) = fitted(&bench, &format!("--model {model}"), searched);
        assert!(!plain.contains("ignores"), "{plain}");
        let (stderr, with_option) = fitted(&bench, &format!("--model {model} {option}"), searched);
        assert!(stderr.contains(&format!("{model} ignores {flag}")), "{model} {option}: {stderr}");
        assert_eq!(with_option, model_file, "{model} {option}");
    }
}

#[test]
fn help_is_short_unless_all_options_are_asked_for() {
    let bench = Workbench::new();
    let (short, long) = (bench.run("fit --help").stdout, bench.run("fit --help options").stdout);
    assert!(short.lines().count() < 60, "{} lines", short.lines().count());
    assert!(short.contains("Examples:") && !short.contains("--free-weights"), "{short}");
    assert!(long.contains("--free-weights"), "{long}");
}

#[test]
fn every_command_has_the_version_and_names_with_slips_are_suggested() {
    let bench = Workbench::new();
    let version = |arguments: &str| bench.run(arguments).stdout.split(' ').next_back().map(str::to_string);
    for command in ["fit", "evaluate", "man"] {
        assert_eq!(version(&format!("{command} --version")), version("--version"), "{command}");
    }
    for (typed, meant) in [("fti", "fit"), ("plto", "plot"), ("compar", "compare")] {
        let ran = bench.run(typed);
        assert_eq!(ran.status, Some(2));
        assert!(ran.stderr.contains(&format!("a similar subcommand exists: '{meant}'")), "{}", ran.stderr);
    }
    assert!(!bench.run("nonsense").stderr.contains("similar"));
}

#[test]
fn several_tables_are_evaluated_one_by_one() {
    let bench = Workbench::new();
    bench.succeeds("generate ferromagnet -o train.csv --test test.csv");
    bench.succeeds("fit train.csv --model pnn --starts 1 --epochs 2 -o m.json --no-report");
    let text = bench.succeeds("evaluate m.json train.csv test.csv").stdout;
    let of = |file: &str| bench.succeeds(&format!("evaluate m.json {file}")).stdout;
    assert_eq!(text, format!("train.csv\n{}\ntest.csv\n{}", of("train.csv"), of("test.csv")));
    let json: serde_json::Value = bench.json("evaluate m.json train.csv test.csv --json");
    assert_eq!(json[1], bench.json("evaluate m.json test.csv --json"));
}
