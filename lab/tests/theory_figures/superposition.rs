//! Laws that are sums of operators: Masing's branches, plays, the Preisach plane.

use hysid_core::law::masing::{Masing, MasingParts};
use hysid_core::law::{Law, Sample};
use hysid_core::operator::{Operator, Play, Relay};
use hysid_document::chart::{Chart, Colour, Curve};

use super::{chart, corners, history, label, line, loops, path, rows};

/// A virgin curve with four bends, its loop, and all branches moved to one origin and halved.
pub fn masing() -> Vec<Chart> {
    let parts = MasingParts {
        constant: 0.0,
        thresholds: vec![0.2, 0.45, 0.8, 1.2],
        slopes: vec![2.0, 1.3, 0.7, 0.3, 0.1],
    };
    let law = Masing::new(parts).unwrap();
    let turning = [1.5, -1.5, 0.8, -0.4, 1.5];
    let x = path(&turning);
    let mut state = law.virgin();
    let y: Vec<f64> = x.iter().map(|&x| law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 })).collect();
    let points = loops(&x, &y);
    let rows = rows(&turning);
    let branches = [
        (rows[0]..rows[1], Colour::Simulated),
        (rows[1]..rows[2], Colour::Error),
        (rows[2]..rows[3], Colour::Input),
    ];
    let virgin = line(&points[..=rows[0]], Colour::Faint);
    let whole =
        |(rows, colour): &(std::ops::Range<usize>, Colour)| line(&points[rows.start..=rows.end], *colour);
    let halved = |(rows, colour): &(std::ops::Range<usize>, Colour)| {
        let (x0, y0) = points[rows.start];
        // Every branch at other places, so that no dot hides another.
        let first =
            rows.start + branches.iter().position(|branch| branch.1 == *colour).unwrap_or_default() * 6;
        let moved = points[first..=rows.end].iter().step_by(18);
        Curve::dots(moved.map(|(x, y)| ((x - x0).abs() / 2.0, (y - y0).abs() / 2.0)), *colour, 3.5)
    };
    let first = |curve: Curve, others: Vec<Curve>| [curve].into_iter().chain(others).collect();
    let legend = [
        (Colour::Faint, "virgin"),
        (Colour::Simulated, "down"),
        (Colour::Error, "up"),
        (Colour::Input, "minor"),
    ];
    let branches_over_input = first(virgin.clone(), branches.iter().map(whole).collect());
    let all_halved = first(virgin, branches.iter().map(halved).collect());
    vec![
        chart("branches", "input x", "output y", branches_over_input),
        chart("halved", "|x - x*|/2", "|y - y*|/2", all_halved).with_legend(legend),
    ]
}

/// Three plays with their weights, and the sum.
pub fn plays() -> Vec<Chart> {
    let x = path(&[2.0, -2.0, 0.8, -0.6, 2.0]);
    let weighted = [(0.2, 0.5), (0.7, 0.35), (1.3, 0.3)];
    let outputs = weighted
        .map(|(r, w)| -> Vec<f64> { Play::new(r).unwrap().run(&x).into_iter().map(|p| w * p).collect() });
    let sum: Vec<f64> = (0..x.len()).map(|k| outputs.iter().map(|output| output[k]).sum()).collect();
    let curves = outputs.iter().enumerate().map(|(k, y)| line(&loops(&x, y), Colour::Series(k))).collect();
    let legend = weighted.iter().enumerate().map(|(k, (r, _))| (Colour::Series(k), format!("r = {r}")));
    vec![
        chart("plays", "input x", "w p", curves).with_legend(legend),
        chart("sum", "input x", "output y", vec![line(&loops(&x, &sum), Colour::Simulated)]),
    ]
}

/// Relays of a Preisach plane after five turning points, and the staircase between those up and those down.
pub fn preisach_plane() -> Vec<Chart> {
    let turning = [0.8, -0.6, 0.5, -0.2, 0.2];
    let x = path(&turning);
    let cells = 20;
    let side = 2.0 / f64::from(cells);
    let mut areas = Vec::new();
    for i in 0..cells {
        for j in 0..=i {
            let (alpha, beta) = (-1.0 + side * f64::from(i), -1.0 + side * f64::from(j));
            let (up, down) = (alpha + 0.5 * side, beta + 0.5 * side);
            // On the edge of the plane a cell is half a square; a relay in it has a width above 0.
            let (up, down) = if i == j { (up + 0.1 * side, down - 0.1 * side) } else { (up, down) };
            let mut relay = Relay::new((up - down) / 2.0, (up + down) / 2.0).unwrap();
            let is_up = *relay.run(&x).last().unwrap() > 0.0;
            let mut outline = vec![(beta, alpha), (beta, alpha + side), (beta + side, alpha + side)];
            if i != j {
                outline.push((beta + side, alpha));
            }
            areas.push(Curve::new(outline, Colour::Level(if is_up { 3 } else { 0 }), 0.0));
        }
    }
    // From the virgin state's line up to the largest turning point, then from turning point to turning point.
    let mut staircase = vec![(-1.0, 1.0), (-turning[0], turning[0])];
    for pair in turning.windows(2) {
        let &(beta, alpha) = staircase.last().unwrap();
        staircase.push(if pair[1] < pair[0] { (pair[1], alpha) } else { (beta, pair[1]) });
    }
    staircase.push((turning[4], turning[4]));
    areas.push(Curve::new(staircase, Colour::Error, 2.5));
    let rows = rows(&turning);
    let over_rows = history(&x);
    let labels = rows.iter().zip(1..).map(|(row, number)| {
        label(over_rows[*row], if number % 2 == 1 { 9.0 } else { -9.0 }, &number.to_string())
    });
    let input = chart("input", "row k", "input x", vec![Curve::new(corners(&over_rows), Colour::Input, 2.0)]);
    let legend = [(Colour::Level(3), "up"), (Colour::Level(0), "down"), (Colour::Error, "staircase")];
    vec![
        Chart { labels: labels.collect(), ..input },
        chart("relays", "β: switches down", "α: switches up", areas).with_legend(legend),
    ]
}
