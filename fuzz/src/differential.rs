//! Ways to the same result: kernels against a scalar reference, a free run against single steps and against blocks,
//! and a fit that is broken off and resumed against one that is not.

use std::ops::ControlFlow;

use hysid::data::record::Record;
use hysid::fit::network::{fit, resume};
use hysid::fit::progress::Checkpoint;
use hysid::model::Model;
use hysid::options::network::{FitOptions, Trainer};
use hysid_core::network::{Architecture, Family, Network, NetworkDrive, ParameterLayout, Sizes};

use crate::bytes::Bytes;
use crate::{fixtures, scalar};

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    match bytes.below(8) {
        0 => resumed_is_whole(&mut bytes),
        1..4 => kernels_are_scalar(&mut bytes),
        _ => runs_are_steps(&mut bytes),
    }
}

/// Largest difference allowed, in units of the largest output.
const TOLERANCE: f64 = 1e-9;

fn kernels_are_scalar(bytes: &mut Bytes) {
    let sizes = Sizes { stops: 1 + bytes.below(19), hidden: 1 + bytes.below(9), relaxation: bytes.below(3) };
    let family = bytes.one_of(&Family::ALL);
    let inputs = if family.takes_further_inputs() { 1 + bytes.below(3) } else { 1 };
    let (rate, time) = (bytes.below(2) == 0, bytes.below(2) == 0);
    let architecture = Architecture::new(family, sizes, inputs, rate && time, time).expect("an architecture");
    let layout = ParameterLayout::new(architecture);
    let parameter = |index: usize| {
        let value = bytes.ordinary();
        if layout.ln_beta.contains(&index) {
            4.0 + 3.0 * value
        } else if layout.stop_weights.contains(&index) {
            6.0 * value
        } else {
            value
        }
    };
    let parameters = (0..layout.len()).map(parameter).collect();
    let output: Vec<f64> = (0..architecture.output_weights()).map(|_| bytes.ordinary()).collect();
    let network = Network::new(architecture, parameters, output).expect("a network");
    let rows = 1 + bytes.below(150);
    let channels: Vec<Vec<f64>> =
        (0..architecture.channels()).map(|_| (0..rows).map(|_| bytes.ordinary()).collect()).collect();
    let step = |k: usize| if k == 0 { 0.0 } else { 0.01 + bytes.ordinary().abs() };
    let steps = if architecture.relaxation > 0 { (0..rows).map(step).collect() } else { Vec::new() };
    let drive = NetworkDrive { channels, steps };
    let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
    let mut fast = vec![0.0; rows];
    network.simulator().run(&u, &drive.steps, &mut fast);
    let slow = scalar::outputs(&network, &drive);
    let largest = slow.iter().fold(1e-3, |most: f64, y| most.max(y.abs()));
    for (fast, slow) in fast.iter().zip(&slow) {
        assert!((fast - slow).abs() <= TOLERANCE * largest, "{fast} and {slow}: {architecture:?}");
    }
}

fn runs_are_steps(bytes: &mut Bytes) {
    let models = fixtures::models();
    let model = &models[bytes.below(models.len())];
    let rows = 1 + bytes.below(100);
    let x: Vec<f64> = (0..rows).map(|_| 2.0 * bytes.ordinary()).collect();
    let mut now = 0.0;
    let time = (0..rows).map(|_| {
        now += 0.01 + bytes.ordinary().abs();
        now
    });
    let time: Vec<f64> = time.collect();
    let record = Record::new("r", vec![x.clone()], vec![f64::NAN; rows]).expect("a record");
    let record = record.with_time(time.clone()).expect("time rises");
    let whole = model.simulate(&record).expect("a free run");
    let mut stepper = model.stepper();
    for (row, y) in whole.iter().enumerate() {
        // Fixtures take backward differences, as a stepper does.
        let step = stepper.step(&[x[row]], time[row], None).expect("a step");
        assert_eq!(step.to_bits(), y.to_bits(), "{}: row {row}, {step} and {y}", model.name().name());
    }
    let file = Model::from_json(&model.to_json()).expect("what was written is read");
    assert_eq!(file.simulate(&record).expect("a free run"), whole);
}

fn resumed_is_whole(bytes: &mut Bytes) {
    let training = bytes.one_of(&Trainer::ALL);
    let options = FitOptions {
        model: bytes.one_of(&[Family::Gpnn, Family::PreisachNn, Family::XpnnPlus]),
        sizes: Sizes { stops: 1 + bytes.below(3), hidden: 1 + bytes.below(3), relaxation: bytes.below(2) },
        starts: 1 + bytes.below(2),
        epochs: 1 + bytes.below(5),
        population: 4 + bytes.below(5),
        seed: u64::from(bytes.byte()),
        ..FitOptions::of(training)
    };
    let data = fixtures::data();
    let whole = fit(data, &options, &mut |_| ControlFlow::Continue(())).expect("a fit").model;
    let (last, mut call) = (1 + bytes.below(12), 0);
    let mut kept: Option<Checkpoint> = None;
    let stopped = fit(data, &options, &mut |progress| {
        call += 1;
        kept = progress.checkpoint().or(kept.take());
        if call >= last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let (Ok(_), Some(kept)) = (stopped, kept) else { return };
    let kept = Checkpoint::from_bytes(&kept.to_bytes()).expect("what was written is read");
    let resumed = resume(data, kept, &mut |_| ControlFlow::Continue(())).expect("it goes on").model;
    assert_eq!(resumed, whole, "{options:?}, broken off at {last}");
}

pub fn seeds() -> Vec<Vec<u8>> {
    (0..16u32)
        .map(|way| (0..400u32).map(|k| if k == 0 { way as u8 } else { (k * 73 + way * 29) as u8 }).collect())
        .collect()
}
