//! The elementary functions that a model uses, in C: those of [`hysid_core::elementary`], operation by operation.

use std::collections::BTreeSet;

use crate::program::Precision;
use crate::program::expression::{Binary, Unary};
use crate::program::uses::Uses;

/// A part of `elementary.c.txt`.
struct SourceSection {
    name: &'static str,
    needs: Vec<&'static str>,
    text: &'static str,
}

/// All parts, each behind those that it needs.
fn sections() -> Vec<SourceSection> {
    include_str!("elementary.c.txt")
        .split("@@ ")
        .skip(1)
        .map(|section| {
            let (head, text) = section.split_once('\n').expect("a line with the name");
            let (name, needs) = head.split_once(": ").unwrap_or((head, ""));
            SourceSection { name, needs: needs.split_whitespace().collect(), text }
        })
        .collect()
}

/// A function that programs use.
pub(super) struct Function {
    section: &'static str,
    /// Its names in double and in single precision.
    names: [&'static str; 2],
}

impl Function {
    pub fn name(&self, precision: Precision) -> &'static str {
        match precision {
            Precision::Double => self.names[0],
            Precision::Single => self.names[1],
        }
    }

    /// The function in single precision: that in double precision, rounded.
    fn in_single_precision(&self, arguments: &[&str]) -> String {
        let [double, single] = self.names;
        let declared: Vec<String> = arguments.iter().map(|argument| format!("real {argument}")).collect();
        let given: Vec<String> = arguments.iter().map(|argument| format!("(double){argument}")).collect();
        format!(
            "static real {single}({})\n{{\n    return (real){double}({});\n}}\n\n",
            declared.join(", "),
            given.join(", ")
        )
    }
}

macro_rules! function {
    ($section:literal) => {
        Function {
            section: $section,
            names: [concat!("hysid_", $section), concat!("hysid_", $section, "_single")],
        }
    };
}

pub(super) fn of_unary(function: Unary) -> Option<Function> {
    Some(match function {
        Unary::Exp => function!("exp"),
        Unary::ExpMinusOne => function!("exp_m1"),
        Unary::Ln => function!("ln"),
        Unary::LnOnePlus => function!("ln_1p"),
        Unary::Tanh => function!("tanh"),
        Unary::InverseSinh => function!("asinh"),
        _ => return None,
    })
}

pub(super) fn of_binary(function: Binary) -> Option<Function> {
    match function {
        Binary::Power => Some(function!("powf")),
        Binary::Hypotenuse => Some(function!("hypot")),
        _ => None,
    }
}

/// The functions that programs use, and what those need.
pub(super) fn functions(uses: &Uses, precision: Precision) -> String {
    let unary: Vec<Function> = uses.unary.iter().filter_map(|function| of_unary(*function)).collect();
    let binary: Vec<Function> = uses.binary.iter().filter_map(|function| of_binary(*function)).collect();
    let mut text = text_of(unary.iter().chain(&binary).map(|function| function.section));
    if precision == Precision::Single {
        text.extend(unary.iter().map(|function| function.in_single_precision(&["a"])));
        text.extend(binary.iter().map(|function| function.in_single_precision(&["a", "b"])));
    }
    text
}

fn text_of(names: impl Iterator<Item = &'static str>) -> String {
    let sections = sections();
    let mut needed: BTreeSet<&str> = names.collect();
    for section in sections.iter().rev() {
        if needed.contains(section.name) {
            needed.extend(&section.needs);
        }
    }
    sections.iter().filter(|section| needed.contains(section.name)).map(|section| section.text).collect()
}

/// All elementary functions of exports to C, for a test against those of `hysid-core`.
pub fn all_elementary_functions() -> String {
    text_of(sections().iter().map(|section| section.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_section_stands_behind_those_that_it_needs() {
        let sections = sections();
        for (place, section) in sections.iter().enumerate() {
            for need in &section.needs {
                assert!(
                    sections[..place].iter().any(|other| other.name == *need),
                    "{need} of {}",
                    section.name
                );
            }
        }
    }
}
