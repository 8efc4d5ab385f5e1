//! The experiments of the paper on Prandtl and Preisach neural networks, each a [`Chapter`] of text, tables and charts. The
//! measured data of the paper are not public: synthetic specimens stand in for them, and every heading says so.
//!
//! An [`Experiment`] has no clock, no terminal and no files: whoever runs it gives it an [`Observer`], and renders and
//! stores what it comes to.
//!
//! ```
//! use hysid_paper::{Experiment, Observer, Settings};
//!
//! struct Silent;
//!
//! impl Observer for Silent {
//!     fn clock(&self) -> std::time::Duration {
//!         std::time::Duration::ZERO
//!     }
//!     fn is_stopped(&self) -> bool {
//!         false
//!     }
//!     fn say(&self, _: &str) {}
//! }
//!
//! let nds = Experiment::named("nds").unwrap();
//! let chapter = nds.chapter(Settings { seed: 1, quick: true }, &Silent).unwrap();
//! assert!(chapter.verdict.contains("One neuron makes static, rate-dependent and deteriorating loops"));
//! ```

mod chapter;
mod conditions;
mod example;
mod experiment;
mod fitting;
mod nds;
mod spread;
mod table2;
mod training;

pub use chapter::{Chapter, ChapterTarget, Content, FurtherFile, TargetSource, TargetVerdict, targets};
pub use conditions::{Observer, Settings};
pub use experiment::Experiment;
