//! How cost grows with rows, stops, tanh neurons and members of an ensemble.
//!
//! `growth` prints tables, in about a minute; with `--picture FILE.svg` it also draws them. Every time is the minimum of many runs, since other programs on the machine only ever add to it.

#[path = "../../crates/hysid/benches/inputs/mod.rs"]
mod inputs;

use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::Args;
use hysid::data::record::Dataset;
use hysid::fit::network::fit;
use hysid::fit::network::objective::Objective;
use hysid::model::input_transform::InputTransform;
use hysid::model::{Ensemble, Group, Model, Node, NodeKind, Predictor, ProvenanceDraft, Weights};
use hysid::options::FitSpec;
use hysid::options::fit_spec::AutoOptions;
use hysid::options::network::FitOptions;
use hysid_core::elementary::{ln, square};
use hysid_core::network::scaling::Scaling;
use hysid_core::termination::Termination;
use hysid_document::chart::{self, Appearance, Axis, Chart, Colour, Curve};
use hysid_document::{Cell, Page, Part, Table, markdown};

use crate::files;
use inputs::{data, network, options, parameters, path, xpnn};

/// Stops and tanh neurons where they do not vary.
const STOPS: usize = 10;
const NEURONS: usize = 10;

/// Rows where they do not vary.
const ROWS: usize = 20_000;

/// All points are measured in turns, so that a short load on the machine affects one round of all points, not all rounds
/// of one point.
const ROUNDS: usize = 10;

/// A point is run this long in a round, and at least twice.
const SLICE: Duration = Duration::from_millis(80);

/// Number of largest sizes that the exponent is fitted to; at smaller sizes, constant costs matter.
const LARGEST: usize = 3;

/// A cost at one size.
struct Point {
    size: usize,
    run: Box<dyn FnMut()>,
    /// Shortest time of a run so far.
    seconds: f64,
}

/// A cost at growing sizes.
struct Series {
    name: &'static str,
    points: Vec<Point>,
}

/// Costs that grow with one quantity, and what is constant.
struct Study {
    quantity: &'static str,
    constant: String,
    series: Vec<Series>,
}

/// What to draw.
#[derive(Debug, Args)]
pub struct Request {
    /// Draw the tables too
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.picture.as_deref().map_or(Ok(()), files::check_writable)?;
    let mut studies = [
        of_networks("rows", &[1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000], |rows| {
            (rows, STOPS, NEURONS)
        }),
        of_networks("stops", &[8, 16, 32, 64, 128], |stops| (ROWS, stops, NEURONS)),
        of_networks("tanh neurons", &[8, 16, 32, 64, 128], |neurons| (ROWS, STOPS, neurons)),
        of_ensembles(&[1, 2, 4, 8, 16, 32]),
    ];
    for _ in 0..ROUNDS {
        studies.iter_mut().flat_map(|study| &mut study.series).for_each(Series::measure);
    }
    let tables = studies.iter().map(Study::part).chain([Part::section("Summary", [summary(&studies)])]);
    print!("{}", markdown::page(&Page { title: "Growth of cost".into(), parts: tables.collect() }));
    match &request.picture {
        Some(file) => files::write(file, &drawing(&studies)),
        None => Ok(()),
    }
}

/// Evaluation, gradient and free run of a network with the rows, stops and tanh neurons of each size.
fn of_networks(
    quantity: &'static str,
    sizes: &[usize],
    of_size: impl Fn(usize) -> (usize, usize, usize),
) -> Study {
    let names = ["evaluation", "gradient", "free run"];
    let mut series = names.map(|name| Series { name, points: Vec::new() });
    for &size in sizes {
        let (rows, stops, neurons) = of_size(size);
        for (series, run) in series.iter_mut().zip(runs_of_network(rows, stops, neurons)) {
            series.points.push(Point { size, run, seconds: f64::INFINITY });
        }
    }
    let sizes = [("rows", ROWS), ("stops", STOPS), ("tanh neurons", NEURONS)];
    let constant = sizes.iter().filter(|(name, _)| *name != quantity);
    let constant: Vec<String> = constant.map(|(name, size)| format!("{size} {name}")).collect();
    Study { quantity, constant: constant.join(", "), series: series.into() }
}

fn runs_of_network(rows: usize, stops: usize, neurons: usize) -> [Box<dyn FnMut()>; 3] {
    let (data, architecture) = (data(rows), xpnn(stops, neurons, true));
    let scaling = Scaling::of(&data, None).unwrap();
    let objective = Rc::new(Objective::new(&data, &scaling, architecture, &options()).unwrap());
    let parameters = Rc::new(parameters(architecture, 2));
    let value = objective.value(&parameters);
    let evaluation = {
        let (objective, parameters) = (objective.clone(), parameters.clone());
        move || drop(black_box(objective.value(black_box(&parameters))))
    };
    let gradient = move || drop(black_box(objective.gradient(black_box(&parameters), &value)));
    let (x, mut y) = (path(rows), vec![0.0; rows]);
    let mut simulator = network(architecture).simulator();
    let free_run = move || {
        simulator.reset();
        simulator.run(&[black_box(&x)], &[], &mut y);
        black_box(y[rows - 1]);
    };
    [Box::new(evaluation), Box::new(gradient), Box::new(free_run)]
}

/// Free runs of ensembles, and of their members alone: the difference is the overhead of the ensemble, with its medians.
/// The members are networks from different random starts, each trained for two epochs only, because their cost does not
/// depend on their error.
fn of_ensembles(sizes: &[usize]) -> Study {
    let data = data(2000);
    let member = |seed: usize| {
        let options = FitOptions { starts: 1, epochs: 2, seed: seed as u64, ..options() };
        fit(&data, &options, &mut |_| ControlFlow::Continue(())).unwrap().model
    };
    let members: Rc<[Model]> = (1..=sizes.iter().copied().max().unwrap_or_default()).map(member).collect();
    let x: Rc<[f64]> = path(ROWS).into();
    let whole = |&size: &usize| {
        let (model, x) = (ensemble(&members[..size], &data), x.clone());
        let run = move || drop(black_box(model.run(black_box(&x)).unwrap()));
        Point { size, run: Box::new(run), seconds: f64::INFINITY }
    };
    let alone = |&size: &usize| {
        let (members, x) = (members.clone(), x.clone());
        let run = move || {
            for member in &members[..size] {
                black_box(member.run(black_box(&x)).unwrap());
            }
        };
        Point { size, run: Box::new(run), seconds: f64::INFINITY }
    };
    let series = vec![
        Series { name: "ensemble", points: sizes.iter().map(whole).collect() },
        Series { name: "its members", points: sizes.iter().map(alone).collect() },
    ];
    let constant = format!("{ROWS} rows, {STOPS} stops, {NEURONS} neurons");
    Study { quantity: "members", constant, series }
}

/// The median of these models, all with the same weight.
fn ensemble(members: &[Model], data: &Dataset) -> Model {
    let node = |member| Node { weights: Weights::equal(), kind: NodeKind::Member(member) };
    let group = Group { name: "all".into(), nodes: (0..members.len()).map(node).collect() };
    let ensemble = Ensemble::new(members.to_vec(), group, data.input_range(0)).unwrap();
    let found = ProvenanceDraft {
        options: FitSpec::Auto(AutoOptions::default()),
        chosen_start: 0,
        termination: Termination::Converged,
        validation: None,
        penalties: None,
        runs: Vec::new(),
        selection: None,
    };
    Model::new(Predictor::Ensemble(ensemble), InputTransform::default(), None, data, found).unwrap()
}

impl Series {
    fn measure(&mut self) {
        for Point { run, seconds, .. } in &mut self.points {
            let (began, mut runs) = (Instant::now(), 0);
            while runs < 2 || began.elapsed() < SLICE {
                let began = Instant::now();
                run();
                *seconds = seconds.min(began.elapsed().as_secs_f64());
                runs += 1;
            }
        }
    }

    /// Sizes with their times in milliseconds.
    fn measured(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> {
        self.points.iter().map(|point| (point.size as f64, 1e3 * point.seconds))
    }

    /// The exponent `b` of `time = a size^b` for the largest sizes, by least squares of the logarithms.
    fn exponent(&self) -> f64 {
        let points: Vec<(f64, f64)> =
            self.measured().rev().take(LARGEST).map(|(size, time)| (ln(size), ln(time))).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let covariance: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
        covariance / points.iter().map(|point| square(point.0 - x)).sum::<f64>()
    }

    /// With two decimals: a cell with a number would omit zeros at its end.
    fn exponent_cell(&self) -> Cell {
        Cell::Text(format!("{:.2}", self.exponent()))
    }

    /// The line of slope 1 through the largest size: smaller sizes lie above it if part of the cost is constant, and below
    /// it if the cost grows faster than linearly.
    fn line(&self) -> Vec<(f64, f64)> {
        let Some((largest, longest)) = self.measured().last() else { return Vec::new() };
        self.measured().map(|(size, _)| (size, longest * size / largest)).collect()
    }
}

impl Study {
    /// Every time, in milliseconds, and the exponents.
    fn part(&self) -> Part {
        let names = self.series.iter().map(|series| format!("{} (ms)", series.name));
        let mut table = Table::new([self.quantity.to_owned()].into_iter().chain(names));
        let times = |row: usize| self.series.iter().map(move |series| 1e3 * series.points[row].seconds);
        for (row, point) in self.series[0].points.iter().enumerate() {
            table.push([point.size.into()].into_iter().chain(times(row).map(Cell::from)));
        }
        let exponents = self.series.iter().map(Series::exponent_cell);
        table.push([Cell::from("exponent")].into_iter().chain(exponents));
        Part::section(format!("{} ({})", self.quantity, self.constant), [Part::Table(table)])
    }

    fn chart(&self) -> Chart {
        let colour = |index| Colour::Series(index);
        let lines = self.series.iter().map(|series| Curve::new(series.line(), Colour::Faint, 1.5));
        let dots = self.series.iter().enumerate();
        let dots = dots.map(|(index, series)| Curve::dots(series.measured(), colour(index), 3.5));
        let curves: Vec<Curve> = lines.chain(dots).collect();
        let points = || curves.iter().flat_map(|curve| &curve.points);
        let x = Axis::logarithmic(
            format!("{} ({})", self.quantity, self.constant),
            points().map(|point| point.0),
        );
        let y = Axis::logarithmic("time (ms)", points().map(|point| point.1));
        let description = format!("Time against the number of {}", self.quantity);
        let names = self.series.iter().enumerate().map(|(index, series)| (colour(index), series.name));
        let legend: Vec<_> = names.chain([(Colour::Faint, "linear")]).collect();
        Chart::on_axes(description, x, y, curves).sized(430.0, 320.0).with_legend(legend)
    }
}

/// Each cost at its smallest and largest size.
fn summary(studies: &[Study]) -> Part {
    let mut table = Table::new(["cost", "grows with", "smallest", "largest", "exponent"]);
    for Study { quantity, series, .. } in studies {
        for series in series {
            let at = |point: Option<&Point>| {
                let time = point.map(|point| Cell::from(1e3 * point.seconds).shown()).unwrap_or_default();
                Cell::Text(format!("{}: {time} ms", point.map_or(0, |point| point.size)))
            };
            let (smallest, largest) = (at(series.points.first()), at(series.points.last()));
            table.push([series.name.into(), (*quantity).into(), smallest, largest, series.exponent_cell()]);
        }
    }
    Part::Table(table)
}

fn drawing(studies: &[Study]) -> String {
    let charts: Vec<Chart> = studies.iter().map(Study::chart).collect();
    let description =
        "Time against rows, stops, tanh neurons and members of an ensemble, with lines of linear growth";
    chart::sheet(&charts, 2, &Appearance::of_page(), description, "lab/src/growth.rs")
}
