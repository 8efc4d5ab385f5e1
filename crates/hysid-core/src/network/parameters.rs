//! The parameters found by search, as one flat vector with names and bounds.

use std::ops::Range;

use crate::elementary::ln;
use crate::error::{Error, Result};
use crate::network::Architecture;

/// Positions of the parameters in the flat vector: stops (`w`, `ln β`), `a`, `ln τ`, then `b` and `U`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterLayout {
    architecture: Architecture,
    /// `w`: weights of the stops, one value for each channel of the first stop, then of the second, ...
    pub stop_weights: Range<usize>,
    /// `ln β` of each stop; empty without deterioration.
    pub ln_beta: Range<usize>,
    /// `a`: weights of the linear neuron, one for each channel; empty without it.
    pub linear: Range<usize>,
    /// `ln τ` of each relaxation neuron, by input, then by neuron, with `τ` in the unit of time.
    pub ln_tau: Range<usize>,
    /// Of each tanh neuron in turn: bias `b_i`, then the weights `U_ij` of the memory neurons.
    pub hidden: Range<usize>,
}

impl ParameterLayout {
    /// The layout of an architecture.
    pub fn new(architecture: Architecture) -> Self {
        let mut end = 0;
        let mut next = |length: usize| {
            let start = end;
            end += length;
            start..end
        };
        let a = &architecture;
        Self {
            architecture,
            stop_weights: next(a.stops * a.channels()),
            ln_beta: next(if a.deterioration { a.stops } else { 0 }),
            linear: next(if a.linear { a.channels() } else { 0 }),
            ln_tau: next(a.relaxation_neurons()),
            hidden: next(a.hidden * (1 + a.memory_neurons())),
        }
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.hidden.end
    }

    /// Never true: every network has a stop.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True for a connection weight, on which weight decay acts; false for `ln β` and `ln τ`.
    pub fn is_weight(&self, index: usize) -> bool {
        !self.ln_beta.contains(&index) && !self.ln_tau.contains(&index)
    }

    /// Name of each parameter in order, such as `stop 3 weight of x`.
    pub fn names(&self) -> Vec<String> {
        let a = &self.architecture;
        let channel = |c: usize| match (c, a.rate) {
            (0, _) => "x".to_string(),
            (1, true) => "rate".to_string(),
            (c, rate) => format!("x{}", c + 1 - usize::from(rate)),
        };
        let relaxation =
            |m: usize| format!("relaxation {} of x{}", m % a.relaxation + 1, m / a.relaxation + 1);
        let mut memory = vec!["bias".to_string()];
        memory.extend(a.linear.then(|| "linear neuron".to_string()));
        memory.extend((0..a.stops).map(|j| format!("stop {}", j + 1)));
        memory.extend((0..a.relaxation_neurons()).map(relaxation));

        let mut names = Vec::with_capacity(self.len());
        for j in 0..a.stops {
            names.extend((0..a.channels()).map(|c| format!("stop {} weight of {}", j + 1, channel(c))));
        }
        names.extend(self.ln_beta.clone().enumerate().map(|(j, _)| format!("stop {} ln beta", j + 1)));
        names.extend(
            self.linear.clone().enumerate().map(|(c, _)| format!("linear neuron weight of {}", channel(c))),
        );
        names.extend((0..a.relaxation_neurons()).map(|m| format!("{} ln tau", relaxation(m))));
        for i in 0..a.hidden {
            names.extend(memory.iter().map(|z| format!("hidden {} weight of {z}", i + 1)));
        }
        names
    }

    /// Lower and upper bound of a parameter. They are wide: they keep a search finite and do not guide it.
    /// Weights multiply scaled inputs. `β` lies between 0.3 and 1e7, which is practically no deterioration.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        if self.stop_weights.contains(&index) {
            (-1e4, 1e4)
        } else if self.ln_beta.contains(&index) {
            (ln(0.3), ln(1e7))
        } else if self.ln_tau.contains(&index) {
            (ln(1e-15), ln(1e15))
        } else {
            (-1e3, 1e3)
        }
    }

    /// Moves every parameter into its bounds.
    pub fn clamp(&self, values: &mut [f64]) {
        for (index, value) in values.iter_mut().enumerate() {
            let (low, high) = self.bounds(index);
            *value = value.clamp(low, high);
        }
    }

    /// Checks length and bounds of a flat vector.
    ///
    /// # Errors
    /// Another length, or a parameter that is NaN or outside its bounds, which the error names.
    pub fn check(&self, values: &[f64]) -> Result<()> {
        if values.len() != self.len() {
            return Err(Error::Parts(format!(
                "{} parameters where the architecture has {}",
                values.len(),
                self.len()
            )));
        }
        for (index, &value) in values.iter().enumerate() {
            let (low, high) = self.bounds(index);
            // ln of exp of a bound may fall a rounding outside it.
            let slack = 1e-9 * low.abs().max(high.abs());
            if !(low - slack..=high + slack).contains(&value) {
                let name = &self.names()[index];
                return Err(Error::Parts(format!("parameter `{name}` is {value}, outside {low} to {high}")));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Family, Sizes};

    #[test]
    fn every_parameter_has_its_own_name_and_sound_bounds() {
        for family in Family::ALL {
            let inputs = if family.takes_further_inputs() { 3 } else { 1 };
            let architecture = Architecture::new(family, Sizes::default(), inputs, true, true).unwrap();
            let layout = ParameterLayout::new(architecture);
            let mut names = layout.names();
            assert_eq!(names.len(), architecture.searched_parameters());
            assert_eq!(names.len(), layout.len());
            names.sort();
            names.dedup();
            assert_eq!(names.len(), layout.len(), "two parameters share a name");
            let mut values = vec![f64::INFINITY; layout.len()];
            assert!(layout.check(&values).is_err());
            layout.clamp(&mut values);
            layout.check(&values).unwrap();
        }
    }
}
