//! The links of the built site: each leads to a file of the site, and to an anchor that is there.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::html::{Page, Reference};
use crate::markdown;

/// The built site.
#[derive(Default)]
pub struct Site {
    /// Every file by its path from the root of the site, with `/`.
    pub files: BTreeSet<String>,
    /// The pages among them.
    pub pages: BTreeMap<String, Page>,
}

impl Site {
    /// The site in a folder.
    pub fn read(root: &Path) -> Result<Self> {
        let mut site = Self::default();
        site.add(root, "")?;
        Ok(site)
    }

    /// Adds the files of a folder, whose path from the root ends with `/` unless it is empty.
    fn add(&mut self, folder: &Path, prefix: &str) -> Result<()> {
        let unreadable = || format!("{} cannot be read", folder.display());
        for entry in fs::read_dir(folder).with_context(unreadable)? {
            let entry = entry.with_context(unreadable)?;
            let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if entry.file_type().with_context(unreadable)?.is_dir() {
                self.add(&entry.path(), &format!("{path}/"))?;
                continue;
            }
            if path.ends_with(".html") {
                let html =
                    fs::read_to_string(entry.path()).with_context(|| format!("{path} cannot be read"))?;
                self.pages.insert(path.clone(), Page::read(&html));
            }
            self.files.insert(path);
        }
        Ok(())
    }

    /// What is wrong with its links, a line each. Links to other sites are not followed, but no page may load a part
    /// from one, because the site is also read without a network.
    pub fn broken_links(&self) -> Vec<String> {
        let references = self
            .pages
            .iter()
            .flat_map(|(path, page)| page.references.iter().map(move |reference| (path, reference)));
        references
            .filter_map(|(path, reference)| {
                let what = self.fault(path, reference)?;
                Some(format!("{path}: `{}`: {what}", reference.target))
            })
            .collect()
    }

    fn fault(&self, path: &str, reference: &Reference) -> Option<&'static str> {
        let target = reference.target.as_str();
        let is_outside = target.contains("://") || target.starts_with("//");
        if is_outside {
            return (!reference.is_followed).then_some("is loaded from another site");
        }
        if ["mailto:", "javascript:", "data:"].iter().any(|scheme| target.starts_with(scheme)) {
            return None;
        }
        let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
        let file = file.split('?').next().unwrap_or_default();
        let resolved = match file {
            "" => Some(path.to_owned()),
            file => markdown::resolve(path, &without_percents(file)),
        };
        let Some(resolved) = resolved.filter(|resolved| self.files.contains(resolved)) else {
            return Some("there is no such file");
        };
        if anchor.is_empty() {
            return None;
        }
        let has_anchor =
            self.pages.get(&resolved).is_some_and(|page| page.anchors.contains(&without_percents(anchor)));
        (!has_anchor).then_some("there is no such anchor")
    }
}

/// A link with `%20` and the like as the text that it means.
fn without_percents(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()).filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(pages: &[(&str, &str)], others: &[&str]) -> Site {
        let pages: BTreeMap<_, _> =
            pages.iter().map(|&(path, html)| (path.to_owned(), Page::read(html))).collect();
        let files = pages.keys().cloned().chain(others.iter().map(|&path| path.to_owned())).collect();
        Site { files, pages }
    }

    #[test]
    fn good_links_are_passed() {
        let html = "<h1 id='ä'></h1><a href='#%C3%A4'></a><a href='b/c.html#d'></a><img src='e f.svg'>\
                    <img src='e%20f.svg'><a href='https://example.org/nowhere'></a><a href='mailto:a@b'></a>";
        let site = site(&[("a.html", html), ("b/c.html", "<p id=d><a href='../a.html'>")], &["e f.svg"]);
        assert_eq!(site.broken_links(), Vec::<String>::new());
    }

    #[test]
    fn each_kind_of_broken_link_is_found() {
        let html = "<a href='nowhere.html'></a><a href='b.html#nowhere'></a><a href='#nowhere'></a>\
                    <img src='nowhere.svg'><a href='../b.html'></a><a href='f'></a>\
                    <script src='https://example.org/x.js'></script><link href='//example.org/x.css'>";
        let site = site(&[("a.html", html), ("b.html", "<p id=c>")], &["f/g.svg"]);
        let found = site.broken_links();
        let expected = [
            "a.html: `nowhere.html`: there is no such file",
            "a.html: `b.html#nowhere`: there is no such anchor",
            "a.html: `#nowhere`: there is no such anchor",
            "a.html: `nowhere.svg`: there is no such file",
            "a.html: `../b.html`: there is no such file",
            "a.html: `f`: there is no such file",
            "a.html: `https://example.org/x.js`: is loaded from another site",
            "a.html: `//example.org/x.css`: is loaded from another site",
        ];
        assert_eq!(found, expected);
    }
}
