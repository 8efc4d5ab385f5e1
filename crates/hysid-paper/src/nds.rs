//! The six demonstrations of one neuron: what its two weights and its capacity do to its loop.

use std::f64::consts::TAU;

use hysid::operator::{DeterioratingStop, Operator};
use hysid_core::elementary::{cos, sin};
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, number};

use crate::chapter::{Chapter, ChapterTarget, TargetSource, TargetVerdict};

/// A neuron: the stop of `weight x + rate_weight x'` with threshold 1, which deteriorates.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Neuron {
    /// `w_x`.
    weight: f64,
    /// `w_x'`, in seconds.
    rate_weight: f64,
    /// `β`.
    capacity: f64,
}

/// A capacity that no demonstration uses up.
const ENDLESS: f64 = 1e7;

/// The paper's six, and what each shows.
const DEMONSTRATIONS: [(Neuron, &str); 6] = [
    (neuron(1.42, 0.0, ENDLESS), "a static loop, the same at every rate"),
    (
        neuron(1.42, -1.1, ENDLESS),
        "a negative weight of the rate narrows the loop and then reverses its \
                                   orientation",
    ),
    (neuron(1.42, 0.0, 25.0), "the static loop shrinks as the stop slides, in cycles and not in time"),
    (neuron(1.42, 2.0, 25.0), "wider at speed, with a shorter life: a faster cycle slides further"),
    (neuron(1.0, 0.0, ENDLESS), "the stop never slides: no loop at all"),
    (neuron(1.0, 2.0, ENDLESS), "no loop when slow, a loop at speed: K is zero and P is not"),
];

/// The third with the capacity that the paper's text has in the place of that in its list.
const VARIANT: (Neuron, &str) = (neuron(1.42, 0.0, 50.0), "the third with β of 50, twice the life");

/// Rates of the input in Hz: a sine of amplitude 1. Designed; the paper's figure does not give them.
const RATES: [f64; 3] = [0.1, 0.2, 0.5];

/// Cycles at each rate.
const CYCLES: usize = 3;

const ROWS: usize = 2000;

/// Most cycles that a neuron is followed to its end.
const MOST_CYCLES: usize = 100;

const fn neuron(weight: f64, rate_weight: f64, capacity: f64) -> Neuron {
    Neuron { weight, rate_weight, capacity }
}

impl Neuron {
    fn stop(self) -> DeterioratingStop {
        DeterioratingStop::new(1.0, self.capacity).expect("capacities are above 0")
    }

    /// Input of the stop for a sine of amplitude 1 at a phase in rad; at rate 0 the rate is 0.
    fn drive(self, rate: f64, phase: f64) -> f64 {
        self.weight * sin(phase) + self.rate_weight * TAU * rate * cos(phase)
    }

    /// Input and output from the virgin state, over a number of cycles of a sine.
    fn run(self, rate: f64, cycles: usize) -> Vec<(f64, f64)> {
        let mut stop = self.stop();
        let row = |row: usize| {
            let phase = TAU * row as f64 / ROWS as f64;
            (sin(phase), stop.step(self.drive(rate, phase)))
        };
        (0..=cycles * ROWS).map(row).collect()
    }

    /// Width of the first full cycle after a quarter, half-way between lowest and highest output; `None` if not passed.
    fn width(self, rate: f64) -> Option<f64> {
        let path = self.run(rate, 2);
        let cycle = &path[ROWS / 4..=5 * ROWS / 4];
        let (low, high) =
            cycle.iter().fold((f64::MAX, f64::MIN), |(low, high), (_, y)| (low.min(*y), high.max(*y)));
        let middle = 0.5 * (low + high);
        let crossing = |rises: bool| {
            cycle.windows(2).find_map(|pair| {
                let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
                let passes = if rises { y0 < middle && y1 >= middle } else { y0 > middle && y1 <= middle };
                passes.then(|| x0 + (x1 - x0) * (middle - y0) / (y1 - y0))
            })
        };
        Some(crossing(false)? - crossing(true)?)
    }

    /// Cycles until it is dead; `None` if it lives on.
    fn life(self, rate: f64) -> Option<f64> {
        let mut stop = self.stop();
        let dead = |row: &usize| {
            stop.step(self.drive(rate, TAU * *row as f64 / ROWS as f64));
            stop.is_dead()
        };
        (0..MOST_CYCLES * ROWS).find(dead).map(|row| row as f64 / ROWS as f64)
    }

    fn name(self) -> String {
        let capacity = if self.capacity == ENDLESS { "10⁷".into() } else { number(self.capacity, 2) };
        format!("w ({}, {}), β {capacity}", number(self.weight, 3), number(self.rate_weight, 2))
    }
}

/// The whole experiment; nothing in it is random.
pub fn chapter() -> Chapter {
    Chapter {
        name: "nds".into(),
        title: "One neuron, six demonstrations".into(),
        verdict: "One neuron makes static, rate-dependent and deteriorating loops by three numbers alone: a \
                  static loop needs |w_x| above 1 at unit input, rate dependence needs w_x' other than 0, \
                  and with a finite β every slide deteriorates the loop."
            .into(),
        parts: vec![
            Part::Table(table()),
            Part::note(format!(
                "The neuron is the stop of w_x x + w_x' x' with threshold 1 and capacity β. K is the width \
                 of the loop at rate 0, half-way up; P is the width at a rate minus K: both are measured on \
                 the first full cycle of a simulation from the virgin state under sin 2πft. The paper names \
                 K and P without defining them; these definitions are ours. Rates are designed. The paper \
                 lists β 25 for the third demonstration and discusses it as 50; the last row has that. The \
                 output of a dead neuron is 0, so it has no width (–); life is in cycles at {} Hz.",
                RATES[0]
            )),
            Part::heading("The input, and the six loops"),
            Part::chart(input_chart()),
            Part::Charts(
                DEMONSTRATIONS.iter().enumerate().map(|(index, (neuron, _))| loops(index, *neuron)).collect(),
            ),
            Part::note(
                "In the figures the three rates follow each other without a reset, so deterioration \
                        continues from one to the next.",
            ),
        ],
        targets: vec![target()],
        files: Vec::new(),
    }
}

/// By the paper: has each demonstration a static loop (K is not 0), a rate-dependent part (P is not 0), an end?
const CLAIMED: [(bool, bool, bool); 6] = [
    (true, false, false),
    (true, true, false),
    (true, false, true),
    (true, true, true),
    (false, false, false),
    (false, true, false),
];

/// The demonstrations that have the K, the P and the end that the paper claims.
fn target() -> ChapterTarget {
    let holds = |((neuron, _), claimed): &((Neuron, &str), (bool, bool, bool))| {
        let (zero, slow) = (neuron.width(0.0), neuron.width(RATES[0]));
        let is_wide = zero.is_some_and(|zero| zero.abs() > 1e-9);
        let has_rate = zero.zip(slow).is_some_and(|(zero, slow)| (slow - zero).abs() > 1e-9);
        (is_wide, has_rate, neuron.life(RATES[0]).is_some()) == *claimed
    };
    let holding = DEMONSTRATIONS.into_iter().zip(CLAIMED).filter(holds).count();
    let all = DEMONSTRATIONS.len();
    ChapterTarget {
        specimen: "one neuron".into(),
        figure: "demonstrations with the K, P and end of life claimed".into(),
        source: TargetSource::Paper,
        wanted: format!("{all} of {all}"),
        one: format!("{holding} of {all}"),
        several: None,
        verdict: if holding == all { TargetVerdict::Met } else { TargetVerdict::Missed },
    }
}

fn table() -> Table {
    let rates = RATES.map(|rate| format!("P at {rate} Hz"));
    let columns = ["neuron".to_string(), "K".into()].into_iter().chain(rates);
    let row = |(name, (neuron, shows)): (String, (Neuron, &str))| {
        let zero = neuron.width(0.0);
        let more = |rate: f64| neuron.width(rate).zip(zero).map(|(width, zero)| tidy(width - zero));
        let mut cells = vec![format!("{name}: {}", neuron.name()).into(), zero.map(tidy).into()];
        cells.extend(RATES.map(|rate| more(rate).into()));
        cells.push(neuron.life(RATES[0]).map_or("unlimited".into(), Cell::from));
        cells.push(shows.into());
        cells
    };
    let numbered = DEMONSTRATIONS.into_iter().enumerate().map(|(index, it)| ((index + 1).to_string(), it));
    Table::new(columns.chain(["life, cycles".to_string(), "shows".into()]))
        .headed("K and P of one neuron, simulated: no specimen is needed, neither measured nor synthetic")
        .with_rows(numbered.chain([("3, β 50".to_string(), VARIANT)]).map(row))
}

/// Replaces a width that is a rounding error by 0.
fn tidy(width: f64) -> f64 {
    if width.abs() < 1e-9 { 0.0 } else { width }
}

/// Time, input and output of the three rates in turn, with the number of the rate.
fn in_turn(neuron: Neuron) -> Vec<(f64, f64, f64, usize)> {
    let mut stop = neuron.stop();
    let mut path = Vec::new();
    let mut begun = 0.0;
    for (index, rate) in RATES.into_iter().enumerate() {
        for row in 0..=CYCLES * ROWS {
            let cycles = row as f64 / ROWS as f64;
            let y = stop.step(neuron.drive(rate, TAU * cycles));
            path.push((begun + cycles / rate, sin(TAU * cycles), y, index));
        }
        begun += CYCLES as f64 / rate;
    }
    path
}

fn input_chart() -> Chart {
    let path = in_turn(DEMONSTRATIONS[0].0);
    let curve = |index: usize| {
        let rows = path.iter().filter(|row| row.3 == index);
        Curve::new(rows.map(|row| (row.0, row.1)).step_by(20).collect(), Colour::Series(index), 1.4)
    };
    let curves = (0..RATES.len()).map(curve).collect();
    Chart::new("The input over time: three sines of growing rate", "time (s)", "input x", curves)
        .with_height(220.0)
        .with_legend(
            RATES.iter().enumerate().map(|(index, rate)| (Colour::Series(index), format!("{rate} Hz"))),
        )
}

fn loops(index: usize, neuron: Neuron) -> Chart {
    let path = in_turn(neuron);
    let curve = |rate: usize| {
        let rows = path.iter().filter(|row| row.3 == rate);
        Curve::new(rows.step_by(8).map(|row| (row.1, row.2)).collect(), Colour::Series(rate), 1.2)
    };
    let title = format!("{}: {}", index + 1, neuron.name());
    let range = || [-1.0, 1.0].into_iter();
    let curves = (0..RATES.len()).map(curve).collect();
    let (x, y) = (Axis::linear("input x", range()), Axis::linear("output", range()));
    Chart::on_axes(format!("Loops of neuron {title} at three rates"), x, y, curves).small(title)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{acos, asin, atan2, hypot};

    use super::*;

    /// Half-way up is output 0, at which the stop's argument `V sin θ` is `1 - V` on the way up if it slides
    /// and 0 if it does not; the input lags behind by the phase of the two weights.
    fn width(neuron: Neuron, rate: f64) -> f64 {
        let across = neuron.rate_weight * TAU * rate;
        let amplitude = hypot(neuron.weight, across);
        let lead = atan2(across, neuron.weight);
        let theta = if amplitude > 1.0 { asin((1.0 - amplitude) / amplitude) } else { 0.0 };
        -2.0 * sin(theta - lead)
    }

    #[test]
    fn widths_are_those_of_the_closed_form() {
        for (neuron, _) in DEMONSTRATIONS.into_iter().filter(|(neuron, _)| neuron.capacity == ENDLESS) {
            for rate in [0.0].into_iter().chain(RATES) {
                let (found, expected) = (neuron.width(rate).unwrap(), width(neuron, rate));
                assert!((found - expected).abs() < 1e-5, "{} at {rate}: {found}, {expected}", neuron.name());
            }
        }
        // K of the first: twice what the amplitude has more than the threshold.
        let k = DEMONSTRATIONS[0].0.width(0.0).unwrap();
        assert!((k - 2.0 * (1.0 - 1.0 / 1.42)).abs() < 1e-5, "{k}");
    }

    /// The first quarter of a cycle slides V - 1, every half cycle 2 (V - 1), once 2 off its peak.
    #[test]
    fn lives_are_those_of_the_closed_form() {
        for (neuron, capacity) in [(DEMONSTRATIONS[2].0, 25.0), (VARIANT.0, 50.0)] {
            let amplitude: f64 = 1.42;
            let excess = amplitude - 1.0;
            let halves = ((capacity - excess) / (2.0 * excess)).floor();
            let last = capacity - excess - halves * 2.0 * excess;
            let cycles = 0.25 + 0.5 * halves + acos((amplitude - 2.0 - last) / amplitude) / TAU;
            let life = neuron.life(0.1).unwrap();
            assert!((life - cycles).abs() < 2.0 / ROWS as f64, "{life}, {cycles}");
        }
        assert_eq!(DEMONSTRATIONS[0].0.life(0.1), None);
    }

    #[test]
    fn all_demonstrations_are_as_the_paper_claims() {
        assert_eq!((target().one.as_str(), target().verdict), ("6 of 6", TargetVerdict::Met));
    }

    #[test]
    fn demonstrations_show_what_is_said_of_them() {
        let k = |index: usize| DEMONSTRATIONS[index].0.width(0.0).unwrap();
        let p = |index: usize, rate: f64| DEMONSTRATIONS[index].0.width(rate).unwrap() - k(index);
        assert!(p(0, 0.5).abs() < 1e-9);
        assert!(p(1, 0.1) < 0.0 && k(1) + p(1, 0.5) < 0.0);
        assert!(k(4).abs() < 1e-9 && k(5).abs() < 1e-9);
        assert!(RATES.iter().all(|&rate| p(5, rate) > 1.0));
    }
}
