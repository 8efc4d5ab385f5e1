//! Fonts of drawings: the families that are asked for, and the first of them that this machine has.

use std::sync::Arc;

use anyhow::{Result, bail};
use resvg::usvg::fontdb::{Database, Family, Query};

use crate::messages::note;
use crate::terminal::clipped;

/// Families to which a general name stands, the preferred one first.
const SANS_SERIF: [&str; 6] =
    ["Arial", "Helvetica", "Liberation Sans", "Nimbus Sans", "DejaVu Sans", "Noto Sans"];
const SERIF: [&str; 6] =
    ["Times New Roman", "Times", "Liberation Serif", "Nimbus Roman", "DejaVu Serif", "Noto Serif"];

/// The families for a name, in the order in which they are tried.
fn families(name: &str) -> Vec<&str> {
    match name.to_ascii_lowercase().as_str() {
        "sans-serif" => SANS_SERIF.to_vec(),
        "serif" => SERIF.to_vec(),
        _ => vec![name],
    }
}

/// The families as a style sheet lists them, for programs that choose for themselves.
pub fn as_style(name: &str) -> String {
    let general = if name.eq_ignore_ascii_case("serif") { "serif" } else { "sans-serif" };
    let list = families(name).into_iter().chain([general]);
    list.map(|family| family.replace(['\'', ',', ';'], " ")).collect::<Vec<_>>().join(", ")
}

/// All fonts of this machine, and the family in which text is drawn.
pub fn found(name: &str) -> Result<(Arc<Database>, String)> {
    let mut fonts = Database::new();
    fonts.load_system_fonts();
    let has = |family: &str| {
        fonts.query(&Query { families: &[Family::Name(family)], ..Query::default() }).is_some()
    };
    let general = SANS_SERIF.into_iter().chain(SERIF);
    let found = families(name).into_iter().chain(general).find(|family| has(family)).map(String::from);
    let any = || Some(fonts.faces().next()?.families.first()?.0.clone());
    let Some(family) = found.or_else(any) else {
        bail!(
            "PDF and PNG need a font, and this machine has none: install one (on Debian: apt install fonts-dejavu-core), \
             or name a file that ends in .svg"
        );
    };
    if !families(name).contains(&family.as_str()) {
        note(format_args!("the font {} is not installed: the text is in {family}", clipped(name)));
    }
    Ok((Arc::new(fonts), family))
}
