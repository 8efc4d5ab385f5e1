//! Laws of the battery, a step of the input at a time.

use hysid_core::elementary::{powi, tanh};

/// A law with hysteresis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Elastic, perfectly plastic, with hardening.
    ElasticPlastic,
    /// Bouc-Wen with `A = n = 1`, `β = γ = 1/2`.
    BoucWen,
    /// Force only beyond the slip that was run before.
    Pinching,
    /// A saturating function of twenty plays.
    Magnet,
}

/// State of a law.
pub struct State {
    law: Law,
    x: f64,
    z: f64,
    plays: Vec<f64>,
    reach: (f64, f64),
}

impl Law {
    /// All laws.
    pub const ALL: [Self; 4] = [Self::ElasticPlastic, Self::BoucWen, Self::Pinching, Self::Magnet];

    /// True if cycles are read from tip to tip, so that only loops that repeat have one true division.
    pub fn needs_steady(self) -> bool {
        self == Self::Magnet
    }

    /// Names of the columns.
    pub fn names(self) -> [&'static str; 2] {
        if self == Self::Magnet { ["H_A_per_m", "B_T"] } else { ["disp_mm", "force_kN"] }
    }

    /// The virgin state.
    pub fn begin(self) -> State {
        State { law: self, x: 0.0, z: 0.0, plays: vec![0.0; 20], reach: (0.0, 0.0) }
    }
}

impl State {
    /// Output after the input went straight to `x`. The largest inputs are about 1.
    pub fn to(&mut self, x: f64) -> f64 {
        let steps = ((x - self.x).abs() / 1e-3).ceil().max(1.0);
        let dx = (x - self.x) / steps;
        let begin = self.x;
        let mut y = 0.0;
        for step in 1..=steps as usize {
            y = self.step(begin + dx * step as f64, dx);
        }
        self.x = x;
        y
    }

    fn step(&mut self, x: f64, dx: f64) -> f64 {
        match self.law {
            Law::ElasticPlastic => {
                self.z = (self.z + dx).clamp(-0.04, 0.04);
                40.0 * self.z / 0.04 + 4.0 * x
            }
            Law::BoucWen => {
                let slope = 1.0 - 0.5 * (self.z * dx.signum() + self.z.abs()) * powi(self.z.abs(), 0);
                self.z += slope * 20.0 * dx;
                30.0 * self.z + 10.0 * x
            }
            Law::Pinching => {
                self.z = (self.z + dx).clamp(-0.03, 0.03);
                self.reach = (self.reach.0.min(x), self.reach.1.max(x));
                // Bearing only near the furthest inputs so far, friction everywhere.
                let bearing = (x - 0.6 * self.reach.1).max(0.0) + (x - 0.6 * self.reach.0).min(0.0);
                100.0 * bearing + 3.0 * self.z / 0.03
            }
            Law::Magnet => {
                let count = self.plays.len() as f64;
                for (number, play) in self.plays.iter_mut().enumerate() {
                    let radius = 0.5 * (number + 1) as f64 / count;
                    *play = play.clamp(x - radius, x + radius);
                }
                1.5 * tanh(2.5 * self.plays.iter().sum::<f64>() / count) + 0.05 * x
            }
        }
    }
}
