//! From a program to a graph: every assignment becomes a new name, loops and branches become subgraphs.
//!
//! A loop whose passes do not need each other becomes operations on rows of numbers; a short one is unrolled.

use std::collections::{BTreeMap, BTreeSet};

use crate::program::expression::{Binary, Real, RealVariable, Relation, Truth, Unary, Whole, WholeVariable};
use crate::program::{Array, Program, Statement, Storage, every};
use crate::target::onnx::lanes;
use crate::target::onnx::messages::{Attribute, BOOL, DOUBLE, Graph, INT64, OnnxNode, Tensor, ValueInfo};

/// Most passes of a loop that is unrolled.
const UNROLLED: i64 = 64;

/// Names of the graph's inputs and outputs.
pub(super) const STATE: &str = "state";
pub(super) const NEXT_STATE: &str = "next_state";
pub(super) const OUTPUT: &str = "y";
pub(super) const SLOPE: &str = "slope";

/// The graph of a step: from the state and the arguments to the output, its slope if the program has it, and the next
/// state.
pub(super) fn step(program: &Program, arguments: &[String], with_slope: bool) -> Graph {
    let mut compiler = Compiler::new(program, arguments);
    let states: Vec<(Array, usize)> =
        program.states().map(|(array, _, values)| (array, values.len())).collect();
    compiler.split(&states);
    compiler.block(&program.body);

    let mut outputs = vec![ValueInfo::scalar(OUTPUT, DOUBLE)];
    let output = compiler.values.arrays[&program.outputs].clone();
    let last = program.declaration(program.outputs).storage.len() - 1;
    for (name, place) in [(OUTPUT, 0), (SLOPE, last)].into_iter().take(1 + usize::from(with_slope)) {
        let place = compiler.whole_constant(i64::try_from(place).unwrap_or_default());
        let value = compiler.node("Gather", &[&output, &place]);
        compiler.named("Identity", &[&value], name);
    }
    if with_slope {
        outputs.push(ValueInfo::scalar(SLOPE, DOUBLE));
    }
    let arrays: Vec<String> = states.iter().map(|(array, _)| compiler.values.arrays[array].clone()).collect();
    let arrays: Vec<&str> = arrays.iter().map(String::as_str).collect();
    compiler.add("Concat", &arrays, vec![NEXT_STATE.into()], vec![Attribute::integer("axis", 0)]);
    outputs.push(ValueInfo::row(NEXT_STATE, program.state_len()));

    let mut inputs = vec![ValueInfo::row(STATE, program.state_len())];
    inputs.extend(arguments.iter().map(|argument| ValueInfo::scalar(argument, DOUBLE)));
    let nodes = compiler.nodes.pop().unwrap_or_default();
    let mut used = BTreeSet::new();
    names_read(&nodes, &mut used);
    let initializers: Vec<Tensor> =
        compiler.initializers.into_iter().filter(|tensor| used.contains(tensor.name.as_str())).collect();
    Graph { name: "step".into(), initializers, inputs, outputs, nodes }
}

fn names_read<'n>(nodes: &'n [OnnxNode], names: &mut BTreeSet<&'n str>) {
    for node in nodes {
        names.extend(node.inputs.iter().map(String::as_str));
        let graphs = node.attributes.iter().filter_map(|attribute| attribute.graph.as_ref());
        graphs.for_each(|graph| names_read(&graph.nodes, names));
    }
}

pub(super) fn row(name: &str, values: &[f64]) -> Tensor {
    Tensor {
        dims: vec![i64::try_from(values.len()).unwrap_or(i64::MAX)],
        data_type: DOUBLE,
        name: name.into(),
        raw: values.iter().flat_map(|value| value.to_le_bytes()).collect(),
    }
}

fn row_of_wholes(name: &str, values: &[i64]) -> Tensor {
    let raw = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    Tensor { data_type: INT64, raw, ..row(name, &vec![0.0; values.len()]) }
}

/// Names of the present values.
#[derive(Clone, Default)]
struct GraphValues {
    reals: BTreeMap<RealVariable, String>,
    wholes: BTreeMap<WholeVariable, String>,
    arrays: BTreeMap<Array, String>,
    known: BTreeMap<WholeVariable, i64>,
    /// The variable of a loop on rows that has the numbers 0, 1, ... to below this one.
    all: Option<(WholeVariable, usize)>,
    lanes: Option<String>,
}

/// A value that a subgraph changes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum ChangedValue {
    Real(RealVariable),
    Whole(WholeVariable),
    Array(Array),
}

struct Compiler<'a> {
    program: &'a Program,
    arguments: &'a [String],
    /// Nodes of the graphs that are open, outermost first.
    nodes: Vec<Vec<OnnxNode>>,
    initializers: Vec<Tensor>,
    /// Constants by their bits, whole ones by their value.
    constants: BTreeMap<(bool, u64), String>,
    names: usize,
    values: GraphValues,
}

impl<'a> Compiler<'a> {
    fn new(program: &'a Program, arguments: &'a [String]) -> Self {
        let mut compiler = Self {
            program,
            arguments,
            nodes: vec![Vec::new()],
            initializers: Vec::new(),
            constants: BTreeMap::new(),
            names: 0,
            values: GraphValues::default(),
        };
        for (index, declaration) in program.arrays.iter().enumerate() {
            let values = match &declaration.storage {
                Storage::Constant(values) => values.clone(),
                Storage::Scratch(length) | Storage::Output(length) => vec![0.0; *length],
                Storage::State(_) | Storage::Argument(_) => continue,
            };
            let name = format!("array_{}", declaration.name);
            compiler.initializers.push(row(&name, &values));
            compiler.values.arrays.insert(Array(index), name);
        }
        compiler
    }

    fn split(&mut self, states: &[(Array, usize)]) {
        let sizes: Vec<i64> =
            states.iter().map(|(_, length)| i64::try_from(*length).unwrap_or(i64::MAX)).collect();
        self.initializers.push(row_of_wholes("state_sizes", &sizes));
        let names: Vec<String> = states
            .iter()
            .map(|(array, _)| format!("state_{}", self.program.declaration(*array).name))
            .collect();
        self.add("Split", &[STATE, "state_sizes"], names.clone(), vec![Attribute::integer("axis", 0)]);
        self.values.arrays.extend(states.iter().map(|(array, _)| *array).zip(names));
    }

    fn name(&mut self) -> String {
        self.names += 1;
        format!("v{}", self.names)
    }

    fn add(&mut self, operation: &str, inputs: &[&str], outputs: Vec<String>, attributes: Vec<Attribute>) {
        let inputs = inputs.iter().map(ToString::to_string).collect();
        let node = OnnxNode { inputs, outputs, operation: operation.into(), attributes };
        if let Some(nodes) = self.nodes.last_mut() {
            nodes.push(node);
        }
    }

    fn named(&mut self, operation: &str, inputs: &[&str], name: &str) {
        self.add(operation, inputs, vec![name.into()], Vec::new());
    }

    fn node(&mut self, operation: &str, inputs: &[&str]) -> String {
        let name = self.name();
        self.named(operation, inputs, &name);
        name
    }

    fn constant(&mut self, value: f64) -> String {
        self.constant_of((false, value.to_bits()), |name| row(name, &[value]))
    }

    fn whole_constant(&mut self, value: i64) -> String {
        self.constant_of((true, value.cast_unsigned()), |name| row_of_wholes(name, &[value]))
    }

    fn constant_of(&mut self, key: (bool, u64), row: impl FnOnce(&str) -> Tensor) -> String {
        if let Some(name) = self.constants.get(&key) {
            return name.clone();
        }
        let name = format!("c{}", self.constants.len());
        self.initializers.push(Tensor { dims: Vec::new(), ..row(&name) });
        self.constants.insert(key, name.clone());
        name
    }

    fn block(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Remark(_) | Statement::ForSlope(_) => {}
                Statement::Let(variable, value) | Statement::Assign(variable, value) => {
                    let value = self.real(value);
                    self.values.reals.insert(*variable, value);
                }
                Statement::LetWhole(variable, value) | Statement::AssignWhole(variable, value) => {
                    let known = self.known(value);
                    let name = self.whole(value);
                    self.values.wholes.insert(*variable, name);
                    match known {
                        Some(known) => self.values.known.insert(*variable, known),
                        None => self.values.known.remove(variable),
                    };
                }
                Statement::Set(array, index, value) => {
                    let index = self.whole(index);
                    let value = self.real(value);
                    let axis = self.constant_row(&[0]);
                    let index = self.node("Unsqueeze", &[&index, &axis]);
                    let value = self.node("Unsqueeze", &[&value, &axis]);
                    self.scatter(*array, &index, &value);
                }
                Statement::Each(variable, first, last, body) => self.each(*variable, first, last, body),
                Statement::While(condition, body) => self.while_true(condition, body),
                Statement::If(condition, yes, no) => self.branch(condition, yes, no),
            }
        }
    }

    fn scatter(&mut self, array: Array, indices: &str, values: &str) {
        let before = self.values.arrays[&array].clone();
        let name = self.name();
        let axis = vec![Attribute::integer("axis", 0)];
        self.add("ScatterElements", &[&before, indices, values], vec![name.clone()], axis);
        self.values.arrays.insert(array, name);
    }

    fn constant_row(&mut self, values: &[i64]) -> String {
        let name = format!("row_{}", values.iter().map(ToString::to_string).collect::<Vec<_>>().join("_"));
        if self.initializers.iter().all(|tensor| tensor.name != name) {
            self.initializers.push(row_of_wholes(&name, values));
        }
        name
    }

    fn each(&mut self, variable: WholeVariable, first: &Whole, last: &Whole, body: &[Statement]) {
        let range = self.known(first).zip(self.known(last));
        if lanes::are_independent(variable, body) {
            return self.on_rows(variable, (first, last), range, body);
        }
        match range {
            Some((first, last)) if last - first <= UNROLLED => {
                for number in first..last {
                    let name = self.whole_constant(number);
                    self.values.wholes.insert(variable, name);
                    self.values.known.insert(variable, number);
                    self.block(body);
                }
                self.values.known.remove(&variable);
            }
            _ => {
                let (first, last) = (self.whole(first), self.whole(last));
                let count = self.node("Sub", &[&last, &first]);
                self.repeat(&count, None, body, |compiler, pass| {
                    let number = compiler.node("Add", &[&first, pass]);
                    compiler.values.wholes.insert(variable, number);
                });
            }
        }
    }

    /// All passes of a loop at once.
    fn on_rows(
        &mut self,
        variable: WholeVariable,
        (first, last): (&Whole, &Whole),
        range: Option<(i64, i64)>,
        body: &[Statement],
    ) {
        let before = self.values.clone();
        let numbers = match range {
            Some((first, last)) => {
                let numbers: Vec<i64> = (first..last).collect();
                if numbers.is_empty() {
                    return;
                }
                if first == 0 {
                    self.values.all = usize::try_from(last).ok().map(|last| (variable, last));
                }
                let name = format!("numbers_{first}_{last}");
                if self.initializers.iter().all(|tensor| tensor.name != name) {
                    self.initializers.push(row_of_wholes(&name, &numbers));
                }
                name
            }
            None => {
                let (first, last, one) = (self.whole(first), self.whole(last), self.whole_constant(1));
                self.node("Range", &[&first, &last, &one])
            }
        };
        self.values.lanes = Some(self.node("Shape", &[&numbers]));
        self.values.wholes.insert(variable, numbers);
        self.values.known.remove(&variable);
        let mut sums = Vec::new();
        for statement in body {
            match statement {
                Statement::Let(variable, value) => {
                    let value = self.real(value);
                    self.values.reals.insert(*variable, value);
                }
                Statement::LetWhole(variable, value) => {
                    let value = self.whole(value);
                    self.values.wholes.insert(*variable, value);
                    self.values.known.remove(variable);
                }
                Statement::Set(array, index, value) => self.set_row(*array, index, value),
                Statement::Assign(variable, value) => {
                    if let Some(addend) = lanes::addend(*variable, value) {
                        let addend = self.real(&addend);
                        let sum = self.name();
                        let keep = vec![Attribute::integer("keepdims", 0)];
                        self.add("ReduceSum", &[&addend], vec![sum.clone()], keep);
                        let old = self.values.reals[variable].clone();
                        sums.push((*variable, self.node("Add", &[&old, &sum])));
                    }
                }
                _ => {}
            }
        }
        let arrays = std::mem::take(&mut self.values.arrays);
        self.values = GraphValues { arrays, ..before };
        self.values.reals.extend(sums);
    }

    fn set_row(&mut self, array: Array, index: &Whole, value: &Real) {
        let value = self.real(value);
        let value = match self.values.lanes.clone() {
            Some(lanes) => self.node("Expand", &[&value, &lanes]),
            None => value,
        };
        if self.is_all(array, index) {
            self.values.arrays.insert(array, value);
        } else {
            let index = self.whole(index);
            self.scatter(array, &index, &value);
        }
    }

    /// True if an index on rows goes through the whole array.
    fn is_all(&self, array: Array, index: &Whole) -> bool {
        let length = self.program.declaration(array).storage.len();
        self.values.all.is_some_and(|(variable, last)| *index == Whole::Variable(variable) && last == length)
    }

    fn while_true(&mut self, condition: &Truth, body: &[Statement]) {
        let first = self.truth(condition);
        self.repeat("", Some((&first, condition)), body, |_, _| {});
    }

    /// A loop as a subgraph. `begin` is called at the beginning of its body with the number of the pass.
    fn repeat(
        &mut self,
        count: &str,
        condition: Option<(&str, &Truth)>,
        body: &[Statement],
        begin: impl FnOnce(&mut Self, &str),
    ) {
        let changed = self.changed(body);
        let before = self.values.clone();
        let (pass, goes_on) = (self.name(), self.name());
        let mut inputs = vec![ValueInfo::scalar(&pass, INT64), ValueInfo::scalar(&goes_on, BOOL)];
        let mut given = vec![count.to_string(), condition.map_or(String::new(), |(first, _)| first.into())];
        for &value in &changed {
            given.push(self.present(value));
            let name = self.name();
            inputs.push(self.info(value, &name));
            self.replace(value, name);
        }
        self.nodes.push(Vec::new());
        begin(self, &pass);
        self.block(body);
        let next = match condition {
            Some((_, condition)) => self.truth(condition),
            None => goes_on,
        };
        let mut outputs = Vec::new();
        let name = self.node("Identity", &[&next]);
        outputs.push(ValueInfo::scalar(&name, BOOL));
        outputs.extend(self.outputs(&changed));
        let nodes = self.nodes.pop().unwrap_or_default();
        let body = Graph { nodes, name: self.name(), initializers: Vec::new(), inputs, outputs };
        self.values = before;
        let results: Vec<String> = changed.iter().map(|_| self.name()).collect();
        let given: Vec<&str> = given.iter().map(String::as_str).collect();
        self.add("Loop", &given, results.clone(), vec![Attribute::graph("body", body)]);
        changed.iter().zip(results).for_each(|(&value, name)| self.replace(value, name));
    }

    fn branch(&mut self, condition: &Truth, yes: &[Statement], no: &[Statement]) {
        if let Some(holds) = self.known_truth(condition) {
            return self.block(if holds { yes } else { no });
        }
        let condition = self.truth(condition);
        let mut changed = self.changed(yes);
        changed.extend(self.changed(no));
        changed.sort_unstable();
        changed.dedup();
        if changed.is_empty() {
            return;
        }
        let before = self.values.clone();
        let [yes, no] = [yes, no].map(|statements| {
            self.nodes.push(Vec::new());
            self.block(statements);
            let outputs = self.outputs(&changed);
            let nodes = self.nodes.pop().unwrap_or_default();
            self.values = before.clone();
            Graph { nodes, name: self.name(), initializers: Vec::new(), inputs: Vec::new(), outputs }
        });
        let results: Vec<String> = changed.iter().map(|_| self.name()).collect();
        let branches = vec![Attribute::graph("then_branch", yes), Attribute::graph("else_branch", no)];
        self.add("If", &[&condition], results.clone(), branches);
        changed.iter().zip(results).for_each(|(&value, name)| self.replace(value, name));
    }

    /// The values from outside that statements change.
    fn changed(&self, statements: &[Statement]) -> Vec<ChangedValue> {
        let mut all = Vec::new();
        every(statements, &mut |statement| match statement {
            Statement::Assign(variable, _) => all.push(ChangedValue::Real(*variable)),
            Statement::AssignWhole(variable, _) => all.push(ChangedValue::Whole(*variable)),
            Statement::Set(array, _, _) => all.push(ChangedValue::Array(*array)),
            _ => {}
        });
        all.retain(|value| match value {
            ChangedValue::Real(variable) => self.values.reals.contains_key(variable),
            ChangedValue::Whole(variable) => self.values.wholes.contains_key(variable),
            ChangedValue::Array(_) => true,
        });
        all.sort_unstable();
        all.dedup();
        all
    }

    fn present(&self, value: ChangedValue) -> String {
        match value {
            ChangedValue::Real(variable) => self.values.reals[&variable].clone(),
            ChangedValue::Whole(variable) => self.values.wholes[&variable].clone(),
            ChangedValue::Array(array) => self.values.arrays[&array].clone(),
        }
    }

    fn replace(&mut self, value: ChangedValue, name: String) {
        match value {
            ChangedValue::Real(variable) => {
                self.values.reals.insert(variable, name);
            }
            ChangedValue::Whole(variable) => {
                self.values.wholes.insert(variable, name);
                self.values.known.remove(&variable);
            }
            ChangedValue::Array(array) => {
                self.values.arrays.insert(array, name);
            }
        }
    }

    fn info(&self, value: ChangedValue, name: &str) -> ValueInfo {
        match value {
            ChangedValue::Real(_) => ValueInfo::scalar(name, DOUBLE),
            ChangedValue::Whole(_) => ValueInfo::scalar(name, INT64),
            ChangedValue::Array(array) => ValueInfo::row(name, self.program.declaration(array).storage.len()),
        }
    }

    /// The outputs of a subgraph: each is made inside it.
    fn outputs(&mut self, changed: &[ChangedValue]) -> Vec<ValueInfo> {
        let one = |value: &ChangedValue| {
            let inside = self.present(*value);
            let name = self.node("Identity", &[&inside]);
            self.info(*value, &name)
        };
        changed.iter().map(one).collect()
    }

    fn known(&self, value: &Whole) -> Option<i64> {
        match value {
            Whole::Constant(value) => Some(*value),
            Whole::Variable(variable) => self.values.known.get(variable).copied(),
            Whole::Sum(a, b) => Some(self.known(a)? + self.known(b)?),
            Whole::Difference(a, b) => Some(self.known(a)? - self.known(b)?),
            Whole::Product(a, b) => Some(self.known(a)? * self.known(b)?),
            Whole::OfReal(_) => None,
        }
    }

    fn known_truth(&self, condition: &Truth) -> Option<bool> {
        match condition {
            Truth::Whole(comparison, a, b) => {
                let (a, b) = (self.known(a)?, self.known(b)?);
                Some(comparison.holds(a, b))
            }
            Truth::Not(a) => Some(!self.known_truth(a)?),
            Truth::Real(..) | Truth::And(..) | Truth::Or(..) => None,
        }
    }

    fn whole(&mut self, value: &Whole) -> String {
        if let Some(known) = self.known(value) {
            return self.whole_constant(known);
        }
        match value {
            Whole::Constant(value) => self.whole_constant(*value),
            Whole::Variable(variable) => self.values.wholes[variable].clone(),
            Whole::Sum(a, b) => self.whole_pair("Add", a, b),
            Whole::Difference(a, b) => self.whole_pair("Sub", a, b),
            Whole::Product(a, b) => self.whole_pair("Mul", a, b),
            Whole::OfReal(value) => {
                let value = self.real(value);
                self.cast(&value, INT64)
            }
        }
    }

    fn whole_pair(&mut self, operation: &str, a: &Whole, b: &Whole) -> String {
        let (a, b) = (self.whole(a), self.whole(b));
        self.node(operation, &[&a, &b])
    }

    fn cast(&mut self, value: &str, to: i32) -> String {
        let name = self.name();
        let to = vec![Attribute::integer("to", usize::try_from(to).unwrap_or_default())];
        self.add("Cast", &[value], vec![name.clone()], to);
        name
    }

    fn real(&mut self, value: &Real) -> String {
        match value {
            Real::Constant(value) => self.constant(*value),
            Real::Variable(variable) => self.values.reals[variable].clone(),
            Real::Element(array, index) if *array == self.program.arguments => {
                let place = self.known(index).and_then(|place| usize::try_from(place).ok());
                place.and_then(|place| self.arguments.get(place)).cloned().unwrap_or_default()
            }
            Real::Element(array, index) => {
                let values = self.values.arrays[array].clone();
                if self.is_all(*array, index) {
                    return values;
                }
                let index = self.whole(index);
                self.node("Gather", &[&values, &index])
            }
            Real::Unary(function, a) => {
                let a = self.real(a);
                self.unary(*function, &a)
            }
            Real::Binary(function, a, b) => {
                let (a, b) = (self.real(a), self.real(b));
                self.binary(*function, &a, &b)
            }
            Real::Fused(a, b, c) => {
                let [a, b, c] = [a, b, c].map(|part| self.real(part));
                let product = self.node("Mul", &[&a, &b]);
                self.node("Add", &[&product, &c])
            }
            Real::Choice(condition, yes, no) => {
                let condition = self.truth(condition);
                let (yes, no) = (self.real(yes), self.real(no));
                self.node("Where", &[&condition, &yes, &no])
            }
            Real::OfWhole(value) => {
                let value = self.whole(value);
                self.cast(&value, DOUBLE)
            }
        }
    }

    fn unary(&mut self, function: Unary, a: &str) -> String {
        match function {
            Unary::Detached => a.to_string(),
            Unary::Negative => self.node("Neg", &[a]),
            Unary::Magnitude => self.node("Abs", &[a]),
            Unary::SquareRoot => self.node("Sqrt", &[a]),
            Unary::Exp => self.node("Exp", &[a]),
            Unary::ExpMinusOne => self.exp_minus_one(a),
            Unary::Ln => self.node("Log", &[a]),
            Unary::LnOnePlus => self.ln_one_plus(a),
            Unary::Tanh => self.node("Tanh", &[a]),
            Unary::InverseSinh => self.inverse_sinh(a),
            Unary::Ceiling => self.node("Ceil", &[a]),
            Unary::PowerOfTwo => {
                let two = self.constant(2.0);
                self.node("Pow", &[&two, a])
            }
        }
    }

    fn binary(&mut self, function: Binary, a: &str, b: &str) -> String {
        match function {
            Binary::Sum => self.node("Add", &[a, b]),
            Binary::Difference => self.node("Sub", &[a, b]),
            Binary::Product => self.node("Mul", &[a, b]),
            Binary::Quotient => self.node("Div", &[a, b]),
            Binary::Power => self.node("Pow", &[a, b]),
            Binary::CopySign => self.copy_sign(a, b),
            Binary::Hypotenuse => self.hypotenuse(a, b),
        }
    }

    /// `ln w · a/(w - 1)` with `w = 1 + a`, which is accurate near 0.
    fn ln_one_plus(&mut self, a: &str) -> String {
        let one = self.constant(1.0);
        let w = self.node("Add", &[&one, a]);
        let rest = self.node("Sub", &[&w, &one]);
        let log = self.node("Log", &[&w]);
        let share = self.node("Div", &[a, &rest]);
        let value = self.node("Mul", &[&log, &share]);
        let is_tiny = self.node("Equal", &[&w, &one]);
        let infinite = self.constant(f64::INFINITY);
        let is_infinite = self.node("Equal", &[&w, &infinite]);
        let value = self.node("Where", &[&is_infinite, &w, &value]);
        self.node("Where", &[&is_tiny, a, &value])
    }

    /// `(u - 1) a/ln u` with `u = e^a`, which is accurate near 0.
    fn exp_minus_one(&mut self, a: &str) -> String {
        let one = self.constant(1.0);
        let u = self.node("Exp", &[a]);
        let rest = self.node("Sub", &[&u, &one]);
        let log = self.node("Log", &[&u]);
        let share = self.node("Div", &[a, &log]);
        let value = self.node("Mul", &[&rest, &share]);
        // Far from 0 there is no difference of nearly equal numbers.
        let size = self.node("Abs", &[a]);
        let is_far = self.node("Less", &[&one, &size]);
        let value = self.node("Where", &[&is_far, &rest, &value]);
        let is_tiny = self.node("Equal", &[&u, &one]);
        self.node("Where", &[&is_tiny, a, &value])
    }

    fn inverse_sinh(&mut self, a: &str) -> String {
        let one = self.constant(1.0);
        let size = self.node("Abs", &[a]);
        let inverse = self.node("Div", &[&one, &size]);
        let root = self.hypotenuse(&one, &inverse);
        let root = self.node("Add", &[&root, &inverse]);
        let share = self.node("Div", &[&size, &root]);
        let sum = self.node("Add", &[&size, &share]);
        let value = self.ln_one_plus(&sum);
        self.copy_sign(&value, a)
    }

    fn hypotenuse(&mut self, a: &str, b: &str) -> String {
        let (a, b) = (self.node("Abs", &[a]), self.node("Abs", &[b]));
        let is_less = self.node("Less", &[&a, &b]);
        let large = self.node("Where", &[&is_less, &b, &a]);
        let small = self.node("Where", &[&is_less, &a, &b]);
        let share = self.node("Div", &[&small, &large]);
        let (one, zero) = (self.constant(1.0), self.constant(0.0));
        let square = self.node("Mul", &[&share, &share]);
        let sum = self.node("Add", &[&one, &square]);
        let root = self.node("Sqrt", &[&sum]);
        let value = self.node("Mul", &[&large, &root]);
        let is_zero = self.node("Equal", &[&large, &zero]);
        self.node("Where", &[&is_zero, &zero, &value])
    }

    fn copy_sign(&mut self, a: &str, sign: &str) -> String {
        let (zero, one) = (self.constant(0.0), self.constant(1.0));
        let size = self.node("Abs", &[a]);
        let opposite = self.node("Neg", &[&size]);
        let is_below = self.node("Less", &[sign, &zero]);
        // The inverse of a negative 0 is negative.
        let inverse = self.node("Div", &[&one, sign]);
        let is_inverse_below = self.node("Less", &[&inverse, &zero]);
        let is_negative = self.node("Or", &[&is_below, &is_inverse_below]);
        self.node("Where", &[&is_negative, &opposite, &size])
    }

    fn truth(&mut self, condition: &Truth) -> String {
        let operation = |comparison: &Relation| match comparison {
            Relation::Below => "Less",
            Relation::AtMost => "LessOrEqual",
            Relation::Equal => "Equal",
        };
        match condition {
            Truth::Real(comparison, a, b) => {
                let (a, b) = (self.real(a), self.real(b));
                self.node(operation(comparison), &[&a, &b])
            }
            Truth::Whole(comparison, a, b) => {
                let (a, b) = (self.whole(a), self.whole(b));
                self.node(operation(comparison), &[&a, &b])
            }
            Truth::And(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                self.node("And", &[&a, &b])
            }
            Truth::Or(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                self.node("Or", &[&a, &b])
            }
            Truth::Not(a) => {
                let a = self.truth(a);
                self.node("Not", &[&a])
            }
        }
    }
}
