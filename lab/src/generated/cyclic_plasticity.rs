//! Cyclic plasticity of a metal in one dimension: isotropic hardening after Voce, kinematic hardening after
//! Armstrong and Frederick with several backstresses after Chaboche.
//!
//! ```text
//! σ = E (ε - ε_p),   |σ - Σ α_k| <= σ_y + Q (1 - e^{-b p}),   p' = |ε_p'|   theory.md (6.33)
//! α_k' = C_k ε_p' - γ_k α_k p'                                              theory.md (6.34)
//! ```
//!
//! `ε` is the strain in mm/m, `ε_p` its plastic part, `p` the accumulated plastic strain, `σ` the stress and
//! `α_k` the backstresses in MPa; `E`, `σ_y`, `Q`, `b`, `C_k` and `γ_k` are parameters. `Q < 0` is softening.
//! Published: the equations; a structural steel has `E` = 200 GPa, and `σ_y`, `Q`, `C`, `γ` of the order used
//! here (Voce-Chaboche sets of RESSPyLab).

use hysid_core::elementary::exp;

/// Longest part of the strain moved at once, as a share of the yield strain.
const LONGEST_PART: f64 = 0.02;

/// One backstress, with the strain in mm/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Backstress {
    /// `C` in MPa per mm/m.
    pub modulus: f64,
    /// `γ` in one over mm/m.
    pub recovery: f64,
}

/// Values of a metal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CyclicPlasticityParameters {
    /// `E` in MPa per mm/m, that is, GPa.
    pub modulus: f64,
    /// `σ_y` in MPa.
    pub yield_stress: f64,
    /// `Q` in MPa, above `-σ_y`.
    pub isotropic: f64,
    /// `b` in one over mm/m of plastic strain.
    pub isotropic_rate: f64,
    pub backstresses: Vec<Backstress>,
}

/// A metal with its memory, virgin at first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CyclicPlasticity {
    parameters: CyclicPlasticityParameters,
    strain: f64,
    plastic: f64,
    path: f64,
    /// `α_k` in MPa.
    back: Vec<f64>,
}

impl CyclicPlasticity {
    pub fn new(parameters: CyclicPlasticityParameters) -> Self {
        let back = vec![0.0; parameters.backstresses.len()];
        Self { parameters, strain: 0.0, plastic: 0.0, path: 0.0, back }
    }

    /// The stress in MPa at the next strain in mm/m.
    pub fn step(&mut self, strain: f64) -> f64 {
        let yield_strain = self.parameters.yield_stress / self.parameters.modulus;
        let parts = ((strain - self.strain).abs() / (LONGEST_PART * yield_strain)).ceil().max(1.0);
        let from = self.strain;
        for part in 1..=parts as usize {
            self.flow(from + (strain - from) * part as f64 / parts);
        }
        self.strain = strain;
        self.parameters.modulus * (strain - self.plastic)
    }

    /// Returns a stress beyond the yield surface to it; the parts are so short that its growth is linear.
    fn flow(&mut self, strain: f64) {
        let values = &self.parameters;
        let relative = values.modulus * (strain - self.plastic) - self.back.iter().sum::<f64>();
        let fading = exp(-values.isotropic_rate * self.path);
        let excess = relative.abs() - values.yield_stress - values.isotropic * (1.0 - fading);
        if excess <= 0.0 {
            return;
        }
        let sign = relative.signum();
        let terms = values.backstresses.iter().zip(&self.back);
        let kinematic: f64 = terms.map(|(term, back)| term.modulus - term.recovery * back * sign).sum();
        let isotropic = values.isotropic * values.isotropic_rate * fading;
        let flow = excess / (values.modulus + kinematic + isotropic);
        self.plastic += sign * flow;
        self.path += flow;
        for (term, back) in values.backstresses.iter().zip(&mut self.back) {
            let limit = sign * term.modulus / term.recovery;
            *back = limit + (*back - limit) * exp(-term.recovery * flow);
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::tanh;

    use super::*;

    fn steel(isotropic: f64) -> CyclicPlasticity {
        CyclicPlasticity::new(CyclicPlasticityParameters {
            modulus: 200.0,
            yield_stress: 300.0,
            isotropic,
            isotropic_rate: 0.02,
            backstresses: vec![Backstress { modulus: 10.0, recovery: 0.1 }],
        })
    }

    /// First loading has a solution in closed form: with the plastic strain `p`,
    /// `σ = σ_y + Q (1 - e^{-bp}) + C/γ (1 - e^{-γp})`.
    #[test]
    fn first_loading_is_the_closed_form() {
        let mut steel = steel(80.0);
        for k in 1..=40 {
            let strain = 0.5 * f64::from(k);
            let stress = steel.step(strain);
            let p = strain - stress / 200.0;
            let expected = 300.0 + 80.0 * (1.0 - exp(-0.02 * p)) + 100.0 * (1.0 - exp(-0.1 * p));
            let expected = if strain <= 1.5 { 200.0 * strain } else { expected };
            assert!((stress - expected).abs() < 0.02, "{strain}: {stress} {expected}");
        }
    }

    /// Chaboche's steady cycle: `Δσ/2 = σ_y + C/γ tanh(γ Δε_p/2)`.
    #[test]
    fn the_steady_cycle_is_the_published_one() {
        let mut steel = steel(0.0);
        for _ in 0..20 {
            steel.step(-8.0);
            steel.step(8.0);
        }
        let top = steel.step(8.0);
        let amplitude = 8.0 - top / 200.0;
        let expected = 300.0 + 100.0 * tanh(0.1 * amplitude);
        assert!((top - expected).abs() < 0.02, "{top} {expected}");
    }
}
