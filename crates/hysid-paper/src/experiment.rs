//! The experiments by their names.

use crate::chapter::{Chapter, FurtherFile};
use crate::conditions::{Observer, Settings};
use crate::example::catalogue::{EXAMPLES, Example};
use crate::{example, nds, table2, training};

/// One of the experiments.
#[derive(Debug, Clone, Copy)]
pub enum Experiment {
    /// One neuron.
    Nds,
    /// An example of the paper.
    Example(&'static Example),
    /// Which network can represent which property.
    Table2,
    /// The trainers compared.
    Training,
}

impl Experiment {
    /// All of them, in the order of the page.
    pub fn all() -> impl Iterator<Item = Experiment> {
        let examples = EXAMPLES.iter().map(Experiment::Example);
        let others = [Experiment::Table2, Experiment::Training];
        [Experiment::Nds].into_iter().chain(examples).chain(others)
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

    /// The files that only this experiment has.
    pub fn further_files(self) -> &'static [FurtherFile] {
        match self {
            Experiment::Training => &training::FILES,
            Experiment::Nds | Experiment::Example(_) | Experiment::Table2 => &[],
        }
    }

    /// Runs it; an error as of a fit, or if the observer stops it.
    pub fn chapter(self, settings: Settings, observer: &dyn Observer) -> hysid::Result<Chapter> {
        match self {
            Experiment::Nds => Ok(nds::chapter()),
            Experiment::Example(example) => example::chapter(example, settings, observer),
            Experiment::Table2 => table2::chapter(settings, observer),
            Experiment::Training => training::chapter(settings, observer),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    struct Impatient;

    impl Observer for Impatient {
        fn clock(&self) -> Duration {
            Duration::ZERO
        }

        fn is_stopped(&self) -> bool {
            true
        }

        fn say(&self, line: &str) {
            panic!("nothing is done: {line}");
        }
    }

    #[test]
    fn an_experiment_that_is_stopped_says_so() {
        for name in ["example1", "table2", "training"] {
            let settings = Settings { seed: 1, quick: true };
            let ended = Experiment::named(name).unwrap().chapter(settings, &Impatient);
            assert!(matches!(ended, Err(hysid::Error::Stopped)), "{name}: {ended:?}");
        }
    }
}
