//! The files of the page, which are part of the program.

use axum::extract::Path;
use axum::http::header;
use axum::response::{Html, IntoResponse, Response};
use hysid_document::html;

use super::answer::{Answer, Problem};

/// The page.
const PAGE: &str = include_str!("../../page/index.html");

/// Its files, by their addresses.
const FILES: &[(&str, &[u8])] = &[];

/// The page itself.
pub async fn page() -> Html<&'static str> {
    Html(PAGE)
}

/// A file of the page.
pub async fn asset(Path(path): Path<String>) -> Answer<Response> {
    if path == "document.css" {
        return Ok(([(header::CONTENT_TYPE, "text/css; charset=utf-8")], document_style()).into_response());
    }
    let found = FILES.iter().find(|(name, _)| *name == path);
    let missing = || Problem::new(axum::http::StatusCode::NOT_FOUND, "the page has no such file");
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

/// The style of what the program writes as documents, inside elements of the class `document`.
fn document_style() -> String {
    html::style(".document")
}
