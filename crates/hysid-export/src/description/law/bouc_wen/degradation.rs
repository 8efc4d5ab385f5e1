//! Degradation and pinching of a Bouc-Wen element (theory.md (8.8) to (8.11), (8.52)).

use hysid_core::law::bouc_wen::Degradation;

use crate::program::Builder;
use crate::program::expression::{Real, RealVariable};

// Numbers of the library's solver.
const LARGEST_ENERGY: f64 = 1e9;
const QUICK: f64 = 4.0;
const AT_REST: f64 = 1e-3;
const SLOW: f64 = 3e-3;
const STEADY: f64 = 3e-5;
const SUNK: f64 = 0.02;
const NEARLY_AT_REST: f64 = 0.003;

pub(super) fn limited(builder: &mut Builder, e: &Real) -> Real {
    builder.value(e.clamp(0.0, LARGEST_ENERGY))
}

/// `A`, `ν`, `η`, `ζ1`, `ζ2` and the centre of the pinched range at one energy.
pub(super) struct ElementProperties {
    a: Real,
    nu: Real,
    eta: Real,
    zeta_1: Real,
    zeta_2: Real,
    centre: Real,
}

impl ElementProperties {
    /// `dz/dx` on the way up (theory.md (8.6)).
    pub fn slope(&self, builder: &mut Builder, z: &Real, softening: &Real) -> Real {
        let pinching = self.pinching(builder, z);
        builder.value(pinching / &self.eta * (&self.a - &self.nu * softening))
    }

    /// `h` (theory.md (8.10))
    fn pinching(&self, builder: &mut Builder, z: &Real) -> Real {
        let distance = builder.value((z - &self.centre) / &self.zeta_2);
        builder.value(1.0 - &self.zeta_1 * (-&distance * &distance).exp())
    }
}

/// A steady lag behind the yield force: `z`, the way on which that force sinks a little, and 1 if there is one.
struct Steady {
    z: Real,
    way: Real,
    exists: Real,
}

pub(super) struct DegradingElement<'a> {
    pub degradation: &'a Degradation,
    pub n: f64,
}

impl DegradingElement<'_> {
    /// The properties after the dissipated energy `e`.
    pub fn properties(&self, builder: &mut Builder, e: &Real) -> ElementProperties {
        let d = self.degradation;
        let e = limited(builder, e);
        let a = builder.value(1.0 - d.delta_a * &e);
        let nu = builder.value(1.0 + d.delta_nu * &e);
        let zeta_1 = builder.value(d.zeta_s * (1.0 - (-d.p * &e).exp()));
        ElementProperties {
            a: builder.value(a.max(0.0)),
            eta: builder.value(1.0 + d.delta_eta * &e),
            zeta_2: builder.value((d.psi_0 + d.delta_psi * &e) * (d.lambda + &zeta_1)),
            centre: builder.value(d.q * nu.powf(-1.0 / self.n)),
            nu,
            zeta_1,
        }
    }

    /// `z` at which the element yields on the way up.
    fn ultimate(&self, builder: &mut Builder, e: &Real) -> Real {
        let d = self.degradation;
        let a = builder.value(1.0 - d.delta_a * e);
        let strength = builder.value(a.max(0.0) / (1.0 + d.delta_nu * e));
        // The power of 0 is 0, with the slope 0.
        builder.value(strength.above(0.0).choose(strength.powf(1.0 / self.n), 0.0))
    }

    /// `ν/η`
    fn loss_ratio(&self, builder: &mut Builder, e: &Real) -> Real {
        let d = self.degradation;
        builder.value((1.0 + d.delta_nu * e) / (1.0 + d.delta_eta * e))
    }

    /// How much faster it comes to rest at its yield force than the untouched one.
    pub fn quickness(&self, builder: &mut Builder, z: &Real, e: &Real) -> Real {
        let ultimate = self.ultimate(builder, e);
        let size = builder.value(z.abs());
        let largest = builder.value(size.max(&ultimate));
        let ratio = self.loss_ratio(builder, e);
        builder.value(ratio * largest.powf(self.n - 1.0))
    }

    /// Parts for a yield displacement that a narrow pinched range requires.
    pub fn narrowness(&self) -> f64 {
        let d = self.degradation;
        (0.5 / (d.psi_0 * (d.lambda + d.zeta_s))).clamp(1.0, 2.0)
    }

    /// 1 if it has come to its yield force and will only follow it.
    pub fn is_at_rest(&self, builder: &mut Builder, z: &Real, e: &Real) -> Real {
        let rests = builder.variable(0.0);
        let ratio = self.loss_ratio(builder, e);
        builder.when(z.at_least(0.0).and(ratio.above(QUICK)), |builder| {
            let quickness = self.quickness(builder, z, e);
            builder.when(quickness.above(QUICK), |builder| {
                let ultimate = self.ultimate(builder, e);
                let distance = builder.value((z - &ultimate).abs());
                let near = distance.at_most(AT_REST * &ultimate + 1e-9);
                builder.assign(rests, near.choose(1.0, 0.0));
            });
        });
        rests.into()
    }

    /// Yields upwards by `by`.
    pub fn yields(&self, builder: &mut Builder, (z, e): (RealVariable, RealVariable), by: &Real) {
        let middle = builder.value(Real::from(e) + 0.5 * by * Real::from(z));
        let middle = limited(builder, &middle);
        let middle = self.ultimate(builder, &middle);
        let energy = builder.value(Real::from(e) + by * middle);
        let energy = limited(builder, &energy);
        let end = self.ultimate(builder, &energy);
        builder.assign(z, end);
        builder.assign(e, energy);
    }

    fn steady(&self, builder: &mut Builder, e: &Real) -> Steady {
        let d = self.degradation;
        let properties = self.properties(builder, e);
        let ultimate = self.ultimate(builder, e);
        let drift =
            builder.value((d.delta_a / properties.a.clone() + d.delta_nu / properties.nu.clone()) / self.n);
        let pinching = properties.pinching(builder, &ultimate);
        let pull = builder.value(pinching * self.n * &properties.a / (&properties.eta * &ultimate));
        let lag = builder.value(&drift * &ultimate / pull);
        let exists = builder.value(lag.at_most(SLOW).choose(1.0, 0.0));
        let way = builder.value(SUNK / (drift * &ultimate));
        Steady { z: builder.value(ultimate * (1.0 + lag)), way, exists }
    }

    /// Moves along the yield force as far as it follows that steadily, if it hardly moved in the last part.
    pub fn follows(
        &self,
        builder: &mut Builder,
        (z, e): (RealVariable, RealVariable),
        left: RealVariable,
        (before, part): (&Real, &Real),
    ) {
        let moved = builder.value((Real::from(z) - before).abs());
        let hardly_moves = moved.at_most(NEARLY_AT_REST * self.n * part);
        let follows = builder.variable(hardly_moves.choose(1.0, 0.0));
        let goes_on = Real::from(follows).above(0.0).and(Real::from(left).above(0.0));
        builder.while_true(goes_on.and(Real::from(z).above(0.0)), |builder| {
            builder.assign(follows, 0.0);
            let first = self.steady(builder, &e.into());
            let distance = builder.value((Real::from(z) - &first.z).abs());
            let is_steady = first.exists.above(0.0).and(distance.above(STEADY * &first.z).negated());
            builder.when(is_steady, |builder| {
                let by = builder.value(Real::from(left).min(&first.way));
                let energy = builder.value(Real::from(e) + 0.5 * &by * &first.z);
                let energy = limited(builder, &energy);
                let middle = self.steady(builder, &energy);
                builder.when(middle.exists.above(0.0), |builder| {
                    let energy = builder.value(Real::from(e) + &by * &middle.z);
                    let energy = limited(builder, &energy);
                    let last = self.steady(builder, &energy);
                    builder.when(last.exists.above(0.0), |builder| {
                        builder.assign(z, last.z.min(1.0));
                        builder.assign(e, &energy);
                        builder.assign(left, Real::from(left) - &by);
                        builder.assign(follows, 1.0);
                    });
                });
            });
        });
    }
}
