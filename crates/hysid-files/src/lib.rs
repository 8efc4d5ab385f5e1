//! How the program `hysid` and its Python package write files, and other services of the system that both use.
//!
//! - **Atomic.** A file is written beside its target, synced and renamed: the target is complete or as it was.
//! - **Only over its own files.** A file that Hysid did not write is not replaced, unless that is asked for. A model
//!   that is replaced is kept as `NAME.bak`.
//! - **As the user arranged it.** Links are followed, owner and permissions of the old file are kept, and devices and
//!   pipes are written through.
//!
//! A [`Destination`] is a path together with the [`Kind`] of file that goes there.

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]

mod available_memory;
mod backup;
mod destination;
mod failure;
mod folder;
mod kind;
mod leftovers;
mod lock;
mod reading;
mod rescue;
mod seal;
mod target;
mod temporary;

pub use available_memory::available_memory;
pub use destination::Destination;
pub use destination::NewFile;
pub use failure::{Failure, reason};
pub use folder::Folder;
pub use kind::{GENERATOR, Kind, PAGE_MARK, is_page_as_written, with_page_sum};
pub use leftovers::remove_leftovers;
pub use lock::Lock;
pub use reading::{checksum, open, read, read_from, unreadable};
pub use rescue::rescue;
