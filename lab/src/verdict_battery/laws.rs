//! The laws and their true answers. Every law is written here from the equation of a textbook and shares no code with
//! the library.
//!
//! Inputs run over -1 ... 1; a branch over this range takes 1 s on most paths, 10 s at most. An answer that a law
//! violates its property holds for records that show twice the effect that matters: `truth.rs` tests that on the
//! undisturbed record. So a law that violates a property on some paths only has the answer of these paths.

mod differential;
mod elements;
mod functions;
mod memory;
mod plays;
mod preisach;
mod stops;
mod structures;
mod viscous;

use super::property::Answers;

/// A specimen that follows a law.
pub trait Specimen {
    /// The output after the input went straight to `x` within `seconds`. The first call gives the input at the
    /// beginning, after 0 seconds.
    fn advance(&mut self, x: f64, seconds: f64) -> f64;
}

/// A law with its true answers.
pub struct Law {
    pub name: &'static str,
    /// Yes (`y`), no (`n`) or no clear answer (`-`) for static hysteresis, clockwise loops, rate dependence,
    /// wiping-out, congruency, Masing's rule, odd symmetry, saturation, deterioration and closed loops; of members also for
    /// strength loss and pinching.
    pub answers: &'static str,
    /// Why these are the answers.
    pub why: &'static str,
    /// A new specimen.
    pub specimen: fn() -> Box<dyn Specimen>,
}

impl Law {
    /// The answers, in the order of the properties.
    pub fn answers(&self) -> Answers {
        let mut letters = self.answers.chars().filter(|letter| *letter != ' ');
        std::array::from_fn(|_| match letters.next() {
            Some('y') => Some(true),
            Some('n') => Some(false),
            _ => None,
        })
    }

    /// The output at every input, `seconds` apart.
    pub fn run(&self, inputs: &[f64], seconds: f64) -> Vec<f64> {
        let mut specimen = (self.specimen)();
        let step = |(row, &x): (usize, &f64)| specimen.advance(x, if row == 0 { 0.0 } else { seconds });
        inputs.iter().enumerate().map(step).collect()
    }
}

/// All laws.
pub fn all() -> Vec<Law> {
    [
        plays::laws(),
        stops::laws(),
        preisach::laws(),
        differential::laws(),
        structures::laws(),
        functions::laws(),
        viscous::laws(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests;
