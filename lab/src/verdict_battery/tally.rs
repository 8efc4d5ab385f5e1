//! Verdicts, judged and counted.

use std::collections::BTreeMap;

use super::answer::Finding;

/// What a verdict turned out to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    Right,
    Wrong,
    NotTestable,
}

impl Outcome {
    /// Of a verdict where this is the answer.
    pub fn of(said: Option<bool>, answer: bool) -> Self {
        match said {
            None => Self::NotTestable,
            Some(said) if said == answer => Self::Right,
            Some(_) => Self::Wrong,
        }
    }
}

/// A verdict that counts.
pub struct Verdict {
    pub law: &'static str,
    pub path: &'static str,
    pub disturbance: &'static str,
    pub property: &'static str,
    pub answer: bool,
    pub finding: Finding,
}

impl Verdict {
    pub fn outcome(&self) -> Outcome {
        Outcome::of(self.finding.verdict, self.answer)
    }
}

/// How many verdicts are right, wrong and not testable.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    pub right: usize,
    pub wrong: usize,
    pub not_testable: usize,
}

impl Tally {
    pub fn of<'v>(verdicts: impl Iterator<Item = &'v Verdict>) -> Self {
        let mut tally = Self::default();
        for verdict in verdicts {
            match verdict.outcome() {
                Outcome::Right => tally.right += 1,
                Outcome::Wrong => tally.wrong += 1,
                Outcome::NotTestable => tally.not_testable += 1,
            }
        }
        tally
    }

    /// Share of wrong among right and wrong in percent; none without any.
    pub fn percent_wrong(&self) -> Option<f64> {
        let decided = self.right + self.wrong;
        (decided > 0).then(|| 100.0 * self.wrong as f64 / decided as f64)
    }
}

/// Kinds of wrong verdicts: disturbance, property and law, with their number, the most frequent first.
pub fn kinds(verdicts: &[Verdict]) -> Vec<([&'static str; 3], usize)> {
    let mut counts: BTreeMap<[&'static str; 3], usize> = BTreeMap::new();
    for verdict in verdicts.iter().filter(|verdict| verdict.outcome() == Outcome::Wrong) {
        *counts.entry([verdict.disturbance, verdict.property, verdict.law]).or_default() += 1;
    }
    let mut kinds: Vec<_> = counts.into_iter().collect();
    // The sort is stable: equal numbers stay in the order of their names.
    kinds.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    kinds
}
