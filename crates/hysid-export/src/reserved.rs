//! Names that an export cannot have, because its files would then shadow others, or a function or variable would have two
//! meanings.

use crate::error::Error;
use crate::program::Program;

/// Headers of C compilers and systems, which a header beside the source code shadows, and names in the test.
pub(crate) const C: &str = include_str!("reserved/c.txt");

/// Functions of GNU Octave, most of which are of MATLAB too, words of the language and variables of the files.
pub(crate) const MATLAB: &str = include_str!("reserved/matlab.txt");

/// Headers, classes and materials of OpenSees.
pub(crate) const OPENSEES: &str = include_str!("reserved/opensees.txt");

/// Modules of Python and of the libraries that the files use, built-in functions, words of the language.
pub(crate) const PYTHON: &str = include_str!("reserved/python.txt");

/// Files of a Functional Mock-up Unit.
pub(crate) const FMU: &str = "fmi2 fmi3";

/// Names of devices, which Windows does not take for files.
const DEVICES: &str = "con prn aux nul com1 com2 com3 com4 com5 com6 com7 com8 com9 \
                       lpt1 lpt2 lpt3 lpt4 lpt5 lpt6 lpt7 lpt8 lpt9";

/// Longest name: MATLAB takes 63 letters, of which the files add some.
const MOST_LETTERS: usize = 50;

/// Endings of the name in functions and types of C.
const ENDINGS: &str = "commit half_width inverse model reach real reset restore revert save state step";

/// Refuses a name that is no identifier, or one of the target's lists, where capital and small letters are the same, as
/// in file names of many systems.
pub(crate) fn check(name: &str, lists: &[&str], target: &'static str) -> Result<(), Error> {
    let is_identifier = name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
        && name.len() <= MOST_LETTERS;
    if !is_identifier {
        return Err(Error::Name(name.to_string()));
    }
    let mut reserved = lists.iter().chain([&DEVICES]).flat_map(|list| list.split_whitespace());
    match reserved.any(|word| word.eq_ignore_ascii_case(name)) {
        true => Err(Error::Reserved { name: name.to_string(), target }),
        false => Ok(()),
    }
}

/// Refuses a name whose functions and types of C would have the names of arrays of the program.
pub(crate) fn check_arrays(name: &str, program: &Program, target: &'static str) -> Result<(), Error> {
    let is_taken = |array: &str| {
        array.strip_prefix(name).and_then(|rest| rest.strip_prefix('_')).is_some_and(|ending| {
            ENDINGS.split(' ').any(|word| word == ending) || ending.starts_with("trial")
        })
    };
    match program.arrays.iter().any(|declaration| is_taken(&declaration.name)) {
        true => Err(Error::Reserved { name: name.to_string(), target }),
        false => Ok(()),
    }
}
