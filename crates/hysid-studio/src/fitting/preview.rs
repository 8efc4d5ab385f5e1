//! The best model so far, drawn over the data and kept in a file.

use std::sync::Arc;
use std::time::{Duration, Instant};

use hysid::data::record::Record;
use hysid::model::Model;
use hysid_records::Data;

use super::latest::Latest;
use super::watch::SoFar;
use super::{FitCourse, Keep};

/// Rows that are simulated: the first of the data.
const MOST_ROWS: usize = 20_000;

/// Time between two writings of the best model so far.
const BETWEEN_FILES: Duration = Duration::from_secs(3);

/// Simulation of the best model so far.
#[derive(Clone)]
pub struct FitPreview {
    /// Number of the file whose rows were simulated.
    pub file: u64,
    /// Name of the model.
    pub name: String,
    /// Its output in the first rows.
    pub output: Arc<Vec<f64>>,
}

/// Draws models as they come, until there are no more.
pub fn draw(models: &Latest<SoFar>, course: &FitCourse, data: &Data, file: u64, keep: &Keep) {
    let rows: Vec<Record> = first_rows(data);
    let mut due = Instant::now();
    while let Some(so_far) = models.take() {
        let SoFar { name, model } = so_far;
        if Instant::now() >= due {
            // A disk that is full is told when the model itself is written.
            keep(&model);
            due = Instant::now() + BETWEEN_FILES;
        }
        let Some(output) = simulated(&model, &rows) else { continue };
        let preview = FitPreview { file, name, output: Arc::new(output) };
        *course.preview.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(preview);
        course.change(|state| state.preview += 1);
    }
}

/// The first rows of the first table.
fn first_rows(data: &Data) -> Vec<Record> {
    let mut left = MOST_ROWS;
    let mut rows = Vec::new();
    for (record, place) in data.set.records().iter().zip(data.source.places()) {
        if left == 0 || place.table != 0 {
            break;
        }
        let taken = record.len().min(left);
        rows.push(record.rows_up_to(taken));
        left -= taken;
    }
    rows
}

fn simulated(model: &Model, rows: &[Record]) -> Option<Vec<f64>> {
    let mut output = Vec::new();
    for record in rows {
        output.extend(model.simulate(record).ok()?);
    }
    Some(output)
}
