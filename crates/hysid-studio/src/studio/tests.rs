use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use hysid::model::Model;
use serde_json::{Value, json};

use super::*;
use crate::fitting::FitState;
use crate::project::{FitRequest, Use};
use crate::words::said;
use hysid_records::ReadingChoice;

const TABLE: &str = "t,x,y\n0,0,0\n1,1,1.1\n2,2,2.1\n3,1,1.2\n4,0,0.1\n5,1,1.1\n";

fn opened(path: &Path) -> Arc<Studio> {
    Arc::new(Studio::open(Folder::open(Some(path)).unwrap()).unwrap())
}

/// With training and test data as files 1 and 2.
fn with_specimen(path: &Path) -> Arc<Studio> {
    let studio = opened(path);
    studio.take_specimen("ferromagnet", 1, 0.0).unwrap();
    studio
}

fn shown(studio: &Studio) -> Value {
    serde_json::to_value(studio.shown()).unwrap()
}

/// Fits, and waits for the end.
fn fit(studio: &Arc<Studio>) -> FitState {
    let options = [("model", json!("prandtl-ishlinskii")), ("operators", json!(3))];
    let options = options.map(|(name, value)| (name.to_string(), value)).into_iter().collect();
    studio.begin_fit(FitRequest { options, rate: Some("none".into()), time_limit: None }).unwrap();
    wait(studio)
}

fn wait(studio: &Studio) -> FitState {
    let began = Instant::now();
    loop {
        let state = studio.fit().unwrap();
        if !state.is_running {
            return state;
        }
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn changed(path: &Path, change: impl FnOnce(&mut Value)) {
    let file = path.join("project.json");
    let mut project = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    change(&mut project);
    fs::write(file, serde_json::from_value::<Project>(project).unwrap().text()).unwrap();
}

#[test]
fn uploads_at_the_same_time_do_not_exceed_the_limit() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = opened(&path);
    studio.take_content("a.csv", TABLE.as_bytes(), Use::Unused).unwrap();
    drop(studio);
    changed(&path, |project| {
        let file = project["files"][0].clone();
        let files = (1..=195).map(|id| {
            let mut file = file.clone();
            (file["id"], file["name"]) = (json!(id), json!(format!("{id}.csv")));
            file
        });
        project["files"] = files.collect();
    });
    let studio = opened(&path);
    let taken: usize = std::thread::scope(|scope| {
        let uploads: Vec<_> = (0..20)
            .map(|_| scope.spawn(|| studio.take_content("b.csv", TABLE.as_bytes(), Use::Unused).is_ok()))
            .collect();
        uploads.into_iter().map(|upload| usize::from(upload.join().unwrap())).sum()
    });
    assert_eq!((taken, studio.project().files.len()), (5, 200));
    let left = fs::read_dir(path.join("data")).unwrap().flatten();
    assert_eq!(left.filter(|entry| entry.file_name().to_string_lossy().starts_with('.')).count(), 0);
}

#[test]
fn a_project_with_3000_files_opens_in_a_second() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    drop(opened(&path));
    let file = |id: usize| json!({"id": id, "name": format!("{id}.csv"), "bytes": TABLE.len(), "checksum": "", "use": "training"});
    (1..=3000).for_each(|id| fs::write(path.join(format!("data/{id}.csv")), TABLE).unwrap());
    opened(&path).change(|_| Ok(())).unwrap();
    changed(&path, |project| project["files"] = (1..=3000).map(file).collect());
    let began = Instant::now();
    let studio = opened(&path);
    let state = shown(&studio);
    assert!(began.elapsed() < Duration::from_secs(1), "{:?}", began.elapsed());
    assert_eq!((state["files"].as_array().unwrap().len(), &state["is_reading"]), (3000, &json!(true)));
}

#[test]
fn a_problem_names_the_control_that_helps_and_not_an_option_of_the_terminal() {
    let place = tempfile::tempdir().unwrap();
    let studio = opened(&place.path().join("p"));
    let text = TABLE.replacen("\n", "\n0,0,over\n", 1);
    let id = studio.take_content("a.csv", text.as_bytes(), Use::Training).unwrap();
    let problem = studio.data_of(id).map(drop).unwrap_err();
    let at_end = |words: &str, ending: &str| assert!(words.ends_with(ending), "{words}");
    at_end(&problem.to_string(), "(if it stands for a missing value: --missing over)");
    at_end(&said(&problem).text(), "(if it stands for a missing value: \"Missing\" over)");
    let shown = shown(&studio)["files"][0]["problem"].clone();
    assert_eq!(shown[1], json!({"flag": "--missing", "words": "\"Missing\" over", "value": null}));
    studio.read_as(ReadingChoice { missing: vec!["over".into()], ..ReadingChoice::default() }).unwrap();
    assert_eq!(studio.data_of(id).unwrap().set.scored(), 6);
}

#[test]
fn a_file_that_killed_the_studio_is_held_back_until_it_is_read_again() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = opened(&path);
    let bad = studio.take_content("bad.csv", TABLE.as_bytes(), Use::Unseen).unwrap();
    let good = studio.take_content("good.csv", TABLE.as_bytes(), Use::Training).unwrap();
    assert!(!path.join("data/.reading-1").exists());
    // The studio dies while the reader of the file is at work.
    let folder = &studio.folder;
    let died = std::panic::catch_unwind(|| {
        folder.read_data(bad, "bad.csv", |_| -> Result<()> { std::panic::resume_unwind(Box::new(())) })
    });
    assert!(died.is_err() && path.join("data/.reading-1").exists());
    drop(studio);
    let studio = opened(&path);
    assert_eq!(studio.data_of(good).unwrap().set.rows(), 6);
    let words = studio.data_of(bad).map(drop).unwrap_err().to_string();
    assert!(words.contains("the studio was killed while it read this file"), "{words}");
    assert_eq!(shown(&studio)["files"][0]["is_held_back"], true);
    studio.read_again(bad).unwrap();
    assert_eq!(studio.data_of(bad).unwrap().set.rows(), 6);
    assert_eq!(shown(&studio)["files"][0]["is_held_back"], false);
    assert!(!path.join("data/.reading-1").exists());
}

#[test]
fn a_model_that_cannot_be_stored_stays_until_it_is() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = with_specimen(&path);
    // As with a full disk: nothing can be written to the folder of models.
    let (models, away) = (path.join("models"), path.join("models-away"));
    fs::rename(&models, &away).unwrap();
    fs::write(&models, "").unwrap();
    let state = fit(&studio);
    let words = state.problem.clone().unwrap().text();
    assert!(state.is_unsaved && words.contains("is in the memory of the studio"), "{words}");
    let (name, text) = studio.unsaved_model().unwrap();
    assert!(name.ends_with("-prandtl-ishlinskii.json") && Model::from_json(&text).is_ok());
    assert!(studio.save_again().is_err() && studio.unsaved_model().is_ok());
    fs::remove_file(&models).unwrap();
    fs::rename(&away, &models).unwrap();
    studio.save_again().unwrap();
    let state = studio.fit().unwrap();
    assert_eq!((state.is_unsaved, state.problem, state.made), (false, None, Some(state.id)));
    assert_eq!(fs::read_to_string(models.join(&name)).unwrap(), text);
    assert_eq!(studio.project().unfinished, None);
    assert!(studio.project().models[0].report.is_some() && studio.unsaved_model().is_err());
}

#[test]
fn a_studio_that_was_killed_between_model_and_project_takes_the_finished_model() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = with_specimen(&path);
    let id = fit(&studio).made.unwrap();
    let stored = studio.stored_model(id).unwrap();
    let finished = studio.folder.finished(id);
    studio.end().unwrap();
    drop(studio);
    assert!(!finished.exists());
    let model = path.join("models").join(&stored.file);
    fs::copy(&model, &finished).unwrap();
    fs::write(path.join("models/.best-so-far.json"), "an earlier model").unwrap();
    changed(&path, |project| {
        project["unfinished"] = project["models"][0]["begun"].clone();
        project["models"] = json!([]);
    });
    // A project that cannot be written opens all the same, and keeps what there is.
    let file = path.join("project.json");
    let text = fs::read_to_string(&file).unwrap();
    let field = "\"format\": \"hysid-project\"";
    let elsewhere = text.replacen(&format!("{field},"), "", 1);
    fs::write(&file, format!("{}, {field}}}", elsewhere.trim_end().trim_end_matches('}'))).unwrap();
    let state = opened(&path).fit().unwrap();
    assert!(state.made.is_none() && state.problem.unwrap().text().contains("project.json"));
    fs::write(&file, text).unwrap();
    let studio = opened(&path);
    let project = studio.project().clone();
    assert_eq!(project.models.len(), 1);
    assert_eq!((&project.models[0].file, project.models[0].was_interrupted), (&stored.file, false));
    assert!(project.unfinished.is_none() && !finished.exists());
    let left = fs::read_dir(path.join("models")).unwrap().flatten().map(|entry| entry.file_name());
    assert_eq!(left.filter(|name| name.to_string_lossy().ends_with(".json")).count(), 1);
}

#[test]
fn a_file_without_a_model_is_read_once_until_it_changes() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = with_specimen(&path);
    let id = fit(&studio).made.unwrap();
    let model = studio.model_file(id).unwrap();
    let text = fs::read_to_string(&model).unwrap();
    let simulated = |studio: &Studio| studio.run(id, 1).unwrap();
    let before = simulated(&studio);
    assert!(Arc::ptr_eq(&before, &simulated(&studio)));
    fs::write(&model, "{}").unwrap();
    let problem = shown(&studio)["models"][0]["problem"].as_str().unwrap().to_string();
    assert!(problem.contains(&model.display().to_string()), "{problem}");
    assert!(studio.run(id, 1).is_err());
    let again = || -> Result<String> { panic!("it is read again") };
    assert_eq!(studio.models.of(id, &model, again).unwrap_err().to_string(), problem);
    fs::write(&model, text).unwrap();
    assert!(shown(&studio)["models"][0]["problem"].is_null());
    assert!(!Arc::ptr_eq(&before, &simulated(&studio)));
}

#[test]
fn what_somebody_changed_or_others_wrote_stays_when_it_is_removed_from_the_project() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    let studio = with_specimen(&path);
    let (first, second) = (fit(&studio).made.unwrap(), fit(&studio).made.unwrap());
    let stored = |id: u64| studio.stored_model(id).unwrap();
    let (model, report) = (studio.folder.models(&stored(first).file), stored(first).report.unwrap());
    let report = studio.folder.models(&report);
    fs::write(&model, fs::read_to_string(&model).unwrap().replacen('0', "1", 1)).unwrap();
    fs::write(&report, "<p>mine</p>").unwrap();
    assert_eq!(studio.remove_model(first).unwrap().len(), 2);
    assert!(model.exists() && report.exists());
    let ours =
        [studio.folder.models(&stored(second).file), studio.folder.models(&stored(second).report.unwrap())];
    assert_eq!(studio.remove_model(second).unwrap(), [""; 0]);
    assert!(ours.iter().all(|file| !file.exists()));
    // Data of the same length are other data.
    let data = studio.folder.data("ferromagnet-train.csv");
    let text = fs::read_to_string(&data).unwrap();
    fs::write(&data, text.replace('1', "2")).unwrap();
    assert_eq!(studio.remove_file(1).unwrap(), Some("ferromagnet-train.csv".into()));
    assert_eq!(studio.remove_file(2).unwrap(), None);
    assert!(data.exists() && !studio.folder.data("ferromagnet-test.csv").exists());
    // Both come back: the one that stayed, and the one that was put aside, under a free name if its own is taken.
    fs::write(studio.folder.data("ferromagnet-test.csv"), "mine").unwrap();
    for (id, name) in [(1, "ferromagnet-train.csv"), (2, "ferromagnet-test (2).csv")] {
        studio.undo_removal(id).unwrap();
        assert!(studio.project().file(id).unwrap().name == name && studio.data_of(id).is_ok());
    }
    assert!(studio.undo_removal(1).is_err() && studio.undo_removal(second).is_ok());
    assert!(ours.iter().all(|file| file.exists()) && studio.model(second).is_ok());
}

#[cfg(unix)]
#[test]
fn a_model_that_cannot_be_stored_goes_nowhere_that_a_link_leads_to() {
    let place = tempfile::tempdir().unwrap();
    let (path, other) = (place.path().join("p"), place.path().join("other"));
    let studio = with_specimen(&path);
    fs::create_dir(&other).unwrap();
    fs::remove_dir_all(path.join("models")).unwrap();
    std::os::unix::fs::symlink(&other, path.join("models")).unwrap();
    assert!(fit(&studio).is_unsaved);
    assert_eq!(fs::read_dir(&other).unwrap().count(), 0);
}

#[test]
fn temporary_files_of_killed_studios_go_at_the_next_start() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("p");
    drop(opened(&path));
    let left = [
        ".project.json.AbCdEf12.hysid-partial",
        "models/.1-pnn.json.AbCdEf12.hysid-partial",
        "data/.upload-0123456789abcdef",
        "data/.removed-7-0",
    ];
    left.iter().for_each(|name| fs::write(path.join(name), "half").unwrap());
    fs::write(path.join("models/.mine.hysid-partial"), "mine").unwrap();
    drop(opened(&path));
    assert!(left.iter().all(|name| !path.join(name).exists()));
    assert!(path.join("models/.mine.hysid-partial").exists());
}
