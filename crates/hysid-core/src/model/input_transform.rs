//! Input transform: shifts and compresses the input of a model, and adds its history as further inputs.
//!
//! ```text
//! x - c instead of x                                                        theory.md (11.8)
//! u = asinh(x / s),    v = asinh(x' / s')                                   theory.md (11.1)
//! m = max |x| so far / X,    p = ln(1 + 10 path so far / P) / ln 11         theory.md (11.2)
//! ```
//!
//! `x` is the first input and `x'` its rate. `c` is the origin: 0 if it lies inside the range of the input,
//! otherwise the value at which the records begin, or the middle of the range. *Compression* replaces `x` and
//! `x'` by `u` and `v`, with the scales `s` and `s'` in the units of `x` and `x'`. *History* adds `m` and `p`
//! as inputs: running peak and travelled path of the first input, with the largest `|x|` in training, `X`,
//! and the longest path of a record, `P`.
//!
//! Compression resolves small inputs: a soft magnet reverses within a hundredth of the field range. `u`
//! increases with `x`, so turning points, wiping-out and Madelung's rules are the same in `u` as in `x`.
//! Running peak and path describe the state of a degrading structure directly.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::data::FEWEST_ROWS;
use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Excitation, Record};
use crate::elementary::{asinh, ln, ln_1p, sinh};
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::facts::Origin;
use crate::network::scaling::SCALES;
use crate::options::input_options::HISTORY_INPUTS;
use crate::options::input_options::InputOptions;

/// The input transform of a model, in the user's units; the equations are those of the [module page](self).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputTransform {
    /// `c`: origin of each input, in its unit, where the memory is virgin; empty if all are 0 (theory.md (11.8)).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub origins: Vec<f64>,
    /// `s` of `u = asinh(x / s)`, in the unit of the input; `None` for no compression (theory.md (11.1)).
    pub compression: Option<f64>,
    /// `s'` of `v = asinh(x' / s')`, in the unit of the rate; `None` for no compression (theory.md (11.1)).
    pub rate_compression: Option<f64>,
    /// `X` and `P` of `m = max |x| so far / X` and `p = ln(1 + 10 path so far / P) / ln 11`, in the unit of
    /// the input; `None` for no history (theory.md (11.2)).
    pub history: Option<(f64, f64)>,
}

/// Share of the rows whose rates stay below the reference rate of compression.
const ROWS_BELOW: f64 = 0.995;

impl InputOptions {
    /// The input transform for these data; shares become scales in the user's units.
    pub(crate) fn of(
        &self,
        data: &Dataset,
        rate: Option<RateMethod>,
        origin: Origin,
    ) -> Result<InputTransform> {
        let origins = match origin {
            Origin::Zero(_) => Vec::new(),
            Origin::OfData => origins(data),
        };
        let origin = origins.first().copied().unwrap_or_default();
        let (low, high) = data.input_range(0);
        let largest = (low - origin).abs().max((high - origin).abs());
        let rate_compression = match (self.rate_compression, rate) {
            (Some(share), Some(method)) => Some(share * common_rate(data, method)?),
            _ => None,
        };
        let way = |record: &Record| path(&record.lead_in_rows()) + path(&record.inputs()[0]);
        let longest = || data.records().iter().map(way).fold(0.0, f64::max);
        Ok(InputTransform {
            compression: self.compression.map(|share| share * largest),
            rate_compression,
            history: self.history.then(|| (largest, longest())),
            origins,
        })
    }
}

/// Least share of the range between 0 and its ends if 0 is the origin, and largest between first values at one point.
const MARGIN: f64 = 0.05;

/// The origin `c` of each input (theory.md (11.8)); none if all are 0.
fn origins(data: &Dataset) -> Vec<f64> {
    let origins: Vec<f64> = (0..data.names().inputs.len()).map(|input| origin(data, input)).collect();
    if origins.iter().all(|origin| *origin == 0.0) { Vec::new() } else { origins }
}

/// The origin `c` of an input, in its unit (theory.md (11.8)): 0 if it lies inside the range; otherwise, for
/// the first input, the value at which all records begin, if there is one; otherwise the middle of the range.
///
/// A 0 outside the range, or at its end (0 to 150 V, 198 to 202 mm), has no meaning for the memory. The
/// virgin state then belongs where the records begin.
pub fn origin(data: &Dataset, input: usize) -> f64 {
    let (low, high) = data.input_range(input);
    let margin = MARGIN * (high - low);
    if low + margin < 0.0 && high - margin > 0.0 {
        return 0.0;
    }
    let beginnings = || data.records().iter().map(|record| record.inputs()[input][0]);
    let first = beginnings().next().unwrap_or_default();
    if input == 0 && beginnings().all(|beginning| (beginning - first).abs() <= margin) {
        return first;
    }
    0.5 * low + 0.5 * high
}

fn path(x: &[f64]) -> f64 {
    x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
}

/// The rate that most rows stay below; 1 if all rates are 0.
fn common_rate(data: &Dataset, method: RateMethod) -> Result<f64> {
    let mut rates = Vec::with_capacity(data.rows());
    for record in data.records() {
        rates.extend(method.rate(record)?.into_iter().map(f64::abs));
    }
    Ok(common_magnitude(rates))
}

/// The value that 99.5 % of these magnitudes, of which there is at least one, stay below; 1 if it is 0.
pub fn common_magnitude(mut magnitudes: Vec<f64>) -> f64 {
    let place = ((magnitudes.len() - 1) as f64 * ROWS_BELOW) as usize;
    let (_, &mut magnitude, _) = magnitudes.select_nth_unstable_by(place, f64::total_cmp);
    if magnitude > 0.0 { magnitude } else { 1.0 }
}

/// Transformed data, and the method of their rate.
pub struct TransformedData<'d> {
    /// The input transform.
    pub preprocessing: InputTransform,
    /// The transformed data.
    pub data: Cow<'d, Dataset>,
    /// The method of the rate of the transformed data.
    pub rate: Option<RateMethod>,
}

impl<'d> TransformedData<'d> {
    /// The data as seen by a model; an error for unusable data or shares, or a rate that cannot be computed.
    pub fn of(
        data: &'d Dataset,
        shaping: &InputOptions,
        rate: Option<RateMethod>,
        origin: Origin,
    ) -> Result<Self> {
        shaping.check()?;
        let data = match shaping.warm_up {
            0 => Cow::Borrowed(data),
            rows => Cow::Owned(data.clone().warmed_up(rows)),
        };
        data.check_identifiable(FEWEST_ROWS)?;
        let preprocessing = shaping.of(&data, rate, origin)?;
        let (seen, seen_rate) = preprocessing.data(&data, rate)?;
        let seen = match seen {
            Cow::Owned(seen) => Some(seen),
            Cow::Borrowed(_) => None,
        };
        Ok(Self { preprocessing, data: seen.map_or(data, Cow::Owned), rate: seen_rate })
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct InputPast {
    largest: f64,
    path: f64,
    last: Option<f64>,
}

impl InputPast {
    /// Adds the next input and returns `m = max |x| so far / X` and `p = ln(1 + 10 path so far / P) / ln 11`
    /// (theory.md (11.2)).
    fn take(&mut self, x: f64, (largest, longest): (f64, f64)) -> [f64; HISTORY_INPUTS] {
        self.largest = self.largest.max(x.abs());
        self.path += self.last.map_or(0.0, |last| (x - last).abs());
        self.last = Some(x);
        [self.largest / largest, ln_1p(10.0 * self.path / longest) / ln(11.0)]
    }

    /// Adds the first input at each row of a lead-in.
    fn take_all(&mut self, rows: &[f64], origin: f64, scales: (f64, f64)) {
        for &x in rows {
            self.take(limited(x) - origin, scales);
        }
    }
}

/// A lead-in in the transformed input.
pub(crate) struct SeenLeadIn {
    /// The transformed first input at each row.
    pub first: Vec<f64>,
    /// All further transformed inputs, which have their values of the first row of the record.
    pub others: Vec<f64>,
}

impl InputTransform {
    /// True if the input is not changed.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Number of inputs that are added to those of the record.
    pub fn added_inputs(&self) -> usize {
        if self.history.is_some() { HISTORY_INPUTS } else { 0 }
    }

    /// Origin `c` of an input, in its unit.
    pub fn origin(&self, input: usize) -> f64 {
        self.origins.get(input).copied().unwrap_or_default()
    }

    /// The transformed first input.
    pub fn input(&self, x: f64) -> f64 {
        let x = x - self.origin(0);
        self.compression.map_or(x, |scale| asinh(x / scale))
    }

    /// The first input whose transform this is.
    pub fn original(&self, seen: f64) -> f64 {
        self.compression.map_or(seen, |scale| scale * sinh(seen)) + self.origin(0)
    }

    /// Any transformed input; the index 0 is the first.
    pub fn input_as_seen(&self, input: usize, value: f64) -> f64 {
        if input == 0 { self.input(value) } else { value - self.origin(input) }
    }

    /// The transformed rate.
    pub fn rate(&self, rate: f64) -> f64 {
        self.rate_compression.map_or(rate, |scale| asinh(rate / scale))
    }

    /// Writes all transformed inputs of a sample into `seen`.
    pub(crate) fn sample(&self, inputs: &[f64], past: &mut InputPast, seen: &mut Vec<f64>) {
        seen.clear();
        seen.extend(
            inputs.iter().enumerate().map(|(input, &value)| self.input_as_seen(input, limited(value))),
        );
        if let Some(scales) = self.history {
            seen.extend(past.take(limited(inputs[0]) - self.origin(0), scales));
        }
    }

    /// Transforms a lead-in, whose last row has the first input of `first_row`. `past` then contains it.
    pub(crate) fn lead_in(&self, rows: &[f64], first_row: &[f64], past: &mut InputPast) -> SeenLeadIn {
        if let Some(scales) = self.history {
            past.take_all(rows, self.origin(0), scales);
        }
        let mut others = Vec::new();
        self.sample(first_row, &mut past.clone(), &mut others);
        others.remove(0);
        SeenLeadIn { first: rows.iter().map(|&x| self.input(limited(x))).collect(), others }
    }

    /// The transformed columns of an excitation; `None` if they are unchanged.
    pub(crate) fn columns(
        &self,
        excitation: &Excitation<'_>,
        rate: Option<RateMethod>,
    ) -> Result<Option<SeenColumns>> {
        if self.is_none() {
            return Ok(None);
        }
        let x = excitation.inputs()[0];
        let measured = excitation.inputs().iter().enumerate();
        let mut inputs: Vec<Vec<f64>> = measured
            .map(|(input, values)| values.iter().map(|&value| self.input_as_seen(input, value)).collect())
            .collect();
        if let Some(scales) = self.history {
            let mut past = InputPast::default();
            past.take_all(&excitation.lead_in_rows(), self.origin(0), scales);
            let (largest, path) = x.iter().map(|&x| past.take(x - self.origin(0), scales).into()).unzip();
            inputs.extend([largest, path]);
        }
        let seen_rate = |method: RateMethod| -> Result<Vec<f64>> {
            let mut rates = vec![0.0; excitation.len()];
            method.fill(excitation, 0, &mut rates)?;
            rates.iter_mut().for_each(|rate| *rate = self.rate(*rate));
            Ok(rates)
        };
        let lead_in = excitation.lead_in().map(|turns| turns.iter().map(|&x| self.input(x)).collect());
        Ok(Some(SeenColumns { inputs, rate: rate.map(seen_rate).transpose()?, lead_in }))
    }

    /// Transformed data, and the method of their rate.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn data<'d>(
        &self,
        data: &'d Dataset,
        rate: Option<RateMethod>,
    ) -> Result<(Cow<'d, Dataset>, Option<RateMethod>)> {
        let mut records = Vec::with_capacity(data.records().len());
        for record in data.records() {
            let Some(seen) = self.columns(&record.excitation(), rate)? else {
                return Ok((Cow::Borrowed(data), rate));
            };
            records.push(seen.record(record)?);
        }
        let mut names = data.names().clone();
        names.inputs.extend((0..self.added_inputs()).map(|added| format!("history {}", added + 1)));
        Ok((Cow::Owned(Dataset::new(names, records)?), rate.map(|_| RateMethod::Given)))
    }

    pub(crate) fn check(&self) -> Result<()> {
        let scales =
            [self.compression, self.rate_compression, self.history.map(|h| h.0), self.history.map(|h| h.1)];
        let is_scale = |scale: f64| SCALES.contains(&scale);
        let is_value = |origin: &f64| origin.abs() <= LARGEST_VALUE;
        if scales.into_iter().flatten().all(is_scale) && self.origins.iter().all(is_value) {
            return Ok(());
        }
        Err(Error::Parts("its preprocessing has a scale that is none".into()))
    }
}

/// A value of the user's as a model takes it, so that nothing overflows: records have no larger ones.
pub(crate) fn limited(value: f64) -> f64 {
    value.clamp(-LARGEST_VALUE, LARGEST_VALUE)
}

pub(crate) struct SeenColumns {
    inputs: Vec<Vec<f64>>,
    rate: Option<Vec<f64>>,
    lead_in: Option<Vec<f64>>,
}

impl SeenColumns {
    /// A record of these columns, with all else of the one measured.
    fn record(self, measured: &Record) -> Result<Record> {
        let mut seen = Record::new(measured.name(), self.inputs, measured.output().to_vec())?;
        if let Some(time) = measured.time() {
            seen = seen.with_time(time.to_vec())?;
        }
        if let Some(lead_in) = self.lead_in {
            seen = seen.with_lead_in(lead_in)?;
        }
        if let Some(weights) = measured.weights() {
            seen = seen.with_weights(weights.to_vec())?;
        }
        match self.rate {
            Some(rate) => seen.with_given_rate(rate),
            None => Ok(seen),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::ColumnNames;

    fn data() -> Dataset {
        let x = vec![0.0, 1.0, -2.0, 0.5];
        let record = Record::new("r", vec![x], vec![0.0, 1.0, 2.0, 3.0]).unwrap();
        let record = record.with_time(vec![0.0, 1.0, 2.0, 3.0]).unwrap();
        Dataset::new(ColumnNames::plain(1), vec![record]).unwrap()
    }

    #[test]
    fn every_row_follows_the_formulas() {
        let data = data();
        let shaping = InputOptions {
            compression: Some(0.1),
            rate_compression: Some(0.5),
            history: true,
            ..InputOptions::default()
        };
        let rate = Some(RateMethod::Backward);
        let preprocessing = shaping.of(&data, rate, Origin::OfData).unwrap();
        let (seen, method) = preprocessing.data(&data, rate).unwrap();
        assert_eq!(method, Some(RateMethod::Given));
        let record = &seen.records()[0];
        // s = 0.2, X = 2, P = 1 + 3 + 2.5; the rates are 0, 1, -3, 2.5 and 99.5 % of three rows stay below 2.5.
        let [u, m, p] = record.inputs() else { panic!("three inputs") };
        assert_eq!(u[2], asinh(-10.0));
        assert_eq!(**m, [0.0, 0.5, 1.0, 1.0]);
        assert!((p[2] - ln(1.0 + 10.0 * 4.0 / 6.5) / ln(11.0)).abs() < 1e-15);
        assert!((p[3] - 1.0).abs() < 1e-15);
        assert!((record.given_rate().unwrap()[2] - asinh(-3.0 / 1.25)).abs() < 1e-15);

        let (mut past, mut sample) = (InputPast::default(), Vec::new());
        for (row, &x) in data.records()[0].inputs()[0].iter().enumerate() {
            preprocessing.sample(&[x], &mut past, &mut sample);
            assert_eq!(sample, [u[row], m[row], p[row]]);
        }
    }
}
