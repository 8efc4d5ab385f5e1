//! Files in the program's words: reading, and writing to a [`Destination`].

use std::fs;
use std::path::{self, Path, PathBuf};

use anyhow::{Error, Result, anyhow};
use hysid_document::shell::quoted;
pub use hysid_document::shell::shown;
use hysid_document::{Page, Problem};
pub use hysid_files::reason;
use hysid_files::{Destination, Failure, Kind};

use hysid_app::{origin, page_text};

use crate::messages::{Usage, note};

/// The content of a file, or of standard input for `-`.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    match path == Path::new("-") {
        true => hysid_files::read_from("-", std::io::stdin()),
        false => hysid_files::read(path),
    }
    .map_err(Error::msg)
}

/// A file in the current folder, named after a table that is read.
pub fn named_after(table: &Path, ending: &str) -> PathBuf {
    // Standard input has no name.
    let stem = table.file_stem().filter(|stem| *stem != "-").unwrap_or("data".as_ref());
    let mut name = stem.to_os_string();
    name.push(ending);
    PathBuf::from(name)
}

/// The place of a page, unless none is to be written.
pub fn page(no_report: bool, path: impl Into<PathBuf>, force: bool) -> Option<Destination> {
    (!no_report).then(|| Destination::new(path, Kind::Page, force))
}

/// Writes a file; the old one survives any failure. Says so if a copy of the old one is kept.
pub fn write(destination: &Destination, content: &[u8]) -> Result<()> {
    match destination.write(content) {
        Ok(kept) => say_kept(destination.path(), kept.as_deref()),
        Err(failure) => return Err(explained(failure)),
    }
    Ok(())
}

/// Writes a page, as [`write`] does. Its last section lists the command and these files.
pub fn write_page(destination: &Destination, mut page: Page, inputs: &[impl AsRef<Path>]) -> Result<()> {
    let inputs: Vec<&Path> = inputs.iter().map(AsRef::as_ref).collect();
    page.parts.push(origin::section(&command(), &inputs));
    write(destination, page_text(&page).as_bytes())
}

/// The command line as a shell takes it.
fn command() -> String {
    let arguments = std::env::args_os().skip(1);
    let quoted = arguments.map(|argument| quoted(&argument.to_string_lossy()));
    std::iter::once("hysid".to_string()).chain(quoted).collect::<Vec<_>>().join(" ")
}

/// Writes a file that took long to compute. If that fails, it is put elsewhere, and the error names the place.
pub fn write_or_rescue(destination: &Destination, what: &str, content: &[u8]) -> Result<()> {
    write(destination, content).map_err(|error| match hysid_files::rescue(destination.path(), content) {
        Some(place) => anyhow!("{error}; the {what} is in {}", shown(&place)),
        None => error,
    })
}

/// Says which files were written: what each is, and its path.
pub fn say_written<'p>(written: impl IntoIterator<Item = (&'p str, Option<&'p Path>)>) {
    for (what, path) in written {
        if let Some(path) = path {
            note(format_args!("{what:<8}{}", shown(path)));
        }
    }
}

/// Refuses `--json` where the table goes to stdout.
pub fn check_stdout(has_table: bool, json: bool) -> Result<()> {
    if has_table && json {
        let advice = "--json prints to stdout in place of the table: name a file for the table with -o";
        return Err(Usage(advice.into()).into());
    }
    Ok(())
}

/// Says where the file is that was replaced, if it is kept.
pub fn say_kept(path: &Path, kept: Option<&Path>) {
    if let Some(kept) = kept {
        note(format_args!("the file that was {} is kept as {}", shown(path), shown(kept)));
    }
}

/// A failure in the program's words.
pub fn explained(failure: Failure) -> anyhow::Error {
    match failure {
        Failure::NotOurs { .. } => {
            Usage(format!("{failure}: name another file, or replace it with --force")).into()
        }
        failure => anyhow!("{failure}"),
    }
}

/// A failure of a folder in the program's words.
pub fn explained_folder(failure: Failure) -> anyhow::Error {
    let advice = match failure {
        Failure::NotOurs { .. } | Failure::Changed(_) => {
            "name another folder with --out, or add --force, which keeps what it replaces as NAME.bak"
        }
        Failure::HoldsInput { .. } | Failure::NotPlain(_) => "name another folder with --out",
        failure => return anyhow!("{failure}"),
    };
    Usage(format!("{failure}: {advice}")).into()
}

/// Refuses, before the work begins, files that cannot be written, that Hysid did not write, or that are read too.
pub fn check_outputs<'d>(
    outputs: impl IntoIterator<Item = &'d Destination>,
    inputs: &[impl AsRef<Path>],
) -> Result<()> {
    let mut taken: Vec<&Path> = Vec::new();
    for output in outputs {
        let path = output.path();
        if let Some(input) = inputs.iter().map(AsRef::as_ref).find(|input| same(path, input)) {
            let advice = "would be overwritten: name another file with --out";
            return Err(Usage(format!("{} {advice}", input.display())).into());
        }
        if taken.iter().any(|other| same(path, other)) {
            let advice = match path.extension().is_some_and(|ending| ending == "html") {
                true => {
                    "the table and the page would have this name: name the table with another ending, such as \
                     .csv, or add --no-report"
                }
                false => "two results would have this name: name another file with --out",
            };
            return Err(Usage(format!("{}: {advice}", path.display())).into());
        }
        output.check().map_err(explained)?;
        taken.push(path);
    }
    Ok(())
}

/// The inputs of a command that reads no files.
pub const NO_INPUTS: [&Path; 0] = [];

/// Makes a folder for results, if it is not there.
pub fn make_folder(folder: &Path) -> Result<()> {
    if folder == Path::new("-") {
        return Err(
            Problem::request("-o -: the files need a folder, which stdout cannot be: name one").into()
        );
    }
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made: {}", folder.display(), reason(&error)))
}

/// True if both are the same file, under whatever name.
pub fn same(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        // At least one is not there yet.
        _ => match (path::absolute(a), path::absolute(b)) {
            (Ok(a), Ok(b)) => a == b,
            _ => a == b,
        },
    }
}
