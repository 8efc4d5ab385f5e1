//! The source file: the step with and without its tangent, and the functions around it.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::export::Subject;
use crate::program::expression::{Binary, Comparison, Real, RealVariable, Truth, Unary, Whole};
use crate::program::unused::used_arrays;
use crate::program::{Array, Precision, Program, Statement, Storage};
use crate::target::c::argument_names;

/// The text of the source file.
pub(super) fn source(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let (step, tangent) = (subject.program(), subject.tangent());
    let printer = Printer { name, precision: subject.precision(), arguments: argument_names(subject) };
    let mut functions = Functions::default();
    functions.of_block(&step.body);
    functions.of_block(&tangent.body);

    let mut text = format!("/* {name}.c: see {name}.h. */\n\n");
    if functions.uses_math() {
        text += "#include <math.h>\n";
    }
    if functions.power_of_two {
        text += "#include <stdint.h>\n";
    }
    text += &format!("#include \"{name}.h\"\n\n");
    text += "#ifdef __FAST_MATH__\n#error \"-ffast-math changes the results of this file\"\n#endif\n\n";
    text += &format!("typedef {name}_real real;\n\n");
    text += &functions.prelude(subject.precision());
    text += &constants(&printer, &[step, tangent]);
    text += &initial_state(&printer, step);
    text += &function(&printer, step, "advance", false);
    text += &function(&printer, tangent, "advance_with_tangent", true);
    text += &around(&printer);
    text
}

/// All arrays of constants that the programs use.
fn constants(printer: &Printer<'_>, programs: &[&Program]) -> String {
    let used: BTreeSet<Array> = programs.iter().flat_map(|program| used_arrays(program)).collect();
    let mut text = String::new();
    for array in used {
        // The second program has the arrays of the first, and more.
        let declaration = programs[programs.len() - 1].declaration(array);
        if let Storage::Constant(values) = &declaration.storage {
            text += &format!(
                "static const real {}[{}] = {};\n",
                declaration.name,
                values.len(),
                printer.list(values)
            );
        }
    }
    text + "\n"
}

fn initial_state(printer: &Printer<'_>, program: &Program) -> String {
    let name = printer.name;
    let mut text = format!("static const {name}_state initial_state = {{\n");
    for (_, array, values) in program.states() {
        let _ = writeln!(text, "    {}, /* {array} */", printer.list(values));
    }
    text + "};\n\n"
}

/// One of the two steps, as a function that advances a state.
fn function(printer: &Printer<'_>, program: &Program, function: &str, with_tangent: bool) -> String {
    let parameters: String = printer.arguments.iter().map(|argument| format!(", real {argument}")).collect();
    let tangent = if with_tangent { ", real *tangent" } else { "" };
    let mut text =
        format!("static real {function}({}_state *state{parameters}{tangent})\n{{\n", printer.name);
    for array in used_arrays(program) {
        let declaration = program.declaration(array);
        match declaration.storage {
            Storage::Scratch(length) | Storage::Output(length) => {
                let _ = writeln!(text, "    real {}[{length}];", declaration.name);
            }
            Storage::Constant(_) | Storage::State(_) | Storage::Argument(_) => {}
        }
    }
    let mut assigned = BTreeSet::new();
    collect_assigned(&program.body, &mut assigned);
    printer.block(program, &assigned, &program.body, 1, &mut text);
    let output = &program.declaration(program.outputs).name;
    if with_tangent {
        let last = program.declaration(program.outputs).storage.len() - 1;
        let _ = writeln!(text, "    *tangent = {output}[{last}];");
    }
    let _ = writeln!(text, "    return {output}[0];\n}}\n");
    text
}

fn collect_assigned(statements: &[Statement], assigned: &mut BTreeSet<RealVariable>) {
    for statement in statements {
        match statement {
            Statement::Assign(variable, _) => {
                assigned.insert(*variable);
            }
            Statement::Each(_, _, _, body) | Statement::While(_, body) => collect_assigned(body, assigned),
            Statement::If(_, yes, no) => {
                collect_assigned(yes, assigned);
                collect_assigned(no, assigned);
            }
            _ => {}
        }
    }
}

/// The public functions.
fn around(printer: &Printer<'_>) -> String {
    let name = printer.name;
    let parameters: String = printer.arguments.iter().map(|argument| format!(", real {argument}")).collect();
    let arguments: String = printer.arguments.iter().map(|argument| format!(", {argument}")).collect();
    format!(
        "void {name}_reset({name}_model *model)
{{
    model->committed = initial_state;
    model->has_trial = 0;
}}

real {name}_trial({name}_model *model{parameters})
{{
    model->trial = model->committed;
    model->has_trial = 1;
    return advance(&model->trial{arguments});
}}

real {name}_trial_tangent({name}_model *model{parameters}, real *tangent)
{{
    model->trial = model->committed;
    model->has_trial = 1;
    return advance_with_tangent(&model->trial{arguments}, tangent);
}}

void {name}_commit({name}_model *model)
{{
    if (model->has_trial) {{
        model->committed = model->trial;
        model->has_trial = 0;
    }}
}}

void {name}_revert({name}_model *model)
{{
    model->has_trial = 0;
}}

real {name}_step({name}_model *model{parameters})
{{
    model->has_trial = 0;
    return advance(&model->committed{arguments});
}}

void {name}_save(const {name}_model *model, unsigned char *bytes)
{{
    const unsigned char *from = (const unsigned char *)&model->committed;
    size_t i;
    for (i = 0; i < {upper}_STATE_BYTES; i++)
        bytes[i] = from[i];
}}

void {name}_restore({name}_model *model, const unsigned char *bytes)
{{
    unsigned char *to = (unsigned char *)&model->committed;
    size_t i;
    for (i = 0; i < {upper}_STATE_BYTES; i++)
        to[i] = bytes[i];
    model->has_trial = 0;
}}
",
        upper = name.to_uppercase(),
    )
}

/// Functions of the standard library and of the prelude that a program uses.
#[derive(Default)]
struct Functions {
    library: BTreeSet<&'static str>,
    rounded: bool,
    power_of_two: bool,
    inverse_sinh: bool,
    infinity: bool,
}

impl Functions {
    fn of_block(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Remark(_) => {}
                Statement::Let(_, value) | Statement::Assign(_, value) => self.of_real(value),
                Statement::LetWhole(_, value) | Statement::AssignWhole(_, value) => self.of_whole(value),
                Statement::Set(_, index, value) => {
                    self.of_whole(index);
                    self.of_real(value);
                }
                Statement::Each(_, first, last, body) => {
                    self.of_whole(first);
                    self.of_whole(last);
                    self.of_block(body);
                }
                Statement::While(condition, body) => {
                    self.of_truth(condition);
                    self.of_block(body);
                }
                Statement::If(condition, yes, no) => {
                    self.of_truth(condition);
                    self.of_block(yes);
                    self.of_block(no);
                }
            }
        }
    }

    fn of_real(&mut self, value: &Real) {
        match value {
            Real::Constant(value) => self.infinity |= value.is_infinite(),
            Real::Variable(_) => {}
            Real::Element(_, index) | Real::OfWhole(index) => self.of_whole(index),
            Real::Unary(function, a) => {
                match function {
                    Unary::Rounded => self.rounded = true,
                    Unary::PowerOfTwo => self.power_of_two = true,
                    Unary::InverseSinh => self.inverse_sinh = true,
                    other => self.library.extend(unary_name(*other)),
                }
                self.of_real(a);
            }
            Real::Binary(function, a, b) => {
                self.library.extend(binary_name(*function));
                self.of_real(a);
                self.of_real(b);
            }
            Real::Choice(condition, yes, no) => {
                self.of_truth(condition);
                self.of_real(yes);
                self.of_real(no);
            }
        }
    }

    fn of_whole(&mut self, value: &Whole) {
        match value {
            Whole::Constant(_) | Whole::Variable(_) => {}
            Whole::Sum(a, b) | Whole::Difference(a, b) | Whole::Product(a, b) => {
                self.of_whole(a);
                self.of_whole(b);
            }
            Whole::OfReal(value) => self.of_real(value),
        }
    }

    fn of_truth(&mut self, condition: &Truth) {
        match condition {
            Truth::Real(_, a, b) => {
                self.of_real(a);
                self.of_real(b);
            }
            Truth::Whole(_, a, b) => {
                self.of_whole(a);
                self.of_whole(b);
            }
            Truth::And(a, b) | Truth::Or(a, b) => {
                self.of_truth(a);
                self.of_truth(b);
            }
            Truth::Not(a) => self.of_truth(a),
        }
    }

    fn uses_math(&self) -> bool {
        !self.library.is_empty() || self.inverse_sinh || self.infinity
    }

    /// Functions that the C library does not have.
    fn prelude(&self, precision: Precision) -> String {
        let suffix = math_suffix(precision);
        let (round, bits, shift) = match precision {
            Precision::Double => ("6755399441056767.0", "uint64_t", 52),
            Precision::Single => ("12583039.0f", "uint32_t", 23),
        };
        let mut text = String::new();
        if self.rounded {
            text += &format!(
                "/* The next whole number: the sum has no digits behind the point. */
static real rounded(real a)
{{
    return (a + {round}) - {round};
}}

"
            );
        }
        if self.power_of_two {
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
        if self.inverse_sinh {
            let one = if precision == Precision::Single { "1.0f" } else { "1.0" };
            text += &format!(
                "static real inverse_sinh(real a)
{{
    const real magnitude = fabs{suffix}(a);
    const real inverse = {one} / magnitude;
    const real root = hypot{suffix}({one}, inverse) + inverse;
    return copysign{suffix}(log1p{suffix}(magnitude + magnitude / root), a);
}}

"
            );
        }
        text
    }
}

fn math_suffix(precision: Precision) -> &'static str {
    match precision {
        Precision::Double => "",
        Precision::Single => "f",
    }
}

fn unary_name(function: Unary) -> Option<&'static str> {
    match function {
        Unary::Negative | Unary::Rounded | Unary::PowerOfTwo | Unary::InverseSinh => None,
        Unary::Magnitude => Some("fabs"),
        Unary::SquareRoot => Some("sqrt"),
        Unary::Exp => Some("exp"),
        Unary::ExpMinusOne => Some("expm1"),
        Unary::Ln => Some("log"),
        Unary::LnOnePlus => Some("log1p"),
        Unary::Tanh => Some("tanh"),
        Unary::Ceiling => Some("ceil"),
    }
}

fn binary_name(function: Binary) -> Option<&'static str> {
    match function {
        Binary::Sum | Binary::Difference | Binary::Product | Binary::Quotient => None,
        Binary::Power => Some("pow"),
        Binary::CopySign => Some("copysign"),
        Binary::Hypotenuse => Some("hypot"),
    }
}

/// How strongly the outermost operation of an expression binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Choice,
    Or,
    And,
    Comparison,
    Sum,
    Product,
    Sign,
    Atom,
}

/// Writes statements and expressions in C.
struct Printer<'a> {
    name: &'a str,
    precision: Precision,
    arguments: Vec<String>,
}

impl Printer<'_> {
    fn number(&self, value: f64) -> String {
        match self.precision {
            _ if value.is_infinite() => {
                let sign = if value < 0.0 { "-" } else { "" };
                format!("{sign}HUGE_VAL{}", math_suffix(self.precision).to_uppercase())
            }
            Precision::Double => format!("{value:?}"),
            Precision::Single => format!("{:?}f", value as f32),
        }
    }

    /// Numbers in braces, some in a line.
    fn list(&self, values: &[f64]) -> String {
        const IN_A_LINE: usize = 4;
        let numbers: Vec<String> = values.iter().map(|value| self.number(*value)).collect();
        if numbers.len() <= IN_A_LINE {
            return format!("{{ {} }}", numbers.join(", "));
        }
        let lines: Vec<String> =
            numbers.chunks(IN_A_LINE).map(|line| format!("    {}", line.join(", "))).collect();
        format!("{{\n{}\n}}", lines.join(",\n"))
    }

    fn block(
        &self,
        program: &Program,
        assigned: &BTreeSet<RealVariable>,
        statements: &[Statement],
        depth: usize,
        text: &mut String,
    ) {
        let indent = "    ".repeat(depth);
        for statement in statements {
            let _ = match statement {
                Statement::Remark(remark) => writeln!(text, "{indent}/* {} */", remark.replace("*/", "* /")),
                Statement::Let(variable, value) => {
                    let constant = if assigned.contains(variable) { "" } else { "const " };
                    let value = self.real(program, value, Binding::Choice);
                    writeln!(text, "{indent}{constant}real v{} = {value};", variable.0)
                }
                Statement::Assign(variable, value) => {
                    writeln!(
                        text,
                        "{indent}v{} = {};",
                        variable.0,
                        self.real(program, value, Binding::Choice)
                    )
                }
                Statement::LetWhole(variable, value) => {
                    writeln!(
                        text,
                        "{indent}int k{} = {};",
                        variable.0,
                        self.whole(program, value, Binding::Sum)
                    )
                }
                Statement::AssignWhole(variable, value) => {
                    writeln!(text, "{indent}k{} = {};", variable.0, self.whole(program, value, Binding::Sum))
                }
                Statement::Set(array, index, value) => writeln!(
                    text,
                    "{indent}{} = {};",
                    self.element(program, *array, index),
                    self.real(program, value, Binding::Choice)
                ),
                Statement::Each(variable, first, last, body) => {
                    let (first, last) =
                        (self.whole(program, first, Binding::Sum), self.whole(program, last, Binding::Sum));
                    let _ = writeln!(
                        text,
                        "{indent}for (int k{0} = {first}; k{0} < {last}; k{0}++) {{",
                        variable.0
                    );
                    self.block(program, assigned, body, depth + 1, text);
                    writeln!(text, "{indent}}}")
                }
                Statement::While(condition, body) => {
                    let _ = writeln!(
                        text,
                        "{indent}while ({}) {{",
                        self.truth(program, condition, Binding::Choice)
                    );
                    self.block(program, assigned, body, depth + 1, text);
                    writeln!(text, "{indent}}}")
                }
                Statement::If(condition, yes, no) => {
                    let (condition, yes, no) = match (yes.is_empty(), condition) {
                        (false, condition) => (condition.clone(), yes, no),
                        (true, condition) => (condition.clone().negated(), no, yes),
                    };
                    let _ = writeln!(
                        text,
                        "{indent}if ({}) {{",
                        self.truth(program, &condition, Binding::Choice)
                    );
                    self.block(program, assigned, yes, depth + 1, text);
                    if !no.is_empty() {
                        let _ = writeln!(text, "{indent}}} else {{");
                        self.block(program, assigned, no, depth + 1, text);
                    }
                    writeln!(text, "{indent}}}")
                }
            };
        }
    }

    fn element(&self, program: &Program, array: Array, index: &Whole) -> String {
        if array == program.arguments
            && let Whole::Constant(index) = index
        {
            return self.arguments[usize::try_from(*index).unwrap_or_default()].clone();
        }
        let declaration = program.declaration(array);
        let state = if matches!(declaration.storage, Storage::State(_)) { "state->" } else { "" };
        format!("{state}{}[{}]", declaration.name, self.whole(program, index, Binding::Sum))
    }

    /// An expression, in parentheses if it binds more weakly than what stands around it.
    fn real(&self, program: &Program, value: &Real, around: Binding) -> String {
        let (text, binding) = match value {
            // The sign of a number binds as an operation.
            Real::Constant(value) if value.is_sign_negative() => (self.number(*value), Binding::Sign),
            Real::Constant(value) => (self.number(*value), Binding::Atom),
            Real::Variable(variable) => (format!("v{}", variable.0), Binding::Atom),
            Real::Element(array, index) => (self.element(program, *array, index), Binding::Atom),
            Real::Unary(Unary::Negative, a) => {
                (format!("-{}", self.real(program, a, Binding::Atom)), Binding::Sign)
            }
            Real::Unary(function, a) => {
                let a = self.real(program, a, Binding::Choice);
                let name = match function {
                    Unary::Rounded => "rounded".to_string(),
                    Unary::PowerOfTwo => "power_of_two".to_string(),
                    Unary::InverseSinh => "inverse_sinh".to_string(),
                    other => {
                        format!("{}{}", unary_name(*other).unwrap_or_default(), math_suffix(self.precision))
                    }
                };
                (format!("{name}({a})"), Binding::Atom)
            }
            Real::Binary(function, a, b) => self.binary(program, *function, a, b),
            Real::Choice(condition, yes, no) => {
                let condition = self.truth(program, condition, Binding::Or);
                let (yes, no) =
                    (self.real(program, yes, Binding::Or), self.real(program, no, Binding::Choice));
                (format!("{condition} ? {yes} : {no}"), Binding::Choice)
            }
            Real::OfWhole(value) => {
                (format!("(real){}", self.whole(program, value, Binding::Atom)), Binding::Sign)
            }
        };
        bracketed(text, binding, around)
    }

    fn binary(&self, program: &Program, function: Binary, a: &Real, b: &Real) -> (String, Binding) {
        let infix = |sign: &str, binding: Binding, above: Binding| {
            let (a, b) = (self.real(program, a, binding), self.real(program, b, above));
            (format!("{a} {sign} {b}"), binding)
        };
        match function {
            Binary::Sum => infix("+", Binding::Sum, Binding::Product),
            Binary::Difference => infix("-", Binding::Sum, Binding::Product),
            Binary::Product => infix("*", Binding::Product, Binding::Sign),
            Binary::Quotient => infix("/", Binding::Product, Binding::Sign),
            Binary::Power | Binary::CopySign | Binary::Hypotenuse => {
                let (a, b) = (self.real(program, a, Binding::Choice), self.real(program, b, Binding::Choice));
                let name = binary_name(function).unwrap_or_default();
                (format!("{name}{}({a}, {b})", math_suffix(self.precision)), Binding::Atom)
            }
        }
    }

    fn whole(&self, program: &Program, value: &Whole, around: Binding) -> String {
        let infix = |sign: &str, a: &Whole, b: &Whole, binding: Binding, above: Binding| {
            let (a, b) = (self.whole(program, a, binding), self.whole(program, b, above));
            (format!("{a} {sign} {b}"), binding)
        };
        let (text, binding) = match value {
            Whole::Constant(value) => {
                (value.to_string(), if *value < 0 { Binding::Sign } else { Binding::Atom })
            }
            Whole::Variable(variable) => (format!("k{}", variable.0), Binding::Atom),
            Whole::Sum(a, b) => infix("+", a, b, Binding::Sum, Binding::Product),
            Whole::Difference(a, b) => infix("-", a, b, Binding::Sum, Binding::Product),
            Whole::Product(a, b) => infix("*", a, b, Binding::Product, Binding::Sign),
            Whole::OfReal(value) => {
                (format!("(int){}", self.real(program, value, Binding::Atom)), Binding::Sign)
            }
        };
        bracketed(text, binding, around)
    }

    fn truth(&self, program: &Program, condition: &Truth, around: Binding) -> String {
        let (text, binding) = match condition {
            Truth::Real(comparison, a, b) => {
                let (a, b) = (self.real(program, a, Binding::Sum), self.real(program, b, Binding::Sum));
                (format!("{a} {} {b}", sign(*comparison)), Binding::Comparison)
            }
            Truth::Whole(comparison, a, b) => {
                let (a, b) = (self.whole(program, a, Binding::Sum), self.whole(program, b, Binding::Sum));
                (format!("{a} {} {b}", sign(*comparison)), Binding::Comparison)
            }
            Truth::And(a, b) => {
                let (a, b) = (self.truth(program, a, Binding::And), self.truth(program, b, Binding::And));
                (format!("{a} && {b}"), Binding::And)
            }
            Truth::Or(a, b) => {
                // In parentheses, because compilers warn of `a && b || c`.
                let (a, b) = (
                    self.truth(program, a, Binding::Comparison),
                    self.truth(program, b, Binding::Comparison),
                );
                (format!("{a} || {b}"), Binding::Or)
            }
            Truth::Not(a) => (format!("!({})", self.truth(program, a, Binding::Choice)), Binding::Sign),
        };
        bracketed(text, binding, around)
    }
}

fn sign(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Below => "<",
        Comparison::AtMost => "<=",
        Comparison::Equal => "==",
    }
}

fn bracketed(text: String, binding: Binding, around: Binding) -> String {
    if binding < around { format!("({text})") } else { text }
}
