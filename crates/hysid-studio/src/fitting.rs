//! Fits: one at a time, on a thread of its own, watched while it runs.

mod latest;
mod preview;
mod state;
mod watch;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;

use hysid::Model;
use hysid::fit::identify;
use hysid::options::FitSpec;
use hysid_app::{Beforehand, Identified, check_memory};
use hysid_document::{Problem, Result, problem};
use hysid_records::Data;

use latest::Latest;
pub use preview::FitPreview;
use state::Candidate;
pub use state::{FitEnd, FitState};
use watch::Watch;

/// The fits of a studio: the last one, running or ended.
#[derive(Default)]
pub struct Fits {
    last: Mutex<Option<RunningFit>>,
}

/// Called when a fit has news.
pub type Tell = Arc<dyn Fn() + Send + Sync>;

struct RunningFit {
    course: Arc<FitCourse>,
    thread: Option<JoinHandle<()>>,
}

/// State of a fit, its preview, and whether it is to stop.
pub struct FitCourse {
    state: Mutex<FitState>,
    preview: Mutex<Option<FitPreview>>,
    is_to_stop: AtomicBool,
    tell: Tell,
}

pub struct FitWork {
    pub id: u64,
    pub request: FitSpec,
    pub data: Arc<Data>,
    /// Reading and warnings from before the fit.
    pub beforehand: Beforehand,
    /// Number of the file with the first records, over which the best model so far is drawn.
    pub file: u64,
    /// Seconds after which the fit ends.
    pub time_limit: Option<f64>,
    /// Keeps the best model so far.
    pub keep: Keep,
}

/// Keeps the best model so far in a file.
pub type Keep = Box<dyn Fn(&Model) + Send + Sync>;

/// Takes what a fit has found, or why it has found nothing, and says how the fit has ended.
pub type Finish = Box<dyn FnOnce(Result<(Identified, Arc<Data>)>) -> FitEnd + Send>;

impl Fits {
    /// Begins a fit.
    ///
    /// # Errors
    /// Another one is running; too little memory.
    pub fn begin(&self, work: FitWork, finish: Finish, tell: Tell) -> Result<()> {
        let mut last = self.last();
        if last.as_ref().is_some_and(|last| last.course.state().is_running) {
            return Err(is_running());
        }
        let pool = hysid::thread_pool(None);
        let pool = pool.map_err(|error| problem!("cannot start the threads: {error}"))?;
        check_memory(&work.data.set, &work.request, pool.current_num_threads())
            .map_err(|error| work.data.explain(error))?;
        let course = Arc::new(FitCourse {
            state: Mutex::new(FitState::begun(work.id, &work.request)),
            preview: Mutex::new(None),
            is_to_stop: AtomicBool::new(false),
            tell,
        });
        let own = Arc::clone(&course);
        let thread = std::thread::Builder::new().name("fit".into()).spawn(move || {
            let found = caught(|| run(&own, work, &pool));
            let ended = caught(|| Ok(finish(found))).unwrap_or_else(FitEnd::Failed);
            own.change(|state| state.end(ended));
        });
        let thread = Some(thread.map_err(|error| problem!("cannot start the fit: {error}"))?);
        *last = Some(RunningFit { course, thread });
        Ok(())
    }

    /// The last fit; `None` before the first.
    pub fn state(&self) -> Option<FitState> {
        self.last().as_ref().map(|last| last.course.state().clone())
    }

    /// Simulation of the best model so far; `None` before there is one.
    pub fn preview(&self) -> Option<FitPreview> {
        let last = self.last();
        let preview = last.as_ref()?.course.preview.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        preview.clone()
    }

    /// Stops the fit with its best model so far.
    pub fn stop(&self) {
        if let Some(last) = &*self.last() {
            last.course.is_to_stop.store(true, Ordering::Relaxed);
        }
    }

    /// Says that the model of the last fit is stored after all.
    pub fn saved(&self, model: u64) {
        if let Some(last) = &*self.last() {
            last.course.change(|state| {
                (state.is_unsaved, state.problem, state.made) = (false, None, Some(model));
            });
        }
    }

    /// Says how a fit of an earlier studio has ended.
    pub fn taken_up(&self, state: FitState) {
        let course = FitCourse {
            state: Mutex::new(state),
            preview: Mutex::new(None),
            is_to_stop: AtomicBool::new(true),
            tell: Arc::new(|| ()),
        };
        *self.last() = Some(RunningFit { course: Arc::new(course), thread: None });
    }

    /// Ends the fit, if one is running, and waits until its model is saved.
    pub fn end(&self) {
        self.stop();
        let thread = self.last().as_mut().and_then(|last| last.thread.take());
        if let Some(thread) = thread {
            // A fit that panicked has said so.
            let _ = thread.join();
        }
    }

    fn last(&self) -> MutexGuard<'_, Option<RunningFit>> {
        self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

impl FitCourse {
    fn state(&self) -> MutexGuard<'_, FitState> {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Changes the state, and calls `tell`.
    fn change(&self, change: impl FnOnce(&mut FitState)) {
        change(&mut self.state());
        (self.tell)();
    }

    fn is_to_stop(&self) -> bool {
        self.is_to_stop.load(Ordering::Relaxed)
    }
}

/// The problem of a second fit.
pub fn is_running() -> Problem {
    Problem::Busy("a fit is running: stop it, or wait until it ends".into())
}

/// Result of `work`; a panic in it is an error.
pub fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let words = "an internal error ended this fit: this is a fault of Hysid, please report it with what the terminal says";
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err(words.into()))
}

fn run(course: &Arc<FitCourse>, work: FitWork, pool: &rayon::ThreadPool) -> Result<(Identified, Arc<Data>)> {
    let FitWork { request, data, beforehand, file, time_limit, keep, .. } = work;
    let models = Latest::default();
    std::thread::scope(|scope| {
        let (drawn, of_data) = (&models, &*data);
        scope.spawn(move || preview::draw(drawn, course, of_data, file, &keep));
        let mut watch = Watch::new(course, drawn, request.starts(), time_limit);
        let fitted = pool.install(|| identify(&data.set, &request, &mut |progress| watch.observe(progress)));
        let seconds = watch.finish();
        let fitted = fitted.map_err(|error| data.explain(error))?;
        course.change(|state| {
            (state.done, state.part) = (1.0, "writing model and report".into());
            (state.remaining, state.remaining_seconds) = (None, None);
        });
        let identified = Identified {
            model: fitted.model,
            evaluations: fitted.evaluations,
            held_out: fitted.held_out,
            seconds: Some(seconds),
            beforehand,
        };
        Ok((identified, Arc::clone(&data)))
    })
}

#[cfg(test)]
mod tests {
    use hysid::options::ModelName;
    use hysid_document::Face;
    use hysid_records::{Roles, csv_text};
    use hysid_tables::{Reading, Table};

    use super::*;

    fn work() -> FitWork {
        let specimen = hysid::specimens::Specimen::named("ferromagnet").unwrap();
        let text = csv_text(&specimen.train_with_seed(1));
        let path = std::path::Path::new("a.csv");
        let table = Table::from_bytes(path, text.into_bytes(), &Reading::default()).unwrap();
        let roles = Roles::detect(&table, &hysid_records::ColumnChoice::default()).unwrap();
        let data = Arc::new(Data::new(vec![table], roles, None).unwrap());
        let request = FitSpec::of("prandtl-ishlinskii".parse::<ModelName>().unwrap(), None, 1);
        let beforehand = Beforehand::of(&data, &request, Face::Studio).unwrap();
        FitWork { id: 1, request, data, beforehand, file: 1, time_limit: None, keep: Box::new(|_| ()) }
    }

    #[test]
    fn a_panic_ends_the_fit_and_not_the_studio() {
        let fits = Fits::default();
        let silent: Tell = Arc::new(|| ());
        fits.begin(work(), Box::new(|_| panic!("while the model is stored")), Arc::clone(&silent)).unwrap();
        fits.end();
        let state = fits.state().unwrap();
        assert!(
            !state.is_running && state.problem.unwrap().text().contains("an internal error ended this fit")
        );
        // One in the fit itself is told to who takes its result.
        let in_fit = FitWork { keep: Box::new(|_| panic!("while the fit runs")), ..work() };
        fits.begin(
            in_fit,
            Box::new(|found| found.map_or_else(FitEnd::Failed, |_| FitEnd::Stored(7))),
            silent,
        )
        .unwrap();
        fits.end();
        assert!(!fits.state().unwrap().is_running);
    }
}
