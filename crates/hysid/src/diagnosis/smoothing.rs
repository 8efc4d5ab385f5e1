//! A branch's course without its noise: local parabolas over neighbouring rows.
//!
//! How many rows may be taken together without bending the course is found from the data: as many as
//! leave no more behind than the noise.

use super::noise;

/// Rows taken together, the candidates; 1 leaves the data as they are.
const WINDOWS: [usize; 7] = [1, 7, 11, 17, 25, 39, 65];

/// Share of the remainder beyond the noise that is accepted, over all rows.
const ACCEPTED: f64 = 1.15;

/// The same for a tenth of a branch: nine in ten tenths are below.
const ACCEPTED_IN_A_PART: f64 = 1.8;

/// Branches that the window is chosen from.
const JUDGED: usize = 60;

/// A value and how far it may be off for noise of deviation 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smoothed {
    pub y: f64,
    /// Deviation of `y` where the rows' noise has deviation 1.
    pub deviation: f64,
}

/// The points `(x, y)`, in the order of `x`, each on the parabola of least squares through the `window` nearest
/// rows; a window at an end of the branch lies on one side of its row.
pub(crate) fn smooth(points: &[(f64, f64)], window: usize) -> Vec<Smoothed> {
    let window = window.min(points.len() - (points.len() + 1) % 2);
    if window < 5 {
        return points.iter().map(|&(_, y)| Smoothed { y, deviation: 1.0 }).collect();
    }
    (0..points.len())
        .map(|row| {
            let first = row.saturating_sub(window / 2).min(points.len() - window);
            parabola_at(&points[first..first + window], points[row])
        })
        .collect()
}

/// Value at `x` of the parabola of least squares; the mean where the points have no extent.
fn parabola_at(points: &[(f64, f64)], (x, y): (f64, f64)) -> Smoothed {
    let n = points.len() as f64;
    let extent = (points[points.len() - 1].0 - points[0].0).abs();
    if extent <= 1e-12 * x.abs() || extent == 0.0 {
        let mean = points.iter().map(|point| point.1).sum::<f64>() / n;
        return Smoothed { y: mean, deviation: n.sqrt().recip() };
    }
    let (mut s1, mut s2, mut s3, mut s4) = (0.0, 0.0, 0.0, 0.0);
    let (mut t0, mut t1, mut t2) = (0.0, 0.0, 0.0);
    for &(other, value) in points {
        let u = (other - x) / extent;
        let v = value - y;
        let square = u * u;
        s1 += u;
        s2 += square;
        s3 += square * u;
        s4 += square * square;
        t0 += v;
        t1 += v * u;
        t2 += v * square;
    }
    // First row of the inverse of the normal matrix, by cofactors.
    let c0 = s2 * s4 - s3 * s3;
    let c1 = s2 * s3 - s1 * s4;
    let c2 = s1 * s3 - s2 * s2;
    let determinant = n * c0 + s1 * c1 + s2 * c2;
    if determinant <= 1e-9 * n * s2 * s4 {
        // Three places at most: a mean of what stands at this one.
        let here: Vec<f64> = points.iter().filter(|point| point.0 == x).map(|point| point.1).collect();
        let n = here.len().max(1) as f64;
        return Smoothed { y: here.iter().sum::<f64>() / n, deviation: n.sqrt().recip() };
    }
    Smoothed {
        y: y + (c0 * t0 + c1 * t1 + c2 * t2) / determinant,
        deviation: (c0 / determinant).max(0.0).sqrt(),
    }
}

/// The longest window that leaves no more than the noise behind.
pub(crate) fn choose_window(branches: &[Vec<(f64, f64)>], deviation: f64) -> usize {
    if deviation <= 0.0 {
        return 1;
    }
    let mut order: Vec<&Vec<(f64, f64)>> = branches.iter().filter(|branch| branch.len() >= 7).collect();
    let step = order.len().div_ceil(JUDGED).max(1);
    order = order.into_iter().step_by(step).collect();
    let leaves_only_noise = |window: &&usize| {
        let (mut remainder, mut expected) = (0.0, 0.0);
        let mut parts = Vec::new();
        for points in &order {
            let smoothed = smooth(points, **window);
            for (rows, values) in
                points.chunks(points.len().div_ceil(10)).zip(smoothed.chunks(points.len().div_ceil(10)))
            {
                let pairs = || rows.iter().zip(values);
                let left: f64 = pairs().map(|(point, value)| (point.1 - value.y).powi(2)).sum();
                let free: f64 = pairs().map(|(_, value)| 1.0 - value.deviation.powi(2)).sum();
                remainder += left;
                expected += free * deviation * deviation;
                if free > 2.0 {
                    parts.push(left / (free * deviation * deviation));
                }
            }
        }
        let ninth = parts.len() * 9 / 10;
        let part = match parts.get(ninth) {
            Some(_) => *parts.select_nth_unstable_by(ninth, f64::total_cmp).1,
            None => 0.0,
        };
        // A tenth with few rows has much or little by chance.
        let rows = order.iter().map(|points| points.len() / 10).min().unwrap_or(1).max(1) as f64;
        let by_chance = 1.0 + noise::upper_quantile(0.1) * (2.0 / rows).sqrt();
        remainder <= ACCEPTED * expected && part <= ACCEPTED_IN_A_PART.max(1.3 * by_chance)
    };
    WINDOWS[1..].iter().rev().find(leaves_only_noise).copied().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_stays_as_it_is() {
        let points: Vec<(f64, f64)> =
            (0..50).map(|k| 0.1 * k as f64).map(|x| (x, 3.0 - x + 0.5 * x * x)).collect();
        for (point, value) in points.iter().zip(smooth(&points, 11)) {
            assert!((point.1 - value.y).abs() < 1e-11, "{point:?} {value:?}");
        }
    }

    #[test]
    fn deviations_are_those_of_least_squares() {
        // Even spacing, 5 rows: (3/35)(…) weights of Savitzky and Golay, whose middle one is 17/35.
        let points: Vec<(f64, f64)> = (0..20).map(|k| (k as f64, 0.0)).collect();
        let smoothed = smooth(&points, 5);
        assert!((smoothed[10].deviation.powi(2) - 17.0 / 35.0).abs() < 1e-12);
        assert!((smoothed[0].deviation.powi(2) - 31.0 / 35.0).abs() < 1e-12);
    }

    #[test]
    fn equal_places_are_averaged() {
        let points = [(1.0, 2.0), (1.0, 4.0), (1.0, 2.0), (1.0, 4.0), (1.0, 3.0)];
        assert_eq!(smooth(&points, 5)[2].y, 3.0);
    }
}
