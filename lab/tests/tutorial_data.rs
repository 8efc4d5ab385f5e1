//! The data of `docs/tutorials/data`: records of synthetic specimens in the form in which a laboratory writes them.
//! `HYSID_WRITE=1 cargo test --test tutorial_data` writes them anew.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use hysid::data::record::{Dataset, Record};
use hysid::specimens::{BoucWenBaberNoori, ReinforcedConcreteJoint, with_noise};
use hysid_core::elementary::{cos, exp, sin};
use hysid_lab::generated::{DrivenSpecimen, driven_specimen};

/// Noise of the load cell, and of the coil, in percent of the standard deviation of the output.
const NOISE: f64 = 1.0;
const COIL_NOISE: f64 = 0.3;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/tutorials/data").join(name)
}

/// Compares a file with what it must be.
fn check(name: &str, expected: &str) {
    if std::env::var_os("HYSID_WRITE").is_some() {
        fs::write(file(name), expected).unwrap();
    }
    let stored = fs::read_to_string(file(name)).unwrap_or_default().replace("\r\n", "\n");
    assert!(stored == expected, "{name}: HYSID_WRITE=1 cargo test writes it anew");
    assert!(stored.len() < 100_000, "{name} has {} bytes", stored.len());
}

/// A path through turning points in equal steps of at most `step`.
fn through(turns: &[f64], step: f64) -> Vec<f64> {
    let mut path = vec![turns[0]];
    for ends in turns.windows(2) {
        let steps = ((ends[1] - ends[0]).abs() / step).ceil();
        path.extend((1..=steps as usize).map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / steps));
    }
    path
}

/// The forces in kN of a new column, with noise: two hinges, of which one yields later and degrades less. No model of
/// Hysid has this law.
fn forces(displacement: &[f64], seed: u64) -> Vec<f64> {
    let weak = BoucWenBaberNoori { force_scale: 230.0, ..BoucWenBaberNoori::joint() };
    let strong = BoucWenBaberNoori {
        force_scale: 120.0,
        displacement_scale: 30.0,
        delta_nu: 0.1,
        zeta_s: 0.6,
        ..BoucWenBaberNoori::joint()
    };
    let [weak, strong] = [weak, strong].map(|hinge| ReinforcedConcreteJoint::new(hinge).run(displacement));
    let exact: Vec<f64> = weak.iter().zip(strong).map(|(weak, strong)| weak + strong).collect();
    let data = Dataset::from_slices(displacement, &exact).unwrap();
    with_noise(&data, NOISE, seed).unwrap().records()[0].output().to_vec()
}

/// A number with a decimal comma.
fn comma(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('.', ",")
}

/// Seven amplitudes up to 60 mm, three cycles each, 0.5 mm/s.
#[test]
fn the_column_test_is_that_of_its_law() {
    let levels = [5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0];
    let turns = levels.iter().flat_map(|level| [*level, -level].repeat(3));
    let turns: Vec<f64> = [0.0].into_iter().chain(turns).chain([0.0]).collect();
    let displacement = through(&turns, 1.0);
    let mut text = String::from(
        "Structures laboratory, column C3\n\
         Cyclic test with constant axial load; displacement at the top\n\
         Height of the column: 2000 mm\n\n\
         Time [s];Displacement [mm];Force [kN]\n",
    );
    for (row, (x, y)) in displacement.iter().zip(forces(&displacement, 1)).enumerate() {
        writeln!(text, "{};{};{}", 2 * row, comma(*x, 3), comma(y, 2)).unwrap();
    }
    check("column-test.txt", &text);
}

/// Displacement of the column in an earthquake: sines under an envelope, the largest magnitude 1.
fn earthquake() -> Vec<f64> {
    let tones = [(0.9, 1.0, 0.0), (1.4, 0.7, 1.0), (2.3, 0.45, 2.5), (0.35, 0.5, 4.0)];
    let at = |t: f64| {
        let envelope = (t / 2.0).min(1.0) * exp(-(t - 4.0).max(0.0) / 4.0);
        envelope * tones.iter().map(|(f, a, phase)| a * sin(TAU * f * t + phase)).sum::<f64>()
    };
    let raw: Vec<f64> = (0..700).map(|row| at(0.02 * f64::from(row))).collect();
    let largest = raw.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    raw.iter().map(|x| x / largest).collect()
}

/// Three new columns in the same earthquake, scaled to 30, 60 and 90 mm.
#[test]
fn the_earthquakes_are_those_of_the_same_law() {
    for (seed, peak) in (11..).zip([30.0, 60.0, 90.0]) {
        let displacement: Vec<f64> = earthquake().iter().map(|x| peak * x).collect();
        let mut text = String::from("t_s,Displacement_mm,Force_kN\n");
        for (row, (x, y)) in displacement.iter().zip(forces(&displacement, seed)).enumerate() {
            writeln!(text, "{:.2},{x:.3},{y:.2}", 0.02 * row as f64).unwrap();
        }
        check(&format!("earthquake-{peak}.csv"), &text);
    }
}

/// A sheet of electrical steel behind eddy currents: sines of three amplitudes at five frequencies, and two waveforms
/// with harmonics.
#[test]
fn the_sheet_is_that_of_its_law() {
    let sheet = driven_specimen("eddy-sheet-frequencies", 1).unwrap().unwrap();
    let largest = sheet.range.1;
    let record = |name: &str, rows: usize, step: f64, field: &dyn Fn(f64) -> f64| -> Record {
        let field: Vec<f64> = (0..rows).map(|row| largest * field(step * row as f64)).collect();
        sheet.run(name, &field, Some(step)).unwrap()
    };
    let mut sines = Vec::new();
    for frequency in [5.0, 20.0, 50.0, 100.0, 200.0] {
        for amplitude in [0.4, 0.7, 1.0] {
            let step = 1.0 / (60.0 * frequency);
            let name = format!("{frequency} Hz, {:.0} %", 100.0 * amplitude);
            sines.push(record(&name, 121, step, &|t| amplitude * sin(TAU * frequency * t)));
        }
    }
    check("sheet.csv", &table(&sheet.names, sines, 1, COIL_NOISE));
    let inverter = |t: f64| 0.75 * sin(TAU * 50.0 * t) + 0.25 * sin(TAU * 250.0 * t);
    let biased = |t: f64| 0.3 * (1.0 - exp(-t / 0.01)) + 0.5 * sin(TAU * 50.0 * t);
    let waveforms = vec![
        record("fifth harmonic", 361, 1.0 / 6000.0, &inverter),
        record("bias", 361, 1.0 / 6000.0, &biased),
    ];
    check("waveforms.csv", &table(&sheet.names, waveforms, 2, COIL_NOISE));
}

/// Time step of the stage's controller, in s.
const STAGE_STEP: f64 = 0.002;

/// A piezo stage that creeps, between 0 and its largest voltage.
fn stage() -> DrivenSpecimen {
    driven_specimen("creeping-piezo-frequencies", 1).unwrap().unwrap()
}

/// Half cosines between turning points, each with its number of rows.
fn swings(start: f64, legs: impl IntoIterator<Item = (f64, usize)>) -> Vec<f64> {
    let mut path = vec![start];
    for (to, rows) in legs {
        let from = path[path.len() - 1];
        let at = |row: usize| 0.5 * (1.0 - cos(0.5 * TAU * row as f64 / rows as f64));
        path.extend((1..=rows).map(|row| from + (to - from) * at(row)));
    }
    path
}

/// The golden ratio, whose multiples modulo 1 are all over the range.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Turning points all over the range, swings of 30 to 90 ms.
#[test]
fn the_stage_is_that_of_its_law() {
    let stage = stage();
    let legs = (1..=48).map(|k| {
        let level = (GOLDEN * f64::from(k)).fract();
        (stage.range.1 * level, [15, 25, 35, 45][k as usize % 4])
    });
    let voltage = swings(0.0, [(stage.range.1, 50), (0.0, 50)].into_iter().chain(legs));
    let record = stage.run("test", &voltage, Some(STAGE_STEP)).unwrap();
    let table = table(&stage.names, vec![record], 3, 0.2);
    let without_records: Vec<&str> = table.lines().map(|line| line.split_once(',').unwrap().1).collect();
    check("stage.csv", &(without_records.join("\n") + "\n"));
}

/// The wanted positions of a scan: lines of 6 um that end 0.1 um further each time, then three steps.
#[test]
fn the_scan_is_that_of_its_formula() {
    let lines = (0..8).flat_map(|line| {
        let offset = 4.0 + 0.1 * f64::from(line);
        [(offset + 6.0, 40), (offset + 0.1, 40)]
    });
    let steps = [(7.0, 25), (7.0, 50), (5.5, 25), (5.5, 50), (8.5, 25), (8.5, 50)];
    let wanted = swings(3.0, [(4.0, 40)].into_iter().chain(lines).chain(steps));
    let mut text = String::from("t_s,y_um\n");
    for (row, y) in wanted.iter().enumerate() {
        writeln!(text, "{:.3},{y:.4}", STAGE_STEP * row as f64).unwrap();
    }
    check("scan.csv", &text);
}

/// The positions of the stage in the columns of measurements are those at the drives beside them.
#[test]
fn the_driven_stage_is_that_of_its_law() {
    for (name, seed) in [("driven-by-line.csv", 4), ("driven-by-inverse.csv", 5), ("driven-again.csv", 6)] {
        let stored = fs::read_to_string(file(name)).unwrap_or_default();
        let voltage: Vec<f64> =
            stored.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
        assert!(voltage.len() > 500, "{name}: put the drive of the tutorial there, with columns t_s and u_V");
        let record = stage().run("test", &voltage, Some(STAGE_STEP)).unwrap();
        let measured = with_noise(&Dataset::new(stage().names, vec![record]).unwrap(), 0.2, seed).unwrap();
        let mut text = String::from("t_s,u_V,y_um\n");
        for (row, (x, y)) in voltage.iter().zip(measured.records()[0].output()).enumerate() {
            writeln!(text, "{:.3},{x:.3},{y:.5}", STAGE_STEP * row as f64).unwrap();
        }
        check(name, &text);
    }
}

/// A column of numbers of a file.
fn column(name: &str, column: usize) -> Vec<f64> {
    let text = fs::read_to_string(file(name)).unwrap();
    text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

/// The deviations from the wanted scan in um that the page of the stage tells: RMS and largest.
#[test]
fn the_deviations_of_the_stage_are_those_of_its_page() {
    let wanted = column("scan.csv", 1);
    let page = fs::read_to_string(file("../piezo-control.md")).unwrap();
    for name in ["driven-by-inverse.csv", "driven-again.csv"] {
        let errors: Vec<f64> =
            column(name, 2).iter().zip(&wanted).map(|(y, wanted)| (y - wanted).abs()).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let largest = errors.iter().copied().fold(0.0_f64, f64::max);
        let row = format!("| `{name}` | {rms:.3} | {largest:.3} |");
        assert!(page.contains(&row), "the page has no row {row}");
    }
}

/// Records as a table with a column `record`.
fn table(names: &hysid::data::record::ColumnNames, records: Vec<Record>, seed: u64, noise: f64) -> String {
    let data = with_noise(&Dataset::new(names.clone(), records).unwrap(), noise, seed).unwrap();
    let mut text =
        format!("record,{},{},{}\n", names.time.as_deref().unwrap(), names.inputs[0], names.output);
    for record in data.records() {
        let rows = record.time().unwrap().iter().zip(record.inputs()[0].iter()).zip(record.output());
        for ((t, x), y) in rows {
            writeln!(text, "\"{}\",{t:.7},{x:.2},{y:.5}", record.name()).unwrap();
        }
    }
    text
}
