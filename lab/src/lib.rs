//! Generated cases, which commands and tests of the laboratory share.

pub mod generated;
