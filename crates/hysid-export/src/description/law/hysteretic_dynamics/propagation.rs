//! The modes over one step: the factors of their motion, by the power series of a short part of the step and doubling.

use hysid_core::law::hysteretic_dynamics::Mode;

use crate::program::expression::{Real, RealVariable, Whole};
use crate::program::{Array, Builder};

/// Terms of the power series.
const TERMS: usize = 20;

/// Steps with `θ (1 + 2 ζ)` below this use the power series.
const SHORT: f64 = 1.0;

/// The factors of all modes: `Φ_qq, Φ_qp, α_0, α_1, Φ_pq, Φ_pp, β_0, β_1`, each of every mode.
pub struct ModeFactors {
    modes: usize,
    factors: Array,
    frequencies: Array,
    dampings: Array,
    /// `1 + 2 ζ`
    reaches: Array,
    /// `1/k` at the place `k`.
    inverses: Array,
}

/// The weights `α_0, α_1, β_0, β_1` of the forces at the ends of a step.
struct EndWeights {
    alpha: [RealVariable; 2],
    beta: [RealVariable; 2],
}

impl ModeFactors {
    pub fn new(builder: &mut Builder, name: &str, modes: &[Mode]) -> Self {
        let of_modes = |of: fn(&Mode) -> f64| modes.iter().map(of).collect::<Vec<f64>>();
        let inverses = (0..=TERMS + 1).map(|k| if k == 0 { 0.0 } else { 1.0 / k as f64 }).collect();
        Self {
            modes: modes.len(),
            factors: builder.scratch(&format!("{name}_factor"), 8 * modes.len()),
            frequencies: builder.constants(&format!("{name}_frequency"), of_modes(|mode| mode.frequency)),
            dampings: builder.constants(&format!("{name}_damping"), of_modes(|mode| mode.damping)),
            reaches: builder.constants(&format!("{name}_reach"), of_modes(|mode| 1.0 + 2.0 * mode.damping)),
            inverses: builder.constants(&format!("{name}_inverse"), inverses),
        }
    }

    pub fn at(&self, factor: usize, mode: &Whole) -> Real {
        self.factors.at(self.place(factor, mode))
    }

    fn place(&self, factor: usize, mode: &Whole) -> Whole {
        mode + factor * self.modes
    }

    /// Computes the factors of steps of this length.
    pub fn set(&self, builder: &mut Builder, length: &Real) {
        builder.each(0_usize, self.modes, |builder, i| {
            let theta = builder.value(self.frequencies.at(&i) * length);
            let set = |builder: &mut Builder, factors: [Real; 8]| {
                for (k, factor) in factors.into_iter().enumerate() {
                    builder.set(self.factors, self.place(k, &i), factor);
                }
            };
            builder.when_else(
                theta.equals(f64::INFINITY),
                |builder| set(builder, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0].map(Real::from)),
                |builder| {
                    let ratio = builder.value(self.dampings.at(&i));
                    let weights = self.weights(builder, &theta, &ratio, &self.reaches.at(&i));
                    let [displacement, s, velocity] = weights.changes(builder, &ratio);
                    let ([alpha_0, alpha_1], [beta_0, beta_1]) =
                        (weights.alpha.map(Real::from), weights.beta.map(Real::from));
                    let (kept, velocity_kept) = (1.0 + displacement, 1.0 + velocity);
                    set(builder, [kept, s.clone(), alpha_0, alpha_1, -s, velocity_kept, beta_0, beta_1]);
                },
            );
        });
    }

    fn weights(&self, builder: &mut Builder, theta: &Real, ratio: &Real, reach: &Real) -> EndWeights {
        let part = builder.variable(theta);
        builder.while_true((Real::from(part) * reach).at_least(SHORT), |builder| {
            builder.assign(part, 0.5 * Real::from(part));
        });
        let weights = self.of_short_step(builder, &part.into(), ratio);
        builder.while_true(Real::from(part).below(theta), |builder| {
            weights.double(builder, ratio);
            builder.assign(part, 2.0 * Real::from(part));
        });
        weights
    }

    /// From the power series of `S`.
    fn of_short_step(&self, builder: &mut Builder, angle: &Real, ratio: &Real) -> EndWeights {
        let square = builder.value(angle * angle);
        let drag = builder.value(2.0 * (ratio * angle));
        let mut zero = || builder.variable(0.0);
        let weights = EndWeights { alpha: [zero(), zero()], beta: [zero(), zero()] };
        let (before, term) = (zero(), builder.variable(angle));
        let add = |builder: &mut Builder, to: RealVariable, value: Real| {
            builder.assign(to, Real::from(to) + value);
        };
        builder.each(1_usize, TERMS, |builder, k| {
            let n = builder.value(k.to_real());
            let inverse = builder.value(self.inverses.at(&k + 1_usize));
            let of_velocity = builder.value(&inverse * Real::from(term));
            let of_displacement = builder.value(self.inverses.at(&k + 2_usize) * (Real::from(term) * angle));
            add(builder, weights.alpha[0], of_displacement.clone());
            add(builder, weights.alpha[1], &inverse * of_displacement);
            add(builder, weights.beta[0], &n * &of_velocity);
            add(builder, weights.beta[1], of_velocity);
            let sum = builder.value(&n * (&drag * Real::from(term)) + &square * Real::from(before));
            builder.assign(before, term);
            builder.assign(term, -(inverse * self.inverses.at(&k)) * sum);
        });
        weights
    }
}

impl EndWeights {
    /// `Φ_qq - 1`, `S` and `Φ_pp - 1`.
    fn changes(&self, builder: &mut Builder, ratio: &Real) -> [Real; 3] {
        let ([alpha_0, alpha_1], [beta_0, beta_1]) = (self.alpha.map(Real::from), self.beta.map(Real::from));
        let displacement = builder.value(-(alpha_0 + alpha_1));
        let s = builder.value(beta_0 + beta_1);
        let velocity = builder.value(&displacement - 2.0 * (ratio * &s));
        [displacement, s, velocity]
    }

    /// Becomes those of a step twice as long.
    fn double(&self, builder: &mut Builder, ratio: &Real) {
        let [displacement, s, velocity] = self.changes(builder, ratio);
        let mut moved = |q: Real, p: Real| {
            let (q, p) = (builder.value(q), builder.value(p));
            let after = &q + (&displacement * &q + &s * &p);
            let velocity_after = &p + (&velocity * &p - &s * &q);
            [builder.value(after), builder.value(velocity_after)]
        };
        let ([alpha_0, alpha_1], [beta_0, beta_1]) = (self.alpha.map(Real::from), self.beta.map(Real::from));
        let half = |weight: &Real| 0.5 * weight;
        let [q_0, p_0] = moved(&alpha_0 + half(&alpha_1), &beta_0 + half(&beta_1));
        let [q_1, p_1] = moved(half(&alpha_1), half(&beta_1));
        builder.assign(self.alpha[1], q_1 + (half(&alpha_0) + &alpha_1));
        builder.assign(self.alpha[0], q_0 + half(&alpha_0));
        builder.assign(self.beta[1], p_1 + (half(&beta_0) + &beta_1));
        builder.assign(self.beta[0], p_0 + half(&beta_0));
    }
}
