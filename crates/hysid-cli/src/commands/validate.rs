//! `hysid validate`: how well a model predicts data that it was not fitted to.

use anyhow::{Context, Result};
use hysid::validation::CrossValidator;
use hysid_app::validation::{ValidateRequest, validate};
use hysid_document::Problem;

use crate::Outcome;
use crate::arguments::Validate;
use crate::commands::fit::warn_of_ignored;
use crate::data::{data_of, read_tables};
use crate::identification::say_beforehand;
use crate::interrupt;
use crate::messages::{insist, told};
use crate::progress::Follower;

pub fn run(arguments: &Validate) -> Result<Outcome> {
    let tables = read_tables(&arguments.data, &arguments.columns.reading)?;
    let file = tables[0].file.clone();
    let chosen = &arguments.model.0;
    let data = data_of(tables, &arguments.columns)?;
    let spec = arguments.columns.rate.request(chosen, &data.set).with_context(|| file.clone())?;
    warn_of_ignored(chosen);
    let beginning = spec.judged_beginning(data.set.names())?;
    let folds = CrossValidator::new(&data.set, arguments.folds).with_context(|| file)?;
    let folds = folds.with_known_beginning(beginning);
    say_beforehand(&data, &spec, "stopping; the finished folds are reported")?;

    let threads = arguments.threads.map(usize::from);
    let request = ValidateRequest { data: &data, spec: &spec, folds, threads };
    let mut follower = Follower::new(spec.starts(), arguments.time_limit, None);
    let validated = validate(request, &mut follower);
    follower.finish();
    let validated = match validated {
        Err(Problem::Library(hysid::Error::Stopped)) if interrupt::requested() => {
            insist(format_args!("interrupted before the first fold was finished"));
            return Ok(Outcome::Interrupted);
        }
        validated => validated?,
    };
    told(arguments.json, || Ok(&validated), || validated.text())?;
    if interrupt::requested() {
        insist(format_args!("interrupted: {}", validated.finished()));
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}
