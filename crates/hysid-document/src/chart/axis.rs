//! Axes of charts: range, ticks at round numbers, and their texts.

use std::ops::Range;

use hysid_core::elementary::{log10, powf, powi};
use hysid_core::significant::Significant;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::Ranged;

/// Share of the range left free at each end.
const MARGIN: f64 = 0.04;

/// Most powers of ten that a logarithmic axis spans: what lies lower is drawn at its end.
const MOST_DECADES: f64 = 9.0;

/// Values further beyond the ends of an axis, in its lengths, have the place of this one.
const MOST_BEYOND: f64 = 100.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Label: the quantity with its unit.
    pub label: String,
    logarithmic: bool,
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    step: f64,
}

impl Axis {
    /// A linear axis over all finite values.
    pub fn linear(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = range(values);
        let spread = match high - low {
            spread if spread > 1e-12 * low.abs().max(high.abs()) => MARGIN * spread,
            _ if low == 0.0 => 1.0,
            _ => 0.1 * low.abs(),
        };
        Self::new(label.into(), false, low - spread, high + spread)
    }

    /// A logarithmic axis over all positive values.
    pub fn logarithmic(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = range(values.filter(|&v| v > 0.0).map(log10));
        let low = low.max(high - MOST_DECADES);
        let spread = (MARGIN * (high - low)).max(0.1);
        Self::new(label.into(), true, low - spread, high + spread)
    }

    fn new(label: String, logarithmic: bool, low: f64, high: f64) -> Self {
        Self { label, logarithmic, low, high, ticks: Vec::new(), step: 0.0 }
    }

    /// Difference of its ends.
    pub(super) fn span(&self) -> f64 {
        self.high - self.low
    }

    /// The axis with this difference of its ends and the same middle.
    pub(super) fn with_span(&self, span: f64) -> Self {
        let middle = 0.5 * (self.low + self.high);
        Self::new(self.label.clone(), self.logarithmic, middle - 0.5 * span, middle + 0.5 * span)
    }

    /// The axis with about this many ticks, at least two.
    pub(super) fn with_ticks(mut self, count: usize) -> Self {
        let wanted = (self.high - self.low) / count.max(2) as f64;
        if self.logarithmic {
            self.ticks = self.decades(count);
        } else {
            self.tick_every(round_step(wanted));
            // A single tick does not tell the scale.
            if self.ticks.len() < 2 {
                self.tick_every(round_step(0.5 * wanted));
            }
        }
        self
    }

    fn tick_every(&mut self, step: f64) {
        let (first, last) = ((self.low / step).ceil(), (self.high / step).floor());
        let count = (last - first).clamp(0.0, 50.0) as usize;
        self.ticks = (0..=count).map(|k| (first + k as f64) * step).collect();
        self.step = step;
    }

    /// Ticks of a logarithmic axis: powers of ten, with 2 and 5 between them if there is room.
    fn decades(&self, count: usize) -> Vec<f64> {
        let every = ((self.high - self.low) / count.max(2) as f64).ceil().max(1.0) as i32;
        let between: &[f64] = if self.high - self.low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        (self.low.floor() as i32..=self.high.ceil() as i32)
            .filter(|exponent| exponent % every == 0)
            .flat_map(|exponent| between.iter().map(move |factor| factor * powi(10.0, exponent)))
            .filter(|tick| (self.low..=self.high).contains(&log10(*tick)))
            .collect()
    }

    pub(super) fn text(&self, tick: f64) -> String {
        let largest = self.low.abs().max(self.high.abs());
        let text = if self.logarithmic {
            format!("{:.1}", Significant(tick))
        } else if (1e-4..1e5).contains(&self.step) && largest < 1e12 {
            let decimals = (-log10(self.step)).ceil().max(0.0) as usize;
            format!("{tick:.decimals$}")
        } else {
            let digits = (log10(largest).floor() - log10(self.step).floor()).clamp(0.0, 14.0) as usize + 1;
            format!("{:.*}", digits, Significant(if tick.abs() < 0.5 * self.step { 0.0 } else { tick }))
        };
        text.replace('-', "−")
    }

    /// Letters of the longest tick.
    pub(super) fn longest_text(&self) -> usize {
        self.ticks.iter().map(|&tick| self.text(tick).chars().count()).max().unwrap_or(0)
    }

    /// Place of a value along the axis: 0 at its beginning, 1 at its end, and not much beyond either.
    pub fn place(&self, value: f64) -> f64 {
        let value = if self.logarithmic { log10(value.max(f64::MIN_POSITIVE)) } else { value };
        ((value - self.low) / (self.high - self.low)).clamp(-MOST_BEYOND, 1.0 + MOST_BEYOND)
    }

    fn position(&self, value: f64) -> f64 {
        self.place(value).clamp(0.0, 1.0)
    }

    /// Beginning and end, as powers of ten if it is logarithmic, and whether it is.
    pub(super) fn limits(&self) -> (f64, f64, bool) {
        (self.low, self.high, self.logarithmic)
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        limit.0 + (self.position(*value) * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        if self.logarithmic { powf(10.0, self.low)..powf(10.0, self.high) } else { self.low..self.high }
    }
}

/// Smallest and largest finite value; 0 to 0 if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// The nearest of 1, 2 and 5 times a power of ten.
fn round_step(wanted: f64) -> f64 {
    let power = powf(10.0, log10(wanted).floor());
    // The limits are the geometric means of neighbours.
    match wanted / power {
        ratio if ratio < 1.414 => power,
        ratio if ratio < 3.162 => 2.0 * power,
        ratio if ratio < 7.071 => 5.0 * power,
        _ => 10.0 * power,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: Axis, count: usize) -> Vec<String> {
        let axis = axis.with_ticks(count);
        axis.ticks.iter().map(|&tick| axis.text(tick)).collect()
    }

    #[test]
    fn ticks_are_round_and_tell_apart() {
        assert_eq!(
            texts(Axis::linear("", [-1.0, 1.0].into_iter()), 5),
            ["−1.0", "−0.5", "0.0", "0.5", "1.0"]
        );
        assert_eq!(texts(Axis::linear("", [0.0, 3e7].into_iter()), 4), ["0", "1e7", "2e7", "3e7"]);
        // Steps of 2 would leave 0 alone.
        assert_eq!(texts(Axis::linear("", [-1.7, 1.7].into_iter()), 2), ["−1", "0", "1"]);
        let narrow = texts(Axis::linear("", [1e6, 1e6 + 1.0].into_iter()), 4);
        assert!(narrow.windows(2).all(|pair| pair[0] != pair[1]), "{narrow:?}");
        assert_eq!(
            texts(Axis::logarithmic("", [0.1, 1000.0].into_iter()), 5),
            ["0.1", "1", "10", "100", "1000"]
        );
    }

    #[test]
    fn every_range_has_an_axis() {
        let cases = [vec![], vec![f64::NAN], vec![0.0], vec![-5.0, -5.0], vec![1e150, -1e150], vec![1e-300]];
        for values in cases {
            for axis in
                [Axis::linear("", values.iter().copied()), Axis::logarithmic("", values.iter().copied())]
            {
                assert!(axis.low < axis.high && axis.high.is_finite(), "{values:?}: {axis:?}");
                assert!(axis.clone().with_ticks(5).ticks.len() < 60);
                let place = axis.map(&f64::MAX, (0, 100));
                assert!((0..=100).contains(&place));
            }
        }
    }
}
