//! Drives of first tests and of unseen ones.

use hysid::plan::{Leg, Limits, Path};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Slowest swing of a random drive, as a share of the largest rate; without time all swings are as fast as allowed.
const SLOWEST: f64 = 0.2;

/// Smallest swing of a random drive, as a share of the range.
const SMALLEST_SWING: f64 = 0.06;

/// A drive through turning points at the largest rate, cut to so many rows.
pub fn through(path: &Path, turns: impl Iterator<Item = f64>, rows: usize) -> Vec<f64> {
    drive(path, turns.map(|to| Leg::Swing { to, speed: 1.0 }), rows)
}

/// Random turning points all over the range, alternately above and below the one before, each swing at a speed of its
/// own.
pub fn random(path: &Path, rows: usize, seed: u64) -> Vec<f64> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let Limits { range: (low, high), start, step, .. } = path.limits;
    let least = SMALLEST_SWING * (high - low);
    let (mut x, mut rises) = (start, high - start > start - low);
    let legs = std::iter::repeat_with(|| {
        let end = if rises { high } else { low };
        let nearest = if rises { (x + least).min(end) } else { (x - least).max(end) };
        x = nearest + (end - nearest) * generator.random::<f64>();
        rises = !rises;
        let speed = SLOWEST.powf(generator.random::<f64>());
        Leg::Swing { to: x, speed: if step.is_some() { speed } else { 1.0 } }
    });
    drive(path, legs, rows)
}

fn drive(path: &Path, legs: impl Iterator<Item = Leg>, rows: usize) -> Vec<f64> {
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
