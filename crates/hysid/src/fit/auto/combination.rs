//! Combination of candidates: the weighted median of the best, each the median of its starts. The same tree of
//! weights predicts held-out data from the fits to folds and, with the fits of the same starts to everything, is
//! the ensemble.

use hysid_core::elementary::{exp, ln};

use crate::error::Result;
use crate::fit::auto::prior::{self, LoopEvidence};
use crate::fit::auto::score::{Score, weights};
use crate::fit::auto::trial::{FoldRows, HeldOut, Trial};
use crate::model::{
    Ensemble, Group, HeldOutRow, MedianBuffers, Model, Node, NodeKind, Provenance, Weights, disagreement,
};

/// Power `p` of the weights `(e^S / e^{S_best})^{-p}` (theory.md (11.6)), and number of candidates with a weight.
const POWER: f64 = 3.0;
const MOST_CANDIDATES: usize = 8;

/// Fewest starts of an ensemble: fewer are worse on data that no candidate fits well (docs/accuracy.md).
const FEWEST: usize = 5;

/// Largest error of fewer starts on held-out data, relative to that of all.
const WORTH: f64 = 1.01;

/// Share of the whole weight below which a candidate does not count.
const TOO_LITTLE: f64 = 0.02;

/// A start of a candidate: validated on the folds; its fit to all data is a member of the ensemble.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Leaf {
    /// Place of the candidate among the trials.
    pub place: usize,
    pub start: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Combination {
    group: Group,
    leaves: Vec<Leaf>,
}

impl Combination {
    /// Of the complete trials, weighted by the folds that are `counted`; `None` without a complete trial.
    pub fn of(
        trials: &[Trial],
        folds: &[HeldOut],
        evidence: LoopEvidence,
        counted: impl Fn(usize) -> bool + Copy,
    ) -> Option<Self> {
        let places: Vec<usize> = (0..trials.len()).filter(|&place| trials[place].is_complete()).collect();
        let scores: Vec<Score> =
            places.iter().map(|&place| trials[place].score(folds, evidence, counted)).collect();
        let power = match evidence {
            LoopEvidence::SeveralLoops => POWER,
            LoopEvidence::OneLoop(_) => prior::POWER,
        };
        let weights = weights(&scores, power, MOST_CANDIDATES);
        let sum = |weight: fn(&Weights) -> f64| weights.iter().map(weight).sum::<f64>();
        let (inside, outside) = (sum(|weights| weights.inside), sum(|weights| weights.outside));
        let counts = |weights: &Weights| {
            weights.inside >= TOO_LITTLE * inside || weights.outside >= TOO_LITTLE * outside
        };
        let nodes = places.into_iter().zip(weights).filter(|(_, weights)| counts(weights));
        let nodes = nodes.map(|(place, weights)| Node { weights, kind: NodeKind::Member(place) });
        let all = Group { name: "all".into(), nodes: nodes.collect() };
        let mut leaves = Vec::new();
        let group = all.map_members(&mut |place| {
            let nodes = (0..trials[place].starts.len()).map(|start| {
                leaves.push(Leaf { place, start });
                Node { weights: Weights::equal(), kind: NodeKind::Member(leaves.len() - 1) }
            });
            let nodes: Vec<Node> = nodes.collect();
            let name = trials[place].candidate.name();
            (!nodes.is_empty()).then_some(NodeKind::Group(Group { name, nodes }))
        })?;
        Some(Self { group, leaves })
    }

    /// The starts that count.
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// Starts of a candidate that count.
    pub fn members(&self, place: usize) -> usize {
        self.leaves.iter().filter(|leaf| leaf.place == place).count()
    }

    /// Weights of the candidates in the ensemble, each with the candidate's place.
    pub fn shares(&self) -> Vec<(usize, Weights)> {
        let mut shares: Vec<(usize, Weights)> = Vec::new();
        for (leaf, weights) in self.group.shares() {
            let place = self.leaves[leaf].place;
            match shares.iter_mut().find(|(other, _)| *other == place) {
                Some((_, sum)) => {
                    sum.inside += weights.inside;
                    sum.outside += weights.outside;
                }
                None => shares.push((place, weights)),
            }
        }
        shares
    }

    /// Only the leaves that are kept; `None` if these count nothing.
    pub fn only(&self, is_kept: impl Fn(Leaf) -> bool) -> Option<Self> {
        let mut leaves = Vec::new();
        let mut keep = |leaf: usize| {
            let leaf = self.leaves[leaf];
            is_kept(leaf).then(|| {
                leaves.push(leaf);
                NodeKind::Member(leaves.len() - 1)
            })
        };
        let group = self.group.map_members(&mut keep)?;
        Some(Self { group, leaves })
    }

    /// The error to be expected on loops that the data do not show: the geometric mean of those of its candidates.
    pub fn unseen_error(&self, trials: &[Trial], evidence: LoopEvidence) -> f64 {
        let of_candidate = |(place, share): (usize, Weights)| {
            share.inside * ln(trials[place].unseen_error(evidence).max(f64::MIN_POSITIVE))
        };
        if evidence.is_one_loop() {
            exp(self.shares().into_iter().map(of_candidate).sum::<f64>())
        } else {
            0.0
        }
    }

    /// Predictions of the ensemble for the rows of each fold.
    pub fn predictions(&self, trials: &[Trial], folds: &[HeldOut]) -> Vec<Vec<f64>> {
        let of_leaf = |leaf: usize, fold: usize, row: usize| self.predicted(trials, leaf, fold)[row];
        predictions(&self.group, of_leaf, folds)
    }

    fn predicted<'t>(&self, trials: &'t [Trial], leaf: usize, fold: usize) -> &'t [f64] {
        let Leaf { place, start } = self.leaves[leaf];
        &trials[place].starts[start][fold].predicted
    }

    /// Its score on all folds.
    pub fn score(&self, trials: &[Trial], folds: &[HeldOut]) -> Score {
        Score::of(&self.predictions(trials, folds), folds, |_| true)
    }

    /// The fewest leaves, at most `most`, whose error on the `counted` folds is at most 1 % above that of all.
    pub fn smallest(
        &self,
        trials: &[Trial],
        folds: &[HeldOut],
        evidence: LoopEvidence,
        counted: impl Fn(usize) -> bool + Copy,
        most: usize,
    ) -> Option<Self> {
        let error = |combination: &Self| {
            let score = Score::of(&combination.predictions(trials, folds), folds, counted);
            score.with_unseen(combination.unseen_error(trials, evidence)).sum() / 2.0
        };
        let enough = error(self) + ln(WORTH);
        let of_fewer = (FEWEST.min(most)..most).filter_map(|count| self.first(count));
        let mut of_fewer = of_fewer.filter(|fewer| error(fewer) <= enough);
        of_fewer.next().or_else(|| self.first(most))
    }

    /// The first `most` leaves: the first of each candidate before the second of any, by weight.
    pub fn first(&self, most: usize) -> Option<Self> {
        let share = |leaf: &Leaf| {
            let of_place = self.shares().into_iter().find(|(place, _)| *place == leaf.place);
            of_place.map_or(0.0, |(_, share)| share.inside.max(share.outside))
        };
        let mut order: Vec<(Leaf, f64)> = self.leaves.iter().map(|leaf| (*leaf, share(leaf))).collect();
        let by_place = |a: &Leaf, b: &Leaf| a.place.cmp(&b.place);
        order.sort_by(|(a, of_a), (b, of_b)| {
            a.start.cmp(&b.start).then(of_b.total_cmp(of_a)).then(by_place(a, b))
        });
        order.truncate(most);
        self.only(|leaf| order.iter().any(|(kept, _)| *kept == leaf))
    }

    /// The ensemble of the models of each leaf; leaves without a model are left out.
    pub fn ensemble(
        &self,
        model: impl Fn(usize, usize) -> Option<Model>,
        range: (f64, f64),
    ) -> Result<Ensemble> {
        let mut members: Vec<Model> = Vec::new();
        let mut of_leaf = |leaf: usize| {
            let Leaf { place, start } = self.leaves[leaf];
            model(place, start).map(|model| {
                // The history of its training tells nothing of the ensemble.
                let provenance = Provenance { runs: Vec::new(), ..model.provenance().clone() };
                members.push(model.with_provenance(provenance));
                NodeKind::Member(members.len() - 1)
            })
        };
        let group = self.group.map_members(&mut of_leaf);
        let nothing = || Group { name: "all".into(), nodes: Vec::new() };
        Ensemble::new(members, group.unwrap_or_else(nothing), range)
    }

    /// Rows of a fold with their errors and the disagreement of all leaves.
    pub fn rows(&self, trials: &[Trial], folds: &[HeldOut], fold: usize) -> Vec<HeldOutRow> {
        let FoldRows { measured, outside, .. } = &folds[fold].rows;
        let mut medians = MedianBuffers::new(&self.group);
        let row = |row: usize| {
            let of_leaf = |leaf: usize| self.predicted(trials, leaf, fold)[row];
            HeldOutRow {
                error: measured[row] - medians.output(&self.group, outside[row], of_leaf),
                disagreement: disagreement(medians.predictions(&self.group, outside[row], of_leaf)),
                outside: outside[row],
                weight: 1.0 / measured.len() as f64,
            }
        };
        (0..measured.len()).map(row).collect()
    }
}

/// Predictions of a tree for the rows of each fold; `of_member` gives those of a member, by fold and row.
fn predictions(
    group: &Group,
    of_member: impl Fn(usize, usize, usize) -> f64,
    folds: &[HeldOut],
) -> Vec<Vec<f64>> {
    let mut medians = MedianBuffers::new(group);
    let mut of_fold = |(fold, held_out): (usize, &HeldOut)| -> Vec<f64> {
        let row = |(row, &outside): (usize, &f64)| {
            medians.output(group, outside, |member| of_member(member, fold, row))
        };
        held_out.rows.outside.iter().enumerate().map(row).collect()
    };
    folds.iter().enumerate().map(&mut of_fold).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use hysid_core::elementary::{powf, sin};

    use super::*;
    use crate::data::record::{ColumnNames, Dataset, Record};
    use crate::fit::auto::candidates::Candidate;
    use crate::fit::auto::trial::FoldTrial;
    use crate::fit::one_model::identify;
    use crate::network::Family;
    use crate::options::FitSpec;
    use crate::options::classical::{ClassicalModel, ClassicalOptions};
    use crate::options::network::FitOptions;
    use crate::validation::folds;

    fn data() -> Dataset {
        let x: Vec<f64> = (0..120).map(|k| sin(0.2 * f64::from(k)) * (0.2 + 0.01 * f64::from(k))).collect();
        let y = x.iter().map(|x| x * x * x).collect();
        Dataset::new(ColumnNames::plain(1), vec![Record::new("r", vec![x], y).unwrap()]).unwrap()
    }

    /// Trials of all kinds, of one to three starts, with random errors inside and outside.
    fn trials(model: &Model, folds: &[HeldOut], generator: &mut Xoshiro256PlusPlus) -> Vec<Trial> {
        let requests = [
            FitSpec::Network(FitOptions { model: Family::Xpnn, ..FitOptions::default() }),
            FitSpec::Classical(ClassicalOptions::of(ClassicalModel::RandomStops)),
            FitSpec::Classical(ClassicalOptions::of(ClassicalModel::Preisach)),
        ];
        let count = 1 + (generator.random::<u64>() % 14) as usize;
        let one = |_| {
            let request = &requests[(generator.random::<u64>() % 3) as usize];
            let mut trial = Trial::of(Candidate::alone(request));
            for start in 0..=(generator.random::<u64>() % 3) as usize {
                let mut off = || powf(10.0, 8.0 * generator.random::<f64>() - 6.0);
                let (inside, outside) = (off(), off());
                let predicted = |fold: &HeldOut| {
                    let rows = fold.rows.measured.iter().zip(&fold.rows.outside);
                    rows.map(|(y, o)| y + if *o > 0.5 { outside } else { inside }).collect()
                };
                let of_folds = folds.iter().map(predicted);
                trial.add_start(
                    of_folds.map(|predicted| FoldTrial { model: model.clone(), predicted }).collect(),
                );
                trial.members.insert(start, model.clone());
            }
            trial
        };
        (0..count).map(one).collect()
    }

    /// However many members may stay, the result is the ensemble that was validated.
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
            let evidence = LoopEvidence::SeveralLoops;
            let all = Combination::of(&trials, &folds, evidence, |_| true).unwrap();
            let error = all.score(&trials, &folds).sum();
            for most in 1..=12 {
                let first = all.first(most).unwrap();
                assert_eq!(first.leaves().len(), most.min(all.leaves().len()));
                let smallest = all.smallest(&trials, &folds, evidence, |_| true, most).unwrap();
                let found = smallest.leaves().len();
                assert!(found <= most && found >= FEWEST.min(most).min(all.leaves().len()));
                if found < most.min(all.leaves().len()) {
                    let score = smallest.score(&trials, &folds).sum();
                    assert!(score <= error + 2.0 * ln(WORTH) + 1e-9, "{score} and {error}");
                }
                for combination in [first, smallest] {
                    let members = |place: usize, start: usize| trials[place].members.get(&start).cloned();
                    let ensemble = combination.ensemble(members, (-1.0, 1.0)).unwrap();
                    assert_eq!(ensemble.members().len(), combination.leaves().len());
                    let shares = combination.shares();
                    for share in [|weights: &Weights| weights.inside, |weights: &Weights| weights.outside] {
                        let sum: f64 = shares.iter().map(|(_, weights)| share(weights)).sum();
                        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
                    }
                    let predictions = combination.predictions(&trials, &folds);
                    assert!(predictions.iter().flatten().all(|y| y.is_finite()));
                    let mut medians = MedianBuffers::new(ensemble.group());
                    for (fold, (held_out, validated)) in folds.iter().zip(&predictions).enumerate() {
                        for (row, validated) in validated.iter().enumerate() {
                            let said = |member: usize| combination.predicted(&trials, member, fold)[row];
                            let answer = medians.output(ensemble.group(), held_out.rows.outside[row], said);
                            let size = validated.abs().max(1.0);
                            assert!((answer - validated).abs() < 1e-9 * size, "{answer} and {validated}");
                        }
                    }
                }
            }
        }
    }
}
