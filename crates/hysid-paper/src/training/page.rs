//! Result of the comparison of trainers: tables, figures, and the sentence on the paper's claim.

use hysid::options::network::Trainer;
use hysid_core::elementary::square;
use hysid_core::significant::Significant;
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, count, number};

use super::{EPOCHS, Moment, Repetition, TRAINERS, TrainerRun, TrainingProtocol};
use crate::chapter::{Chapter, ChapterTarget, Content, FurtherFile, TargetSource, TargetVerdict, stands_in};
use crate::spread::Spread;

/// Heading of every table: what the figures are of.
fn heading(protocol: &TrainingProtocol) -> String {
    format!(
        "{}: XPNN with 10 stops and 10 tanh neurons; {} epochs",
        stands_in(protocol.specimen.name, "example 2"),
        protocol.epochs
    )
}

/// Names of the files beside page and tables, and header lines of those that are tables.
const SEEDS_TABLE: &str = "training-seeds.csv";
const HISTORY_TABLE: &str = "training-history.csv";
const EPOCHS_CHART: &str = "training-epochs.svg";
const SECONDS_CHART: &str = "training-seconds.svg";
const SEEDS_HEADER: &str =
    "seed,trainer,train_mse,train_nrmse_std_percent,test_mse,test_nrmse_std_percent,seconds,evaluations\n";
const HISTORY_HEADER: &str = "seed,trainer,epoch,evaluations,seconds,train_nrmse_std_percent\n";

/// The files beside page and tables.
pub const FILES: [FurtherFile; 4] = [
    FurtherFile { name: SEEDS_TABLE, header: Some(SEEDS_HEADER) },
    FurtherFile { name: HISTORY_TABLE, header: Some(HISTORY_HEADER) },
    FurtherFile { name: EPOCHS_CHART, header: None },
    FurtherFile { name: SECONDS_CHART, header: None },
];

pub fn chapter(protocol: &TrainingProtocol, repetitions: &[Repetition]) -> Chapter {
    let (epochs, seconds) = (chart(repetitions, Abscissa::Epochs), chart(repetitions, Abscissa::Seconds));
    let files = [
        (SEEDS_TABLE, Content::Text(csv(repetitions))),
        (HISTORY_TABLE, Content::Text(history(repetitions))),
        (EPOCHS_CHART, Content::Drawing(epochs.clone().into())),
        (SECONDS_CHART, Content::Drawing(seconds.clone().into())),
    ];
    let specimen = protocol.specimen;
    let mut parts = vec![
        Part::Table(table(protocol, repetitions, "medians of the seeds", |(_, median, _)| median.into())),
        Part::Table(table(protocol, repetitions, "lowest to highest of the seeds", |(low, _, high)| {
            format!("{} to {}", number(low, 3), number(high, 3)).into()
        })),
        Part::paragraph(why(protocol, repetitions)),
        Part::paragraph(matched(repetitions)),
        Part::note(WORDS),
    ];
    if protocol.epochs < EPOCHS {
        parts.push(Part::note("A quick run: a tenth of the paper's epochs."));
    }
    parts.extend([
        Part::heading("Convergence"),
        Part::chart(epochs),
        Part::chart(seconds),
        Part::note(format!(
            "The specimen: {}. Published: {}. Designed: {}.",
            specimen.summary, specimen.published, specimen.designed
        )),
    ]);
    Chapter {
        name: "training".into(),
        title: "trainers compared".into(),
        verdict: claim(repetitions),
        parts,
        targets: targets(protocol, repetitions),
        files: files.map(|(name, content)| (name.to_string(), content)).into(),
    }
}

/// Explains the words of the tables.
const WORDS: &str = "Every trainer minimises the same objective on the same record, output weights by least \
                     squares. From the same seed the genetic algorithm and the hybrid begin with the same \
                     population, the sub-gradient method and Levenberg-Marquardt with the same random \
                     network, whose thresholds are spread out beforehand. An epoch is a generation of 50 \
                     individuals, an outer iteration of the sub-gradient method, or an iteration of \
                     Levenberg-Marquardt; a hybrid spends half of its epochs on each phase. An evaluation \
                     is one of the objective or of its gradient. Times are those of this run on this \
                     machine, which may have run other programs too. “Unseen” is the rest of the history, \
                     which no model was fitted to.";

fn of(repetitions: &[Repetition], trainer: Trainer) -> Vec<&TrainerRun> {
    let all = repetitions.iter().flat_map(|repetition| &repetition.trainings);
    all.filter(|training| training.trainer == trainer).collect()
}

/// A row for each trainer; `cell` is made of the lowest, median and highest of its seeds.
fn table(
    protocol: &TrainingProtocol,
    repetitions: &[Repetition],
    of_seeds: &str,
    cell: impl Fn((f64, f64, f64)) -> Cell,
) -> Table {
    let unit = repetitions[0].trainings[0].train.output.rsplit_once('_').map_or("", |(_, unit)| unit);
    let columns = ["trainer".to_string(), format!("MSE, {unit}²")].into_iter();
    let columns = columns.chain(["% of std", "unseen, %", "seconds", "evaluations"].map(String::from));
    let row = |trainer: Trainer| {
        let trainings = of(repetitions, trainer);
        let spread = |value: &dyn Fn(&TrainerRun) -> f64| {
            cell(range(&trainings.iter().map(|training| value(training)).collect::<Vec<f64>>()))
        };
        vec![
            trainer.name().into(),
            spread(&|training| training.train.mse),
            spread(&|training| training.train.nrmse_std_percent.unwrap_or(f64::NAN)),
            spread(&|training| training.test.nrmse_std_percent.unwrap_or(f64::NAN)),
            spread(&|training| training.seconds),
            spread(&|training| training.evaluations as f64),
        ]
    };
    let seeds = count(repetitions.len(), "seed");
    Table::new(columns)
        .headed(format!("{}; {of_seeds} ({seeds} from {})", heading(protocol), protocol.first_seed))
        .with_rows(TRAINERS.map(row))
}

fn range(values: &[f64]) -> (f64, f64, f64) {
    let Spread { low, median, high } = Spread::of(values.iter().copied()).unwrap_or(Spread {
        low: f64::NAN,
        median: f64::NAN,
        high: f64::NAN,
    });
    (low, median, high)
}

/// The paper's claims on its hybrid.
pub(super) fn targets(protocol: &TrainingProtocol, repetitions: &[Repetition]) -> Vec<ChapterTarget> {
    let target =
        |figure: &str, limit: f64, source: TargetSource, ratio: &dyn Fn(&Repetition) -> Option<f64>| {
            let ratios: Option<Vec<f64>> = repetitions.iter().map(ratio).collect();
            let spread = ratios.and_then(Spread::of);
            let is_met = spread.is_some_and(|spread| spread.median >= limit);
            ChapterTarget {
                specimen: protocol.specimen.name.into(),
                figure: figure.into(),
                source,
                wanted: format!("at least {limit}"),
                one: spread.map_or_else(|| "–".into(), Spread::shown),
                several: None,
                verdict: if is_met { TargetVerdict::Met } else { TargetVerdict::Missed },
            }
        };
    let times = |other: Trainer| {
        move |repetition: &Repetition| {
            Some(repetition.of(other)?.train.mse / repetition.of(Trainer::Hybrid)?.train.mse)
        }
    };
    vec![
        target("MSE ratio, genetic algorithm / hybrid", 1.0, TargetSource::Words, &times(Trainer::Genetic)),
        target(
            "MSE ratio, sub-gradient method / hybrid",
            1.0,
            TargetSource::Words,
            &times(Trainer::Subgradient),
        ),
        target(
            "MSE ratio, end of the hybrid's first phase / end",
            40.0,
            TargetSource::Paper,
            &|repetition| {
                let hybrid = repetition.of(Trainer::Hybrid)?;
                let first = hybrid.percent_at(protocol.epochs / 2)?;
                Some(square(first / hybrid.train.nrmse_std_percent?))
            },
        ),
    ]
}

/// The cause, by experiment: what the same number of sub-gradient epochs comes to without the genetic algorithm before.
fn why(protocol: &TrainingProtocol, repetitions: &[Repetition]) -> String {
    let of_seed = |repetition: &Repetition| -> Option<(f64, f64)> {
        let (hybrid, alone) = (repetition.of(Trainer::Hybrid)?, repetition.of(Trainer::Subgradient)?);
        Some((alone.percent_at(protocol.epochs / 2)?, hybrid.train.nrmse_std_percent?))
    };
    let pairs: Vec<(f64, f64)> = repetitions.iter().filter_map(of_seed).collect();
    let (alone, hybrid) = (pairs.iter().map(|pair| pair.0), pairs.iter().map(|pair| pair.1));
    let (Some(alone), Some(hybrid)) = (Spread::of(alone), Spread::of(hybrid)) else { return String::new() };
    let wins = pairs.iter().filter(|(alone, hybrid)| hybrid < alone).count();
    let seeds = count(pairs.len(), "seed");
    let (alone, hybrid) = (alone.shown(), hybrid.shown());
    if 2 * wins > pairs.len() {
        return format!(
            "What the genetic algorithm is good for: after half of its epochs, as many as the hybrid has of them, the sub-gradient method alone is at {alone} % of std from its random network; the hybrid ends at {hybrid} %. With equally many sub-gradient epochs the hybrid is the lower in {wins} of {seeds}."
        );
    }
    format!(
        "Why the hybrid does not do better than the sub-gradient method: it spends half of its epochs on the genetic algorithm, whose best individual is far from the end. After half of its epochs, as many as the hybrid has of them, the sub-gradient method alone is at {alone} % of std from its random network; the hybrid ends at {hybrid} %. With equally many sub-gradient epochs the hybrid is the lower in {wins} of {seeds}."
    )
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
                "The sub-gradient method alone, begun anew from another random network after half as many epochs \
                 as the hybrid has, does not reach the hybrid's final error within the hybrid's time from any of \
                 {tried}."
            );
        }
        shares => shares,
    };
    let (low, median, high) = range(reached);
    let part = |share: f64| format!("1/{:.2}", Significant(1.0 / share));
    format!(
        "The sub-gradient method alone, begun anew from another random network after half as many epochs as the \
         hybrid has, reaches the hybrid's final error within the hybrid's time in {} of {tried}, after {} of that \
         time ({} to {}).",
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
fn chart(repetitions: &[Repetition], abscissa: Abscissa) -> Chart {
    let x = |moment: &Moment| match abscissa {
        Abscissa::Epochs => moment.epoch as f64,
        Abscissa::Seconds => moment.seconds,
    };
    let curve = |training: &TrainerRun| {
        let points = kept(&training.moments).map(|moment| (x(moment), moment.nrmse_percent));
        Curve::new(points.collect(), colour(training.trainer), 1.4)
    };
    let trainings = repetitions.iter().flat_map(|repetition| &repetition.trainings);
    let curves: Vec<Curve> = trainings.map(curve).collect();
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let label = if abscissa == Abscissa::Epochs { "epoch" } else { "time (s)" };
    let x = Axis::logarithmic(label, points().map(|point| point.0));
    let y = Axis::logarithmic("training error (% of std)", points().map(|point| point.1));
    let description = format!("Training error against {label}, one line for each trainer and seed");
    let legend = TRAINERS.map(|trainer| (colour(trainer), trainer.name()));
    Chart::on_axes(description, x, y, curves).with_height(360.0).with_legend(legend)
}

/// Moments that can be distinguished in a drawing: about a hundred in a decade of epochs.
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

fn csv(repetitions: &[Repetition]) -> String {
    let mut text = String::from(SEEDS_HEADER);
    for training in repetitions.iter().flat_map(|repetition| &repetition.trainings) {
        let percent = |errors: &hysid::data::metrics::Errors| errors.nrmse_std_percent.unwrap_or(f64::NAN);
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
    let mut text = String::from(HISTORY_HEADER);
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
