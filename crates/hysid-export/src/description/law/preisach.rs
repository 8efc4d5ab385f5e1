//! Preisach: relays on a plane of cells, by their Everett function.

use hysid_core::law::preisach::Preisach;

use super::turning_points::{TurningPoints, partition_point};
use crate::description::{PartInputs, limited};
use crate::program::expression::{Real, Whole};
use crate::program::{Array, Builder};

/// `y = c + k x + Σ_j v_j m_j(x) + Σ_ij w_ij R_ij[x]` (theory.md (7.8))
pub(super) fn step(builder: &mut Builder, name: &str, law: &Preisach, sample: &PartInputs) -> Real {
    let points = TurningPoints::new(builder, name);
    let plane = PlaneTables::new(builder, name, law);
    let x = limited(builder, &sample.inputs[0]);
    let n = Whole::from(points.advance(builder, &x));
    let place = plane.place(builder, &x);
    let switched = builder.variable(0.0);
    builder.when_else(
        n.equals(0_usize),
        |builder| {
            let virgin = law.virgin_output();
            builder.when_else(
                x.at_least(0.0),
                |builder| {
                    let share = plane.virgin[0].value(builder, &x);
                    builder.assign(switched, virgin + 2.0 * share);
                },
                |builder| {
                    let share = plane.virgin[1].value(builder, &x);
                    builder.assign(switched, virgin - 2.0 * share);
                },
            );
        },
        |builder| {
            let (start, at_start) = points.last(&n);
            let start = builder.value(start);
            let from = plane.place(builder, &start);
            builder.when_else(
                x.above(&start),
                |builder| {
                    let everett = plane.everett(builder, &place, &from);
                    builder.assign(switched, at_start.clone() + 2.0 * everett);
                },
                |builder| {
                    let everett = plane.everett(builder, &from, &place);
                    builder.assign(switched, at_start.clone() - 2.0 * everett);
                },
            );
        },
    );
    let switched = Real::from(switched);
    points.set_value(builder, &switched);
    let between = plane.reversible.at(&place.interval)
        + 2.0 * place.share.clone() * plane.reversible_weights.at(&place.interval);
    let weights = law.weights();
    let reversible = builder.value(weights.constant + weights.slope * x + between);
    builder.value(switched + reversible)
}

/// Place of an input among the lines: interval, and share of it below.
struct InputPlace {
    interval: Whole,
    share: Real,
}

/// Tables of the Everett function and of the reversible part.
struct PlaneTables {
    intervals: usize,
    lines: Array,
    weight: Array,
    inner: Array,
    along_row: Array,
    along_column: Array,
    virgin: [VirginTables; 2],
    reversible: Array,
    reversible_weights: Array,
}

impl PlaneTables {
    fn new(builder: &mut Builder, name: &str, law: &Preisach) -> Self {
        let tables = law.tables();
        let mut of_cells = |part: &str, index: usize| {
            builder
                .constants(&format!("{name}_{part}"), tables.cells.iter().map(|cell| cell[index]).collect())
        };
        let (weight, inner) = (of_cells("cell", 0), of_cells("inner", 1));
        let (along_row, along_column) = (of_cells("along_row", 2), of_cells("along_column", 3));
        let [up, down] = tables.virgin;
        let virgin = [("virgin_up", up), ("virgin_down", down)].map(|(part, (knots, pieces))| {
            VirginTables::new(builder, &format!("{name}_{part}"), knots, &pieces)
        });
        let weights = law.weights();
        Self {
            intervals: weights.lines.len() - 1,
            lines: builder.constants(&format!("{name}_line"), weights.lines.clone()),
            weight,
            inner,
            along_row,
            along_column,
            virgin,
            reversible: builder.constants(&format!("{name}_reversible"), tables.reversible),
            reversible_weights: builder
                .constants(&format!("{name}_reversible_weight"), weights.reversible.clone()),
        }
    }

    /// Place of an input; one beyond the plane is at its edge.
    fn place(&self, builder: &mut Builder, x: &Real) -> InputPlace {
        let interval = partition_point(builder, self.lines, 1, self.intervals - 1, x);
        let low = builder.value(self.lines.at(&interval));
        let share = builder.value((x - &low) / (self.lines.at(&interval + 1) - &low));
        InputPlace { interval, share: builder.value(share.clamp(0.0, 1.0)) }
    }

    /// `E(a, b)`, 0 unless `a > b` (theory.md (7.10)).
    fn everett(&self, builder: &mut Builder, a: &InputPlace, b: &InputPlace) -> Real {
        let (i, j) = (&a.interval, &b.interval);
        let s = &a.share;
        let value = builder.variable(0.0);
        let of_row = builder.value(self.weight.at(i * (self.intervals + 1)));
        builder.when_else(
            j.below(i),
            |builder| {
                let cell = Whole::from(builder.whole_variable(i * self.intervals + j));
                let rest = builder.value(1.0 - &b.share);
                let of_column = self.weight.at(j * (self.intervals + 1));
                builder.assign(
                    value,
                    self.inner.at(&cell)
                        + s * self.along_row.at(&cell)
                        + &rest * self.along_column.at(&cell)
                        + s * s * &of_row
                        + &rest * &rest * of_column
                        + s * &rest * self.weight.at(&cell),
                );
            },
            |builder| {
                builder.when(i.equals(j), |builder| {
                    let edge = builder.value(s - &b.share);
                    let edge = builder.value(edge.max(0.0));
                    builder.assign(value, &edge * &edge * &of_row);
                });
            },
        );
        value.into()
    }
}

/// Output along the virgin curve on one side of 0.
struct VirginTables {
    knots: Array,
    length: usize,
    coefficients: [Array; 3],
}

impl VirginTables {
    fn new(builder: &mut Builder, name: &str, knots: Vec<f64>, pieces: &[[f64; 3]]) -> Self {
        let coefficients = [0, 1, 2].map(|power| {
            builder.constants(&format!("{name}_{power}"), pieces.iter().map(|piece| piece[power]).collect())
        });
        let length = knots.len();
        Self { knots: builder.constants(&format!("{name}_knot"), knots), length, coefficients }
    }

    fn value(&self, builder: &mut Builder, h: &Real) -> Real {
        let size = builder.value(h.abs());
        // The first knot is 0.
        let piece = partition_point(builder, self.knots, 1, self.length - 1, &size);
        let is_inside = piece.below(self.length - 1);
        let distance = builder.value(is_inside.choose(&size - self.knots.at(&piece), 0.0));
        let [a, b, c] = self.coefficients.map(|array| array.at(&piece));
        builder.value(a + &distance * (b + &distance * c))
    }
}
