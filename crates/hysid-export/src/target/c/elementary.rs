//! The elementary functions that a model uses, in C: those of [`hysid_core::elementary`], operation by operation.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::program::Precision;
use crate::program::expression::{Binary, Unary};
use crate::program::uses::Uses;

/// A part of `elementary.c.txt`.
struct Section {
    name: &'static str,
    needs: Vec<&'static str>,
    text: &'static str,
}

/// All parts, each behind those that it needs.
fn sections() -> Vec<Section> {
    include_str!("elementary.c.txt")
        .split("@@ ")
        .skip(1)
        .map(|section| {
            let (head, text) = section.split_once('\n').expect("a line with the name");
            let (name, needs) = head.split_once(": ").unwrap_or((head, ""));
            Section { name, needs: needs.split_whitespace().collect(), text }
        })
        .collect()
}

/// Name of a section, and of its function behind `hysid_`.
fn of_unary(function: Unary) -> Option<&'static str> {
    Some(match function {
        Unary::Exp => "exp",
        Unary::ExpMinusOne => "exp_m1",
        Unary::Ln => "ln",
        Unary::LnOnePlus => "ln_1p",
        Unary::Tanh => "tanh",
        Unary::InverseSinh => "asinh",
        _ => return None,
    })
}

/// The same of functions of two numbers.
fn of_binary(function: Binary) -> Option<&'static str> {
    match function {
        Binary::Power => Some("powf"),
        Binary::Hypotenuse => Some("hypot"),
        _ => None,
    }
}

/// The functions that programs use, and what those need.
pub(super) fn functions(uses: &Uses, precision: Precision) -> String {
    let unary = uses.unary.iter().filter_map(|function| of_unary(*function));
    let binary = uses.binary.iter().filter_map(|function| of_binary(*function));
    let (unary, binary): (Vec<_>, Vec<_>) = (unary.collect(), binary.collect());
    let mut text = text_of(unary.iter().chain(&binary).copied());
    if precision == Precision::Single {
        for name in unary {
            let _ = writeln!(
                text,
                "static real hysid_{name}_single(real a)\n{{\n    return (real)hysid_{name}((double)a);\n}}\n"
            );
        }
        for name in binary {
            let _ = writeln!(
                text,
                "static real hysid_{name}_single(real a, real b)
{{
    return (real)hysid_{name}((double)a, (double)b);
}}
"
            );
        }
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
