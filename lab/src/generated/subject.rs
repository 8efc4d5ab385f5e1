//! What is measured in a case: any law, untouched at the beginning of each record.

use hysid_core::law::series::samples_of;
use hysid_core::law::{Law, Sample};

/// A law that gives the outputs of a record from its samples.
type Run = Box<dyn Fn(&[Sample]) -> Vec<f64>>;

/// A specimen with the range of its input.
pub(super) struct Subject {
    /// Smallest and largest input of the experiment.
    pub range: (f64, f64),
    run: Run,
}

impl Subject {
    /// A specimen from the step of an untouched one.
    pub fn new(range: (f64, f64), step: impl FnMut(Sample) -> f64 + Clone + 'static) -> Self {
        let run = move |samples: &[Sample]| {
            let fresh = step.clone();
            samples.iter().copied().map(fresh).collect()
        };
        Self { range, run: Box::new(run) }
    }

    /// A specimen of a classical law.
    pub fn of_law<L: Law + Clone + 'static>(range: (f64, f64), law: L) -> Self
    where
        L::State: 'static,
    {
        let mut state = law.virgin();
        Self::new(range, move |sample| law.step(&mut state, sample))
    }

    /// The outputs at all samples, from the untouched specimen.
    pub fn run(&self, samples: &[Sample]) -> Vec<f64> {
        (self.run)(samples)
    }

    /// The outputs at all inputs where time does not matter.
    pub fn run_still(&self, inputs: &[f64]) -> Vec<f64> {
        let samples = samples_of(inputs);
        self.run(&samples)
    }

    /// Middle and half of the range.
    pub fn swing(&self) -> (f64, f64) {
        (0.5 * (self.range.0 + self.range.1), 0.5 * (self.range.1 - self.range.0))
    }
}
