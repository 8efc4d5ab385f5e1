//! ONNX: a step as a graph with the state as input and output, and a whole record as a scan of such steps.

mod graph;
mod lanes;
mod messages;

use prost::Message;

use crate::error::Error;
use crate::program::Program;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::template::filled;
use crate::target::{BackEnd, TargetFiles};
use graph::{NEXT_STATE, OUTPUT, STATE, row};
use messages::{Attribute, Graph, OnnxEntry, OnnxModel, OnnxNode, OperatorSet, ValueInfo};

pub(super) const BACK_END: BackEnd =
    BackEnd { name: "onnx", has_single_precision: false, has_inverse: false, reserved: &[], write, usage };

/// Version of the format, and of its operators, as of ONNX 1.12.
const FORMAT: i64 = 8;
const OPERATORS: i64 = 17;

fn write(subject: &ExportSubject<'_>) -> Result<TargetFiles, Error> {
    let name = subject.name();
    let arguments = subject.argument_names();
    let step = graph::step(subject.program(), &arguments, false);
    let tangent = graph::step(subject.tangent(), &arguments, true);
    let record = record(subject.program(), &arguments, step.clone());
    let file = |ending: &str, graph: Graph| {
        ExportFile::new(format!("{name}{ending}.onnx"), model(subject, graph).encode_to_vec())
    };
    Ok(vec![
        file("", record),
        file("_step", step),
        file("_tangent", tangent),
        ExportFile::new(format!("{name}_test.py"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names();
    let columns: Vec<String> = arguments.iter().map(|name| format!("\"{name}\": {name}")).collect();
    let values: Vec<String> =
        arguments.iter().map(|name| format!("\"{name}\": np.array({name}, dtype=float)")).collect();
    let time = match arguments.iter().any(|name| name == "time_step") {
        true => "\n`time_step` is the time since the row before; that of the first row is ignored.\n",
        false => "",
    };
    filled(
        include_str!("onnx/usage.md.txt"),
        &[
            ("NAME", name),
            ("@columns@", &columns.join(", ")),
            ("@values@", &values.join(", ")),
            ("@time@", time),
        ],
    )
}

fn record(program: &Program, arguments: &[String], mut step: Graph) -> Graph {
    // A scan gives states first.
    step.outputs.rotate_right(1);
    let initial: Vec<f64> = program.states().flat_map(|(_, _, values)| values.iter().copied()).collect();
    let mut inputs = vec!["initial_state".to_string()];
    inputs.extend(arguments.iter().cloned());
    // Names of a graph inside another one are its own.
    let renamed = |name: &str| format!("row_{name}");
    rename(&mut step, &|name| {
        (arguments.contains(name) || [STATE, NEXT_STATE, OUTPUT].contains(&name.as_str()))
            .then(|| renamed(name))
    });
    let scan = OnnxNode {
        inputs,
        outputs: vec![NEXT_STATE.into(), OUTPUT.into()],
        operation: "Scan".into(),
        attributes: vec![
            Attribute::graph("body", step),
            Attribute::integer("num_scan_inputs", arguments.len()),
        ],
    };
    Graph {
        nodes: vec![scan],
        name: "record".into(),
        initializers: vec![row("initial_state", &initial)],
        inputs: arguments.iter().map(|argument| ValueInfo::record(argument)).collect(),
        outputs: vec![ValueInfo::record(OUTPUT), ValueInfo::row(NEXT_STATE, program.state_len())],
    }
}

/// Gives values of a graph and its subgraphs other names.
fn rename(graph: &mut Graph, new: &impl Fn(&String) -> Option<String>) {
    let change = |name: &mut String| {
        if let Some(new) = new(name) {
            *name = new;
        }
    };
    graph.inputs.iter_mut().chain(&mut graph.outputs).for_each(|value| change(&mut value.name));
    for node in &mut graph.nodes {
        node.inputs.iter_mut().chain(&mut node.outputs).for_each(change);
        for inner in node.attributes.iter_mut().filter_map(|attribute| attribute.graph.as_mut()) {
            rename(inner, new);
        }
    }
}

fn model(subject: &ExportSubject<'_>, graph: Graph) -> OnnxModel {
    let initial: Vec<String> = subject
        .program()
        .states()
        .flat_map(|(_, _, values)| values.iter().map(|value| format!("{value:?}")))
        .collect();
    let mut metadata =
        vec![OnnxEntry { key: "initial_state".into(), value: format!("[{}]", initial.join(", ")) }];
    metadata.extend(subject.facts().into_iter().map(|(key, value)| OnnxEntry { key, value }));
    OnnxModel {
        ir_version: FORMAT,
        producer_name: "Hysid".into(),
        producer_version: env!("CARGO_PKG_VERSION").into(),
        doc_string: "A model of hysteresis, written by Hysid.".into(),
        graph: Some(graph),
        opset_import: vec![OperatorSet { domain: String::new(), version: OPERATORS }],
        metadata,
    }
}

fn self_test(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names();
    let names: Vec<String> = arguments.iter().map(|name| format!("\"{name}\"")).collect();
    let (low, high) = subject.model().trained_ranges().output;
    filled(
        include_str!("onnx/test.py.txt"),
        &[("@scale@", &format!("{:?}", 0.5 * (high - low))), ("@names@", &names.join(", ")), ("NAME", name)],
    )
}
