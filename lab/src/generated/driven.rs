//! Specimens of the cases that are driven along any input, to compare experiments.

use super::draw::Draw;
use super::plans::PLANS;
use super::subject::Subject;
use hysid_core::data::record::{ColumnNames, Record};
use hysid_core::error::Result;
use hysid_core::law::Sample;

/// Steps of the simulation from row to row.
const STEPS_PER_ROW: usize = 10;

/// A generator of its own, apart from those of the other cases.
const FIRST_DRAW: usize = 2000;

/// A specimen with random parameters, to be driven along any input.
pub struct DrivenSpecimen {
    /// Name of the plan of cases that it is of, such as `joint-growing`.
    pub name: &'static str,
    /// Names of its columns; the time is named for a specimen whose output depends on it.
    pub names: ColumnNames,
    /// Smallest and largest input of its experiments.
    pub range: (f64, f64),
    /// Lowest and highest frequency of its experiments in Hz; `None` where time does not matter.
    pub frequencies: Option<(f64, f64)>,
    subject: Subject,
}

/// The specimen of the plan of this name, with the random parameters of a seed.
///
/// ```
/// use hysid_lab::generated::driven_specimen;
/// let brace = driven_specimen("brace-irregular", 1)?.expect("a plan of this name");
/// let path: Vec<f64> = (0..100).map(|k| brace.range.1 * (0.1 * k as f64).sin()).collect();
/// let record = brace.run("test", &path, None)?;
/// assert_eq!(record.output()[0], 0.0);
/// # Ok::<(), hysid_core::Error>(())
/// ```
///
/// # Errors
/// A law whose random values cannot be used; none is known.
pub fn driven_specimen(name: &str, seed: u64) -> Result<Option<DrivenSpecimen>> {
    let Some((index, plan)) = PLANS.iter().enumerate().find(|(_, plan)| plan.name == name) else {
        return Ok(None);
    };
    let subject = (plan.subject)(&mut Draw::new(seed, FIRST_DRAW + index))?;
    Ok(Some(DrivenSpecimen {
        name: plan.name,
        names: plan.names(),
        range: subject.range,
        frequencies: plan.design.band(),
        subject,
    }))
}

impl DrivenSpecimen {
    /// The record of an untouched specimen along an input, with `step` seconds between rows; `None` where time does not
    /// matter.
    ///
    /// # Errors
    /// An input that no record can have.
    pub fn run(&self, name: &str, input: &[f64], step: Option<f64>) -> Result<Record> {
        let Some(step) = step else {
            return Record::new(name, vec![input.to_vec()], self.subject.run_still(input));
        };
        let output = self.subject.run(&samples(input, step)).into_iter().step_by(STEPS_PER_ROW).collect();
        let time = (0..input.len()).map(|row| row as f64 * step).collect();
        Record::new(name, vec![input.to_vec()], output)?.with_time(time)
    }
}

/// Samples along cubic polynomials between rows, whose rates at the rows are central differences.
fn samples(input: &[f64], step: f64) -> Vec<Sample> {
    let last = input.len().saturating_sub(1);
    let slope = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
        if before == after { 0.0 } else { (input[after] - input[before]) / (after - before) as f64 }
    };
    let mut samples = vec![Sample { x: input[0], rate: slope(0) / step, step: 0.0 }];
    for row in 0..last {
        let (x_0, x_1, m_0, m_1) = (input[row], input[row + 1], slope(row), slope(row + 1));
        samples.extend((1..=STEPS_PER_ROW).map(|part| {
            let s = part as f64 / STEPS_PER_ROW as f64;
            let (s2, s3) = (s * s, s * s * s);
            let x = (2.0 * s3 - 3.0 * s2 + 1.0) * x_0
                + (s3 - 2.0 * s2 + s) * m_0
                + (3.0 * s2 - 2.0 * s3) * x_1
                + (s3 - s2) * m_1;
            let rate = (6.0 * s2 - 6.0 * s) * (x_0 - x_1)
                + (3.0 * s2 - 4.0 * s + 1.0) * m_0
                + (3.0 * s2 - 2.0 * s) * m_1;
            Sample { x, rate: rate / step, step: step / STEPS_PER_ROW as f64 }
        }));
    }
    samples
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    /// A parabola is a cubic polynomial: values and rates inside are exact.
    #[test]
    fn samples_between_rows_follow_the_input() {
        let at = |t: f64| 2.0 - 3.0 * t + 0.5 * t * t;
        let input: Vec<f64> = (0..8).map(|row| at(0.2 * f64::from(row))).collect();
        let samples = samples(&input, 0.2);
        assert_eq!(samples.len(), 71);
        for (index, sample) in samples.iter().enumerate().take(61).skip(10) {
            let t = 0.02 * index as f64;
            assert!((sample.x - at(t)).abs() < 1e-12 && (sample.rate - (t - 3.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_specimen_is_untouched_at_the_beginning_of_each_record() {
        let damper = driven_specimen("damper-random", 3).unwrap().unwrap();
        let input: Vec<f64> = (0..200).map(|k| damper.range.1 * sin(0.1 * f64::from(k))).collect();
        let run = || damper.run("r", &input, Some(0.01)).unwrap();
        assert_eq!(run(), run());
        assert!(driven_specimen("jelly", 1).unwrap().is_none());
    }
}
