//! What the command lines of several commands have in common.

use anyhow::Result;

use crate::Usage;

/// An option and its value, from `--option=value` or from `--option` and the argument behind it.
pub fn option_and_value<'a>(
    argument: &'a str,
    rest: &mut impl Iterator<Item = &'a str>,
) -> (&'a str, Option<&'a str>) {
    match argument.split_once('=') {
        Some((option, value)) => (option, Some(value)),
        None => (argument, rest.next()),
    }
}

/// The error of a command line that cannot be obeyed.
pub fn usage<T>(what: String) -> Result<T> {
    Err(Usage(what).into())
}
