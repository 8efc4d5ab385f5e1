//! Figures of the rising and the falling way of a loop: non-linearity of a sensor, transition temperatures of a shape-memory
//! alloy, hysteresis index of a storm.

use super::CLOSED;
use super::path::range;
use super::row::CycleRow;
use super::strand::Strand;

/// Equal steps of the input at which both ways are read.
const STEPS: u32 = 400;

/// Halvings of the search of the best straight line.
const SEARCH: usize = 100;

/// Percent that are rounding.
const ROUNDING: f64 = 1e-9;

/// Share of the input at each end over which the base lines of a transition are fitted.
const BASE: f64 = 0.1;

/// Share of the input over which the steepest tangent is fitted.
const TANGENT: f64 = 0.02;

/// A transition is steeper than its base lines by this factor.
const STEEP: f64 = 3.0;

/// Least share of the swing by which the extreme of a branch of a butterfly lies behind the input 0.
const LAG: f64 = 0.01;

/// Least share of the height of a butterfly by which both ends of a branch are away from its extreme.
const DEEP: f64 = 0.2;

/// Largest share of the swing over which an extreme is flat within the noise.
const FLAT: f64 = 0.05;

/// Shares of the input from which the index of a storm is read: each twentieth between them.
const SECTIONS: std::ops::RangeInclusive<u32> = 1..=19;

/// Largest deviation of the mean of both ways from the straight line for which it is smallest, in percent of the range of the
/// output (IEC 61298-2, independent non-linearity).
pub(super) fn nonlinearity_percent(falling: &Strand, rising: &Strand, ends: (f64, f64)) -> Option<f64> {
    let (down, up) = (sampled(falling, ends)?, sampled(rising, ends)?);
    let height = {
        let all: Vec<f64> = down.iter().chain(&up).map(|point| point.1).collect();
        let (low, high) = range(&all);
        high - low
    };
    let mean: Vec<(f64, f64)> = up.iter().zip(&down).map(|(a, b)| (a.0, 0.5 * (a.1 + b.1))).collect();
    // Half the range of the distances from lines of one slope is convex in the slope.
    let off = |slope: f64| {
        let (low, high) = range(&mean.iter().map(|(x, y)| y - slope * x).collect::<Vec<f64>>());
        0.5 * (high - low)
    };
    let steepest = mean.windows(2).map(|pair| slope(pair[0], pair[1]).abs()).fold(0.0, f64::max);
    let (mut low, mut high) = (-steepest, steepest);
    for _ in 0..SEARCH {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if off(a) <= off(b) { high = b } else { low = a }
    }
    let percent = 100.0 * off(0.5 * (low + high)) / height;
    percent.is_finite().then_some(if percent < ROUNDING { 0.0 } else { percent })
}

/// Reads the figures of a butterfly, whose branches have their lowest outputs (or their highest) inside, behind the input 0.
pub(super) fn read_butterfly(row: &mut CycleRow, falling: &Strand, rising: &Strand, (low, high): (f64, f64)) {
    let (least, swing) = (LAG * (high - low), high - low);
    let wings = [1.0, -1.0].into_iter().find_map(|sign| {
        let (down, up) = (falling.deepest(sign)?, rising.deepest(sign)?);
        let height = down.height.max(up.height);
        let is_deep = [&down, &up].iter().all(|wing| wing.depth >= DEEP * height);
        (is_deep && down.x < -least && up.x > least).then_some((sign, down, up, height))
    });
    let Some((sign, down, up, height)) = wings else { return };
    let remanence = |strand: &Strand, own: f64| strand.output_at(0.0, 0.0).map(|output| sign * output - own);
    let remanences = remanence(falling, down.lowest).zip(remanence(rising, up.lowest));
    row.nonlinearity_percent = None;
    row.peak_to_peak = Some(height);
    row.butterfly_remanence = remanences.map(|(down, up)| 0.5 * (down + up));
    if down.flat.max(up.flat) <= FLAT * swing {
        row.butterfly_coercive_input = Some(0.5 * (up.x - down.x));
    } else {
        row.notes.push("no coercive field: the extremes of the branches are flat within the noise".into());
    }
}

/// Reads the temperatures at which the transitions on both ways start and finish, and the width between their middles.
pub(super) fn read_transitions(row: &mut CycleRow, falling: &Strand, rising: &Strand, ends: (f64, f64)) {
    let (heating, cooling) = (transition(rising, ends), transition(falling, ends));
    row.heating_start = heating.map(|ends| ends.0);
    row.heating_finish = heating.map(|ends| ends.1);
    row.cooling_start = cooling.map(|ends| ends.1);
    row.cooling_finish = cooling.map(|ends| ends.0);
    row.thermal_width = heating.zip(cooling).map(|(up, down)| 0.5 * (up.0 + up.1 - down.0 - down.1));
    if row.thermal_width.is_none() {
        row.notes.push(
            "no transition temperatures: a branch has no part that is three times as steep as its ends"
                .into(),
        );
    }
}

/// Where the tangent at the steepest point meets the lines through both ends, the lower input first.
fn transition(strand: &Strand, (low, high): (f64, f64)) -> Option<(f64, f64)> {
    let points = sampled(strand, (low, high))?;
    let count = |share: f64| (share * f64::from(STEPS)).round() as usize;
    let (first, last) = (line(&points[..=count(BASE)])?, line(&points[points.len() - 1 - count(BASE)..])?);
    let tangents = points.windows(count(TANGENT) + 1).filter_map(line);
    let steepest = tangents.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    let meets = |base: (f64, f64)| (base.1 - steepest.1) / (steepest.0 - base.0);
    let is_steep = steepest.0.abs() > STEEP * first.0.abs().max(last.0.abs());
    let (start, finish) = (meets(first), meets(last));
    (is_steep && low <= start && start < finish && finish <= high).then_some((start, finish))
}

/// Mean difference of the rising and the falling way at equal inputs, both in shares of their range: 1 to -1, positive if
/// the loop is passed clockwise (Lloyd et al., Hydrol. Earth Syst. Sci. 20, 2016, 625-632).
pub(super) fn hysteresis_index(falling: &Strand, rising: &Strand, ends: (f64, f64)) -> Option<f64> {
    let (down, up) = (sampled(falling, ends)?, sampled(rising, ends)?);
    let (low, high) = range(&down.iter().chain(&up).map(|point| point.1).collect::<Vec<f64>>());
    let place = |section: u32| (section * STEPS / 20) as usize;
    let differences = SECTIONS.map(|section| up[place(section)].1 - down[place(section)].1);
    let index = differences.sum::<f64>() / SECTIONS.count() as f64 / (high - low);
    index.is_finite().then_some(index)
}

/// The way at equal steps of the input from its lower to its upper end.
fn sampled(strand: &Strand, (low, high): (f64, f64)) -> Option<Vec<(f64, f64)>> {
    let input = |step: u32| low + (high - low) * f64::from(step) / f64::from(STEPS);
    let reach = CLOSED * (high - low);
    (0..=STEPS).map(|step| Some((input(step), strand.output_at(input(step), reach)?))).collect()
}

fn slope(a: (f64, f64), b: (f64, f64)) -> f64 {
    (b.1 - a.1) / (b.0 - a.0)
}

/// Slope and value at 0 of the line of least squares.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let (covariance, variance) = points.iter().fold((0.0, 0.0), |(covariance, variance), point| {
        (covariance + (point.0 - x) * (point.1 - y), variance + (point.0 - x) * (point.0 - x))
    });
    (variance > 0.0).then(|| (covariance / variance, y - covariance / variance * x))
}

/// Mean distance along the output of the way there and the way back, and the energy that comes back of that which was put in,
/// in percent.
pub(super) fn read_battery(row: &mut CycleRow, x: &[f64], y: &[f64]) {
    let work = |sense: f64| -> f64 {
        let steps = x.windows(2).zip(y.windows(2));
        steps.map(|(x, y)| (sense * (x[1] - x[0])).max(0.0) * 0.5 * (y[0] + y[1])).sum()
    };
    let (up, down) = (work(1.0), work(-1.0));
    let (low, high) = range(x);
    row.mean_gap = Some((up - down).abs() / (high - low)).filter(|gap| gap.is_finite());
    row.energy_efficiency_percent =
        Some(100.0 * up.min(down) / up.max(down)).filter(|percent| (0.0..=100.0).contains(percent));
}
