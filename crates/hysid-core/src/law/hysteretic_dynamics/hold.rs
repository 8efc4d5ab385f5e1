//! The input between two samples.

use serde::{Deserialize, Serialize};

/// How the input goes from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// It keeps the value of the earlier sample, as that of a digital output does.
    Constant,
    /// Along a straight line.
    Linear,
    /// Along the cubic through the last four samples, for a smooth input that was sampled; along a straight line
    /// where they are not equally far apart. It never needs a later sample.
    Cubic,
}

/// Time steps that differ by less, relative to their length, count as equal.
const EQUAL: f64 = 1e-3;

impl Hold {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Constant, Self::Linear, Self::Cubic];

    /// The input after the share `part` of the last step, from the newest four samples, the newest first.
    #[inline(always)]
    pub(super) fn at(self, part: f64, recent: &RecentSamples) -> f64 {
        let [last, before, third, fourth] = recent.values;
        match self {
            Self::Constant => before,
            Self::Cubic if recent.is_even => {
                let (up, down, on) = (part + 1.0, part - 1.0, part + 2.0);
                part * up * on / 6.0 * last - 0.5 * down * up * on * before + 0.5 * down * part * on * third
                    - down * part * up / 6.0 * fourth
            }
            _ => before + part * (last - before),
        }
    }
}

/// The newest samples of the input, and whether they are equally far apart.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RecentSamples {
    /// The newest first.
    pub values: [f64; 4],
    /// The last three time steps, the newest first; 0 where there was none.
    steps: [f64; 3],
    pub is_even: bool,
}

impl RecentSamples {
    /// At rest under this input.
    pub fn at_rest(value: f64) -> Self {
        Self { values: [value; 4], steps: [0.0; 3], is_even: false }
    }

    pub fn add(&mut self, value: f64, step: f64) {
        let [a, b, c, _] = self.values;
        self.values = [value, a, b, c];
        let [p, q, _] = self.steps;
        self.steps = [step, p, q];
        self.is_even = step.is_finite() && [p, q].iter().all(|other| (other - step).abs() <= EQUAL * step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recent(values: [f64; 4], steps: [f64; 3]) -> RecentSamples {
        let mut recent = RecentSamples::at_rest(values[0]);
        values[1..].iter().zip(steps).for_each(|(&value, step)| recent.add(value, step));
        recent
    }

    #[test]
    fn the_cubic_hold_reproduces_a_cubic() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.3 * t * t * t;
        let recent = recent([-2.0, -1.0, 0.0, 1.0].map(cubic), [1.0; 3]);
        for k in 0..=10 {
            let part = f64::from(k) / 10.0;
            assert!((Hold::Cubic.at(part, &recent) - cubic(part)).abs() < 1e-14);
        }
    }

    #[test]
    fn uneven_steps_are_bridged_by_a_straight_line() {
        let recent = recent([7.0, 5.0, 1.0, 3.0], [1.0, 1.0, 1.5]);
        assert_eq!(Hold::Cubic.at(0.25, &recent), 1.5);
        assert_eq!(Hold::Linear.at(0.25, &recent), 1.5);
        assert_eq!(Hold::Constant.at(0.25, &recent), 1.0);
    }

    #[test]
    fn the_input_between_samples_is_at_most_the_lebesgue_constant() {
        for signs in 0..16 {
            let values = [0, 1, 2, 3].map(|bit| if signs >> bit & 1 == 1 { 1.0 } else { -1.0 });
            let recent = recent(values, [1.0; 3]);
            for hold in Hold::ALL {
                let largest =
                    (0..=1000).map(|k| hold.at(f64::from(k) / 1000.0, &recent).abs()).fold(0.0, f64::max);
                assert!(largest <= if hold == Hold::Cubic { 1.64 } else { 1.0 });
            }
        }
        let worst = recent([1.0, -1.0, 1.0, 1.0], [1.0; 3]);
        let largest = (0..=1000).map(|k| Hold::Cubic.at(f64::from(k) / 1000.0, &worst)).fold(0.0, f64::max);
        assert!(largest > 1.5, "{largest}");
    }
}
