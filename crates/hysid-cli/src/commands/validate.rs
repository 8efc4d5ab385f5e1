//! `hysid validate`: how well a model predicts data that it was not fitted to.

use anyhow::{Context, Result, anyhow};
use hysid::data::unit;
use hysid::fit::identify;
use hysid::fit::progress::Progress;
use hysid::model::Model;
use hysid::validation::{CrossValidation, CrossValidator, FoldErrors};
use hysid_app::check_memory;
use hysid_core::significant::Significant;
use hysid_core::termination::Termination;
use hysid_document::plain::{WIDTH, aligned, wrapped};

use crate::Outcome;
use crate::arguments::Validate;
use crate::commands::fit::warn_of_ignored;
use crate::data::{data_of, read_tables};
use crate::identification::{say_beforehand, thread_pool};
use crate::interrupt;
use crate::messages::{insist, told};
use crate::progress::Follower;

/// Result of the folds, with its provenance.
#[derive(serde::Serialize)]
struct Validated {
    model: &'static str,
    /// Folds that there are; those not reached before Ctrl-C have no errors.
    folds_in_all: usize,
    /// Folds whose fit the time limit ended.
    folds_stopped: usize,
    seconds: f64,
    #[serde(flatten)]
    errors: CrossValidation,
}

pub fn run(arguments: &Validate) -> Result<Outcome> {
    let tables = read_tables(&arguments.data, &arguments.columns.reading)?;
    let file = tables[0].file.clone();
    let chosen = &arguments.model.0;
    let data = data_of(tables, &arguments.columns)?;
    let request = arguments.columns.rate.request(chosen, &data.set).with_context(|| file.clone())?;
    warn_of_ignored(chosen);
    let beginning = match &arguments.known {
        Some(known) => known.beginning(data.set.names().time.as_deref())?,
        None => request.judged_beginning(),
    };
    let validator =
        CrossValidator::new(&data.set, arguments.folds).map_err(|error| anyhow!("{file}: {error}"))?;
    let mut validator = validator.with_known_beginning(beginning);
    say_beforehand(&data, &request, "stopping; the finished folds are reported")?;

    let pool = thread_pool(arguments.threads)?;
    check_memory(&data.set, &request, pool.current_num_threads()).map_err(|error| data.explain(error))?;
    let mut follower = Follower::new(request.starts(), arguments.time_limit, None);
    let (all, mut stopped) = (validator.folds(), 0);
    for place in 0..all {
        follower.begin_fold(place, all);
        let fold = validator.fold(place);
        let mut observer = |progress: &Progress| follower.observe(progress);
        let fitted = pool.install(|| identify(&fold.train, &request, &mut observer));
        if matches!(fitted, Err(hysid::Error::Stopped)) {
            if interrupt::requested() {
                break;
            }
            follower.warn(&format!(
                "fold {} of {all}: stopped by the time limit before a first model",
                place + 1
            ));
            continue;
        }
        let model = fitted.map_err(|error| data.explain(error))?.model;
        if is_stopped(&model) {
            if interrupt::requested() {
                break;
            }
            stopped += 1;
        }
        let errors = validator.judge(&fold, &model).map_err(|error| data.explain(error))?;
        follower.say(&format!(
            "fold {} of {all}: {} % of std on held-out data",
            place + 1,
            percent(&errors.unseen)
        ));
        if interrupt::requested() {
            break;
        }
    }
    let seconds = follower.finish();
    let Some(errors) = validator.result() else {
        if !interrupt::requested() {
            return Err(hysid::Error::Stopped.into());
        }
        insist(format_args!("interrupted before the first fold was finished"));
        return Ok(Outcome::Interrupted);
    };
    let model = request.model().name();
    let validated = Validated { model, folds_in_all: all, folds_stopped: stopped, seconds, errors };
    told(arguments.json, || Ok(&validated), || validated.text())?;
    if interrupt::requested() {
        insist(format_args!("interrupted: {} of {all} folds are finished", validated.errors.folds.len()));
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

fn is_stopped(model: &Model) -> bool {
    model.provenance().termination == Termination::Stopped
}

impl Validated {
    /// The folds as a table, in 80 columns where units are short.
    fn text(&self) -> String {
        let unit = unit::of_column(&self.errors.unseen.output).unwrap_or_else(|| "RMSE".into());
        let headings =
            ["%".to_string(), unit].map(|unit| [format!("train {unit}"), format!("unseen {unit}")]);
        let row = |name: &str, numbers: [String; 4]| [vec![name.to_string()], numbers.to_vec()].concat();
        let mut rows = vec![row("held out", headings.concat().try_into().expect("two times two"))];
        rows.extend(self.errors.folds.iter().map(|fold| row(&fold.held_out, cells(fold))));
        let blank = String::new;
        let all = &self.errors.unseen;
        rows.push(row("all folds", [blank(), percent(all), blank(), number(all.rmse)]));
        let mean = self.errors.unseen_nrmse_std_percent.map_or_else(|| "-".into(), number);
        rows.push(row("geometric mean", [blank(), mean, blank(), blank()]));
        shorten_names(&mut rows);
        let mut text = aligned(&rows).join("\n") + "\n\n";
        text += &wrapped(
            "Errors of free runs: RMSE, and RMSE in % of the standard deviation of the output. Unseen rows \
             are those held out of the fit. A single record is cut in time, and parts of it are held out \
             more than once.",
            WIDTH,
        )
        .join("\n");
        text += &format!("\n{}: {} in {:.1} s\n", self.model, self.count(), self.seconds);
        text
    }

    fn count(&self) -> String {
        let done = match self.errors.folds.len() {
            all if all == self.folds_in_all => format!("{all} folds"),
            some => format!("{some} of {} folds", self.folds_in_all),
        };
        match self.folds_stopped {
            0 => done,
            stopped => format!("{done}, {stopped} of them ended by the time limit,"),
        }
    }
}

fn cells(fold: &FoldErrors) -> [String; 4] {
    [percent(&fold.train), percent(&fold.unseen), number(fold.train.rmse), number(fold.unseen.rmse)]
}

fn percent(errors: &hysid::data::metrics::Errors) -> String {
    errors.nrmse_std_percent.map_or_else(|| "-".into(), number)
}

fn number(value: f64) -> String {
    format!("{:.3}", Significant(value))
}

/// Cuts names off where a line would be too long for a terminal.
fn shorten_names(rows: &mut [Vec<String>]) {
    const FEWEST: usize = 20;
    let letters = |text: &String| text.chars().count();
    let numbers: usize = (1..rows[0].len())
        .map(|column| 2 + rows.iter().map(|row| letters(&row[column])).max().unwrap_or(0))
        .sum();
    let room = WIDTH.saturating_sub(numbers).max(FEWEST);
    for name in rows.iter_mut().map(|row| &mut row[0]) {
        if letters(name) > room {
            *name = name.chars().take(room - 1).chain(['…']).collect();
        }
    }
}
