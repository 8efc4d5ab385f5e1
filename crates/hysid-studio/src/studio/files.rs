//! Files of a project, and their content.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use hysid::data::record::Dataset;
use hysid::data::summary::Summary;
use hysid::diagnosis::cycles::CycleOptions;
use hysid::diagnosis::{DataIssue, Diagnosis, DiagnosisOptions, before_a_fit};
use hysid::specimens::{Specimen, with_noise};
use hysid_app::cycles::{self, Cycles};
use hysid_app::diagnosis::DataDiagnosis;
use hysid_document::visible::clipped;
use hysid_document::{Face, Problem, html, object};
use hysid_document::{Result, problem};
use hysid_records::{Data, ReadingChoice, Roles, csv_text, summarised, understanding};
use hysid_tables::{Table, other_kind};
use serde::Deserialize;
use serde_json::{Value, json};

use super::Studio;
use super::removal::Removed;
use crate::folder::{ProjectFolder, UPLOAD, cannot_read};
use crate::project::{ChosenColumns, Project, ProjectFile, ProjectModel, Use};
use crate::view::{View, read};
use crate::words::{Said, said};

/// What the columns do not tell of cycles: the field, if its guess is wrong, the mass density of a magnet, in kg/m³, and the
/// height of a structure, in the unit of the input.
#[derive(Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CyclesAsked {
    field: Option<String>,
    density: Option<f64>,
    height: Option<f64>,
}

impl Studio {
    /// Where a file with this name that comes in is put, before it is [taken](Self::take_file).
    pub fn place_for_upload(&self) -> Result<PathBuf> {
        self.project().check_room()?;
        let mut random = [0; 8];
        getrandom::fill(&mut random).map_err(|error| problem!("no random name: {error}"))?;
        Ok(self.folder.data(&format!("{UPLOAD}{:016x}", u64::from_le_bytes(random))))
    }

    /// Takes a file that lies at a place of an upload. It is read before it is in the project: one that kills the studio
    /// is in none.
    pub fn take_file(&self, given: &str, place: &Path, usage: Use) -> Result<u64> {
        let reading = self.project().understanding.reading.clone();
        let name = self.folder.free_name(ProjectFolder::Data, given)?;
        let content = fs::read(place).map_err(|error| cannot_read(Path::new(&name), &error))?;
        // A picture is no file of a project: it is refused, and the page says so.
        if let Some(kind) = other_kind(&content) {
            return Err(Problem::in_file(&name, kind.to_string()));
        }
        let bytes = content.len() as u64;
        let checksum = hysid_files::checksum(&content[..]).map_err(|error| problem!("{name}: {error}"))?;
        let table = Table::from_bytes(Path::new(&name), content, &reading.reading()?);
        let mut stored = None;
        let entered = self.change(|project| {
            project.check_room()?;
            let name = self.folder.free_name(ProjectFolder::Data, given)?;
            let path = self.folder.data(&name);
            fs::rename(place, &path)
                .map_err(|error| problem!("{name}: cannot be stored: {}", hysid_files::reason(&error)))?;
            stored = Some(path);
            let id = project.next_id();
            let columns = ChosenColumns::default();
            project.files.push(ProjectFile { id, name, bytes, checksum, usage, columns, is_example: false });
            Ok((id, project.understanding.reading == reading))
        });
        if entered.is_err() {
            stored.iter().for_each(|path| self.folder.remove(path));
        }
        let (id, is_read_alike) = entered?;
        self.read_files_with(is_read_alike.then_some((id, table)));
        Ok(id)
    }

    pub fn take_content(&self, given: &str, content: &[u8], usage: Use) -> Result<u64> {
        let place = self.place_for_upload()?;
        let stored = fs::write(&place, content)
            .map_err(|error| problem!("{given}: cannot be stored: {}", hysid_files::reason(&error)));
        let taken = stored.and_then(|()| self.take_file(given, &place, usage));
        if taken.is_err() {
            self.folder.remove(&place);
        }
        taken
    }

    /// Takes a copy of a file of the user, unless the project has the same already.
    pub fn take_path(&self, path: &Path) -> Result<()> {
        let content = fs::read(path).map_err(|error| cannot_read(path, &error))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_known = |file: &ProjectFile| {
            file.name == name
                && self.folder.read(&self.folder.data(&file.name)).is_ok_and(|known| known == content)
        };
        if self.project().files.iter().any(is_known) {
            return Ok(());
        }
        let usage = self.usage_of_next();
        self.take_content(&name, &content, usage).map(drop)
    }

    /// Marks files as data of the example.
    pub fn mark_example(&self, ids: &[u64]) -> Result<()> {
        self.change(|project| {
            project.files.iter_mut().for_each(|file| file.is_example |= ids.contains(&file.id));
            Ok(())
        })
    }

    /// Removes the example, before files of the user come in its place.
    pub fn leave_example(&self) -> Result<()> {
        let project = self.project().clone();
        let (example, own): (Vec<_>, Vec<_>) = project.files.iter().partition(|file| file.is_example);
        if !own.is_empty() || self.fits.state().is_some_and(|fit| fit.is_running) {
            return Ok(());
        }
        let is_of_it = |model: &&ProjectModel| {
            model.begun.files.iter().all(|name| example.iter().any(|file| file.name == *name))
        };
        for model in project.models.iter().filter(is_of_it) {
            self.remove_model(model.begun.id)?;
        }
        example.iter().try_for_each(|file| self.remove_file(file.id).map(drop))
    }

    /// Use of the next file: the first are for training; once there is a model, a file is unseen.
    pub fn usage_of_next(&self) -> Use {
        if self.project().models.is_empty() { Use::Training } else { Use::Unseen }
    }

    /// Removes a file from the project. Gives its name if it stays in the folder, because it is no longer the one that came.
    pub fn remove_file(&self, id: u64) -> Result<Option<String>> {
        let (removed, place) = self.change(|project| {
            let place = project.place_of_file(id)?;
            Ok((project.files.remove(place), place))
        })?;
        // A model that was made of it keeps its line.
        let path = self.folder.data(&removed.name);
        let aside = self.folder.removed(ProjectFolder::Data, id, 0);
        let kept = self.folder.set_aside_if(&path, &aside, |file| {
            Ok(file.metadata()?.len() == removed.bytes && hysid_files::checksum(file)? == removed.checksum)
        });
        self.keep_removed(Removed::File(removed.clone(), place));
        self.folder.release(id);
        self.read_files();
        Ok(kept.then_some(removed.name))
    }

    /// Reads a file that was not read because that killed the studio before.
    pub fn read_again(&self, id: u64) -> Result<()> {
        self.project().file(id)?;
        self.folder.release(id);
        self.show(self.view().without(id));
        self.read_files();
        Ok(())
    }

    pub fn use_file(&self, id: u64, usage: Use) -> Result<()> {
        self.change_reading(|project| {
            project.file(id)?;
            project.files.iter_mut().filter(|file| file.id == id).for_each(|file| file.usage = usage);
            Ok(())
        })
    }

    /// Takes the training and the test data of a specimen.
    pub fn take_specimen(&self, name: &str, seed: u64, noise_percent: f64) -> Result<Vec<u64>> {
        let specimen = Specimen::named(name).ok_or_else(|| problem!("there is no specimen \"{name}\""))?;
        // As of `hysid generate`: test data have a noise of their own.
        let sets = [
            (format!("{name}-train.csv"), specimen.train_with_seed(seed), seed, Use::Training),
            (format!("{name}-test.csv"), specimen.test_with_seed(seed), !seed, Use::Unseen),
        ];
        let take = |(name, data, seed, usage): (String, Dataset, u64, Use)| {
            let text = csv_text(&with_noise(&data, noise_percent, seed)?);
            self.take_content(&name, text.as_bytes(), usage)
        };
        sets.into_iter().map(take).collect()
    }

    pub fn read_as(&self, reading: ReadingChoice) -> Result<()> {
        reading.reading()?;
        self.change_reading(|project| {
            project.understanding.reading = reading;
            Ok(())
        })
    }

    /// Says which columns are what; `None` to guess.
    ///
    /// # Errors
    /// Columns that the training files do not have, or one with two roles. Nothing is then changed.
    ///
    /// Returns a note on a column that has a role by its name although none was chosen for it.
    pub fn choose_columns(&self, columns: Option<ChosenColumns>) -> Result<Option<String>> {
        let before = self.project().clone();
        let note = match (&columns, before.first()) {
            (Some(chosen), Some(first)) => self.check_columns(&before, first, chosen)?,
            _ => None,
        };
        self.change_reading(|project| {
            if project.files != before.files || project.understanding != before.understanding {
                return Err(problem!(
                    "the files or their reading changed meanwhile: choose the columns again"
                ));
            }
            if columns.is_none() {
                project.files.iter_mut().for_each(|file| file.columns = ChosenColumns::default());
            }
            project.understanding.columns = columns;
            Ok(())
        })?;
        Ok(note)
    }

    /// Says which columns of a file have the roles of the first; those that are not chosen are found.
    pub fn choose_columns_of(&self, id: u64, columns: ChosenColumns) -> Result<()> {
        self.change_reading(|project| {
            let place = project.place_of_file(id)?;
            project.files[place].columns = columns;
            Ok(())
        })
    }

    /// Checks columns by the first file; gives a note on one that keeps its role.
    fn check_columns(
        &self,
        project: &Project,
        first: &ProjectFile,
        chosen: &ChosenColumns,
    ) -> Result<Option<String>> {
        let table = read(first, &self.folder, &project.understanding.reading.reading()?)?;
        let found = Roles::detect(&table, &chosen.choice())?;
        let roles = [("time", &chosen.time, &found.time), ("record", &chosen.record, &found.record)];
        let by_name = roles.iter().find_map(|(role, chosen, found)| {
            let name = found.as_ref().filter(|_| chosen.is_none())?;
            Some(format!("\"{}\" keeps the role {role}, which is detected from its name or values; another column can get the role", clipped(name)))
        });
        Ok(by_name)
    }

    pub fn data_of(&self, id: u64) -> Result<Arc<Data>> {
        let view = self.view();
        let is_read_as = view.is_read_as(&self.project().understanding);
        // Others may still be read.
        if is_read_as && let Ok(data) = view.data(id) {
            return Ok(data);
        }
        self.current().1.data(id)
    }

    /// All training data, as a fit takes them.
    pub fn training_data(&self) -> Result<Arc<Data>> {
        let (project, view) = self.current();
        view.training(&project, &self.folder)
    }

    /// Issues of the training data: warnings of a fit, and findings of the diagnosis.
    pub fn findings(&self) -> Result<Value> {
        let data = self.training_data()?;
        let warnings = summarised(&Summary::of(&data.set).warnings(&data.set));
        // Data that cannot be diagnosed may still be fitted to.
        let issues = match Diagnosis::of(&data.set, &DiagnosisOptions::default()) {
            Ok(diagnosis) => diagnosis.doctor,
            Err(_) => before_a_fit(&data.set).unwrap_or_default(),
        };
        // The issues with the rows that show them.
        let issue = |issue: DataIssue| {
            let words = Said::from(issue.words());
            object! { words: words, #[serde(flatten)] issue: issue }
        };
        Ok(json!({"warnings": warnings, "issues": issues.into_iter().map(issue).collect::<Vec<_>>()}))
    }

    /// The diagnosis of the training data, as HTML. It is made once, also if who asked for it does not wait.
    pub fn diagnosis(&self) -> Result<String> {
        self.made_once(|view| &view.diagnosis, diagnosis_of)
    }

    /// The cycles of the training data, as the diagnosis.
    pub fn cycles(&self, asked: &CyclesAsked) -> Result<String> {
        let CyclesAsked { field, density, height } = asked;
        for (option, value) in [("density", density), ("height", height)] {
            if value.is_some_and(|value| !(value > 0.0 && value.is_finite())) {
                return Err(Problem::option(option, "a number above 0 is needed"));
            }
        }
        if *asked == CyclesAsked::default() {
            return self.made_once(|view| &view.cycles, |data| cycles_of(data, &CycleOptions::default()));
        }
        let named =
            |name: &String| name.parse().map_err(|error: hysid::Error| Problem::request(error.to_string()));
        let field = field.as_ref().map(named).transpose()?;
        let options = CycleOptions { field, density: *density, height: *height, ..CycleOptions::default() };
        cycles_of(self.training_data()?.as_ref(), &options)
    }

    fn made_once(
        &self,
        kept: impl Fn(&View) -> &OnceLock<std::result::Result<String, Said>>,
        make: fn(&Data) -> Result<String>,
    ) -> Result<String> {
        let (project, view) = self.current();
        let made = || view.training(&project, &self.folder).and_then(|data| make(&data));
        let page = kept(&view).get_or_init(|| made().map_err(|error| said(&error)));
        page.clone().map_err(Problem::from)
    }
}

fn diagnosis_of(data: &Data) -> Result<String> {
    let understood = understanding::of_data(data, &Summary::of(&data.set), Face::Studio);
    let diagnosed =
        DataDiagnosis::of(data, &DiagnosisOptions::default(), &understood, String::new(), Face::Studio)?;
    Ok(html::parts(&diagnosed.page().parts))
}

fn cycles_of(data: &Data, options: &CycleOptions) -> Result<String> {
    let understood = understanding::of_data(data, &Summary::of(&data.set), Face::Studio);
    let cycles = Cycles::of_data(&data.set, options, &[], (None, 0.0), ("", understood));
    Ok(html::parts(&cycles::page(&cycles.map_err(|error| data.explain(error))?).parts))
}
