//! `generate-cases` as it is typed.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn generate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hysid-lab"));
    command.arg("generate-cases").arg(folder).args(arguments).output().unwrap()
}

/// Path and content of all files two levels down, in order.
fn files(folder: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    for case in fs::read_dir(folder).unwrap() {
        for file in fs::read_dir(case.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().display().to_string();
            files.push((name, fs::read_to_string(path).unwrap()));
        }
    }
    files.sort();
    files
}

#[test]
fn folders_of_a_seed_are_the_same_and_have_the_form_of_measured_ones() {
    let (first, second, other) = (TempDir::new().unwrap(), TempDir::new().unwrap(), TempDir::new().unwrap());
    let output = generate(first.path(), &["--count", "4", "--seed", "3"]);
    assert!(output.status.success());
    // A head of two lines and a line for each case.
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 6);
    generate(second.path(), &["--seed=3", "--count=4"]);
    generate(other.path(), &["--count", "4"]);
    let written = files(first.path());
    assert!(written == files(second.path()));
    assert!(written != files(other.path()));

    let names: Vec<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), 8);
    assert_eq!(names[..2], ["g01-joint-growing/test.csv", "g01-joint-growing/train.csv"]);
    let (test, train) = (&written[0].1, &written[1].1);
    let past = train.lines().count() - 1;
    assert!(train.starts_with("record,disp_mm,force_kN\ncyclic test,0,"));
    for (test, train) in test.lines().zip(train.lines()).skip(1) {
        let (input, _) = train.rsplit_once(',').unwrap();
        assert_eq!(test, format!("{input},"));
    }
    assert!(test.lines().skip(1 + past).all(|line| !line.ends_with(',')));
    assert!(written[7].1.starts_with("record,t_s,u_V,y_um\n"));
}

#[test]
fn a_folder_that_cannot_be_made_is_one_clear_line() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let output = generate(&file, &["--count", "1"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.lines().count() == 1 && said.contains("cannot be made"), "{said}");
    assert_eq!(generate(&file, &["--count", "none"]).status.code(), Some(2));
}
