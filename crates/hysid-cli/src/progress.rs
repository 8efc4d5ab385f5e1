//! The observer of a fit: a bar on a terminal, now and then a line elsewhere; Ctrl-C and time limit.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use hysid::fit::network::Progress;
use hysid::model::history::Phase;
use hysid::options::network::Method;
use hysid::significant::Significant;
use indicatif::{ProgressBar, ProgressStyle};

use crate::checkpoint::Keeper;
use crate::interrupt;
use crate::messages::{note, warning};

/// Without a terminal, one line in this time at most.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Follows a fit, or the fits to several folds one after the other.
pub struct Follower {
    started: Instant,
    /// Time for each fold.
    limit: Option<Duration>,
    starts: usize,
    /// The fold that is fitted to, counted from 0, and how many there are; a fit to everything is the only one.
    fold: (usize, usize),
    fold_started: Instant,
    keeper: Option<Keeper>,
    /// A checkpoint could not be written, and that was said.
    failed: bool,
    /// Smallest training error so far.
    best: f64,
    bar: Option<ProgressBar>,
    last_line: Instant,
}

impl Follower {
    /// Begins now, and ends at the limit, if any.
    pub fn new(starts: usize, time_limit: Option<f64>, keeper: Option<Keeper>) -> Self {
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
            fold: (0, 1),
            fold_started: now,
            keeper,
            failed: false,
            best: f64::INFINITY,
            bar,
            last_line: now,
        }
    }

    /// From now on a fold is fitted to, of so many; it has the time limit for itself.
    pub fn begin_fold(&mut self, place: usize, of: usize) {
        self.fold = (place, of);
        self.fold_started = Instant::now();
        self.best = f64::INFINITY;
    }

    /// Hears of an iteration; breaks after Ctrl-C or at the time limit.
    pub fn observe(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.best = match progress.method {
            // The error of its best start, which need not be the lowest that was ever told.
            Method::LeastSquares if progress.train_nrmse_percent.is_nan() => self.best,
            Method::LeastSquares => progress.train_nrmse_percent,
            _ => self.best.min(progress.train_nrmse_percent),
        };
        let (place, of) = self.fold;
        let done = (place as f64 + progress.done) / of as f64;
        if let Some(bar) = &self.bar {
            bar.set_position((done * STEPS) as u64);
            bar.set_message(self.text(progress, done));
        } else if self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            note(format_args!("{:3.0} % {}", 100.0 * done, self.text(progress, done)));
        }
        let over =
            self.limit.is_some_and(|limit| self.fold_started.elapsed() >= limit) || interrupt::requested();
        if let Some(keeper) = &mut self.keeper
            && let Err(error) = keeper.observe(progress, over)
            && !std::mem::replace(&mut self.failed, true)
        {
            // The fit is worth more than its checkpoint.
            warning(format_args!("the fit continues without a checkpoint: {error}"));
        }
        if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Says a line without disturbing the bar.
    pub fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => note(format_args!("{text}")),
        }
    }

    /// Takes the bar away; tells the seconds spent.
    pub fn finish(self) -> f64 {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.started.elapsed().as_secs_f64()
    }

    fn text(&self, progress: &Progress, done: f64) -> String {
        let (place, of) = self.fold;
        let fold = if of > 1 { format!("fold {} of {of}, ", place + 1) } else { String::new() };
        format!("{fold}{}, {:.0} s left", part(progress, self.starts, self.best), self.seconds_left(done))
    }

    /// As far as the work done so far tells, and at most what the limit leaves.
    fn seconds_left(&self, done: f64) -> f64 {
        let elapsed = self.started.elapsed().as_secs_f64();
        let left = elapsed / done.max(1e-3) * (1.0 - done);
        let Some(limit) = self.limit.map(|limit| limit.as_secs_f64()) else { return left };
        let (place, of) = self.fold;
        let of_this = (limit - self.fold_started.elapsed().as_secs_f64()).max(0.0);
        left.min(of_this + (of - place - 1) as f64 * limit)
    }
}

/// What is being done, in words.
fn part(progress: &Progress, starts: usize, best: f64) -> String {
    // One fit of many: its starts, epochs and errors say nothing of the whole.
    if progress.is_part {
        return format!("fitting {}", progress.model.name());
    }
    if progress.phase == Phase::Starts {
        return "cross-validation".into();
    }
    let is_first = best == f64::INFINITY;
    let epoch = progress.epoch;
    let part = match progress.method {
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
    };
    if is_first {
        return part;
    }
    format!("{part}, error {:.3} % of std", Significant(best))
}
