//! The neurons: thresholds, capacities, relaxation times, output weights.

use hysid::data::record::{Dataset, Record};
use hysid::network::scaling::Scaling;
use hysid::network::{Layout, Network};
use hysid::operator::{DeterioratingStop, Operator};
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, count, unit};

use crate::{Report, seen_label};

/// From this capacity on a stop counts as one that never deteriorates.
const LASTING: f64 = 9e6;

/// Most rows of a table.
const MOST_ROWS: usize = 40;

/// Most output weights in the table.
const MOST_WEIGHTS: usize = 10;

/// Most channels in the table of stops.
const MOST_CHANNELS: usize = 5;

/// A stop in the user's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Number, counted from 1.
    pub number: usize,
    /// Threshold in the unit of the first input.
    pub threshold: f64,
    /// Weights of the scaled channels.
    pub weights: Vec<f64>,
    /// Capacity; infinite without deterioration.
    pub beta: f64,
}

impl Stop {
    /// All stops of a network, by their numbers.
    pub fn all(network: &Network, scaling: &Scaling) -> Vec<Self> {
        let (a, parameters) = (network.architecture(), network.parameters());
        let layout = Layout::new(*a);
        let betas = &parameters[layout.ln_beta.clone()];
        let weights = parameters[layout.stop_weights.clone()].chunks(a.channels().max(1));
        let stop = |(j, weights): (usize, &[f64])| Self {
            number: j + 1,
            threshold: scaling.inputs[0] / weights[0].abs(),
            weights: weights.to_vec(),
            beta: betas.get(j).map_or(f64::INFINITY, |ln_beta| ln_beta.exp()),
        };
        weights.enumerate().map(stop).collect()
    }

    /// True if no input within the trained ranges makes it slip.
    fn never_slips(&self) -> bool {
        self.weights.iter().map(|w| w.abs()).sum::<f64>() <= 1.0
    }
}

/// The section on the neurons; `None` for a model that has none.
pub fn section(report: &Report) -> Option<Part> {
    report.model.network()?;
    let stops = stops(report);
    let a = network(report).architecture();
    let kinds = [(a.stops, "stop"), (a.relaxation_neurons(), "relaxation neuron"), (a.hidden, "tanh neuron")];
    let kinds: Vec<String> =
        kinds.into_iter().filter(|&(n, _)| n > 0).map(|(n, kind)| count(n, kind)).collect();
    let words = format!("{}; {} in all.", kinds.join(", "), count(a.parameters(), "parameter"));
    let mut parts = vec![
        Part::paragraph(words),
        Part::heading("Stops"),
        Part::chart(threshold_chart(report, &stops)),
        Part::Table(stop_table(report, &stops)),
        stop_note(report, &stops),
    ];
    parts.extend(relaxation_parts(report));
    parts.extend(output_parts(report));
    Some(Part::section("The neurons", parts))
}

fn network<'a>(report: &'a Report) -> &'a Network {
    report.model.network().expect("the section is on networks")
}

fn scaling<'a>(report: &'a Report) -> &'a Scaling {
    report.model.scaling().expect("a network has a scaling")
}

/// All stops, the smallest threshold first.
fn stops(report: &Report) -> Vec<Stop> {
    let mut stops = Stop::all(network(report), scaling(report));
    stops.sort_by(|a, b| a.threshold.total_cmp(&b.threshold));
    stops
}

fn stop_table(report: &Report, stops: &[Stop]) -> Table {
    let a = network(report).architecture();
    let channels = a.channels().min(MOST_CHANNELS);
    let mut headings = vec!["stop".to_string(), format!("threshold of {}", seen_label(report.model))];
    headings.extend((0..channels).map(|channel| format!("weight of {}", channel_name(report, channel))));
    if a.deterioration {
        headings.push("capacity β".into());
        headings.push("strength left".into());
    }
    let springs = stops.iter().any(Stop::never_slips);
    headings.extend(springs.then(|| "note".to_string()));
    let left = if a.deterioration { strength_left(report, stops) } else { None };
    let row = |(index, stop): (usize, &Stop)| {
        let mut row = vec![stop.number.into(), Cell::number(stop.threshold, 4)];
        row.extend(stop.weights[..channels].iter().map(|&weight| Cell::from(weight)));
        if a.deterioration {
            row.push(if stop.beta >= LASTING { "∞".into() } else { stop.beta.into() });
            row.push(left.as_ref().map_or(Cell::Missing, |left| Cell::Percent(100.0 * left[index], 3)));
        }
        if springs {
            row.push(if stop.never_slips() { "never slips: a spring".into() } else { "".into() });
        }
        row
    };
    Table::new(headings).with_rows(stops.iter().enumerate().take(MOST_ROWS).map(row))
}

fn stop_note(report: &Report, stops: &[Stop]) -> Part {
    let mut text = String::from(
        "A stop is a spring behind a friction slider: it slides once the input has travelled by its threshold \
         (twice that after a reversal). Weights are of inputs scaled to 1 at their largest. A stop that never \
         slips within the trained range has no memory of its own.",
    );
    if network(report).architecture().rate {
        text += " The rate moves it too, by its weight; the threshold is that for a slow input.";
    }
    if network(report).architecture().deterioration {
        text += " A stop has lost its strength after sliding β times its threshold; ∞ means never. \
                 “Strength left” is that at the end of the longest training record.";
    }
    if stops.len() > MOST_ROWS {
        text += &format!(" {} more are not listed.", stops.len() - MOST_ROWS);
    }
    Part::note(text)
}

fn channel_name(report: &Report, channel: usize) -> String {
    match (channel, network(report).architecture().rate) {
        (1, true) if report.model.input_transform().rate_companding.is_some() => "the companded rate".into(),
        (1, true) => "the rate".into(),
        (channel, rate) => input_name(report, channel - usize::from(rate && channel > 0)),
    }
}

/// An input of the network: one that was measured, or what its past comes to.
fn input_name(report: &Report, input: usize) -> String {
    let names = &report.model.names().inputs;
    let name = |input: usize| unit::split(&names[input]).0;
    match input.checked_sub(names.len()) {
        None if input == 0 && report.model.input_transform().companding.is_some() => seen_label(report.model),
        None => name(input),
        Some(0) => format!("largest |{}| so far", name(0)),
        Some(_) => format!("path of {} so far", name(0)),
    }
}

/// Share of each stop's strength that is left at the end of the longest record.
fn strength_left(report: &Report, stops: &[Stop]) -> Option<Vec<f64>> {
    let data = report.sets.first()?.data;
    let longest: &Record = data.records().iter().max_by_key(|record| record.len())?;
    let longest = Dataset::new(data.names().clone(), vec![longest.clone()]).ok()?;
    let (seen, rate) = report.model.input_transform().data(&longest, report.model.rate()).ok()?;
    let longest = &seen.records()[0];
    let drive = scaling(report).drive(longest, network(report).architecture(), rate).ok()?;
    let left = |stop: &Stop| {
        let mut element = DeterioratingStop::new(1.0, stop.beta).ok()?;
        for row in 0..longest.len() {
            let input: f64 = stop.weights.iter().zip(&drive.channels).map(|(w, u)| w * u[row]).sum();
            element.step(input);
        }
        Some((1.0 - element.slip() / stop.beta).max(0.0))
    };
    stops.iter().take(MOST_ROWS).map(left).collect()
}

/// Thresholds on a logarithmic axis, beside the range of the input.
fn threshold_chart(report: &Report, stops: &[Stop]) -> Chart {
    let largest = scaling(report).inputs[0];
    let shown = |stop: &Stop| stop.threshold.clamp(1e-4 * largest, 1e4 * largest);
    let top = stops.len() as f64 + 0.5;
    let mut curves = vec![Curve::new(vec![(largest, 0.5), (largest, top)], Colour::Input, 1.5)];
    curves.extend(stops.iter().enumerate().map(|(index, stop)| {
        let colour = if stop.never_slips() { Colour::Faint } else { Colour::Simulated };
        Curve::new(vec![(shown(stop), index as f64 + 1.0)], colour, 4.0)
    }));
    let thresholds = stops.iter().map(shown).chain([largest]);
    let x = Axis::logarithmic(format!("threshold of {}", seen_label(report.model)), thresholds);
    let y = Axis::linear("stops by threshold", [0.5, top].into_iter());
    let description = format!("Thresholds of the {} stops", stops.len());
    Chart::on_axes(description, x, y, curves).with_height(240.0).with_legend([
        (Colour::Simulated, "stop"),
        (Colour::Faint, "never slips"),
        (Colour::Input, "largest input in training"),
    ])
}

fn relaxation_parts(report: &Report) -> Vec<Part> {
    let network = network(report);
    let a = network.architecture();
    if a.relaxation == 0 {
        return Vec::new();
    }
    let names = report.model.names();
    let time = names.time.as_deref().map_or("unit of time".to_string(), unit::of);
    let ln_taus = &network.parameters()[Layout::new(*a).ln_tau];
    let mut neurons: Vec<(usize, f64)> = ln_taus.iter().map(|ln_tau| ln_tau.exp()).enumerate().collect();
    neurons.sort_by(|p, q| (p.0 / a.relaxation).cmp(&(q.0 / a.relaxation)).then(p.1.total_cmp(&q.1)));
    let row = |&(m, tau): &(usize, f64)| {
        vec![(m + 1).into(), input_name(report, m / a.relaxation).into(), tau.into()]
    };
    let columns = ["neuron".into(), "of input".into(), format!("relaxation time ({time})")];
    let table = Table::new(columns).with_rows(neurons.iter().take(MOST_ROWS).map(row));
    let words = "A relaxation neuron is a spring behind a dashpot: the effect of the input on it fades \
                 within its relaxation time.";
    vec![Part::heading("Relaxation neurons"), Part::Table(table), Part::note(words)]
}

/// The output weights that count most.
fn output_parts(report: &Report) -> [Part; 3] {
    let network = network(report);
    let deviation = scaling(report).output_deviation;
    let names = output_names(report);
    let mut weights: Vec<(String, f64)> =
        names.into_iter().zip(network.output().iter().map(|weight| weight * deviation)).collect();
    let all = weights.len();
    weights.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    weights.truncate(MOST_WEIGHTS);
    let columns = ["from".into(), format!("weight ({})", unit::of(&report.model.names().output))];
    let row = |(name, weight): &(String, f64)| vec![name.as_str().into(), Cell::number(*weight, 4)];
    let table = Table::new(columns).with_rows(weights.iter().map(row));
    let mut words = String::from(
        "The output is a weighted sum. The outputs of tanh neurons and stops are between −1 and 1; the \
         outputs of linear and relaxation neurons scale with the input.",
    );
    if weights.len() < all {
        words += &format!(" The {} largest of {all} weights are listed.", weights.len());
    }
    [Part::heading("Output weights"), Part::Table(table), Part::note(words)]
}

/// What each output weight multiplies, in order.
fn output_names(report: &Report) -> Vec<String> {
    let a = network(report).architecture();
    let mut names: Vec<String> = a.constant.then(|| "constant".to_string()).into_iter().collect();
    names.extend((1..=a.hidden).map(|i| format!("tanh neuron {i}")));
    if a.output_weights() > names.len() {
        names.extend(a.linear.then(|| "linear neuron".to_string()));
        names.extend((1..=a.stops).map(|j| format!("stop {j}")));
        names.extend((1..=a.relaxation_neurons()).map(|m| format!("relaxation neuron {m}")));
    }
    names
}
