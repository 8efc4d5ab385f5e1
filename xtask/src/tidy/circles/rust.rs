//! Which room of a crate uses which, and which part of a room.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use proc_macro2::{TokenStream, TokenTree};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, ItemUse, Macro, Path, UseTree};

use super::{Place, Uses};
use crate::tidy::SourceFile;

/// The folder of a crate's sources, if the path is its root file.
pub fn source_folder(path: &str) -> Option<String> {
    let folder = path.strip_suffix("lib.rs").or_else(|| path.strip_suffix("main.rs"))?;
    folder.ends_with("src/").then(|| folder.to_owned())
}

/// Uses among the rooms of the crate in a folder, and among the parts of each room.
pub fn uses(folder: &str, files: &[SourceFile]) -> Result<Vec<Uses>> {
    let mut re_exported = BTreeMap::new();
    let mut by_rooms: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    let mut visitors = Vec::new();
    for file in files {
        let Some(inside) = file.path.strip_prefix(folder) else { continue };
        let is_test = inside.split(['/', '.']).any(|part| part == "tests");
        let Some(module) = inside.strip_suffix(".rs").filter(|_| !is_test) else { continue };
        let syntax = syn::parse_file(&file.text).with_context(|| format!("{} cannot be read", file.path))?;
        if matches!(module, "lib" | "main") {
            re_exports(&syntax.items, &mut re_exported);
            continue;
        }
        if !module.contains('/') {
            re_exports(&syntax.items, by_rooms.entry(module.into()).or_default());
        }
        let module = module.split('/').map(str::to_owned).collect();
        let mut visitor = Visitor { path: &file.path, module, used: Vec::new() };
        visitor.visit_file(&syntax);
        visitors.push(visitor);
    }
    let mut rooms = Uses::default();
    let mut parts: BTreeMap<&str, Uses> = BTreeMap::new();
    for Visitor { path, module, used } in &visitors {
        for (names, line) in used {
            let place = Place { path: (*path).to_owned(), line: *line };
            let room = re_exported.get(&names[0]).unwrap_or(&names[0]);
            rooms.add(&module[0], room, place.clone());
            if let ([from, part, ..], [to, other, ..]) = (&module[..], &names[..])
                && from == to
            {
                let other = by_rooms.get(to).and_then(|names| names.get(other)).unwrap_or(other);
                parts.entry(from).or_default().add(part, other, place);
            }
        }
    }
    // What is no room, and no part of one, is an item of the file above.
    rooms.keep(&visitors.iter().map(|visitor| visitor.module[0].clone()).collect());
    for (room, uses) in &mut parts {
        let of_room = visitors.iter().filter(|visitor| visitor.module[0] == *room);
        uses.keep(&of_room.filter_map(|visitor| visitor.module.get(1).cloned()).collect());
    }
    Ok(std::iter::once(rooms).chain(parts.into_values()).collect())
}

/// The room that each name comes from which the root gives on, or the part that it comes from in a room.
fn re_exports(items: &[Item], names: &mut BTreeMap<String, String>) {
    for item in items {
        if let Item::Use(ItemUse { tree, .. }) = item {
            for path in paths(tree) {
                let path: Vec<&String> =
                    path.iter().filter(|part| *part != "crate" && *part != "self").collect();
                if let [room, .., name] = path.as_slice() {
                    names.insert((*name).clone(), (*room).clone());
                }
            }
        }
    }
}

/// The paths of a `use`; behind one that gets another name stands that name.
fn paths(tree: &UseTree) -> Vec<Vec<String>> {
    let below = |name: String, tree: &UseTree| {
        let mut paths = paths(tree);
        paths.iter_mut().for_each(|path| path.insert(0, name.clone()));
        paths
    };
    match tree {
        UseTree::Path(path) => below(path.ident.to_string(), &path.tree),
        UseTree::Name(name) => vec![vec![name.ident.to_string()]],
        UseTree::Rename(name) => vec![vec![name.ident.to_string(), name.rename.to_string()]],
        UseTree::Glob(_) => vec![vec!["*".into()]],
        UseTree::Group(group) => group.items.iter().flat_map(paths).collect(),
    }
}

/// Collects the first two names of paths from the root of the crate.
struct Visitor<'f> {
    path: &'f str,
    /// The module that is visited, from the root.
    module: Vec<String>,
    /// Names, and the lines where they stand.
    used: Vec<(Vec<String>, usize)>,
}

impl Visitor<'_> {
    /// Takes a path from the root, or from a module below it.
    fn take(&mut self, path: &[String], line: usize) {
        let climbs = path.iter().take_while(|part| *part == "super").count();
        let below = match path.first().map(String::as_str) {
            Some("crate") => &[],
            Some("super") => &self.module[..self.module.len().saturating_sub(climbs)],
            _ => return,
        };
        let names: Vec<String> = below.iter().chain(&path[climbs.max(1)..]).take(2).cloned().collect();
        if !names.is_empty() {
            self.used.push((names, line));
        }
    }

    /// Paths inside the arguments of a macro, where the syntax is not known.
    fn take_tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        for (index, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Group(group) => self.take_tokens(group.stream()),
                TokenTree::Ident(first) if first == "crate" => {
                    // Between names stand two colons.
                    let names = tokens[index..].iter().step_by(3).map_while(|token| match token {
                        TokenTree::Ident(name) => Some(name.to_string()),
                        _ => None,
                    });
                    self.take(&names.take(3).collect::<Vec<_>>(), first.span().start().line);
                }
                _ => {}
            }
        }
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    let is_test = |attribute: &Attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<Path>().is_ok_and(|argument| argument.is_ident("test"))
    };
    attributes.iter().any(is_test)
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if is_test(&module.attrs) {
            return;
        }
        self.module.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if !is_test(&item.attrs) {
            paths(&item.tree).iter().for_each(|path| self.take(path, item.span().start().line));
        }
    }

    fn visit_path(&mut self, path: &'ast Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.take(&names, path.span().start().line);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast Macro) {
        self.take_tokens(called.tokens.clone());
        visit::visit_macro(self, called);
    }
}
