//! The folder of a project: where its files are, and names that cannot leave it.

mod entrance;
mod readings;

use std::fs::{self, DirBuilder};
use std::io;
use std::path::{Path, PathBuf};

use hysid_core::words::{Hint, Words};
use hysid_document::visible::is_hidden;
use hysid_document::{Problem, Result, problem};
use hysid_files::{Destination, Failure, Kind, Lock};

use entrance::ENTRANCE;
use readings::Readings;

/// Name of a project's folder if none is given.
const DEFAULT: &str = "hysid-project";

/// Folders that are tried if others are in use.
const MOST_FOLDERS: usize = 100;

/// The file with what was chosen and made.
const PROJECT: &str = "project.json";

/// Longest name of a file that is kept.
const LONGEST_NAME: usize = 120;

/// The best model so far of a fit that is under way.
const BEST_SO_FAR: &str = ".best-so-far.json";

/// Begins the names of files on their way. 16 random digits follow.
pub const UPLOAD: &str = ".upload-";

/// Begins the names of files of what was removed.
const REMOVED: &str = ".removed-";

/// A folder in that of a project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProjectFolder {
    Data,
    Models,
}

impl ProjectFolder {
    fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Models => "models",
        }
    }
}

/// The folder of a project, locked for this process.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    readings: Readings,
    _lock: Lock,
}

impl Folder {
    /// Opens a project's folder, or makes it. Without a name it is `hysid-project` in the present folder, or
    /// `hysid-project-2` and so on while another studio has that open.
    ///
    /// # Errors
    /// A folder that is in use, that is none of a project, or that cannot be written to.
    pub fn open(asked: Option<&Path>) -> Result<Self> {
        if let Some(asked) = asked {
            return Self::locked(asked)?.ok_or_else(|| {
                let advice = "another studio has this project open: close it, or name another folder";
                let words = Words::from(format!("{}: {advice} with ", asked.display()));
                Problem::Request(words + Hint::Option("project"))
            });
        }
        for number in 1..=MOST_FOLDERS {
            let name = if number == 1 { DEFAULT.into() } else { format!("{DEFAULT}-{number}") };
            if let Some(folder) = Self::locked(Path::new(&name))? {
                return Ok(folder);
            }
        }
        let words =
            format!("the default folders up to {DEFAULT}-{MOST_FOLDERS} are in use: name a folder with ");
        Err(Problem::Other(Words::from(words) + Hint::Option("project")))
    }

    /// `None` if another process has it.
    fn locked(asked: &Path) -> Result<Option<Self>> {
        let shown = asked.display();
        check_ours(asked)?;
        make_private(asked)?;
        for inner in [ProjectFolder::Data, ProjectFolder::Models] {
            make_private(&asked.join(inner.name()))?;
            check_folder(&asked.join(inner.name()))?;
        }
        let root = fs::canonicalize(asked).map_err(|error| problem!("{shown}: {error}"))?;
        match Lock::acquire(&root.join(PROJECT)) {
            Ok(lock) => {
                let data = root.join(ProjectFolder::Data.name());
                for folder in [&root, &data, &root.join(ProjectFolder::Models.name())] {
                    hysid_files::remove_leftovers(folder);
                    remove_ours(folder);
                }
                Ok(Some(Self { root, readings: Readings::left_in(&data), _lock: lock }))
            }
            Err(Failure::InUse(_)) => Ok(None),
            Err(failure) => Err(problem!("{failure}")),
        }
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    pub fn name(&self) -> String {
        self.root.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    pub fn data(&self, file: &str) -> PathBuf {
        self.in_folder(ProjectFolder::Data, file)
    }

    pub fn models(&self, file: &str) -> PathBuf {
        self.in_folder(ProjectFolder::Models, file)
    }

    pub fn in_folder(&self, inner: ProjectFolder, file: &str) -> PathBuf {
        self.root.join(inner.name()).join(plain(file))
    }

    /// Where a file of what was removed is kept, by the number of that.
    pub fn removed(&self, inner: ProjectFolder, id: u64, part: usize) -> PathBuf {
        self.in_folder(inner, &format!("{REMOVED}{id}-{part}"))
    }

    /// The path of the best model so far of a fit that is under way.
    pub fn best_so_far(&self) -> PathBuf {
        self.root.join(ProjectFolder::Models.name()).join(BEST_SO_FAR)
    }

    /// The path of the model of a fit that has ended, until the project names it.
    pub fn finished(&self, fit: u64) -> PathBuf {
        self.root.join(ProjectFolder::Models.name()).join(format!(".finished-{fit}.json"))
    }

    /// A name, made of the one that it is given, that no file of this folder has.
    pub fn free_name(&self, inner: ProjectFolder, given: &str) -> Result<String> {
        let folder = self.root.join(inner.name());
        check_folder(&folder)?;
        let entries = fs::read_dir(&folder).map_err(|error| cannot_read(&folder, &error))?;
        let taken: Vec<String> =
            entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        Ok(safe_name(given, &taken.iter().map(String::as_str).collect::<Vec<&str>>()))
    }

    /// The content of a file of the project.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>> {
        self.check_file(path)?;
        hysid_files::read(path).map_err(Problem::from)
    }

    /// Removes a file of the project; one that is not there, or not plain, stays as it is.
    pub fn remove(&self, path: &Path) {
        if self.check_file(path).is_ok() {
            let _ = fs::remove_file(path);
        }
    }

    /// Moves a file of the project away if it is one that Hysid wrote or took, and nobody changed. True if another stays.
    pub fn set_aside_if(
        &self,
        path: &Path,
        aside: &Path,
        is_as_it_was: impl FnOnce(fs::File) -> io::Result<bool>,
    ) -> bool {
        let is_plain = self.check_file(path).is_ok();
        if is_plain && fs::File::open(path).and_then(is_as_it_was).unwrap_or(false) {
            let _ = fs::rename(path, aside);
        }
        fs::symlink_metadata(path).is_ok()
    }

    /// Refuses what is no plain file, or is in a folder that is a link: it may be anywhere.
    fn check_file(&self, path: &Path) -> Result<()> {
        check_folder(path.parent().unwrap_or(&self.root))?;
        let found = fs::symlink_metadata(path).map_err(|error| cannot_read(path, &error))?;
        if !found.is_file() {
            return Err(problem!("{}: is no plain file, and a project holds only those", path.display()));
        }
        Ok(())
    }

    /// Writes a file of the project as a whole or not at all. Only what the project wrote before is replaced.
    ///
    /// # Errors
    /// A file of others in its place; a folder that cannot be written to.
    pub fn write(&self, path: &Path, kind: Kind, content: &[u8]) -> Result<()> {
        if fs::symlink_metadata(path).is_ok() {
            self.check_file(path)?;
        }
        check_folder(path.parent().unwrap_or(&self.root))?;
        let destination = Destination::new(path, kind, false).keeping_the_old(false);
        destination.write(content).map(|_| ()).map_err(|failure| problem!("{failure}"))
    }

    /// Text of the project file, if there is one.
    pub fn read_project(&self) -> Result<Option<String>> {
        let path = self.root.join(PROJECT);
        if fs::symlink_metadata(&path).is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound) {
            return Ok(None);
        }
        let text = String::from_utf8(self.read(&path)?);
        text.map(Some).map_err(|_| problem!("{}: is no text", path.display()))
    }

    /// Writes what was chosen and made, as a whole or not at all.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn write_project(&self, text: &str) -> Result<()> {
        self.write(&self.root.join(PROJECT), Kind::Project, text.as_bytes())
    }
}

/// Error for a file that cannot be read.
pub fn cannot_read(path: &Path, error: &std::io::Error) -> Problem {
    hysid_files::unreadable(&path.display().to_string(), error).into()
}

/// Refuses a link in the place of a folder of the project.
fn check_folder(folder: &Path) -> Result<()> {
    match fs::symlink_metadata(folder) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(problem!("{}: is no folder, and a project holds no links", folder.display())),
        Err(error) => Err(cannot_read(folder, &error)),
    }
}

/// Makes a folder that only the user can enter; one that is there stays as it is.
fn make_private(folder: &Path) -> Result<()> {
    let failed = |error: std::io::Error| {
        problem!("{}: cannot be made: {}", folder.display(), hysid_files::reason(&error))
    };
    fs::create_dir_all(folder.parent().unwrap_or(Path::new(""))).map_err(failed)?;
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    match builder.create(folder) {
        Err(error) if !folder.is_dir() => Err(failed(error)),
        _ => Ok(()),
    }
}

/// Removes what a studio that was killed left in a folder: uploads, and what had been removed.
fn remove_ours(folder: &Path) {
    let is_upload = |name: &str| {
        let digits = name.strip_prefix(UPLOAD);
        digits
            .is_some_and(|digits| digits.len() == 16 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
    };
    let is_removed = |name: &str| {
        let numbers = name.strip_prefix(REMOVED).and_then(|numbers| numbers.split_once('-'));
        numbers.is_some_and(|(id, part)| id.parse::<u64>().is_ok() && ["0", "1"].contains(&part))
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(|name| is_upload(name) || is_removed(name)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Refuses a folder with other things in it.
fn check_ours(folder: &Path) -> Result<()> {
    if folder.join(PROJECT).exists() {
        return Ok(());
    }
    let mut entries = match fs::read_dir(folder) {
        Ok(entries) => entries.flatten(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => {
            return Err(problem!("{}: cannot be opened: {}", folder.display(), hysid_files::reason(&error)));
        }
    };
    if entries.any(|entry| !is_of_lock(&entry)) {
        let advice = "is not a Hysid project and is not empty: name another folder with ";
        let words = Words::from(format!("{} {advice}", folder.display()));
        return Err(Problem::Request(words + Hint::Option("project")));
    }
    Ok(())
}

/// True for what a studio makes before the project has a file.
fn is_of_lock(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name();
    ["data", "models", ENTRANCE].iter().any(|ours| name == *ours)
        || name.to_string_lossy().starts_with(".project.json")
}

/// The last part of a name: no path leaves the folder.
pub fn plain(file: &str) -> &str {
    let name = file.rsplit(['/', '\\']).next().unwrap_or_default();
    if name.is_empty() || name == "." || name == ".." { "_" } else { name }
}

/// A name for a file in the folder, made of the one that it is given: no folders, nothing that a file system treats in its
/// own way, and none of those that are `taken`, in capital or small letters.
pub fn safe_name(given: &str, taken: &[&str]) -> String {
    let kept: String = plain(given)
        .chars()
        .map(|letter| if is_hidden(letter) || "<>:\"|?*".contains(letter) { '_' } else { letter })
        .collect();
    let kept = kept.trim().trim_start_matches('.').trim_end_matches(['.', ' ']);
    let (stem, ending) = match kept.rsplit_once('.') {
        Some((stem, ending)) if !stem.is_empty() && ending.len() <= 8 => (stem, format!(".{ending}")),
        _ => (kept, String::new()),
    };
    let stem: String = stem.chars().take(LONGEST_NAME).collect();
    let stem = if stem.is_empty() || is_reserved(&stem) { format!("data{stem}") } else { stem };
    let is_free = |name: &String| !taken.iter().any(|other| other.to_lowercase() == name.to_lowercase());
    let numbered = (2..).map(|number| format!("{stem} ({number}){ending}"));
    let mut names = std::iter::once(format!("{stem}{ending}")).chain(numbered);
    names.find(is_free).expect("there is always a further number")
}

/// Names of devices on Windows.
fn is_reserved(stem: &str) -> bool {
    let stem = stem.to_uppercase();
    let is_port = |name: &str| {
        stem.starts_with(name) && stem.len() == 4 && stem.ends_with(|c: char| c.is_ascii_digit())
    };
    ["CON", "PRN", "AUX", "NUL"].contains(&stem.as_str()) || is_port("COM") || is_port("LPT")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leaves_the_folder() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(Some(&place.path().join("p"))).unwrap();
        let data = folder.root().join("data");
        for name in ["../../etc/passwd", "..\\..\\x.csv", "/etc/passwd", "..", ".", "", "a/..", "C:\\x"] {
            let safe = safe_name(name, &[]);
            for path in [folder.data(&safe), folder.data(name)] {
                assert_eq!(path.parent(), Some(data.as_path()), "{name}");
                assert!(!path.ends_with(".."), "{name}");
            }
        }
    }

    #[test]
    fn names_stay_what_they_are_where_they_can() {
        assert_eq!(safe_name("train.csv", &[]), "train.csv");
        assert_eq!(safe_name("Versuch 3 (µm).csv", &[]), "Versuch 3 (µm).csv");
        assert_eq!(safe_name("train.csv", &["Train.csv", "train (2).csv"]), "train (3).csv");
        assert_eq!(safe_name(".hidden", &[]), "hidden");
        assert_eq!(safe_name("<script>.csv", &[]), "_script_.csv");
        assert_eq!(safe_name("con.csv", &[]), "datacon.csv");
        assert_eq!(safe_name("a\u{202e}vsc.exe", &[]), "a_vsc.exe");
        assert_eq!(safe_name("../..", &[]), "_");
        assert!(safe_name(&"x".repeat(500), &[]).len() <= LONGEST_NAME);
    }

    #[test]
    fn files_of_others_stay_and_uploads_of_killed_studios_go() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("p");
        fs::create_dir_all(path.join("data")).unwrap();
        let upload = path.join("data/.upload-0123456789abcdef");
        fs::write(&upload, "half").unwrap();
        fs::write(path.join("data/.upload-mine"), "mine").unwrap();
        let folder = Folder::open(Some(&path)).unwrap();
        assert!(!upload.exists() && path.join("data/.upload-mine").exists());
        fs::write(folder.models("3-pnn.json"), "mine").unwrap();
        assert_eq!(folder.free_name(ProjectFolder::Models, "3-pnn.json").unwrap(), "3-pnn (2).json");
        assert!(folder.write(&folder.models("3-pnn.json"), Kind::Model, b"{}").is_err());
        assert_eq!(fs::read(folder.models("3-pnn.json")).unwrap(), b"mine");
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_nowhere() {
        use std::os::unix::fs::symlink;
        let place = tempfile::tempdir().unwrap();
        let other = place.path().join("other");
        fs::create_dir(&other).unwrap();
        fs::write(other.join("thesis.doc"), "mine").unwrap();
        let path = place.path().join("p");
        let folder = Folder::open(Some(&path)).unwrap();
        symlink(other.join("thesis.doc"), folder.data("a.csv")).unwrap();
        assert!(folder.read(&folder.data("a.csv")).unwrap_err().to_string().contains("is no plain file"));
        assert!(folder.write(&folder.data("a.csv"), Kind::Model, b"{}").is_err());
        fs::remove_dir_all(path.join("data")).unwrap();
        symlink(&other, path.join("data")).unwrap();
        let thesis = folder.data("thesis.doc");
        folder.remove(&thesis);
        assert!(folder.read(&thesis).is_err() && thesis.exists());
        assert!(folder.free_name(ProjectFolder::Data, "b.csv").is_err());
        drop(folder);
        assert!(Folder::open(Some(&path)).unwrap_err().to_string().contains("holds no links"));
    }

    #[test]
    fn a_project_is_open_once_and_other_folders_are_left_alone() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("p");
        let folder = Folder::open(Some(&path)).unwrap();
        assert!(Folder::open(Some(&path)).unwrap_err().to_string().contains("--project"));
        folder.write_project("{\n  \"format\": \"hysid-project\"\n}").unwrap();
        drop(folder);
        assert!(Folder::open(Some(&path)).unwrap().read_project().unwrap().is_some());
        let other = place.path().join("mine");
        fs::create_dir(&other).unwrap();
        fs::write(other.join("thesis.doc"), "x").unwrap();
        assert!(Folder::open(Some(&other)).unwrap_err().to_string().contains("is not a Hysid project"));
        assert_eq!(fs::read_dir(&other).unwrap().count(), 1);
    }
}
