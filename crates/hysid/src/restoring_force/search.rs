//! The choice of a filter by its noise and its smoothing error, theory.md (15.22).

use std::ops::Range;

use hysid_core::elementary::{hypot, square};

use super::filter::{Filter, RowWeights, SMALLEST_WINDOW};

/// Degrees of the polynomials that are tried.
pub const DEGREES: [usize; 2] = [2, 4];

/// Rows on which a filter is tried.
const TRIED_ROWS: usize = 2000;

/// No longer window is tried once the smoothing error is so many times the whole error of the best.
const HOPELESS: f64 = 4.0;

/// A smoothing error is told from noise where two filters are apart by so many times the variance that noise explains.
const TOLD: f64 = 3.0;

/// A window is so many times as long where a polynomial of the next higher degree lets as much noise through.
const LONGER: f64 = 1.7;

/// The channel of each record: its time stamps and values.
pub type Channel<'a> = (&'a [f64], &'a [f64]);

/// Records on which filters are tried.
pub struct Search<'s> {
    records: &'s [Channel<'s>],
    /// The rows of each record.
    rows: Vec<Vec<usize>>,
    order: usize,
    /// Standard deviation of the noise of the channel.
    noise: f64,
}

impl<'s> Search<'s> {
    /// Of derivatives of an order, on rows with so many rows on both sides.
    pub fn new(records: &'s [Channel<'s>], on_a_side: usize, order: usize, noise: f64) -> Self {
        Self { records, rows: tried_rows(records, on_a_side), order, noise }
    }

    /// The filter with the least error among all degrees with so many rows on a side, or a long filter's shorter
    /// `other`.
    pub fn best(&self, sides: &[usize], other: Option<&Trial>) -> Trial {
        let mut best: Option<Trial> = None;
        for degree in DEGREES {
            for &on_a_side in sides {
                let filter = Filter { degree, on_a_side };
                if !filter.is_possible() {
                    continue;
                }
                let trial = self.trial(filter, other.or(best.as_ref()));
                let (error, least) = (trial.error(), best.as_ref().map_or(f64::INFINITY, Trial::error));
                if error < least {
                    best = Some(trial);
                } else if trial.is_told && trial.smoothing > HOPELESS * least {
                    break;
                }
            }
        }
        let smallest = Filter { degree: DEGREES[0], on_a_side: SMALLEST_WINDOW / 2 };
        best.unwrap_or_else(|| self.trial(smallest, None))
    }

    fn trial(&self, filter: Filter, other: Option<&Trial>) -> Trial {
        let (mut values, mut gain) = (Vec::new(), 0.0);
        let (mut apart, mut apart_by_noise) = (0.0, 0.0);
        for (&(time, channel), rows) in self.records.iter().zip(&self.rows) {
            let own = RowWeights::new(time, filter, self.order);
            let reference = RowWeights::new(time, filter.reference(), self.order);
            for &row in rows {
                let (first, own) = own.at(row);
                let (_, reference) = reference.at(row);
                let (mut derivative, mut difference) = (0.0, 0.0);
                for ((own, reference), value) in own.iter().zip(&*reference).zip(&channel[first..]) {
                    derivative += own * value;
                    difference += (reference - own) * value;
                    gain += own * own;
                    apart_by_noise += square(reference - own);
                }
                values.push(derivative);
                apart += difference * difference;
            }
        }
        let (count, variance) = (values.len() as f64, self.noise * self.noise);
        let noise = (variance * gain / count).sqrt();
        let own = Trial { filter, values, noise, smoothing: 0.0, is_told: false };
        // What two filters are apart is the smoothing error of the longer one and the noise that the other lets through.
        // A window longer than the motion hides it from the polynomials of both degrees, but not from a shorter window.
        let from_reference = Apart { total: apart / count, by_others: variance * apart_by_noise / count };
        let from_other = other.filter(|other| own.noise < other.noise).map(|other| own.apart_from(other));
        let all = || [Some(from_reference), from_other].into_iter().flatten();
        Trial {
            smoothing: all().map(Apart::smoothing).fold(0.0, f64::max),
            is_told: all().any(Apart::is_told),
            ..own
        }
    }

    /// The smoothing error of a filter by the difference from a polynomial of the higher degree on a longer window, which lets
    /// about as much noise through; above the truth where that one smooths, too.
    pub fn smoothing_by_longer(&self, trial: &Trial) -> f64 {
        let shortest = self.records.iter().map(|(time, _)| time.len()).min().unwrap_or(0);
        let on_a_side = (LONGER * trial.filter.on_a_side as f64).ceil() as usize;
        let filter = Filter { on_a_side, ..trial.filter.reference() };
        if filter.window() > shortest {
            return trial.smoothing;
        }
        let longer = self.trial(filter, None);
        let total = trial.apart_from(&longer).total;
        // Both have the rows of the shorter window, so that less noise than that of both is in the difference.
        let by_others = square(trial.noise).max(square(longer.noise));
        Apart { total, by_others }.smoothing()
    }
}

/// A filter and its errors.
pub struct Trial {
    pub filter: Filter,
    /// The derivative in the tried rows.
    values: Vec<f64>,
    /// Standard deviation of the noise of the derivative.
    pub noise: f64,
    /// Smoothing error of the derivative (root mean square).
    pub smoothing: f64,
    /// The smoothing error is larger than what noise alone can feign.
    is_told: bool,
}

impl Trial {
    /// The mean square of the difference from a filter that lets more noise through.
    fn apart_from(&self, other: &Self) -> Apart {
        let squares = self.values.iter().zip(&other.values).map(|(a, b)| square(a - b));
        Apart { total: squares.sum::<f64>() / self.values.len() as f64, by_others: square(other.error()) }
    }

    fn error(&self) -> f64 {
        hypot(self.noise, self.smoothing)
    }
}

#[derive(Debug, Clone, Copy)]
struct Apart {
    total: f64,
    /// Error that noise, and the smoothing error of the other filter, add to it.
    by_others: f64,
}

impl Apart {
    fn smoothing(self) -> f64 {
        (self.total - self.by_others).max(0.0).sqrt()
    }

    fn is_told(self) -> bool {
        self.total > TOLD * self.by_others
    }
}

/// Rows of each record on which filters are tried: those with a whole window on both sides, or the middle one.
fn tried_rows(records: &[Channel<'_>], on_a_side: usize) -> Vec<Vec<usize>> {
    let inner = |rows: usize| -> Range<usize> {
        let margin = on_a_side.min((rows - 1) / 2);
        margin..rows - margin
    };
    let total: usize = records.iter().map(|(time, _)| inner(time.len()).len()).sum();
    let stride = total.div_ceil(TRIED_ROWS).max(1);
    records.iter().map(|(time, _)| inner(time.len()).step_by(stride).collect()).collect()
}
