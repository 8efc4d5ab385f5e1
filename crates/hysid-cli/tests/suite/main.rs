//! Tests of the program as its users run it, in one test program.

mod bad_input;
mod bad_requests;
mod checkpoint;
mod column_guesses;
mod commands;
mod compare;
mod cycles;
mod diagnose;
mod doubtful_data;
mod ensemble;
mod export;
mod files;
mod fit_inverse;
mod generate;
mod hostile_text;
#[cfg(unix)]
mod how_to;
mod ignored_options;
mod initial_state;
mod instruments;
mod invert;
mod long_tables;
#[cfg(target_os = "linux")]
mod memory;
mod model_notes;
mod overwriting;
mod plan;
mod plot;
mod printed_output;
mod program;
mod quiet;
mod reproduce;
mod residuals;
mod restoring_force;
mod units;
mod workbench;
