//! The memory of a fit.

use hysid::data::record::Dataset;
use hysid::fit::memory_need;
use hysid::options::FitSpec;

/// Refuses a fit with this number of threads that needs more memory than there is.
///
/// # Errors
/// Too little memory, or options that are no valid network for these data.
pub fn check_memory(data: &Dataset, spec: &FitSpec, threads: usize) -> hysid::Result<()> {
    memory_need(data, spec, threads)?.check(hysid_files::available_memory())
}
