//! Wanted outputs of all kinds, and what the inverse of the library gives for them.

use hysid::Model;
use hysid::model::Reach;
use hysid_core::elementary::{cos, sin};
use hysid_export::InverseOptions;
use hysid_export::description::{Argument, Description, RateSource};
use hysid_export::program::Precision;

use crate::models::time_step;

/// Result of a step of an inverse; `None` for an invalid one.
pub type Given = Option<(f64, f64, Reach, usize)>;

/// The arguments of the steps of an inverse, and what the library gives.
pub struct InverseCase {
    /// The arguments behind the wanted output.
    pub arguments: Vec<Argument>,
    pub rows: Vec<Vec<f64>>,
    pub expected: Vec<Given>,
}

/// Bounds that are reached often: the middle of the trained range, and its width in a unit of time.
pub fn tight(model: &Model) -> InverseOptions {
    let (low, high) = model.trained_ranges().inputs[0];
    let width = high - low;
    InverseOptions { limits: Some((low + 0.2 * width, high - 0.25 * width)), slew: Some(width) }
}

pub fn unit() -> impl FnMut() -> f64 {
    let mut bits: u64 = 7;
    move || {
        bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl InverseCase {
    /// So many rows: outputs on a path of the model, sudden changes, outputs beyond the trained range, rest, and, if
    /// wanted, invalid rows.
    pub fn of(model: &Model, options: InverseOptions, rows: usize, with_invalid: bool) -> Self {
        let mut arguments =
            Description::of(model, RateSource::Backward, Precision::Double).arguments.split_off(1);
        if options.slew.is_some() && !arguments.contains(&Argument::TimeStep) {
            arguments.push(Argument::TimeStep);
        }
        let has_time = arguments.contains(&Argument::TimeStep);
        let ranges = model.trained_ranges();
        let (low, high) = options.limits.unwrap_or(ranges.inputs[0]);
        let (least, most) = ranges.output;
        let mut inverse = model.inverse().by_search().limits(low, high).unwrap();
        if let Some(slew) = options.slew {
            inverse = inverse.slew(slew).unwrap();
        }
        let mut specimen = model.stepper();
        let mut unit = unit();
        let (mut time, mut time_on_path, mut wanted) = (0.0, 0.0, 0.5 * (least + most));
        let mut case = Self { arguments, rows: Vec::new(), expected: Vec::new() };
        for row in 0..rows {
            let t = row as f64;
            let others: Vec<f64> =
                (1..ranges.inputs.len()).map(|input| 5.0 + cos(0.013 * t * input as f64)).collect();
            let before = time;
            time += time_step(row);
            time_on_path += time_step(row);
            let place = 0.5 + 0.35 * (sin(0.043 * t) + 0.4 * sin(0.31 * t));
            let inputs = [&[low + place * (high - low)], &others[..]].concat();
            let on_path = specimen.step(&inputs, time_on_path, None).unwrap();
            let kind = unit();
            wanted = match row % 400 {
                300..340 if kind < 0.7 => wanted,
                340..370 => least + (1.6 * unit() - 0.3) * (most - least),
                _ if kind < 0.01 => least + (1.2 * unit() - 0.1) * (most - least),
                _ => on_path,
            };
            let mut asked = (wanted, time);
            if with_invalid && kind > 0.99 {
                asked =
                    if kind > 0.995 || !has_time || row == 0 { (f64::NAN, time) } else { (wanted, before) };
            }
            let found = inverse.step(asked.0, &others, asked.1);
            let value = |argument: &Argument| match argument {
                Argument::Input(input) => others[*input - 1],
                // The library takes time stamps, whose difference is rounded.
                _ => asked.1 - before,
            };
            let mut arguments = vec![asked.0];
            arguments.extend(case.arguments.iter().map(value));
            case.rows.push(arguments);
            if found.is_err() {
                time = before;
            }
            case.expected
                .push(found.ok().map(|found| (found.input, found.output, found.reach, found.trials)));
        }
        case
    }

    /// The arguments, row by row, as bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.rows.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
    }

    pub fn reaches(&self) -> String {
        let count =
            |word: &str| self.expected.iter().flatten().filter(|given| given.2.word() == word).count();
        let reaches = Reach::ALL.iter().map(|reach| format!("{} {}", count(reach.word()), reach.word()));
        let invalid = self.expected.iter().filter(|given| given.is_none()).count();
        reaches.chain([format!("{invalid} invalid")]).collect::<Vec<_>>().join(", ")
    }
}

/// The number of a reach in exports; -1 for an invalid step.
pub fn code(reach: Option<Reach>) -> f64 {
    let place = |reach: Reach| Reach::ALL.iter().position(|other| *other == reach).unwrap();
    reach.map_or(-1.0, |reach| place(reach) as f64)
}
