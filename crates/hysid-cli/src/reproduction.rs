//! `hysid reproduce`: runs the paper's experiments, and writes pages and tables of what is finished.

mod outputs;
mod rendering;
mod run;

pub use hysid_paper::Experiment;
pub use outputs::Outputs;
pub use run::run;
