//! The files of the page, which are part of the program.

use std::sync::LazyLock;

use axum::extract::Path;
use axum::http::header::{self, HeaderValue};
use axum::response::{Html, IntoResponse, Response};
use hysid_document::html;
use sha2::{Digest, Sha256};

use super::answer::{Answer, Refusal};

const PAGE: &str = include_str!("../../page/index.html");

/// The page that shows a report.
const REPORT: &str = include_str!("../../page/report.html");

/// Script that a report may run: the program's own, and no other.
static REPORT_SCRIPT: LazyLock<String> = LazyLock::new(|| checksum(html::script_of_pages()));

/// A script as a policy names it.
pub fn checksum(script: &str) -> String {
    format!("'sha256-{}'", base64(&Sha256::digest(script)))
}

/// The files of a list, each with its content.
macro_rules! files {
    ($($name:literal,)*) => {
        &[$(($name, include_bytes!(concat!("../../page/", $name)))),*]
    };
}

/// Files of the page, by their addresses.
const FILES: &[(&str, &[u8])] = files![
    "controls.js",
    "elements.js",
    "main.js",
    "notices.js",
    "numbers.js",
    "plots/figure.js",
    "plots/gestures.js",
    "plots/history-points.js",
    "plots/link.js",
    "plots/loop-points.js",
    "plots/marks.js",
    "plots/min-max-levels.js",
    "plots/pace.js",
    "plots/painter.js",
    "plots/palette.js",
    "plots/points.js",
    "plots/record-figures.js",
    "plots/save.js",
    "plots/scatter-points.js",
    "plots/svg.js",
    "plots/trace.js",
    "project.js",
    "report.js",
    "server.js",
    "steps/compare.js",
    "steps/data.js",
    "steps/drives.js",
    "steps/example.js",
    "steps/fit-progress.js",
    "steps/identify.js",
    "steps/invert.js",
    "steps/judge.js",
    "steps/model-choice.js",
    "steps/plan.js",
    "steps/restoring-force.js",
    "steps/take-away.js",
    "steps/training-page.js",
    "steps/try.js",
    "steps/use-case.js",
    "studio.css",
    "uploads.js",
    "uplot/LICENSE",
    "uplot/uPlot.esm.js",
    "uplot/uPlot.min.css",
];

/// The page itself.
pub fn page() -> Html<&'static str> {
    Html(PAGE)
}

/// The page that shows a report, in a frame that has this policy too.
pub fn report() -> Response {
    let policy = format!(
        "default-src 'none'; script-src 'self' {}; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'; \
         form-action 'none'; base-uri 'none'; frame-ancestors 'none'",
        *REPORT_SCRIPT
    );
    with_policy(Html(REPORT), &policy)
}

/// The text of a report. A project may be of somebody else: the policy names the program's own script and no other.
pub fn report_text(text: String) -> Response {
    let policy = format!(
        "default-src 'none'; script-src {}; style-src 'unsafe-inline'; img-src data: blob:; form-action 'none'; \
         base-uri 'none'; frame-ancestors 'none'; sandbox allow-scripts allow-downloads",
        *REPORT_SCRIPT
    );
    with_policy(Html(text), &policy)
}

fn with_policy(page: impl IntoResponse, policy: &str) -> Response {
    let mut response = page.into_response();
    if let Ok(policy) = HeaderValue::from_str(policy) {
        response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

/// A file of the page.
pub async fn asset(Path(path): Path<String>) -> Answer<Response> {
    if path == "assets/document.css" {
        return Ok(([(header::CONTENT_TYPE, "text/css; charset=utf-8")], document_style()).into_response());
    }
    let found = FILES.iter().find(|(name, _)| *name == path);
    let missing = || Refusal::new(axum::http::StatusCode::NOT_FOUND, "the page has no such file");
    let (name, content) = found.ok_or_else(missing)?;
    Ok(([(header::CONTENT_TYPE, kind(name))], *content).into_response())
}

fn kind(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "text/plain; charset=utf-8",
    }
}

/// Bytes as text of base 64.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letters = |three: &[u8]| {
        let bits =
            three.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        let letter = |place: usize| match place <= three.len() {
            true => char::from(LETTERS[(bits >> (18 - 6 * place)) as usize & 63]),
            false => '=',
        };
        [letter(0), letter(1), letter(2), letter(3)]
    };
    bytes.chunks(3).flat_map(letters).collect()
}

/// The style of what the program writes as documents, inside elements of the class `document`.
fn document_style() -> String {
    html::style(".document")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;

    fn files_in(folder: &Path, within: &str) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = format!("{within}{}", entry.file_name().to_string_lossy());
            match entry.file_type().unwrap().is_dir() {
                true => found.extend(files_in(&entry.path(), &format!("{name}/"))),
                false => found.extend([name]),
            }
        }
        found
    }

    #[test]
    fn the_program_has_every_file_of_the_page() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        let mut known: BTreeSet<String> = FILES.iter().map(|(name, _)| (*name).to_string()).collect();
        known.extend(["index.html", "report.html"].map(String::from));
        assert_eq!(known, files_in(&folder, ""));
    }

    #[test]
    fn the_page_is_below_500_kilobytes() {
        let bytes: usize = FILES.iter().map(|(_, content)| content.len()).sum();
        assert!(PAGE.len() + document_style().len() + bytes < 500_000, "{bytes}");
    }

    #[test]
    fn the_page_loads_nothing_from_elsewhere_and_has_no_inline_script_or_style() {
        for (name, content) in FILES.iter().chain([&("index.html", PAGE.as_bytes())]) {
            let text = String::from_utf8_lossy(content);
            let is_library = name.starts_with("uplot/");
            let outside = ["https://", "http://"]
                .iter()
                .any(|scheme| text.contains(scheme) && !text.contains("http://www.w3.org/"));
            assert!(is_library || !outside, "{name}");
        }
        assert!(!PAGE.contains("<style") && !PAGE.contains(" style=") && !PAGE.contains("<script>"));
    }

    #[test]
    fn base_64_is_that_of_rfc_4648() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
