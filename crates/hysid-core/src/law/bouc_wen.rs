//! Bouc-Wen: a spring in parallel with a hysteretic element that yields, optionally with the degradation and
//! pinching of Baber and Noori.
//!
//! ```text
//! y     = c0 + α k x + (1 - α) k z + c x'                                   theory.md (8.4)
//! dz/dx = 1 - |z/z_u|^n [1 - b + b sgn(z dx)]                               theory.md (8.5)
//! dz/dx = (h/η) {A - ν |z/z_u|^n [1 - b + b sgn(z dx)]}                     theory.md (8.6)
//! ```
//!
//! `x` is the input, `x'` its rate, `y` the output and `z` the hysteretic part of the displacement, in the
//! unit of `x`. The second equation holds without degradation, the third with it; [`Degradation`] gives `A`,
//! `ν`, `η` and `h`.
//!
//! `b = β/(β + γ)` and `z_u = (β + γ)^{-1/n}` replace the `β` and `γ` of the literature with `A = 1`. `z_u`
//! is the yield displacement; its unit does not depend on `n`.
//!
//! Properties: the law is written in `x` instead of time, so it is rate-independent without damping `c`. It
//! is integrated in small parts of `z_u`, so the output does not depend on the sampling. There is no
//! return-point memory: small loops drift. Source: Bouc; Wen; Baber and Noori; Foliente.

mod degradation;

use serde::{Deserialize, Serialize};

use crate::elementary::{exp, exp_m1, ln_1p, powf};
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts, Rate};
use crate::law::properties::ODD;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;
pub use degradation::Degradation;

/// Longest part of the input in one step of Runge and Kutta, in yield displacements, at quickness 1.
const LONGEST_PART: f64 = 0.1;

/// Yield displacements in one direction after which `z` does not change any more.
const SATURATED: f64 = 60.0;

/// From here on `z` does not grow any more, to rounding.
const YIELDED: f64 = 1.0 - 1e-14;

/// Slope of `z`, as a multiple of `n`, below which the element may follow its yield force.
const NEARLY_AT_REST: f64 = 0.003;

/// Parts of a single step of the input at most.
const MOST_PARTS: f64 = 600.0;

/// Bounds of `n`: below 1 the law is not Lipschitz at `z = 0`.
pub(crate) const N_BOUNDS: (f64, f64) = (1.0, 10.0);

/// Bounds of `b`. At 0 the element would not unload from `z_u`.
pub const B_BOUNDS: (f64, f64) = (0.05, 3.0);

/// A Bouc-Wen law in the user's units: `y = c0 + α k x + (1 - α) k z + c x'` (theory.md (8.4)), with `z` from
/// the differential equation of the [module page](self).
///
/// ```
/// use hysid_core::law::bouc_wen::BoucWen;
/// use hysid_core::law::{Law, Sample};
/// let law = BoucWen::new(5.0, 100.0, 2.0)?; // 5 kN/mm beside 100 kN/mm that yields at 2 mm
/// let mut state = law.virgin();
/// let force = law.step(&mut state, Sample { x: 40.0, rate: 0.0, step: 0.0 });
/// assert!((force - (5.0 * 40.0 + 100.0 * 2.0)).abs() < 1e-6);
/// # Ok::<(), hysid_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoucWen {
    /// `c0`, in the unit of the output.
    pub offset: f64,
    /// `α k`: stiffness of the spring, in the unit of the output divided by that of the input.
    pub elastic_stiffness: f64,
    /// `(1 - α) k`: initial stiffness of the hysteretic element, in the unit of the output divided by that of
    /// the input. It is negative for the loops of actuators, whose output lags.
    pub hysteretic_stiffness: f64,
    /// `c`: damping, in the unit of the output divided by that of the rate; 0 ignores the rate.
    pub damping: f64,
    /// `z_u > 0`: yield displacement, in the unit of the input.
    pub yield_displacement: f64,
    /// `b = β/(β + γ)`, 0.05 to 3: share of the softening that depends on the direction.
    pub b: f64,
    /// `n`, 1 to 10: sharpness of yielding.
    pub n: f64,
    /// Degradation and pinching, if any.
    pub degradation: Option<Degradation>,
}

/// The state: the input, `z` and the dissipated energy.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BoucWenState {
    x: f64,
    inner: Inner,
}

/// The hysteretic element: `z` in yield displacements, and its dissipated energy `e`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Inner {
    z: f64,
    e: f64,
}

impl BoucWen {
    /// A law with `b = 0.5`, `n = 1` and neither offset, damping nor degradation.
    ///
    /// # Errors
    /// As [`BoucWen::validated`].
    pub fn new(elastic_stiffness: f64, hysteretic_stiffness: f64, yield_displacement: f64) -> Result<Self> {
        let law = Self {
            offset: 0.0,
            elastic_stiffness,
            hysteretic_stiffness,
            damping: 0.0,
            yield_displacement,
            b: 0.5,
            n: 1.0,
            degradation: None,
        };
        law.validated()
    }

    /// `k`: the initial stiffness of the whole law, in the unit of the output divided by that of the input.
    pub fn stiffness(&self) -> f64 {
        self.elastic_stiffness + self.hysteretic_stiffness
    }

    /// `α`: the share of the spring in the initial stiffness. Infinite or NaN if that is 0.
    pub fn alpha(&self) -> f64 {
        self.elastic_stiffness / self.stiffness()
    }

    /// The hysteretic part `z` of the displacement, in the unit of the input.
    pub fn hysteretic_displacement(&self, state: &BoucWenState) -> f64 {
        self.yield_displacement * state.inner.z
    }

    /// Advances to the next input and returns `z/z_u`.
    pub fn advance(&self, state: &mut BoucWenState, x: f64) -> f64 {
        let by = (x - state.x) / self.yield_displacement;
        state.x = x;
        if by != 0.0 {
            // The law is odd: downwards is upwards in a mirror.
            let direction = by.signum();
            let Inner { z, e } =
                self.upwards(Inner { z: direction * state.inner.z, ..state.inner }, by.abs());
            state.inner = Inner { z: direction * z, e };
        }
        state.inner.z
    }

    fn upwards(&self, inner: Inner, by: f64) -> Inner {
        if self.n == 1.0 && self.degradation.is_none() {
            return Inner { z: self.exponential_branches(inner.z, by), e: 0.0 };
        }
        if self.degradation.is_none() && inner.z >= YIELDED {
            return inner;
        }
        let travel = by.min(SATURATED);
        let narrowness = self.degradation.map_or(1.0, |degradation| degradation.narrowness());
        let part = LONGEST_PART / self.quickness(inner).max(narrowness);
        let parts = (travel / part).ceil().clamp(1.0, MOST_PARTS);
        let part = travel / parts;
        match &self.degradation {
            None => self.constant_upwards(inner, part, parts as usize),
            Some(degradation) => self.degrading_upwards(degradation, inner, part, by),
        }
    }

    /// Moves up by `parts` parts, or until the yield force is reached.
    fn constant_upwards(&self, inner: Inner, part: f64, parts: usize) -> Inner {
        let mut inner = inner;
        for _ in 0..parts {
            if inner.z >= YIELDED {
                break;
            }
            inner = self.part(inner, part);
        }
        inner
    }

    /// Moves up by `by` in parts, or along the yield force where the element follows it.
    fn degrading_upwards(&self, degradation: &Degradation, inner: Inner, part: f64, by: f64) -> Inner {
        let travel = by.min(SATURATED);
        let (mut inner, mut left) = (inner, travel);
        while left > 1e-9 * travel {
            if degradation.is_at_rest(self.n, inner.z, inner.e) {
                return degradation.yielding(self.n, inner, left + (by - travel));
            }
            let before = inner.z;
            inner = self.part(inner, part.min(left));
            left -= part;
            let hardly_moves = (inner.z - before).abs() <= NEARLY_AT_REST * self.n * part;
            while left > 0.0
                && hardly_moves
                && inner.z > 0.0
                && let Some((followed, way)) = degradation.follow(self.n, inner, left)
            // (8.52)
            {
                (inner, left) = (followed, left - way);
            }
        }
        if by > travel { degradation.yielding(self.n, inner, by - travel) } else { inner }
    }

    /// The exact solution for `n = 1` without degradation. With `ζ = z/z_u`, `m = 2b - 1` and `s = Δx/z_u`
    /// upwards from `ζ_0`: `ζ = 1 - (1 - ζ_0) e^{-s}` for `ζ_0 >= 0`, otherwise `-ζ = (-ζ_0 + 1/m) e^{-ms} -
    /// 1/m` up to `ζ = 0` (theory.md (8.7)).
    fn exponential_branches(&self, z: f64, by: f64) -> f64 {
        let (mut z, mut by) = (z, by);
        if z < 0.0 {
            let m = 2.0 * self.b - 1.0;
            let to_zero = if m.abs() < 1e-9 { -z } else { ln_1p(-m * z) / m };
            if by < to_zero {
                // (8.7) for ζ_0 < 0
                let way = if m.abs() < 1e-9 { by } else { -exp_m1(-m * by) / m };
                return (z * exp(-m * by) + way).min(0.0);
            }
            (z, by) = (0.0, by - to_zero);
        }
        1.0 - (1.0 - z) * exp(-by) // (8.7) for ζ_0 ≥ 0
    }

    /// How much faster than `x/z_u` the element comes to rest at its yield force.
    fn quickness(&self, Inner { z, e }: Inner) -> f64 {
        let bend = 0.5 * self.n.max((2.0 * self.b - 1.0).abs());
        self.degradation.map_or(bend, |degradation| bend * degradation.quickness(self.n, z, e))
    }

    /// Moves up by a small part; the kink at `z = 0` is stepped onto, so that no step straddles it.
    fn part(&self, inner: Inner, by: f64) -> Inner {
        let end = self.runge_kutta(inner, by);
        if !(inner.z < 0.0 && end.z > 0.0) {
            return end;
        }
        let (mut low, mut high) = ((0.0, inner.z), (by, end.z));
        let mut middle = inner;
        let mut way = 0.0;
        for _ in 0..3 {
            way = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            middle = self.runge_kutta(inner, way);
            if middle.z < 0.0 {
                low = (way, middle.z);
            } else {
                high = (way, middle.z);
            }
            if high.1 <= low.1 {
                break;
            }
        }
        self.runge_kutta(Inner { z: 0.0, ..middle }, by - way)
    }

    fn runge_kutta(&self, start: Inner, by: f64) -> Inner {
        // The properties change slowly: taken at the middle of the part they are exact to second order.
        let properties =
            self.degradation.map(|degradation| degradation.at(self.n, start.e + 0.5 * by * start.z));
        let slope = |z: f64| {
            let share = if z < 0.0 { 1.0 - 2.0 * self.b } else { 1.0 };
            let softening = powf(z.abs(), self.n) * share;
            // (8.5), or (8.6)
            properties.as_ref().map_or(1.0 - softening, |properties| properties.slope(z, softening))
        };
        // (8.5) and (8.6) keep |z| ≤ 1; this keeps the numbers there as well, whatever the part.
        let within = |z: f64| z.clamp(-1.0, 1.0);
        let k1 = slope(start.z);
        let z2 = within(start.z + 0.5 * by * k1);
        let k2 = slope(z2);
        let z3 = within(start.z + 0.5 * by * k2);
        let k3 = slope(z3);
        let z4 = within(start.z + by * k3);
        let end = start.z + by * (k1 + 2.0 * (k2 + k3) + slope(z4)) / 6.0;
        // (8.8), by Simpson's rule
        let work = if properties.is_some() { by * (start.z + 2.0 * (z2 + z3) + z4) / 6.0 } else { 0.0 };
        Inner { z: within(end), e: degradation::limited(start.e + work) }
    }
}

impl Law for BoucWen {
    type State = BoucWenState;

    const FACTS: Facts = Facts {
        rate: Rate::Optional,
        variants: &["degradation"],
        // With eight, a search of twelve unknowns ended in another minimum from two or three of ten seeds. Designed.
        defaults_with_degradation: &[("starts", 16)],
        advice: &[
            (Behaviour::Traces, Advised::Simplest),
            (Behaviour::Degradation, Advised::FewerParameters("option degradation, with pinching")),
            (Behaviour::RateDependence, Advised::FewerParameters("with the rate")),
        ],
        ..Facts::searched(
            "bouc-wen",
            "spring and yielding element; option degradation: pinching and degradation",
            &["degradation", "starts", "epochs", "rate_compression"],
            ErrorsInside { softening: 0.05, sigmoid: 0.3, other: 0.3 },
        )
    };

    fn virgin(&self) -> BoucWenState {
        BoucWenState::default()
    }

    fn step(&self, state: &mut BoucWenState, sample: Sample) -> f64 {
        let sample = sample.limited();
        let z = self.advance(state, sample.x);
        // (8.4)
        self.offset
            + self.elastic_stiffness * sample.x
            + self.hysteretic_stiffness * (self.yield_displacement * z)
            + self.damping * sample.rate
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (0.0, LARGEST_VALUE);
        let friction = Dimension { input: -1, output: 1, time: 1 };
        let mut all = Parameter::table([
            ("c0", "output at rest", self.offset, any, Dimension::OUTPUT),
            ("αk", "stiffness after yielding", self.elastic_stiffness, any, Dimension::SLOPE),
            (
                "(1-α)k",
                "first stiffness of the hysteretic element",
                self.hysteretic_stiffness,
                any,
                Dimension::SLOPE,
            ),
            ("c", "damping", self.damping, any, friction),
            ("z_u", "yield displacement", self.yield_displacement, positive, Dimension::INPUT),
            ("β/(β+γ)", "share of softening by direction", self.b, B_BOUNDS, Dimension::NONE),
            ("n", "sharpness of yielding", self.n, N_BOUNDS, Dimension::NONE),
        ]);
        all.extend(self.degradation.iter().flat_map(Degradation::parameters));
        all
    }

    fn validated(self) -> Result<Self> {
        Parameter::check_all(&self.parameters(), "Bouc-Wen")?;
        if self.yield_displacement <= 0.0 {
            return Err(Error::Parts("Bouc-Wen: the yield displacement must be positive".into()));
        }
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        self.damping != 0.0
    }

    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
        let deterioration = self.degradation.is_none().then_some((Property::Deterioration, false));
        deterioration.into_iter().chain(about_origin.then_some(ODD)).collect()
    }
}
