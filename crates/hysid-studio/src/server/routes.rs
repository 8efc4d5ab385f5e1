//! The addresses of a studio.

use axum::Router;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::StatusCode;
use axum::middleware::{from_fn_with_state, map_response};
use axum::response::{IntoResponse, Response};
use axum::routing::{delete, get, post};

use super::answer::{Answer, Refusal, at_once, value};
use super::guard::{self, Guard};
use super::{Shared, assets, events, files, models};
use crate::choices;

/// Largest body of a request that is no file: a path of some inputs.
const MOST_BODY_BYTES: usize = 8 << 20;

/// All addresses, for the page that the guard admits.
pub fn router(shared: Shared, guard: Guard) -> Router {
    let of_files = Router::new()
        .route("/files", post(files::upload).layer(DefaultBodyLimit::disable()))
        .route("/files/{id}", delete(files::remove))
        .route("/files/{id}/use", post(files::use_as))
        .route("/files/{id}/read", post(files::read_again))
        .route("/files/{id}/columns", get(files::numbers).post(files::columns_of))
        .route("/specimens", post(files::specimen))
        .route("/reading", post(files::reading))
        .route("/columns", post(files::columns))
        .route("/findings", get(files::findings))
        .route("/diagnosis", get(files::diagnosis))
        .route("/cycles", get(files::cycles))
        .route("/plan", post(files::plan))
        .route("/restoring-force", post(files::restoring_force));
    let of_models = Router::new()
        .route("/fit", post(models::fit))
        .route("/fit/stop", post(models::stop))
        .route("/fit/preview", get(models::preview))
        .route("/fit/save", post(models::save_again))
        .route("/fit/model", get(models::unsaved))
        .route("/models/{id}", delete(models::remove))
        .route("/models/{id}/name", post(models::rename))
        .route("/models/{id}/simulated/{file}", get(models::simulated))
        .route("/models/{id}/members/{file}", get(models::members))
        .route("/models/{id}/judgement/{file}", get(models::judgement))
        .route("/models/{id}/run", post(models::run))
        .route("/models/{id}/inverse", post(models::inverse))
        .route("/models/{id}/facts", get(models::facts))
        .route("/models/{id}/file", get(models::file))
        .route("/models/{id}/report", get(models::report))
        .route("/models/{id}/export/{target}", get(models::export))
        .route("/models/{id}/commands", get(models::lines));
    let api = Router::new()
        .route("/choices", get(async || value(choices::all())))
        .route("/project", get(project))
        .route("/example", get(files::example))
        .route("/removed/{id}", post(files::undo))
        .route("/events", get(events::events))
        .merge(of_files)
        .merge(of_models)
        .layer(from_fn_with_state(guard.clone(), guard::check_key));
    Router::new()
        .route("/", get(async || assets::page()))
        .route("/report", get(async || assets::report()))
        .route("/api/session", post(guard::session).with_state(guard.clone()))
        .route("/{*path}", get(assets::asset))
        .nest("/api", api)
        .fallback(async || Refusal::new(StatusCode::NOT_FOUND, "there is no such address"))
        .layer(DefaultBodyLimit::max(MOST_BODY_BYTES))
        .layer(map_response(in_words))
        .layer(from_fn_with_state(guard, guard::check))
        .with_state(shared)
}

async fn project(State(shared): State<Shared>) -> Answer<Response> {
    Ok(value(at_once(shared, |studio| Ok(studio.shown())).await?))
}

/// Rewrites errors of the server itself in the form of all others.
async fn in_words(response: Response) -> Response {
    let kind = response.headers().get("content-type").map(|kind| kind.to_str().unwrap_or_default());
    let is_in_words = kind.is_some_and(|kind| kind.starts_with("application/json"));
    let status = response.status();
    if is_in_words || !(status.is_client_error() || status.is_server_error()) {
        return response;
    }
    let bytes = axum::body::to_bytes(response.into_body(), MOST_BODY_BYTES).await.unwrap_or_default();
    let words = String::from_utf8_lossy(&bytes)
        .replace("Failed to deserialize the JSON body into the target type", "the request is not valid");
    Refusal::new(status, words).into_response()
}
