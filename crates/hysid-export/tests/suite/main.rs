//! Exported models, compiled and run by the tools of their targets, in one test program.

mod interpreter;
mod models;
mod targets;
