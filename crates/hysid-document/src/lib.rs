//! Documents made of typed parts, and one renderer for each format: [`html`], [`markdown`] and [`plain`]
//! text.
//!
//! A [`Page`] is a title and its [`Part`]s: headings, paragraphs of [`Text`], lists, [`Table`]s of typed
//! [`Cell`]s, and [`Chart`]s, which are data until a renderer draws them. Parts contain plain text; each
//! renderer escapes what its format requires.
//!
//! ```
//! use hysid_document::{Page, Part, Table, html, plain};
//!
//! let mut table = Table::new(["model", "error (%)"]);
//! table.push([("pnn & others").into(), 1.25.into()]);
//! let page = Page { title: "Models".into(), parts: vec![Part::section("Errors", [Part::Table(table)])] };
//! assert!(html::page(&page, html::BEGINNING).contains("<th scope=\"row\">pnn &amp; others</th><td>1.25</td>"));
//! assert_eq!(plain::rendered(&page.parts), "Errors\n\nmodel         error (%)\npnn & others       1.25\n");
//! ```

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]

pub mod chart;
pub mod convergence;
mod escape;
mod face;
pub mod html;
mod json;
pub mod markdown;
pub mod number;
mod part;
pub mod plain;
mod problem;
pub mod progress;
pub mod shell;
mod table;
mod text;
pub mod unit;
pub mod visible;

#[cfg(test)]
mod balance;

pub use chart::{Axis, Chart, Colour, Curve, Label};
pub use face::Face;
pub use json::{is_nothing, json};
pub use number::{capitalised, count, number, span};
pub use part::{Card, Item, Page, Part};
pub use problem::{Problem, Result, TablePlace};
pub use table::{Cell, Table};
pub use text::{Badge, Piece, Text};
