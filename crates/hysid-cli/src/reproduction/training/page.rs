//! What the comparison of trainers comes to: tables, figures, and the sentence on the paper's claim.

use hysid::training::Trainer;
use hysid::warning::Significant;

use super::{EPOCHS, Moment, Protocol, Repetition, TRAINERS, Training};
use crate::lines::{WIDTH, aligned, wrapped};
use crate::page::{count, figure, note, paragraph, section, table, verdict, whole};
use crate::plot::{self, Axis, Chart, Colour, Curve};

/// Heading of every table: what the figures are of.
fn heading(protocol: &Protocol) -> String {
    format!(
        "Synthetic specimen {} in the place of the paper's measured joint (its example 2); XPNN with 10 stops and 10 tanh neurons; {} epochs",
        protocol.specimen.name, protocol.epochs
    )
}

/// The files, by name.
pub fn files(protocol: &Protocol, repetitions: &[Repetition]) -> Vec<(&'static str, String)> {
    let (epochs, seconds) = (chart(repetitions, Abscissa::Epochs), chart(repetitions, Abscissa::Seconds));
    vec![
        ("training.html", html(protocol, repetitions, &[&epochs, &seconds])),
        ("training.md", markdown(protocol, repetitions)),
        ("training.csv", csv(repetitions)),
        ("training-history.csv", history(repetitions)),
        ("training-epochs.svg", plot::standalone(&epochs)),
        ("training-seconds.svg", plot::standalone(&seconds)),
    ]
}

/// The result as plain text.
pub fn text(protocol: &Protocol, repetitions: &[Repetition]) -> String {
    let (headings, rows) = summary(repetitions);
    // A terminal has 80 columns: ranges are given of the MSE only, the files have all.
    let narrow = |row: Vec<String>| {
        let short = |(column, cell): (usize, String)| match column {
            0 | 1 => cell,
            _ => cell.split(" (").next().unwrap_or_default().to_string(),
        };
        row.into_iter().enumerate().map(short).collect::<Vec<String>>()
    };
    let mut lines = vec![headings.into_iter().map(|cell| cell.replace("training, ", "")).collect()];
    lines.extend(rows.into_iter().map(narrow));
    let words = "Medians of the seeds, in brackets the range.";
    let paragraph = |text: &str| wrapped(text, WIDTH).join("\n") + "\n";
    let paragraphs = [words, &claim(repetitions), &matched(repetitions)].map(paragraph);
    let heading = paragraph(&(heading(protocol) + "."));
    let table = aligned(&lines).join("\n") + "\n";
    [heading, table].into_iter().chain(paragraphs).collect::<Vec<String>>().join("\n")
}

fn of(repetitions: &[Repetition], trainer: Trainer) -> Vec<&Training> {
    let all = repetitions.iter().flat_map(|repetition| &repetition.trainings);
    all.filter(|training| training.trainer == trainer).collect()
}

/// Headings and a row for each trainer.
fn summary(repetitions: &[Repetition]) -> (Vec<String>, Vec<Vec<String>>) {
    let unit = repetitions[0].trainings[0].train.output.rsplit_once('_').map_or("", |(_, unit)| unit);
    let headings = ["trainer".into(), format!("training MSE, {unit}²"), "training, % of std".into()];
    let headings = headings.into_iter().chain(["unseen, %", "seconds", "evaluations"].map(String::from));
    let rows = TRAINERS.map(|trainer| {
        let trainings = of(repetitions, trainer);
        let spread = |value: &dyn Fn(&Training) -> f64| {
            let values: Vec<f64> = trainings.iter().map(|training| value(training)).collect();
            let (low, median, high) = range(&values);
            let shown = |value| format!("{:.3}", Significant(value));
            format!("{} ({} to {})", shown(median), shown(low), shown(high))
        };
        vec![
            trainer.name().to_string(),
            spread(&|training| training.train.mse),
            spread(&|training| training.train.nrmse_std_percent.unwrap_or(f64::NAN)),
            spread(&|training| training.test.nrmse_std_percent.unwrap_or(f64::NAN)),
            spread(&|training| training.seconds),
            spread(&|training| training.evaluations as f64),
        ]
    });
    (headings.collect(), rows.into())
}

/// Lowest, median and highest.
fn range(values: &[f64]) -> (f64, f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let median =
        if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
    (sorted[0], median, sorted[sorted.len() - 1])
}

fn median_mse(repetitions: &[Repetition], trainer: Trainer) -> f64 {
    let values: Vec<f64> = of(repetitions, trainer).iter().map(|training| training.train.mse).collect();
    range(&values).1
}

/// Does the paper's claim hold: is the hybrid better than either phase alone?
pub(super) fn claim(repetitions: &[Repetition]) -> String {
    let median = |trainer| median_mse(repetitions, trainer);
    let (hybrid, genetic, subgradient) =
        (median(Trainer::Hybrid), median(Trainer::Genetic), median(Trainer::Subgradient));
    let best_of = |repetition: &&Repetition| {
        let mse = |trainer| {
            let found = repetition.trainings.iter().find(|training| training.trainer == trainer);
            found.map_or(f64::NAN, |training| training.train.mse)
        };
        mse(Trainer::Hybrid) < mse(Trainer::Genetic) && mse(Trainer::Hybrid) < mse(Trainer::Subgradient)
    };
    let wins = repetitions.iter().filter(best_of).count();
    let seeds = count(repetitions.len(), "seed");
    let verdict = if hybrid < genetic && hybrid < subgradient && 2 * wins > repetitions.len() {
        "holds here"
    } else if hybrid < genetic {
        "holds here against the genetic algorithm alone, but not against the sub-gradient method alone"
    } else {
        "does not hold here"
    };
    let times = |other: f64| match other / hybrid {
        ratio if ratio >= 1.0 => format!("{:.2} times below", Significant(ratio)),
        ratio => format!("{:.2} times above", Significant(1.0 / ratio)),
    };
    format!(
        "The paper's claim that the hybrid beats each phase alone {verdict}: its median MSE is {} that of the genetic algorithm and {} that of the sub-gradient method, and it is the lowest of the three in {wins} of {seeds}.",
        times(genetic),
        times(subgradient)
    )
}

/// How soon Levenberg-Marquardt is as good as the hybrid.
pub(super) fn matched(repetitions: &[Repetition]) -> String {
    let hybrids = of(repetitions, Trainer::Hybrid);
    let shares: Vec<f64> = repetitions
        .iter()
        .zip(&hybrids)
        .filter_map(|(repetition, hybrid)| Some(repetition.seconds_to_match? / hybrid.seconds))
        .collect();
    let tried = count(repetitions.len(), "seed");
    let reached = match shares.as_slice() {
        [] => {
            return format!(
                "Levenberg-Marquardt, begun anew whenever it ends, does not reach the hybrid's final error within the hybrid's time from any of {tried}."
            );
        }
        shares => shares,
    };
    let (low, median, high) = range(reached);
    let part = |share: f64| format!("1/{:.2}", Significant(1.0 / share));
    format!(
        "Levenberg-Marquardt, begun anew whenever it ends, reaches the hybrid's final error within the hybrid's time in {} of {tried}, after {} of that time ({} to {}).",
        reached.len(),
        part(median),
        part(low),
        part(high)
    )
}

fn colour(trainer: Trainer) -> Colour {
    let place = TRAINERS.iter().position(|&other| other == trainer);
    Colour::Series(match place.unwrap_or_default() {
        // The hybrid is blue, as the model is elsewhere.
        2 => 0,
        0 => 2,
        other => other,
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Abscissa {
    Epochs,
    Seconds,
}

/// Error against epochs or seconds, every training.
fn chart(repetitions: &[Repetition], abscissa: Abscissa) -> String {
    let x = |moment: &Moment| match abscissa {
        Abscissa::Epochs => moment.epoch as f64,
        Abscissa::Seconds => moment.seconds,
    };
    let curve = |training: &Training| Curve {
        points: kept(&training.moments).map(|moment| (x(moment), moment.nrmse_percent)).collect(),
        colour: colour(training.trainer),
        width: 1.4,
    };
    let trainings = repetitions.iter().flat_map(|repetition| &repetition.trainings);
    let curves: Vec<Curve> = trainings.map(curve).collect();
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let label = if abscissa == Abscissa::Epochs { "epoch" } else { "time (s)" };
    Chart {
        labels: Vec::new(),
        description: format!("Training error against {label}, one line for each trainer and seed"),
        title: String::new(),
        size: (860.0, 360.0),
        x: Axis::logarithmic(label, points().map(|point| point.0)),
        y: Axis::logarithmic("training error (% of std)", points().map(|point| point.1)),
        legend: TRAINERS.map(|trainer| (colour(trainer), trainer.name().to_string())).into(),
        curves,
    }
    .svg()
}

/// Moments that can be told apart in a drawing: about a hundred in a decade of epochs.
fn kept(moments: &[Moment]) -> impl Iterator<Item = &Moment> {
    let mut next = 1.0;
    moments.iter().enumerate().filter_map(move |(index, moment)| {
        let due = moment.epoch as f64 >= next || index + 1 == moments.len();
        if due {
            next = moment.epoch as f64 * 1.023;
        }
        due.then_some(moment)
    })
}

fn html(protocol: &Protocol, repetitions: &[Repetition], charts: &[&String]) -> String {
    let (headings, rows) = summary(repetitions);
    let words = "Every trainer minimises the same objective on the same record, output weights by least squares. From the same seed the genetic algorithm and the hybrid begin with the same population, the sub-gradient method and Levenberg-Marquardt with the same random network, whose thresholds are spread out beforehand. An epoch is a generation of 50 individuals, an outer iteration of the sub-gradient method, or an iteration of Levenberg-Marquardt; a hybrid spends half of its epochs on each phase. An evaluation is one of the objective or of its gradient. Seconds are of this machine and of this run. Unseen is the rest of the history, which nothing was fitted to.";
    let mut content = verdict(&claim(repetitions));
    content += &section(
        "Results",
        &(note(&heading(protocol))
            + &table(&headings, &rows)
            + &paragraph(&matched(repetitions))
            + &note(words)),
    );
    let figures: String = charts.iter().map(|chart| figure(chart, true)).collect();
    content += &section("Convergence", &figures);
    content += &section(
        "The specimen",
        &(paragraph(protocol.specimen.summary)
            + &note(&format!("Published: {}", protocol.specimen.published))
            + &note(&format!("Designed: {}", protocol.specimen.designed))),
    );
    whole("Trainers compared", &content)
}

fn markdown(protocol: &Protocol, repetitions: &[Repetition]) -> String {
    let (headings, rows) = summary(repetitions);
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("# Trainers compared\n\n{}.\n\n", heading(protocol));
    text += &line(&headings);
    text += &format!("|---|{}\n", "---:|".repeat(headings.len() - 1));
    text.extend(rows.iter().map(|row| line(row)));
    let runs = format!(
        "Median of {} (lowest to highest); hysid {}, seeds from {}.",
        count(repetitions.len(), "seed"),
        env!("CARGO_PKG_VERSION"),
        protocol.first_seed
    );
    let quick = if protocol.epochs < EPOCHS { "\nA quick run: a tenth of the paper's epochs.\n" } else { "" };
    text + &format!("\n{runs}\n{quick}\n{}\n\n{}\n", claim(repetitions), matched(repetitions))
}

fn csv(repetitions: &[Repetition]) -> String {
    let mut text = String::from(
        "seed,trainer,train_mse,train_nrmse_std_percent,test_mse,test_nrmse_std_percent,seconds,evaluations\n",
    );
    for training in repetitions.iter().flat_map(|repetition| &repetition.trainings) {
        let percent = |errors: &hysid::metrics::Errors| errors.nrmse_std_percent.unwrap_or(f64::NAN);
        text += &format!(
            "{},{},{},{},{},{},{:.4},{}\n",
            training.seed,
            training.trainer.name(),
            training.train.mse,
            percent(&training.train),
            training.test.mse,
            percent(&training.test),
            training.seconds,
            training.evaluations
        );
    }
    text
}

fn history(repetitions: &[Repetition]) -> String {
    let mut text = String::from("seed,trainer,epoch,evaluations,seconds,train_nrmse_std_percent\n");
    for training in repetitions.iter().flat_map(|repetition| &repetition.trainings) {
        for moment in kept(&training.moments) {
            text += &format!(
                "{},{},{},{},{:.5},{}\n",
                training.seed,
                training.trainer.name(),
                moment.epoch,
                moment.evaluations,
                moment.seconds,
                moment.nrmse_percent
            );
        }
    }
    text
}
