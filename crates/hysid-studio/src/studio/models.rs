//! Models of a project, and their runs over its files.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use hysid::model::Model;
use hysid_app::diagnosis::DiagnosedModel;
use hysid_document::visible::is_hidden;
use hysid_document::{Page, Problem, html};
use hysid_document::{Result, problem};
use hysid_records::Data;
use serde_json::Value;

use super::Studio;
use super::removal::Removed;
use crate::folder::ProjectFolder;
use crate::judgement::Run;
use crate::project::ProjectModel;
use crate::take_away;
use crate::view::read;

/// Longest name of a model.
const LONGEST_NAME: usize = 80;

/// Models that are kept in memory.
const MOST_MODELS: usize = 200;

/// The models of a project that were read, each by the number of its fit.
#[derive(Default)]
pub(super) struct Models(Mutex<HashMap<u64, ReadModel>>);

/// A model, or why its file holds none.
struct ReadModel {
    of: FileStamp,
    model: std::result::Result<Arc<Model>, String>,
}

/// Size and time stamp of a file, which show that it has changed since it was read.
#[derive(PartialEq)]
struct FileStamp {
    bytes: u64,
    changed: Option<SystemTime>,
}

impl FileStamp {
    fn of(path: &Path) -> Option<Self> {
        let found = fs::symlink_metadata(path).ok()?;
        Some(Self { bytes: found.len(), changed: found.modified().ok() })
    }
}

impl Models {
    fn kept(&self) -> MutexGuard<'_, HashMap<u64, ReadModel>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The model of a file, which is read once, also if it holds none.
    pub fn of(&self, id: u64, path: &Path, text: impl FnOnce() -> Result<String>) -> Result<Arc<Model>> {
        let state = FileStamp::of(path);
        if let Some(known) = self.kept().get(&id).filter(|known| Some(&known.of) == state.as_ref()) {
            return known.model.clone().map_err(Problem::from);
        }
        let parsed =
            |text: String| Model::from_json(&text).map_err(|error| problem!("{}: {error}", path.display()));
        let model = text().and_then(parsed).map(Arc::new).map_err(|error| error.to_string());
        let mut kept = self.kept();
        if kept.len() >= MOST_MODELS {
            kept.clear();
        }
        if let Some(of) = state {
            kept.insert(id, ReadModel { of, model: model.clone() });
        }
        model.map_err(Problem::from)
    }
}

impl Studio {
    pub fn model(&self, id: u64) -> Result<Arc<Model>> {
        let path = self.model_file(id)?;
        self.models.of(id, &path, || self.text(&path))
    }

    pub fn stored_model(&self, id: u64) -> Result<ProjectModel> {
        self.project().model(id).cloned()
    }

    pub fn model_file(&self, id: u64) -> Result<PathBuf> {
        Ok(self.folder.models(&self.project().model(id)?.file))
    }

    /// The text of a model's report.
    pub fn report(&self, id: u64) -> Result<String> {
        let report = self.project().model(id)?.report.clone();
        let report = report.ok_or_else(|| {
            problem!("this model has no report: the fit was interrupted, or the report could not be written")
        })?;
        let path = self.folder.models(&report);
        self.text(&path)
    }

    fn text(&self, path: &Path) -> Result<String> {
        String::from_utf8(self.folder.read(path)?).map_err(|_| problem!("{}: is no text", path.display()))
    }

    /// Removes a model from the project. Gives the names of its files that stay in the folder, because Hysid did not write
    /// them or somebody changed them.
    pub fn remove_model(&self, id: u64) -> Result<Vec<String>> {
        let (removed, place) = self.change(|project| {
            let place = project.place_of_model(id)?;
            Ok((project.models.remove(place), place))
        })?;
        self.keep_removed(Removed::Model(Box::new(removed.clone()), place));
        let aside = |part| self.folder.removed(ProjectFolder::Models, id, part);
        let text = |file| hysid_files::read_from("", file).map_err(io::Error::other);
        let is_model = |file| {
            let text = String::from_utf8(text(file)?);
            Ok(text.is_ok_and(|text| Model::from_json(&text).is_ok()))
        };
        let mut kept = Vec::new();
        if self.folder.set_aside_if(&self.folder.models(&removed.file), &aside(0), is_model) {
            kept.push(removed.file);
        }
        if let Some(report) = removed.report {
            let is_page = |file| Ok(hysid_files::is_page_as_written(&text(file)?));
            if self.folder.set_aside_if(&self.folder.models(&report), &aside(1), is_page) {
                kept.push(report);
            }
        }
        self.models.kept().remove(&id);
        self.runs.clear();
        Ok(kept)
    }

    /// Gives a model a name; without one, its name says what it is.
    pub fn rename_model(&self, id: u64, name: &str) -> Result<()> {
        let name: String = name.chars().filter(|letter| !is_hidden(*letter)).take(LONGEST_NAME).collect();
        let name = Some(name.trim().to_string()).filter(|name| !name.is_empty());
        self.change(|project| {
            let place = project.place_of_model(id)?;
            project.models[place].name = name;
            Ok(())
        })
    }

    /// The free run of a model over a file.
    pub fn run(&self, model: u64, file: u64) -> Result<Arc<Run>> {
        let fitted = self.model(model)?;
        self.runs.of(&fitted, file, || {
            let (stored, file, reading) = {
                let project = self.project();
                let file = project.file(file)?.clone();
                (project.model(model)?.clone(), file, project.understanding.reading.clone())
            };
            let table = read(&file, &self.folder, &reading.reading()?)?;
            let columns = stored.columns_in(&fitted, &table, &file);
            let data = Data::of_model(vec![table], &fitted, &columns, reading.zero)?;
            Run::of(&fitted, data.set)
        })
    }

    /// Facts of a model, as HTML.
    pub fn facts(&self, id: u64) -> Result<String> {
        let (model, path) = (self.model(id)?, self.model_file(id)?);
        let file = PathBuf::from(path.file_name().unwrap_or_default());
        let page: Page = DiagnosedModel::of(&file, &model)?.page();
        Ok(html::parts(&page.parts))
    }

    /// The lines that make a model without the studio.
    pub fn lines(&self, id: u64) -> Result<Value> {
        Ok(take_away::lines(&self.stored_model(id)?, &*self.model(id)?, self.folder.root()))
    }
}
