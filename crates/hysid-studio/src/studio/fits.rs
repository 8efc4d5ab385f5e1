//! Fits to the training data, and what is kept of them.

use std::path::{Path, PathBuf};
use std::sync::{Arc, MutexGuard, PoisonError};

use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::chosen::NamedOptions;
use hysid_app::{Beforehand, Identified, date, origin, page_text};
use hysid_document::{Face, Problem, Result, problem};
use hysid_files::Kind;
use hysid_records::Data;

use super::Studio;
use crate::fitting::{Finish, FitEnd, FitPreview, FitState, FitWork, caught, is_running};
use crate::folder::ProjectFolder;
use crate::project::{Begun, ChosenColumns, FitRequest, ProjectModel, Use};
use crate::words::said;

/// Result of a fit, until it is stored.
pub struct Found {
    begun: Begun,
    identified: Identified,
    data: Arc<Data>,
    /// The text of the model's file.
    text: String,
    /// A copy in another place, if there was room.
    rescued: Option<PathBuf>,
}

impl Studio {
    /// Begins a fit to the training data.
    ///
    /// # Errors
    /// A request that is not valid, or not for these data; another fit that is running.
    pub fn begin_fit(self: &Arc<Self>, request: FitRequest) -> Result<u64> {
        let _only = self.beginning.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if self.fits.state().is_some_and(|state| state.is_running) {
            return Err(is_running());
        }
        let limit = request.time_limit.map(hysid::time_limit).transpose();
        limit.map_err(|needed| Problem::option("time_limit", needed))?;
        self.save_again()
            .and_then(|()| self.take_up_the_unfinished())
            .map_err(|problem| problem.within("the model of the last fit cannot be stored"))?;
        let request = request.with_values()?;
        let (seen, view) = self.current();
        let data = self.training_data()?;
        let spec = self.spec(&request, &data)?;
        let renamed = seen
            .files_for(Use::Training)
            .filter(|file| view.is_renamed(file.id))
            .map(|file| file.name.clone());
        let renamed: Vec<String> = renamed.collect();
        // What can be refused is refused before anything is stored.
        let beforehand = Beforehand::of(&data, &spec, Face::Studio)?;
        let best = self.folder.best_so_far();
        self.folder.remove(&best);
        let begun = self.change(|project| {
            if project.files != seen.files || project.understanding != seen.understanding {
                return Err(problem!("the files or their reading changed meanwhile: start the fit again"));
            }
            let id = project.next_id();
            let files = project.files_for(Use::Training).map(|file| file.name.clone()).collect();
            let understanding = project.understanding.clone();
            let columns = ChosenColumns::of(&data.roles);
            let of_files = project.columns_of_files();
            let begun = Begun { id, request, files, understanding, columns, of_files, renamed };
            project.unfinished = Some(begun.clone());
            Ok(begun)
        })?;
        let id = begun.id;
        let file = self.project().files_for(Use::Training).next().map_or(0, |file| file.id);
        let time_limit = begun.request.time_limit;
        let (finishing, keeping, news) = (Arc::clone(self), Arc::clone(self), self.news.clone());
        let keep = Box::new(move |model: &Model| {
            let folder = &keeping.folder;
            drop(folder.write(&folder.best_so_far(), Kind::Model, model.to_json().as_bytes()));
        });
        let work = FitWork { id, request: spec, data, beforehand, file, time_limit, keep };
        let finish: Finish = Box::new(move |found| match found {
            Ok((identified, data)) => {
                let text = identified.model.to_json();
                finishing.take_model(Found { begun, identified, data, text, rescued: None })
            }
            Err(problem) => FitEnd::Failed(finishing.keep_the_best(problem)),
        });
        let tell = Arc::new(move || news.send_modify(|news| news.fit += 1));
        let begun = self.fits.begin(work, finish, tell);
        if begun.is_err() {
            self.forget_the_unfinished();
        }
        begun.map(|()| id)
    }

    fn spec(&self, request: &FitRequest, data: &Data) -> Result<FitSpec> {
        let chosen =
            NamedOptions::of(request.options.clone()).map_err(|error| Problem::request(error.to_string()))?;
        request.rate(&self.project().understanding)?.request(&chosen, &data.set)
    }

    /// Ends the fit with its best model so far.
    pub fn stop_fit(&self) {
        self.fits.stop();
    }

    pub fn fit(&self) -> Option<FitState> {
        self.fits.state()
    }

    /// Simulation of the best model so far.
    pub fn preview(&self) -> Option<FitPreview> {
        self.fits.preview()
    }

    /// Ends everything: the fit stops with its best model so far, which is saved.
    ///
    /// # Errors
    /// A model that cannot be stored; the error names the place of a copy.
    pub fn end(&self) -> Result<()> {
        self.folder.end_readings();
        self.forget_removed();
        self.fits.end();
        self.save_again().map_err(|problem| {
            let place = self.unsaved().as_ref().and_then(|found| found.rescued.clone());
            let place = place.map_or_else(|| "lost".into(), |place| format!("in {}", place.display()));
            Problem::Other(problem.words() + format!("; the model is {place}"))
        })
    }

    /// Saves what a fit has found. If that fails, it stays in memory, and a copy is put elsewhere if there is room.
    fn take_model(&self, found: Found) -> FitEnd {
        let id = found.begun.id;
        // From here on a studio that is killed finds this model, and not an earlier one.
        let _ = self.folder.write(&self.folder.finished(id), Kind::Model, found.text.as_bytes());
        let Err(problem) = self.store_model(&found) else { return FitEnd::Stored(id) };
        // Beside the file of the project: the folder of models may be what cannot be written to, or a link elsewhere.
        let named = self.folder.root().join(format!("{}.json", found.identified.model.name().name()));
        let rescued = hysid_files::rescue(&named, found.text.as_bytes());
        let place = rescued.as_ref().map_or_else(String::new, |place| format!(" and in {}", place.display()));
        *self.unsaved() = Some(Found { rescued, ..found });
        let place = format!("; the model is in the memory of the studio{place}");
        FitEnd::Unsaved(Problem::Other(problem.words() + place))
    }

    /// Stores the model that could not be stored at the end of its fit.
    pub fn save_again(&self) -> Result<()> {
        let mut unsaved = self.unsaved();
        let Some(found) = &*unsaved else { return Ok(()) };
        self.store_model(found)?;
        // The file of the project is as good as this copy, which nobody asked for.
        found.rescued.iter().for_each(|copy| drop(std::fs::remove_file(copy)));
        self.fits.saved(found.begun.id);
        *unsaved = None;
        Ok(())
    }

    /// Name and text of the model that could not be stored.
    pub fn unsaved_model(&self) -> Result<(String, String)> {
        let unsaved = self.unsaved();
        let found = unsaved.as_ref().ok_or_else(|| problem!("all models are stored"))?;
        Ok((format!("{}.json", found.stem()), found.text.clone()))
    }

    fn unsaved(&self) -> MutexGuard<'_, Option<Found>> {
        self.unsaved.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores a model with its report, the project last.
    fn store_model(&self, found: &Found) -> Result<()> {
        let file = self.place_model(found.begun.id, &found.identified.model, &found.text)?;
        // A model is worth more than its report.
        let report = self.folder.free_name(ProjectFolder::Models, &format!("{}.html", found.stem()))?;
        let written = caught(|| self.write_report(&report, &file, found));
        self.keep(ProjectModel {
            begun: found.begun.clone(),
            file,
            report: written.is_ok().then_some(report),
            made: date::now(),
            seconds: found.identified.seconds.unwrap_or_default(),
            was_interrupted: false,
            name: None,
        })
    }

    /// Writes the file of a model unless it is there already, and gives its name.
    fn place_model(&self, fit: u64, model: &Model, text: &str) -> Result<String> {
        let file = format!("{}.json", stem(fit, model));
        let path = self.folder.models(&file);
        let is_named = self.project().models.iter().any(|stored| stored.file == file);
        if !is_named && self.folder.read(&path).is_ok_and(|there| there == text.as_bytes()) {
            return Ok(file);
        }
        let file = self.folder.free_name(ProjectFolder::Models, &file)?;
        self.folder.write(&self.folder.models(&file), Kind::Model, text.as_bytes())?;
        Ok(file)
    }

    /// Stores a model, with which its fit is no longer unfinished.
    fn keep(&self, stored: ProjectModel) -> Result<()> {
        let fit = stored.begun.id;
        self.change(|project| {
            project.unfinished = None;
            project.models.push(stored);
            Ok(())
        })?;
        self.folder.remove(&self.folder.finished(fit));
        self.folder.remove(&self.folder.best_so_far());
        Ok(())
    }

    fn write_report(&self, report: &str, file: &str, found: &Found) -> Result<()> {
        let Found { begun, identified, data, .. } = found;
        let trained = identified.model.as_trained(&data.set)?;
        let title = file.strip_suffix(".json").unwrap_or(file);
        let sets = [("training", trained.as_ref())];
        let mut page = identified.page(Some(title), Some(Path::new(file)), &sets)?;
        let inputs: Vec<PathBuf> = begun.files.iter().map(|file| self.folder.data(file)).collect();
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        page.parts.push(origin::section("hysid studio", &inputs));
        self.folder.write(&self.folder.models(report), Kind::Page, page_text(&page).as_bytes())
    }

    fn forget_the_unfinished(&self) {
        let forgotten = self.change(|project| {
            project.unfinished = None;
            Ok(())
        });
        // The folder could be written to a moment ago; the next change tells if it no longer can.
        drop(forgotten);
    }

    /// Keeps the best model so far of a fit that ends without a model, and reports it.
    fn keep_the_best(&self, problem: Problem) -> Problem {
        let Some(begun) = self.project().unfinished.clone() else { return problem };
        match self.model_in(&self.folder.best_so_far()) {
            Some((model, text)) if self.keep_unfinished(begun, &model, &text, true).is_ok() => {
                problem.within("the best model so far was kept")
            }
            _ => {
                self.forget_the_unfinished();
                problem
            }
        }
    }

    /// A model in a file, with its text.
    fn model_in(&self, path: &Path) -> Option<(Model, String)> {
        let text = String::from_utf8(self.folder.read(path).ok()?).ok()?;
        Some((Model::from_json(&text).ok()?, text))
    }

    /// Keeps the model of a fit that was not stored at its end.
    fn keep_unfinished(&self, begun: Begun, model: &Model, text: &str, was_interrupted: bool) -> Result<()> {
        let file = self.place_model(begun.id, model, text)?;
        self.keep(ProjectModel {
            begun,
            file,
            report: None,
            made: date::now(),
            seconds: 0.0,
            was_interrupted,
            name: None,
        })
    }

    /// Keeps the model of a fit that an earlier studio did not bring to its end, and reports it.
    ///
    /// # Errors
    /// It cannot be stored; it stays where it is.
    pub(super) fn take_up_the_unfinished(&self) -> Result<()> {
        let Some(begun) = self.project().unfinished.clone() else { return Ok(()) };
        let chosen = NamedOptions::of(begun.request.options.clone()).unwrap_or_default();
        let mut state = FitState::begun(begun.id, &FitSpec::of(chosen.model(), None, 1));
        state.is_running = false;
        let taken = self.take_up(begun, &mut state);
        if let Err(error) = &taken {
            state.problem = Some(said(error));
        }
        self.fits.taken_up(state);
        taken
    }

    fn take_up(&self, begun: Begun, state: &mut FitState) -> Result<()> {
        let id = begun.id;
        if let Some((model, text)) = self.model_in(&self.folder.finished(id)) {
            self.keep_unfinished(begun, &model, &text, false)?;
            state.made = Some(id);
            return Ok(());
        }
        state.was_interrupted = true;
        let words = "the studio was closed";
        let Some((model, text)) = self.model_in(&self.folder.best_so_far()) else {
            self.forget_the_unfinished();
            state.problem = Some(format!("{words} before this fit had a model: start it again").into());
            return Ok(());
        };
        self.keep_unfinished(begun, &model, &text, true)?;
        state.made = Some(id);
        state.problem = Some(format!("{words} during this fit; the best model so far was kept").into());
        Ok(())
    }
}

impl Found {
    /// Begins the names of its files.
    fn stem(&self) -> String {
        stem(self.begun.id, &self.identified.model)
    }
}

fn stem(fit: u64, model: &Model) -> String {
    format!("{fit}-{}", model.name().name())
}
