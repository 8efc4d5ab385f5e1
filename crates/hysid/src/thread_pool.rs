//! The threads of a computation.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Threads of a pool at most.
pub const MOST_THREADS: usize = 1024;

/// A pool of so many threads, at most [`MOST_THREADS`]; of one for each processor if no number is given. No variable of the
/// environment changes it: `RAYON_NUM_THREADS=99999` would start as many.
///
/// # Errors
/// Threads that the system does not start.
pub fn thread_pool(threads: Option<usize>) -> Result<ThreadPool, ThreadPoolBuildError> {
    let of_processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(of_processors).clamp(1, MOST_THREADS);
    ThreadPoolBuilder::new().num_threads(threads).build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_has_the_threads_that_are_asked_for_within_its_bound() {
        assert_eq!(thread_pool(Some(3)).unwrap().current_num_threads(), 3);
        assert_eq!(thread_pool(Some(0)).unwrap().current_num_threads(), 1);
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        assert_eq!(thread_pool(None).unwrap().current_num_threads(), processors.min(MOST_THREADS));
    }
}
