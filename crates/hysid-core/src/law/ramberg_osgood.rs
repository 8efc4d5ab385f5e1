//! Ramberg-Osgood: a power curve with Masing's rules, for soils, metals and members that yield gradually.
//!
//! ```text
//! skeleton: x/x_y = v + v |v|^{r-1},   g(x) = F v                       theory.md (8.59)
//! virgin:   y = c0 + g(x)                                               theory.md (8.60)
//! branch:   y = y* + 2 g((x - x*)/2)      from the turning point (x*, y*)
//! ```
//!
//! `x` is the input, as a displacement or strain, `y` the output, as a force or stress. `K = F/x_y` is the initial
//! stiffness; at the output `F` the secant stiffness is half of it. A branch that meets an earlier one continues along it
//! (Madelung's rules), see [`turning_point_stack`](crate::law::turning_point_stack).
//!
//! The form `x = (y/K) (1 + α |y/F_α|^{r-1})` with another `α` is the same curve with `F = F_α α^{-1/(r-1)}`: `α = 3/7` of
//! Ramberg and Osgood, Technical Note 902, NACA (1943). With Masing's rules: Jennings, Journal of the Engineering
//! Mechanics Division, ASCE 90 (1964) 131-166.

use serde::{Deserialize, Serialize};

use crate::elementary::powf;
use crate::error::{LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts};
use crate::law::properties::{CONGRUENT, MASING, ODD, WIPES_OUT};
use crate::law::thresholds::limited;
use crate::law::turning_point_stack::{StackBranch, TurningPointStack};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// A Ramberg-Osgood law with Masing's rules: `x/x_y = v + v |v|^{r-1}`, `y = c0 + F v` on the virgin curve, branches
/// magnified by two (theory.md (8.59), (8.60)).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RambergOsgood {
    /// `c0`: output at rest, in its unit.
    pub offset: f64,
    /// `F`: output above the offset at which the secant stiffness is half the initial one, in its unit.
    pub strength: f64,
    /// `x_y = F/K`: elastic part of the input at the output `F`, in the unit of the input.
    pub yield_displacement: f64,
    /// `r`: 1 is linear, infinity is elastic and perfectly plastic.
    pub exponent: f64,
}

/// Valid exponents.
pub const EXPONENT_BOUNDS: (f64, f64) = (1.0, 100.0);

/// Largest magnitude of the input in yield displacements: no power of it overflows.
pub const LARGEST_RATIO: f64 = 1e150;

/// Most steps of Newton's method, which needs fewer than 10.
pub const MOST_STEPS: usize = 60;

impl RambergOsgood {
    /// `v` of the skeleton curve (8.59) at `x`.
    pub fn skeleton(&self, x: f64) -> f64 {
        let ratio = (x / self.yield_displacement).clamp(-LARGEST_RATIO, LARGEST_RATIO);
        let (u, r) = (ratio.abs(), self.exponent);
        // Newton's method falls from a bound above, because v + v^r is convex.
        let newton = |v: f64| {
            let power = powf(v, r - 1.0);
            v - (v + v * power - u) / (1.0 + r * power)
        };
        let mut v = u.min(powf(u, 1.0 / r));
        let mut next = newton(v);
        let mut steps = 0;
        while next < v && steps < MOST_STEPS {
            v = next;
            next = newton(v);
            steps += 1;
        }
        if ratio < 0.0 { -v } else { v }
    }

    /// The output at the next input, for a unit strength and without the offset.
    pub fn advance(&self, stack: &mut TurningPointStack<f64>, x: f64) -> f64 {
        stack.advance(x, 0.0);
        // (8.60)
        let v = match stack.branch() {
            StackBranch::Virgin => self.skeleton(x),
            StackBranch::From { start, .. } => start.value + 2.0 * self.skeleton(0.5 * (x - start.x)),
        };
        stack.set_value(v);
        v
    }
}

impl Law for RambergOsgood {
    /// Turning points with the output there, for a unit strength and without the offset.
    type State = TurningPointStack<f64>;

    const FACTS: Facts = Facts {
        // The errors of `auto` with it as a candidate were not measured.
        is_candidate: false,
        ..Facts::searched(
            "ramberg-osgood",
            "power curve and Masing's rules at turning points",
            &["starts", "epochs"],
            ErrorsInside { softening: 0.04, sigmoid: 0.7, other: 0.6 },
        )
    };

    fn virgin(&self) -> Self::State {
        TurningPointStack::default()
    }

    fn step(&self, stack: &mut Self::State, sample: Sample) -> f64 {
        let v = self.advance(stack, limited(sample.x));
        self.offset + self.strength * v
    }

    fn work_of_row(&self, _: f64, _: f64) -> f64 {
        500.0
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let half = "output at which the secant stiffness is half the initial one";
        Parameter::table([
            ("c0", "output at rest", self.offset, any, Dimension::OUTPUT),
            ("F", half, self.strength, any, Dimension::OUTPUT),
            ("x_y", "elastic part of the input there", self.yield_displacement, positive, Dimension::INPUT),
            ("r", "exponent of the power curve", self.exponent, EXPONENT_BOUNDS, Dimension::NONE),
        ])
    }

    fn validated(self) -> Result<Self> {
        Parameter::check_all(&self.parameters(), "Ramberg-Osgood")?;
        Ok(self)
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT, MASING, ODD]].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::test_paths::{assert_finite, numbers, refined, run};

    fn law(exponent: f64) -> RambergOsgood {
        RambergOsgood { offset: 0.0, strength: 3.0, yield_displacement: 2.0, exponent }
    }

    #[test]
    fn the_skeleton_is_the_inverse_of_the_power_curve() {
        for r in [1.0, 1.3, 2.0, 5.5, 20.0, 100.0] {
            for v in [1e-12, 1e-3, 0.4, 0.97, 1.0, 1.05, 2.0, 30.0] {
                let u = v + powf(v, r);
                for sign in [-1.0, 1.0] {
                    let found = sign * law(r).skeleton(2.0 * sign * u);
                    assert!((found - v).abs() < 4e-16 * v.max(1e-300) * 4.0, "{found} instead of {v}, r {r}");
                }
            }
        }
    }

    #[test]
    fn a_loop_dissipates_what_jennings_derived() {
        // 4 F x_y (r - 1)/(r + 1) v^{r+1} for a loop between -v and v in units of F. Jennings (1964).
        for (r, v) in [(2.0, 0.5), (3.0, 1.2), (7.0, 1.05)] {
            let law = law(r);
            let amplitude = law.yield_displacement * (v + powf(v, r));
            let path = refined(&[amplitude, -amplitude, amplitude], 20_000);
            let y = run(&law, &path);
            let rows = 20_000..60_000;
            let work: f64 = rows.map(|k| 0.5 * (y[k] + y[k - 1]) * (path[k] - path[k - 1])).sum();
            let expected =
                4.0 * law.strength * law.yield_displacement * (r - 1.0) / (r + 1.0) * powf(v, r + 1.0);
            assert!((work / expected - 1.0).abs() < 1e-6, "{work} instead of {expected}");
        }
    }

    #[test]
    fn a_minor_loop_closes_and_the_curve_before_it_continues() {
        let with_minor = run(&law(4.0), &[5.0, -4.0, 2.0, -1.0, 2.0, 4.5, 6.0]);
        let without = run(&law(4.0), &[5.0, -4.0, 2.0, 4.5, 6.0]);
        assert_eq!(with_minor[4..], without[2..]);
        assert_eq!(
            without[4],
            run(&law(4.0), &[6.0])[0],
            "beyond its largest magnitude the input is on the virgin curve"
        );
    }

    #[test]
    fn the_output_is_finite_whatever_the_input() {
        for exponent in [1.0, 100.0] {
            for yield_displacement in [f64::MIN_POSITIVE, 1.0, LARGEST_VALUE] {
                let law = RambergOsgood { strength: LARGEST_VALUE, yield_displacement, ..law(exponent) };
                assert_finite(&law, &[0.0, 1e308, -1e308, 1e-300, -5.0, f64::MAX]);
                assert_finite(&law, &numbers(3, 100));
            }
        }
    }
}
