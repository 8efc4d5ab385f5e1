//! Requests to stop long computations.
//!
//! Loops that may run for more than some hundredths of a second count their operations with a [`Pace`] and
//! end when it is over. Their results are then incomplete and must be discarded: the caller checks
//! [`StopCheck::is_asked`] before it uses them.

use std::fmt;

/// A check whether a computation is to stop. Once it has returned true it always returns true.
#[derive(Clone, Copy)]
pub struct StopCheck<'a>(&'a (dyn Fn() -> bool + Sync + 'a));

impl<'a> StopCheck<'a> {
    /// A check by this function, which may be called from any thread and takes no more than microseconds.
    pub fn new(ask: &'a (dyn Fn() -> bool + Sync + 'a)) -> Self {
        Self(ask)
    }

    /// A check that never stops.
    pub fn never() -> StopCheck<'static> {
        StopCheck(&|| false)
    }

    /// True once the computation is to stop.
    pub fn is_asked(self) -> bool {
        (self.0)()
    }
}

impl fmt::Debug for StopCheck<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("StopCheck")
    }
}

/// Elementary operations between two questions, about a millisecond.
const BETWEEN: usize = 2_000_000;

/// Counts the operations of a loop and checks at intervals whether to stop.
#[derive(Debug, Clone)]
pub struct Pace<'a> {
    stop: StopCheck<'a>,
    /// Operations until the next question.
    left: usize,
    is_over: bool,
}

impl<'a> Pace<'a> {
    /// Nothing counted yet.
    pub fn new(stop: StopCheck<'a>) -> Self {
        Self { stop, left: BETWEEN, is_over: false }
    }

    /// Adds operations to the count; true once the computation is to stop.
    #[inline(always)]
    pub fn is_over(&mut self, operations: usize) -> bool {
        if operations < self.left {
            self.left -= operations;
            return self.is_over;
        }
        self.ask()
    }

    #[cold]
    fn ask(&mut self) -> bool {
        self.left = BETWEEN;
        self.is_over = self.is_over || self.stop.is_asked();
        self.is_over
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn a_pace_asks_once_for_so_many_operations_and_keeps_the_answer() {
        let asked = AtomicUsize::new(0);
        let third_time = || asked.fetch_add(1, Ordering::Relaxed) == 2;
        let mut pace = Pace::new(StopCheck::new(&third_time));
        let done = (0..).take_while(|_| !pace.is_over(BETWEEN / 100)).count();
        assert_eq!(asked.load(Ordering::Relaxed), 3);
        assert!((297..=303).contains(&done), "{done}");
        assert!(pace.is_over(1) && pace.is_over(BETWEEN));
        assert_eq!(asked.load(Ordering::Relaxed), 3);
    }
}
