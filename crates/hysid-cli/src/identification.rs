//! The work of `fit` and `demo`: print the reading of the data, train, and write model and report. All before
//! the training is that of `validate` too.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use hysid::data::metrics::Errors;
use hysid::data::record::Dataset;
use hysid::fit::network::resume;
use hysid::fit::progress::{Checkpoint, Progress};
use hysid::model::{Model, Provenance};
use hysid::options::FitSpec;
use hysid::options::fit_spec::AutoOptions;
use hysid_app::{Beforehand, Identified, check_memory, errors_table};
use hysid_core::termination::Termination;
use hysid_document::Face;
use hysid_document::plain::{WIDTH, wrapped};
use hysid_files::Destination;
use hysid_records::Data;

use crate::checkpoint::Keeper;
use crate::files::write_page;
use crate::inspection::stored_errors;
use crate::messages::{insist, note_labelled, warning};
use crate::progress::Follower;
use crate::{files, interrupt};

/// Fit to run: request, start, and where to store its state.
pub struct FitTask<'a> {
    pub request: &'a FitSpec,
    /// A fit begun before, with these options.
    pub begun: Option<Checkpoint>,
    /// Where to store the state of the fit.
    pub checkpoint: Option<Keeper>,
    /// Threads; by default one for each processor.
    pub threads: Option<u16>,
    /// Seconds after which to stop.
    pub time_limit: Option<f64>,
}

impl<'a> FitTask<'a> {
    /// A fit from its beginning, without limits.
    pub fn new(request: &'a FitSpec) -> Self {
        Self { request, begun: None, checkpoint: None, threads: None, time_limit: None }
    }
}

/// Prints the reading of data and request, and warnings. From now on Ctrl-C stops the fit at its next step, and prints
/// this text.
pub fn say_beforehand(data: &Data, request: &FitSpec, to_ctrl_c: &'static str) -> Result<Beforehand> {
    let beforehand = Beforehand::of(data, request, Face::Terminal)?;
    // Looking at long data takes its time, and Ctrl-C ends it at once: there is nothing to lose yet.
    interrupt::listen(to_ctrl_c)?;
    note_labelled(&beforehand.in_short);
    beforehand.warnings.iter().for_each(warning);
    Ok(beforehand)
}

/// Identifies a model, following the training on stderr.
pub fn identify(data: &Data, work: FitTask) -> Result<Identified> {
    let request = work.request;
    let beforehand = say_beforehand(data, request, "stopping to save the best model so far")?;
    let pool = hysid::thread_pool(work.threads.map(usize::from)).context("cannot start the threads")?;
    check_memory(&data.set, request, pool.current_num_threads()).map_err(|error| data.explain(error))?;
    let mut follower = Follower::new(request.starts(), work.time_limit, work.checkpoint);
    let mut observer = |progress: &Progress| follower.observe(progress);
    let fitted = pool.install(|| match work.begun {
        Some(begun) => resume(&data.set, begun, &mut observer),
        None => hysid::fit::identify(&data.set, request, &mut observer),
    });
    let seconds = follower.finish();
    let fitted = fitted.map_err(|error| data.explain(error))?;
    let (model, evaluations, held_out) = (fitted.model, fitted.evaluations, fitted.held_out);
    Ok(Identified { model, evaluations, held_out, seconds: Some(seconds), beforehand })
}

/// Writes the model. It took long to find: if it cannot be written there, it is put elsewhere, and the error names
/// the place.
pub fn save(identified: &Identified, model: &Destination) -> Result<()> {
    files::write_or_rescue(model, "model", identified.model.to_json().as_bytes())
}

/// Writes the report on the model, which is written already, with a title of its own if there is one.
pub fn write_report(
    identified: &Identified,
    (page, title): (&Destination, Option<&str>),
    model: &Path,
    sets: &[(&str, &Dataset)],
    inputs: &[impl AsRef<Path>],
) -> Result<()> {
    write_page(page, identified.page(title, Some(model), sets)?, inputs)
        .context("the model was written, but not its report")
}

/// Errors, size, time and files, for stdout.
pub fn printed(identified: &Identified, unseen: Option<&Errors>, written: &[(&str, &Path)]) -> String {
    let Identified { model, seconds, .. } = identified;
    let provenance = model.provenance();
    let mut sets = stored_errors(provenance);
    sets.extend(unseen.map(|errors| ("unseen test", errors)));
    let mut text = errors_table::errors_table(&sets);
    if let Some(selection) = &provenance.selection {
        text += &match selection.one_loop {
            true => {
                "(validation: on parts of the one measured loop; the error on smaller loops is unknown)\n"
                    .into()
            }
            false => {
                let words = format!("(validation: {})", selection.held_out_rows());
                wrapped(&words, WIDTH).join("\n") + "\n"
            }
        };
        text.push('\n');
        for (label, line) in ["chosen", "why"].into_iter().zip(selection.summary()) {
            text += &labelled(label, &line);
        }
    } else if provenance.validation.is_some() {
        text += "(validation: errors on held-out rows)\n";
    }
    text += &format!(
        "{}\n{} with {} parameters; {}; {:.1} s\n",
        model.notes().iter().map(|note| labelled("note", note)).collect::<String>(),
        named(model),
        model.parameters(),
        chosen(provenance),
        seconds.unwrap_or_default()
    );
    for (what, path) in written {
        text += &format!("{what:<7} {}\n", files::shown(path));
    }
    text
}

/// A label and a text, within 80 columns where words allow.
fn labelled(label: &str, text: &str) -> String {
    const LABEL: usize = 7;
    let lines = wrapped(text, WIDTH - LABEL);
    let mut labels = std::iter::once(label).chain(std::iter::repeat(""));
    lines.iter().map(|line| format!("{:LABEL$}{line}\n", labels.next().unwrap_or_default())).collect()
}

/// The name of the model that was asked for, and how many of it there are.
fn named(model: &Model) -> String {
    match (&model.provenance().options, model.ensemble()) {
        (FitSpec::Auto(AutoOptions { only: Some(only), .. }), Some(ensemble)) => {
            format!("ensemble of {} {}", ensemble.members().len(), only.model().name())
        }
        _ => model.name().name().into(),
    }
}

/// Where the model comes from and why its fit ended, in words.
fn chosen(provenance: &Provenance) -> String {
    let ended = &provenance.termination;
    let options = match &provenance.options {
        FitSpec::Network(options) => options,
        FitSpec::Classical(options) if options.model.is_searched() => {
            return format!("multi-start search, {ended}");
        }
        FitSpec::Classical(_) => return "linear least squares".into(),
        // The members ended each by itself.
        FitSpec::Auto(_) if *ended == Termination::Stopped => {
            return "chosen by cross-validation, stopped".into();
        }
        FitSpec::Auto(_) => return "chosen by cross-validation".into(),
    };
    match options.starts {
        1 => format!("{} training, {ended}", options.training.name()),
        starts => format!("start {} of {starts} chosen, {ended}", provenance.chosen_start + 1),
    }
}

/// The report lies beside the model: `.html` in the place of `.json`, or behind any other ending.
pub fn report_path(model: &Path) -> PathBuf {
    if model.extension().is_none_or(|extension| extension == "json") {
        return model.with_extension("html");
    }
    let mut name = model.as_os_str().to_os_string();
    name.push(".html");
    name.into()
}

/// Says that Ctrl-C or a signal was obeyed.
pub fn note_interrupted(path: &Path) {
    insist(format_args!("interrupted: the best model so far is in {}", files::shown(path)));
}
