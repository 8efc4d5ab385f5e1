//! MATLAB: one function file, a System object, and a function that tests the first.

use std::fmt::Write as _;

use crate::error::Error;
use crate::program::choices::without_choices;
use crate::program::expression::{Binary, Unary};
use crate::program::unused::used_arrays;
use crate::program::{Declaration, Program, Storage};
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::printer::{Binding, Language, Printer, Syntax};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles};

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "matlab",
    has_single_precision: false,
    has_inverse: false,
    reserved: &[reserved::MATLAB],
    write,
    usage,
};

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let name = subject.name();
    Ok(vec![
        ExportFile::new(format!("{name}.m"), function_file(subject)),
        ExportFile::new(format!("{name}_system.m"), system_object(subject)),
        ExportFile::new(format!("{name}_test.m"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names().join(", ");
    filled(include_str!("matlab/usage.md.txt"), &[("NAME", name), ("@arguments@", &arguments)])
}

fn function_file(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let matlab = Matlab { arguments: subject.argument_names() };
    let arguments = matlab.arguments.join(", ");
    let facts: String = subject.facts().iter().map(|(fact, text)| format!("%   {fact}: {text}\n")).collect();
    let (step, tangent) = (without_choices(subject.program()), without_choices(subject.tangent()));
    let initial: Vec<f64> = step.states().flat_map(|(_, _, values)| values.iter().copied()).collect();
    let mut text = filled(
        include_str!("matlab/function.m.txt"),
        &[
            ("NAME", name),
            ("@arguments@", &arguments),
            ("UPPER", &name.to_uppercase()),
            ("@upper_arguments@", &arguments.to_uppercase()),
            ("@facts@", &facts),
            ("@initial@", &matlab.column(&initial, "        ")),
        ],
    );
    text += &function(&matlab, &step, "advance", false);
    text += &function(&matlab, &tangent, "advance_with_tangent", true);
    text += OWN_FUNCTIONS;
    text
}

const OWN_FUNCTIONS: &str = include_str!("matlab/with_sign.m.txt");

fn function(matlab: &Matlab, program: &Program, name: &str, with_tangent: bool) -> String {
    let slope = if with_tangent { ", slope" } else { "" };
    let arguments = matlab.arguments.join(", ");
    let mut text = format!("function [y, state{slope}] = {name}(state, {arguments})\n");
    let no_slope = if with_tangent { "    slope = NaN;\n" } else { "" };
    let _ = writeln!(
        text,
        "if ~all(isfinite([{arguments}])) % Nothing changes then.\n    y = NaN;\n{no_slope}    return\nend"
    );
    let used = used_arrays(program);
    for array in &used {
        let declaration = program.declaration(*array);
        let array = matlab.array(declaration);
        let _ = match &declaration.storage {
            Storage::Constant(values) => writeln!(
                text,
                "persistent {array}\nif isempty({array})\n    {array} = {};\nend",
                matlab.column(values, "        ")
            ),
            Storage::Scratch(length) | Storage::Output(length) => {
                writeln!(text, "{array} = zeros({length}, 1);")
            }
            Storage::State(_) | Storage::Argument(_) => Ok(()),
        };
    }
    let mut position = 0;
    let mut states = Vec::new();
    for (array, _, values) in program.states() {
        let array = matlab.array(program.declaration(array));
        let _ = writeln!(text, "{array} = state({}:{});", position + 1, position + values.len());
        position += values.len();
        states.push(array);
    }
    text += &Printer::new(matlab, program).body(0);
    let _ = writeln!(text, "state = [{}];", states.join("; "));
    let output = matlab.array(program.declaration(program.outputs));
    if with_tangent {
        let _ = writeln!(text, "slope = {output}({});", program.declaration(program.outputs).storage.len());
    }
    let _ = writeln!(text, "y = {output}(1);\nend\n");
    text
}

fn system_object(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names().join(", ");
    let count = subject.argument_names().len();
    let names =
        subject.argument_names().iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    let outputs = (1..=count).map(|index| format!("name{index}")).collect::<Vec<_>>().join(", ");
    filled(
        include_str!("matlab/system.m.txt"),
        &[
            ("NAME", name),
            ("UPPER", &name.to_uppercase()),
            ("@arguments@", &arguments),
            ("@count@", &count.to_string()),
            ("@outputs@", &outputs),
            ("@names@", &names),
        ],
    )
}

fn self_test(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let count = subject.argument_names().len();
    let number = |value: f64| format!("{value:?}");
    let rows: String = subject
        .vectors()
        .iter()
        .map(|vector| {
            let mut numbers: Vec<String> = vector.arguments.iter().copied().map(number).collect();
            numbers.resize(count, "0".into());
            numbers.extend([number(vector.output), number(vector.tangent)]);
            // Actions are numbered in their order.
            format!("    {}, {}\n", vector.action as usize + 1, numbers.join(", "))
        })
        .collect();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = 0.5 * (high - low);
    let given: String = (0..count).map(|index| format!(", v({})", index + 2)).collect();
    filled(
        include_str!("matlab/test.m.txt"),
        &[
            ("NAME", name),
            ("UPPER", &name.to_uppercase()),
            ("@rows@", &rows),
            ("@scale@", &format!("{scale:?}")),
            ("@given@", &given),
            ("@output@", &(count + 2).to_string()),
            ("@tangent@", &(count + 3).to_string()),
        ],
    )
}

struct Matlab {
    arguments: Vec<String>,
}

impl Matlab {
    /// The name of an array, apart from keywords and functions.
    fn array(&self, declaration: &Declaration) -> String {
        let kind = match declaration.storage {
            Storage::Constant(_) => "c",
            Storage::State(_) => "s",
            _ => "w",
        };
        format!("{kind}_{}", declaration.name)
    }

    fn column(&self, values: &[f64], indent: &str) -> String {
        const IN_A_LINE: usize = 4;
        let numbers: Vec<String> = values.iter().map(|value| self.number(*value)).collect();
        let lines: Vec<String> =
            numbers.chunks(IN_A_LINE).map(|line| format!("{indent}{}", line.join("; "))).collect();
        format!("[\n{}]", lines.join(";\n"))
    }
}

impl Language for Matlab {
    const SYNTAX: Syntax = Syntax {
        // Not written: programs for MATLAB have no choices in expressions.
        choice: |condition, yes, no| (format!("choose({condition}, {yes}, {no})"), Binding::Atom),
        logic: ["&&", "||", "~"],
        to_whole: |real| format!("fix({real})"),
        to_real: |whole| whole.to_string(),
        declare: |variable, value, _| format!("{variable} = {value};"),
        declare_whole: |variable, value| format!("{variable} = {value};"),
        assign: |to, value| format!("{to} = {value};"),
        remark: |text| format!("% {text}"),
        each: |variable, first, last| format!("for {variable} = {first}:{last} - 1"),
        while_true: |condition| format!("while {condition}"),
        when: |condition| format!("if {condition}"),
        otherwise: "else",
        end: Some("end"),
    };

    fn number(&self, value: f64) -> String {
        match value.is_infinite() {
            true => if value < 0.0 { "-Inf" } else { "Inf" }.to_string(),
            false => format!("{value:?}"),
        }
    }

    fn element(&self, declaration: &Declaration, index: &str) -> String {
        let constant = index.parse::<usize>();
        match (&declaration.storage, constant) {
            (Storage::Argument(_), Ok(index)) => self.arguments[index].clone(),
            (_, Ok(index)) => format!("{}({})", self.array(declaration), index + 1),
            (_, Err(_)) => format!("{}({index} + 1)", self.array(declaration)),
        }
    }

    fn unary(&self, function: Unary) -> Option<&'static str> {
        Some(match function {
            Unary::Negative => return None,
            Unary::Detached => "",
            Unary::Magnitude => "abs",
            Unary::SquareRoot => "sqrt",
            Unary::Exp => "exp",
            Unary::ExpMinusOne => "expm1",
            Unary::Ln => "log",
            Unary::LnOnePlus => "log1p",
            Unary::Tanh => "tanh",
            Unary::InverseSinh => "asinh",
            Unary::Ceiling => "ceil",
            Unary::PowerOfTwo => "pow2",
        })
    }

    fn binary(&self, function: Binary) -> Option<&'static str> {
        match function {
            Binary::Sum | Binary::Difference | Binary::Product | Binary::Quotient => None,
            Binary::Power => Some("power"),
            Binary::CopySign => Some("with_sign"),
            Binary::Hypotenuse => Some("hypot"),
        }
    }
}
