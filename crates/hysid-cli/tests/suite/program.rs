//! Commands about the program itself: models, completions, manual pages.

use crate::workbench::{Workbench, must_contain};
use serde_json::Value;

#[test]
fn the_list_of_models_has_every_name_that_a_fit_takes() {
    let bench = Workbench::new();
    let listed = bench.json("models --json");
    let names: Vec<&str> =
        listed.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    // A wrong name makes a fit say all names.
    let said = bench.run("fit a.csv --model none-such").stderr;
    let (_, known) = said.split_once("[possible values: ").unwrap();
    let known: Vec<&str> = known.split_once(']').unwrap().0.split(", ").collect();
    assert_eq!(names, known);
    let text = bench.run("models").stdout;
    assert!(names.iter().all(|name| text.lines().any(|line| line.split(' ').next() == Some(name))), "{text}");
}

#[test]
fn a_model_file_is_shown_with_what_it_stores() {
    let bench = Workbench::with_model();
    let shown = bench.json("models model.json --json");
    let file: Value = serde_json::from_str(&bench.text("model.json")).unwrap();
    assert_eq!(shown["model"], "xpnn+");
    assert_eq!(shown["bytes"], bench.text("model.json").len());
    for (name, stored) in [
        ("written_by", &file["written_by"]),
        ("columns", &file["columns"]),
        ("train", &file["training"]["train"]),
        ("samples", &file["training"]["samples"]),
    ] {
        assert_eq!(&shown[name], stored, "{name}");
    }
    assert_eq!(shown["trained_ranges"]["inputs"], file["trained_ranges"]["inputs"]);
    let text = bench.run("models model.json").stdout;
    for said in ["xpnn+: network of 10 stops", "RMSE of y", "output", "60 samples in 1 record", "Seed"] {
        assert!(text.contains(said), "{said}: {text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn a_law_is_shown_with_its_parameters_and_an_ensemble_with_its_members() {
    let bench = Workbench::with_model();
    bench.succeeds("fit good.csv -o law.json --no-report --model prandtl-ishlinskii -q");
    let law = bench.json("models law.json --json");
    let parameters = law["law_parameters"].as_array().unwrap();
    assert_eq!(law["parameters"], parameters.len());
    let text = bench.run("models law.json").stdout;
    let mut shown = parameters.iter().take(60);
    assert!(shown.all(|one| text.contains(one["symbol"].as_str().unwrap())), "{text}");
    assert!(text.contains(&format!("{} more parameter", parameters.len() - 60)), "{text}");
    bench.succeeds("fit good.csv -o both.json --no-report --model masing --members 2 -q");
    let both = bench.json("models both.json --json");
    let shares =
        both["members"].as_array().unwrap().iter().map(|one| one["weights"]["inside"].as_f64().unwrap());
    let (count, sum) = (shares.len(), shares.sum::<f64>());
    assert!(count == 0 || (sum - 1.0).abs() < 1e-9, "{count} members, {sum}");
}

#[test]
fn completions_of_every_shell_know_commands_and_options() {
    let bench = Workbench::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let ran = bench.run(&format!("completions {shell}"));
        assert_eq!((ran.status, ran.stderr.as_str()), (Some(0), ""), "{shell}");
        must_contain(&ran.stdout, &["diagnose", "completions", "time-limit", "quiet"]);
    }
    let ran = bench.run("completions tcsh");
    assert_eq!(ran.status, Some(2));
    assert!(ran.stderr.contains("(see `hysid completions --help`)"), "{}", ran.stderr);
    // The script is one that bash takes.
    bench.put("hysid.bash", bench.run("completions bash").stdout);
    let checked = bench.shell("bash -n hysid.bash && bash -c '. ./hysid.bash && complete -p hysid'");
    assert!(checked.stdout.contains("hysid"), "{}", checked.stderr);
}

#[test]
fn there_is_a_manual_page_of_the_program_and_of_each_command() {
    let bench = Workbench::new();
    bench.succeeds("man -o pages");
    let pages = bench.files("pages");
    for page in ["hysid.1", "hysid-fit.1", "hysid-look.1", "hysid-man.1"] {
        assert!(pages.iter().any(|known| known == page), "{page}: {pages:?}");
    }
    let fit = bench.text("pages/hysid-fit.1");
    assert!(fit.contains(".TH hysid-fit 1") && fit.contains("time\\-limit"), "{fit}");
    // A later version replaces its own pages, and no file of somebody else.
    bench.succeeds("man -o pages");
    bench.put("pages/hysid.1", "my notes");
    assert_eq!(bench.run("man -o pages").status, Some(2));
    assert_eq!(bench.text("pages/hysid.1"), "my notes");
}
