//! The density of the Preisach plane by local parabolas (C. R. Pike, A. P. Roberts and K. L. Verosub, J. Appl. Phys. 85, 1999,
//! 6660-6667).

use hysid_core::elementary::square;
use hysid_core::linear_algebra::Symmetric;
use hysid_core::stop_check::StopCheck;

use super::SMOOTHING_FACTORS;
use super::recognition::CurveSet;
use crate::branch::BranchSet;

/// The deviation of the density by noise, as a share of its largest magnitude, that a chosen smoothing factor accepts.
pub(super) const ACCEPTED: f64 = 0.05;

/// Smoothing factors that are tried.
const TRIED: std::ops::RangeInclusive<usize> = 1..=6;

/// Share of a full window that must have rows. On the diagonal half of the window has none.
const FULL: f64 = 0.45;

/// A curve is of a window if its reversal input is so many times as far from the node's as curves in equal steps would be.
const FURTHER: f64 = 1.5;

/// Rows of a curve within half a step are taken together.
const CELLS: f64 = 2.0;

/// Coefficients of a parabola of two variables.
const COEFFICIENTS: usize = 6;

/// A density, and its standard deviation from the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Density {
    pub value: f64,
    pub deviation: f64,
}

/// Rows of a curve taken together.
#[derive(Debug, Clone, Copy)]
struct DensityCell {
    x: f64,
    y: f64,
    rows: f64,
}

/// The curves as the parabolas are fitted to them. Curves that fall are turned about the origin, so that all rise.
#[derive(Debug)]
pub(super) struct Smoothing {
    step: f64,
    noise: f64,
    growth: f64,
    reversals: Vec<f64>,
    /// The cells of each curve, in the order of the input.
    curves: Vec<Vec<DensityCell>>,
}

impl Smoothing {
    pub fn new(survey: &BranchSet, found: &CurveSet, step: f64, growth: f64) -> Self {
        let sign = if found.rising { 1.0 } else { -1.0 };
        let end = sign * found.end;
        let curve = |&number: &usize| {
            let branch = &survey.branches[number];
            let record = &survey.data.records()[branch.record];
            let (x, y) = (&record.inputs()[0][branch.rows.clone()], &record.output()[branch.rows.clone()]);
            let mut cells: Vec<(i64, DensityCell)> = Vec::new();
            for (x, y) in x.iter().zip(y).filter(|(_, y)| !y.is_nan()) {
                let (x, y) = (sign * x, sign * y);
                let place = ((end - x) * CELLS / step).round() as i64;
                match cells.last_mut().filter(|(last, _)| *last == place) {
                    Some((_, cell)) => {
                        *cell = DensityCell { x: cell.x + x, y: cell.y + y, rows: cell.rows + 1.0 };
                    }
                    None => cells.push((place, DensityCell { x, y, rows: 1.0 })),
                }
            }
            let mean = |(_, cell): &(i64, DensityCell)| DensityCell {
                x: cell.x / cell.rows,
                y: cell.y / cell.rows,
                ..*cell
            };
            let mut cells: Vec<DensityCell> = cells.iter().map(mean).collect();
            cells.sort_by(|a, b| a.x.total_cmp(&b.x));
            cells
        };
        Self {
            step,
            growth,
            noise: survey.output_noise.deviation(),
            reversals: found.branches.iter().map(|&number| sign * survey.branches[number].from).collect(),
            curves: found.branches.iter().map(curve).collect(),
        }
    }

    /// The density at each node, which is the number of a curve and an input, with a smoothing factor that grows away from
    /// both axes; `None` where too few rows surround it.
    pub fn densities(&self, nodes: &[(usize, f64)], factor: usize) -> Vec<Option<Density>> {
        let window = |&(curve, x): &(usize, f64)| {
            let factor = self.factor_at(self.reversals[curve], x, factor);
            (factor, self.window(curve, x, factor))
        };
        let windows: Vec<(usize, Vec<[f64; 4]>)> = nodes.iter().map(window).collect();
        let mut full = [0; *SMOOTHING_FACTORS.end() + 1];
        windows.iter().for_each(|(factor, window)| full[*factor] = full[*factor].max(window.len()));
        let is_filled = |(factor, window): &(usize, Vec<[f64; 4]>)| {
            window.len() >= COEFFICIENTS && window.len() as f64 >= FULL * full[*factor] as f64
        };
        let density =
            |both: &(usize, Vec<[f64; 4]>)| is_filled(both).then(|| self.density(&both.1, both.0))?;
        windows.iter().map(density).collect()
    }

    /// The smoothing factor of a node.
    fn factor_at(&self, reversal: f64, x: f64, least: usize) -> usize {
        let away = f64::min(0.5 * (x - reversal), 0.5 * (x + reversal).abs());
        let grown = least + (self.growth * away / self.step).max(0.0) as usize;
        grown.min(*SMOOTHING_FACTORS.end()).max(least)
    }

    /// Reversal input and input in units of the window, output, and number of rows of all cells around a node.
    fn window(&self, curve: usize, x: f64, factor: usize) -> Vec<[f64; 4]> {
        let reach = factor as f64 * self.step;
        let around = curve.saturating_sub(factor)..(curve + factor + 1).min(self.curves.len());
        let near =
            around.filter(|&other| (self.reversals[other] - self.reversals[curve]).abs() <= FURTHER * reach);
        // Half a cell more, so that rounding leaves no cell out.
        let (low, high) = (x - reach - 0.25 * self.step, x + reach + 0.25 * self.step);
        let mut window = Vec::new();
        for other in near {
            let cells = &self.curves[other];
            let first = cells.partition_point(|cell| cell.x < low);
            let inside = cells[first..].iter().take_while(|cell| cell.x <= high);
            let u = (self.reversals[other] - self.reversals[curve]) / reach;
            window.extend(inside.map(|cell| [u, (cell.x - x) / reach, cell.y, cell.rows]));
        }
        window
    }

    /// `-½ a_6` of the parabola of least squares; `None` if the rows do not determine it.
    fn density(&self, window: &[[f64; 4]], factor: usize) -> Option<Density> {
        let reach = factor as f64 * self.step;
        let terms = |[u, v, ..]: &[f64; 4]| [1.0, *u, u * u, *v, v * v, u * v];
        let rows: Vec<[f64; COEFFICIENTS]> = window.iter().map(terms).collect();
        let gram = Symmetric::from_fn(COEFFICIENTS, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
        // The last row of the inverse gives what each row counts in a_6.
        let mut last = [0.0; COEFFICIENTS];
        last[COEFFICIENTS - 1] = 1.0;
        gram.cholesky(StopCheck::never())?.solve(&mut last);
        let offset = window[0][2];
        let (mut mixed, mut variance) = (0.0, 0.0);
        for (row, [.., y, rows]) in rows.iter().zip(window) {
            let weight: f64 = row.iter().zip(last).map(|(term, last)| term * last).sum();
            mixed += weight * (y - offset);
            variance += weight * weight / rows;
        }
        let scale = 0.5 / (reach * reach);
        Some(Density { value: -scale * mixed, deviation: scale * self.noise * variance.sqrt() })
    }
}

/// The smallest of the tried smoothing factors with which noise is a small share of the density, and the densities.
pub(super) fn chosen(smoothing: &Smoothing, nodes: &[(usize, f64)]) -> (usize, Vec<Option<Density>>) {
    let most = (smoothing.curves.len().saturating_sub(1) / 2).clamp(*TRIED.start(), *TRIED.end());
    for factor in *TRIED.start()..most {
        let densities = smoothing.densities(nodes, factor);
        if is_accepted(&densities) {
            return (factor, densities);
        }
    }
    (most, smoothing.densities(nodes, most))
}

fn is_accepted(densities: &[Option<Density>]) -> bool {
    let known = || densities.iter().flatten();
    let largest = known().fold(0.0, |most: f64, density| most.max(density.value.abs()));
    let squares: f64 = known().map(|density| square(density.deviation)).sum();
    (squares / known().count().max(1) as f64).sqrt() <= ACCEPTED * largest
}
