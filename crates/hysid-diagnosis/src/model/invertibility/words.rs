//! The verdict on invertibility in words.

use hysid_core::data::record::ColumnNames;
use hysid_core::data::unit;
use hysid_core::significant::Significant;

use super::{Invertibility, NonMonotonePlace, OutputDirection, PlaceKind};
use crate::Verdict;

/// Numbers with the units of the columns.
pub(super) struct Words {
    input: String,
    output: String,
    time: String,
}

impl Words {
    pub fn of(names: &ColumnNames) -> Self {
        let suffix = |name: &str| unit::suffix(unit::of_column(name).as_deref());
        Self {
            input: suffix(&names.inputs[0]),
            output: suffix(&names.output),
            time: names.time.as_deref().map_or_else(String::new, suffix),
        }
    }

    fn outputs(&self, outputs: (f64, f64)) -> String {
        format!("{}{}", span(outputs), self.output)
    }

    fn inputs(&self, inputs: (f64, f64)) -> String {
        format!("{}{}", span(inputs), self.input)
    }

    pub fn statement(&self, found: &Invertibility) -> String {
        let tried = found.time_steps.first().map(|at| at.time_step);
        let goes = match found.direction {
            OutputDirection::Rising => "rises",
            OutputDirection::Falling => "falls",
        };
        let steps = found.shortest_time_step.map(|shortest| {
            let time = format!("{:.3}{}", Significant(shortest), self.time);
            match tried {
                Some(tried) if shortest <= tried => format!("at time steps from {time}, the shortest tried"),
                _ => format!("at time steps of {time} or longer"),
            }
        });
        let mut statement = match (&found.worst, steps) {
            (Some(worst), None) => {
                let longest =
                    found.time_steps.last().filter(|longest| Some(longest.time_step) != worst.time_step);
                let longest = longest.map(|longest| {
                    format!(
                        "; with the longest time step tried, {:.3}{}, by {:.2} %",
                        Significant(longest.time_step),
                        self.time,
                        Significant(100.0 * longest.index)
                    )
                });
                self.place(worst, found.direction) + &longest.unwrap_or_default()
            }
            (Some(worst), Some(steps)) => {
                let place = self.place(worst, found.direction);
                format!("{place}; {steps} it {goes} with the input after every past tried")
            }
            (None, steps) => {
                let steps = steps.map_or_else(String::new, |steps| format!(" {steps}"));
                format!("after each of {} pasts the output {goes} with the input{steps}", found.pasts)
            }
        };
        let step = if tried.is_some() { "in one step that is long enough" } else { "in one step" };
        let jumps = if found.jumps > 0 { ", except in jumps," } else { "" };
        statement += &match found.always {
            Some(always) => format!(
                "; outputs from {}{jumps} can be reached {step} after any past tried",
                self.outputs(always)
            ),
            None => format!("; no output can be reached {step} after every past tried"),
        };
        if let (Verdict::No, Some(unique)) = (found.finding.verdict, found.monotone_outputs) {
            statement += &format!("; those from {} belong to one input each", self.outputs(unique));
        }
        if found.flat_share > 0.0 {
            statement += &format!(
                "; over {:.2} % of the inputs tried the output does not change, so that it belongs to many inputs",
                Significant(100.0 * found.flat_share)
            );
        }
        statement
    }

    fn place(&self, worst: &NonMonotonePlace, direction: OutputDirection) -> String {
        let past = self.past(worst);
        let percent = Significant(100.0 * worst.size);
        let step = worst.time_step.map_or_else(String::new, |step| {
            format!(", with a time step of {:.3}{}", Significant(step), self.time)
        });
        match worst.kind {
            PlaceKind::Reversal => {
                let back = match direction {
                    OutputDirection::Rising => "falls",
                    OutputDirection::Falling => "rises",
                };
                format!(
                    "{past}{step}, the output {back} by {percent:.2} % of its range while the input rises from {}: an \
                     output there belongs to several inputs",
                    self.inputs(worst.inputs)
                )
            }
            PlaceKind::Jump => format!(
                "{past}{step}, the output jumps by {percent:.2} % of its range, from {}, at the input {:.4}{}: outputs \
                 between cannot be reached",
                self.outputs(worst.outputs),
                Significant(worst.inputs.0),
                self.input
            ),
        }
    }

    fn past(&self, worst: &NonMonotonePlace) -> String {
        let at = |x: f64| format!("{:.4}", Significant(x));
        match worst.turning_points.as_slice() {
            [] => "in the initial state".into(),
            turns => {
                let turns: Vec<String> = turns.iter().map(|&x| at(x)).collect();
                format!(
                    "after the input turned at {} and reached {}{}",
                    turns.join(" and "),
                    at(worst.input),
                    self.input
                )
            }
        }
    }
}

/// Both ends, with as many digits as it takes to distinguish them.
fn span((low, high): (f64, f64)) -> String {
    let with =
        |digits: usize| [low, high].map(|value| format!("{value:.digits$}", value = Significant(value)));
    let [low, high] = (4..12).map(with).find(|[low, high]| low != high).unwrap_or_else(|| with(4));
    format!("{low} to {high}")
}
