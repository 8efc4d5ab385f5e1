//! The observer of a fit: a bar on a terminal, now and then a line elsewhere; Ctrl-C and time limit.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use hysid::training::{Method, Phase, Progress};
use hysid::warning::Significant;
use indicatif::{ProgressBar, ProgressStyle};

use crate::checkpoint::Keeper;
use crate::interrupt;
use crate::messages::{note, warning};

/// Without a terminal, one line in this time at most.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Follows a fit.
pub struct Follower {
    started: Instant,
    limit: Option<Duration>,
    starts: usize,
    keeper: Option<Keeper>,
    /// A checkpoint could not be written, and that was said.
    failed: bool,
    /// Smallest training error so far.
    best: f64,
    bar: Option<ProgressBar>,
    last_line: Instant,
}

impl Follower {
    /// Begins now, and ends at the limit, if any; keeps a checkpoint if there is a file for it.
    pub fn new(starts: usize, time_limit: Option<f64>, checkpoint: Option<&Path>) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(STEPS as u64);
            let style = ProgressStyle::with_template("[{bar:24}] {percent:>3} % {msg}");
            bar.set_style(style.expect("the template is sound").progress_chars("=> "));
            bar
        });
        let now = Instant::now();
        let limit = time_limit.map(Duration::from_secs_f64);
        Self {
            started: now,
            limit,
            starts,
            keeper: checkpoint.map(Keeper::new),
            failed: false,
            best: f64::INFINITY,
            bar,
            last_line: now,
        }
    }

    /// Hears of an iteration; breaks after Ctrl-C or at the time limit.
    pub fn observe(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.best = self.best.min(progress.train_nrmse_percent);
        if let Some(bar) = &self.bar {
            bar.set_position((progress.done * STEPS) as u64);
            bar.set_message(self.text(progress));
        } else if self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            note(format_args!("{:3.0} % {}", 100.0 * progress.done, self.text(progress)));
        }
        let over = self.limit.is_some_and(|limit| self.started.elapsed() >= limit) || interrupt::requested();
        if let Some(keeper) = &mut self.keeper
            && let Err(error) = keeper.observe(progress, over)
            && !std::mem::replace(&mut self.failed, true)
        {
            // The fit is worth more than its checkpoint.
            warning(format_args!("the fit goes on without checkpoint: {error}"));
        }
        if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Takes the bar away; tells the seconds spent.
    pub fn finish(self) -> f64 {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.started.elapsed().as_secs_f64()
    }

    fn text(&self, progress: &Progress) -> String {
        let part = match (progress.phase, progress.method) {
            (Phase::Starts, _) => format!("{} starts", self.starts),
            (Phase::AllData, Method::LevenbergMarquardt) => "all data".to_string(),
            (Phase::AllData, Method::Genetic) => format!("generation {}", progress.epoch),
            (Phase::AllData, Method::LeastSquares) => format!("round {}", progress.epoch),
            (Phase::AllData, Method::Subgradient) => format!("sub-gradient {}", progress.epoch),
        };
        let elapsed = self.started.elapsed().as_secs_f64();
        let mut left = elapsed / progress.done.max(1e-3) * (1.0 - progress.done);
        if let Some(limit) = self.limit {
            left = left.min(limit.as_secs_f64() - elapsed).max(0.0);
        }
        format!("{part}, error {:.3} % of std, {left:.0} s left", Significant(self.best))
    }
}
