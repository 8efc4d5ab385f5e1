//! Fits and models.

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, Query, State};
use axum::response::Response;
use hysid::model::Model;
use hysid_export::InverseOptions;
use serde::Deserialize;
use serde_json::json;

use super::Shared;
use super::answer::{Answer, Arrays, Refusal, at_once, computed, diagnosed, done, download, encoded, value};
use super::assets::report_text;
use crate::drive;
use crate::judgement;
use crate::project::FitRequest;
use crate::studio::{InverseAsked, limits};
use crate::take_away;

/// Begins a fit.
pub async fn fit(State(shared): State<Shared>, Json(request): Json<FitRequest>) -> Answer<Response> {
    let id = computed(shared, move |studio| studio.begin_fit(request)).await?;
    Ok(value(json!({"id": id})))
}

/// Ends the fit with its best model so far.
pub async fn stop(State(shared): State<Shared>) -> Response {
    shared.studio.stop_fit();
    done()
}

/// Stores the model that could not be stored.
pub async fn save_again(State(shared): State<Shared>) -> Answer<Response> {
    at_once(shared, |studio| studio.save_again()).await?;
    Ok(done())
}

/// The model that could not be stored.
pub async fn unsaved(State(shared): State<Shared>) -> Answer<Response> {
    let (name, text) = at_once(shared, |studio| studio.unsaved_model()).await?;
    Ok(download(&name, "application/json", text.into_bytes()))
}

/// Simulation of the best model so far.
pub async fn preview(State(shared): State<Shared>) -> Answer<Arrays> {
    let nothing = || Refusal::new(axum::http::StatusCode::NOT_FOUND, "there is no model so far");
    let preview = shared.studio.preview().ok_or_else(nothing)?;
    let rows = preview.output.len();
    Ok(Arrays::of(&[("simulated", preview.output.as_slice())])
        .with("x-file", preview.file.to_string())
        .with("x-from", "0".into())
        .with("x-to", rows.to_string())
        .with("x-name", encoded(&preview.name)))
}

/// The free run of a model over a file.
pub async fn simulated(
    State(shared): State<Shared>,
    Path((model, file)): Path<(u64, u64)>,
) -> Answer<Arrays> {
    computed(shared, move |studio| Ok(Arrays::of(&judgement::columns(&studio.run(model, file)?.predicted))))
        .await
}

/// The output of each member of an ensemble for a file.
pub async fn members(State(shared): State<Shared>, Path((model, file)): Path<(u64, u64)>) -> Answer<Arrays> {
    computed(shared, move |studio| {
        let (run, model) = (studio.run(model, file)?, studio.model(model)?);
        Ok(Arrays::named("member", &judgement::members(&model, &run.data)?))
    })
    .await
}

/// Errors and tests of a model on a file.
pub async fn judgement(
    State(shared): State<Shared>,
    Path((model, file)): Path<(u64, u64)>,
) -> Answer<Response> {
    let told = computed(shared, move |studio| studio.run(model, file)?.judgement(&*studio.model(model)?));
    Ok(value(told.await?))
}

/// Rows of a path.
#[derive(Deserialize)]
pub struct Driven {
    rows: usize,
}

impl Driven {
    /// The path whose numbers are a body.
    fn path(&self, model: &Model, body: &Bytes) -> hysid_document::Result<drive::Path> {
        let number = |bytes: &[u8]| Some(f64::from_le_bytes(bytes.try_into().ok()?));
        let numbers: Vec<f64> = body.chunks_exact(8).filter_map(number).collect();
        drive::Path::of(model, &numbers, self.rows)
    }
}

/// A model along a path from rest.
pub async fn run(
    State(shared): State<Shared>,
    Path(id): Path<u64>,
    Query(driven): Query<Driven>,
    body: Bytes,
) -> Answer<Arrays> {
    computed(shared, move |studio| {
        let model = studio.model(id)?;
        let run = driven.path(&model, &body)?.run(&model)?;
        Ok(Arrays::of(&judgement::columns(&[run])))
    })
    .await
}

/// The input that drives a model along a wanted output.
pub async fn inverse(
    State(shared): State<Shared>,
    Path(id): Path<u64>,
    Json(asked): Json<InverseAsked>,
) -> Answer<Response> {
    Ok(value(computed(shared, move |studio| studio.inverse(id, &asked)).await?))
}

/// Facts of a model.
pub async fn facts(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    Ok(value(json!({"html": diagnosed(shared, move |studio| studio.facts(id)).await?})))
}

/// Removes a model.
pub async fn remove(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    Ok(value(json!({"kept": at_once(shared, move |studio| studio.remove_model(id)).await?})))
}

/// The name of a model; an empty one for the name that says what it is.
#[derive(Deserialize)]
pub struct ModelTitle {
    name: String,
}

/// Gives a model a name.
pub async fn rename(
    State(shared): State<Shared>,
    Path(id): Path<u64>,
    Json(title): Json<ModelTitle>,
) -> Answer<Response> {
    at_once(shared, move |studio| studio.rename_model(id, &title.name)).await?;
    Ok(done())
}

/// The file of a model.
pub async fn file(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    at_once(shared, move |studio| {
        let content = studio.folder().read(&studio.model_file(id)?)?;
        Ok(download(&studio.stored_model(id)?.file, "application/json", content))
    })
    .await
}

/// The report of a model.
pub async fn report(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    Ok(report_text(at_once(shared, move |studio| studio.report(id)).await?))
}

/// The bounds of an inverse to be exported in place of the model.
#[derive(Deserialize)]
pub struct Exported {
    #[serde(default)]
    inverse: bool,
    low: Option<f64>,
    high: Option<f64>,
    slew: Option<f64>,
}

/// A model or its inverse for a target, as an archive.
pub async fn export(
    State(shared): State<Shared>,
    Path((id, target)): Path<(u64, String)>,
    Query(asked): Query<Exported>,
) -> Answer<Response> {
    computed(shared, move |studio| {
        let model = studio.model(id)?;
        let bounds = InverseOptions { limits: limits(&model, asked.low, asked.high), slew: asked.slew };
        let inverse = asked.inverse.then_some(bounds);
        let (name, content) = take_away::archive(&model, &studio.stored_model(id)?, &target, inverse)?;
        Ok(download(&name, "application/zip", content))
    })
    .await
}

/// The lines that make a model without the studio.
pub async fn lines(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    Ok(value(at_once(shared, move |studio| studio.lines(id)).await?))
}
