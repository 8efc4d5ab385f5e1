//! The observer of a fit: a bar on a terminal, now and then a line elsewhere; Ctrl-C and time limit.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use hysid::fit::progress::Progress;
use hysid_app::ProgressText;
use hysid_app::validation::ValidateObserver;
use hysid_core::significant::Significant;
use hysid_document::plain::WIDTH;
use hysid_document::progress::{Line, Remaining, in_words, share_done};
use indicatif::{ProgressBar, ProgressStyle};

use crate::checkpoint::Keeper;
use crate::interrupt;
use crate::messages::{is_quiet, note, warning};

/// Without a terminal, one line in this time at most.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Follows a fit, or the fits to several folds one after the other.
pub struct Follower {
    started: Instant,
    /// Time for each fold.
    limit: Option<Duration>,
    course: ProgressText,
    starts: usize,
    /// The fold that is fitted to, counted from 0, and how many there are; a fit to everything is the only one.
    fold: (usize, usize),
    fold_started: Instant,
    keeper: Option<Keeper>,
    /// True once a checkpoint could not be written and the warning was printed.
    failed: bool,
    bar: Option<ProgressBar>,
    remaining: Remaining,
    last_line: Instant,
}

impl Follower {
    /// Begins now, and ends at the limit, if any.
    pub fn new(starts: usize, time_limit: Option<f64>, keeper: Option<Keeper>) -> Self {
        let bar = (std::io::stderr().is_terminal() && !is_quiet()).then(|| {
            let bar = ProgressBar::new_spinner();
            // What is wider than the terminal is cut: it may have been made narrower since.
            let style = ProgressStyle::with_template("{wide_msg}");
            bar.set_style(style.expect("the template is sound"));
            bar
        });
        let now = Instant::now();
        let limit = time_limit.map(Duration::from_secs_f64);
        Self {
            started: now,
            limit,
            course: ProgressText::new(starts),
            starts,
            fold: (0, 1),
            fold_started: now,
            keeper,
            failed: false,
            bar,
            remaining: Remaining::default(),
            last_line: now,
        }
    }

    /// Shows the progress; breaks after Ctrl-C or at the time limit.
    pub fn observe(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.course.take(progress);
        let (place, of) = self.fold;
        let elapsed = self.fold_started.elapsed().as_secs_f64();
        let of_fold = share_done(progress.done, elapsed, self.limit.map(|limit| limit.as_secs_f64()));
        let done = (place as f64 + of_fold) / of as f64;
        let line = self.line(progress, done);
        if let Some(bar) = &self.bar {
            // The last column stays free: some terminals wrap when it is filled.
            let columns = columns().saturating_sub(1);
            bar.set_message(line.in_columns(columns));
            bar.tick();
        } else if self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            note(format_args!("{}", line.without_bar(WIDTH)));
        }
        let over =
            self.limit.is_some_and(|limit| self.fold_started.elapsed() >= limit) || interrupt::requested();
        if let Some(keeper) = &mut self.keeper
            && let Err(error) = keeper.observe(progress, over)
            && !std::mem::replace(&mut self.failed, true)
        {
            // The fit is worth more than its checkpoint.
            self.warn(&format!("the fit continues without a checkpoint: {error}"));
        }
        if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Warns without disturbing the bar.
    pub fn warn(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| warning(text)),
            None => warning(text),
        }
    }

    /// Removes the bar; returns the seconds spent.
    pub fn finish(self) -> f64 {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.started.elapsed().as_secs_f64()
    }

    fn line(&mut self, progress: &Progress, done: f64) -> Line {
        let (place, of) = self.fold;
        let left = self.remaining.after(self.started.elapsed().as_secs_f64(), done, self.limit_left());
        Line {
            done,
            fold: (of > 1).then_some((place + 1, of)),
            part: self.course.part(progress),
            error: self.course.error(progress).map(|error| format!("{:.3}", Significant(error))),
            left: left.map(in_words),
        }
    }

    /// Seconds that the time limit leaves to this fold and those behind it.
    fn limit_left(&self) -> Option<f64> {
        let limit = self.limit?.as_secs_f64();
        let (place, of) = self.fold;
        let of_this = (limit - self.fold_started.elapsed().as_secs_f64()).max(0.0);
        Some(of_this + (of - place - 1) as f64 * limit)
    }
}

impl ValidateObserver for Follower {
    fn is_to_stop(&self) -> bool {
        interrupt::requested()
    }

    /// Begins a fold, which has the time limit for itself.
    fn begin_fold(&mut self, place: usize, count: usize) {
        self.fold = (place, count);
        self.fold_started = Instant::now();
        self.course = ProgressText::new(self.starts);
    }

    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        Self::observe(self, progress)
    }

    fn say(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None => note(format_args!("{line}")),
        }
    }

    fn warn(&self, line: &str) {
        Self::warn(self, line);
    }
}

/// Prints on stderr, every few seconds, that work without a known share goes on.
pub fn while_working<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let (done, is_done) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            // An error says that the work is over.
            while let Err(mpsc::RecvTimeoutError::Timeout) = is_done.recv_timeout(BETWEEN_LINES) {
                note(format_args!("{what}: {:.0} s (Ctrl-C stops)", began.elapsed().as_secs_f64()));
            }
        });
        let result = work();
        drop(done);
        result
    })
}

/// Columns of the terminal behind stderr.
fn columns() -> usize {
    terminal_size::terminal_size_of(std::io::stderr()).map_or(WIDTH, |(width, _)| usize::from(width.0))
}
