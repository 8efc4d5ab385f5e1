//! A mass on a spring and a damper, driven by the input, beside a part of the output that follows the input at once,
//! theory.md (10.28):
//!
//! ```text
//! y = z + D u + c,    z'' + 2 ζ ω z' + ω² z = ω² K u,    ω = 2 π f
//! ```
//!
//! Between rows the input is a straight line, for which the response is exact, whatever the step.

use std::f64::consts::TAU;

use hysid_core::elementary::{exp, sin_cos};

use super::excerpt::ComparedSignal;

/// A linear oscillator as fitted to data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearOscillator {
    /// Natural frequency `f` without damping, in cycles per unit of time.
    pub natural_frequency: f64,
    /// Share `ζ` of the critical damping, below 1.
    pub damping_ratio: f64,
    /// Output of the oscillator for each unit of the input at rest, `K`.
    pub gain: f64,
    /// Output that follows the input at once, for each unit of it, `D`.
    pub direct: f64,
    /// Output at rest under zero input, `c`. Not determined if changes were compared; do not use it then.
    pub offset: f64,
    /// Signal compared with the oscillator: the output or its changes from row to row.
    pub compared: ComparedSignal,
    /// Root mean square error of a free run, in the unit of the output: of the output or of its changes, see `compared`.
    pub residual: f64,
}

/// One time step of an oscillator whose gain is 1. Its state is its distance `z - u` from where it would rest, and its
/// speed `z'/ω`.
#[derive(Debug, Clone, Copy)]
pub(super) struct OscillatorStep {
    matrix: [[f64; 2]; 2],
    /// `ω` times the time step.
    angle: f64,
    damping_ratio: f64,
}

impl OscillatorStep {
    /// Of a frequency in cycles per unit of time, a damping ratio below 1, and a duration in units of time.
    pub fn new(natural_frequency: f64, damping_ratio: f64, duration: f64) -> Self {
        let angle = TAU * natural_frequency * duration;
        let damped = (1.0 - damping_ratio * damping_ratio).sqrt();
        let fades = exp(-damping_ratio * angle);
        let (sine, cosine) = sin_cos(damped * angle);
        let (sine, cosine) = (fades * sine / damped, fades * cosine);
        let turn = damping_ratio * sine;
        Self { matrix: [[cosine + turn, sine], [-sine, cosine - turn]], angle, damping_ratio }
    }

    /// The state a step later, without input.
    #[inline(always)]
    fn free(&self, [distance, speed]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.matrix;
        [a * distance + b * speed, c * distance + d * speed]
    }

    /// The state a step later, while the input changes at a constant rate by `change`. For such an input
    /// `z - u = -2 ζ u'/ω`, `z' = u'` is a motion of the oscillator; the difference to it fades freely.
    #[inline(always)]
    fn driven(&self, [distance, speed]: [f64; 2], change: f64) -> [f64; 2] {
        let rate = change / self.angle;
        let lag = 2.0 * self.damping_ratio * rate;
        let [distance, speed] = self.free([distance + lag, speed - rate]);
        [distance - lag, speed + rate]
    }

    /// Distances `z - u` row by row, from rest at the first input.
    pub fn response(&self, input: &[f64], response: &mut Vec<f64>) {
        let mut state = [0.0; 2];
        let mut before = input.first().copied().unwrap_or(0.0);
        response.clear();
        response.extend(input.iter().map(|&x| {
            state = self.driven(state, x - before);
            before = x;
            state[0]
        }));
    }

    /// Free motion over a number of rows, from a distance and a speed.
    pub fn decay(&self, mut state: [f64; 2], rows: usize, decay: &mut Vec<f64>) {
        decay.clear();
        decay.extend((0..rows).map(|_| {
            let distance = state[0];
            state = self.free(state);
            distance
        }));
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    const F: f64 = 0.7;
    const ZETA: f64 = 0.15;
    const STEP: f64 = 0.23;

    fn times() -> impl Iterator<Item = f64> {
        (0..60).map(|row| f64::from(row) * STEP)
    }

    /// `e^(-ζ ω t)` times sine and cosine of the damped motion.
    fn damped(t: f64) -> (f64, f64) {
        let omega = TAU * F;
        let (sine, cosine) = sin_cos(omega * (1.0 - ZETA * ZETA).sqrt() * t);
        let fades = exp(-ZETA * omega * t);
        (fades * sine, fades * cosine)
    }

    #[test]
    fn free_motion_is_the_damped_cosine() {
        let mut decay = Vec::new();
        OscillatorStep::new(F, ZETA, STEP).decay([1.0, 0.0], 60, &mut decay);
        for (t, value) in times().zip(decay) {
            let (sine, cosine) = damped(t);
            let exact = cosine + ZETA / (1.0 - ZETA * ZETA).sqrt() * sine;
            assert!((value - exact).abs() < 1e-13, "{t}: {value} {exact}");
        }
    }

    #[test]
    fn the_response_to_a_ramp_is_exact() {
        // u = t from rest: z = t - 2ζ/ω + (2ζ/ω) cosine + (2ζ² - 1)/ω_d sine, damped.
        let input: Vec<f64> = times().collect();
        let mut response = Vec::new();
        OscillatorStep::new(F, ZETA, STEP).response(&input, &mut response);
        let omega = TAU * F;
        for (t, value) in times().zip(response) {
            let (sine, cosine) = damped(t);
            let lag = 2.0 * ZETA / omega;
            let over = (2.0 * ZETA * ZETA - 1.0) / (omega * (1.0 - ZETA * ZETA).sqrt());
            assert!((value - (lag * cosine + over * sine - lag)).abs() < 1e-13, "{t}: {value}");
        }
    }

    #[test]
    fn a_sine_at_resonance_is_amplified_by_half_the_inverse_damping() {
        let step = 1.0 / (F * 200.0);
        let input: Vec<f64> = (0..8000).map(|row| sin(TAU * F * f64::from(row) * step)).collect();
        let mut response = Vec::new();
        OscillatorStep::new(F, ZETA, step).response(&input, &mut response);
        let largest =
            response[7000..].iter().zip(&input[7000..]).map(|(z, u)| (z + u).abs()).fold(0.0, f64::max);
        // Straight lines between rows make the input smaller by 8e-5.
        assert!((largest * 2.0 * ZETA - 1.0).abs() < 2e-4, "{largest}");
    }
}
