//! The files of a project as they are read: tables, columns, records.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use anyhow::{Result, anyhow, bail};
use hysid_records::{Data, Looked, Roles};
use hysid_tables::{Reading, Table};

use crate::folder::Folder;
use crate::project::{Project, ProjectFile, Understanding, Use};

/// The files of a project as they are read.
#[derive(Default)]
pub struct View {
    understanding: Understanding,
    /// The file that tells the columns, if they are guessed.
    first: Option<u64>,
    /// Each file, in the order of the project.
    pub files: Vec<Arc<FileView>>,
    /// Which column is what; `None` without a file, or with [`View::problem`].
    pub roles: Option<Roles>,
    /// Why the columns of the first file cannot be told apart.
    pub problem: Option<String>,
    /// All training files together, once they were asked for.
    together: OnceLock<Arc<Data>>,
}

/// A file as it is read.
pub struct FileView {
    /// Its number.
    pub id: u64,
    /// The table, if it can be read.
    pub table: Option<TableView>,
    /// The data, if the columns can be used.
    pub data: Option<Arc<Data>>,
    /// Why it cannot be used.
    pub problem: Option<String>,
    roles: Option<Roles>,
}

/// A table as it is read.
pub struct TableView {
    /// How its file is stored and laid out, in words.
    pub read_as: String,
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub looked: Looked,
}

impl View {
    /// Reads the files of a project. What was read already in the same way is taken from the view `before`.
    pub fn of(project: &Project, folder: &Folder, before: &View) -> Self {
        let understanding = &project.understanding;
        // Models are fitted to training files: they tell the columns.
        let first = project.files_for(Use::Training).chain(&project.files).next();
        let mut view = Self {
            understanding: understanding.clone(),
            first: first.map(|file| file.id),
            ..Self::default()
        };
        let is_read_alike = before.understanding.reading == understanding.reading;
        let reading = match understanding.reading.reading() {
            Ok(reading) => reading,
            Err(problem) => {
                view.problem = Some(problem.to_string());
                return view;
            }
        };
        let mut first_table = None;
        if before.understanding == *understanding && before.first == view.first {
            (view.roles, view.problem) = (before.roles.clone(), before.problem.clone());
        } else if let Some(first) = first {
            match read(&first.name, folder, &reading) {
                Err(problem) => view.problem = Some(format!("{problem:#}")),
                Ok(table) => {
                    match Roles::detect(&table, &understanding.choice()) {
                        Ok(roles) => view.roles = Some(roles),
                        Err(problem) => view.problem = Some(format!("{problem:#}")),
                    }
                    first_table = Some((first.id, table));
                }
            }
        }
        let read_before = |file: &ProjectFile| {
            let mut known = before.files.iter().filter(|_| is_read_alike);
            known.find(|known| known.id == file.id && known.roles == view.roles).cloned()
        };
        for file in &project.files {
            let of_file = read_before(file).unwrap_or_else(|| {
                let table = match first_table.take_if(|(id, _)| *id == file.id) {
                    Some((_, table)) => Ok(table),
                    None => read(&file.name, folder, &reading),
                };
                let of = first.map_or("", |first| &first.name);
                Arc::new(FileView::of(file.id, table, view.roles.as_ref(), of, understanding))
            });
            view.files.push(of_file);
        }
        view
    }

    /// A file as it is read.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn file(&self, id: u64) -> Result<&Arc<FileView>> {
        self.files.iter().find(|file| file.id == id).ok_or_else(|| anyhow!("there is no file {id}"))
    }

    /// The data of a file.
    ///
    /// # Errors
    /// There is none of this number, or it cannot be used.
    pub fn data(&self, id: u64) -> Result<Arc<Data>> {
        let file = self.file(id)?;
        let problem = || file.problem.clone().or_else(|| self.problem.clone()).unwrap_or_default();
        file.data.clone().ok_or_else(|| anyhow!(problem()))
    }

    /// The training files of the project that this is a view of, as one set of data.
    ///
    /// # Errors
    /// No training file, or files that cannot be used.
    pub fn training(&self, project: &Project, folder: &Folder) -> Result<Arc<Data>> {
        let files: Vec<&ProjectFile> = project.files_for(Use::Training).collect();
        match (files.as_slice(), self.together.get()) {
            ([], _) => bail!("there are no training data: drop a file, or choose one for training"),
            ([one], _) => return self.data(one.id),
            (_, Some(together)) => return Ok(Arc::clone(together)),
            _ => {}
        }
        let roles = self.roles.clone().ok_or_else(|| anyhow!(self.problem.clone().unwrap_or_default()))?;
        let reading = &project.understanding.reading;
        let as_read = reading.reading()?;
        let tables = files.iter().map(|file| read(&file.name, folder, &as_read)).collect::<Result<_>>()?;
        let data = Arc::new(Data::new(tables, roles, reading.zero)?);
        Ok(Arc::clone(self.together.get_or_init(|| data)))
    }
}

impl FileView {
    /// `of` is the file that the roles are of.
    fn of(
        id: u64,
        table: Result<Table>,
        roles: Option<&Roles>,
        of: &str,
        understanding: &Understanding,
    ) -> Self {
        let mut view = Self { id, table: None, data: None, problem: None, roles: roles.cloned() };
        let table = match table {
            Ok(table) => table,
            Err(problem) => {
                view.problem = Some(format!("{problem:#}"));
                return view;
            }
        };
        let looked = Looked::of(&table, roles);
        view.table = Some(TableView { read_as: table.described(), rows: table.rows(), looked });
        let Some(roles) = roles else { return view };
        let data = roles
            .check_against(&table, of)
            .and_then(|()| Data::new(vec![table], roles.clone(), understanding.reading.zero));
        match data {
            Ok(data) => view.data = Some(Arc::new(data)),
            Err(problem) => view.problem = Some(format!("{problem:#}")),
        }
        view
    }
}

/// The table of a file of this name, by which errors call it.
///
/// # Errors
/// A file that cannot be read or is no table.
pub fn read(name: &str, folder: &Folder, reading: &Reading) -> Result<Table> {
    let content = folder.read(&folder.data(name))?;
    Table::from_bytes(Path::new(name), content, reading)
}
