//! Files as they are left behind: complete, where the user wanted them, and never in the place of somebody else's.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use hysid_files::{Destination, Failure, Kind, Lock, PAGE_MARK, rescue};
use tempfile::TempDir;

const MODEL: &[u8] = b"{\"format\": \"hysid-model\", \"version\": 1}";
const OTHER_MODEL: &[u8] = b"{\"format\": \"hysid-model\", \"version\": 2}";

fn folder() -> TempDir {
    TempDir::new().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn model(path: &Path) -> Destination {
    Destination::new(path, Kind::Model, false)
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).unwrap().mode() & 0o7777
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn a_new_file_has_the_permissions_that_the_mask_leaves_and_an_old_one_keeps_its_own() {
    let folder = folder();
    let [new, plain] = ["new.json", "plain"].map(|name| folder.path().join(name));
    fs::write(&plain, "").unwrap();
    model(&new).write(MODEL).unwrap();
    assert_eq!(mode(&new), mode(&plain), "as any file that this user makes");
    for kept in [0o600, 0o640, 0o664] {
        fs::set_permissions(&new, fs::Permissions::from_mode(kept)).unwrap();
        model(&new).write(MODEL).unwrap();
        assert_eq!(mode(&new), kept);
    }
    assert_eq!(names(folder.path()), ["new.json", "plain"]);
}

#[test]
fn links_are_followed_to_files_and_to_places_where_there_is_none_yet() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("store")).unwrap();
    symlink("store/model.json", at("one")).unwrap();
    symlink("one", at("two")).unwrap();
    for content in [MODEL, OTHER_MODEL] {
        model(&at("two")).write(content).unwrap();
        assert_eq!(fs::read(at("store/model.json")).unwrap(), content);
    }
    for (link, leads) in [("one", "store/model.json"), ("two", "one")] {
        assert_eq!(fs::read_link(at(link)).unwrap(), PathBuf::from(leads));
    }
    assert_eq!(names(&at("store")), ["model.json", "model.json.bak"]);
    symlink("round", at("round")).unwrap();
    let error = model(&at("round")).check().unwrap_err().to_string();
    assert!(error.ends_with("round: cannot be written: too many links"), "{error}");
}

#[test]
fn pipes_and_devices_are_written_through() {
    let folder = folder();
    let path = folder.path().join("pipe");
    pipe(&path);
    let reader = {
        let path = path.clone();
        std::thread::spawn(move || {
            let mut content = Vec::new();
            File::open(path).unwrap().read_to_end(&mut content).unwrap();
            content
        })
    };
    model(&path).check().unwrap();
    model(&path).write(MODEL).unwrap();
    assert_eq!(reader.join().unwrap(), MODEL);
    assert!(!fs::symlink_metadata(&path).unwrap().is_file());
    model(Path::new("/dev/null")).write(MODEL).unwrap();
    assert_eq!(names(folder.path()), ["pipe"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_open_file_under_its_name_as_a_file_is_written_to_and_not_replaced() {
    use std::os::fd::AsRawFd;
    let folder = folder();
    let path = folder.path().join("open");
    let mut open = File::create(&path).unwrap();
    open.write_all(b"before ").unwrap();
    let inode = fs::metadata(&path).unwrap().ino();
    let name = format!("/proc/self/fd/{}", open.as_raw_fd());
    symlink(&name, folder.path().join("link")).unwrap();
    for (name, content) in [(PathBuf::from(&name), "1"), (folder.path().join("link"), "2")] {
        model(&name).write(content.as_bytes()).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap(), "before 12");
    assert_eq!(fs::metadata(&path).unwrap().ino(), inode);
}

#[test]
fn only_hysid_s_own_files_are_replaced() {
    let folder = folder();
    let path = folder.path().join("file");
    let page = format!("{PAGE_MARK}0.1.0\">\n");
    let svg = "<svg class=\"plot\" role=\"img\" aria-label=\"B over H\" data-generator=\"Hysid 0.1.0\">";
    let table = Kind::Beginning(b"t,x,y_model\n".to_vec());
    let cases = [
        (Kind::Model, std::str::from_utf8(MODEL).unwrap(), "{\"format\": \"json\"}"),
        (Kind::Checkpoint, "hysid checkpoint 1\n...", "t,x,y\n"),
        (Kind::Page, &page, "<!DOCTYPE html>\n<title>mine</title>"),
        (Kind::Drawing, svg, "<svg class=\"plot\"></svg>"),
        (
            Kind::Drawing,
            "%PDF-1.7\n1 0 obj\n<< /Creator (Hysid 0.1.0) >>",
            "%PDF-1.7\n1 0 obj\n<< /Creator (LaTeX) >>",
        ),
        (table, "t,x,y_model\n0,1,2\n", "t,x,y_model_2\n0,1,2\n"),
        (Kind::Content(b"x,y\n1,2\n".to_vec()), "x,y\n1,2\n", "x,y\n1,3\n"),
    ];
    for (kind, ours, theirs) in cases {
        for (there, is_ours) in [(ours, true), ("", true), (theirs, false), ("x,y\n1.5,2.5\n", false)] {
            fs::write(&path, there).unwrap();
            let destination = Destination::new(&path, kind.clone(), false);
            assert_eq!(destination.check().is_ok(), is_ours, "{kind:?}: {there}");
            if is_ours {
                destination.write(b"new").unwrap();
                assert_eq!(fs::read(&path).unwrap(), b"new");
                continue;
            }
            for refused in [destination.check().err(), destination.write(b"new").err()] {
                assert!(matches!(refused, Some(Failure::NotOurs { .. })), "{kind:?}: {there}: {refused:?}");
            }
            assert_eq!(fs::read_to_string(&path).unwrap(), there, "{kind:?}");
            let forced = Destination::new(&path, kind.clone(), true);
            forced.check().unwrap();
            forced.write(b"new").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"new");
        }
    }
}

#[test]
fn a_file_put_there_during_the_work_is_not_replaced() {
    let folder = folder();
    let path = folder.path().join("out.csv");
    let destination = Destination::new(&path, Kind::Beginning(b"x,y_model\n".to_vec()), false);
    let mut file = destination.create().unwrap();
    file.write_all(b"x,y_model\n1,2\n").unwrap();
    fs::write(&path, "measured\n").unwrap();
    assert!(matches!(file.commit(), Err(Failure::NotOurs { .. })));
    assert_eq!(fs::read_to_string(&path).unwrap(), "measured\n");
    assert_eq!(names(folder.path()), ["out.csv"]);
}

#[test]
fn a_replaced_model_is_kept_unless_it_is_the_same() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_eq!(model(&at("m.json")).write(MODEL).unwrap(), None);
    assert_eq!(model(&at("m.json")).write(MODEL).unwrap(), None, "the same again");
    assert_eq!(names(folder.path()), ["m.json"]);
    assert_eq!(model(&at("m.json")).write(OTHER_MODEL).unwrap(), Some(at("m.json.bak")));
    assert_eq!(fs::read(at("m.json.bak")).unwrap(), MODEL);
    assert_eq!(fs::read(at("m.json")).unwrap(), OTHER_MODEL);
    // Somebody else's file in the place of the copy is neither replaced nor in the way.
    fs::write(at("m.json.bak"), "notes").unwrap();
    model(&at("m.json")).check().unwrap();
    assert_eq!(model(&at("m.json")).write(MODEL).unwrap(), Some(at("m.json.bak2")));
    assert_eq!(fs::read_to_string(at("m.json.bak")).unwrap(), "notes");
    assert_eq!(fs::read(at("m.json.bak2")).unwrap(), OTHER_MODEL);
}

#[test]
fn write_protected_files_are_refused() {
    let folder = folder();
    let path = folder.path().join("m.json");
    fs::write(&path, MODEL).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    if fs::OpenOptions::new().append(true).open(&path).is_ok() {
        eprintln!("skipped: this user (root?) may write to everything");
        return;
    }
    let error = model(&path).check().unwrap_err().to_string();
    assert!(error.ends_with("m.json: cannot be written: permission denied"), "{error}");
}

#[test]
fn leftovers_of_dead_processes_are_removed_and_nothing_else() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // Their process lives: the lock is held until the end of the test.
    let living = model(&at("m.json"));
    let mut living = living.create().unwrap();
    living.write_all(b"half").unwrap();
    let of_living = names(folder.path());
    assert_eq!(of_living.len(), 1);
    fs::write(at(".m.json.abcdEF12.hysid-partial"), "half").unwrap();
    let others = [
        ".other.json.abcdEF12.hysid-partial",
        ".m.json.abcdEF1.hysid-partial",
        ".m.json.abcdEF12.partial",
        ".m.json.notes",
    ];
    for name in others {
        fs::write(at(name), "").unwrap();
    }
    // Not followed, not opened.
    fs::write(at("precious"), "precious").unwrap();
    symlink("precious", at(".m.json.aaaaaaaa.hysid-partial")).unwrap();
    pipe(&at(".m.json.bbbbbbbb.hysid-partial"));
    model(&at("m.json")).check().unwrap();
    let mut expected: Vec<String> = others.map(String::from).to_vec();
    expected.extend([".m.json.aaaaaaaa.hysid-partial", ".m.json.bbbbbbbb.hysid-partial"].map(String::from));
    expected.extend(of_living);
    expected.push("precious".into());
    expected.sort();
    assert_eq!(names(folder.path()), expected);
    living.commit().unwrap();
    assert_eq!(fs::read(at("m.json")).unwrap(), b"half");
}

#[test]
fn a_lock_is_held_once_and_leaves_nothing_behind() {
    let folder = folder();
    let path = folder.path().join("c.bin");
    let first = Lock::acquire(&path).unwrap();
    assert!(matches!(Lock::acquire(&path), Err(Failure::InUse(_))));
    assert!(matches!(Lock::acquire(&folder.path().join("./c.bin")), Err(Failure::InUse(_))));
    drop(first);
    drop(Lock::acquire(&path).unwrap());
    assert!(names(folder.path()).is_empty());
    // A file of the user's with this name stays.
    let notes = folder.path().join(".c.bin.lock");
    fs::write(&notes, "notes").unwrap();
    drop(Lock::acquire(&path).unwrap());
    assert_eq!(fs::read(&notes).unwrap(), b"notes");
    fs::remove_file(&notes).unwrap();
    // A link in the place of the lock is not followed.
    let victim = folder.path().join("victim");
    symlink(&victim, folder.path().join(".c.bin.lock")).unwrap();
    assert!(matches!(Lock::acquire(&path), Err(Failure::Refused { .. })));
    assert!(!victim.exists());
    drop(Lock::acquire(Path::new("/dev/null")).unwrap());
}

#[test]
fn what_cannot_be_written_where_it_should_is_written_elsewhere() {
    let folder = folder();
    let path = folder.path().join("m.json");
    let found = rescue(&path, MODEL).unwrap();
    assert_eq!(found.parent(), Some(folder.path()));
    assert!(found.file_name().unwrap().to_str().unwrap().starts_with("m-"), "{found:?}");
    assert_eq!(fs::read(&found).unwrap(), MODEL);
    let elsewhere = rescue(&folder.path().join("missing/m.json"), MODEL).unwrap();
    assert_eq!(fs::read(&elsewhere).unwrap(), MODEL);
    assert_eq!(elsewhere.extension().unwrap(), "json");
    fs::remove_file(elsewhere).unwrap();
    let of_a_device = rescue(Path::new("/dev/null"), MODEL).unwrap();
    assert_ne!(of_a_device.parent(), Some(Path::new("/dev")), "nothing is put among devices");
    fs::remove_file(of_a_device).unwrap();
}
