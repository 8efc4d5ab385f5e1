//! The tables as a page in Markdown, with where they come from.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use super::answer::Case;
use super::request::Request;
use super::table::{Measure, Reasons, table};
use crate::workspace_root;

/// The tables under their headings.
const TABLES: [(&str, Measure); 3] = [
    ("Test: NRMSE of a free run, % of std", |figures| figures.test),
    ("Training: NRMSE of a free run, % of std", |figures| figures.train),
    ("Seconds to fit", |figures| figures.seconds),
];

/// All that is known so far.
pub struct Page {
    /// The cases that are done.
    pub cases: Vec<Case>,
    asked: usize,
    /// Date, version and command.
    origin: String,
}

impl Page {
    /// The page of so many cases before the first is done. `version` is what the program says of itself.
    pub fn new(request: &Request, version: String, cases: usize) -> Self {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
        // Of another program than the one built here the revision is unknown.
        let revision = request.program.is_none().then(revision).flatten();
        let revision = revision.map_or_else(String::new, |revision| format!(" ({revision})"));
        let command: Vec<String> = request.typed.iter().map(|word| quoted(word)).collect();
        let origin = format!(
            "{}, {version}{revision}:\n\n```sh\ncargo xtask cases {}\n```\n",
            date(seconds),
            command.join(" ")
        );
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
        sections.join("\n")
    }
}

/// The revision of the working copy, if git knows it.
fn revision() -> Option<String> {
    let git = Command::new("git")
        .args(["describe", "--always", "--dirty"])
        .current_dir(workspace_root())
        .output()
        .ok()
        .filter(|git| git.status.success())?;
    Some(String::from_utf8_lossy(&git.stdout).trim().to_owned())
}

/// A word as an argument of a shell command.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The day (UTC) so many seconds after the beginning of 1970.
fn date(seconds: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    let (mut days, mut year) = (seconds / 86_400, 1970);
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::super::answer::{Answer, Figures};
    use super::*;

    /// Computed with `date -u -d @SECONDS +%F`.
    #[test]
    fn days_of_common_and_leap_years() {
        for (seconds, day) in [
            (0, "1970-01-01"),
            (951_782_399, "2000-02-28"),
            (951_782_400, "2000-02-29"),
            (1_735_689_599, "2024-12-31"),
            (1_735_689_600, "2025-01-01"),
            (1_795_219_200, "2026-11-21"),
        ] {
            assert_eq!(date(seconds), day);
        }
    }

    #[test]
    fn the_page_tells_where_it_comes_from_and_how_far_it_got() {
        let typed = ["my data", "--models", "pnn,xpnn", "--program", "hysid"];
        let request = Request::parse(&typed).unwrap();
        let mut page = Page::new(&request, "hysid 9.8.7".into(), 2);
        let figures = Ok(Figures { test: Some(2.0), train: Some(1.0), seconds: Some(0.5) });
        let answer = |figures| Answer { model: "pnn".into(), figures };
        page.cases.push(Case { name: "a".into(), outcome: Ok(vec![answer(figures)]) });
        let text = page.text();
        assert!(text.contains(", hysid 9.8.7:\n"), "{text}");
        assert!(text.contains("cargo xtask cases 'my data' --models pnn,xpnn --program hysid\n"), "{text}");
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
}
