//! Content of a project: files, how they are read, models. It is one JSON file in the project's folder.

use hysid::data::rate::RateMethod;
use hysid::model::Model;
use hysid::options::chosen::RateChoice;
use hysid::options::table::{OPTIONS, OptionValues};
use hysid_document::{Problem, Result, problem};
use hysid_records::{ColumnChoice, RateOption, ReadingChoice, Roles};
use hysid_tables::Head;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::folder::{Folder, plain};

/// Version of the project's file.
const VERSION: u32 = 1;

const MOST_FILES: usize = 200;

/// Largest number of a file or a model, far below those that a page in a browser rounds.
const LARGEST_ID: u64 = 1 << 48;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    format: String,
    version: u32,
    /// The next number of a file or a model.
    next: u64,
    /// Files with data, in the order in which they came.
    pub files: Vec<ProjectFile>,
    /// How the files are read and which columns are what.
    pub understanding: Understanding,
    /// Models, in the order in which they were made.
    pub models: Vec<ProjectModel>,
    /// A fit that was begun and has not ended.
    pub unfinished: Option<Begun>,
}

/// How files are read and which columns are what.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Understanding {
    pub reading: ReadingChoice,
    /// The columns, if they are not guessed.
    pub columns: Option<ChosenColumns>,
}

/// Columns by their roles. Of the file that determines the roles all are known; of others those that were chosen.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(missing_docs, reason = "each field is the role of its name")]
pub struct ChosenColumns {
    pub record: Option<String>,
    pub time: Option<String>,
    pub inputs: Vec<String>,
    pub rate: Option<String>,
    pub output: Option<String>,
}

impl ChosenColumns {
    pub fn choice(&self) -> ColumnChoice {
        let Self { record, time, inputs, rate, output } = self.clone();
        let rate = rate.map_or_else(RateOption::default, RateOption::Column);
        ColumnChoice { record, time, input: inputs, output, rate }
    }

    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The roles that find the same columns in other tables.
    pub fn roles(&self) -> Roles {
        let Self { record, time, inputs, rate, output } = self.clone();
        Roles { record, time, inputs, rate, output: output.unwrap_or_default(), ..Roles::default() }
    }

    pub fn of(roles: &Roles) -> Self {
        Self {
            record: roles.record.clone(),
            time: roles.time.clone(),
            inputs: roles.inputs.clone(),
            rate: roles.rate.clone(),
            output: Some(roles.output.clone()),
        }
    }
}

impl Begun {
    /// The method of the rate that was asked for; `None` for the default, and for a column.
    pub fn rate_method(&self) -> Option<&str> {
        self.request.rate.as_deref().filter(|method| self.columns.rate.is_none() && *method != "auto")
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProjectFile {
    pub id: u64,
    pub name: String,
    pub bytes: u64,
    /// Of its content as it came.
    pub checksum: String,
    #[serde(rename = "use")]
    pub usage: Use,
    /// Columns that were chosen for this file, in place of those that are like the columns of the first.
    #[serde(default, skip_serializing_if = "ChosenColumns::is_empty")]
    pub columns: ChosenColumns,
    /// True for data of the example, which files of the user replace.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_example: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Use {
    /// Models are fitted to it.
    Training,
    /// Models are judged by it.
    Unseen,
    Unused,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitRequest {
    /// Options by name, as in the table of options.
    #[serde(default)]
    pub options: Map<String, Value>,
    /// `auto`, `none` or a method; a column of the rate comes before it.
    #[serde(default)]
    pub rate: Option<String>,
    /// Seconds after which the fit ends.
    #[serde(default)]
    pub time_limit: Option<f64>,
}

/// A fit that was begun: what it was asked for, and with which data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Begun {
    /// Its number, which its model gets too.
    pub id: u64,
    pub request: FitRequest,
    pub files: Vec<String>,
    /// How they were read.
    pub understanding: Understanding,
    pub columns: ChosenColumns,
    /// Columns that were chosen for single files; empty if none were.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of_files: Vec<ChosenColumns>,
    /// Files whose columns have other names than those of the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub renamed: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProjectModel {
    /// The fit that it came from.
    pub begun: Begun,
    /// Its file in the folder of models.
    pub file: String,
    pub report: Option<String>,
    /// Date and time of day in UTC.
    pub made: String,
    pub seconds: f64,
    /// True if the fit did not come to its end, because the studio was ended.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub was_interrupted: bool,
    /// The name that somebody gave it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

impl ProjectModel {
    /// The columns of the model in a table, which may have them under other names: those of its fit, whatever is chosen
    /// now for other files.
    pub fn columns_in(&self, model: &Model, table: &Head, file: &ProjectFile) -> ColumnChoice {
        let wanted = self.begun.columns.roles();
        let (found, _) = wanted.in_table(table, "the training data", &file.columns.choice());
        let rate = found.rate.filter(|_| model.rate() == Some(RateMethod::Given));
        ColumnChoice {
            record: found.record,
            time: found.time,
            input: if found.inputs.len() == wanted.inputs.len() { found.inputs } else { Vec::new() },
            output: Some(found.output).filter(|output| !output.is_empty()),
            rate: rate.map_or_else(RateOption::default, RateOption::Column),
        }
    }
}

impl Default for Project {
    fn default() -> Self {
        Self {
            format: "hysid-project".into(),
            version: VERSION,
            next: 1,
            files: Vec::new(),
            understanding: Understanding::default(),
            models: Vec::new(),
            unfinished: None,
        }
    }
}

impl Project {
    /// Reads the project of a folder; a new project if there is none.
    ///
    /// # Errors
    /// A file that cannot be read, or is of a later version.
    pub fn of(folder: &Folder) -> Result<Self> {
        let Some(text) = folder.read_project()? else { return Ok(Self::default()) };
        let file = folder.root().join("project.json");
        let wrong = |what: String| problem!("{}: {what}", file.display());
        let value: Value = serde_json::from_str(&text)
            .map_err(|error| wrong(format!("is damaged: {error} (restore it, or open another folder)")))?;
        match (value["format"].as_str(), value["version"].as_u64()) {
            (Some("hysid-project"), Some(version)) if version <= u64::from(VERSION) => {}
            (Some("hysid-project"), _) => {
                return Err(wrong("was written by a later version of Hysid".into()));
            }
            _ => return Err(wrong("is not a Hysid project".into())),
        }
        let project: Self =
            serde_json::from_value(value).map_err(|error| wrong(format!("is damaged: {error}")))?;
        project.checked().map_err(|error| wrong(format!("is damaged: {error}")))
    }

    /// The same with a next number that is free. Numbers and names select the files to write and remove, so each is
    /// there once, and names lead nowhere else.
    fn checked(mut self) -> Result<Self> {
        let of_models = self.models.iter().map(|model| model.begun.id);
        let mut ids: Vec<u64> = self.files.iter().map(|file| file.id).chain(of_models).collect();
        ids.sort_unstable();
        if let Some(twice) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(problem!("the number {} is there twice", twice[0]));
        }
        let last = ids.into_iter().chain(self.unfinished.iter().map(|begun| begun.id)).max().unwrap_or(0);
        self.next = self.next.max(last.saturating_add(1));
        if self.next > LARGEST_ID {
            return Err(problem!("a number is too large"));
        }
        let of_data = self.files.iter().map(|file| file.name.as_str());
        let of_models =
            self.models.iter().flat_map(|model| std::iter::once(&model.file).chain(&model.report));
        for mut names in [of_data.collect::<Vec<&str>>(), of_models.map(String::as_str).collect()] {
            if let Some(other) = names.iter().find(|name| plain(name) != **name) {
                return Err(problem!("{other:?} is no name of a file in the project"));
            }
            names.sort_unstable();
            if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(problem!("the file {:?} is there twice", twice[0]));
            }
        }
        Ok(self)
    }

    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).expect("a project is plain data") + "\n"
    }

    /// Refuses one more file in a full project.
    pub fn check_room(&self) -> Result<()> {
        if self.files.len() >= MOST_FILES {
            return Err(problem!("a project has at most {MOST_FILES} files: remove some that are not used"));
        }
        Ok(())
    }

    /// A number that was not used before.
    pub fn next_id(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    pub fn file(&self, id: u64) -> Result<&ProjectFile> {
        Ok(&self.files[self.place_of_file(id)?])
    }

    pub fn place_of_file(&self, id: u64) -> Result<usize> {
        self.files.iter().position(|file| file.id == id).ok_or_else(|| problem!("there is no file {id}"))
    }

    pub fn model(&self, id: u64) -> Result<&ProjectModel> {
        Ok(&self.models[self.place_of_model(id)?])
    }

    pub fn place_of_model(&self, id: u64) -> Result<usize> {
        let place = self.models.iter().position(|model| model.begun.id == id);
        place.ok_or_else(|| problem!("there is no model {id}"))
    }

    pub fn files_for(&self, usage: Use) -> impl Iterator<Item = &ProjectFile> {
        self.files.iter().filter(move |file| file.usage == usage)
    }

    /// The file that determines the columns: models are fitted to training files.
    pub fn first(&self) -> Option<&ProjectFile> {
        self.files_for(Use::Training).chain(&self.files).next()
    }

    /// Columns that were chosen for single training files; empty if none were.
    pub fn columns_of_files(&self) -> Vec<ChosenColumns> {
        let all: Vec<ChosenColumns> =
            self.files_for(Use::Training).map(|file| file.columns.clone()).collect();
        if all.iter().all(ChosenColumns::is_empty) { Vec::new() } else { all }
    }

    /// True if a fit had other data than the present ones.
    pub fn is_stale(&self, begun: &Begun) -> bool {
        begun.understanding != self.understanding
            || begun.of_files != self.columns_of_files()
            || !begun.files.iter().eq(self.files_for(Use::Training).map(|file| &file.name))
    }
}

impl Understanding {
    pub fn choice(&self) -> ColumnChoice {
        self.columns.as_ref().map_or_else(ColumnChoice::default, ChosenColumns::choice)
    }
}

impl FitRequest {
    /// The same with values in place of their texts, as a form gives them.
    pub fn with_values(mut self) -> Result<Self> {
        for (name, value) in &mut self.options {
            let Some(option) = OPTIONS.iter().find(|option| option.name == name) else { continue };
            if let Value::String(text) = value
                && !matches!(option.values, OptionValues::Names(_))
            {
                *value = option.read(text).map_err(|needed| Problem::option(option.name, needed))?;
            }
        }
        Ok(self)
    }

    /// Where the rate comes from, in a project with this understanding of its files.
    pub fn rate(&self, understanding: &Understanding) -> Result<RateOption> {
        if let Some(column) = understanding.columns.as_ref().and_then(|columns| columns.rate.clone()) {
            return Ok(RateOption::Column(column));
        }
        let method = self.rate.as_deref().unwrap_or("auto");
        let choice: RateChoice = method.parse().map_err(|error| Problem::option("rate", error))?;
        Ok(RateOption::Choice(choice))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_a_form_become_values() {
        let request = |options: &str| -> FitRequest {
            serde_json::from_str(&format!("{{\"options\": {options}}}")).unwrap()
        };
        let texts = request(r#"{"model": "prandtl-ishlinskii", "thresholds": "0.1, 0.5", "seed": 3}"#);
        let values = request(r#"{"model": "prandtl-ishlinskii", "thresholds": [0.1, 0.5], "seed": 3}"#);
        assert_eq!(texts.with_values().unwrap(), values);
        let error = request(r#"{"thresholds": "0.1; x"}"#).with_values().unwrap_err().to_string();
        assert!(error.starts_with("--thresholds: numbers above 0"), "{error}");
    }

    #[test]
    fn forged_numbers_and_names_are_refused() {
        let file = |id, name: &str| ProjectFile {
            id,
            name: name.into(),
            bytes: 1,
            checksum: String::new(),
            usage: Use::Training,
            columns: ChosenColumns::default(),
            is_example: false,
        };
        let with = |files: Vec<ProjectFile>| Project { files, ..Project::default() }.checked();
        assert_eq!(with(vec![file(7, "a.csv")]).unwrap().next, 8, "a number is never given twice");
        for (files, said) in [
            (vec![file(1, "a.csv"), file(1, "b.csv")], "the number 1 is there twice"),
            (vec![file(1, "a.csv"), file(2, "a.csv")], "the file \"a.csv\" is there twice"),
            (vec![file(1, "../a.csv")], "is no name of a file"),
            (vec![file(u64::MAX, "a.csv")], "a number is too large"),
            (vec![file(1 << 53, "a.csv")], "a number is too large"),
        ] {
            let error = with(files).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        assert!(
            Project { next: u64::MAX, ..Project::default() }.checked().is_err(),
            "the next number has no next"
        );
    }

    #[test]
    fn a_project_reads_back_as_it_was_written_and_a_damaged_one_says_so() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(Some(&place.path().join("p"))).unwrap();
        let mut project = Project::of(&folder).unwrap();
        assert_eq!(project, Project::default());
        let id = project.next_id();
        project.files.push(ProjectFile {
            id,
            name: "a.csv".into(),
            bytes: 7,
            checksum: "0".into(),
            usage: Use::Unseen,
            columns: ChosenColumns::default(),
            is_example: false,
        });
        folder.write_project(&project.text()).unwrap();
        assert_eq!(Project::of(&folder).unwrap(), project);
        let text = project.text();
        folder.write_project(&text[..text.len() / 2]).unwrap();
        let error = Project::of(&folder).unwrap_err().to_string();
        assert!(error.contains("project.json: is damaged"), "{error}");
        folder.write_project(&text.replace("\"version\": 1", "\"version\": 9")).unwrap();
        let error = Project::of(&folder).unwrap_err().to_string();
        assert!(error.contains("later version"), "{error}");
    }
}
