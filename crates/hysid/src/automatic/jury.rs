//! The panels of all kinds, and what they answer together.

use crate::automatic::POWER_OF_KINDS;
use crate::automatic::choice::{Score, medians, weights};
use crate::automatic::panel::{Panel, Panelist};
use crate::automatic::trials::Judge;
use crate::error::Result;
use crate::metrics::{ErrorSums, Errors};
use crate::model::{Ensemble, Group, HeldOutRow, Model, Speaker, Voice, Votes, Weights, disagreement};

/// All panels with what each counts.
pub(super) struct Jury {
    pub panels: Vec<Panel>,
    pub weights: Vec<Weights>,
}

impl Jury {
    /// Panels that were judged, or a single one that was not.
    pub fn of(panels: Vec<Panel>, judges: &[Judge]) -> Self {
        let scores: Vec<Score> = panels.iter().map(|panel| Score::of(&panel.foretold, judges)).collect();
        let weights = weights(&scores, POWER_OF_KINDS, panels.len());
        Self { panels, weights }
    }

    /// What all answer together on a fold; without one candidate, if its place is given by panel and
    /// panelist.
    pub fn foretold(&self, fold: usize, judge: &Judge, without: Option<(usize, usize)>) -> Vec<f64> {
        let mut voices: Vec<Vec<f64>> = Vec::new();
        let mut weights = Vec::new();
        for (place, (panel, weight)) in self.panels.iter().zip(&self.weights).enumerate() {
            let is_heard =
                |panelist: &&(usize, &Panelist)| panelist.1.counts() && without != Some((place, panelist.0));
            let all: Vec<(usize, &Panelist)> = panel.panelists.iter().enumerate().collect();
            let heard: Vec<&(usize, &Panelist)> = all.iter().filter(is_heard).collect();
            if heard.is_empty() {
                continue;
            }
            let of_fold: Vec<&[f64]> = heard.iter().map(|one| one.1.foretold[fold].as_slice()).collect();
            let inner: Vec<Weights> = heard.iter().map(|one| one.1.weights).collect();
            voices.push(medians(&of_fold, &inner, &judge.outside));
            weights.push(*weight);
        }
        let slices: Vec<&[f64]> = voices.iter().map(Vec::as_slice).collect();
        medians(&slices, &weights, &judge.outside)
    }

    /// Errors on everything that was held out; of a single record, rows are in several folds.
    pub fn validation(&self, judges: &[Judge], output: &str) -> Option<Errors> {
        let mut sums = ErrorSums::default();
        for (fold, judge) in judges.iter().enumerate() {
            sums.add(&judge.measured, &self.foretold(fold, judge, None));
        }
        sums.errors(output)
    }

    /// Every row held out with its error and the disagreement of all starts of all candidates.
    pub fn rows_held_out(&self, judges: &[Judge]) -> Vec<HeldOutRow> {
        let mut rows = Vec::new();
        let mut votes = Votes::default();
        for (fold, judge) in judges.iter().enumerate() {
            let foretold = self.foretold(fold, judge, None);
            for (row, (foretold, measured)) in foretold.iter().zip(&judge.measured).enumerate() {
                let outside = judge.outside[row];
                votes.clear();
                let kinds: f64 = self.weights.iter().map(|weights| weights.at(outside)).sum();
                for (panel, of_kind) in self.panels.iter().zip(&self.weights) {
                    let all: f64 = panel.voices().map(|voice| voice.weights.at(outside)).sum();
                    for voice in panel.voices() {
                        let starts = &voice.trial.folds[fold];
                        let share = of_kind.at(outside) / kinds * voice.weights.at(outside) / all;
                        starts.iter().for_each(|start| votes.cast(start[row], share / starts.len() as f64));
                    }
                }
                rows.push(HeldOutRow {
                    error: measured - foretold,
                    disagreement: disagreement(&mut votes),
                    outside,
                    weight: 1.0 / judge.measured.len() as f64,
                });
            }
        }
        rows
    }

    /// The fits to everything, at most so many of them, as an ensemble.
    ///
    /// # Errors
    /// None that the panels could cause.
    pub fn ensemble(&self, most: usize, range: (f64, f64)) -> Result<Ensemble> {
        let kept = self.members_kept(most);
        let mut members: Vec<Model> = Vec::new();
        let mut kinds = Vec::new();
        for (place, (panel, weights)) in self.panels.iter().zip(&self.weights).enumerate() {
            let mut candidates = Vec::new();
            for (of_panel, panelist) in panel.panelists.iter().enumerate() {
                let count = kept.iter().filter(|one| **one == (place, of_panel)).count();
                if count == 0 {
                    continue;
                }
                let voices = panelist.members[..count].iter().map(|model| {
                    members.push(model.clone());
                    Voice { weights: Weights::equal(), who: Speaker::Member(members.len() - 1) }
                });
                let group = Group { name: panelist.candidate.name(), voices: voices.collect() };
                candidates.push(Voice { weights: panelist.weights, who: Speaker::Group(group) });
            }
            if !candidates.is_empty() {
                let group = Group { name: panel.kind.name().into(), voices: candidates };
                kinds.push(Voice { weights: *weights, who: Speaker::Group(group) });
            }
        }
        Ensemble::new(members, Group { name: "all".into(), voices: kinds }, range)
    }

    /// Panel and panelist of each member that is kept: the first of each candidate before the second of
    /// any, and those that count most before the others.
    pub fn members_kept(&self, most: usize) -> Vec<(usize, usize)> {
        let mut all: Vec<(usize, f64, (usize, usize))> = Vec::new();
        for (place, (panel, kind)) in self.panels.iter().zip(&self.weights).enumerate() {
            for (of_panel, panelist) in panel.panelists.iter().enumerate().filter(|(_, one)| one.counts()) {
                let inside = kind.inside * panelist.weights.inside;
                let outside = kind.outside * panelist.weights.outside;
                let places =
                    (0..panelist.members.len()).map(|round| (round, inside.max(outside), (place, of_panel)));
                all.extend(places);
            }
        }
        all.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
        all.truncate(most);
        all.into_iter().map(|(_, _, place)| place).collect()
    }
}
