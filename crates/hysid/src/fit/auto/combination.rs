//! Combination of candidates: the weighted median of kinds, each the weighted median of its best candidates.
//! The same tree of weights predicts held-out data and, with members instead of candidates, is the ensemble.

use crate::data::metrics::Errors;
use crate::error::Result;
use crate::fit::auto::candidates::Kind;
use crate::fit::auto::prior::{self, Evidence};
use crate::fit::auto::score::{Score, weights};
use crate::fit::auto::trial::{HeldOut, Trial};
use crate::model::{
    Ensemble, Group, HeldOutRow, MedianBuffers, Model, Node, NodeKind, Weights, disagreement,
};
use crate::validation::PooledErrors;

/// Power `p` of the weights `(e^S / e^{S_best})^{-p}` among candidates of a kind (theory.md (11.6)), and the
/// number of candidates with a weight.
const POWER_IN_KIND: f64 = 8.0;
const MOST_IN_KIND: usize = 3;

/// The same among kinds.
const POWER_OF_KINDS: f64 = 3.0;

/// Share of the weight of its kind below which a candidate does not count.
const TOO_LITTLE: f64 = 0.02;

/// Candidates with their weights: a tree whose members are places among the trials.
#[derive(Debug, Clone)]
pub(super) struct Combination {
    group: Group,
}

impl Combination {
    /// Of the trials that are complete, weighted by the folds that are `counted`; `None` if no trial is
    /// complete.
    pub fn of(
        trials: &[Trial],
        folds: &[HeldOut],
        evidence: Evidence,
        counted: impl Fn(usize) -> bool + Copy,
    ) -> Option<Self> {
        let of_kind = |kind: &Kind| of_kind(*kind, trials, folds, evidence, counted);
        let kinds: Vec<Group> = Kind::ALL.iter().filter_map(of_kind).collect();
        let score = |kind: &Group| {
            let prior = |(place, share): &(usize, Weights)| share.inside * trials[*place].prior(evidence);
            let prior: f64 = kind.shares().iter().map(prior).sum();
            Score::of(&predictions(kind, trials, folds), folds, counted).with_prior(prior)
        };
        let scores: Vec<Score> = kinds.iter().map(score).collect();
        let power = match evidence {
            Evidence::SeveralLoops => POWER_OF_KINDS,
            Evidence::OneLoop => prior::POWER_OF_KINDS,
        };
        let weights = weights(&scores, power, kinds.len());
        let nodes = kinds.into_iter().zip(weights);
        let nodes = nodes.map(|(group, weights)| Node { weights, kind: NodeKind::Group(group) });
        Group { name: "all".into(), nodes: nodes.collect() }
            .map_members(&mut |place| Some(NodeKind::Member(place)))
            .map(|group| Self { group })
    }

    /// A single candidate.
    pub fn alone(kind: Kind, place: usize) -> Self {
        let node = |kind| Node { weights: Weights::equal(), kind };
        let kind = Group { name: kind.name().into(), nodes: vec![node(NodeKind::Member(place))] };
        Self { group: Group { name: "all".into(), nodes: vec![node(NodeKind::Group(kind))] } }
    }

    /// What each candidate counts in the whole, by its place.
    pub fn shares(&self) -> Vec<(usize, Weights)> {
        self.group.shares()
    }

    /// Only the candidates that are kept; `None` if these count nothing.
    pub fn only(&self, is_kept: impl Fn(usize) -> bool) -> Option<Self> {
        let mut keep = |place| is_kept(place).then_some(NodeKind::Member(place));
        self.group.map_members(&mut keep).map(|group| Self { group })
    }

    /// What it predicts of the rows of each fold.
    pub fn predictions(&self, trials: &[Trial], folds: &[HeldOut]) -> Vec<Vec<f64>> {
        predictions(&self.group, trials, folds)
    }

    /// Its score on all folds.
    pub fn score(&self, trials: &[Trial], folds: &[HeldOut]) -> Score {
        Score::of(&self.predictions(trials, folds), folds, |_| true)
    }

    /// Its errors on everything that was held out.
    pub fn validation(&self, trials: &[Trial], folds: &[HeldOut], output: &str) -> Option<Errors> {
        let mut pooled = PooledErrors::default();
        for (fold, predicted) in folds.iter().zip(self.predictions(trials, folds)) {
            pooled.add(&fold.fold.held_out, &predicted);
        }
        pooled.errors(output)
    }

    /// Fits of each candidate that its share asks for, of at most so many in all and so many starts.
    pub fn members_wanted(&self, trials: &[Trial], most: usize, starts: usize) -> Vec<usize> {
        let mut wanted = vec![0; trials.len()];
        for (place, share) in self.shares() {
            let fair = (share.inside.max(share.outside) * most as f64).ceil() as usize;
            let starts = if trials[place].candidate.is_random() { starts } else { 1 };
            wanted[place] = starts.min(fair.max(1));
        }
        wanted
    }

    /// Members of each candidate that are kept, at most `most` in all: the first of each candidate before the
    /// second of any, and those that count most before the others.
    pub fn members_kept(&self, trials: &[Trial], most: usize) -> Vec<usize> {
        let mut all: Vec<(usize, f64, usize)> = Vec::new();
        for (place, share) in self.shares() {
            let share = share.inside.max(share.outside);
            all.extend((0..trials[place].members.len()).map(|round| (round, share, place)));
        }
        all.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
        all.truncate(most);
        let mut kept = vec![0; trials.len()];
        all.into_iter().for_each(|(_, _, place)| kept[place] += 1);
        kept
    }

    /// The ensemble of so many models of each candidate.
    ///
    /// # Errors
    /// None that a combination of complete trials could cause.
    pub fn ensemble(
        &self,
        trials: &[Trial],
        models: impl Fn(usize) -> Vec<Model>,
        range: (f64, f64),
    ) -> Result<Ensemble> {
        let mut members: Vec<Model> = Vec::new();
        let mut of_candidate = |place: usize| {
            let nodes: Vec<Node> = models(place)
                .into_iter()
                .map(|model| {
                    members.push(model);
                    Node { weights: Weights::equal(), kind: NodeKind::Member(members.len() - 1) }
                })
                .collect();
            let name = trials[place].candidate.name();
            (!nodes.is_empty()).then_some(NodeKind::Group(Group { name, nodes }))
        };
        let group = self.group.map_members(&mut of_candidate);
        let nothing = || Group { name: "all".into(), nodes: Vec::new() };
        Ensemble::new(members, group.unwrap_or_else(nothing), range)
    }

    /// Rows of a fold with their errors and the disagreement of all starts of all candidates.
    pub fn rows(&self, trials: &[Trial], folds: &[HeldOut], fold: usize) -> Vec<HeldOutRow> {
        let held_out = &folds[fold];
        let mut starts: Vec<(usize, usize)> = Vec::new();
        let group = self.group.map_members(&mut |place| {
            let nodes = (0..trials[place].starts.len()).map(|start| {
                starts.push((place, start));
                Node { weights: Weights::equal(), kind: NodeKind::Member(starts.len() - 1) }
            });
            Some(NodeKind::Group(Group { name: String::new(), nodes: nodes.collect() }))
        });
        let Some(group) = group else { return Vec::new() };
        let mut medians = MedianBuffers::new(&group);
        let row = |row: usize| {
            let outside = held_out.outside[row];
            let of_start = |leaf: usize| {
                let (place, start) = starts[leaf];
                trials[place].starts[start][fold].predicted[row]
            };
            HeldOutRow {
                error: held_out.measured[row] - medians.output(&group, outside, of_start),
                disagreement: disagreement(medians.predictions(&group, outside, of_start)),
                outside,
                weight: 1.0 / held_out.measured.len() as f64,
            }
        };
        (0..held_out.measured.len()).map(row).collect()
    }
}

/// The best candidates of a kind with their weights; `None` if none is complete.
fn of_kind(
    kind: Kind,
    trials: &[Trial],
    folds: &[HeldOut],
    evidence: Evidence,
    counted: impl Fn(usize) -> bool + Copy,
) -> Option<Group> {
    let is_of_kind = |place: &usize| trials[*place].candidate.kind == kind && trials[*place].is_complete();
    let places: Vec<usize> = (0..trials.len()).filter(is_of_kind).collect();
    let score = |&place: &usize| {
        Score::of(&trials[place].predicted, folds, counted).with_prior(trials[place].prior(evidence))
    };
    let scores: Vec<Score> = places.iter().map(score).collect();
    let weights = weights(&scores, POWER_IN_KIND, MOST_IN_KIND);
    let sum = |weight: fn(&Weights) -> f64| weights.iter().map(weight).sum::<f64>();
    let (inside, outside) = (sum(|weights| weights.inside), sum(|weights| weights.outside));
    let counts =
        |weights: &Weights| weights.inside >= TOO_LITTLE * inside || weights.outside >= TOO_LITTLE * outside;
    let nodes = places.into_iter().zip(weights).filter(|(_, weights)| counts(weights));
    let nodes: Vec<Node> =
        nodes.map(|(place, weights)| Node { weights, kind: NodeKind::Member(place) }).collect();
    (!nodes.is_empty()).then(|| Group { name: kind.name().into(), nodes })
}

/// What a tree predicts of the rows of each fold.
fn predictions(group: &Group, trials: &[Trial], folds: &[HeldOut]) -> Vec<Vec<f64>> {
    let mut medians = MedianBuffers::new(group);
    let mut of_fold = |(fold, held_out): (usize, &HeldOut)| -> Vec<f64> {
        let row = |(row, &outside): (usize, &f64)| {
            medians.output(group, outside, |place| trials[place].predicted[fold][row])
        };
        held_out.outside.iter().enumerate().map(row).collect()
    };
    folds.iter().enumerate().map(&mut of_fold).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;
    use crate::data::record::{ColumnNames, Dataset, Record};
    use crate::fit::auto::candidates::Candidate;
    use crate::fit::identify;
    use crate::network::Family;
    use crate::options::FitSpec;
    use crate::options::classical::{ClassicalModel, ClassicalOptions};
    use crate::options::network::FitOptions;
    use crate::validation::folds;

    fn data() -> Dataset {
        let x: Vec<f64> =
            (0..120).map(|k| (0.2 * f64::from(k)).sin() * (0.2 + 0.01 * f64::from(k))).collect();
        let y = x.iter().map(|x| x * x * x).collect();
        Dataset::new(ColumnNames::plain(1), vec![Record::new("r", vec![x], y).unwrap()]).unwrap()
    }

    /// Trials of all kinds whose predictions are off by chance, inside and outside by factors of their own, with
    /// one to eight members.
    fn trials(model: &Model, folds: &[HeldOut], generator: &mut Xoshiro256PlusPlus) -> Vec<Trial> {
        let requests = [
            FitSpec::Network(FitOptions { model: Family::Xpnn, ..FitOptions::default() }),
            FitSpec::Classical(ClassicalOptions::of(ClassicalModel::RandomStops)),
            FitSpec::Classical(ClassicalOptions::of(ClassicalModel::Preisach)),
        ];
        let count = 1 + (generator.random::<u64>() % 14) as usize;
        let one = |_| {
            let request = &requests[(generator.random::<u64>() % 3) as usize];
            let mut off = || 10f64.powf(8.0 * generator.random::<f64>() - 6.0);
            let (inside, outside) = (off(), off());
            let mut trial = Trial::of(Candidate::alone(request));
            let predicted = folds.iter().map(|fold| {
                let rows = fold.measured.iter().zip(&fold.outside);
                rows.map(|(y, o)| y + if *o > 0.5 { outside } else { inside }).collect()
            });
            trial.predicted = predicted.collect();
            trial.starts = vec![Vec::new()];
            trial.members = vec![model.clone(); 1 + (generator.random::<u64>() % 8) as usize];
            trial
        };
        (0..count).map(one).collect()
    }

    /// However many members may stay, what stays is an ensemble that predicts.
    #[test]
    fn any_number_of_members_is_an_ensemble() {
        let data = data();
        let request = ClassicalOptions {
            operators: Some(3),
            ..ClassicalOptions::of(ClassicalModel::PrandtlIshlinskii)
        };
        let fitted = identify(&data, &FitSpec::Classical(request), &mut |_| ControlFlow::Continue(()));
        let model = fitted.unwrap().model;
        let folds: Vec<HeldOut> = folds(&data, 5).into_iter().map(HeldOut::of).collect();
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(7);
        for _ in 0..100 {
            let trials = trials(&model, &folds, &mut generator);
            let all = Combination::of(&trials, &folds, Evidence::SeveralLoops, |_| true).unwrap();
            for most in 1..=12 {
                let kept = all.members_kept(&trials, most);
                let having: usize = all.shares().iter().map(|(place, _)| trials[*place].members.len()).sum();
                assert_eq!(kept.iter().sum::<usize>(), most.min(having));
                let combination = all.only(|place| kept[place] > 0).unwrap();
                let members = |place: usize| trials[place].members[..kept[place]].to_vec();
                let ensemble = combination.ensemble(&trials, members, (-1.0, 1.0)).unwrap();
                assert_eq!(ensemble.members().len(), most.min(having));
                let shares = combination.shares();
                for share in [|weights: &Weights| weights.inside, |weights: &Weights| weights.outside] {
                    let sum: f64 = shares.iter().map(|(_, weights)| share(weights)).sum();
                    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
                }
                let predictions = combination.predictions(&trials, &folds);
                assert!(predictions.iter().flatten().all(|y| y.is_finite()));
                // Where its members say what was predicted of the folds, the ensemble answers what was validated.
                let of_member: Vec<usize> =
                    shares.iter().flat_map(|(place, _)| vec![*place; kept[*place]]).collect();
                let mut medians = MedianBuffers::new(ensemble.group());
                for (fold, (held_out, validated)) in folds.iter().zip(&predictions).enumerate() {
                    for (row, (&outside, validated)) in held_out.outside.iter().zip(validated).enumerate() {
                        let said = |member: usize| trials[of_member[member]].predicted[fold][row];
                        let answer = medians.output(ensemble.group(), outside, said);
                        let size = validated.abs().max(1.0);
                        assert!((answer - validated).abs() < 1e-9 * size, "{answer} and {validated}");
                    }
                }
            }
        }
    }
}
