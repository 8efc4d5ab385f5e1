//! The next output over the next input, from one state of a model.

use hysid_core::error::Result;

/// A cell is bisected so often before its difference counts as a jump.
const BISECTIONS: usize = 34;

/// After this many bisections a difference must have shrunk to a quarter, or the cell is bisected on.
const FIRST_BISECTIONS: usize = 4;

/// Cells whose difference exceeds this multiple of the mean one are looked at for jumps, and the steepest cell always.
const STEEP: f64 = 2.0;

/// The trial output over the input, by rising input.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scan {
    pub points: Vec<(f64, f64)>,
    pub jumps: Vec<Jump>,
}

/// The ends of a jump, which are next to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jump {
    pub input: f64,
    pub outputs: (f64, f64),
}

/// The farthest way back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reversal {
    /// Inputs between which the output goes back.
    pub inputs: (f64, f64),
    pub outputs: (f64, f64),
}

impl Reversal {
    pub fn size(&self) -> f64 {
        (self.outputs.1 - self.outputs.0).abs()
    }
}

impl Scan {
    /// Scans `output` over a window, at `count` inputs. The last input is one of the points, because there the output
    /// may have a kink. Differences below `least` are no jumps.
    pub fn of(
        window: (f64, f64),
        count: usize,
        last: f64,
        least: f64,
        output: &mut impl FnMut(f64) -> Result<f64>,
    ) -> Result<Self> {
        let (low, high) = window;
        let mut inputs: Vec<f64> =
            (0..count).map(|k| low + (high - low) * (k as f64 / (count - 1) as f64)).collect();
        // Not a rounding beyond it.
        inputs[count - 1] = high;
        inputs.push(last.clamp(low, high));
        inputs.sort_by(f64::total_cmp);
        inputs.dedup();
        let points = inputs.into_iter().map(|x| Ok((x, output(x)?))).collect::<Result<Vec<_>>>()?;
        let mut scan = Self { points, jumps: Vec::new() };
        let size = |cell: &[(f64, f64)]| (cell[1].1 - cell[0].1).abs();
        let sizes: Vec<f64> = scan.points.windows(2).map(size).collect();
        let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        for (cell, &size) in sizes.iter().enumerate() {
            if size > least && (size > STEEP * mean || size == largest) {
                let jump = jump(scan.points[cell], scan.points[cell + 1], least, output)?;
                scan.jumps.extend(jump);
            }
        }
        Ok(scan)
    }

    /// Change of the output from the lowest input to the highest.
    pub fn change(&self) -> f64 {
        self.points[self.points.len() - 1].1 - self.points[0].1
    }

    pub fn width(&self) -> f64 {
        self.points[self.points.len() - 1].0 - self.points[0].0
    }

    /// Least and largest output.
    pub fn outputs(&self) -> (f64, f64) {
        let outputs = self.points.iter().map(|point| point.1);
        outputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)))
    }

    /// The farthest way of the output against a direction, 1 or -1.
    pub fn reversal(&self, direction: f64) -> Reversal {
        let (mut from, mut worst) = (self.points[0], (self.points[0], self.points[0]));
        for &point in &self.points[1..] {
            if direction * (point.1 - from.1) >= 0.0 {
                from = point;
            } else if direction * (from.1 - point.1) > direction * (worst.0.1 - worst.1.1) {
                worst = (from, point);
            }
        }
        let (from, to) = worst;
        Reversal { inputs: (from.0, to.0), outputs: (from.1, to.1) }
    }

    /// Outputs that more than one input has, if the output should go in a direction, 1 or -1: intervals, in any order.
    pub fn ambiguous(&self, direction: f64, tolerance: f64) -> Vec<(f64, f64)> {
        let outputs: Vec<f64> = self.points.iter().map(|point| direction * point.1).collect();
        let mut least_after = outputs.clone();
        for k in (0..outputs.len() - 1).rev() {
            least_after[k] = least_after[k].min(least_after[k + 1]);
        }
        let mut largest = f64::NEG_INFINITY;
        let mut intervals = Vec::new();
        for k in 0..outputs.len() - 1 {
            largest = largest.max(outputs[k]);
            let low = least_after[k + 1];
            if largest - low > tolerance {
                let (a, b) = (direction * low, direction * largest);
                intervals.push((a.min(b), a.max(b)));
            }
        }
        intervals
    }

    /// Parts of at least two cells over which the output does not change by more than `slope`.
    pub fn flats(&self, slope: f64) -> Vec<(f64, f64)> {
        let is_flat = |cell: &[(f64, f64)]| (cell[1].1 - cell[0].1).abs() <= slope * (cell[1].0 - cell[0].0);
        let cells: Vec<bool> = self.points.windows(2).map(is_flat).collect();
        let mut parts = Vec::new();
        let mut first = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            if run[0] && run.len() > 1 {
                parts.push((self.points[first].0, self.points[first + run.len()].0));
            }
            first += run.len();
        }
        parts
    }
}

/// Bisects a cell towards its larger difference. What is left after many bisections is a jump.
fn jump(
    mut left: (f64, f64),
    mut right: (f64, f64),
    least: f64,
    output: &mut impl FnMut(f64) -> Result<f64>,
) -> Result<Option<Jump>> {
    let size = |left: (f64, f64), right: (f64, f64)| (right.1 - left.1).abs();
    let whole = size(left, right);
    for bisection in 0..BISECTIONS {
        let x = 0.5 * left.0 + 0.5 * right.0;
        if x <= left.0 || x >= right.0 {
            break;
        }
        let middle = (x, output(x)?);
        if size(left, middle) > size(middle, right) {
            right = middle;
        } else {
            left = middle;
        }
        let here = size(left, right);
        if here <= least || bisection + 1 == FIRST_BISECTIONS && here < 0.25 * whole {
            return Ok(None);
        }
    }
    Ok(Some(Jump { input: right.0, outputs: (left.1, right.1) }))
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::tanh;

    use super::*;

    fn scan(function: impl Fn(f64) -> f64) -> Scan {
        Scan::of((-1.0, 1.0), 65, 0.3, 1e-6, &mut |x| Ok(function(x))).unwrap()
    }

    #[test]
    fn a_monotone_function_has_neither_reversals_nor_jumps() {
        // A kink, and a slope that is steep without a jump.
        for function in [|x: f64| x + f64::max(0.0, 9.0 * x), |x: f64| tanh(2000.0 * x) + 0.01 * x] {
            let scan = scan(function);
            assert_eq!(scan.reversal(1.0).size(), 0.0);
            assert!(scan.ambiguous(1.0, 0.0).is_empty() && scan.jumps.is_empty(), "{:?}", scan.jumps);
            assert!((scan.reversal(-1.0).size() - scan.change()).abs() < 1e-15);
            assert_eq!(scan.ambiguous(-1.0, 0.0).len(), scan.points.len() - 1);
        }
    }

    #[test]
    fn a_reversal_is_found_where_it_is() {
        let scan = scan(|x| {
            if x < 0.0 {
                x
            } else if x < 0.5 {
                -0.5 * x
            } else {
                x - 0.75
            }
        });
        let found = scan.reversal(1.0);
        assert_eq!((found.inputs, found.outputs), ((0.0, 0.5), (0.0, -0.25)));
        let intervals = scan.ambiguous(1.0, 0.0);
        let low = intervals.iter().map(|interval| interval.0).fold(f64::INFINITY, f64::min);
        let high = intervals.iter().map(|interval| interval.1).fold(f64::NEG_INFINITY, f64::max);
        assert_eq!((low, high), (-0.25, 0.0));
    }

    #[test]
    fn a_jump_is_found_with_its_size() {
        let scan = scan(|x| if x < 0.123 { 0.1 * x } else { 1.0 + 0.1 * x });
        assert_eq!(scan.jumps.len(), 1);
        let Jump { input, outputs } = scan.jumps[0];
        assert!((input - 0.123).abs() < 1e-9 && (outputs.1 - outputs.0 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_staircase_jumps_although_all_cells_are_equal() {
        assert!(!scan(|x| (64.0 * x).floor()).jumps.is_empty());
    }

    #[test]
    fn flat_parts_are_wider_than_a_cell() {
        let scan = scan(|x| f64::max(x, 0.5));
        assert_eq!(scan.flats(1e-6), [(-1.0, 0.5)]);
    }
}
