//! A studio: a project, its files as they are read, its models and its fit. It computes what the server sends to
//! the page.

mod files;
mod fits;
mod models;
mod removal;
#[cfg(test)]
mod tests;
mod use_cases;

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, RwLock};

use hysid_document::{Problem, Result};
use serde_json::Value;
use tokio::sync::watch;

use crate::example::Example;
use crate::fitting::Fits;
use crate::folder::Folder;
use crate::judgement::Runs;
use crate::project::{Project, ProjectModel};
use crate::shown::shown;
use crate::view::{AtHand, View};
pub use files::CyclesAsked;
use fits::Found;
use models::Models;
pub use use_cases::{ForceAsked, InverseAsked, PlanAsked, limits};

pub struct Studio {
    folder: Folder,
    /// Held for moments: no table is read and nothing is computed meanwhile.
    project: Mutex<Project>,
    /// The files as they were read last, perhaps those of an earlier project. Held for moments.
    view: RwLock<Arc<View>>,
    /// Held while files are read, so that each is read once.
    reading: Mutex<()>,
    fits: Fits,
    /// A model that could not be stored.
    unsaved: Mutex<Option<Found>>,
    /// Held while a fit begins, so that two requests do not begin two.
    beginning: Mutex<()>,
    runs: Runs,
    models: Models,
    removed: Mutex<Vec<removal::Removed>>,
    example: OnceLock<std::result::Result<Arc<Example>, String>>,
    /// Numbers of changes: of the project, and of the fit.
    news: watch::Sender<News>,
}

/// How often something has changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct News {
    pub project: u64,
    pub fit: u64,
}

impl Studio {
    /// Opens the project of a folder. A fit that did not come to its end leaves its best model so far. No file with data
    /// is read before that is needed.
    pub fn open(folder: Folder) -> Result<Self> {
        let project = Project::of(&folder)?;
        let studio = Self {
            folder,
            project: Mutex::new(project),
            view: RwLock::default(),
            reading: Mutex::default(),
            fits: Fits::default(),
            unsaved: Mutex::default(),
            beginning: Mutex::default(),
            runs: Runs::default(),
            models: Models::default(),
            removed: Mutex::default(),
            example: OnceLock::new(),
            news: watch::Sender::new(News::default()),
        };
        // On a full disk the project opens all the same, and the page says so.
        drop(studio.take_up_the_unfinished());
        Ok(studio)
    }

    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    pub fn news(&self) -> watch::Receiver<News> {
        self.news.subscribe()
    }

    fn project(&self) -> MutexGuard<'_, Project> {
        self.project.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn removed(&self) -> MutexGuard<'_, Vec<removal::Removed>> {
        self.removed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The example of the first page, which is computed once.
    pub fn example(&self) -> Result<Arc<Example>> {
        let made =
            self.example.get_or_init(|| Example::new().map(Arc::new).map_err(|error| error.to_string()));
        made.clone().map_err(Problem::from)
    }

    fn view(&self) -> Arc<View> {
        Arc::clone(&self.view.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn show(&self, view: View) {
        *self.view.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(view);
        self.news.send_modify(|news| news.project += 1);
    }

    /// Reads the files of the project that are not read with its present choices.
    pub fn read_files(&self) {
        self.read_files_with(None);
    }

    fn read_files_with(&self, at_hand: AtHand) {
        let _reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        let (project, before) = (self.project().clone(), self.view());
        if !before.is_of(&project) {
            self.show(View::of(&project, &self.folder, &before, at_hand, &|so_far| self.show(so_far)));
            self.runs.clear();
        }
    }

    /// The project, and its files read with its choices. Waits until they are.
    fn current(&self) -> (Project, Arc<View>) {
        loop {
            let (project, view) = (self.project().clone(), self.view());
            if view.is_of(&project) {
                return (project, view);
            }
            self.read_files();
        }
    }

    /// Changes the project and stores it. Nothing is changed if it cannot be stored.
    fn change<T>(&self, change: impl FnOnce(&mut Project) -> Result<T>) -> Result<T> {
        let mut project = self.project();
        let mut changed = project.clone();
        let result = change(&mut changed)?;
        self.folder.write_project(&changed.text())?;
        *project = changed;
        drop(project);
        self.news.send_modify(|news| news.project += 1);
        Ok(result)
    }

    /// Changes the project and what its files are read as, and reads them.
    fn change_reading(&self, change: impl FnOnce(&mut Project) -> Result<()>) -> Result<()> {
        self.change(change)?;
        self.read_files();
        Ok(())
    }

    /// The whole state, as the page shows it.
    pub fn shown(&self) -> Value {
        let project = self.project().clone();
        let model = |stored: &ProjectModel| self.model(stored.begun.id);
        shown(&project, &self.folder, &self.view(), self.fits.state(), model, self.news.borrow().project)
    }

    /// Holds up the reading of files.
    #[cfg(test)]
    pub(crate) fn being_read(&self) -> MutexGuard<'_, ()> {
        self.reading.lock().unwrap()
    }

    #[cfg(test)]
    pub(crate) fn forget_view(&self) {
        self.show(View::default());
    }
}
