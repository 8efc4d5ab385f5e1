//! Test vectors of an inverse.

use hysid_core::elementary::{cos, sin};
use hysid_core::model::{Inverse, Inverted, Model};

use crate::description::Argument;
use crate::vectors::{Action, of_both_precisions, within};

/// Rows of the path, and the fewest of a model whose steps need much work.
const ROWS: usize = 200;
const FEWEST_ROWS: usize = 20;

/// Operations that the vectors may need, about a second, if a row needs [`STEPS`] steps of the model.
const MOST_WORK: f64 = 1e9;
const STEPS: f64 = 20.0;

/// The state is saved before this row, and restored after [`REPEATED`] further ones, which are then repeated.
const SAVED: usize = 90;
const REPEATED: usize = 20;

/// Call to an inverse: reset, step, save or restore.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct InverseVector {
    pub action: Action,
    /// The wanted output and the further arguments of a step; otherwise empty.
    pub arguments: Vec<f64>,
    pub given: Option<Inverted>,
}

/// Vectors of an inverse in the initial state. `arguments` are those behind the wanted output.
pub(super) fn vectors(model: &Model, initial: Inverse<'_>, arguments: &[Argument]) -> Vec<InverseVector> {
    let mut now = (initial.clone(), 0.0);
    let mut saved = now.clone();
    let mut all = Vec::new();
    let mut act = |action: Action, row: usize| {
        let mut vector = InverseVector { action, arguments: Vec::new(), given: None };
        match action {
            Action::Step => {
                let (inverse, time) = &mut now;
                let row = VectorRow::of(model, row);
                *time += row.time_step;
                // Bounds were checked, and rows are finite.
                vector.given = inverse.step(row.wanted, &row.others, *time).ok();
                vector.arguments = vec![row.wanted];
                vector.arguments.extend(arguments.iter().map(|argument| row.value(*argument)));
            }
            Action::Save => saved = now.clone(),
            Action::Restore => now = saved.clone(),
            _ => now = (initial.clone(), 0.0),
        }
        all.push(vector);
    };
    let (low, high) = model.trained_ranges().inputs[0];
    let work = STEPS * model.work_of_row(high - low, VectorRow::of(model, 0).time_step);
    let rows = ((MOST_WORK / work) as usize).clamp(FEWEST_ROWS, ROWS);
    let (saved, repeated) = (SAVED * rows / ROWS, REPEATED * rows / ROWS);
    act(Action::Reset, 0);
    for row in 0..rows {
        if row == saved {
            act(Action::Save, 0);
        }
        if row == saved + repeated {
            act(Action::Restore, 0);
            (saved..saved + repeated).for_each(|row| act(Action::Step, row));
        }
        act(Action::Step, row);
    }
    act(Action::Reset, 0);
    act(Action::Step, 0);
    all
}

/// A row of a path through the trained range of the output and a little beyond.
struct VectorRow {
    wanted: f64,
    others: Vec<f64>,
    time_step: f64,
}

impl VectorRow {
    fn of(model: &Model, row: usize) -> Self {
        let ranges = model.trained_ranges();
        let t = row as f64;
        let wave = 1.05 * (sin(0.23 * t) * (0.6 + 0.4 * cos(0.031 * t)) + 0.1 * sin(1.9 * t));
        let other = |(input, range): (usize, &(f64, f64))| {
            of_both_precisions(within(*range, sin(0.11 * t + input as f64)))
        };
        Self {
            wanted: of_both_precisions(within(ranges.output, wave)),
            others: ranges.inputs.iter().enumerate().skip(1).map(other).collect(),
            // Sums and differences of such times are exact.
            time_step: (10 + (row * 7919) % 13) as f64 / 1024.0,
        }
    }

    fn value(&self, argument: Argument) -> f64 {
        match argument {
            Argument::Input(input) => self.others[input - 1],
            _ => self.time_step,
        }
    }
}
