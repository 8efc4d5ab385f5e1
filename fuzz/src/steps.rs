//! Samples of any numbers for a model of any kind: an output is finite, and a refused sample changes nothing.

use crate::bytes::Bytes;
use crate::{assert_is_one_line, fixtures};

/// Samples taken of an input at most.
const MOST: usize = 60;

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    let models = fixtures::models();
    let model = &models[bytes.below(models.len())];
    let name = model.name().name();
    let mut stepper = model.stepper();
    let mut time = 0.0;
    for _ in 0..MOST {
        if bytes.is_empty() {
            return;
        }
        let action = bytes.below(16);
        if action == 0 {
            stepper.reset();
        }
        let inputs: Vec<f64> = match action {
            1 => vec![bytes.number(); 3],
            _ => vec![bytes.number()],
        };
        time = match action {
            2 => bytes.number(),
            _ => time + 0.1,
        };
        let rate = (action > 8).then(|| bytes.number());
        let before = stepper.clone();
        match stepper.step(&inputs, time, rate) {
            Ok(y) => assert!(y.is_finite(), "{name}: {y} at {inputs:?}, {time}, {rate:?}"),
            Err(error) => {
                assert_is_one_line(&error.to_string());
                // Later times than any before, so that both go on.
                let (mut refused, mut untouched) = (stepper.clone(), before);
                let next = |stepper: &mut hysid::model::Stepper<'_>, k: f64| {
                    stepper.step(&[0.3 * k], 1e300 * (1.0 + k), Some(0.1)).map(f64::to_bits)
                };
                for k in 0..3 {
                    let k = f64::from(k);
                    assert_eq!(next(&mut refused, k), next(&mut untouched, k), "{name}: {inputs:?}, {time}");
                }
            }
        }
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    let seed = |model: usize| (0..200u32).map(|k| (k * 37 + 11 * model as u32) as u8).collect::<Vec<u8>>();
    (0..fixtures::models().len())
        .map(|model| {
            let mut seed = seed(model);
            seed[0] = model as u8;
            seed
        })
        .collect()
}
