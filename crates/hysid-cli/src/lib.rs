//! The program `hysid`: identify, simulate and judge hysteresis from the command line.
//!
//! Results go to stdout, everything else to stderr. Exit status: 0, 1 (data, model, input or output),
//! 2 (usage), and after the best model so far is saved 130 (Ctrl-C), 143 (SIGTERM) or 129 (SIGHUP).

mod arguments;
mod checkpoint;
mod commands;
mod data;
mod files;
mod help;
mod identification;
mod inspection;
mod interrupt;
mod messages;
mod plotting;
mod progress;
mod reproduction;
mod terminal;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};

use arguments::{Arguments, Command};
use hysid_document::{Problem, object};
use messages::{StdoutClosed, insist, is_usage};

/// How a command ended when nothing went wrong.
enum Outcome {
    /// It did all it was asked to.
    Done,
    /// Ctrl-C or a signal ended it early; what was found is saved.
    Interrupted,
}

/// Says nothing of panics in libraries that read files: they become errors of the file.
fn quieten_readers() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(hysid_tables::CONTAINER_THREAD) {
            usual(panic);
        }
    }));
}

/// Runs the command line; returns the exit status.
pub fn run() -> ExitCode {
    quieten_readers();
    interrupt::survive_limits_of_files();
    if let Some(set) = std::env::var_os("HYSID_INSTRUCTIONS")
        && !set.to_str().is_some_and(hysid_core::simd::narrow_to)
    {
        insist(format_args!(
            "error: HYSID_INSTRUCTIONS={}: this machine has no such instruction set (AVX2 or baseline)",
            set.display()
        ));
        return ExitCode::from(2);
    }
    let arguments = match Arguments::typed() {
        Ok(arguments) => arguments,
        Err(error) => return refuse(error),
    };
    if arguments.quiet {
        messages::be_quiet();
    }
    let outcome = match arguments.command {
        Command::Demo(arguments) => commands::demo::run(&arguments),
        Command::Fit(arguments) => commands::fit::run(&arguments),
        Command::Validate(arguments) => commands::validate::run(&arguments),
        Command::Simulate(arguments) => commands::simulate::run(&arguments),
        Command::Evaluate(arguments) => commands::evaluate::run(&arguments),
        Command::Invert(arguments) => commands::invert::run(&arguments),
        Command::Compare(arguments) => commands::compare::run(&arguments),
        Command::Look(arguments) => commands::look::run(&arguments),
        Command::Diagnose(arguments) => commands::diagnose::run(&arguments),
        Command::Cycles(arguments) => commands::cycles::run(&arguments),
        Command::RestoringForce(arguments) => commands::restoring_force::run(&arguments),
        Command::Plot(arguments) => commands::plot::run(&arguments),
        Command::Studio(arguments) => commands::studio::run(&arguments),
        Command::Plan(arguments) => commands::plan::run(&arguments),
        Command::Reproduce(arguments) => commands::reproduce::run(&arguments),
        Command::Generate(arguments) => commands::generate::run(&arguments),
        Command::Export(arguments) => commands::export::run(&arguments),
        Command::Models(arguments) => commands::models::run(&arguments),
        Command::Completions(arguments) => commands::completions::run(&arguments),
        Command::Man(arguments) => commands::man::run(&arguments),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => ExitCode::from(interrupt::exit_status()),
        // Whoever read the results has seen enough.
        Err(error) if error.is::<StdoutClosed>() => ExitCode::SUCCESS,
        Err(error) => {
            let message = format!("{error:#}{}", help::pointer(&error));
            insist(format_args!("error: {message}"));
            say_as_json(&message);
            if interrupt::requested() && is_stopped(&error) {
                return ExitCode::from(interrupt::exit_status());
            }
            ExitCode::from(if is_usage(&error) { 2 } else { 1 })
        }
    }
}

/// True for a fit that ended before there was a first model.
fn is_stopped(error: &anyhow::Error) -> bool {
    let library = match error.downcast_ref() {
        Some(Problem::Library(library)) => Some(library),
        _ => error.downcast_ref(),
    };
    matches!(library, Some(hysid::Error::Stopped))
}

/// Shows help or version where these were asked for, otherwise what is wrong with the command line,
/// in one line.
fn refuse(error: clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed pipe is no reason to complain.
            let _ = error.print();
            ExitCode::from(error.exit_code() as u8)
        }
        _ => {
            let mut error = error;
            let hint = match is_extra_value(&error) {
                true => help::hint_of_force(),
                false => help::hint_of_test(&error),
            };
            if hint.is_some() {
                error.remove(ContextKind::SuggestedArg);
            }
            help::suggest_command(&mut error);
            help::shorten(&mut error);
            let text = cleaned(error).render().to_string();
            let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
            let said: Vec<&str> = lines.take_while(|line| !line.starts_with("Usage:")).collect();
            let said = said.join(" ");
            let said = said.split(" For more information").next().unwrap_or_default().replace(" tip: ", "; ");
            let helps = hint.unwrap_or_else(|| format!("see `{}`", help::of_typed_command()));
            let message = format!("{said} ({helps})");
            insist(format_args!("{message}"));
            say_as_json(message.strip_prefix("error: ").unwrap_or(&message));
            ExitCode::from(2)
        }
    }
}

/// With `--json`, an error is an object on stdout too, for programs that read it, unless one with the problem is there.
fn say_as_json(message: &str) {
    if std::env::args_os().any(|argument| argument == "--json") && !messages::has_results() {
        // Whoever closed stdout does not read it.
        let _ = messages::json_results(&object! { error: message });
    }
}

/// True if the error is about a value where none is expected.
fn is_extra_value(error: &clap::Error) -> bool {
    let is_value = |value: Option<&ContextValue>| match value {
        Some(ContextValue::String(text)) => !text.starts_with('-'),
        _ => false,
    };
    match error.kind() {
        ErrorKind::UnknownArgument => is_value(error.get(ContextKind::InvalidArg)),
        ErrorKind::TooManyValues => true,
        _ => false,
    }
}

/// The error with the user's arguments in one line, and cut where they are long.
fn cleaned(mut error: clap::Error) -> clap::Error {
    let shown = |value: &ContextValue| match value {
        ContextValue::String(text) => Some(ContextValue::String(terminal::clipped(text).into_owned())),
        ContextValue::Strings(texts) => Some(ContextValue::Strings(
            texts.iter().map(|text| terminal::clipped(text).into_owned()).collect(),
        )),
        _ => None,
    };
    let context: Vec<_> = error.context().filter_map(|(kind, value)| Some((kind, shown(value)?))).collect();
    for (kind, value) in context {
        error.insert(kind, value);
    }
    error
}
