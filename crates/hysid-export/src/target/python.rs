//! Python: one module that needs NumPy only, and a program that tests it.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::description::{Argument, HALF_WIDTH};
use crate::error::Error;
use crate::manifest::token_of;
use crate::program::expression::{Binary, Unary};
use crate::program::unused::used_arrays;
use crate::program::{Array, Declaration, Program, Storage};
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::printer::{Binding, Language, Printer, Syntax, rows_of_numbers};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles};

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "python",
    has_single_precision: false,
    has_inverse: false,
    reserved: &[reserved::PYTHON],
    write,
    usage,
};

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let name = subject.name();
    Ok(vec![
        ExportFile::new(format!("{name}.py"), module(subject)),
        ExportFile::new(format!("{name}_test.py"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let columns = whole_record(subject).join(", ");
    let arguments = subject.argument_names().join(", ");
    filled(
        include_str!("python/usage.md.txt"),
        &[("NAME", name), ("@columns@", &columns), ("@arguments@", &arguments)],
    )
}

/// The parameters of `simulate`.
fn whole_record(subject: &ExportSubject<'_>) -> Vec<&'static str> {
    let of = |argument: &Argument| match argument {
        Argument::Input(0) => Some("x"),
        Argument::Input(_) => None,
        Argument::TimeStep => Some("time"),
        Argument::Rate => Some("rate"),
    };
    subject.description().arguments.iter().filter_map(of).collect()
}

fn module(subject: &ExportSubject<'_>) -> String {
    let python = Python { arguments: subject.argument_names() };
    let (step, tangent) = (subject.program(), subject.tangent());
    let facts: String =
        subject.facts().iter().map(|(fact, text)| format!("{fact}: {}\n", text.replace('"', "'"))).collect();
    let mut text = format!(
        "\"\"\"A model of hysteresis, written by Hysid.

{facts}
Values are in the units of the columns above. Inputs must be finite.
\"\"\"

import math
import struct
import zlib

import numpy as np

{FUNCTIONS}"
    );
    let head = text.len();
    text += &constants(&python, &[step, tangent]);
    let states: Vec<String> =
        tangent.states().map(|(_, _, values)| format!("({})", listed(&python, values))).collect();
    let _ = writeln!(text, "_INITIAL_STATE = (\n    {},\n)\n\n", states.join(",\n    "));
    text += &function(&python, step, "_advance", false);
    text += &function(&python, tangent, "_advance_with_tangent", true);
    let _ = writeln!(
        text,
        "# Tells saved states of this model from those of others.\n_TOKEN = {}\n\n",
        token_of(&text[head..])
    );
    text += &class(subject);
    text
}

/// Functions that raise no exception where a C program gives an infinite number.
const FUNCTIONS: &str = include_str!("python/functions.py.txt");

fn constants(python: &Python, programs: &[&Program]) -> String {
    let used: BTreeSet<Array> = programs.iter().flat_map(|program| used_arrays(program)).collect();
    let mut text = String::new();
    for array in used {
        let declaration = programs[programs.len() - 1].declaration(array);
        if let Storage::Constant(values) = &declaration.storage {
            let rows = rows_of_numbers(python, values, "    ");
            let _ = writeln!(text, "{} = (\n{rows},\n)", python.array(declaration));
        }
    }
    text
}

fn listed(python: &Python, values: &[f64]) -> String {
    values.iter().map(|value| python.number(*value) + ",").collect::<Vec<_>>().join(" ")
}

fn function(python: &Python, program: &Program, name: &str, with_tangent: bool) -> String {
    let arguments: String = python.arguments.iter().map(|argument| format!(", {argument}")).collect();
    let mut text = format!("def {name}(state{arguments}):\n");
    let states: Vec<String> =
        program.states().map(|(array, _, _)| python.array(program.declaration(array))).collect();
    let finite = python
        .arguments
        .iter()
        .map(|name| format!("math.isfinite({name})"))
        .collect::<Vec<_>>()
        .join(" and ");
    let none = if with_tangent { "math.nan, math.nan" } else { "math.nan" };
    let _ = writeln!(text, "    if not ({finite}):\n        return {none}  # Nothing changes then.");
    let _ = writeln!(text, "    {} = state", states.join(", ") + ",");
    for array in used_arrays(program) {
        let declaration = program.declaration(array);
        if let Storage::Scratch(length) | Storage::Output(length) = declaration.storage {
            let _ = writeln!(text, "    {} = [0.0] * {length}", python.array(declaration));
        }
    }
    text += &Printer::new(python, program).body(1);
    let output = python.array(program.declaration(program.outputs));
    let last = program.declaration(program.outputs).storage.len() - 1;
    let tangent = if with_tangent { format!(", {output}[{last}]") } else { String::new() };
    let _ = writeln!(text, "    return {output}[0]{tangent}\n\n");
    text
}

fn class(subject: &ExportSubject<'_>) -> String {
    let parameters: String = subject.argument_names().iter().map(|name| format!(", {name}")).collect();
    let arguments = subject
        .argument_names()
        .iter()
        .map(|name| format!("float({name})"))
        .map(|text| format!(", {text}"))
        .collect::<String>();
    let numbers = subject.program().state_len();
    let columns = whole_record(subject);
    let names: String = columns.iter().map(|name| format!(", {name}")).collect();
    let inputs =
        subject.description().arguments.iter().filter(|argument| matches!(argument, Argument::Input(_)));
    let inputs = inputs.count();
    let mut row = match inputs {
        1 => "x[row]".to_string(),
        _ => "*x[row]".to_string(),
    };
    let mut prepared = match inputs {
        1 => "        x = np.asarray(x, dtype=float).tolist()\n".to_string(),
        _ => "        x = np.asarray(x, dtype=float).tolist()  # a row for each sample, a column for each input\n"
            .to_string(),
    };
    if columns.contains(&"time") {
        prepared += "        time = np.asarray(time, dtype=float)\n        time_step = np.diff(time, prepend=time[:1]).tolist()\n";
        row += ", time_step[row]";
    }
    if columns.contains(&"rate") {
        prepared += "        rate = np.asarray(rate, dtype=float).tolist()\n";
        row += ", rate[row]";
    }
    let half_width = match subject.half_width() {
        None => String::new(),
        Some(_) => {
            let mut states = subject.program().states();
            let array = states.position(|(_, name, _)| name == HALF_WIDTH).unwrap_or_default();
            format!(
                "    def half_width(self):
        \"\"\"Give half the width of the prediction band at the last trial or step.\"\"\"
        state = self._committed if self._trial is None else self._trial
        return state[{array}][0]

"
            )
        }
    };
    filled(
        include_str!("python/class.py.txt"),
        &[
            ("@parameters@", &parameters),
            ("@arguments@", &arguments),
            ("@numbers@", &numbers.to_string()),
            ("@half_width@", &half_width),
            ("@names@", &names),
            ("@prepared@", &prepared),
            ("@row@", &row),
        ],
    )
}

fn self_test(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let count = subject.argument_names().len();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = 0.5 * (high - low);
    filled(
        include_str!("python/test.py.txt"),
        &[("NAME", name), ("@scale@", &format!("{scale:?}")), ("@count@", &count.to_string())],
    )
}

struct Python {
    arguments: Vec<String>,
}

impl Python {
    /// The name of an array, apart from keywords and variables.
    fn array(&self, declaration: &Declaration) -> String {
        let kind = match declaration.storage {
            Storage::Constant(_) => "_",
            Storage::State(_) => "s_",
            _ => "w_",
        };
        format!("{kind}{}", declaration.name)
    }
}

impl Language for Python {
    const SYNTAX: Syntax = Syntax {
        choice: |condition, yes, no| (format!("{yes} if {condition} else {no}"), Binding::Choice),
        logic: ["and", "or", "not "],
        to_whole: |real| format!("int({real})"),
        to_real: |whole| format!("float({whole})"),
        declare: |variable, value, _| format!("{variable} = {value}"),
        declare_whole: |variable, value| format!("{variable} = {value}"),
        assign: |to, value| format!("{to} = {value}"),
        remark: |text| format!("# {text}"),
        each: |variable, first, last| format!("for {variable} in range({first}, {last}):"),
        while_true: |condition| format!("while {condition}:"),
        when: |condition| format!("if {condition}:"),
        otherwise: "else:",
        end: None,
    };

    fn number(&self, value: f64) -> String {
        match value.is_infinite() {
            true => if value < 0.0 { "-math.inf" } else { "math.inf" }.to_string(),
            false => format!("{value:?}"),
        }
    }

    fn element(&self, declaration: &Declaration, index: &str) -> String {
        match declaration.storage {
            Storage::Argument(_) => index.parse::<usize>().map_or_else(
                |_| format!("({})[{index}]", self.arguments.join(", ")),
                |index| self.arguments[index].clone(),
            ),
            _ => format!("{}[{index}]", self.array(declaration)),
        }
    }

    fn unary(&self, function: Unary) -> Option<&'static str> {
        Some(match function {
            Unary::Negative => return None,
            Unary::Detached => "",
            Unary::Magnitude => "abs",
            Unary::SquareRoot => "_sqrt",
            Unary::Exp => "_exp",
            Unary::ExpMinusOne => "_expm1",
            Unary::Ln => "_log",
            Unary::LnOnePlus => "_log1p",
            Unary::Tanh => "math.tanh",
            Unary::InverseSinh => "_asinh",
            Unary::Ceiling => "_ceil",
            Unary::PowerOfTwo => "_power_of_two",
        })
    }

    fn binary(&self, function: Binary) -> Option<&'static str> {
        match function {
            Binary::Sum | Binary::Difference | Binary::Product => None,
            Binary::Quotient => Some("_quotient"),
            Binary::Power => Some("_power"),
            Binary::CopySign => Some("math.copysign"),
            Binary::Hypotenuse => Some("_hypot"),
        }
    }
}
