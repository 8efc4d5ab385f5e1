//! The relay, and the two laws of memory: wiping-out and congruency.

use hysid_core::elementary::tanh;
use hysid_core::operator::{Operator, Relay};
use hysid_document::chart::{Chart, Colour};

use super::{chart, history, label, line, loops, path, rows, sum_of_stops};

pub fn relay() -> Chart {
    let x = path(&[2.2, -1.4, 2.2]);
    let y = Relay::new(1.0, 0.4).unwrap().run(&x);
    let chart =
        chart("relay, r = 1, s = 0.4", "input x", "relay R", vec![line(&loops(&x, &y), Colour::Simulated)]);
    let labels = vec![label((1.4, -0.5), 0.0, "up at s + r"), label((-0.6, 0.5), 0.0, "down at s - r")];
    Chart { labels, ..chart }
}

/// A swing up and down, an inner loop, and the way back beyond the first turning point.
pub fn wiping_out() -> Vec<Chart> {
    let turning = [1.6, -1.0, 0.6, -0.2, 2.0];
    let names = ["A", "B", "C", "D", "E"];
    let x = path(&turning);
    let y = sum_of_stops(&x);
    let rows = rows(&turning);
    // The inner loop ends where the input is at C again.
    let closed = rows[3] + rows[3] - rows[2];
    let parts =
        [(0..rows[2], Colour::Simulated), (rows[2]..closed, Colour::Error), (closed..rows[4], Colour::Input)];
    let curves = |points: &[(f64, f64)]| {
        let part =
            |(rows, colour): &(std::ops::Range<usize>, Colour)| line(&points[rows.start..=rows.end], *colour);
        parts.iter().map(part).collect()
    };
    let (over_rows, over_input) = (history(&x), loops(&x, &y));
    let names_at = |points: &[(f64, f64)], below: &[&str]| {
        let named = rows.iter().zip(names);
        let rise = |name| if below.contains(&name) { -9.0 } else { 9.0 };
        named.map(|(row, name)| label(points[*row], rise(name), name)).collect()
    };
    let input = Chart {
        labels: names_at(&over_rows, &["B", "D"]),
        ..chart("input", "row k", "input x", curves(&over_rows))
    };
    let output = Chart {
        labels: names_at(&over_input, &["B", "C", "D"]),
        ..chart("output", "input x", "output y", curves(&over_input))
    };
    let legend = [(Colour::Simulated, "before"), (Colour::Error, "inner loop"), (Colour::Input, "after")];
    vec![input, output.with_legend(legend)]
}

/// The same inner loops on the way up and on the way down, without and with a mixing nonlinear function.
pub fn congruency() -> Vec<Chart> {
    let turning = [-1.6, 0.6, -0.6, 0.6, 1.6, -0.6, 0.6, -0.6, -1.6];
    let x = path(&turning);
    let rows = rows(&turning);
    let sum = sum_of_stops(&x);
    let mixed: Vec<f64> = sum.iter().map(|y| tanh(1.6 * y + 0.6)).collect();
    let drawn = |title: &str, y: &[f64]| {
        let points = loops(&x, y);
        let curves = vec![
            line(&points[rows[0]..], Colour::Faint),
            line(&points[rows[1]..=rows[3]], Colour::Simulated),
            line(&points[rows[5]..=rows[7]], Colour::Error),
        ];
        chart(title, "input x", "output y", curves)
    };
    let legend = [(Colour::Simulated, "after -1.6"), (Colour::Error, "after 1.6")];
    vec![
        drawn("sum of stops", &sum).with_legend(legend),
        drawn("tanh of the sum", &mixed).with_legend(legend),
    ]
}
