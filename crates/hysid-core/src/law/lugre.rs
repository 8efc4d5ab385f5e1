//! LuGre: friction of a contact whose bristles bend before they slip, as in bearings, gears, guides and tyres; with a
//! spring beside it if there is one.
//!
//! ```text
//! dz/dt = v - σ0 |v| z / g(v),    g(v) = F_C + (F_S - F_C) exp(-(v/v_s)²)          theory.md (8.26)
//! y     = c0 + k x + σ0 z + σ1 dz/dt + σ2 v                                        theory.md (8.27)
//! ```
//!
//! `x` is the displacement, `v` its rate, `y` the force and `z` the deflection of the bristles, in the unit
//! of `x`. At a small rate the contact is a spring of stiffness `σ0` that yields at the static friction
//! `F_S`; with increasing rate the friction decreases to `F_C` (the Stribeck effect).
//!
//! For a rate that is constant between two samples the first equation has an exact solution, which is used
//! here: the time step can have any length. The state is `s = σ0 z/F_C`, and the presliding displacement is
//! `x_s = F_C/σ0`. Source: Canudas de Wit, Olsson, Åström and Lischinsky, IEEE Transactions on Automatic
//! Control 40 (1995) 419-425.

use serde::{Deserialize, Serialize};

use crate::elementary::exp;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts, Rate};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// Bounds of `F_S/F_C - 1`.
pub const STRIBECK_BOUNDS: (f64, f64) = (0.0, 10.0);

/// A LuGre law in the user's units: `y = c0 + k x + σ0 z + σ1 dz/dt + σ2 v` (theory.md (8.27)).
///
/// ```
/// use hysid_core::law::lugre::Lugre;
/// use hysid_core::law::{Law, Sample};
/// let law = Lugre { sliding: 2.0, presliding: 0.01, ..Lugre::default() };
/// let mut state = law.virgin();
/// let force = law.step(&mut state, Sample { x: 1.0, rate: 0.5, step: 0.1 });
/// assert!((force - 2.0).abs() < 1e-12); // far beyond the presliding displacement: 2 N of sliding friction
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lugre {
    /// `c0`, in the unit of the output.
    pub offset: f64,
    /// `k`: stiffness of the spring, in the unit of the output for that of the input.
    pub spring: f64,
    /// `F_C`: sliding friction at a high rate, in the unit of the output.
    pub sliding: f64,
    /// `x_s = F_C/σ0 > 0`: presliding displacement, in the unit of the input.
    pub presliding: f64,
    /// `F_S/F_C - 1`, 0 to 10: relative excess of the static over the sliding friction.
    pub stribeck: f64,
    /// `v_s > 0`: Stribeck velocity, in the unit of the rate.
    pub stribeck_velocity: f64,
    /// `σ1 F_C/σ0`: damping of the bristles, in the unit of the output times that of time.
    pub bristle_damping: f64,
    /// `σ2`: viscous friction, in the unit of the output divided by that of the rate.
    pub viscous: f64,
}

impl Default for Lugre {
    /// A friction of 1 without Stribeck effect and damping.
    fn default() -> Self {
        Self {
            offset: 0.0,
            spring: 0.0,
            sliding: 1.0,
            presliding: 1.0,
            stribeck: 0.0,
            stribeck_velocity: 1.0,
            bristle_damping: 0.0,
            viscous: 0.0,
        }
    }
}

/// The state: the displacement and the deflection of the bristles.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LugreState {
    x: f64,
    /// `σ0 z/F_C`.
    deflection: f64,
}

/// The deflection of the bristles and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristles {
    /// `σ0 z/F_C`: the deflection as a share of that at the sliding friction.
    pub deflection: f64,
    /// The derivative of `deflection` with respect to time.
    pub rate: f64,
}

impl Lugre {
    /// `g(v)/F_C`: the friction of steady motion divided by the sliding friction, without the viscous part.
    pub fn steady(&self, rate: f64) -> f64 {
        let share = rate / self.stribeck_velocity;
        1.0 + self.stribeck * exp(-share * share) // (8.26): g(v)/F_C
    }

    /// Advances to the next sample and returns the bristles: the exact solution for a rate that is constant
    /// since the previous sample, `z_k = z_g + (z_{k-1} - z_g) exp(-σ0 |x_k - x_{k-1}| / g(v_k))` with `z_g =
    /// sgn(x_k - x_{k-1}) g(v_k)/σ0` (theory.md (8.28)).
    pub fn advance(&self, state: &mut LugreState, sample: Sample) -> Bristles {
        let by = sample.x - state.x;
        state.x = sample.x;
        let steady = self.steady(sample.rate);
        if by != 0.0 {
            let end = by.signum() * steady;
            let decay = exp(-by.abs() / (self.presliding * steady));
            state.deflection = end + (state.deflection - end) * decay; // (8.28)
        }
        let deflection = state.deflection;
        // (8.26)
        let rate = (sample.rate - sample.rate.abs() * deflection / steady) / self.presliding;
        Bristles { deflection, rate }
    }
}

impl Law for Lugre {
    type State = LugreState;

    const FACTS: Facts = Facts {
        rate: Rate::Needed,
        ..Facts::searched(
            "lugre",
            "friction of bristles, with the Stribeck effect",
            &["starts", "epochs", "rate_compression"],
            ErrorsInside { softening: 0.06, sigmoid: 0.3, other: 0.3 },
        )
    };

    fn virgin(&self) -> LugreState {
        LugreState::default()
    }

    fn step(&self, state: &mut LugreState, sample: Sample) -> f64 {
        let sample = sample.limited();
        let bristles = self.advance(state, sample);
        let damping = self.bristle_damping * bristles.rate;
        // (8.27)
        let force = self.sliding * bristles.deflection + damping + self.viscous * sample.rate;
        (self.offset + self.spring * sample.x + force).clamp(-f64::MAX, f64::MAX)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let rate = Dimension { input: 1, output: 0, time: -1 };
        let viscosity = Dimension { input: -1, output: 1, time: 1 };
        let impulse = Dimension { input: 0, output: 1, time: 1 };
        Parameter::table([
            ("c0", "output at rest", self.offset, any, Dimension::OUTPUT),
            ("k", "stiffness of the spring", self.spring, any, Dimension::SLOPE),
            ("F_C", "sliding friction", self.sliding, any, Dimension::OUTPUT),
            ("x_s", "presliding displacement", self.presliding, positive, Dimension::INPUT),
            ("F_S/F_C-1", "surplus of static friction", self.stribeck, STRIBECK_BOUNDS, Dimension::NONE),
            ("v_s", "Stribeck velocity", self.stribeck_velocity, positive, rate),
            ("σ1x_s", "damping of the bristles", self.bristle_damping, any, impulse),
            ("σ2", "viscous friction", self.viscous, any, viscosity),
        ])
    }

    fn validated(self) -> Result<Self> {
        Parameter::check_all(&self.parameters(), "LuGre")?;
        if self.sliding * (1.0 + self.stribeck) > LARGEST_VALUE {
            return Err(Error::Parts("LuGre: the static friction is too large".into()));
        }
        Ok(self)
    }

    fn sees_rate(&self) -> bool {
        true
    }

    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
        let odd = about_origin.then_some(crate::law::properties::ODD);
        [Some((Property::Deterioration, false)), odd].into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};

    /// A joint with all terms.
    fn joint() -> Lugre {
        Lugre {
            offset: 0.3,
            spring: 0.0,
            sliding: 2.0,
            presliding: 0.05,
            stribeck: 0.6,
            stribeck_velocity: 0.2,
            bristle_damping: 0.01,
            viscous: 0.4,
        }
    }

    #[test]
    fn steady_sliding_has_the_friction_of_its_rate() {
        for v in [-1.0, -0.2, 0.01, 0.3, 5.0] {
            let (law, mut state) = (joint(), LugreState::default());
            let force = law.step(&mut state, Sample { x: 10.0 * f64::signum(v), rate: v, step: 1.0 });
            let share: f64 = v / 0.2;
            let expected = 0.3 + v.signum() * (2.0 + 1.2 * exp(-share * share)) + 0.4 * v;
            assert!((force - expected).abs() < 1e-12, "{v}: {force} and {expected}");
        }
    }

    #[test]
    fn one_step_is_as_many_at_the_same_rate() {
        let (law, mut once, mut often) = (joint(), LugreState::default(), LugreState::default());
        let rate = 0.15;
        let far = law.step(&mut once, Sample { x: 0.04, rate, step: 1.0 });
        let near =
            (1..=1000).map(|k| law.step(&mut often, Sample { x: 4e-5 * f64::from(k), rate, step: 1e-3 }));
        assert!((near.last().unwrap() - far).abs() < 1e-12);
    }

    #[test]
    fn the_differential_equation_is_solved() {
        // Runge and Kutta in time with a thousand parts, the rate falling and changing its sign.
        let law = joint();
        let (duration, parts) = (2.0, 200_000);
        let step = duration / f64::from(parts);
        let rate = |t: f64| 0.3 * cos(2.0 * t);
        let slope = |s: f64, t: f64| (rate(t) - rate(t).abs() * s / law.steady(rate(t))) / law.presliding;
        let (mut exact, mut state, mut largest) = (0.0, law.virgin(), 0.0_f64);
        for k in 1..=parts {
            let t = step * f64::from(k - 1);
            let k1 = slope(exact, t);
            let k2 = slope(exact + 0.5 * step * k1, t + 0.5 * step);
            let k3 = slope(exact + 0.5 * step * k2, t + 0.5 * step);
            let k4 = slope(exact + step * k3, t + step);
            exact += step * (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
            let t = t + step;
            let x = 0.15 * sin(2.0 * t);
            let bristles = law.advance(&mut state, Sample { x, rate: rate(t), step });
            largest = largest.max((bristles.deflection - exact).abs());
        }
        assert!(largest < 2e-4, "{largest}");
    }

    #[test]
    fn small_displacements_meet_a_spring() {
        let law = Lugre { bristle_damping: 0.0, viscous: 0.0, offset: 0.0, ..joint() };
        let mut state = law.virgin();
        let mut at = |x: f64| law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
        let (here, there) = (at(0.0), at(1e-6));
        let slope = (there - here) / 1e-6;
        assert!((slope - 2.0 / 0.05).abs() < 1e-2, "{slope}");
    }
}
