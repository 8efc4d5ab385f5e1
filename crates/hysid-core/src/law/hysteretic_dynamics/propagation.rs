//! A mode over one step: its motion under a force that changes linearly is followed exactly.
//!
//! ```text
//! q'' + 2 ζ ω q' + ω² q = ω² f(t),   p = q'/ω,   θ = ω h                       theory.md (15.3)
//! q_1 = Φ_qq q_0 + Φ_qp p_0 + α_0 f_0 + α_1 f_1
//! p_1 = Φ_pq q_0 + Φ_pp p_0 + β_0 f_0 + β_1 f_1                                theory.md (15.4)
//! ```
//!
//! `f` is the force as the displacement that it would hold at rest. Both `Φ` and the weights of the forces follow
//! from `S(θ)`, the displacement after a unit velocity `p`: `S'' + 2 ζ S' + S = 0`, `S(0) = 0`, `S'(0) = 1`. Short
//! steps sum its power series, which has no cancellation; long ones use its closed form.

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

    fn over(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        self.times(other.map(inverse, -inverse * inverse))
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.map(value, value)
    }
}

/// The factors of a step of a mode: `Φ_qq, Φ_qp, α_0, α_1` of the displacement, then `Φ_pq, Φ_pp, β_0, β_1` of the
/// velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Propagation {
    pub displacement: [f64; 4],
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

/// Steps with `θ (1 + 2 ζ)` up to here use the power series.
const SHORT: f64 = 1.0;

/// `|(1 - ζ²) θ²|` up to which sine and cosine use their series, so that critical damping is no special case.
const NEARLY_CRITICAL: f64 = 0.1;

/// Decay after which nothing is left of the motion before, to rounding.
const FORGOTTEN: f64 = 700.0;

impl Propagation {
    /// Of a step of any length, even an infinite one, after which the mode is at rest.
    pub fn new(frequency: f64, damping: f64, step: f64) -> Self {
        PropagationSlopes::new(frequency, damping, step).of
    }

    const AT_REST: Self = Self { displacement: [0.0, 0.0, 0.0, 1.0], velocity: [0.0; 4] };
    const NONE: Self = Self { displacement: [0.0; 4], velocity: [0.0; 4] };
}

impl PropagationSlopes {
    pub fn new(frequency: f64, damping: f64, step: f64) -> Self {
        let theta = frequency * step;
        // The slower of the two decays of an overdamped mode counts.
        let slowest = if damping > 1.0 { 0.5 / damping } else { damping };
        if slowest * theta > FORGOTTEN {
            return Self {
                of: Propagation::AT_REST,
                by_ln_frequency: Propagation::NONE,
                by_ln_damping: Propagation::NONE,
            };
        }
        let angle = Dual { value: theta, by: [1.0, 0.0] };
        let ratio = Dual { value: damping, by: [0.0, 1.0] };
        let factors = if theta * (1.0 + 2.0 * damping) < SHORT {
            by_series(angle, ratio)
        } else {
            in_closed_form(angle, ratio)
        };
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

/// The factors from the power series of `S`.
fn by_series(angle: Dual, ratio: Dual) -> [[Dual; 4]; 2] {
    let zero = Dual::constant(0.0);
    // s_k θ^k, from s_k+2 = -(2 ζ (k + 1) s_k+1 + s_k)/((k + 2)(k + 1)).
    let (mut before, mut term) = (zero, angle);
    let (mut s, mut slope) = (zero, zero);
    let (mut alpha_0, mut alpha_1, mut beta_0, mut beta_1) = (zero, zero, zero, zero);
    for k in 1..TERMS {
        let n = k as f64;
        s = s.plus(term);
        // k s_k θ^(k-1) and the integrals of both against 1 - t/θ and t/θ.
        let without = term.over(angle);
        slope = slope.plus(without.scaled(n));
        let integral = term.times(angle);
        alpha_1 = alpha_1.plus(integral.scaled(1.0 / ((n + 1.0) * (n + 2.0))));
        alpha_0 = alpha_0.plus(integral.scaled(1.0 / (n + 2.0)));
        beta_1 = beta_1.plus(term.scaled(1.0 / (n + 1.0)));
        beta_0 = beta_0.plus(term.scaled(n / (n + 1.0)));
        let of_velocity = ratio.times(angle).times(term).scaled(2.0 * n);
        let of_displacement = angle.times(angle).times(before);
        let next = of_velocity.plus(of_displacement).scaled(-1.0 / ((n + 1.0) * n));
        (before, term) = (term, next);
    }
    let kept = Dual::constant(1.0).minus(alpha_0.plus(alpha_1));
    [[kept, s, alpha_0, alpha_1], [s.scaled(-1.0), slope, beta_0, beta_1]]
}

/// The factors from the closed form of `S`.
fn in_closed_form(angle: Dual, ratio: Dual) -> [[Dual; 4]; 2] {
    let one = Dual::constant(1.0);
    let square = one.minus(ratio.times(ratio));
    let z = square.times(angle).times(angle);
    // e^(-ζθ) cos(wθ) and e^(-ζθ) sin(wθ)/w, with w² = 1 - ζ², which may be negative.
    let (cosine, s) = if z.value.abs() < NEARLY_CRITICAL {
        let decay = ratio.times(angle).scaled(-1.0).exp();
        let (mut cosine, mut sine) = (one, one);
        let (mut of_cosine, mut of_sine) = (one, one);
        for k in 1..9 {
            let n = 2.0 * f64::from(k);
            of_cosine = of_cosine.times(z).scaled(-1.0 / (n * (n - 1.0)));
            of_sine = of_sine.times(z).scaled(-1.0 / (n * (n + 1.0)));
            (cosine, sine) = (cosine.plus(of_cosine), sine.plus(of_sine));
        }
        (decay.times(cosine), decay.times(angle).times(sine))
    } else if z.value > 0.0 {
        let decay = ratio.times(angle).scaled(-1.0).exp();
        let root = square.value.sqrt();
        let w = square.map(root, 0.5 / root);
        let phase = w.times(angle);
        let (sin, cos) = phase.value.sin_cos();
        (decay.times(phase.map(cos, -sin)), decay.times(phase.map(sin, cos)).over(w))
    } else {
        let root = (-square.value).sqrt();
        let w = square.map(root, -0.5 / root);
        // -ζ + w = -1/(ζ + w) without cancellation.
        let slow = angle.scaled(-1.0).over(ratio.plus(w)).exp();
        let fast = angle.times(ratio.plus(w)).scaled(-1.0).exp();
        (slow.plus(fast).scaled(0.5), slow.minus(fast).scaled(0.5).over(w))
    };
    let by_ratio = ratio.times(s);
    let kept = cosine.plus(by_ratio);
    let velocity_kept = cosine.minus(by_ratio);
    let twice = ratio.scaled(2.0);
    let of_ramp = twice.times(one.minus(kept)).plus(s).over(angle);
    let velocity_of_ramp = one.minus(twice.times(s)).minus(velocity_kept).over(angle);
    [
        [kept, s, of_ramp.minus(kept), one.minus(of_ramp)],
        [s.scaled(-1.0), velocity_kept, s.minus(velocity_of_ramp), velocity_of_ramp],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn short_steps_agree_with_the_closed_form() {
        for (theta, damping) in [(0.3, 0.05), (0.9, 0.01), (0.3, 0.9), (0.2, 1.5)] {
            let (angle, ratio) =
                (Dual { value: theta, by: [1.0, 0.0] }, Dual { value: damping, by: [0.0, 1.0] });
            let (series, closed) = (by_series(angle, ratio), in_closed_form(angle, ratio));
            for (a, b) in series.iter().flatten().zip(closed.iter().flatten()) {
                assert!((a.value - b.value).abs() < 1e-13, "{theta} {damping}: {a:?} {b:?}");
                assert!((a.by[0] - b.by[0]).abs() + (a.by[1] - b.by[1]).abs() < 1e-11, "{a:?} {b:?}");
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
                Propagation::new(theta * ln_frequency.exp(), damping * ln_damping.exp(), 1.0)
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
        for (step, damping) in [(f64::INFINITY, 0.01), (1e300, 50.0), (f64::INFINITY, 2.0)] {
            assert_eq!(Propagation::new(1.0, damping, step), Propagation::AT_REST);
        }
    }
}
