//! Residual of the output after a law without inertia: powers of the input, its rate, and stops.

use hysid_core::data::record::Dataset;
use hysid_core::operator::{Operator, Stop};

use super::excerpt::{Excerpt, Excerpts};
use super::linear_oscillator::OscillatorStep;
use super::normal_equations::NormalEquations;

/// Columns of two free motions, which belong to one excerpt alone.
const FREE: usize = 2;

const STOPS: usize = 10;

/// All of them: with a constant, three powers and the rate, and the output.
const COLUMNS: usize = FREE + 5 + STOPS + 1;

/// Sum of squares that the law leaves of the scaled output. Each excerpt may begin with a free motion at a frequency and a
/// damping ratio, as that of an oscillator may: what swings by itself is no response to the input.
pub(super) fn remainder(data: &Dataset, excerpts: &Excerpts, frequency: f64, damping_ratio: f64) -> f64 {
    let mut sum = NormalEquations::<COLUMNS>::empty();
    let mut free = [Vec::new(), Vec::new()];
    for part in &excerpts.parts {
        let step = OscillatorStep::new(frequency, damping_ratio, part.step);
        step.decay([1.0, 0.0], part.rows.len(), &mut free[0]);
        step.decay([0.0, 1.0], part.rows.len(), &mut free[1]);
        free.iter_mut().for_each(|column| excerpts.compare(part, column));
        let mut columns: Vec<&[f64]> = free.iter().map(Vec::as_slice).collect();
        let law = law(data, excerpts, part);
        columns.extend(law.iter().map(Vec::as_slice));
        columns.push(&part.output_column);
        let columns: [&[f64]; COLUMNS] = std::array::from_fn(|k| columns[k]);
        let mut equations = NormalEquations::of(columns);
        equations.eliminate(0..FREE);
        sum.add(&equations);
    }
    sum.eliminate(FREE..COLUMNS - 1);
    sum.remainder()
}

/// The columns of the law in the rows of an excerpt.
fn law(data: &Dataset, excerpts: &Excerpts, part: &Excerpt) -> Vec<Vec<f64>> {
    let x = &part.input;
    // Rates of all excerpts in one unit, near 1.
    let unit = excerpts.parts[0].step / part.step;
    let rate = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(x.len() - 1));
        unit * (x[after] - x[before]) / (after - before) as f64
    };
    let mut columns = vec![
        vec![1.0; x.len()],
        x.clone(),
        x.iter().map(|x| x * x).collect(),
        x.iter().map(|x| x * x * x).collect(),
        (0..x.len()).map(rate).collect(),
    ];
    let past = &data.records()[part.record].inputs()[0][..part.rows.end];
    for stop in 1..=STOPS {
        let mut stop = Stop::new(stop as f64 / (STOPS + 1) as f64).expect("the threshold is positive");
        let run = past.iter().map(|&x| stop.step(excerpts.input.apply(x)));
        columns.push(run.skip(part.rows.start).collect());
    }
    columns.iter_mut().for_each(|column| excerpts.compare(part, column));
    columns
}
