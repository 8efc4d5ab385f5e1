//! Arguments of the commands about the program itself: `models`, `completions`, `man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

use super::Overwriting;

const MODELS_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid models                   all models that a fit can use
  hysid models model.json        what a model file holds
  hysid models model.json --json the same as one JSON object

Properties of a model: hysid diagnose. More about each model:
",
    page!("models.md")
);

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  hysid completions bash > ~/.local/share/bash-completion/completions/hysid
  hysid completions zsh > ~/.zfunc/_hysid
  hysid completions fish > ~/.config/fish/completions/hysid.fish";

const MAN_EXAMPLES: &str = "\
Examples:
  hysid man -o ~/.local/share/man/man1
  hysid man -o DIR && man -l DIR/hysid-fit.1";

#[derive(Debug, Args)]
#[command(after_help = MODELS_EXAMPLES)]
pub struct Models {
    /// A model file of `hysid fit` to inspect [default: none; all models are listed]
    #[arg(value_name = "MODEL.json")]
    pub model: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS_EXAMPLES)]
pub struct Completions {
    /// The shell that is to complete commands and options
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

#[derive(Debug, Args)]
#[command(after_help = MAN_EXAMPLES)]
pub struct Man {
    /// Folder for the pages, one of the program and one of each command
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    #[command(flatten)]
    pub overwriting: Overwriting,
}
