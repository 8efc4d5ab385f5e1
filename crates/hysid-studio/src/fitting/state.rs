//! State of a fit, for the page.

use hysid::options::FitSpec;
use hysid_document::Problem;
use serde::Serialize;

use crate::words::{Said, said};

/// State of a fit. Errors are in percent of the standard deviation of the output.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FitState {
    /// Its number.
    pub id: u64,
    /// Name of the model.
    pub model: &'static str,
    /// False once it has ended.
    pub is_running: bool,
    /// Seconds so far.
    pub seconds: f64,
    /// Completed share of the work, 0 to 1.
    pub done: f64,
    /// Estimate of the seconds to come.
    pub remaining_seconds: Option<f64>,
    /// The same in words.
    pub remaining: Option<String>,
    /// Current step of the work.
    pub part: String,
    /// The error so far.
    pub error_percent: Option<f64>,
    /// Seconds, and the lowest error until then.
    pub curve: Vec<(f64, f64)>,
    /// Seconds, and the error of a candidate on the folds that were held out until then.
    pub tried: Vec<(f64, f64)>,
    /// Seconds, and the training error of the candidate that is being fitted.
    pub running: Vec<(f64, f64)>,
    /// Kind of the errors of the curve.
    pub curve_is: &'static str,
    /// Candidates of `auto`, the lowest error first.
    pub candidates: Vec<Candidate>,
    /// Number of the newest picture; 0 if there is none.
    pub preview: u64,
    /// Why there is no model.
    pub problem: Option<Said>,
    /// Number of the model that was made.
    pub made: Option<u64>,
    /// True if the model could not be stored and is in memory alone.
    pub is_unsaved: bool,
    /// True if the studio was ended before the fit.
    pub was_interrupted: bool,
}

/// How a fit has ended.
pub enum FitEnd {
    /// With a stored model, by its number.
    Stored(u64),
    /// With a model that could not be stored, and the reason.
    Unsaved(Problem),
    Failed(Problem),
}

/// A candidate of `auto`.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    pub name: String,
    /// Error on the held-out rows so far.
    pub error_percent: Option<f64>,
    /// Folds that were held out so far.
    pub folds: usize,
    /// Folds in all.
    pub of: usize,
    /// How it stands.
    pub state: Standing,
}

/// How a candidate stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "as of the library")]
pub enum Standing {
    Trying,
    Complete,
    Dropped,
}

/// Points of a curve; of more, every other one is left out.
const MOST_POINTS: usize = 400;

impl FitState {
    /// Of a fit that begins.
    pub fn begun(id: u64, request: &FitSpec) -> Self {
        Self {
            id,
            model: request.model().name(),
            is_running: true,
            part: "starting".into(),
            curve_is: match request {
                FitSpec::Auto(_) => "cross-validation error",
                FitSpec::Network(_) | FitSpec::Classical(_) => "training error",
            },
            ..Self::default()
        }
    }

    /// Takes the error so far into the curve.
    pub(super) fn add_error(&mut self, second: f64, percent: f64) {
        let lowest = self.curve.last().map_or(f64::INFINITY, |(_, lowest)| *lowest);
        self.error_percent = Some(percent.min(lowest));
        self.curve.push((second, percent.min(lowest)));
        thin(&mut self.curve);
    }

    /// Takes the training error of a candidate that is being fitted.
    pub(super) fn add_running(&mut self, second: f64, percent: f64) {
        self.running.push((second, percent));
        thin(&mut self.running);
    }

    /// Takes the error of a candidate on some of the folds.
    pub(super) fn add_tried(&mut self, second: f64, percent: f64) {
        self.tried.push((second, percent));
        thin(&mut self.tried);
    }

    /// Takes what has become known of a candidate.
    pub(super) fn add_candidate(&mut self, candidate: Candidate) {
        match self.candidates.iter_mut().find(|known| known.name == candidate.name) {
            Some(known) => *known = candidate,
            None => self.candidates.push(candidate),
        }
        let rank = |candidate: &Candidate| {
            (candidate.state == Standing::Dropped, candidate.error_percent.unwrap_or(f64::INFINITY))
        };
        self.candidates.sort_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
    }

    /// Takes how the fit has ended.
    pub(super) fn end(&mut self, ended: FitEnd) {
        self.is_unsaved = matches!(ended, FitEnd::Unsaved(_));
        self.is_running = false;
        self.remaining = None;
        self.remaining_seconds = None;
        match ended {
            FitEnd::Stored(model) => self.made = Some(model),
            FitEnd::Unsaved(problem) | FitEnd::Failed(problem) => self.problem = Some(said(&problem)),
        }
    }
}

/// Leaves out every other one of too many points, but not the last.
fn thin(points: &mut Vec<(f64, f64)>) {
    let last = points.len().saturating_sub(1);
    if last >= MOST_POINTS {
        let mut places = 0..;
        points.retain(|_| places.next().is_some_and(|place| place % 2 == 0 || place == last));
    }
}

#[cfg(test)]
mod tests {
    use hysid::options::ModelName;

    use super::*;

    fn state() -> FitState {
        FitState::begun(1, &FitSpec::of(ModelName::AUTO, None, 1))
    }

    #[test]
    fn a_long_curve_keeps_its_ends_and_never_rises() {
        let mut state = state();
        for second in 0..5000 {
            state.add_error(f64::from(second), 100.0 - f64::from(second % 70));
        }
        assert!(state.curve.len() <= MOST_POINTS);
        assert_eq!(state.curve[0], (0.0, 100.0));
        assert_eq!(state.curve.last(), Some(&(4999.0, 31.0)));
        assert!(state.curve.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 >= pair[1].1));
    }

    #[test]
    fn the_best_candidate_comes_first_and_those_that_were_dropped_last() {
        let mut state = state();
        let candidate = |name: &str, error: Option<f64>, standing| Candidate {
            name: name.into(),
            error_percent: error,
            folds: 1,
            of: 3,
            state: standing,
        };
        state.add_candidate(candidate("a", Some(5.0), Standing::Trying));
        state.add_candidate(candidate("b", None, Standing::Dropped));
        state.add_candidate(candidate("c", Some(2.0), Standing::Trying));
        state.add_candidate(candidate("a", Some(1.0), Standing::Complete));
        let names: Vec<&str> = state.candidates.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["a", "c", "b"]);
    }
}
