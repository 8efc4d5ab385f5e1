//! A studio: a project, its files as they are read, its models and its fit. What a page asks for is answered here; how it
//! asks is the server's matter.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, RwLock};

use anyhow::{Context, Result, anyhow, bail};
use hysid::data::record::Dataset;
use hysid::data::summary::Summary;
use hysid::diagnosis::before_a_fit;
use hysid::diagnosis::{DataIssue, Diagnosis, DiagnosisOptions};
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::chosen::NamedOptions;
use hysid::specimens::{Specimen, with_noise};
use hysid_document::{Page, html};
use hysid_files::Kind;
use hysid_records::{ColumnChoice, Data, ReadingChoice, Roles, Usage, csv_text, summarised, understanding};
use hysid_report::diagnosis::{DataDiagnosis, DiagnosedModel};
use hysid_report::{Beforehand, Identified, date, origin, page_text};
use serde::Serialize;
use tokio::sync::watch;

use crate::fitting::{FitState, Fits, Preview, Work};
use crate::folder::{Folder, safe_name, write};
use crate::judgement::{Run, Runs};
use crate::project::{Begun, ChosenColumns, FitRequest, Project, ProjectFile, ProjectModel, Use};
use crate::shown::Shown;
use crate::take_away::Lines;
use crate::view::{View, read_named};

/// Most files of a project.
const MOST_FILES: usize = 200;

/// What may be wrong with data.
#[derive(Debug, Serialize)]
pub struct Findings {
    /// What a fit warns of.
    warnings: Vec<String>,
    /// What the diagnosis finds, with the rows that show it.
    issues: Vec<DataIssue>,
}

/// Models that are kept in memory.
const MOST_MODELS: usize = 20;

/// A studio.
pub struct Studio {
    folder: Folder,
    project: Mutex<Project>,
    view: RwLock<Arc<View>>,
    fits: Fits,
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

    /// Hears of changes.
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

    // Files.

    /// Where a file with this name that comes in is put, before it is [taken](Self::take_file).
    pub fn place_for_upload(&self) -> Result<PathBuf> {
        if self.project().files.len() >= MOST_FILES {
            bail!("a project has at most {MOST_FILES} files: remove some that are not used");
        }
        let mut random = [0; 8];
        getrandom::fill(&mut random).map_err(|error| anyhow!("no random name: {error}"))?;
        Ok(self.folder.data(&format!(".upload-{:016x}", u64::from_le_bytes(random))))
    }

    /// Takes a file that lies at a place of an upload.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn take_file(&self, given: &str, place: &Path, usage: Use) -> Result<u64> {
        let bytes = fs::metadata(place).map_or(0, |metadata| metadata.len());
        self.change(|project| {
            let taken: Vec<&str> = project.files.iter().map(|file| file.name.as_str()).collect();
            let name = safe_name(given, &taken);
            fs::rename(place, self.folder.data(&name))
                .map_err(|error| anyhow!("{name}: cannot be stored: {}", hysid_files::reason(&error)))?;
            let id = project.next_id();
            project.files.push(ProjectFile { id, name, bytes, usage });
            Ok(id)
        })
    }

    /// Takes a file with this content.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn take_content(&self, given: &str, content: &[u8], usage: Use) -> Result<u64> {
        let place = self.place_for_upload()?;
        fs::write(&place, content)
            .map_err(|error| anyhow!("{given}: cannot be stored: {}", hysid_files::reason(&error)))?;
        self.take_file(given, &place, usage)
    }

    /// Takes a copy of a file of the user, unless the project has the same already.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn take_path(&self, path: &Path) -> Result<()> {
        let content = fs::read(path).map_err(|error| {
            anyhow!("{}: cannot be read: {}", path.display(), hysid_files::reason(&error))
        })?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_known = |file: &ProjectFile| {
            file.name == name && fs::read(self.folder.data(&file.name)).is_ok_and(|known| known == content)
        };
        if self.project().files.iter().any(is_known) {
            return Ok(());
        }
        let usage = self.usage_of_next();
        self.take_content(&name, &content, usage).map(drop)
    }

    /// What the next file is for: the first are for training; once there is a model, a file is unseen.
    pub fn usage_of_next(&self) -> Use {
        if self.project().models.is_empty() { Use::Training } else { Use::Unseen }
    }

    /// Removes a file.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn remove_file(&self, id: u64) -> Result<()> {
        self.change(|project| {
            let name = project.file(id)?.name.clone();
            project.files.retain(|file| file.id != id);
            // A model that was made of it keeps its line; the file itself is the user's copy.
            let _ = fs::remove_file(self.folder.data(&name));
            Ok(())
        })
    }

    /// Says what a file is for.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn use_file(&self, id: u64, usage: Use) -> Result<()> {
        self.change(|project| {
            project.file(id)?;
            project.files.iter_mut().filter(|file| file.id == id).for_each(|file| file.usage = usage);
            Ok(())
        })
    }

    /// Takes the training and the test data of a specimen.
    ///
    /// # Errors
    /// No specimen of this name; a noise that is none.
    pub fn take_specimen(&self, name: &str, seed: u64, noise_percent: f64) -> Result<Vec<u64>> {
        let specimen = Specimen::named(name).ok_or_else(|| anyhow!("there is no specimen \"{name}\""))?;
        // As of `hysid generate`: test data have a noise of their own.
        let sets = [
            (format!("{name}-train.csv"), specimen.train(), seed, Use::Training),
            (format!("{name}-test.csv"), specimen.test(), !seed, Use::Unseen),
        ];
        let take = |(name, data, seed, usage): (String, Dataset, u64, Use)| {
            let text = csv_text(&with_noise(&data, noise_percent, seed)?)?;
            self.take_content(&name, text.as_bytes(), usage)
        };
        sets.into_iter().map(take).collect()
    }

    /// Says how tables are read.
    ///
    /// # Errors
    /// A value that is not valid.
    pub fn read_as(&self, reading: ReadingChoice) -> Result<()> {
        reading.reading()?;
        self.change(|project| {
            project.understanding.reading = reading;
            Ok(())
        })
    }

    /// Says which columns are what; `None` to guess.
    ///
    /// # Errors
    /// Columns that the training files do not have, or one with two roles. Nothing is then changed.
    pub fn choose_columns(&self, columns: Option<ChosenColumns>) -> Result<()> {
        self.change(|project| {
            project.understanding.columns = columns;
            let first = project.files_for(Use::Training).chain(&project.files).next();
            let Some(first) = first.map(|file| file.name.clone()) else { return Ok(()) };
            let understanding = &project.understanding;
            if understanding.columns.is_some() {
                let table = read_named(&first, &self.folder, &understanding.reading.reading()?)?;
                Roles::detect(&table, &understanding.choice())?;
            }
            Ok(())
        })
    }

    /// The data of a file.
    ///
    /// # Errors
    /// A file that cannot be used.
    pub fn data_of(&self, id: u64) -> Result<Arc<Data>> {
        self.view().data(id)
    }

    /// All training data, as a fit takes them.
    ///
    /// # Errors
    /// None; or files that cannot be used.
    pub fn training_data(&self) -> Result<Arc<Data>> {
        let (files, understanding) = {
            let project = self.project();
            let files: Vec<ProjectFile> = project.files_for(Use::Training).cloned().collect();
            (files, project.understanding.clone())
        };
        let view = self.view();
        match files.as_slice() {
            [] => bail!("there are no training data: drop a file, or choose one for training"),
            [one] => match (&view.problem, view.file(one.id)?.problem.is_some()) {
                (Some(problem), false) => bail!("{problem}"),
                _ => view.data(one.id),
            },
            several => {
                if let Some(problem) = &view.problem {
                    bail!("{problem}");
                }
                let reading = understanding.reading.reading()?;
                let read = |file: &ProjectFile| read_named(&file.name, &self.folder, &reading);
                let tables = several.iter().map(read).collect::<Result<_>>()?;
                let zero = understanding.reading.zero;
                Ok(Arc::new(Data::of_tables(tables, &understanding.choice(), zero)?))
            }
        }
    }

    /// What may be wrong with the training data: what a fit warns of, and what the diagnosis finds.
    ///
    /// # Errors
    /// As [`Studio::training_data`].
    pub fn findings(&self) -> Result<Findings> {
        let data = self.training_data()?;
        let warnings = summarised(&Summary::of(&data.set).warnings(&data.set));
        // Data that cannot be diagnosed may still be fitted to.
        let issues = match Diagnosis::of(&data.set, &DiagnosisOptions::default()) {
            Ok(diagnosis) => diagnosis.doctor,
            Err(_) => before_a_fit(&data.set).unwrap_or_default(),
        };
        Ok(Findings { warnings, issues })
    }

    /// The diagnosis of the training data, as HTML.
    ///
    /// # Errors
    /// As [`Studio::training_data`]; data that cannot be diagnosed.
    pub fn diagnosis(&self) -> Result<String> {
        let data = self.training_data()?;
        let understood = understanding::of_data(&data, &Summary::of(&data.set));
        let diagnosed = DataDiagnosis::of(&data, &DiagnosisOptions::default(), &understood, String::new())?;
        Ok(html::parts(&diagnosed.page().parts))
    }

    // Fits.

    /// Begins a fit to the training data.
    ///
    /// # Errors
    /// A request that is not valid, or not for these data; another fit that is running.
    pub fn begin_fit(self: &Arc<Self>, request: FitRequest) -> Result<u64> {
        if self.fits.state().is_some_and(|state| state.is_running) {
            bail!("a fit is running: stop it, or wait until it ends");
        }
        if request.time_limit.is_some_and(|limit| !(limit > 0.0 && limit.is_finite() && limit <= 1e9)) {
            return Err(Usage("--time-limit: a number of seconds above 0 is needed".into()).into());
        }
        let data = self.training_data()?;
        let spec = self.spec(&request, &data)?;
        // What can be refused is refused before anything is stored.
        Beforehand::of(&data, &spec)?;
        let best = self.folder.best_so_far();
        let _ = fs::remove_file(&best);
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
        // The fit has data of its own: the page may read files in another way meanwhile.
        let data = Arc::try_unwrap(data).or_else(|_| self.owned_training_data())?;
        let work = Work { id, request: spec, data, file, time_limit, best };
        let (finishing, telling) = (Arc::clone(self), Arc::clone(self));
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

    fn owned_training_data(&self) -> Result<Data> {
        let project = self.project();
        let understanding = project.understanding.clone();
        let reading = understanding.reading.reading()?;
        let read = |file: &ProjectFile| read_named(&file.name, &self.folder, &reading);
        let tables = project.files_for(Use::Training).map(read).collect::<Result<_>>()?;
        drop(project);
        Data::of_tables(tables, &understanding.choice(), understanding.reading.zero)
    }

    /// What a request asks for.
    fn spec(&self, request: &FitRequest, data: &Data) -> Result<FitSpec> {
        let chosen = NamedOptions::of(request.options.clone()).map_err(|error| Usage(error.to_string()))?;
        request.rate(&self.project().understanding)?.request(&chosen, &data.roles)
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

    /// Saves what a fit has found.
    fn take_model(&self, begun: Begun, identified: &Identified, data: &Data) -> Result<()> {
        let stem = format!("{}-{}", begun.id, identified.model.name().name());
        let (file, report) = (format!("{stem}.json"), format!("{stem}.html"));
        write(&self.folder.models(&file), Kind::Model, identified.model.to_json().as_bytes())?;
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
        self.change(|project| {
            project.unfinished = None;
            project.models.push(stored);
            Ok(())
        })?;
        let _ = fs::remove_file(self.folder.best_so_far());
        Ok(())
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
        write(&self.folder.models(report), Kind::Page, page_text(&page).as_bytes())
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
    fn take_up_the_unfinished(&self) -> Result<()> {
        let Some(begun) = self.project().unfinished.clone() else { return Ok(()) };
        let chosen = NamedOptions::of(begun.request.options.clone()).unwrap_or_default();
        let best = self.folder.best_so_far();
        let model = fs::read_to_string(&best).ok().and_then(|text| Model::from_json(&text).ok());
        let mut state = FitState::begun(begun.id, &FitSpec::of(chosen.model(), None, 1));
        state.is_running = false;
        state.was_interrupted = true;
        let words = "the studio was ended before this fit";
        match model {
            Some(model) => {
                let id = begun.id;
                let file = format!("{id}-{}.json", model.name().name());
                fs::rename(&best, self.folder.models(&file))
                    .context("the best model so far cannot be kept")?;
                let stored = ProjectModel {
                    begun,
                    file,
                    report: None,
                    made: date::now(),
                    seconds: 0.0,
                    was_interrupted: true,
                };
                self.change(|project| {
                    project.unfinished = None;
                    project.models.push(stored);
                    Ok(())
                })?;
                state.made = Some(id);
                state.problem = Some(format!("{words}; its best model so far is kept"));
            }
            None => {
                self.forget_the_unfinished();
                state.problem = Some(format!("{words} had a model; start it again"));
            }
        }
        self.fits.interrupted(state);
        Ok(())
    }

    // Models.

    /// The model of this number.
    ///
    /// # Errors
    /// There is none, or its file cannot be read.
    pub fn model(&self, id: u64) -> Result<Arc<Model>> {
        let kept = || self.models.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(known) = kept().get(&id) {
            return Ok(Arc::clone(known));
        }
        let path = self.model_file(id)?;
        let text = fs::read_to_string(&path).map_err(|error| {
            anyhow!("{}: cannot be read: {}", path.display(), hysid_files::reason(&error))
        })?;
        let model = Model::from_json(&text).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        let model = Arc::new(model);
        let mut kept = kept();
        if kept.len() >= MOST_MODELS {
            kept.clear();
        }
        kept.insert(id, Arc::clone(&model));
        Ok(model)
    }

    /// What is stored of a model.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn stored_model(&self, id: u64) -> Result<ProjectModel> {
        self.project().model(id).cloned()
    }

    /// Where the file of a model is.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn model_file(&self, id: u64) -> Result<PathBuf> {
        Ok(self.folder.models(&self.project().model(id)?.file))
    }

    /// The text of a model's report.
    ///
    /// # Errors
    /// There is none.
    pub fn report(&self, id: u64) -> Result<String> {
        let report = self.project().model(id)?.report.clone();
        let report =
            report.ok_or_else(|| anyhow!("this model has no report: its fit did not come to its end"))?;
        let path = self.folder.models(&report);
        fs::read_to_string(&path)
            .map_err(|error| anyhow!("{}: cannot be read: {}", path.display(), hysid_files::reason(&error)))
    }

    /// Removes a model.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn remove_model(&self, id: u64) -> Result<()> {
        self.change(|project| {
            let stored = project.model(id)?.clone();
            project.models.retain(|model| model.begun.id != id);
            for file in std::iter::once(&stored.file).chain(&stored.report) {
                let _ = fs::remove_file(self.folder.models(file));
            }
            Ok(())
        })?;
        self.models.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).remove(&id);
        self.runs.clear();
        Ok(())
    }

    /// The free run of a model over a file.
    ///
    /// # Errors
    /// A file that the model cannot run on.
    pub fn run(&self, model: u64, file: u64) -> Result<Arc<Run>> {
        self.runs.of(model, file, || {
            let (stored, name, reading) = {
                let project = self.project();
                let name = project.file(file)?.name.clone();
                (project.model(model)?.clone(), name, project.understanding.reading.clone())
            };
            let fitted = self.model(model)?;
            let table = read_named(&name, &self.folder, &reading.reading()?)?;
            // The model knows the names of its columns, whatever is chosen now.
            let record = stored.begun.columns.record.filter(|name| table.column(name).is_some());
            let columns = ColumnChoice { record, ..ColumnChoice::default() };
            let data = Data::of_model(vec![table], &fitted, &columns, reading.zero)?;
            Run::of(&fitted, data.set)
        })
    }

    /// What is known of a model, as HTML.
    ///
    /// # Errors
    /// A model that cannot be diagnosed.
    pub fn facts(&self, id: u64) -> Result<String> {
        let (model, path) = (self.model(id)?, self.model_file(id)?);
        let file = PathBuf::from(path.file_name().unwrap_or_default());
        let page: Page = DiagnosedModel::of(&file, &model)?.page();
        Ok(html::parts(&page.parts))
    }

    /// The lines that make a model without the studio.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn lines(&self, id: u64) -> Result<Lines> {
        Ok(Lines::of(&self.stored_model(id)?, self.folder.root()))
    }
}
