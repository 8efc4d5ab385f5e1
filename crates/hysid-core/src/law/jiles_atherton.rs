//! Jiles-Atherton: magnetisation by domain walls that are pinned on their way to the anhysteretic curve.
//!
//! ```text
//! y = c0 + μ H + M,   H_e = H + α M,   M_an = M_s (coth(H_e/a) - a/H_e),   A = dM_an/dH_e    theory.md (8.22)
//! dM/dH = [(1 - c) δ_M (M_an - M)/(δk - α(M_an - M)) + c A]/(1 - α c A)              1986    theory.md (8.23)
//! dM/dH = N/(1 - α N),   N = δ_M (M_an - M)/(δk) + c A                               1992    theory.md (8.24)
//! ```
//!
//! `H` is the field, the input; `M` the magnetisation, in the unit of the output; `M_an` the anhysteretic
//! magnetisation and `H_e` the effective field. `δ` is the sign of `dH`. `δ_M` is 0 where `M_an - M` is
//! opposed to the direction of the field, else 1, so the susceptibility is never negative.
//!
//! Where the feedback `α` would make the susceptibility infinite it is limited: `k - α|M_an - M| >= 0.02 k` and
//! `α c A <= 0.98` in the form of 1986, `α N <= 0.98` in that of 1992 (theory.md (8.25), our own). The field is
//! integrated in small parts of `a` and `k`, so the output does not depend on the sampling.
//!
//! Properties: rate-independent; minor loops do not close. Source: Jiles and Atherton 1986, whose `c/(1 + c)` is `c` here;
//! Jiles, Thoelke and Devine 1992.

use serde::{Deserialize, Serialize};

use crate::elementary::exp;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts, Origin};
use crate::law::properties::ODD;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// Longest part of the field in one step of Runge and Kutta, as a share of the smaller of `a` and `k`.
const LONGEST_PART: f64 = 0.05;

/// Parts of a single step of the input at most.
const MOST_PARTS: f64 = 4000.0;

/// Multiple of `a + k + α M_s` beyond which the material is saturated and nothing more is computed.
const SATURATED: f64 = 300.0;

/// Least `k - α|M_an - M|` as a share of `k` (theory.md (8.25)).
const LEAST_PINNING: f64 = 0.02;

/// Largest `α N`; at 1 the susceptibility would be infinite (theory.md (8.25)).
const LARGEST_FEEDBACK: f64 = 0.98;

/// Bounds of `c`.
pub const C_BOUNDS: (f64, f64) = (0.0, 0.99);

/// Which differential equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JilesAthertonForm {
    /// `dM/dH = [(1 - c) δ_M (M_an - M)/(δk - α(M_an - M)) + c A]/(1 - α c A)`, of 1986 (theory.md (8.23)).
    #[default]
    Original,
    /// `dM/dH = N/(1 - α N)` with `N = δ_M (M_an - M)/(δk) + c dM_an/dH_e`, of 1992: reversible and
    /// irreversible magnetisation are separate (theory.md (8.24)).
    Differential,
}

/// A Jiles-Atherton law in the user's units: `y = c0 + μ H + M` (theory.md (8.22)). The input is the field
/// `H`, the output the flux density `B` or the magnetisation `M`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JilesAtherton {
    /// `c0`, in the unit of the output.
    pub offset: f64,
    /// `μ`: share of the field itself in the output, in the unit of the output divided by that of the input.
    pub permeability: f64,
    /// `M_s > 0`: saturation magnetisation, in the unit of the output.
    pub saturation: f64,
    /// `a > 0`: width of the anhysteretic curve, in the unit of the input.
    pub a: f64,
    /// `k > 0`: pinning, close to the coercive field, in the unit of the input.
    pub k: f64,
    /// `α`, from 0 to `3a/M_s`: the field that the magnetisation adds, in the unit of the input divided by that of the
    /// output. From `3a/M_s` on the anhysteretic curve itself would have a loop.
    pub alpha: f64,
    /// `c`, 0 to 0.99: share of the reversible magnetisation.
    pub c: f64,
    /// Which differential equation.
    pub form: JilesAthertonForm,
}

/// The state: field and magnetisation, the latter as a share of `M_s`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JilesAthertonState {
    h: f64,
    m: f64,
}

impl JilesAthertonState {
    /// `M/M_s`
    pub fn share(&self) -> f64 {
        self.m
    }
}

/// Laws that are advanced step by step together.
const SIDE_BY_SIDE: usize = 4;

/// The way from one field to the next, upwards: `parts` parts of length `part`.
#[derive(Debug, Clone, Copy, Default)]
struct Way {
    direction: f64,
    from: f64,
    part: f64,
    parts: f64,
    m: f64,
}

impl JilesAtherton {
    /// `α M_s`: the field that the saturated magnetisation adds, in the unit of the input.
    pub fn coupling(&self) -> f64 {
        self.alpha * self.saturation
    }

    /// Approximate number of elementary operations of [`Self::advance`].
    pub fn operations(&self, state: &JilesAthertonState, h: f64) -> usize {
        let end = SATURATED * (self.a + self.k + self.coupling());
        let travel = (h - state.h).abs().min(2.0 * end);
        let parts = (travel / (LONGEST_PART * self.a.min(self.k))).min(MOST_PARTS);
        20 + 200 * parts as usize
    }

    /// Advances to the next field and returns `M/M_s`.
    pub fn advance(&self, state: &mut JilesAthertonState, h: f64) -> f64 {
        let Way { direction, from, part, parts, mut m } = self.way(state, h);
        for index in 0..parts as usize {
            m = self.runge_kutta(from + part * index as f64, m, part);
        }
        *state = JilesAthertonState { h, m: direction * m };
        state.m
    }

    /// The way to the next field. The law is odd: downwards is upwards in a mirror.
    fn way(&self, state: &JilesAthertonState, h: f64) -> Way {
        let direction = (h - state.h).signum();
        let end = SATURATED * (self.a + self.k + self.coupling());
        let (from, to) = ((direction * state.h).clamp(-end, end), (direction * h).clamp(-end, end));
        let part = LONGEST_PART * self.a.min(self.k);
        let parts = if to > from { ((to - from) / part).ceil().clamp(1.0, MOST_PARTS) } else { 0.0 };
        Way { direction, from, part: (to - from) / parts.max(1.0), parts, m: direction * state.m }
    }

    /// Advances several laws, with the numbers of [`Self::advance`]. A step waits for the one before, so that several laws
    /// together take little longer than one.
    pub fn advance_side_by_side(laws: &[Self], states: &mut [JilesAthertonState], h: f64) {
        for (laws, states) in laws.chunks(SIDE_BY_SIDE).zip(states.chunks_mut(SIDE_BY_SIDE)) {
            Self::advance_few(laws, states, h);
        }
    }

    fn advance_few(laws: &[Self], states: &mut [JilesAthertonState], h: f64) {
        let count = laws.len().min(states.len());
        let mut ways = [Way::default(); SIDE_BY_SIDE];
        for lane in 0..count {
            ways[lane] = laws[lane].way(&states[lane], h);
        }
        let most = ways.iter().map(|way| way.parts).fold(0.0, f64::max);
        for index in 0..most as usize {
            let mut k = [[0.0; 4]; SIDE_BY_SIDE];
            for (order, (of_part, of_slope)) in
                [(0.0, 0.0), (0.5, 0.5), (0.5, 0.5), (1.0, 1.0)].into_iter().enumerate()
            {
                for lane in 0..count {
                    let Way { from, part, m, .. } = ways[lane];
                    let h = from + part * index as f64;
                    k[lane][order] = match order {
                        0 => laws[lane].slope(h, m),
                        _ => laws[lane].slope(h + of_part * part, m + of_slope * part * k[lane][order - 1]),
                    };
                }
            }
            for lane in 0..count {
                let Way { part, m, parts, .. } = ways[lane];
                if (index as f64) < parts {
                    ways[lane].m = runge_kutta_end(m, part, k[lane]);
                }
            }
        }
        for lane in 0..count {
            states[lane] = JilesAthertonState { h, m: ways[lane].direction * ways[lane].m };
        }
    }

    fn runge_kutta(&self, h: f64, m: f64, by: f64) -> f64 {
        let k1 = self.slope(h, m);
        let k2 = self.slope(h + 0.5 * by, m + 0.5 * by * k1);
        let k3 = self.slope(h + 0.5 * by, m + 0.5 * by * k2);
        let k4 = self.slope(h + by, m + by * k3);
        runge_kutta_end(m, by, [k1, k2, k3, k4])
    }

    /// `d(M/M_s)/dH` on the way up; never negative.
    #[inline(always)]
    fn slope(&self, h: f64, m: f64) -> f64 {
        let (langevin, steepness) = langevin((h + self.coupling() * m) / self.a); // (8.22)
        let anhysteretic = steepness / self.a;
        let missing = (langevin - m).max(0.0);
        match self.form {
            JilesAthertonForm::Original => {
                // (8.25)
                let pinning = (self.k - self.coupling() * missing).max(LEAST_PINNING * self.k);
                let reversible = self.c * anhysteretic;
                let feedback = (self.coupling() * reversible).min(LARGEST_FEEDBACK); // (8.25)
                ((1.0 - self.c) * missing / pinning + reversible) / (1.0 - feedback) // (8.23)
            }
            JilesAthertonForm::Differential => {
                let n = missing / self.k + self.c * anhysteretic; // (8.24)
                n / (1.0 - (self.coupling() * n).min(LARGEST_FEEDBACK)) // (8.24), (8.25)
            }
        }
    }
}

#[inline(always)]
fn runge_kutta_end(m: f64, by: f64, [k1, k2, k3, k4]: [f64; 4]) -> f64 {
    (m + by * (k1 + 2.0 * (k2 + k3) + k4) / 6.0).clamp(-1.0, 1.0)
}

#[inline(always)]
fn langevin(x: f64) -> (f64, f64) {
    let square = x * x;
    if square < 0.0025 {
        let value = x / 3.0 * (1.0 - square / 15.0 * (1.0 - 2.0 / 21.0 * square));
        return (value, 1.0 / 3.0 - square / 15.0 + 2.0 / 189.0 * square * square);
    }
    let decline = exp(-2.0 * x.abs());
    let rest = 1.0 - decline;
    let value = (1.0 + decline) / rest - 1.0 / x.abs();
    (value.copysign(x), 1.0 / square - 4.0 * decline / (rest * rest))
}

impl Law for JilesAtherton {
    type State = JilesAthertonState;

    const FACTS: Facts = Facts {
        origin: Origin::Zero("the demagnetised state"),
        variants: &["differential_form"],
        ..Facts::searched(
            "jiles-atherton",
            "differential equation of the magnetisation",
            &["differential_form", "starts", "epochs"],
            ErrorsInside { softening: 0.06, sigmoid: 0.08, other: 0.1 },
        )
    };

    fn virgin(&self) -> JilesAthertonState {
        JilesAthertonState::default()
    }

    fn step(&self, state: &mut JilesAthertonState, sample: Sample) -> f64 {
        let sample = sample.limited();
        let m = self.advance(state, sample.x);
        self.offset + self.permeability * sample.x + self.saturation * m // (8.22)
    }

    fn work_of_row(&self, travel: f64, _: f64) -> f64 {
        self.operations(&self.virgin(), travel) as f64
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (1.0 / LARGEST_VALUE, LARGEST_VALUE);
        Parameter::table([
            ("c0", "level of the output", self.offset, any, Dimension::OUTPUT),
            ("μ", "share of the field itself", self.permeability, any, Dimension::SLOPE),
            ("M_s", "saturation magnetisation", self.saturation, positive, Dimension::OUTPUT),
            ("a", "width of the anhysteretic curve", self.a, positive, Dimension::INPUT),
            ("k", "pinning", self.k, positive, Dimension::INPUT),
            (
                "α",
                "field that the magnetisation adds",
                self.alpha,
                (0.0, 3.0 * self.a / self.saturation),
                Dimension::COMPLIANCE,
            ),
            ("c", "reversible share", self.c, C_BOUNDS, Dimension::NONE),
        ])
    }

    fn validated(self) -> Result<Self> {
        if !(self.a > 0.0 && self.k > 0.0 && self.saturation > 0.0) {
            return Err(Error::Parts("Jiles-Atherton: M_s, a and k must be positive".into()));
        }
        Parameter::check_all(&self.parameters(), "Jiles-Atherton")?;
        Ok(self)
    }

    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
        [Some((Property::Deterioration, false)), about_origin.then_some(ODD)].into_iter().flatten().collect()
    }
}
