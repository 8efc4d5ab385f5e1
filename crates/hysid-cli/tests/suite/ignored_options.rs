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
fn help_is_short_where_it_is_asked_for_briefly() {
    let bench = Workbench::new();
    let (short, long) = (bench.run("fit -h").stdout, bench.run("fit --help").stdout);
    assert!(short.lines().count() < 60, "{} lines", short.lines().count());
    assert!(short.contains("Examples:") && !short.contains("--free-weights"), "{short}");
    assert!(long.contains("--free-weights"), "{long}");
}
