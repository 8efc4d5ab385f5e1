//! One specimen, one first test, one seed: the errors after each second test.

use anyhow::Result;
use hysid::data::record::Dataset;
use hysid::plan::{DrivePath, Limits, Plan, PlanOptions};
use hysid::{Fit, Model};

use crate::rig::{Rig, drives, error_of};

/// Rows of the first test.
const ROWS: usize = 525;

/// What was run first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum FirstTest {
    /// Cycles over the whole range.
    Constant,
    /// Amplitudes from a quarter of the range to the whole, two cycles each.
    Rising,
}

impl FirstTest {
    pub const ALL: [Self; 2] = [Self::Constant, Self::Rising];

    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "cycles of constant amplitude",
            Self::Rising => "cycles of rising amplitude",
        }
    }

    fn drive(self, path: &DrivePath) -> Vec<f64> {
        let Limits { range: (low, high), start, .. } = path.limits;
        let level = move |cycle: usize| match self {
            Self::Constant => 1.0,
            Self::Rising => 0.25 * (1 + (cycle / 2) % 4) as f64,
        };
        let turns = (0..).flat_map(move |cycle| {
            [start + level(cycle) * (high - start), start + level(cycle) * (low - start)]
        });
        drives::through(path, turns, ROWS)
    }
}

/// The errors on unseen data, NRMSE in percent of the standard deviation.
#[derive(Debug, Clone)]
pub struct Trial {
    pub name: &'static str,
    pub first: FirstTest,
    pub seed: u64,
    pub before: f64,
    pub repeated: f64,
    pub planned: f64,
    pub random: f64,
    /// Rows of the plan; the other tests have those of the first.
    pub rows: usize,
}

impl Trial {
    /// What it is worth to plan.
    pub fn ratio(&self) -> f64 {
        self.repeated / self.planned
    }

    /// The same against the lower of the errors without a second test and after the same one again: models chosen by
    /// cross-validation can become worse by a repetition.
    pub fn strict_ratio(&self) -> f64 {
        self.before.min(self.repeated) / self.planned
    }

    pub fn line(&self) -> String {
        format!(
            "{}, {}, seed {}: before {:.2}, repeated {:.2}, planned {:.2} ({} rows), random {:.2}, ratio {:.2}",
            self.name,
            self.first.name(),
            self.seed,
            self.before,
            self.repeated,
            self.planned,
            self.rows,
            self.random,
            self.ratio()
        )
    }
}

/// Fits models after the first test and after each second one.
pub fn trial(name: &'static str, first: FirstTest, seed: u64) -> Result<Trial> {
    let rig = Rig::new(name, seed, ROWS)?;
    let path = &rig.path;
    let one = rig.measured("first", &first.drive(path), seed)?;
    let model = fit(&rig.data([one.clone()])?, seed)?;
    let unseen = rig.unseen(seed)?;
    let plan = Plan::of(&rig.data([one.clone()])?, &PlanOptions { seed, ..PlanOptions::default() })?;
    let after = |drive: &[f64], noise: u64| -> Result<f64> {
        let second = rig.measured("second", drive, noise)?;
        error_of(&fit(&rig.data([one.clone(), second])?, seed)?, &unseen)
    };
    Ok(Trial {
        name,
        first,
        seed,
        before: error_of(&model, &unseen)?,
        repeated: after(&first.drive(path), seed + 100)?,
        planned: after(&plan.input, seed + 200)?,
        random: after(&drives::random(path, ROWS, 1000 * seed + 500), seed + 300)?,
        rows: plan.rows(),
    })
}

/// The default model, with one start of each candidate.
fn fit(data: &Dataset, seed: u64) -> Result<Model> {
    Ok(Fit::new().option("starts", 1).option("initial_state", "virgin").seed(seed).run(data)?)
}
