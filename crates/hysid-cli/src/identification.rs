//! The work of `fit` and `demo`: say what was understood, train, and write model and report. What comes before
//! the training is that of `validate` too.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use hysid::data::metrics::{ErrorSums, Errors};
use hysid::data::record::{Dataset, Record};
use hysid::data::summary::Summary;
use hysid::diagnosis::residuals::{FEWEST_ROWS, ResidualOptions, Residuals};
use hysid::diagnosis::{DataIssueKind, before_a_fit};
use hysid::fit::HeldOutRows;
use hysid::fit::intervals::ParameterIntervals;
use hysid::fit::memory_need;
use hysid::fit::network::{Checkpoint, Progress, resume};
use hysid::model::{Model, Prediction, Provenance};
use hysid::options::FitSpec;
use hysid_document::Page;
use hysid_document::plain::{WIDTH, wrapped};
use hysid_files::{Destination, GENERATOR};
use rayon::ThreadPool;

use crate::checkpoint::Keeper;
use crate::data::Data;
use crate::inspection::stored_errors;
use crate::messages::{insist, summarised, warning};
use crate::progress::Follower;
use crate::report::{self, Report, ReportSet, Tracks};
use crate::{errors_table, files, interrupt, origin, understanding};

/// A model and what was said and spent on the way to it.
pub struct Identified {
    /// The model.
    pub model: Model,
    /// Evaluations of the objective.
    pub evaluations: usize,
    /// Rows that were held out in turn, and what was predicted for them.
    held_out: Option<HeldOutRows>,
    /// Seconds of training.
    pub seconds: f64,
    said: Said,
}

/// What is to be done with the data, and how.
pub struct Work<'a> {
    /// What is to be identified.
    pub request: &'a FitSpec,
    /// A fit begun before, with these options.
    pub begun: Option<Checkpoint>,
    /// Where to store the state of the fit.
    pub checkpoint: Option<Keeper>,
    /// Threads; one for each processor if not said.
    pub threads: Option<u16>,
    /// Seconds after which to stop.
    pub time_limit: Option<f64>,
}

impl<'a> Work<'a> {
    /// A fit from its beginning, without limits.
    pub fn new(request: &'a FitSpec) -> Self {
        Self { request, begun: None, checkpoint: None, threads: None, time_limit: None }
    }
}

/// What was said before the work began.
pub struct Said {
    understood: Vec<(String, String)>,
    warnings: Vec<String>,
}

/// Says what was understood of data and request, and what to be aware of. From now on Ctrl-C asks to stop, and gets
/// this answer.
pub fn say_beforehand(data: &Data, request: &FitSpec, to_ctrl_c: &'static str) -> Result<Said> {
    let model = match request {
        FitSpec::Network(options) => {
            let architecture = options.architecture(&data.set).map_err(|error| data.explain(error))?;
            format!(": {} parameters; {}", architecture.parameters(), understanding::parts(&architecture))
        }
        FitSpec::Auto(options) => understanding::choice(options),
        FitSpec::Classical(_) => String::new(),
    };
    request.model().check_data(&data.set, request.rate()).map_err(|error| data.explain(error))?;
    let summary = Summary::of(&data.set);
    let understood = understanding::understanding(data, &summary, request, &model);
    let mut warnings = data_warnings(data, &summary);
    warnings.extend(request.cautions(&data.set));
    // Looking at long data takes its time, and Ctrl-C ends it at once: there is nothing to lose yet.
    interrupt::listen(to_ctrl_c)?;
    understanding::print(&understood);
    warnings.iter().for_each(warning);
    Ok(Said { understood, warnings })
}

/// What to be aware of in data that a model is to be fitted to.
pub fn data_warnings(data: &Data, summary: &Summary) -> Vec<String> {
    // Data that cannot be looked at cannot be fitted to either: the fit says why.
    let doubtful = before_a_fit(&data.set).unwrap_or_default();
    let output = format!("\"{}\" ", data.roles.output);
    let statements = doubtful.into_iter().map(|issue| match (issue.kind, issue.value) {
        (DataIssueKind::MissingValueMark, Some(value)) if issue.statement.starts_with(&output) => {
            format!("{} (--missing {value})", issue.statement)
        }
        _ => issue.statement,
    });
    summarised(&summary.warnings(&data.set)).into_iter().chain(statements).collect()
}

/// Refuses work that needs more memory than there is.
pub fn check_memory(data: &Dataset, request: &FitSpec, threads: usize) -> hysid::Result<()> {
    memory_need(data, request, threads)?.check(hysid_files::available_memory())
}

/// So many threads; one for each processor if not said.
pub fn thread_pool(threads: Option<u16>) -> Result<ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0).into()).build();
    pool.context("cannot start the threads")
}

/// Identifies a model, following the training on stderr.
pub fn identify(data: &Data, work: Work) -> Result<Identified> {
    let request = work.request;
    let said = say_beforehand(data, request, "stopping to save the best model so far")?;
    let pool = thread_pool(work.threads)?;
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
    Ok(Identified { model, evaluations, held_out, seconds, said })
}

impl Identified {
    /// Writes the model. It took long to find: if it cannot be written there, it is put elsewhere, and the error says
    /// where.
    pub fn save(&self, model: &Destination) -> Result<()> {
        files::write_or_rescue(model, "model", self.model.to_json().as_bytes())
    }

    /// Writes the report on the model, which is written already.
    pub fn write_report(
        &self,
        page: &Destination,
        model: &Path,
        sets: &[(&str, &Dataset)],
        inputs: &[&Path],
    ) -> Result<()> {
        origin::write_page(page, self.report(model, sets)?, inputs)
            .context("the model was written, but not its report")
    }

    /// Tests of the residual on the data that the model was fitted to (as it was trained on them), and on rows that were
    /// held out from other models made in the same way.
    pub fn residuals(&self, trained: &Dataset) -> Result<Vec<(String, Residuals)>> {
        let mut all = Vec::new();
        all.extend(self.residuals_of("training", trained)?);
        let options =
            ResidualOptions { uses_rate: self.model.rate().is_some(), ..ResidualOptions::default() };
        if let Some(HeldOutRows { data, simulated }) = &self.held_out
            && data.scored() >= FEWEST_ROWS
        {
            all.push(("held-out".into(), Residuals::of(data, simulated, &options)?));
        }
        Ok(all)
    }

    /// Tests of the residual on some data; `None` for too few rows.
    fn residuals_of(&self, name: &str, data: &Dataset) -> Result<Option<(String, Residuals)>> {
        let is_training = name == "training";
        // The rows of a warm-up were not trained on.
        let data = data.clone().warmed_up(if is_training { self.model.warm_up() } else { 0 });
        if data.scored() < FEWEST_ROWS {
            return Ok(None);
        }
        let options = ResidualOptions { is_training, ..ResidualOptions::default() };
        Ok(Some((name.into(), Residuals::of_model(&self.model, &data, &options)?)))
    }

    /// Confidence intervals of the parameters, for a law that has them.
    pub fn intervals(&self, trained: &Dataset) -> Result<Option<ParameterIntervals>> {
        Ok(ParameterIntervals::of(&self.model, trained)?)
    }

    fn report(&self, path: &Path, sets: &[(&str, &Dataset)]) -> Result<Page> {
        let mut residuals = Vec::new();
        let mut intervals = None;
        for &(name, data) in sets {
            match name {
                "training" => {
                    residuals.extend(self.residuals(data)?);
                    intervals = self.intervals(data)?;
                }
                _ => residuals.extend(self.residuals_of(name, data)?),
            }
        }
        let title = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(report::page(&Report {
            title,
            model: &self.model,
            sets: sets.iter().map(|(name, data)| self.set(name, data)).collect::<Result<_>>()?,
            residuals: &residuals,
            intervals: intervals.as_ref(),
            warnings: &self.said.warnings,
            understood: &self.said.understood,
            model_file: path.display().to_string(),
            seconds: self.seconds,
        }))
    }

    /// Measured and simulated loops on a set of data, as an SVG file.
    pub fn loops(&self, name: &str, data: &Dataset) -> Result<String> {
        Ok(report::loops(&self.set(name, data)?).file(GENERATOR))
    }

    fn set<'a>(&self, name: &str, data: &'a Dataset) -> Result<ReportSet<'a>> {
        let mut sums = ErrorSums::default();
        let predict = |record: &Record| self.model.predict(&record.excitation(), report::BAND);
        let predicted = self.model.band().map(|_| data.records().iter().map(predict).collect());
        let predicted: Option<Vec<Prediction>> = predicted.transpose()?;
        let simulated: Vec<Vec<f64>> = match &predicted {
            Some(predicted) => predicted.iter().map(|predicted| predicted.output.clone()).collect(),
            None => data
                .records()
                .iter()
                .map(|record| self.model.simulate(record))
                .collect::<hysid::Result<_>>()?,
        };
        data.records().iter().zip(&simulated).for_each(|(record, output)| sums.add(record.output(), output));
        let errors = sums.errors(&data.names().output).context("there is nothing to score")?;
        let tracks = Tracks::of(name, data);
        Ok(ReportSet { name: name.into(), data, simulated, predicted, errors, tracks })
    }

    /// Errors, size, time and files, for stdout.
    pub fn results(&self, unseen: Option<&Errors>, written: &[(&str, &Path)]) -> String {
        let provenance = self.model.provenance();
        let mut sets = stored_errors(provenance);
        sets.extend(unseen.map(|errors| ("unseen test", errors)));
        let mut text = errors_table::errors_table(&sets);
        if let Some(selection) = &provenance.selection {
            text +=
                &format!("(validation: errors on the rows held out in {} folds)\n", selection.folds.len());
            text.push('\n');
            for (label, line) in ["chosen", "why"].into_iter().zip(selection.summary()) {
                text += &labelled(label, &line);
            }
        } else if provenance.validation.is_some() {
            text += "(validation: errors on held-out rows)\n";
        }
        text += &format!(
            "{}\n{} with {} parameters; {}, {}; {:.1} s\n",
            self.model.notes().iter().map(|note| labelled("note", note)).collect::<String>(),
            self.model.name().name(),
            self.model.parameters(),
            chosen(provenance),
            provenance.termination,
            self.seconds
        );
        for (what, path) in written {
            text += &format!("{what:<7} {}\n", files::shown(path));
        }
        text
    }
}

/// A label and a text, within 80 columns where words allow.
fn labelled(label: &str, text: &str) -> String {
    const LABEL: usize = 7;
    let lines = wrapped(text, WIDTH - LABEL);
    let mut labels = std::iter::once(label).chain(std::iter::repeat(""));
    lines.iter().map(|line| format!("{:LABEL$}{line}\n", labels.next().unwrap_or_default())).collect()
}

/// Where the model comes from, in words.
fn chosen(provenance: &Provenance) -> String {
    let options = match &provenance.options {
        FitSpec::Network(options) => options,
        FitSpec::Classical(options) if options.model.is_searched() => return "multi-start search".into(),
        FitSpec::Classical(_) => return "linear least squares".into(),
        FitSpec::Auto(_) => return "chosen by cross-validation".into(),
    };
    match options.starts {
        1 => format!("{} training", options.training.name()),
        starts => format!("start {} of {starts} chosen", provenance.chosen_start + 1),
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
