//! The tables as a page in Markdown, with where they come from.

use super::answer::Case;
use super::table::{Measure, Reasons, in_words, row, table};
use crate::statistics::geometric_mean;

/// The tables under their headings.
const TABLES: [(&str, Measure); 3] = [
    ("Test: NRMSE of a free run, % of std", |figures| figures.test),
    ("Training: NRMSE of a free run, % of std", |figures| figures.train),
    ("Seconds to fit", |figures| figures.seconds),
];

/// The model that chooses what it is made of.
const CHOOSES: &str = "auto";

/// All that is known so far.
pub struct Page {
    /// The cases that are done.
    pub cases: Vec<Case>,
    asked: usize,
    /// Date, version and command.
    origin: String,
}

impl Page {
    /// The page of so many cases before the first is done.
    pub fn new(origin: String, cases: usize) -> Self {
        Self { cases: Vec::new(), asked: cases, origin }
    }

    /// The whole page.
    pub fn text(&self) -> String {
        let done = match self.cases.len() {
            all if all == self.asked => format!("{all} cases"),
            some => format!("{some} of {} cases (not finished)", self.asked),
        };
        format!(
            "# Every model on every case\n\n{}\n{done}, each a folder with `train.csv` and `test.csv`; the test data are \
             never trained on. The data are not in this\nrepository.\n\n{}",
            self.origin,
            self.tables()
        )
    }

    /// The tables with their headings, and below the first why cells are empty.
    pub fn tables(&self) -> String {
        let mut reasons = Reasons::default();
        let mut sections = TABLES.map(|(heading, measure)| {
            format!("## {heading}\n\n{}", table(&self.cases, measure, &mut reasons))
        });
        let reasons = reasons.list();
        sections[0] += "\nBold: the best of its row. A mean is over the cases where the model worked, in brackets how many \
                        where not all; it is\nbold only if the model worked wherever any did.\n";
        if !reasons.is_empty() {
            sections[0] += &format!("\nWhy cells are empty:\n\n{reasons}");
        }
        sections.join("\n") + &self.against_best() + &self.structures()
    }

    /// Errors of the model that chooses, relative to the best of the others on the test data; empty without both.
    fn against_best(&self) -> String {
        let mut ratios = Vec::new();
        let mut rows = Vec::new();
        for case in &self.cases {
            let Some((chosen, name, best)) = chosen_and_best(case) else { continue };
            ratios.push(chosen / best);
            let cells =
                [format!("{chosen:.3}"), format!("{name} {best:.3}"), format!("{:.2}", chosen / best)];
            rows.push(row(&case.name, &cells));
        }
        if ratios.is_empty() {
            return String::new();
        }
        ratios.sort_by(f64::total_cmp);
        let place = (0.95 * (ratios.len() - 1) as f64).ceil() as usize;
        let heading = row("case", &[CHOOSES, "best other model, known from the test", "ratio"]);
        format!(
            "\n## {CHOOSES} beside the best other model\n\n{}\nGeometric mean of the ratios {:.2}, 95th percentile {:.2}, \
             largest {:.2}; {} cases.\n",
            in_words(&[vec![heading], rows].concat()),
            geometric_mean(&ratios),
            ratios[place],
            ratios[ratios.len() - 1],
            ratios.len()
        )
    }

    /// What was chosen in each case by the model that chooses; empty without it.
    fn structures(&self) -> String {
        let chosen = |case: &Case| -> Option<Vec<String>> {
            let answer = case.outcome.as_ref().ok()?.iter().find(|answer| answer.model == CHOOSES)?;
            let structure = answer.figures.as_ref().ok()?.structure.clone()?;
            Some(row(&case.name, &[structure]))
        };
        let rows: Vec<Vec<String>> = self.cases.iter().filter_map(chosen).collect();
        if rows.is_empty() {
            return String::new();
        }
        let heading = row("case", &["chosen"]);
        format!("\n## What {CHOOSES} chose\n\n{}", in_words(&[vec![heading], rows].concat()))
    }
}

/// Test error of the model that chooses, and the name and error of the best of the others.
fn chosen_and_best(case: &Case) -> Option<(f64, &str, f64)> {
    let answers = case.outcome.as_ref().ok()?;
    let errors = answers.iter().filter_map(|answer| {
        let error = answer.figures.as_ref().ok()?.test?;
        Some((answer.model.as_str(), error))
    });
    let (chosen, others): (Vec<_>, Vec<_>) = errors.partition(|(model, _)| *model == CHOOSES);
    let (_, chosen) = chosen.first()?;
    let (name, best) = others.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((*chosen, name, best))
}

#[cfg(test)]
mod tests {
    use super::super::answer::{Answer, Figures};
    use super::*;

    #[test]
    fn the_page_tells_where_it_comes_from_and_how_far_it_got() {
        let mut page = Page::new("2026-11-27, hysid 9.8.7:\n".into(), 2);
        let figures = Figures { test: Some(2.0), train: Some(1.0), seconds: Some(0.5), ..Figures::default() };
        let answer = |figures| Answer { model: "pnn".into(), figures };
        page.cases.push(Case { name: "a".into(), outcome: Ok(vec![answer(Ok(figures))]) });
        let text = page.text();
        assert!(text.contains(", hysid 9.8.7:\n"), "{text}");
        assert!(text.contains("1 of 2 cases (not finished), "), "{text}");
        assert!(text.contains("The data are not in this\nrepository."), "{text}");
        assert!(!text.contains("Why cells"), "{text}");
        let headings: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        assert_eq!(headings, TABLES.map(|(heading, _)| heading));

        page.cases.push(Case { name: "b".into(), outcome: Ok(vec![answer(Err("diverged".into()))]) });
        let text = page.text();
        assert!(text.contains("\n2 cases, each"), "{text}");
        assert_eq!(text.matches("1. diverged\n").count(), 1, "told once, below the first table: {text}");
        assert_eq!(text.matches(" – (1) |\n").count(), 3, "{text}");
    }

    #[test]
    fn the_choice_is_compared_with_the_best_other_model() {
        let mut page = Page::new(String::new(), 2);
        let answer = |model: &str, test: f64| {
            let figures = Figures { test: Some(test), ..Figures::default() };
            Answer { model: model.into(), figures: Ok(figures) }
        };
        let case = |name: &str, answers| Case { name: name.into(), outcome: Ok(answers) };
        page.cases.push(case("a", vec![answer("pnn", 4.0), answer("auto", 2.0), answer("gpnn", 8.0)]));
        page.cases.push(case("b", vec![answer("auto", 3.0), answer("pnn", 1.5)]));
        let text = page.text();
        assert!(text.contains("| a    | 2.000 | pnn 4.000                             | 0.50  |"), "{text}");
        assert!(
            text.contains("Geometric mean of the ratios 1.00, 95th percentile 2.00, largest 2.00; 2 cases."),
            "{text}"
        );
        let mut alone = Page::new(String::new(), 1);
        alone.cases.push(case("a", vec![answer("auto", 2.0)]));
        assert!(!alone.text().contains("best other model"), "{}", alone.text());
    }

    #[test]
    fn what_was_chosen_has_a_table_of_its_own() {
        let mut page = Page::new(String::new(), 2);
        let answer = |model: &str, structure: &str| {
            let figures = Figures { structure: Some(structure.into()), ..Figures::default() };
            Answer { model: model.into(), figures: Ok(figures) }
        };
        let case = |name: &str, answers| Case { name: name.into(), outcome: Ok(answers) };
        page.cases.push(case("a", vec![answer("pnn", "10 stops")]));
        assert!(!page.text().contains("chose"));
        page.cases
            .push(case("steel", vec![answer("pnn", "10 stops"), answer("auto", "3 of xpnn | 2 of gpnn")]));
        let expected = "\n## What auto chose\n\n\
            | case  | chosen                 |\n\
            | ----- | ---------------------- |\n\
            | steel | 3 of xpnn \\| 2 of gpnn |\n";
        assert!(page.text().ends_with(expected), "{}", page.text());
    }
}
