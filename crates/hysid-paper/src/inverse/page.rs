//! The chapter on compensation: tables, pictures, targets.

use hysid::data::unit;
use hysid_document::unit::label;
use hysid_document::{Cell, Chart, Colour, Curve, Part, Table, count, number};

use super::specimens::ROWS;
use super::{Compensated, Course, FOLDS, SHARE, Way};
use crate::chapter::{Chapter, Source, Target, Verdict};

/// How many times smaller the deviation is to be than without compensation.
const LEAST_GAIN: f64 = 5.0;

pub(super) fn chapter(all: &[Compensated]) -> Chapter {
    let mut parts = vec![
        Part::Table(table(all)),
        Part::note(format!(
            "RMS deviation of the specimen's output from the wanted one, in percent of the range of the output in \
             training, over the second of two periods. Wanted outputs cover {} % of that range. Line: the input of the \
             least-squares line through the training data. Classical: the inverse of the classical model with the \
             lowest error of a {FOLDS}-fold cross-validation of the training data. Inverse: that of the default model, \
             auto. Direct: a default model of exchanged data (fit --inverse). All inputs stay within the trained range. \
             In brackets: how many times smaller than with the line.",
            number(100.0 * SHARE, 3)
        )),
        Part::Table(models(all)),
        Part::note(
            "Model deviates: RMS deviation of the output of the driven model from the wanted one, in percent of the range; \
             the rest of the specimen's deviation is the error of the model. The preview is how far the search looks ahead; \
             it is chosen by the library for each wanted output.",
        ),
        Part::heading("Which way tracks better"),
        Part::paragraph(comparison(all)),
        Part::paragraph(LIMITS),
        Part::heading("The specimens under three sines"),
    ];
    parts.extend(all.iter().map(|compensated| Part::chart(picture(compensated))));
    parts.push(Part::heading("How the specimens are driven"));
    parts.push(Part::paragraph(DRIVEN));
    Chapter {
        name: "inverse".into(),
        title: "compensation of actuators by their inverses".into(),
        verdict: verdict(all),
        parts,
        targets: all.iter().flat_map(targets).collect(),
        files: Vec::new(),
    }
}

const HEADING: &str = "Synthetic specimens in place of measured actuators";

/// What limits the compensation.
const LIMITS: &str = "The records of the piezo and of the magnetostrictive actuator are single sines of one amplitude. They \
                      contain no smaller loop, so they do not determine what a model does between its loops, and models \
                      with equal errors on unseen frequencies differ there. A record of sums of sines, or of shrinking \
                      loops, does determine it.";

/// What the specimens do between and beside their laws.
const DRIVEN: &str = "The input is a straight line between rows. The response of the piezo actuator is known for one sine; \
                      here the responses to the sines of the voltage are added (designed). The other laws hold for any \
                      input. All memories begin as in training, and the first period is not scored.";

fn percent(compensated: &Compensated, rms: f64) -> f64 {
    100.0 * rms / compensated.range
}

fn table(all: &[Compensated]) -> Table {
    let mut table = Table::new(["specimen", "wanted output", "line", "classical", "inverse", "direct"])
        .headed(format!("{HEADING}: deviation from the wanted output, RMS in % of the range"));
    for compensated in all {
        for course in &compensated.courses {
            let cell = |way: Way| -> Cell {
                let shown = number(percent(compensated, course.of(way).rms), 3);
                match way {
                    Way::Line => shown.into(),
                    way => format!("{shown} ({})", number(course.gain(way), 2)).into(),
                }
            };
            let names = [compensated.actuator.name.into(), course.shape.into()];
            table.push(names.into_iter().chain(Way::ALL.map(cell)));
        }
    }
    table
}

fn models(all: &[Compensated]) -> Table {
    let columns = [
        "specimen",
        "wanted output",
        "inverted model",
        "model deviates, %",
        "rows reached, %",
        "preview, ms",
    ];
    let mut table = Table::new(columns).headed(format!("{HEADING}: the models that were inverted"));
    for compensated in all {
        let (name, error) = &compensated.classical;
        for course in &compensated.courses {
            for way in [Way::Classical, Way::Inverse] {
                let tracking = course.of(way);
                let Some((deviation, reached)) = tracking.of_model else { continue };
                let model = match way {
                    Way::Classical => format!("{name}, {} % of std on the folds", number(*error, 3)),
                    _ => "auto".into(),
                };
                table.push([
                    compensated.actuator.name.into(),
                    course.shape.into(),
                    model.into(),
                    Cell::number(percent(compensated, deviation), 3),
                    Cell::number(100.0 * reached, 4),
                    Cell::number(1e3 * tracking.preview, 3),
                ]);
            }
        }
    }
    table
}

/// Smallest and largest of a figure over the wanted outputs.
fn span(courses: &[Course], figure: impl Fn(&Course) -> f64) -> (f64, f64) {
    let figures = courses.iter().map(figure);
    figures.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

fn targets(compensated: &Compensated) -> Vec<Target> {
    let courses = &compensated.courses;
    let (least, most) = span(courses, |course| course.gain(Way::Inverse));
    let (best, worst) = span(courses, |course| course.of(Way::Inverse).rms / course.of(Way::Classical).rms);
    let target = |figure: &str, wanted: &str, is_met: bool, (low, high): (f64, f64)| Target {
        specimen: compensated.actuator.name.into(),
        figure: figure.into(),
        source: Source::Ours,
        wanted: wanted.into(),
        one: format!("{} to {}", number(low, 3), number(high, 3)),
        several: None,
        verdict: if is_met { Verdict::Met } else { Verdict::Missed },
    };
    vec![
        target(
            "deviation without compensation over that with the inverse, three wanted outputs",
            "at least 5",
            least >= LEAST_GAIN,
            (least, most),
        ),
        target(
            "deviation with the inverse over that with the best classical inverse",
            "at most 1",
            worst <= 1.0,
            (best, worst),
        ),
    ]
}

fn verdict(all: &[Compensated]) -> String {
    let is_far_better = |compensated: &&Compensated| {
        span(&compensated.courses, |course| course.gain(Way::Inverse)).0 >= LEAST_GAIN
    };
    let better = all.iter().filter(is_far_better).count();
    format!(
        "The inverse of the default model lowers the deviation from every wanted output at least five times on {better} of {}.",
        count(all.len(), "specimen")
    )
}

/// Which of the two ways of the default model tracks better, in words.
fn comparison(all: &[Compensated]) -> String {
    let courses = || all.iter().flat_map(|compensated| &compensated.courses);
    let better = courses().filter(|course| course.of(Way::Inverse).rms < course.of(Way::Direct).rms).count();
    let total = courses().count();
    format!(
        "The inverse of a model tracks better than a model of the inverse in {better} of {total} cases. A model of the \
         inverse runs at the cost of a simulation and needs no search, and lag becomes lead in it; but its input is the \
         measured output with its noise, it has no limits of the input, and it does not say where the wanted output \
         cannot be reached."
    )
}

/// Wanted output and those of the specimen without and with compensation.
fn picture(compensated: &Compensated) -> Chart {
    let names = compensated.actuator.specimen().columns();
    let course = &compensated.courses[0];
    let step = compensated.actuator.period / ROWS as f64;
    let curve = |values: &[f64], colour: Colour, width: f64| {
        let points = values.iter().enumerate().map(|(row, &value)| (step * row as f64, value));
        Curve::new(points.collect(), colour, width)
    };
    let curves = vec![
        curve(&course.wanted, Colour::Measured, 2.6),
        curve(&course.of(Way::Line).output, Colour::Error, 1.1),
        curve(&course.of(Way::Inverse).output, Colour::Simulated, 1.1),
    ];
    let output = label(&names.output);
    let description = format!(
        "{}: wanted output, and that of the specimen without and with compensation",
        compensated.actuator.name
    );
    let time = names.time.as_deref().map_or_else(|| "time".into(), label);
    let mut chart = Chart::new(description, &time, &output, curves).with_legend([
        (Colour::Measured, "wanted"),
        (Colour::Error, "straight line"),
        (Colour::Simulated, "inverse of auto"),
    ]);
    chart.title = format!("{} ({})", compensated.actuator.name, unit::split(&names.output).0);
    chart
}
