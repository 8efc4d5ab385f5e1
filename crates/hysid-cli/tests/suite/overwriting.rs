//! Files that exist: Hysid replaces its own files only, keeps a model that it replaces, and leaves links,
//! permissions, devices and pipes as they are.

use std::fs;

use crate::workbench::{Ran, Workbench, table};

/// A file that somebody measured: its header is what a simulation of other data would have.
const MEASURED: &str = "t,x,y\n0,0.5,1\n1,0.7,2\n";

const FIT: &str = "fit good.csv -o model.json --model xpnn+ --starts 1 --epochs 1";

/// Runs a command that must not replace a file, then with `--force`.
fn refused_then_forced(bench: &Workbench, command: &str, file: &str, expected: &str) -> Ran {
    bench.put(file, MEASURED);
    let before = bench.files(".");
    let ran = bench.run(command);
    let line = format!(
        "error: {file}: a file is there already and is no {expected}: name another file, or replace it with --force"
    );
    assert_eq!(ran.last_line(), line, "hysid {command}");
    assert_eq!((ran.status, ran.stdout.as_str()), (Some(2), ""), "hysid {command}");
    assert_eq!(ran.stderr.lines().count(), 1, "refused before any work: {}", ran.stderr);
    assert_eq!((bench.text(file).as_str(), bench.files(".")), (MEASURED, before), "hysid {command}");
    let forced = bench.succeeds(&format!("{command} --force"));
    assert!(fs::read(bench.path(file)).unwrap() != MEASURED.as_bytes(), "hysid {command} --force");
    forced
}

#[test]
fn a_measured_file_is_replaced_by_no_command() {
    let bench = Workbench::with_model();
    bench.put("drive.csv", table());
    for (command, file, expected) in [
        (FIT, "model.json", "model of Hysid"),
        (FIT, "model.html", "page of Hysid"),
        (
            "fit good.csv -o new.json --no-report --model xpnn+ --starts 1 --epochs 1 --checkpoint data.bin",
            "data.bin",
            "checkpoint of Hysid",
        ),
        ("simulate model.json drive.csv -o out.csv", "out.csv", "result of this command"),
        ("generate ferromagnet -o train.csv", "train.csv", "copy of what this command writes"),
        ("generate ferromagnet --test test.csv", "test.csv", "copy of what this command writes"),
        ("compare good.csv --models pnn --time-limit 0.1", "good-compared.html", "page of Hysid"),
        ("diagnose good.csv", "good.diagnosis.html", "page of Hysid"),
    ] {
        refused_then_forced(&bench, command, file, expected);
        // Its own file it replaces without being told.
        bench.succeeds(command);
    }
    let hidden: Vec<String> = bench.files(".").into_iter().filter(|name| name.starts_with('.')).collect();
    assert!(hidden.is_empty(), "{hidden:?}");
}

#[test]
fn what_somebody_edited_is_kept() {
    let bench = Workbench::with_model();
    let kept = |command: &str, file: &str| {
        bench.succeeds(command);
        let edited = bench.text(file).replace("</svg>", "<text>mine</text></svg>") + "\n";
        bench.put(file, &edited);
        bench.succeeds(command);
        assert_eq!(bench.text(&format!("{file}.bak")), edited, "hysid {command}");
    };
    kept("look good.csv -o plain.csv", "plain.csv");
    kept("plot good.csv -o loops.svg", "loops.svg");
    // Later runs with other results replace the copies of unchanged files alone.
    let (edited, whole) = (bench.text("plain.csv.bak"), bench.text("good.csv"));
    let part: Vec<&str> = whole.lines().take(50).collect();
    for content in [part.join("\n"), whole.clone(), part.join("\n"), whole] {
        bench.put("good.csv", content);
        bench.succeeds("look good.csv -o plain.csv");
    }
    assert_eq!(bench.text("plain.csv.bak"), edited);
    let copies = bench.files("").into_iter().filter(|name| name.starts_with("plain.csv.bak")).count();
    assert_eq!(copies, 2);
}

#[test]
fn the_demo_and_the_reproduction_look_before_they_work() {
    let bench = Workbench::new();
    fs::create_dir(bench.path("out")).unwrap();
    for name in ["demo-train.csv", "demo-test.csv", "demo.json", "demo.html", "demo-loops.svg"] {
        bench.put(&format!("out/{name}"), MEASURED);
        let ran = bench.run("demo -o out");
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(2), 1), "{}", ran.stderr);
        assert!(ran.stderr.starts_with(&format!("error: out/{name}: a file is there already")), "{ran}");
        assert_eq!(bench.files("out"), [name], "nothing is written");
        fs::remove_file(bench.path(&format!("out/{name}"))).unwrap();
    }
    for name in ["nds.html", "nds.md", "nds.csv"] {
        bench.put(&format!("out/{name}"), MEASURED);
        let ran = bench.run("reproduce nds -o out");
        assert_eq!((ran.status, bench.text(&format!("out/{name}")).as_str()), (Some(2), MEASURED), "{name}");
        assert!(ran.stderr.contains(&format!("out/{name}: a file is there already")), "{}", ran.stderr);
        bench.succeeds("reproduce nds -o out --force");
        bench.succeeds("reproduce nds -o out");
        for name in bench.files("out") {
            fs::remove_file(bench.path(&format!("out/{name}"))).unwrap();
        }
    }
    bench.put("out/training-seeds.csv", MEASURED);
    let ran = bench.run("reproduce training --quick -o out");
    assert_eq!((ran.status, bench.files("out").len()), (Some(2), 1), "{}", ran.stderr);
}

#[test]
fn tables_are_replaced_only_by_the_same_command() {
    let bench = Workbench::with_model();
    let run = |command: &str| bench.run(command).status;
    assert_eq!(run("simulate model.json good.csv -o out.csv"), Some(0));
    // The same columns: another run of the same command, maybe with another model.
    assert_eq!(run("simulate model.json good.csv -o out.csv"), Some(0));
    bench.put("renamed.csv", table().replacen("t,x,y", "t,x,z", 1));
    assert_eq!(run("simulate model.json renamed.csv -o out.csv"), Some(2));
    assert_eq!(run("generate ferromagnet -o loops.csv --noise 1"), Some(0));
    assert_eq!(run("generate ferromagnet -o loops.csv --noise 1"), Some(0));
    assert_eq!(run("generate ferromagnet -o loops.csv --noise 2"), Some(2));
    assert_eq!(run("generate ferromagnet -o loops.csv --noise 2 --force"), Some(0));
    // A file without content is nobody's loss.
    bench.put("empty.csv", "");
    assert_eq!(run("generate ferromagnet -o empty.csv"), Some(0));
}

#[test]
fn a_replaced_model_is_kept_and_a_note_says_so() {
    let bench = Workbench::with_model();
    let (first, fit) =
        (bench.text("model.json"), "fit good.csv -o model.json --no-report --model pnn --starts 1");
    let ran = bench.succeeds(fit);
    assert_eq!(ran.last_line(), "the file that was model.json is kept as model.json.bak");
    assert_eq!(bench.text("model.json.bak"), first);
    // The same model again: what is kept stays.
    let ran = bench.run(fit);
    assert!(!ran.stderr.contains("is kept"), "{}", ran.stderr);
    assert_eq!(bench.text("model.json.bak"), first);
    bench.put("model.json.bak", MEASURED);
    // A file of somebody else has that name: the model is kept beside it.
    let second = bench.text("model.json");
    let ran = bench.run("fit good.csv -o model.json --no-report --model xpnn+ --starts 1 --epochs 1");
    assert_eq!(ran.last_line(), "the file that was model.json is kept as model.json.bak2");
    assert_eq!((bench.text("model.json.bak").as_str(), bench.text("model.json.bak2")), (MEASURED, second));
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
    use std::process::Command;

    use super::*;

    #[test]
    fn links_permissions_pipes_and_devices_stay_what_they_are() {
        let bench = Workbench::with_model();
        let mode = |name: &str| fs::metadata(bench.path(name)).unwrap().mode() & 0o777;
        fs::set_permissions(bench.path("model.json"), fs::Permissions::from_mode(0o600)).unwrap();
        symlink("model.json", bench.path("link.json")).unwrap();
        let fit = "--no-report --model pnn --starts 1 --epochs 1 --seed";
        bench.succeeds(&format!("fit good.csv -o link.json {fit} 3"));
        assert!(fs::symlink_metadata(bench.path("link.json")).unwrap().is_symlink());
        assert_eq!((mode("model.json"), mode("model.json.bak")), (0o600, 0o600));
        bench.succeeds("simulate model.json good.csv -o out.csv");

        let made = Command::new("mkfifo").arg(bench.path("pipe")).status().unwrap();
        assert!(made.success());
        let ran = bench.shell("cat pipe > read.csv & hysid simulate model.json good.csv -o pipe && wait");
        assert_eq!((ran.status, bench.text("read.csv")), (Some(0), bench.text("out.csv")), "{}", ran.stderr);
        assert!(fs::metadata(bench.path("pipe")).unwrap().file_type().is_fifo());
        for (out, read) in [("/dev/stdout", "a.csv"), ("/dev/fd/1", "b.csv")] {
            let ran = bench.shell(&format!("hysid simulate model.json good.csv -o {out} > {read}"));
            assert_eq!((ran.status, bench.text(read)), (Some(0), bench.text("out.csv")), "{}", ran.stderr);
        }
        let ran = bench.shell("hysid simulate model.json good.csv -o /dev/stdout | cat > c.csv");
        assert_eq!((ran.status, bench.text("c.csv")), (Some(0), bench.text("out.csv")));
    }

    #[test]
    fn a_checkpoint_goes_through_a_link_and_into_a_pipe_s_place_never() {
        let bench = Workbench::with_model();
        fs::create_dir(bench.path("store")).unwrap();
        symlink("store/c.bin", bench.path("c.bin")).unwrap();
        let fit = "fit good.csv -o new.json --no-report --model xpnn+ --starts 1 --epochs 2 --checkpoint";
        bench.succeeds(&format!("{fit} c.bin"));
        assert!(fs::symlink_metadata(bench.path("c.bin")).unwrap().is_symlink());
        assert!(fs::metadata(bench.path("store/c.bin")).unwrap().is_file());
        // Names that could be guessed are not used: links there stay links, and what they lead to stays as it is.
        for guess in [".d.bin.partial", ".d.bin.hysid-partial", ".d.bin.tmp"] {
            bench.put("victim", MEASURED);
            symlink("victim", bench.path(guess)).unwrap();
        }
        bench.succeeds(&format!("{fit} d.bin"));
        assert_eq!(bench.text("victim"), MEASURED);
        bench.succeeds(&format!("{fit} /dev/null"));
    }

    #[test]
    fn a_full_disk_does_not_lose_the_fit() {
        let bench = Workbench::with_data();
        let disk = bench.path("small");
        fs::create_dir(&disk).unwrap();
        let mounted =
            Command::new("mount").args(["-t", "tmpfs", "-o", "size=16k", "tmpfs"]).arg(&disk).output();
        if !mounted.is_ok_and(|mounted| mounted.status.success()) {
            eprintln!("skipped: this user cannot make a small disk");
            return;
        }
        // The disk is full but for a few blocks, in which a name but no model has room.
        fs::write(disk.join("filling"), [0u8; 12 * 1024]).unwrap();
        let ran = bench.run("fit good.csv -o small/m.json --no-report --model xpnn+ --starts 1 --epochs 1");
        let left: Vec<String> = bench.files("small");
        assert!(Command::new("umount").arg(&disk).status().unwrap().success());
        assert_eq!(ran.status, Some(1), "{}", ran.stderr);
        let line = ran.last_line();
        let place =
            line.strip_prefix("error: small/m.json: cannot be written: the disk is full; the model is in ");
        let place = place.unwrap_or_else(|| panic!("{line}")).to_string();
        assert_eq!(left, ["filling"]);
        let ran = bench.run(&format!("evaluate {place} good.csv"));
        fs::remove_file(&place).unwrap();
        assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    }
}
