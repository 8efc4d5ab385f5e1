//! Text of files and arguments as a terminal shows it: nothing in it moves the cursor, and nothing is endless.

pub use hysid_document::json;
pub use hysid_document::visible::{clipped, line, listed, visible};
