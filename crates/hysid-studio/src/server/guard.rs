//! Access: only the page that this studio opened gets answers.
//!
//! A random token is in the address that is opened, and from then on in a cookie that the browser sends from this page
//! alone. A page of somebody else has neither; nor can it pretend to be this machine by a name of its own (DNS rebinding),
//! because `Host` must be the address of this server, and `Origin`, where there is one, too.

use std::sync::Arc;

use anyhow::{Result, anyhow};
use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::answer::Problem;

/// Bytes of a token.
const TOKEN_BYTES: usize = 24;

/// What a page may do: use what this server gives, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; font-src 'self'; form-action 'none'; base-uri 'none'; \
                      frame-ancestors 'none'";

/// Headers of every answer.
const HEADERS: [(HeaderName, &str); 6] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
];

/// The address, token and cookie of this studio.
#[derive(Clone)]
pub struct Guard(Arc<Known>);

struct Known {
    hosts: [String; 2],
    token: String,
    cookie: String,
}

/// A random token.
///
/// # Errors
/// A system without random numbers.
pub fn token() -> Result<String> {
    let mut random = [0; TOKEN_BYTES];
    getrandom::fill(&mut random).map_err(|error| anyhow!("no random numbers: {error}"))?;
    Ok(random.iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Guard {
    /// Of a server on this port.
    pub fn new(port: u16, token: String) -> Self {
        let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        // Cookies do not tell ports apart: two studios need two names.
        Self(Arc::new(Known { hosts, token, cookie: format!("hysid-studio-{port}") }))
    }

    /// Why a request is refused; `None` if it is not.
    fn refusal(&self, request: &Request) -> Option<Problem> {
        let headers = request.headers();
        let host = text(headers, &header::HOST).unwrap_or_default();
        if !self.0.hosts.iter().any(|known| known == host) {
            return Some(Problem::refused("request refused: wrong address"));
        }
        let own = format!("http://{host}");
        let origin = text(headers, &header::ORIGIN);
        let is_reading = matches!(*request.method(), Method::GET | Method::HEAD);
        if origin.is_some_and(|origin| origin != own) || (origin.is_none() && !is_reading) {
            return Some(Problem::refused("request refused: it did not come from the page of this studio"));
        }
        let is_opening = request.uri().path() == "/";
        let site = text(headers, &HeaderName::from_static("sec-fetch-site"));
        if !is_opening && site.is_some_and(|site| site != "same-origin" && site != "none") {
            return Some(Problem::refused("request refused: it did not come from the page of this studio"));
        }
        let has_token = self.has_cookie(headers) || (is_opening && self.has_token(request));
        let words = "The studio was restarted, or this page was not opened by it. Open the address that `hysid studio` has printed.";
        (!has_token).then(|| Problem::refused(words))
    }

    fn has_cookie(&self, headers: &HeaderMap) -> bool {
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(|value| value.to_str().ok());
        let mut pairs =
            cookies.flat_map(|cookies| cookies.split(';')).filter_map(|pair| pair.trim().split_once('='));
        pairs.any(|(name, value)| name == self.0.cookie && self.is_token(value))
    }

    fn has_token(&self, request: &Request) -> bool {
        let query = request.uri().query().unwrap_or_default();
        query.split('&').filter_map(|pair| pair.strip_prefix("token=")).any(|value| self.is_token(value))
    }

    /// Takes the same time wherever the first difference is.
    fn is_token(&self, value: &str) -> bool {
        let (value, token) = (value.as_bytes(), self.0.token.as_bytes());
        let differences = value.iter().zip(token).fold(0, |sum, (a, b)| sum | (a ^ b));
        value.len() == token.len() && differences == 0
    }

    /// The cookie that stands for the token from now on.
    fn cookie(&self) -> String {
        format!("{}={}; Path=/; HttpOnly; SameSite=Strict", self.0.cookie, self.0.token)
    }
}

fn text<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    // What is no text is none that is known.
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}

/// Lets the page of the studio through, and gives every answer its headers.
pub async fn check(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let opens = request.uri().path() == "/" && guard.has_token(&request);
    let mut response = match guard.refusal(&request) {
        Some(problem) => problem.into_response(),
        None => next.run(request).await,
    };
    let is_answered = response.status() == StatusCode::OK;
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if !headers.contains_key(header::CONTENT_SECURITY_POLICY) {
        headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    }
    if opens
        && is_answered
        && let Ok(cookie) = HeaderValue::from_str(&guard.cookie())
    {
        headers.insert(header::SET_COOKIE, cookie);
    }
    response
}
