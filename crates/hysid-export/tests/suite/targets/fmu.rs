//! Exports as Functional Mock-up Units, run by FMPy.

use std::fs;
use std::process::Command;

use hysid_export::{FmiVersion, Options, Target};

use super::case::{Case, MODELS, NAME, written};
use super::tools::{python, succeeds, tool};

/// Validates a unit, and reads rows of arguments in binary.
pub const OPENED: &str = "
import sys
import fmpy, numpy as np
from fmpy.validation import validate_fmu

assert validate_fmu('actuator.fmu') == [], validate_fmu('actuator.fmu')
has_time = sys.argv[2] == 'true'
rows = np.fromfile('rows').reshape(-1, int(sys.argv[1]))
steps = rows[:, -1] if has_time else np.ones(len(rows))
inputs = rows[:, :-1] if has_time else rows
description = fmpy.read_model_description('actuator.fmu')
names = [v.name for v in description.modelVariables if v.causality == 'input']
references = [v.valueReference for v in description.modelVariables if v.causality == 'input']
";

/// Simulates rows of arguments in binary as an importer does, writes outputs in binary, and tries what importers do
/// besides.
const DRIVER: &str = "
output = [v.valueReference for v in description.modelVariables if v.causality == 'output']
folder = fmpy.extract('actuator.fmu')

class Unit:
    def __init__(self):
        self.fmu = fmpy.instantiate_fmu(folder, description, 'CoSimulation')
        self.three = description.fmiVersion.startswith('3')
        self.get = self.fmu.getFloat64 if self.three else self.fmu.getReal
        self.put = self.fmu.setFloat64 if self.three else self.fmu.setReal
        self.time = 0.0
        if not self.three:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.put(references, list(inputs[0]))
        self.fmu.exitInitializationMode()
    def row(self, k):
        if k > 0:
            self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=steps[k])
            self.time += steps[k]
            self.put(references, list(inputs[k]))
        return self.get(output)[0]

# Ten instances at once, each at its own place; the state saved, rewound and repeated.
units = [Unit() for _ in range(10)]
found = [[] for _ in units]
for k in range(0, len(rows) + 10):
    for number, unit in enumerate(units):
        if 0 <= k - number < len(rows):
            found[number].append(unit.row(k - number))
            if number == 3 and k - number == 100:
                f = unit.fmu
                state = f.getFMUState() if unit.three else f.getFMUstate()
                if unit.three:
                    bytes_ = f.serializeFMUState(state)
                    state = f.deserializeFMUState(bytes_)
                else:
                    bytes_ = f.serializeFMUstate(state)
                    state = f.deSerializeFMUstate(bytes_)
                time = unit.time
                first = [unit.row(j) for j in range(101, 150)]
                f.setFMUState(state) if unit.three else f.setFMUstate(state)
                unit.time = time
                second = [unit.row(j) for j in range(101, 150)]
                assert first == second
                f.setFMUState(state) if unit.three else f.setFMUstate(state)
                unit.time = time
for other in found[1:]:
    assert other == found[0]
np.array(found[0]).tofile('outputs')

# A whole simulation by FMPy: its outputs are those of the inputs at the beginning of each step.
h = 0.01
t = h * np.arange(len(rows))
signals = np.array([(time, *row) for time, row in zip(t, inputs)], dtype=[('time', float)] + [(n, float) for n in names])
result = fmpy.simulate_fmu('actuator.fmu', stop_time=t[-1], output_interval=h, step_size=h, input=signals)
once = Unit()
steps = np.full(len(rows), h)
expected = [once.row(k) for k in range(len(rows))]
simulated = result[result.dtype.names[1]]
assert len(simulated) == len(expected), (len(simulated), len(expected))
scale = max(map(abs, expected))
assert np.abs(simulated[1:] - expected[:-1]).max() <= 1e-9 * scale, np.abs(simulated[1:] - expected[:-1]).max()
";

#[test]
fn importers_find_nothing_wrong_and_outputs_equal_those_of_the_library() {
    const ROWS: usize = 400;
    let Some(_) = tool("binaries of FMUs", "cc", &["--version"], "run: sudo apt-get install gcc") else {
        return;
    };
    let Some(python) = python("exports as FMU", &["numpy", "fmpy"]) else { return };
    // One version for a model, in turns.
    for ((name, model), fmi) in MODELS.iter().zip([FmiVersion::Three, FmiVersion::Two].into_iter().cycle()) {
        let folder = written(model, Target::Fmu, &Options { fmi, ..Options::named(NAME) });
        let output = succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with("0 of "), "{name}, {fmi:?}: {text}");

        let case = Case::of(model, ROWS);
        fs::write(folder.path().join("rows"), case.bytes()).unwrap();
        let driver = format!("{OPENED}{DRIVER}");
        let arguments = ["-c", &driver, &case.arguments.len().to_string(), &case.has_time().to_string()];
        succeeds(Command::new(&python).current_dir(&folder).args(arguments));
        // The importer adds up the time steps, whose roundings reach rates.
        let difference = case.difference(name, &fs::read(folder.path().join("outputs")).unwrap());
        println!("{name}: {difference:.1e}");
        assert!(difference <= 1e-12, "{name}, {fmi:?}: {difference:e}");
    }
}
