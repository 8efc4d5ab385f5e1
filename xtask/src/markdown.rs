//! Links in Markdown pages, for `tidy` and `site`.

use std::ops::Range;

/// The target of a link or an image.
#[derive(Debug, PartialEq, Eq)]
pub struct Link<'a> {
    /// The line, which counts from 1.
    pub line: usize,
    /// Text between the brackets, without a title.
    pub target: &'a str,
    /// Where it stands in the text.
    pub range: Range<usize>,
}

impl Link<'_> {
    /// The part that names a file, and the anchor with its `#`.
    pub fn file_and_anchor(&self) -> (&str, &str) {
        let at = self.target.find('#').unwrap_or(self.target.len());
        self.target.split_at(at)
    }

    /// True if the target is not a file of the repository: another site, or an anchor of the same page.
    pub fn is_elsewhere(&self) -> bool {
        self.target.contains("://")
            || self.target.starts_with("mailto:")
            || self.file_and_anchor().0.is_empty()
    }
}

/// Every `[text](target)`, `![text](target "title")` and `[name]: target` outside code.
pub fn links(text: &str) -> Vec<Link<'_>> {
    let mut links = Vec::new();
    let mut inside_block = false;
    let mut start = 0;
    for (number, line) in (1..).zip(text.split_inclusive('\n')) {
        if is_fence(line) {
            inside_block = !inside_block;
        }
        if !inside_block {
            links.extend(targets(line).into_iter().map(|range| Link {
                line: number,
                target: &line[range.clone()],
                range: start + range.start..start + range.end,
            }));
        }
        start += line.len();
    }
    links
}

/// True for a line that begins or ends a block of code.
pub fn is_fence(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with("```") || line.starts_with("~~~")
}

/// Where the targets stand in a line.
fn targets(line: &str) -> Vec<Range<usize>> {
    let word = |start: usize, text: &str| {
        let blank = text.len() - text.trim_start().len();
        let length = text.split_whitespace().next().map_or(0, str::len);
        (length > 0).then_some(start + blank..start + blank + length)
    };
    let mut found = Vec::new();
    let is_definition = line.trim_start().starts_with('[');
    if let Some(end) = line.find("]: ").filter(|_| is_definition) {
        found.extend(word(end + 3, &line[end + 3..]));
    }
    for (start, opening) in line.match_indices("](") {
        let inside_code = line[..start].matches('`').count() % 2 == 1;
        let start = start + opening.len();
        if !inside_code && let Some((inside, _)) = line[start..].split_once(')') {
            found.extend(word(start, inside));
        }
    }
    found
}

/// The path from the root that `target` means in the file `path`; none if it leads out of the root.
pub fn resolve(path: &str, target: &str) -> Option<String> {
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_where_they_stand() {
        let text = "[a](b.md#c) and ![d](e.svg \"title\")\n```\n[no](no.md)\n```\n`[no](no.md)`\n[f]: g.md\n";
        let links = links(text);
        let found: Vec<_> = links.iter().map(|link| (link.line, link.target)).collect();
        assert_eq!(found, [(1, "b.md#c"), (1, "e.svg"), (6, "g.md")]);
        assert!(links.iter().all(|link| &text[link.range.clone()] == link.target));
        assert_eq!(links[0].file_and_anchor(), ("b.md", "#c"));
    }

    #[test]
    fn targets_are_resolved_from_the_folder_of_their_page() {
        assert_eq!(resolve("docs/how-to/a.md", "../b.md").as_deref(), Some("docs/b.md"));
        assert_eq!(resolve("docs/a.md", "./b/c.md").as_deref(), Some("docs/b/c.md"));
        assert_eq!(resolve("a.md", "../b.md"), None);
    }
}
