//! Cycles and first-order reversal curves of a fitted model, which is driven for them.
//!
//! ```text
//! cycles            of growing amplitude, two of each, over the trained range: about its middle if it has both signs,
//!                   otherwise from its end next to 0; three over the whole range at each trained speed
//! reversal curves   from forty inputs on the falling branch back to the upper end of the trained range
//! magnets           the initial curve, and the anhysteretic one, where oscillations about each input end that decay
//! ```

use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::error::Result;
use hysid_core::model::Model;

use super::magnetisation::{self, MagnetisationNode};
use super::probe::{Probe, Probing};
use crate::DiagnosisOptions;
use crate::cycles::{CycleOptions, CycleTable, Field};
use crate::reversal_curves::{ReversalCurveOptions, ReversalCurves};

/// Amplitudes of the growing cycles.
const AMPLITUDES: usize = 8;

/// Cycles of each amplitude.
const REPEATS: usize = 2;

const AT_A_SPEED: usize = 3;

/// Reversal inputs of the reversal curves.
const REVERSALS: u32 = 40;

/// A range whose smaller side is this share of the larger one has both signs.
const BOTH_SIGNS: f64 = 0.2;

/// Reversals of the smallest cycles count.
const SMALLEST_REVERSAL: f64 = 0.25 / AMPLITUDES as f64;

/// The cycles and reversal curves of a model, and what it was driven with.
///
/// ```
/// use hysid::Fit;
/// use hysid_diagnosis::model::ModelCycles;
/// use hysid_specimens::Specimen;
///
/// let sheet = Specimen::named("ferromagnet").unwrap().train();
/// let model = Fit::new().model("preisach").run(&sheet)?;
/// let cycles = ModelCycles::of(&model, &Default::default(), None)?;
/// assert!(cycles.table.complete().all(|cycle| cycle.energy.unwrap() > 0.0));
/// assert!(cycles.reversal_curves.unwrap().largest_density() > 0.0);
/// # Ok::<(), hysid_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCycles {
    /// Drives of the model.
    pub probing: Probing,
    /// The cycles: input, output and time.
    pub data: Dataset,
    /// Their figures.
    pub table: CycleTable,
    /// Its first-order reversal curves; `None` if its output is the same everywhere at a vanishing speed.
    pub reversal_curves: Option<ReversalCurves>,
    /// Initial and anhysteretic curve of a magnet whose range has both signs; otherwise empty.
    pub magnetisation: Vec<MagnetisationNode>,
}

impl ModelCycles {
    /// Drives a fitted model through cycles and reversal curves. Of `options`, the reversals and the smoothing are those of a
    /// model and are ignored; `smoothing_factor` is that of [`ReversalCurveOptions`].
    ///
    /// # Errors
    /// A model that was trained on no range of the input, or whose output is the same everywhere.
    pub fn of(model: &Model, options: &CycleOptions, smoothing_factor: Option<usize>) -> Result<Self> {
        let probe = Probe::new(model)?;
        let data = cycles(&probe)?;
        let branches = DiagnosisOptions { smallest_reversal: SMALLEST_REVERSAL, smoothing: false };
        let options = CycleOptions {
            smallest_reversal: Some(branches.smallest_reversal),
            smoothing: branches.smoothing,
            ..options.clone()
        };
        let options_of_curves = ReversalCurveOptions {
            branches: DiagnosisOptions { smallest_reversal: 0.5 / f64::from(REVERSALS), ..branches },
            smoothing_factor,
            smoothing_growth: 0.0,
        };
        let curves = reversal_curves(&probe)?;
        let has_loops = curves.check_identifiable(crate::FEWEST_ROWS).is_ok();
        let table = CycleTable::of(&data, &options)?;
        let has_curves = table.field == Field::Magnet && begin(&probe).0 == 0.0;
        Ok(Self {
            probing: probe.description(),
            table,
            magnetisation: if has_curves { magnetisation::curves(&probe)? } else { Vec::new() },
            reversal_curves: if has_loops { ReversalCurves::of(&curves, &options_of_curves)? } else { None },
            data,
        })
    }
}

/// The first input and the output of a model by their names.
fn names(model: &Model, has_time: bool) -> ColumnNames {
    let names = model.names();
    ColumnNames {
        time: names.time.clone().filter(|_| has_time),
        inputs: names.inputs[..1].to_vec(),
        rate: None,
        output: names.output.clone(),
    }
}

fn cycles(probe: &Probe) -> Result<Dataset> {
    let growing = probe.path(&growing(probe)).x;
    let mut records: Vec<Record> = Vec::new();
    if probe.speeds.matter() {
        records.push(probe.run("slow", &growing, probe.speeds.vanishing)?);
        let whole = probe.path(&whole(probe)).x;
        for speed in probe.speeds.tried() {
            let name = format!("speed {:.3}", hysid_core::significant::Significant(speed));
            records.push(probe.run(&name, &whole, speed)?);
        }
    } else {
        records.push(probe.run_slowly("cycles", &growing)?);
    }
    Dataset::new(names(probe.model, probe.speeds.matter()), records)
}

/// Where cycles begin, -1, 0 or 1 for the ends and the middle of the range, and how far they go at most.
fn begin(probe: &Probe) -> (f64, f64) {
    let (low, high) = (probe.centre - probe.half, probe.centre + probe.half);
    if low < 0.0 && high > 0.0 && low.abs().min(high) >= BOTH_SIGNS * low.abs().max(high) {
        return (0.0, 1.0);
    }
    if high.abs() >= low.abs() { (-1.0, 2.0) } else { (1.0, -2.0) }
}

fn growing(probe: &Probe) -> Vec<f64> {
    let (begin, reach) = begin(probe);
    let mut turning = vec![begin];
    for step in 1..=AMPLITUDES {
        let away = begin + reach * step as f64 / AMPLITUDES as f64;
        let back = if begin == 0.0 { -away } else { begin };
        turning.extend([away, back].repeat(REPEATS));
    }
    turning.push(begin);
    turning
}

fn whole(probe: &Probe) -> Vec<f64> {
    let (begin, reach) = begin(probe);
    let (away, back) = (begin + reach, if begin == 0.0 { -1.0 } else { begin });
    let mut turning = vec![begin];
    turning.extend([away, back].repeat(AT_A_SPEED));
    turning.push(begin);
    turning
}

fn reversal_curves(probe: &Probe) -> Result<Dataset> {
    let mut turning = vec![-1.0, 1.0];
    for step in 1..=REVERSALS {
        turning.extend([1.0 - 2.0 * f64::from(step) / f64::from(REVERSALS), 1.0]);
    }
    let record = probe.run_slowly("reversal curves", &probe.path(&turning).x)?;
    Dataset::new(names(probe.model, false), vec![record])
}
