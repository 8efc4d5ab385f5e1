//! Phase transformation of a shape-memory wire: the cosine law of Liang and Rogers.
//!
//! ```text
//! heating, A_s < T < A_f:   ξ = ξ_h g((T - A_s)/(A_f - A_s))                theory.md (6.35)
//! cooling, M_f < T < M_s:   1 - ξ = (1 - ξ_c) g((M_s - T)/(M_s - M_f)),     g(s) = (1 + cos πs)/2
//! y = Y (1 - ξ) + θ T                                                       theory.md (6.36)
//! ```
//!
//! `ξ` is the fraction of martensite, 1 when cold; `T` the temperature in °C, `y` the stroke in mm. `ξ_h` and
//! `ξ_c` are such that a branch begins where the last one ended. `ξ` is constant between the transformations.
//! Source: Liang and Rogers (1990), without stress. *Designed*: the values, and the stroke.

use std::f64::consts::PI;

use hysid_core::elementary::cos;

/// Values of a wire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PhaseTransformationParameters {
    /// `A_s`, `A_f` in °C: where heating begins and ends the transformation.
    pub austenite: (f64, f64),
    /// `M_s`, `M_f` in °C: where cooling begins and ends it; `M_s > M_f`.
    pub martensite: (f64, f64),
    /// `Y` in mm.
    pub stroke: f64,
    /// `θ` in mm/°C.
    pub expansion: f64,
}

/// A wire with its memory, cold at first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PhaseTransformation {
    parameters: PhaseTransformationParameters,
    temperature: f64,
    martensite: f64,
}

impl PhaseTransformation {
    pub fn new(parameters: PhaseTransformationParameters) -> Self {
        Self { parameters, temperature: f64::NEG_INFINITY, martensite: 1.0 }
    }

    /// The stroke in mm at the next temperature in °C; how many steps lead there does not matter.
    pub fn step(&mut self, temperature: f64) -> f64 {
        let PhaseTransformationParameters { austenite, martensite, stroke, expansion } = self.parameters;
        if temperature > self.temperature {
            self.martensite *= left(self.temperature, temperature, austenite);
        } else {
            let austenite_left = left(self.temperature, temperature, martensite);
            self.martensite = 1.0 - (1.0 - self.martensite) * austenite_left;
        }
        self.temperature = temperature;
        stroke * (1.0 - self.martensite) + expansion * temperature
    }
}

/// What a transformation from `start` to `finish` leaves of the phase on the way from one temperature to
/// another.
fn left(from: f64, to: f64, (start, finish): (f64, f64)) -> f64 {
    let remaining = |temperature: f64| {
        let progress = ((temperature - start) / (finish - start)).clamp(0.0, 1.0);
        0.5 * (1.0 + cos(PI * progress))
    };
    let before = remaining(from);
    if before > 0.0 { remaining(to) / before } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wire() -> PhaseTransformation {
        PhaseTransformation::new(PhaseTransformationParameters {
            austenite: (60.0, 80.0),
            martensite: (50.0, 30.0),
            stroke: 4.0,
            expansion: 0.0,
        })
    }

    #[test]
    fn full_and_partial_transformation_by_hand() {
        let mut wire = wire();
        let stroke = [20.0, 60.0, 70.0, 80.0, 50.0, 40.0, 30.0].map(|t| wire.step(t));
        for (y, expected) in stroke.into_iter().zip([0.0, 0.0, 2.0, 4.0, 4.0, 2.0, 0.0]) {
            assert!((y - expected).abs() < 1e-12, "{stroke:?}");
        }
        // Half heated, half of that cooled: a quarter of the stroke is left.
        let partial = [70.0, 55.0, 40.0].map(|t| wire.step(t));
        for (y, expected) in partial.into_iter().zip([2.0, 2.0, 1.0]) {
            assert!((y - expected).abs() < 1e-12, "{partial:?}");
        }
    }

    #[test]
    fn a_path_may_be_cut_into_any_steps() {
        let turning = [20.0, 71.0, 38.0, 66.0, 33.0, 90.0];
        let (mut coarse, mut fine) = (wire(), wire());
        let mut from = 20.0;
        for to in turning {
            let y = coarse.step(to);
            let last = (1..=37).map(|k| fine.step(from + (to - from) * f64::from(k) / 37.0)).last();
            assert!((last.unwrap() - y).abs() < 1e-12);
            from = to;
        }
    }
}
