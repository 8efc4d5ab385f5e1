//! Synthetic earthquakes: white noise, filtered by a layer of soil as Kanai and Tajimi propose, with an envelope.
//!
//! ```text
//! x'' + 2 ζ_g ω_g x' + ω_g² x = -w,   s = -(2 ζ_g ω_g x' + ω_g² x)            theory.md (6.43)
//! a(t) = P s(t) g(t)/max |s g|,   g = (t/t_1)² to t_1, 1 to t_2, then e^{-(t - t_2)/τ}   theory.md (6.44)
//! ```
//!
//! `w` is the acceleration of the rock, white noise that is a straight line between the rows, `x` the displacement of
//! the layer relative to it, `s` the acceleration of its surface and `P` the wanted peak of the ground acceleration `a`.
//!
//! *Published*: the filter and its values for firm soil (Kanai; Tajimi), and the form of the envelope (Jennings, Housner and
//! Tsai). *Designed*: the times of the envelope, the duration and the sampling.

use hysid_core::elementary::{exp, square};

use super::draw::Draw;
use super::runge_kutta;

/// Time from row to row in s.
pub(super) const TIME_STEP: f64 = 0.01;

const ROWS: usize = 3000;

/// `ω_g` in rad/s and `ζ_g`: frequency and damping of the soil.
const SOIL: (f64, f64) = (15.6, 0.6);

/// `t_1`, `t_2` and `τ` of the envelope in s.
const ENVELOPE: (f64, f64, f64) = (3.0, 12.0, 5.0);

/// Steps of the filter from row to row.
const STEPS_PER_ROW: usize = 4;

/// The ground acceleration in m/s² at the rows of an earthquake with this peak in m/s², above 0.
pub(super) fn ground_acceleration(draw: &mut Draw, peak: f64) -> Vec<f64> {
    let rock: Vec<f64> = (0..ROWS).map(|_| draw.normal()).collect();
    let shaped = surface(&rock).into_iter().enumerate().map(|(row, s)| s * envelope(row as f64 * TIME_STEP));
    let shaped: Vec<f64> = shaped.collect();
    let largest = shaped.iter().fold(0.0f64, |largest, s| largest.max(s.abs()));
    shaped.iter().map(|s| peak * s / largest).collect()
}

/// The acceleration of the surface of the soil, which is at rest at first.
fn surface(rock: &[f64]) -> Vec<f64> {
    let (omega, zeta) = SOIL;
    let acceleration = |[x, v]: [f64; 2]| -(2.0 * zeta * omega * v + omega * omega * x);
    let mut state = [0.0; 2];
    let mut surface = vec![0.0];
    for ends in rock.windows(2) {
        for part in 0..STEPS_PER_ROW {
            let rock =
                |share: f64| ends[0] + (ends[1] - ends[0]) * (part as f64 + share) / STEPS_PER_ROW as f64;
            let slope = |share: f64, state: [f64; 2]| [state[1], acceleration(state) - rock(share)];
            state = runge_kutta::step(state, TIME_STEP / STEPS_PER_ROW as f64, slope);
        }
        surface.push(acceleration(state));
    }
    surface
}

fn envelope(t: f64) -> f64 {
    let (rises, falls, decay) = ENVELOPE;
    if t < rises { square(t / rises) } else { exp(-(t - falls).max(0.0) / decay) }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{hypot, sin};

    use super::*;

    #[test]
    fn an_earthquake_has_its_peak_and_begins_and_ends_gently() {
        let ground = ground_acceleration(&mut Draw::new(1, 0), 3.0);
        assert_eq!((ground.len(), ground[0]), (ROWS, 0.0));
        let largest = |rows: std::ops::Range<usize>| ground[rows].iter().fold(0.0f64, |m, a| m.max(a.abs()));
        assert!((largest(0..ROWS) - 3.0).abs() < 1e-12);
        assert!(largest(0..50) < 0.3 && largest(2800..3000) < 0.3);
        assert_ne!(ground, ground_acceleration(&mut Draw::new(2, 0), 3.0));
    }

    /// A sine of the rock reaches the surface with `√((1 + 4ζ²q²)/((1 - q²)² + 4ζ²q²))`, `q = ω/ω_g`.
    #[test]
    fn the_soil_has_the_frequency_response_of_kanai_and_tajimi() {
        let (omega_g, zeta) = SOIL;
        for omega in [6.0f64, 15.6, 40.0] {
            let rock: Vec<f64> = (0..3000).map(|row| sin(omega * TIME_STEP * f64::from(row))).collect();
            let surface = surface(&rock);
            // The amplitude of a sine from its value and its slope.
            let amplitude = |row: usize| {
                let slope = (surface[row + 1] - surface[row - 1]) / (2.0 * sin(omega * TIME_STEP));
                hypot(surface[row], slope)
            };
            let damped = square(2.0 * zeta * omega / omega_g);
            let expected = ((1.0 + damped) / (square(1.0 - square(omega / omega_g)) + damped)).sqrt();
            for row in [2000, 2345, 2990] {
                // The straight lines between the rows flatten the sine by 1 % at 40 rad/s.
                assert!((amplitude(row) / expected - 1.0).abs() < 0.015, "{omega}: {}", amplitude(row));
            }
        }
    }
}
