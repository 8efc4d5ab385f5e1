//! Menegotto-Pinto: steel, by curves between two straight lines.

use hysid_core::law::menegotto_pinto::MenegottoPinto;

use super::yield_curve::yielding;
use crate::description::{PartInputs, limited};
use crate::program::expression::{Real, Whole};
use crate::program::{Array, Builder};

// Numbers of the library.
const LEAST_ROUNDNESS: f64 = 0.3;
const LEAST_STRENGTH: f64 = 0.1;
const LARGEST_DISPLACEMENT: f64 = 1e100;
const MET: f64 = 1e-12;
const STEPS_AHEAD: f64 = 8.0;
const MOST_BRANCHES: usize = 8;

/// `y = c0 + k x + F q` (theory.md (8.47))
pub(super) fn step(builder: &mut Builder, name: &str, law: &MenegottoPinto, sample: &PartInputs) -> Real {
    let state = SteelState::new(builder, name, law);
    let x = limited(builder, &sample.inputs[0]);
    let d = builder.value(&x / law.yield_displacement);
    let d = builder.value(d.clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT));
    let before = builder.value(state.d.at(0_usize));
    builder.when(d.equals(&before).negated(), |builder| {
        let direction = builder.whole_variable(0_usize);
        builder.when(d.below(&before), |builder| builder.assign_whole(direction, 1));
        let direction = Whole::from(direction);
        builder.when(state.direction.at(0_usize).equals(direction.to_real()).negated(), |builder| {
            state.turn(builder, law, &direction);
        });
        let sign = sign_of(builder, &direction);
        let along = builder.value(&sign * &d);
        state.delete_opposite(builder, &direction, &along);
        let by = builder.value((&d - &before).abs());
        let q = state.followed(builder, &direction, &along, &by);
        builder.set(state.d, 0_usize, &d);
        builder.set(state.q, 0_usize, sign * q);
    });
    let y = builder.value(law.offset + law.hardening_stiffness * &x + law.strength * state.q.at(0_usize));
    builder.value(y.clamp(-f64::MAX, f64::MAX))
}

fn sign_of(builder: &mut Builder, direction: &Whole) -> Real {
    builder.value(direction.equals(0_usize).choose(1.0, -1.0))
}

/// The branches upwards, then those downwards, [`MOST_BRANCHES`] places each; the present point; the extremes.
struct SteelState {
    from: Array,
    start: Array,
    room: Array,
    roundness: Array,
    /// Two points of each branch, `d` and `q` of the first, then of the second.
    chord: [Array; 4],
    count: Array,
    /// 0 upwards, 1 downwards; -1 before the first movement.
    direction: Array,
    d: Array,
    q: Array,
    extremes: Array,
    /// First yield stress and isotropic hardening of each direction.
    ratio: Array,
    isotropic: Array,
}

impl SteelState {
    fn new(builder: &mut Builder, name: &str, law: &MenegottoPinto) -> Self {
        let (ratio, isotropic) = law.down.map_or((1.0, law.isotropic), |down| (down.ratio, down.isotropic));
        let mut state = |part: &str, initial: Vec<f64>| builder.state(&format!("{name}_{part}"), initial);
        let mut of_branches = |part: &str| state(part, vec![0.0; 2 * MOST_BRANCHES]);
        let [from, start, room, roundness] = ["from", "start", "room", "roundness"].map(&mut of_branches);
        let chord = ["chord_d1", "chord_q1", "chord_d2", "chord_q2"].map(&mut of_branches);
        Self {
            from,
            start,
            room,
            roundness,
            chord,
            count: state("branches", vec![0.0; 2]),
            direction: state("direction", vec![-1.0]),
            d: state("d", vec![0.0]),
            q: state("q", vec![0.0]),
            extremes: state("extreme", vec![1.0, 1.0]),
            ratio: builder.constants(&format!("{name}_ratio"), vec![1.0, ratio]),
            isotropic: builder.constants(&format!("{name}_isotropic"), vec![law.isotropic, isotropic]),
        }
    }

    /// The number of branches of a direction, and the place of the first.
    fn branches(&self, builder: &mut Builder, direction: &Whole) -> (Whole, Whole) {
        let count = builder.counter(self.count, direction, 0.0, MOST_BRANCHES as f64);
        let first = builder.whole_variable(direction * MOST_BRANCHES);
        (count.into(), first.into())
    }

    /// `q` of the branch in a place at `d`, both with the sign of the direction (theory.md (8.48)).
    fn at(&self, builder: &mut Builder, place: &Whole, d: &Real) -> Real {
        let q = builder.variable(self.start.at(place));
        let room = builder.value(self.room.at(place));
        builder.when(room.above(0.0), |builder| {
            let z = builder.value((d - self.from.at(place)) / &room);
            let z = builder.value(z.max(0.0));
            let roundness = builder.value(self.roundness.at(place));
            let curve = yielding(builder, &z, &roundness);
            builder.assign(q, self.start.at(place) + &room * curve);
        });
        q.into()
    }

    /// Leaves the present branch and begins one in another direction.
    fn turn(&self, builder: &mut Builder, law: &MenegottoPinto, direction: &Whole) {
        let (from, start) = (builder.variable(0.0), builder.variable(0.0));
        let room = builder.variable(self.ratio.at(direction));
        let roundness = builder.variable(law.roundness);
        builder.when(self.direction.at(0_usize).at_least(0.0), |builder| {
            let (d, q) = (builder.value(self.d.at(0_usize)), builder.value(self.q.at(0_usize)));
            let before = Whole::from(builder.counter(self.direction, 0_usize, 0.0, 1.0));
            let sign = sign_of(builder, &before);
            let (count, first) = self.branches(builder, &before);
            builder.when(count.above(0_usize), |builder| {
                let last = Whole::from(builder.whole_variable(&first + &count - 1));
                builder.set(self.chord[2], &last, &sign * &d);
                builder.set(self.chord[3], &last, &sign * &q);
            });
            let extreme = builder.value(self.extremes.at(&before));
            let reached = builder.value(&sign * &d);
            builder.set(self.extremes, &before, extreme.max(&reached));

            let sign = sign_of(builder, direction);
            builder.assign(from, &sign * &d);
            builder.assign(start, &sign * &q);
            let stress = self.yield_stress(builder, direction);
            let left = builder.value(stress - Real::from(start));
            builder.assign(room, left.max(0.0));
            let asymptote = Real::from(from) + Real::from(room);
            let excursion = builder.value((self.extremes.at(direction) - asymptote).abs());
            let loss = law.loss * &excursion / (law.pace + &excursion);
            let rounded = builder.value(law.roundness * (1.0 - loss));
            builder.assign(roundness, rounded.max(LEAST_ROUNDNESS));
        });
        self.push(builder, direction, [from, start, room, roundness].map(Real::from));
        builder.set(self.direction, 0_usize, direction.to_real());
    }

    /// `S` or `ρ S` (theory.md (8.50)).
    fn yield_stress(&self, builder: &mut Builder, direction: &Whole) -> Real {
        let half = builder.value(0.5 * (self.extremes.at(0_usize) + self.extremes.at(1_usize)));
        let excursion = builder.value(half.max(0.0));
        let share = builder.value(1.0 + self.isotropic.at(direction) * excursion.powf(0.8));
        builder.value(self.ratio.at(direction) * share.max(LEAST_STRENGTH))
    }

    /// Adds a branch, of which the second is deleted if there is no place.
    fn push(&self, builder: &mut Builder, direction: &Whole, [from, start, room, roundness]: [Real; 4]) {
        let (count, first) = self.branches(builder, direction);
        let all = [self.from, self.start, self.room, self.roundness].into_iter().chain(self.chord);
        let all: Vec<Array> = all.collect();
        let length = builder.whole_variable(&count);
        builder.when(count.equals(MOST_BRANCHES), |builder| {
            builder.each(&first + 1, &first + (MOST_BRANCHES - 1), |builder, k| {
                for &array in &all {
                    builder.set(array, &k, array.at(&k + 1));
                }
            });
            builder.assign_whole(length, MOST_BRANCHES - 1);
        });
        let end = Whole::from(builder.whole_variable(&first + Whole::from(length)));
        builder.each(&first, &end, |builder, k| {
            let q = self.at(builder, &k, &from);
            builder.set(self.chord[0], &k, &from);
            builder.set(self.chord[1], &k, q);
        });
        for (array, value) in [
            (self.from, &from),
            (self.start, &start),
            (self.room, &room),
            (self.roundness, &roundness),
            (self.chord[0], &from),
            (self.chord[1], &start),
            (self.chord[2], &from),
            (self.chord[3], &start),
        ] {
            builder.set(array, &end, value);
        }
        builder.set(self.count, direction, (Whole::from(length) + 1).to_real());
    }

    /// Deletes the branches the other way that begin on this path.
    fn delete_opposite(&self, builder: &mut Builder, direction: &Whole, along: &Real) {
        let opposite = Whole::from(builder.whole_variable(Whole::from(1_usize) - direction));
        let (count, first) = self.branches(builder, &opposite);
        let left = builder.whole_variable(&count);
        let last = |left: Whole| -self.from.at(&first + left - 1);
        let passed = last(left.into()).at_most(along);
        builder.while_true(Whole::from(left).above(0_usize).and(passed), |builder| {
            builder.assign_whole(left, Whole::from(left) - 1);
        });
        builder.set(self.count, &opposite, Whole::from(left).to_real());
    }

    /// The smallest `q` of the branches at `d` (theory.md (8.51)). Later branches than its own are deleted.
    fn followed(&self, builder: &mut Builder, direction: &Whole, d: &Real, by: &Real) -> Real {
        let (count, first) = self.branches(builder, direction);
        let least = builder.variable(0.0);
        builder.when(count.above(0_usize), |builder| {
            let last = Whole::from(builder.whole_variable(&first + &count - 1));
            let q = self.at(builder, &last, d);
            builder.assign(least, q);
            let kept = builder.whole_variable(&count);
            builder.each(1, &count, |builder, back| {
                let place = Whole::from(builder.whole_variable(&last - back));
                let bound = self.least(builder, &place, d);
                builder.when(Real::from(least).at_least(bound - 2.0 * MET), |builder| {
                    let q = self.looked_at(builder, &place, d, by);
                    builder.when(Real::from(least).at_least(&q - MET), |builder| {
                        builder.assign(least, &q);
                        builder.assign_whole(kept, &place - &first + 1);
                    });
                });
            });
            builder.set(self.count, direction, Whole::from(kept).to_real());
        });
        least.into()
    }

    /// A lower bound of `q` at `d`: a chord.
    fn least(&self, builder: &mut Builder, place: &Whole, d: &Real) -> Real {
        let [d1, q1, d2, q2] = self.chord.map(|array| builder.value(array.at(place)));
        let bound = builder.variable(&q1);
        builder.when_else(
            d.at_least(&d2),
            |builder| builder.assign(bound, q1.max(&q2)),
            |builder| {
                builder.when(d1.below(&d2), |builder| {
                    builder.assign(bound, &q1 + (&q2 - &q1) * ((d - &d1) / (&d2 - &d1)));
                });
            },
        );
        bound.into()
    }

    /// `q` at `d`, and a chord for the next few steps.
    fn looked_at(&self, builder: &mut Builder, place: &Whole, d: &Real, by: &Real) -> Real {
        let q = self.at(builder, place, d);
        let ahead = builder.value(d + STEPS_AHEAD * by);
        let end = builder.value(self.chord[2].at(place));
        builder.when(end.above(d).and(end.at_most(&ahead)).negated(), |builder| {
            let value = self.at(builder, place, &ahead);
            builder.set(self.chord[2], place, &ahead);
            builder.set(self.chord[3], place, value);
        });
        builder.set(self.chord[0], place, d);
        builder.set(self.chord[1], place, &q);
        q
    }
}
