//! Help of the program and of its commands: commands in groups; a screen of the options that most people need, and all of
//! them with `--help options`.

use clap::{Arg, ArgAction, Command};
use hysid_document::plain::{WIDTH, wrapped};

/// Commands by what they are for.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Read", &["look", "diagnose", "cycles", "restoring-force"]),
    ("Fit", &["demo", "fit", "validate", "compare"]),
    ("Use", &["evaluate", "simulate", "invert", "export", "plot", "plan"]),
    ("Browser", &["studio"]),
    ("Other", &["models", "generate", "reproduce", "completions", "man"]),
];

/// The argument that asks for all options; `--help options` is typed for it.
const ALL_OPTIONS: &str = "help-options";

const TEMPLATE: &str =
    "{about-with-newline}\n{usage-heading} {usage}\n{before-help}Options:\n{options}{after-help}";

/// The command line with this help.
pub(super) fn with_help(command: Command) -> Command {
    let groups = grouped(&command);
    with_two_helps(command.before_help(groups).help_template(TEMPLATE))
        .mut_subcommands(|command| with_version(with_two_helps(command)))
}

/// The arguments as they were typed, with `--help options` in one word.
pub(super) fn in_one_word(typed: impl Iterator<Item = std::ffi::OsString>) -> Vec<std::ffi::OsString> {
    let mut words: Vec<std::ffi::OsString> = Vec::new();
    for word in typed {
        match words.last_mut() {
            Some(last) if word == "options" && (last == "--help" || last == "-h") => {
                *last = format!("--{ALL_OPTIONS}").into()
            }
            _ => words.push(word),
        }
    }
    words
}

fn with_two_helps(command: Command) -> Command {
    let short = Arg::new("help")
        .short('h')
        .long("help")
        .action(ArgAction::HelpShort)
        .display_order(999)
        .help_heading(None);
    let all = Arg::new(ALL_OPTIONS).long(ALL_OPTIONS).action(ArgAction::HelpLong).hide(true);
    let short = short.help("Print help; all options: --help options");
    command.disable_help_flag(true).args([short, all])
}

/// A command has the version of the program, which its help does not tell.
fn with_version(command: Command) -> Command {
    let version = Arg::new("version").short('V').long("version").action(ArgAction::Version).hide(true);
    command.disable_version_flag(true).version(env!("CARGO_PKG_VERSION")).arg(version)
}

/// The commands with what they do, group by group.
fn grouped(command: &Command) -> String {
    let widest = GROUPS.iter().flat_map(|(_, names)| *names).map(|name| name.len()).max().unwrap_or(0);
    let line = |name: &&str| {
        let about = command.find_subcommand(name).and_then(Command::get_about).map(ToString::to_string);
        let lines = wrapped(&about.unwrap_or_default(), WIDTH - widest - 4);
        format!("  {name:widest$}  {}\n", lines.join(&format!("\n{:1$}", "", widest + 4)))
    };
    let group = |(heading, names): &(&str, &[&str])| {
        format!("\n{heading}:\n{}", names.iter().map(line).collect::<String>())
    };
    GROUPS.iter().map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Arguments;

    #[test]
    fn every_command_is_in_one_group() {
        let program = Arguments::whole();
        let mut named: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        let mut all: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
        named.sort_unstable();
        all.sort_unstable();
        assert_eq!(named, all);
    }

    #[test]
    fn all_options_are_one_word() {
        let typed = |line: &str| -> Vec<String> {
            let words = in_one_word(line.split(' ').map(Into::into));
            words.into_iter().map(|word| word.into_string().unwrap()).collect()
        };
        assert_eq!(typed("hysid fit --help options"), ["hysid", "fit", "--help-options"]);
        assert_eq!(typed("hysid fit options --help"), ["hysid", "fit", "options", "--help"]);
    }
}
