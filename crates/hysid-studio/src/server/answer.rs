//! Answers: JSON, arrays of numbers, downloads, and problems in words.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::Json;
use axum::body::Body;
use axum::http::StatusCode;
use axum::http::header::{self, HeaderName, HeaderValue};
use axum::response::{IntoResponse, Response};
use hysid_document::Problem;
use serde::Serialize;
use serde_json::json;
use tokio::sync::OwnedSemaphorePermit;

use super::Shared;
use crate::studio::Studio;
use crate::words::{Said, said};

/// Why something cannot be done, in words.
#[derive(Debug)]
pub struct Refusal {
    status: StatusCode,
    words: Said,
}

impl Refusal {
    /// A problem with this HTTP status.
    pub fn new(status: StatusCode, words: impl Into<Said>) -> Self {
        let words: Said = words.into();
        let words = match words.text().trim().is_empty() {
            true => {
                format!("this is not possible: {}", status.canonical_reason().unwrap_or("refused")).into()
            }
            false => words,
        };
        Self { status, words }
    }

    /// A request that is refused.
    pub fn refused(words: &str) -> Self {
        Self::new(StatusCode::FORBIDDEN, words)
    }
}

impl From<Problem> for Refusal {
    fn from(problem: Problem) -> Self {
        let status = match problem {
            Problem::Busy(_) => StatusCode::CONFLICT,
            _ => StatusCode::BAD_REQUEST,
        };
        Self::new(status, said(&problem))
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, Json(json!({"error": self.words}))).into_response()
    }
}

/// A response, or why there is none.
pub type Answer<T> = Result<T, Refusal>;

/// Time after which a response is given up.
pub const LONGEST_COMPUTATION: Duration = Duration::from_secs(600);

/// Computes a response on a thread of its own: reads tables or runs models, one of few at a time.
pub async fn computed<T: Send + 'static>(
    shared: Shared,
    compute: impl FnOnce(&Arc<Studio>) -> hysid_document::Result<T> + Send + 'static,
) -> Answer<T> {
    let permit = Arc::clone(&shared.computing).acquire_owned().await;
    on_a_thread(shared, permit.ok(), compute).await
}

/// As [`computed`], for diagnoses: those that nobody waits for any more hold up only other diagnoses.
pub async fn diagnosed<T: Send + 'static>(
    shared: Shared,
    compute: impl FnOnce(&Arc<Studio>) -> hysid_document::Result<T> + Send + 'static,
) -> Answer<T> {
    let permit = Arc::clone(&shared.diagnosing).acquire_owned().await;
    on_a_thread(shared, permit.ok(), compute).await
}

/// Computes a quick response, which waits for no other.
pub async fn at_once<T: Send + 'static>(
    shared: Shared,
    compute: impl FnOnce(&Arc<Studio>) -> hysid_document::Result<T> + Send + 'static,
) -> Answer<T> {
    on_a_thread(shared, None, compute).await
}

/// A permit to compute, given back by whichever ends first: the computation or the longest time of one. A computation
/// without an end so holds up no other for ever.
struct Turn(Arc<Mutex<Option<OwnedSemaphorePermit>>>);

impl Drop for Turn {
    fn drop(&mut self) {
        drop(self.0.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

async fn on_a_thread<T: Send + 'static>(
    shared: Shared,
    permit: Option<OwnedSemaphorePermit>,
    compute: impl FnOnce(&Arc<Studio>) -> hysid_document::Result<T> + Send + 'static,
) -> Answer<T> {
    let (studio, longest) = (shared.studio, shared.longest);
    let permit = Turn(Arc::new(Mutex::new(permit)));
    let taken_back = Turn(Arc::clone(&permit.0));
    let timer = tokio::spawn(async move {
        tokio::time::sleep(longest).await;
        drop(taken_back);
    });
    let result = tokio::task::spawn_blocking(move || {
        let _permit = permit;
        compute(&studio)
    });
    let words = "this takes more than ten minutes: use fewer rows";
    let late = |_| Refusal::new(StatusCode::GATEWAY_TIMEOUT, words);
    let outcome = tokio::time::timeout(longest, result).await;
    timer.abort();
    match outcome.map_err(late)? {
        Ok(result) => Ok(result?),
        Err(_) => Err(Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "internal error in this computation; the project is unchanged",
        )),
    }
}

/// Arrays of numbers, one after the other, with the name of each.
pub struct Arrays {
    headers: Vec<(HeaderName, String)>,
    content: Vec<u8>,
}

impl Arrays {
    /// Arrays of these columns.
    pub fn of<V: AsRef<[f64]>>(columns: &[(&str, V)]) -> Self {
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let rows = columns.first().map_or(0, |(_, values)| values.as_ref().len());
        let mut content = Vec::with_capacity(8 * rows * columns.len());
        for (_, values) in columns {
            content.extend(values.as_ref().iter().flat_map(|value| value.to_le_bytes()));
        }
        let arrays = Self { headers: Vec::new(), content };
        arrays.with("x-columns", names.join(",")).with("x-rows", rows.to_string())
    }

    /// Arrays of one kind, each with a name of its own.
    pub fn named(kind: &str, all: &[(String, Vec<f64>)]) -> Self {
        let names: Vec<&String> = all.iter().map(|(name, _)| name).collect();
        let columns: Vec<(&str, &Vec<f64>)> = all.iter().map(|(_, values)| (kind, values)).collect();
        Self::of(&columns).with("x-names", encoded(&json!(names).to_string()))
    }

    /// With one more header.
    pub fn with(mut self, name: &'static str, value: String) -> Self {
        self.headers.push((HeaderName::from_static(name), value));
        self
    }
}

impl IntoResponse for Arrays {
    fn into_response(self) -> Response {
        let mut response = Response::new(Body::from(self.content));
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/octet-stream"));
        for (name, value) in self.headers {
            if let Ok(value) = HeaderValue::from_str(&value) {
                headers.insert(name, value);
            }
        }
        response
    }
}

/// Text for a header, as `encodeURIComponent` writes it.
pub fn encoded(text: &str) -> String {
    let letter = |byte: u8| match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => char::from(byte).to_string(),
        other => format!("%{other:02X}"),
    };
    text.bytes().map(letter).collect()
}

/// A file to be saved.
pub fn download(name: &str, kind: &'static str, content: Vec<u8>) -> Response {
    let mut response = Response::new(Body::from(content));
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    let disposition = format!("attachment; filename*=UTF-8''{}", encoded(name));
    if let Ok(disposition) = HeaderValue::from_str(&disposition) {
        headers.insert(header::CONTENT_DISPOSITION, disposition);
    }
    response
}

/// That something was done.
pub fn done() -> Response {
    Json(json!({})).into_response()
}

/// A value as JSON.
pub fn value(value: impl Serialize) -> Response {
    Json(value).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computation_without_an_end_holds_up_others_for_its_longest_time_only() {
        let place = tempfile::tempdir().unwrap();
        let folder = crate::folder::Folder::open(Some(place.path())).unwrap();
        let one = || Arc::new(tokio::sync::Semaphore::new(1));
        let (ending, is_over) = tokio::sync::watch::channel(false);
        let shared = Shared {
            studio: Arc::new(Studio::open(folder).unwrap()),
            computing: one(),
            diagnosing: one(),
            longest: Duration::from_millis(50),
            is_over,
        };
        let (release, released) = std::sync::mpsc::channel::<()>();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let first = computed(shared.clone(), move |_| Ok(released.recv().is_ok())).await;
            assert_eq!(first.unwrap_err().status, StatusCode::GATEWAY_TIMEOUT);
            assert_eq!(computed(shared.clone(), |_| Ok(7)).await.ok(), Some(7));
            assert_eq!(shared.computing.available_permits(), 1);
        });
        drop((release, ending));
    }

    #[test]
    fn arrays_follow_each_other_in_little_endian() {
        let arrays = Arrays::of(&[("a", vec![1.0, f64::NAN]), ("b", vec![-2.5, 0.0])]);
        assert_eq!(arrays.content.len(), 32);
        assert_eq!(arrays.content[..8], 1.0f64.to_le_bytes());
        assert_eq!(arrays.content[16..24], (-2.5f64).to_le_bytes());
        assert_eq!(arrays.headers[0].1, "a,b");
        assert_eq!(arrays.headers[1].1, "2");
        assert_eq!(encoded("a b/ü.json"), "a%20b%2F%C3%BC.json");
    }
}
