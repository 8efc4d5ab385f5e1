//! The source file: the step with and without its tangent, and the functions around it.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::description::HALF_WIDTH;
use crate::manifest::token_of;
use crate::program::expression::{Binary, Unary};
use crate::program::unused::used_arrays;
use crate::program::uses::Uses;
use crate::program::{Array, Declaration, Precision, Program, Storage};
use crate::subject::ExportSubject;
use crate::target::c::elementary;
use crate::target::printer::{Binding, Language, Printer, Syntax, rows_of_numbers};
use crate::target::template::filled;

/// Refuses options of compilers that change results, and switches off the optimisation of gcc that fuses products and sums
/// in spite of `-ffp-contract=off` (gcc 12: alternating sums and differences become one `vfmaddsub`). That line makes gcc
/// apply `-fassociative-math`, which it ignores by itself, so the options are looked at again. Clang tells of few of them,
/// but can be told to reorder nothing; `float_control` alone would let it fuse.
pub(super) const EXACT: &str = include_str!("exact.c.txt");

/// A product and a sum in one rounding.
const FUSED: &str = include_str!("fused.c.txt");

/// The text of the source file.
pub(super) fn source(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let (step, tangent) = (subject.program(), subject.tangent());
    let c = C { precision: subject.precision(), arguments: subject.argument_names() };
    let functions = Uses::of(&[step, tangent]);

    let mut text = format!("/* {name}.c: see {name}.h. */\n\n");
    let is_fused = is_fused(subject);
    if functions.infinity || is_fused || uses_math(&functions) {
        text += "#include <math.h>\n";
    }
    let elementary = elementary::functions(&functions, subject.precision());
    if is_fused || functions.unary.contains(&Unary::PowerOfTwo) || !elementary.is_empty() {
        text += "#include <stdint.h>\n";
    }
    text += &format!("#include <string.h>\n\n#include \"{name}.h\"\n\n");
    text += EXACT;
    text += &format!("typedef {name}_real real;\n\n");
    text += &elementary;
    text += &prelude(&functions, subject.precision());
    if is_fused {
        text += FUSED;
    }
    text += &constants(&c, &[step, tangent]);
    text += &initial_state(&c, name, step);
    text += &function(&c, name, step, "advance", false);
    text += &function(&c, name, tangent, "advance_with_tangent", true);
    text += &around(&c, name, token_of(&text));
    if subject.half_width().is_some() {
        text += &format!(
            "
real {name}_half_width(const {name}_model *model)
{{
    return (model->has_trial ? &model->trial : &model->committed)->{HALF_WIDTH}[0];
}}
"
        );
    }
    text
}

/// True if the code has products and sums in one rounding.
pub(super) fn is_fused(subject: &ExportSubject<'_>) -> bool {
    subject.precision() == Precision::Double && Uses::of(&[subject.program()]).fused
}

fn uses_math(functions: &Uses) -> bool {
    let own = [Unary::Negative, Unary::PowerOfTwo, Unary::Detached];
    let infix = [Binary::Sum, Binary::Difference, Binary::Product, Binary::Quotient];
    functions.unary.iter().any(|function| !own.contains(function))
        || functions.binary.iter().any(|function| !infix.contains(function))
}

/// All arrays of constants that the programs use.
fn constants(c: &C, programs: &[&Program]) -> String {
    let used: BTreeSet<Array> = programs.iter().flat_map(|program| used_arrays(program)).collect();
    let mut text = String::new();
    for array in used {
        // The last program has the arrays of those before, and more.
        let declaration = programs[programs.len() - 1].declaration(array);
        if let Storage::Constant(values) = &declaration.storage {
            let rows = rows_of_numbers(c, values, "    ");
            let _ =
                writeln!(text, "static const real {}[{}] = {{\n{rows}\n}};", declaration.name, values.len());
        }
    }
    text + "\n"
}

fn initial_state(c: &C, name: &str, program: &Program) -> String {
    let mut text = format!("static const {name}_state first_values = {{\n");
    for (_, array, values) in program.states() {
        let _ = writeln!(text, "    {{ /* {array} */\n{}\n    }},", rows_of_numbers(c, values, "        "));
    }
    text + "};\n\n"
}

/// One of the two steps, as a function that advances a state.
fn function(c: &C, name: &str, program: &Program, function: &str, with_tangent: bool) -> String {
    let parameters: String = c.arguments.iter().map(|argument| format!(", real {argument}")).collect();
    let tangent = if with_tangent { ", real *tangent" } else { "" };
    let mut text = format!("static real {function}({name}_state *state{parameters}{tangent})\n{{\n");
    for array in used_arrays(program) {
        let declaration = program.declaration(array);
        if let Storage::Scratch(length) | Storage::Output(length) = declaration.storage {
            let _ = writeln!(text, "    real {}[{length}];", declaration.name);
        }
    }
    let sum = c.arguments.iter().map(|argument| format!("0 * {argument}")).collect::<Vec<_>>().join(" + ");
    let slope = if with_tangent { "\n        *tangent = invalid;" } else { "" };
    let _ = writeln!(
        text,
        "    const real invalid = {sum}; /* 0, or NaN if an argument is not finite: nothing changes then. */
    if (invalid != 0) {{{slope}
        return invalid;
    }}"
    );
    text += &Printer::new(c, program).body(1);
    let output = &program.declaration(program.outputs).name;
    if with_tangent {
        let last = program.declaration(program.outputs).storage.len() - 1;
        let _ = writeln!(text, "    *tangent = {output}[{last}];");
    }
    let _ = writeln!(text, "    return {output}[0];\n}}\n");
    text
}

/// The public functions.
fn around(c: &C, name: &str, token: u32) -> String {
    let parameters: String = c.arguments.iter().map(|argument| format!(", real {argument}")).collect();
    let arguments: String = c.arguments.iter().map(|argument| format!(", {argument}")).collect();
    filled(
        include_str!("around.c.txt"),
        &[
            ("@token@", &token.to_string()),
            ("NAME", name),
            ("@parameters@", &parameters),
            ("@arguments@", &arguments),
        ],
    )
}

/// Rounding functions that the C library does not have.
fn prelude(functions: &Uses, precision: Precision) -> String {
    let (round, bits, shift) = match precision {
        Precision::Double => ("6755399441056767.0", "uint64_t", 52),
        Precision::Single => ("12583039.0f", "uint32_t", 23),
    };
    let mut text = String::new();
    if functions.unary.contains(&Unary::PowerOfTwo) {
        text += &format!(
            "/* 2^a of a whole number: it becomes the exponent. */
static real power_of_two(real a)
{{
    union {{ real value; {bits} bits; }} number;
    number.value = a + {round};
    number.bits <<= {shift};
    return number.value;
}}

"
        );
    }
    text
}

/// The language.
struct C {
    precision: Precision,
    arguments: Vec<String>,
}

impl C {
    /// The function of this precision.
    fn of_precision(&self, double: &'static str, single: &'static str) -> &'static str {
        match self.precision {
            Precision::Double => double,
            Precision::Single => single,
        }
    }
}

impl Language for C {
    const SYNTAX: Syntax = Syntax {
        choice: |condition, yes, no| (format!("{condition} ? {yes} : {no}"), Binding::Choice),
        logic: ["&&", "||", "!"],
        to_whole: |real| format!("((int){real})"),
        to_real: |whole| format!("((real){whole})"),
        declare: |variable, value, is_constant| {
            format!("{}real {variable} = {value};", if is_constant { "const " } else { "" })
        },
        declare_whole: |variable, value| format!("int {variable} = {value};"),
        assign: |to, value| format!("{to} = {value};"),
        remark: |text| format!("/* {text} */"),
        each: |variable, first, last| {
            format!("for (int {variable} = {first}; {variable} < {last}; {variable}++) {{")
        },
        while_true: |condition| format!("while ({condition}) {{"),
        when: |condition| format!("if ({condition}) {{"),
        otherwise: "} else {",
        end: Some("}"),
    };

    fn number(&self, value: f64) -> String {
        match self.precision {
            _ if value.is_infinite() => {
                let sign = if value < 0.0 { "-" } else { "" };
                format!("{sign}{}", self.of_precision("HUGE_VAL", "HUGE_VALF"))
            }
            Precision::Double => format!("{value:?}"),
            Precision::Single => format!("{:?}f", Precision::single(value)),
        }
    }

    fn element(&self, declaration: &Declaration, index: &str) -> String {
        let name = &declaration.name;
        match declaration.storage {
            Storage::Argument(_) => index
                .parse::<usize>()
                .map_or_else(|_| format!("{name}[{index}]"), |index| self.arguments[index].clone()),
            Storage::State(_) => format!("state->{name}[{index}]"),
            _ => format!("{name}[{index}]"),
        }
    }

    fn unary(&self, function: Unary) -> Option<&'static str> {
        Some(match function {
            Unary::Negative => return None,
            Unary::Detached => "",
            Unary::PowerOfTwo => "power_of_two",
            Unary::Magnitude => self.of_precision("fabs", "fabsf"),
            Unary::SquareRoot => self.of_precision("sqrt", "sqrtf"),
            Unary::Ceiling => self.of_precision("ceil", "ceilf"),
            _ => elementary::of_unary(function)?.name(self.precision),
        })
    }

    fn binary(&self, function: Binary) -> Option<&'static str> {
        match function {
            Binary::Sum | Binary::Difference | Binary::Product | Binary::Quotient => None,
            Binary::CopySign => Some(self.of_precision("copysign", "copysignf")),
            _ => Some(elementary::of_binary(function)?.name(self.precision)),
        }
    }

    fn fused(&self) -> Option<&'static str> {
        (self.precision == Precision::Double).then_some("fused")
    }
}
