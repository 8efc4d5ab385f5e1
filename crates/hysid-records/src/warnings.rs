//! Warnings of the library in words.

use std::mem::{self, Discriminant};

use hysid_core::data::warning::Warning;

/// Largest number of warnings of a kind that are listed one by one: a file may have a hundred thousand records.
const MOST_OF_A_KIND: usize = 5;

/// Warnings in words, kind by kind: the first few, and how many more there are.
pub fn summarised(warnings: &[Warning]) -> Vec<String> {
    let mut kinds: Vec<(Discriminant<Warning>, Vec<&Warning>)> = Vec::new();
    for warning in warnings {
        let kind = mem::discriminant(warning);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, warnings)) => warnings.push(warning),
            None => kinds.push((kind, vec![warning])),
        }
    }
    let words = kinds.iter().flat_map(|(_, warnings)| {
        let more = warnings.len().saturating_sub(MOST_OF_A_KIND);
        let more = (more > 0).then(|| format!("and {more} more of this kind"));
        warnings.iter().take(MOST_OF_A_KIND).map(ToString::to_string).chain(more)
    });
    words.collect()
}
