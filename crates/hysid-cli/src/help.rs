//! Which help an error points to.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use hysid_document::Problem;
use hysid_document::shell::option;
use hysid_tables::is_model;

use crate::arguments::Arguments;
use crate::files::shown;

/// The help of the command that was typed, or of the program if no command is recognised.
pub fn of_typed_command() -> String {
    of_command(typed())
}

/// The arguments of the program as they were typed.
fn typed() -> impl Iterator<Item = String> {
    std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned())
}

/// The help of the command that these arguments of the program name. No option before the command takes a value.
fn of_command(typed: impl IntoIterator<Item = String>) -> String {
    let named = typed.into_iter().find(|argument| !argument.starts_with('-'));
    let command = Arguments::whole();
    match named.as_deref().and_then(|name| command.find_subcommand(name)) {
        Some(command) => format!("hysid {} --help", command.get_name()),
        None => "hysid --help".into(),
    }
}

/// Most letters that are missing, wrong or exchanged in a name that was meant.
const MOST_SLIPS: usize = 2;

/// Adds the command that was meant to an error about one that does not exist: short names with exchanged letters are too far
/// apart for the library's own measure.
pub fn suggest_command(error: &mut clap::Error) {
    let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) else { return };
    if error.kind() != ErrorKind::InvalidSubcommand || error.get(ContextKind::SuggestedSubcommand).is_some() {
        return;
    }
    let program = Arguments::whole();
    let all = program.get_subcommands().map(|command| command.get_name());
    let nearest = all.map(|one| (strsim::osa_distance(name, one), one)).min();
    if let Some((slips, nearest)) = nearest
        && slips <= MOST_SLIPS
    {
        let suggested = ContextValue::Strings(vec![nearest.to_string()]);
        error.insert(ContextKind::SuggestedSubcommand, suggested);
    }
}

/// Leaves out what a list of all values says worse than the one that was meant, and advice to take a wrong option for a file.
pub fn shorten(error: &mut clap::Error) {
    if error.get(ContextKind::SuggestedValue).is_some() {
        error.remove(ContextKind::ValidValue);
    }
    if let Some(ContextValue::StyledStrs(hints)) = error.remove(ContextKind::Suggested) {
        let useful = hints.into_iter().filter(|hint| !hint.to_string().contains("as a value")).collect();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(useful));
    }
}

/// Hint for a value after `--force` of `hysid restoring-force`, which takes none: it may be a column.
pub fn hint_of_force() -> Option<String> {
    value_typed("restoring-force", "--force").map(|column| applied_force(&column))
}

/// Hint for `hysid fit --test`: the fit takes no test data.
pub fn hint_of_test(error: &clap::Error) -> Option<String> {
    let is_test =
        matches!(error.get(ContextKind::InvalidArg), Some(ContextValue::String(name)) if name == "--test");
    let data = value_typed("fit", "--test").filter(|_| is_test)?;
    let data = shown(Path::new(&data));
    Some(format!(
        "after the fit, `hysid evaluate MODEL.json {data}` tests the model; `hysid compare` takes --test and tests several"
    ))
}

/// Value after this option of this command.
fn value_typed(command: &str, option: &str) -> Option<String> {
    let mut typed = typed().skip_while(|argument| argument.starts_with('-'));
    typed.next().filter(|typed| typed == command)?;
    let value = |argument: &str| Some(argument.strip_prefix(option)?.strip_prefix('=')?.to_string());
    let mut rest = typed.skip_while(|argument| argument != option && value(argument).is_none());
    value(&rest.next()?).or_else(|| rest.next().filter(|value| !value.starts_with('-')))
}

/// Longest beginning of a file that shows whether it is a model.
const BEGINNING: u64 = 256;

/// A model file that was typed behind this one.
pub fn model_behind(path: &Path) -> Option<PathBuf> {
    let behind = typed().skip_while(|argument| Path::new(argument) != path).skip(1).map(PathBuf::from);
    behind.into_iter().find(|path| {
        let mut begins = Vec::new();
        // A pipe may have no end.
        path.is_file()
            && File::open(path).is_ok_and(|file| file.take(BEGINNING).read_to_end(&mut begins).is_ok())
            && is_model(&begins)
    })
}

fn applied_force(column: &str) -> String {
    let option = option("applied-force", column);
    format!("--force replaces files; a column with the applied force is named by {option}")
}

/// Hint after an error that does not say what helps: where the options are described, for an invalid request; the command
/// that shows how a table is read, for a wrong line of a table; otherwise empty.
pub fn pointer(error: &anyhow::Error) -> String {
    let helps = match error.downcast_ref() {
        Some(Problem::Request(words)) if !words.helps() => Some(of_typed_command()),
        Some(problem) => look_at(problem, typed()),
        None => None,
    };
    helps.map_or_else(String::new, |command| format!(" (see `{command}`)"))
}

/// The command that shows how the table of a problem is read: one of those that were typed, with a line that is wrong.
fn look_at(problem: &Problem, typed: impl IntoIterator<Item = String>) -> Option<String> {
    let wrong = problem.file_to_look_at()?;
    let mut typed = typed.into_iter().peekable();
    match typed.peek().map(String::as_str) {
        Some("look") => None,
        _ => typed.find(|file| file == wrong).map(|file| format!("hysid look {}", shown(Path::new(&file)))),
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::words::Words;

    use super::*;

    #[test]
    fn a_wrong_line_of_a_typed_table_points_to_look() {
        let look = |problem: &Problem, line: &str| look_at(problem, line.split(' ').map(String::from));
        let wrong = Problem::at("a.csv", 3, "has 2 cells where the header has 3");
        assert_eq!(look(&wrong, "fit b.csv a.csv"), Some("hysid look a.csv".into()));
        assert_eq!(look(&wrong, "look a.csv"), None);
        assert_eq!(look(&wrong, "fit b.csv"), None);
        let advised = Problem::at("a.csv", 3, Words::from("is no text").advised("save it as UTF-8"));
        assert_eq!(look(&advised, "fit a.csv"), None);
        assert_eq!(look(&Problem::in_file("a.csv", "there is nothing to score"), "fit a.csv"), None);
    }
}
