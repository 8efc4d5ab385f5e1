//! Classical laws, one a file. Each writes the operations of its law in `hysid_core::law`, in their order.

mod bouc_wen;
mod duhem_nn;
mod dynamic_prandtl_ishlinskii;
mod generalized_prandtl_ishlinskii;
mod hysteretic_dynamics;
mod hysteretic_oscillator;
mod hysteretic_state_space;
mod jiles_atherton;
mod lugre;
mod masing;
mod menegotto_pinto;
mod modified_prandtl_ishlinskii;
mod neuro_madelung;
mod peak_oriented;
mod prandtl_ishlinskii;
mod preisach;
mod ramberg_osgood;
mod rate_dependent_prandtl_ishlinskii;
mod tanh_layer;
mod turning_points;
mod yield_curve;

use hysid_core::for_each_law;
use hysid_core::law::Classical;

use crate::description::PartInputs;
use crate::program::Builder;
use crate::program::expression::Real;

macro_rules! step {
    ($($module:ident::$law:ident),* $(,)?) => {
        /// Writes a step of a law. The sample is in the user's units; the result is the output in its unit.
        pub(super) fn step(builder: &mut Builder, name: &str, law: &Classical, sample: &PartInputs) -> Real {
            match law {
                $(Classical::$law(law) => $module::step(builder, name, law, sample),)*
            }
        }
    };
}

for_each_law!(step);
