//! Inverses as Functional Mock-up Units, run by FMPy.

use std::fs;
use std::process::Command;

use hysid_core::model::BandLevel;
use hysid_export::description::Argument;
use hysid_export::{FmiVersion, InverseOptions, Options, Target};

use super::case::{MODELS, NAME, written};
use super::fmu::OPENED;
use super::inverse_case::{InverseCase, code, tight};
use super::tools::{python, succeeds, tool};

/// Runs rows of arguments in binary as an importer does, writes inputs, outputs and reaches in binary, and tries what
/// importers do besides.
const DRIVER: &str = "
outputs = [v.valueReference for v in description.modelVariables if v.causality == 'output'][:3]
folder = fmpy.extract('actuator.fmu')

class Unit:
    def __init__(self):
        self.fmu = fmpy.instantiate_fmu(folder, description, 'CoSimulation')
        self.three = description.fmiVersion.startswith('3')
        self.get = self.fmu.getFloat64 if self.three else self.fmu.getReal
        self.put = self.fmu.setFloat64 if self.three else self.fmu.setReal
        self.time = steps[0]
        if self.three:
            self.fmu.enterInitializationMode(startTime=self.time)
        else:
            self.fmu.setupExperiment(startTime=self.time)
            self.fmu.enterInitializationMode()
        self.put(references, list(inputs[0]))
        self.fmu.exitInitializationMode()
    def row(self, k):
        if k > 0:
            self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=steps[k])
            self.time += steps[k]
            self.put(references, list(inputs[(k + 7) % len(rows)]))
            self.get(outputs[:1])
            self.put(references, list(inputs[k]))
        return self.get(outputs)
    def repeat(self, k):
        # The state saved, serialised, rewound and repeated.
        f = self.fmu
        if self.three:
            state = f.deserializeFMUState(f.serializeFMUState(f.getFMUState()))
        else:
            state = f.deSerializeFMUstate(f.serializeFMUstate(f.getFMUstate()))
        time, found = self.time, []
        for _ in range(2):
            found.append([self.row(j) for j in range(k, k + 40)])
            f.setFMUState(state) if self.three else f.setFMUstate(state)
            self.time = time
        assert found[0] == found[1]

units = [Unit() for _ in range(3)]
found = [[] for _ in units]
for k in range(0, len(rows) + 3):
    for number, unit in enumerate(units):
        if 0 <= k - number < len(rows):
            if number == 1 and k - number == 100:
                unit.repeat(100)
            found[number].append(unit.row(k - number))
assert found[1] == found[0] and found[2] == found[0]
np.array(found[0]).tofile('outputs')

# A whole simulation by FMPy.
h = 0.01
t = h * np.arange(len(rows))
signals = np.array([(time, *row) for time, row in zip(t, inputs)], dtype=[('time', float)] + [(n, float) for n in names])
result = fmpy.simulate_fmu('actuator.fmu', stop_time=t[-1], output_interval=h, step_size=h, input=signals)
assert len(result) == len(rows)
";

#[test]
fn importers_find_nothing_wrong_and_units_of_inverses_agree() {
    const ROWS: usize = 300;
    let Some(_) = tool("binaries of FMUs", "cc", &["--version"], "run: sudo apt-get install gcc") else {
        return;
    };
    let Some(python) = python("inverses as FMU", &["numpy", "fmpy"]) else { return };
    // One version for a model, in turns.
    for (number, (name, model)) in MODELS.iter().enumerate() {
        let (fmi, inverse) = match number % 2 {
            0 => (FmiVersion::Three, tight(model)),
            _ => (FmiVersion::Two, InverseOptions::default()),
        };
        // The band, where there is one, is an output more.
        let band = model.band().map(|_| BandLevel { probability: 0.9, of_ten: 8 });
        let options = Options { fmi, band, inverse: Some(inverse), ..Options::named(NAME) };
        let folder = written(model, Target::Fmu, &options);
        let output = succeeds(Command::new(&python).current_dir(&folder).arg("actuator_test.py"));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with("0 of "), "{name}, {fmi:?}: {text}");

        let case = InverseCase::of(model, inverse, ROWS, false);
        fs::write(folder.path().join("rows"), case.bytes()).unwrap();
        let has_time = case.arguments.last() == Some(&Argument::TimeStep);
        let driver = format!("{OPENED}{DRIVER}");
        let arguments = ["-c", &driver, &(case.arguments.len() + 1).to_string(), &has_time.to_string()];
        succeeds(Command::new(&python).current_dir(&folder).args(arguments));
        let bytes = fs::read(folder.path().join("outputs")).unwrap();
        let numbers: Vec<f64> =
            bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(numbers.len(), 3 * ROWS);
        let mut different = 0;
        let (low, high) = model.trained_ranges().output;
        for (row, (found, expected)) in numbers.chunks(3).zip(&case.expected).enumerate() {
            let (input, output, reach, _) = expected.unwrap();
            different += usize::from(found[0] != input || found[1] != output);
            assert_eq!(found[2], code(Some(reach)), "{name}, {fmi:?}, row {row}");
            // The importer adds up the time steps, whose roundings reach rates.
            let deviation = (found[1] - output).abs() / (high - low);
            assert!(deviation <= 1e-12, "{name}, {fmi:?}, row {row}: {deviation:e}");
        }
        println!("{name}, {fmi:?}: {different} of {ROWS} rows differ; {}", case.reaches());
    }
}
