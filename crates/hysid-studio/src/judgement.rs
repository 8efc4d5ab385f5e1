//! The free run of a model over a file: outputs, errors, tests of the residual.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use hysid::data::metrics::{ErrorSums, Errors};
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::residuals::{FEWEST_ROWS, ResidualFinding, ResidualOptions, Residuals};
use hysid::model::{Model, Prediction};
use hysid_app::residual_words::{name, p_value, verdict};
use hysid_app::{BAND, BandCoverage, ReportSet};
use hysid_document::{Problem, Result};
use hysid_records::summarised;
use serde_json::{Value, json};

const MOST_KEPT: usize = 8;

/// What is said of records with a known beginning.
const AFTER_A_BEGINNING: &str = "the model finds its state in each record from the measured outputs at its beginning, as in its \
     fit (known); these rows are not scored";

/// The free run of a model over a file.
pub struct Run {
    /// The data of the file, in the units of the model.
    pub data: Dataset,
    /// True if the model was fitted to the file.
    pub is_training: bool,
    /// True if the records have a known beginning, which is not scored.
    is_begun: bool,
    /// Output, and the band if the model has one, of each record.
    pub predicted: Vec<Prediction>,
    pub errors: Errors,
}

impl Run {
    /// Runs a model. Data that it was fitted to begin as they did then, and all data have the known beginning with which it
    /// was judged in its fit, unless nothing would be left to score.
    pub fn of(model: &Model, data: Dataset) -> Result<Self> {
        let is_training = data.records().iter().any(|record| model.was_trained_on(&record.fingerprint()));
        let data = if is_training { model.as_trained(&data)?.into_owned() } else { data };
        let begun = model.as_judged(&data)?.into_owned();
        let is_begun = begun.scored() > 0 && begun.scored() < data.scored();
        let data = if is_begun { begun } else { data };
        let set = ReportSet::of(model, "", &data)?;
        let without_band = |output: Vec<f64>| Prediction { output, ..Prediction::default() };
        let predicted = match set.predicted {
            Some(predicted) => predicted,
            None => set.simulated.into_iter().map(without_band).collect(),
        };
        let errors = set.errors;
        Ok(Self { data, is_training, is_begun, predicted, errors })
    }

    pub fn judgement(&self, model: &Model) -> Result<Value> {
        let pairs = || self.data.records().iter().zip(&self.predicted);
        let has_band = self.predicted.iter().all(|run| !run.low.is_empty());
        let coverage = has_band.then(|| BandCoverage::counted(&self.predicted, &self.data, BAND));
        let of_record = |(record, run): (&Record, &Prediction)| {
            let mut sums = ErrorSums::default();
            sums.add(record.output(), &run.output);
            json!({"name": record.name(), "errors": sums.errors(&self.data.names().output)})
        };
        let mut warnings = summarised(&model.range_warnings(&self.data)?);
        if self.is_begun {
            warnings.push(AFTER_A_BEGINNING.into());
        }
        if !self.is_training {
            warnings.extend(summarised(&model.known_records(&self.data)));
        }
        Ok(json!({
            "errors": self.errors,
            "inside_band_percent": coverage.map(|coverage| coverage.coverage_percent),
            "is_training": self.is_training,
            "warnings": warnings,
            "records": pairs().map(of_record).collect::<Vec<_>>(),
            "residuals": self.residuals(model)?,
        }))
    }

    /// Tests of the residual; none for too few rows.
    fn residuals(&self, model: &Model) -> Result<Vec<Value>> {
        if self.data.scored() < FEWEST_ROWS {
            return Ok(Vec::new());
        }
        let simulated: Vec<Vec<f64>> = self.predicted.iter().map(|run| run.output.clone()).collect();
        let options = ResidualOptions {
            uses_rate: model.rate().is_some(),
            is_training: self.is_training,
            ..ResidualOptions::default()
        };
        let residuals = Residuals::of(&self.data, &simulated, &options)?;
        let told = |finding: &ResidualFinding| {
            json!({
                "test": name(finding),
                "verdict": verdict(finding.verdict),
                "p": p_value(finding),
                "statement": finding.statement,
                "advice": finding.advice,
            })
        };
        Ok(residuals.findings.iter().map(told).collect())
    }
}

/// Outputs of predictions one after the other, and the edges of the band if all have one.
pub fn columns(predicted: &[Prediction]) -> Vec<(&'static str, Vec<f64>)> {
    let all = |part: fn(&Prediction) -> &Vec<f64>| -> Vec<f64> {
        predicted.iter().flat_map(part).copied().collect()
    };
    let mut columns = vec![("simulated", all(|run| &run.output))];
    if predicted.iter().all(|run| !run.low.is_empty()) {
        columns.extend([("low", all(|run| &run.low)), ("high", all(|run| &run.high))]);
    }
    columns
}

/// The output of each member of an ensemble for the data of a run.
pub fn members(model: &Model, data: &Dataset) -> Result<Vec<(String, Vec<f64>)>> {
    let Some(ensemble) = model.ensemble() else { return Ok(Vec::new()) };
    let run = |(number, member): (usize, &Model)| {
        let name = format!("{} {}", number + 1, member.name().name());
        let of_record = |record: &Record| member.simulate(record);
        let output: hysid::Result<Vec<Vec<f64>>> = data.records().iter().map(of_record).collect();
        let output = output.map_err(|error| {
            Problem::Library(error).within(format!("member {name} cannot run on these data"))
        })?;
        Ok((name, output.concat()))
    };
    ensemble.members().iter().enumerate().map(run).collect()
}

/// A run, with its model and the number of its file.
type Kept = (Arc<Model>, u64, Arc<Run>);

/// The last runs, by model and number of the file.
#[derive(Default)]
pub struct Runs {
    kept: Mutex<VecDeque<Kept>>,
}

impl Runs {
    /// The run of a model over a file; it is made if it is not kept.
    pub fn of(&self, model: &Arc<Model>, file: u64, make: impl FnOnce() -> Result<Run>) -> Result<Arc<Run>> {
        let kept = || self.kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let is_asked = |(of, number, _): &&Kept| Arc::ptr_eq(of, model) && *number == file;
        let known = kept().iter().find(is_asked).map(|(.., run)| Arc::clone(run));
        if let Some(known) = known {
            return Ok(known);
        }
        let run = Arc::new(make()?);
        let mut kept = kept();
        kept.truncate(MOST_KEPT - 1);
        kept.push_front((Arc::clone(model), file, Arc::clone(&run)));
        Ok(run)
    }

    /// Forgets all of them, as files are read in another way.
    pub fn clear(&self) {
        self.kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clear();
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use hysid::data::known_beginning::{KnownBeginning, KnownSpan};
    use hysid::data::record::ColumnNames;
    use hysid::fit::identify;
    use hysid::options::FitSpec;
    use hysid::options::classical::{ClassicalModel, ClassicalOptions};

    use super::*;

    /// A play of threshold 1 under a triangle of this amplitude, from the row `first` on.
    fn cut(name: &str, amplitude: f64, first: usize) -> Dataset {
        let x = (0..200).map(|k| amplitude * (f64::from((k + 20) % 40 - 20).abs() / 10.0 - 1.0));
        let (x, mut play): (Vec<f64>, f64) = (x.collect(), 0.0);
        let step = |x: &f64| {
            play = play.clamp(x - 1.0, x + 1.0);
            0.2 * x + play
        };
        let y: Vec<f64> = x.iter().map(step).collect();
        let record = Record::new(name, vec![x[first..].to_vec()], y[first..].to_vec()).unwrap();
        Dataset::new(ColumnNames::of(None, &["x"], "y"), vec![record]).unwrap()
    }

    #[test]
    fn files_are_judged_with_the_known_beginning_of_the_fit() {
        let options = ClassicalOptions {
            known: Some(KnownSpan::Rows(30)),
            ..ClassicalOptions::of(ClassicalModel::PrandtlIshlinskii)
        };
        let fitted =
            identify(&cut("a", 4.0, 0), &FitSpec::Classical(options), &mut |_| ControlFlow::Continue(()));
        let model = fitted.unwrap().model;
        let unseen = cut("b", 3.0, 55);
        let judged = Run::of(&model, unseen.clone()).unwrap().judgement(&model).unwrap();
        let known = model.clone().with_known_beginning(KnownBeginning::Rows(30)).evaluate(&unseen).unwrap();
        assert_eq!(judged["errors"]["samples"], 115);
        assert_eq!(judged["errors"]["rmse"], json!(known.rmse));
        assert!(judged["warnings"].to_string().contains("not scored"), "{}", judged["warnings"]);
        // Records that are no longer than the beginning are judged as they are.
        let whole = &unseen.records()[0];
        let (x, y) = (whole.inputs()[0][..20].to_vec(), whole.output()[..20].to_vec());
        let short =
            Dataset::new(unseen.names().clone(), vec![Record::new("c", vec![x], y).unwrap()]).unwrap();
        let judged = Run::of(&model, short).unwrap().judgement(&model).unwrap();
        assert_eq!(judged["errors"]["samples"], 20);
        assert!(!judged["warnings"].to_string().contains("not scored"));
    }
}
