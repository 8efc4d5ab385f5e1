//! Kinds of hysteresis: properties of a measured record or of a fitted model, each with its
//! evidence.
//!
//! The input is cut into branches between turning points; a property is a statement about branches that
//! must coincide. Each test compares such branches, and says *yes*, *no*, or that the record does not
//! contain what is needed. Definitions: theory.md section 10.
//!
//! ```
//! use hysid_diagnosis::{Diagnosis, DiagnosisOptions, Property, Verdict};
//! use hysid_specimens::Specimen;
//! let joint = Specimen::named("reinforced-concrete-joint").unwrap().train();
//! let diagnosis = Diagnosis::of(&joint, &DiagnosisOptions::default())?;
//! assert_eq!(diagnosis.verdict(Property::Deterioration), Verdict::Yes);
//! # Ok::<(), hysid_core::Error>(())
//! ```

mod advice;
mod artifact;
mod branch;
mod comparison;
mod congruency;
pub mod cycles;
mod deterioration;
pub mod distribution;
mod doctor;
pub mod frequency_response;
mod interpolation;
mod loop_closure;
mod masing;
mod minimum;
pub mod model;
mod noise;
mod odd_symmetry;
mod orientation;
mod pinching;
mod rate_dependence;
pub mod residuals;
pub mod resonance;
pub mod reversal_curves;
mod saturation;
pub mod serial;
pub mod significance;
mod smoothing;
mod static_hysteresis;
mod strength_loss;
mod wiping_out;

use std::fmt;

use serde::Serialize;

pub use advice::Advice;
pub(crate) use cycles::Cycle;
use cycles::Field;
pub use cycles::{BackbonePoint, CycleOptions, CycleTable};
pub use doctor::{DataIssue, DataIssueKind, Severity, before_a_fit};
use hysid_core::data::record::{Dataset, Record};
use hysid_core::error::Result;
pub use hysid_core::property::Property;
pub use model::ModelDiagnosis;
pub use noise::resolution;
pub use rate_dependence::delay::{self, Delay};
use resonance::Resonance;
pub use reversal_curves::{ReversalCurveOptions, ReversalCurves};

/// Fewest scored rows that say anything about hysteresis.
const FEWEST_ROWS: usize = 8;

/// How data are diagnosed.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosisOptions {
    /// Reversals of the input below this share of its range are no turning points.
    pub smallest_reversal: f64,
    /// Whether noise is smoothed out of branches before they are compared.
    pub smoothing: bool,
}

impl Default for DiagnosisOptions {
    fn default() -> Self {
        Self { smallest_reversal: 0.02, smoothing: true }
    }
}

impl DiagnosisOptions {
    /// How the cycles of the same data are found: by the noise, unless a smallest reversal is given.
    fn of_cycles(&self) -> CycleOptions {
        let asked = self.smallest_reversal != Self::default().smallest_reversal;
        CycleOptions {
            smallest_reversal: asked.then_some(self.smallest_reversal),
            smoothing: self.smoothing,
            ..CycleOptions::default()
        }
    }
}

/// Verdict on a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub enum Verdict {
    /// It has the property.
    #[serde(rename = "yes")]
    Yes,
    /// It does not.
    #[serde(rename = "no")]
    No,
    /// The data do not decide.
    #[serde(rename = "not testable")]
    NotTestable,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::NotTestable => "not testable",
        })
    }
}

/// A property and what the data say about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Property that the finding is about.
    #[serde(rename = "name")]
    pub property: Property,
    /// Verdict on the property.
    pub verdict: Verdict,
    /// The measure that decides, a share without unit.
    pub index: Option<f64>,
    /// The index where it decides otherwise.
    pub threshold: Option<f64>,
    /// The index that noise alone would give.
    pub noise: Option<f64>,
    /// How many comparisons it is the largest of.
    pub comparisons: usize,
    /// Result in words.
    pub statement: String,
    /// Experiment that would decide, where the data do not.
    pub experiment: Option<String>,
    /// The rows that show it, the strongest first.
    pub evidence: Vec<Evidence>,
    /// A drawing of the strongest evidence.
    #[serde(skip)]
    pub picture: Option<Picture>,
}

impl Finding {
    /// The data do not decide.
    fn not_testable(property: Property, statement: impl Into<String>, experiment: impl Into<String>) -> Self {
        Self {
            property,
            verdict: Verdict::NotTestable,
            index: None,
            threshold: None,
            noise: None,
            comparisons: 0,
            statement: statement.into(),
            experiment: Some(experiment.into()),
            evidence: Vec::new(),
            picture: None,
        }
    }
}

/// Pieces of data that were compared, and their difference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evidence {
    /// Their difference, in the unit of the index.
    pub index: f64,
    /// Rows that were compared, piece by piece.
    pub pieces: Vec<Piece>,
}

/// Rows of a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Piece {
    /// Name of the record.
    pub record: String,
    /// First and last row, counted from 0 at the beginning of the record.
    pub rows: (usize, usize),
}

impl Piece {
    fn of(record: &Record, rows: (usize, usize)) -> Self {
        Self { record: record.name().into(), rows }
    }
}

/// Curves that show a verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Label of the horizontal axis; empty for the input.
    pub x_label: String,
    /// Label of the vertical axis; empty for the output.
    pub y_label: String,
    /// The curves.
    pub curves: Vec<PictureCurve>,
}

/// A curve of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureCurve {
    /// Label of the curve; empty if it is there for comparison only.
    pub label: String,
    /// Points `(x, y)` in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

/// Everything that the data say about their hysteresis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// The properties, in the order of [`Property::ALL`]; of members [`Property::StrengthLoss`] and
    /// [`Property::Pinching`] follow.
    pub properties: Vec<Finding>,
    /// Standard deviation of the noise of the output, in its unit.
    pub output_noise: f64,
    /// Standard deviation of the noise of the first input, in its unit.
    pub input_noise: f64,
    /// The delay of the output that makes several speeds agree, if one does.
    pub delay: Option<Delay>,
    /// Turning points of the first input.
    pub turning_points: usize,
    /// The rows where they are, record by record, counted from 0 at the beginning of each.
    #[serde(skip)]
    pub turning_rows: Vec<Vec<usize>>,
    /// Smallest reversal of the first input that counts, in its unit.
    #[serde(skip)]
    pub smallest_reversal: f64,
    /// The backbone of each record.
    #[serde(skip)]
    pub backbone: Vec<BackbonePoint>,
    /// The cycles of the first input: the table of `hysid cycles`.
    #[serde(flatten)]
    pub cycles: CycleTable,
    /// Problems of the data that would mislead a fit, warnings first.
    pub doctor: Vec<DataIssue>,
    /// The simplest model that can hold what was found.
    pub advice: Advice,
}

const ONLY_DEFECTS: &str =
    "beside what looks like a defect of the record, the input or the output does not change";

const TOO_LARGE: &str = "the numbers are too large or too small to compute with";

const OTHER_UNITS: &str = "give the columns in other units";

const RECORD_ANEW: &str = "record an output that follows an input over its whole range";

impl Diagnosis {
    /// Diagnoses measured data.
    ///
    /// # Errors
    /// Data that nothing can be said about: a constant input or output, hardly any rows.
    pub fn of(data: &Dataset, options: &DiagnosisOptions) -> Result<Self> {
        data.check_identifiable(FEWEST_ROWS)?;
        let measured = cycles::survey(data, options);
        // What a clipped channel or a spike shows is not the output of the specimen.
        let clipped = doctor::clipped_outputs(&measured);
        let sound = doctor::without_defects(&measured, &clipped);
        let survey = sound.as_ref().map(|data| cycles::survey(data, options));
        let survey = survey.as_ref().unwrap_or(&measured);
        let cycles = cycles::cycles(survey);
        let (rate, delay) = rate_dependence::verdict(survey);
        // Branches of different speed say nothing about memory where the speed matters, or may matter.
        let equal_speed = data.has_time() && rate.verdict != Verdict::No;
        let wear = deterioration::verdict(survey, &cycles::cycles_up_to_growth(survey));
        // Memory that fades keeps loops open at first, but loses no energy.
        let may_fade = equal_speed && wear.verdict != Verdict::Yes;
        let at_rest =
            static_hysteresis::test_of_measured(survey, rate.verdict, || doctor::longest_lag(survey));
        let has_loops = at_rest.verdict != Verdict::No;
        let mut properties = vec![
            at_rest,
            orientation::verdict(survey),
            rate,
            wiping_out::verdict(survey, equal_speed),
            congruency::verdict(survey, equal_speed, has_loops),
            masing::verdict(survey, equal_speed),
            odd_symmetry::verdict(survey, equal_speed),
            saturation::verdict(survey),
            wear,
            loop_closure::test(survey, &cycles, may_fade),
        ];
        if !clipped.is_empty() {
            artifact::withhold_partial(&mut properties);
        }
        let resonance = Resonance::of(data).filter(Resonance::is_found);
        let explanations =
            artifact::withhold(survey, options, &mut properties, |corrected, property| match property {
                Property::WipingOut => wiping_out::verdict(corrected, equal_speed),
                Property::Congruency => congruency::verdict(corrected, equal_speed, has_loops),
                Property::Masing => masing::verdict(corrected, equal_speed),
                Property::OddSymmetry => odd_symmetry::verdict(corrected, equal_speed),
                _ => loop_closure::test(corrected, &cycles::cycles(corrected), may_fade),
            });
        let table = CycleTable::of(data, &options.of_cycles())?;
        let is_member = match table.field {
            Field::Structure => true,
            field => field.has_structures() && properties[1].verdict == Verdict::Yes,
        };
        if is_member {
            let rate = properties[2].verdict;
            properties.push(strength_loss::verdict(survey, &table.cycles, rate));
            properties.push(pinching::verdict(survey, &table.cycles));
        }
        if resonance.is_some() {
            artifact::withhold_what_inertia_makes(&mut properties);
        }
        // Shares of no height or width are no numbers, nor are those of areas beyond all numbers.
        let has_size = survey.height() > 0.0 && survey.width() > 0.0;
        for finding in &mut properties {
            if !has_size {
                *finding = Finding::not_testable(finding.property, ONLY_DEFECTS, RECORD_ANEW);
            } else if finding.index.is_some_and(|index| !index.is_finite()) {
                *finding = Finding::not_testable(finding.property, TOO_LARGE, OTHER_UNITS);
            }
            finding.noise = finding.noise.filter(|noise| noise.is_finite());
        }
        let turning_rows = survey.turning_rows();
        Ok(Self {
            doctor: doctor::examine(
                &measured,
                (&cycles, &table),
                &properties,
                delay.as_ref(),
                resonance.as_ref(),
                &explanations,
            ),
            advice: advice::advise(&properties, delay.as_ref(), resonance.is_some()),
            properties,
            delay,
            output_noise: survey.output_noise.deviation(),
            input_noise: survey.input_noise.deviation(),
            turning_points: turning_rows.iter().map(Vec::len).sum(),
            backbone: cycles::backbones(survey),
            turning_rows,
            smallest_reversal: survey.smallest_reversal,
            cycles: table,
        })
    }

    /// The finding on a property.
    pub fn finding(&self, property: Property) -> &Finding {
        self.properties
            .iter()
            .find(|finding| finding.property == property)
            .expect("a diagnosis has every property")
    }

    /// The verdict on a property.
    pub fn verdict(&self, property: Property) -> Verdict {
        self.finding(property).verdict
    }
}
