//! Dependency circles, found from the source: among the rooms of a crate (its top-level modules), among the parts of a room
//! (its modules), and among the files of the Python package. Test code is not checked.

mod python;
mod rust;

use std::collections::{BTreeMap, BTreeSet};

use anyhow::Result;

use super::{SourceFile, Violation};

/// Where a room uses another one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    path: String,
    line: usize,
}

/// Which room uses which, and where it does so first.
#[derive(Debug, Default, PartialEq, Eq)]
struct Uses(BTreeMap<String, BTreeMap<String, Place>>);

impl Uses {
    fn add(&mut self, from: &str, to: &str, place: Place) {
        if from == to {
            return;
        }
        let first = self.0.entry(from.into()).or_default().entry(to.into()).or_insert_with(|| place.clone());
        if place < *first {
            *first = place;
        }
    }

    /// Removes uses of anything that is not one of the rooms.
    fn keep(&mut self, rooms: &BTreeSet<String>) {
        for of_room in self.0.values_mut() {
            of_room.retain(|to, _| rooms.contains(to));
        }
    }

    /// The rooms on the shortest way from a room to another one, both included.
    fn way(&self, from: &str, to: &str) -> Option<Vec<String>> {
        let mut ways = vec![vec![from.to_owned()]];
        let mut seen = BTreeSet::new();
        while !ways.is_empty() {
            let mut longer = Vec::new();
            for way in ways {
                for next in way.last().and_then(|last| self.0.get(last)).into_iter().flat_map(BTreeMap::keys)
                {
                    let mut way = way.clone();
                    way.push(next.clone());
                    if next == to {
                        return Some(way);
                    }
                    if seen.insert(next.clone()) {
                        longer.push(way);
                    }
                }
            }
            ways = longer;
        }
        None
    }

    /// The shortest circle through each room that is on one, each circle once, the shortest first.
    fn circles(&self) -> Vec<Vec<String>> {
        let mut circles: Vec<Vec<String>> = self.0.keys().filter_map(|room| self.way(room, room)).collect();
        circles.sort_by_key(Vec::len);
        let mut known = BTreeSet::new();
        circles.retain(|circle| known.insert(circle.iter().cloned().collect::<BTreeSet<_>>()));
        circles
    }

    fn violations(&self) -> Vec<Violation> {
        self.circles().iter().map(|circle| self.violation(circle)).collect()
    }

    fn violation(&self, circle: &[String]) -> Violation {
        let place = |pair: &[String]| &self.0[&pair[0]][&pair[1]];
        let places: Vec<String> = circle
            .windows(2)
            .map(|pair| format!("{}:{} uses {}", place(pair).path, place(pair).line, pair[1]))
            .collect();
        let Place { path, line } = place(circle).clone();
        Violation { path, line, what: format!("a circle, {}: {}", circle.join(" -> "), places.join(", ")) }
    }
}

/// The circles in every crate and in the Python package.
pub fn found(files: &[SourceFile]) -> Result<Vec<Violation>> {
    let mut found = Vec::new();
    for root in files.iter().filter_map(|file| rust::source_folder(&file.path)).collect::<BTreeSet<_>>() {
        found.extend(rust::uses(&root, files)?.iter().flat_map(Uses::violations));
    }
    for root in files.iter().filter_map(|file| python::package_folder(&file.path)).collect::<BTreeSet<_>>() {
        found.extend(python::uses(&root, files).violations());
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(texts: &[(&str, &str)]) -> Vec<SourceFile> {
        texts.iter().map(|(path, text)| SourceFile { path: (*path).into(), text: (*text).into() }).collect()
    }

    fn circles(texts: &[(&str, &str)]) -> Vec<String> {
        found(&files(texts)).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_circle_of_rust_modules_is_found_however_it_is_written() {
        for back in [
            "use crate::upper::Thing;",
            "use crate::{lower::X, upper::{self, Thing}};",
            "use super::super::upper;",
            "use crate::Thing;",
            "fn f() -> crate::upper::Thing { todo() }",
            "fn f() { let a = vec![1, crate::upper::f()]; }",
            "impl crate::upper::Part for X {}",
        ] {
            let found = circles(&[
                ("a/src/lib.rs", "pub mod upper;\npub mod lower;\npub use upper::Thing;\n"),
                ("a/src/upper.rs", "\nuse crate::lower::X;\n"),
                ("a/src/lower.rs", "mod inner;\n"),
                ("a/src/lower/inner.rs", back),
            ]);
            let expected = "a/src/lower/inner.rs:1: a circle, lower -> upper -> lower: \
                            a/src/lower/inner.rs:1 uses upper, a/src/upper.rs:2 uses lower";
            assert_eq!(found, [expected], "{back}");
        }
    }

    #[test]
    fn a_circle_of_the_parts_of_a_room_is_found() {
        for back in [
            "use crate::room::upper::Thing;",
            "use crate::{other::X, room::{lower::Y, upper::Thing}};",
            "use super::super::upper::Thing;",
            "fn f() { let a = vec![1, crate::room::upper::f()]; }",
        ] {
            let found = circles(&[
                ("a/src/lib.rs", "mod room; mod other;"),
                ("a/src/room.rs", "mod upper; mod lower;"),
                ("a/src/room/upper.rs", "use super::lower::X;"),
                ("a/src/room/lower.rs", "mod inner;"),
                ("a/src/room/lower/inner.rs", back),
            ]);
            assert_eq!(found.len(), 1, "{back}: {found:?}");
            assert!(found[0].contains("a circle, lower -> upper -> lower"), "{back}: {found:?}");
        }
    }

    #[test]
    fn what_is_no_circle_is_not_reported() {
        for harmless in [
            "// crate::upper",
            "const A: &str = \"crate::upper\";",
            "#[cfg(test)]\nmod tests { use crate::upper; }",
            "use super::other;",
            "use std::upper;",
            "use crate::lower::upper;",
        ] {
            let found = circles(&[
                ("a/src/lib.rs", "mod upper; mod lower;"),
                ("a/src/upper.rs", "use crate::lower::X;"),
                ("a/src/lower.rs", "mod inner; mod other;"),
                ("a/src/lower/inner.rs", harmless),
                ("a/src/lower/tests.rs", "use crate::upper;"),
                ("a/tests/whole.rs", "use crate::upper;"),
            ]);
            assert!(found.is_empty(), "{harmless}: {found:?}");
        }
    }

    #[test]
    fn a_name_that_the_root_gives_on_under_another_name_is_that_of_its_room() {
        let found = circles(&[
            ("a/src/lib.rs", "mod upper; mod lower; pub use upper::Thing as Other;"),
            ("a/src/upper.rs", "use crate::lower::X;"),
            ("a/src/lower.rs", "use crate::Other;"),
        ]);
        assert_eq!(found.len(), 1, "{found:?}");
    }

    #[test]
    fn a_long_circle_is_reported_once() {
        let found = circles(&[
            ("a/src/main.rs", "mod one; mod two; mod three;"),
            ("a/src/one.rs", "use crate::two;"),
            ("a/src/two.rs", "use crate::three;"),
            ("a/src/three.rs", "use crate::one;"),
        ]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("one -> two -> three -> one"), "{found:?}");
    }

    #[test]
    fn a_circle_of_python_files_is_found() {
        for back in [
            "from . import upper",
            "from .upper import f",
            "import p.upper",
            "import os, p.upper as u",
            "from p import upper",
            "from . import (  # all of it\n        other,\n        upper,\n    )",
        ] {
            let local = format!("def g():\n    {back}\n");
            let found = circles(&[
                ("x/python/p/__init__.py", "from .upper import f\n"),
                ("x/python/p/upper.py", "from .lower import (\n    g,\n)\n"),
                ("x/python/p/lower.py", &local),
            ]);
            let expected = "x/python/p/lower.py:2: a circle, lower -> upper -> lower: \
                            x/python/p/lower.py:2 uses upper, x/python/p/upper.py:1 uses lower";
            assert_eq!(found, [expected], "{back}");
        }
        let harmless = circles(&[
            ("x/python/p/__init__.py", "from .upper import f\n"),
            ("x/python/p/upper.py", "from .lower import g\nfrom . import _native\n"),
            ("x/python/p/_native.pyi", "from .upper import f\n"),
            ("x/python/p/lower.py", "# from .upper import f\nimport numpy\n"),
        ]);
        assert!(harmless.is_empty(), "{harmless:?}");
    }
}
