//! Ensembles: several models whose outputs are combined by nested weighted medians.
//!
//! ```text
//! y   = M(y_1 .. y_n; w_1 .. w_n)                                          theory.md (11.3)
//! w_i = a_i^{1-o} b_i^o,   o = min(1, e / 0.06 (u - l))                    theory.md (11.4)
//! w_i = (1-o) a_i/Σa + o b_i/Σb      if the products are 0 for all i       theory.md (11.9)
//! ```
//!
//! `y_i` is the output of node `i`, a member or a group, and `M` the weighted median: each value is placed at
//! the middle of its weight, with linear interpolation to the cumulative weight 1/2. Node `i` has the weight
//! `a_i` inside the trained range `l` to `u` of the first input and `b_i` outside it, since a model that is
//! good inside need not be good outside. `e` is the largest distance by which the record has left the range
//! so far; `o` is 0 inside and 1 from 6 % of the range on.
//!
//! The median is robust: one diverging fit does not change it. Nodes are nested (starts of one model form a
//! group), so that a model gains no weight by its number of starts.

use serde::{Deserialize, Serialize};

use crate::elementary::powf;
use crate::error::{Error, Result};
use crate::model::Model;

/// Distance outside, as a share of the trained range, from which on only the outside weights count. Designed.
const WAY_OUT: f64 = 0.06;

/// Largest depth of nested groups.
const DEEPEST: usize = 8;

/// Most members of an ensemble, each counted as often as its groups name it.
const MOST_LEAVES: usize = 2_000;

/// Several models whose predictions are combined by nested weighted medians.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    members: Vec<Model>,
    group: Group,
    range: (f64, f64),
}

/// Nodes that are combined by their weighted median.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Name of the group: what its nodes have in common.
    pub name: String,
    /// Its nodes: members and groups.
    #[serde(rename = "voices")]
    pub nodes: Vec<Node>,
}

/// A weighted node of the ensemble.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Its weights in its group.
    pub weights: Weights,
    /// A member or a group.
    #[serde(rename = "who")]
    pub kind: NodeKind,
}

/// Content of a node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NodeKind {
    /// A member, by its index in [`Ensemble::members`].
    Member(usize),
    /// The weighted median of a group.
    Group(Group),
}

/// Weights of a node in its group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// Weight `a` while the record stays in the trained range of the first input.
    pub inside: f64,
    /// Weight `b` once the record has left it.
    pub outside: f64,
}

impl Weights {
    /// Weight 1 inside and outside.
    pub fn equal() -> Self {
        Self { inside: 1.0, outside: 1.0 }
    }

    /// The weight `a^{1-o} b^o`, where `o` is how far the record has been outside, 0 to 1 (theory.md (11.4)).
    pub(crate) fn at(&self, outside: f64) -> f64 {
        if outside == 0.0 {
            self.inside
        } else if outside == 1.0 {
            self.outside
        } else {
            powf(self.inside, 1.0 - outside) * powf(self.outside, outside)
        }
    }
}

/// How far outside the trained range a record has been so far.
#[derive(Debug, Clone, Copy)]
pub struct Excursion {
    range: (f64, f64),
    farthest: f64,
}

impl Excursion {
    /// At the beginning of a record, for this trained range.
    pub fn beyond(range: (f64, f64)) -> Self {
        Self { range, farthest: 0.0 }
    }

    /// Adds the next input and returns `o = min(1, e / 0.06 (u - l))`, where `e` is the largest distance so
    /// far outside the range `l` to `u`: 0 if the record was always inside, 1 for fully outside (theory.md
    /// (11.4)).
    pub fn take(&mut self, x: f64) -> f64 {
        let (low, high) = self.range;
        self.farthest = self.farthest.max(low - x).max(x - high);
        self.outside()
    }

    /// The degree `o` of the inputs so far.
    pub fn outside(&self) -> f64 {
        let (low, high) = self.range;
        (self.farthest / (WAY_OUT * (high - low))).clamp(0.0, 1.0)
    }
}

/// Output and weight of each member, for weighted quantiles.
#[derive(Debug, Clone, Default)]
pub struct Predictions(Vec<(f64, f64)>);

impl Predictions {
    /// Removes all values.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds the value of a member with its weight.
    pub fn push(&mut self, value: f64, weight: f64) {
        self.0.push((value, weight));
    }

    /// Gives the predictions other weights, in the order in which they were added.
    fn set_weights(&mut self, weights: impl Iterator<Item = f64>) {
        self.0.iter_mut().zip(weights).for_each(|(vote, weight)| vote.1 = weight);
    }

    fn weight(&self) -> f64 {
        self.0.iter().map(|(_, weight)| weight).sum()
    }

    /// The weighted quantile at a level from 0 to 1 (theory.md (11.3)).
    ///
    /// With the sorted values `y_i` and weights `w_i`, value `i` is at the level `q_i = (w_1 + .. + w_{i-1} +
    /// w_i/2) / Σ w`, with linear interpolation in between. With equal weights, `quantile(0.5)` is the
    /// ordinary median.
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
    /// An ensemble of models of the same columns. `group` combines them, by their indices. `range` is that of
    /// the first input over all training data, in its unit.
    ///
    /// # Errors
    /// A group without nodes, a member that does not exist, an ensemble as a member, members of different
    /// inputs, more than 2,000 members, weights that are negative, not finite or all 0, inside and outside.
    pub fn new(mut members: Vec<Model>, group: Group, range: (f64, f64)) -> Result<Self> {
        group.check(members.len(), DEEPEST)?;
        let named = group.leaves().max(members.len());
        if named > MOST_LEAVES {
            let problem = format!("an ensemble has {named} members, at most {MOST_LEAVES} are possible");
            return Err(Error::Parts(problem));
        }
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

    /// The outermost group.
    pub fn group(&self) -> &Group {
        &self.group
    }

    /// All members, in the order in which nodes number them.
    pub fn members(&self) -> &[Model] {
        &self.members
    }

    /// Trained range of the first input, in its unit, outside which the outside weights count.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// True if the weights inside and outside differ, so that an excursion of the record matters.
    pub fn remembers_excursions(&self) -> bool {
        self.group.remembers_excursions()
    }
}

impl Group {
    fn check(&self, members: usize, deepest: usize) -> Result<()> {
        if self.nodes.is_empty() {
            return Err(Error::Parts("an ensemble needs at least one member".into()));
        }
        if deepest == 0 {
            return Err(Error::Parts("the groups of an ensemble are nested too deeply".into()));
        }
        let (inside, outside) = self.sums();
        let is_weight = |weight: f64| (0.0..=1e9).contains(&weight);
        let are_weights =
            |Node { weights, .. }: &Node| is_weight(weights.inside) && is_weight(weights.outside);
        if !self.nodes.iter().all(are_weights) || inside.max(outside) < 1e-9 {
            let problem = "a group of an ensemble needs weights from 0 to 1e9 that are not all 0";
            return Err(Error::Parts(problem.into()));
        }
        for node in &self.nodes {
            match &node.kind {
                NodeKind::Group(group) => group.check(members, deepest - 1)?,
                NodeKind::Member(member) if *member < members => {}
                NodeKind::Member(member) => {
                    return Err(Error::Parts(format!("an ensemble of {members} has no member {member}")));
                }
            }
        }
        Ok(())
    }

    /// The group with each member replaced by another node, or removed; `None` if no node is left. The
    /// weights of each group are scaled to the sum 1; if all weights of a class (inside, outside) are
    /// removed, those of the other replace them.
    pub fn map_members(&self, with: &mut impl FnMut(usize) -> Option<NodeKind>) -> Option<Group> {
        let mut nodes = Vec::new();
        for Node { weights, kind } in &self.nodes {
            let kind = match kind {
                NodeKind::Member(member) => with(*member),
                NodeKind::Group(group) => group.map_members(with).map(NodeKind::Group),
            };
            nodes.extend(kind.map(|kind| Node { weights: *weights, kind }));
        }
        let mut group = Group { name: self.name.clone(), nodes };
        let (inside, outside): (Vec<f64>, Vec<f64>) =
            (group.blended(0.0).collect(), group.blended(1.0).collect());
        for (node, (inside, outside)) in group.nodes.iter_mut().zip(inside.into_iter().zip(outside)) {
            node.weights = Weights { inside, outside };
        }
        let (inside, outside) = group.sums();
        (inside > 0.0 && outside > 0.0).then_some(group)
    }

    /// Weight of each member in the whole ensemble, inside and outside.
    pub fn shares(&self) -> Vec<(usize, Weights)> {
        let mut shares = Vec::new();
        let weights = self.blended(0.0).zip(self.blended(1.0));
        for (node, (inside, outside)) in self.nodes.iter().zip(weights) {
            match &node.kind {
                NodeKind::Member(member) => shares.push((*member, Weights { inside, outside })),
                NodeKind::Group(group) => {
                    shares.extend(group.shares().into_iter().map(|(member, weights)| {
                        let (inside, outside) = (inside * weights.inside, outside * weights.outside);
                        (member, Weights { inside, outside })
                    }))
                }
            }
        }
        shares
    }

    /// Number of members that the group and those in it name, repeated ones included.
    fn leaves(&self) -> usize {
        let of_node = |node: &Node| match &node.kind {
            NodeKind::Member(_) => 1,
            NodeKind::Group(group) => group.leaves(),
        };
        self.nodes.iter().map(of_node).sum()
    }

    /// Sums of the weights inside and outside.
    fn sums(&self) -> (f64, f64) {
        let weights = || self.nodes.iter().map(|node| node.weights);
        (weights().map(|weights| weights.inside).sum(), weights().map(|weights| weights.outside).sum())
    }

    /// The weights `(1-o) a_i/Σa + o b_i/Σb`, where all products `a_i^{1-o} b_i^o` are 0 (theory.md (11.9)).
    fn blended(&self, outside: f64) -> impl Iterator<Item = f64> {
        let (a, b) = self.sums();
        self.nodes.iter().map(move |Node { weights, .. }| {
            let of_inside = if a > 0.0 { weights.inside / a } else { weights.outside / b };
            let of_outside = if b > 0.0 { weights.outside / b } else { weights.inside / a };
            (1.0 - outside) * of_inside + outside * of_outside
        })
    }

    /// Sum of the products `a_i^{1-o} b_i^o` (theory.md (11.4)).
    fn sum_at(&self, outside: f64) -> f64 {
        self.nodes.iter().map(|node| node.weights.at(outside)).sum()
    }

    fn remembers_excursions(&self) -> bool {
        // Only the proportions of the weights count.
        let first = self.nodes[0].weights;
        self.nodes.iter().any(|Node { weights, kind }| {
            weights.inside * first.outside != weights.outside * first.inside
                || matches!(kind, NodeKind::Group(group) if group.remembers_excursions())
        })
    }

    fn depth(&self) -> usize {
        let of_voice = |node: &Node| match &node.kind {
            NodeKind::Member(_) => 0,
            NodeKind::Group(group) => group.depth(),
        };
        1 + self.nodes.iter().map(of_voice).max().unwrap_or_default()
    }

    /// The weighted median of the group; `levels` has room for the predictions of this group and of those below.
    fn median(&self, outside: f64, of_member: &impl Fn(usize) -> f64, levels: &mut [Predictions]) -> f64 {
        let Some((predictions, deeper)) = levels.split_first_mut() else { return f64::NAN };
        predictions.clear();
        for node in &self.nodes {
            let value = match &node.kind {
                NodeKind::Member(member) => of_member(*member),
                NodeKind::Group(group) => group.median(outside, of_member, deeper),
            };
            predictions.push(value, node.weights.at(outside));
        }
        if predictions.weight() == 0.0 {
            predictions.set_weights(self.blended(outside));
        }
        predictions.quantile(0.5)
    }

    /// Collects the predictions of all members below, whose weights sum to `share`.
    fn gather(&self, outside: f64, share: f64, of_member: &impl Fn(usize) -> f64, all: &mut Predictions) {
        let sum = self.sum_at(outside);
        let of_11_4 = self.nodes.iter().map(|node| node.weights.at(outside) / sum);
        let mut blended = self.blended(outside);
        for (node, weight) in self.nodes.iter().zip(of_11_4) {
            let share = share * if sum > 0.0 { weight } else { blended.next().unwrap_or_default() };
            match &node.kind {
                NodeKind::Member(member) => all.push(of_member(*member), share),
                NodeKind::Group(group) => group.gather(outside, share, of_member, all),
            }
        }
    }
}

/// Buffers for the medians of one row.
#[derive(Debug, Clone)]
pub struct MedianBuffers {
    /// Predictions of the group at each depth.
    levels: Vec<Predictions>,
    /// Predictions of all members, each with its weight in the whole.
    all: Predictions,
}

impl MedianBuffers {
    /// Buffers for a group and all groups in it.
    pub fn new(group: &Group) -> Self {
        Self { levels: vec![Predictions::default(); group.depth()], all: Predictions::default() }
    }

    /// The output of the ensemble, where `of_member` is the prediction of each member.
    pub fn output(&mut self, group: &Group, outside: f64, of_member: impl Fn(usize) -> f64) -> f64 {
        group.median(outside, &of_member, &mut self.levels)
    }

    /// The predictions of all members with their weights.
    pub fn predictions(
        &mut self,
        group: &Group,
        outside: f64,
        of_member: impl Fn(usize) -> f64,
    ) -> &mut Predictions {
        self.all.clear();
        group.gather(outside, 1.0, &of_member, &mut self.all);
        &mut self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantile(predictions: &[(f64, f64)], level: f64) -> f64 {
        Predictions(predictions.to_vec()).quantile(level)
    }

    #[test]
    fn equal_weights_give_the_ordinary_median() {
        assert_eq!(quantile(&[(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)], 0.5), 2.0);
        assert_eq!(quantile(&[(4.0, 0.5), (1.0, 0.5), (2.0, 0.5), (8.0, 0.5)], 0.5), 3.0);
        assert_eq!(quantile(&[(5.0, 0.3)], 0.5), 5.0);
    }

    #[test]
    fn a_value_without_weight_counts_nothing_and_one_with_most_decides() {
        assert_eq!(quantile(&[(-9.0, 0.0), (1.0, 1.0), (9.0, 0.0)], 0.5), 1.0);
        let near = quantile(&[(0.0, 1.0), (1.0, 1e-9), (-1.0, 1e-9)], 0.5);
        assert!(near.abs() < 1e-8, "{near}");
        assert_eq!(quantile(&[(1.0, 1.0), (1e300, 1.0), (2.0, 1.0)], 0.5), 2.0);
    }

    #[test]
    fn quantiles_rise_with_their_level_and_stay_among_the_values() {
        let predictions = [(3.0, 0.2), (-1.0, 1.0), (0.5, 0.7), (2.0, 0.1)];
        let mut last = f64::NEG_INFINITY;
        for percent in 0..=100 {
            let value = quantile(&predictions, f64::from(percent) / 100.0);
            assert!(value >= last && (-1.0..=3.0).contains(&value), "{percent}: {value} after {last}");
            last = value;
        }
    }

    fn group(weights: &[(f64, f64)]) -> Group {
        let node = |(member, &(inside, outside)): (usize, &(f64, f64))| Node {
            weights: Weights { inside, outside },
            kind: NodeKind::Member(member),
        };
        Group { name: "g".into(), nodes: weights.iter().enumerate().map(node).collect() }
    }

    /// theory.md (11.9): a degree at which no member has a weight of (11.4), a class without any.
    #[test]
    fn there_is_an_output_at_every_degree_of_having_been_outside() {
        let values = [1.0, 3.0];
        let output = |weights: &[(f64, f64)], outside: f64| {
            let group = group(weights);
            let mut council = MedianBuffers::new(&group);
            let output = council.output(&group, outside, |member| values[member]);
            let all = council.predictions(&group, outside, |member| values[member]);
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
            nodes: vec![
                Node {
                    weights: Weights { inside: 1.0, outside: 0.0 },
                    kind: NodeKind::Group(group(&[(1.0, 1e-12), (2.0, 1.0)])),
                },
                Node { weights: Weights { inside: 3.0, outside: 2.0 }, kind: NodeKind::Member(2) },
            ],
        };
        let shares = tree.shares();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(shares[0].1.inside, 0.25 / 3.0);
        close(shares[1].1.inside, 0.5 / 3.0);
        close(shares[2].1.outside, 1.0);
        // Without its second member the first group has next to no weight outside; it has all there is.
        let left = tree.map_members(&mut |member| (member != 1).then_some(NodeKind::Member(member))).unwrap();
        left.check(3, DEEPEST).unwrap();
        let NodeKind::Group(first) = &left.nodes[0].kind else { panic!("a group") };
        assert_eq!(first.nodes[0].weights, Weights { inside: 1.0, outside: 1.0 });
        let alone = tree.map_members(&mut |member| (member == 0).then_some(NodeKind::Member(0))).unwrap();
        assert_eq!(alone.nodes[0].weights, Weights { inside: 1.0, outside: 1.0 });
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
