//! Drives of tests: cycles, and random reversals.

use hysid::plan::{DrivePath, Leg, Limits};
use hysid_core::elementary::powf;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Slowest swing of a random drive, as a share of the largest rate; without time all swings are as fast as allowed.
const SLOWEST: f64 = 0.2;

/// Smallest swing of a random drive, as a share of the range.
const SMALLEST_SWING: f64 = 0.06;

/// A drive through turning points at the largest rate, cut to so many rows.
pub fn through(path: &DrivePath, turns: impl Iterator<Item = f64>, rows: usize) -> Vec<f64> {
    drive(path, turns.map(|to| Leg::Swing { to, speed: 1.0 }), rows)
}

/// Random turning points all over the range, alternately above and below the one before, each swing at a speed of its
/// own.
pub fn random(path: &DrivePath, rows: usize, seed: u64) -> Vec<f64> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let Limits { range: (low, high), start, step, .. } = path.limits;
    let least = SMALLEST_SWING * (high - low);
    let (mut x, mut rises) = (start, high - start > start - low);
    let legs = std::iter::repeat_with(|| {
        let end = if rises { high } else { low };
        let nearest = if rises { (x + least).min(end) } else { (x - least).max(end) };
        x = nearest + (end - nearest) * generator.random::<f64>();
        rises = !rises;
        let speed = powf(SLOWEST, generator.random::<f64>());
        Leg::Swing { to: x, speed: if step.is_some() { speed } else { 1.0 } }
    });
    drive(path, legs, rows)
}

/// Cycles about the start at the largest rate, as many as `levels`; a level is the share of the range on each side.
pub fn cycles(path: &DrivePath, levels: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let Limits { range: (low, high), start, .. } = path.limits;
    let turns = levels.into_iter().flat_map(|level| [high, low].map(|end| start + level * (end - start)));
    through(path, turns.chain([start]), usize::MAX)
}

/// The same path within a share of its range on each side of the start.
pub fn within(path: &DrivePath, share: f64) -> DrivePath {
    let Limits { range: (low, high), start, .. } = path.limits;
    let range = (start + share * (low - start), start + share * (high - start));
    DrivePath { limits: Limits { range, ..path.limits }, ..*path }
}

fn drive(path: &DrivePath, legs: impl Iterator<Item = Leg>, rows: usize) -> Vec<f64> {
    let mut x = vec![path.limits.start];
    for leg in legs {
        if x.len() >= rows {
            break;
        }
        let from = x[x.len() - 1];
        x.extend(path.leg(from, leg));
    }
    x.truncate(rows);
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use hysid::plan::Wave;

    fn path() -> DrivePath {
        let limits = Limits { range: (-2.0, 2.0), start: 0.0, step: None, max_rate: 0.1, rows: 100 };
        DrivePath { limits, wave: Wave::Triangle }
    }

    #[test]
    fn cycles_reach_their_levels_and_end_at_the_start() {
        let input = cycles(&path(), [0.5, 1.0]);
        let largest = |rows: &[f64]| rows.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // The first cycle travels 1 + 2 in steps of 0.1, then the second rises.
        assert!((largest(&input[..40]) - 1.0).abs() < 1e-12 && (largest(&input) - 2.0).abs() < 1e-12);
        assert_eq!((input[0], input[input.len() - 1]), (0.0, 0.0));
    }

    #[test]
    fn a_share_of_the_range_bounds_random_reversals() {
        let input = random(&within(&path(), 0.25), 500, 1);
        let largest = input.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        assert!(largest <= 0.5 && largest > 0.4, "{largest}");
    }
}
