//! The paper's experiments, one a file. The measured data of the paper are not public: synthetic
//! specimens stand in for them, and every heading says so.

pub mod training;
