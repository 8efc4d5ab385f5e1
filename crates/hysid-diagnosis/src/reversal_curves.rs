//! First-order reversal curves (FORC): the branches that begin on the branch from one end of the input's range and lead
//! back to that end. From them follow the Everett function and the density of a Preisach plane.
//!
//! ```text
//! E(x, r) = ½ |y(r, x) - y(r, r)|            Everett function                    (Mayergoyz 1986)
//! ρ(r, x) = -½ ∂²y/∂r∂x                      density                             (Pike, Roberts, Verosub 1999)
//! y ≈ a_1 + a_2 r + a_3 r² + a_4 x + a_5 x² + a_6 r x,    ρ = -½ a_6             within a window
//! ```
//!
//! `y(r, x)` is the output at the input `x` of the curve that begins at the reversal input `r`. Both are those of relays
//! with outputs ±1: from `r` to `x` the output grows by `2 E(x, r)`, theory.md (7.9). For curves that fall from reversals on
//! the rising branch, `ρ = ½ ∂²y/∂r∂x`.
//!
//! The parabola is fitted by least squares to the rows of the `2 SF + 1` curves and the inputs within `SF` steps around a
//! node, `SF` the smoothing factor and a step the median distance of neighbouring reversal inputs.

mod calibration;
mod density;
mod recognition;
#[cfg(test)]
mod tests;

use hysid_core::data::record::Dataset;
use hysid_core::error::Result;
use serde::Serialize;

pub(crate) use self::calibration::without_calibration_points;
use self::density::{Smoothing, chosen};
use self::recognition::{CurveSet, recognised};
use super::branch::BranchSet;
use super::{DiagnosisOptions, FEWEST_ROWS};

/// Valid smoothing factors.
pub const SMOOTHING_FACTORS: std::ops::RangeInclusive<usize> = 1..=10;

/// Valid growths of the smoothing factor.
pub const SMOOTHING_GROWTHS: std::ops::RangeInclusive<f64> = 0.0..=1.0;

/// Grid lines of the table, at most; of more curves some are left out, in the table only.
const MOST_LINES: usize = 120;

/// How reversal curves are found and smoothed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReversalCurveOptions {
    /// How branches are found.
    pub branches: DiagnosisOptions,
    /// The smoothing factor `SF`, within [`SMOOTHING_FACTORS`]; `None` for the smallest from 1 to 6 with which the noise of
    /// the output deviates the density by 5 % of its largest value or less.
    pub smoothing_factor: Option<usize>,
    /// Growth `λ` of the smoothing factor, within [`SMOOTHING_GROWTHS`]: that of a node is `SF + λ min(H_c, |H_u|)/step`, at
    /// most 10. So the ridges at `H_c = 0` and `H_u = 0` stay sharp and noise beside them is smoothed, as by VARIFORC (R. Egli,
    /// Glob. Planet. Change 110, 2013, 302-320).
    pub smoothing_growth: f64,
}

/// A first-order reversal curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReversalCurve {
    /// Name of the record.
    pub record: String,
    /// First and last row, counted from 0 at the beginning of the record.
    pub rows: (usize, usize),
    /// Input where it begins.
    pub reversal_input: f64,
    /// Output there.
    pub reversal_output: f64,
    /// Inputs and outputs along it.
    #[serde(skip)]
    pub points: Vec<(f64, f64)>,
}

/// A node of the grid over reversal input and input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReversalNode {
    /// Input where the curve begins.
    pub reversal_input: f64,
    /// Input along the curve.
    pub input: f64,
    /// Output there.
    pub output: f64,
    /// Everett function, in the unit of the output.
    pub everett: f64,
    /// Density, in the unit of the output over the square of that of the input; `None` where too few rows surround the node.
    pub density: Option<f64>,
    /// Standard deviation of the density from the noise of the output.
    pub density_deviation: Option<f64>,
}

/// A value of a marginal distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarginalValue {
    /// Coercivity or interaction field.
    pub field: f64,
    /// Integral of the density over the other field, for the measure `dr dx`.
    pub density: f64,
}

/// First-order reversal curves, and what follows from them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReversalCurves {
    /// The input at which all curves end.
    pub end: f64,
    /// True if the input rises along the curves.
    pub rising: bool,
    /// The curves, from the reversal input next to the end to the furthest.
    pub curves: Vec<ReversalCurve>,
    /// Distance of the grid's lines along both axes, in the unit of the input.
    pub step: f64,
    /// Smoothing factor `SF` of the [module page](self).
    pub smoothing_factor: usize,
    /// True if it was chosen by the noise.
    pub smoothing_is_chosen: bool,
    /// The nodes, curve by curve.
    pub nodes: Vec<ReversalNode>,
    /// Notes on the curves for the reader.
    pub notes: Vec<String>,
}

impl ReversalCurves {
    /// The first-order reversal curves in data; `None` if there are fewer than five with different reversal inputs, or if
    /// they are not most of the branches in their direction.
    ///
    /// # Errors
    /// Data without loops: a constant input or output, hardly any rows.
    pub fn of(data: &Dataset, options: &ReversalCurveOptions) -> Result<Option<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let survey = BranchSet::new(data, &options.branches);
        Ok(recognised(&survey).map(|found| Self::from_candidates(&survey, &found, options)))
    }

    fn from_candidates(survey: &BranchSet, found: &CurveSet, options: &ReversalCurveOptions) -> Self {
        let wanted = options.smoothing_factor;
        let sign = if found.rising { 1.0 } else { -1.0 };
        let step = median_step(&found.branches.iter().map(|&b| survey.branches[b].from).collect::<Vec<_>>());
        let lines = found.branches.len().div_ceil(MOST_LINES).max(1);
        let smoothing = Smoothing::new(survey, found, step, options.smoothing_growth);
        let grid = grid(survey, found, step * lines as f64, lines);
        let places: Vec<(usize, f64)> =
            grid.iter().map(|&(curve, node)| (curve, sign * node.input)).collect();
        let (factor, densities) = match wanted {
            Some(factor) => (factor, smoothing.densities(&places, factor)),
            None => chosen(&smoothing, &places),
        };
        let mut nodes: Vec<ReversalNode> = grid.into_iter().map(|(_, node)| node).collect();
        for (node, density) in nodes.iter_mut().zip(&densities) {
            node.density = density.map(|density| density.value);
            node.density_deviation = density.map(|density| density.deviation);
        }
        let curves = found.branches.iter().map(|&number| {
            let branch = &survey.branches[number];
            let points: Vec<(f64, f64)> = branch.curve.points().collect();
            ReversalCurve {
                record: survey.data.records()[branch.record].name().into(),
                rows: (branch.rows.start, branch.rows.end - 1),
                reversal_input: branch.from,
                reversal_output: branch.curve.at(branch.from).map_or(f64::NAN, |reading| reading.y),
                points,
            }
        });
        let notes = notes(&nodes, found, lines);
        Self {
            end: found.end,
            rising: found.rising,
            curves: curves.collect(),
            step: step * lines as f64,
            smoothing_factor: factor,
            smoothing_is_chosen: wanted.is_none(),
            nodes,
            notes,
        }
    }

    /// Coercivity `H_c`, half the distance of input and reversal input, and interaction field `H_u`, their mean, of a node.
    pub fn fields(&self, node: &ReversalNode) -> (f64, f64) {
        let sign = if self.rising { 0.5 } else { -0.5 };
        (sign * (node.input - node.reversal_input), 0.5 * (node.input + node.reversal_input))
    }

    /// Marginal distributions of the density over the coercivity and over the interaction field: its sum over the nodes of
    /// each class of half a step, as integral over the other field. Both have the sum of the density over the plane.
    pub fn marginals(&self) -> [Vec<MarginalValue>; 2] {
        let width = 0.5 * self.step;
        let mut sums = [std::collections::BTreeMap::new(), std::collections::BTreeMap::new()];
        for node in &self.nodes {
            let Some(density) = node.density else { continue };
            let (coercivity, interaction) = self.fields(node);
            // A node has the area step² in the plane of both inputs, which is that of dH_c dH_u times 2.
            for (sum, field) in sums.iter_mut().zip([coercivity, interaction]) {
                *sum.entry((field / width).round() as i64).or_insert(0.0) +=
                    density * self.step * self.step / width;
            }
        }
        let values = |sums: std::collections::BTreeMap<i64, f64>| {
            sums.into_iter()
                .map(|(place, value)| MarginalValue { field: place as f64 * width, density: value })
                .collect()
        };
        sums.map(values)
    }

    /// The largest magnitude of the density.
    pub fn largest_density(&self) -> f64 {
        self.nodes.iter().filter_map(|node| node.density).fold(0.0, |most, density| most.max(density.abs()))
    }
}

fn median_step(reversals: &[f64]) -> f64 {
    let mut steps: Vec<f64> = reversals.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    crate::significance::median(&mut steps)
}

/// The nodes: on every curve, or every so many, at equal steps of the input from the end back to its beginning.
fn grid(survey: &BranchSet, found: &CurveSet, step: f64, every: usize) -> Vec<(usize, ReversalNode)> {
    let sign = if found.rising { 1.0 } else { -1.0 };
    let mut nodes = Vec::new();
    for (curve, &number) in found.branches.iter().enumerate().step_by(every) {
        let branch = &survey.branches[number];
        let Some(begin) = branch.curve.at(branch.from) else { continue };
        let length = sign * (found.end - branch.from) / step;
        // A node within rounding of the beginning belongs to the curve.
        for place in 0..=(length + 1e-6).floor().max(0.0) as usize {
            let input = found.end - sign * place as f64 * step;
            if let Some(reading) = branch.curve.at(input) {
                nodes.push((
                    curve,
                    ReversalNode {
                        reversal_input: branch.from,
                        input,
                        output: reading.y,
                        everett: 0.5 * sign * (reading.y - begin.y),
                        density: None,
                        density_deviation: None,
                    },
                ));
            }
        }
    }
    nodes
}

fn notes(nodes: &[ReversalNode], found: &CurveSet, lines: usize) -> Vec<String> {
    let mut notes = Vec::new();
    let most = nodes.iter().filter_map(|node| node.density).fold(0.0, |most: f64, d| most.max(d.abs()));
    let squares = nodes.iter().filter_map(|node| node.density_deviation).map(|d| d * d);
    let (sum, count) = squares.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
    let deviation = (sum / f64::from(count.max(1))).sqrt();
    if deviation > density::ACCEPTED * most {
        notes.push(format!(
            "the noise of the output deviates the density by {:.0} % of its largest value",
            100.0 * deviation / most
        ));
    }
    if found.repeated > 0 {
        notes.push(format!("{} repeated curves are left out", found.repeated));
    }
    if lines > 1 {
        notes.push(format!("the table has every {lines}th curve"));
    }
    notes
}
