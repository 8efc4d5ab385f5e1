//! A law on a path, undisturbed, at every step of the simulation.

use super::evidence::{Evidence, evidence};
use super::laws::Law;
use super::paths::{Path, SUBSTEPS};

/// How much slower the path is whose loops are those at rest.
const AT_REST: f64 = 1e4;

/// An undisturbed run.
pub struct Run<'p> {
    pub path: &'p Path,
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    /// The outputs at a vanishing speed.
    at_rest: Vec<f64>,
}

impl<'p> Run<'p> {
    pub fn of(law: &Law, path: &'p Path) -> Self {
        let inputs = path.inputs();
        let seconds = path.row_seconds() / SUBSTEPS as f64;
        let (outputs, at_rest) = (law.run(&inputs, seconds), law.run(&inputs, AT_REST * seconds));
        Self { path, inputs, outputs, at_rest }
    }

    /// What the run shows of each property from a step on.
    pub fn evidence(&self, first: usize) -> Evidence {
        evidence(&self.inputs[first..], &self.outputs[first..], &self.at_rest[first..], self.path.timed)
    }
}
