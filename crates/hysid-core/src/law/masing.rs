//! Masing's rule: every branch is the virgin curve, magnified by two.
//!
//! ```text
//! virgin:   y = c + g(x)                                              theory.md (7.3)
//! branch:   y = y* + 2 g((x - x*)/2)      from the turning point (x*, y*)
//! g(x) = Σ_j m_j [clip(x; -r_j, r_j) - clip(x; -r_{j-1}, r_{j-1})]
//! ```
//!
//! `x` is the input, `y` the output; `clip(a; l, u) = min(u, max(l, a))`. The virgin curve `g` is an odd
//! polygon: `m_j` is its slope between the thresholds `r_{j-1}` and `r_j`, and the last slope continues
//! without end. A branch that meets an earlier one continues along it (Madelung's rules), see
//! [`turning_point_stack`](crate::law::turning_point_stack).
//!
//! So extended, the rule is the Prandtl model of stops `ε_r`: `y = c + Σ_j (m_j - m_{j+1}) ε_{r_j}[x] +
//! m_{n+1} x` (theory.md (7.13)). The output is therefore linear in the slopes.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::law::facts::{ErrorsInside, Facts};
use crate::law::properties::{CONGRUENT, MASING, ODD, WIPES_OUT};
use crate::law::thresholds::{check_thresholds, check_weights, limited};
use crate::law::turning_point_stack::{StackBranch, TurningPointStack};
use crate::law::{Dimension, Law, Parameter, Sample, stored_as};
use crate::property::Property;

/// A model by Masing's rule: `y = c + g(x)` on the virgin curve, `y = y* + 2 g((x - x*)/2)` from a turning
/// point `(x*, y*)`, with an odd polygon `g` (theory.md (7.3)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MasingParts", into = "MasingParts")]
pub struct Masing {
    parts: MasingParts,
    /// `g` at each threshold.
    heights: Vec<f64>,
}

/// Parameters of a model by Masing's rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MasingParts {
    /// Constant `c`, in the unit of the output.
    pub constant: f64,
    /// Thresholds `r_1 < r_2 < ...` where the virgin curve bends, in the unit of the input, positive.
    pub thresholds: Vec<f64>,
    /// Slopes `m_j` of the virgin curve, in the unit of output over input: below each threshold, and beyond the last.
    pub slopes: Vec<f64>,
}

stored_as!(MasingParts of Masing in parts);

impl Masing {
    /// A model from its parameters.
    ///
    /// # Errors
    /// Thresholds that are not positive, finite and rising; not one more slope than thresholds; a slope or
    /// constant that is not finite or beyond 1e100.
    pub fn new(parts: MasingParts) -> Result<Self> {
        check_thresholds(&parts.thresholds)?;
        check_weights(&parts.slopes)?;
        check_weights(&[parts.constant])?;
        if parts.slopes.len() != parts.thresholds.len() + 1 {
            return Err(Error::Parts(format!(
                "{} slopes where {} thresholds need {}",
                parts.slopes.len(),
                parts.thresholds.len(),
                parts.thresholds.len() + 1
            )));
        }
        let (mut height, mut from) = (0.0, 0.0);
        let mut rise = |(&r, &slope): (&f64, &f64)| {
            height += slope * (r - from);
            from = r;
            height
        };
        let heights = parts.thresholds.iter().zip(&parts.slopes).map(&mut rise).collect();
        Ok(Self { parts, heights })
    }

    /// The parameters.
    pub fn parts(&self) -> &MasingParts {
        &self.parts
    }

    /// `g` at each threshold, in the unit of the output.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The virgin curve `g` at the input `x`, in the unit of the output.
    pub fn virgin_curve(&self, x: f64) -> f64 {
        let (size, thresholds) = (x.abs(), &self.parts.thresholds);
        let piece = thresholds.partition_point(|&r| r <= size);
        let (from, height) =
            if piece == 0 { (0.0, 0.0) } else { (thresholds[piece - 1], self.heights[piece - 1]) };
        let height = height + self.parts.slopes[piece] * (size - from);
        if x < 0.0 { -height } else { height }
    }
}

impl Law for Masing {
    /// Turning points with the output there, without the constant.
    type State = TurningPointStack<f64>;

    const FACTS: Facts = Facts::linear(
        "masing",
        "virgin curve and Masing's rules at turning points",
        &["operators", "thresholds", "sign"],
        ErrorsInside { softening: 0.04, sigmoid: 0.7, other: 0.6 },
    )
    .with_defaults(&[("operators", 30)]);

    fn virgin(&self) -> Self::State {
        TurningPointStack::default()
    }

    fn step(&self, stack: &mut Self::State, sample: Sample) -> f64 {
        let x = limited(sample.x);
        stack.advance(x, 0.0);
        let y = match stack.branch() {
            StackBranch::Virgin => self.virgin_curve(x),
            // (7.3)
            StackBranch::From { start, .. } => start.value + 2.0 * self.virgin_curve(0.5 * (x - start.x)),
        };
        stack.set_value(y);
        self.parts.constant + y
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let positive = (0.0, f64::INFINITY);
        let MasingParts { constant, thresholds, slopes } = &self.parts;
        let (bend, slope) = ("bend of the virgin curve", "slope of the virgin curve");
        let mut all = vec![Parameter::new("c", "output constant", *constant, any, Dimension::OUTPUT)];
        all.extend(Parameter::numbered("r", 1, thresholds, bend, positive, Dimension::INPUT));
        all.extend(Parameter::numbered("m", 1, slopes, slope, any, Dimension::SLOPE));
        all
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT, MASING, ODD]].concat()
    }
}
