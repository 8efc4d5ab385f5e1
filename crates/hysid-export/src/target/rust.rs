//! Rust: one file without the standard library, and a program that tests it.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::description::HALF_WIDTH;
use crate::error::Error;
use crate::program::expression::{Binary, Unary};
use crate::program::functions::Functions;
use crate::program::unused::used_arrays;
use crate::program::{Array, Declaration, Precision, Program, Storage};
use crate::subject::{File, Subject};
use crate::target::printer::{Binding, Language, Printer, rows_of_numbers};
use crate::target::{BackEnd, Written};

pub(super) const BACK_END: BackEnd = BackEnd {
    name: "rust",
    has_single_precision: true,
    has_inverse: false,
    reserved: RESERVED,
    write,
    usage,
};

/// Words of the language, and names that the test has.
const RESERVED: &[&str] = &[
    "Model", "Real", "Self", "State", "abstract", "alloc", "as", "async", "await", "become", "box", "break",
    "const", "continue", "core", "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn",
    "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override",
    "priv", "pub", "ref", "return", "self", "static", "std", "struct", "super", "trait", "true", "try",
    "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

fn write(subject: &Subject<'_>) -> Result<Written, Error> {
    let name = subject.name();
    Ok(vec![
        File::new(format!("{name}.rs"), module(subject)),
        File::new(format!("{name}_test.rs"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names().join(", ");
    let library = match math_functions(subject).is_empty() {
        true => "It needs `core` and nothing else.".to_string(),
        false => format!(
            "It needs `core`, and these functions of the C library, which a program with the standard library has \
             already: `{}`. On bare metal, link a mathematical library that has them.",
            math_functions(subject).join("`, `")
        ),
    };
    format!(
        "Copy `{name}.rs` into the sources of your crate.

```rust
mod {name};

let mut model = {name}::Model::new();
let y = model.step({arguments});

let (y, slope) = model.trial_tangent({arguments});  // as often as a solver asks
model.commit();
```

{library} `rustc -O {name}_test.rs && ./{name}_test` runs the test vectors.
"
    )
}

/// The functions of the C library that the file declares.
fn math_functions(subject: &Subject<'_>) -> Vec<&'static str> {
    let functions = Functions::of(&[subject.program(), subject.tangent()]);
    let single = subject.precision() == Precision::Single;
    let of = |double: &'static str, of_single: &'static str| if single { of_single } else { double };
    let mut names = BTreeSet::new();
    for function in &functions.unary {
        match function {
            Unary::SquareRoot => names.insert(of("sqrt", "sqrtf")),
            Unary::Exp => names.insert(of("exp", "expf")),
            Unary::ExpMinusOne => names.insert(of("expm1", "expm1f")),
            Unary::Ln => names.insert(of("log", "logf")),
            Unary::LnOnePlus => names.insert(of("log1p", "log1pf")),
            Unary::Tanh => names.insert(of("tanh", "tanhf")),
            Unary::Ceiling => names.insert(of("ceil", "ceilf")),
            Unary::InverseSinh => names.insert(of("log1p", "log1pf")) | names.insert(of("hypot", "hypotf")),
            Unary::Negative | Unary::Magnitude | Unary::Rounded | Unary::PowerOfTwo | Unary::Detached => {
                false
            }
        };
    }
    for function in &functions.binary {
        match function {
            Binary::Power => names.insert(of("pow", "powf")),
            Binary::Hypotenuse => names.insert(of("hypot", "hypotf")),
            _ => false,
        };
    }
    names.into_iter().collect()
}

fn module(subject: &Subject<'_>) -> String {
    let rust = Rust { arguments: subject.argument_names(), precision: subject.precision() };
    let (step, tangent) = (subject.program(), subject.tangent());
    let real = subject.precision().name();
    let facts: String =
        subject.facts().iter().map(|(fact, text)| format!("//! {fact}: {text}  \n")).collect();
    let mut text = format!(
        "//! A model of hysteresis, written by Hysid.
//!
{facts}//!
//! Values are in the units of the columns above. Inputs must be finite.

#![allow(unused_mut, unused_variables, unused_assignments, unused_parens, dead_code, clippy::all)]

/// A number.
pub type Real = {real};

"
    );
    text += &declarations(&math_functions(subject), real);
    text += &own_functions(&Functions::of(&[step, tangent]), subject.precision());
    text += &constants(&rust, &[step, tangent]);
    text += &state(&rust, step, subject.bytes());
    text += &function(&rust, step, "advance", false);
    text += &function(&rust, tangent, "advance_with_tangent", true);
    text += &model(&rust, subject.half_width().is_some());
    text
}

fn declarations(names: &[&str], real: &str) -> String {
    if names.is_empty() {
        return String::new();
    }
    let of_two = |name: &str| name.starts_with("pow") || name.starts_with("hypot");
    let lines: String = names
        .iter()
        .map(|name| {
            let second = if of_two(name) { format!(", b: {real}") } else { String::new() };
            format!("    safe fn {name}(a: {real}{second}) -> {real};\n")
        })
        .collect();
    format!("// Functions of the C library.\nunsafe extern \"C\" {{\n{lines}}}\n\n")
}

fn own_functions(functions: &Functions, precision: Precision) -> String {
    let (round, bits, shift, f) = match precision {
        Precision::Double => ("6755399441056767.0", "u64", 52, ""),
        Precision::Single => ("12583039.0", "u32", 23, "f"),
    };
    let mut text = String::new();
    if functions.unary.contains(&Unary::Rounded) {
        text += &format!(
            "/// The next whole number: the sum has no digits behind the point.
fn rounded(a: Real) -> Real {{
    (a + {round}) - {round}
}}

"
        );
    }
    if functions.unary.contains(&Unary::PowerOfTwo) {
        text += &format!(
            "/// 2^a of a whole number: it becomes the exponent.
fn power_of_two(a: Real) -> Real {{
    let number: {bits} = Real::to_bits(a + {round});
    Real::from_bits(number << {shift})
}}

"
        );
    }
    if functions.unary.contains(&Unary::InverseSinh) {
        text += &format!(
            "fn inverse_sinh(a: Real) -> Real {{
    let magnitude = Real::abs(a);
    let inverse = 1.0 / magnitude;
    let root = hypot{f}(1.0, inverse) + inverse;
    Real::copysign(log1p{f}(magnitude + magnitude / root), a)
}}

"
        );
    }
    text
}

fn constants(rust: &Rust, programs: &[&Program]) -> String {
    let used: BTreeSet<Array> = programs.iter().flat_map(|program| used_arrays(program)).collect();
    let mut text = String::new();
    for array in used {
        let declaration = programs[programs.len() - 1].declaration(array);
        if let Storage::Constant(values) = &declaration.storage {
            let rows = rows_of_numbers(rust, values, "    ");
            let name = rust.array(declaration);
            let _ = writeln!(text, "static {name}: [Real; {}] = [\n{rows},\n];", values.len());
        }
    }
    text + "\n"
}

/// The type of the state, with its values at the beginning and its bytes.
fn state(rust: &Rust, program: &Program, bytes: usize) -> String {
    let (mut fields, mut values, mut save, mut restore) =
        (String::new(), String::new(), String::new(), String::new());
    for (array, _, initial) in program.states() {
        let name = rust.field(program.declaration(array));
        let rows = rows_of_numbers(rust, initial, "            ");
        let _ = writeln!(fields, "    {name}: [Real; {}],", initial.len());
        let _ = writeln!(values, "        {name}: [\n{rows},\n        ],");
        let _ = writeln!(save, "        numbers.extend(&self.{name});");
        let _ = writeln!(restore, "        numbers.fill(&mut state.{name});");
    }
    let length = program.state_len() * bytes;
    format!(
        "/// Bytes of a saved state.
pub const STATE_BYTES: usize = {length};

/// What the model remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {{
{fields}}}

impl State {{
    /// The initial state.
    pub const INITIAL: Self = Self {{
{values}    }};

    /// The state as bytes.
    pub fn to_bytes(&self) -> [u8; STATE_BYTES] {{
        let mut numbers = Bytes {{ bytes: [0; STATE_BYTES], position: 0 }};
{save}        numbers.bytes
    }}

    /// The state of these bytes.
    pub fn from_bytes(bytes: [u8; STATE_BYTES]) -> Self {{
        let mut numbers = Bytes {{ bytes, position: 0 }};
        let mut state = Self::INITIAL;
{restore}        state
    }}
}}

/// A place in the bytes of a state.
struct Bytes {{
    bytes: [u8; STATE_BYTES],
    position: usize,
}}

impl Bytes {{
    fn extend(&mut self, values: &[Real]) {{
        for value in values {{
            self.bytes[self.position..self.position + {bytes}].copy_from_slice(&value.to_le_bytes());
            self.position += {bytes};
        }}
    }}

    fn fill(&mut self, values: &mut [Real]) {{
        for value in values {{
            let mut bytes = [0; {bytes}];
            bytes.copy_from_slice(&self.bytes[self.position..self.position + {bytes}]);
            *value = Real::from_le_bytes(bytes);
            self.position += {bytes};
        }}
    }}
}}

"
    )
}

fn function(rust: &Rust, program: &Program, name: &str, with_tangent: bool) -> String {
    let parameters: String = rust.arguments.iter().map(|argument| format!(", {argument}: Real")).collect();
    let output = if with_tangent { "(Real, Real)" } else { "Real" };
    let mut text = format!("fn {name}(state: &mut State{parameters}) -> {output} {{\n");
    for array in used_arrays(program) {
        let declaration = program.declaration(array);
        if let Storage::Scratch(length) | Storage::Output(length) = declaration.storage {
            let _ = writeln!(text, "    let mut {} = [0.0; {length}];", rust.array(declaration));
        }
    }
    text += &Printer::new(rust, program).body(1);
    let output = rust.array(program.declaration(program.outputs));
    let last = program.declaration(program.outputs).storage.len() - 1;
    let _ = match with_tangent {
        true => writeln!(text, "    ({output}[0], {output}[{last}])\n}}\n"),
        false => writeln!(text, "    {output}[0]\n}}\n"),
    };
    text
}

fn model(rust: &Rust, has_band: bool) -> String {
    let half_width = match has_band {
        false => String::new(),
        true => format!(
            "
    /// Half the width of the prediction band at the last trial or step, in the unit of the output.
    pub fn half_width(&self) -> Real {{
        let state = if self.has_trial {{ &self.trial }} else {{ &self.committed }};
        state.{HALF_WIDTH}_[0]
    }}
"
        ),
    };
    let parameters: String = rust.arguments.iter().map(|argument| format!(", {argument}: Real")).collect();
    let arguments: String = rust.arguments.iter().map(|argument| format!(", {argument}")).collect();
    format!(
        "/// One instance of the model, with a committed state and a trial state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {{
    committed: State,
    trial: State,
    has_trial: bool,
}}

impl Model {{
    /// The model in its initial state.
    pub const fn new() -> Self {{
        Self {{ committed: State::INITIAL, trial: State::INITIAL, has_trial: false }}
    }}

    /// Goes to the initial state.
    pub fn reset(&mut self) {{
        *self = Self::new();
    }}

    /// The output at a new input, from the committed state, which stays as it is.
    pub fn trial(&mut self{parameters}) -> Real {{
        self.trial = self.committed;
        self.has_trial = true;
        advance(&mut self.trial{arguments})
    }}

    /// The same, and the slope of the output by x; at a kink that of the branch taken.
    pub fn trial_tangent(&mut self{parameters}) -> (Real, Real) {{
        self.trial = self.committed;
        self.has_trial = true;
        advance_with_tangent(&mut self.trial{arguments})
    }}

    /// Makes the state of the last trial the committed one. Without a trial, nothing changes.
    pub fn commit(&mut self) {{
        if self.has_trial {{
            self.committed = self.trial;
            self.has_trial = false;
        }}
    }}

    /// Forgets the last trial.
    pub fn revert(&mut self) {{
        self.has_trial = false;
    }}

    /// The output of a trial that is committed at once.
    pub fn step(&mut self{parameters}) -> Real {{
        self.has_trial = false;
        advance(&mut self.committed{arguments})
    }}

    /// The committed state.
    pub fn state(&self) -> &State {{
        &self.committed
    }}

    /// Replaces the committed state.
    pub fn set_state(&mut self, state: State) {{
        self.committed = state;
        self.has_trial = false;
    }}
{half_width}}}
"
    )
}

fn self_test(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let count = subject.argument_names().len();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = 0.5 * (high - low);
    let tolerance = if subject.precision() == Precision::Double { 1e-9 } else { 1e-4 };
    let given: String = (0..count).map(|index| format!("a[{index}]")).collect::<Vec<_>>().join(", ");
    format!(
        "//! Compares {name}.rs with the test vectors. Exit status 0 if all agree.

mod {name};

use {name}::{{Model, Real, State}};

fn main() {{
    const SCALE: f64 = {scale:?};
    let mut model = Model::new();
    let mut saved = model.state().to_bytes();
    let mut differences = Vec::new();
    for line in include_str!(\"test_vectors.csv\").lines().skip(1) {{
        let fields: Vec<&str> = line.split(',').collect();
        let a: Vec<Real> = fields[1..].iter().map(|field| field.parse().unwrap_or(0.0)).collect();
        let (output, slope) = (f64::from(a[{count}]), f64::from(a[{count} + 1]));
        let mut compare = |found: Real, expected: f64, scale: f64| {{
            differences.push((f64::from(found) - expected).abs() / scale);
        }};
        match fields[0] {{
            \"reset\" => model.reset(),
            \"commit\" => model.commit(),
            \"revert\" => model.revert(),
            \"save\" => saved = model.state().to_bytes(),
            \"restore\" => model.set_state(State::from_bytes(saved)),
            \"step\" => compare(model.step({given}), output, SCALE),
            _ => {{
                let (y, tangent) = model.trial_tangent({given});
                compare(y, output, SCALE);
                compare(tangent, slope, SCALE + slope.abs());
                compare(model.trial({given}), output, SCALE);
            }}
        }}
    }}
    let different = differences.iter().filter(|difference| **difference != 0.0).count();
    let largest = differences.iter().fold(0.0, |largest: f64, difference| largest.max(*difference));
    println!(
        \"{{different}} of {{}} numbers differ, by at most {{largest:.1e}} of half the trained range\",
        differences.len()
    );
    std::process::exit(i32::from(!(largest <= {tolerance:e})));
}}
"
    )
}

/// The language.
struct Rust {
    arguments: Vec<String>,
    precision: Precision,
}

impl Rust {
    /// The name of an array that is no field of the state.
    fn array(&self, declaration: &Declaration) -> String {
        match declaration.storage {
            Storage::Constant(_) => declaration.name.to_uppercase(),
            _ => format!("all_{}", declaration.name),
        }
    }

    /// The name of a field of the state, apart from keywords.
    fn field(&self, declaration: &Declaration) -> String {
        format!("{}_", declaration.name)
    }

    fn of_precision(&self, double: &'static str, single: &'static str) -> &'static str {
        match self.precision {
            Precision::Double => double,
            Precision::Single => single,
        }
    }
}

impl Language for Rust {
    fn number(&self, value: f64) -> String {
        match (value.is_infinite(), self.precision) {
            (true, _) => if value < 0.0 { "-Real::INFINITY" } else { "Real::INFINITY" }.to_string(),
            (false, Precision::Double) => format!("{value:?}"),
            (false, Precision::Single) => format!("{:?}", Precision::single(value)),
        }
    }

    fn element(&self, declaration: &Declaration, index: &str) -> String {
        let constant = index.parse::<usize>();
        let place = if constant.is_ok() { index.to_string() } else { format!("({index}) as usize") };
        match (&declaration.storage, constant) {
            (Storage::Argument(_), Ok(index)) => self.arguments[index].clone(),
            (Storage::Argument(_), _) => format!("[{}][{place}]", self.arguments.join(", ")),
            (Storage::State(_), _) => format!("state.{}[{place}]", self.field(declaration)),
            _ => format!("{}[{place}]", self.array(declaration)),
        }
    }

    fn unary(&self, function: Unary) -> Option<&'static str> {
        Some(match function {
            Unary::Negative => return None,
            Unary::Detached => "",
            Unary::Rounded => "rounded",
            Unary::PowerOfTwo => "power_of_two",
            Unary::InverseSinh => "inverse_sinh",
            Unary::Magnitude => "Real::abs",
            Unary::SquareRoot => self.of_precision("sqrt", "sqrtf"),
            Unary::Exp => self.of_precision("exp", "expf"),
            Unary::ExpMinusOne => self.of_precision("expm1", "expm1f"),
            Unary::Ln => self.of_precision("log", "logf"),
            Unary::LnOnePlus => self.of_precision("log1p", "log1pf"),
            Unary::Tanh => self.of_precision("tanh", "tanhf"),
            Unary::Ceiling => self.of_precision("ceil", "ceilf"),
        })
    }

    fn binary(&self, function: Binary) -> Option<&'static str> {
        match function {
            Binary::Sum | Binary::Difference | Binary::Product | Binary::Quotient => None,
            Binary::Power => Some(self.of_precision("pow", "powf")),
            Binary::CopySign => Some("Real::copysign"),
            Binary::Hypotenuse => Some(self.of_precision("hypot", "hypotf")),
        }
    }

    fn choice(&self, condition: &str, yes: &str, no: &str) -> (String, Binding) {
        (format!("if {condition} {{ {yes} }} else {{ {no} }}"), Binding::Choice)
    }

    fn logic(&self) -> [&'static str; 3] {
        ["&&", "||", "!"]
    }

    fn to_whole(&self, real: &str) -> String {
        format!("({real} as i32)")
    }

    fn to_real(&self, whole: &str) -> String {
        format!("({whole} as Real)")
    }

    fn declare(&self, variable: &str, value: &str, is_constant: bool) -> String {
        format!("let {}{variable}: Real = {value};", if is_constant { "" } else { "mut " })
    }

    fn declare_whole(&self, variable: &str, value: &str) -> String {
        format!("let mut {variable}: i32 = {value};")
    }

    fn assign(&self, to: &str, value: &str) -> String {
        format!("{to} = {value};")
    }

    fn remark(&self, text: &str) -> String {
        format!("// {text}")
    }

    fn each(&self, variable: &str, first: &str, last: &str) -> String {
        format!("for {variable} in {first}..{last} {{")
    }

    fn while_true(&self, condition: &str) -> String {
        format!("while {condition} {{")
    }

    fn when(&self, condition: &str) -> String {
        format!("if {condition} {{")
    }

    fn otherwise(&self) -> &'static str {
        "} else {"
    }

    fn end(&self) -> Option<&'static str> {
        Some("}")
    }
}
