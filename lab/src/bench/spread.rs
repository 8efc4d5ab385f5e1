//! A measured speed and its spread over several runs.

use anyhow::Result;

/// Median, lowest and highest value of several runs.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(super) struct Spread {
    /// The median; of an even number of runs, the higher of the two in the middle.
    pub value: f64,
    pub lowest: f64,
    pub highest: f64,
    pub runs: usize,
}

impl Spread {
    /// The spread of these values, of which there is one at least.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let runs = values.len();
        Self { value: values[runs / 2], lowest: values[0], highest: values[runs - 1], runs }
    }

    /// The spread of what so many runs measure.
    ///
    /// # Errors
    /// That of a run.
    pub fn over(runs: usize, mut run: impl FnMut() -> Result<f64>) -> Result<Self> {
        Ok(Self::of((0..runs).map(|_| run()).collect::<Result<_>>()?))
    }

    /// The same in another unit: all values times a factor above 0.
    pub fn times(self, factor: f64) -> Self {
        let Self { value, lowest, highest, runs } = self;
        Self { value: factor * value, lowest: factor * lowest, highest: factor * highest, runs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_ends_are_those_of_the_sorted_values() {
        let spread = Spread::of(vec![3.0, 1.0, 9.0, 2.0, 8.0]);
        assert_eq!(spread, Spread { value: 3.0, lowest: 1.0, highest: 9.0, runs: 5 });
        assert_eq!(spread.times(1e3), Spread { value: 3e3, lowest: 1e3, highest: 9e3, runs: 5 });
        assert_eq!(Spread::of(vec![4.0]), Spread { value: 4.0, lowest: 4.0, highest: 4.0, runs: 1 });
    }

    #[test]
    fn each_run_is_counted_and_an_error_ends_them() {
        let mut runs = 0.0;
        let spread = Spread::over(3, || {
            runs += 1.0;
            Ok(runs)
        });
        assert_eq!(spread.unwrap(), Spread { value: 2.0, lowest: 1.0, highest: 3.0, runs: 3 });
        assert!(Spread::over(3, || anyhow::bail!("broken")).is_err());
    }
}
