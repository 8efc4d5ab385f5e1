//! The tables as a page in Markdown, and the list of wrong verdicts.

use super::laws::Law;
use super::property::PROPERTIES;
use super::tally::{Outcome, Tally, Verdict, kinds};
use crate::cases::{aligned, in_words, row};

/// Kinds of wrong verdicts that are shown.
const SHOWN: usize = 10;

const COLUMNS: [&str; 4] = ["right", "wrong", "not testable", "wrong of decided, %"];

/// Names of what was asked about, in the order of the tables.
pub struct Names {
    pub laws: Vec<&'static str>,
    pub paths: Vec<&'static str>,
    pub disturbances: Vec<&'static str>,
}

/// All tables.
pub fn tables(names: &Names, verdicts: &[Verdict]) -> String {
    let by = |heading: &str, names: &[&str], of: fn(&Verdict) -> &'static str| {
        format!("## By {heading}\n\n{}\n", table(heading, names, verdicts, of))
    };
    [
        by("disturbance", &names.disturbances, |verdict| verdict.disturbance),
        by("property", &PROPERTIES, |verdict| verdict.property),
        by("law", &names.laws, |verdict| verdict.law),
        by("path", &names.paths, |verdict| verdict.path),
        crossed(&names.disturbances, verdicts),
        most_frequent(verdicts),
    ]
    .concat()
}

fn table(heading: &str, names: &[&str], verdicts: &[Verdict], of: fn(&Verdict) -> &'static str) -> String {
    let mut rows = vec![row(heading, &COLUMNS)];
    for name in names {
        let tally = Tally::of(verdicts.iter().filter(|verdict| of(verdict) == *name));
        rows.push(row(name, &cells(&tally)));
    }
    rows.push(row("all", &cells(&Tally::of(verdicts.iter()))));
    aligned(&rows)
}

fn cells(tally: &Tally) -> [String; 4] {
    let share = tally.percent_wrong().map_or_else(|| "–".into(), |percent| format!("{percent:.2}"));
    [tally.right.to_string(), tally.wrong.to_string(), tally.not_testable.to_string(), share]
}

/// Numbers of wrong verdicts, a row for each disturbance and a column for each property.
fn crossed(disturbances: &[&str], verdicts: &[Verdict]) -> String {
    let mut rows = vec![row("disturbance", &PROPERTIES)];
    for disturbance in disturbances {
        let wrong = |property: &&str| {
            let here = |v: &&Verdict| v.disturbance == *disturbance && v.property == *property;
            Tally::of(verdicts.iter().filter(here)).wrong.to_string()
        };
        rows.push(row(disturbance, &PROPERTIES.iter().map(wrong).collect::<Vec<_>>()));
    }
    format!("## Wrong verdicts by disturbance and property\n\n{}\n", aligned(&rows))
}

fn most_frequent(verdicts: &[Verdict]) -> String {
    let mut rows = vec![row("disturbance", &["property", "law", "wrong"])];
    for ([disturbance, property, law], count) in kinds(verdicts).into_iter().take(SHOWN) {
        rows.push(row(disturbance, &[property, law, &count.to_string()]));
    }
    format!("## Most frequent wrong verdicts\n\n{}", in_words(&rows))
}

/// The laws with their answers, and why.
pub fn laws(laws: &[Law]) -> String {
    let mut rows = vec![row("law", &["answers", "why"])];
    rows.extend(laws.iter().map(|law| row(law.name, &[law.answers, law.why])));
    format!(
        "## Laws\n\nAnswers, yes, no or none (`-`), in the order of the table of properties.\n\n{}",
        in_words(&rows)
    )
}

/// A line of CSV for each wrong verdict.
pub fn wrong_verdicts(verdicts: &[Verdict]) -> String {
    let mut text = String::from("law,path,disturbance,property,said,true,index,threshold,statement\n");
    let word = |answer: bool| if answer { "yes" } else { "no" };
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
    for verdict in verdicts.iter().filter(|verdict| verdict.outcome() == Outcome::Wrong) {
        let Verdict { law, path, disturbance, property, answer, finding } = verdict;
        let (index, threshold) = (number(finding.index), number(finding.threshold));
        let (said, statement) = (word(!answer), finding.statement.replace('"', "\"\""));
        let answer = word(*answer);
        text += &format!(
            "{law},{path},{disturbance},{property},{said},{answer},{index},{threshold},\"{statement}\"\n"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::answer::Finding;
    use super::*;

    fn verdict(law: &'static str, property: &'static str, answer: bool, said: Option<bool>) -> Verdict {
        let statement = "so \"wide\"".into();
        let finding = Finding { verdict: said, index: Some(0.5), threshold: None, statement };
        Verdict { law, path: "nested", disturbance: "none", property, answer, finding }
    }

    #[test]
    fn verdicts_are_counted_and_wrong_ones_listed() {
        let verdicts = [
            verdict("play", "masing", true, Some(true)),
            verdict("play", "congruency", true, Some(false)),
            verdict("dahl", "masing", false, None),
        ];
        let names = Names { laws: vec!["play", "dahl"], paths: vec!["nested"], disturbances: vec!["none"] };
        let tables = tables(&names, &verdicts);
        assert!(
            tables.contains("| play |     1 |     1 |            0 |               50.00 |\n"),
            "{tables}"
        );
        assert!(
            tables.contains("| dahl |     0 |     0 |            1 |                   – |\n"),
            "{tables}"
        );
        assert!(tables.ends_with("| none        | congruency | play | 1     |\n"), "{tables}");
        let wrong = wrong_verdicts(&verdicts);
        assert!(
            wrong.ends_with("\nplay,nested,none,congruency,no,yes,0.500000,,\"so \"\"wide\"\"\"\n"),
            "{wrong}"
        );
        assert_eq!(wrong.lines().count(), 2);
    }
}
