//! Peak-oriented law of structural members and joints: reloading leads to the largest displacement so far on that
//! side, along a curve that can be pinched; optionally the member softens beyond a cap and deteriorates with work.
//!
//! ```text
//! y   = c0 + k x + F_s s f,    d = s x/x_s,    s = ±1 the sign of the force          theory.md (8.37)
//! envelope:   E(d) = {h d + (1 - h) d/(1 + d^n)^{1/n}} C(d)                          theory.md (8.38), (8.39)
//! unloading:  k_u = [σ E(d_m)/d_m]^u from (d_r, f_r) to d_z = d_r - f_r/k_u          theory.md (8.43)
//!             f   = f_r (1 - q)/(1 + c_r q),    q = (d_r - d)/(d_r - d_z)            theory.md (8.44)
//! reloading:  f   = σ E(d_t) φ((d - d_0)/(d_t - d_0)) from (d_0, 0) to the target,   theory.md (8.41), (8.42)
//!             then σ E(d)
//! pinch:      φ_ω = τ_b + ω(φ_b - τ_b),    ω = 1 - {σ E(d_t)/(d_t - d_0)}/k_u        theory.md (8.40)
//! ```
//!
//! `x` is the input, a displacement, `y` the output, a force. On each side `d` counts the displacement in yield
//! displacements `x_s` and `f ≥ 0` the force in yield forces `F_s`. `d_m` is the largest `d` so far, `(d_r, f_r)`
//! the last turning point, `d_0` where the force last passed 0, `d_t` the target. `C`, `σ` and `d_t` follow from
//! [`Degradation`]; without it `C = σ = 1` and `d_t = d_m`. `d_t` is at least `min(1, √|d_0|)` where `d_0 < 0`: a
//! side that was not loaded before reloads to its yield point if `d_0 ≤ -1`, and a virgin member follows the
//! envelope.
//!
//! `φ` is the curve of a pinch point `(τ_b, φ_ω)`: below the diagonal the loops are pinched, above it they are
//! full. `ω` is 0 where reloading is as stiff as unloading, so small displacements and small loops are not
//! pinched. `c_r = c (1 - k_r/k_u)` with the stiffness `k_r = σ E(d_m)/d_m` likewise bends unloading only after
//! yielding.
//!
//! Properties: rate-independent. Between two passages through zero force every branch is a closed form in `x`, and
//! unloading that is reversed returns along itself; so the output depends on the turning points alone, not on the
//! sampling. `u = 0` unloads with the initial stiffness, `u = 1` towards the origin; for a member without
//! hardening `k_u` is `(x_y/x_m)^u` of Takeda. Source: Clough and Johnston (1966), Takeda, Sozen and Nielsen
//! (1970), Ibarra, Medina and Krawinkler (2005); the curves in place of broken lines are ours.

mod degradation;
mod envelope;
mod reloading;

use serde::{Deserialize, Serialize};

use crate::elementary::powf;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts};
use crate::law::properties::ODD;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;
pub use degradation::{BOUNDS as DEGRADATION_BOUNDS, Degradation};
use reloading::{Bend, unloading_area, unloading_share};

/// Bounds of `n`.
pub const N_BOUNDS: (f64, f64) = (0.5, 20.0);

/// Bounds of `c`.
pub const CURVATURE_BOUNDS: (f64, f64) = (0.0, 20.0);

/// Bounds of `τ_b` and `φ_b`.
pub const PINCH_BOUNDS: (f64, f64) = (0.01, 0.99);

/// Bounds of `w`.
pub const WEIGHT_BOUNDS: (f64, f64) = (0.1, 30.0);

/// Largest displacement, in yield displacements; its powers are finite.
const LARGEST_DISPLACEMENT: f64 = 1e100;

/// Least slope of a secant, so that a member that has lost all strength still divides by a number.
const LEAST_SECANT: f64 = 1e-30;

/// Nodes and weights of Gauss and Legendre's rule on 0 to 1.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
    (0.5, 0.284_444_444_444_444_43),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_24),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Strength and yield displacement of one side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Side {
    /// `F_s`: yield force, in the unit of the output; negative for an output that lags behind its input.
    pub strength: f64,
    /// `x_s > 0`: yield displacement, in the unit of the input.
    pub yield_displacement: f64,
}

/// A peak-oriented law in the user's units: `y = c0 + k x + F_s s f` (theory.md (8.37)), with `f` from the
/// equations of the [module page](self).
///
/// ```
/// use hysid_core::law::peak_oriented::PeakOriented;
/// use hysid_core::law::{Law, Sample};
/// let law = PeakOriented::new(100.0, 10.0)?; // yields at 100 kN and 10 mm
/// let mut state = law.virgin();
/// let mut force = |x| law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
/// assert!((force(1e4) - 100.0).abs() < 1e-3);
/// assert!((force(-1e4) + 100.0).abs() < 1e-3);
/// # Ok::<(), hysid_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeakOriented {
    /// `c0`, in the unit of the output.
    pub offset: f64,
    /// `k`: stiffness of a spring beside the member, in the unit of the output divided by that of the input;
    /// negative for the moment of an axial load.
    pub spring: f64,
    /// The side of positive forces, and both sides of a symmetric law.
    pub up: Side,
    /// The side of negative forces; that of positive ones if `None`.
    pub down: Option<Side>,
    /// `n`, 0.5 to 20: sharpness of yielding.
    pub n: f64,
    /// `h`, 0 to 1: hardening, the slope of the envelope after yielding divided by that at first.
    pub hardening: f64,
    /// `u`, 0 to 1: decrease of the unloading stiffness with the largest displacement.
    pub unloading: f64,
    /// `c`, 0 to 20: curvature of unloading.
    pub curvature: f64,
    /// `τ_b`, 0.01 to 0.99: place of the pinch point between zero force and the target.
    pub pinch_place: f64,
    /// `φ_b`, 0.01 to 0.99: height of the pinch point as a share of the force at the target.
    pub pinch_height: f64,
    /// `w`, 0.1 to 30: how closely reloading follows the two lines through the pinch point.
    pub pinch_weight: f64,
    /// Softening and deterioration, if any.
    pub degradation: Option<Degradation>,
}

/// The state: the present branch, the largest displacements and the dissipated work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakOrientedState {
    /// 0 for positive forces, 1 for negative ones; `None` before the first movement.
    side: Option<usize>,
    /// The present `d`.
    d: f64,
    /// Largest `d` so far on each side; not negative.
    peaks: [f64; 2],
    loading: LoadingBranch,
    unloading: Option<Unloading>,
    /// `e`, in yield forces times yield displacements.
    work: f64,
    /// `D`.
    deterioration: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct LoadingBranch {
    /// `d_0`.
    from: f64,
    /// `d_t`.
    target: f64,
    /// `σ E(d_t)`.
    top: f64,
    bend: Bend,
    /// `σ`.
    strength: f64,
}

/// A branch from a turning point to zero force.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unloading {
    /// `d_r`.
    from: f64,
    /// `f_r`.
    force: f64,
    /// `d_z`.
    zero: f64,
    /// `c_r`.
    curvature: f64,
}

impl PeakOriented {
    /// A symmetric law that yields at this force and displacement: without offset, spring, hardening and
    /// degradation, with a sharp yield point, straight unloading of the initial stiffness and straight
    /// reloading.
    ///
    /// # Errors
    /// As [`PeakOriented::validated`].
    pub fn new(strength: f64, yield_displacement: f64) -> Result<Self> {
        let law = Self {
            offset: 0.0,
            spring: 0.0,
            up: Side { strength, yield_displacement },
            down: None,
            n: N_BOUNDS.1,
            hardening: 0.0,
            unloading: 0.0,
            curvature: 0.0,
            pinch_place: 0.5,
            pinch_height: 0.5,
            pinch_weight: 1.0,
            degradation: None,
        };
        law.validated()
    }

    fn side(&self, side: usize) -> Side {
        if side == 0 { self.up } else { self.down.unwrap_or(self.up) }
    }

    /// `x` as `d` of a side.
    fn displacement(&self, side: usize, x: f64) -> f64 {
        let d = x / self.side(side).yield_displacement; // (8.37)
        (if side == 0 { d } else { -d }).clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT)
    }

    /// `E(d)` for `d ≥ 0`: the envelope before deterioration, in yield forces.
    pub fn envelope(&self, d: f64) -> f64 {
        let curve = envelope::hardening_curve(d, self.n, self.hardening); // (8.38)
        // (8.38), (8.39)
        self.degradation.map_or(curve, |degradation| curve * degradation.capped_share(d))
    }

    /// `σ` after the deterioration `D`.
    fn strength(&self, deterioration: f64) -> f64 {
        // (8.46)
        self.degradation.map_or(1.0, |degradation| 1.0 - degradation.strength_loss * deterioration)
    }

    /// `σ E(d_m)/d_m`: slope of the line from the origin to the envelope at the largest displacement.
    fn secant(&self, peak: f64, strength: f64) -> f64 {
        let secant = if peak > 0.0 { strength * self.envelope(peak) / peak } else { strength };
        secant.max(LEAST_SECANT)
    }

    /// The branch of a side that begins without force at `from`.
    fn loading(&self, state: &PeakOrientedState, side: usize, from: f64) -> LoadingBranch {
        let strength = self.strength(state.deterioration);
        let (peak, far) = (state.peaks[side], (-from).max(0.0));
        let (growth, loss) = self.degradation.map_or((0.0, 0.0), |degradation| {
            let Degradation { target_growth, pinching_growth, .. } = degradation;
            (target_growth * state.deterioration, pinching_growth * state.deterioration)
        });
        let target = (peak * (1.0 + growth)).max(far.sqrt().min(1.0)); // (8.46): d_t
        let top = if target > 0.0 { strength * self.envelope(target) } else { 0.0 };
        // (8.43): k_u
        let stiffness = powf(self.secant(if peak > 0.0 { peak } else { target }, strength), self.unloading);
        // `ω` (theory.md (8.40)).
        let room = if target > from { 1.0 - top / ((target - from) * stiffness) } else { 0.0 };
        // (8.40): φ_ω
        let height =
            self.pinch_place + room.clamp(0.0, 1.0) * (self.pinch_height * (1.0 - loss) - self.pinch_place);
        let bend = Bend { place: self.pinch_place, height, weight: self.pinch_weight };
        LoadingBranch { from, target, top, bend, strength }
    }

    /// The force on a branch at `d`, beyond its beginning.
    fn force(&self, loading: &LoadingBranch, d: f64) -> f64 {
        if d >= loading.target {
            return loading.strength * self.envelope(d.max(0.0)); // (8.41)
        }
        // (8.41)
        loading.top * loading.bend.height_at((d - loading.from) / (loading.target - loading.from))
    }

    /// The branch from a turning point at `from` on a branch.
    fn unloading(&self, loading: &LoadingBranch, peak: f64, from: f64) -> Unloading {
        let force = self.force(loading, from);
        let secant = self.secant(peak, loading.strength);
        let stiffness = powf(secant, self.unloading); // (8.43)
        let curvature = self.curvature * (1.0 - secant / stiffness).clamp(0.0, 1.0); // (8.44): c_r
        // Not beyond the point where the branch began: a small loop dissipates.
        let zero = (from - force / stiffness).max(loading.from).min(from); // (8.43): d_z
        Unloading { from, force, zero, curvature }
    }

    /// Work of a branch that was loaded and unloaded to zero force.
    fn dissipated(&self, loading: &LoadingBranch, unloading: &Unloading) -> f64 {
        let middle = loading.target.clamp(loading.from, unloading.from);
        let area = |from: f64, to: f64| {
            let at = |(node, weight): (f64, f64)| weight * self.force(loading, from + node * (to - from));
            if to > from { (to - from) * GAUSS.map(at).iter().sum::<f64>() } else { 0.0 }
        };
        // Apart, because the force bends at the target and at the yield point.
        let bend = middle.max(1.0).min(unloading.from);
        let gained = area(loading.from, middle) + area(middle, bend) + area(bend, unloading.from);
        let returned =
            unloading.force * (unloading.from - unloading.zero) * unloading_area(unloading.curvature);
        (gained - returned).max(0.0) // (8.45)
    }

    /// The force passes 0: the branch is complete, and one of the other side begins.
    fn pass_zero(&self, state: &mut PeakOrientedState, side: usize, unloading: &Unloading) {
        if let Some(degradation) = &self.degradation {
            // (8.45)
            state.work = (state.work + self.dissipated(&state.loading, unloading)).min(LARGEST_DISPLACEMENT);
            state.deterioration = degradation.deterioration(state.work); // (8.46)
        }
        let other = 1 - side;
        let ratio = self.side(side).yield_displacement / self.side(other).yield_displacement;
        let from = (-unloading.zero * ratio).clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT);
        state.side = Some(other);
        state.loading = self.loading(state, other, from);
        state.unloading = None;
    }

    /// Advances to the next input and returns the forces of both sides, in their yield forces.
    pub fn advance(&self, state: &mut PeakOrientedState, x: f64) -> [f64; 2] {
        let side = *state.side.get_or_insert(usize::from(x < 0.0));
        let d = self.displacement(side, x);
        if state.unloading.is_none() && d < state.d {
            let from = state.d;
            state.peaks[side] = state.peaks[side].max(from);
            state.unloading = Some(self.unloading(&state.loading, state.peaks[side], from));
        }
        state.d = d;
        let Some(unloading) = state.unloading else { return signed(side, self.force(&state.loading, d)) };
        if d >= unloading.from {
            state.unloading = None;
            return signed(side, self.force(&state.loading, d));
        }
        if d > unloading.zero {
            let share = (unloading.from - d) / (unloading.from - unloading.zero);
            return signed(side, unloading.force * unloading_share(share, unloading.curvature)); // (8.44)
        }
        self.pass_zero(state, side, &unloading);
        // Rounding must not put it before the beginning of the branch.
        let other = 1 - side;
        state.d = self.displacement(other, x).max(state.loading.from);
        signed(other, self.force(&state.loading, state.d))
    }
}

fn signed(side: usize, force: f64) -> [f64; 2] {
    if side == 0 { [force, 0.0] } else { [0.0, -force] }
}

impl Law for PeakOriented {
    type State = PeakOrientedState;

    const FACTS: Facts = Facts {
        variants: &["degradation", "asymmetric"],
        advice: &[
            (Behaviour::Degradation, Advised::FewerParameters("members and joints; option degradation")),
            (Behaviour::Pinching, Advised::FewerParameters("members and joints, pinched or full")),
        ],
        ..Facts::searched(
            "peak-oriented",
            "members and joints: reloading leads to the largest displacement so far",
            &["asymmetric", "degradation", "starts", "epochs"],
            ErrorsInside { softening: 0.15, sigmoid: 0.25, other: 0.2 },
        )
        .with_defaults(&[("starts", 16)])
    };

    fn virgin(&self) -> PeakOrientedState {
        let bend = Bend { place: 0.5, height: 0.5, weight: 1.0 };
        PeakOrientedState {
            side: None,
            d: 0.0,
            peaks: [0.0; 2],
            loading: LoadingBranch { from: 0.0, target: 0.0, top: 0.0, bend, strength: 1.0 },
            unloading: None,
            work: 0.0,
            deterioration: 0.0,
        }
    }

    fn step(&self, state: &mut PeakOrientedState, sample: Sample) -> f64 {
        let x = sample.limited().x;
        let [up, down] = self.advance(state, x);
        let force = self.side(0).strength * up + self.side(1).strength * down;
        (self.offset + self.spring * x + force).clamp(-f64::MAX, f64::MAX) // (8.37)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let mut all = Parameter::table([
            ("c0", "output at rest", self.offset, any, Dimension::OUTPUT),
            ("k", "stiffness of the spring beside the member", self.spring, any, Dimension::SLOPE),
        ]);
        let names = [("F+", "x+"), ("F-", "x-")];
        let sides = [Some(self.up), self.down];
        for ((strength, displacement), side) in names.into_iter().zip(sides) {
            let Some(side) = side else { continue };
            all.extend(Parameter::table([
                (strength, "yield force", side.strength, any, Dimension::OUTPUT),
                (displacement, "yield displacement", side.yield_displacement, positive, Dimension::INPUT),
            ]));
        }
        let share = (0.0, 1.0);
        let numbers = [
            ("n", "sharpness of yielding", self.n, N_BOUNDS),
            ("h", "hardening", self.hardening, share),
            ("u", "decrease of the unloading stiffness", self.unloading, share),
            ("c", "curvature of unloading", self.curvature, CURVATURE_BOUNDS),
            ("τ_b", "place of the pinch point", self.pinch_place, PINCH_BOUNDS),
            ("φ_b", "height of the pinch point", self.pinch_height, PINCH_BOUNDS),
            ("w", "sharpness of the pinch", self.pinch_weight, WEIGHT_BOUNDS),
        ];
        all.extend(numbers.map(|(symbol, meaning, value, bounds)| {
            Parameter::new(symbol, meaning, value, bounds, Dimension::NONE)
        }));
        all.extend(self.degradation.iter().flat_map(Degradation::parameters));
        all
    }

    fn validated(self) -> Result<Self> {
        Parameter::check_all(&self.parameters(), "peak-oriented")?;
        let [up, down] = [0, 1].map(|side| self.side(side).yield_displacement);
        if !(1e-6..=1e6).contains(&(up / down)) {
            return Err(Error::Parts(
                "peak-oriented: the yield displacements of the two sides differ by more than a factor of 1e6"
                    .into(),
            ));
        }
        Ok(self)
    }

    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
        (self.down.is_none() && about_origin).then_some(ODD).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cbrt, exp, powi};
    use crate::law::test_paths::{assert_finite, numbers, refined, run};

    fn member() -> PeakOriented {
        PeakOriented {
            offset: 0.7,
            spring: -0.3,
            up: Side { strength: 90.0, yield_displacement: 8.0 },
            down: Some(Side { strength: 70.0, yield_displacement: 6.0 }),
            n: 3.0,
            hardening: 0.05,
            unloading: 0.4,
            curvature: 2.0,
            pinch_place: 0.6,
            pinch_height: 0.25,
            pinch_weight: 1.5,
            degradation: Some(Degradation::from_values([4.0, 1.5, 0.3, 30.0, 1.2, 0.4, 0.3, 0.5])),
        }
    }

    #[test]
    fn a_member_without_strength_has_a_finite_force() {
        let degradation = Degradation::from_values([2.0, 0.5, 0.0, 0.01, 1.0, 1.0, 1.0, 1.0]);
        let law = PeakOriented {
            unloading: 0.5,
            curvature: 1.0,
            degradation: Some(degradation),
            ..PeakOriented::new(1.0, 1.0).unwrap()
        };
        let mut state = law.virgin();
        for x in [5.0, -5.0, 5.0, 1e90, -1e100, 3.0, 4.0, -3.0, 0.0, 1.0] {
            let y = law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
            assert!(y.is_finite(), "{y} at {x:e}");
        }
        assert_eq!(law.strength(state.deterioration), 0.0);
    }

    #[test]
    fn monotone_loading_is_the_envelope() {
        let law = member();
        let envelope = |d: f64| {
            let curve = 0.05 * d + 0.95 * d / cbrt(1.0 + powi(d, 3));
            let beyond = ((d / 4.0 - 1.0) / 1.5).max(0.0);
            curve * (0.3 + 0.7 / (1.0 + beyond * beyond))
        };
        for x in [0.5, 3.0, 8.0, 20.0, 50.0, 200.0] {
            let up = 0.7 - 0.3 * x + 90.0 * envelope(x / 8.0);
            let down = 0.7 + 0.3 * x - 70.0 * envelope(x / 6.0);
            assert!((run(&law, &[0.0, 0.3 * x, x])[2] - up).abs() < 1e-10, "{x}");
            assert!((run(&law, &[-x])[0] - down).abs() < 1e-10, "{x}");
        }
    }

    /// By hand: 100 kN at 10 mm; back along 10 kN/mm; from (10 mm, 0) straight to the yield point of the other side,
    /// from (-10 mm, 0) straight to the largest displacement of this side.
    #[test]
    fn clough_s_member_by_hand() {
        let law = PeakOriented::new(100.0, 10.0).unwrap();
        // The envelope is rounded at the yield point.
        let corner = 100.0 * powf(0.5, 1.0 / 20.0);
        let path = [20.0, 15.0, 10.0, 0.0, -10.0, -20.0, -15.0, -10.0, 5.0, 20.0, 30.0];
        let expected = [100.0, 50.0, 0.0, -0.5 * corner, -corner, -100.0, -50.0, 0.0, 50.0, 100.0, 100.0];
        for (force, expected) in run(&law, &path).iter().zip(expected) {
            assert!((force - expected).abs() < 1e-4, "{force} and {expected}");
        }
    }

    /// By hand: with `u = 1/2` the member that has gone to four yield displacements unloads with half its
    /// stiffness, to two of them. Of the curvature `c = 3` one half applies, and `(1 - q)/(1 + 3q/2)` is 1/2 at
    /// `q = 2/7`.
    #[test]
    fn unloading_softens_with_the_peak_and_bends() {
        let straight = PeakOriented { unloading: 0.5, ..PeakOriented::new(100.0, 10.0).unwrap() };
        let forces = run(&straight, &[40.0, 30.0, 20.0]);
        assert!((forces[1] - 50.0).abs() < 1e-6 && forces[2].abs() < 1e-6, "{forces:?}");
        let bent = PeakOriented { curvature: 3.0, ..straight };
        let forces = run(&bent, &[40.0, 40.0 - 20.0 * 2.0 / 7.0, 20.0]);
        assert!((forces[1] - 50.0).abs() < 1e-5 && forces[2].abs() < 1e-6, "{forces:?}");
    }

    /// By hand: from (-10 mm, 0) to (20 mm, 100 kN) the straight line has a third of the stiffness of unloading, so
    /// `ω` is 2/3; the pinch point (1/2, 1/10) comes to 1/2 - 2/3 (1/2 - 1/10) = 7/30 of the force, and the parabola
    /// in the middle to (2 · 7/30 + 1)/4 = 11/30.
    #[test]
    fn reloading_is_pinched_by_its_room() {
        let law = PeakOriented { pinch_height: 0.1, ..PeakOriented::new(100.0, 10.0).unwrap() };
        let forces = run(&law, &[20.0, -20.0, -10.0, 5.0, 20.0]);
        assert!((forces[3] - 1100.0 / 30.0).abs() < 1e-4, "{forces:?}");
        assert!((forces[4] - 100.0).abs() < 1e-4, "{forces:?}");
    }

    /// By hand: up to 20 mm and back to 10 mm the work is 1000 kN mm, one yield force times the yield displacement.
    #[test]
    fn strength_and_target_deteriorate_with_work() {
        let degradation = Degradation::from_values([1e6, 1e3, 1.0, 2.0, 1.0, 0.5, 1.0, 0.0]);
        let law = PeakOriented { degradation: Some(degradation), ..PeakOriented::new(100.0, 10.0).unwrap() };
        let mut state = law.virgin();
        for x in [20.0, 9.0] {
            law.advance(&mut state, x);
        }
        assert!((state.work - 1.0).abs() < 5e-3, "{}", state.work);
        let deterioration = 1.0 - exp(-state.work / 2.0);
        assert_eq!(state.deterioration, deterioration);
        let [_, down] = law.advance(&mut state, -60.0);
        assert!((down + 1.0 - 0.5 * deterioration).abs() < 1e-6, "{down}");
        // Upwards the target is beyond the 20 mm that were reached.
        law.advance(&mut state, 0.0);
        let [up, _] = law.advance(&mut state, 20.0);
        let growth = 1.0 + state.deterioration;
        let zero = state.loading.from;
        assert!((state.loading.target - 2.0 * growth).abs() < 1e-12);
        let expected = (1.0 - 0.5 * state.deterioration) * (2.0 - zero) / (2.0 * growth - zero);
        assert!((up - expected).abs() < 1e-6, "{up} and {expected}");
    }

    #[test]
    fn rows_between_turning_points_change_nothing() {
        let law = member();
        let turning: Vec<f64> =
            numbers(12_345, 200).iter().enumerate().map(|(k, u)| u * 0.2 * (k as f64 + 5.0)).collect();
        let (coarse, fine) = (run(&law, &turning), run(&law, &refined(&turning, 9)));
        for (index, force) in coarse.iter().enumerate() {
            assert!((force - fine[9 * index + 8]).abs() < 1e-9, "turning point {index}");
        }
    }

    #[test]
    fn unloading_that_is_reversed_returns_along_itself() {
        let law = member();
        let whole = run(&law, &[-30.0, 10.0, 14.0, 30.0]);
        let broken = run(&law, &[-30.0, 10.0, 8.5, 9.5, 8.0, 10.0, 14.0, 13.0, 30.0]);
        assert_eq!([whole[1], whole[2], whole[3]], [broken[5], broken[6], broken[8]]);
    }

    #[test]
    fn outputs_stay_within_their_bound_however_wild() {
        let extremes = [1e-300, 1e-100, 1e-3, 1.0, 1e6, 1e99];
        for (index, u) in numbers(12_345, 300).into_iter().enumerate() {
            let pick = |by: usize| extremes[(index / by) % extremes.len()];
            let law = PeakOriented {
                up: Side { strength: -pick(1), yield_displacement: pick(6) },
                down: (u > 0.0).then(|| Side { strength: pick(2), yield_displacement: pick(6) * 3.0 }),
                n: if u > 0.5 { 0.5 } else { 20.0 },
                unloading: u.abs(),
                pinch_weight: if u > 0.3 { 30.0 } else { 0.1 },
                ..member()
            };
            let path: Vec<f64> = numbers(12_345, 60).iter().map(|v| v * pick(3)).collect();
            assert_finite(&law, &path);
        }
    }

    #[test]
    fn sides_of_very_different_size_are_rejected() {
        let down = Side { strength: 1.0, yield_displacement: 1e-9 };
        let error = PeakOriented { down: Some(down), ..member() }.validated().unwrap_err().to_string();
        assert!(error.contains("factor of 1e6"), "{error}");
        assert!(PeakOriented::new(1.0, 0.0).is_err());
    }
}
