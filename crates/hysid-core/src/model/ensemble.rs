//! Ensembles: several models that answer together by weighted medians.
//!
//! ```text
//! y = M(y_1 .. y_n; w_1 .. w_n),    w_i = a_i^{1-o} b_i^o                  theory.md (11.3), (11.4)
//! w_i = (1-o) a_i/Σa + o b_i/Σb           where that is 0 for all i          theory.md (11.9)
//! ```
//!
//! The median, not the mean: a single fit that runs away does not move it. Voices come in groups that first
//! agree among themselves (fits of one kind from several starts, kinds of one family), so that a kind does
//! not win by being many. A voice that is good inside the range it was trained on need not be good outside,
//! so it has two weights, and `o` tells how far outside the record has been.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::Model;

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
pub struct Excursion {
    range: (f64, f64),
    farthest: f64,
}

impl Excursion {
    /// Beyond this range, at the beginning of a record.
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
pub struct Votes(Vec<(f64, f64)>);

impl Votes {
    /// Forgets all values.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds the value of a member with its weight.
    pub fn cast(&mut self, value: f64, weight: f64) {
        self.0.push((value, weight));
    }

    /// Gives the votes other weights, in the order in which they were cast.
    fn weigh_anew(&mut self, weights: impl Iterator<Item = f64>) {
        self.0.iter_mut().zip(weights).for_each(|(vote, weight)| vote.1 = weight);
    }

    /// Weight of all together.
    fn weight(&self) -> f64 {
        self.0.iter().map(|(_, weight)| weight).sum()
    }

    /// The weighted quantile, theory.md (11.3): each vote stands at the middle of its weight, and values
    /// between are interpolated. With equal weights, `quantile(0.5)` is the ordinary median.
    pub fn quantile(&mut self, level: f64) -> f64 {
        self.0.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let wanted = level * self.weight();
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
    /// inputs, weights that are negative, not finite or all 0, inside and outside.
    pub fn new(mut members: Vec<Model>, group: Group, range: (f64, f64)) -> Result<Self> {
        group.check(members.len(), DEEPEST)?;
        if members.iter().any(|member| member.ensemble().is_some()) {
            return Err(Error::Parts("an ensemble cannot be a member of another".into()));
        }
        if members.iter().any(|member| member.inputs() != members[0].inputs()) {
            return Err(Error::Parts("the members of an ensemble do not have the same inputs".into()));
        }
        if !(range.0 < range.1 && range.0.is_finite() && range.1.is_finite()) {
            return Err(Error::Parts("the range of an ensemble's input is no range".into()));
        }
        // The ensemble remembers them for all.
        members.iter_mut().for_each(Model::forget_records);
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
    pub fn remembers_excursions(&self) -> bool {
        self.group.remembers_excursions()
    }
}

impl Group {
    fn check(&self, members: usize, deepest: usize) -> Result<()> {
        if self.voices.is_empty() {
            return Err(Error::Parts("an ensemble needs at least one member".into()));
        }
        if deepest == 0 {
            return Err(Error::Parts("the groups of an ensemble are nested too deeply".into()));
        }
        let (inside, outside) = self.sums();
        let is_weight = |weight: f64| (0.0..=1e9).contains(&weight);
        let are_weights =
            |Voice { weights, .. }: &Voice| is_weight(weights.inside) && is_weight(weights.outside);
        if !self.voices.iter().all(are_weights) || inside.max(outside) < 1e-9 {
            let problem = "a group of an ensemble needs weights from 0 to 1e9 that are not all 0";
            return Err(Error::Parts(problem.into()));
        }
        for voice in &self.voices {
            match &voice.who {
                Speaker::Group(group) => group.check(members, deepest - 1)?,
                Speaker::Member(member) if *member < members => {}
                Speaker::Member(member) => {
                    return Err(Error::Parts(format!("an ensemble of {members} has no member {member}")));
                }
            }
        }
        Ok(())
    }

    /// The same with something else in the place of each member, or nothing; `None` if nothing is left. The
    /// weights of each group sum to 1; a class whose weights are all gone has those of the other.
    pub fn map_members(&self, with: &mut impl FnMut(usize) -> Option<Speaker>) -> Option<Group> {
        let mut voices = Vec::new();
        for Voice { weights, who } in &self.voices {
            let who = match who {
                Speaker::Member(member) => with(*member),
                Speaker::Group(group) => group.map_members(with).map(Speaker::Group),
            };
            voices.extend(who.map(|who| Voice { weights: *weights, who }));
        }
        let mut group = Group { name: self.name.clone(), voices };
        let (inside, outside): (Vec<f64>, Vec<f64>) =
            (group.blended(0.0).collect(), group.blended(1.0).collect());
        for (voice, (inside, outside)) in group.voices.iter_mut().zip(inside.into_iter().zip(outside)) {
            voice.weights = Weights { inside, outside };
        }
        let (inside, outside) = group.sums();
        (inside > 0.0 && outside > 0.0).then_some(group)
    }

    /// What each member counts in the whole, inside and outside.
    pub fn shares(&self) -> Vec<(usize, Weights)> {
        let mut shares = Vec::new();
        let weights = self.blended(0.0).zip(self.blended(1.0));
        for (voice, (inside, outside)) in self.voices.iter().zip(weights) {
            match &voice.who {
                Speaker::Member(member) => shares.push((*member, Weights { inside, outside })),
                Speaker::Group(group) => {
                    shares.extend(group.shares().into_iter().map(|(member, weights)| {
                        let (inside, outside) = (inside * weights.inside, outside * weights.outside);
                        (member, Weights { inside, outside })
                    }))
                }
            }
        }
        shares
    }

    /// Sums of the weights inside and outside.
    fn sums(&self) -> (f64, f64) {
        let weights = || self.voices.iter().map(|voice| voice.weights);
        (weights().map(|weights| weights.inside).sum(), weights().map(|weights| weights.outside).sum())
    }

    /// The weights of a record that has been outside by this degree where (11.4) leaves none: theory.md
    /// (11.9). A class without weights has those of the other.
    fn blended(&self, outside: f64) -> impl Iterator<Item = f64> {
        let (a, b) = self.sums();
        self.voices.iter().map(move |Voice { weights, .. }| {
            let of_inside = if a > 0.0 { weights.inside / a } else { weights.outside / b };
            let of_outside = if b > 0.0 { weights.outside / b } else { weights.inside / a };
            (1.0 - outside) * of_inside + outside * of_outside
        })
    }

    /// Sum of the weights of (11.4).
    fn sum_at(&self, outside: f64) -> f64 {
        self.voices.iter().map(|voice| voice.weights.at(outside)).sum()
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
        if votes.weight() == 0.0 {
            votes.weigh_anew(self.blended(outside));
        }
        votes.quantile(0.5)
    }

    /// Casts the votes of all members below, which share out `share`.
    fn gather(&self, outside: f64, share: f64, of_member: &impl Fn(usize) -> f64, all: &mut Votes) {
        let sum = self.sum_at(outside);
        let of_11_4 = self.voices.iter().map(|voice| voice.weights.at(outside) / sum);
        let mut blended = self.blended(outside);
        for (voice, weight) in self.voices.iter().zip(of_11_4) {
            let share = share * if sum > 0.0 { weight } else { blended.next().unwrap_or_default() };
            match &voice.who {
                Speaker::Member(member) => all.cast(of_member(*member), share),
                Speaker::Group(group) => group.gather(outside, share, of_member, all),
            }
        }
    }
}

/// Room to hear all voices of a row in.
#[derive(Debug, Clone)]
pub struct Council {
    /// Votes of the group that is being heard, at each depth.
    levels: Vec<Votes>,
    /// Votes of all members, each with what it counts in the whole.
    all: Votes,
}

impl Council {
    /// Room for a group and all groups in it.
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

    fn group(weights: &[(f64, f64)]) -> Group {
        let voice = |(member, &(inside, outside)): (usize, &(f64, f64))| Voice {
            weights: Weights { inside, outside },
            who: Speaker::Member(member),
        };
        Group { name: "g".into(), voices: weights.iter().enumerate().map(voice).collect() }
    }

    /// theory.md (11.9): a degree at which no member has a weight of (11.4), a class without any.
    #[test]
    fn there_is_an_output_at_every_degree_of_having_been_outside() {
        let values = [1.0, 3.0];
        let output = |weights: &[(f64, f64)], outside: f64| {
            let group = group(weights);
            let mut council = Council::new(&group);
            let output = council.output(&group, outside, |member| values[member]);
            let all = council.everybody(&group, outside, |member| values[member]);
            assert!((all.weight() - 1.0).abs() < 1e-12 && all.quantile(0.5).is_finite());
            output
        };
        let crossed = [(1.0, 0.0), (0.0, 1.0)];
        assert_eq!((output(&crossed, 0.0), output(&crossed, 1.0)), (1.0, 3.0));
        assert_eq!(output(&crossed, 0.5), 2.0, "half of each");
        let mut last = 1.0;
        for percent in 1..100 {
            let y = output(&crossed, f64::from(percent) / 100.0);
            assert!((last..=3.0).contains(&y), "{percent} %: {y} after {last}");
            last = y;
        }
        // Outside nobody has a weight: the weights inside hold there too.
        let inside_only = [(1.0, 0.0), (3.0, 0.0)];
        for outside in [0.0, 0.4, 1.0] {
            assert_eq!(output(&inside_only, outside), output(&[(1.0, 1.0), (3.0, 3.0)], outside));
        }
        assert!(group(&[(0.0, 0.0), (0.0, 0.0)]).check(2, 1).is_err());
        assert!(group(&[(f64::NAN, 1.0), (1.0, 1.0)]).check(2, 1).is_err());
    }

    #[test]
    fn weights_that_are_left_sum_to_one() {
        let tree = Group {
            name: "all".into(),
            voices: vec![
                Voice {
                    weights: Weights { inside: 1.0, outside: 0.0 },
                    who: Speaker::Group(group(&[(1.0, 1e-12), (2.0, 1.0)])),
                },
                Voice { weights: Weights { inside: 3.0, outside: 2.0 }, who: Speaker::Member(2) },
            ],
        };
        let shares = tree.shares();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(shares[0].1.inside, 0.25 / 3.0);
        close(shares[1].1.inside, 0.5 / 3.0);
        close(shares[2].1.outside, 1.0);
        // Without its second member the first group has next to no weight outside; it has all there is.
        let left = tree.map_members(&mut |member| (member != 1).then_some(Speaker::Member(member))).unwrap();
        left.check(3, DEEPEST).unwrap();
        let Speaker::Group(first) = &left.voices[0].who else { panic!("a group") };
        assert_eq!(first.voices[0].weights, Weights { inside: 1.0, outside: 1.0 });
        let alone = tree.map_members(&mut |member| (member == 0).then_some(Speaker::Member(0))).unwrap();
        assert_eq!(alone.voices[0].weights, Weights { inside: 1.0, outside: 1.0 });
        assert_eq!(tree.map_members(&mut |_| None), None);
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
