//! Bouc-Wen laws: `BoucWen` and `BWBN`.
//!
//! ```text
//! native:  stress = α k_o ε + (1 - α) k_o z,   dz = [A - |z|^n (γ + β sgn(z dε))]/η dε
//! ours:    y - c0 = α k x + (1 - α) k z,       z in yield displacements z_u           theory.md (8.4) to (8.11)
//! ```
//!
//! So `β = b/z_u^n` and `γ = (1 - b)/z_u^n`. The native energy is in the unit of work, ours in `(1 - α) k z_u²`.

use hysid_core::elementary::powf;
use hysid_core::law::bouc_wen::{BoucWen, Degradation};

use super::{Argument, Command, NativeLaw};

const AGREEMENT: &str = "The law is the same. OpenSees advances it by one implicit step for each change of strain, so its \
                         stress approaches that of this model as the steps become small";

/// Tolerance and iterations of the implicit steps of `BWBN`.
const TOLERANCE: f64 = 1e-10;
const ITERATIONS: u32 = 100;

pub(super) fn native(law: &BoucWen) -> Result<NativeLaw, String> {
    if law.damping != 0.0 {
        return Err("its damping (c) belongs to the rate in the data, and the native law has none".into());
    }
    let stiffness = law.stiffness();
    if stiffness == 0.0 {
        return Err("its initial stiffness is 0, which the native law divides by".into());
    }
    let exponent = powf(law.yield_displacement, law.n);
    let common = [
        ("alpha", law.alpha()),
        ("ko", stiffness),
        ("n", law.n),
        ("gamma", (1.0 - law.b) / exponent),
        ("beta", law.b / exponent),
        ("Ao", 1.0),
    ];
    let energy = law.hysteretic_stiffness * law.yield_displacement * law.yield_displacement;
    let command = match law.degradation {
        Some(degradation) if degradation.zeta_s != 0.0 => {
            let pinching = pinching(law, &degradation, energy)?;
            let mut command = Command::new("BWBN", common.into_iter().chain(pinching));
            command.arguments.extend([
                Argument::Number { name: "tolerance", value: TOLERANCE },
                Argument::Count { name: "iterations", value: ITERATIONS },
            ]);
            command
        }
        degradation => {
            let deltas = degradation.map_or([0.0; 3], |degradation| {
                [degradation.delta_a, degradation.delta_nu, degradation.delta_eta]
            });
            let names = ["deltaA", "deltaNu", "deltaEta"];
            let degrading = names.into_iter().zip(deltas.map(|delta| delta / energy));
            Command::new("BoucWen", common.into_iter().chain(degrading))
        }
    };
    Ok(NativeLaw { commands: vec![command], agreement: AGREEMENT, offset: law.offset })
}

/// Pinching, which the native law has without degradation of strength and stiffness.
fn pinching(
    law: &BoucWen,
    degradation: &Degradation,
    energy: f64,
) -> Result<[(&'static str, f64); 6], String> {
    let Degradation { delta_a, delta_nu, delta_eta, zeta_s, p, q, psi_0, delta_psi, lambda } = *degradation;
    if [delta_a, delta_nu, delta_eta] != [0.0; 3] {
        return Err(
            "it has both pinching and degradation; of the native laws, BoucWen has no pinching and BWBN no \
                    degradation of strength and stiffness"
                .into(),
        );
    }
    let z_u = law.yield_displacement;
    Ok([
        ("q", q),
        ("zetas", zeta_s),
        ("p", p / energy),
        ("Shi", psi_0 * z_u),
        ("deltaShi", delta_psi * z_u / energy),
        ("lambda", lambda),
    ])
}
