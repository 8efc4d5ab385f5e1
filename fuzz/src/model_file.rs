//! Text of a model file whose checksum is right: what is read is a model that runs, or one line says why not.

use std::time::{Duration, Instant};

use hysid::data::record::Record;
use hysid::model::Model;

use crate::{assert_is_one_line, fixtures};

pub fn run(text: &[u8]) {
    let Ok(text) = std::str::from_utf8(text) else { return };
    match Model::from_json(&mended(text)) {
        Ok(model) => check(&model),
        Err(error) => assert_is_one_line(&error.to_string()),
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    fixtures::models().iter().map(|model| model.to_json().into_bytes()).collect()
}

/// What holds of every model.
fn check(model: &Model) {
    let again = model.to_json();
    assert_eq!(Model::from_json(&again).expect("what was written is read").to_json(), again);
    let inputs = model.names().inputs.len();
    let values = [0.0, 1.0, -1.0, 1e100, -1e100, 1e-300, 0.3, 0.3, -7e99, 2.0];
    let columns = (0..inputs).map(|c| values.iter().cycle().skip(c).take(40).copied().collect()).collect();
    let record = Record::new("r", columns, vec![f64::NAN; 40]).expect("a record");
    let record = record.with_time((0..40).map(f64::from).collect()).expect("with time");
    let given = (0..40).map(|k| if k % 3 == 0 { 1e90 } else { -0.5 }).collect();
    let record = record.with_given_rate(given).expect("with a rate");
    match model.simulate(&record) {
        Ok(outputs) => assert!(outputs.iter().all(|y| y.is_finite()), "{}: {outputs:?}", model.name().name()),
        Err(error) => assert_is_one_line(&error.to_string()),
    }
    if is_slow(model) {
        return;
    }
    if let Err(error) = hysid::diagnosis::ModelDiagnosis::of(model) {
        assert_is_one_line(&error.to_string());
    }
}

/// Longest time for a row of a model that is diagnosed. A diagnosis takes many thousands of rows: of a Jiles-Atherton
/// law with a tiny `k`, whose rows take thousands of steps each, it would take minutes.
const LONGEST_ROW: Duration = Duration::from_micros(100);

fn is_slow(model: &Model) -> bool {
    const ROWS: u32 = 200;
    let ranges = &model.trained_ranges().inputs;
    let column = |&(low, high): &(f64, f64)| {
        (0..ROWS).map(|row| low + (high - low) * f64::from(row) / f64::from(ROWS)).collect()
    };
    let columns = ranges.iter().map(column).collect();
    let Ok(record) = Record::new("r", columns, vec![f64::NAN; ROWS as usize]) else { return false };
    let record = record.with_time((0..ROWS).map(f64::from).collect()).expect("with time");
    let began = Instant::now();
    let _ = model.simulate(&record);
    began.elapsed() > ROWS * LONGEST_ROW
}

/// The text with the checksum that belongs to it.
fn mended(text: &str) -> String {
    const KEY: &str = "\"checksum\"";
    let Some(end) = text.rfind(KEY) else { return text.into() };
    let (mut is_within_text, mut is_escaped) = (false, false);
    let counts = |byte: &u8| {
        let is_quote = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && is_within_text && !is_escaped;
        is_within_text ^= is_quote;
        !byte.is_ascii_whitespace() || is_within_text
    };
    let content: Vec<u8> = text[..end].bytes().filter(counts).collect();
    format!("{}{KEY}: \"{:08x}\"\n}}\n", &text[..end], crc32fast::hash(&content))
}
