//! The files of a project as they are read: tables, columns, records.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use hysid_document::{Face, Problem, Result, problem};
use hysid_records::{Data, Roles, TableOverview};
use hysid_tables::{Reading, Table};

use crate::folder::Folder;
use crate::project::{ChosenColumns, Project, ProjectFile, Understanding, Use};
use crate::words::{Said, said};

/// Time between two views that are shown while files are read.
const BETWEEN_VIEWS: Duration = Duration::from_secs(1);

/// The files of a project as they are read.
#[derive(Default)]
pub struct View {
    understanding: Understanding,
    /// The files of the project, once all are read.
    of: Vec<ProjectFile>,
    /// Number of the file that determines the columns, if they are guessed.
    pub first: Option<u64>,
    pub files: Vec<Arc<FileView>>,
    /// Which column is what; `None` without a file, or with [`View::problem`].
    pub roles: Option<Roles>,
    /// Why the roles of the columns of the first file cannot be found.
    pub problem: Option<Said>,
    /// All training files together, once they were asked for.
    together: OnceLock<Arc<Data>>,
    /// The diagnosis of the training data, or why there is none, once it was asked for.
    pub diagnosis: OnceLock<std::result::Result<String, Said>>,
    /// The cycles of the training data, as the diagnosis.
    pub cycles: OnceLock<std::result::Result<String, Said>>,
}

/// A table that was read before its file was in the project, with the number of the file.
pub type AtHand = Option<(u64, Result<Table>)>;

pub struct FileView {
    pub id: u64,
    pub table: Option<TableView>,
    /// The data, if the columns can be used.
    pub data: Option<Arc<Data>>,
    /// Why it cannot be used.
    pub problem: Option<Said>,
    /// The roles of the first file, and the columns that were chosen for this one: with others it is read anew.
    like: Option<Roles>,
    chosen: ChosenColumns,
    is_used: bool,
    /// The roles of its own columns; some may be missing.
    pub roles: Option<Roles>,
}

pub struct TableView {
    /// How its file is stored and laid out, in words.
    pub read_as: String,
    pub rows: usize,
    pub looked: TableOverview,
}

impl View {
    /// Reads the files of a project. What was read already in the same way is taken from the view `before` and from what
    /// is `at_hand`. Gives `show` what has been read so far, now and then.
    pub fn of(
        project: &Project,
        folder: &Folder,
        before: &View,
        mut at_hand: AtHand,
        show: &dyn Fn(Self),
    ) -> Self {
        let understanding = &project.understanding;
        let first = project.first();
        let mut view = Self {
            understanding: understanding.clone(),
            first: first.map(|file| file.id),
            ..Self::default()
        };
        let is_read_alike = before.understanding.reading == understanding.reading;
        let reading = match understanding.reading.reading() {
            Ok(reading) => reading,
            Err(problem) => {
                view.problem = Some(said(&problem));
                view.of.clone_from(&project.files);
                return view;
            }
        };
        let mut table_of = |file: &ProjectFile| match at_hand.take_if(|(id, _)| *id == file.id) {
            Some((_, table)) => table,
            None => read(file, folder, &reading),
        };
        let mut first_table = None;
        if before.understanding == *understanding && before.first == view.first {
            (view.roles, view.problem) = (before.roles.clone(), before.problem.clone());
        } else if let Some(first) = first {
            let table = table_of(first);
            let roles = match &table {
                Ok(table) => Roles::detect(table, &understanding.choice()).map_err(|problem| said(&problem)),
                Err(problem) => Err(said(problem)),
            };
            match roles {
                Ok(roles) => view.roles = Some(roles),
                Err(problem) => view.problem = Some(problem),
            }
            first_table = Some((first.id, table));
        }
        let known = before.files.iter().filter(|known| is_read_alike && known.like == view.roles);
        let known: HashMap<u64, &Arc<FileView>> = known.map(|known| (known.id, known)).collect();
        let mut shown = Instant::now();
        for file in &project.files {
            let known = known
                .get(&file.id)
                .filter(|known| known.chosen == file.columns && known.is_used == (file.usage != Use::Unused));
            let of_file = known.map(|known| Arc::clone(known)).unwrap_or_else(|| {
                let table = match first_table.take_if(|(id, _)| *id == file.id) {
                    Some((_, table)) => table,
                    None => table_of(file),
                };
                let of = first.map_or("", |first| &first.name);
                Arc::new(FileView::of(file, table, view.roles.as_ref(), of, understanding))
            });
            view.files.push(of_file);
            if shown.elapsed() >= BETWEEN_VIEWS {
                show(view.so_far());
                shown = Instant::now();
            }
        }
        view.of.clone_from(&project.files);
        view
    }

    /// The same without what is known of all files together.
    fn so_far(&self) -> Self {
        Self {
            understanding: self.understanding.clone(),
            first: self.first,
            files: self.files.clone(),
            roles: self.roles.clone(),
            problem: self.problem.clone(),
            ..Self::default()
        }
    }

    /// The same without a file, which is then read again.
    pub fn without(&self, id: u64) -> Self {
        let mut view = self.so_far();
        view.files.retain(|file| file.id != id);
        // It may be the one that tells the columns.
        view.first = view.first.filter(|first| *first != id);
        view
    }

    /// True if all files of a project are read with its present choices.
    pub fn is_of(&self, project: &Project) -> bool {
        self.of == project.files && self.is_read_as(&project.understanding)
    }

    /// True if those files that are read are read like this.
    pub fn is_read_as(&self, understanding: &Understanding) -> bool {
        self.understanding == *understanding
    }

    pub fn file(&self, id: u64) -> Result<&Arc<FileView>> {
        self.files.iter().find(|file| file.id == id).ok_or_else(|| problem!("there is no file {id}"))
    }

    /// True if the columns of a file have other names than those of the first.
    pub fn is_renamed(&self, id: u64) -> bool {
        let own = self.file(id).ok().and_then(|file| file.roles.as_ref());
        own.is_some_and(|own| Some(own.names()) != self.roles.as_ref().map(Roles::names))
    }

    pub fn data(&self, id: u64) -> Result<Arc<Data>> {
        let file = self.file(id)?;
        let problem = file.problem.as_ref().or(self.problem.as_ref());
        let not_read = || "this file is not read".into();
        file.data.clone().ok_or_else(|| problem.map_or_else(not_read, |said| said.clone().into()))
    }

    /// The training files of the project that this is a view of, as one set of data.
    pub fn training(&self, project: &Project, folder: &Folder) -> Result<Arc<Data>> {
        let files: Vec<&ProjectFile> = project.files_for(Use::Training).collect();
        match (files.as_slice(), self.together.get()) {
            ([], _) => {
                return Err(problem!("there are no training data: drop a file, or choose one for training"));
            }
            ([one], _) => return self.data(one.id),
            (_, Some(together)) => return Ok(Arc::clone(together)),
            _ => {}
        }
        let problem = || self.problem.clone().unwrap_or_else(|| "the files are not read".into());
        let roles = self.roles.clone().ok_or_else(|| Problem::from(problem()))?;
        let reading = &project.understanding.reading;
        let as_read = reading.reading()?;
        let with_roles = |file: &&ProjectFile| {
            let view = self.file(file.id)?;
            let own = view.roles.clone().filter(|_| view.problem.is_none());
            let own =
                own.ok_or_else(|| view.problem.clone().map_or_else(|| problem().into(), Problem::from))?;
            Ok((read(file, folder, &as_read)?, own))
        };
        let tables = files.iter().map(with_roles).collect::<Result<_>>()?;
        let data = Arc::new(Data::of_files(tables, roles, reading.zero)?);
        Ok(Arc::clone(self.together.get_or_init(|| data)))
    }
}

impl FileView {
    /// `of` is the file that the roles are of.
    fn of(
        file: &ProjectFile,
        table: Result<Table>,
        like: Option<&Roles>,
        of: &str,
        understanding: &Understanding,
    ) -> Self {
        let (id, chosen, is_used) = (file.id, file.columns.clone(), file.usage != Use::Unused);
        let mut view = Self {
            id,
            table: None,
            data: None,
            problem: None,
            like: like.cloned(),
            chosen,
            is_used,
            roles: None,
        };
        let table = match table {
            Ok(table) => table,
            Err(problem) => {
                view.problem = Some(said(&problem));
                return view;
            }
        };
        let found = like.map(|like| match file.name == of {
            true => (like.clone(), None),
            false => like.in_table(&table, of, &file.columns.choice()),
        });
        let (roles, doubt) = found.unzip();
        let looked = TableOverview::of(&table, roles.as_ref(), Face::Studio);
        view.table = Some(TableView { read_as: table.described(), rows: table.rows(), looked });
        view.roles.clone_from(&roles);
        let (Some(like), Some(roles)) = (like, roles) else { return view };
        let data = match doubt.flatten() {
            // It may be a wanted output, or the motion of a mass.
            Some(_) if !is_used => return view,
            Some(problem) => Err(problem),
            None => Data::of_files(vec![(table, roles)], like.clone(), understanding.reading.zero),
        };
        match data {
            Ok(data) => view.data = Some(Arc::new(data)),
            Err(problem) => view.problem = Some(said(&problem)),
        }
        view
    }
}

/// The table of a file, whose name errors have.
pub fn read(file: &ProjectFile, folder: &Folder, reading: &Reading) -> Result<Table> {
    let name = &file.name;
    folder.read_data(file.id, name, |content| Table::from_bytes(Path::new(name), content, reading))
}
