//! `hysid fit`: from measured data to a model file.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use hysid::data::rate::RateMethod;
use hysid::data::record::Dataset;
use hysid::diagnosis::residuals::Residuals;
use hysid::fit::progress::Checkpoint;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::chosen::{Ignored, NamedOptions, RateChoice};
use hysid::options::network::FitOptions;
use hysid_app::{Identified, initial_state};
use hysid_document::shell::flag;
use hysid_document::{Problem, object};
use hysid_files::{Destination, Kind};
use hysid_records::Roles;
use serde::Serialize;

use crate::Outcome;
use crate::arguments::{Fit, RateOption};
use crate::checkpoint::{self, Keeper};
use crate::data::{data_with, read_tables};
use crate::files::{self, check_outputs};
use crate::identification::{self, FitTask, identify, report_path};
use crate::interrupt;
use crate::messages::{Usage, note, told, warning};

pub fn run(arguments: &Fit) -> Result<Outcome> {
    let force = arguments.overwriting.force;
    let model = Destination::new(out(arguments)?, Kind::Model, force);
    let report = files::page(arguments.no_report, report_path(model.path()), force);
    let tables = read_tables(&arguments.train, &arguments.columns.reading)?;
    let begun = arguments.resume.as_deref().map(checkpoint::read).transpose()?;
    let checkpoint = checkpoint_destination(arguments);
    check_outputs(std::iter::once(&model).chain(&report).chain(&checkpoint), &arguments.train)?;
    let roles = Roles::detect(&tables[0], &arguments.columns.choice())?;
    let chosen = &arguments.model.0;
    let file = tables[0].file.clone();
    let data = data_with(tables, roles, arguments.columns.reading.zero)?;
    let data = if arguments.inverse { data.exchanged()? } else { data };
    let request = match &begun {
        Some(begun) => FitSpec::Network(options_of(begun, &arguments.columns.rate)?),
        None => arguments.columns.rate.request(chosen, &data.set).with_context(|| file)?,
    };
    if arguments.checkpoint.is_some() {
        check_checkpoints(&request)?;
    }
    let keeper = checkpoint.map(Keeper::new).transpose()?;
    let resumable = keeper.as_ref().map(|keeper| keeper.path().to_path_buf());
    warn_of_ignored(chosen);
    let work = FitTask {
        request: &request,
        begun,
        checkpoint: keeper,
        threads: arguments.threads,
        time_limit: arguments.time_limit,
    };
    let identified = identify(&data, work)?;

    let out = model.path();
    identification::save(&identified, &model)?;
    let trained = identified.model.as_trained(&data.set)?;
    let sets = [("training", trained.as_ref())];
    let title = arguments.title.as_deref();
    let reported = report.as_ref().map_or(Ok(()), |page| {
        identification::write_report(&identified, (page, title), out, &sets, &arguments.train)
    });
    let mut written = vec![("model", out)];
    written.extend(report.iter().filter(|_| reported.is_ok()).map(|page| ("report", page.path())));
    let text = || identification::printed(&identified, None, &written) + &next(out);
    told(arguments.json, || printed(&identified, out, &trained), text)?;
    reported?;
    if interrupt::requested() {
        identification::note_interrupted(out);
        resumable.iter().for_each(|checkpoint| note_resumable(checkpoint));
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

/// Where the state of the fit is stored. What a fit begins anew there replaces is kept; one that is resumed goes on.
fn checkpoint_destination(arguments: &Fit) -> Option<Destination> {
    let path = arguments.checkpoint.as_ref().or(arguments.resume.as_ref())?;
    let goes_on = arguments.resume.as_ref().is_some_and(|resumed| files::same(resumed, path));
    let destination = Destination::new(path, Kind::Checkpoint, arguments.overwriting.force);
    Some(destination.keeping_the_old(!goes_on))
}

fn note_resumable(checkpoint: &Path) {
    let file = files::shown(checkpoint);
    note(format_args!(
        "to resume: run the same command with --resume {file} instead of its training options"
    ));
}

/// The model file: as asked, or the first table's name in the present folder.
fn out(arguments: &Fit) -> Result<PathBuf> {
    let Some(out) = &arguments.out else {
        return Ok(files::named_after(&arguments.train[0], ".json"));
    };
    if out.extension().is_some_and(|extension| extension == "html") {
        let advice = "use .json for the model file: the report gets the same name with .html";
        return Err(Problem::request(format!("{}: {advice}", out.display())).into());
    }
    if out.as_os_str() == "-" {
        return Err(Usage("--out needs the name of a file for the model".into()).into());
    }
    Ok(out.clone())
}

/// The options of a fit that is taken up again.
fn options_of(begun: &Checkpoint, rate: &RateOption) -> Result<FitOptions> {
    let options = begun.options().clone();
    let agrees = match rate {
        RateOption::Choice(RateChoice::Auto) => true,
        RateOption::Choice(RateChoice::None) => options.rate.is_none(),
        RateOption::Choice(RateChoice::Method(method)) => options.rate == Some(*method),
        RateOption::Column(_) => options.rate == Some(RateMethod::Given),
    };
    if !agrees {
        let advice = "--rate differs from that of the checkpoint: leave it out, or start a new fit";
        return Err(Usage(advice.into()).into());
    }
    Ok(options)
}

/// Refuses checkpoints of what has none.
fn check_checkpoints(request: &FitSpec) -> Result<()> {
    let what = match request {
        FitSpec::Network(_) => return Ok(()),
        FitSpec::Classical(options) => options.model.name(),
        FitSpec::Auto(options) if options.only.is_some() => "an ensemble",
        FitSpec::Auto(_) => "auto",
    };
    let advice = "only a single network has them, such as --model xpnn+";
    Err(Usage(format!("{what} has no checkpoints: {advice}")).into())
}

pub fn warn_of_ignored(chosen: &NamedOptions) {
    for Ignored { option, by } in chosen.ignored() {
        warning(format_args!("{by} ignores {}", flag(option)));
    }
}

fn next(model: &Path) -> String {
    let model = files::shown(model);
    format!("\nnext:\n  hysid evaluate {model} DATA.csv\n  hysid simulate {model} DATA.csv -o OUT.csv\n")
}

fn architecture(model: &Model) -> impl Serialize + use<> {
    object! {
        family: model.name(),
        #[serde(flatten)]
        parts: model.network().map(|network| *network.architecture()),
    }
}

/// The object that `--json` prints.
fn printed(identified: &Identified, out: &Path, trained: &Dataset) -> Result<impl Serialize> {
    let (model, provenance) = (&identified.model, identified.model.provenance());
    let member = |model: &Model| {
        object! {
            #[serde(flatten)]
            architecture: architecture(model),
            parameters: model.parameters(),
        }
    };
    let tested = |(data, tests): (String, Residuals)| {
        object! {
            /// Kind of the data: `training` or `held-out`.
            data: data,
            #[serde(flatten)]
            tests: tests,
        }
    };
    Ok(object! {
        model: out.display().to_string(),
        architecture: architecture(model),
        parameters: model.parameters(),
        /// Members of the ensemble; `null` for a single model.
        members: model.ensemble().map(|ensemble| ensemble.members().iter().map(member).collect::<Vec<_>>()),
        /// Candidates and their errors; `null` where there was no choice.
        selection: provenance.selection.as_ref(),
        train: &provenance.train,
        /// Without the rows of a warm-up; left out for a model without one.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        train_after_warm_up: provenance.train_after_warm_up.as_ref(),
        validation: provenance.validation.as_ref(),
        /// In which state data to come begin; left out for the virgin state.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        initial_state: initial_state(model),
        /// Turning points of the first input before each training record; left out where all begin in one state.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        lead_ins: &provenance.lead_ins,
        /// Confidence intervals of the parameters; left out for a model that has none.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        intervals: identified.intervals(trained)?,
        /// Tests of the residual by the data, training first; left out for too few rows.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        residuals: identified.residuals(trained)?.into_iter().map(tested).collect::<Vec<_>>(),
        /// Limitations of the model.
        notes: model.notes(),
        seconds: identified.seconds,
        evaluations: identified.evaluations,
        termination: provenance.termination,
    })
}
