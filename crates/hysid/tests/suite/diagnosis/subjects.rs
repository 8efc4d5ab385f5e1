//! Laws whose properties are known, on the protocol of theory.md (10.15) or on one of their own.

use crate::scaffold::*;
use std::f64::consts::TAU;

use hysid::diagnosis::Property;
use hysid::law::bouc_wen::BoucWen;
use hysid::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use hysid::specimens::{Ferromagnet, Specimen, shape_memory_actuator};
use hysid_core::elementary::{ln, sin};

const TURNING: [f64; 30] = [
    0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -0.3, 0.3, -0.3, 1.0, -1.0, 0.3, -0.3, 0.3, -1.0, 1.0, 0.6, -0.6, 0.6,
    -0.6, 0.3, -0.3, 0.3, 1.0, -0.5, 0.0, -0.5, 1.0, -1.0, 1.0,
];

/// Rows of the protocol for 1 of the input.
const ROWS: f64 = 200.0;

/// A law with its record and what is known of it.
pub struct Subject {
    pub name: &'static str,
    pub data: Dataset,
    /// One letter a property, in the order of `Property::ALL`: `y`, `n`, or `.` where nothing is known.
    truth: &'static str,
    /// Properties that this record contains the evidence for.
    pub testable: &'static [Property],
}

pub fn protocol() -> Vec<f64> {
    let mut path = vec![TURNING[0]];
    for ends in TURNING.windows(2) {
        let swing = ends[1] - ends[0];
        let rows = (swing.abs() * ROWS).round();
        path.extend((1..=rows as usize).map(|row| ends[0] + swing * row as f64 / rows));
    }
    path
}

fn record(x: Vec<f64>, y: Vec<f64>) -> Dataset {
    Dataset::new(ColumnNames::plain(1), vec![Record::new("protocol", vec![x], y).unwrap()]).unwrap()
}

fn run(law: &impl Law, x: &[f64]) -> Vec<f64> {
    let mut state = law.virgin();
    x.iter().map(|&x| law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 })).collect()
}

/// Stops side by side: a Prandtl-Ishlinskii law.
pub fn prandtl_ishlinskii(x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for (threshold, weight) in [(0.1, 3.0), (0.2, 1.5), (0.4, 1.0), (0.6, 0.5), (0.9, 0.3)] {
        let stress = Stop::new(threshold).unwrap().run(x);
        y.iter_mut().zip(stress).for_each(|(y, stress)| *y += weight * stress);
    }
    y
}

/// Silicon steel: Preisach by an analytic Everett function, over its whole range.
pub fn m330(x: &[f64]) -> Dataset {
    let h: Vec<f64> = x.iter().map(|x| 650.0 * x).collect();
    let b = Ferromagnet::m330_50a().run(&h);
    record(h, b)
}

/// The published law of a shape-memory actuator, over its whole range.
pub fn shape_memory(x: &[f64]) -> Dataset {
    let voltage: Vec<f64> = x.iter().map(|x| 1.2 + 1.2 * x).collect();
    let y = shape_memory_actuator::law().run(&voltage);
    record(voltage, y)
}

pub fn bouc_wen(x: &[f64]) -> Dataset {
    let law = BoucWen { n: 1.5, ..BoucWen::new(0.5, 10.0, 0.3).unwrap() };
    record(x.to_vec(), run(&law, x))
}

/// Jiles-Atherton of 1992 with published parameters.
pub fn jiles_atherton(x: &[f64]) -> Dataset {
    let saturation = 1.6e6;
    let law = JilesAtherton {
        offset: 0.0,
        permeability: 0.0,
        saturation,
        a: 1100.0,
        k: 400.0,
        alpha: 1.6e-3,
        c: 0.2,
        form: JilesAthertonForm::Differential,
    };
    let h: Vec<f64> = x.iter().map(|x| 6000.0 * x).collect();
    let m = run(&law, &h);
    record(h, m)
}

fn network(
    family: Family,
    x: &[f64],
    fill: impl Fn(&ParameterLayout, &mut Vec<f64>),
    output: Vec<f64>,
) -> Dataset {
    let sizes = Sizes { stops: 6, hidden: 4, relaxation: 0 };
    let architecture = Architecture::new(family, sizes, 1, false, false).unwrap();
    let layout = ParameterLayout::new(architecture);
    let mut parameters = vec![0.0; layout.len()];
    fill(&layout, &mut parameters);
    for (weight, threshold) in
        parameters[layout.stop_weights.clone()].iter_mut().zip([0.1, 0.2, 0.3, 0.45, 0.6, 0.9])
    {
        *weight = 1.0 / threshold;
    }
    let network = Network::new(architecture, parameters, output).unwrap();
    let mut y = vec![0.0; x.len()];
    network.simulator().run(&[x], &vec![0.0; x.len()], &mut y);
    record(x.to_vec(), y)
}

/// A generalized Prandtl network whose stops wear out: β = 25.
pub fn gpnn(x: &[f64]) -> Dataset {
    let fill =
        |layout: &ParameterLayout, values: &mut Vec<f64>| values[layout.ln_beta.clone()].fill(ln(25.0));
    network(Family::Gpnn, x, fill, vec![0.0, 0.5, 0.4, 0.4, 0.3, 0.3, 0.3])
}

/// A Preisach network that mixes its stops in tanh neurons with bias.
pub fn preisach_nn(x: &[f64]) -> Dataset {
    let fill = |layout: &ParameterLayout, values: &mut Vec<f64>| {
        if !layout.linear.is_empty() {
            values[layout.linear.start] = 1.0;
        }
        for (k, weight) in values[layout.hidden.clone()].iter_mut().enumerate() {
            *weight = 0.7 * sin(1.0 + 1.7 * k as f64);
        }
    };
    network(Family::PreisachNn, x, fill, vec![0.1, 1.0, 0.8, -0.6, 0.5])
}

const LAWS: &[Property] = &[
    Property::Congruency,
    Property::StaticHysteresis,
    Property::Orientation,
    Property::WipingOut,
    Property::Masing,
    Property::OddSymmetry,
    Property::Saturation,
    Property::Deterioration,
    Property::LoopClosure,
];

/// Where the small loops of the protocol lie outside the large one, or differ by nearly what matters: no congruency.
const WITHOUT_CONGRUENCY: &[Property] = LAWS.split_first().unwrap().1;

impl Subject {
    /// `None` where it is near the threshold, or where the record does not tell.
    pub fn truth(&self, property: Property) -> Option<bool> {
        let place = Property::ALL.iter().position(|other| *other == property).unwrap();
        match self.truth.as_bytes()[place] {
            b'y' => Some(true),
            b'n' => Some(false),
            _ => None,
        }
    }
}

fn subject(name: &'static str, data: Dataset, truth: &'static str, testable: &'static [Property]) -> Subject {
    Subject { name, data, truth, testable }
}

/// The laws on the protocol. Letters: static hysteresis, orientation clockwise, rate dependence, wiping-out,
/// congruency, Masing, odd symmetry, saturation, deterioration, loop closure.
pub fn laws() -> Vec<Subject> {
    let x = protocol();
    vec![
        subject("Prandtl-Ishlinskii", record(x.clone(), prandtl_ishlinskii(&x)), "yy.yyyyyny", LAWS),
        subject("Preisach M330-50A", m330(&x), "yn.yynyyny", WITHOUT_CONGRUENCY),
        subject("GPIM-SMA", shape_memory(&x), "yn.y.nnyny", WITHOUT_CONGRUENCY),
        subject(
            "GPNN, beta 25",
            gpnn(&x),
            "yy.nnn..y.",
            &[Property::WipingOut, Property::Congruency, Property::Masing],
        ),
        subject("Bouc-Wen, n 1.5", bouc_wen(&x), "yy.n.nyyn.", WITHOUT_CONGRUENCY),
        subject("Jiles-Atherton 1992", jiles_atherton(&x), "yn.yynyyny", WITHOUT_CONGRUENCY),
        subject("Preisach network", preisach_nn(&x), "y..ynnn.ny", LAWS),
    ]
}

/// Cycles of one amplitude at three speeds: a law that does not depend on the rate, its output `delay` late.
pub fn at_three_speeds(law: impl Fn(&[f64]) -> Vec<f64>, sampling: f64, delay: f64) -> Dataset {
    let records = [2.0, 6.0, 20.0].map(|frequency: f64| {
        let rows = (4.0 / frequency / sampling).round() as usize;
        let time: Vec<f64> = (0..rows).map(|row| row as f64 * sampling).collect();
        let wave = |t: f64| if t > 0.0 { sin(TAU * frequency * t) } else { 0.0 };
        let x: Vec<f64> = time.iter().map(|&t| wave(t)).collect();
        // The law runs on the input of then: the sensor is late, not the specimen.
        let earlier: Vec<f64> = time.iter().map(|&t| wave(t - delay)).collect();
        let name = format!("{frequency} Hz");
        Record::new(name, vec![x], law(&earlier)).unwrap().with_time(time).unwrap()
    });
    Dataset::new(ColumnNames::plain(1), records.to_vec()).unwrap()
}

const TIMED: &[Property] = &[Property::RateDependence, Property::StaticHysteresis, Property::Orientation];

pub fn timed() -> Vec<Subject> {
    let steel = |x: &[f64]| m330(x).records()[0].output().to_vec();
    vec![
        subject(
            "Prandtl-Ishlinskii, three speeds",
            at_three_speeds(prandtl_ishlinskii, 1e-3, 0.0),
            "yyn..y.y.y",
            TIMED,
        ),
        // At the fastest speed, the rows on the steep part are too far apart to show that the outputs agree.
        subject(
            "Preisach, three speeds",
            at_three_speeds(steel, 1e-3, 0.0),
            "ynn....y.y",
            &[Property::StaticHysteresis, Property::Orientation],
        ),
        subject(
            "Prandtl-Ishlinskii, delayed",
            at_three_speeds(prandtl_ishlinskii, 1e-3, 5e-4),
            "yyn....y..",
            TIMED,
        ),
    ]
}

/// The synthetic specimens, on the data they are trained on.
pub fn specimens() -> Vec<Subject> {
    const WIPING_OUT: &[Property] = &[Property::WipingOut];
    const RATE: &[Property] = &[Property::RateDependence];
    let of = |name, truth, testable| subject(name, Specimen::named(name).unwrap().train(), truth, testable);
    vec![
        of("ferromagnet", "ynnyynyyny", &[]),
        of("reinforced-concrete-joint", "yynnnn.yy.", &[Property::Deterioration]),
        of("terfenol-actuator", "ynny.nnnny", WIPING_OUT),
        of("shape-memory-actuator", "ynny.nnyny", WIPING_OUT),
        of("concrete", "yynnnnn.yn", &[]),
        of("piezo-actuator", "yny.......", RATE),
        of("rate-dependent-actuator", "yny.yyynny", RATE),
        of("magnetostrictive-actuator", "yny....n..", RATE),
    ]
}
