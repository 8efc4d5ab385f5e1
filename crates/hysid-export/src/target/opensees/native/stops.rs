//! Prandtl-Ishlinskii models and models by Masing's rule: a spring and elastic, perfectly plastic materials in parallel.
//!
//! ```text
//! p_r[x] = x - ε_r[x],    so    c + w_0 x + Σ w_i p_{r_i}[x] = c + (w_0 + Σ w_i) x - Σ w_i ε_{r_i}[x]    theory.md (7.4)
//! c + g(x) with Masing's rule = c + Σ_j (m_j - m_{j+1}) ε_{r_j}[x] + m_{n+1} x                            theory.md (7.13)
//! ```
//!
//! The stop `ε_r` is the material `ElasticPP` of modulus 1 and yield strain `r`.

use hysid_core::law::masing::Masing;
use hysid_core::law::prandtl_ishlinskii::PrandtlIshlinskii;

use super::{Argument, Command, NativeLaw};

const AGREEMENT: &str = "It is the same model, at steps of any size";

pub(super) fn of_plays(law: &PrandtlIshlinskii) -> NativeLaw {
    let slope = law.linear() + law.weights().iter().sum::<f64>();
    let stops = law.thresholds().iter().copied().zip(law.weights().iter().map(|weight| -weight));
    in_parallel(law.constant(), slope, stops.collect())
}

pub(super) fn of_masing(law: &Masing) -> NativeLaw {
    let parts = law.parts();
    let slope = parts.slopes.last().copied().unwrap_or_default();
    let weights = parts.slopes.windows(2).map(|pair| pair[0] - pair[1]);
    in_parallel(parts.constant, slope, parts.thresholds.iter().copied().zip(weights).collect())
}

/// A spring of this slope beside stops, each a threshold and a weight.
fn in_parallel(offset: f64, slope: f64, stops: Vec<(f64, f64)>) -> NativeLaw {
    let parts = stops.len() + 1;
    let spring = Command::new("Elastic", [("E", slope)]);
    let stop = |&(threshold, _): &(f64, f64)| Command::new("ElasticPP", [("E", 1.0), ("epsyP", threshold)]);
    let mut parallel = Command::new("Parallel", []);
    parallel.arguments.extend((1..=parts).map(Argument::Part));
    parallel.arguments.push(Argument::Flag("-factors"));
    let factors = std::iter::once(1.0).chain(stops.iter().map(|&(_, weight)| weight));
    parallel.arguments.extend(factors.map(|value| Argument::Number { name: "", value }));
    let commands = std::iter::once(spring).chain(stops.iter().map(stop)).chain([parallel]).collect();
    NativeLaw { commands, agreement: AGREEMENT, offset }
}
