//! Jobs shared out among the threads of the pool. Results stand in the order of the jobs, so that nothing depends on the
//! number of threads.
//!
//! The pool runs one kind of job, whatever the results are: its code is compiled once and not for every caller.

use std::sync::{Mutex, PoisonError};

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// The results of a job for each number below `count`.
pub(crate) fn numbered<T: Send>(count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let places: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    share_out(count, &|number| {
        let result = job(number);
        *places[number].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
    });
    let results = places.into_iter().map(|place| place.into_inner().unwrap_or_else(PoisonError::into_inner));
    results.map(|result| result.expect("every job is done")).collect()
}

/// The results of a job for each item.
pub(crate) fn each<I: Sync, T: Send>(items: &[I], job: impl Fn(&I) -> T + Sync) -> Vec<T> {
    numbered(items.len(), |number| job(&items[number]))
}

/// The results of a job for each item, which the job takes.
pub(crate) fn each_taken<I: Send, T: Send>(
    items: impl IntoIterator<Item = I>,
    job: impl Fn(I) -> T + Sync,
) -> Vec<T> {
    let items: Vec<Mutex<Option<I>>> = items.into_iter().map(|item| Mutex::new(Some(item))).collect();
    numbered(items.len(), |number| {
        let item = items[number].lock().unwrap_or_else(PoisonError::into_inner).take();
        job(item.expect("each item is taken once"))
    })
}

fn share_out(count: usize, job: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(job);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_jobs() {
        assert_eq!(numbered(1000, |number| number * number)[999], 999 * 999);
        assert_eq!(each(&["a", "bc", ""], |text| text.len()), [1, 2, 0]);
        let mut counts = [3, 5];
        let of = |(place, count): (usize, &mut i32)| {
            *count += 1;
            (place, *count)
        };
        assert_eq!(each_taken(counts.iter_mut().enumerate(), of), [(0, 4), (1, 6)]);
        assert_eq!(counts, [4, 6]);
        assert!(numbered(0, |number| number).is_empty());
    }

    #[test]
    fn a_job_that_panics_panics_here() {
        let job = |number: usize| assert_ne!(number, 7, "the seventh");
        assert!(std::panic::catch_unwind(|| numbered(20, job)).is_err());
    }
}
