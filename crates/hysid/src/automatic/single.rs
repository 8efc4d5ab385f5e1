//! One small model in the place of many: the candidate that does best alone, and of its starts the one that
//! follows the ensemble most closely.

use rayon::prelude::*;

use crate::automatic::candidates::{Candidate, Kind};
use crate::automatic::choice::Score;
use crate::automatic::jury::Jury;
use crate::automatic::panel::Panelist;
use crate::automatic::trials::{Judge, Watch};
use crate::error::Result;
use crate::model::{HeldOutRow, Model};
use crate::record::{Dataset, Record};

/// Starts among which one is chosen.
const STARTS: usize = 12;

/// Shares of the measured input that the ensemble is asked about beside the data: paths that nobody
/// measured, but that the model may meet.
const SHARES: [f64; 2] = [0.5, 0.75];

/// The candidate whose starts do best one by one. Random stops are many, and so no small model.
pub(super) fn best_alone<'j>(jury: &'j Jury, judges: &[Judge]) -> Option<&'j Panelist> {
    let small = jury.panels.iter().filter(|panel| panel.kind != Kind::RandomStops);
    let panelists = small.flat_map(|panel| &panel.panelists);
    panelists.min_by(|a, b| score_alone(a, judges).total_cmp(&score_alone(b, judges)))
}

fn score_alone(panelist: &Panelist, judges: &[Judge]) -> f64 {
    let starts = panelist.trial.folds.first().map_or(0, Vec::len);
    let of_start = |start: usize| {
        let foretold: Vec<Vec<f64>> =
            panelist.trial.folds.iter().map(|starts| starts[start].clone()).collect();
        let score = Score::of(&foretold, judges);
        score.inside + score.outside
    };
    (0..starts).map(of_start).sum::<f64>() / starts.max(1) as f64
}

/// Data with what the ensemble says of smaller paths beside them.
fn with_answers(data: &Dataset, ensemble: &Model) -> Result<Dataset> {
    let mut records = data.records().to_vec();
    for share in SHARES {
        for record in data.records() {
            let scaled = scaled(record, share)?;
            let answers = ensemble.simulate(&scaled)?;
            // As many rows as were measured, so that what was measured counts most.
            let every = SHARES.len().max(1);
            let blank = |(row, y): (usize, f64)| if row % every == 0 { y } else { f64::NAN };
            let output = answers.into_iter().enumerate().map(blank).collect();
            records.push(scaled.with_output(output)?);
        }
    }
    Dataset::new(data.names().clone(), records)
}

fn scaled(record: &Record, share: f64) -> Result<Record> {
    let mut inputs = record.inputs().to_vec();
    inputs[0].iter_mut().for_each(|x| *x *= share);
    let mut scaled = Record::new(record.name(), inputs, vec![f64::NAN; record.len()])?;
    if let Some(time) = record.time() {
        scaled = scaled.with_time(time.to_vec())?;
    }
    if let Some(rate) = record.given_rate() {
        scaled = scaled.with_given_rate(rate.iter().map(|rate| rate * share).collect())?;
    }
    Ok(scaled)
}

/// Fits the candidate to the data and to what the ensemble says beside them, from several starts; gives the
/// fit that is nearest to the ensemble over all of it. `None` if there was no time.
pub(super) fn following(
    ensemble: &Model,
    candidate: &Candidate,
    data: &Dataset,
    watch: &Watch,
) -> Result<Option<Model>> {
    let taught = with_answers(data, ensemble)?;
    let answers: Vec<Vec<f64>> =
        taught.records().par_iter().map(|record| ensemble.simulate(record)).collect::<Result<_>>()?;
    let starts = if candidate.is_random() { STARTS } else { 1 };
    let distance = |model: &Model| -> Result<f64> {
        let mut sum = 0.0;
        for (record, answers) in taught.records().iter().zip(&answers) {
            let output = model.simulate(record)?;
            sum += output.iter().zip(answers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        }
        Ok(sum)
    };
    let fitted: Vec<Option<(f64, Model)>> = (0..starts)
        .into_par_iter()
        .map(|start| {
            let Some(model) = watch.fit(candidate, &taught, start)? else { return Ok(None) };
            Ok(Some((distance(&model)?, model)))
        })
        .collect::<Result<_>>()?;
    let nearest = fitted.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(nearest.map(|(_, model)| model))
}

/// Rows held out with the errors of single starts.
pub(super) fn rows_held_out(panelist: &Panelist, judges: &[Judge]) -> Vec<HeldOutRow> {
    let mut rows = Vec::new();
    for (starts, judge) in panelist.trial.folds.iter().zip(judges) {
        for start in starts {
            let of_rows = start.iter().zip(&judge.measured).zip(&judge.outside);
            rows.extend(of_rows.map(|((foretold, measured), outside)| HeldOutRow {
                error: measured - foretold,
                disagreement: 0.0,
                outside: *outside,
                weight: 1.0 / (judge.measured.len() * starts.len()) as f64,
            }));
        }
    }
    rows
}
