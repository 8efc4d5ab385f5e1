//! The path of the input as branches between turning points, and the loops that each branch closes, theory.md (10.2).

mod opening;
mod reversals;

use std::ops::Range;

use super::noise::{self, ChannelRun, Noise, resolution};
use super::significance;
use super::smoothing::{BranchRow, Parabola, Points, SmoothedRow, choose_window, smooth_where_straight};
use super::{DiagnosisOptions, PictureCurve, Piece};
use hysid_core::data::record::{Dataset, Record};
use hysid_core::elementary::hypot;
pub(crate) use opening::Opening;
use opening::openings;
pub(crate) use reversals::ReversalRule;
use reversals::reversals;

/// Branches of twice as many rows are averaged in blocks, to about so many points.
const MOST_POINTS: usize = 400;

/// A turning point counts as reached within this share of the input's range.
const REACHED: f64 = 0.003;

/// The same where rows are far apart: at most this share of the input's range.
const BETWEEN_ROWS: f64 = 0.01;

/// Branches lower than this share of the output's range have no shape.
const LOWEST: f64 = 0.05;

/// Branches lower than so many deviations of the noise have none either.
const LOWEST_IN_NOISE: f64 = 10.0;

/// An input whose noise is below this share of its range does not jitter.
pub(crate) const JITTERS: f64 = 2e-4;

/// Points on either side of one over which its slope is taken.
const BESIDE: usize = 3;

/// Number of enclosing turning points that are kept with a branch.
const KEPT: usize = 4;

/// A monotone way of the input between two turning points.
#[derive(Debug, Clone)]
pub(crate) struct Branch {
    pub record: usize,
    /// Rows from the turning point at its beginning to that at its end, both included.
    pub rows: Range<usize>,
    pub from: f64,
    pub to: f64,
    /// Mean speed of the input.
    pub speed: Option<f64>,
    /// Turning points that enclose it, the latest last; the last is where it began.
    pub beneath: Vec<f64>,
    /// How many of them the input is known to have turned at; the first row of a record is no turning point.
    pub known: usize,
    /// Those of them that still enclose it at its end, the latest last.
    pub around: Vec<f64>,
    /// Loops that it closes on its way.
    pub closes: Vec<Closing>,
    /// The output over the input.
    pub curve: BranchCurve,
}

/// A turning point that a branch comes back to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Closing {
    pub x: f64,
    /// Number of the branch that first arrived there.
    pub arrived: usize,
}

impl Branch {
    pub fn rises(&self) -> bool {
        self.to > self.from
    }

    pub fn travel(&self) -> f64 {
        (self.to - self.from).abs()
    }

    /// The input up to which this branch belongs to the loop that encloses it: where the turning point
    /// before its beginning lies, or its end if that comes first. `None` where nothing encloses it.
    pub fn own_end(&self) -> Option<f64> {
        let before = *self.beneath.iter().rev().nth(1)?;
        Some(if self.rises() { before.min(self.to) } else { before.max(self.to) })
    }

    /// The row where it goes through an input, if it went evenly.
    fn row_at(&self, x: f64) -> f64 {
        let share = ((x - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        self.rows.start as f64 + share * (self.rows.len() - 1) as f64
    }

    pub fn duration(&self) -> Option<f64> {
        self.speed.map(|speed| self.travel() / speed)
    }
}

/// Output over input along a branch, in the order of the input.
#[derive(Debug, Clone, Default)]
pub(crate) struct BranchCurve {
    points: Vec<CurvePoint>,
}

#[derive(Debug, Clone, Copy)]
struct CurvePoint {
    x: f64,
    y: f64,
    deviation: f64,
    bend: f64,
    input_deviation: f64,
}

/// A value read from a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CurveReading {
    pub y: f64,
    pub deviation: f64,
    /// How far smoothing and reading between the rows may be off.
    pub bend: f64,
}

impl BranchCurve {
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    pub fn range(&self) -> (f64, f64) {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => (first.x, last.x),
            _ => (f64::INFINITY, f64::NEG_INFINITY),
        }
    }

    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.points.iter().map(|point| (point.x, point.y))
    }

    pub fn points_with_deviation(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.points.iter().map(|point| (point.x, point.y, point.deviation))
    }

    /// The output at an input; `None` beyond the curve by more than the distance of its last points.
    pub fn at(&self, x: f64) -> Option<CurveReading> {
        let count = self.points.len();
        if count < 2 {
            return None;
        }
        let above = self.points.partition_point(|point| point.x < x).clamp(1, count - 1);
        let (a, b) = (&self.points[above - 1], &self.points[above]);
        let width = b.x - a.x;
        if width <= 0.0 {
            return (a.x == x).then_some(CurveReading { y: b.y, deviation: b.deviation, bend: b.bend });
        }
        let share = (x - a.x) / width;
        if !(-1.0..=2.0).contains(&share) {
            return None;
        }
        let neighbours = [above.checked_sub(2), Some(above + 1)];
        let line = |point: &CurvePoint| a.y + (b.y - a.y) * (point.x - a.x) / width;
        // A neighbour as far off the line as a parabola would be has bent it by an eighth of that, at
        // the spacing of two rows.
        let bend = neighbours
            .into_iter()
            .flatten()
            .filter_map(|index| self.points.get(index))
            .map(|point| {
                let away = ((point.x - a.x) * (point.x - b.x)).abs();
                if away > 0.0 { (point.y - line(point)).abs() * width * width / (4.0 * away) } else { 0.0 }
            })
            .fold(0.0, f64::max);
        let on_a_point = share == 0.0 || share == 1.0;
        Some(CurveReading {
            y: a.y + share * (b.y - a.y),
            deviation: a.deviation + share.clamp(0.0, 1.0) * (b.deviation - a.deviation),
            bend: a.bend.max(b.bend) + if on_a_point { 0.0 } else { bend.min((b.y - a.y).abs()) },
        })
    }
}

/// A data set as the tests of properties look at it.
#[derive(Debug)]
pub(crate) struct BranchSet<'a> {
    pub data: &'a Dataset,
    /// Smallest and largest input.
    pub input: (f64, f64),
    /// Smallest and largest output.
    pub output: (f64, f64),
    pub input_noise: Noise,
    pub output_noise: Noise,
    /// Reversals of the input below this are no turning points.
    pub smallest_reversal: f64,
    /// Rows that are taken together to read a curve.
    pub window: usize,
    /// All branches, record after record.
    pub branches: Vec<Branch>,
    /// How far each stands open to the next of its record, in their order.
    pub openings: Vec<Opening>,
    /// Deviation by which the output moves from cycle to cycle; 0 unless [`survey`](crate::cycles::survey) measured it.
    pub slow_noise: f64,
    /// True if the rows include the turning points themselves, as where a path was simulated.
    pub turns_on_rows: bool,
}

impl<'a> BranchSet<'a> {
    pub fn new(data: &'a Dataset, options: &DiagnosisOptions) -> Self {
        let input = data.input_range(0);
        let width = input.1 - input.0;
        let inputs = data.records().iter().map(|record| &*record.inputs()[0]);
        let roughness = noise::roughness(inputs);
        let rows = data.rows().max(2);
        // Jitter of all rows together hardly ever jumps further.
        let jitter = 2.0 * roughness * significance::critical_value(rows);
        let smallest_reversal = (options.smallest_reversal * width).max(jitter);
        Self::by_rule(data, options.smoothing, ReversalRule::Size(smallest_reversal))
    }

    /// Looks through the data, with branches between the reversals that a rule finds.
    pub fn by_rule(data: &'a Dataset, smoothing: bool, rule: ReversalRule) -> Self {
        let input = data.input_range(0);
        let width = input.1 - input.0;
        let inputs = data.records().iter().map(|record| &*record.inputs()[0]);
        let roughness = noise::roughness(inputs);
        let mut smallest_reversal: f64 = 0.0;
        let reached = REACHED * width + 2.0 * roughness;
        let mut branches = Vec::new();
        for (number, record) in data.records().iter().enumerate() {
            let (turns, smallest) = reversals(&record.inputs()[0], rule);
            smallest_reversal = smallest_reversal.max(smallest);
            follow(number, record, turns, (reached, BETWEEN_ROWS * width), &mut branches);
        }
        let input_noise = Noise::of(branches.iter().map(|branch| {
            let (values, output) = channels(data, branch);
            ChannelRun { values, beside: if is_scored(output) { output } else { &[] } }
        }));
        let scored = branches.iter().map(|branch| channels(data, branch)).filter(|(_, y)| is_scored(y));
        let output_noise = Noise::of(scored.map(|(beside, values)| ChannelRun { values, beside }));
        let reading = BranchReader {
            data,
            by_rows: input_noise.deviation() > JITTERS * width,
            resolutions: resolutions(data),
            input_noise: &input_noise,
            output_noise: &output_noise,
        };
        let points: Vec<Points> = branches.iter().map(|branch| reading.points(branch)).collect();
        let window = if smoothing { choose_window(&points) } else { 1 };
        for (branch, points) in branches.iter_mut().zip(points) {
            branch.curve = reading.curve(&points, window);
        }
        let output = data.output_range();
        let openings = openings(&branches, &output_noise);
        Self {
            data,
            input,
            output,
            input_noise,
            output_noise,
            smallest_reversal,
            window,
            branches,
            openings,
            slow_noise: 0.0,
            turns_on_rows: false,
        }
    }

    pub fn height(&self) -> f64 {
        self.output.1 - self.output.0
    }

    pub fn width(&self) -> f64 {
        self.input.1 - self.input.0
    }

    pub fn of_record(&self, record: usize) -> &[Branch] {
        let first = self.branches.partition_point(|branch| branch.record < record);
        let count = self.branches[first..].partition_point(|branch| branch.record == record);
        &self.branches[first..first + count]
    }

    pub fn turning_rows(&self) -> Vec<Vec<usize>> {
        let mut rows = vec![Vec::new(); self.data.records().len()];
        for pair in self.branches.windows(2).filter(|pair| pair[0].record == pair[1].record) {
            rows[pair[1].record].push(pair[1].rows.start);
        }
        rows
    }

    /// Branches lower than this have no shape to compare, in the unit of the output.
    pub fn lowest_shape(&self) -> f64 {
        (LOWEST * self.height()).max(LOWEST_IN_NOISE * self.output_noise.deviation())
    }

    /// By how much the output after a turning point may be off because the input turned between two rows, and so further
    /// on than it was measured: half the way between rows, times the change of slope.
    pub fn turn_error(&self, branch: &Branch) -> f64 {
        if self.turns_on_rows {
            return 0.0;
        }
        let record = &self.data.records()[branch.record];
        let first = branch.rows.start;
        let way = step_beside(&record.inputs()[0], first);
        let inwards = if branch.rises() { way } else { -way };
        let rise = |of: &Branch, reach: f64| -> Option<f64> {
            let (there, here) = (of.curve.at(branch.from + reach)?, of.curve.at(branch.from)?);
            let rise = there.y - here.y;
            // As far as it is not noise.
            let clear = (rise.abs() - hypot(there.deviation, here.deviation)).max(0.0);
            Some(clear.copysign(rise) / reach)
        };
        // A law may bend within two rows.
        let slope = |of: &Branch| -> Option<f64> {
            let (near, far) = (rise(of, inwards), rise(of, 2.0 * inwards));
            [near, far].into_iter().flatten().max_by(|a, b| a.abs().total_cmp(&b.abs()))
        };
        let place = self.branches.partition_point(|b| (b.record, b.rows.start) < (branch.record, first));
        let arriving = place.checked_sub(1).map(|place| &self.branches[place]);
        let arriving = arriving.filter(|arriving| arriving.record == branch.record);
        match (slope(branch), arriving.and_then(slope)) {
            (Some(own), Some(other)) => 0.5 * way * (own - other).abs(),
            _ => 0.0,
        }
    }

    /// Deviation by which slow noise and drift move the output over a number of rows.
    pub fn wander(&self, rows: f64) -> f64 {
        self.output_noise.wander(rows).max(self.slow_noise)
    }

    /// Deviation of the walk along a branch from its beginning, on average over a part of its way.
    pub fn wander_along(&self, branch: &Branch, way: f64) -> f64 {
        self.output_noise.wander(0.5 * way / branch.travel() * (branch.rows.len() - 1) as f64)
    }

    /// Rows between where two branches go through an input.
    pub fn rows_between(&self, a: &Branch, b: &Branch, x: f64) -> f64 {
        let (a_row, b_row) = (a.row_at(x), b.row_at(x));
        // Records of their own begin anywhere.
        if a.record == b.record { (a_row - b_row).abs() } else { a_row + b_row }
    }

    /// Mean time between rows; 0 without time.
    pub fn time_step(&self) -> f64 {
        let records = self.data.records().iter();
        let spans = records.filter_map(|record| Some((record.time()?, record.len().max(2) - 1)));
        let (time, steps) = spans.fold((0.0, 0), |(time, steps), (column, count)| {
            (time + column[column.len() - 1] - column[0], steps + count)
        });
        if steps == 0 { 0.0 } else { time / steps as f64 }
    }

    pub fn same_input(&self) -> f64 {
        0.01 * self.width() + 2.0 * self.input_noise.deviation()
    }
}

fn follow(
    number: usize,
    record: &Record,
    turns: Vec<usize>,
    (reached, longest_beside): (f64, f64),
    branches: &mut Vec<Branch>,
) {
    let x = &record.inputs()[0];
    let mut ends = vec![0];
    ends.extend(turns);
    ends.push(x.len() - 1);
    ends.dedup();
    // Each with the number of the branch that arrived there.
    let mut stack: Vec<(f64, Option<usize>)> = vec![(x[0], None)];
    for rows in ends.windows(2) {
        let (first, last) = (rows[0], rows[1]);
        let (from, to) = (x[first], x[last]);
        let here = branches.len();
        let latest = |stack: &[(f64, Option<usize>)]| -> Vec<f64> {
            stack[stack.len().saturating_sub(KEPT)..].iter().map(|(x, _)| *x).collect()
        };
        let beneath = latest(&stack);
        let begins_there = stack.len() == beneath.len() && stack[0].1.is_none() && stack.len() > 1;
        let known = beneath.len() - usize::from(begins_there);
        let mut closes = Vec::new();
        // The input turns between rows: up to half the way between them further on than it was measured.
        let reached = reached.max((0.5 * step_beside(x, last)).min(longest_beside));
        while stack.len() >= 2 {
            let (before, arrived) = stack[stack.len() - 2];
            let passed = if to > from { to >= before - reached } else { to <= before + reached };
            if !passed {
                break;
            }
            // What lies beneath the last two is not known: only the latest turning point still counts.
            if stack.len() == 2 {
                stack.remove(0);
                break;
            }
            closes.extend(arrived.map(|arrived| Closing { x: before, arrived }));
            stack.truncate(stack.len() - 2);
        }
        let around = latest(&stack);
        stack.push((to, Some(here)));
        let speed = record.time().map(|time| (to - from).abs() / (time[last] - time[first]));
        branches.push(Branch {
            record: number,
            rows: first..last + 1,
            from,
            to,
            speed,
            beneath,
            known,
            around,
            closes,
            curve: BranchCurve::default(),
        });
    }
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

/// The longer of the ways of the input to a row and from it.
fn step_beside(x: &[f64], row: usize) -> f64 {
    let before = (x[row] - x[row.saturating_sub(1)]).abs();
    let after = (x[(row + 1).min(x.len() - 1)] - x[row]).abs();
    before.max(after)
}

fn resolutions(data: &Dataset) -> (f64, f64) {
    let records = || data.records().iter();
    let input = resolution(records().flat_map(|record| &record.inputs()[0]));
    let output = resolution(records().flat_map(|record| record.output()));
    (input, output)
}

/// How branches are read from the rows of a data set.
struct BranchReader<'r> {
    data: &'r Dataset,
    /// True if the input is so noisy that, without time, the row number gives the order of rows better than the input.
    by_rows: bool,
    resolutions: (f64, f64),
    input_noise: &'r Noise,
    output_noise: &'r Noise,
}

impl BranchReader<'_> {
    /// Points of a branch in the order of time, averaged in blocks where there are very many.
    fn points(&self, branch: &Branch) -> Points {
        let record = &self.data.records()[branch.record];
        let columns = [&record.inputs()[0], record.output()].map(|column| &column[branch.rows.clone()]);
        let block = (branch.rows.len() / MOST_POINTS).max(1);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let blocks = |column: usize| columns[column].chunks(block).map(mean);
        // The output is smooth in time, whatever the input does; without time stamps the input stands for it.
        let stations: Vec<f64> = match record.time() {
            Some(time) => time[branch.rows.clone()].chunks(block).map(mean).collect(),
            None if self.by_rows => (0..columns[0].len().div_ceil(block)).map(|row| row as f64).collect(),
            None => blocks(0).collect(),
        };
        let rows = stations.into_iter().zip(blocks(0).zip(blocks(1)));
        let mut places: Vec<BranchRow> = rows
            .filter(|(_, (_, y))| !y.is_nan())
            .map(|(station, (x, y))| BranchRow { station, x, y })
            .collect();
        if places.len() < 4 {
            places.clear();
        }
        places.sort_by(|a, b| a.station.total_cmp(&b.station));
        Points {
            places,
            input_noise: self.input_noise.in_blocks(block),
            output_noise: self.output_noise.in_blocks(block),
        }
    }

    /// The output over the input along a branch, with what its noise and that of the input leave.
    fn curve(&self, points: &Points, window: usize) -> BranchCurve {
        let smoothed = smooth_where_straight(points, window);
        let place = |(place, value): (&BranchRow, &SmoothedRow)| self.curve_point(points, place, value);
        let mut points: Vec<CurvePoint> = points.places.iter().zip(&smoothed).map(place).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let deviations: Vec<(f64, f64)> =
            (0..points.len()).map(|at| self.through_the_slope(&points, at)).collect();
        for (point, (deviation, bend)) in points.iter_mut().zip(deviations) {
            point.deviation = hypot(point.deviation, deviation);
            point.bend += bend + 0.5 * self.resolutions.1;
        }
        BranchCurve { points }
    }

    /// A point without what the input's noise adds.
    fn curve_point(&self, points: &Points, place: &BranchRow, value: &SmoothedRow) -> CurvePoint {
        let jitters = self.by_rows;
        if points.output_noise.is_white() && !jitters {
            let deviation = value.deviation * points.output_noise.deviation();
            let input_deviation = points.input_noise.deviation();
            return CurvePoint { x: place.x, y: value.y, deviation, bend: value.bend, input_deviation };
        }
        let rows = &points.places[value.rows.clone()];
        let parabola = Parabola::over(rows, place.station);
        let weights: Vec<f64> = rows.iter().map(|row| parabola.weight(row)).collect();
        let x = rows.iter().zip(&weights).map(|(row, weight)| row.x * weight).sum();
        CurvePoint {
            x: if jitters { x } else { place.x },
            y: value.y,
            deviation: points.output_noise.of_sum(&weights),
            bend: value.bend,
            input_deviation: if jitters {
                points.input_noise.of_sum(&weights)
            } else {
                points.input_noise.deviation()
            },
        }
    }

    /// Deviation and error of an output because of the noise and the steps of the input.
    fn through_the_slope(&self, points: &[CurvePoint], at: usize) -> (f64, f64) {
        let (first, last) = (at.saturating_sub(BESIDE), (at + BESIDE).min(points.len() - 1));
        let (way, rise) = (points[last].x - points[first].x, points[last].y - points[first].y);
        let slope = if way > 0.0 { (rise / way).abs() } else { 0.0 };
        (slope * points[at].input_deviation, 0.5 * slope * self.resolutions.0)
    }
}

/// Input and output of a branch.
fn channels<'d>(data: &'d Dataset, branch: &Branch) -> (&'d [f64], &'d [f64]) {
    let record = &data.records()[branch.record];
    (&record.inputs()[0][branch.rows.clone()], &record.output()[branch.rows.clone()])
}

fn is_scored(output: &[f64]) -> bool {
    !output.iter().any(|y| y.is_nan())
}

/// Branches whose speeds differ by no more than this factor are of the same speed.
const SAME_SPEED: f64 = 1.25;

/// The speed at a place is that within this share of the input's range.
const NEAR: f64 = 0.0025;

/// With noise in the input, so many of its deviations more.
const NEAR_IN_NOISE: f64 = 6.0;

/// True if two speeds are taken as one.
pub(crate) fn is_one_speed(a: f64, b: f64) -> bool {
    a.max(b) <= SAME_SPEED * a.min(b)
}

impl BranchSet<'_> {
    /// True unless two branches are known to go through an input at different speeds, as where one of them is
    /// about to turn.
    pub fn similar_speed_at(&self, a: &Branch, b: &Branch, x: f64) -> bool {
        match (self.speed_at(a, x), self.speed_at(b, x)) {
            (Some(a), Some(b)) => is_one_speed(a, b),
            _ => true,
        }
    }

    /// True unless the mean speeds of two branches are known to differ.
    pub fn similar_speed(&self, a: &Branch, b: &Branch) -> bool {
        match (a.speed, b.speed) {
            (Some(a), Some(b)) => is_one_speed(a, b),
            _ => true,
        }
    }

    /// Number of rows of a typical branch, the median; 0 without branches.
    pub fn typical_rows(&self) -> usize {
        let mut rows: Vec<usize> = self.branches.iter().map(|branch| branch.rows.len()).collect();
        rows.sort_unstable();
        rows.get(rows.len() / 2).copied().unwrap_or(0)
    }

    /// Speed of the input near a place, over a short way and three rows at least; `None` without time.
    pub fn speed_at(&self, branch: &Branch, place: f64) -> Option<f64> {
        let record = &self.data.records()[branch.record];
        let time = &record.time()?[branch.rows.clone()];
        let x = &record.inputs()[0][branch.rows.clone()];
        let sign = if branch.rises() { 1.0 } else { -1.0 };
        let reach = NEAR * self.width() + NEAR_IN_NOISE * self.input_noise.deviation();
        let first = x.partition_point(|x| sign * x < sign * place - reach);
        let last = x.partition_point(|x| sign * x <= sign * place + reach);
        let first = first.saturating_sub(1).min(x.len().saturating_sub(3));
        let last = last.max(first + 2).min(x.len() - 1);
        (time[last] > time[first]).then(|| (x[last] - x[first]).abs() / (time[last] - time[first]))
    }

    pub fn piece(&self, branch: &Branch) -> Piece {
        Piece::of(&self.data.records()[branch.record], (branch.rows.start, branch.rows.end - 1))
    }

    pub fn curve(&self, label: &str, branch: &Branch) -> PictureCurve {
        PictureCurve { label: label.into(), points: branch.curve.points().collect() }
    }

    /// The part of a branch between two inputs, for a picture.
    pub fn curve_between(&self, label: &str, branch: &Branch, (a, b): (f64, f64)) -> PictureCurve {
        let (low, high) = (a.min(b), a.max(b));
        let points = branch.curve.points().filter(|(x, _)| *x >= low && *x <= high).collect();
        PictureCurve { label: label.into(), points }
    }
}
