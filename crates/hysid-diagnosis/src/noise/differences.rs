//! Noise from differences of a channel at several orders and distances, theory.md (10.1). The course of the values adds
//! to each of them with a high power of the distance, white noise not at all, coloured noise slowly, hum with its
//! period: the shares of all follow from how the differences grow.

use std::borrow::Cow;
use std::f64::consts::TAU;

use hysid_core::elementary::powi;

use super::{Correlation, Noise};
use crate::significance::{MEDIAN_OF_NORMAL, median};

/// Maximum number of differences; more do not improve the estimate.
const MOST: usize = 100_000;

/// Orders of the differences: the course of the values is less in the higher ones, and corners of it are in fewer of the
/// lower ones.
const ORDERS: [usize; 4] = [2, 3, 4, 6];

/// Distances of the rows of a difference.
const DISTANCES: [usize; 10] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32];

/// A difference spans at most this share of a run.
const SPAN: f64 = 0.3;

/// Correlations from row to row that are tried, where they decay within a share of a run.
const DECAYS: [f64; 6] = [0.6, 0.8, 0.9, 0.95, 0.98, 0.99];
const DECAYED: f64 = 0.25;

/// Periods of hum: from the shortest on by this factor, up to a share of a run.
const SHORTEST_PERIOD: f64 = 4.0;
const NEXT_PERIOD: f64 = 1.15;
const LONGEST_PERIOD: f64 = 0.2;

/// Rounds in which the shares of the parts are found.
const ROUNDS: usize = 2000;

/// Relative excess of the variance at larger distances that chance may cause, times `√n` for `n` rows. Times `√n`, the
/// relative deviation of a variance from a median is about 4, that of a ratio of two 5 to 6, and the minimum over four
/// orders is more uncertain.
const SAMPLING: f64 = 14.0;

/// Power of the distance with which differences grow on a line with many kinks.
const KINKS: i32 = 3;

/// Lowest order at which the course of the values adds little to near rows.
const TELLING: usize = 4;

/// Distances at which the differences of correlated noise are larger than at distance 1.
const NEAR: [usize; 2] = [2, 3];

/// Parts below this share of the variance are left out.
const SMALLEST: f64 = 1e-3;

/// Successive values of a channel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChannelRun<'a> {
    pub values: &'a [f64],
    /// Those of the channel that they follow, row by row: where they move together, and not evenly, neither of them is
    /// noise. Empty if it is not known.
    pub beside: &'a [f64],
}

/// The variance of a normalised difference.
struct DifferenceVariance {
    order: usize,
    distance: usize,
    variance: f64,
}

/// Which differences count.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rows {
    All,
    /// The half whose ends differ least, at near distances: the course of the values is in few of these, where it changes
    /// over a part of a run.
    Calm,
}

/// Fewest values that show anything about their noise.
const FEWEST: usize = 8;

/// Deviation of white noise by which neighbouring rows differ as much; 0 for hardly any values.
pub(crate) fn roughness<'a>(columns: impl Iterator<Item = &'a [f64]>) -> f64 {
    let columns: Vec<DistinctRows> =
        columns.map(|values| DistinctRows::new(ChannelRun { values, beside: &[] })).collect();
    let rows: usize = columns.iter().map(|column| column.values.len()).sum();
    let runs = columns.iter().map(DistinctRows::run);
    if rows < FEWEST { 0.0 } else { least(&differences(runs, rows, 0, Rows::All), 1).sqrt() }
}

/// The rows of a run without those that repeat the one before: a logger that is faster than its sensor makes them, and they
/// contain no information about noise.
struct DistinctRows<'a> {
    values: Cow<'a, [f64]>,
    beside: Cow<'a, [f64]>,
}

impl<'a> DistinctRows<'a> {
    fn new(ChannelRun { values, beside }: ChannelRun<'a>) -> Self {
        let is_new = |row: &usize| {
            let before = row.wrapping_sub(1);
            *row == 0 || values[*row] != values[before] || beside.get(*row) != beside.get(before)
        };
        let kept = || (0..values.len()).filter(is_new);
        let count = kept().count();
        // An input in steps rests most of the time.
        if count == values.len() || 2 * count <= values.len() {
            return Self { values: values.into(), beside: beside.into() };
        }
        let of = |channel: &[f64]| kept().filter_map(|row| channel.get(row).copied()).collect();
        Self { values: of(values), beside: of(beside) }
    }

    fn run(&self) -> ChannelRun<'_> {
        ChannelRun { values: &self.values, beside: &self.beside }
    }
}

/// The least variance of all orders at a distance: the course of the values adds to each. 0 where none was measured.
fn least(differences: &[DifferenceVariance], distance: usize) -> f64 {
    let alike = differences.iter().filter(|difference| difference.distance == distance);
    let least = alike.map(|difference| difference.variance).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// The noise of a channel; none for hardly any values.
pub(super) fn noise<'a>(runs: impl Iterator<Item = ChannelRun<'a>>) -> Noise {
    let runs: Vec<DistinctRows> = runs.map(DistinctRows::new).collect();
    let runs = runs.iter().map(DistinctRows::run);
    let rows: usize = runs.clone().map(|run| run.values.len()).sum();
    if rows < FEWEST {
        return Noise::default();
    }
    let length = typical_length(runs.clone(), rows);
    let differences_of = |which| differences(runs.clone(), rows, length, which);
    let differences = differences_of(Rows::All);
    let roughness = least(&differences, 1).sqrt();
    if roughness == 0.0 {
        return Noise::default();
    }
    // The least of each distance does not grow where noise is white; a course of the values adds to all of them.
    let sampling = SAMPLING / (rows as f64).sqrt();
    let is_told = |distance: usize| differences.iter().any(|d| d.distance == distance && d.order >= TELLING);
    let grow = |differences: &[DifferenceVariance], told: &[usize]| {
        told.iter().all(|&distance| least(differences, distance) > (1.0 + sampling) * least(differences, 1))
    };
    let told: Vec<usize> = NEAR.into_iter().filter(|distance| is_told(*distance)).collect();
    if told.is_empty() {
        // At one distance alone, a course of the values cannot be told from noise.
        return Noise::white(roughness);
    }
    let is_white = !grow(&differences, &told) || !grow(&differences_of(Rows::Calm), &told);
    let correlations = if is_white { vec![Correlation::White] } else { correlations(length) };
    let shares = shares(&differences, &correlations);
    let total: f64 = shares.iter().sum();
    let mut parts: Vec<_> =
        correlations.into_iter().zip(shares).filter(|part| part.1 > SMALLEST * total).collect();
    if !is_white {
        parts.push((Correlation::Walking, largest_walk(&differences)));
    }
    Noise { parts, roughness }
}

/// The largest variance of the steps of a walk that no difference contradicts. Branches do not show how slow the slowest noise is, so the largest possible walk is
/// assumed.
fn largest_walk(differences: &[DifferenceVariance]) -> f64 {
    let bounds = differences.iter().map(|d| d.variance / in_difference(Correlation::Walking, d));
    bounds.fold(f64::INFINITY, f64::min)
}

/// Half of all rows are in runs at least so long.
fn typical_length<'a>(runs: impl Iterator<Item = ChannelRun<'a>>, rows: usize) -> usize {
    let mut lengths: Vec<usize> = runs.map(|run| run.values.len()).collect();
    lengths.sort_unstable_by(|a, b| b.cmp(a));
    let mut before = 0;
    let passes_half = |length: &&usize| {
        before += **length;
        2 * before >= rows
    };
    lengths.iter().find(passes_half).copied().unwrap_or(0)
}

/// Correlations that runs of a length can show.
fn correlations(length: usize) -> Vec<Correlation> {
    let length = length as f64;
    let longest_decay = (DECAYED * length).max(3.0);
    let decays = DECAYS.iter().copied().filter(|factor| (1.0 - factor).recip() <= longest_decay);
    let periods = std::iter::successors(Some(SHORTEST_PERIOD), |period| Some(period * NEXT_PERIOD))
        .take_while(|period| *period <= LONGEST_PERIOD * length);
    let mut correlations = vec![Correlation::White];
    correlations.extend(decays.map(Correlation::Decaying));
    correlations.extend(periods.map(|period| Correlation::Periodic(TAU / period)));
    correlations
}

/// Coefficients of a difference, of unit length.
fn coefficients(order: usize) -> Vec<f64> {
    let mut binomial = vec![1.0];
    for _ in 0..order {
        let shifted = std::iter::once(0.0).chain(binomial.iter().copied());
        let padded = binomial.iter().copied().chain(std::iter::once(0.0));
        binomial = padded.zip(shifted).map(|(a, b)| a - b).collect();
    }
    let norm = binomial.iter().map(|c| c * c).sum::<f64>().sqrt();
    binomial.iter().map(|c| c / norm).collect()
}

/// The differences of each order and distance: of the values, or of what they are away from following the channel beside
/// them along a straight line, whichever is less.
fn differences<'a>(
    runs: impl Iterator<Item = ChannelRun<'a>> + Clone,
    rows: usize,
    length: usize,
    which: Rows,
) -> Vec<DifferenceVariance> {
    let stride = rows.div_ceil(MOST);
    let longest = SPAN * length as f64;
    let counts = |distance: usize| which == Rows::All || distance <= NEAR[1];
    let pairs = ORDERS.iter().flat_map(|&order| DISTANCES.map(|distance| (order, distance)));
    let measured = pairs.filter(|&(order, distance)| {
        counts(distance) && (distance == 1 || (order * distance) as f64 <= longest)
    });
    let variance = |(order, distance): (usize, usize)| {
        let coefficients = coefficients(order);
        let span = order * distance;
        let of = |values: &[f64], row: usize| -> f64 {
            coefficients.iter().enumerate().map(|(k, c)| c * values[row + k * distance]).sum()
        };
        // Size of each difference, and how far its ends differ.
        let (mut sizes, mut sizes_apart) = (Vec::with_capacity(rows / stride), Vec::new());
        for ChannelRun { values, beside } in runs.clone() {
            for row in (0..values.len().saturating_sub(span)).step_by(stride) {
                let own = of(values, row);
                let change = values[row + span] - values[row];
                sizes.push((own.abs(), change.abs()));
                if !beside.is_empty() {
                    let slope = change / (beside[row + span] - beside[row]);
                    let apart = (own - slope * of(beside, row)).abs();
                    sizes_apart.push((if apart.is_nan() { f64::INFINITY } else { apart }, change.abs()));
                }
            }
        }
        let deviation = typical(&mut sizes, which).min(typical(&mut sizes_apart, which)) / MEDIAN_OF_NORMAL;
        deviation.is_finite().then_some(DifferenceVariance {
            order,
            distance,
            variance: deviation * deviation,
        })
    };
    measured.filter_map(variance).collect()
}

/// The median size of differences, of which the change between their ends is known too; infinite for none.
fn typical(sizes: &mut [(f64, f64)], which: Rows) -> f64 {
    let count = if which == Rows::Calm { sizes.len() / 2 } else { sizes.len() };
    if count == 0 {
        return f64::INFINITY;
    }
    if which == Rows::Calm {
        sizes.select_nth_unstable_by(count, |a, b| a.1.total_cmp(&b.1));
    }
    median(&mut sizes[..count].iter().map(|size| size.0).collect::<Vec<f64>>())
}

/// Variances of noise of each correlation that add up to the differences, together with a course of the values that
/// adds to those of order `p` and distance `d` by multiples of `d^{2p}` and, for its kinks, of `d^3`: least squares of the relative errors with
/// shares that are not negative, by multiplicative updates (Lee and Seung 1999).
fn shares(differences: &[DifferenceVariance], correlations: &[Correlation]) -> Vec<f64> {
    let relative = |of: &dyn Fn(&DifferenceVariance) -> f64| -> Vec<f64> {
        differences.iter().map(|d| of(d) / floor(d, differences)).collect()
    };
    let of_noise = correlations.iter().map(|&correlation| relative(&|d| in_difference(correlation, d)));
    let courses = ORDERS.iter().flat_map(|&order| [(order, KINKS), (order, 2 * order as i32)]);
    let of_course = courses.map(|(order, power)| {
        relative(&|d| if d.order == order { course(d, power, differences) } else { 0.0 })
    });
    let columns: Vec<Vec<f64>> = of_noise.chain(of_course).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scales: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt()).collect();
    let used: Vec<usize> = (0..columns.len()).filter(|&k| scales[k] > 0.0).collect();
    let entry = |i: usize, j: usize| product(&columns[i], &columns[j]) / (scales[i] * scales[j]);
    let gram: Vec<Vec<f64>> = used.iter().map(|&i| used.iter().map(|&j| entry(i, j)).collect()).collect();
    let right: Vec<f64> =
        used.iter().map(|&k| (columns[k].iter().sum::<f64>() / scales[k]).max(0.0)).collect();
    let mut weights = vec![(used.len() as f64).recip(); used.len()];
    for _ in 0..ROUNDS {
        let products: Vec<f64> = gram.iter().map(|row| product(row, &weights)).collect();
        for ((weight, right), product) in weights.iter_mut().zip(&right).zip(&products) {
            *weight *= right / product.max(f64::MIN_POSITIVE);
        }
    }
    let mut shares = vec![0.0; columns.len()];
    used.iter().zip(&weights).for_each(|(&k, weight)| shares[k] = weight / scales[k]);
    shares.truncate(correlations.len());
    shares
}

/// Scale of a difference: its own size, but not less than rounding.
fn floor(difference: &DifferenceVariance, all: &[DifferenceVariance]) -> f64 {
    const ROUNDING: f64 = 1e-24;
    let largest = all.iter().map(|d| d.variance).fold(0.0, f64::max);
    difference.variance.max(ROUNDING * largest).max(f64::MIN_POSITIVE)
}

/// Variance of a difference of noise of variance 1.
fn in_difference(correlation: Correlation, difference: &DifferenceVariance) -> f64 {
    let coefficients = coefficients(difference.order);
    let pairs = coefficients
        .iter()
        .enumerate()
        .flat_map(|(i, a)| coefficients.iter().enumerate().map(move |(j, b)| (i.abs_diff(j), a * b)));
    let sum: f64 =
        pairs.map(|(apart, product)| product * correlation.at((apart * difference.distance) as f64)).sum();
    sum.max(0.0)
}

/// A course of the values that is as large as the largest difference of its order, and grows with a power of the
/// distance.
fn course(difference: &DifferenceVariance, power: i32, all: &[DifferenceVariance]) -> f64 {
    let alike = || all.iter().filter(|d| d.order == difference.order);
    let furthest = alike().map(|d| d.distance).max().unwrap_or(1) as f64;
    let largest = alike().map(|d| d.variance).fold(0.0, f64::max);
    powi(difference.distance as f64 / furthest, power) * largest
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, ln, powf, sin, tanh};

    use super::*;
    use rand::{Rng, RngExt, SeedableRng};

    /// A standard normal number, by Box and Muller.
    fn normal(generator: &mut impl Rng) -> f64 {
        let (u, v): (f64, f64) = (generator.random(), generator.random());
        (-2.0 * ln(1.0 - u)).sqrt() * cos(TAU * v)
    }

    const BRANCHES: usize = 12;
    const ROWS: usize = 200;

    /// Branches of a play under a triangle, with what is added to each row.
    fn branches(mut added: impl FnMut(usize) -> f64) -> Vec<Vec<f64>> {
        let branch = |number: usize| {
            let sign = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
            let course = |k: usize| sign * powf((k as f64 / ROWS as f64 - 0.2).max(0.0), 1.3);
            (0..ROWS).map(|k| course(k) + added(number * ROWS + k)).collect()
        };
        (0..BRANCHES).map(branch).collect()
    }

    fn noise_of(branches: &[Vec<f64>]) -> Noise {
        Noise::of(branches.iter().map(|values| ChannelRun { values, beside: &[] }))
    }

    #[test]
    fn white_noise_is_found_within_its_sampling_error() {
        let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        let noise = noise_of(&branches(|_| 0.01 * normal(&mut generator)));
        assert!((noise.deviation() / 0.01 - 1.0).abs() < 0.1, "{noise:?}");
        // A mean of many rows shows whether it was taken for white.
        assert!(noise.of_mean(25) < 1.6 * 0.01 / 5.0, "{noise:?}");
    }

    #[test]
    fn white_noise_of_short_branches_is_found_too() {
        let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        for rows in [7, 10, 15, 25, 40] {
            let branch = |_| (0..rows).map(|row| row as f64 + 0.01 * normal(&mut generator)).collect();
            let branches: Vec<Vec<f64>> = (0..2000 / rows).map(branch).collect();
            let ratio = noise_of(&branches).deviation() / 0.01;
            assert!((0.75..1.25).contains(&ratio), "{rows} rows: {ratio}");
        }
    }

    /// Loops of a `tanh` on a slow sine: a steep flank takes up a small or large part of each branch.
    #[test]
    fn white_noise_beside_steep_flanks_is_not_taken_for_a_walk() {
        let weights = |rows: usize| -> Vec<f64> {
            (0..rows).map(|k| sin(TAU * k as f64 / rows as f64) * TAU / rows as f64).collect()
        };
        for (seed, (width, rows)) in [0.03, 0.08, 0.2, 1.0]
            .into_iter()
            .flat_map(|width| [40, 60, 150].map(|rows| (width, rows)))
            .enumerate()
        {
            let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed as u64);
            for deviation in [0.002, 0.01] {
                let mut branch = |number: usize| -> (Vec<f64>, Vec<f64>) {
                    let sign = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
                    let input = |k: usize| -sign * cos(TAU * 0.5 * k as f64 / rows as f64);
                    let output = |x: f64| 0.5 * tanh((x - 0.2 * sign) / width);
                    let x: Vec<f64> = (0..rows).map(input).collect();
                    let y = x.iter().map(|&x| output(x) + deviation * normal(&mut generator)).collect();
                    (x, y)
                };
                let branches: Vec<(Vec<f64>, Vec<f64>)> = (0..BRANCHES).map(&mut branch).collect();
                let run = |(beside, values)| ChannelRun { values, beside };
                let noise = Noise::of(branches.iter().map(|(x, y)| run((x.as_slice(), y.as_slice()))));
                let energy = deviation * Correlation::White.of_sum(&weights(2 * rows)).sqrt();
                let ratio = noise.of_sum(&weights(2 * rows)) / energy;
                assert!((0.7..1.6).contains(&ratio), "width {width}, {rows} rows, {deviation}: {ratio}");
            }
        }
    }

    #[test]
    fn coloured_noise_is_found_within_a_third_and_its_mean_falls_slowly() {
        for seed in 1..6 {
            let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut value = 0.0;
            let noise = noise_of(&branches(|_| {
                value = 0.9 * value + 0.01 * (1.0_f64 - 0.81).sqrt() * normal(&mut generator);
                value
            }));
            let ratio = noise.deviation() / 0.01;
            assert!((0.67..1.5).contains(&ratio), "{ratio}");
            // The mean of 25 rows of this noise has 0.62 of its deviation.
            assert!((0.4..1.0).contains(&(noise.of_mean(25) / 0.01)), "{noise:?}");
        }
    }

    #[test]
    fn hum_is_found_within_a_factor_of_1_6() {
        for period in [9.3, 13.7, 25.0] {
            let noise = noise_of(&branches(|row| 0.01 * sin(TAU * row as f64 / period)));
            let ratio = noise.deviation() / (0.01 / 2.0_f64.sqrt());
            // A sine has another median magnitude than a normal number: 1.48 times too much.
            assert!((0.67..1.6).contains(&ratio), "period {period}: {ratio}");
            let (found, amplitude) = noise.hum().expect("hum");
            assert!((found / period - 1.0).abs() < 0.15, "{found} for {period}");
            assert!((amplitude / 0.01 - 1.0).abs() < 0.3, "{amplitude} for a period of {period}");
        }
    }

    #[test]
    fn smooth_branches_have_hardly_any() {
        assert!(noise_of(&branches(|_| 0.0)).deviation() < 1e-4);
        let two = ChannelRun { values: &[1.0, 2.0], beside: &[] };
        assert_eq!(Noise::of(std::iter::once(two)), Noise::default());
    }

    #[test]
    fn uneven_steps_of_the_input_are_no_noise_of_the_output() {
        let mut generator = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(2);
        let inputs: Vec<Vec<f64>> = (0..BRANCHES)
            .map(|_| {
                let step = |x: &mut f64, _| {
                    *x += generator.random::<f64>() / ROWS as f64;
                    Some(*x)
                };
                (0..ROWS).scan(0.0, step).collect()
            })
            .collect();
        let outputs: Vec<Vec<f64>> =
            inputs.iter().map(|x| x.iter().map(|x| 3.0 * x - 0.5 * x * x).collect()).collect();
        let alone = noise_of(&outputs).deviation();
        let beside = |own: &[Vec<f64>], other: &[Vec<f64>]| {
            Noise::of(own.iter().zip(other).map(|(values, beside)| ChannelRun { values, beside })).deviation()
        };
        assert!(beside(&outputs, &inputs) < 0.05 * alone, "{} of {alone}", beside(&outputs, &inputs));
        let alone = noise_of(&inputs).deviation();
        assert!(beside(&inputs, &outputs) < 0.05 * alone, "{} of {alone}", beside(&inputs, &outputs));
    }
}
