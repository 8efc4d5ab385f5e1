//! Files and models that were removed, which can be brought back until the studio ends.

use std::path::{Path, PathBuf};

use hysid_document::{Result, problem};

use super::Studio;
use crate::folder::ProjectFolder;
use crate::project::{ProjectFile, ProjectModel};

/// Removals that can be undone.
const MOST_REMOVED: usize = 20;

/// What was removed, and its place in the list of the project.
pub(super) enum Removed {
    File(ProjectFile, usize),
    Model(Box<ProjectModel>, usize),
}

impl Removed {
    fn id(&self) -> u64 {
        match self {
            Self::File(file, _) => file.id,
            Self::Model(model, _) => model.begun.id,
        }
    }

    /// Its files: their names in the project, and where they are kept meanwhile.
    fn files(&self, studio: &Studio) -> Vec<(ProjectFolder, String, PathBuf)> {
        let (folder, names): (_, Vec<&String>) = match self {
            Self::File(file, _) => (ProjectFolder::Data, vec![&file.name]),
            Self::Model(model, _) => {
                (ProjectFolder::Models, std::iter::once(&model.file).chain(&model.report).collect())
            }
        };
        let kept = |(part, name): (usize, &String)| {
            (folder, name.clone(), studio.folder.removed(folder, self.id(), part))
        };
        names.into_iter().enumerate().map(kept).collect()
    }
}

impl Studio {
    /// Keeps what was removed. The oldest removals become final.
    pub(super) fn keep_removed(&self, removed: Removed) {
        let mut all = self.removed();
        all.push(removed);
        let excess = all.len().saturating_sub(MOST_REMOVED);
        let finally: Vec<Removed> = all.drain(..excess).collect();
        drop(all);
        self.forget(&finally);
    }

    /// Makes all removals final.
    pub(super) fn forget_removed(&self) {
        let finally = std::mem::take(&mut *self.removed());
        self.forget(&finally);
    }

    fn forget(&self, removed: &[Removed]) {
        removed.iter().flat_map(|one| one.files(self)).for_each(|(.., kept)| self.folder.remove(&kept));
    }

    /// Brings back a file or a model with the name that it had, or a free one.
    pub fn undo_removal(&self, id: u64) -> Result<()> {
        let removed = {
            let mut all = self.removed();
            let place = all.iter().position(|one| one.id() == id);
            all.remove(place.ok_or_else(|| problem!("this can no longer be undone"))?)
        };
        let mut names =
            removed.files(self).into_iter().map(|(folder, name, kept)| self.bring_back(folder, name, &kept));
        let restored = match &removed {
            Removed::File(file, place) => {
                let file = ProjectFile { name: names.next().expect("a file has a name")?, ..file.clone() };
                self.change_reading(|project| {
                    project.check_room()?;
                    project.files.insert((*place).min(project.files.len()), file);
                    Ok(())
                })
            }
            Removed::Model(model, place) => {
                let file = names.next().expect("a model has a file")?;
                let report = names.next().transpose()?;
                let model = ProjectModel { file, report, ..(**model).clone() };
                self.change(|project| {
                    project.models.insert((*place).min(project.models.len()), model);
                    Ok(())
                })
            }
        };
        if restored.is_err() {
            self.removed().push(removed);
        }
        restored
    }

    /// A file that stayed in the folder, because it was changed, has its name still.
    fn bring_back(&self, folder: ProjectFolder, name: String, kept: &Path) -> Result<String> {
        if !kept.exists() {
            return Ok(name);
        }
        let name = self.folder.free_name(folder, &name)?;
        let path = self.folder.in_folder(folder, &name);
        std::fs::rename(kept, path)
            .map_err(|error| problem!("{name}: cannot be brought back: {}", hysid_files::reason(&error)))?;
        Ok(name)
    }
}
