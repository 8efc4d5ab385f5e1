//! The responses of a model: its free run over the measured input, and over smaller ones of the same shape.

use hysid_core::data::record::{Dataset, Excitation, Record};
use hysid_core::elementary::cos;
use hysid_core::error::Result;
use hysid_core::model::Model;

use super::spectra::mean;
use super::stretches::{Stretch, stretches};
use super::{FrequencyResponse, NoResponse, Segments, resolution};
use crate::resonance::{ComparedSignal, LinearOscillator, Resonance};

/// Factors by which the input is multiplied, about its mean. Larger ones than 1 would leave the trained range.
const FACTORS: [f64; 2] = [0.3, 0.1];

/// Responses of data, of the linear oscillator that fits them best, and of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelResponses {
    /// How the rows were divided.
    pub segments: Segments,
    /// Of the measured output.
    pub measured: FrequencyResponse,
    /// Frequencies within this distance were averaged in the measured response.
    pub resolution: f64,
    /// The linear oscillator that fits best in a free run, and its response at the measured frequencies.
    pub oscillator: Option<(LinearOscillator, FrequencyResponse)>,
    /// Of the simulated output, the largest amplitude first: that of the measurement.
    pub model: Vec<AtAmplitude>,
}

/// The response of a model to inputs of some amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct AtAmplitude {
    /// The distance of the measured input from its mean was multiplied by this.
    pub factor: f64,
    /// Standard deviation of the input, in its unit.
    pub input_deviation: f64,
    /// The response.
    pub response: FrequencyResponse,
}

impl ModelResponses {
    /// Whether the resonance is that of the output or, if only these show one, of its changes.
    pub fn compared(&self) -> ComparedSignal {
        self.oscillator.as_ref().map_or(ComparedSignal::Output, |(oscillator, _)| oscillator.compared)
    }

    /// Responses of a model to the inputs of data, which it was simulated over: `simulated` has the output of each record.
    /// Its rows without a measured output are left out as those of the measurement are.
    ///
    /// The inner result says why the data have no response.
    ///
    /// # Errors
    /// Data that the model cannot run on.
    pub fn of(
        model: &Model,
        data: &Dataset,
        simulated: &[Vec<f64>],
    ) -> Result<std::result::Result<Self, NoResponse>> {
        let (stretches, step) = match stretches(data) {
            Ok(found) => found,
            Err(why) => return Ok(Err(why)),
        };
        let oscillator = Resonance::of(data).map(|found| found.oscillator);
        let of_data = oscillator.as_ref().map_or(0.0, resolution);
        let begun = stretches.iter().map(|stretch| {
            (stretch.input(data).to_vec(), simulated[stretch.record][..stretch.rows].to_vec())
        });
        let mut runs = vec![ScaledRun { factor: 1.0, columns: begun.collect(), resolution: of_data }];
        for factor in FACTORS {
            runs.push(ScaledRun::scaled(model, data, &stretches, step, factor, of_data)?);
        }
        let finest = runs.iter().map(|run| run.resolution).fold(f64::INFINITY, f64::min);
        let segments = match Segments::of(data, (finest > 0.0).then_some(finest)) {
            Ok(segments) => segments,
            Err(why) => return Ok(Err(why)),
        };
        let measured = segments.measured(data, of_data);
        let oscillator = oscillator.map(|oscillator| {
            let frequencies = measured.points.iter().map(|point| point.frequency);
            (oscillator, FrequencyResponse::of_oscillator(&oscillator, frequencies))
        });
        let model = runs.iter().map(|run| run.response(&segments)).collect();
        Ok(Ok(Self { segments, measured, resolution: of_data, oscillator, model }))
    }
}

struct ScaledRun {
    factor: f64,
    /// Input and output of each stretch.
    columns: Vec<(Vec<f64>, Vec<f64>)>,
    /// Frequencies within this distance are averaged. A resonance is sharper at an amplitude at which less is dissipated.
    resolution: f64,
}

impl ScaledRun {
    /// The runs over the inputs of data, multiplied about their means. If no oscillator fits them, the resolution is the
    /// given one.
    fn scaled(
        model: &Model,
        data: &Dataset,
        stretches: &[Stretch],
        step: f64,
        factor: f64,
        coarsest: f64,
    ) -> Result<Self> {
        let mut columns = Vec::with_capacity(stretches.len());
        let mut records = Vec::with_capacity(stretches.len());
        for stretch in stretches {
            let (input, output) = scaled_run(model, data, *stretch, step, factor)?;
            let time = (0..input.len()).map(|row| step * row as f64).collect();
            records.push(Record::new("", vec![input.clone()], output.clone())?.with_time(time)?);
            columns.push((input, output));
        }
        let moved = Dataset::new(data.names().clone(), records)?;
        let oscillator = Resonance::of(&moved).map(|found| found.oscillator);
        let resolution = oscillator.map_or(coarsest, |oscillator| resolution(&oscillator).min(coarsest));
        Ok(Self { factor, columns, resolution })
    }

    fn response(&self, segments: &Segments) -> AtAmplitude {
        let columns: Vec<(&[f64], &[f64])> =
            self.columns.iter().map(|(input, output)| (input.as_slice(), output.as_slice())).collect();
        AtAmplitude {
            factor: self.factor,
            input_deviation: deviation(columns.iter().map(|(input, _)| *input)),
            response: segments.response(&columns, self.resolution),
        }
    }
}

fn deviation<'c>(inputs: impl Iterator<Item = &'c [f64]> + Clone) -> f64 {
    let rows: usize = inputs.clone().map(<[f64]>::len).sum();
    let square = |input: &[f64]| {
        let mean = mean(input);
        input.iter().map(|x| (x - mean) * (x - mean) / rows as f64).sum::<f64>()
    };
    inputs.map(square).sum::<f64>().sqrt()
}

/// Rows of the rise before a run whose input would begin with a jump.
const RISE: usize = 2000;

/// The input of a stretch multiplied about its mean, theory.md (10.49), and the output of a free run over it.
///
/// A record with a mean far from its first value, such as a bias that is raised from zero, would begin with a jump. Such a
/// run begins at the measured first value and rises smoothly to the multiplied one; these rows are left out again.
fn scaled_run(
    model: &Model,
    data: &Dataset,
    stretch: Stretch,
    step: f64,
    factor: f64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let record = &data.records()[stretch.record];
    let measured = stretch.input(data);
    let mean = mean(measured);
    let scaled = |x: f64| mean + factor * (x - mean);
    let (from, to) = (measured[0], scaled(measured[0]));
    let before = if to.abs() > from.abs() { RISE } else { 0 };
    let rise = (0..before).map(|row| from + (to - from) * smooth(row as f64 / before as f64));
    let input: Vec<f64> = rise.chain(measured.iter().map(|&x| scaled(x))).collect();
    let time: Vec<f64> = (0..input.len()).map(|row| step * row as f64).collect();
    let output = run(model, record, &input, &time, scaled)?;
    Ok((input[before..].to_vec(), output[before..].to_vec()))
}

/// A rise from 0 to 1 that begins and ends at rest.
fn smooth(share: f64) -> f64 {
    0.5 - 0.5 * cos(std::f64::consts::PI * share)
}

fn run(
    model: &Model,
    record: &Record,
    input: &[f64],
    time: &[f64],
    scaled: impl Fn(f64) -> f64,
) -> Result<Vec<f64>> {
    let excitation = Excitation::new(record.name(), vec![input])?.with_time(time)?;
    let lead_in: Option<Vec<f64>> =
        record.lead_in().map(|values| values.iter().map(|&x| scaled(x)).collect());
    match &lead_in {
        Some(lead_in) => model.response(&excitation.with_lead_in(lead_in)?),
        None => model.response(&excitation),
    }
}
