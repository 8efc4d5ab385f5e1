//! Peak memory of the training of a network.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::memory_need::{FEWER_ROWS, MemoryNeed, numbers};
use crate::fit::network::curvature::has_few_rows;
use crate::fit::network::fitting::room;
use crate::linear_algebra::dilated_space::DilatedSpace;
use crate::network::Architecture;
use crate::options::network::{FitOptions, Trainer};

/// Runs on folds: three starts on each of five.
const RUNS_ON_FOLDS: usize = 15;

const FEWER_NEURONS: &str = "choose fewer hidden, stops or relaxation neurons, or fewer inputs";
const FEWER_STARTS: &str = "choose fewer starts or fewer neurons";
const SMALLER_POPULATION: &str = "choose a smaller population, fewer starts, or fewer neurons";

/// The peak memory of a fit with this number of threads.
///
/// # Errors
/// Options that are no valid network for these data.
pub(crate) fn memory_need(data: &Dataset, options: &FitOptions, threads: usize) -> Result<MemoryNeed> {
    let architecture = options.architecture(data)?;
    let (searched, features) = (architecture.searched_parameters(), architecture.output_weights());
    let rows = data.scored().min(options.thin);
    let (p, m, n) = (searched as f64, features as f64, rows as f64);
    let busy = threads.min(options.starts.max(if options.starts > 1 { RUNS_ON_FOLDS } else { 1 })) as f64;

    let evaluation = 4.0 * m * m;
    let slope = match options.training {
        // A backward pass needs no matrix.
        _ if options.training != Trainer::LevenbergMarquardt => 100.0 * p,
        _ if has_few_rows(searched, features, rows) => 2.0 * p * (n + m) + 3.0 * (n + m) * (n + m),
        _ => (m + p) * (m + p) + p * p + p * m,
    };
    // Rows of the columns that a matrix is made of.
    let buffers = 500.0 * if options.training == Trainer::LevenbergMarquardt { m + p } else { m };
    let all_runs = options.starts.saturating_add(if options.starts > 1 { RUNS_ON_FOLDS } else { 0 });
    let space = DilatedSpace::numbers(searched, options.epochs) as f64;
    let under_way = all_runs.min(room(searched, options.epochs, threads));
    let state = match options.training {
        Trainer::LevenbergMarquardt => 0.0,
        Trainer::Genetic => 2.0 * options.population as f64 * p,
        Trainer::Subgradient => space,
        Trainer::Hybrid => space.max(2.0 * options.population as f64 * p),
    };
    let (kept, states) = (all_runs as f64 * (m * m + 4.0 * p), under_way as f64 * (m * m + state));
    let of_states = match options.training.is_genetic() {
        true => (format!("populations of {} for {under_way} runs", options.population), SMALLER_POPULATION),
        false => (format!("the search in {searched} parameters"), FEWER_NEURONS),
    };
    let copies = copies_of_data(data, &architecture, options.starts > 1);
    let total = busy * (evaluation + slope + buffers) + kept + states + copies;
    Ok(MemoryNeed::largest_of(
        total,
        [
            (busy * slope, format!("derivatives by {searched} searched parameters"), FEWER_NEURONS),
            (busy * evaluation, format!("sums over {features} output weights"), FEWER_NEURONS),
            (kept, format!("{all_runs} runs of {searched} searched parameters"), FEWER_STARTS),
            (states, of_states.0, of_states.1),
            (copies, format!("{} rows of {} inputs", data.rows(), architecture.channels()), FEWER_ROWS),
        ],
    ))
}

/// Copies of the data that training works on: scaled, and again for each fold.
fn copies_of_data(data: &Dataset, architecture: &Architecture, is_validated: bool) -> f64 {
    let drives = data.rows() as f64 * (architecture.channels() + 4) as f64;
    let folds = if is_validated { 5.0 } else { 0.0 };
    (1.0 + 2.0 * folds) * (drives + numbers(data))
}
