//! The responses of a model: its free run over the measured input, and over smaller ones of the same shape.

use hysid_core::data::record::{Dataset, Excitation, Record};
use hysid_core::error::Result;
use hysid_core::model::Model;

use super::spectra::mean;
use super::stretches::Stretch;
use super::{FrequencyResponse, NoResponse, Segments};
use crate::resonance::{LinearOscillator, linear_oscillators};

/// Factors by which the input is multiplied, about its mean. Larger ones than 1 would leave the trained range.
const FACTORS: [f64; 2] = [0.3, 0.1];

/// Responses of data, of the linear oscillator that fits them best, and of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelResponses {
    /// How the rows were divided.
    pub segments: Segments,
    /// Of the measured output.
    pub measured: FrequencyResponse,
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
        let oscillator = linear_oscillators(data).into_iter().next();
        let segments = match Segments::of(data, oscillator.as_ref()) {
            Ok(segments) => segments,
            Err(why) => return Ok(Err(why)),
        };
        let stretches = &segments.stretches;
        let inputs: Vec<&[f64]> = stretches.iter().map(|stretch| stretch.input(data)).collect();
        let outputs: Vec<Vec<f64>> =
            stretches.iter().map(|stretch| simulated[stretch.record][..stretch.rows].to_vec()).collect();
        let mut responses = vec![AtAmplitude::of(&segments, 1.0, &inputs, &outputs)];
        for factor in FACTORS {
            let runs = stretches.iter().map(|stretch| scaled_run(model, data, &segments, *stretch, factor));
            let (inputs, outputs): (Vec<Vec<f64>>, Vec<Vec<f64>>) =
                runs.collect::<Result<Vec<_>>>()?.into_iter().unzip();
            let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
            responses.push(AtAmplitude::of(&segments, factor, &inputs, &outputs));
        }
        let measured = segments.measured(data);
        let oscillator = oscillator.map(|oscillator| {
            let frequencies = measured.points.iter().map(|point| point.frequency);
            (oscillator, FrequencyResponse::of_oscillator(&oscillator, frequencies))
        });
        Ok(Ok(Self { segments, measured, oscillator, model: responses }))
    }
}

impl AtAmplitude {
    fn of(segments: &Segments, factor: f64, inputs: &[&[f64]], outputs: &[Vec<f64>]) -> Self {
        let columns: Vec<(&[f64], &[f64])> =
            inputs.iter().copied().zip(outputs.iter().map(Vec::as_slice)).collect();
        Self { factor, input_deviation: deviation(inputs), response: segments.response(&columns) }
    }
}

/// Standard deviation of values, each about the mean of its record.
fn deviation(inputs: &[&[f64]]) -> f64 {
    let rows: usize = inputs.iter().map(|input| input.len()).sum();
    let square = |input: &&[f64]| {
        let mean = mean(input);
        input.iter().map(|x| (x - mean) * (x - mean) / rows as f64).sum::<f64>()
    };
    inputs.iter().map(square).sum::<f64>().sqrt()
}

/// The input of a stretch multiplied about its mean, and the output of a free run over it.
///
/// A record with a mean far from its first value, such as a bias that is raised from zero, would begin with a jump. Such a
/// run begins at the measured first value and rises smoothly to the multiplied one; these rows are left out again.
fn scaled_run(
    model: &Model,
    data: &Dataset,
    segments: &Segments,
    stretch: Stretch,
    factor: f64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let record = &data.records()[stretch.record];
    let measured = stretch.input(data);
    let mean = mean(measured);
    let scaled = |x: f64| mean + factor * (x - mean);
    let (from, to) = (measured[0], scaled(measured[0]));
    let before = if to.abs() > from.abs() { segments.length() } else { 0 };
    let rise = (0..before).map(|row| from + (to - from) * smooth(row as f64 / before as f64));
    let input: Vec<f64> = rise.chain(measured.iter().map(|&x| scaled(x))).collect();
    let time: Vec<f64> = (0..input.len()).map(|row| segments.step * row as f64).collect();
    let output = run(model, record, &input, &time, scaled)?;
    Ok((input[before..].to_vec(), output[before..].to_vec()))
}

/// A rise from 0 to 1 that begins and ends at rest.
fn smooth(share: f64) -> f64 {
    0.5 - 0.5 * (std::f64::consts::PI * share).cos()
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
