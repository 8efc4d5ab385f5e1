//! Text on a restoring force: how the data were read, how large and how uncertain the force is.

use std::path::{Path, PathBuf};

use hysid::data::unit;
use hysid::error::MotionColumn;
use hysid::restoring_force::{Filter, RestoringForce};
use hysid_core::significant::Significant;
use hysid_core::words::{Hint, Words};
use hysid_document::shell::shown;
use hysid_document::visible::{clipped, listed};
use hysid_document::{Face, count};
use hysid_tables::Table;
use serde::Serialize;

use super::MeasuredMotion;
use super::mass::Mass;

/// Noise or a smoothing error above this share of the standard deviation of the force is warned of, in percent.
const LARGE: f64 = 10.0;

/// Reading of the data, label and text.
pub fn understood(
    table: &Table,
    motion: &MeasuredMotion,
    mass: &Mass,
    found: &RestoringForce,
    face: Face,
) -> Vec<(String, String)> {
    let names = &motion.names;
    let name = |name: &String| clipped(name).into_owned();
    let rows: usize = motion.records.iter().map(|record| record.rows.len()).sum();
    let records = count(motion.records.len(), "record");
    let mut lines = vec![
        ("file", clipped(&table.file).into_owned()),
        ("read as", table.described()),
        ("samples", format!("{rows} in {records}")),
        ("time", name(&names.time)),
        ("y", format!("{}: displacement relative to the base", name(&names.displacement))),
        ("y'", velocity(motion, found)),
        acceleration(motion, found),
    ];
    if let Some(base) = &names.base_acceleration {
        lines.push(("a", format!("{}: acceleration of the base", name(base))));
    }
    let force =
        names.applied_force.as_ref().map_or("none".into(), |force| format!("{}: applied force", name(force)));
    lines.push(("u", force));
    lines.push(("m", shown_mass(mass, motion)));
    let is_base_moving = names.is_absolute || names.base_acceleration.is_some();
    let inertia = if is_base_moving { "(y'' + a)" } else { "y''" };
    lines.push(("r", format!("u - m {inertia}: of a spring, positive where y is positive")));
    lines.push(units(motion, face));
    if !names.guessed.is_empty() {
        let told = names.guessed.iter().map(|words| face.told(words));
        lines.push(("guessed", told.collect::<Vec<String>>().join("; ")));
    }
    if !names.unused_accelerations.is_empty() {
        let words = format!("{}: name it with ", listed(&names.unused_accelerations));
        let words = Words::from(words) + Hint::Option("acceleration") + " (relative to the base) or ";
        let words = words + Hint::Option("absolute_acceleration") + " (as accelerometers measure it)";
        lines.push(("unused", face.told(&words)));
    }
    lines.into_iter().map(|(label, text)| (label.to_string(), text)).collect()
}

fn velocity(motion: &MeasuredMotion, found: &RestoringForce) -> String {
    match &motion.names.velocity {
        Some(velocity) => format!("{}: velocity relative to the base", clipped(velocity)),
        None => by("the derivative", &motion.names.displacement, found.velocity_filter, motion),
    }
}

fn acceleration(motion: &MeasuredMotion, found: &RestoringForce) -> (&'static str, String) {
    let (names, filter) = (&motion.names, found.acceleration_filter);
    match (&names.acceleration, &names.velocity) {
        (Some(measured), _) if names.is_absolute => {
            ("y''+a", format!("{}: absolute acceleration", clipped(measured)))
        }
        (Some(measured), _) => ("y''", format!("{}: acceleration relative to the base", clipped(measured))),
        (None, Some(velocity)) => ("y''", by("the derivative", velocity, filter, motion)),
        (None, None) => ("y''", by("the second derivative", &names.displacement, filter, motion)),
    }
}

fn by(derivative: &str, column: &str, filter: Option<Filter>, motion: &MeasuredMotion) -> String {
    let what = format!("{derivative} of {}", clipped(column));
    let Some(filter) = filter else { return what };
    let steps = |record: &super::MotionRecord| {
        let time = record.column(MotionColumn::Time)?;
        Some((time.last()? - time.first()?, time.len().saturating_sub(1)))
    };
    let (duration, count) =
        motion.records.iter().filter_map(steps).fold((0.0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    let length = 2.0 * filter.on_a_side as f64 * duration / count.max(1) as f64;
    let unit = unit::suffix(unit::of_column(&motion.names.time).as_deref());
    format!(
        "{what}: Savitzky-Golay, degree {}, window of {} rows ({:.3}{})",
        filter.degree,
        filter.window(),
        Significant(length),
        clipped(&unit)
    )
}

fn shown_mass(mass: &Mass, motion: &MeasuredMotion) -> String {
    let number = format!("{:.6}", Significant(mass.number));
    let unit = mass.unit.as_deref();
    let is_known = !motion.units.is_same && !motion.units.known().is_empty();
    unit.or(is_known.then_some("kg")).map_or(number.clone(), |unit| format!("{number} {}", clipped(unit)))
}

/// Conversions of units, and assumptions on them.
fn units(motion: &MeasuredMotion, face: Face) -> (&'static str, String) {
    let units = &motion.units;
    let known = units.known();
    let text = if units.is_same {
        face.told(&Words::from("not converted").advised(Hint::Option("same_units")))
    } else if known.is_empty() {
        "none known, nothing is converted: mass times acceleration must be a force".into()
    } else if units.without.is_empty() {
        format!("{}: converted; the force is in {}", listed(&known), force_unit(motion))
    } else {
        let taken =
            units.without.iter().map(|(name, unit)| format!("{} is taken to be in {unit}", clipped(name)));
        format!("{}: converted to SI; {}", listed(&known), taken.collect::<Vec<_>>().join(", "))
    };
    ("units", text)
}

fn force_unit(motion: &MeasuredMotion) -> String {
    motion
        .units
        .force_unit
        .as_deref()
        .map_or_else(|| "an unknown unit".into(), |unit| clipped(unit).into_owned())
}

/// Warnings on the force.
pub fn warnings(
    motion: &MeasuredMotion,
    found: &RestoringForce,
    window: Option<usize>,
    face: Face,
) -> Vec<String> {
    let suffix = unit::suffix(motion.units.force_unit.as_deref());
    // A chosen window has the least of both errors.
    let (measure, of_noise, of_smoothing) = match (found.acceleration_filter, window) {
        (None, _) => ("", "use sensors with less noise".into(), String::new()),
        (Some(_), None) => {
            ("measure the acceleration, or ", "sample more often".into(), "sample more often".into())
        }
        (Some(_), Some(_)) => {
            let window = face.hint(&Hint::Option("window"));
            (
                "measure the acceleration, or ",
                format!("use a longer {window}"),
                format!("use a shorter {window}"),
            )
        }
    };
    let mut all: Vec<String> = motion.warnings.clone();
    if let Some(percent) = found.noise_percent().filter(|percent| *percent > LARGE) {
        all.push(format!(
            "the noise of the restoring force is about {:.3}{}, {percent:.0} % of its standard deviation: \
             {measure}{of_noise}",
            Significant(found.noise),
            clipped(&suffix)
        ));
    }
    if let Some(percent) = found.smoothing_percent().filter(|percent| *percent > LARGE) {
        all.push(format!(
            "the smoothing error of the restoring force is about {:.3}{}, {percent:.0} % of its standard deviation: \
             {measure}{of_smoothing}",
            Significant(found.smoothing),
            clipped(&suffix)
        ));
    }
    all
}

/// The result as text.
pub fn summary(motion: &MeasuredMotion, found: &RestoringForce, table: Option<&Path>) -> String {
    let suffix = unit::suffix(motion.units.force_unit.as_deref());
    let suffix = clipped(&suffix);
    let printed = PrintedForce::of(motion, found, None);
    let (low, high) = printed.force_range;
    let percent = |percent: Option<f64>| {
        percent.map_or_else(String::new, |percent| {
            format!(", {:.2} % of the standard deviation", Significant(percent))
        })
    };
    let mut lines = vec![
        ("restoring force", format!("{:.4} to {:.4}{suffix}", Significant(low), Significant(high))),
        ("standard deviation", format!("{:.4}{suffix}", Significant(found.deviation))),
        ("rows with a force", format!("{} of {}", printed.rows_with_force, printed.rows)),
        ("noise", format!("{:.2}{suffix}{}", Significant(found.noise), percent(found.noise_percent()))),
    ];
    if found.acceleration_filter.is_some() {
        let text =
            format!("{:.2}{suffix}{}", Significant(found.smoothing), percent(found.smoothing_percent()));
        lines.push(("smoothing error", text));
    }
    if let Some(table) = table {
        lines.push(("next", format!("hysid fit {}", shown(table))));
    }
    lines.iter().map(|(label, text)| format!("{label:<20}{text}\n")).collect()
}

/// The object that `--json` prints.
#[derive(Serialize)]
pub struct PrintedForce<'a> {
    table: Option<PathBuf>,
    rows: usize,
    records: usize,
    rows_with_force: usize,
    /// Lowest and highest restoring force.
    force_range: (f64, f64),
    force_unit: Option<&'a str>,
    standard_deviation: f64,
    /// Standard deviation of the noise of the force, in its unit and in percent of the standard deviation.
    noise: f64,
    noise_percent: Option<f64>,
    /// Smoothing error of the filter of the acceleration, likewise.
    smoothing: f64,
    smoothing_percent: Option<f64>,
    /// The filter of the acceleration; none if it is measured.
    acceleration_filter: Option<PrintedFilter>,
    velocity_filter: Option<PrintedFilter>,
}

#[derive(Serialize)]
struct PrintedFilter {
    degree: usize,
    window: usize,
}

impl<'a> PrintedForce<'a> {
    pub fn of(motion: &'a MeasuredMotion, found: &RestoringForce, table: Option<&Path>) -> Self {
        let forces = || found.records.iter().flat_map(|record| &record.force).filter(|force| !force.is_nan());
        let filter = |filter: Filter| PrintedFilter { degree: filter.degree, window: filter.window() };
        Self {
            table: table.map(Path::to_path_buf),
            rows: found.records.iter().map(|record| record.force.len()).sum(),
            records: found.records.len(),
            rows_with_force: forces().count(),
            force_range: forces()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &r| (low.min(r), high.max(r))),
            force_unit: motion.units.force_unit.as_deref(),
            standard_deviation: found.deviation,
            noise: found.noise,
            noise_percent: found.noise_percent(),
            smoothing: found.smoothing,
            smoothing_percent: found.smoothing_percent(),
            acceleration_filter: found.acceleration_filter.map(filter),
            velocity_filter: found.velocity_filter.map(filter),
        }
    }
}
