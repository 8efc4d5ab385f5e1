//! Pieces of drives among which a plan chooses.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::path::Leg;
use super::segment::Kind;

/// A piece of a drive.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub kind: Kind,
    pub legs: Vec<Leg>,
}

/// Amplitudes of loops about the middle, as shares of half the range.
const AMPLITUDES: [f64; 7] = [1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.1];

/// Middles of minor loops, from -1 to 1 over the range, and their amplitudes as shares of half the range.
const MIDDLES: [f64; 6] = [-0.75, -0.5, -0.25, 0.25, 0.5, 0.75];
const MINOR_AMPLITUDES: [f64; 3] = [0.12, 0.25, 0.4];

/// Places at which reversal curves begin, as shares of the range away from the end that they come from.
const REVERSALS: [f64; 7] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9];

/// Ratio of the amplitudes of nested loops, and their turning points.
const FALL: f64 = 0.75;
const NESTED: usize = 7;

/// Random paths among which one may be chosen, and their turning points.
const RANDOM_PATHS: usize = 24;
const RANDOM_TURNS: usize = 4;

/// Smallest swing of a random path, as a share of the range.
const SMALLEST_SWING: f64 = 0.06;

/// Candidates within a range at a share of the largest rate, from an input on.
pub(super) fn candidates(
    from: f64,
    (low, high): (f64, f64),
    speed: f64,
    generator: &mut Xoshiro256PlusPlus,
) -> Vec<Candidate> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    // The way to a loop is no part of it, and fast.
    let path = |kind: Kind, turns: Vec<f64>| {
        let of_leg = |place: usize| if place == 0 && kind != Kind::RandomReversals { 1.0 } else { speed };
        let legs = turns.into_iter().enumerate();
        Candidate { kind, legs: legs.map(|(place, to)| Leg::Swing { to, speed: of_leg(place) }).collect() }
    };
    let mut all = Vec::new();
    for amplitude in AMPLITUDES {
        let (up, down) = (middle + amplitude * half, middle - amplitude * half);
        all.push(path(Kind::CentredLoop, vec![up, down, up]));
        all.push(path(Kind::CentredLoop, vec![down, up, down]));
    }
    for place in MIDDLES {
        for amplitude in MINOR_AMPLITUDES {
            let (up, down) = (middle + (place + amplitude) * half, middle + (place - amplitude) * half);
            if up <= high && down >= low {
                all.push(path(Kind::MinorLoop, vec![up, down, up]));
                all.push(path(Kind::MinorLoop, vec![down, up, down]));
            }
        }
    }
    for share in REVERSALS {
        let (below, above) = (high - 2.0 * share * half, low + 2.0 * share * half);
        all.push(path(Kind::ReversalCurve, vec![high, below, high]));
        all.push(path(Kind::ReversalCurve, vec![low, above, low]));
    }
    for sign in [1.0, -1.0] {
        let turn = |k: usize| {
            let side = if k.is_multiple_of(2) { sign } else { -sign };
            middle + side * half * FALL.powi(k as i32)
        };
        all.push(path(Kind::NestedLoops, (0..NESTED).map(turn).collect()));
    }
    for _ in 0..RANDOM_PATHS {
        all.push(path(Kind::RandomReversals, random_turns(from, (low, high), generator)));
    }
    all.retain(|candidate| starts_with_a_swing(from, candidate, 2.0 * half));
    all
}

/// Turning points at random, alternately above and below the one before.
fn random_turns(from: f64, (low, high): (f64, f64), generator: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let least = SMALLEST_SWING * (high - low);
    let mut x = from.clamp(low, high);
    let mut rises = match (x - low < least, high - x < least) {
        (true, _) => true,
        (_, true) => false,
        _ => generator.random::<f64>() < 0.5,
    };
    let turn = |_| {
        let end = if rises { high } else { low };
        let nearest = if rises { (x + least).min(end) } else { (x - least).max(end) };
        x = nearest + (end - nearest) * generator.random::<f64>();
        rises = !rises;
        x
    };
    (0..RANDOM_TURNS).map(turn).collect()
}

/// True if the first leg is a swing that can be seen.
fn starts_with_a_swing(from: f64, candidate: &Candidate, width: f64) -> bool {
    match candidate.legs.first() {
        Some(&Leg::Swing { to, .. }) => (to - from).abs() >= 0.5 * SMALLEST_SWING * width,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn candidates_stay_within_the_range_and_turn_at_every_point() {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(1);
        for from in [-1.0, -0.97, 0.2, 3.0] {
            for candidate in candidates(from, (-1.0, 3.0), 0.45, &mut generator) {
                let mut path = vec![from];
                path.extend(candidate.legs.iter().map(|leg| match leg {
                    Leg::Swing { to, .. } => *to,
                    Leg::Hold(_) => panic!("no holds"),
                }));
                assert!(path.iter().all(|x| (-1.0..=3.0).contains(x)), "{path:?}");
                let swings: Vec<f64> = path.windows(2).map(|pair| pair[1] - pair[0]).collect();
                assert!(swings[1..].windows(2).all(|pair| pair[0] * pair[1] < 0.0), "{candidate:?}");
            }
        }
    }
}
