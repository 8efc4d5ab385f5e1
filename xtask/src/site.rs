//! `cargo xtask site`: the documentation as a site that is read in a browser, on the net or from the disk.
//!
//! mdBook turns pages into HTML. It is a tool and no dependency: a pinned version is installed once, beside the build,
//! because as a library it would be compiled with every developer command. The pages are copied to
//! `target/site-source` with their links rewritten ([`book`]); mdBook writes `target/site`, whose links are checked.

mod book;
mod html;
mod links;
mod notebook;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use self::book::{Book, SUMMARY, place};
use self::links::Site;
use crate::{program, repository, workspace_root};

/// The version of mdBook. Another one may write other anchors.
const MDBOOK: &str = "0.5.4";

/// The settings of mdBook and what it adds to each page, by their path in the repository.
const SETTINGS: [&str; 2] = ["docs/book.toml", "docs/site.css"];

/// The folder of the pages in the source of the book; `book.toml` names it too.
const PAGES: &str = "pages";

pub fn run() -> Result<()> {
    let target = program::target()?;
    let (source, site) = (target.join("site-source"), target.join("site"));
    let mdbook = mdbook(&target.join("tools"))?;

    println!("==> site");
    write_source(&workspace_root(), &source)?;
    // What an earlier build left would hide a page that is gone.
    remove(&site)?;
    let build = Command::new(mdbook).arg("build").arg(&source).arg("--dest-dir").arg(&site).output();
    let build = build.context("step `site`: mdbook could not be started")?;
    let said = String::from_utf8_lossy(&build.stderr);
    ensure!(build.status.success(), "step `site`: mdbook failed:\n{said}");

    let broken = Site::read(&site).context("step `site`")?.broken_links();
    for link in &broken {
        eprintln!("{link}");
    }
    ensure!(broken.is_empty(), "step `site` failed: broken links of the site: {}", broken.len());
    println!("{}", site.join("index.html").display());
    Ok(())
}

/// The pinned mdBook, installed if need be.
fn mdbook(tools: &Path) -> Result<PathBuf> {
    let program = tools.join("bin").join(format!("mdbook{}", std::env::consts::EXE_SUFFIX));
    let version = Command::new(&program).arg("--version").stdin(Stdio::null()).output();
    if version.is_ok_and(|said| String::from_utf8_lossy(&said.stdout).trim() == format!("mdbook v{MDBOOK}")) {
        return Ok(program);
    }
    println!("==> cargo install mdbook {MDBOOK}");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["install", "mdbook", "--locked", "--force", "--version", &format!("={MDBOOK}")])
        .args(["--no-default-features", "--features", "search", "--root"])
        .arg(tools)
        // Built in a folder of its own that is removed, not among our crates.
        .env_remove("CARGO_TARGET_DIR")
        .status()
        .context("step `site`: cargo install could not be started")?;
    ensure!(
        status.success(),
        "step `site`: mdbook could not be installed ({status}); it needs crates.io once: is there a network?"
    );
    Ok(program)
}

/// Writes the source of the book from the files of the repository.
fn write_source(root: &Path, source: &Path) -> Result<()> {
    let paths = repository::paths(root).context("step `site`")?;
    let book = Book::of_summary(&read(root, SUMMARY)?)?;
    let left_out = book.left_out(&paths);
    ensure!(left_out.is_empty(), "step `site`: {SUMMARY} does not list {}", left_out.join(", "));

    remove(source)?;
    let pages = source.join(PAGES);
    let mut files = BTreeSet::new();
    for (path, place) in book.pages().chain([(SUMMARY, "SUMMARY.md")]) {
        let mut text = read(root, path)?;
        if path.ends_with(".ipynb") {
            text = write_images_of_notebook(path, &text, &pages)?;
        }
        let page = book.page(path, &text);
        files.extend(page.files);
        write(&pages.join(place), page.text.as_bytes())?;
    }
    // A file that is neither there nor written with a notebook is found by the check of links.
    for path in files.intersection(&paths) {
        copy(&root.join(path), &pages.join(place(path)))?;
    }
    for path in SETTINGS {
        copy(&root.join(path), &source.join(crate::files::name(Path::new(path))))?;
    }
    Ok(())
}

/// Writes the images of a notebook; returns its text.
fn write_images_of_notebook(path: &str, notebook: &str, pages: &Path) -> Result<String> {
    let stem = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    let page = notebook::page(&stem, notebook)?;
    for (name, image) in &page.images {
        let bytes = notebook::bytes(image).with_context(|| format!("{path}: an image is not in base64"))?;
        write(&pages.join(place(path)).with_file_name(name), &bytes)?;
    }
    Ok(page.text)
}

/// The text of a file below `root`.
fn read(root: &Path, path: &str) -> Result<String> {
    fs::read_to_string(root.join(path)).with_context(|| format!("step `site`: {path} could not be read"))
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
