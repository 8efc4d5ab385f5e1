use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use hysid::data::metrics::ErrorSums;
use hysid_document::{Page, markdown};

use super::*;
use crate::chapter::Content;

/// A clock that goes on by a second whenever it is looked at.
#[derive(Default)]
struct TickingClock(AtomicU64);

impl Observer for TickingClock {
    fn clock(&self) -> Duration {
        Duration::from_secs(self.0.fetch_add(1, Ordering::Relaxed))
    }

    fn is_stopped(&self) -> bool {
        false
    }

    fn say(&self, _: &str) {}
}

/// Errors of so many percent of the output's standard deviation.
fn errors(percent: f64) -> Errors {
    let mut sums = ErrorSums::default();
    let error = percent / 100.0;
    sums.add(&[1.0, -1.0, 1.0, -1.0], &[1.0 + error, -1.0 + error, 1.0 - error, -1.0 - error]);
    sums.errors("force_kN").unwrap()
}

/// A repetition with errors of genetic, sub-gradient, hybrid, Levenberg-Marquardt; the hybrid takes 10 s.
fn repetition_of(percents: [f64; 4], seconds_to_match: Option<f64>) -> Repetition {
    let training = |(trainer, percent): (Trainer, f64)| TrainerRun {
        trainer,
        seed: 1,
        train: errors(percent),
        test: errors(percent),
        moments: vec![Moment { epoch: 1, evaluations: 2, seconds: 0.1, nrmse_percent: percent }],
        seconds: 10.0,
        evaluations: 100,
    };
    Repetition { trainings: TRAINERS.into_iter().zip(percents).map(training).collect(), seconds_to_match }
}

#[test]
fn the_sentence_says_what_the_figures_say() {
    let claim = |percents: &[[f64; 4]]| {
        let repetitions: Vec<Repetition> =
            percents.iter().map(|percents| repetition_of(*percents, None)).collect();
        page::claim(&repetitions)
    };
    let holds = claim(&[[4.0, 2.0, 1.0, 1.0], [4.0, 2.0, 1.0, 1.0], [4.0, 0.5, 1.0, 1.0]]);
    assert!(holds.contains("holds here:") && holds.contains("in 2 of 3 seeds"), "{holds}");
    assert!(
        holds.contains("16 times below that of the genetic")
            && holds.contains("4 times below that of the sub")
    );
    let half = claim(&[[4.0, 1.0, 2.0, 1.0]]);
    assert!(half.contains("but not against the sub-gradient method alone"), "{half}");
    assert!(half.contains("4 times above that of the sub-gradient"), "{half}");
    assert!(claim(&[[1.0, 1.0, 2.0, 1.0]]).contains("does not hold here"));
}

/// Ratios of the MSE: squares of those of the percents.
#[test]
fn targets_are_those_of_the_paper_on_its_hybrid() {
    let protocol = TrainingProtocol::new(1, true);
    let found = page::targets(&protocol, &[repetition_of([4.0, 0.5, 1.0, 1.0], None)]);
    let found: Vec<(&str, crate::chapter::TargetVerdict)> =
        found.iter().map(|target| (target.one.as_str(), target.verdict)).collect();
    use crate::chapter::TargetVerdict::{Met, Missed};
    assert_eq!(found, [("16", Met), ("0.25", Missed), ("1", Missed)]);
}

#[test]
fn levenberg_marquardt_is_timed_against_the_hybrid() {
    let percents = [4.0, 2.0, 1.0, 1.0];
    let matched = page::matched(&[repetition_of(percents, Some(0.2)), repetition_of(percents, None)]);
    assert!(matched.contains("in 1 of 2 seeds, after 1/50 of that time"), "{matched}");
    assert!(page::matched(&[repetition_of(percents, None)]).contains("does not reach"));
}

#[test]
fn time_that_ends_before_there_is_a_model_reaches_nothing() {
    let protocol = TrainingProtocol { epochs: 10, ..TrainingProtocol::new(3, true) };
    // The time ends before the start, and at its first and second moments.
    for seconds in [0.5, 1.5, 2.5] {
        let mut hybrid = repetition_of([1e-12; 4], None).trainings.remove(2);
        hybrid.seconds = seconds;
        assert_eq!(
            seconds_to_match(&protocol, 3, &hybrid, &TickingClock::default()).unwrap(),
            None,
            "{seconds} s"
        );
    }
}

#[test]
fn a_short_comparison_makes_a_chapter() {
    let protocol = TrainingProtocol { epochs: 10, ..TrainingProtocol::new(3, true) };
    let chapter = compared(&protocol, &TickingClock::default()).unwrap();
    let content = |name: &str| &chapter.files.iter().find(|(other, _)| other == name).unwrap().1;
    let file = |name: &str| match content(name) {
        Content::Text(text) => text.clone(),
        Content::Drawing(chart) => chart.file("Hysid"),
    };
    let table = file("training-seeds.csv");
    assert_eq!(table.lines().count(), 1 + 5 * TRAINERS.len());
    assert!(table.contains("\n3,genetic,") && table.contains("\n7,levenberg-marquardt,"), "{table}");
    // The history of the genetic algorithm: 10 generations of 50, the best of which lives on.
    let history = file("training-history.csv");
    assert!(history.contains(",genetic,10,540,"), "{history}");
    assert!(file("training-seconds.svg").starts_with("<svg"));
    let text = markdown::page(&Page { title: chapter.verdict, parts: chapter.parts });
    for word in
        ["Synthetic specimen reinforced-concrete-joint", "The paper's claim", "| trainer | MSE, kN² |"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
}
