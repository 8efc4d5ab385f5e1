//! An observer that is shared among threads: called with the progress between rounds or fits, and in between
//! to check whether to stop.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard};

use crate::fit::progress::{Observer, Progress};
use crate::termination::Termination;

pub(crate) struct SharedObserver<'o, 'a> {
    observer: Mutex<ObserverState<'o, 'a>>,
    is_over: AtomicBool,
}

struct ObserverState<'o, 'a> {
    observer: &'o mut Observer<'a>,
    last: Option<Progress<'static>>,
}

impl<'o, 'a> SharedObserver<'o, 'a> {
    /// `first` is the progress to report before there is any; without it, nothing is reported then.
    pub fn new(observer: &'o mut Observer<'a>, first: Option<Progress<'static>>) -> Self {
        Self {
            observer: Mutex::new(ObserverState { observer, last: first }),
            is_over: AtomicBool::new(false),
        }
    }

    /// Reports the progress. Once the observer has broken off, it is not called again.
    pub fn tell(&self, progress: &Progress) -> ControlFlow<()> {
        let mut told = self.told();
        // It may have said stop to another thread that was waited for.
        if self.is_over() {
            return ControlFlow::Break(());
        }
        told.last = Some(progress.without_state());
        let flow = (told.observer)(progress);
        if flow.is_break() {
            self.is_over.store(true, Ordering::Relaxed);
        }
        flow
    }

    /// Tells where the fit was when the observer said stop.
    pub fn tell_last(&self, progress: &Progress) {
        // It has said what it wants.
        let _ = (self.told().observer)(progress);
    }

    /// Asks whether to stop, telling the last progress once more.
    pub fn is_to_stop(&self) -> bool {
        if self.is_over() {
            return true;
        }
        // Another thread is asking, and will be answered.
        let Ok(mut told) = self.observer.try_lock() else { return self.is_over() };
        let ObserverState { observer, last } = &mut *told;
        if last.as_ref().is_some_and(|last| observer(last).is_break()) {
            self.is_over.store(true, Ordering::Relaxed);
        }
        self.is_over()
    }

    /// True once the observer has said stop.
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    /// Why a fit ended that would otherwise have ended so.
    pub fn termination(&self, otherwise: Termination) -> Termination {
        if self.is_over() { Termination::Stopped } else { otherwise }
    }

    fn told(&self) -> MutexGuard<'_, ObserverState<'o, 'a>> {
        self.observer.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
