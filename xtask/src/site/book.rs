//! Which files of the repository are pages of the book, and what their links become there.
//!
//! The pages are those of `docs/SUMMARY.md`. Links in the repository lead from file to file, so that they also work
//! where the repository is browsed; in the book, a link to another page stays within the book, images and other files
//! of `docs/` are copied, and a link to anything else leads to the repository on the net.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, bail};

use crate::markdown::{links, resolve};

/// The table of contents.
pub const SUMMARY: &str = "docs/SUMMARY.md";

/// Where the documents are that belong into the book.
const DOCUMENTS: &str = "docs/";

/// Where files that are not in the book can be read.
const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// The pages of the book.
pub struct Book {
    /// Path in the book by path in the repository.
    pages: BTreeMap<String, String>,
}

/// A page with the links of the book.
pub struct BookPage {
    pub text: String,
    /// The files beside pages that it shows or links, by their path in the repository.
    pub files: BTreeSet<String>,
}

impl Book {
    /// The book of this table of contents.
    pub fn of_summary(summary: &str) -> Result<Self> {
        let mut pages = BTreeMap::new();
        for link in links(summary) {
            let Some(path) = resolve(SUMMARY, link.target) else {
                bail!("{SUMMARY}:{}: `{}` is outside the repository", link.line, link.target);
            };
            if pages.insert(path.clone(), place(&path)).is_some() {
                bail!("{SUMMARY}:{}: {path} is listed twice", link.line);
            }
        }
        Ok(Self { pages })
    }

    /// The pages: path in the repository and path in the book.
    pub fn pages(&self) -> impl Iterator<Item = (&str, &str)> {
        self.pages.iter().map(|(path, place)| (path.as_str(), place.as_str()))
    }

    /// The documents among these files that the table of contents leaves out.
    pub fn left_out<'a>(&self, paths: &'a BTreeSet<String>) -> Vec<&'a str> {
        let is_document =
            |path: &str| path.starts_with(DOCUMENTS) && (path.ends_with(".md") || path.ends_with(".ipynb"));
        let paths = paths.iter().map(String::as_str);
        paths
            .filter(|path| is_document(path) && *path != SUMMARY && !self.pages.contains_key(*path))
            .collect()
    }

    /// The text of the file `path` with links as the book needs them.
    pub fn page(&self, path: &str, text: &str) -> BookPage {
        let from = self.pages.get(path).cloned().unwrap_or_else(|| place(path));
        let mut page = BookPage { text: String::with_capacity(text.len()), files: BTreeSet::new() };
        let mut copied = 0;
        for link in links(text).into_iter().filter(|link| !link.is_elsewhere()) {
            let (file, anchor) = link.file_and_anchor();
            let Some(target) = resolve(path, file) else { continue };
            page.text.push_str(&text[copied..link.range.start]);
            copied = link.range.end;
            if let Some(to) = self.pages.get(&target) {
                page.text.push_str(&relative(&from, to));
            } else if is_copied(&target) {
                page.text.push_str(&relative(&from, &place(&target)));
                page.files.insert(target);
            } else {
                page.text.push_str(&format!("{REPOSITORY}/blob/main/{target}"));
            }
            page.text.push_str(anchor);
        }
        page.text.push_str(&text[copied..]);
        page
    }
}

/// Where a file of the repository is in the book: documents without their folder, and the pages of the repository
/// itself beside them. The README is the first page.
pub fn place(path: &str) -> String {
    if let Some(document) = path.strip_prefix(DOCUMENTS) {
        return match document.strip_suffix(".ipynb") {
            Some(notebook) => format!("{notebook}.md"),
            None => document.to_owned(),
        };
    }
    match path.strip_suffix("README.md") {
        Some("") => "index.md".into(),
        Some(folder) => format!("{}.md", folder.trim_end_matches('/')),
        None => path.to_lowercase(),
    }
}

/// True for images, and for files of the documents that are not pages, such as data.
fn is_copied(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or_default();
    let is_image = [".svg", ".png"].iter().any(|end| name.ends_with(end));
    is_image || path.starts_with(DOCUMENTS) && name.contains('.') && !name.ends_with(".md")
}

/// The link from one path to another of the same root.
fn relative(from: &str, to: &str) -> String {
    let folder: Vec<&str> = from.split('/').collect();
    let folder = &folder[..folder.len() - 1];
    let target: Vec<&str> = to.split('/').collect();
    let shared = folder.iter().zip(&target).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..", folder.len() - shared);
    up.chain(target[shared..].iter().copied()).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn book() -> Book {
        let summary = "[Start](../README.md)\n- [Theory](theory.md)\n- [Fit](how-to/fit.md)\n- [Speed]\
                       (../benchmarks/README.md)\n- [Piezo](notebooks/piezo.ipynb)\n";
        Book::of_summary(&summary.replace("]\n", "]")).unwrap()
    }

    #[test]
    fn pages_have_their_place_in_the_book() {
        let book = book();
        let pages: Vec<_> = book.pages().collect();
        let expected = [
            ("README.md", "index.md"),
            ("benchmarks/README.md", "benchmarks.md"),
            ("docs/how-to/fit.md", "how-to/fit.md"),
            ("docs/notebooks/piezo.ipynb", "notebooks/piezo.md"),
            ("docs/theory.md", "theory.md"),
        ];
        assert_eq!(pages, expected);
    }

    #[test]
    fn links_are_rewritten_for_the_book() {
        let page = book().page(
            "docs/how-to/fit.md",
            "[a](../theory.md#1-operators) [b](../../README.md) ![c](../images/d.svg) [e](../../crates) [f](#g) \
             [h](https://i.org/j.md) ![k](../../benchmarks/growth.svg \"title\") [l](../notebooks/piezo.ipynb) \
             [m](../data/n.csv) [o](../data) [p](../SUMMARY.md) tail",
        );
        let main = format!("{REPOSITORY}/blob/main");
        assert_eq!(
            page.text,
            format!(
                "[a](../theory.md#1-operators) [b](../index.md) ![c](../images/d.svg) [e]({main}/crates) [f](#g) \
                 [h](https://i.org/j.md) ![k](../benchmarks/growth.svg \"title\") [l](../notebooks/piezo.md) \
                 [m](../data/n.csv) [o]({main}/docs/data) [p]({main}/docs/SUMMARY.md) tail"
            )
        );
        let files = ["benchmarks/growth.svg", "docs/data/n.csv", "docs/images/d.svg"].map(str::to_owned);
        assert_eq!(page.files, files.into());
        assert_eq!(book().page("README.md", "[a](docs/theory.md)").text, "[a](theory.md)");
    }

    #[test]
    fn documents_that_the_summary_leaves_out_are_named() {
        let paths = [SUMMARY, "docs/theory.md", "docs/new.md", "docs/images/a.svg", "xtask/notes.md"];
        assert_eq!(book().left_out(&paths.map(str::to_owned).into()), ["docs/new.md"]);
    }

    #[test]
    fn a_page_is_listed_once() {
        assert!(Book::of_summary("- [a](a.md)\n- [b](a.md)\n").is_err());
        assert!(Book::of_summary("- [a](../../a.md)\n").is_err());
    }
}
