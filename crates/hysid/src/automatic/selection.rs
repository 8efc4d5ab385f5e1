//! What was tried, how it did, and what came of it: kept in the model file.

use serde::{Deserialize, Serialize};

use crate::automatic::choice::Score;
use crate::automatic::jury::Jury;
use crate::automatic::trials::Judge;
use crate::model::Weights;
use crate::warning::Significant;

/// How candidates did on data held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// What was held out, fold by fold, in words.
    pub folds: Vec<String>,
    /// Error of all together, in percent of the standard deviation: geometric mean over the folds, of rows
    /// inside the trained range and of rows beyond it (theory.md 11.5).
    pub error_percent: (f64, f64),
    /// The candidates, the best of each kind first.
    pub candidates: Vec<CandidateResult>,
}

/// How a candidate did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CandidateResult {
    /// What it is.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Its error, as that of all together.
    pub error_percent: (f64, f64),
    /// What it counts in the whole, as a share of all.
    pub share: Weights,
    /// Fits of it in the model.
    pub members: usize,
    /// Error of all together without it; `None` if it does not count.
    pub without_percent: Option<(f64, f64)>,
}

fn percent(score: Score) -> (f64, f64) {
    (100.0 * score.inside.exp(), 100.0 * score.outside.exp())
}

impl Selection {
    /// Of a jury of which so many members answer, at most.
    pub(super) fn of(jury: &Jury, judges: &[Judge], most: usize) -> Self {
        let kept = jury.members_kept(most);
        let score = |without: Option<(usize, usize)>| {
            let foretold: Vec<Vec<f64>> =
                judges.iter().enumerate().map(|(fold, judge)| jury.foretold(fold, judge, without)).collect();
            percent(Score::of(&foretold, judges))
        };
        let sum = |weight: fn(&Weights) -> f64, of: &mut dyn Iterator<Item = Weights>| -> f64 {
            of.map(|weights| weight(&weights)).sum::<f64>().max(f64::MIN_POSITIVE)
        };
        let voices = jury.panels.iter().map(|panel| panel.voices().count()).sum::<usize>();
        let kinds = (
            sum(|weights| weights.inside, &mut jury.weights.iter().copied()),
            sum(|weights| weights.outside, &mut jury.weights.iter().copied()),
        );
        let mut candidates = Vec::new();
        for (place, (panel, kind)) in jury.panels.iter().zip(&jury.weights).enumerate() {
            let inside = sum(|weights| weights.inside, &mut panel.panelists.iter().map(|one| one.weights));
            let outside = sum(|weights| weights.outside, &mut panel.panelists.iter().map(|one| one.weights));
            let mut of_kind: Vec<CandidateResult> = panel
                .panelists
                .iter()
                .enumerate()
                .map(|(of_panel, panelist)| CandidateResult {
                    name: panelist.candidate.name(),
                    kind: panel.kind.name().into(),
                    error_percent: percent(panelist.score),
                    share: Weights {
                        inside: kind.inside / kinds.0 * panelist.weights.inside / inside,
                        outside: kind.outside / kinds.1 * panelist.weights.outside / outside,
                    },
                    members: kept.iter().filter(|one| **one == (place, of_panel)).count(),
                    without_percent: (panelist.counts() && voices > 1)
                        .then(|| score(Some((place, of_panel)))),
                })
                .collect();
            of_kind.sort_by(|a, b| a.error_percent.0.total_cmp(&b.error_percent.0));
            candidates.extend(of_kind);
        }
        let folds = judges.iter().map(|judge| judge.fold.name.clone()).collect();
        Self { folds, error_percent: score(None), candidates }
    }

    /// What was chosen and why, in two lines.
    pub fn summary(&self) -> [String; 2] {
        let count = |kind: &str| -> usize {
            self.candidates.iter().filter(|one| one.kind == kind).map(|one| one.members).sum()
        };
        let mut kinds: Vec<&str> = self.candidates.iter().map(|one| one.kind.as_str()).collect();
        kinds.dedup();
        let parts: Vec<String> = kinds
            .iter()
            .filter(|kind| count(kind) > 0)
            .map(|kind| format!("{} {kind}", count(kind)))
            .collect();
        let most = self.candidates.iter().max_by(|a, b| a.share.inside.total_cmp(&b.share.inside));
        let leading = most.map_or_else(String::new, |one| format!("; most counts {}", one.name));
        let best_of = |kind: &&str| {
            let of_kind = self.candidates.iter().filter(|one| one.kind == **kind);
            let best = of_kind.min_by(|a, b| a.error_percent.0.total_cmp(&b.error_percent.0))?;
            Some(format!("{} {:.3} %", best.name, Significant(best.error_percent.0)))
        };
        let bests: Vec<String> = kinds.iter().filter_map(best_of).collect();
        [
            format!("the weighted median of {}{leading}", parts.join(", ")),
            format!(
                "on data held out {:.3} % of std; alone {}",
                Significant(self.error_percent.0),
                bests.join(", ")
            ),
        ]
    }
}
