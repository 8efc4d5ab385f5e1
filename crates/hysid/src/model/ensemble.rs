//! Ensembles: several models that answer together by weighted medians.
//!
//! ```text
//! y = M(y_1 .. y_n; w_1 .. w_n),    w_i = a_i^{1-o} b_i^o                  theory.md (11.3), (11.4)
//! ```
//!
//! The median, not the mean: a single fit that runs away does not move it. Voices come in groups that first
//! agree among themselves (fits of one kind from several starts, kinds of one family), so that a kind does
//! not win by being many. A voice that is good inside the range it was trained on need not be good outside,
//! so it has two weights, and `o` tells how far outside the record has been.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::band::disagreement;
use crate::record::Excitation;

/// Share of the trained range by which the input must leave it until only the outer weights count.
/// Designed.
const WAY_OUT: f64 = 0.06;

/// Groups within groups, at most.
const DEEPEST: usize = 8;

/// Several models that answer together.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    members: Vec<Model>,
    group: Group,
    range: (f64, f64),
}

/// Voices that agree on one answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// What they have in common.
    pub name: String,
    /// Those who agree.
    pub voices: Vec<Voice>,
}

/// One that is heard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Voice {
    /// What it counts.
    pub weights: Weights,
    /// Who it is.
    pub who: Speaker,
}

/// Who is heard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Speaker {
    /// A member, by its place among all.
    Member(usize),
    /// The answer of a group.
    Group(Group),
}

/// What a voice counts in its group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// While the record stays in the trained range of the first input.
    pub inside: f64,
    /// Once the record has left it.
    pub outside: f64,
}

impl Weights {
    /// The same inside and outside.
    pub fn equal() -> Self {
        Self { inside: 1.0, outside: 1.0 }
    }

    /// The weight of a record that has been outside by this degree, 0 to 1: theory.md (11.4).
    pub(crate) fn at(&self, outside: f64) -> f64 {
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

    /// The weighted quantile, theory.md (11.3): each vote stands at the middle of its weight, and values
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
    /// A group without voices, a member that is not there, an ensemble as a member, members of different
    /// inputs, weights that are negative, not finite or all 0.
    pub fn new(members: Vec<Model>, group: Group, range: (f64, f64)) -> Result<Self> {
        group.check(members.len(), DEEPEST)?;
        if members.iter().any(|member| member.ensemble().is_some()) {
            return Err(Error::Option("an ensemble cannot be a member of another".into()));
        }
        if members.iter().any(|member| member.inputs() != members[0].inputs()) {
            return Err(Error::Option("the members of an ensemble do not have the same inputs".into()));
        }
        if !(range.0 < range.1 && range.0.is_finite() && range.1.is_finite()) {
            return Err(Error::Option("the range of an ensemble's input is no range".into()));
        }
        Ok(Self { members, group, range })
    }

    /// The group of all.
    pub fn group(&self) -> &Group {
        &self.group
    }

    /// All models.
    pub fn members(&self) -> &[Model] {
        &self.members
    }

    /// Range of the first input beyond which the outer weights count, in its unit.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// True if it matters that a record has once left the range.
    pub(crate) fn remembers_excursions(&self) -> bool {
        self.group.remembers_excursions()
    }

    pub(super) fn simulate(&self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        let mut council = Council::new(&self.group);
        let mut excursion = Excursion::beyond(self.range);
        let outputs = self.outputs(excitation)?;
        let row = |(row, &x): (usize, &f64)| {
            let outside = excursion.take(x);
            council.output(&self.group, outside, |member| outputs[member][row])
        };
        Ok(excitation.inputs()[0].iter().enumerate().map(row).collect())
    }

    /// What the members say of each row of an excitation.
    pub(super) fn answers(&self, excitation: &Excitation<'_>) -> Result<Vec<Answer>> {
        let mut council = Council::new(&self.group);
        let mut excursion = Excursion::beyond(self.range);
        let outputs = self.outputs(excitation)?;
        let row = |(row, &x): (usize, &f64)| {
            let outside = excursion.take(x);
            let output = council.output(&self.group, outside, |member| outputs[member][row]);
            let all = council.everybody(&self.group, outside, |member| outputs[member][row]);
            Answer { output, disagreement: disagreement(all), outside }
        };
        Ok(excitation.inputs()[0].iter().enumerate().map(row).collect())
    }

    fn outputs(&self, excitation: &Excitation<'_>) -> Result<Vec<Vec<f64>>> {
        self.members.iter().map(|member| member.response(excitation)).collect()
    }
}

impl Group {
    fn check(&self, members: usize, deepest: usize) -> Result<()> {
        if self.voices.is_empty() {
            return Err(Error::Option("an ensemble needs at least one member".into()));
        }
        if deepest == 0 {
            return Err(Error::Option("the groups of an ensemble are nested too deeply".into()));
        }
        for weight in [|weights: &Weights| weights.inside, |weights: &Weights| weights.outside] {
            let all = self.voices.iter().map(|voice| weight(&voice.weights));
            if !all.clone().all(|weight| (0.0..=1e9).contains(&weight)) || all.sum::<f64>() < 1e-9 {
                return Err(Error::Option("the weights of an ensemble are no weights".into()));
            }
        }
        for voice in &self.voices {
            match &voice.who {
                Speaker::Group(group) => group.check(members, deepest - 1)?,
                Speaker::Member(member) if *member < members => {}
                Speaker::Member(member) => {
                    return Err(Error::Option(format!("an ensemble of {members} has no member {member}")));
                }
            }
        }
        Ok(())
    }

    fn remembers_excursions(&self) -> bool {
        // Only the proportions of the weights count.
        let first = self.voices[0].weights;
        self.voices.iter().any(|Voice { weights, who }| {
            weights.inside * first.outside != weights.outside * first.inside
                || matches!(who, Speaker::Group(group) if group.remembers_excursions())
        })
    }

    fn depth(&self) -> usize {
        let of_voice = |voice: &Voice| match &voice.who {
            Speaker::Member(_) => 0,
            Speaker::Group(group) => group.depth(),
        };
        1 + self.voices.iter().map(of_voice).max().unwrap_or_default()
    }

    /// What the group answers; `levels` has room for the votes of this group and of those below.
    fn answer(&self, outside: f64, of_member: &impl Fn(usize) -> f64, levels: &mut [Votes]) -> f64 {
        let Some((votes, deeper)) = levels.split_first_mut() else { return f64::NAN };
        votes.clear();
        for voice in &self.voices {
            let value = match &voice.who {
                Speaker::Member(member) => of_member(*member),
                Speaker::Group(group) => group.answer(outside, of_member, deeper),
            };
            votes.cast(value, voice.weights.at(outside));
        }
        votes.quantile(0.5)
    }

    /// Casts the votes of all members below, which share out `share`.
    fn gather(&self, outside: f64, share: f64, of_member: &impl Fn(usize) -> f64, all: &mut Votes) {
        let sum: f64 = self.voices.iter().map(|voice| voice.weights.at(outside)).sum();
        for voice in &self.voices {
            let share = share * voice.weights.at(outside) / sum;
            match &voice.who {
                Speaker::Member(member) => all.cast(of_member(*member), share),
                Speaker::Group(group) => group.gather(outside, share, of_member, all),
            }
        }
    }
}

/// Room to hear all voices of a row in.
#[derive(Debug, Clone)]
pub(crate) struct Council {
    /// Votes of the group that is being heard, at each depth.
    levels: Vec<Votes>,
    /// Votes of all members, each with what it counts in the whole.
    all: Votes,
}

impl Council {
    pub fn new(group: &Group) -> Self {
        Self { levels: vec![Votes::default(); group.depth()], all: Votes::default() }
    }

    /// What all answer together where each member says `of_member`.
    pub fn output(&mut self, group: &Group, outside: f64, of_member: impl Fn(usize) -> f64) -> f64 {
        group.answer(outside, &of_member, &mut self.levels)
    }

    /// The votes of all members.
    pub fn everybody(&mut self, group: &Group, outside: f64, of_member: impl Fn(usize) -> f64) -> &mut Votes {
        self.all.clear();
        group.gather(outside, 1.0, &of_member, &mut self.all);
        &mut self.all
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
