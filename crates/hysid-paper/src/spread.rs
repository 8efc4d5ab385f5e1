//! A figure over several seeds: its median and its range.

use hysid_document::number;

/// Median and range of a figure over several seeds. A model that diverged has an infinite value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Lowest value.
    pub low: f64,
    pub median: f64,
    /// Highest value.
    pub high: f64,
}

const DIGITS: usize = 3;

impl Spread {
    /// Of these values; `None` if there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        let median = median(&mut sorted)?;
        Some(Self { low: sorted[0], median, high: sorted[sorted.len() - 1] })
    }

    /// `1.04 (0.98 to 1.2)`, or the one value that all have.
    pub fn shown(self) -> String {
        if self.low == self.high {
            shown(self.median)
        } else {
            format!("{} ({})", shown(self.median), self.range())
        }
    }

    /// `0.98 to 1.2`, or the one value that all have.
    pub fn range(self) -> String {
        if self.low == self.high {
            shown(self.low)
        } else {
            format!("{} to {}", shown(self.low), shown(self.high))
        }
    }
}

fn shown(value: f64) -> String {
    if value.is_finite() { number(value, DIGITS) } else { "diverged".into() }
}

/// The median of these values, which are sorted; `None` if there are none.
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        1 => Some(values[middle]),
        _ if values.is_empty() => None,
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_shown_with_its_range() {
        assert_eq!(Spread::of([3.0, 1.0, 2.0]).unwrap().shown(), "2 (1 to 3)");
        assert_eq!(Spread::of([2.0, 2.0]).unwrap().shown(), "2");
        assert_eq!(Spread::of([4.0, 1.0, 3.0, 2.0]).unwrap().median, 2.5);
        assert!(Spread::of([]).is_none());
    }

    #[test]
    fn a_model_that_diverged_has_no_number() {
        assert_eq!(Spread::of([5.0, f64::INFINITY, 7.0]).unwrap().shown(), "7 (5 to diverged)");
        assert_eq!(Spread::of([f64::INFINITY; 3]).unwrap().shown(), "diverged");
    }
}
