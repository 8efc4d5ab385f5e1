//! How rows are divided into segments that are transformed, the same for measured and for simulated outputs.

use hysid_core::data::record::Dataset;
use hysid_core::elementary::powf;

use super::period::period;
use super::spectra::{Spectra, SpectralLine, Window, mean};
use super::stretches::{FEWEST_ROWS, Stretch, stretches};
use super::{FrequencyResponse, NoResponse, ResponsePoint};
use crate::resonance::LinearOscillator;

/// Frequencies at which the input has less than this share of its largest power are left out.
const LEAST_POWER: f64 = 1e-7;

/// With a window, so are those with less than this share of the power of a line that is not further away than so many lines:
/// a strong line leaks more than that to its next neighbours, and the edge of a band would have useless points.
const LEAST_OF_NEIGHBOURS: f64 = 1e-2;
const NEIGHBOURS: usize = 3;

/// So are those whose coherence noise alone would exceed with this probability.
const CHANCE: f64 = 0.05;

/// Parts into which the half-power bandwidth of the resonance is divided: it changes the height of the peak by less than
/// 1 %, theory.md (10.47).
const RESOLUTION: f64 = 8.0;

/// Segments with a window are halved until there are so many: the standard error of a magnitude is then less than a third
/// of what a single one has.
const FEWEST_SEGMENTS: usize = 8;

/// A larger damping ratio does not make a resolution coarser.
const MOST_DAMPING: f64 = 0.2;

/// The distance of frequencies that must be resolved around the resonance of an oscillator: an eighth of its half-power
/// bandwidth `2 ζ f`.
pub fn resolution(oscillator: &LinearOscillator) -> f64 {
    2.0 * oscillator.damping_ratio.min(MOST_DAMPING) * oscillator.natural_frequency / RESOLUTION
}

/// The segments of data.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    pub(super) stretches: Vec<Stretch>,
    /// Rows of each stretch at which a segment begins.
    beginnings: Vec<Vec<usize>>,
    /// Time between rows.
    pub(super) step: f64,
    length: usize,
    window: Window,
}

impl Segments {
    /// Divides data with one input and evenly spaced time (to 1/1000 of a step), so that frequencies at this distance, in
    /// cycles per unit of time, can be resolved if there are enough rows; see [`resolution`]. Segments with a row
    /// without output are left out.
    ///
    /// # Errors
    /// Why the data have no frequency response.
    pub fn of(data: &Dataset, resolution: Option<f64>) -> Result<Self, NoResponse> {
        let (stretches, step) = stretches(data)?;
        if is_constant(stretches.iter().map(|stretch| stretch.input(data)))
            || is_constant(stretches.iter().map(|stretch| stretch.output(data)))
        {
            return Err(NoResponse::Constant);
        }
        let with = |length: usize, window: Window| {
            let beginnings =
                stretches.iter().map(|stretch| beginnings(stretch.output(data), length, window)).collect();
            Self { stretches: stretches.clone(), beginnings, step, length, window }
        };
        if let Some(length) = common_period(data, &stretches) {
            let segments = with(length, Window::WholePeriods);
            if segments.count() > 0 {
                return Ok(segments);
            }
        }
        let rows: usize = stretches.iter().map(|stretch| stretch.rows).sum();
        let longest = stretches.iter().map(|stretch| stretch.rows).max().unwrap_or(0);
        let wanted =
            resolution.map_or(rows / FEWEST_SEGMENTS, |distance| (1.0 / (distance * step)).ceil() as usize);
        let mut length = wanted.min(longest).max(FEWEST_ROWS).next_power_of_two();
        while length >= FEWEST_ROWS {
            let segments = with(length, Window::Hann);
            if segments.count() >= FEWEST_SEGMENTS {
                return Ok(segments);
            }
            length /= 2;
        }
        Err(NoResponse::TooFewRows)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.beginnings.iter().map(Vec::len).sum()
    }

    /// Rows of each.
    pub fn length(&self) -> usize {
        self.length
    }

    /// How their rows are weighted.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Distance in cycles per unit of time of the frequencies that are transformed.
    pub fn distance(&self) -> f64 {
        1.0 / (self.length as f64 * self.step)
    }

    /// The response of the measured output to the input; frequencies within `resolution` are averaged.
    pub fn measured(&self, data: &Dataset, resolution: f64) -> FrequencyResponse {
        let stretches = self.stretches.iter();
        let columns = stretches.map(|stretch| (stretch.input(data), stretch.output(data)));
        self.response(&columns.collect::<Vec<_>>(), resolution)
    }

    /// The response of outputs to inputs, both over the rows of each stretch.
    pub(super) fn response(&self, columns: &[(&[f64], &[f64])], resolution: f64) -> FrequencyResponse {
        let segments = || {
            self.beginnings.iter().zip(columns).flat_map(|(beginnings, (input, output))| {
                let rows = move |&begin: &usize| begin..begin + self.length;
                beginnings.iter().map(rows).map(move |rows| (&input[rows.clone()], &output[rows]))
            })
        };
        let scales =
            segments().fold([0.0f64; 2], |[u, y], (input, output)| [u.max(size(input)), y.max(size(output))]);
        if scales[0] == 0.0 {
            return FrequencyResponse { points: Vec::new() };
        }
        let scales = scales.map(|scale| if scale > 0.0 { scale } else { 1.0 });
        let mut spectra = Spectra::empty(self.length, self.window);
        segments().for_each(|(input, output)| spectra.add(input, output, scales));
        FrequencyResponse { points: self.points(&spectra.lines, scales[1] / scales[0], resolution) }
    }

    /// The lines at which the input has power, neighbours within the resolution together. `scale` turns their quotients
    /// into the units of the data.
    fn points(&self, lines: &[SpectralLine], scale: f64, resolution: f64) -> Vec<ResponsePoint> {
        let powered = (1..).zip(lines).zip(has_power(lines, self.window)).filter(|(_, has_power)| *has_power);
        let mut groups: Vec<FrequencyGroup> = Vec::new();
        for ((multiple, line), _) in powered {
            let frequency = f64::from(multiple) * self.distance();
            match groups.last_mut().filter(|group| frequency - group.lowest < resolution) {
                Some(group) => group.add(frequency, line),
                None => groups.push(FrequencyGroup::of(frequency, line)),
            }
        }
        let points = groups.into_iter().filter_map(|group| group.point(scale, self.count()));
        points.filter(|point| point.real.is_finite() && point.imaginary.is_finite()).collect()
    }
}

struct FrequencyGroup {
    lowest: f64,
    lines: usize,
    sum: SpectralLine,
    /// Distances from the lowest frequency, weighted with the power of the input.
    moment: f64,
}

impl FrequencyGroup {
    fn of(frequency: f64, line: &SpectralLine) -> Self {
        Self { lowest: frequency, lines: 1, sum: *line, moment: 0.0 }
    }

    fn add(&mut self, frequency: f64, line: &SpectralLine) {
        self.lines += 1;
        self.sum.add(line);
        self.moment += (frequency - self.lowest) * line.input;
    }

    /// `None` if noise alone could give as much coherence.
    fn point(self, scale: f64, segments: usize) -> Option<ResponsePoint> {
        let SpectralLine { input, output, product } = self.sum;
        let averaged = self.lines * segments;
        let coherence =
            (averaged > 1 && output > 0.0).then(|| (product.norm_sqr() / (input * output)).min(1.0));
        // Of n averaged transforms, noise exceeds a coherence c with the probability (1 - c)^(n - 1).
        if coherence.is_some_and(|coherence| powf(1.0 - coherence, averaged as f64 - 1.0) > CHANCE) {
            return None;
        }
        let response = product / input * scale;
        let frequency = self.lowest + self.moment / input;
        Some(ResponsePoint { frequency, real: response.re, imaginary: response.im, coherence })
    }
}

/// At which lines the input has power of its own.
fn has_power(lines: &[SpectralLine], window: Window) -> impl Iterator<Item = bool> {
    let largest = |lines: &[SpectralLine]| lines.iter().map(|line| line.input).fold(0.0, f64::max);
    let least = LEAST_POWER * largest(lines);
    let neighbours = match window {
        Window::WholePeriods => 0,
        Window::Hann => NEIGHBOURS,
    };
    lines.iter().enumerate().map(move |(index, line)| {
        let near = &lines[index.saturating_sub(neighbours)..(index + neighbours + 1).min(lines.len())];
        line.input > 0.0 && line.input >= least.max(LEAST_OF_NEIGHBOURS * largest(near))
    })
}

impl Stretch {
    pub(super) fn input<'d>(&self, data: &'d Dataset) -> &'d [f64] {
        &data.records()[self.record].inputs()[0][..self.rows]
    }

    pub(super) fn output<'d>(&self, data: &'d Dataset) -> &'d [f64] {
        &data.records()[self.record].output()[..self.rows]
    }
}

/// The period of all inputs, in rows.
fn common_period(data: &Dataset, stretches: &[Stretch]) -> Option<usize> {
    let mut periods = stretches.iter().map(|stretch| period(stretch.input(data)));
    let first = periods.next()??;
    periods.all(|period| period == Some(first)).then_some(first)
}

/// Rows at which segments begin, all with an output: periods after the first one, or segments that overlap by half.
fn beginnings(output: &[f64], length: usize, window: Window) -> Vec<usize> {
    let (first, distance) = match window {
        Window::WholePeriods => (length, length),
        Window::Hann => (0, length / 2),
    };
    // The row after the last one without output, row by row.
    let mut sound_from = Vec::with_capacity(output.len());
    let mut from = 0;
    for (row, y) in output.iter().enumerate() {
        from = if y.is_nan() { row + 1 } else { from };
        sound_from.push(from);
    }
    let fits = |&begin: &usize| begin + length <= output.len();
    let all = (first..).step_by(distance).take_while(fits);
    all.filter(|begin| sound_from[begin + length - 1] <= *begin).collect()
}

fn is_constant<'c>(columns: impl Iterator<Item = &'c [f64]>) -> bool {
    let mut values = columns.flatten().filter(|value| !value.is_nan());
    values.next().is_some_and(|first| values.all(|value| value == first))
}

/// Largest distance from the mean.
fn size(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|value| (value - mean).abs()).fold(0.0, f64::max)
}
