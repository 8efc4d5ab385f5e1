//! Is this a resonance? A linear oscillator is compared with the best law without inertia: powers of the input, its rate and
//! stops. Both run freely over the same rows. theory.md (10.28).

mod excerpt;
mod linear_oscillator;
mod normal_equations;
mod search;
mod static_law;

pub use excerpt::ComparedSignal;
use excerpt::Excerpts;
pub(crate) use excerpt::{JITTER, even_step};
use hysid_core::data::record::Dataset;
pub use linear_oscillator::LinearOscillator;

use crate::Piece;

/// Limits of the residual of the oscillator divided by that of the law without inertia, below which there is a resonance:
/// for the output, and for its changes.
const RATIO: f64 = 0.6;
const RATIO_OF_CHANGES: f64 = 0.75;

/// With a larger damping ratio, the response does not oscillate; it only lags. Yielding adds apparent damping, hence the
/// higher limit for changes.
const MOST_DAMPING: f64 = 0.4;
const MOST_DAMPING_OF_CHANGES: f64 = 0.8;

/// A linear oscillator, compared with a law without inertia.
#[derive(Debug, Clone, PartialEq)]
pub struct Resonance {
    /// The linear oscillator that fits best.
    pub oscillator: LinearOscillator,
    /// The residual of the oscillator divided by that of the law without inertia.
    pub ratio: f64,
    /// The rows that were compared.
    pub rows: Vec<Piece>,
}

impl Resonance {
    /// Compares the best linear oscillator with the best law without inertia, whichever is better. If the output shows no
    /// resonance, its changes from row to row are compared, because no linear oscillator follows the permanent deformation
    /// of a structure that yields. `None` unless the data have one input, evenly spaced time (to 1/1000 of a step) and at least
    /// 200 rows with an output in records of at least 200 rows, and where input or output are constant. Of long data some
    /// 6000 rows are compared.
    pub fn of(data: &Dataset) -> Option<Self> {
        let of_output = Self::of_what(data, ComparedSignal::Output)?;
        if of_output.is_found() {
            return Some(of_output);
        }
        Self::of_what(data, ComparedSignal::Changes).filter(Self::is_found).or(Some(of_output))
    }

    /// True if the oscillator leaves clearly less, and swings.
    pub fn is_found(&self) -> bool {
        let (ratio, damping_ratio) = match self.oscillator.compared {
            ComparedSignal::Output => (RATIO, MOST_DAMPING),
            ComparedSignal::Changes => (RATIO_OF_CHANGES, MOST_DAMPING_OF_CHANGES),
        };
        self.ratio < ratio && self.oscillator.damping_ratio <= damping_ratio
    }

    fn of_what(data: &Dataset, compared: ComparedSignal) -> Option<Self> {
        let excerpts = Excerpts::of(data, compared)?;
        let oscillator = search::best(&excerpts)?;
        let (frequency, damping_ratio) = (oscillator.natural_frequency, oscillator.damping_ratio);
        let remainder = static_law::remainder(data, &excerpts, frequency, damping_ratio);
        let ratio = oscillator.residual / excerpts.root_mean_square(remainder);
        let rows = excerpts.parts.iter();
        let rows = rows
            .map(|part| Piece::of(&data.records()[part.record], (part.rows.start, part.rows.end - 1)))
            .collect();
        Some(Self { oscillator, ratio, rows })
    }
}

#[cfg(test)]
mod tests;
