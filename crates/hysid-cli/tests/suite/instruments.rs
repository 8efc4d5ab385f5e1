//! Files in the layouts of instruments, each with the same record: read without an option, or with the first hint.

use std::fmt::Write as _;

use hysid_core::elementary::{cos, sin};

use crate::workbench::{Workbench, columns};

const ROWS: usize = 120;

/// Time, input and output of a row.
fn truth(row: usize) -> [f64; 3] {
    let t = 0.1 * row as f64;
    let amplitude = 1.0 + 0.1 * (t / 4.0).floor();
    [t, amplitude * sin(1.6 * t), 2.0 * amplitude * sin(1.6 * t) - 0.4 * cos(1.6 * t)]
}

/// What an instrument writes: the lines before the rows, a row with `{n}`, `{clock}`, `{t}`, `{x}` and `{y}`, and the
/// columns of input and output.
struct Layout {
    name: &'static str,
    head: &'static str,
    row: &'static str,
    input: &'static str,
    output: &'static str,
}

const fn layout(
    name: &'static str,
    head: &'static str,
    row: &'static str,
    input: &'static str,
    output: &'static str,
) -> Layout {
    Layout { name, head, row, input, output }
}

const LAYOUTS: [Layout; 28] = [
    layout(
        "mpms3.dat",
        "[Header]\n; MPMS3 Data File\nTITLE,\nFILEOPENTIME,3800000000.0,01/01/2020,12:00 pm\nBYAPP,MultiVu\nINFO,10.0,SAMPLE_MASS\n[Data]\nComment,Time Stamp (sec),Temperature (K),Magnetic Field (Oe),Moment (emu),M. Std. Err. (emu),Transport Action,Averaging Time (sec),Center Position (mm),Range,DC Moment Fixed Ctr (emu),DC Moment Free Ctr (emu),Min. Field (Oe),Max. Field (Oe),Mass (grams),Motor Lag (deg),Pressure (Torr)\n",
        ",38000{t},300.0{n},{x},{y},1e-05,1,1,32.9{n},10,,,{x},{x},55.1,0.0{n},5.{n}",
        "Magnetic Field (Oe)",
        "Moment (emu)",
    ),
    layout(
        "mpms-dc.dat",
        "[Header]\n; MPMS3 Data File\nBYAPP,MultiVu\n[Data]\nComment,Time Stamp (sec),Temperature (K),Magnetic Field (Oe),Moment (emu),M. Std. Err. (emu),Transport Action,DC Moment Fixed Ctr (emu),DC Moment Err Fixed Ctr (emu),DC Moment Free Ctr (emu),DC Moment Err Free Ctr (emu),DC Fixed Fit,DC Free Fit,DC Calculated Center (mm),DC # of points\n",
        ",38000{t},300.0{n},{x},,,1,,,{y},1e-6,,0.99{n},29.9{n},200",
        "Magnetic Field (Oe)",
        "DC Moment Free Ctr (emu)",
    ),
    layout(
        "ppms-vsm.dat",
        "[Header]\nTITLE,loop\nBYAPP,VSM,1.0\nINFO,PPMS,INSTRUMENT\nDATATYPE,COMMENT,1\n[Data]\nComment,Time Stamp (sec),Temperature (K),Magnetic Field (Oe),Moment (emu),M. Std. Err. (emu),Transport Action,Averaging Time (sec),Frequency (Hz),Peak Amplitude (mm),Center Position (mm),Coil Signal' (mV),Coil Signal\" (mV),Range (mV),M. Quad. Signal (emu),M. Raw' (emu),M. Raw\" (emu),Min. Temperature (K),Max. Temperature (K),Min. Field (Oe),Max. Field (Oe),Mass (grams),Motor Lag (deg),Pressure (Torr),VSM Status (code),Measure Count,System Temp. (K)\n",
        ",38000{t},300.0{n},{x},{y},1e-05,1,1,40,2,35.1{n},0.1{n},0.02{n},2.5,1e-5{n},{y}9,1e-5{n},300.0{n},300.1{n},{x},{x},0.1,0.5{n},5.{n},4113,{n},27.{n}",
        "Magnetic Field (Oe)",
        "Moment (emu)",
    ),
    layout(
        "mpms-xl.rso.dat",
        "[Header]\n;MPMS rso data\nTITLE,loop\nINFO,NAME,a\n[Data]\nTime,Comment,Field (Oe),Temperature (K),Long Moment (emu),Long Scan Std Dev,Long Algorithm,Long Reg Fit,Long Percent Error\n",
        "38000{t},,{x},300.0{n},{y},1e-6,2,0.99{n},0.1{n}",
        "Field (Oe)",
        "Long Moment (emu)",
    ),
    layout(
        "micromag.txt",
        "MicroMag 2900/3900 Data File (Series 0016)\nDirect moment vs. field; Hysteresis loop\n\nINSTRUMENT\nConfiguration   :  VSM\nUnits of measure:  cgs\n\nMEASUREMENT\nHCoerce         =  +1.0E+02\nSlope           =  N/A\n\n",
        "{x},{y}",
        "Field [Oe]",
        "Moment [emu]",
    ),
    layout(
        "lake-shore.txt",
        "Lake Shore VSM 7400\n Start Time:  01/01/2020 12:00\nSample ID:\tA\nSample Mass (g):\t0.1\n\nField(G)\tMoment(emu)\tTemperature(K)\tTime(s)\n",
        "{x}\t{y}\t295.1{n}\t{t}",
        "Field(G)",
        "Moment(emu)",
    ),
    layout(
        "lake-shore-8600.csv",
        "#INSTRUMENT:8600 VSM\n#OPERATOR:N. N.\n#DATE:01/01/2020\nStep,Iteration,Segment,Field [Oe],Moment [emu],Time Stamp [s],Field Status,Moment Status\n",
        "1,1,1,{x},{y},{t},OK,OK",
        "Field [Oe]",
        "Moment [emu]",
    ),
    layout(
        "aixacct.dat",
        "DynamicHysteresisResult\n\nDynamicHysteresis\nProgram: aixPlorer\nWaveform: triangle\nArea [mm2]: 0.5\nThickness [nm]: 200\n\nTime [s]\tV+ [V]\tI1 [A]\tP1 [uC/cm2]\n",
        "{t}\t{x}\t1e-6{n}\t{y}",
        "V+ [V]",
        "P1 [uC/cm2]",
    ),
    layout(
        "radiant.txt",
        "Radiant Technologies, Inc.\nVision Data Export\nTask Name:\tHysteresis\nMax. Drive Voltage:\t10.0\nSample Area (cm2):\t0.0001\n\nPoint\tTime (ms)\tDrive Voltage\tMeasured Polarization (µC/cm2)\n",
        "{n}\t{t}\t{x}\t{y}",
        "Drive Voltage",
        "Measured Polarization (µC/cm2)",
    ),
    layout(
        "arbin.csv",
        "Data_Point,Date_Time,Test_Time(s),Step_Time(s),Step_Index,Cycle_Index,Current(A),Voltage(V),Charge_Capacity(Ah),Discharge_Capacity(Ah),Charge_Energy(Wh),Discharge_Energy(Wh),dV/dt(V/s),Internal_Resistance(Ohm),Temperature(C)\n",
        "{n},01/01/2020 {clock},{t},{t},2,1,{x},{y},0.00{n},0.001,0.01{n},0.02,0.0{n},0.01,25.0{n}",
        "Current(A)",
        "Voltage(V)",
    ),
    layout(
        "neware.csv",
        "Record Index,Cycle Index,Step Index,Step Type,Time,Total Time,Current(A),Voltage(V),Capacity(Ah),Spec. Cap.(mAh/g),Chg. Cap.(Ah),DChg. Cap.(Ah),Energy(Wh),Power(W),dQ/dV(mAh/V),Contact resistance(mΩ),Date\n",
        "{n},1,2,CC Chg,{clock},{clock},{x},{y},0.00{n},1.{n},0.00{n},0,0.01{n},0.2{n},0.1{n},1,2020-01-01 {clock}",
        "Current(A)",
        "Voltage(V)",
    ),
    layout(
        "biologic.mpt",
        "EC-Lab ASCII FILE\nNb header lines : 9\n\nCyclic Voltammetry\n\nRun on channel : 1 (SN 1)\nElectrode area : 0.001 cm2\n\nmode\tox/red\terror\tcounter inc.\ttime/s\tcontrol/V\tEwe/V\t<I>/mA\tcycle number\t(Q-Qo)/C\n",
        "2\t1\t0\t0\t{t}\t{x}1\t{x}\t{y}\t1.0\t0.00{n}",
        "Ewe/V",
        "<I>/mA",
    ),
    layout(
        "maccor.txt",
        "Today's Date\t01/01/2020\tDate of Test:\t01/01/2020\tFilename:\tcell.001\tProcedure:\tcycle\n\nRec#\tCyc#\tStep\tTestTime\tStepTime\tAmp-hr\tWatt-hr\tAmps\tVolts\tState\tES\tDPt Time\n",
        "{n}\t1\t2\t{clock}\t{clock}\t0.00{n}\t0.01{n}\t{x}\t{y}\tC\t1\t01/01/2020 {clock}",
        "Amps",
        "Volts",
    ),
    layout(
        "keithley-kickstart.csv",
        "Project,IV\nInstrument,2450\nStart,01/01/2020\n\nIndex,Time (s),SMU-1 Voltage (V),SMU-1 Current (A)\n",
        "{n},{t},{x},{y}",
        "SMU-1 Voltage (V)",
        "SMU-1 Current (A)",
    ),
    layout("keithley-4200.csv", "Time,AnodeV,AnodeI\n", "{t},{x},{y}", "AnodeV", "AnodeI"),
    layout(
        "keithley-tsp.csv",
        "Smu1.Time[1][1],Smu1.V[1][1],Smu1.I[1][1]\n",
        "{t},{x},{y}",
        "Smu1.V[1][1]",
        "Smu1.I[1][1]",
    ),
    layout(
        "mts.txt",
        "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Header:\tCycle\tTime:\t12.5\tSec\tDate:\t01/01/2020\nStation Name:\tframe 1\n\nRunning Time\tAxial Displacement\tAxial Force\tAxial Count\nSec\tmm\tkN\tsegments\n",
        "{t}\t{x}\t{y}\t{n}",
        "Axial Displacement [mm]",
        "Axial Force [kN]",
    ),
    layout(
        "instron.csv",
        "\"Sample ID\",\"A-1\"\n\"Rate\",\"1.0\",\"mm/min\"\n\n\"Time\",\"Extension\",\"Load\"\n\"(s)\",\"(mm)\",\"(N)\"\n",
        "\"{t}\",\"{x}\",\"{y}\"",
        "Extension [mm]",
        "Load [N]",
    ),
    layout(
        "zwick.txt",
        "\"Prüfer\";\"N. N.\"\n\"Material\";\"S235\"\n\n\"Prüfzeit\";\"Traversenweg\";\"Standardkraft\"\n\"s\";\"mm\";\"N\"\n",
        "{t,};{x,};{y,}",
        "Traversenweg [mm]",
        "Standardkraft [N]",
    ),
    layout(
        "labview.lvm",
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n***End_of_Header***\t\n\nChannels\t2\t\nSamples\t120\t120\nX_Dimension\tTime\tTime\nX0\t0.0E+0\t0.0E+0\nDelta_X\t0.1\t0.1\n***End_of_Header***\t\nX_Value\tDisplacement\tForce\tComment\n",
        "{t}\t{x}\t{y}\t",
        "Displacement",
        "Force",
    ),
    layout("opensees.out", "", "{t} {x} {y}", "c2", "c3"),
    layout(
        "ta-instruments.txt",
        "[Filename]\nInstrument name\tDMA 850\nOperator\tN. N.\n\n[step]\nOscillation - 1\nTime\tOscillation strain\tOscillation stress\tTemperature\tStep name\ns\t%\tMPa\t°C\t\n",
        "{t}\t{x}\t{y}\t25.0{n}\tOscillation - 1",
        "Oscillation strain [%]",
        "Oscillation stress [MPa]",
    ),
    layout(
        "polytec.txt",
        "Source File Name:\tscan.svd\nPoint Index:\t1\nComponent:\tRoot\nSignal:\tVib Displacement\n\nTime\tRef1 Voltage\tVib Displacement\n[ s ]\t[ V ]\t[ m ]\n",
        "{t}\t{x}\t{y}",
        "Ref1 Voltage [V]",
        "Vib Displacement [m]",
    ),
    layout(
        "tektronix.csv",
        "Model,MSO24\nFirmware Version,1.0\n\nPoint Format,Y,,\nHorizontal Units,s,\nSample Interval,0.1,\nRecord Length,120,\n\nLabels,,\nTIME,CH1,CH2\n",
        "{t},{x},{y}",
        "CH1",
        "CH2",
    ),
    layout("keysight.csv", "x-axis,1,2\nsecond,Volt,Volt\n", "{t},{x},{y}", "Volt", "Volt (2)"),
    layout(
        "dspace.csv",
        "type;\"measurement\"\nversion;1\nrecorder;\"Recorder 1\"\n\nTime [s];Model Root/Stage/Drive Voltage [V];Model Root/Stage/Position [µm]\n",
        "{t};{x};{y}",
        "Model Root/Stage/Drive Voltage [V]",
        "Model Root/Stage/Position [µm]",
    ),
    layout(
        "comsol.txt",
        "% Model:              core.mph\n% Version:            COMSOL 6.1\n% Date:               Jan 1 2020, 12:00\n% Dimension:          0\n% Nodes:              1\n% Expressions:        2\n% Description:        Field, flux density\n% t                      H (A/m)                  B (T)\n",
        "{t}    {x}    {y}",
        "H (A/m)",
        "B (T)",
    ),
    layout(
        "abaqus.rpt",
        "\n            X               U1               RF1 \n\n",
        "   {t}    {x}    {y}",
        "U1",
        "RF1",
    ),
];

/// The file of a layout.
fn content(layout: &Layout) -> String {
    let mut text = layout.head.to_string();
    for row in 0..ROWS {
        let [t, x, y] = truth(row);
        let clock = format!("00:{:02}:{:04.1}", (t / 60.0) as usize, t - 60.0 * (t / 60.0).floor());
        let numbers = [("{t}", t), ("{x}", x), ("{y}", y)];
        let mut line = layout.row.replace("{n}", &(row + 1).to_string()).replace("{clock}", &clock);
        for (key, value) in numbers {
            line = line.replace(key, &format!("{value:.6}"));
            line = line.replace(&key.replace('}', ",}"), &format!("{value:.6}").replace('.', ","));
        }
        writeln!(text, "{line}").unwrap();
    }
    text
}

/// The options of the first hint in an error, as they are pasted.
pub fn first_hint(error: &str) -> Option<String> {
    let mut rest = &error[error.find("--")?..];
    let mut options = Vec::new();
    while rest.starts_with("--") {
        let (mut is_quoted, mut is_escaped, mut words) = (false, false, 0);
        let end = rest.char_indices().find(|&(_, letter)| {
            is_quoted ^= letter == '\'' && !is_escaped;
            is_escaped = letter == '\\' && !is_escaped && !is_quoted;
            words += usize::from(letter == ' ' && !is_quoted);
            !is_quoted && (words == 2 || matches!(letter, ',' | ')' | ';'))
        });
        let end = end.map_or(rest.len(), |(place, _)| place);
        options.push(rest[..end].trim());
        rest = rest[end..].trim_start();
    }
    Some(options.join(" "))
}

/// Names of input and output, and the hint that was followed.
struct LookedAt {
    hint: Option<String>,
    names: [String; 2],
    columns: [Vec<f64>; 2],
}

/// Looks at a file, and follows the first hint of an error, or of a doubt about the output.
fn look(bench: &Workbench, file: &str) -> Result<LookedAt, String> {
    let look = |options: &str| bench.shell(&format!("hysid look {file} -o clean.csv --force {options}"));
    let mut ran = look("");
    let doubt = ran.stderr.lines().find(|line| line.contains("looks more like"));
    let asks = if ran.status == Some(0) { doubt } else { Some(ran.last_line()) };
    let hint = asks.map(|line| first_hint(line).unwrap_or_default());
    if let Some(options) = &hint {
        ran = look(options);
    }
    if ran.status != Some(0) {
        return Err(format!("{file} {hint:?}: {ran}"));
    }
    let (names, columns) = columns(&bench.text("clean.csv"));
    let behind = names.len() - 2;
    let [input, output] = [0, 1].map(|place| columns[behind + place].clone());
    Ok(LookedAt { hint, names: [names[behind].clone(), names[behind + 1].clone()], columns: [input, output] })
}

#[test]
fn files_of_instruments_are_read_without_an_option_or_with_the_first_hint() {
    let bench = Workbench::new();
    let mut problems = String::new();
    let mut hinted = Vec::new();
    for layout in &LAYOUTS {
        bench.put(layout.name, content(layout));
        let looked = match look(&bench, layout.name) {
            Ok(looked) => looked,
            Err(problem) => {
                writeln!(problems, "{problem}").unwrap();
                continue;
            }
        };
        hinted.extend(looked.hint.is_some().then_some(layout.name));
        let LookedAt { hint, names, columns: [input, output] } = looked;
        if names != [layout.input, layout.output] {
            writeln!(problems, "{} {hint:?}: {names:?}", layout.name).unwrap();
            continue;
        }
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5;
        let is_right = |row: usize| near(input[row], truth(row)[1]) && near(output[row], truth(row)[2]);
        if input.len() != ROWS || !(0..ROWS).all(is_right) {
            writeln!(problems, "{} {hint:?}: other numbers, {} rows", layout.name, input.len()).unwrap();
        }
    }
    assert!(problems.is_empty(), "{problems}");
    assert_eq!(hinted, ["biologic.mpt", "abaqus.rpt"]);
}

/// Names of input and output as they stand in files of many fields.
const PAIRS: &str = "\
Displacement (mm) | Force (kN)
disp_mm | force_kN
Disp | Force
Axial Displacement [mm] | Axial Force [kN]
Drift (%) | Base Shear (kN)
Drift ratio | Lateral load (kN)
Rotation (rad) | Moment (kN m)
Curvature (1/m) | Moment (kNm)
Strain | Stress
Strain (%) | Stress (MPa)
eps | sigma
Shear strain (%) | Shear stress (kPa)
Deflection/mm | Load/kN
Stroke (mm) | Damping force (N)
Angle (deg) | Torque (Nm)
Extension (mm) | Load (N)
Position (um) | Force (mN)
x | F
u | F
x | y
Weg (mm) | Kraft (kN)
Dehnung (%) | Spannung (MPa)
Déplacement (mm) | Effort (kN)
Desplazamiento (mm) | Fuerza (kN)
H (A/m) | B (T)
H (Oe) | M (emu)
Field (T) | Moment (emu)
mu0H (T) | M (A/m)
Magnetic Field (Oe) | Moment (emu)
Applied Field (kA/m) | Polarization J (T)
B (T) | M (A m2/kg)
E (kV/cm) | P (uC/cm2)
Electric Field (MV/m) | Polarization (C/m2)
Voltage (V) | Charge (nC)
Drive Voltage (V) | Displacement (um)
Voltage (V) | Strain (%)
Voltage (V) | Current (A)
Vg (V) | Id (A)
Current (A) | Torque (Nm)
Current (A) | Flux linkage (Wb)
Temperature (°C) | Strain (%)
Temperature (K) | Resistance (Ohm)
p/p0 | Adsorbed volume (cm3/g)
RH (%) | Water content (kg/kg)
Suction (kPa) | Water content
";

#[test]
fn usual_pairs_of_names_give_their_cycles_without_an_option() {
    let bench = Workbench::new();
    let mut problems = String::new();
    assert!(PAIRS.lines().count() >= 40);
    for pair in PAIRS.lines() {
        let (input, output) = pair.split_once(" | ").unwrap();
        let mut text = format!("{input},{output}\n");
        for row in 0..=240 {
            let phase = std::f64::consts::TAU * f64::from(row) / 80.0;
            writeln!(text, "{:.6},{:.6}", 3.0 * sin(phase), 2.0 * sin(phase) - 0.5 * cos(phase)).unwrap();
        }
        bench.put("pair.csv", text);
        let ran = bench.run("cycles pair.csv --no-report --force --json");
        let told: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap_or_default();
        let cycles = told["cycles"].as_array().map_or(0, Vec::len);
        let said = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        let is_read =
            said.contains(&format!("input {input}: ")) && said.contains(&format!("output {output}: "));
        if ran.status != Some(0) || !is_read || !(3..=4).contains(&cycles) || ran.stderr.contains("warning") {
            writeln!(problems, "{pair}: {cycles} cycles, {}", ran.stderr).unwrap();
        }
    }
    assert!(problems.is_empty(), "{problems}");
}

/// Names of columns, of which many are no input and no output.
const NAMES: [&str; 30] = [
    "Time (s)",
    "x",
    "y",
    "Displacement (mm)",
    "Force (kN)",
    "Load 2 (kN)",
    "Field (Oe)",
    "Moment (emu)",
    "Voltage (V)",
    "Current (A)",
    "Temperature (K)",
    "Cycle",
    "ch1",
    "ch2",
    "ch3",
    "command",
    "measured",
    "Strain (%)",
    "Stress (MPa)",
    "Energy (J)",
    "Pressure (kPa)",
    "B (T)",
    "u",
    "Position (mm)",
    "it's; \"$a\"",
    "-speed (mm/s)",
    "Status",
    "P (uC/cm2)",
    "RH (%)",
    "Angle (deg)",
];

#[test]
fn no_hint_leads_to_the_next_error() {
    let bench = Workbench::new();
    let (mut problems, mut hints) = (String::new(), 0);
    let mut state = 1_u64;
    let mut next = |count: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    for _ in 0..120 {
        let mut names: Vec<&str> = Vec::new();
        while names.len() < 2 + names.len() % 2 + next(5) || names.len() < 2 {
            let name = NAMES[next(NAMES.len())];
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let phases: Vec<f64> = names.iter().map(|_| 0.3 * next(8) as f64).collect();
        let grows: Vec<bool> = names.iter().map(|name| name.starts_with("Time") || next(12) == 0).collect();
        let header: Vec<String> =
            names.iter().map(|name| format!("\"{}\"", name.replace('"', "\"\""))).collect();
        let mut text = header.join(",") + "\n";
        for row in 0..60 {
            let time = 0.2 * f64::from(row);
            let value = |place: usize| {
                if grows[place] { time } else { sin(time + phases[place]) * (1.0 + 0.1 * time) }
            };
            let cells: Vec<String> = (0..names.len()).map(|place| format!("{:.4}", value(place))).collect();
            writeln!(text, "{}", cells.join(",")).unwrap();
        }
        bench.put("data.csv", text);
        let refused = bench.shell("hysid look data.csv");
        if refused.status == Some(0) || refused.last_line().contains("no column is left") {
            continue;
        }
        hints += 1;
        let hint = first_hint(refused.last_line()).unwrap_or_default();
        let ran = bench.shell(&format!("hysid look data.csv {hint}"));
        if hint.is_empty() || ran.status != Some(0) {
            writeln!(problems, "{names:?} {}\n  {hint} => {}", refused.last_line(), ran.last_line()).unwrap();
        }
    }
    assert!(problems.is_empty(), "{problems}");
    assert!(hints > 30, "only {hints} hints");
}
