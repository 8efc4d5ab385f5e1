//! The section on frequency responses of a model with inertia: measured, best linear oscillator, model at several amplitudes.

use hysid::data::unit::of_column;
use hysid::diagnosis::frequency_response::{
    AtAmplitude, FrequencyResponse, ModelResponses, ResponsePoint, Segments, Window,
};
use hysid::diagnosis::resonance::{ComparedSignal, LinearOscillator};
use hysid_core::elementary::{log10, powf};
use hysid_document::chart::Track;
use hysid_document::chart::thin::{Point, thin};
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, count, number, unit};

use crate::Report;
use crate::figures::MEASURED_WIDTH;

/// Fewest frequencies of a chart.
const FEWEST_POINTS: usize = 5;

/// Points of a curve, at most.
const POINTS: usize = 2000;

/// A line is interrupted where frequencies are further apart than this multiple of their usual distance.
const GAP: f64 = 5.0;

/// Width of the lines of models, in pixels: thin, because several curves overlap.
const WIDTH: f64 = 1.6;

const MOST_DIGITS: f64 = 6.0;

/// Colours of the model, by falling amplitude.
const AMPLITUDES: [Colour; 3] = [Colour::Simulated, Colour::Series(2), Colour::Series(3)];

/// The section; `None` for a model without inertia.
pub fn section(report: &Report) -> Option<Part> {
    let parts = match report.frequency_response.as_ref()? {
        Err(why) => vec![Part::note(format!("The frequency response was not computed: {why}."))],
        Ok(responses) if responses.measured.points.len() < FEWEST_POINTS => {
            let found = count(responses.measured.points.len(), "spectral line");
            vec![Part::note(format!(
                "The frequency response is not drawn: only {found} had enough input power and coherence. Excite the system \
                 with noise or a multisine, or record longer."
            ))]
        }
        Ok(responses) => Section::of(report, responses).parts(),
    };
    Some(Part::section("Frequency response", parts))
}

struct FrequencyLine<'a> {
    name: String,
    colour: Colour,
    width: f64,
    input_deviation: Option<f64>,
    response: &'a FrequencyResponse,
}

struct Section<'a> {
    responses: &'a ModelResponses,
    lines: Vec<FrequencyLine<'a>>,
    input: &'a str,
    output: &'a str,
    /// Unit of frequencies.
    hertz: String,
}

impl<'a> Section<'a> {
    fn of(report: &'a Report, responses: &'a ModelResponses) -> Self {
        let names = report.model.names();
        let hertz = match names.time.as_deref().and_then(of_column) {
            Some(time) if time == "s" => "Hz".into(),
            Some(time) => format!("cycles per {time}"),
            None => "cycles per unit of time".into(),
        };
        let measured = FrequencyLine {
            name: "measured".into(),
            colour: Colour::Measured,
            width: MEASURED_WIDTH,
            input_deviation: responses.model.first().map(|at| at.input_deviation),
            response: &responses.measured,
        };
        let oscillator = responses.oscillator.as_ref().map(|(_, response)| FrequencyLine {
            name: "best linear oscillator".into(),
            colour: Colour::Series(1),
            width: WIDTH,
            input_deviation: None,
            response,
        });
        let model = responses.model.iter().zip(AMPLITUDES).map(|(at, colour)| FrequencyLine {
            name: model_name(at, &names.inputs[0]),
            colour,
            width: WIDTH,
            input_deviation: Some(at.input_deviation),
            response: &at.response,
        });
        let lines = std::iter::once(measured).chain(oscillator).chain(model).collect();
        Self { responses, lines, input: &names.inputs[0], output: &names.output, hertz }
    }

    fn parts(&self) -> Vec<Part> {
        let magnitude = format!("magnitude ({})", self.gain_unit());
        let magnitudes: Vec<Curve> =
            self.lines.iter().map(|line| self.curve(line, &magnitudes(line))).collect();
        let oscillator = self.responses.oscillator.as_ref().map(|(oscillator, _)| oscillator);
        let phases: Vec<Curve> =
            self.lines.iter().map(|line| self.curve(line, &line.response.phases(oscillator))).collect();
        let ordinates = |curves: &[Curve]| -> Vec<f64> {
            curves.iter().flat_map(|curve| &curve.points).map(|point| point.1).collect()
        };
        let of_magnitudes = Axis::logarithmic(magnitude.as_str(), ordinates(&magnitudes).into_iter());
        let of_phases = Axis::linear("phase (degrees)", ordinates(&phases).into_iter());
        vec![
            Part::paragraph(
                "A linear system has the same response at every amplitude. Differences between the curves of the model \
                 show its nonlinearity. If the resonance frequency falls as the input grows, the stiffness softens; if it \
                 rises, the stiffness hardens. A lower and wider peak indicates more damping.",
            ),
            Part::chart(self.chart("Magnitude", of_magnitudes, magnitudes).with_height(330.0)),
            Part::chart(self.chart("Phase", of_phases, phases).with_height(240.0)),
            Part::Table(self.table()),
            Part::note(self.method()),
        ]
    }

    /// The points of a line, and gaps where the input has no power.
    fn curve(&self, line: &FrequencyLine, values: &[f64]) -> Curve {
        let frequency = |point: &ResponsePoint| point.frequency;
        let points = line.response.points.iter().map(frequency).zip(values.iter().copied());
        let points = with_gaps(&points.collect::<Vec<Point>>());
        let record = "frequency response".to_string();
        // The same frequency is marked in both charts.
        Curve::new(thin(&points, POINTS), line.colour, line.width).tracked(Track {
            record,
            times: None,
            cycles: Vec::new(),
        })
    }

    fn chart(&self, what: &str, y: Axis, curves: Vec<Curve>) -> Chart {
        let frequencies = curves.iter().flat_map(|curve| &curve.points).map(|point| point.0);
        let x = Axis::logarithmic(format!("frequency ({})", self.hertz), frequencies);
        let description = format!(
            "{what} of {} per {} over frequency: measured, best linear oscillator, model at several amplitudes",
            unit::label(self.output),
            unit::label(self.input)
        );
        let legend = self.lines.iter().map(|line| (line.colour, line.name.clone()));
        Chart::on_axes(description, x, y, curves).with_legend(legend.collect::<Vec<_>>())
    }

    fn table(&self) -> Table {
        let mut table = Table::new([
            "response".into(),
            format!("input, std ({})", unit::of(self.input)),
            format!("resonance ({})", self.hertz),
            format!("magnitude there ({})", self.gain_unit()),
            "coherence there".into(),
        ]);
        let compared = self.responses.compared();
        for line in &self.lines {
            let peak = line.response.peak(compared);
            let known = peak.zip(line.response.peak_resolution(compared));
            let resonance =
                known.map_or(Cell::Missing, |(peak, resolution)| resolved(peak.frequency, resolution));
            table.push([
                line.name.as_str().into(),
                Cell::number(line.input_deviation, 3),
                resonance,
                Cell::number(peak.map(|peak| peak.magnitude()), 3),
                Cell::number(peak.and_then(|peak| peak.coherence), 3),
            ]);
        }
        table
    }

    fn gain_unit(&self) -> String {
        format!("{} per {}", unit::of(self.output), unit::of(self.input))
    }

    fn method(&self) -> String {
        let segments = &self.responses.segments;
        let oscillator = self.responses.oscillator.as_ref();
        let oscillator = oscillator.map_or_else(String::new, |(oscillator, _)| self.oscillator(oscillator));
        format!(
            "Measured and model: the linear system that explains most of the output for this input, without a parametric \
             form (best linear approximation), {}. Frequencies within {} {} are averaged; at smaller amplitudes, where the \
             resonance of the model may be sharper, within less. Frequencies with little input power, or with a coherence \
             that noise alone could give, are left out. Coherence: share of the output power that this linear system \
             explains. {oscillator}Model: free runs over the measured input, and over the input with its deviation from \
             the mean multiplied by smaller factors; larger ones would leave the trained range. Resonance: \
             frequency {}.",
            divided(segments),
            number(self.responses.resolution.max(segments.distance()), 2),
            self.hertz,
            match self.responses.compared() {
                ComparedSignal::Output => "of the largest magnitude",
                ComparedSignal::Changes =>
                    "where frequency times magnitude is largest; this product is proportional to the response of the changes of \
                     the output from row to row, and only these show the resonance",
            }
        )
    }

    fn oscillator(&self, oscillator: &LinearOscillator) -> String {
        format!(
            "Best linear oscillator: mass, spring and damper plus a constant gain, fitted {}in a free run; natural \
             frequency {} {}, damping ratio {} %. ",
            match oscillator.compared {
                ComparedSignal::Output => "",
                ComparedSignal::Changes => "to the changes of the output from row to row ",
            },
            number(oscillator.natural_frequency, 4),
            self.hertz,
            number(100.0 * oscillator.damping_ratio, 2)
        )
    }
}

/// A positive value that is known to a resolution, with the digits that this supports: the last one has the size of the
/// resolution.
fn resolved(value: f64, resolution: f64) -> Cell {
    let size = |number: f64| log10(number).floor();
    let digits = (size(value) - size(resolution) + 1.0).clamp(1.0, MOST_DIGITS);
    let unit = powf(10.0, size(value) + 1.0 - digits);
    Cell::number(unit * (value / unit).round(), digits as u8)
}

fn model_name(at: &AtAmplitude, input: &str) -> String {
    let deviation = unit::with(&number(at.input_deviation, 3), input);
    match at.factor {
        1.0 => format!("model at {deviation} std (as measured)"),
        factor => format!("model at {deviation} std (× {factor})"),
    }
}

/// How rows were divided, in words.
fn divided(segments: &Segments) -> String {
    let rows = count(segments.length(), "row");
    match segments.window() {
        Window::WholePeriods => {
            format!(
                "averaged over {} of {rows}; the first period is left out",
                count(segments.count(), "period")
            )
        }
        Window::Hann => format!(
            "averaged over {} of {rows} that overlap by half, with a Hann window (Welch)",
            count(segments.count(), "segment")
        ),
    }
}

fn magnitudes(line: &FrequencyLine) -> Vec<f64> {
    line.response.points.iter().map(ResponsePoint::magnitude).collect()
}

/// The points, with a NaN inserted at each gap.
fn with_gaps(points: &[Point]) -> Vec<Point> {
    let mut distances: Vec<f64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    distances.sort_by(f64::total_cmp);
    let usual = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    let mut all = Vec::with_capacity(points.len());
    for (index, &point) in points.iter().enumerate() {
        if index > 0 && point.0 - points[index - 1].0 > GAP * usual {
            all.push((f64::NAN, f64::NAN));
        }
        all.push(point);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_has_the_digits_that_its_resolution_supports() {
        for (value, resolution, expected) in [
            (38.62, 0.73, "38.6"),
            (38.62, 1.5, "39"),
            (38.62, 0.1, "38.6"),
            (0.15912, 0.0027, "0.159"),
            (1234.4, 5.0, "1234"),
            (1234.4, 20.0, "1230"),
            (99.97, 0.3, "100"),
            (38.62, 60.0, "40"),
            (38.625, 1e-9, "38.625"),
        ] {
            assert_eq!(resolved(value, resolution).shown(), expected, "{value} ± {resolution}");
        }
    }
}
