//! The undisturbed run as branches between turning points, with the turning points that enclose each of them.

use super::paths::{SUBSTEPS, range};

/// Reversals below this share of the input's range are none.
const SMALLEST: f64 = 0.02;

/// A course of the input in one direction.
pub struct Branch {
    /// Steps of its turning points, both included.
    pub first: usize,
    pub last: usize,
    pub from: f64,
    pub to: f64,
    /// Turning points that enclose its beginning, the latest last, which is its own beginning.
    pub outer: Vec<f64>,
    /// Those of them that still enclose its end.
    pub around: Vec<f64>,
    /// Turning points to which it returns: the input, and the step at which it was left.
    pub returns: Vec<(f64, usize)>,
}

impl Branch {
    pub fn rises(&self) -> bool {
        self.to > self.from
    }

    pub fn travel(&self) -> f64 {
        (self.to - self.from).abs()
    }

    /// Steps that it takes: its duration.
    pub fn steps(&self) -> usize {
        self.last - self.first
    }

    /// Where it leaves the loop that encloses it, or its end; none for a branch that nothing encloses.
    pub fn own_end(&self) -> Option<f64> {
        let before = *self.outer.iter().rev().nth(1)?;
        Some(if self.rises() { before.min(self.to) } else { before.max(self.to) })
    }

    /// Smallest and largest input.
    pub fn span(&self) -> (f64, f64) {
        (self.from.min(self.to), self.from.max(self.to))
    }
}

/// A run, cut into branches.
pub struct Branches<'r> {
    pub inputs: &'r [f64],
    pub outputs: &'r [f64],
    pub branches: Vec<Branch>,
    /// Whether the record has time stamps.
    pub timed: bool,
    /// Range of the input.
    pub width: f64,
    /// Range of the output.
    pub height: f64,
}

impl<'r> Branches<'r> {
    pub fn of(inputs: &'r [f64], outputs: &'r [f64], timed: bool) -> Self {
        let extent = |values: &[f64]| {
            let (low, high) = range(values);
            high - low
        };
        let (width, height) = (extent(inputs), extent(outputs));
        Self { inputs, outputs, branches: cut(inputs, SMALLEST * width), timed, width, height }
    }

    /// The output where a branch passes an input; none where it does not.
    pub fn at(&self, branch: &Branch, x: f64) -> Option<f64> {
        let (step, share) = self.place(branch, x)?;
        Some(self.outputs[step] + share * (self.outputs[step + 1] - self.outputs[step]))
    }

    /// True if two branches pass two inputs at the same speed, to a factor of 1.25, or time is unknown. A difference
    /// between branches of different speed may be one of memory or of rate.
    pub fn one_speed(&self, (a, x_a): (&Branch, f64), (b, x_b): (&Branch, f64)) -> bool {
        let speed = |branch: &Branch, x| {
            let (step, _) = self.place(branch, x)?;
            // Over two rows: the last step to a turning point is a part of one.
            let (first, last) =
                (step.saturating_sub(SUBSTEPS).max(branch.first), (step + SUBSTEPS).min(branch.last));
            Some((self.inputs[last] - self.inputs[first]).abs() / (last - first) as f64)
        };
        match (speed(a, x_a), speed(b, x_b)) {
            (Some(a), Some(b)) if self.timed => a.max(b) <= 1.25 * a.min(b),
            _ => true,
        }
    }

    /// The step before a branch passes an input, and the share of the next step.
    fn place(&self, branch: &Branch, x: f64) -> Option<(usize, f64)> {
        let (low, high) = branch.span();
        // Computed places may lie beyond the ends by a rounding error.
        let rounding = 1e-9 * self.width;
        if x < low - rounding || x > high + rounding {
            return None;
        }
        let inputs = &self.inputs[branch.first..=branch.last];
        let sign = if branch.rises() { 1.0 } else { -1.0 };
        let above = inputs.partition_point(|&v| sign * v < sign * x).clamp(1, inputs.len() - 1);
        let (a, b) = (inputs[above - 1], inputs[above]);
        let share = if a == b { 0.0 } else { ((x - a) / (b - a)).clamp(0.0, 1.0) };
        Some((branch.first + above - 1, share))
    }
}

/// Turning points and the two ends.
fn turning_steps(inputs: &[f64], smallest: f64) -> Vec<usize> {
    let mut turns = vec![0];
    // The extreme since the last turning point, and whether it is a maximum; unknown at the beginning.
    let (mut lowest, mut highest, mut rising) = (0, 0, None);
    for (step, &x) in inputs.iter().enumerate() {
        if x < inputs[lowest] {
            lowest = step;
        }
        if x > inputs[highest] {
            highest = step;
        }
        match rising {
            None if x - inputs[lowest] > smallest => (rising, highest) = (Some(true), step),
            None if inputs[highest] - x > smallest => (rising, lowest) = (Some(false), step),
            Some(true) if inputs[highest] - x > smallest => {
                turns.push(highest);
                (rising, lowest) = (Some(false), step);
            }
            Some(false) if x - inputs[lowest] > smallest => {
                turns.push(lowest);
                (rising, highest) = (Some(true), step);
            }
            _ => {}
        }
    }
    if turns[turns.len() - 1] != inputs.len() - 1 {
        turns.push(inputs.len() - 1);
    }
    turns
}

/// Follows the turning points by Madelung's rules: a branch that passes the turning point before its own closes the
/// loop between them.
fn cut(inputs: &[f64], smallest: f64) -> Vec<Branch> {
    let steps = turning_steps(inputs, smallest);
    let mut open: Vec<usize> = vec![steps[0]];
    let mut branches = Vec::new();
    for pair in steps.windows(2) {
        let (first, last) = (pair[0], pair[1]);
        let (from, to) = (inputs[first], inputs[last]);
        let outer = open.iter().map(|&step| inputs[step]).collect();
        let mut returns = Vec::new();
        while open.len() >= 2 {
            let step = open[open.len() - 2];
            let before = inputs[step];
            // Sampling misses the tips of repeated loops by different ways.
            let near = 0.002;
            if if to > from { to < before - near } else { to > before + near } {
                break;
            }
            if open.len() == 2 {
                open.remove(0);
                break;
            }
            returns.push((before, step));
            open.truncate(open.len() - 2);
        }
        let around = open.iter().map(|&step| inputs[step]).collect();
        open.push(last);
        branches.push(Branch { first, last, from, to, outer, around, returns });
    }
    branches
}
