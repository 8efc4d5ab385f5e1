//! The files of a project as they are read: tables, columns, records.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
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
            match read(first, folder, &reading) {
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
                    None => read(file, folder, &reading),
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
        file.data.clone().ok_or_else(|| anyhow!("{}", file.problem.clone().unwrap_or_default()))
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

/// The table of a file, which errors call by its name.
///
/// # Errors
/// A file that cannot be read or is no table.
pub fn read(file: &ProjectFile, folder: &Folder, reading: &Reading) -> Result<Table> {
    read_named(&file.name, folder, reading)
}

/// As [`read`], by the name of a file.
///
/// # Errors
/// A file that cannot be read or is no table.
pub fn read_named(name: &str, folder: &Folder, reading: &Reading) -> Result<Table> {
    let path = folder.data(name);
    let content = fs::read(&path)
        .map_err(|error| anyhow!("cannot be read: {}", hysid_files::reason(&error)))
        .with_context(|| path.display().to_string())?;
    Table::from_bytes(Path::new(name), content, reading)
}
