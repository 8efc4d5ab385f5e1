//! Degradation and pinching of a Bouc-Wen element after Baber and Noori.
//!
//! ```text
//! de = (z/z_u) dx/z_u                                                       theory.md (8.8)
//! A  = max(0, 1 - δA e),   ν = 1 + δν e,   η = 1 + δη e                     theory.md (8.9)
//! h  = 1 - ζ1 exp(-(z/z_u sgn(dx) - q ν^{-1/n})²/ζ2²)                       theory.md (8.10)
//! ζ1 = ζs (1 - e^{-pe}),   ζ2 = (ψ0 + δψ e)(λ + ζ1)                         theory.md (8.11)
//! ```
//!
//! `e` is the dissipated energy, divided by `(1 - α) k z_u²`; `A` and `ν` determine the strength, `η` the
//! stiffness, and `h` the pinching in [`BoucWen`](super::BoucWen). All are pure numbers.

use serde::{Deserialize, Serialize};

use crate::elementary::{exp, powf};
use crate::law::{Dimension, Parameter};

use super::Inner;

/// Largest energy; the element has no strength left far below it.
const LARGEST_ENERGY: f64 = 1e9;

/// An element so much quicker than when untouched follows its yield force, which sinks slowly, closely.
const QUICK: f64 = 4.0;

/// How near to the yield force that is, as a share of it.
const AT_REST: f64 = 1e-3;

/// Largest lag behind the yield force, as a share of it, at which an element follows steadily.
const SLOW: f64 = 3e-3;

/// How near to the steady lag that is, as a share of the yield force.
const STEADY: f64 = 3e-5;

/// Share by which the yield force sinks in one part of the way along it.
const SUNK: f64 = 0.02;

/// The energy within its limits; it is not negative, whatever `b`.
pub(super) fn limited(e: f64) -> f64 {
    e.clamp(0.0, LARGEST_ENERGY)
}

/// How a Bouc-Wen element changes with its dissipated energy `e`, which is counted in yield forces times
/// yield displacements. All fields are pure numbers; the equations are those of the [module of the
/// law](super).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Degradation {
    /// `δA`: loss of tangent stiffness and strength, `A = max(0, 1 - δA e)`.
    pub delta_a: f64,
    /// `δν`: loss of strength, `ν = 1 + δν e`.
    pub delta_nu: f64,
    /// `δη`: loss of stiffness, `η = 1 + δη e`.
    pub delta_eta: f64,
    /// `ζs`: final pinching, 0 (none) to 0.99 (nearly no stiffness at its centre).
    pub zeta_s: f64,
    /// `p`: rate at which pinching develops with `e`.
    pub p: f64,
    /// `q`: centre of the pinched range, as a share of the ultimate `z`.
    pub q: f64,
    /// `ψ0`: width of the pinched range.
    pub psi_0: f64,
    /// `δψ`: growth of that width with `e`.
    pub delta_psi: f64,
    /// `λ`: width while pinching is slight.
    pub lambda: f64,
}

/// Bounds of each parameter, in the order of the fields.
pub(super) const BOUNDS: [(f64, f64); 9] = [
    (0.0, 1.0),
    (0.0, 10.0),
    (0.0, 10.0),
    (0.0, 0.99),
    (0.0, 100.0),
    (-1.0, 1.0),
    (0.01, 10.0),
    (0.0, 1.0),
    (0.01, 10.0),
];

/// `A`, `ν`, `η`, `ζ1`, `ζ2` and the centre of the pinched range at one energy.
#[derive(Debug, Clone, Copy)]
pub(super) struct DegradedProperties {
    a: f64,
    nu: f64,
    eta: f64,
    zeta_1: f64,
    zeta_2: f64,
    centre: f64,
}

impl DegradedProperties {
    /// `dz/dx` on the way up, theory.md (8.6); `softening` is `|z/z_u|^n` with its share.
    pub fn slope(&self, z: f64, softening: f64) -> f64 {
        self.pinching(z) / self.eta * (self.a - self.nu * softening)
    }

    /// `h`, theory.md (8.10).
    fn pinching(&self, z: f64) -> f64 {
        let distance = (z - self.centre) / self.zeta_2;
        1.0 - self.zeta_1 * exp(-distance * distance)
    }
}

impl Degradation {
    /// From its nine parameters, in the order of the fields.
    pub fn from_values(values: [f64; 9]) -> Self {
        let [delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda] = values;
        Self { delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda }
    }

    /// The values, in the order of [`Degradation::from_values`].
    pub fn values(&self) -> [f64; 9] {
        let &Self { delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda } = self;
        [delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda]
    }

    /// The properties of an element after the dissipated energy `e`.
    pub(super) fn at(&self, n: f64, e: f64) -> DegradedProperties {
        let e = limited(e);
        let nu = 1.0 + self.delta_nu * e; // (8.9)
        let zeta_1 = self.zeta_s * (1.0 - exp(-self.p * e)); // (8.11)
        DegradedProperties {
            a: (1.0 - self.delta_a * e).max(0.0), // (8.9)
            nu,
            eta: 1.0 + self.delta_eta * e, // (8.9)
            zeta_1,
            zeta_2: (self.psi_0 + self.delta_psi * e) * (self.lambda + zeta_1), // (8.11)
            centre: self.q * powf(nu, -1.0 / n),                                // (8.10)
        }
    }

    /// `z` at which the element yields on the way up.
    fn ultimate(&self, n: f64, e: f64) -> f64 {
        powf((1.0 - self.delta_a * e).max(0.0) / (1.0 + self.delta_nu * e), 1.0 / n)
    }

    /// True if the element is so quick that it has come to its yield force and will only follow it.
    pub(super) fn is_at_rest(&self, n: f64, z: f64, e: f64) -> bool {
        // `|z| ≤ 1` and `n ≥ 1`: most elements are known not to be quick without a power.
        z >= 0.0 && self.loss_ratio(e) > QUICK && self.quickness(n, z, e) > QUICK && {
            let ultimate = self.ultimate(n, e);
            (z - ultimate).abs() <= AT_REST * ultimate + 1e-9
        }
    }

    /// The element after it has yielded upwards by `by`; the energy to second order.
    pub(super) fn yielding(&self, n: f64, Inner { z, e }: Inner, by: f64) -> Inner {
        let middle = self.ultimate(n, limited(e + 0.5 * by * z));
        let e = limited(e + by * middle);
        Inner { z: self.ultimate(n, e), e }
    }

    /// `z` of an element that follows its yield force `u` steadily on the way up (theory.md (8.52)), and the way in yield
    /// displacements on which `u` sinks a little; `None` where it sinks too fast for that.
    ///
    /// ```text
    /// dz/dx ≈ κ (u - z),   κ = h n A/(η u)         (8.6), linearised at u = (A/ν)^{1/n}
    /// du/dx = -D u z,      D = (δA/A + δν/ν)/n     (8.8), (8.9)
    /// z = u (1 + D u/κ)    to second order in D u/κ
    /// ```
    fn steady(&self, n: f64, e: f64) -> Option<(f64, f64)> {
        let properties = self.at(n, e);
        let ultimate = self.ultimate(n, e);
        let drift = (self.delta_a / properties.a + self.delta_nu / properties.nu) / n; // (8.52): D
        // (8.52): κ
        let pull = properties.pinching(ultimate) * n * properties.a / (properties.eta * ultimate);
        let lag = drift * ultimate / pull;
        (lag <= SLOW).then(|| (ultimate * (1.0 + lag), SUNK / (drift * ultimate)))
    }

    /// The element moved up by at most `by` along its yield force, and how far; `None` if not steadily.
    pub(super) fn follow(&self, n: f64, Inner { z, e }: Inner, by: f64) -> Option<(Inner, f64)> {
        let (steady, way) = self.steady(n, e)?;
        if (z - steady).abs() > STEADY * steady {
            return None;
        }
        let by = by.min(way);
        let (middle, _) = self.steady(n, limited(e + 0.5 * by * steady))?;
        let e = limited(e + by * middle);
        let (z, _) = self.steady(n, e)?;
        Some((Inner { z: z.min(1.0), e }, by))
    }

    /// How much faster the degraded element comes to rest at its yield force than the untouched one.
    pub(super) fn quickness(&self, n: f64, z: f64, e: f64) -> f64 {
        let largest = z.abs().max(self.ultimate(n, e));
        self.loss_ratio(e) * powf(largest, n - 1.0)
    }

    /// `ν/η`.
    fn loss_ratio(&self, e: f64) -> f64 {
        (1.0 + self.delta_nu * e) / (1.0 + self.delta_eta * e)
    }

    /// Parts for a yield displacement, beyond those for its quickness, that a narrow pinched range requires.
    pub(super) fn narrowness(&self) -> f64 {
        (0.5 / (self.psi_0 * (self.lambda + self.zeta_s))).clamp(1.0, 2.0)
    }

    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let values = [
            ("δA", "loss of tangent stiffness", self.delta_a),
            ("δν", "loss of strength", self.delta_nu),
            ("δη", "loss of stiffness", self.delta_eta),
            ("ζs", "pinching in the end", self.zeta_s),
            ("p", "how fast pinching begins", self.p),
            ("q", "centre of the pinched range", self.q),
            ("ψ0", "width of the pinched range", self.psi_0),
            ("δψ", "growth of that width", self.delta_psi),
            ("λ", "width while pinching is slight", self.lambda),
        ];
        let parameter = |((symbol, meaning, value), bounds)| {
            Parameter::new(symbol, meaning, value, bounds, Dimension::NONE)
        };
        values.into_iter().zip(BOUNDS).map(parameter).collect()
    }
}
