//! Arguments of `studio`.

use std::path::PathBuf;

use clap::Args;

const EXAMPLES: &str = concat!(
    "\
Examples:
  hysid studio                    opens the page in your browser
  hysid studio data.csv           the same with a file
  hysid studio --project DIR      opens a project again
  hysid studio --no-open --port 8080

No data leave this machine. See
",
    page!("studio.md")
);

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Studio {
    /// Files with measured data (text, spreadsheet, MATLAB); they are copied into the project
    #[arg(value_name = "DATA.csv")]
    pub data: Vec<PathBuf>,
    /// Folder of the project: data, columns, models [default: hysid-project; if another studio has it open, hysid-project-2 and so on]
    #[arg(long, value_name = "DIR")]
    pub project: Option<PathBuf>,
    /// Port on this machine [default: 4973, or a free one]
    #[arg(long, value_name = "N")]
    pub port: Option<u16>,
    /// Print the address and do not open a browser
    #[arg(long)]
    pub no_open: bool,
}
