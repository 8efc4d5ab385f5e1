//! Test vectors: what is done with a model, and what it must give.

use hysid_core::elementary::{cos, sin};

use crate::description::{Argument, Description};
use crate::program::Program;
use crate::program::interpreter::Machine;

/// Rows of the path, and the fewest of a model whose steps need so much work that all would take seconds.
const ROWS: usize = 300;
const FEWEST_ROWS: usize = 30;

/// Operations with real numbers that the vectors of a model may need, about a second of the interpreter; with
/// [`FEWEST_ROWS`] it may be more.
const MOST_OPERATIONS: u64 = 40_000_000;

/// Rows whose steps show the work of all.
const TRIED: usize = 5;

/// The state is saved before this row, and restored after [`REPEATED`] further ones, which are then repeated.
const SAVED: usize = 120;
const REPEATED: usize = 25;

/// Call to a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// To the initial state.
    Reset,
    /// A trial step with tangent, from the committed state.
    Trial,
    /// The last trial becomes the committed state.
    Commit,
    /// The last trial is forgotten.
    Revert,
    /// A step that is committed at once.
    Step,
    /// The committed state is saved.
    Save,
    /// The saved state becomes the committed one.
    Restore,
}

impl Action {
    /// Its name in files of test vectors.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reset => "reset",
            Self::Trial => "trial",
            Self::Commit => "commit",
            Self::Revert => "revert",
            Self::Step => "step",
            Self::Save => "save",
            Self::Restore => "restore",
        }
    }
}

/// One action with its arguments and what it gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Vector {
    /// Call that is made.
    pub action: Action,
    /// Arguments of a trial or a step, in their order; otherwise empty.
    pub arguments: Vec<f64>,
    /// Output of a trial or a step, otherwise 0.
    pub output: f64,
    /// Tangent of a trial, otherwise 0.
    pub tangent: f64,
}

/// Vectors for a model whose inputs and rate have these trained ranges. `tangent` is its program with the tangent.
pub fn vectors(
    description: &Description,
    tangent: &Program,
    inputs: &[(f64, f64)],
    rate: f64,
) -> Vec<Vector> {
    let mut machine = Machine::new(tangent);
    let mut committed = machine.state();
    let initial = committed.clone();
    let mut saved = initial.clone();
    let mut trial = committed.clone();
    let mut all = Vec::new();
    let mut act = |action: Action, arguments: Vec<f64>| {
        let (mut output, mut slope) = (0.0, 0.0);
        match action {
            Action::Trial | Action::Step => {
                machine.set_state(&committed);
                let outputs = machine.step(&arguments);
                (output, slope) = (outputs[0], outputs[1]);
                trial = machine.state();
                if action == Action::Step {
                    (committed, slope) = (trial.clone(), 0.0);
                }
            }
            Action::Commit => committed = trial.clone(),
            Action::Revert => {}
            Action::Save => saved = committed.clone(),
            Action::Restore => committed = saved.clone(),
            Action::Reset => committed = initial.clone(),
        }
        all.push(Vector { action, arguments, output, tangent: slope });
    };
    let path = VectorPath { arguments: &description.arguments, inputs, rate };
    let rows = rows_of(tangent, &path);
    let (saved, repeated) = (SAVED * rows / ROWS, REPEATED * rows / ROWS);
    act(Action::Reset, Vec::new());
    for row in 0..rows {
        if row == saved {
            act(Action::Save, Vec::new());
        }
        if row == saved + repeated {
            act(Action::Restore, Vec::new());
            for row in saved..saved + repeated {
                act(Action::Step, path.row(row, 0.0));
            }
        }
        match row % 5 {
            // An iteration of a solver: two trials that are left, and one that is taken.
            0 => {
                act(Action::Trial, path.row(row, 0.3));
                act(Action::Trial, path.row(row, -0.2));
                act(Action::Revert, Vec::new());
                act(Action::Trial, path.row(row, 0.0));
                act(Action::Commit, Vec::new());
            }
            _ => act(Action::Step, path.row(row, 0.0)),
        }
    }
    act(Action::Reset, Vec::new());
    act(Action::Step, path.row(0, 0.0));
    all
}

/// Rows of the path: fewer where steps need much work.
fn rows_of(tangent: &Program, path: &VectorPath<'_>) -> usize {
    let mut machine = Machine::new(tangent);
    for row in 0..TRIED {
        machine.step(&path.row(row, 0.0));
    }
    // A row is two steps, on average.
    let of_row = 2 * machine.operations() / TRIED as u64;
    ((MOST_OPERATIONS / of_row.max(1)) as usize).clamp(FEWEST_ROWS, ROWS)
}

/// A path through the trained ranges and a little beyond.
struct VectorPath<'a> {
    arguments: &'a [Argument],
    inputs: &'a [(f64, f64)],
    rate: f64,
}

impl VectorPath<'_> {
    /// Arguments of a row; the first input is displaced by this share of half its range.
    fn row(&self, row: usize, displaced: f64) -> Vec<f64> {
        let t = row as f64;
        let wave = 1.05 * (sin(0.23 * t) * (0.6 + 0.4 * cos(0.031 * t)) + 0.15 * sin(1.9 * t));
        let value = |argument: &Argument| match *argument {
            Argument::Input(0) => within(self.inputs[0], wave + displaced),
            Argument::Input(input) => within(self.inputs[input], sin(0.11 * t + input as f64)),
            Argument::TimeStep => 0.01 * (1.0 + 0.5 * sin(0.7 * t)),
            Argument::Rate => self.rate * cos(0.37 * t),
        };
        self.arguments.iter().map(|argument| of_both_precisions(value(argument))).collect()
    }
}

/// The nearest number that single precision has too, where it has one.
pub(crate) fn of_both_precisions(value: f64) -> f64 {
    let single = value as f32;
    if single.is_normal() { f64::from(single) } else { value }
}

pub(crate) fn within((low, high): (f64, f64), place: f64) -> f64 {
    0.5 * (low + high) + 0.5 * (high - low) * place
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::expression::Real;
    use crate::program::{Builder, Precision};

    #[test]
    fn numbers_beyond_single_precision_stay() {
        assert_eq!(of_both_precisions(0.1), f64::from(0.1f32));
        for value in [0.0, -1e99, 1e-60, 3e-42] {
            assert_eq!(of_both_precisions(value), value);
        }
    }

    /// A program with this number of sums in a step.
    fn of_sums(count: f64) -> Program {
        let mut builder = Builder::new(1, 2, Precision::Double);
        let sums = builder.variable(0.0);
        builder.while_true(Real::from(sums).below(count), |builder| {
            builder.assign(sums, Real::from(sums) + 1.0);
        });
        builder.output(0, sums);
        builder.output(1, 0.0);
        builder.finish()
    }

    #[test]
    fn a_model_whose_steps_need_much_work_has_fewer_vectors() {
        let count = |sums: f64| {
            let description = Description { program: of_sums(sums), arguments: vec![Argument::Input(0)] };
            let all = vectors(&description, &description.program, &[(-1.0, 1.0)], 0.0);
            let count = |action: Action| all.iter().filter(|vector| vector.action == action).count();
            assert_eq!((count(Action::Save), count(Action::Restore)), (1, 1));
            count(Action::Step)
        };
        assert_eq!(count(100.0), 4 * ROWS / 5 + REPEATED + 1);
        assert!((100..250).contains(&count(1e5)), "{}", count(1e5));
        assert!((FEWEST_ROWS / 2..=FEWEST_ROWS).contains(&count(1e6)), "{}", count(1e6));
    }
}
