//! `hysid reproduce`: runs the paper's experiments, stores what is finished, and writes pages and tables of it.

mod outputs;
mod rendering;
mod run;
mod storage;

pub use hysid_paper::Experiment;
pub use outputs::Outputs;
pub use run::run;
