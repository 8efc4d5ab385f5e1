//! The records in the form in which modes and elements are fitted to them.
//!
//! Of a record that repeats its input, as a measurement with several periods of a multisine does, two periods are
//! enough: the first, and one that is the mean of the others. It counts as many times as it is the mean of.

use hysid_core::elementary::square;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::search::{measured, spread};
use crate::law::hysteretic_dynamics::DynamicsDrive;
use crate::law::series::Series;

/// Rows that a fit runs over at most: the beginnings of the records.
const MOST_ROWS: usize = 60_000;

/// Share of the rows in the early stages, and rows there at least.
const EARLY: f64 = 1.0 / 3.0;
const FEWEST_EARLY: usize = 1500;

/// Periods of a record that is averaged at least: the first, and two to compare.
const FEWEST_PERIODS: usize = 3;

/// Inputs that differ by less, relative to the largest, count as equal.
const EQUAL: f64 = 1e-9;

/// Time steps that differ from the median by less, relative to it, are taken as their mean: they differ because time stamps
/// are rounded. The factors of a step are computed anew whenever its length changes.
const EVEN: f64 = 1e-7;

/// The second period may differ from the mean of the later ones by this multiple of what they differ among each other.
const LARGEST_TRANSIENT: f64 = 1.3;

pub(super) struct Records {
    pub drives: Vec<DynamicsDrive>,
    pub input_scale: f64,
    /// Mean and standard deviation of the output, in its unit.
    pub output_mean: f64,
    pub output_scale: f64,
    /// Mean time between rows.
    pub step: f64,
}

impl Records {
    pub fn of(data: &Dataset) -> Result<Self> {
        let series = Series::all(data, None)?;
        let (output_mean, output_scale) = spread(&measured(&series));
        let inputs = || series.iter().flat_map(|series| series.samples.iter().map(|sample| sample.x.abs()));
        let largest = inputs().fold(0.0, f64::max);
        let rows: usize = series.iter().map(|series| series.samples.len()).sum();
        let share = (MOST_ROWS as f64 / rows as f64).min(1.0);
        let drives: Vec<DynamicsDrive> = series
            .iter()
            .map(|series| {
                let whole = scaled(series, output_scale);
                let averaged = averaged(&whole, EQUAL * largest).unwrap_or(whole);
                if share < 1.0 { begun(&averaged, share) } else { averaged }
            })
            .collect();
        let steps = drives.iter().flat_map(|drive| drive.steps.iter()).filter(|step| step.is_finite());
        let step = steps.clone().sum::<f64>() / steps.filter(|step| **step > 0.0).count().max(1) as f64;
        let input_scale = if largest > 0.0 { largest } else { 1.0 };
        Ok(Self { drives, input_scale, output_mean, output_scale, step })
    }

    /// Standard deviation of the scaled input.
    pub fn input_deviation(&self) -> f64 {
        let inputs = self.drives.iter().flat_map(|drive| drive.x.iter().map(|x| x / self.input_scale));
        spread(&inputs.collect::<Vec<f64>>()).1
    }

    /// The beginnings of the records.
    pub fn beginning(&self) -> Vec<DynamicsDrive> {
        let rows: usize = self.drives.iter().map(|drive| drive.x.len()).sum();
        self.first(EARLY.max(FEWEST_EARLY as f64 / rows as f64))
    }

    /// So many rows of each record.
    pub fn first_rows(&self, rows: usize) -> Vec<DynamicsDrive> {
        self.drives.iter().map(|drive| begun(drive, rows as f64 / drive.x.len() as f64)).collect()
    }

    /// A share of each record, from its beginning.
    pub fn first(&self, share: f64) -> Vec<DynamicsDrive> {
        let share = share.min(1.0);
        let all: Vec<DynamicsDrive> = self.drives.iter().map(|drive| begun(drive, share)).collect();
        let is_compared = |drive: &DynamicsDrive| drive.targets.iter().any(|target| !target.is_nan());
        if all.iter().any(is_compared) { all } else { self.drives.clone() }
    }
}

fn scaled(series: &Series, deviation: f64) -> DynamicsDrive {
    DynamicsDrive {
        x: series.samples.iter().map(|sample| sample.x).collect(),
        steps: evened(series.samples.iter().map(|sample| sample.step).collect()),
        targets: series.output.iter().map(|y| y / deviation).collect(),
        weights: vec![1.0; series.output.len()],
    }
}

/// Time steps without the differences that rounding makes.
fn evened(mut steps: Vec<f64>) -> Vec<f64> {
    let mut moving: Vec<f64> = steps.iter().copied().filter(|step| step.is_finite() && *step > 0.0).collect();
    if moving.is_empty() {
        return steps;
    }
    let middle = moving.len() / 2;
    let usual = *moving.select_nth_unstable_by(middle, f64::total_cmp).1;
    let is_usual = |step: f64| (step - usual).abs() <= EVEN * usual;
    let like = || steps.iter().copied().filter(|step| is_usual(*step));
    let mean = like().sum::<f64>() / like().count() as f64;
    steps.iter_mut().filter(|step| is_usual(**step)).for_each(|step| *step = mean);
    steps
}

fn begun(drive: &DynamicsDrive, share: f64) -> DynamicsDrive {
    let rows = (share * drive.x.len() as f64).ceil() as usize;
    let first = |values: &[f64]| values[..rows.min(values.len())].to_vec();
    DynamicsDrive {
        x: first(&drive.x),
        steps: first(&drive.steps),
        targets: first(&drive.targets),
        weights: first(&drive.weights),
    }
}

/// A record of equal periods as its first and the mean of the others; `None` if not in steady state from the second on.
fn averaged(drive: &DynamicsDrive, equal: f64) -> Option<DynamicsDrive> {
    let rows = drive.x.len();
    if drive.targets.iter().any(|target| target.is_nan()) {
        return None;
    }
    let repeats = |period: usize| (period..rows).all(|k| (drive.x[k] - drive.x[k - period]).abs() <= equal);
    let repeats_at_first =
        |period: usize| (0..period.min(50)).all(|k| (drive.x[k + period] - drive.x[k]).abs() <= equal);
    let period = (2..=rows / FEWEST_PERIODS).find(|&period| repeats_at_first(period) && repeats(period))?;
    let is_constant = drive.x[..period].iter().all(|x| (x - drive.x[0]).abs() <= equal);
    let periods = rows / period;
    if is_constant || periods < FEWEST_PERIODS {
        return None;
    }
    let mean_from = |first: usize, k: usize| -> f64 {
        (first..periods).map(|n| drive.targets[n * period + k]).sum::<f64>() / (periods - first) as f64
    };
    // What the later periods differ by is noise; with the second it would be more in a transient.
    let deviation = |of: usize, others: usize| -> f64 {
        let square = |k: usize| square(drive.targets[of * period + k] - mean_from(others, k));
        (0..period).map(square).sum::<f64>() / period as f64
    };
    let counted = (periods - 2) as f64;
    if periods > FEWEST_PERIODS {
        // Of n values, one differs from their mean by 1 - 1/n of the variance, a further value by 1 + 1/n.
        let noise = deviation(periods - 1, 2) / (1.0 - 1.0 / counted);
        if deviation(1, 2) > LARGEST_TRANSIENT * LARGEST_TRANSIENT * noise * (1.0 + 1.0 / counted) {
            return None;
        }
    }
    let mut averaged = begun(drive, 2.0 * period as f64 / rows as f64);
    averaged.x.truncate(2 * period);
    for values in [&mut averaged.steps, &mut averaged.targets, &mut averaged.weights] {
        values.truncate(2 * period);
    }
    for k in 0..period {
        averaged.targets[period + k] = mean_from(1, k);
        averaged.weights[period + k] = ((periods - 1) as f64).sqrt();
    }
    Some(averaged)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, exp, sin};

    use super::*;

    /// A periodic input, and an output with a transient and a little noise that differs from period to period.
    fn drive(periods: usize, transient: f64) -> DynamicsDrive {
        let period = 64;
        let rows = periods * period + 10;
        let x = |k: usize| sin(0.1 * (k % period) as f64) + 0.3 * cos(0.7 * (k % period) as f64);
        let noise = |k: usize| 1e-3 * ((k * k) as f64 * 0.618_033_988_749_895).fract();
        let y = |k: usize| x(k) + transient * exp(-(k as f64) / 40.0) + noise(k);
        DynamicsDrive {
            x: (0..rows).map(x).collect(),
            steps: vec![0.1; rows],
            targets: (0..rows).map(y).collect(),
            weights: vec![1.0; rows],
        }
    }

    #[test]
    fn time_steps_that_differ_by_rounding_become_equal() {
        let time = |k: u32| f64::from(k) / 750.0;
        let mut steps: Vec<f64> = (1..1000).map(|k| time(k) - time(k - 1)).collect();
        assert!(steps.windows(2).any(|pair| pair[0] != pair[1]));
        steps[0] = 0.0;
        steps[1] = f64::INFINITY;
        steps[500] = 1.001 / 750.0;
        let even = evened(steps.clone());
        for k in [0, 1, 500] {
            assert_eq!(even[k], steps[k]);
        }
        let equal = |k: &usize| even[*k] == even[2] && (even[*k] * 750.0 - 1.0).abs() < 1e-12;
        assert_eq!((2..even.len()).filter(equal).count(), even.len() - 3);
        assert!(evened(vec![0.0, f64::INFINITY]).len() == 2);
    }

    #[test]
    fn equal_periods_become_two_of_which_the_second_counts_more() {
        let whole = drive(5, 1e-3);
        let short = averaged(&whole, 1e-9).unwrap();
        assert_eq!(short.x.len(), 128);
        assert_eq!(short.targets[..64], whole.targets[..64]);
        let mean = |k: usize| (1..5).map(|n| whole.targets[n * 64 + k]).sum::<f64>() / 4.0;
        assert!((0..64).all(|k| (short.targets[64 + k] - mean(k)).abs() < 1e-12));
        assert_eq!((short.weights[0], short.weights[100]), (1.0, 2.0));
    }

    #[test]
    fn transients_and_records_without_periods_stay_as_they_are() {
        assert!(averaged(&drive(5, 3.0), 1e-9).is_none(), "a transient that lasts");
        assert!(averaged(&drive(2, 0.0), 1e-9).is_none(), "too few periods");
        let mut changed = drive(5, 0.01);
        changed.x[200] += 1e-3;
        assert!(averaged(&changed, 1e-9).is_none(), "not quite periodic");
        let constant = DynamicsDrive {
            x: vec![1.0; 300],
            steps: vec![0.1; 300],
            targets: vec![0.0; 300],
            weights: vec![1.0; 300],
        };
        assert!(averaged(&constant, 1e-9).is_none());
    }
}
