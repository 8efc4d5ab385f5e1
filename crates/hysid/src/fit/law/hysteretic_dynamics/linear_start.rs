//! The linear system that a search begins with: modes one after the other, each the best of a grid of frequencies and
//! damping ratios, then all together by Levenberg-Marquardt.

use rayon::prelude::*;

use super::Asked;
use super::records::Records;
use super::task::{Task, Value};
use crate::law::hysteretic_dynamics::{
    DAMPING_RATIOS, Drive, Dynamics, Form, Hold, Layout, Mode, Run, Shape,
};
use crate::linear_algebra::{Gram, Symmetric};
use crate::optimise::levenberg_marquardt::LevenbergMarquardt;
use crate::stop_check::StopCheck;

/// Rows of the grid at most, at the beginning of the records.
const ROWS_OF_GRID: usize = 6000;

/// Frequencies of the grid.
const FREQUENCIES: usize = 60;

/// Damping ratios of the grid, of an oscillator and of a state space model.
const RATIOS: [f64; 3] = [0.02, 0.1, 0.4];
const RATIOS_OF_STATE_SPACE: [f64; 5] = [0.02, 0.1, 0.4, 1.5, 6.0];

/// Highest frequency of the grid, as a share of the sampling rate.
const HIGHEST: f64 = 0.35;

/// Iterations that improve all modes together, and with which holds are compared.
const EPOCHS: usize = 25;

/// Steps in a period of the fastest mode that vibrates.
const STEPS_PER_PERIOD: f64 = 60.0;

/// An input is smooth if the variance of its fourth difference is less than this share of what it is for a random
/// sequence, `1 + 16 + 36 + 16 + 1` times the variance.
const SMOOTH: f64 = 0.02;
const OF_RANDOM_SEQUENCE: f64 = 70.0;

/// Rows at most that tell how a motion began.
const MOST_FIRST_ROWS: f64 = 1000.0;

/// A small penalty that keeps coefficients without influence at 0.
const RIDGE: f64 = 1e-10;

/// The linear system; `None` once stopped.
pub(super) fn find(records: &Records, asked: &Asked, stop: StopCheck<'_>) -> Option<Dynamics> {
    let holds: &[Hold] =
        if is_smooth(&records.drives) { &[Hold::Cubic] } else { &[Hold::Linear, Hold::Constant] };
    let rows: usize = records.drives.iter().map(|drive| drive.x.len()).sum();
    let few = records.first(ROWS_OF_GRID as f64 / rows as f64);
    let mut system = Dynamics {
        input_scale: records.input_scale,
        output_offset: records.output_mean,
        output_scale: records.output_scale,
        direct: 0.0,
        hold: holds[0],
        longest_step: f64::MAX.sqrt(),
        begins_under_input: false,
        modes: Vec::new(),
        elements: Vec::new(),
    };
    for _ in 0..asked.modes {
        system.modes.push(best_of_grid(&system, &few, records, asked, stop)?);
        system = improved(system, asked, &few, stop)?.0;
    }
    let fastest = system.modes.iter().filter(|mode| mode.damping < 1.0).map(|mode| mode.frequency);
    let fastest = fastest.fold(0.0, f64::max);
    if fastest > 0.0 {
        system.longest_step = std::f64::consts::TAU / (STEPS_PER_PERIOD * fastest);
    } else {
        system.longest_step = records.step;
    }
    let mut best: Option<(Dynamics, f64)> = None;
    for &hold in holds {
        let found = improved(Dynamics { hold, ..system.clone() }, asked, &few, stop)?;
        if best.as_ref().is_none_or(|best| found.1 < best.1) {
            best = Some(found);
        }
    }
    let at_rest = best?.0;
    let under_input = Dynamics { begins_under_input: true, ..at_rest.clone() };
    let first = records.first_rows(first_rows(&at_rest, records.step));
    let square = |dynamics: &Dynamics| Run { dynamics, drives: &first, stop }.half_square();
    let begins = if square(&under_input)? < square(&at_rest)? { under_input } else { at_rest };
    improved(begins, asked, &records.drives, stop).map(|found| found.0)
}

/// Rows of a quarter of a period, in which a motion is still as it began.
fn first_rows(system: &Dynamics, step: f64) -> usize {
    let fastest = system.modes.iter().map(|mode| mode.frequency).fold(0.0, f64::max);
    let quarter = 0.25 * std::f64::consts::TAU / (fastest * step);
    quarter.clamp(2.0, MOST_FIRST_ROWS).ceil() as usize
}

/// True if the input has next to nothing of the highest frequencies that its samples could have: the variance of its
/// fourth difference, compared with that of a random sequence.
fn is_smooth(drives: &[Drive]) -> bool {
    let (mut difference, mut square) = (0.0, 0.0);
    for drive in drives {
        let mean = drive.x.iter().sum::<f64>() / drive.x.len() as f64;
        square += drive.x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        let fourth = |x: &[f64]| x[0] - 4.0 * x[1] + 6.0 * x[2] - 4.0 * x[3] + x[4];
        difference += drive.x.windows(5).map(|x| fourth(x).powi(2)).sum::<f64>();
    }
    difference < SMOOTH * OF_RANDOM_SEQUENCE * square
}

/// The mode that lowers the error most beside those that there are.
fn best_of_grid(
    system: &Dynamics,
    drives: &[Drive],
    records: &Records,
    asked: &Asked,
    stop: StopCheck<'_>,
) -> Option<Mode> {
    let longest = drives.iter().map(|drive| drive.steps.iter().filter(|step| step.is_finite()).sum::<f64>());
    let lowest = std::f64::consts::TAU / longest.fold(records.step, f64::max);
    let highest = std::f64::consts::TAU * HIGHEST / records.step;
    let ratios: &[f64] = if asked.form == Form::Oscillator { &RATIOS } else { &RATIOS_OF_STATE_SPACE };
    let points: Vec<(f64, f64)> = (0..FREQUENCIES)
        .flat_map(|k| {
            let share = k as f64 / (FREQUENCIES - 1) as f64;
            let frequency = lowest * (highest / lowest).powf(share);
            ratios.iter().map(move |&ratio| (frequency, ratio))
        })
        .collect();
    let layout = Layout::new(asked.form, system.modes.len() + 1, 0, NO_ELEMENT);
    let of_point = |&(frequency, damping): &(f64, f64)| {
        let mut tried = system.clone();
        tried.modes.push(Mode { frequency, damping, gain: 1.0, velocity_in_output: 0.0 });
        let run = Run { dynamics: &tried, drives, stop };
        let (square, gain, velocity) = linear_part(&run.gram(&layout)?, &layout)?;
        Some((square, Mode { gain, velocity_in_output: velocity, ..tried.modes[system.modes.len()] }))
    };
    let found: Vec<(f64, Mode)> = points.par_iter().filter_map(of_point).collect();
    found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
}

const NO_ELEMENT: Shape = Shape { stops: 0, states: 0, neurons: 1, deteriorates: false };

/// The least square with the best offset, direct share, gains and velocities, from the derivatives at a gain of 1; and
/// the gain and velocity of the last mode. `None` if they are not determined.
fn linear_part(gram: &Gram, layout: &Layout) -> Option<(f64, f64, f64)> {
    let mut places = vec![0, 1];
    for mode in &layout.modes {
        places.push(mode.gain);
        places.extend(mode.velocity_in_output.clone());
    }
    let target = layout.count();
    let size = places.iter().map(|&i| gram.at(i, i)).fold(0.0, f64::max);
    let mut matrix = Symmetric::from_fn(places.len(), |i, j| gram.at(places[i], places[j]));
    (0..places.len()).for_each(|i| matrix.add_to_diagonal(i, RIDGE * size));
    let right: Vec<f64> = places.iter().map(|&place| -gram.at(target, place)).collect();
    let mut by = right.clone();
    matrix.cholesky(StopCheck::never())?.solve(&mut by);
    let fall: f64 = by.iter().zip(&right).map(|(by, right)| by * right).sum();
    let last = layout.modes.last()?;
    let of = |place: usize| places.iter().position(|&p| p == place).map_or(0.0, |i| by[i]);
    let gain = 1.0 + of(last.gain);
    // The share of the velocity multiplies a mode that has its gain already.
    let velocity = last.velocity_in_output.clone().next().map_or(0.0, |place| of(place) / gain);
    let square = gram.at(target, target) - fall;
    (square.is_finite() && gain.is_finite() && velocity.is_finite()).then_some((square, gain, velocity))
}

/// A linear system improved by Levenberg-Marquardt, with half its mean square error; `None` once stopped.
fn improved(
    system: Dynamics,
    asked: &Asked,
    drives: &[Drive],
    stop: StopCheck<'_>,
) -> Option<(Dynamics, f64)> {
    let mut system = system;
    for mode in &mut system.modes {
        mode.damping = mode.damping.clamp(DAMPING_RATIOS.0, DAMPING_RATIOS.1);
    }
    let layout = Layout::new(asked.form, system.modes.len(), 0, NO_ELEMENT);
    let task = Task::new(&layout, &system, drives, stop);
    let mut search: LevenbergMarquardt<Value> = LevenbergMarquardt::new(&task, layout.parameters(&system));
    for _ in 0..EPOCHS {
        if search.advance(&task).is_some() {
            break;
        }
    }
    let value = search.known_value()?.objective;
    value.is_finite().then(|| (layout.dynamics(search.parameters(), &system), value))
}
