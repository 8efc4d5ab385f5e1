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
use crate::subject::{File, Subject};
use crate::target::printer::{Binding, Language, Printer, Syntax, rows_of_numbers};
use crate::target::{BackEnd, Written};

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "python",
    has_single_precision: false,
    has_inverse: false,
    reserved: &[reserved::PYTHON],
    write,
    usage,
};

fn write(subject: &Subject<'_>) -> Result<Written, Error> {
    let name = subject.name();
    Ok(vec![
        File::new(format!("{name}.py"), module(subject)),
        File::new(format!("{name}_test.py"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let columns = whole_record(subject).join(", ");
    let arguments = subject.argument_names().join(", ");
    format!(
        "```python
import {name}

y = {name}.Model().simulate({columns})  # a whole record, as arrays

model = {name}.Model()                  # or step by step
y = model.step({arguments})
y, slope = model.trial_tangent({arguments})
model.commit()
```

Trials begin at the committed state as often as they are asked for; `commit` accepts the last one. `python
{name}_test.py` runs the test vectors.
"
    )
}

/// The parameters of `simulate`.
fn whole_record(subject: &Subject<'_>) -> Vec<&'static str> {
    let of = |argument: &Argument| match argument {
        Argument::Input(0) => Some("x"),
        Argument::Input(_) => None,
        Argument::TimeStep => Some("time"),
        Argument::Rate => Some("rate"),
    };
    subject.description().arguments.iter().filter_map(of).collect()
}

fn module(subject: &Subject<'_>) -> String {
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
const FUNCTIONS: &str = "
def _quotient(a, b):
    if b != 0.0:
        return a / b
    if a == 0.0 or a != a or b != b:
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def _exp(a):
    return math.exp(a) if a < 709.0 else float(np.exp(min(a, 710.0)))


def _expm1(a):
    return math.expm1(a) if a < 709.0 else _exp(a)


def _log(a):
    return math.log(a) if a > 0.0 else (-math.inf if a == 0.0 else math.nan)


def _log1p(a):
    return math.log1p(a) if a > -1.0 else (-math.inf if a == -1.0 else math.nan)


def _sqrt(a):
    return math.sqrt(a) if a >= 0.0 else math.nan


def _power(a, b):
    try:
        return math.pow(a, b)
    except OverflowError:
        return math.inf
    except ValueError:
        return math.inf if a == 0.0 else math.nan


def _ceil(a):
    return float(math.ceil(a)) if math.isfinite(a) else a


def _power_of_two(a):
    return math.ldexp(1.0, int(a))


def _hypot(a, b):
    return float(np.hypot(a, b))  # That of the C library; math.hypot rounds in another way.


def _asinh(a):
    inverse = _quotient(1.0, abs(a))
    root = _hypot(1.0, inverse) + inverse
    return math.copysign(math.log1p(abs(a) + abs(a) / root), a)


";

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

fn class(subject: &Subject<'_>) -> String {
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
    format!(
        "class Model:
    \"\"\"One instance of the model, with a committed state and a trial state.\"\"\"

    def __init__(self):
        self.reset()

    def reset(self):
        \"\"\"Go to the initial state.\"\"\"
        self._committed = [list(values) for values in _INITIAL_STATE]
        self._trial = None

    def trial(self{parameters}):
        \"\"\"Give the output at a new input, from the committed state, which stays as it is.\"\"\"
        self._trial = [values.copy() for values in self._committed]
        return _advance(self._trial{arguments})

    def trial_tangent(self{parameters}):
        \"\"\"Give the same, and the slope of the output by x; at a kink that of the branch taken.\"\"\"
        self._trial = [values.copy() for values in self._committed]
        return _advance_with_tangent(self._trial{arguments})

    def commit(self):
        \"\"\"Make the state of the last trial the committed one. Without a trial, nothing changes.\"\"\"
        if self._trial is not None:
            self._committed, self._trial = self._trial, None

    def revert(self):
        \"\"\"Forget the last trial.\"\"\"
        self._trial = None

    def step(self{parameters}):
        \"\"\"Give the output of a trial that is committed at once.\"\"\"
        self._trial = None
        return _advance(self._committed{arguments})

    def save(self):
        \"\"\"Give the committed state as bytes.\"\"\"
        state = struct.pack(\"<{numbers}d\", *(value for values in self._committed for value in values))
        return state + struct.pack(\"<II\", _TOKEN, zlib.crc32(state))

    def restore(self, state):
        \"\"\"Go back to a saved state of this model; other bytes raise a ValueError.\"\"\"
        state, tail = state[:-8], state[-8:]
        if len(state) != 8 * {numbers} or tail != struct.pack(\"<II\", _TOKEN, zlib.crc32(state)):
            raise ValueError(\"the state is damaged or that of another model\")
        numbers = iter(struct.unpack(\"<{numbers}d\", state))
        self._committed = [[next(numbers) for _ in values] for values in _INITIAL_STATE]
        self._trial = None

{half_width}    def simulate(self{names}):
        \"\"\"Give the outputs over a whole record, from the initial state.\"\"\"
        self.reset()
{prepared}        return np.array([self.step({row}) for row in range(len(x))])
"
    )
}

fn self_test(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let count = subject.argument_names().len();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = 0.5 * (high - low);
    format!(
        "\"\"\"Compares {name}.py with the test vectors. Exit status 0 if all agree.\"\"\"

import csv
import pathlib
import sys

import {name}

SCALE = {scale:?}

model = {name}.Model()
saved = model.save()
differences = []
path = pathlib.Path(__file__).with_name(\"test_vectors.csv\")
with path.open(newline=\"\") as file:
    for action, *numbers in list(csv.reader(file))[1:]:
        if action in (\"step\", \"trial\"):
            arguments = [float(number) for number in numbers[:{count}]]
            expected = float(numbers[{count}])
            if action == \"step\":
                differences.append(abs(model.step(*arguments) - expected) / SCALE)
            else:
                slope = float(numbers[{count} + 1])
                output, tangent = model.trial_tangent(*arguments)
                differences.append(abs(output - expected) / SCALE)
                differences.append(abs(tangent - slope) / (SCALE + abs(slope)))
                differences.append(abs(model.trial(*arguments) - expected) / SCALE)
        elif action == \"save\":
            saved = model.save()
        elif action == \"restore\":
            model.restore(saved)
        else:
            getattr(model, action)()

# One that is not a number is the largest.
largest = max(differences, key=lambda difference: (difference != difference, difference))
different = sum(difference != 0.0 for difference in differences)
print(f\"{{different}} of {{len(differences)}} numbers differ, by at most {{largest:.1e}} of half the trained range\")
sys.exit(0 if largest <= 1e-9 else 1)
"
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
