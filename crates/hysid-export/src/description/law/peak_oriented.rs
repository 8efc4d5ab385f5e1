//! Peak-oriented law of members and joints, with pinching, softening and deterioration.

use hysid_core::law::peak_oriented::{Degradation, PeakOriented};

use super::yield_curve::yielding;
use crate::description::{PartInputs, limited};
use crate::program::expression::{Real, Whole, WholeVariable};
use crate::program::{Array, Builder};

// Numbers of the library.
const LARGEST_DISPLACEMENT: f64 = 1e100;
const LEAST_SECANT: f64 = 1e-30;
const GAUSS_NODES: [f64; 5] =
    [0.046_910_077_030_668, 0.230_765_344_947_158_45, 0.5, 0.769_234_655_052_841_6, 0.953_089_922_969_332];
const GAUSS_WEIGHTS: [f64; 5] = [
    0.118_463_442_528_094_54,
    0.239_314_335_249_683_24,
    0.284_444_444_444_444_43,
    0.239_314_335_249_683_24,
    0.118_463_442_528_094_54,
];

/// `y = c0 + k x + F_s s f` (theory.md (8.37))
pub(super) fn step(builder: &mut Builder, name: &str, law: &PeakOriented, sample: &PartInputs) -> Real {
    let member = PeakOrientedMember::new(builder, name, law);
    let x = limited(builder, &sample.inputs[0]);
    let side = builder.counter(member.side, 0_usize, -1.0, 1.0);
    builder.when(Whole::from(side).below(0_usize), |builder| {
        builder.assign_whole(side, 0_usize);
        builder.when(x.below(0.0), |builder| builder.assign_whole(side, 1));
    });
    let f = member.advance(builder, side, &x);
    builder.set(member.side, 0_usize, Whole::from(side).to_real());
    let is_up = Whole::from(side).equals(0_usize);
    let (up, down) = (is_up.clone().choose(&f, 0.0), is_up.choose(0.0, -&f));
    let down_strength = law.down.unwrap_or(law.up).strength;
    let force = builder.value(law.up.strength * up + down_strength * down);
    let y = builder.value(law.offset + law.spring * &x + force);
    builder.value(y.clamp(-f64::MAX, f64::MAX))
}

/// The law with its state.
struct PeakOrientedMember<'a> {
    law: &'a PeakOriented,
    yield_displacement: Array,
    /// 0 for positive forces, 1 for negative ones; -1 before the first movement.
    side: Array,
    d: Array,
    peaks: Array,
    /// `d_0`, `d_t`, `σ E(d_t)`, the height of the pinch point and `σ` of the branch.
    loading: [Array; 5],
    /// 1 while unloading; `d_r`, `f_r`, `d_z` and `c_r`.
    unloads: Array,
    unloading: [Array; 4],
    work: Array,
    deterioration: Array,
    nodes: Array,
    weights: Array,
}

/// The branch from zero force to its target: `d_0`, `d_t`, `σ E(d_t)`, the height of the pinch point and `σ`.
struct LoadingPath([Real; 5]);

impl<'a> PeakOrientedMember<'a> {
    fn new(builder: &mut Builder, name: &str, law: &'a PeakOriented) -> Self {
        let displacements = [law.up, law.down.unwrap_or(law.up)].map(|side| side.yield_displacement);
        let yield_displacement =
            builder.constants(&format!("{name}_yield_displacement"), displacements.to_vec());
        let nodes = builder.constants(&format!("{name}_node"), GAUSS_NODES.to_vec());
        let weights = builder.constants(&format!("{name}_node_weight"), GAUSS_WEIGHTS.to_vec());
        let mut state =
            |part: &str, initial: &[f64]| builder.state(&format!("{name}_{part}"), initial.to_vec());
        Self {
            law,
            yield_displacement,
            side: state("side", &[-1.0]),
            d: state("d", &[0.0]),
            peaks: state("peak", &[0.0, 0.0]),
            loading: [("from", 0.0), ("target", 0.0), ("top", 0.0), ("pinch", 0.5), ("strength", 1.0)]
                .map(|(part, initial)| state(part, &[initial])),
            unloads: state("unloads", &[0.0]),
            unloading: ["turned_at", "turned_force", "zero", "curvature"].map(|part| state(part, &[0.0])),
            work: state("work", &[0.0]),
            deterioration: state("deterioration", &[0.0]),
            nodes,
            weights,
        }
    }

    /// `x` as `d` of a side.
    fn displacement(&self, builder: &mut Builder, side: &Whole, x: &Real) -> Real {
        let d = builder.value(x / self.yield_displacement.at(side));
        let d = builder.value(side.equals(0_usize).choose(&d, -&d));
        builder.value(d.clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT))
    }

    /// Advances to the next input, and gives the force of the side, which may have become the other one.
    fn advance(&self, builder: &mut Builder, side_variable: WholeVariable, x: &Real) -> Real {
        let side = Whole::from(side_variable);
        let d = self.displacement(builder, &side, x);
        let turns = self.unloads.at(0_usize).equals(0.0).and(d.below(self.d.at(0_usize)));
        builder.when(turns, |builder| self.turn(builder, &side));
        builder.set(self.d, 0_usize, &d);
        let (f, is_known) = (builder.variable(0.0), builder.variable(0.0));
        builder.when(self.unloads.at(0_usize).above(0.0), |builder| {
            let [from, force, zero, curvature] = self.unloading.map(|array| builder.value(array.at(0_usize)));
            builder.when_else(
                d.at_least(&from),
                |builder| builder.set(self.unloads, 0_usize, 0.0),
                |builder| {
                    builder.when_else(
                        d.above(&zero),
                        |builder| {
                            let q = builder.value((&from - &d) / (&from - &zero));
                            builder.assign(f, &force * ((1.0 - &q) / (1.0 + &curvature * &q)));
                            builder.assign(is_known, 1.0);
                        },
                        |builder| {
                            self.pass_zero(builder, side_variable);
                            let d = self.displacement(builder, &side, x);
                            // Rounding must not put it before the beginning of the branch.
                            builder.set(self.d, 0_usize, d.max(self.loading[0].at(0_usize)));
                        },
                    );
                },
            );
        });
        builder.when(Real::from(is_known).equals(0.0), |builder| {
            let d = builder.value(self.d.at(0_usize));
            let loading = self.present(builder);
            let force = self.force(builder, &loading, &d);
            builder.assign(f, force);
        });
        f.into()
    }

    fn present(&self, builder: &mut Builder) -> LoadingPath {
        LoadingPath(self.loading.map(|array| builder.value(array.at(0_usize))))
    }

    /// `E(d)` for `d ≥ 0` (theory.md (8.38), (8.39)).
    fn envelope(&self, builder: &mut Builder, d: &Real) -> Real {
        let h = self.law.hardening;
        let curve = yielding(builder, d, &self.law.n.into());
        let curve = builder.value(h * d + (1.0 - h) * curve);
        match self.law.degradation {
            None => curve,
            Some(Degradation { cap, softening, residual, .. }) => {
                let beyond = builder.value(d / cap - 1.0);
                let beyond = builder.value(beyond.max(0.0) / softening);
                builder.value(curve * (residual + (1.0 - residual) / (1.0 + &beyond * &beyond)))
            }
        }
    }

    /// `σ`
    fn strength(&self, builder: &mut Builder) -> Real {
        match self.law.degradation {
            None => Real::Constant(1.0),
            Some(degradation) => {
                builder.value(1.0 - degradation.strength_loss * self.deterioration.at(0_usize))
            }
        }
    }

    /// `σ E(d_m)/d_m`
    fn secant(&self, builder: &mut Builder, peak: &Real, strength: &Real) -> Real {
        let secant = builder.variable(strength);
        builder.when(peak.above(0.0), |builder| {
            let envelope = self.envelope(builder, peak);
            builder.assign(secant, strength * envelope / peak);
        });
        let secant = Real::from(secant);
        builder.value(secant.max(LEAST_SECANT))
    }

    /// Begins the branch of a side that is without force at `from` (theory.md (8.40) to (8.42)).
    fn begin(&self, builder: &mut Builder, side: &Whole, from: &Real) {
        let law = self.law;
        let strength = self.strength(builder);
        let peak = builder.value(self.peaks.at(side));
        let (growth, loss) = match law.degradation {
            None => (Real::Constant(0.0), Real::Constant(0.0)),
            Some(Degradation { target_growth, pinching_growth, .. }) => (
                builder.value(target_growth * self.deterioration.at(0_usize)),
                builder.value(pinching_growth * self.deterioration.at(0_usize)),
            ),
        };
        let far = builder.value(-from);
        let far = builder.value(far.max(0.0));
        let root = builder.value(far.sqrt());
        let least = builder.value(root.min(1.0));
        let grown = builder.value(&peak * (1.0 + growth));
        let target = builder.value(grown.max(&least));
        let top = builder.variable(0.0);
        builder.when(target.above(0.0), |builder| {
            let envelope = self.envelope(builder, &target);
            builder.assign(top, &strength * envelope);
        });
        let top = Real::from(top);
        let of = builder.value(peak.above(0.0).choose(&peak, &target));
        let secant = self.secant(builder, &of, &strength);
        let stiffness = builder.value(secant.powf(law.unloading));
        let room = builder.variable(0.0);
        builder.when(target.above(from), |builder| {
            builder.assign(room, 1.0 - &top / ((&target - from) * &stiffness));
        });
        let room = builder.value(Real::from(room).clamp(0.0, 1.0));
        let height = law.pinch_place + room * (law.pinch_height * (1.0 - loss) - law.pinch_place);
        for (array, value) in self.loading.into_iter().zip([from.clone(), target, top, height, strength]) {
            builder.set(array, 0_usize, value);
        }
    }

    /// The force on a branch at `d`, beyond its beginning.
    fn force(&self, builder: &mut Builder, loading: &LoadingPath, d: &Real) -> Real {
        let LoadingPath([from, target, top, height, strength]) = loading;
        let f = builder.variable(0.0);
        builder.when_else(
            d.at_least(target),
            |builder| {
                let d = builder.value(d.max(0.0));
                let envelope = self.envelope(builder, &d);
                builder.assign(f, strength * envelope);
            },
            |builder| {
                let share = builder.value((d - from) / (target - from));
                let bend = self.bend(builder, height, &share);
                builder.assign(f, top * bend);
            },
        );
        f.into()
    }

    /// `φ` at `τ`: the curve of a pinch point.
    fn bend(&self, builder: &mut Builder, height: &Real, share: &Real) -> Real {
        let twice = 2.0 * self.law.pinch_weight;
        let linear =
            builder.value(twice * self.law.pinch_place - 2.0 * share * (self.law.pinch_weight - 1.0));
        let square = builder.value(1.0 - &linear);
        let root = builder.value(&linear * &linear + 4.0 * &square * share);
        let root = builder.value(root.max(0.0));
        let root = builder.value(root.sqrt());
        let t = builder.value(
            linear.above(0.0).choose(2.0 * share / (&linear + &root), (&root - &linear) / (2.0 * &square)),
        );
        let t = builder.value(t.clamp(0.0, 1.0));
        let middle = builder.value(twice * &t * (1.0 - &t));
        let end = builder.value(&t * &t);
        builder.value((&middle * height + &end) / ((1.0 - &t) * (1.0 - &t) + &middle + &end))
    }

    /// The input turns: a branch of unloading begins (theory.md (8.43)).
    fn turn(&self, builder: &mut Builder, side: &Whole) {
        let law = self.law;
        let from = builder.value(self.d.at(0_usize));
        let before = builder.value(self.peaks.at(side));
        let peak = builder.value(before.max(&from));
        builder.set(self.peaks, side, &peak);
        let loading = self.present(builder);
        let force = self.force(builder, &loading, &from);
        let secant = self.secant(builder, &peak, &loading.0[4]);
        let stiffness = builder.value(secant.powf(law.unloading));
        let softer = builder.value(1.0 - &secant / &stiffness);
        let curvature = law.curvature * softer.clamp(0.0, 1.0);
        // Not beyond the point where the branch began: a small loop dissipates.
        let zero = builder.value(&from - &force / &stiffness);
        let zero = builder.value(zero.max(&loading.0[0]));
        let zero = zero.min(&from);
        for (array, value) in self.unloading.into_iter().zip([from, force, zero, curvature]) {
            builder.set(array, 0_usize, value);
        }
        builder.set(self.unloads, 0_usize, 1.0);
    }

    /// The force passes 0: the branch is complete, and one of the other side begins.
    fn pass_zero(&self, builder: &mut Builder, side_variable: WholeVariable) {
        let side = Whole::from(side_variable);
        if let Some(Degradation { endurance, pace, .. }) = self.law.degradation {
            let done = self.dissipated(builder);
            let work = builder.value(self.work.at(0_usize) + done);
            let work = builder.value(work.min(LARGEST_DISPLACEMENT));
            builder.set(self.work, 0_usize, &work);
            builder.set(self.deterioration, 0_usize, -(-(work / endurance).powf(pace)).exp_m1());
        }
        let before = builder.value(self.yield_displacement.at(&side));
        builder.assign_whole(side_variable, Whole::from(1_usize) - &side);
        let ratio = builder.value(before / self.yield_displacement.at(&side));
        let from = builder.value(-self.unloading[2].at(0_usize) * ratio);
        let from = builder.value(from.clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT));
        self.begin(builder, &side, &from);
        builder.set(self.unloads, 0_usize, 0.0);
    }

    /// Work of the branch that was loaded and unloaded.
    fn dissipated(&self, builder: &mut Builder) -> Real {
        let loading = self.present(builder);
        let [turned, force, zero, curvature] = self.unloading.map(|array| builder.value(array.at(0_usize)));
        let LoadingPath([from, target, ..]) = &loading;
        let middle = builder.value(target.clamp(from, &turned));
        // Apart, because the force bends at the target and at the yield point.
        let yielded = builder.value(middle.max(1.0));
        let bend = builder.value(yielded.min(&turned));
        let first = self.area(builder, &loading, from, &middle);
        let second = self.area(builder, &loading, &middle, &bend);
        let third = self.area(builder, &loading, &bend, &turned);
        let share = builder.variable(0.5 - &curvature / 6.0);
        builder.when(curvature.at_least(1e-4), |builder| {
            let area = ((1.0 + &curvature) * curvature.ln_1p() - &curvature) / (&curvature * &curvature);
            builder.assign(share, area);
        });
        let returned = force * (turned - zero) * Real::from(share);
        let work = builder.value(first + second + third - returned);
        builder.value(work.max(0.0))
    }

    fn area(&self, builder: &mut Builder, loading: &LoadingPath, from: &Real, to: &Real) -> Real {
        let sum = builder.variable(-0.0);
        builder.when(to.above(from), |builder| {
            builder.each(0_usize, GAUSS_NODES.len(), |builder, k| {
                let d = builder.value(from + self.nodes.at(&k) * (to - from));
                let force = self.force(builder, loading, &d);
                builder.assign(sum, Real::from(sum) + self.weights.at(&k) * force);
            });
            builder.assign(sum, (to - from) * Real::from(sum));
        });
        // Nothing without a way.
        builder.value(to.above(from).choose(sum, 0.0))
    }
}
