//! Shor's r-algorithm, a sub-gradient method with space dilatation, which minimises functions that need not be smooth.
//!
//! ```text
//! R_γ(ξ) = I + (γ - 1) ξ ξᵀ,  |ξ| = 1
//! d = B Bᵀg / |Bᵀg|;   x <- x - h d  until  dᵀg(x) <= 0;   B <- B R_{1/α}(ξ)     theory.md (3.7)
//! ξ ∝ Bᵀ(g⁺ - g)                                                                 theory.md (3.8)
//! ```
//!
//! `x` are the variables, `g` is a sub-gradient of the function before and `g⁺` after the steps along the
//! direction `d`, `h` the step, `B` the transformation of the space and `α > 1` the coefficient of
//! dilatation.
//!
//! Each dilatation shortens the steps in a direction across which the sub-gradient jumps, so that a narrow
//! valley becomes round. `B` has the square of the number of variables as entries; an iteration reads it twice
//! and writes it once, in addition to the function. Of many variables its dilatations are kept instead.
//!
//! Training advances step by step with [`SpaceDilatation`], whose whole state can be stored. Source: Shor and Zhurbenko
//! (1971).

use hysid_core::elementary::square;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::linear_algebra::dilated_space::{DilatedSpace, dilate_vector};
use crate::linear_algebra::dot;
use crate::optimise::MOST_COUNTED;
use crate::termination::Termination;

/// A function and one of its sub-gradients: writes the sub-gradient, returns the value.
pub trait Subdifferentiable {
    /// Value at `x`; `subgradient` takes one of the sub-gradients there.
    fn evaluate(&mut self, x: &[f64], subgradient: &mut [f64]) -> f64;
}

impl<F: FnMut(&[f64], &mut [f64]) -> f64> Subdifferentiable for F {
    fn evaluate(&mut self, x: &[f64], subgradient: &mut [f64]) -> f64 {
        self(x, subgradient)
    }
}

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DilatationOptions {
    /// `α`: coefficient of dilatation, above 1, usually 2 to 4.
    pub coefficient: f64,
    /// First step `h`, about the distance to the minimum in units of the scales.
    pub first_step: f64,
    /// `q1`: factor of the step after an iteration with a single inner step. 1 for a function that is not
    /// smooth (a smaller factor shortens steps faster than the space is dilated), 0.8 to 0.95 for a smooth
    /// one.
    pub shrinkage: f64,
    /// `q2`: factor of the step at every third inner step.
    pub growth: f64,
}

impl Default for DilatationOptions {
    fn default() -> Self {
        Self { coefficient: 2.5, first_step: 1.0, shrinkage: 1.0, growth: 1.1 }
    }
}

impl DilatationOptions {
    /// An error for a setting outside its meaning.
    pub fn check(&self) -> Result<()> {
        let within = |name: &str, value: f64, low: f64, high: f64| match value >= low && value <= high {
            true => Ok(()),
            false => Err(Error::Parts(format!("{name} {value} is not between {low} and {high}"))),
        };
        within("coefficient of dilatation", self.coefficient, 1.001, 1e3)?;
        within("first step", self.first_step, 1e-100, 1e100)?;
        within("shrinkage of the step", self.shrinkage, 0.01, 1.0)?;
        within("growth of the step", self.growth, 1.0, 10.0)
    }
}

/// Inner steps after which the step grows.
const STEPS_BEFORE_GROWTH: usize = 3;
/// Inner steps that end an iteration in any case: the function seems to fall for ever.
const MOST_INNER_STEPS: usize = 500;
/// Times in a row that a step is halved because there the function is no number.
const MOST_HALVINGS: usize = 100;
/// A transformed vector this much shorter than rounding allows for is noise: the space begins anew.
const NOISE: f64 = 1e-13;
/// Largest entry of `B` below which all are divided by it.
const SMALLEST_ENTRY: f64 = 1e-50;

/// The state of a minimisation. It can be stored and resumed, to the last bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpaceDilatation {
    options: DilatationOptions,
    /// Typical length of each variable; `B` begins as the diagonal matrix of these.
    scales: Vec<f64>,
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    /// `B`.
    space: DilatedSpace,
    /// `Bᵀg`.
    transformed: Vec<f64>,
    /// `B Bᵀg / |Bᵀg|`, along which the next steps go.
    direction: Vec<f64>,
    step: f64,
    /// Length of the last inner step in units of the scales.
    last_move: f64,
    best: Minimum,
}

/// The lowest point found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Minimum {
    /// The variables there.
    pub x: Vec<f64>,
    /// The value of the function there.
    pub value: f64,
    /// Outer iterations so far.
    pub iterations: usize,
    /// Evaluations of the function so far, each with a sub-gradient.
    pub evaluations: usize,
}

impl SpaceDilatation {
    /// Begins at `x`. `scales` are typical lengths, one for each variable, which are the units of the steps.
    ///
    /// # Errors
    /// Invalid options, no variable, scales that are not positive, a function that is not finite at `x`.
    pub fn new(
        x: Vec<f64>,
        scales: Vec<f64>,
        options: DilatationOptions,
        f: &mut impl Subdifferentiable,
    ) -> Result<Self> {
        options.check()?;
        if x.is_empty() || x.len() != scales.len() || !x.iter().all(|x| x.is_finite()) {
            return Err(Error::Parts("a minimisation needs finite variables and a scale for each".into()));
        }
        if !scales.iter().all(|scale| *scale > 0.0 && scale.is_finite()) {
            return Err(Error::Parts("the scales of the variables must be positive".into()));
        }
        let mut gradient = vec![0.0; x.len()];
        let value = f.evaluate(&x, &mut gradient);
        if !is_usable(value, &gradient) {
            return Err(Error::Parts(
                "the function has no finite value and sub-gradient at the start".into(),
            ));
        }
        let best = Minimum { x: x.clone(), value, iterations: 0, evaluations: 1 };
        let space = DilatedSpace::of_scales(&scales);
        let mut search = Self {
            options,
            scales,
            x,
            value,
            gradient,
            space,
            transformed: Vec::new(),
            direction: Vec::new(),
            step: options.first_step,
            last_move: options.first_step,
            best,
        };
        search.aim();
        Ok(search)
    }

    /// True if a minimisation of a function of this number of variables with these settings can go on from here.
    pub(crate) fn is_sound(&self, variables: usize, options: &DilatationOptions) -> bool {
        let n = variables;
        let are_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let vectors =
            [&self.x, &self.scales, &self.gradient, &self.transformed, &self.direction, &self.best.x];
        let numbers = [self.value, self.step, self.last_move, self.best.value];
        self.options == *options
            && vectors.into_iter().all(|vector| vector.len() == n && are_finite(vector))
            && self.scales.iter().all(|scale| *scale > 0.0)
            && self.space.is_sound(n)
            && are_finite(&numbers)
            && self.step > 0.0
            && self.best.iterations.max(self.best.evaluations) <= MOST_COUNTED
    }

    /// The lowest point so far.
    pub fn best(&self) -> &Minimum {
        &self.best
    }

    /// One outer iteration: steps along one direction, then a dilatation. Returns why the search ends, if it does.
    pub fn advance(&mut self, f: &mut impl Subdifferentiable) -> Option<Termination> {
        self.best.iterations += 1;
        if norm(&self.gradient) == 0.0 {
            return Some(Termination::GradientVanished);
        }
        let before = std::mem::replace(&mut self.gradient, vec![0.0; self.x.len()]);
        if !self.walk(f) {
            self.gradient = before;
            return Some(Termination::NoFurtherImprovement);
        }
        let after = self.space.transpose_times(&self.gradient);
        let xi = difference(&after, &self.transformed);
        if self.is_noise(&xi, &difference(&self.gradient, &before)) {
            self.begin_anew();
        } else {
            self.dilate(&xi, after);
        }
        None
    }

    /// Steps along the direction until the function rises along it; false if the point cannot change.
    fn walk(&mut self, f: &mut impl Subdifferentiable) -> bool {
        let mut inner = 0;
        let mut halvings = 0;
        let unit = norm_in(&self.direction, &self.scales);
        loop {
            let next: Vec<f64> = self.x.iter().zip(&self.direction).map(|(x, d)| x - self.step * d).collect();
            if next == self.x {
                return false;
            }
            // The function is asked nothing of what is no point.
            let is_point = next.iter().all(|x| x.is_finite());
            let value = if is_point { f.evaluate(&next, &mut self.gradient) } else { f64::NAN };
            self.best.evaluations += usize::from(is_point);
            if !is_usable(value, &self.gradient) {
                halvings += 1;
                if halvings == MOST_HALVINGS {
                    return false;
                }
                self.step *= 0.5;
                continue;
            }
            inner += 1;
            self.x = next;
            self.value = value;
            if value < self.best.value {
                self.best.value = value;
                self.best.x.copy_from_slice(&self.x);
            }
            self.last_move = self.step * unit;
            // Counted before it is compared: the step grows at the third step, not at the first.
            if inner % STEPS_BEFORE_GROWTH == 0 {
                self.step *= self.options.growth;
            }
            if dot(&self.direction, &self.gradient) <= 0.0 || inner == MOST_INNER_STEPS {
                if inner == 1 {
                    self.step *= self.options.shrinkage;
                }
                return true;
            }
        }
    }

    /// Forgets the dilatations; the step is the last one in the undilated space, as the dilated one may be huge.
    fn begin_anew(&mut self) {
        self.space = DilatedSpace::of_scales(&self.scales);
        self.step = self.last_move / STEPS_BEFORE_GROWTH as f64;
        self.aim();
    }

    /// The direction in which the function falls, in a space that is not dilated yet.
    fn aim(&mut self) {
        self.transformed = self.space.transpose_times(&self.gradient);
        self.direction = self.space.times(&unit(&self.transformed));
    }

    /// `B <- B R_{1/α}(ξ / |ξ|)`, and the next direction. `transformed` is `Bᵀg` of the space as it was.
    fn dilate(&mut self, xi: &[f64], transformed: Vec<f64>) {
        let (xi, gamma) = (unit(xi), 1.0 / self.options.coefficient);
        self.transformed = transformed;
        // R is symmetric: Bᵀg of the new space is R Bᵀg.
        dilate_vector(&mut self.transformed, &xi, gamma);
        self.direction = self.space.dilate(&xi, gamma, &unit(&self.transformed));
        // det B falls with every dilatation: a common factor moves from B to the step, without effect on the points.
        if self.space.largest_entry() < SMALLEST_ENTRY {
            let largest = self.space.normalise();
            self.transformed.iter_mut().chain(&mut self.direction).for_each(|value| *value /= largest);
            self.step *= largest;
        }
        if norm(&self.gradient) > 0.0 && self.is_noise(&self.transformed, &self.gradient) {
            self.begin_anew();
        }
    }

    /// True if `u = Bᵀg` is shorter than rounding allows for.
    fn is_noise(&self, u: &[f64], g: &[f64]) -> bool {
        norm(u) <= NOISE * norm(g) * self.space.largest_entry()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn unit(v: &[f64]) -> Vec<f64> {
    let length = norm(v).max(f64::MIN_POSITIVE);
    v.iter().map(|v| v / length).collect()
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

fn norm_in(v: &[f64], scales: &[f64]) -> f64 {
    v.iter().zip(scales).map(|(v, scale)| square(v / scale)).sum::<f64>().sqrt()
}

fn is_usable(value: f64, gradient: &[f64]) -> bool {
    value.is_finite() && gradient.iter().all(|g| g.is_finite())
}
