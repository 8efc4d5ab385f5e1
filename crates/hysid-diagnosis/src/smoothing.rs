//! A branch's course without its noise: local parabolas over neighbouring rows.
//!
//! How many rows may be taken together without bending the course is found from the data: as many as
//! leave no more behind than the noise.

use std::ops::Range;

use hysid_core::elementary::square;

use super::noise::Noise;
use super::significance;

/// Rows taken together, the candidates; 1 leaves the data as they are.
const WINDOWS: [usize; 7] = [1, 7, 11, 17, 25, 39, 65];

/// Share of the remainder beyond the noise that is accepted, over all rows.
const ACCEPTED: f64 = 1.15;

/// The same for a tenth of a branch: nine in ten tenths are below.
const ACCEPTED_IN_A_PART: f64 = 1.8;

/// Longest window, as a share of the branch.
const LONGEST: f64 = 0.2;

/// Shortest window that a parabola smooths.
const SHORTEST: usize = 5;

/// Deviations of the shorter one within which values of two windows agree.
const AGREE: f64 = 2.0;

/// Branches that the window is chosen from.
const JUDGED: usize = 60;

/// A row on the parabola through its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SmoothedRow {
    pub y: f64,
    /// Deviation of `y` for white noise of deviation 1.
    pub deviation: f64,
    /// How far a window half as long is off, beyond its noise.
    pub bend: f64,
    pub rows: Range<usize>,
}

/// A row of a branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BranchRow {
    /// Where it stands on the way: its time, or its input.
    pub station: f64,
    pub x: f64,
    pub y: f64,
}

/// The rows of a branch, in the order of their stations, and their noise.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    pub places: Vec<BranchRow>,
    pub input_noise: Noise,
    pub output_noise: Noise,
}

/// Each row on the parabola of least squares over the stations of the `window` nearest rows; a window at an
/// end of the branch lies on one side of its row, and none is longer than a share of the branch.
pub(crate) fn smooth(places: &[BranchRow], window: usize) -> Vec<SmoothedRow> {
    // An odd number of rows.
    let window = window.min((places.len() as f64 * LONGEST) as usize / 2 * 2 + 1);
    if window < SHORTEST {
        let alone = |(row, place): (usize, &BranchRow)| SmoothedRow {
            y: place.y,
            deviation: 1.0,
            bend: 0.0,
            rows: row..row + 1,
        };
        return places.iter().enumerate().map(alone).collect();
    }
    (0..places.len())
        .map(|row| {
            let first = row.saturating_sub(window / 2).min(places.len() - window);
            let rows = first..first + window;
            let (y, deviation) = parabola_at(&places[rows.clone()], &places[row]);
            SmoothedRow { y, deviation, bend: 0.0, rows }
        })
        .collect()
}

/// As [`smooth`], with shorter windows where a longer one bends the course: at each row the longest that agrees
/// with those half and a quarter as long, as far as noise goes.
pub(crate) fn smooth_where_straight(points: &Points, window: usize) -> Vec<SmoothedRow> {
    let lengths = [window / 4, window / 2, window].map(|length| length / 2 * 2 + 1);
    let [mut chosen, half, whole] = lengths.map(|length| smooth(&points.places, length));
    // What is taken for white noise is smoothed out, no more: coloured noise stays, and is allowed for.
    let noise = points.output_noise.roughness();
    let agree = |a: &SmoothedRow, b: &SmoothedRow| (a.y - b.y).abs() <= AGREE * noise * a.deviation;
    for (row, chosen) in chosen.iter_mut().enumerate() {
        for longer in [&half[row], &whole[row]] {
            if !agree(chosen, longer) {
                break;
            }
            let apart = (longer.y - chosen.y).abs() - 0.5 * noise * chosen.deviation;
            *chosen = SmoothedRow { bend: apart.max(0.0), ..longer.clone() };
        }
    }
    chosen
}

/// Value of the parabola of least squares at a row, and its deviation for white noise of deviation 1.
fn parabola_at(places: &[BranchRow], at: &BranchRow) -> (f64, f64) {
    let parabola = Parabola::over(places, at.station);
    let above: f64 = places.iter().map(|place| parabola.weight(place) * (place.y - at.y)).sum();
    (at.y + above, parabola.deviation)
}

/// How the rows around a station add up to the value there of the parabola of least squares through them.
pub(crate) struct Parabola {
    station: f64,
    /// Stations within this distance are the same.
    same: f64,
    scale: f64,
    /// The weight of a row at the scaled distance `u` is `c_0 + c_1 u + c_2 u²`; `None` where two stations or one do not
    /// determine a parabola: then the rows at the station itself have equal weights.
    coefficients: Option<[f64; 3]>,
    equal: f64,
    deviation: f64,
}

impl Parabola {
    pub fn over(places: &[BranchRow], station: f64) -> Self {
        let n = places.len() as f64;
        let same = 1e-12 * station.abs();
        let extent = places[places.len() - 1].station - places[0].station;
        let scale = extent.recip();
        let (mut s1, mut s2, mut s3, mut s4) = (0.0, 0.0, 0.0, 0.0);
        for place in places {
            let u = (place.station - station) * scale;
            let square = u * u;
            s1 += u;
            s2 += square;
            s3 += square * u;
            s4 += square * square;
        }
        // First row of the inverse of the normal matrix, by cofactors.
        let cofactors = [s2 * s4 - s3 * s3, s2 * s3 - s1 * s4, s1 * s3 - s2 * s2];
        let determinant = n * cofactors[0] + s1 * cofactors[1] + s2 * cofactors[2];
        if extent > same && determinant > 1e-9 * n * s2 * s4 {
            let coefficients = cofactors.map(|c| c / determinant);
            let deviation = coefficients[0].max(0.0).sqrt();
            return Self { station, same, scale, coefficients: Some(coefficients), equal: 0.0, deviation };
        }
        let here =
            places.iter().filter(|place| (place.station - station).abs() <= same).count().max(1) as f64;
        Self { station, same, scale, coefficients: None, equal: here.recip(), deviation: here.sqrt().recip() }
    }

    /// The share of a row in the value.
    pub fn weight(&self, place: &BranchRow) -> f64 {
        let distance = place.station - self.station;
        match self.coefficients {
            Some([c0, c1, c2]) => {
                let u = distance * self.scale;
                c0 + u * (c1 + u * c2)
            }
            None if distance.abs() <= self.same => self.equal,
            None => 0.0,
        }
    }
}

/// The longest window that leaves no more than the noise behind.
pub(crate) fn choose_window(branches: &[Points]) -> usize {
    let judged: Vec<&Points> = branches
        .iter()
        .filter(|branch| branch.places.len() >= 7 && branch.output_noise.roughness() > 0.0)
        .collect();
    if judged.is_empty() {
        return 1;
    }
    let judged: Vec<&Points> = judged.iter().step_by(judged.len().div_ceil(JUDGED)).copied().collect();
    let leaves_only_noise = |window: &&usize| {
        let (mut remainder, mut expected) = (0.0, 0.0);
        let mut parts = Vec::new();
        for Points { places, output_noise, .. } in &judged {
            let variance = square(output_noise.roughness());
            let smoothed = smooth(places, **window);
            let tenth = places.len().div_ceil(10);
            for (rows, values) in places.chunks(tenth).zip(smoothed.chunks(tenth)) {
                let pairs = || rows.iter().zip(values);
                let left: f64 = pairs().map(|(place, value)| square(place.y - value.y)).sum();
                let free: f64 = pairs().map(|(_, value)| 1.0 - square(value.deviation)).sum();
                remainder += left;
                expected += free * variance;
                if free > 2.0 {
                    parts.push(left / (free * variance));
                }
            }
        }
        let ninth = parts.len() * 9 / 10;
        let part = match parts.get(ninth) {
            Some(_) => *parts.select_nth_unstable_by(ninth, f64::total_cmp).1,
            None => 0.0,
        };
        // A tenth with few rows has much or little by chance.
        let rows = judged.iter().map(|points| points.places.len() / 10).min().unwrap_or(1).max(1) as f64;
        let by_chance = 1.0 + significance::upper_quantile(0.1) * (2.0 / rows).sqrt();
        remainder <= ACCEPTED * expected && part <= ACCEPTED_IN_A_PART.max(1.3 * by_chance)
    };
    WINDOWS[1..].iter().rev().find(leaves_only_noise).copied().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(station: f64, y: f64) -> BranchRow {
        BranchRow { station, x: station, y }
    }

    #[test]
    fn a_parabola_stays_as_it_is() {
        let places: Vec<BranchRow> =
            (0..50).map(|k| 0.1 * k as f64).map(|x| place(x, 3.0 - x + 0.5 * x * x)).collect();
        for (place, value) in places.iter().zip(smooth(&places, 9)) {
            assert!((place.y - value.y).abs() < 1e-11, "{place:?} {value:?}");
        }
    }

    #[test]
    fn deviations_are_those_of_least_squares() {
        // Even spacing, 5 rows: (3/35)(…) weights of Savitzky and Golay, whose middle one is 17/35.
        let places: Vec<BranchRow> = (0..30).map(|k| place(k as f64, 0.0)).collect();
        let smoothed = smooth(&places, 5);
        assert!((square(smoothed[10].deviation) - 17.0 / 35.0).abs() < 1e-12);
        assert!((square(smoothed[0].deviation) - 31.0 / 35.0).abs() < 1e-12);
    }

    #[test]
    fn equal_places_are_averaged() {
        let places: Vec<BranchRow> = (0..30).map(|k| place(1.0, f64::from(k % 5))).collect();
        assert_eq!(smooth(&places, 5)[12].y, 2.0);
    }
}
