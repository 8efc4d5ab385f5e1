//! `hysid export` as a user runs it.

use std::fs;

use hysid_core::elementary::{cos, sin};

use crate::workbench::{Workbench, cases, must_contain};

/// A bench with a model of a few stops.
fn with_model() -> Workbench {
    let bench = Workbench::new();
    let rows: String = (0..300)
        .map(|k| {
            let x = sin(0.1 * f64::from(k)) * f64::from(k) / 100.0;
            format!("{x},{}\n", 2.0 * x + 0.3 * cos(0.1 * f64::from(k)))
        })
        .collect();
    bench.put("train.csv", format!("x_mm,F_kN\n{rows}"));
    let fit = "fit train.csv --model pnn --starts 1 --epochs 3 -o stage-2.json --no-report";
    bench.succeeds(fit);
    bench
}

#[test]
fn a_folder_appears_with_all_that_its_manifest_lists() {
    let bench = with_model();
    let ran = bench.run("export stage-2.json --to c");
    assert_eq!((ran.status, ran.stdout.as_str()), (Some(0), ""), "{}", ran.stderr);
    assert_eq!(ran.stderr, "wrote stage_2_c: 8 files; stage_2_c/README.md says how to use them\n");
    let folder = bench.path("stage_2_c");
    let manifest: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("manifest.json")).unwrap()).unwrap();
    assert_eq!((&manifest["target"], &manifest["name"]), (&"c".into(), &"stage_2".into()));
    for file in manifest["files"].as_array().unwrap() {
        let content = fs::read(folder.join(file["path"].as_str().unwrap())).unwrap();
        assert_eq!(file["bytes"], content.len());
        assert_eq!(file["sha256"].as_str().unwrap().len(), 64);
    }
    let header = fs::read_to_string(folder.join("stage_2.h")).unwrap();
    must_contain(&header, &["x_mm, trained from", "F_kN", "error in training", "date of the model file: 20"]);

    // The same again replaces it; a file that was added stays.
    fs::write(folder.join("mine.c"), "mine").unwrap();
    bench.succeeds("export stage-2.json --to c --json");
    assert_eq!(fs::read_to_string(folder.join("mine.c")).unwrap(), "mine");
}

#[test]
fn nothing_that_others_wrote_or_changed_is_lost() {
    let bench = with_model();
    bench.succeeds("export stage-2.json --to c -o q");
    let source = bench.path("q").join("stage_2.c");
    let edited = fs::read_to_string(&source).unwrap() + "/* mine */\n";
    fs::write(&source, &edited).unwrap();
    let ran = bench.run("export stage-2.json --to c -o q");
    assert_eq!(ran.status, Some(2));
    must_contain(&ran.stderr, &["q/stage_2.c: this file is not as Hysid wrote it: name another folder"]);
    let ran = bench.succeeds("export stage-2.json --to c -o q --force");
    assert!(ran.stderr.contains("kept as") && ran.stderr.contains("stage_2.c.bak"), "{ran}");
    assert_eq!(fs::read_to_string(bench.path("q").join("stage_2.c.bak")).unwrap(), edited);

    // A folder of others, and one with the model in it.
    fs::create_dir_all(bench.path("p").join("notes")).unwrap();
    fs::write(bench.path("p").join("notes").join("t"), "thesis").unwrap();
    assert_eq!(bench.run("export stage-2.json --to c -o p").status, Some(2));
    fs::copy(bench.path("stage-2.json"), bench.path("p").join("m.json")).unwrap();
    let ran = bench.run("export p/m.json --to c -o p --force");
    assert_eq!(ran.status, Some(2));
    assert!(ran.stderr.contains("p: holds p/m.json, which is read"), "{ran}");
    bench.succeeds("export stage-2.json --to c -o p --force");
    assert_eq!(fs::read_to_string(bench.path("p").join("notes").join("t")).unwrap(), "thesis");
    assert!(bench.path("p").join("m.json").exists() && bench.path("p").join("stage_2.h").exists());
}

#[test]
fn a_folder_is_found_whatever_the_working_folder_is() {
    let bench = with_model();
    bench.succeeds("export stage-2.json --to c -o own");
    let ran = bench
        .command("export ../stage-2.json --to c -o ../own")
        .current_dir(bench.path("own"))
        .output()
        .unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    assert!(bench.path("own").join("stage_2.c").exists());
    let names: Vec<String> = fs::read_dir(bench.path(""))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert!(!names.iter().any(|name| name.contains("partial")), "{names:?}");
}

#[test]
fn without_a_compiler_a_unit_has_its_sources_and_the_user_is_told() {
    let bench = with_model();
    let without = bench
        .command("export stage-2.json --to fmu -o sources --json")
        .env("CC", "no-such-cc")
        .output()
        .unwrap();
    assert!(without.status.success());
    let answer: serde_json::Value = serde_json::from_slice(&without.stdout).unwrap();
    assert!(answer["note"].as_str().unwrap().contains("no C compiler"), "{answer}");
    let ran = bench.command("export stage-2.json --to fmu -o told").env("CC", "no-such-cc").output().unwrap();
    let text = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert!(text.contains("stage_2.fmu has source code only") && text.lines().count() == 2, "{text}");
}

#[test]
fn bad_requests_are_one_line_and_leave_nothing() {
    let bench = with_model();
    bench.put("file", "mine");
    for (status, arguments, text) in cases(
        r#"
        2 --to c --name 2nd => --name: the name "2nd" is no identifier
        2 --to c --precision f16 => f16
        2 --to onnx --precision f32 => --precision: onnx computes in double precision
        2 --to c --fmi 2 => --fmi is a version of --to fmu
        2 --to fmu --fmi 1 => --fmi
        2 --to cobol => cobol
        2 --to python --inverse => --inverse: exports to python have no inverse: those to c and fmu have one
        2 --to c --limits 0:1 => --limits is for the input of an inverse: add --inverse
        2 --to c --slew 1 => --slew is for the input of an inverse: add --inverse
        2 --to c --inverse --limits 3:1 => '3:1' for '--limits <LOW:HIGH>': the low limit 3 is not below
        2 --to c --inverse --limits nan:1 => --limits <LOW:HIGH>': two numbers are needed
        2 --to c --inverse --slew -1 => '-1' for '--slew <RATE>': a number above 0 is needed
        2 --to c --inverse --precision f32 --limits 1:1.00000001 => --limits: the limits of the input are 1
        2 --to c -o file => file: a file is there already
        2 --to c -o - => -o -: an export is a folder
        1 --to c -o train.csv/new => train.csv/new: cannot be written
    "#,
    ) {
        let ran = bench.run(&format!("export stage-2.json {arguments}"));
        assert_eq!(ran.status, Some(status), "{arguments}: {}", ran.stderr);
        assert!(ran.stderr.contains(text) && ran.stderr.lines().count() == 1, "{arguments}: {}", ran.stderr);
    }
    let ran = bench.run("export missing.json --to c");
    assert_eq!(ran.status, Some(1), "{}", ran.stderr);
    let mut left: Vec<_> =
        fs::read_dir(bench.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["file", "stage-2.json", "train.csv"]);
}

#[test]
fn an_inverse_has_the_bounds_that_were_asked_for() {
    let bench = with_model();
    for (bounds, low, high) in [
        ("", None, None),
        ("--limits -0.5:0.75", Some("(-0.5)"), Some("0.75")),
        ("--limits=-0.5:-0.25 --slew 2e3", Some("(-0.5)"), Some("(-0.25)")),
    ] {
        bench.succeeds(&format!("export stage-2.json --to c --inverse {bounds}"));
        let header = fs::read_to_string(bench.path("stage_2_c").join("stage_2_inverse.h")).unwrap();
        for (bound, value) in [("LOW", low), ("HIGH", high)] {
            let line = format!("#define STAGE_2_INVERSE_{bound} {}", value.unwrap_or_default());
            assert!(header.contains(&line), "{header}");
        }
        let slew = header.contains("#define STAGE_2_INVERSE_SLEW 2000.0");
        assert_eq!(slew, bounds.contains("slew"), "{header}");
        assert!(bench.path("stage_2_c").join("inverse_vectors.csv").exists());
    }
    let answer = bench.json("export stage-2.json --to fmu --inverse --json");
    let files: Vec<&str> =
        answer["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    assert_eq!(
        files,
        ["stage_2.fmu", "stage_2_test.py", "inverse_vectors.csv", "README.md", "manifest.json"]
    );
}
