//! The table: right, said and wrong by protocol and by disturbance.

use super::answer::Answer;
use super::protocols::Disturbance;
use crate::cases::{aligned, row};

/// A row for each protocol and for each disturbance.
pub fn table(answers: &[(&'static str, Disturbance, Answer)]) -> String {
    let counts = |is_of: &dyn Fn(&(&'static str, Disturbance, Answer)) -> bool| {
        let of: Vec<&Answer> =
            answers.iter().filter(|answer| is_of(answer)).map(|answer| &answer.2).collect();
        let count = |is: fn(&Answer) -> bool| of.iter().filter(|answer| is(answer)).count();
        let [right, said, wrong] = [
            count(|answer| *answer == Answer::Right),
            count(|answer| matches!(answer, Answer::Said(_))),
            count(|answer| matches!(answer, Answer::Wrong(_))),
        ];
        [right, said, wrong].map(|count| count.to_string())
    };
    let columns = ["right", "said", "wrong"];
    let mut protocols = vec![row("protocol", &columns)];
    let mut names: Vec<&str> = answers.iter().map(|answer| answer.0).collect();
    names.dedup();
    protocols.extend(names.iter().map(|name| row(name, &counts(&|answer| answer.0 == *name))));
    protocols.push(row("all", &counts(&|_| true)));
    let mut disturbances = vec![row("disturbance", &columns)];
    let of = |disturbance: Disturbance| row(disturbance.name(), &counts(&|answer| answer.1 == disturbance));
    disturbances.extend(Disturbance::ALL.map(of));
    format!("{}\n{}", aligned(&protocols), aligned(&disturbances))
}
