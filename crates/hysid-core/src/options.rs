//! What can be asked for: models by their names, and the options of each. A model file keeps what its model was
//! identified with.

pub mod auto;
mod cautions;
pub mod chosen;
pub mod classical;
pub mod model_name;
pub mod network;
pub mod request;
pub mod shaping;
pub mod table;
pub mod variants;

pub use model_name::ModelName;
pub use request::Request;
