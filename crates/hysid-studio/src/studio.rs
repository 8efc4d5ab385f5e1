//! A studio: a project, its files as they are read, its models and its fit. What a page asks for is answered here; how it
//! asks is the server's matter.

mod files;
mod fits;
mod models;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, RwLock};

use anyhow::Result;
use hysid::model::Model;
use tokio::sync::watch;

use crate::fitting::Fits;
use crate::folder::Folder;
use crate::judgement::Runs;
use crate::project::{Project, ProjectModel};
use crate::shown::Shown;
use crate::view::View;

/// A studio.
pub struct Studio {
    folder: Folder,
    project: Mutex<Project>,
    view: RwLock<Arc<View>>,
    fits: Fits,
    /// Held while a fit begins, so that two requests do not begin two.
    beginning: Mutex<()>,
    runs: Runs,
    models: Mutex<HashMap<u64, Arc<Model>>>,
    /// Numbers of changes: of the project, and of the fit.
    news: watch::Sender<News>,
}

/// How often something has changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct News {
    /// Of the project.
    pub project: u64,
    /// Of the fit.
    pub fit: u64,
}

impl Studio {
    /// Opens the project of a folder. A fit that did not come to its end leaves its best model so far.
    ///
    /// # Errors
    /// A project that cannot be read.
    pub fn open(folder: Folder) -> Result<Self> {
        let project = Project::of(&folder)?;
        let view = View::of(&project, &folder, &View::default());
        let studio = Self {
            folder,
            project: Mutex::new(project),
            view: RwLock::new(Arc::new(view)),
            fits: Fits::default(),
            beginning: Mutex::default(),
            runs: Runs::default(),
            models: Mutex::default(),
            news: watch::Sender::new(News::default()),
        };
        studio.take_up_the_unfinished()?;
        Ok(studio)
    }

    /// The folder of the project.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Subscribes to changes.
    pub fn news(&self) -> watch::Receiver<News> {
        self.news.subscribe()
    }

    fn project(&self) -> MutexGuard<'_, Project> {
        self.project.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn view(&self) -> Arc<View> {
        Arc::clone(&self.view.read().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }

    /// Changes the project, stores it, and reads its files again where that is needed. Nothing is changed if it cannot be
    /// stored.
    fn change<T>(&self, change: impl FnOnce(&mut Project) -> Result<T>) -> Result<T> {
        let mut project = self.project();
        let mut changed = project.clone();
        let result = change(&mut changed)?;
        self.folder.write_project(&changed.text())?;
        let is_read_again = changed.files != project.files || changed.understanding != project.understanding;
        *project = changed;
        if is_read_again {
            let view = View::of(&project, &self.folder, &self.view());
            *self.view.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = Arc::new(view);
            self.runs.clear();
        }
        drop(project);
        self.news.send_modify(|news| news.project += 1);
        Ok(result)
    }

    /// The whole state, as the page shows it.
    pub fn shown(&self) -> Shown {
        let project = self.project().clone();
        let model = |stored: &ProjectModel| self.model(stored.begun.id).ok();
        Shown::of(&project, &self.folder, &self.view(), self.fits.state(), model, self.news.borrow().project)
    }
}
