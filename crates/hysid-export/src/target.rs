//! The targets, one a file: each writes programs in its language.

pub mod c;
