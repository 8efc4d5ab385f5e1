//! The turning points that are not wiped out, by Madelung's rules (theory.md (7.2)), in a fixed number of places.

use crate::program::expression::{Real, Truth, Whole, WholeVariable};
use crate::program::{Array, Builder};

/// Most turning points. At another one the innermost loop is closed early: the last point is deleted, and the branch of
/// the point before it continues.
const MOST: usize = 128;

/// Turning points with the value of the model at each, oldest first, and the present point.
pub(super) struct TurningPoints {
    x: Array,
    value: Array,
    depth: Array,
    present: Array,
    present_value: Array,
    has_present: Array,
}

impl TurningPoints {
    /// Those of a virgin model.
    pub fn new(builder: &mut Builder, name: &str) -> Self {
        let mut state =
            |part: &str, length: usize| builder.state(&format!("{name}_{part}"), vec![0.0; length]);
        Self {
            x: state("turning_x", MOST),
            value: state("turning_value", MOST),
            depth: state("depth", 1),
            present: state("present_x", 1),
            present_value: state("present_value", 1),
            has_present: state("has_present", 1),
        }
    }

    /// Advances to the next input: as `TurningPointStack::advance` of the library. Returns the number of points.
    pub fn advance(&self, builder: &mut Builder, x: &Real) -> WholeVariable {
        let depth = builder.counter(self.depth, 0_usize, 0.0, MOST as f64);
        let n = Whole::from(depth);
        let moved = self.has_present.at(0_usize).above(0.0).and(x.equals(self.present.at(0_usize)).negated());
        builder.when(moved, |builder| {
            let present = builder.value(self.present.at(0_usize));
            let start = builder.variable(0.0);
            builder.when(n.above(0_usize), |builder| builder.assign(start, self.x.at(&n - 1)));
            let headed_up = builder.value(present.above(start).choose(1.0, 0.0));
            let goes_up = builder.value(x.above(&present).choose(1.0, 0.0));
            // At rest at 0 the virgin curve goes both ways.
            let is_at_origin = n.equals(0_usize).and(present.equals(0.0));
            let turned = headed_up.equals(&goes_up).negated().and(is_at_origin.negated());
            builder.when(turned, |builder| {
                builder.when_else(
                    n.below(MOST),
                    |builder| {
                        builder.set(self.x, &n, &present);
                        builder.set(self.value, &n, self.present_value.at(0_usize));
                        builder.assign_whole(depth, &n + 1);
                    },
                    |builder| builder.assign_whole(depth, &n - 1),
                );
            });
            let magnitude = builder.value(x.abs());
            builder.while_true(self.is_wiped_out(&n, x, &magnitude), |builder| {
                builder.when_else(
                    n.equals(1),
                    |builder| builder.assign_whole(depth, 0_usize),
                    |builder| builder.assign_whole(depth, &n - 2),
                );
            });
        });
        builder.set(self.depth, 0_usize, n.to_real());
        builder.set(self.present, 0_usize, x);
        builder.set(self.has_present, 0_usize, 1.0);
        depth
    }

    /// True if the input has passed the only point or its mirror image, or the point before the last.
    fn is_wiped_out(&self, n: &Whole, x: &Real, magnitude: &Real) -> Truth {
        let only = n.equals(1).and(magnitude.at_least(self.x.at(0_usize).abs()));
        let (before, last) = (self.x.at(n - 2), self.x.at(n - 1));
        let above = before.above(&last).and(x.at_least(&before));
        let below = before.above(&last).negated().and(x.at_most(&before));
        only.or(n.above(1).and(above.or(below)))
    }

    /// The last point and the value there.
    pub fn last(&self, n: &Whole) -> (Real, Real) {
        (self.x.at(n - 1), self.value.at(n - 1))
    }

    /// Sets the value of the model at the present point.
    pub fn set_value(&self, builder: &mut Builder, value: &Real) {
        builder.set(self.present_value, 0_usize, value);
    }
}

/// The number of values of a rising array, from a first one on, that are not above `x`.
pub(super) fn partition_point(
    builder: &mut Builder,
    array: Array,
    first: usize,
    length: usize,
    x: &Real,
) -> Whole {
    let low = builder.whole_variable(0_usize);
    let high = builder.whole_variable(length);
    let (from, to) = (Whole::from(low), Whole::from(high));
    builder.while_true(from.below(&to), |builder| {
        let middle = builder.whole_variable(((&from + &to).to_real() * 0.5).to_whole());
        let middle = Whole::from(middle);
        builder.when_else(
            array.at(&middle + first).at_most(x),
            |builder| builder.assign_whole(low, &middle + 1),
            |builder| builder.assign_whole(high, &middle),
        );
    });
    from
}
