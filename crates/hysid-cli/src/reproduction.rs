//! The paper's experiments, one a file. The measured data of the paper are not public: synthetic
//! specimens stand in for them, and every heading says so.

mod chapter;
mod date;
mod example;
mod fitting;
mod nds;
mod outputs;
mod run;
mod storage;
mod table2;
mod training;

use anyhow::Result;

use chapter::Chapter;
use example::catalogue::{EXAMPLES, Example};
use hysid_files::Kind;
pub use outputs::Outputs;
pub use run::run;

/// What decides about all figures but those in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// A fraction of the effort, to see how it looks.
    pub quick: bool,
}

/// One of the experiments.
#[derive(Debug, Clone, Copy)]
pub enum Experiment {
    /// One neuron.
    Nds,
    /// An example of the paper.
    Example(&'static Example),
    /// Which network can learn which property.
    Table2,
    /// The trainers compared.
    Training,
}

impl Experiment {
    /// All of them, in the order of the page.
    pub fn all() -> impl Iterator<Item = Experiment> {
        let examples = EXAMPLES.iter().map(Experiment::Example);
        [Experiment::Nds].into_iter().chain(examples).chain([Experiment::Table2, Experiment::Training])
    }

    /// The experiment of this name.
    pub fn named(name: &str) -> Option<Experiment> {
        Self::all().find(|experiment| experiment.name() == name)
    }

    /// Name on the command line and of its files.
    pub fn name(self) -> &'static str {
        match self {
            Experiment::Nds => "nds",
            Experiment::Example(example) => example.name,
            Experiment::Table2 => "table2",
            Experiment::Training => "training",
        }
    }

    /// Names of the files that only this experiment has, and what they are.
    fn further_files(self) -> Vec<(&'static str, Kind)> {
        match self {
            Experiment::Training => training::further_files(),
            Experiment::Nds | Experiment::Example(_) | Experiment::Table2 => Vec::new(),
        }
    }

    /// Runs it; `None` if interrupted.
    fn chapter(self, settings: Settings) -> Result<Option<Chapter>> {
        match self {
            Experiment::Nds => Ok(Some(nds::chapter())),
            Experiment::Example(example) => example::chapter(example, settings),
            Experiment::Table2 => table2::chapter(settings),
            Experiment::Training => training::chapter(settings),
        }
    }
}
