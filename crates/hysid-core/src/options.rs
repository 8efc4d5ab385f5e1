//! Options of a fit: models by their names, and the options of each. A model file contains those of its fit.

mod cautions;
mod checks;
pub mod chosen;
pub mod classical;
pub(crate) mod default_words;
pub mod effort;
mod fields;
pub mod fit_spec;
pub mod input_options;
pub mod model_name;
pub mod network;
pub mod preset;
pub mod table;
pub mod variants;

pub use fit_spec::FitSpec;
pub use model_name::ModelName;
