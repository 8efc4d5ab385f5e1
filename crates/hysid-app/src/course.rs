//! The course of a fit: the error so far, and what is being done, in words.

use hysid::fit::progress::Progress;
use hysid::model::history::Phase;
use hysid::options::network::Method;

#[derive(Debug, Clone, Copy)]
pub struct ProgressText {
    starts: usize,
    /// Training error so far, in percent of the standard deviation; infinite before there is one.
    best: f64,
}

impl ProgressText {
    /// Of a fit with so many starts.
    pub fn new(starts: usize) -> Self {
        Self { starts, best: f64::INFINITY }
    }

    /// Takes a report of the fit's progress.
    pub fn take(&mut self, progress: &Progress) {
        self.best = match progress.method {
            // The error of its best start, which need not be the lowest that was ever told.
            Method::LeastSquares if progress.train_nrmse_percent.is_nan() => self.best,
            Method::LeastSquares => progress.train_nrmse_percent,
            _ => self.best.min(progress.train_nrmse_percent),
        };
    }

    /// The training error so far in percent of the standard deviation, if the work has one.
    pub fn error(&self, progress: &Progress) -> Option<f64> {
        let has_none = progress.is_part || progress.phase == Phase::Starts || self.best == f64::INFINITY;
        (!has_none).then_some(self.best)
    }

    /// Current step of the work, in words.
    pub fn part(&self, progress: &Progress) -> String {
        // One fit of many: its starts, epochs and errors say nothing of the whole.
        if progress.is_part {
            return format!("fitting {}", progress.model.name());
        }
        if progress.phase == Phase::Starts {
            return "cross-validation".into();
        }
        let is_first = self.best == f64::INFINITY;
        let (epoch, starts) = (progress.epoch, self.starts);
        match progress.method {
            // Several starts at a time have no epoch in common.
            Method::LevenbergMarquardt | Method::Subgradient if starts > 1 => format!("{starts} starts"),
            Method::LevenbergMarquardt | Method::Subgradient | Method::Genetic if is_first => {
                "first evaluations".into()
            }
            Method::LevenbergMarquardt => format!("iteration {epoch}"),
            Method::Subgradient => format!("sub-gradient {epoch}"),
            Method::Genetic => format!("generation {epoch}"),
            Method::LeastSquares if is_first && epoch == 0 => "least squares".into(),
            Method::LeastSquares => format!("round {epoch}"),
        }
    }
}
