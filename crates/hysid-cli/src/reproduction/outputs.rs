//! The files of `hysid reproduce`: their names, and how Hysid recognizes its own.

use std::path::Path;

use hysid_files::{Destination, Kind};
use hysid_paper::{Experiment, FurtherFile};

use super::rendering::CSV_HEADER;

/// The folder that files go to.
#[derive(Debug, Clone, Copy)]
pub struct Outputs<'a> {
    pub folder: &'a Path,
    /// Files that Hysid did not write are replaced too.
    pub force: bool,
}

impl Outputs<'_> {
    pub fn page(&self, name: &str) -> Destination {
        self.destination(&format!("{name}.html"), Kind::Page)
    }

    pub fn markdown(&self, name: &str) -> Destination {
        self.destination(&format!("{name}.md"), Kind::Marked("# ", "Made by hysid ".into()))
    }

    pub fn tables(&self, name: &str) -> Destination {
        self.destination(&format!("{name}.csv"), Kind::Beginning(CSV_HEADER.into()))
    }

    /// Page, Markdown and tables of one experiment or of all together.
    pub fn rendered(&self, name: &str) -> [Destination; 3] {
        [self.page(name), self.markdown(name), self.tables(name)]
    }

    /// A file that only this experiment has; `None` if it has none of this name.
    pub fn further(&self, experiment: Experiment, name: &str) -> Option<Destination> {
        let file = experiment.further_files().iter().find(|file| file.name == name)?;
        Some(self.further_file(file))
    }

    pub fn of(&self, experiment: Experiment) -> Vec<Destination> {
        let name = experiment.name();
        let further = experiment.further_files();
        let further = further.iter().map(|file| self.further_file(file));
        self.rendered(name).into_iter().chain(further).collect()
    }

    fn further_file(&self, file: &FurtherFile) -> Destination {
        self.destination(
            file.name,
            file.header.map_or(Kind::Drawing, |header| Kind::Beginning(header.into())),
        )
    }

    fn destination(&self, name: &str, kind: Kind) -> Destination {
        Destination::new(self.folder.join(name), kind, self.force)
    }
}
