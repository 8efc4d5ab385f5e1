//! A program that runs the test vectors with FMPy.

use crate::description::Argument;
use crate::inverse::Inverse;
use crate::subject::Subject;
use crate::target::template::filled;

pub(super) fn self_test(subject: &Subject<'_>) -> String {
    let arguments = &subject.description().arguments;
    let time_step = arguments.iter().position(|argument| *argument == Argument::TimeStep);
    let inputs: Vec<String> = (0..arguments.len())
        .filter(|index| Some(*index) != time_step)
        .map(|index| index.to_string())
        .collect();
    let (low, high) = subject.model().trained_ranges().output;
    format!(
        "\"\"\"Compares {name}.fmu with the test vectors. Exit status 0 if all agree.\"\"\"

import csv
import pathlib
import shutil
import sys

import fmpy

SCALE = {scale:?}
INPUTS = [{inputs}]  # columns of the inputs among the {count} arguments
TIME_STEP = {time_step}  # column of the time step

folder = pathlib.Path(__file__).parent
path = str(folder / \"{name}.fmu\")
description = fmpy.read_model_description(path, validate=True)
references = {{variable.name: variable.valueReference for variable in description.modelVariables}}
inputs = [v.valueReference for v in description.modelVariables if v.causality == \"input\"]
output = [v.valueReference for v in description.modelVariables if v.causality == \"output\"]
unpacked = fmpy.extract(path)
fmu = fmpy.instantiate_fmu(unpacked, description, \"CoSimulation\")
is_three = description.fmiVersion.startswith(\"3\")
get = fmu.getFloat64 if is_three else fmu.getReal
put = fmu.setFloat64 if is_three else fmu.setReal
save = fmu.getFMUState if is_three else fmu.getFMUstate
restore = fmu.setFMUState if is_three else fmu.setFMUstate
differences = []
time = 0.0
is_first = True


def begin():
    global time, is_first
    time, is_first = 0.0, True
    fmu.reset()
    if not is_three:
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()


def row(arguments):
    \"\"\"Go on by the time step, and set the inputs there.\"\"\"
    global time
    if not is_first:
        step = arguments[TIME_STEP] if TIME_STEP is not None else 1.0
        fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)
        time += step
    put(inputs, [arguments[column] for column in INPUTS])


def compare(expected, tangent=None):
    differences.append(abs(get(output)[0] - expected) / SCALE)
    if tangent is not None:
        slope = fmu.getDirectionalDerivative(output[:1], inputs[:1], [1.0])[0]
        differences.append(abs(slope - tangent) / (SCALE + abs(tangent)))


# A row is committed when the next begins: what a trial displaces is set again at the same point.
with (folder / \"test_vectors.csv\").open(newline=\"\") as file:
    vectors = [(action, [float(n) if n else 0.0 for n in numbers]) for action, *numbers in list(csv.reader(file))[1:]]
saved, saved_time = None, None
is_new = True
for action, numbers in vectors:
    arguments, expected, tangent = numbers[:{count}], numbers[{count}], numbers[{count} + 1]
    if action == \"reset\":
        begin()
        is_new = True
    elif action in (\"step\", \"trial\"):
        if is_new:
            row(arguments)
            is_first, is_new = False, False
        else:
            put(inputs, [arguments[column] for column in INPUTS])
        compare(expected, tangent if action == \"trial\" else None)
        is_new = action == \"step\"
    elif action == \"commit\":
        is_new = True
    elif action == \"save\":
        saved, saved_time = save(), time
    elif action == \"restore\":
        restore(saved)
        time = saved_time
fmu.terminate()
fmu.freeInstance()
shutil.rmtree(unpacked, ignore_errors=True)
# One that is not a number is the largest.
largest = max(differences, key=lambda difference: (difference != difference, difference))
different = sum(difference != 0.0 for difference in differences)
print(f\"{{different}} of {{len(differences)}} numbers differ, by at most {{largest:.1e}} of half the trained range\")
sys.exit(0 if largest <= 1e-9 else 1)
",
        name = subject.name(),
        scale = 0.5 * (high - low),
        inputs = inputs.join(", "),
        count = subject.argument_names().len(),
        time_step = time_step.map_or("None".into(), |index| index.to_string()),
    )
}

/// The text of the program for a unit of an inverse.
pub(super) fn of_inverse(subject: &Subject<'_>, inverse: &Inverse) -> String {
    let time_step = inverse.arguments.iter().position(|argument| *argument == Argument::TimeStep);
    let (low, high) = subject.model().trained_ranges().output;
    filled(
        include_str!("inverse_test.py.txt"),
        &[
            ("NAME", subject.name()),
            ("@scale@", &format!("{:?}", 0.5 * (high - low))),
            ("@inputs@", &(1 + inverse.arguments.len() - usize::from(time_step.is_some())).to_string()),
            ("@time_step@", &time_step.map_or("None".into(), |place| (place + 1).to_string())),
        ],
    )
}
