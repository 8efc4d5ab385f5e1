//! Reinforced-concrete beam-column joint: a Bouc-Wen-Baber-Noori element, which loses strength and stiffness
//! and pinches as it dissipates energy, in a slow cyclic test with growing amplitude.
//!
//! ```text
//! f      = S (α ξ + (1 - α) z),   ξ = x/X                                  theory.md (6.4)
//! dz/dξ  = h/η [A - ν |z|^n (β sgn(z dξ) + γ)]                             theory.md (6.5)
//! de/dξ  = (1 - α) κ z                                                     theory.md (6.6)
//! A = max(0, A0 - δA e),   ν = ν0 + δν e,   η = η0 + δη e                  theory.md (6.7)
//! h      = 1 - ζ1 exp(-(z sgn dξ - q z_u)²/ζ2²)                            theory.md (6.8)
//! z_u    = (ν (β + γ))^{-1/n},   ζ1 = ζs (1 - e^{-pe}),   ζ2 = (ψ0 + δψ e)(λ + ζ1)   theory.md (6.9)
//! ```
//!
//! `x` is the displacement in mm, `f` the force in kN, `z` the hysteretic part of the displacement and `e`
//! the energy dissipated so far. The displacement is prescribed, so there are no inertia and no viscous
//! damping, and the output does not depend on time.
//!
//! *Published*: the equations, and for [`BoucWenBaberNoori::demonstration`] all values, as in the example of
//! BWBN_TMCMC (Ortiz, Alvarez; after Foliente 1995). *Designed*: in [`BoucWenBaberNoori::joint`] the scales
//! of force, displacement and energy, α and the pinching except p; its other values are published. The drift
//! history is designed as well.

use hysid_core::data::record::Record;
use hysid_core::elementary::{exp, powf};
use hysid_core::error::Result;

use super::path;
use super::specimen::{Specimen, SpecimenColumns};

/// Largest error of `z` or `e` in one step of the integration.
const TOLERANCE: f64 = 1e-10;

/// The first step tried on a piece, in units of `ξ`.
const FIRST_STEP: f64 = 0.05;

/// Steps are not cut below this.
const SMALLEST_STEP: f64 = 1e-7;

/// Largest displacement, in units of the displacement scale.
const LARGEST: f64 = 1000.0;

/// Parameters of a Bouc-Wen-Baber-Noori element; pure numbers unless a unit is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoucWenBaberNoori {
    /// `S` in kN: the initial elastic force of the displacement `X`, where `A = η = 1`.
    pub force_scale: f64,
    /// `X` in mm: the displacement whose units `ξ` and `z` are in.
    pub displacement_scale: f64,
    /// `κ`: energy `e`, in its own unit, per unit of `z ξ`. With 0 there is neither degradation nor pinching.
    pub energy_scale: f64,
    /// `α`: share of the elastic spring beside the hysteretic element.
    pub alpha: f64,
    /// `β`: share of the softening that depends on the direction of loading.
    pub beta: f64,
    /// `γ`: share of the softening that does not; `β + γ > 0`.
    pub gamma: f64,
    /// `n`: sharpness of yielding.
    pub n: f64,
    /// `ν0`: softening at first.
    pub nu_0: f64,
    /// `δν`: its growth with `e`, which is loss of strength.
    pub delta_nu: f64,
    /// `A0`: tangent stiffness at first.
    pub a_0: f64,
    /// `δA`: its decline with `e`.
    pub delta_a: f64,
    /// `η0`: flexibility at first.
    pub eta_0: f64,
    /// `δη`: its growth with `e`, which is loss of stiffness.
    pub delta_eta: f64,
    /// `p`: rate at which pinching develops with `e`.
    pub p: f64,
    /// `ζs`: final pinching, from 0 (none) to below 1 (no stiffness at its centre), or 1.
    pub zeta_s: f64,
    /// `ψ0`: width of the pinched range.
    pub psi_0: f64,
    /// `δψ`: its growth with `e`.
    pub delta_psi: f64,
    /// `λ`: width of the pinched range while pinching is slight.
    pub lambda: f64,
    /// `q`: centre of the pinched range, as a share of the ultimate `z`.
    pub q: f64,
}

impl BoucWenBaberNoori {
    /// The element of the published example, without its mass and damper: stiffness 6 kN/mm, 500 kg,
    /// `e` in J/kg. Published.
    pub fn demonstration() -> Self {
        Self {
            force_scale: 6.0,
            displacement_scale: 1.0,
            energy_scale: 0.012,
            alpha: 0.2,
            beta: 2.0,
            gamma: -1.0,
            n: 1.2,
            nu_0: 1.2,
            delta_nu: 0.4,
            a_0: 1.1,
            delta_a: 0.1,
            eta_0: 1.3,
            delta_eta: 0.5,
            p: 2.0,
            zeta_s: 1.0,
            psi_0: 0.5,
            delta_psi: 0.6,
            lambda: 0.9,
            q: 1.0,
        }
    }

    /// The joint. Designed: scales, `α`, `ζs`, `ψ0`, `δψ`, `λ`, `q`, such that the load peaks near
    /// 270 kN at 1.5 % drift and a third of it is lost at 5 %; the others are those of
    /// [`BoucWenBaberNoori::demonstration`].
    pub fn joint() -> Self {
        Self {
            force_scale: 330.0,
            displacement_scale: 14.0,
            energy_scale: 0.03,
            alpha: 0.015,
            zeta_s: 0.95,
            psi_0: 0.15,
            delta_psi: 0.03,
            lambda: 0.4,
            q: 0.2,
            ..Self::demonstration()
        }
    }

    /// Upper bound of `|z|`: `(A0/(ν0 (β + γ)))^{1/n}` (theory.md (6.10)).
    pub fn ultimate(&self) -> f64 {
        powf(self.a_0 / (self.nu_0 * (self.beta + self.gamma)), 1.0 / self.n)
    }

    /// Derivatives of `z` and `e` by `ξ` in this direction: `h/η [A - ν |z|^n (β sgn(z dξ) + γ)]` and `(1 -
    /// α) κ z` (theory.md (6.5), (6.6)).
    fn slope(&self, JointMemory { z, e }: JointMemory, direction: f64) -> JointMemory {
        let a = (self.a_0 - self.delta_a * e).max(0.0);
        let nu = self.nu_0 + self.delta_nu * e;
        let eta = self.eta_0 + self.delta_eta * e;
        let zeta_1 = self.zeta_s * (1.0 - exp(-self.p * e));
        let zeta_2 = (self.psi_0 + self.delta_psi * e) * (self.lambda + zeta_1);
        let z_u = powf(nu * (self.beta + self.gamma), -1.0 / self.n);
        let distance = (z * direction - self.q * z_u) / zeta_2;
        let h = 1.0 - zeta_1 * exp(-distance * distance);
        let softening = nu * powf(z.abs(), self.n) * (self.beta * z.signum() * direction + self.gamma);
        JointMemory { z: h / eta * (a - softening), e: (1.0 - self.alpha) * self.energy_scale * z }
    }

    fn step(&self, start: JointMemory, by: f64, direction: f64) -> JointMemory {
        let k1 = self.slope(start, direction);
        let k2 = self.slope(start.along(0.5 * by, k1), direction);
        let k3 = self.slope(start.along(0.5 * by, k2), direction);
        let k4 = self.slope(start.along(by, k3), direction);
        let mean = |k1: f64, k2: f64, k3: f64, k4: f64| (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        start.along(by, JointMemory { z: mean(k1.z, k2.z, k3.z, k4.z), e: mean(k1.e, k2.e, k3.e, k4.e) })
    }

    /// Moves `ξ` by `by`, in steps so small that two halves agree with the whole.
    fn integrate(&self, mut inner: JointMemory, by: f64) -> JointMemory {
        let direction = by.signum();
        let (mut left, mut step) = (by.abs(), FIRST_STEP);
        while left > 0.0 {
            let now = step.min(left);
            let whole = self.step(inner, direction * now, direction);
            let half = self.step(inner, direction * 0.5 * now, direction);
            let halves = self.step(half, direction * 0.5 * now, direction);
            let error = (whole.z - halves.z).abs().max((whole.e - halves.e).abs());
            if error > TOLERANCE && now > SMALLEST_STEP {
                step = 0.5 * now;
                continue;
            }
            inner = halves;
            left -= now;
            if error < TOLERANCE / 64.0 {
                step = 2.0 * now;
            }
        }
        inner
    }
}

/// Memory of the element beside its displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct JointMemory {
    z: f64,
    e: f64,
}

impl JointMemory {
    fn along(self, by: f64, slope: JointMemory) -> JointMemory {
        JointMemory { z: self.z + by * slope.z, e: self.e + by * slope.e }
    }
}

/// A joint with its memory, initially unloaded and undamaged.
///
/// ```
/// use hysid_specimens::{BoucWenBaberNoori, ReinforcedConcreteJoint};
/// let mut joint = ReinforcedConcreteJoint::new(BoucWenBaberNoori::joint());
/// let force = joint.run(&[0.0, 40.0, -40.0, 40.0]); // mm to kN
/// assert!(force[1] > 230.0);
/// assert!(force[3] < force[1]); // the cycle has done damage
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ReinforcedConcreteJoint {
    /// Parameters of the element.
    pub parameters: BoucWenBaberNoori,
    xi: f64,
    inner: JointMemory,
}

impl ReinforcedConcreteJoint {
    /// An undamaged joint at displacement 0.
    pub fn new(parameters: BoucWenBaberNoori) -> Self {
        Self { parameters, xi: 0.0, inner: JointMemory::default() }
    }

    /// Returns to the undamaged joint, at displacement 0.
    pub fn reset(&mut self) {
        *self = Self::new(self.parameters);
    }

    /// The force in kN at the next displacement in mm, for any number of steps on the way. A displacement
    /// that is not finite or beyond a thousand displacement scales gives NaN and leaves the memory unchanged.
    pub fn step(&mut self, displacement: f64) -> f64 {
        let parameters = &self.parameters;
        let xi = displacement / parameters.displacement_scale;
        if xi.is_nan() || xi.abs() > LARGEST {
            return f64::NAN;
        }
        self.inner = parameters.integrate(self.inner, xi - self.xi);
        self.xi = xi;
        parameters.force_scale * (parameters.alpha * xi + (1.0 - parameters.alpha) * self.inner.z)
    }

    /// The forces in kN at all displacements in mm, from the undamaged joint.
    pub fn run(&mut self, displacement: &[f64]) -> Vec<f64> {
        self.reset();
        displacement.iter().map(|&x| self.step(x)).collect()
    }

    /// The hysteretic part `z` of the displacement, in units of the displacement scale.
    pub fn hysteretic_displacement(&self) -> f64 {
        self.inner.z
    }

    /// The dissipated energy `e = ∫ (1 - α) κ z dξ`, in its own unit (theory.md (6.6)).
    pub fn energy(&self) -> f64 {
        self.inner.e
    }
}

pub(super) static SPECIMEN: Specimen = JOINT;

const JOINT: Specimen = Specimen {
    name: "reinforced-concrete-joint",
    example: Some("example 2"),
    summary: "beam-column joint in a slow cyclic test: strength and stiffness decline, loops pinch",
    published: "the Bouc-Wen-Baber-Noori equations and the parameters β, γ, n, ν, A, η, p (demonstration set of \
                BWBN_TMCMC, after Foliente 1995)",
    designed: "the scales of force, displacement and energy, α and the other pinching parameters, the drift \
               history and the storey height of 2 m that makes it millimetres",
    training: "drift of 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4 and 5 %, three cycles each, a row a second: the first \
               70 % of the time",
    testing: "the whole history with blank outputs in the first 70 %, so that damage and memory are carried over; \
              the rest is scored, and goes to larger drift than any in training",
    columns: SpecimenColumns { time: Some("t_s"), input: "displacement_mm", output: "force_kN" },
    train: |_| Ok(vec![halves()?.0]),
    test: |_| Ok(vec![halves()?.1]),
};

/// The same test, of which whole cycles are unseen.
pub(super) static CYCLES: Specimen = Specimen {
    name: "reinforced-concrete-joint-cycles",
    summary: "the same beam-column joint and test; every third cycle is unseen",
    training: "drift of 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4 and 5 %, three cycles each, a row a second: the first two \
               cycles at each drift; the third has blank outputs",
    testing: "the same history with outputs in the third cycle at each drift alone",
    train: |_| Ok(vec![cycles(|cycle| cycle % CYCLES_EACH + 1 < CYCLES_EACH)?]),
    test: |_| Ok(vec![cycles(|cycle| cycle % CYCLES_EACH + 1 == CYCLES_EACH)?]),
    ..JOINT
};

/// Amplitudes of the drift in percent.
const DRIFT: [f64; 9] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0];

const CYCLES_EACH: usize = 3;

const CYCLES_IN_ALL: usize = DRIFT.len() * CYCLES_EACH;

/// Storey height in mm for one percent of drift.
const MILLIMETRES: f64 = 20.0;

/// Share of the rows that is for training.
const TRAINED: f64 = 0.7;

/// Largest step of the displacement between two rows, in mm.
const STEP: f64 = 1.6;

fn whole() -> Result<Record> {
    let displacement = path::through(&turning_points(), STEP);
    let force = ReinforcedConcreteJoint::new(BoucWenBaberNoori::joint()).run(&displacement);
    let time = path::every(1.0, displacement.len());
    Record::new("cyclic test", vec![displacement], force)?.with_time(time)
}

/// Turning points of the displacement in mm.
fn turning_points() -> Vec<f64> {
    let mut turning = vec![0.0];
    for drift in DRIFT {
        for _ in 0..CYCLES_EACH {
            turning.extend([drift * MILLIMETRES, -drift * MILLIMETRES]);
        }
    }
    turning.push(0.0);
    turning
}

fn halves() -> Result<(Record, Record)> {
    Ok(whole()?.split_at_fraction(TRAINED).expect("the test has more than two rows"))
}

/// The test with outputs in those of its cycles, counted from 0, that are wanted. A cycle begins where
/// the displacement rises through 0; the last row, which returns to 0, belongs to the last one.
fn cycles(is_wanted: impl Fn(usize) -> bool) -> Result<Record> {
    let whole = whole()?;
    let displacement = &whole.inputs()[0];
    let mut cycle = 0;
    let output = whole.output().iter().enumerate().map(|(row, &force)| {
        let begins = row > 0 && displacement[row - 1] < 0.0 && displacement[row] >= 0.0;
        cycle += usize::from(begins);
        if is_wanted(cycle.min(CYCLES_IN_ALL - 1)) { force } else { f64::NAN }
    });
    let output = output.collect();
    whole.clone().with_output(output)
}
