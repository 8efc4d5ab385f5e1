//! Fits to the training data, and what is kept of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Result, anyhow, bail};
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::chosen::NamedOptions;
use hysid_files::Kind;
use hysid_records::{Data, Usage};
use hysid_report::{Beforehand, Identified, date, origin, page_text};

use super::Studio;
use crate::fitting::{FitState, Preview, Work};
use crate::folder::Inner;
use crate::project::{Begun, ChosenColumns, FitRequest, ProjectModel, Use};

impl Studio {
    /// Begins a fit to the training data.
    ///
    /// # Errors
    /// A request that is not valid, or not for these data; another fit that is running.
    pub fn begin_fit(self: &Arc<Self>, request: FitRequest) -> Result<u64> {
        let _only = self.beginning.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if self.fits.state().is_some_and(|state| state.is_running) {
            bail!("a fit is running: stop it, or wait until it ends");
        }
        if request.time_limit.is_some_and(|limit| !(limit > 0.0 && limit.is_finite() && limit <= 1e9)) {
            return Err(
                Usage("--time-limit: a number of seconds above 0, at most 1e9, is needed".into()).into()
            );
        }
        let request = request.with_values()?;
        let data = self.training_data()?;
        let spec = self.spec(&request, &data)?;
        // What can be refused is refused before anything is stored.
        let beforehand = Beforehand::of(&data, &spec)?;
        let best = self.folder.best_so_far();
        self.folder.remove(&best);
        let begun = self.change(|project| {
            let id = project.next_id();
            let files = project.files_for(Use::Training).map(|file| file.name.clone()).collect();
            let understanding = project.understanding.clone();
            let columns = ChosenColumns::of(&data.roles);
            let begun = Begun { id, request, files, understanding, columns };
            project.unfinished = Some(begun.clone());
            Ok(begun)
        })?;
        let id = begun.id;
        let file = self.project().files_for(Use::Training).next().map_or(0, |file| file.id);
        let time_limit = begun.request.time_limit;
        let (finishing, telling, keeping) = (Arc::clone(self), Arc::clone(self), Arc::clone(self));
        let keep = Box::new(move |model: &Model| {
            let folder = &keeping.folder;
            drop(folder.write(&folder.best_so_far(), Kind::Model, model.to_json().as_bytes()));
        });
        let work = Work { id, request: spec, data, beforehand, file, time_limit, keep };
        let finish = Box::new(move |identified: Identified, data: &Data| {
            finishing.take_model(begun, &identified, data).map(|()| id)
        });
        let tell = Arc::new(move || telling.news.send_modify(|news| news.fit += 1));
        let begun = self.fits.begin(work, finish, tell);
        if begun.is_err() {
            self.forget_the_unfinished();
        }
        begun.map(|()| id)
    }

    /// What a request asks for.
    fn spec(&self, request: &FitRequest, data: &Data) -> Result<FitSpec> {
        let chosen = NamedOptions::of(request.options.clone()).map_err(|error| Usage(error.to_string()))?;
        request.rate(&self.project().understanding)?.request(&chosen, &data.set)
    }

    /// Ends the fit with its best model so far.
    pub fn stop_fit(&self) {
        self.fits.stop();
    }

    /// The fit.
    pub fn fit(&self) -> Option<FitState> {
        self.fits.state()
    }

    /// What the best model so far simulates.
    pub fn preview(&self) -> Option<Preview> {
        self.fits.preview()
    }

    /// Ends everything: the fit stops with its best model so far, which is saved.
    pub fn end(&self) {
        self.fits.end();
    }

    /// Saves what a fit has found. If that fails, the model is put elsewhere, and the error says where.
    fn take_model(&self, begun: Begun, identified: &Identified, data: &Data) -> Result<()> {
        let text = identified.model.to_json();
        // From here on a studio that is killed finds this model, and not an earlier one.
        let best = self.folder.best_so_far();
        let _ = self.folder.write(&best, Kind::Model, text.as_bytes());
        self.store_model(begun, identified, data, &text).map_err(|error| {
            let named = self.folder.models(&format!("{}.json", identified.model.name().name()));
            match hysid_files::rescue(&named, text.as_bytes()) {
                Some(place) => anyhow!("{error:#}; the model is in {}", place.display()),
                None => error,
            }
        })?;
        self.folder.remove(&best);
        Ok(())
    }

    fn store_model(&self, begun: Begun, identified: &Identified, data: &Data, text: &str) -> Result<()> {
        let stem = format!("{}-{}", begun.id, identified.model.name().name());
        let file = self.folder.free_name(Inner::Models, &format!("{stem}.json"))?;
        let report = self.folder.free_name(Inner::Models, &format!("{stem}.html"))?;
        self.folder.write(&self.folder.models(&file), Kind::Model, text.as_bytes())?;
        // A model is worth more than its report.
        let report = self.write_report(&report, &file, identified, data, &begun).is_ok().then_some(report);
        let stored = ProjectModel {
            begun,
            file,
            report,
            made: date::now(),
            seconds: identified.seconds,
            was_interrupted: false,
        };
        self.keep(stored)
    }

    /// Stores a model, with which its fit is no longer unfinished.
    fn keep(&self, stored: ProjectModel) -> Result<()> {
        self.change(|project| {
            project.unfinished = None;
            project.models.push(stored);
            Ok(())
        })
    }

    fn write_report(
        &self,
        report: &str,
        file: &str,
        identified: &Identified,
        data: &Data,
        begun: &Begun,
    ) -> Result<()> {
        let trained = identified.model.as_trained(&data.set)?;
        let mut page = identified.page(Path::new(file), &[("training", trained.as_ref())])?;
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

    /// Keeps the best model of a fit that an earlier studio did not bring to its end, and says so.
    pub(super) fn take_up_the_unfinished(&self) -> Result<()> {
        let Some(begun) = self.project().unfinished.clone() else { return Ok(()) };
        let chosen = NamedOptions::of(begun.request.options.clone()).unwrap_or_default();
        let best = self.folder.best_so_far();
        let text = self.folder.read(&best).ok().and_then(|content| String::from_utf8(content).ok());
        let model = text.as_ref().and_then(|text| Model::from_json(text).ok());
        let mut state = FitState::begun(begun.id, &FitSpec::of(chosen.model(), None, 1));
        state.is_running = false;
        state.was_interrupted = true;
        let words = "the studio was closed";
        match model {
            Some(model) => {
                let id = begun.id;
                let file = format!("{id}-{}.json", model.name().name());
                let file = self.folder.free_name(Inner::Models, &file)?;
                self.folder.write(
                    &self.folder.models(&file),
                    Kind::Model,
                    text.unwrap_or_default().as_bytes(),
                )?;
                let stored = ProjectModel {
                    begun,
                    file,
                    report: None,
                    made: date::now(),
                    seconds: 0.0,
                    was_interrupted: true,
                };
                self.keep(stored)?;
                self.folder.remove(&best);
                state.made = Some(id);
                state.problem = Some(format!("{words} during this fit; the best model so far was kept"));
            }
            None => {
                self.forget_the_unfinished();
                state.problem = Some(format!("{words} before this fit had a model: start it again"));
            }
        }
        self.fits.interrupted(state);
        Ok(())
    }
}
