//! `hysid export`: a model as source code for other programs.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use hysid_app::date;
use hysid_document::{Problem, count, object};
use hysid_export::description::RateSource;
use hysid_export::{
    Error, Export as Exported, FmiVersion, InverseOptions, MANIFEST, Options, Precision, Target, files_of,
};
use hysid_files::Folder;
use serde::Serialize;

use crate::Outcome;
use crate::arguments::Export;
use crate::commands::read_model;
use crate::files;
use crate::messages::{Usage, json_results, note};
use crate::progress::while_working;

pub fn run(arguments: &Export) -> Result<Outcome> {
    let model = read_model(&arguments.model)?;
    let name = match &arguments.name {
        Some(name) => name.clone(),
        None => identifier(&arguments.model)?,
    };
    let folder = arguments.out.clone().unwrap_or_else(|| format!("{name}_{}", arguments.to.name()).into());
    if folder == Path::new("-") {
        return Err(Problem::request("-o -: an export is a folder, which stdout cannot be: name one").into());
    }
    if arguments.fmi.is_some() && arguments.to != Target::Fmu {
        return Err(Usage("--fmi is a version of --to fmu".into()).into());
    }
    let bounds = [("limits", arguments.limits.is_some()), ("slew", arguments.slew.is_some())];
    if let Some((bound, _)) = bounds.into_iter().find(|(_, is_given)| *is_given && !arguments.inverse) {
        return Err(Usage(format!("--{bound} is for the input of an inverse: add --inverse")).into());
    }
    let inverse = InverseOptions { limits: arguments.limits, slew: arguments.slew };
    let options = Options {
        name,
        precision: if arguments.precision == "f32" { Precision::Single } else { Precision::Double },
        rate: if arguments.rate == "argument" { RateSource::Argument } else { RateSource::Backward },
        band: arguments.data_sets.level(arguments.band),
        fmi: if arguments.fmi.as_deref() == Some("2") { FmiVersion::Two } else { FmiVersion::Three },
        inverse: arguments.inverse.then_some(inverse),
        source: source(&arguments.model),
    };
    let exported = while_working("writing and testing the code", || {
        hysid_export::export(&model, arguments.to, &options)
    });
    let exported = exported.map_err(|error| match error {
        Error::Name(_) | Error::Reserved { .. } if arguments.name.is_some() => {
            Usage(format!("--name: {error}")).into()
        }
        Error::Reserved { .. } => Usage(format!("{error} with --name")).into(),
        Error::Band(_) | Error::NoBand => Usage(format!("--band: {error}")).into(),
        Error::NoInverse(_) => Usage(format!("--inverse: {error}")).into(),
        Error::InverseRate => Usage(format!("--rate argument: {error}")).into(),
        Error::Limits(_) if arguments.limits.is_some() => Usage(format!("--limits: {error}")).into(),
        Error::Slew(_) => Usage(format!("--slew: {error}")).into(),
        Error::Precision(_) => Usage(format!("--precision: {error}")).into(),
        error => anyhow!("{}: {error}", arguments.model.display()),
    })?;
    let destination = Folder {
        path: &folder,
        what: "export of Hysid",
        manifest: MANIFEST,
        listed: files_of,
        checksum: hysid_export::checksum,
        inputs: &[&arguments.model],
        force: arguments.overwriting.force,
    };
    let kept = destination.write(&exported.contents()).map_err(files::explained_folder)?;
    match arguments.json {
        true => json_results(&printed(&folder, arguments, &options, &exported))?,
        false => {
            for kept in &kept {
                note(format_args!("a file that was replaced is kept as {}", files::shown(kept)));
            }
            let (shown, files) = (files::shown(&folder), count(exported.files.len(), "file"));
            note(format_args!("wrote {shown}: {files}; {shown}/README.md says how to use them"));
            if let Some(more) = &exported.note {
                note(format_args!("{more}"));
            }
        }
    }
    Ok(Outcome::Done)
}

/// Identifier made from the name of a model file.
fn identifier(path: &Path) -> Result<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name: String =
        stem.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
    match name.starts_with(|first: char| first.is_ascii_alphabetic()) {
        true => Ok(name),
        false => Err(Usage(format!("{stem} is no identifier: name the export with --name")).into()),
    }
}

/// File and date of the model.
fn source(path: &Path) -> Vec<(String, String)> {
    let mut facts = vec![("model file".to_string(), path.display().to_string())];
    if let Ok(time) = fs::metadata(path).and_then(|file| file.modified()) {
        facts.push(("date of the model file".into(), date::of(time)));
    }
    facts
}

/// The object that `--json` prints.
fn printed(folder: &Path, arguments: &Export, options: &Options, exported: &Exported) -> impl Serialize {
    object! {
        folder: folder,
        target: arguments.to.name(),
        name: &options.name,
        precision: options.precision.name(),
        files: exported.files.iter().map(|file| &file.path).collect::<Vec<_>>(),
        note: &exported.note,
    }
}
