//! The studio: identify hysteresis in the browser, on your own machine.
//!
//! A [`Studio`] is a project in a folder: files with data, how they are read, models, and at most one fit that is under
//! way. A [`Server`] answers the page of this studio on the loopback address of this machine, and nobody else. The page is
//! part of the program, so that it needs no internet.

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]

mod choices;
mod drive;
mod example;
mod fitting;
mod folder;
mod judgement;
mod project;
mod server;
mod shown;
mod studio;
mod take_away;
mod view;
mod words;

pub use folder::Folder;
pub use server::{Ending, Server};
pub use studio::Studio;
