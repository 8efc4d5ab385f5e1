//! Is this a resonance? A linear oscillator is compared with the best law without inertia: powers of the input, its rate and
//! stops. Both run freely over the same rows. theory.md (10.28).

mod excerpt;
mod linear_oscillator;
mod normal_equations;
mod search;
mod static_law;

use excerpt::Excerpts;
pub(crate) use excerpt::{JITTER, even_step};
use hysid_core::data::record::Dataset;
pub use linear_oscillator::LinearOscillator;

use crate::Piece;

/// An oscillator that leaves less than this share of what a law without inertia leaves is a resonance.
const RATIO: f64 = 0.6;

/// With a larger damping ratio nothing swings: the output only comes late.
const MOST_DAMPING: f64 = 0.4;

/// A linear oscillator, compared with a law without inertia.
#[derive(Debug, Clone, PartialEq)]
pub struct Resonance {
    /// The oscillator.
    pub oscillator: LinearOscillator,
    /// Root mean square of what the law without inertia leaves of the output, in its unit.
    pub static_residual: f64,
    /// The residual of the oscillator divided by that of the law without inertia.
    pub ratio: f64,
    /// The rows that were compared.
    pub rows: Vec<Piece>,
}

impl Resonance {
    /// Compares the best linear oscillator with the best law without inertia, whichever is better. `None` unless the data
    /// have one input, evenly spaced time (to 1/1000 of a step) and at least 200 rows with an output in records of at least
    /// 200 rows, and where input or output are constant. Of long data some 6000 rows are compared.
    pub fn of(data: &Dataset) -> Option<Self> {
        let excerpts = Excerpts::of(data)?;
        let oscillator = search::best(&excerpts).into_iter().next()?;
        let (frequency, damping_ratio) = (oscillator.natural_frequency, oscillator.damping_ratio);
        let remainder = static_law::remainder(data, &excerpts, frequency, damping_ratio);
        let static_residual = excerpts.root_mean_square(remainder);
        let ratio = oscillator.residual / static_residual;
        let rows = excerpts.parts.iter();
        let rows = rows
            .map(|part| Piece::of(&data.records()[part.record], (part.rows.start, part.rows.end - 1)))
            .collect();
        Some(Self { oscillator, static_residual, ratio, rows })
    }

    /// True if the oscillator leaves clearly less, and swings.
    pub fn is_found(&self) -> bool {
        self.ratio < RATIO && self.oscillator.damping_ratio <= MOST_DAMPING
    }
}

/// Linear oscillators that fit data in a free run, the best first: up to three, at different frequencies. None where
/// [`Resonance::of`] compares nothing.
pub fn linear_oscillators(data: &Dataset) -> Vec<LinearOscillator> {
    Excerpts::of(data).map_or_else(Vec::new, |excerpts| search::best(&excerpts))
}

#[cfg(test)]
mod tests;
