//! A mode over one step: its motion under a force that changes linearly is followed exactly.
//!
//! ```text
//! q'' + 2 ζ ω q' + ω² q = ω² f(t),   p = q'/ω,   θ = ω h                       theory.md (15.3)
//! q_1 = Φ_qq q_0 + Φ_qp p_0 + α_0 f_0 + α_1 f_1
//! p_1 = Φ_pq q_0 + Φ_pp p_0 + β_0 f_0 + β_1 f_1                                theory.md (15.4)
//! ```
//!
//! `f` is the force as the displacement that it would hold at rest. Both `Φ` and the weights of the forces follow
//! from `S(θ)`, the displacement after a unit velocity `p`: `S'' + 2 ζ S' + S = 0`, `S(0) = 0`, `S'(0) = 1`:
//!
//! ```text
//! Φ_qp = -Φ_pq = S = β_0 + β_1,   Φ_qq = 1 - (α_0 + α_1),   Φ_pp = Φ_qq - 2 ζ S
//! ```
//!
//! The power series of `S` gives the weights of a short step; it has no cancellation. A long step is halved until it
//! is short, and its weights follow by doubling the step again and again. All this needs sums, products and
//! quotients alone, which every machine and language rounds alike, so an export equals the library to the last bit.
//! One formula serves all damping ratios. Doubling with `Φ - 1` rather than `Φ` is after Zhong and Williams, A precise
//! time step integration method, Proceedings of the Institution of Mechanical Engineers C 208 (1994) 427-430.

/// A number with its derivatives by `θ` and by `ζ`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dual {
    value: f64,
    by: [f64; 2],
}

impl Dual {
    fn constant(value: f64) -> Self {
        Self { value, by: [0.0; 2] }
    }

    /// The same function of this number, with its value and slope there.
    fn map(self, value: f64, slope: f64) -> Self {
        Self { value, by: self.by.map(|by| slope * by) }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, by: [self.by[0] + other.by[0], self.by[1] + other.by[1]] }
    }

    fn times(self, other: Self) -> Self {
        let by = |k: usize| self.by[k] * other.value + self.value * other.by[k];
        Self { value: self.value * other.value, by: [by(0), by(1)] }
    }

    fn scaled(self, factor: f64) -> Self {
        self.map(factor * self.value, factor)
    }

    fn minus(self, other: Self) -> Self {
        self.plus(other.scaled(-1.0))
    }
}

/// The factors of a step of a mode: `Φ_qq, Φ_qp, α_0, α_1` of the displacement, `Φ_pq, Φ_pp, β_0, β_1` of the velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propagation {
    /// `Φ_qq, Φ_qp, α_0, α_1`.
    pub displacement: [f64; 4],
    /// `Φ_pq, Φ_pp, β_0, β_1`.
    pub velocity: [f64; 4],
}

/// The factors with their derivatives by `ln ω` and `ln ζ`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PropagationSlopes {
    pub of: Propagation,
    pub by_ln_frequency: Propagation,
    pub by_ln_damping: Propagation,
}

/// Terms of the power series; the last is below rounding for the [`SHORT`] steps that use it.
const TERMS: usize = 20;

/// Steps with `θ (1 + 2 ζ)` below this use the power series.
const SHORT: f64 = 1.0;

impl Propagation {
    /// Of a step of any length, even an infinite one, after which the mode is at rest.
    pub fn new(frequency: f64, damping: f64, step: f64) -> Self {
        PropagationSlopes::new(frequency, damping, step).of
    }

    /// Displacement and velocity `[q, p]` after the step, under a force that goes from one value to the other.
    #[inline(always)]
    pub fn moved(&self, [q, p]: [f64; 2], [f_before, f]: [f64; 2]) -> [f64; 2] {
        let of =
            |[by_q, by_p, by_before, by_f]: [f64; 4]| by_q * q + by_p * p + by_before * f_before + by_f * f;
        [of(self.displacement), of(self.velocity)] // (15.3), (15.4)
    }

    const AT_REST: Self = Self { displacement: [0.0, 0.0, 0.0, 1.0], velocity: [0.0; 4] };
    const NONE: Self = Self { displacement: [0.0; 4], velocity: [0.0; 4] };
}

impl PropagationSlopes {
    pub fn new(frequency: f64, damping: f64, step: f64) -> Self {
        let theta = frequency * step;
        if theta == f64::INFINITY {
            return Self {
                of: Propagation::AT_REST,
                by_ln_frequency: Propagation::NONE,
                by_ln_damping: Propagation::NONE,
            };
        }
        let ratio = Dual { value: damping, by: [0.0, 1.0] };
        let weights = ForceWeights::new(Dual { value: theta, by: [1.0, 0.0] }, ratio);
        let factors = weights.factors(ratio);
        let of = |pick: &dyn Fn(Dual) -> f64| Propagation {
            displacement: factors[0].map(pick),
            velocity: factors[1].map(pick),
        };
        Self {
            of: of(&|dual| dual.value),
            by_ln_frequency: of(&|dual| theta * dual.by[0]),
            by_ln_damping: of(&|dual| damping * dual.by[1]),
        }
    }
}

/// The weights of the forces at both ends of a step, from which all factors follow.
#[derive(Clone, Copy)]
struct ForceWeights {
    alpha: [Dual; 2],
    beta: [Dual; 2],
}

impl ForceWeights {
    fn new(angle: Dual, ratio: Dual) -> Self {
        let mut part = angle;
        while part.value * (1.0 + 2.0 * ratio.value) >= SHORT {
            part = part.scaled(0.5);
        }
        let mut weights = Self::of_short_step(part, ratio);
        while part.value < angle.value {
            weights = weights.doubled(ratio);
            part = part.scaled(2.0);
        }
        weights
    }

    /// From the power series of `S`, whose terms are integrated against `1 - t/θ` and `t/θ`.
    fn of_short_step(angle: Dual, ratio: Dual) -> Self {
        let zero = Dual::constant(0.0);
        let (square, drag) = (angle.times(angle), ratio.times(angle).scaled(2.0));
        let (mut alpha, mut beta) = ([zero; 2], [zero; 2]);
        // s_k θ^k, from s_k+1 = -(2 ζ k s_k + s_k-1)/((k + 1) k).
        let (mut before, mut term) = (zero, angle);
        for k in 1..TERMS {
            let k = k as f64;
            let (inverse, next_inverse) = (1.0 / (k + 1.0), 1.0 / (k + 2.0));
            let of_velocity = term.scaled(inverse);
            let of_displacement = term.times(angle).scaled(next_inverse);
            alpha = [alpha[0].plus(of_displacement), alpha[1].plus(of_displacement.scaled(inverse))];
            beta = [beta[0].plus(of_velocity.scaled(k)), beta[1].plus(of_velocity)];
            let sum = drag.times(term).scaled(k).plus(square.times(before));
            (before, term) = (term, sum.scaled(-(inverse * (1.0 / k))));
        }
        Self { alpha, beta }
    }

    /// `Φ_qq - 1`, `S` and `Φ_pp - 1`.
    fn changes(self, ratio: Dual) -> [Dual; 3] {
        let displacement = self.alpha[0].plus(self.alpha[1]).scaled(-1.0);
        let s = self.beta[0].plus(self.beta[1]);
        [displacement, s, displacement.minus(ratio.times(s).scaled(2.0))]
    }

    /// Of a step twice as long: two steps, and the force in the middle is the mean of those at the ends.
    fn doubled(self, ratio: Dual) -> Self {
        let [displacement, s, velocity] = self.changes(ratio);
        // A displacement and velocity after the second half.
        let moved = |q: Dual, p: Dual| {
            [q.plus(displacement.times(q).plus(s.times(p))), p.plus(velocity.times(p).minus(s.times(q)))]
        };
        let half = |of: [Dual; 2]| [of[0].scaled(0.5), of[1].scaled(0.5)];
        let (alpha, beta) = (half(self.alpha), half(self.beta));
        let [q_0, p_0] = moved(self.alpha[0].plus(alpha[1]), self.beta[0].plus(beta[1]));
        let [q_1, p_1] = moved(alpha[1], beta[1]);
        Self {
            alpha: [q_0.plus(alpha[0]), q_1.plus(alpha[0].plus(self.alpha[1]))],
            beta: [p_0.plus(beta[0]), p_1.plus(beta[0].plus(self.beta[1]))],
        }
    }

    /// The factors of [`Propagation`].
    fn factors(self, ratio: Dual) -> [[Dual; 4]; 2] {
        let one = Dual::constant(1.0);
        let [displacement, s, velocity] = self.changes(ratio);
        let ([alpha_0, alpha_1], [beta_0, beta_1]) = (self.alpha, self.beta);
        [[one.plus(displacement), s, alpha_0, alpha_1], [s.scaled(-1.0), one.plus(velocity), beta_0, beta_1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, exp, sin};

    /// Every kind of step: short, long, nearly critical, overdamped.
    const STEPS: [(f64, f64); 10] = [
        (1e-6, 0.02),
        (0.08, 0.02),
        (0.9, 0.02),
        (0.99, 0.0051),
        (3.0, 0.3),
        (1.7, 0.98),
        (1.7, 1.0),
        (1.7, 1.02),
        (0.4, 3.0),
        (40.0, 12.0),
    ];

    /// The mode by many small steps of Runge and Kutta.
    fn integrated(theta: f64, damping: f64, start: [f64; 2], forces: [f64; 2]) -> [f64; 2] {
        let parts = 4000;
        let h = theta / f64::from(parts);
        let slope = |at: f64, [q, p]: [f64; 2]| {
            [p, forces[0] + (forces[1] - forces[0]) * at / theta - q - 2.0 * damping * p]
        };
        let moved = |[q, p]: [f64; 2], [dq, dp]: [f64; 2], by: f64| [q + by * dq, p + by * dp];
        let mut state = start;
        for k in 0..parts {
            let at = f64::from(k) * h;
            let k1 = slope(at, state);
            let k2 = slope(at + 0.5 * h, moved(state, k1, 0.5 * h));
            let k3 = slope(at + 0.5 * h, moved(state, k2, 0.5 * h));
            let k4 = slope(at + h, moved(state, k3, h));
            for i in 0..2 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            }
        }
        state
    }

    #[test]
    fn a_step_is_the_solution_of_the_equation_of_motion() {
        for (theta, damping) in STEPS {
            let step = Propagation::new(theta, damping, 1.0);
            for unit in 0..4 {
                let mut given = [0.0; 4];
                given[unit] = 1.0;
                let exact = integrated(theta, damping, [given[0], given[1]], [given[2], given[3]]);
                let found = [step.displacement[unit], step.velocity[unit]];
                for (found, exact) in found.into_iter().zip(exact) {
                    assert!((found - exact).abs() < 3e-9, "{theta} {damping} {unit}: {found} {exact}");
                }
            }
        }
    }

    /// The closed form of `S` and `S'`.
    fn closed(theta: f64, damping: f64) -> [f64; 2] {
        let square = 1.0 - damping * damping;
        let w = square.abs().sqrt();
        let (s, cosine) = if square > 0.0 {
            let decay = exp(-damping * theta);
            (decay * sin(w * theta) / w, decay * cos(w * theta))
        } else {
            // -ζ + w = -1/(ζ + w) without cancellation.
            let (slow, fast) = (exp(-theta / (damping + w)), exp(-theta * (damping + w)));
            (0.5 * (slow - fast) / w, 0.5 * (slow + fast))
        };
        [s, cosine - damping * s]
    }

    #[test]
    fn steps_of_all_lengths_agree_with_the_closed_form() {
        let lengths = [1e-9, 1e-3, 0.3, 0.9, 3.0, 17.0, 400.0, 2e4, 1e6, 1e12];
        for theta in lengths {
            for damping in [1e-5, 0.01, 0.3, 0.9, 1.5, 8.0, 1e3] {
                let step = Propagation::new(theta, damping, 1.0);
                let [s, slope] = closed(theta, damping);
                let [kept, velocity_kept] = [slope + 2.0 * damping * s, slope];
                let of_ramp = (2.0 * damping * (1.0 - kept) + s) / theta;
                let expected = [kept, s, 1.0 - of_ramp, -s, velocity_kept, (1.0 - kept) / theta];
                let found = [
                    step.displacement[0],
                    step.displacement[1],
                    step.displacement[3],
                    step.velocity[0],
                    step.velocity[1],
                    step.velocity[3],
                ];
                // The phase of a long step is rounded, and so are quotients of a short one.
                let tolerance = 1e-13 + 1e-15 * (theta + (1.0 + 2.0 * damping) / theta);
                for (k, (found, expected)) in found.into_iter().zip(expected).enumerate() {
                    let difference = (found - expected).abs();
                    assert!(difference <= tolerance, "{theta} {damping} {k}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn derivatives_equal_differences() {
        for (theta, damping) in STEPS {
            let slopes = PropagationSlopes::new(theta, damping, 1.0);
            let by = 1e-5;
            let difference = |up: Propagation, down: Propagation| {
                let all = |of: Propagation| [of.displacement, of.velocity].concat();
                let pairs = all(up).into_iter().zip(all(down));
                pairs.map(|(up, down)| (up - down) / (2.0 * by)).collect::<Vec<f64>>()
            };
            let at = |ln_frequency: f64, ln_damping: f64| {
                Propagation::new(theta * exp(ln_frequency), damping * exp(ln_damping), 1.0)
            };
            for (slope, difference) in [
                (slopes.by_ln_frequency, difference(at(by, 0.0), at(-by, 0.0))),
                (slopes.by_ln_damping, difference(at(0.0, by), at(0.0, -by))),
            ] {
                for (slope, difference) in
                    [slope.displacement, slope.velocity].concat().iter().zip(difference)
                {
                    assert!((slope - difference).abs() < 1e-8 * (1.0 + slope.abs()), "{theta} {damping}");
                }
            }
        }
    }

    #[test]
    fn after_an_endless_step_a_mode_is_at_rest() {
        for damping in [0.01, 2.0] {
            assert_eq!(Propagation::new(1.0, damping, f64::INFINITY), Propagation::AT_REST);
            let long = Propagation::new(1.0, damping, 1e300);
            let factors = [long.displacement, long.velocity].concat();
            let at_rest = [Propagation::AT_REST.displacement, Propagation::AT_REST.velocity].concat();
            assert!(factors.iter().zip(at_rest).all(|(factor, rest)| (factor - rest).abs() < 1e-15));
        }
    }
}
