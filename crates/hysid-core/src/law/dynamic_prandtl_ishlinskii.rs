//! Dynamic Prandtl-Ishlinskii model: plays between linear dynamics, for hysteresis in series with a lag, creep or one
//! resonance, or in parallel with relaxation.
//!
//! ```text
//! u = x - σ_0[x]   or   u = x                                                 theory.md (8.53)
//! m = c + w_0 u + Σ_i w_i p_{r_i}[u] + Σ_j s_j S_{d_j}(u)                     theory.md (8.54)
//! f = m + Σ_k b_k σ_k[m]                                                      theory.md (8.55)
//! q'' = ω² (f - q) - 2 ζ ω q'   or   q = f                                    theory.md (8.56)
//! y = q + e_0 x + Σ_k e_k σ_k[x]                                              theory.md (8.57)
//! S_d(u) = max(u - d, 0) for d > 0,   min(u - d, 0) for d < 0
//! ```
//!
//! `x` is the input, `y` the output and `p_r` the [play](crate::operator::play) of threshold `r`. `σ_k` is the
//! [relaxation element](crate::operator::relaxation) of time constant `τ_k`, so `x - σ_k[x]` is a first-order lag.
//! `ω` and `ζ` are natural angular frequency and damping ratio. A record begins in equilibrium with its first sample:
//! `σ_k = 0`, `q = f`, `q' = 0`. All dynamics are solved exactly for what is linear between samples.
//!
//! Properties: at a vanishing rate it is a sum of plays and a curve, `m` with `u = x`. Sources: Krejci and Kuhnen (creep
//! of plays); Hammerstein and Wiener models, a nonlinearity before and behind linear dynamics. This form is ours.

use serde::{Deserialize, Serialize};

use crate::error::{LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts};
use crate::law::hysteretic_dynamics::{DAMPING_RATIOS, Propagation};
use crate::law::modified_prandtl_ishlinskii::dead_zone;
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::properties::{CONGRUENT, MASING, ODD, WIPES_OUT};
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::operator::relaxation::{advance, decay};
use crate::property::Property;

/// Most relaxation elements behind the plays.
pub const MOST_RELAXATIONS: usize = 3;

/// Most dead zones.
const MOST_DEAD_ZONES: usize = 200;

/// A one-sided dead zone `s S_d(u)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeadZone {
    /// `d`, not 0, in the unit of the input.
    pub threshold: f64,
    /// `s`, in the unit of the output divided by that of the input.
    pub weight: f64,
}

/// A relaxation element behind the plays and beside them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Relaxation {
    /// `τ`, in the unit of time.
    pub time_constant: f64,
    /// `b`: its share of the output of the plays; -1 alone is a lag, negative is creep, positive is relaxation.
    pub share: f64,
    /// `e`: weight of the same element driven by the input, in the unit of the output divided by that of the input.
    pub input_weight: f64,
}

/// A resonance behind the plays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resonance {
    /// `ω`: natural angular frequency, in radians per unit of time.
    pub frequency: f64,
    /// `ζ`: damping ratio.
    pub damping: f64,
}

/// A dynamic Prandtl-Ishlinskii model in the user's units (theory.md (8.53) to (8.57)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynamicPrandtlIshlinskii {
    /// `τ_0`: time constant of the lag before the plays, in the unit of time; `None` without a lag.
    pub lag: Option<f64>,
    /// `c`, `w_0` and the plays.
    pub plays: PrandtlIshlinskii,
    /// The dead zones.
    pub dead_zones: Vec<DeadZone>,
    /// The relaxation elements.
    pub relaxations: Vec<Relaxation>,
    /// The resonance, if there is one.
    pub resonance: Option<Resonance>,
    /// `e_0`: weight of the input beside the plays, in the unit of the output divided by that of the input.
    pub direct: f64,
}

/// State of a dynamic Prandtl-Ishlinskii model.
#[derive(Debug, Clone)]
pub struct DynamicState {
    has_begun: bool,
    /// Input, output of the plays and `f` at the sample before.
    before: [f64; 3],
    /// Stress of the lag.
    lag: f64,
    plays: Vec<f64>,
    /// Stresses of the relaxation elements: of the output of the plays, and of the input.
    stresses: [[f64; MOST_RELAXATIONS]; 2],
    /// `q` and `q'/ω`.
    motion: [f64; 2],
}

impl Law for DynamicPrandtlIshlinskii {
    type State = DynamicState;

    const FACTS: Facts = Facts {
        needs_time: true,
        limits: &[("relaxation", 0, MOST_RELAXATIONS)],
        variants: &["resonance", "lagged_input"],
        ..Facts::searched(
            "dynamic-prandtl-ishlinskii",
            "plays between linear dynamics: lag, creep, relaxation, a resonance",
            &["operators", "dead_zones", "relaxation", "resonance", "lagged_input", "starts", "epochs"],
            ErrorsInside { softening: 0.04, sigmoid: 0.7, other: 0.6 },
        )
        .with_defaults(&[("operators", 10), ("dead_zones", 2), ("relaxation", 2)])
    };

    fn virgin(&self) -> DynamicState {
        DynamicState {
            has_begun: false,
            before: [0.0; 3],
            lag: 0.0,
            plays: self.plays.virgin(),
            stresses: [[0.0; MOST_RELAXATIONS]; 2],
            motion: [0.0; 2],
        }
    }

    fn step(&self, state: &mut DynamicState, sample: Sample) -> f64 {
        let time_step = sample.step;
        let sample = sample.limited();
        let [x_before, m_before, f_before] = state.before;
        let risen = if state.has_begun { sample.x - x_before } else { 0.0 };
        let mut u = sample.x;
        if let Some(time_constant) = self.lag {
            state.lag = advance(state.lag, risen, decay(time_step, time_constant));
            u -= state.lag; // (8.53)
        }
        // (8.54)
        let mut m = self.plays.step(&mut state.plays, Sample { x: u, ..sample });
        for zone in &self.dead_zones {
            m += zone.weight * dead_zone(u, zone.threshold); // (8.54)
        }
        let m_risen = if state.has_begun { m - m_before } else { 0.0 };
        let [of_plays, of_input] = &mut state.stresses;
        let mut f = m;
        let mut beside = self.direct * sample.x;
        for ((relaxation, stress), input_stress) in self.relaxations.iter().zip(of_plays).zip(of_input) {
            let factors = decay(time_step, relaxation.time_constant);
            *stress = advance(*stress, m_risen, factors); // (1.11)
            *input_stress = advance(*input_stress, risen, factors); // (1.11)
            f += relaxation.share * *stress; // (8.55)
            beside += relaxation.input_weight * *input_stress; // (8.57)
        }
        let mut y = f;
        if let Some(resonance) = self.resonance {
            state.motion = if state.has_begun {
                let length = if time_step > 0.0 { time_step } else { 0.0 };
                let step = Propagation::new(resonance.frequency, resonance.damping, length);
                step.moved(state.motion, [f_before, f]) // (8.56), by (15.3) and (15.4)
            } else {
                [f, 0.0]
            };
            y = state.motion[0];
        }
        state.before = [sample.x, m, f];
        state.has_begun = true;
        y + beside // (8.57)
    }

    fn work_of_row(&self, _: f64, _: f64) -> f64 {
        let parts = self.relaxations.len() + usize::from(self.lag.is_some());
        let resonance = if self.resonance.is_some() { 400 } else { 0 };
        (20 + 6 * self.plays.thresholds().len() + 4 * self.dead_zones.len() + 60 * parts + resonance) as f64
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (1e-100, LARGEST_VALUE);
        let time = Dimension { time: 1, ..Dimension::NONE };
        let mut all = Vec::new();
        if let Some(lag) = self.lag {
            all.push(Parameter::new("τ_0", "time constant of the lag before the plays", lag, positive, time));
        }
        all.extend(self.plays.parameters());
        let column = |of: fn(&DeadZone) -> f64| self.dead_zones.iter().map(of).collect::<Vec<f64>>();
        let (thresholds, weights) = (column(|zone| zone.threshold), column(|zone| zone.weight));
        let (d, s) = ("threshold of a dead zone", "change of the slope beyond it");
        let d = Parameter::numbered("d", 1, &thresholds, d, any, Dimension::INPUT);
        let s = Parameter::numbered("s", 1, &weights, s, any, Dimension::SLOPE);
        all.extend(d.zip(s).flat_map(|(d, s)| [d, s]));
        for (k, relaxation) in (1..).zip(&self.relaxations) {
            let Relaxation { time_constant, share, input_weight } = *relaxation;
            let numbered = |symbol: &str| format!("{symbol}_{k}");
            all.extend([
                Parameter::new(numbered("τ"), "time constant", time_constant, positive, time),
                Parameter::new(
                    numbered("b"),
                    "share of the output of the plays",
                    share,
                    any,
                    Dimension::NONE,
                ),
            ]);
            if self.lag.is_some() {
                let meaning = "weight of the relaxation of the input";
                all.push(Parameter::new(numbered("e"), meaning, input_weight, any, Dimension::SLOPE));
            }
        }
        if let Some(Resonance { frequency, damping }) = self.resonance {
            let per_time = Dimension { time: -1, ..Dimension::NONE };
            all.extend(Parameter::table([
                ("ω", "natural angular frequency", frequency, positive, per_time),
                ("ζ", "damping ratio", damping, DAMPING_RATIOS, Dimension::NONE),
            ]));
        }
        if self.lag.is_some() {
            let meaning = "weight of the input beside the plays";
            all.push(Parameter::new("e_0", meaning, self.direct, any, Dimension::SLOPE));
        }
        all
    }

    fn validated(self) -> Result<Self> {
        const NAME: &str = "dynamic Prandtl-Ishlinskii";
        Parameter::check_all(&self.parameters(), NAME)?;
        let wrong = |what: String| Err(crate::error::Error::Parts(what));
        if self.relaxations.len() > MOST_RELAXATIONS {
            return wrong(format!(
                "{} relaxation elements: at most {MOST_RELAXATIONS}",
                self.relaxations.len()
            ));
        }
        if self.dead_zones.len() > MOST_DEAD_ZONES {
            return wrong(format!("{} dead zones: at most {MOST_DEAD_ZONES}", self.dead_zones.len()));
        }
        if self.dead_zones.iter().any(|zone| zone.threshold == 0.0) {
            return wrong("a dead zone with the threshold 0".into());
        }
        let has_parallel = self.direct != 0.0 || self.relaxations.iter().any(|part| part.input_weight != 0.0);
        if self.lag.is_none() && has_parallel {
            return wrong("weights of the input beside the plays, without a lag before them".into());
        }
        let plays = &self.plays;
        let (thresholds, weights) = (plays.thresholds().to_vec(), plays.weights().to_vec());
        PrandtlIshlinskii::new(plays.constant(), plays.linear(), thresholds, weights)?;
        Ok(self)
    }

    fn needs_steps(&self) -> bool {
        true
    }

    fn has_inertia(&self) -> bool {
        self.resonance.is_some()
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        let symmetric: &[(Property, bool)] = if self.dead_zones.is_empty() { &[MASING, ODD] } else { &[] };
        [WIPES_OUT.as_slice(), &[CONGRUENT], symmetric].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, exp, sin};
    use crate::law::series::run;

    fn law(plays: PrandtlIshlinskii) -> DynamicPrandtlIshlinskii {
        let (dead_zones, relaxations) = (Vec::new(), Vec::new());
        DynamicPrandtlIshlinskii { lag: None, plays, dead_zones, relaxations, resonance: None, direct: 0.0 }
    }

    fn spring(slope: f64) -> PrandtlIshlinskii {
        PrandtlIshlinskii::new(0.5, slope, vec![], vec![]).unwrap()
    }

    fn creeping(time_constant: f64, share: f64) -> Relaxation {
        Relaxation { time_constant, share, input_weight: 0.0 }
    }

    fn samples(x: &[f64], step: f64) -> Vec<Sample> {
        let of = |(row, &x)| Sample { x, rate: 0.0, step: if row == 0 { 0.0 } else { step } };
        x.iter().enumerate().map(of).collect()
    }

    #[test]
    fn without_dynamics_it_is_a_sum_of_plays_and_dead_zones() {
        let plays = PrandtlIshlinskii::new(0.1, 0.4, vec![0.2, 0.5], vec![1.0, 0.7]).unwrap();
        let x: Vec<f64> = (0..200).map(|row| sin(0.1 * f64::from(row)) * 0.01 * f64::from(row)).collect();
        let zone = DeadZone { threshold: -0.3, weight: 2.0 };
        let bent = DynamicPrandtlIshlinskii { dead_zones: vec![zone], ..law(plays.clone()) };
        let alone = run(&plays, &samples(&x, 0.1));
        for ((y, plays), &x) in run(&bent, &samples(&x, 0.1)).iter().zip(alone).zip(&x) {
            approx::assert_abs_diff_eq!(*y, plays + 2.0 * (x + 0.3).min(0.0), epsilon = 1e-14);
        }
    }

    /// A lag of 2 s under a ramp from rest follows `t - 2 (1 - e^{-t/2})`, whatever the steps.
    #[test]
    fn a_lag_follows_a_ramp_exactly_before_and_behind_the_plays() {
        let behind = DynamicPrandtlIshlinskii { relaxations: vec![creeping(2.0, -1.0)], ..law(spring(3.0)) };
        let before = DynamicPrandtlIshlinskii { lag: Some(2.0), ..law(spring(3.0)) };
        for law in [behind, before] {
            for step in [0.1, 0.7] {
                let time: Vec<f64> = (0..12).map(|row| step * f64::from(row)).collect();
                for (t, y) in time.iter().zip(run(&law, &samples(&time, step))) {
                    approx::assert_abs_diff_eq!(
                        y,
                        0.5 + 3.0 * (t - 2.0 * (1.0 - exp(-t / 2.0))),
                        epsilon = 1e-13
                    );
                }
            }
        }
    }

    /// The step response of a damped oscillator, `1 - e^{-ζωt} (cos ω_d t + ζω/ω_d sin ω_d t)`.
    #[test]
    fn a_resonance_follows_a_jump_exactly() {
        let (frequency, damping) = (5.0, 0.2_f64);
        let law = DynamicPrandtlIshlinskii {
            resonance: Some(Resonance { frequency, damping }),
            ..law(spring(1.0))
        };
        let mut state = law.virgin();
        assert_eq!(law.step(&mut state, Sample { x: 0.0, rate: 0.0, step: 0.0 }), 0.5);
        law.step(&mut state, Sample { x: 1.0, rate: 0.0, step: 0.0 });
        let damped = frequency * (1.0 - damping * damping).sqrt();
        for row in 1..20 {
            let y = law.step(&mut state, Sample { x: 1.0, rate: 0.0, step: 0.13 });
            let t = 0.13 * f64::from(row);
            let turning = cos(damped * t) + damping * frequency / damped * sin(damped * t);
            approx::assert_abs_diff_eq!(y, 1.5 - exp(-damping * frequency * t) * turning, epsilon = 1e-12);
        }
    }

    #[test]
    fn it_begins_in_equilibrium_and_after_a_long_rest_is_the_sum_of_plays() {
        let plays = PrandtlIshlinskii::new(0.1, 0.4, vec![0.2], vec![1.0]).unwrap();
        let law = DynamicPrandtlIshlinskii {
            lag: Some(0.3),
            relaxations: vec![Relaxation { time_constant: 1.0, share: 0.5, input_weight: 2.0 }],
            resonance: Some(Resonance { frequency: 9.0, damping: 0.7 }),
            direct: 0.2,
            ..law(plays.clone())
        };
        let path = [0.7, 0.2, 0.9, -0.4];
        let rested: Vec<Sample> =
            path.iter().map(|&x| Sample { x, rate: 0.0, step: f64::INFINITY }).collect();
        for ((y, plays), x) in run(&law, &rested).iter().zip(run(&plays, &rested)).zip(path) {
            approx::assert_abs_diff_eq!(*y, plays + 0.2 * x, epsilon = 1e-13);
        }
    }
}
