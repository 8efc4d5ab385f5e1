//! Masing's rule: every branch is the virgin curve, magnified by two.

use hysid_core::law::masing::Masing;

use super::turning_points::{TurningPoints, partition_point};
use crate::description::{PartInputs, limited};
use crate::program::expression::{Real, Whole};
use crate::program::{Array, Builder};

/// `y = c + g(x)`, or `y = y* + 2 g((x - x*)/2)` from a turning point (theory.md (7.3))
pub(super) fn step(builder: &mut Builder, name: &str, law: &Masing, sample: &PartInputs) -> Real {
    let points = TurningPoints::new(builder, name);
    let curve = MasingCurve::new(builder, name, law);
    let x = limited(builder, &sample.inputs[0]);
    let n = Whole::from(points.advance(builder, &x));
    let y = builder.variable(0.0);
    builder.when_else(
        n.equals(0_usize),
        |builder| {
            let value = curve.value(builder, &x);
            builder.assign(y, value);
        },
        |builder| {
            let (start, at_start) = points.last(&n);
            let half = builder.value(0.5 * (&x - start));
            let value = curve.value(builder, &half);
            builder.assign(y, at_start + 2.0 * value);
        },
    );
    let y = Real::from(y);
    points.set_value(builder, &y);
    builder.value(law.parts().constant + y)
}

/// The virgin curve: bends with the heights there, 0 first, and slopes.
struct MasingCurve {
    bends: Array,
    heights: Array,
    slopes: Array,
    thresholds: usize,
}

impl MasingCurve {
    fn new(builder: &mut Builder, name: &str, law: &Masing) -> Self {
        let with_zero = |values: &[f64]| [&[0.0], values].concat();
        Self {
            bends: builder.constants(&format!("{name}_bend"), with_zero(&law.parts().thresholds)),
            heights: builder.constants(&format!("{name}_height"), with_zero(law.heights())),
            slopes: builder.constants(&format!("{name}_slope"), law.parts().slopes.clone()),
            thresholds: law.parts().thresholds.len(),
        }
    }

    /// `g`
    fn value(&self, builder: &mut Builder, x: &Real) -> Real {
        let size = builder.value(x.abs());
        let piece = partition_point(builder, self.bends, 1, self.thresholds, &size);
        let beyond = &size - self.bends.at(&piece);
        let height = builder.value(self.heights.at(&piece) + self.slopes.at(&piece) * beyond);
        builder.value(x.below(0.0).choose(-&height, &height))
    }
}
