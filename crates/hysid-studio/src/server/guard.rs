//! Access: only the page that this studio opened can read the project.
//!
//! Every request about the project needs the key in a header. A page of somebody else has no key; nor can it pretend to
//! be this machine by a name of its own (DNS rebinding), because `Host` must be the address of this server, and `Origin`,
//! where there is one, too. The files of the page itself are those of the program, and need no key.

use std::sync::Arc;

use axum::Extension;
use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde_json::json;

use super::answer::{Refusal, value};
use super::assets;
use super::connections::Proof;
use super::keys::Keys;

const KEY: HeaderName = HeaderName::from_static("x-hysid-key");

/// Content policy of a page: it uses only what this server gives.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; font-src 'self'; form-action 'none'; base-uri 'none'; \
                      frame-ancestors 'none'";

/// Headers of every response.
const HEADERS: [(HeaderName, &str); 6] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
];

/// The address and the keys of this studio.
#[derive(Clone)]
pub struct Guard(Arc<GuardState>);

struct GuardState {
    host: String,
    origin: String,
    cookie: String,
    keys: Arc<Keys>,
}

impl Guard {
    /// Of a server on this port.
    pub fn new(port: u16, keys: Arc<Keys>) -> Self {
        // `localhost` may be the address of another server, at `::1`.
        let host = format!("127.0.0.1:{port}");
        // Cookies do not tell ports apart: two studios need two names.
        Self(Arc::new(GuardState {
            origin: format!("http://{host}"),
            host,
            cookie: format!("hysid-studio-{port}"),
            keys,
        }))
    }

    /// Why a request is refused before its key is looked at; `None` if it is not.
    fn refusal(&self, request: &Request) -> Option<Refusal> {
        let headers = request.headers();
        if text(headers, &header::HOST) != Some(&self.0.host) {
            return Some(Refusal::refused(&format!("request refused: the studio is at {}", self.0.origin)));
        }
        let origin = text(headers, &header::ORIGIN);
        let is_reading = matches!(*request.method(), Method::GET | Method::HEAD);
        let is_foreign = origin.map_or(!is_reading, |origin| origin != self.0.origin);
        let site = text(headers, &HeaderName::from_static("sec-fetch-site"));
        let is_opening = request.uri().path() == "/";
        if is_foreign || (!is_opening && site.is_some_and(|site| site != "same-origin" && site != "none")) {
            return Some(Refusal::refused("request refused: it did not come from the page of this studio"));
        }
        None
    }

    /// Response to an address with a token: the page without it, and a ticket; `None` for any other address.
    fn opening(&self, request: &Request) -> Option<Response> {
        let query = request.uri().query().filter(|_| request.uri().path() == "/")?;
        let token = query.split('&').find_map(|pair| pair.strip_prefix("token="))?;
        if request.method() != Method::GET {
            return None;
        }
        let Some(ticket) = self.0.keys.open(token) else {
            // The page shows the project if this browser has the key, and says what to do otherwise.
            return Some((StatusCode::FORBIDDEN, assets::page()).into_response());
        };
        let mut response = (StatusCode::SEE_OTHER, [(header::LOCATION, "/")]).into_response();
        self.set_cookie(&mut response, &ticket, 60);
        Some(response)
    }

    fn set_cookie(&self, response: &mut Response, ticket: &str, seconds: u32) {
        let name = &self.0.cookie;
        let cookie =
            format!("{name}={ticket}; Path=/api/session; HttpOnly; SameSite=Strict; Max-Age={seconds}");
        if let Ok(cookie) = HeaderValue::from_str(&cookie) {
            response.headers_mut().insert(header::SET_COOKIE, cookie);
        }
    }
}

fn text<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    // What is no text is none that is known.
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}

/// Gives the key for the ticket in the cookie; `null` without a valid one.
pub async fn session(State(guard): State<Guard>, headers: HeaderMap) -> Response {
    let cookies = headers.get_all(header::COOKIE).iter().filter_map(|value| value.to_str().ok());
    let mut pairs =
        cookies.flat_map(|cookies| cookies.split(';')).filter_map(|pair| pair.trim().split_once('='));
    let ticket = pairs.find(|(name, _)| *name == guard.0.cookie);
    let key = ticket.and_then(|(_, ticket)| guard.0.keys.exchange(ticket));
    let mut response = value(json!({"key": key}));
    guard.set_cookie(&mut response, "", 0);
    response
}

/// Lets requests with the key through.
pub async fn check_key(
    State(guard): State<Guard>,
    Extension(proof): Extension<Proof>,
    request: Request,
    next: Next,
) -> Response {
    if text(request.headers(), &KEY).is_some_and(|key| guard.0.keys.is_key(key)) {
        proof.give();
        return next.run(request).await;
    }
    let words = "The studio was restarted, or did not open this page. Open the file studio.html in the folder of the project.";
    Refusal::refused(words).into_response()
}

/// Refuses requests of other pages, opens the page, and adds the headers to every response.
pub async fn check(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let refused = guard.refusal(&request).map(IntoResponse::into_response);
    let mut response = match refused.or_else(|| guard.opening(&request)) {
        Some(response) => response,
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if !headers.contains_key(header::CONTENT_SECURITY_POLICY) {
        headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    }
    response
}
