//! What an undisturbed run shows of each property, computed directly. The program's verdict plays no part.

use super::branches::{Branch, Branches};
use super::property::{
    CONGRUENCY, DETERIORATION, LOOP_CLOSURE, MASING, ODD_SYMMETRY, ORIENTATION, PINCHING, PROPERTIES,
    RATE_DEPENDENCE, SATURATION, STATIC_HYSTERESIS, STRENGTH_LOSS, WIPING_OUT,
};

/// Inputs closer than this share of the range are the same.
const SAME: f64 = 0.01;

/// Branches shorter than this share of the input's range, or lower than this share of the output's, show no shape.
const SHORTEST: f64 = 0.05;

/// Places along a branch.
const PLACES: usize = 40;

/// Shares of a course where speeds are compared.
const SPEED_AT: [f64; 4] = [0.05, 0.3, 0.6, 0.95];

/// Loops that fill less than this share of the box of the run are none.
const LOOPLESS: f64 = 0.003;

/// The index of each property; none where the run has nothing to compare.
///
/// Violations: the largest of all comparisons. Orientation: signed over unsigned area. Saturation: slope of the last
/// tenth over the largest. Static hysteresis: area over box.
pub type Evidence = [Option<f64>; PROPERTIES.len()];

/// The evidence of a run from its inputs and outputs; `at_rest` are the outputs at a vanishing speed.
pub fn evidence(inputs: &[f64], outputs: &[f64], at_rest: &[f64], timed: bool) -> Evidence {
    let [run, slow] = [outputs, at_rest].map(|outputs| Branches::of(inputs, outputs, timed));
    let any_speed = Branches::of(inputs, outputs, false);
    let (run, slow) = (&run, &slow);
    // Of branches of one speed; where there are none, of all.
    let of_memory = |index: fn(&Branches) -> Option<f64>| index(run).or_else(|| index(&any_speed));
    let cycles = cycles(run);
    let mut evidence = [None; PROPERTIES.len()];
    evidence[STATIC_HYSTERESIS] = fullness(slow, run.height);
    evidence[ORIENTATION] = orientation(run);
    evidence[RATE_DEPENDENCE] = rate_dependence(run);
    evidence[WIPING_OUT] = of_memory(wiping_out);
    evidence[CONGRUENCY] = of_memory(congruency);
    evidence[MASING] = of_memory(masing);
    evidence[ODD_SYMMETRY] = odd_symmetry(run);
    evidence[SATURATION] = saturation(run);
    evidence[DETERIORATION] = deterioration(run, &cycles);
    evidence[LOOP_CLOSURE] = loop_closure(run, &cycles);
    evidence[STRENGTH_LOSS] = strength_loss(run);
    evidence[PINCHING] = pinching(run);
    evidence
}

fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

/// Evenly spaced inputs between two, both included.
fn places(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..=PLACES).map(move |place| from + (to - from) * place as f64 / PLACES as f64)
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// A branch and the next, over the inputs of both.
struct Opening {
    /// `∮ y dx`, positive if passed clockwise.
    signed: f64,
    /// The same with all parts counted as positive.
    area: f64,
    width: f64,
}

fn opening(run: &Branches, there: &Branch, back: &Branch) -> Option<Opening> {
    let ((a, b), (c, d)) = (there.span(), back.span());
    let (low, high) = (a.max(c), b.min(d));
    let sign = if there.rises() { 1.0 } else { -1.0 };
    let apart: Vec<f64> = places(low, high)
        .map(|x| Some(sign * (run.at(there, x)? - run.at(back, x)?)))
        .collect::<Option<_>>()?;
    let step = (high - low) / apart.len() as f64;
    Some(Opening {
        signed: apart.iter().sum::<f64>() * step,
        area: apart.iter().map(|v| v.abs()).sum::<f64>() * step,
        width: high - low,
    })
}

/// The openings over more than this share of the widest.
fn wide_openings(run: &Branches, share: f64) -> Vec<Opening> {
    let mut openings: Vec<Opening> =
        run.branches.windows(2).filter_map(|pair| opening(run, &pair[0], &pair[1])).collect();
    let widest = openings.iter().map(|opening| opening.width).fold(0.0, f64::max);
    openings.retain(|opening| opening.width > share * widest);
    openings
}

/// Mean area of the widest loops over their width and the range of the output at the measured speed.
fn fullness(slow: &Branches, height: f64) -> Option<f64> {
    let wide = wide_openings(slow, 0.7);
    let sum: f64 = wide.iter().map(|opening| opening.area / (opening.width * height)).sum();
    (!wide.is_empty()).then(|| sum / wide.len() as f64)
}

fn orientation(run: &Branches) -> Option<f64> {
    let mut open = wide_openings(run, 0.3);
    open.retain(|opening| opening.area > LOOPLESS * opening.width * run.height);
    let area: f64 = open.iter().map(|opening| opening.area).sum();
    (area > 0.0).then(|| open.iter().map(|opening| opening.signed).sum::<f64>() / area)
}

/// Largest difference between the fastest and the slowest branch of equal ends, over the range of the output. What a
/// constant delay explains is no difference: a record cannot tell the two apart.
fn rate_dependence(run: &Branches) -> Option<f64> {
    let speed = |branch: &Branch| branch.travel() / branch.steps() as f64;
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * run.width;
    let long: Vec<&Branch> = run.branches.iter().filter(|b| b.travel() >= 0.1 * run.width).collect();
    largest(long.iter().filter_map(|first| {
        let group = || {
            let alike = |b: &&&Branch| {
                let outer = (b.outer.iter().rev().nth(1), first.outer.iter().rev().nth(1));
                let outer = match outer {
                    (Some(a), Some(b)) => same(*a, *b),
                    (None, None) => true,
                    _ => false,
                };
                same(b.from, first.from) && same(b.to, first.to) && outer
            };
            long.iter().filter(alike)
        };
        let slow = group().min_by(|a, b| speed(a).total_cmp(&speed(b)))?;
        let fast = group().max_by(|a, b| speed(a).total_cmp(&speed(b)))?;
        if speed(fast) < 2.0 * speed(slow) {
            return None;
        }
        let longest = fast.steps() as isize / 4;
        let delays = (-longest..=longest).step_by((longest as usize / 40).max(1));
        delays
            .filter_map(|delay| late(run, fast, slow, delay))
            .reduce(f64::min)
            .map(|least| least / run.height)
    }))
}

/// Difference of a branch from another where its output is late by so many steps.
fn late(run: &Branches, branch: &Branch, other: &Branch, delay: isize) -> Option<f64> {
    let steps = (branch.first..=branch.last).step_by((branch.steps() / PLACES).max(1));
    let differences: Vec<f64> = steps
        .filter_map(|step| {
            let output = run.outputs.get(step.checked_add_signed(delay)?)?;
            Some(output - run.at(other, run.inputs[step])?)
        })
        .collect();
    (differences.len() > PLACES / 2).then(|| root_mean_square(&differences))
}

/// Largest gap where the input returns to a turning point, over the range of the output.
fn wiping_out(run: &Branches) -> Option<f64> {
    let gaps = run.branches.iter().flat_map(|branch| {
        let long = |x: f64| (x - branch.from).abs() >= SHORTEST * run.width;
        let returns = branch.returns.iter().filter(move |(x, _)| long(*x));
        returns.filter_map(|&(x, step)| {
            let (low, high) = branch.span();
            let back = x.clamp(low, high);
            let arrived = run.branches.iter().find(|other| other.last == step)?;
            let gap = (run.at(branch, back)? - run.outputs[step]).abs() / run.height;
            run.one_speed((branch, back), (arrived, x)).then_some(gap)
        })
    });
    largest(gaps)
}

/// Largest difference in shape of two branches of equal beginning and direction and different past, over their height.
fn congruency(run: &Branches) -> Option<f64> {
    let known: Vec<&Branch> =
        run.branches.iter().filter(|b| b.own_end().is_some() && b.travel() >= SHORTEST * run.width).collect();
    let pairs = known.iter().enumerate().flat_map(|(k, a)| known[k + 1..].iter().map(move |b| (*a, *b)));
    largest(pairs.filter_map(|(a, b)| {
        let same = a.rises() == b.rises() && (a.from - b.from).abs() <= 0.2 * SAME * run.width;
        if !same || !other_past(run, a, b) {
            return None;
        }
        let end = if a.rises() { a.own_end()?.min(b.own_end()?) } else { a.own_end()?.max(b.own_end()?) };
        let begin = if a.rises() { a.from.max(b.from) } else { a.from.min(b.from) };
        let along = if a.rises() { end - begin } else { begin - end };
        if along < SHORTEST * run.width {
            return None;
        }
        let course = SPEED_AT.map(|share| begin + share * (end - begin));
        if !course.iter().all(|&x| run.one_speed((a, x), (b, x))) {
            return None;
        }
        let (start_a, start_b) = (run.at(a, begin)?, run.at(b, begin)?);
        let shapes: Vec<(f64, f64)> = places(begin, end)
            .map(|x| Some((run.at(a, x)? - start_a, run.at(b, x)? - start_b)))
            .collect::<Option<_>>()?;
        let height = height(shapes.iter().map(|s| s.0)).max(height(shapes.iter().map(|s| s.1)));
        let apart: Vec<f64> = shapes.iter().map(|(a, b)| a - b).collect();
        (height >= SHORTEST * run.height).then(|| root_mean_square(&apart) / height)
    }))
}

fn height(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let (low, high) = super::paths::range(&values);
    high - low
}

/// True if one of the two turning points around the branches differs.
fn other_past(run: &Branches, a: &Branch, b: &Branch) -> bool {
    let outer = |branch: &Branch, depth: usize| branch.outer.iter().rev().nth(depth).copied();
    (1..=2).any(|depth| match (outer(a, depth), outer(b, depth)) {
        (Some(a), Some(b)) => (a - b).abs() > SHORTEST * run.width,
        (None, None) => false,
        _ => true,
    })
}

/// Largest difference of a branch from the longest, both from their turning points on, over the height of the shorter.
fn masing(run: &Branches) -> Option<f64> {
    let length = |branch: &Branch| branch.own_end().map(|end| (end - branch.from).abs());
    let mut own: Vec<(f64, &Branch)> = run
        .branches
        .iter()
        .filter_map(|b| Some((length(b)?, b)))
        .filter(|(length, _)| *length >= SHORTEST * run.width)
        .collect();
    own.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (longest, others) = own.split_first()?;
    let after = |branch: &Branch, way: f64| branch.from + (branch.to - branch.from).signum() * way;
    let grown = |branch: &Branch, way: f64| {
        let sign = (branch.to - branch.from).signum();
        let there = run.at(branch, after(branch, way))?;
        Some(sign * (there - run.outputs[branch.first]))
    };
    largest(others.iter().filter(|(length, _)| *length < 0.9 * longest.0).filter_map(|(length, branch)| {
        let one_speed = |share: &f64| {
            let place = |branch| after(branch, share * length);
            run.one_speed((longest.1, place(longest.1)), (*branch, place(*branch)))
        };
        if !SPEED_AT.iter().all(one_speed) {
            return None;
        }
        let shapes: Vec<(f64, f64)> = places(0.0, 0.999 * length)
            .map(|way| Some((grown(longest.1, way)?, grown(branch, way)?)))
            .collect::<Option<_>>()?;
        let height = largest(shapes.iter().map(|s| s.1.abs()))?;
        let apart: Vec<f64> = shapes.iter().map(|(a, b)| a - b).collect();
        (height >= SHORTEST * run.height).then(|| root_mean_square(&apart) / height)
    }))
}

/// Largest difference of a branch over the whole range from the mean of its neighbours, turned, over the range of the
/// output.
fn odd_symmetry(run: &Branches) -> Option<f64> {
    let half = 0.5 * run.width;
    let whole = |branch: &Branch| branch.travel() >= 0.98 * run.width;
    largest(run.branches.windows(3).filter(|three| three.iter().all(whole)).filter_map(|three| {
        let sums: Vec<f64> = places(-0.97 * half, 0.97 * half)
            .map(|x| {
                let turned = 0.5 * (run.at(&three[0], -x)? + run.at(&three[2], -x)?);
                Some(run.at(&three[1], x)? + turned)
            })
            .collect::<Option<_>>()?;
        let mean = sums.iter().sum::<f64>() / sums.len() as f64;
        let differences: Vec<f64> = sums.iter().map(|sum| sum - mean).collect();
        Some(root_mean_square(&differences) / run.height)
    }))
}

/// Slope of the last tenth over the largest of a tenth, mean of the branches to either end, the smaller of both ends.
fn saturation(run: &Branches) -> Option<f64> {
    let (low, high) = super::paths::range(run.inputs);
    let end = |rising: bool| {
        let edge = if rising { high } else { low };
        let reaches = |b: &&Branch| {
            b.rises() == rising && (b.to - edge).abs() <= SAME * run.width && b.travel() >= 0.6 * run.width
        };
        let ratio = |branch: &Branch| {
            let at =
                |part: usize| run.at(branch, branch.from + (branch.to - branch.from) * part as f64 / 10.0);
            let heights: Vec<f64> = (0..=10).map(at).collect::<Option<_>>()?;
            let rises: Vec<f64> = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
            let high = (heights[10] - heights[0]).abs() >= 0.3 * run.height;
            high.then(|| rises[9] / rises.iter().copied().fold(0.0, f64::max))
        };
        let ratios: Vec<f64> = run.branches.iter().filter(reaches).filter_map(ratio).collect();
        (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
    };
    [end(true), end(false)].into_iter().flatten().reduce(f64::min)
}

/// Branches there and back that begin and end at the same input, in groups of the same ends, enclosing turning points
/// and speed; at least two in a group.
fn cycles(run: &Branches) -> Vec<Vec<usize>> {
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * run.width;
    let same_surroundings = |a: &Branch, b: &Branch| {
        let mut outer = a.around.iter().rev().zip(b.around.iter().rev()).skip(1).take(2);
        outer.all(|(a, b)| same(*a, *b))
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut index = 0;
    while index + 1 < run.branches.len() {
        let (there, back) = (&run.branches[index], &run.branches[index + 1]);
        if (back.to - there.from).abs() > 0.02 * there.travel().max(back.travel()) {
            index += 1;
            continue;
        }
        let known = groups.iter_mut().find(|group| {
            let other = &run.branches[group[0]];
            let (a, b) = (other.steps() as f64, there.steps() as f64);
            same(other.from, there.from)
                && same(other.to, there.to)
                && a.max(b) <= 1.25 * a.min(b)
                && same_surroundings(other, there)
        });
        match known {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
        index += 2;
    }
    groups.retain(|group| group.len() >= 2);
    groups
}

/// The largest loss of energy of a kind of repeated loops, from the first to the last; of three loops at least.
fn deterioration(run: &Branches, groups: &[Vec<usize>]) -> Option<f64> {
    // Loops that cross themselves have an area, but hardly an energy.
    let energy = |index: usize| {
        let Opening { signed, area, width } = opening(run, &run.branches[index], &run.branches[index + 1])?;
        let energy = if signed.abs() < 0.3 * area { area } else { signed.abs() };
        (area > LOOPLESS * width * run.height).then_some(energy)
    };
    let ends = groups.iter().filter_map(|group| {
        let (first, last) = (energy(group[0])?, energy(group[group.len() - 1])?);
        Some((first, 1.0 - last / first, group.len()))
    });
    let ends: Vec<(f64, f64, usize)> = ends.collect();
    let most = largest(ends.iter().map(|end| end.0))?;
    let large = || ends.iter().filter(|end| end.0 >= 0.01 * most);
    let enough = large().map(|end| end.2).sum::<usize>() >= 3;
    largest(large().map(|end| end.1)).filter(|_| enough)
}

/// Largest loss of half the range of the output between the ends of branches that reach both furthest inputs so far, of the
/// largest before; of three branches at least.
fn strength_loss(run: &Branches) -> Option<f64> {
    let near = SAME * run.width;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut strongest, mut loss, mut count) = (0.0_f64, 0.0_f64, 0);
    for branch in &run.branches {
        let (below, above) = branch.span();
        (low, high) = (low.min(below), high.max(above));
        if below > low + near || above < high - near {
            continue;
        }
        let strength = 0.5 * (run.outputs[branch.last] - run.outputs[branch.first]).abs();
        strongest = strongest.max(strength);
        (loss, count) = (loss.max(1.0 - strength / strongest), count + 1);
    }
    (count >= 3).then_some(loss)
}

/// Slope of the tenth of a branch that follows where the output passes 0, over the largest slope of a tenth from there on;
/// the median of the branches over more than half of the range.
fn pinching(run: &Branches) -> Option<f64> {
    let ratio = |branch: &Branch| {
        let at = |part: usize| run.at(branch, branch.from + (branch.to - branch.from) * part as f64 / 100.0);
        let heights: Vec<f64> = (0..=100).map(at).collect::<Option<_>>()?;
        let behind = heights.windows(2).position(|pair| pair[0] * pair[1] <= 0.0)? + 1;
        let rises: Vec<f64> =
            heights[behind..].windows(11).map(|tenth| (tenth[10] - tenth[0]).abs()).collect();
        Some(rises.first()? / rises.iter().copied().fold(0.0, f64::max))
    };
    let large = run.branches.iter().filter(|branch| branch.travel() > 0.5 * run.width);
    let mut ratios: Vec<f64> = large.filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}

/// Largest gap after a period that follows an equal one, over the range of the output.
fn loop_closure(run: &Branches, groups: &[Vec<usize>]) -> Option<f64> {
    let later = groups.iter().flat_map(|group| group.windows(2)).filter(|pair| pair[1] == pair[0] + 2);
    largest(later.filter_map(|pair| {
        let index = pair[1];
        let (there, back) = (&run.branches[index], &run.branches[index + 1]);
        let exact = (back.to - there.from).abs() <= 0.002 * run.width;
        exact.then(|| (run.outputs[back.last] - run.outputs[there.first]).abs() / run.height)
    }))
}
