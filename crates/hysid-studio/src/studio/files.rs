//! Files of a project, and what they say.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Result, anyhow, bail};
use hysid::data::record::Dataset;
use hysid::data::summary::Summary;
use hysid::diagnosis::{DataIssue, Diagnosis, DiagnosisOptions, before_a_fit};
use hysid::specimens::{Specimen, with_noise};
use hysid_document::html;
use hysid_document::visible::clipped;
use hysid_records::{Data, ReadingChoice, Roles, csv_text, summarised, understanding};
use hysid_report::diagnosis::DataDiagnosis;
use serde::Serialize;

use super::Studio;
use crate::folder::{Inner, UPLOAD, cannot_read};
use crate::project::{ChosenColumns, ProjectFile, Use};
use crate::view::read;

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

impl Studio {
    /// Where a file with this name that comes in is put, before it is [taken](Self::take_file).
    pub fn place_for_upload(&self) -> Result<PathBuf> {
        if self.project().files.len() >= MOST_FILES {
            bail!("a project has at most {MOST_FILES} files: remove some that are not used");
        }
        let mut random = [0; 8];
        getrandom::fill(&mut random).map_err(|error| anyhow!("no random name: {error}"))?;
        Ok(self.folder.data(&format!("{UPLOAD}{:016x}", u64::from_le_bytes(random))))
    }

    /// Takes a file that lies at a place of an upload.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn take_file(&self, given: &str, place: &Path, usage: Use) -> Result<u64> {
        let bytes = fs::metadata(place).map_or(0, |metadata| metadata.len());
        self.change(|project| {
            let name = self.folder.free_name(Inner::Data, given)?;
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

    /// What the next file is for: the first are for training; once there is a model, a file is unseen.
    pub fn usage_of_next(&self) -> Use {
        if self.project().models.is_empty() { Use::Training } else { Use::Unseen }
    }

    /// Removes a file.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn remove_file(&self, id: u64) -> Result<()> {
        let removed = self.change(|project| {
            let removed = project.file(id)?.clone();
            project.files.retain(|file| file.id != id);
            Ok(removed)
        })?;
        // A model that was made of it keeps its line. A file that is no longer the one that came stays.
        let path = self.folder.data(&removed.name);
        if fs::symlink_metadata(&path).is_ok_and(|found| found.len() == removed.bytes) {
            self.folder.remove(&path);
        }
        Ok(())
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
            (format!("{name}-train.csv"), specimen.train_with_seed(seed), seed, Use::Training),
            (format!("{name}-test.csv"), specimen.test_with_seed(seed), !seed, Use::Unseen),
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
    ///
    /// The answer is a note on a column that has a role by its name although none was chosen for it.
    pub fn choose_columns(&self, columns: Option<ChosenColumns>) -> Result<Option<String>> {
        self.change(|project| {
            project.understanding.columns = columns;
            let first = project.files_for(Use::Training).chain(&project.files).next();
            let Some(first) = first.map(|file| file.name.clone()) else { return Ok(None) };
            let understanding = &project.understanding;
            let Some(chosen) = &understanding.columns else { return Ok(None) };
            let table = read(&first, &self.folder, &understanding.reading.reading()?)?;
            let found = Roles::detect(&table, &understanding.choice())?;
            let roles = [("time", &chosen.time, &found.time), ("record", &chosen.record, &found.record)];
            let by_name = roles.iter().find_map(|(role, chosen, found)| {
                let name = found.as_ref().filter(|_| chosen.is_none())?;
                Some(format!("\"{}\" keeps the role {role}, which is detected from its name or values; another column can get the role", clipped(name)))
            });
            Ok(by_name)
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
    /// No training file, or files that cannot be used.
    pub fn training_data(&self) -> Result<Arc<Data>> {
        let (project, view) = {
            let project = self.project();
            (project.clone(), self.view())
        };
        view.training(&project, &self.folder)
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
}
