//! Ensembles: several models that answer together by their weighted median.
//!
//! ```text
//! y = M(y_1 .. y_n; w_1 .. w_n),    w_i = a_i^{1-o} b_i^o                  theory.md (11.2), (11.3)
//! ```
//!
//! The median, not the mean: a single fit that runs away does not move it. A member that is good inside the
//! range it was trained on need not be good outside, so it has two weights, and `o` tells how far outside
//! the record has been.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::band::disagreement;
use crate::record::Record;

/// Share of the trained range by which the input must leave it until only the outer weights count.
/// Designed.
const WAY_OUT: f64 = 0.06;

/// Several models that answer together.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    members: Vec<Member>,
    range: (f64, f64),
}

/// A model in an ensemble.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The model.
    pub model: Model,
    /// Its weights.
    pub weights: Weights,
}

/// What a member counts, next to 1 for the best of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// While the record stays in the trained range of the first input.
    pub inside: f64,
    /// Once the record has left it.
    pub outside: f64,
}

impl Weights {
    /// The weight of a record that has been outside by this degree, 0 to 1: theory.md (11.3).
    pub(super) fn at(&self, outside: f64) -> f64 {
        if outside == 0.0 {
            self.inside
        } else if outside == 1.0 {
            self.outside
        } else {
            self.inside.powf(1.0 - outside) * self.outside.powf(outside)
        }
    }
}

/// How far outside the trained range a record has been.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Excursion {
    range: (f64, f64),
    farthest: f64,
}

impl Excursion {
    pub fn beyond(range: (f64, f64)) -> Self {
        Self { range, farthest: 0.0 }
    }

    /// Takes the next input; 0 for always inside, 1 for fully outside.
    pub fn take(&mut self, x: f64) -> f64 {
        let (low, high) = self.range;
        self.farthest = self.farthest.max(low - x).max(x - high);
        (self.farthest / (WAY_OUT * (high - low))).clamp(0.0, 1.0)
    }
}

/// Value and weight of each member, and room to sort them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Votes(Vec<(f64, f64)>);

impl Votes {
    pub fn clear(&mut self) {
        self.0.clear();
    }

    pub fn cast(&mut self, value: f64, weight: f64) {
        self.0.push((value, weight));
    }

    /// The weighted quantile, theory.md (11.2): each vote stands at the middle of its weight, and values
    /// between are interpolated. With equal weights, `quantile(0.5)` is the ordinary median.
    pub fn quantile(&mut self, level: f64) -> f64 {
        self.0.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let wanted = level * self.0.iter().map(|(_, weight)| weight).sum::<f64>();
        let (mut passed, mut below) = (0.0, None::<(f64, f64)>);
        for &(value, weight) in &self.0 {
            if weight == 0.0 {
                continue;
            }
            let place = passed + 0.5 * weight;
            if place >= wanted {
                return match below {
                    Some((before, low)) => low + (value - low) * ((wanted - before) / (place - before)),
                    None => value,
                };
            }
            below = Some((place, value));
            passed += weight;
        }
        below.map_or(f64::NAN, |(_, value)| value)
    }
}

impl Ensemble {
    /// An ensemble of models of the same columns. `range` is that of the first input over all data they
    /// were trained on.
    ///
    /// # Errors
    /// No member, an ensemble as a member, members of different inputs, weights that are negative, not
    /// finite or all 0.
    pub fn new(members: Vec<Member>, range: (f64, f64)) -> Result<Self> {
        let Some(first) = members.first() else {
            return Err(Error::Option("an ensemble needs at least one member".into()));
        };
        let inputs = first.model.inputs();
        if members.iter().any(|member| member.model.ensemble().is_some()) {
            return Err(Error::Option("an ensemble cannot be a member of another".into()));
        }
        if members.iter().any(|member| member.model.inputs() != inputs) {
            return Err(Error::Option("the members of an ensemble do not have the same inputs".into()));
        }
        for weight in [|weights: &Weights| weights.inside, |weights: &Weights| weights.outside] {
            let all: Vec<f64> = members.iter().map(|member| weight(&member.weights)).collect();
            let is_sound = all.iter().all(|weight| (0.0..=1e9).contains(weight));
            if !is_sound || all.iter().sum::<f64>() < 1e-9 {
                return Err(Error::Option("the weights of an ensemble are no weights".into()));
            }
        }
        if !(range.0 < range.1 && range.0.is_finite() && range.1.is_finite()) {
            return Err(Error::Option("the range of an ensemble's input is no range".into()));
        }
        Ok(Self { members, range })
    }

    /// The members, in the order of their weights.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Range of the first input beyond which the outer weights count, in its unit.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    pub(super) fn simulate(&self, record: &Record) -> Result<Vec<f64>> {
        self.hear(record, |votes, _| votes.quantile(0.5))
    }

    /// What the members say of each row of a record.
    pub(super) fn answers(&self, record: &Record) -> Result<Vec<Answer>> {
        self.hear(record, |votes, outside| Answer {
            output: votes.quantile(0.5),
            disagreement: disagreement(votes),
            outside,
        })
    }

    /// Asks all members about every row.
    fn hear<T>(&self, record: &Record, mut conclude: impl FnMut(&mut Votes, f64) -> T) -> Result<Vec<T>> {
        let outputs: Vec<Vec<f64>> =
            self.members.iter().map(|member| member.model.simulate(record)).collect::<Result<_>>()?;
        let mut excursion = Excursion::beyond(self.range);
        let mut votes = Votes::default();
        let row = |(row, &x): (usize, &f64)| {
            let outside = excursion.take(x);
            votes.clear();
            for (member, output) in self.members.iter().zip(&outputs) {
                votes.cast(output[row], member.weights.at(outside));
            }
            conclude(&mut votes, outside)
        };
        Ok(record.inputs()[0].iter().enumerate().map(row).collect())
    }
}

/// What the members of an ensemble say of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Answer {
    pub output: f64,
    pub disagreement: f64,
    /// Degree of having been outside the trained range, 0 to 1.
    pub outside: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantile(votes: &[(f64, f64)], level: f64) -> f64 {
        Votes(votes.to_vec()).quantile(level)
    }

    #[test]
    fn equal_weights_give_the_ordinary_median() {
        assert_eq!(quantile(&[(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)], 0.5), 2.0);
        assert_eq!(quantile(&[(4.0, 0.5), (1.0, 0.5), (2.0, 0.5), (8.0, 0.5)], 0.5), 3.0);
        assert_eq!(quantile(&[(5.0, 0.3)], 0.5), 5.0);
    }

    #[test]
    fn a_vote_without_weight_counts_nothing_and_one_with_most_decides() {
        assert_eq!(quantile(&[(-9.0, 0.0), (1.0, 1.0), (9.0, 0.0)], 0.5), 1.0);
        let near = quantile(&[(0.0, 1.0), (1.0, 1e-9), (-1.0, 1e-9)], 0.5);
        assert!(near.abs() < 1e-8, "{near}");
        assert_eq!(quantile(&[(1.0, 1.0), (1e300, 1.0), (2.0, 1.0)], 0.5), 2.0);
    }

    #[test]
    fn quantiles_rise_with_their_level_and_stay_among_the_votes() {
        let votes = [(3.0, 0.2), (-1.0, 1.0), (0.5, 0.7), (2.0, 0.1)];
        let mut last = f64::NEG_INFINITY;
        for percent in 0..=100 {
            let value = quantile(&votes, f64::from(percent) / 100.0);
            assert!(value >= last && (-1.0..=3.0).contains(&value), "{percent}: {value} after {last}");
            last = value;
        }
    }

    #[test]
    fn once_outside_stays_outside() {
        let mut excursion = Excursion::beyond((-1.0, 1.0));
        assert_eq!(excursion.take(1.0), 0.0);
        let halfway = excursion.take(1.0 + WAY_OUT);
        assert!((halfway - 0.5).abs() < 1e-12, "{halfway}");
        assert_eq!(excursion.take(0.0), halfway);
        assert_eq!(excursion.take(-5.0), 1.0);
        let weights = Weights { inside: 1.0, outside: 0.01 };
        assert!((weights.at(halfway) - 0.1).abs() < 1e-12);
    }
}
