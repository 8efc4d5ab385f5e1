//! ONNX: a step as a graph with the state as input and output, and a whole record as a scan of such steps.

mod graph;
mod lanes;
mod messages;

use prost::Message;

use crate::error::Error;
use crate::program::Program;
use crate::subject::{File, Subject};
use crate::target::{BackEnd, Written};
use graph::{NEXT_STATE, OUTPUT, STATE, row};
use messages::{Attribute, Entry, Graph, Model, Node, OperatorSet, ValueInfo};

pub(super) const BACK_END: BackEnd =
    BackEnd { name: "onnx", has_single_precision: false, has_inverse: false, reserved: &[], write, usage };

/// Version of the format, and of its operators, as of ONNX 1.12.
const FORMAT: i64 = 8;
const OPERATORS: i64 = 17;

fn write(subject: &Subject<'_>) -> Result<Written, Error> {
    let name = subject.name();
    let arguments = subject.argument_names();
    let step = graph::step(subject.program(), &arguments, false);
    let tangent = graph::step(subject.tangent(), &arguments, true);
    let record = record(subject.program(), &arguments, step.clone());
    let file = |ending: &str, graph: Graph| {
        File::new(format!("{name}{ending}.onnx"), model(subject, graph).encode_to_vec())
    };
    Ok(vec![
        file("", record),
        file("_step", step),
        file("_tangent", tangent),
        File::new(format!("{name}_test.py"), self_test(subject)),
    ]
    .into())
}

fn usage(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names();
    let columns: Vec<String> = arguments.iter().map(|name| format!("\"{name}\": {name}")).collect();
    let values: Vec<String> =
        arguments.iter().map(|name| format!("\"{name}\": np.array({name}, dtype=float)")).collect();
    let time = match arguments.iter().any(|name| name == "time_step") {
        true => "\n`time_step` is the time since the row before; that of the first row is ignored.\n",
        false => "",
    };
    format!(
        "All numbers are of double precision.

- `{name}.onnx`: a whole record from the initial state. Inputs and output `y` have a number for each row; `next_state` is
  the state at the end.
- `{name}_step.onnx`: a step. Inputs `state` and scalars, outputs `y` and `next_state`. The initial state is in the
  metadata, entry `initial_state`.
- `{name}_tangent.onnx`: the same, and `slope`, the slope of `y` by `x`; at a kink that of the branch taken.

```python
import json
import numpy as np
import onnxruntime

record = onnxruntime.InferenceSession(\"{name}.onnx\")
y, state = record.run(None, {{{columns}}})

step = onnxruntime.InferenceSession(\"{name}_step.onnx\")
state = np.array(json.loads(step.get_modelmeta().custom_metadata_map[\"initial_state\"]))
y, state = step.run(None, {{\"state\": state, {values}}})
```
{time}
A trial is a step whose `next_state` is not used, a commit one whose `next_state` is the next `state`. `python
{name}_test.py` runs the test vectors; it needs onnxruntime.
",
        columns = columns.join(", "),
        values = values.join(", "),
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
    let scan = Node {
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

fn model(subject: &Subject<'_>, graph: Graph) -> Model {
    let initial: Vec<String> = subject
        .program()
        .states()
        .flat_map(|(_, _, values)| values.iter().map(|value| format!("{value:?}")))
        .collect();
    let mut metadata =
        vec![Entry { key: "initial_state".into(), value: format!("[{}]", initial.join(", ")) }];
    metadata.extend(subject.facts().into_iter().map(|(key, value)| Entry { key, value }));
    Model {
        ir_version: FORMAT,
        producer_name: "Hysid".into(),
        producer_version: env!("CARGO_PKG_VERSION").into(),
        doc_string: "A model of hysteresis, written by Hysid.".into(),
        graph: Some(graph),
        opset_import: vec![OperatorSet { domain: String::new(), version: OPERATORS }],
        metadata,
    }
}

fn self_test(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let arguments = subject.argument_names();
    let names: Vec<String> = arguments.iter().map(|name| format!("\"{name}\"")).collect();
    let (low, high) = subject.model().trained_ranges().output;
    format!(
        "\"\"\"Compares the ONNX models with the test vectors. Exit status 0 if all agree.\"\"\"

import csv
import json
import pathlib
import sys

import numpy as np
import onnxruntime

SCALE = {scale:?}
ARGUMENTS = [{names}]

folder = pathlib.Path(__file__).parent
step = onnxruntime.InferenceSession(str(folder / \"{name}_step.onnx\"), providers=[\"CPUExecutionProvider\"])
tangent = onnxruntime.InferenceSession(str(folder / \"{name}_tangent.onnx\"), providers=[\"CPUExecutionProvider\"])
initial = np.array(json.loads(step.get_modelmeta().custom_metadata_map[\"initial_state\"]))
state = after = saved = initial
differences = []
with (folder / \"test_vectors.csv\").open(newline=\"\") as file:
    for action, *numbers in list(csv.reader(file))[1:]:
        if action in (\"step\", \"trial\"):
            values = [np.array(float(number or 0)) for number in numbers]
            expected = values[len(ARGUMENTS)]
            given = dict(zip(ARGUMENTS, values), state=state)
            if action == \"step\":
                y, state = step.run([\"y\", \"next_state\"], given)
            else:
                y, slope, after = tangent.run([\"y\", \"slope\", \"next_state\"], given)
                differences.append(abs(slope - values[-1]) / (SCALE + abs(values[-1])))
            differences.append(abs(y - expected) / SCALE)
        elif action == \"reset\":
            state = initial
        elif action == \"commit\":
            state = after
        elif action == \"save\":
            saved = state
        elif action == \"restore\":
            state = saved
# One that is not a number is the largest.
largest = max(map(float, differences), key=lambda difference: (difference != difference, difference))
print(f\"{{len(differences)}} numbers differ by at most {{largest:.1e}} of half the trained range\")
sys.exit(0 if largest <= 1e-9 else 1)
",
        scale = 0.5 * (high - low),
        names = names.join(", "),
    )
}
