//! `modelDescription.xml`: variables with units, and what the FMU can do.

use std::collections::BTreeSet;

use hysid_core::data::unit;

use crate::description::Argument;
use crate::options::FmiVersion;
use crate::subject::ExportSubject;
use crate::target::template::filled;

/// Value references: the time has 0, then come the inputs, in the order of the step's arguments without the time step.
pub(super) const FIRST_INPUT: usize = 1;

pub(super) const OUTPUT: usize = 1000;

/// Value reference of half the width of the band.
pub(super) const HALF_WIDTH: usize = 1001;

/// In a unit of an inverse, value references of the model's output and of the reach.
pub(super) const MODEL_OUTPUT: usize = 1002;
pub(super) const REACH: usize = 1003;

struct FmuVariable {
    name: String,
    unit: Option<String>,
    description: String,
}

/// Values of the inputs before they are set: within the trained ranges, next to 0.
pub(super) fn start_values(subject: &ExportSubject<'_>) -> Vec<f64> {
    let ranges = subject.model().trained_ranges();
    let of = |argument: &Argument| match *argument {
        Argument::Input(input) => {
            let is_wanted = input == 0 && subject.inverse().is_some();
            let (low, high) = if is_wanted { ranges.output } else { ranges.inputs[input] };
            Some(0f64.clamp(low, high))
        }
        Argument::TimeStep => None,
        Argument::Rate => Some(0.0),
    };
    subject.description().arguments.iter().filter_map(of).collect()
}

const REACHES: &str = "whether the wanted output was reached: 0 reached, 1 beyond the lowest input, 2 beyond the highest \
                       input, 3 the input cannot change so quickly, 4 the model is not monotone, 5 the output jumps over \
                       it, -1 invalid time step";

/// The inputs, the outputs and, if there is a band, half its width.
fn variables(subject: &ExportSubject<'_>) -> Vec<FmuVariable> {
    let names = subject.names();
    let time = names.time.as_deref().and_then(unit::of_column);
    let of = |argument: &Argument| match *argument {
        Argument::Input(0) if subject.inverse().is_some() => Some(FmuVariable {
            name: format!("wanted {}", names.output),
            unit: unit::of_column(&names.output),
            description: "wanted output".into(),
        }),
        Argument::Input(input) => Some(FmuVariable {
            name: names.inputs[input].clone(),
            unit: unit::of_column(&names.inputs[input]),
            description: format!("input {}", input + 1),
        }),
        Argument::TimeStep => None,
        Argument::Rate => Some(FmuVariable {
            name: format!("rate of {}", names.inputs[0]),
            unit: match (unit::of_column(&names.inputs[0]), &time) {
                (Some(of), Some(time)) => Some(format!("{of}/{time}")),
                _ => None,
            },
            description: "rate of the first input per unit of time".into(),
        }),
    };
    let mut all: Vec<FmuVariable> = subject.description().arguments.iter().filter_map(of).collect();
    if subject.inverse().is_some() {
        all.push(FmuVariable {
            name: names.inputs[0].clone(),
            unit: unit::of_column(&names.inputs[0]),
            description: "input 1, for which the model has the wanted output or the nearest".into(),
        });
    }
    all.push(FmuVariable {
        name: names.output.clone(),
        unit: unit::of_column(&names.output),
        description: "output".into(),
    });
    if subject.inverse().is_some() {
        all.push(FmuVariable { name: "reach".into(), unit: None, description: REACHES.into() });
    }
    if subject.half_width().is_some() {
        all.push(FmuVariable {
            name: format!("half width of {}", names.output),
            unit: unit::of_column(&names.output),
            description: "half the width of the prediction band".into(),
        });
    }
    let mut taken = BTreeSet::from(["time".to_string()]);
    for variable in &mut all {
        while !taken.insert(variable.name.clone()) {
            variable.name.push('_');
        }
    }
    all
}

pub(super) fn variable_names(subject: &ExportSubject<'_>) -> (Vec<String>, Vec<String>) {
    let inputs = start_values(subject).len();
    let mut names = variables(subject).into_iter().map(|variable| variable.name);
    (names.by_ref().take(inputs).collect(), names.collect())
}

fn outputs(subject: &ExportSubject<'_>) -> Vec<usize> {
    let of_inverse = subject.inverse().map(|_| [MODEL_OUTPUT, REACH]);
    [OUTPUT]
        .into_iter()
        .chain(of_inverse.into_iter().flatten())
        .chain(subject.half_width().map(|_| HALF_WIDTH))
        .collect()
}

pub(super) fn model_description(subject: &ExportSubject<'_>, version: FmiVersion, token: &str) -> String {
    match version {
        FmiVersion::Three => version_three(subject, token),
        FmiVersion::Two => version_two(subject, token),
    }
}

fn version_three(subject: &ExportSubject<'_>, token: &str) -> String {
    let variables = variables(subject);
    let mut lines = vec![
        "    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"/>"
            .to_string(),
    ];
    for (index, (variable, kind)) in variables.iter().zip(kinds(subject)).enumerate() {
        let reference = reference(subject, index);
        lines.push(format!(
            "    <Float64 name=\"{}\" valueReference=\"{reference}\" {}{} description=\"{}\"/>",
            escaped(&variable.name),
            kind,
            unit_of(variable),
            variable.description
        ));
    }
    let inputs: Vec<String> =
        (0..start_values(subject).len()).map(|index| (FIRST_INPUT + index).to_string()).collect();
    let inputs = inputs.join(" ");
    let derivatives = match subject.inverse() {
        None => "\n    providesDirectionalDerivatives=\"true\" providesAdjointDerivatives=\"true\"",
        Some(_) => "",
    };
    let unknowns = |kind: &str| -> String {
        let line = |reference: &usize| {
            format!("    <{kind} valueReference=\"{reference}\" dependencies=\"{inputs}\"/>\n")
        };
        outputs(subject).iter().map(line).collect()
    };
    filled(
        include_str!("model_description_3.xml.txt"),
        &[
            ("NAME", subject.name()),
            ("@token@", token),
            ("@description@", &summary(subject)),
            ("@tool@", env!("CARGO_PKG_VERSION")),
            ("@derivatives@", derivatives),
            ("@units@", &units(&variables)),
            ("@lines@", &lines.join("\n")),
            ("@output_lines@", &unknowns("Output")),
            ("@unknown_lines@", &unknowns("InitialUnknown")),
        ],
    )
}

fn version_two(subject: &ExportSubject<'_>, token: &str) -> String {
    let variables = variables(subject);
    let name = subject.name();
    let lines: Vec<String> = variables
        .iter()
        .zip(kinds(subject))
        .enumerate()
        .map(|(index, (variable, kind))| {
            let (kind, start) =
                kind.split_once(" start=").map_or((kind.as_str(), None), |(a, b)| (a, Some(b)));
            let start = start.map_or(String::new(), |start| format!(" start={start}"));
            format!(
                "    <ScalarVariable name=\"{}\" valueReference=\"{}\" {kind} description=\"{}\">\n      \
                 <Real{}{start}/>\n    </ScalarVariable>",
                escaped(&variable.name),
                reference(subject, index),
                variable.description,
                unit_of(variable),
            )
        })
        .collect();
    let (derivative, inverse) = match subject.inverse() {
        None => (" providesDirectionalDerivative=\"true\"", String::new()),
        Some(_) => ("", format!("      <File name=\"{name}_inverse.c\"/>\n")),
    };
    // In version 2, dependencies are places in the list of variables, from 1 on.
    let count = start_values(subject).len();
    let inputs: Vec<String> = (1..=count).map(|place| place.to_string()).collect();
    let inputs = inputs.join(" ");
    let unknowns: String = (count + 1..=variables.len())
        .map(|place| format!("      <Unknown index=\"{place}\" dependencies=\"{inputs}\"/>\n"))
        .collect();
    filled(
        include_str!("model_description_2.xml.txt"),
        &[
            ("NAME", name),
            ("@token@", token),
            ("@description@", &summary(subject)),
            ("@tool@", env!("CARGO_PKG_VERSION")),
            ("@derivative@", derivative),
            ("@inverse@", &inverse),
            ("@units@", &units(&variables)),
            ("@lines@", &lines.join("\n")),
            ("@unknowns@", &unknowns),
        ],
    )
}

/// `sources/buildDescription.xml` of version 3.
pub(super) fn build_description(subject: &ExportSubject<'_>) -> String {
    let name = subject.name();
    let inverse = match subject.inverse() {
        None => String::new(),
        Some(_) => format!("      <SourceFile name=\"{name}_inverse.c\"/>\n"),
    };
    filled(include_str!("build_description.xml.txt"), &[("NAME", name), ("@inverse@", &inverse)])
}

/// Causality, variability and start value of each variable.
fn kinds(subject: &ExportSubject<'_>) -> Vec<String> {
    let input = |start: &f64| format!("causality=\"input\" variability=\"continuous\" start=\"{start:?}\"");
    let mut kinds: Vec<String> = start_values(subject).iter().map(input).collect();
    let output = || "causality=\"output\" variability=\"continuous\" initial=\"calculated\"".to_string();
    kinds.extend(outputs(subject).iter().map(|_| output()));
    kinds
}

fn reference(subject: &ExportSubject<'_>, index: usize) -> usize {
    let inputs = start_values(subject).len();
    if index < inputs { FIRST_INPUT + index } else { outputs(subject)[index - inputs] }
}

fn unit_of(variable: &FmuVariable) -> String {
    variable.unit.as_ref().map_or(String::new(), |unit| format!(" unit=\"{}\"", escaped(unit)))
}

fn units(variables: &[FmuVariable]) -> String {
    let units: BTreeSet<&String> = variables.iter().filter_map(|variable| variable.unit.as_ref()).collect();
    if units.is_empty() {
        return String::new();
    }
    let lines: String =
        units.iter().map(|unit| format!("    <Unit name=\"{}\"/>\n", escaped(unit))).collect();
    format!("  <UnitDefinitions>\n{lines}  </UnitDefinitions>\n")
}

/// The facts about the model, in a line.
fn summary(subject: &ExportSubject<'_>) -> String {
    let facts: Vec<String> = subject.facts().iter().map(|(fact, text)| format!("{fact}: {text}")).collect();
    let what = if subject.inverse().is_some() { "The inverse of a model" } else { "A model" };
    escaped(&format!("{what} of hysteresis, written by Hysid. {}", facts.join("; ")))
}

/// [Harmless](crate::text) text inside an attribute of XML.
fn escaped(text: &str) -> String {
    text.chars()
        .map(|letter| match letter {
            '&' => "&amp;".to_string(),
            '<' => "&lt;".into(),
            '>' => "&gt;".into(),
            '"' => "&quot;".into(),
            letter => letter.into(),
        })
        .collect()
}
