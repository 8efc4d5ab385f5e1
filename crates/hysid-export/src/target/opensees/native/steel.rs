//! Menegotto-Pinto laws: `Steel02`.
//!
//! ```text
//! native:  σ = b E ε + (1 - b) F_y q,    R = R_0 {1 - cR_1 ξ/(cR_2 + ξ)},    F_y {1 + a_3 [(ε_max - ε_min)/(2 a_4 ε_y)]^0.8}
//! ours:    y - c0 = k x + F q            theory.md (8.47) to (8.50)
//! ```
//!
//! So `E = k + F/x_y`, `b = k/E` and `F_y = E x_y`. `a_1` and `a_2` of the native law are the hardening in compression.

use hysid_core::law::menegotto_pinto::MenegottoPinto;

use super::{Command, NativeLaw};

const AGREEMENT: &str = "Between turning points the law is the same, at steps of any size. After a short unloading `Steel02` \
                         runs above the branch that it left, and this model joins that branch; the yield stress of this \
                         model is at least a tenth of the first one";

pub(super) fn native(law: &MenegottoPinto) -> Result<NativeLaw, String> {
    let down = law.down.map_or(law.isotropic, |down| down.isotropic);
    if law.down.is_some_and(|down| down.ratio != 1.0) {
        return Err("its first yield stresses differ upwards and downwards, and Steel02 has one".into());
    }
    let modulus = law.hardening_stiffness + law.strength / law.yield_displacement;
    if modulus.is_nan() || modulus <= 0.0 || law.strength <= 0.0 {
        return Err("its elastic modulus or its strength is not positive".into());
    }
    let arguments = [
        ("Fy", modulus * law.yield_displacement),
        ("E", modulus),
        ("b", law.hardening_stiffness / modulus),
        ("R0", law.roundness),
        ("cR1", law.loss),
        ("cR2", law.pace),
        ("a1", down),
        ("a2", 1.0),
        ("a3", law.isotropic),
        ("a4", 1.0),
    ];
    let commands = vec![Command::new("Steel02", arguments)];
    Ok(NativeLaw { commands, agreement: AGREEMENT, offset: law.offset })
}
