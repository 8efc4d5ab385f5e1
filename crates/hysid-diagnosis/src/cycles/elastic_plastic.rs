//! Yield point and ductility of a backbone: the equivalent energy elastic-plastic (EEEP) curve of ASTM E2126.
//!
//! ```text
//! K_e = 0.4 P_peak / Δ_e                         Δ_e: input where the backbone first reaches 0.4 P_peak
//! Δ_u = input where it falls to 0.8 P_peak, or its last point
//! P_y = K_e (Δ_u - √(Δ_u² - 2 A/K_e))            A: area under the backbone up to Δ_u
//! Δ_y = P_y / K_e,    μ = Δ_u / Δ_y
//! ```
//!
//! The straight lines to the yield point and on to `Δ_u` have the area of the backbone. If no such lines exist, `P_y` is
//! 0.85 `P_peak`, as the standard allows.

use super::backbone::{BackbonePoint, Direction};
use super::record_figure::{RecordFigure, record_figures};
use hysid_core::elementary::square;

/// Share of the peak output at which the elastic stiffness is read.
const ELASTIC: f64 = 0.4;

/// Share of the peak output at which a member has failed.
const FAILED: f64 = 0.8;

/// Share of the peak output that replaces a yield output that equal energy does not give.
const WITHOUT_EQUAL_ENERGY: f64 = 0.85;

record_figures! {
    STIFFNESS: "elastic_stiffness", "elastic stiffness", "K_e", Stiffness, "ASTM E2126";
    PEAK: "peak_output", "peak output", "P_peak", Output, "ASTM E2126";
    PEAK_INPUT: "peak_input", "input at the peak", "Δ_peak", Input, "ASTM E2126";
    YIELD: "yield_output", "yield output", "P_y", Output, "ASTM E2126";
    YIELD_INPUT: "yield_input", "yield input", "Δ_y", Input, "ASTM E2126";
    ULTIMATE: "ultimate_input", "ultimate input", "Δ_u", Input, "ASTM E2126";
    DUCTILITY: "ductility", "ductility", "μ", Ratio, "ASTM E2126";
}

const MEAN_SIDE: &str = "mean backbone";

/// The figures of both sides of the backbone of a record and of their mean. Inputs are counted from `level`.
pub(super) fn figures(record: &str, backbone: &[BackbonePoint], level: f64) -> Vec<RecordFigure> {
    let side = |direction, sign: f64| {
        let own = backbone.iter().filter(|point| point.direction == direction);
        let away = own.map(|point| (sign * (point.input - level), sign * point.output));
        std::iter::once((0.0, 0.0)).chain(away).collect::<Vec<_>>()
    };
    let (up, down) = (side(Direction::Up, 1.0), side(Direction::Down, -1.0));
    let mean = mean(&up, &down);
    let sides = [
        ("positive side", up, (1.0, level)),
        ("negative side", down, (-1.0, level)),
        (MEAN_SIDE, mean, (1.0, 0.0)),
    ];
    let of =
        |(of, points, place): &(&str, Vec<(f64, f64)>, (f64, f64))| of_side((record, of), points, *place);
    let mut all: Vec<RecordFigure> = sides.iter().flat_map(of).collect();
    let ductilities = all.iter().filter(|figure| figure.kind == DUCTILITY).map(|figure| figure.value);
    if let [Some(up), Some(down), Some(mean)] = ductilities.collect::<Vec<_>>()[..]
        && !(0.99 * up.min(down)..=1.01 * up.max(down)).contains(&mean)
        && let Some(figure) = all.pop()
    {
        // The mean ends at the end of the shorter side, and falls otherwise than both.
        let words = "no ductility: it would lie outside those of the two sides, because the mean backbone ends where the shorter side does";
        all.push(RecordFigure { value: None, ..figure }.with_note(words));
    }
    all
}

/// The yield input of the mean backbone among the figures of a record.
pub(super) fn mean_yield_input(figures: &[RecordFigure]) -> Option<f64> {
    figures.iter().find(|figure| figure.of == MEAN_SIDE && figure.kind == YIELD_INPUT)?.value
}

/// Mean of both sides at every input of a point of either, up to the end of the shorter.
fn mean(up: &[(f64, f64)], down: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let end = up[up.len() - 1].0.min(down[down.len() - 1].0);
    let mut inputs: Vec<f64> = up.iter().chain(down).map(|point| point.0).filter(|x| *x <= end).collect();
    inputs.sort_by(f64::total_cmp);
    inputs.dedup();
    inputs.into_iter().map(|x| (x, 0.5 * (output_at(up, x) + output_at(down, x)))).collect()
}

/// The output of a backbone at an input within it.
fn output_at(points: &[(f64, f64)], x: f64) -> f64 {
    let pair = points.windows(2).find(|pair| x <= pair[1].0);
    pair.map_or(points[points.len() - 1].1, |pair| {
        let ((a, p), (b, q)) = (pair[0], pair[1]);
        p + (q - p) * (x - a) / (b - a)
    })
}

/// The EEEP curve of a backbone from (0, 0) with growing inputs. `place` is the sign of the side and the input where it begins.
fn of_side(whose: (&str, &str), points: &[(f64, f64)], (sign, level): (f64, f64)) -> Vec<RecordFigure> {
    let absent = |why: &str| vec![RecordFigure::new(whose, YIELD, None).with_note(why)];
    if points.len() < 3 {
        return absent("fewer than two points of the backbone");
    }
    let last = points.len() - 1;
    let top = (1..=last).max_by(|&a, &b| points[a].1.total_cmp(&points[b].1)).unwrap_or(last);
    let (peak_input, peak) = points[top];
    if peak <= 0.0 {
        return absent("the output on this side does not have the sign of the input");
    }
    let passing = |from: usize, output: f64| {
        points[from..]
            .windows(2)
            .find(|pair| (pair[0].1 - output) * (pair[1].1 - output) <= 0.0)
            .map(|pair| pair[0].0 + (pair[1].0 - pair[0].0) * (output - pair[0].1) / (pair[1].1 - pair[0].1))
    };
    let failure = passing(top, FAILED * peak);
    let ultimate = failure.unwrap_or(points[last].0);
    let Some(elastic) = passing(0, ELASTIC * peak).filter(|x| *x > 0.0) else {
        return absent("the backbone does not rise from 0");
    };
    let stiffness = ELASTIC * peak / elastic;
    let within = points.iter().copied().filter(|point| point.0 < ultimate);
    let upto: Vec<(f64, f64)> = within.chain([(ultimate, output_at(points, ultimate))]).collect();
    let area: f64 = upto.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum();
    let beyond = square(ultimate) - 2.0 * area / stiffness;
    let strength =
        if beyond >= 0.0 { stiffness * (ultimate - beyond.sqrt()) } else { WITHOUT_EQUAL_ENERGY * peak };
    if strength <= 0.0 {
        return absent("the output changes its sign along the backbone");
    }
    // Within rounding, a straight backbone has its yield point at its end.
    let yields = strength / stiffness < ultimate * (1.0 - 1e-9);
    let of_yield = |kind, value: f64| RecordFigure::new(whose, kind, yields.then_some(value));
    let mut yielded = of_yield(YIELD, sign * strength);
    if !yields {
        yielded = yielded.with_note("the backbone does not yield up to its end");
    } else if beyond < 0.0 {
        yielded =
            yielded.with_note("no elastic-plastic curve has the energy of the backbone: 0.85 of the peak");
    }
    let mut end = RecordFigure::new(whose, ULTIMATE, level + sign * ultimate);
    if failure.is_none() {
        end = end.with_note("the output does not fall to 0.8 of its peak: the last point of the backbone");
    }
    vec![
        RecordFigure::new(whose, STIFFNESS, stiffness),
        RecordFigure::new(whose, PEAK, sign * peak),
        RecordFigure::new(whose, PEAK_INPUT, level + sign * peak_input),
        yielded,
        of_yield(YIELD_INPUT, level + sign * strength / stiffness),
        end,
        of_yield(DUCTILITY, ultimate * stiffness / strength),
    ]
}
