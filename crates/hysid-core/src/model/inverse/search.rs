//! Search of the argument at which a function of one variable has a value.
//!
//! A walk in strides that at least double finds two arguments with values on both sides of the target. Between them,
//! secants propose the next argument: through the last two on one side, which meets the target where both are behind the
//! same kink, then through the nearest on both sides. If the interval has not halved then, its midpoint is next. The
//! function need not be smooth: hysteresis operators have kinks.
//!
//! | part | function values, at most |
//! |---|---|
//! | walk | [`MOST_STRIDES`] |
//! | interval, which halves in every three steps | [`MOST_HALVINGS`] times three |
//! | scan, if the walk finds no interval | [`SCANNED`], and [`GOLDEN`] for the nearest value |

/// Function values of a walk, at most.
pub const MOST_STRIDES: usize = 24;

/// Halvings of an interval, at most: as many as a double has bits, and some more.
pub const MOST_HALVINGS: usize = 60;

/// Arguments of a scan.
pub const SCANNED: usize = 33;

/// Function values of the search of an extremum.
pub const GOLDEN: usize = 40;

/// Function values of a search, at most.
pub const MOST_VALUES: usize = 1 + MOST_STRIDES + SCANNED + GOLDEN + 3 * MOST_HALVINGS;

/// The smallest first stride, as a share of the window.
const LEAST_STRIDE: f64 = 1e-6;

/// Deviation that counts as reached where the numbers are not dense enough for the tolerance, as a multiple of it.
const ACCEPTED: f64 = 1e3;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchEnding {
    /// The function has the value.
    Reached,
    /// The nearest value is at the low end of the window.
    Low,
    /// The nearest value is at the high end of the window.
    High,
    /// The nearest value is an extremum inside the window.
    Extremum,
    /// The function jumps over the value.
    Jump,
}

impl SearchEnding {
    /// True if the value is not among those of the window.
    pub fn is_beside(self) -> bool {
        matches!(self, Self::Low | Self::High | Self::Extremum)
    }
}

/// An argument with its function value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchPoint {
    pub argument: f64,
    pub value: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct TargetValue {
    /// Value of the function.
    pub value: f64,
    /// Largest deviation from it.
    pub tolerance: f64,
    /// Least and largest argument.
    pub window: (f64, f64),
}

/// Last point of a search, and why it ended.
#[derive(Debug, Clone, Copy)]
pub struct SearchResult {
    pub point: SearchPoint,
    pub ending: SearchEnding,
    /// Slope of the last secant, if there was one.
    pub slope: Option<f64>,
}

impl TargetValue {
    fn excess(&self, point: SearchPoint) -> f64 {
        point.value - self.value
    }

    fn is_reached(&self, point: SearchPoint) -> bool {
        self.excess(point).abs() <= self.tolerance
    }

    fn found(&self, point: SearchPoint, slope: Option<f64>) -> SearchResult {
        SearchResult { point, ending: SearchEnding::Reached, slope }
    }

    /// The argument at which `function` has the value, nearest to `first` in the direction that `slope` gives.
    pub fn search<E>(
        &self,
        first: f64,
        slope: f64,
        function: &mut impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<SearchResult, E> {
        let (low, high) = self.window;
        let mut at = |argument: f64| function(argument).map(|value| SearchPoint { argument, value });
        let mut here = at(first.clamp(low, high))?;
        if self.is_reached(here) {
            return Ok(self.found(here, None));
        }
        let direction = if (self.excess(here) < 0.0) == (slope >= 0.0) { 1.0 } else { -1.0 };
        let mut stride = (1.5 * self.excess(here) / slope).abs();
        if !stride.is_finite() {
            stride = 0.0;
        }
        stride = stride.clamp(LEAST_STRIDE * (high - low), high - low);
        for _ in 0..MOST_STRIDES {
            let next = (here.argument + direction * stride).clamp(low, high);
            if next == here.argument {
                break;
            }
            let there = at(next)?;
            if self.is_reached(there) {
                return Ok(self.found(there, Some(secant(here, there))));
            }
            if (self.excess(here) < 0.0) != (self.excess(there) < 0.0) {
                return self.enclosed(here, there, &mut at);
            }
            let needed = (1.5 * self.excess(there) / secant(here, there)).abs();
            stride = if needed.is_finite() { needed.max(2.0 * stride) } else { 2.0 * stride };
            here = there;
        }
        self.scan(first, &mut at)
    }

    /// Searches between two arguments with values on both sides of the wanted one.
    fn enclosed<E>(
        &self,
        first: SearchPoint,
        second: SearchPoint,
        at: &mut impl FnMut(f64) -> Result<SearchPoint, E>,
    ) -> Result<SearchResult, E> {
        let (mut below, mut above) = if self.excess(first) < 0.0 { (first, second) } else { (second, first) };
        // The last two points on the side of the last one.
        let (mut before, mut last) = (first, second);
        let width = |below: SearchPoint, above: SearchPoint| (above.argument - below.argument).abs();
        for _ in 0..MOST_HALVINGS {
            let half = 0.5 * width(below, above);
            for part in 0..3 {
                let middle = 0.5 * (below.argument + above.argument);
                let (from, slope) = match part {
                    0 => (last, secant(before, last)),
                    _ => (below, secant(below, above)),
                };
                let proposed = from.argument - self.excess(from) / slope;
                let inside = (proposed - below.argument) * (proposed - above.argument) < 0.0;
                let next = if inside && part < 2 { proposed } else { middle };
                if next == below.argument || next == above.argument {
                    return Ok(self.at_jump(below, above));
                }
                let there = at(next)?;
                if self.is_reached(there) {
                    return Ok(self.found(there, Some(secant(from, there))));
                }
                let side = if self.excess(there) < 0.0 { &mut below } else { &mut above };
                (before, last) = (*side, there);
                *side = there;
                if width(below, above) <= half {
                    break;
                }
            }
        }
        Ok(self.at_jump(below, above))
    }

    /// The nearer side of a jump.
    fn at_jump(&self, below: SearchPoint, above: SearchPoint) -> SearchResult {
        let point = if -self.excess(below) <= self.excess(above) { below } else { above };
        let is_near = self.excess(point).abs() <= ACCEPTED * self.tolerance;
        SearchResult {
            point,
            ending: if is_near { SearchEnding::Reached } else { SearchEnding::Jump },
            slope: None,
        }
    }

    /// Looks at the whole window, for a function that is not monotone or does not have the value.
    fn scan<E>(
        &self,
        first: f64,
        at: &mut impl FnMut(f64) -> Result<SearchPoint, E>,
    ) -> Result<SearchResult, E> {
        let (low, high) = self.window;
        let points = (0..SCANNED)
            .map(|k| {
                let share = k as f64 / (SCANNED - 1) as f64;
                at(if k + 1 == SCANNED { high } else { low + share * (high - low) })
            })
            .collect::<Result<Vec<SearchPoint>, E>>()?;
        if let Some(&point) = points.iter().find(|point| self.is_reached(**point)) {
            return Ok(self.found(point, None));
        }
        let distance = |pair: &[SearchPoint]| (0.5 * (pair[0].argument + pair[1].argument) - first).abs();
        let crossing = points
            .windows(2)
            .filter(|pair| (self.excess(pair[0]) < 0.0) != (self.excess(pair[1]) < 0.0))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(pair) = crossing {
            return self.enclosed(pair[0], pair[1], at);
        }
        let deviation = |k: &usize| self.excess(points[*k]).abs();
        let near = |k: &usize| (points[*k].argument - first).abs();
        let by = |a: &usize, b: &usize| {
            deviation(a).total_cmp(&deviation(b)).then_with(|| near(a).total_cmp(&near(b)))
        };
        match (0..SCANNED).min_by(by).expect("there are points") {
            0 => Ok(SearchResult { point: points[0], ending: SearchEnding::Low, slope: None }),
            k if k + 1 == SCANNED => {
                Ok(SearchResult { point: points[k], ending: SearchEnding::High, slope: None })
            }
            k => self.extremum([points[k - 1], points[k], points[k + 1]], at),
        }
    }

    /// The nearest value between the outer two of three arguments, by golden sections.
    fn extremum<E>(
        &self,
        [left, middle, right]: [SearchPoint; 3],
        at: &mut impl FnMut(f64) -> Result<SearchPoint, E>,
    ) -> Result<SearchResult, E> {
        let (mut low, mut best, mut high) = (left.argument, middle, right.argument);
        let golden = 0.5 * (3.0 - 5.0_f64.sqrt());
        for _ in 0..GOLDEN {
            let upwards = high - best.argument > best.argument - low;
            let step = golden * if upwards { high - best.argument } else { low - best.argument };
            let there = at(best.argument + step)?;
            if self.is_reached(there) {
                return Ok(self.found(there, None));
            }
            if (self.excess(there) < 0.0) != (self.excess(best) < 0.0) {
                return self.enclosed(best, there, at);
            }
            let (nearer, other) = match self.excess(there).abs() < self.excess(best).abs() {
                true => (there, best.argument),
                false => (best, there.argument),
            };
            *(if other < nearer.argument { &mut low } else { &mut high }) = other;
            best = nearer;
        }
        Ok(SearchResult { point: best, ending: SearchEnding::Extremum, slope: None })
    }
}

fn secant(a: SearchPoint, b: SearchPoint) -> f64 {
    (b.value - a.value) / (b.argument - a.argument)
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::elementary::{atanh, powi, tanh};

    fn search(value: f64, first: f64, function: impl Fn(f64) -> f64) -> (SearchResult, usize) {
        let mut count = 0;
        let wanted = TargetValue { value, tolerance: 1e-13, window: (-2.0, 3.0) };
        let mut counted = |x| -> Result<f64, Infallible> {
            count += 1;
            Ok(function(x))
        };
        let found = wanted.search(first, 1.0, &mut counted).unwrap();
        (found, count)
    }

    #[test]
    fn a_line_takes_three_values() {
        let (found, count) = search(1.0, 0.0, |x| 2.0 * x + 0.5);
        assert_eq!(found.ending, SearchEnding::Reached);
        assert!((found.point.argument - 0.25).abs() < 1e-13 && count <= 3, "{count}");
    }

    #[test]
    fn kinks_are_no_hindrance() {
        let kinked = |x: f64| if x < 0.7 { 0.01 * x } else { 0.007 + 30.0 * (x - 0.7) };
        for value in [-0.015, 0.001, 0.0069, 0.0071, 5.0, 60.0] {
            let (found, count) = search(value, 0.0, kinked);
            assert_eq!(found.ending, SearchEnding::Reached, "{value}");
            assert!((kinked(found.point.argument) - value).abs() <= 1e-13 && count < 30, "{value}: {count}");
        }
    }

    #[test]
    fn decreasing_functions_are_found_by_the_scan() {
        let (found, _) = search(0.3, 0.0, |x| -tanh(x));
        assert_eq!(found.ending, SearchEnding::Reached);
        assert!((found.point.argument + atanh(0.3)).abs() < 1e-12);
    }

    #[test]
    fn the_ends_of_the_window_are_named() {
        assert_eq!(search(9.0, 0.0, |x| x).0.ending, SearchEnding::High);
        assert_eq!(search(9.0, 0.0, |x| x).0.point.argument, 3.0);
        assert_eq!(search(-9.0, 0.0, |x| x).0.ending, SearchEnding::Low);
    }

    #[test]
    fn an_extremum_is_found() {
        let (found, _) = search(2.0, 0.0, |x| 1.0 - (x - 0.61) * (x - 0.61));
        assert_eq!(found.ending, SearchEnding::Extremum);
        assert!((found.point.argument - 0.61).abs() < 1e-6);
    }

    #[test]
    fn a_jump_ends_at_its_nearer_side() {
        let (found, count) = search(0.9, -1.0, |x| if x < 1.25 { 0.01 * x } else { 1.0 });
        assert_eq!(found.ending, SearchEnding::Jump);
        assert_eq!(found.point.value, 1.0);
        assert!(count <= MOST_STRIDES + 3 * MOST_HALVINGS);
    }

    /// A walk and an interval that never halves early.
    #[test]
    fn the_number_of_function_values_is_bounded() {
        for power in [3, 9, 31, 101] {
            let (found, count) = search(1e-9, -1.9, |x| powi(x, power));
            assert!(found.ending == SearchEnding::Reached, "{power}");
            assert!(count <= MOST_STRIDES + 3 * MOST_HALVINGS, "{power}: {count}");
        }
    }
}
