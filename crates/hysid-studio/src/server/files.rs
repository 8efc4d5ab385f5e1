//! Files, columns, findings, diagnosis, cycles.

use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

use axum::Json;
use axum::body::Body;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use futures_util::StreamExt;
use hysid::data::rate::RateMethod;
use hysid::data::record::Record;
use hysid_core::words::{Hint, Words};
use hysid_document::Problem;
use hysid_records::{Data, ReadingChoice};
use serde::Deserialize;
use serde_json::json;

use super::Shared;
use super::answer::{Answer, Arrays, Refusal, at_once, computed, diagnosed, done, encoded, value};
use crate::choices::MOST_FILE_BYTES;
use crate::project::{ChosenColumns, Use};
use crate::studio::{CyclesAsked, ForceAsked, PlanAsked};

/// Longest pause of an upload.
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// The name of a file that comes in, and its use if that is chosen.
#[derive(Deserialize)]
pub struct Named {
    name: String,
    #[serde(rename = "use")]
    usage: Option<Use>,
}

/// A file on its way: removed unless it arrives.
struct Upload(Option<PathBuf>);

impl Drop for Upload {
    fn drop(&mut self) {
        self.0.iter().for_each(|path| drop(fs::remove_file(path)));
    }
}

/// Takes a file.
pub async fn upload(
    State(shared): State<Shared>,
    Query(named): Query<Named>,
    headers: axum::http::HeaderMap,
    body: Body,
) -> Answer<Response> {
    let length = headers.get("content-length").and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|length| length > MOST_FILE_BYTES) {
        return Err(too_large());
    }
    let place = shared.studio.place_for_upload()?;
    let mut upload = Upload(Some(place.clone()));
    let stored = |error: std::io::Error| {
        let words = format!("{}: cannot be stored: {}", named.name, hysid_files::reason(&error));
        Refusal::new(StatusCode::INSUFFICIENT_STORAGE, words)
    };
    let mut file = File::create(&place).map_err(stored)?;
    let mut stream = body.into_data_stream();
    let mut bytes = 0;
    loop {
        let words = "the upload stopped: drop the file again";
        let late = || Refusal::new(StatusCode::REQUEST_TIMEOUT, words);
        let next = tokio::time::timeout(LONGEST_PAUSE, stream.next()).await.map_err(|_| late())?;
        let Some(chunk) = next else { break };
        let chunk = chunk.map_err(|_| late())?;
        bytes += chunk.len() as u64;
        if bytes > MOST_FILE_BYTES {
            return Err(too_large());
        }
        // Blocks of some kilobytes, to a file of this machine.
        file.write_all(&chunk).map_err(stored)?;
    }
    drop(file);
    let id = computed(shared, move |studio| {
        if named.usage.is_none() {
            studio.leave_example()?;
        }
        let usage = named.usage.unwrap_or_else(|| studio.usage_of_next());
        let id = studio.take_file(&named.name, &place, usage)?;
        Ok(id)
    })
    .await?;
    upload.0 = None;
    Ok(value(json!({"id": id})))
}

fn too_large() -> Refusal {
    let most = MOST_FILE_BYTES / 1_000_000_000;
    let words = format!("the file is larger than {most} GB: make it smaller, or fit on the command line");
    Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, words)
}

/// Removes a file.
pub async fn remove(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    let kept = at_once(shared, move |studio| studio.remove_file(id)).await?;
    Ok(value(json!({"kept": kept.into_iter().collect::<Vec<String>>()})))
}

/// Brings back a file or a model that was removed.
pub async fn undo(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    computed(shared, move |studio| studio.undo_removal(id)).await?;
    Ok(done())
}

/// The example of the first page.
pub async fn example(State(shared): State<Shared>) -> Answer<Arrays> {
    computed(shared, |studio| {
        let example = studio.example()?;
        Ok(Arrays::of(&example.columns).with("x-facts", encoded(&example.facts.to_string())))
    })
    .await
}

/// Reads a file that was held back.
pub async fn read_again(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Response> {
    computed(shared, move |studio| studio.read_again(id)).await?;
    Ok(done())
}

/// Use of a file, in the query of a request.
#[derive(Deserialize)]
pub struct Usage {
    #[serde(rename = "use")]
    usage: Use,
}

/// Says what a file is for.
pub async fn use_as(
    State(shared): State<Shared>,
    Path(id): Path<u64>,
    Json(Usage { usage }): Json<Usage>,
) -> Answer<Response> {
    at_once(shared, move |studio| studio.use_file(id, usage)).await?;
    Ok(done())
}

#[derive(Deserialize)]
pub struct Specimen {
    name: String,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default)]
    noise_percent: f64,
    #[serde(default)]
    is_example: bool,
}

fn one() -> u64 {
    1
}

/// Takes the data of a specimen.
pub async fn specimen(State(shared): State<Shared>, Json(asked): Json<Specimen>) -> Answer<Response> {
    let take = move |studio: &std::sync::Arc<crate::studio::Studio>| {
        studio.leave_example()?;
        let ids = studio.take_specimen(&asked.name, asked.seed, asked.noise_percent)?;
        if asked.is_example {
            studio.mark_example(&ids)?;
        }
        Ok(ids)
    };
    let ids = computed(shared, take).await?;
    Ok(value(json!({"ids": ids})))
}

/// Says how tables are read.
pub async fn reading(State(shared): State<Shared>, Json(reading): Json<ReadingChoice>) -> Answer<Response> {
    computed(shared, move |studio| studio.read_as(reading)).await?;
    Ok(done())
}

/// Refuses columns of the first file without an input or an output.
fn complete(chosen: ChosenColumns) -> hysid_document::Result<ChosenColumns> {
    let missing = [("input", chosen.inputs.is_empty()), ("output", chosen.output.is_none())];
    match missing.iter().find(|(_, is_missing)| *is_missing) {
        Some((role, _)) => {
            let words = Words::from(format!("no column has the role {role}: choose one"));
            Err(Problem::Request(words.advised(Hint::Option(role))))
        }
        None => Ok(chosen),
    }
}

/// Sets the roles of columns; returns a note if one of them stays what it was.
pub async fn columns(
    State(shared): State<Shared>,
    Json(asked): Json<Option<ChosenColumns>>,
) -> Answer<Response> {
    let note = computed(shared, move |studio| studio.choose_columns(asked.map(complete).transpose()?));
    Ok(value(json!({"note": note.await?})))
}

/// Sets columns of one file that have the roles of the first file's.
pub async fn columns_of(
    State(shared): State<Shared>,
    Path(id): Path<u64>,
    Json(asked): Json<ChosenColumns>,
) -> Answer<Response> {
    computed(shared, move |studio| studio.choose_columns_of(id, asked)).await?;
    Ok(done())
}

/// The numbers of a file.
pub async fn numbers(State(shared): State<Shared>, Path(id): Path<u64>) -> Answer<Arrays> {
    computed(shared, move |studio| {
        let data = studio.data_of(id)?;
        Ok(Arrays::of(&arrays_of(&data)))
    })
    .await
}

/// Time or numbers of rows, inputs, rate where there is time, output: over all records.
fn arrays_of(data: &Data) -> Vec<(&'static str, Vec<f64>)> {
    let records = data.set.records();
    let joined = |column: &dyn Fn(&Record) -> Vec<f64>| records.iter().flat_map(column).collect::<Vec<f64>>();
    let mut columns = Vec::new();
    match data.set.has_time() {
        true => columns.push(("time", joined(&|record| record.time().unwrap_or_default().to_vec()))),
        false => columns.push(("row", (1..=data.set.rows()).map(|row| row as f64).collect())),
    }
    for input in 0..data.set.names().inputs.len() {
        columns.push(("input", joined(&|record| record.inputs()[input].to_vec())));
    }
    let rate = |record: &Record| match record.given_rate() {
        Some(rate) => rate.to_vec(),
        None => RateMethod::Central.rate(record).unwrap_or_else(|_| vec![f64::NAN; record.len()]),
    };
    if data.set.has_time() || data.set.has_given_rate() {
        columns.push(("rate", joined(&rate)));
    }
    columns.push(("output", joined(&|record| record.output().to_vec())));
    columns
}

/// Issues of the training data.
pub async fn findings(State(shared): State<Shared>) -> Answer<Response> {
    Ok(value(diagnosed(shared, |studio| studio.findings()).await?))
}

/// The diagnosis of the training data.
pub async fn diagnosis(State(shared): State<Shared>) -> Answer<Response> {
    Ok(value(json!({"html": diagnosed(shared, |studio| studio.diagnosis()).await?})))
}

/// A plan of the next test.
pub async fn plan(State(shared): State<Shared>, Json(asked): Json<PlanAsked>) -> Answer<Response> {
    Ok(value(computed(shared, move |studio| studio.plan(&asked)).await?))
}

/// The restoring force from the motion of a mass.
pub async fn restoring_force(
    State(shared): State<Shared>,
    Json(asked): Json<ForceAsked>,
) -> Answer<Response> {
    Ok(value(computed(shared, move |studio| studio.restoring_force(&asked)).await?))
}

/// The cycles of the training data.
pub async fn cycles(State(shared): State<Shared>, Query(asked): Query<CyclesAsked>) -> Answer<Response> {
    Ok(value(json!({"html": diagnosed(shared, move |studio| studio.cycles(&asked)).await?})))
}
