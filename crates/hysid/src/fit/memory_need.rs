//! Peak memory of an identification, estimated before it begins.
//!
//! Only large parts are counted: matrices as wide as the number of parameters or features, states of many
//! starts, and copies of the data. The estimates are within a factor of three of measured values; the tests
//! check this.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::auto;
use crate::fit::law::duhem_nn;
use crate::fit::law::hysteretic_dynamics::{self, DynamicsSpec};
use crate::fit::law::random_stops::HIDDEN;
use crate::fit::network::curvature::has_few_rows;
use crate::fit::network::fitting::room;
use crate::law::duhem_nn::CellLayout;
use crate::law::hysteretic_dynamics::DynamicsForm;
use crate::linear_algebra::dilated_space::DilatedSpace;
use crate::network::Architecture;
use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::input_options::HISTORY_INPUTS;
use crate::options::network::{FitOptions, Trainer};

const NUMBER: f64 = 8.0;

/// Rows that a search compares with the measured output, at most.
const ROWS_OF_A_SEARCH: usize = 5000;

/// Runs on folds: three starts on each of five.
const RUNS_ON_FOLDS: usize = 15;

/// Largest number of searched parameters of a law without operators and neurons, about.
const MOST_PARAMETERS_OF_A_LAW: usize = 40;

/// Peak memory of an identification, without that of the data themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryNeed {
    /// Peak memory in bytes.
    pub bytes: f64,
    /// Largest part of it, in words.
    pub taken_by: String,
    /// How to reduce it, in words.
    pub advice: &'static str,
}

impl MemoryNeed {
    /// Checks that the need is not beyond the `available` bytes.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn check(&self, available: f64) -> Result<()> {
        if self.bytes <= available {
            return Ok(());
        }
        let Self { bytes: needed, taken_by, advice } = self.clone();
        Err(Error::Memory { needed, available, taken_by, advice })
    }

    /// Of a number of floating-point numbers.
    fn of(numbers: f64, taken_by: impl Into<String>, advice: &'static str) -> Self {
        Self { bytes: NUMBER * numbers, taken_by: taken_by.into(), advice }
    }
}

/// The peak memory of an identification with this number of threads.
///
/// # Errors
/// Options that are no valid network for these data.
pub fn memory_need(data: &Dataset, request: &FitSpec, threads: usize) -> Result<MemoryNeed> {
    match request {
        FitSpec::Network(options) => of_network(data, options, threads),
        FitSpec::Classical(options) => Ok(of_classical(data, options, threads)),
        FitSpec::Auto(options) => {
            let mut largest = MemoryNeed::of(0.0, "nothing", "");
            for candidate in auto::requests(data, options) {
                // Candidates that cannot be fitted to these data are passed over, as in the fit.
                let Ok(need) = memory_need(data, &candidate, 1) else { continue };
                if need.bytes > largest.bytes {
                    largest = need;
                }
            }
            // Each thread fits a candidate of its own, on folds that are copies of the data.
            let copies = 10.0 * numbers(data);
            Ok(MemoryNeed { bytes: threads as f64 * largest.bytes + NUMBER * copies, ..largest })
        }
    }
}

fn numbers(data: &Dataset) -> f64 {
    let columns =
        data.names().inputs.len() + 1 + usize::from(data.has_time()) + usize::from(data.has_given_rate());
    data.rows() as f64 * columns as f64
}

fn of_network(data: &Dataset, options: &FitOptions, threads: usize) -> Result<MemoryNeed> {
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
    Ok(largest_of(
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

const FEWER_NEURONS: &str = "choose fewer hidden, stops or relaxation neurons, or fewer inputs";
const FEWER_STARTS: &str = "choose fewer starts or fewer neurons";
const SMALLER_POPULATION: &str = "choose a smaller population, fewer starts, or fewer neurons";
const FEWER_ROWS: &str = "fit to fewer rows";
const FEWER_OPERATORS: &str = "choose fewer operators";

/// Copies of the data that training works on: scaled, and again for each fold.
fn copies_of_data(data: &Dataset, architecture: &Architecture, is_validated: bool) -> f64 {
    let drives = data.rows() as f64 * (architecture.channels() + 4) as f64;
    let folds = if is_validated { 5.0 } else { 0.0 };
    (1.0 + 2.0 * folds) * (drives + numbers(data))
}

/// A need with what takes most of it.
fn largest_of<const N: usize>(total: f64, parts: [(f64, String, &'static str); N]) -> MemoryNeed {
    let largest = parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (_, taken_by, advice) = largest.expect("there are parts");
    MemoryNeed::of(total, taken_by, advice)
}

fn of_classical(data: &Dataset, options: &ClassicalOptions, threads: usize) -> MemoryNeed {
    let (rows, scored, threads) = (data.rows() as f64, data.scored() as f64, threads as f64);
    let copies = 2.0 * numbers(data) + 6.0 * rows;
    let folds = if data.records().len() < 10 { 5.0 } else { 10.0 };
    // Sums of each fold and of all, and on each thread those less a fold with what is solved for.
    let linear = |features: f64, operators: usize| {
        let sums = (folds + 1.0 + 5.0 * threads) * features * features;
        let sums = (sums, format!("sums over {operators} operators"), FEWER_OPERATORS);
        largest_of(sums.0 + copies, [sums, (copies, format!("{rows} rows"), FEWER_ROWS)])
    };
    let given = options.thresholds.as_ref().map(Vec::len);
    let plays = given.unwrap_or(options.operators());
    match options.model {
        ClassicalModel::PrandtlIshlinskii | ClassicalModel::Masing => linear(plays as f64 + 3.0, plays),
        ClassicalModel::ModifiedPrandtlIshlinskii => {
            let zones = 2 * options.dead_zones();
            let sums = linear((plays + zones + 3) as f64, plays);
            // Plays of every row are stored for each grid, and copied for each fold that is under way.
            let plays_of_rows = (3.0 + 2.0 * threads) * scored * (plays + 6) as f64;
            let taken_by = format!("{plays} plays at each of {scored} rows");
            let advice = "choose fewer operators, or fit to fewer rows";
            largest_of(
                sums.bytes / NUMBER + plays_of_rows,
                [(sums.bytes / NUMBER, sums.taken_by, sums.advice), (plays_of_rows, taken_by, advice)],
            )
        }
        ClassicalModel::Preisach => {
            let intervals = options.operators() as f64;
            let cells = 0.5 * intervals * (intervals + 1.0) + intervals + 3.0;
            let coarse = linear(233.0, 20);
            let fine = 3.0 * cells * cells;
            let taken_by = format!("sums over the {cells} cells of {intervals} intervals");
            largest_of(
                coarse.bytes / NUMBER + fine,
                [(coarse.bytes / NUMBER, coarse.taken_by, FEWER_ROWS), (fine, taken_by, FEWER_OPERATORS)],
            )
        }
        ClassicalModel::RandomStops => {
            let inputs = data.names().inputs.len() + if options.shaping.history { HISTORY_INPUTS } else { 0 };
            let (stops, hidden) = (options.operators(), options.hidden.unwrap_or(HIDDEN));
            let features = (stops + hidden + 3) as f64;
            let weights = (hidden * stops) as f64;
            let mut need = linear(features, stops);
            need.bytes += NUMBER * (600.0 * (features + weights / 10.0) + rows * (inputs + 4) as f64);
            need
        }
        ClassicalModel::DuhemNn => {
            let starts = options.starts() as f64;
            let layout = CellLayout::new(duhem_nn::shape_of(options, data.has_time()));
            let (p, m) = (layout.count() as f64, layout.shape.terms() as f64);
            let busy = threads.min(starts);
            // Gram matrix, curvature and its damped copy, two at a time, each written below its diagonal only.
            let derivatives = 1.5 * (m + p) * (m + p) + p * m + 270.0 * (m + p);
            let all = busy * derivatives + starts * 6.0 * (p + m * m) + 2.0 * copies;
            let taken_by = format!("derivatives by {p} searched parameters");
            largest_of(
                all,
                [
                    (busy * derivatives, taken_by, "choose fewer hidden, states or operators"),
                    (copies, format!("{rows} rows"), FEWER_ROWS),
                ],
            )
        }
        ClassicalModel::HystereticOscillator | ClassicalModel::HystereticStateSpace => {
            let form = match options.model {
                ClassicalModel::HystereticOscillator => DynamicsForm::Oscillator,
                _ => DynamicsForm::StateSpace,
            };
            // Numbers that no model can have are refused by the fit itself.
            let parameters = DynamicsSpec::of(form, options).map_or(0, |asked| asked.layout().count());
            let (p, starts) = (parameters as f64, options.starts() as f64);
            let at_once = data.records().len().min(hysteretic_dynamics::AT_ONCE) as f64;
            let busy = threads.min(starts * at_once);
            // As for a Duhem network. A start keeps the sums of some records until it adds them.
            let derivatives = 1.5 * p * p + 300.0 * p + starts * at_once * p * p / busy;
            let taken_by = format!("derivatives by {parameters} searched parameters");
            largest_of(
                busy * derivatives + starts * 6.0 * p + 2.0 * copies,
                [
                    (busy * derivatives, taken_by, "choose fewer hidden, states, modes or operators"),
                    (copies, format!("{rows} rows"), FEWER_ROWS),
                ],
            )
        }
        _ => {
            let starts = options.starts() as f64;
            let compared = scored.min(ROWS_OF_A_SEARCH as f64);
            let variables =
                options.operators().max(options.hidden() * 5).max(MOST_PARAMETERS_OF_A_LAW) as f64;
            let residuals = (starts + 3.0 * variables * threads) * compared + 24.0 * starts * 20.0;
            let taken_by = format!("residuals of {starts} starts");
            largest_of(
                residuals + copies,
                [(residuals, taken_by, "choose fewer starts"), (copies, format!("{rows} rows"), FEWER_ROWS)],
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;
    use crate::data::record::{ColumnNames, Record};
    use crate::options::ModelName;
    use crate::options::chosen::NamedOptions;

    fn data(rows: usize, inputs: usize) -> Dataset {
        let input = |c: usize| (0..rows).map(|k| sin((k + c) as f64 * 0.1)).collect();
        let time = (0..rows).map(|k| k as f64).collect();
        let inputs: Vec<Vec<f64>> = (0..inputs).map(input).collect();
        let output = inputs[0].clone();
        let names = ColumnNames::plain(inputs.len());
        let record = Record::new("r", inputs, output).unwrap().with_time(time).unwrap();
        Dataset::new(names, vec![record]).unwrap()
    }

    fn need(data: &Dataset, options: serde_json::Value) -> MemoryNeed {
        let serde_json::Value::Object(options) = options else { panic!("a map") };
        let request = NamedOptions::of(options).unwrap().request(None, false);
        memory_need(data, &request, 2).unwrap()
    }

    #[test]
    fn the_largest_network_is_refused_with_numbers_and_advice() {
        let rows = data(200_000, 1);
        let sizes = serde_json::json!({ "model": "xpnn+", "stops": 300, "hidden": 300, "training": "levenberg-marquardt" });
        let need = need(&rows, sizes);
        assert!(need.bytes > 60e9, "{need:?}");
        let error = need.check(16e9).unwrap_err().to_string();
        for words in ["GB", "16.0 GB are available", "searched parameters", "fewer hidden"] {
            assert!(error.contains(words), "{error}");
        }
        assert!(need.check(1e13).is_ok());
    }

    #[test]
    fn few_rows_of_many_inputs_need_little() {
        let wide = data(50, 99);
        let need = need(&wide, serde_json::json!({ "model": "xpnn+" }));
        assert!(need.bytes < 300e6, "{need:?}");
    }

    #[test]
    fn every_model_has_an_estimate() {
        let rows = data(1000, 1);
        for model in ModelName::all().chain([ModelName::AUTO]) {
            let need = need(&rows, serde_json::json!({ "model": model.name() }));
            assert!(need.bytes > 1e4 && need.bytes < 1e9, "{}: {need:?}", model.name());
        }
        let fine = need(&rows, serde_json::json!({ "model": "preisach", "operators": 200 }));
        assert!(fine.bytes > 5e9 && fine.taken_by.contains("cells"), "{fine:?}");
    }
}
