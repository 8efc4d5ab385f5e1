//! The line of progress of a long computation: what fits into a terminal, and a remaining time that never rises.

mod line;
mod remaining;

pub use line::Line;
pub use remaining::{Remaining, in_words, share_done};
