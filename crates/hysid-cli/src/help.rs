//! Which help an error points to.

use clap::CommandFactory;

use crate::arguments::Arguments;
use crate::messages::Usage;

/// The help of the command that was typed, or of the program if no command is recognised.
pub fn of_typed_command() -> String {
    let typed = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    of_command(typed)
}

/// The help of the command that these arguments of the program name. No option before the command takes a value.
fn of_command(typed: impl IntoIterator<Item = String>) -> String {
    let named = typed.into_iter().find(|argument| !argument.starts_with('-'));
    let command = Arguments::command();
    match named.as_deref().and_then(|name| command.find_subcommand(name)) {
        Some(command) => format!("hysid {} --help", command.get_name()),
        None => "hysid --help".into(),
    }
}

/// What follows an error of a command: where its options are described, if the command line is wrong and the error names
/// neither an option nor a command that helps; otherwise nothing.
pub fn pointer(error: &anyhow::Error) -> String {
    match error.downcast_ref::<Usage>() {
        Some(Usage(text)) if !text.contains("hysid ") && !text.contains("--") => {
            format!(" (see `{}`)", of_typed_command())
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(line: &str) -> String {
        of_command(line.split(' ').map(String::from))
    }

    #[test]
    fn a_command_has_its_own_help_and_everything_else_that_of_the_program() {
        assert_eq!(help("fit --starts"), "hysid fit --help");
        assert_eq!(help("-q look"), "hysid look --help");
        assert_eq!(help("--quiet generate x"), "hysid generate --help");
        assert_eq!(help("fot data.csv"), "hysid --help");
        assert_eq!(help("--unknown"), "hysid --help");
        assert_eq!(help(""), "hysid --help");
    }
}
