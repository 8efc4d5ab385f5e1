//! `cargo xtask site`: the documentation as a site that is read in a browser, on the net or from the disk.
//!
//! The pages are copied to `target/site-source` with their links rewritten ([`book`]), notebooks by nbconvert; mdBook
//! writes `target/site`, whose links lychee checks. The tools are pinned in `xtask/requirements.txt`.

mod book;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use self::book::{Book, SUMMARY, place};
use crate::cargo::{target, workspace_root};
use crate::environment::Environment;
use crate::repository;

/// The settings of mdBook and what it adds to each page, by their path in the repository.
const SETTINGS: [&str; 2] = ["docs/book.toml", "docs/site.css"];

/// The folder of the pages in the source of the book; `book.toml` names it too.
const PAGES: &str = "pages";

/// Kinds of an output that a page shows, the best first.
const OUTPUTS: &str = "--NbConvertBase.display_data_priority=['image/png', 'text/plain']";

/// Text that nbconvert writes in the place of an image's description.
const UNDESCRIBED: &str = "![png](";

pub fn run() -> Result<()> {
    let tools = Environment::of_tools()?;
    println!("==> site");
    let (source, site) = (target()?.join("site-source"), target()?.join("site"));
    write_source(&tools, &workspace_root(), &source)?;
    // What an earlier build left would hide a page that is gone.
    remove(&site)?;
    said(tools.program("mdbook").arg("build").arg(&source).arg("--dest-dir").arg(&site))?;
    let pages = pages(&site)?;
    // Links to other sites are not followed.
    let check = ["--offline", "--include-fragments", "--no-progress", "--quiet"];
    said(tools.program("lychee").args(check).args(&pages))?;
    for page in &pages {
        let text = fs::read_to_string(page).with_context(|| page.display().to_string())?;
        // The site is also read without a network.
        let is_foreign = text.contains("src=\"http") || text.contains("src=\"//");
        ensure!(!is_foreign, "step `site`: {} loads a part from another site", page.display());
    }
    println!("{}", site.join("index.html").display());
    Ok(())
}

/// Runs a tool; what it prints is shown if it fails.
fn said(tool: &mut Command) -> Result<()> {
    let name = tool.get_program().to_string_lossy().into_owned();
    let output = tool.output().with_context(|| format!("step `site`: {name} could not be started"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let printed = text(&output.stdout) + &text(&output.stderr);
    ensure!(output.status.success(), "step `site`: {name} failed:\n{printed}");
    Ok(())
}

/// The pages below a folder.
fn pages(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(pages(&path)?);
        } else if path.extension().is_some_and(|ending| ending == "html") {
            found.push(path);
        }
    }
    Ok(found)
}

/// Writes the source of the book from the files of the repository.
fn write_source(tools: &Environment, root: &Path, source: &Path) -> Result<()> {
    let paths = repository::paths(root).context("step `site`")?;
    let book = Book::of_summary(&read(&root.join(SUMMARY))?)?;
    let left_out = book.left_out(&paths);
    ensure!(left_out.is_empty(), "step `site`: {SUMMARY} does not list {}", left_out.join(", "));

    remove(source)?;
    let pages = source.join(PAGES);
    let mut files = BTreeSet::new();
    for (path, place) in book.pages().chain([(SUMMARY, "SUMMARY.md")]) {
        let to = pages.join(place);
        let text = match path.ends_with(".ipynb") {
            true => converted(tools, &root.join(path), &to)?,
            false => read(&root.join(path))?,
        };
        let page = book.page(path, &text);
        files.extend(page.files);
        write(&to, page.text.as_bytes())?;
    }
    // A file that is neither there nor written with a notebook is found by the check of links.
    for path in files.intersection(&paths) {
        copy(&root.join(path), &pages.join(place(path)))?;
    }
    for path in SETTINGS {
        copy(&root.join(path), &source.join(path.rsplit('/').next().unwrap_or(path)))?;
    }
    Ok(())
}

/// The text of a notebook as a page at this place, beside which its images are written.
fn converted(tools: &Environment, notebook: &Path, place: &Path) -> Result<String> {
    let folder = place.parent().context("a page lies in a folder")?;
    let arguments = ["-m", "nbconvert", "--to", "markdown", OUTPUTS, "--output-dir"];
    said(tools.python().args(arguments).arg(folder).arg(notebook))?;
    Ok(read(place)?.replace(UNDESCRIBED, "![Output of the cell above]("))
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("step `site`: {} could not be read", path.display()))
}

fn write(path: &Path, content: &[u8]) -> Result<()> {
    let folder = path.parent().context("a file lies in a folder")?;
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, content))
        .with_context(|| format!("step `site`: {} could not be written", path.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let content =
        fs::read(from).with_context(|| format!("step `site`: {} could not be read", from.display()))?;
    write(to, &content)
}

/// Removes a folder that may be there.
fn remove(folder: &Path) -> Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            bail!("step `site`: {} could not be removed: {error}", folder.display())
        }
        _ => Ok(()),
    }
}
