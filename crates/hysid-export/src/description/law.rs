//! Classical laws, one a file. Each writes the operations of its law in `hysid_core::law`, in their order.

mod bouc_wen;
mod duhem_nn;
mod dynamic_prandtl_ishlinskii;
mod generalized_prandtl_ishlinskii;
mod hysteretic_dynamics;
mod jiles_atherton;
mod lugre;
mod masing;
mod menegotto_pinto;
mod modified_prandtl_ishlinskii;
mod neuro_madelung;
mod peak_oriented;
mod prandtl_ishlinskii;
mod preisach;
mod rate_dependent_prandtl_ishlinskii;
mod tanh_layer;
mod turning_points;
mod yield_curve;

use hysid_core::law::Classical;

use crate::description::PartInputs;
use crate::program::Builder;
use crate::program::expression::Real;

/// Writes a step of a law. The sample is in the user's units; the result is the output in its unit.
pub(super) fn step(builder: &mut Builder, name: &str, law: &Classical, sample: &PartInputs) -> Real {
    match law {
        Classical::BoucWen(law) => bouc_wen::step(builder, name, law, sample),
        Classical::DuhemNn(law) => duhem_nn::step(builder, name, law, sample),
        Classical::DynamicPrandtlIshlinskii(law) => {
            dynamic_prandtl_ishlinskii::step(builder, name, law, sample)
        }
        Classical::GeneralizedPrandtlIshlinskii(law) => {
            generalized_prandtl_ishlinskii::step(builder, name, law, sample)
        }
        Classical::HystereticOscillator(law) => hysteretic_dynamics::step(builder, name, &law.0, sample),
        Classical::HystereticStateSpace(law) => hysteretic_dynamics::step(builder, name, &law.0, sample),
        Classical::JilesAtherton(law) => jiles_atherton::step(builder, name, law, sample),
        Classical::Lugre(law) => lugre::step(builder, name, law, sample),
        Classical::Masing(law) => masing::step(builder, name, law, sample),
        Classical::MenegottoPinto(law) => menegotto_pinto::step(builder, name, law, sample),
        Classical::ModifiedPrandtlIshlinskii(law) => {
            modified_prandtl_ishlinskii::step(builder, name, law, sample)
        }
        Classical::NeuroMadelung(law) => neuro_madelung::step(builder, name, law, sample),
        Classical::PeakOriented(law) => peak_oriented::step(builder, name, law, sample),
        Classical::PrandtlIshlinskii(law) => prandtl_ishlinskii::step(builder, name, law, sample),
        Classical::Preisach(law) => preisach::step(builder, name, law, sample),
        Classical::RateDependentPrandtlIshlinskii(law) => {
            rate_dependent_prandtl_ishlinskii::step(builder, name, law, sample)
        }
    }
}
