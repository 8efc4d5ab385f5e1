//! Generated identification cases: a law with random parameters under a typical experiment, with noise,
//! divided into training and test data.
//!
//! They guard against tuning to the measured cases. Each case follows a plan (a law, a design of the
//! experiment, columns) with random variations: most values of the law are multiplied by `e^{0.2 N(0, 1)}`,
//! with a standard normal number `N(0, 1)`; amplitudes, cycles, amount of data and noise vary. All plans and
//! values are *designed*; the sources of the laws are given with them.

mod cyclic_plasticity;
mod devices;
mod draw;
mod driven;
mod elastomer;
mod magnetorheological_damper;
mod magnets;
mod one_loop;
mod peak_oriented;
mod phase_transformation;
mod plans;
mod quasi_static;
mod structures;
mod subject;
mod timed;
mod tones;

use hysid::specimens::with_noise;
use hysid_core::data::record::{Dataset, Record};
use hysid_core::error::Result;

use draw::Draw;
pub use driven::{DrivenSpecimen, driven_specimen};
pub use one_loop::one_loop;
use plans::PLANS;

/// An identification case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Number, specimen and design, such as `g07-concrete-growing`.
    pub name: String,
    /// The law, in a few words.
    pub law: &'static str,
    /// The design of the experiment, in a few words.
    pub design: &'static str,
    /// Training data.
    pub train: Dataset,
    /// Test data. A record that continues a training record begins with the training input, its outputs
    /// blank.
    pub test: Dataset,
}

/// Number of plans, that is, of different kinds of cases.
pub const KINDS: usize = PLANS.len();

/// The records of a case before noise.
struct Parts {
    train: Vec<Record>,
    test: Vec<Record>,
}

/// The first `count` cases of a seed. A case depends on the seed and its own number only. After [`KINDS`]
/// cases the plans repeat with other parameters.
///
/// ```
/// let cases = hysid_lab::generated::generated(2, 1)?;
/// assert_eq!(cases[0].name, "g01-joint-growing");
/// assert!(cases[0].train.scored() > cases[0].test.scored());
/// # Ok::<(), hysid_core::Error>(())
/// ```
///
/// # Errors
/// A law whose random values give no finite output; none is known.
pub fn generated(count: usize, seed: u64) -> Result<Vec<Case>> {
    (0..count).map(|index| case(index, seed)).collect()
}

fn case(index: usize, seed: u64) -> Result<Case> {
    let plan = &PLANS[index % KINDS];
    let mut draw = Draw::new(seed, index);
    let subject = (plan.subject)(&mut draw)?;
    let parts = plan.design.parts(&mut draw, &subject)?;
    let names = plan.names();
    let percent = draw.between(plan.noise.0, plan.noise.1);
    let mut noisy = |records| noisy(Dataset::new(names.clone(), records)?, percent, &mut draw);
    Ok(Case {
        name: format!("g{:02}-{}", index + 1, plan.name),
        law: plan.law,
        design: plan.design.words(),
        train: noisy(parts.train)?,
        test: noisy(parts.test)?,
    })
}

/// Data with noise of this deviation, in percent of that of the output.
fn noisy(data: Dataset, percent: f64, draw: &mut Draw) -> Result<Dataset> {
    with_noise(&data, percent, draw.seed())
}

#[cfg(test)]
mod tests;
