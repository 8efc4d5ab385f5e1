//! A place for the latest of several values: who takes them gets the newest, and misses those before it.

use std::sync::{Condvar, Mutex, MutexGuard};

/// A place for the latest value.
pub struct Latest<T> {
    held: Mutex<Held<T>>,
    changed: Condvar,
}

struct Held<T> {
    value: Option<T>,
    is_over: bool,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Self { held: Mutex::new(Held { value: None, is_over: false }), changed: Condvar::new() }
    }
}

impl<T> Latest<T> {
    /// Puts a value there, in place of one that was not taken.
    pub fn put(&self, value: T) {
        self.held().value = Some(value);
        self.changed.notify_one();
    }

    /// There will be no further value.
    pub fn close(&self) {
        self.held().is_over = true;
        self.changed.notify_one();
    }

    /// Waits for a value; `None` once there will be none.
    pub fn take(&self) -> Option<T> {
        let mut held = self.held();
        loop {
            if held.is_over {
                return None;
            }
            if let Some(value) = held.value.take() {
                return Some(value);
            }
            held = self.changed.wait(held).unwrap_or_else(|poisoned| poisoned.into_inner());
        }
    }

    fn held(&self) -> MutexGuard<'_, Held<T>> {
        self.held.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_taken_and_nothing_after_the_end() {
        let latest = Latest::default();
        latest.put(1);
        latest.put(2);
        assert_eq!(latest.take(), Some(2));
        std::thread::scope(|scope| {
            let taken = scope.spawn(|| latest.take());
            latest.put(3);
            assert_eq!(taken.join().unwrap(), Some(3));
            let taken = scope.spawn(|| latest.take());
            latest.close();
            assert_eq!(taken.join().unwrap(), None);
        });
        latest.put(4);
        assert_eq!(latest.take(), None);
    }
}
