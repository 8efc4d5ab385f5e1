//! The options of a model and its training on the command line, made from the library's table of options.

use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use hysid::options::chosen::NamedOptions;
use hysid::options::table::{FitOption, OPTIONS, OptionValues};
use serde_json::{Map, Value};

/// Options of the short help of a command.
const IN_SHORT_HELP: [&str; 2] = ["model", "members"];

/// Options of the model and its training, as given.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelOptions(pub NamedOptions);

impl Args for ModelOptions {
    fn augment_args(command: Command) -> Command {
        command.args(OPTIONS.iter().map(argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for ModelOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given =
            OPTIONS.iter().filter_map(|option| Some((option.name.to_string(), value(option, matches)?)));
        let options = NamedOptions::of(given.collect::<Map<_, _>>());
        options.map(Self).map_err(|error| clap::Error::raw(clap::error::ErrorKind::ValueValidation, error))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

pub fn names() -> impl Iterator<Item = &'static str> {
    OPTIONS.iter().map(|option| option.name)
}

fn argument(option: &'static FitOption) -> Arg {
    let help = format!("{} [default: {}]", option.meaning, option.default_in_words());
    let argument = Arg::new(option.name)
        .long(option.name.replace('_', "-"))
        .help(&help)
        .help_heading(option.group.heading())
        .hide_short_help(!IN_SHORT_HELP.contains(&option.name));
    match option.values {
        OptionValues::Flag => argument.action(ArgAction::SetTrue),
        // The short help has no room for all names.
        OptionValues::Names(names) => argument
            .value_name(option.values.placeholder())
            .value_parser(by_name(names()))
            .hide_possible_values(true)
            .help(format!("{help} [names: see --help options]"))
            .long_help(format!("{help} [names: {}]", names().join(", "))),
        _ => {
            let read = |text: String| option.read(&text);
            argument
                .value_name(option.values.placeholder())
                .allow_hyphen_values(true)
                .value_parser(StringValueParser::new().try_map(read))
        }
    }
}

/// One of the names, or another name of the paper's network.
fn by_name(names: Vec<&'static str>) -> impl TypedValueParser<Value = Value> {
    let known = names.into_iter().map(|name| match name {
        "xpnn" => PossibleValue::new(name).alias("epnn"),
        name => PossibleValue::new(name),
    });
    PossibleValuesParser::new(known).map(Value::from)
}

fn value(option: &FitOption, matches: &ArgMatches) -> Option<Value> {
    match option.values {
        OptionValues::Flag => matches.get_flag(option.name).then_some(Value::Bool(true)),
        _ => matches.get_one::<Value>(option.name).cloned(),
    }
}
