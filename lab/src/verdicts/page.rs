//! The verdicts as a page in Markdown.

use super::answer::{Diagnosis, Verdict};
use crate::cases::{Case, Reasons, aligned, row};

const KEY: &str =
    "\nIn the cells: the verdict and the index in percent; `?` where the record does not allow a verdict.\n";

/// All that is known so far.
pub struct Page {
    /// The cases that are done.
    pub cases: Vec<Case<Diagnosis>>,
    /// Day, version and command.
    origin: String,
}

impl Page {
    /// The page before the first case is done.
    pub fn new(origin: String) -> Self {
        Self { cases: Vec::new(), origin }
    }

    /// The whole page.
    pub fn text(&self) -> String {
        format!(
            "# What kind of hysteresis is it? Verdicts on every case\n\n{}\n{} cases, each a folder with `train.csv`. The data \
             are not in this repository.\n\n{}",
            self.origin,
            self.cases.len(),
            self.tables()
        )
    }

    /// The table of verdicts, what the doctor says and what is advised.
    pub fn tables(&self) -> String {
        let doctor = self.said("Data quality", |diagnosis| &diagnosis.complaints);
        let advice = self.said("Advice", |diagnosis| &diagnosis.advice);
        format!("## Verdicts\n\n{}{doctor}{advice}", self.verdicts())
    }

    fn verdicts(&self) -> String {
        let mut properties: Vec<&str> = self
            .diagnoses()
            .next()
            .map_or_else(Vec::new, |(_, first)| first.verdicts.iter().map(|v| v.property.as_str()).collect());
        if properties.is_empty() {
            // So that the cases still have a place to say why.
            properties.push("any property");
        }
        let mut reasons = Reasons::default();
        let mut rows = vec![row("case", &properties)];
        for case in &self.cases {
            let cells: Vec<String> = match &case.outcome {
                Ok(diagnosis) => properties.iter().map(|property| cell(diagnosis, property)).collect(),
                Err(reason) => vec![format!("– ({})", reasons.number(reason)); properties.len()],
            };
            rows.push(row(&case.name, &cells));
        }
        let reasons = reasons.list();
        let reasons =
            if reasons.is_empty() { reasons } else { format!("\nWhy cells are empty:\n\n{reasons}") };
        aligned(&rows) + KEY + &reasons
    }

    fn diagnoses(&self) -> impl Iterator<Item = (&str, &Diagnosis)> {
        self.cases.iter().filter_map(|case| Some((case.name.as_str(), case.outcome.as_ref().ok()?)))
    }

    /// A section with a line for each case that something is said of.
    fn said(&self, heading: &str, of: fn(&Diagnosis) -> &Vec<String>) -> String {
        let line = |(name, diagnosis): (&str, &Diagnosis)| match of(diagnosis).as_slice() {
            [] => String::new(),
            said => format!("- **{name}**: {}\n", said.join("; ")),
        };
        let lines: String = self.diagnoses().map(line).collect();
        if lines.is_empty() { lines } else { format!("\n## {heading}\n\n{lines}") }
    }
}

fn cell(diagnosis: &Diagnosis, property: &str) -> String {
    let Some(Verdict { verdict, index, .. }) = diagnosis.verdicts.iter().find(|v| v.property == property)
    else {
        return "–".into();
    };
    let verdict = if verdict == "not testable" { "?" } else { verdict };
    match index {
        Some(index) => format!("{verdict} {}", shown(100.0 * index)),
        None => verdict.into(),
    }
}

/// Percent with two digits, none behind the point from 10 on.
fn shown(percent: f64) -> String {
    match percent.abs() {
        large if large >= 9.95 => format!("{percent:.0}"),
        middle if middle >= 0.995 => format!("{percent:.1}"),
        _ => format!("{percent:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_verdict_and_index_and_failures_a_reason() {
        let verdict = |property: &str, verdict: &str, index| Verdict {
            property: property.into(),
            verdict: verdict.into(),
            index,
        };
        let steel = Diagnosis {
            verdicts: vec![verdict("masing", "no", Some(0.4)), verdict("congruency", "not testable", None)],
            complaints: vec!["it drifts".into(), "it is short".into()],
            advice: vec![],
        };
        let timber = Diagnosis {
            verdicts: vec![verdict("masing", "yes", Some(0.0123)), verdict("congruency", "no", Some(-0.002))],
            complaints: vec![],
            advice: vec!["take xpnn".into()],
        };
        let mut page = Page::new("today\n".into());
        let case = |name: &str, outcome| Case { name: name.into(), outcome };
        page.cases =
            vec![case("bad", Err("no number".into())), case("steel", Ok(steel)), case("timber", Ok(timber))];
        let expected = "## Verdicts

| case   |  masing | congruency |
| ------ | ------: | ---------: |
| bad    |   – (1) |      – (1) |
| steel  |   no 40 |          ? |
| timber | yes 1.2 |   no -0.20 |

In the cells: the verdict and the index in percent; `?` where the record does not allow a verdict.

Why cells are empty:

1. no number

## Data quality

- **steel**: it drifts; it is short

## Advice

- **timber**: take xpnn
";
        assert_eq!(page.tables(), expected);
        assert!(page.text().ends_with(expected) && page.text().contains("today\n\n3 cases, "));

        page.cases.truncate(1);
        assert!(page.tables().contains("| bad  |        – (1) |\n"), "{}", page.tables());
    }
}
