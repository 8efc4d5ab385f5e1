//! The classical Preisach model: relays spread over a plane that is divided into cells.
//!
//! ```text
//! y = c + k x + Σ_j v_j m_j(x) + Σ_ij w_ij R_ij[x]                        theory.md (7.8)
//! ```
//!
//! `x` is the input, `y` the output. `R_ij` is the mean output, -1 to 1, of [relays](crate::operator::relay)
//! spread evenly over cell `(i, j)`: they switch up at an `α` in interval `i` and down at a `β` in interval
//! `j`, with `β <= α`. `m_j` is that of relays without width (`α = β`) in interval `j`, which have no memory;
//! with `k x` they are the reversible part.
//!
//! The state is the staircase between relays up and relays down, stored as a stack of dominant extrema. A
//! step costs one value of the Everett function, for any number of cells.
//!
//! Properties: wiping-out and congruency hold, and every model with both is a Preisach model (Mayergoyz).

mod everett;
pub mod plane;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts};
use crate::law::properties::{CONGRUENT, WIPES_OUT};
use crate::law::thresholds::{check_weights, limited};
use crate::law::turning_point_stack::{StackBranch, TurningPointStack};
use crate::law::{Dimension, Law, Parameter, Sample, stored_as};
use crate::property::Property;
use everett::EverettTables;
use plane::Plane;

/// Most intervals of each axis.
pub const MOST_INTERVALS: usize = 200;

/// A Preisach model on a plane of cells: `y = c + k x + Σ_j v_j m_j(x) + Σ_ij w_ij R_ij[x]` (theory.md
/// (7.8)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PreisachWeights", into = "PreisachWeights")]
pub struct Preisach {
    weights: PreisachWeights,
    /// Output in the virgin state, reversible part left out.
    virgin: f64,
    everett: EverettTables,
    /// Reversible output at each line, without `k x`.
    reversible: Vec<f64>,
}

/// Parameters of a Preisach model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreisachWeights {
    /// Constant `c`, in the unit of the output.
    pub constant: f64,
    /// Slope `k` of the reversible part, in the unit of the output divided by that of the input.
    pub slope: f64,
    /// Inputs of the `N + 1` lines of both axes of the plane, in the unit of the input, rising.
    pub lines: Vec<f64>,
    /// Weights `v_j` of the `N` intervals in the reversible part, in the unit of the output.
    pub reversible: Vec<f64>,
    /// Weights `w_ij` of the `N (N + 1)/2` cells in the unit of the output, row by row: `w_00, w_10, w_11, w_20, ...`,
    /// `i` the interval of `α` (switching up), `j ≤ i` that of `β` (switching down).
    pub cells: Vec<f64>,
}

/// Tables of a Preisach model for a plane of `N` intervals, in the unit of the output.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// Of each cell, row by row, with `N` cells a row: its weight `w_ij`, `E` of the triangle between lines `j + 1` and
    /// `i`, the sum of the weights of row `i` between columns `j` and `i`, and that of column `j` between rows `j` and
    /// `i`. All are 0 above the diagonal.
    pub cells: Vec<[f64; 4]>,
    /// Output along the virgin curve upwards and downwards: magnitudes of the input, rising from 0, and for each the
    /// coefficients of a parabola in the distance from there; the last is constant.
    pub virgin: [(Vec<f64>, Vec<[f64; 3]>); 2],
    /// Reversible output at each line, without `k x`.
    pub reversible: Vec<f64>,
}

stored_as!(PreisachWeights of Preisach in weights);

impl Preisach {
    /// A model from its parameters.
    ///
    /// # Errors
    /// Fewer than two lines or more than 201, lines that are not finite and rising, numbers of weights that
    /// do not fit, a weight that is not finite or beyond 1e100.
    pub fn new(weights: PreisachWeights) -> Result<Self> {
        let lines = &weights.lines;
        if lines.len() < 2 || lines.len() > MOST_INTERVALS + 1 {
            return Err(Error::Parts(format!(
                "{} lines: a plane has 2 to {}",
                lines.len(),
                MOST_INTERVALS + 1
            )));
        }
        check_weights(lines)?;
        if let Some(pair) = lines.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(Error::Parts(format!("line {} after {}: lines must rise", pair[1], pair[0])));
        }
        let plane = Plane::new(lines.clone());
        let expected = (plane.intervals(), plane.cells());
        if (weights.reversible.len(), weights.cells.len()) != expected {
            return Err(Error::Parts(format!(
                "{} reversible weights and {} cells where {} lines make {} and {}",
                weights.reversible.len(),
                weights.cells.len(),
                lines.len(),
                expected.0,
                expected.1
            )));
        }
        check_weights(&[weights.constant, weights.slope])?;
        check_weights(&weights.reversible)?;
        check_weights(&weights.cells)?;
        let virgin = plane.indices().zip(&weights.cells).map(|((i, j), w)| w * plane.virgin_mean(i, j)).sum();
        let mut reversible = vec![-weights.reversible.iter().sum::<f64>()];
        for (j, v) in weights.reversible.iter().enumerate() {
            reversible.push(reversible[j] + 2.0 * v);
        }
        Ok(Self { everett: EverettTables::new(&plane, &weights.cells), virgin, reversible, weights })
    }

    /// The parameters.
    pub fn weights(&self) -> &PreisachWeights {
        &self.weights
    }

    /// Output in the virgin state, without its reversible part, in the unit of the output.
    pub fn virgin_output(&self) -> f64 {
        self.virgin
    }

    /// The tables by which the output is computed, for programs that do the same.
    pub fn tables(&self) -> Tables {
        let [up, down] = self.everett.virgin_curves();
        Tables { cells: self.everett.cells(), virgin: [up, down], reversible: self.reversible.clone() }
    }

    /// The Everett function `E(a, b) = Σ_ij w_ij (share of cell ij within b <= β <= α <= a)`: half of the
    /// decrease of the output, without its reversible part, when the input falls from `a` to `b` after a rise
    /// from `b` or below (theory.md (7.10)). 0 unless `a > b`. `a` and `b` are in the unit of the input, the
    /// value in that of the output.
    pub fn everett(&self, a: f64, b: f64) -> f64 {
        self.everett.value(self.everett.place(a), self.everett.place(b))
    }

    /// `c + k x + Σ v_j m_j(x)`
    fn reversible_part(&self, x: f64) -> f64 {
        let (interval, share) = self.everett.place(x).parts();
        // (7.8)
        let between = self.reversible[interval] + 2.0 * share * self.weights.reversible[interval];
        self.weights.constant + self.weights.slope * x + between
    }
}

impl Law for Preisach {
    /// Dominant extrema, each with the output there without its reversible part.
    type State = TurningPointStack<f64>;

    const FACTS: Facts = Facts {
        limits: &[("operators", 1, MOST_INTERVALS)],
        stands_alone: true,
        advice: &[(Behaviour::UnlikeBranches, Advised::Simplest)],
        ..Facts::linear(
            "preisach",
            "plane of relays with a smooth density",
            &["operators", "sign"],
            ErrorsInside { softening: 0.6, sigmoid: 0.1, other: 0.2 },
        )
        .with_defaults(&[("operators", 30)])
    };

    fn virgin(&self) -> Self::State {
        TurningPointStack::default()
    }

    fn step(&self, stack: &mut Self::State, sample: Sample) -> f64 {
        let x = limited(sample.x);
        stack.advance(x, 0.0);
        let switched = match stack.branch() {
            StackBranch::Virgin if x >= 0.0 => self.virgin + 2.0 * self.everett.virgin(x), // (7.11)
            StackBranch::Virgin => self.virgin - 2.0 * self.everett.virgin(x),             // (7.11)
            StackBranch::From { start, .. } if x > start.x => start.value + 2.0 * self.everett(x, start.x),
            StackBranch::From { start, .. } => start.value - 2.0 * self.everett(start.x, x),
        };
        stack.set_value(switched);
        switched + self.reversible_part(x)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let PreisachWeights { constant, slope, lines, reversible, cells } = &self.weights;
        let (line, interval) = ("line of the Preisach plane", "reversible weight of an interval");
        let mut all = Parameter::table([
            ("c", "output constant", *constant, any, Dimension::OUTPUT),
            ("k", "reversible slope", *slope, any, Dimension::SLOPE),
        ]);
        all.extend(Parameter::numbered("x", 0, lines, line, any, Dimension::INPUT));
        all.extend(Parameter::numbered("v", 0, reversible, interval, any, Dimension::OUTPUT));
        for ((i, j), &w) in Plane::new(lines.clone()).indices().zip(cells) {
            let symbol = format!("w_{i},{j}");
            all.push(Parameter::new(symbol, "weight of a cell's relays", w, any, Dimension::OUTPUT));
        }
        all
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        [WIPES_OUT.as_slice(), &[CONGRUENT]].concat()
    }
}
