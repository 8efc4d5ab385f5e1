//! Whether a text is a drawing as [`super::Chart::svg`] makes them, and nothing else: one that was stored in a file may
//! have been changed there, and goes into a page as it is.

/// Elements of a drawing.
const ELEMENTS: [&str; 7] = ["svg", "circle", "line", "polygon", "polyline", "rect", "text"];

/// Their attributes, of which none runs script or loads anything.
const ATTRIBUTES: [&str; 26] = [
    "aria-label",
    "class",
    "cx",
    "cy",
    "dx",
    "dy",
    "font-family",
    "font-size",
    "font-style",
    "font-weight",
    "height",
    "opacity",
    "points",
    "r",
    "role",
    "stroke-width",
    "text-anchor",
    "transform",
    "viewBox",
    "width",
    "x",
    "x1",
    "x2",
    "y",
    "y1",
    "y2",
];

/// True for a drawing with the elements and attributes that the drawing library writes.
pub fn is_drawing(text: &str) -> bool {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text;
    let mut is_begun = false;
    while let Some((before, after)) = rest.split_once('<') {
        // Text stands within the drawing only.
        if before.contains('>') || open.is_empty() && !before.trim().is_empty() {
            return false;
        }
        let Some((tag, behind)) = after.split_once('>') else { return false };
        rest = behind;
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name.trim_end()) {
                return false;
            }
            continue;
        }
        let (tag, is_empty) = tag.strip_suffix('/').map_or((tag, false), |tag| (tag, true));
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        let is_root = open.is_empty();
        if !ELEMENTS.contains(&name) || is_root != (name == "svg") || is_root && is_begun {
            return false;
        }
        if !are_attributes(attributes) {
            return false;
        }
        is_begun = true;
        if !is_empty {
            open.push(name);
        }
    }
    is_begun && open.is_empty() && rest.trim().is_empty()
}

/// Attributes with values in double quotes, separated by blanks.
fn are_attributes(text: &str) -> bool {
    let mut rest = text.trim();
    while !rest.is_empty() {
        let Some((name, after)) = rest.split_once("=\"") else { return false };
        let Some((value, behind)) = after.split_once('"') else { return false };
        if !is_attribute(name, value) || !(behind.is_empty() || behind.starts_with(' ')) {
            return false;
        }
        rest = behind.trim_start();
    }
    true
}

fn is_attribute(name: &str, value: &str) -> bool {
    match name {
        "fill" | "stroke" => value == "none" || is_colour(value),
        "xmlns" => value == "http://www.w3.org/2000/svg",
        _ => ATTRIBUTES.contains(&name),
    }
}

fn is_colour(value: &str) -> bool {
    let digits = value.strip_prefix('#');
    digits.is_some_and(|digits| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
}
