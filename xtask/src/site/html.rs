//! What the link check needs of a page of HTML: its anchors and what it refers to.

use std::collections::BTreeSet;

/// A page of HTML.
#[derive(Debug, Default)]
pub struct Page {
    pub anchors: BTreeSet<String>,
    pub references: Vec<Reference>,
}

/// Something outside the page that it refers to.
#[derive(Debug, PartialEq, Eq)]
pub struct Reference {
    pub target: String,
    /// True for a link that a reader follows; false for what the browser loads with the page.
    pub is_followed: bool,
}

impl Page {
    /// Reads a page. Comments and the inside of scripts and styles are skipped.
    pub fn read(html: &str) -> Self {
        let mut page = Self::default();
        let mut rest = html;
        while let Some(start) = rest.find('<') {
            rest = &rest[start..];
            if let Some(comment) = rest.strip_prefix("<!--") {
                rest = comment.split_once("-->").map_or("", |(_, after)| after);
                continue;
            }
            let (name, attributes, after) = tag(&rest[1..]);
            for (key, value) in attributes {
                page.add(&name, &key, value);
            }
            rest = after;
            if name == "script" || name == "style" {
                rest = after.split_once(&format!("</{name}")).map_or("", |(_, after)| after);
            }
        }
        page
    }

    fn add(&mut self, tag: &str, key: &str, value: String) {
        match key {
            "id" => {
                self.anchors.insert(value);
            }
            "href" | "src" => {
                self.references.push(Reference { target: value, is_followed: tag == "a" });
            }
            _ => {}
        }
    }
}

/// The name of a tag, its attributes, and what follows it; `text` begins behind `<`.
fn tag(text: &str) -> (String, Vec<(String, String)>, &str) {
    let end_of_name = text.find(|c: char| c.is_whitespace() || c == '>').unwrap_or(text.len());
    let (name, mut rest) = text.split_at(end_of_name);
    let mut attributes = Vec::new();
    loop {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '/');
        if rest.is_empty() {
            break;
        }
        if let Some(after) = rest.strip_prefix('>') {
            rest = after;
            break;
        }
        let end = rest.find(|c: char| c.is_whitespace() || c == '=' || c == '>').unwrap_or(rest.len());
        // A sign that begins no attribute is passed over, so that every turn moves on.
        let (key, after) = rest.split_at(end.max(rest.chars().next().map_or(0, char::len_utf8)));
        let (value, after) = match after.strip_prefix('=') {
            Some(after) => attribute_value(after),
            None => ("", after),
        };
        attributes.push((key.to_ascii_lowercase(), without_entities(value)));
        rest = after;
    }
    (name.to_ascii_lowercase(), attributes, rest)
}

/// The value behind an equals sign, and what follows it.
fn attribute_value(text: &str) -> (&str, &str) {
    for quote in ['"', '\''] {
        if let Some(inside) = text.strip_prefix(quote) {
            return inside.split_once(quote).unwrap_or((inside, ""));
        }
    }
    text.split_at(text.find(|c: char| c.is_whitespace() || c == '>').unwrap_or(text.len()))
}

fn without_entities(text: &str) -> String {
    let entities = [("&quot;", "\""), ("&#39;", "'"), ("&#x27;", "'"), ("&lt;", "<"), ("&gt;", ">")];
    let text = entities.iter().fold(text.to_owned(), |text, (entity, sign)| text.replace(entity, sign));
    text.replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_and_references_are_read() {
        let html = "<!-- <a href='no'> --><h2 id=\"a\">A</h2><a class=b href='c.html?x&amp;y#d'>c</a>\
                    <script src=\"e.js\">if (a<b) { '<a href=\"no\">' }</script><img src=f.svg alt=\"\"/>";
        let page = Page::read(html);
        assert_eq!(page.anchors, BTreeSet::from(["a".to_owned()]));
        let found: Vec<_> = page.references.iter().map(|r| (r.target.as_str(), r.is_followed)).collect();
        assert_eq!(found, [("c.html?x&y#d", true), ("e.js", false), ("f.svg", false)]);
    }

    #[test]
    fn a_page_that_breaks_off_is_read_to_its_end() {
        for html in ["<", "<a", "<a href", "<a href=", "<a href=\"x", "<!-- ", "<script>", "<a =>", "<é é>"]
        {
            Page::read(html);
        }
    }
}
