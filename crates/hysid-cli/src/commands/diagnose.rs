//! `hysid diagnose`: what kind of hysteresis measured data or a model have.

use std::path::{Path, PathBuf};

use anyhow::Result;
use hysid::summary::Summary;

use crate::Outcome;
use crate::arguments::{Diagnose, RateOption};
use crate::columns::Roles;
use crate::data::Data;
use crate::diagnosis::DataDiagnosis;
use crate::identification::check_outputs;
use crate::messages::{Usage, note, results, warning};
use crate::table::{Table, is_json};
use crate::{files, understanding};

/// What is told of a diagnosis, and the page if there is to be one.
struct Told {
    text: String,
    page: Option<String>,
}

/// Runs the command.
pub fn run(arguments: &Diagnose) -> Result<Outcome> {
    let page = (!arguments.no_report).then(|| page_path(arguments));
    let inputs: Vec<&Path> = arguments.files.iter().map(PathBuf::as_path).collect();
    let contents: Vec<Vec<u8>> = inputs.iter().map(|path| files::read(path)).collect::<Result<_>>()?;
    check_outputs(&page.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &inputs)?;
    let told = of_data(arguments, &contents)?;
    if let (Some(page), Some(text)) = (&page, &told.page) {
        files::write(page, text.as_bytes())?;
    }
    results(&told.text)?;
    if let Some(page) = &page {
        note(format_args!("page    {}", files::shown(page)));
    }
    Ok(Outcome::Done)
}

fn of_data(arguments: &Diagnose, contents: &[Vec<u8>]) -> Result<Told> {
    let tables = arguments.files.iter().zip(contents).map(|(path, bytes)| Table::from_bytes(path, bytes));
    let tables: Vec<Table> = tables.collect::<Result<_>>()?;
    let roles = Roles::detect(&tables[0], &arguments.columns)?;
    let data = Data::new(tables, roles, true)?;
    let summary = Summary::of(&data.set);
    let understood = understanding::of_data(&data, &summary);
    understanding::print(&understood);
    if let [first, further @ ..] = data.roles.inputs.as_slice()
        && !further.is_empty()
    {
        warning(format_args!(
            "diagnosed is how {} follows {first}; {} {} not looked at (choose with --input)",
            data.roles.output,
            further.join(", "),
            if further.len() == 1 { "is" } else { "are" },
        ));
    }
    if matches!(arguments.columns.rate, RateOption::Method(_)) {
        warning("diagnose has no use for --rate: speeds are taken from the turning points");
    }
    let diagnosed = DataDiagnosis::of(&data, &arguments.options(), &understood)?;
    let text = if arguments.json { diagnosed.json()? } else { diagnosed.text() };
    Ok(Told { text, page: (!arguments.no_report).then(|| diagnosed.page()) })
}

/// The page: as asked, or the first file's name in the present folder.
fn page_path(arguments: &Diagnose) -> PathBuf {
    arguments.out.clone().unwrap_or_else(|| {
        let mut name = arguments.files[0].file_stem().unwrap_or("data".as_ref()).to_os_string();
        name.push(".diagnosis.html");
        PathBuf::from(name)
    })
}
