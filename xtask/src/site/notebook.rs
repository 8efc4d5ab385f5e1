//! Notebooks as pages: text, code, and the outputs that the notebook stores.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::{Context, Result};
use serde_json::Value;

/// A notebook as a page, and the images that it shows.
pub struct NotebookPage {
    pub text: String,
    /// Content by file name, in base64.
    pub images: BTreeMap<String, String>,
}

/// The page of the notebook `name`.
pub fn page(name: &str, notebook: &str) -> Result<NotebookPage> {
    let notebook: Value = serde_json::from_str(notebook).with_context(|| format!("{name} is no notebook"))?;
    let cells = notebook["cells"].as_array().with_context(|| format!("{name} has no cells"))?;
    let mut page = NotebookPage { text: String::new(), images: BTreeMap::new() };
    for cell in cells {
        let source = joined(&cell["source"]);
        if cell["cell_type"] == "markdown" {
            let _ = write!(page.text, "{source}\n\n");
            continue;
        }
        page.block("python", &source);
        for output in cell["outputs"].as_array().into_iter().flatten() {
            page.output(name, output);
        }
    }
    Ok(page)
}

impl NotebookPage {
    fn block(&mut self, language: &str, text: &str) {
        let _ = write!(self.text, "```{language}\n{}\n```\n\n", text.trim_end());
    }

    /// A picture if the output has one, otherwise its text.
    fn output(&mut self, name: &str, output: &Value) {
        let data = &output["data"];
        if let Some(image) = data.get("image/png") {
            let file = format!("{name}-{}.png", self.images.len() + 1);
            let _ = write!(self.text, "![Output of the cell above]({file})\n\n");
            self.images.insert(file, joined(image).split_whitespace().collect());
            return;
        }
        let text = joined(output.get("text").unwrap_or(&data["text/plain"]));
        if !text.trim().is_empty() {
            self.block("text", &text);
        }
    }
}

/// A text of a notebook: a string, or a list of lines with their ends.
fn joined(text: &Value) -> String {
    match text {
        Value::String(text) => text.clone(),
        Value::Array(lines) => lines.iter().filter_map(Value::as_str).collect(),
        _ => String::new(),
    }
}

/// The bytes of a text in base64.
pub fn bytes(base64: &str) -> Option<Vec<u8>> {
    let value = |sign: u8| {
        Some(match sign {
            b'A'..=b'Z' => sign - b'A',
            b'a'..=b'z' => sign - b'a' + 26,
            b'0'..=b'9' => sign - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        })
    };
    let mut bytes = Vec::with_capacity(base64.len() / 4 * 3);
    for group in base64.trim_end_matches('=').as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for &sign in group {
            bits = bits << 6 | u32::from(value(sign)?);
        }
        bits <<= 6 * (4 - group.len());
        bytes.extend(&bits.to_be_bytes()[1..group.len().max(1)]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_notebook_becomes_text_code_and_outputs() {
        let notebook = r##"{"cells": [
            {"cell_type": "markdown", "source": ["# Title\n", "text"]},
            {"cell_type": "code", "source": ["x = 1\n", "x"], "outputs": [
                {"output_type": "stream", "text": ["a\n"]},
                {"output_type": "execute_result", "data": {"text/html": ["<b>"], "text/plain": ["1"]}},
                {"output_type": "display_data", "data": {"image/png": "UE5H\n", "text/plain": ["<Figure>"]}}]}]}"##;
        let page = page("magnet", notebook).unwrap();
        let expected = "# Title\ntext\n\n```python\nx = 1\nx\n```\n\n```text\na\n```\n\n```text\n1\n```\n\n\
                        ![Output of the cell above](magnet-1.png)\n\n";
        assert_eq!(page.text, expected);
        assert_eq!(bytes(&page.images["magnet-1.png"]).unwrap(), b"PNG");
    }

    #[test]
    fn base64_is_read_as_rfc_4648_has_it() {
        for (text, base64) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
        ] {
            assert_eq!(bytes(base64).unwrap(), text.as_bytes(), "{base64}");
        }
        assert_eq!(bytes("\u{ff}bc="), None);
    }
}
