//! Peak-oriented law of a reinforced-concrete member: reloading leads to the largest displacement so far on
//! that side, along a line that is broken where the member pinches; strength decreases with work.
//!
//! ```text
//! f = φ min{K x, f_y + K_h (x - x_y), max[f_y - K_s (x - x_c), 0.1 f_y if x > x_c]}      theory.md (6.30)
//! unloading:  slope K (x_y/x_m)^u                                                        theory.md (6.31)
//! reloading:  from (x_0, 0) through x_0 + d (x_p - x_0), where f = g d f_p, to (x_p, f_p)
//! φ = e^{-w/(W f_y x_y)},   w = ∫ f dx, updated where f passes 0;   x_y = f_y/K           theory.md (6.32)
//! ```
//!
//! `x` is the displacement in mm, `f` the force in kN, `w` the work and `φ` the strength. `x_p` is the
//! largest displacement so far on the loaded side, `f_p` the envelope there, `x_m` the larger of both sides.
//! With `g = 1` there is no pinching.
//!
//! Source: Clough and Johnston (peak orientation), Takeda (slope of unloading), Ibarra, Medina and Krawinkler
//! (pinching by a broken line, strength that decreases with energy). *Designed*: that the strength decreases
//! exponentially, equally for both sides.

use hysid_core::elementary::{exp, powf};

/// Strength that is left at last, as a share of the yield force.
const RESIDUAL: f64 = 0.1;

/// Values of a member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PeakOrientedParameters {
    /// `f_y` in kN.
    pub yield_force: f64,
    /// `x_y` in mm.
    pub yield_displacement: f64,
    /// `K_h/K`.
    pub hardening: f64,
    /// `x_c/x_y`: where the softening line leaves the yield force; above 1.
    pub capping: f64,
    /// `K_s/K`, above 0.
    pub softening: f64,
    /// `u`: 0 unloads with the first stiffness.
    pub unloading: f64,
    /// `g`: height of the break as a share of the straight line, above 0 to 1.
    pub pinching: f64,
    /// `d`: place of the break between `x_0` and the peak, 0 to 1.
    pub break_place: f64,
    /// `W`: work in yield forces times yield displacements that leaves `1/e` of the strength.
    pub endurance: f64,
}

/// A member with its memory, untouched at first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PeakOriented {
    parameters: PeakOrientedParameters,
    x: f64,
    f: f64,
    work: f64,
    strength: f64,
    /// Largest displacement upwards and downwards, each positive and at least `x_y`.
    peaks: [f64; 2],
    /// Where the force last passed 0 on its way up, and on its way down, in the direction of loading.
    zeros: [f64; 2],
}

impl PeakOriented {
    pub fn new(parameters: PeakOrientedParameters) -> Self {
        let peaks = [parameters.yield_displacement; 2];
        Self { parameters, x: 0.0, f: 0.0, work: 0.0, strength: 1.0, peaks, zeros: [0.0; 2] }
    }

    /// The force in kN at the next displacement in mm. A step that begins or ends a branch is cut there,
    /// so how many steps lead to a displacement matters only where a branch meets the envelope.
    pub fn step(&mut self, x: f64) -> f64 {
        if x != self.x {
            let sign = (x - self.x).signum();
            let side = usize::from(sign < 0.0);
            // Downwards is upwards in a mirror.
            (self.x, self.f) = (x, sign * self.upwards(side, sign * self.x, sign * self.f, sign * x));
        }
        self.f
    }

    /// The force at `to`, above `from` with its force, in the direction of loading.
    fn upwards(&mut self, side: usize, mut from: f64, mut force: f64, to: f64) -> f64 {
        let slope = self.unloading_slope();
        if force <= 0.0 {
            let zero = from - force / slope;
            if zero > to {
                let after = force + slope * (to - from);
                self.work += 0.5 * (force + after) * (to - from);
                return after;
            }
            self.work += 0.5 * force * (zero - from);
            self.pass_zero(side, zero);
            (from, force) = (zero, 0.0);
        }
        let after = (force + slope * (to - from)).min(self.bound(side, to));
        self.work += 0.5 * (force + after) * (to - from);
        self.peaks[side] = self.peaks[side].max(to);
        after
    }

    fn pass_zero(&mut self, side: usize, zero: f64) {
        let Self { parameters, work, .. } = self;
        let unit = parameters.endurance * parameters.yield_force * parameters.yield_displacement;
        self.strength = exp(-work.max(0.0) / unit);
        self.zeros[side] = zero;
    }

    fn unloading_slope(&self) -> f64 {
        let PeakOrientedParameters { yield_force, yield_displacement, unloading, .. } = self.parameters;
        let largest = self.peaks[0].max(self.peaks[1]);
        yield_force / yield_displacement * powf(yield_displacement / largest, unloading)
    }

    /// Force of the envelope at a displacement in the direction of loading.
    fn envelope(&self, x: f64) -> f64 {
        let values = &self.parameters;
        let stiffness = values.yield_force / values.yield_displacement;
        let hardening = values.yield_force + values.hardening * stiffness * (x - values.yield_displacement);
        let cap = values.capping * values.yield_displacement;
        let softening = values.yield_force - values.softening * stiffness * (x - cap);
        let force = (stiffness * x).min(hardening).min(softening);
        self.strength * if x > cap { force.max(RESIDUAL * values.yield_force) } else { force }
    }

    /// Largest force at a displacement in the direction of loading.
    fn bound(&self, side: usize, x: f64) -> f64 {
        let (peak, zero) = (self.peaks[side], self.zeros[side]);
        if x >= peak || zero >= peak {
            return self.envelope(x);
        }
        let PeakOrientedParameters { pinching, break_place, .. } = self.parameters;
        let (top, share) = (self.envelope(peak), (x - zero) / (peak - zero));
        let low = pinching * break_place;
        let broken = if share < break_place {
            pinching * share
        } else {
            low + (1.0 - low) * (share - break_place) / (1.0 - break_place)
        };
        top * broken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(pinching: f64, endurance: f64) -> PeakOriented {
        PeakOriented::new(PeakOrientedParameters {
            yield_force: 100.0,
            yield_displacement: 10.0,
            hardening: 0.05,
            capping: 1e9,
            softening: 1.0,
            unloading: 0.0,
            pinching,
            break_place: 0.5,
            endurance,
        })
    }

    fn run(member: &mut PeakOriented, turning: &[f64]) -> Vec<f64> {
        turning.iter().map(|&x| member.step(x)).collect()
    }

    /// By hand: yields at 100, hardens by 0.5 kN/mm, unloads with 10 kN/mm, aims at the other yield point
    /// from (9.5, 0) and later at the peak.
    #[test]
    fn clough_s_member_by_hand() {
        let f = run(&mut member(1.0, f64::INFINITY), &[10.0, 20.0, 9.5, 4.625, -10.0, -20.0]);
        let expected = [100.0, 105.0, 0.0, -25.0, -100.0, -105.0];
        for (f, expected) in f.iter().zip(expected) {
            assert!((f - expected).abs() < 1e-9, "{f} {expected}");
        }
    }

    /// Reloading is at `g` times the straight line's force at the break.
    #[test]
    fn pinching_breaks_the_way_to_the_peak() {
        let turning = [20.0, 9.5, -10.0, 0.0];
        let mut straight = member(1.0, f64::INFINITY);
        let mut pinched = member(0.4, f64::INFINITY);
        run(&mut straight, &turning);
        run(&mut pinched, &turning);
        // From (0, 0) up to (20, 105), half way:
        assert!((straight.step(10.0) - 52.5).abs() < 1e-9);
        assert!((pinched.step(10.0) - 0.4 * 52.5).abs() < 1e-9);
        assert!((pinched.step(20.0) - 105.0).abs() < 1e-9);
    }

    /// The work of a force that runs straight, and what it leaves of the strength.
    #[test]
    fn strength_falls_with_the_work_done() {
        let mut member = member(1.0, 2.0);
        run(&mut member, &[10.0, 20.0]);
        // Triangle, trapezium, and back along 10 kN/mm to 0.
        let work = 500.0 + 1025.0 - 0.5 * 10.5 * 105.0;
        let f = run(&mut member, &[9.5, -10.0]);
        assert!((f[1] + 100.0 * exp(-work / 2000.0f64)).abs() < 1e-9, "{f:?}");
    }
}
