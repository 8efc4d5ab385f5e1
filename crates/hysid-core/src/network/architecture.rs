//! Architecture: which parts of the family a network has, and how many.

use serde::{Deserialize, Serialize};

use crate::error::{Error, OptionError, Result};

/// A named family of networks: which parts of the [`Architecture`] are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Family {
    /// Prandtl neural network: stops of x, linear readout.
    #[serde(rename = "pnn")]
    Pnn,
    /// Generalized Prandtl neural network: deteriorating stops of x, linear readout.
    #[serde(rename = "gpnn")]
    Gpnn,
    /// Preisach neural network: stops of x and a tanh layer.
    #[serde(rename = "preisach-nn")]
    PreisachNn,
    /// Extended Preisach neural network (XPNN, EPNN): deteriorating stops of x and its rate, tanh layer.
    #[serde(rename = "xpnn", alias = "epnn")]
    Xpnn,
    /// Beyond the paper: XPNN with relaxation neurons, a direct linear path and further inputs.
    #[serde(rename = "xpnn+")]
    XpnnPlus,
}

impl Family {
    /// All families.
    pub const ALL: [Family; 5] =
        [Family::Pnn, Family::Gpnn, Family::PreisachNn, Family::Xpnn, Family::XpnnPlus];

    /// Its name on the command line and in model files, such as `preisach-nn`.
    pub fn name(self) -> &'static str {
        match self {
            Family::Pnn => "pnn",
            Family::Gpnn => "gpnn",
            Family::PreisachNn => "preisach-nn",
            Family::Xpnn => "xpnn",
            Family::XpnnPlus => "xpnn+",
        }
    }

    /// Summary of the family, in a few words.
    pub fn summary(self) -> &'static str {
        match self {
            Family::Pnn => "network of stops with a linear readout",
            Family::Gpnn => "network of deteriorating stops with a linear readout",
            Family::PreisachNn => "network of stops with a tanh layer",
            Family::Xpnn => "the paper's network: deteriorating stops of the input and its rate, tanh layer",
            Family::XpnnPlus => "xpnn with relaxation neurons, a direct path and further inputs",
        }
    }

    /// True if the rate of the first input is an input of the stops.
    pub fn uses_rate(self) -> bool {
        matches!(self, Family::Xpnn | Family::XpnnPlus)
    }

    /// True if the stops deteriorate.
    pub fn deteriorates(self) -> bool {
        matches!(self, Family::Gpnn | Family::Xpnn | Family::XpnnPlus)
    }

    /// True if there is a tanh layer.
    pub fn has_tanh_layer(self) -> bool {
        !matches!(self, Family::Pnn | Family::Gpnn)
    }

    /// True if there are relaxation neurons, provided that the data have time stamps.
    pub fn relaxes(self) -> bool {
        self == Family::XpnnPlus
    }

    /// True if more than one input is possible.
    pub fn takes_further_inputs(self) -> bool {
        self == Family::XpnnPlus
    }
}

impl std::str::FromStr for Family {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let known = if name == "epnn" { "xpnn" } else { name };
        Family::ALL.into_iter().find(|family| family.name() == known).ok_or_else(|| {
            let known = Family::ALL.map(Family::name).into();
            Error::UnknownName { what: "model", name: name.into(), known }
        })
    }
}

/// Numbers of neurons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sizes {
    /// Stop neurons.
    pub stops: usize,
    /// Tanh neurons; ignored by a family without a tanh layer.
    pub hidden: usize,
    /// Relaxation neurons of each input; ignored by a family without them, and without time stamps.
    pub relaxation: usize,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { stops: 10, hidden: 10, relaxation: 4 }
    }
}

/// The parts of a network: which equations of the [module page](super) it uses (theory.md (2.1) to (2.6)).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Architecture {
    /// Number of inputs, without the rate.
    pub inputs: usize,
    /// True if the rate of the first input is an input of the network too.
    pub rate: bool,
    /// Stop neurons.
    pub stops: usize,
    /// True if the stops deteriorate (finite `β`).
    pub deterioration: bool,
    /// True if there is a linear neuron `z_0`.
    pub linear: bool,
    /// Relaxation neurons of each input.
    pub relaxation: usize,
    /// Tanh neurons; 0 for a network whose memory neurons lead directly to the output.
    pub hidden: usize,
    /// True if there is a direct path `d_j` beside the tanh layer.
    pub direct: bool,
    /// True if the output has a constant `c_0`.
    pub constant: bool,
}

const MOST_NEURONS: usize = 1000;

const MOST_INPUTS: usize = 100;

impl Architecture {
    /// The architecture of a family for data with this number of inputs, with or without a rate, with or
    /// without time stamps. Without time stamps there are no relaxation neurons.
    ///
    /// # Errors
    /// No stops or tanh neurons where the family needs them, more than 1000 neurons of one kind, several
    /// inputs for a family that takes one.
    pub fn new(family: Family, sizes: Sizes, inputs: usize, rate: bool, time: bool) -> Result<Self> {
        let neural = !matches!(family, Family::Pnn | Family::Gpnn);
        if inputs != 1 && !family.takes_further_inputs() {
            return Err(Error::SeveralInputs { model: family.name(), found: inputs });
        }
        if neural && sizes.hidden == 0 {
            let needed = format!("{} needs at least one tanh neuron (pnn and gpnn have none)", family.name());
            return Err(OptionError::value("hidden", 0, needed).into());
        }
        let plus = family == Family::XpnnPlus;
        let architecture = Self {
            inputs,
            rate: rate && family.uses_rate(),
            stops: sizes.stops,
            deterioration: family.deteriorates(),
            linear: neural,
            relaxation: if plus && time { sizes.relaxation } else { 0 },
            hidden: if neural { sizes.hidden } else { 0 },
            direct: plus,
            constant: true,
        };
        architecture.check()?;
        Ok(architecture)
    }

    /// Checks the numbers of parts.
    ///
    /// # Errors
    /// No stop, no input, more than 100 inputs, more than 1000 neurons of a kind.
    pub fn check(&self) -> Result<()> {
        if self.stops == 0 {
            return Err(Error::Parts("a network needs at least one stop".into()));
        }
        if self.inputs == 0 || self.inputs > MOST_INPUTS {
            return Err(Error::Parts(format!("{} inputs: a network takes 1 to {MOST_INPUTS}", self.inputs)));
        }
        for (count, kind) in
            [(self.stops, "stops"), (self.hidden, "hidden neurons"), (self.relaxation, "relaxation neurons")]
        {
            if count > MOST_NEURONS {
                return Err(Error::Parts(format!("{count} {kind} are too many: at most {MOST_NEURONS}")));
            }
        }
        Ok(())
    }

    /// Number of channels of `u`: the first input, its rate, the further inputs.
    pub fn channels(&self) -> usize {
        self.inputs + usize::from(self.rate)
    }

    /// Number of relaxation neurons of all inputs together.
    pub fn relaxation_neurons(&self) -> usize {
        self.relaxation * self.inputs
    }

    /// Number of memory neurons: linear neuron, stops and relaxation neurons, in this order.
    pub fn memory_neurons(&self) -> usize {
        usize::from(self.linear) + self.stops + self.relaxation_neurons()
    }

    /// True if the memory neurons lead directly to the output, beside a tanh layer or without one.
    pub fn has_direct_path(&self) -> bool {
        self.direct || self.hidden == 0
    }

    /// Number of output weights, found by least squares: constant, tanh neurons, direct path, in this order.
    pub fn output_weights(&self) -> usize {
        let direct = if self.has_direct_path() { self.memory_neurons() } else { 0 };
        usize::from(self.constant) + self.hidden + direct
    }

    /// Number of parameters found by search, which are all but the output weights.
    ///
    /// For `xpnn` with `n_s` stops, `n_t` tanh neurons and the two inputs `x` and `x'` it is `n_s n_t + 3 n_s
    /// + 2 n_t + 2` (theory.md (2.8)).
    pub fn searched_parameters(&self) -> usize {
        let memory = self.stops * (self.channels() + usize::from(self.deterioration))
            + if self.linear { self.channels() } else { 0 }
            + self.relaxation_neurons();
        memory + self.hidden * (1 + self.memory_neurons())
    }

    /// Number of all parameters, the output weights included.
    pub fn parameters(&self) -> usize {
        self.searched_parameters() + self.output_weights()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn xpnn(stops: usize, hidden: usize, rate: bool) -> Architecture {
        let sizes = Sizes { stops, hidden, relaxation: 0 };
        Architecture::new(Family::Xpnn, sizes, 1, rate, rate).unwrap()
    }

    #[test]
    fn parameters_are_the_papers_and_the_capacities() {
        for stops in 1..12 {
            for hidden in 1..12 {
                let ours = xpnn(stops, hidden, true).searched_parameters();
                // (2.7), and the capacity of each stop.
                assert_eq!(ours, stops * hidden + 2 * (stops + hidden + 1) + stops);
                let without_rate = xpnn(stops, hidden, false).searched_parameters();
                assert_eq!(without_rate, stops * hidden + stops + 2 * hidden + 1 + stops);
            }
        }
        assert_eq!(xpnn(10, 10, true).searched_parameters(), 152);
    }

    #[test]
    fn prandtl_networks_have_two_and_three_parameters_a_stop() {
        let sizes = Sizes { stops: 7, hidden: 9, relaxation: 3 };
        let constant = 1;
        let pnn = Architecture::new(Family::Pnn, sizes, 1, true, true).unwrap();
        assert_eq!(pnn.parameters(), 2 * 7 + constant);
        let gpnn = Architecture::new(Family::Gpnn, sizes, 1, true, true).unwrap();
        assert_eq!(gpnn.parameters(), 3 * 7 + constant);
    }
}
