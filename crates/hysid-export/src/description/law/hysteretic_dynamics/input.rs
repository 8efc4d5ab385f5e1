//! The input of a row: into which steps the row is divided, and the input at the end of each.

use hysid_core::law::hysteretic_dynamics::{Dynamics, Hold};

use crate::description::PartInputs;
use crate::program::expression::{Real, RealVariable, Truth, Whole, WholeVariable};
use crate::program::{Array, Builder};

// Numbers of the library's solver.
const MOST_STEPS: f64 = 64.0;
const STATIC_STEPS: usize = 16;
const EQUAL: f64 = 1e-3;

/// The equal steps of a row, and the newest samples.
pub(super) struct Steps {
    pub count: WholeVariable,
    /// In the unit of time; infinite for a quasi-static change.
    pub length: RealVariable,
    hold: Hold,
    /// The scaled input where the motion is.
    reached: Array,
    /// The newest samples of the scaled input, the newest first.
    recent: Array,
    /// 1 where the newest four samples are equally far apart.
    is_even: RealVariable,
}

impl Steps {
    /// Takes the next sample of the scaled input.
    pub fn of_row(builder: &mut Builder, name: &str, law: &Dynamics, u: &Real, sample: &PartInputs) -> Self {
        let samples = if law.hold == Hold::Cubic { 4 } else { 2 };
        let steps = Self {
            count: builder.whole_variable(0_usize),
            length: builder.variable(0.0),
            hold: law.hold,
            reached: builder.state(&format!("{name}_input"), vec![0.0]),
            recent: builder.state(&format!("{name}_recent_input"), vec![0.0; samples]),
            is_even: builder.variable(0.0),
        };
        let recent_steps =
            (law.hold == Hold::Cubic).then(|| builder.state(&format!("{name}_recent_step"), vec![0.0; 2]));
        let row = builder.value(&sample.step);
        let is_long = row.equals(f64::INFINITY);
        let is_static = if law.begins_under_input { is_long.or(sample.is_first.clone()) } else { is_long };
        builder.when_else(
            is_static,
            |builder| {
                steps.add(builder, samples, u);
                if let Some(recent) = recent_steps {
                    builder.set(recent, 1_usize, recent.at(0_usize));
                    builder.set(recent, 0_usize, f64::INFINITY);
                }
                builder.assign_whole(steps.count, STATIC_STEPS);
                builder.assign(steps.length, f64::INFINITY);
            },
            |builder| {
                // Before the first sample the motion is at rest, and while no time passes nothing moves.
                let moves = row.above(0.0).and(sample.is_first.clone().negated());
                builder.when_else(
                    moves,
                    |builder| {
                        steps.add(builder, samples, u);
                        if let Some(recent) = recent_steps {
                            steps.compare(builder, recent, &row);
                        }
                        if law.hold == Hold::Constant {
                            builder.set(steps.reached, 0_usize, steps.recent.at(1_usize));
                        }
                        steps.divide(builder, law, &row);
                    },
                    |builder| {
                        builder.when(sample.is_first.clone(), |builder| {
                            builder.each(1_usize, samples, |builder, k| builder.set(steps.recent, &k, u));
                        });
                        builder.set(steps.recent, 0_usize, u);
                        builder.set(steps.reached, 0_usize, u);
                    },
                );
            },
        );
        steps
    }

    fn add(&self, builder: &mut Builder, samples: usize, u: &Real) {
        for k in (1..samples).rev() {
            builder.set(self.recent, k, self.recent.at(k - 1));
        }
        builder.set(self.recent, 0_usize, u);
    }

    /// Compares a time step with the two before.
    fn compare(&self, builder: &mut Builder, recent: Array, row: &Real) {
        let is_equal = |k: usize| (recent.at(k) - row).abs().at_most(EQUAL * row);
        let is_even = builder.value(is_equal(0).and(is_equal(1)).choose(1.0, 0.0));
        builder.assign(self.is_even, is_even);
        builder.set(recent, 1_usize, recent.at(0_usize));
        builder.set(recent, 0_usize, row);
    }

    /// The number and length of the steps of a row.
    fn divide(&self, builder: &mut Builder, law: &Dynamics, row: &Real) {
        let count = builder.value((row / law.longest_step - 1e-6).ceil());
        let count = builder.value(count.clamp(1.0, MOST_STEPS));
        builder.assign_whole(self.count, count.to_whole());
        builder.assign(self.length, row / count);
    }

    pub fn reached(&self) -> Real {
        self.reached.at(0_usize)
    }

    pub fn newest(&self) -> Real {
        self.recent.at(0_usize)
    }

    /// The scaled input at the end of a step, which is then reached.
    pub fn go(&self, builder: &mut Builder, step: &Whole) -> Real {
        let part = builder.value(step.to_real() / Whole::from(self.count).to_real());
        let [last, before] = [0, 1].map(|k: usize| self.recent.at(k));
        let on_line = &before + &part * (&last - &before);
        let input = match self.hold {
            Hold::Constant => {
                let is_static = Real::from(self.length).equals(f64::INFINITY);
                is_static.choose(on_line, before)
            }
            Hold::Linear => on_line,
            Hold::Cubic => {
                let (up, down) = (builder.value(&part + 1.0), builder.value(&part - 1.0));
                let on = builder.value(&part + 2.0);
                let [third, fourth] = [2, 3].map(|k: usize| self.recent.at(k));
                let cubic = &part * &up * &on / 6.0 * last - 0.5 * &down * &up * &on * before
                    + 0.5 * &down * &part * &on * third
                    - &down * &part * &up / 6.0 * fourth;
                self.is_cubic().choose(cubic, on_line)
            }
        };
        let input = builder.value(input);
        builder.set(self.reached, 0_usize, &input);
        input
    }

    fn is_cubic(&self) -> Truth {
        Real::from(self.is_even).above(0.0)
    }
}
