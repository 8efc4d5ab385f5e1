//! Artifacts of a measurement that look like a property of the specimen: an output that comes a little late, or that
//! drifts. A "no" that either of them explains is withheld, theory.md (10.25).

use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::unit;
use hysid_core::significant::Significant;

use super::branch::BranchSet;
use super::interpolation::at_row;
use super::{DiagnosisOptions, Finding, Property, Verdict, cycles};

/// Properties whose verdict an artifact can turn into "no".
const AFFECTED: [Property; 5] = [
    Property::WipingOut,
    Property::Congruency,
    Property::Masing,
    Property::OddSymmetry,
    Property::LoopClosure,
];

/// Rows by which the output is taken earlier or later.
const LAGS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0];

/// Drifts of the output over a record, as shares of its range.
const DRIFTS: [f64; 10] = [0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05, 0.06, 0.08];

/// Largest lag, as a share of the rows of a typical branch.
const LONGEST_LAG: f64 = 0.1;

/// Share of the comparisons that must remain without an artifact, and of the difference that may.
const AS_MANY: f64 = 0.75;
const MUCH_SMALLER: f64 = 0.5;

/// A difference is clear if that of noise is below this share of it.
const CLEAR: f64 = 0.1;

/// A probe that leaves less than this share of a difference is on the right way.
const SMALLER: f64 = 0.9;

/// Something in the measurement that is not the specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Artifact {
    /// Rows by which the output comes after the input; before it, if negative.
    Lag(f64),
    /// The output moves steadily by this share of its range over each record.
    Drift(f64),
}

/// An artifact, and the properties that the record would have without it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Explanation {
    pub artifact: Artifact,
    pub properties: Vec<Property>,
}

impl Artifact {
    /// Those that are tried: one list for each kind and direction, the smallest first.
    fn candidates(survey: &BranchSet) -> Vec<Vec<Self>> {
        let longest = LONGEST_LAG * survey.typical_rows() as f64;
        let lags: Vec<f64> = LAGS.into_iter().filter(|lag| *lag <= longest).collect();
        let both_ways = [1.0, -1.0].into_iter();
        let of_way = |way: f64| {
            let lags = lags.iter().map(|lag| Self::Lag(way * lag)).collect();
            [lags, DRIFTS.iter().map(|drift| Self::Drift(way * drift)).collect()]
        };
        both_ways.flat_map(of_way).collect()
    }

    /// Two of a list that show whether the others are worth a try.
    fn probes(list: &[Self]) -> Vec<Self> {
        [list.len() / 6, list.len() / 2].iter().filter_map(|&place| list.get(place)).copied().collect()
    }

    /// The data as they would be without it; `None` where a record cannot be corrected.
    fn removed_from(self, data: &Dataset, height: f64) -> Option<Dataset> {
        let corrected = |record: &Record| match self {
            Self::Lag(rows) => later_inputs(record, rows),
            Self::Drift(share) => {
                let count = record.len() as f64;
                let moved = |(row, y): (usize, &f64)| y - share * height * row as f64 / count;
                record.clone().with_output(record.output().iter().enumerate().map(moved).collect()).ok()
            }
        };
        let records: Option<Vec<Record>> = data.records().iter().map(corrected).collect();
        Dataset::new(data.names().clone(), records?).ok()
    }

    pub fn in_words(self, data: &Dataset) -> String {
        match self {
            Self::Lag(rows) => {
                let time = data.records()[0]
                    .time()
                    .and_then(|time| Some((time.last()? - time.first()?) / (time.len() - 1) as f64));
                let shown = match time {
                    Some(step) => {
                        let unit = data.names().time.as_deref().and_then(unit::of_column);
                        format!("{:.2}{}", Significant(step * rows.abs()), unit::suffix(unit.as_deref()))
                    }
                    None if rows.abs() == 1.0 => "1 row".into(),
                    None => format!("{} rows", rows.abs()),
                };
                format!("a delay of {shown} in the {}", if rows > 0.0 { "output" } else { "input" })
            }
            Self::Drift(share) => {
                format!("an output drift of {:.1} % of its range per record", 100.0 * share.abs())
            }
        }
    }
}

/// The record with its outputs as many rows earlier: the inputs are taken later, because they are the smoother ones.
fn later_inputs(record: &Record, rows: f64) -> Option<Record> {
    let count = record.len();
    let shifted =
        |column: &[f64]| -> Vec<f64> { (0..count).map(|row| at_row(column, row as f64 - rows)).collect() };
    // Rows whose input would lie before the beginning or after the end say nothing.
    let lost = rows.abs().ceil() as usize;
    let kept = |row: usize| if rows > 0.0 { row >= lost } else { row + lost < count };
    let output = record.output().iter().enumerate().map(|(row, y)| if kept(row) { *y } else { f64::NAN });
    let inputs = record.inputs().iter().map(|column| shifted(column)).collect();
    let moved = Record::new(record.name(), inputs, output.collect()).ok()?;
    match record.time() {
        Some(time) => moved.with_time(time.to_vec()).ok(),
        None => Some(moved),
    }
}

/// Withholds each "no" that an artifact explains, and says which. `test` gives the findings on the properties of a data
/// set.
pub(crate) fn withhold(
    survey: &BranchSet,
    options: &DiagnosisOptions,
    findings: &mut [Finding],
    test: impl Fn(&BranchSet, Property) -> Finding,
) -> Vec<Explanation> {
    let wears = findings.iter().any(|f| f.property == Property::Deterioration && f.verdict == Verdict::Yes);
    // Loops that lose energy do not close, with or without an artifact.
    let may_be_artifact =
        |property: Property| AFFECTED.contains(&property) && !(property == Property::LoopClosure && wears);
    // A difference without noise that is not testable may be so because of an artifact, too.
    let is_open = |finding: &&Finding| {
        let differs = match finding.verdict {
            Verdict::Yes => false,
            Verdict::No => true,
            Verdict::NotTestable => is_clear(finding),
        };
        differs && may_be_artifact(finding.property)
    };
    let mut open: Vec<Finding> = findings.iter().filter(is_open).cloned().collect();
    let mut explanations: Vec<Explanation> = Vec::new();
    let tested = |artifact: Artifact, open: &[Finding]| -> Option<Vec<(Finding, Finding)>> {
        let data = artifact.removed_from(survey.data, survey.height())?;
        let corrected = cycles::survey(&data, options);
        Some(open.iter().map(|finding| (finding.clone(), test(&corrected, finding.property))).collect())
    };
    for list in Artifact::candidates(survey) {
        let improves = |probe: Artifact| {
            tested(probe, &open)
                .is_some_and(|pairs| pairs.iter().any(|(with, without)| is_smaller(with, without)))
        };
        if open.is_empty() || !Artifact::probes(&list).into_iter().any(improves) {
            continue;
        }
        for artifact in list {
            let pairs = tested(artifact, &open).unwrap_or_default();
            let explains = pairs.iter().filter(|(with, without)| explained(artifact, with, without));
            let properties: Vec<Property> = explains.map(|(with, _)| with.property).collect();
            open.retain(|finding| !properties.contains(&finding.property));
            if !properties.is_empty() {
                explanations.push(Explanation { artifact, properties });
            }
        }
    }
    for explanation in &explanations {
        let words = explanation.artifact.in_words(survey.data);
        for finding in
            findings.iter_mut().filter(|finding| explanation.properties.contains(&finding.property))
        {
            finding.verdict = Verdict::NotTestable;
            finding.statement = format!("{}; {words} would explain this", finding.statement);
            finding.experiment = Some(
                "correct the data, or show that the artifact is absent, and run the diagnosis again".into(),
            );
        }
    }
    explanations
}

/// Withholds a "no" about loops of which a part is unknown because the output is clipped.
pub(crate) fn withhold_partial(findings: &mut [Finding]) {
    withhold_all(
        findings,
        (Verdict::No, &[Property::StaticHysteresis, Property::Congruency, Property::Masing]),
        "clipped outputs omitted, so the loops are incomplete",
        "measure with a larger range of the output channel",
    );
}

/// Withholds what the mass and the damping of a resonance make as well: open loops, and loops that shrink.
pub(crate) fn withhold_what_inertia_makes(findings: &mut [Finding]) {
    withhold_all(
        findings,
        (Verdict::Yes, &[Property::StaticHysteresis, Property::Deterioration, Property::StrengthLoss]),
        "the data look like a resonance, whose mass and damping do this too",
        "measure far below the resonance, or compare fits of models with inertia",
    );
}

fn withhold_all(
    findings: &mut [Finding],
    (verdict, properties): (Verdict, &[Property]),
    why: &str,
    experiment: &str,
) {
    let is_withheld =
        |finding: &&mut Finding| finding.verdict == verdict && properties.contains(&finding.property);
    for finding in findings.iter_mut().filter(is_withheld) {
        finding.verdict = Verdict::NotTestable;
        finding.statement = format!("{} ({why})", finding.statement);
        finding.experiment = Some(experiment.into());
    }
}

/// True if the noise in a difference is negligible.
fn is_clear(finding: &Finding) -> bool {
    finding.index.zip(finding.noise).is_some_and(|(index, noise)| noise < CLEAR * index)
}

/// The difference that contradicts a property without an artifact, as a share of that with it; `None` where far fewer
/// comparisons are left.
fn share_left(with: &Finding, without: &Finding) -> Option<f64> {
    let as_many = without.comparisons as f64 >= AS_MANY * with.comparisons as f64;
    as_many.then(|| Some(without.index? / with.index?)).flatten()
}

fn is_smaller(with: &Finding, without: &Finding) -> bool {
    share_left(with, without).is_some_and(|share| share < SMALLER)
}

/// True if the property holds after the artifact is removed. For a lag, it is enough that the property may hold, because a
/// lag cannot be removed exactly between rows.
fn explained(artifact: Artifact, with: &Finding, without: &Finding) -> bool {
    let holds = match without.verdict {
        Verdict::Yes => true,
        Verdict::No => false,
        Verdict::NotTestable => {
            with.verdict == Verdict::No && is_clear(with) && matches!(artifact, Artifact::Lag(_))
        }
    };
    holds && share_left(with, without).is_some_and(|share| share < MUCH_SMALLER)
}
