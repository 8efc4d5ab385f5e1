//! `hysid compare`: every model on the same data.

use std::path::PathBuf;

use anyhow::{Context, Result};
use hysid::Error;
use hysid::data::summary::Summary;
use hysid::options::ModelName;
use hysid::options::chosen::NamedOptions;
use hysid_app::compare::{CompareObserver, CompareRequest, CompareRow, ComparedData, compare};
use hysid_app::data_warnings;
use hysid_document::Face;
use hysid_records::{Data, Roles};

use crate::Outcome;
use crate::arguments::Compare;
use crate::data::{data_with, read_tables};
use crate::files::{self, check_outputs};
use crate::interrupt;
use crate::messages::{note, summarised, told, warning};

pub fn run(arguments: &Compare) -> Result<Outcome> {
    let path =
        arguments.out.clone().unwrap_or_else(|| files::named_after(&arguments.train[0], "-compared.html"));
    let page = files::page(arguments.no_report, path, arguments.overwriting.force);
    let tables = read_tables(&arguments.train, &arguments.columns.reading)?;
    let roles = Roles::detect(&tables[0], &arguments.columns.choice())?;
    let test = match &arguments.test {
        Some(test) => {
            let unseen = read_tables(std::slice::from_ref(test), &arguments.columns.reading)?;
            roles.check_against(&unseen[0], &tables[0].file)?;
            let test = data_with(unseen, roles.clone(), arguments.columns.reading.zero)?;
            // Now rather than after all fits.
            test.set.check_scored().map_err(|error| test.explain(error))?;
            Some(test)
        }
        None => None,
    };
    let inputs: Vec<&PathBuf> = arguments.train.iter().chain(&arguments.test).collect();
    check_outputs(&page, &inputs)?;
    let models: Vec<ModelName> = match arguments.models.is_empty() {
        // The automatic model takes longest and is begun first.
        true => std::iter::once(ModelName::AUTO).chain(ModelName::all()).collect(),
        false => arguments.models.clone(),
    };
    let file = tables[0].file.clone();
    let train = data_with(tables, roles, arguments.columns.reading.zero)?;
    if arguments.effort.is_some() && !models.iter().any(|model| matches!(model, ModelName::Auto(_))) {
        warning("compare ignores --effort: only auto searches with an effort");
    }
    let mut requests = Vec::new();
    for &model in &models {
        let (seed, known) = (Some(arguments.seed), arguments.known.clone());
        let effort = arguments.effort.filter(|_| matches!(model, ModelName::Auto(_)));
        let chosen = NamedOptions { model: Some(model), seed, known, effort, ..NamedOptions::default() };
        let request = arguments.columns.rate.request(&chosen, &train.set).with_context(|| file.clone())?;
        requests.extend(request.variants());
    }

    data_warnings(&train, &Summary::of(&train.set), Face::Terminal).iter().for_each(warning);
    if let Some(test) = &test {
        summarised(&test.set.copies_of(&train.set)).iter().for_each(warning);
    }
    interrupt::listen("stopping; the finished fits are compared")?;
    let request = CompareRequest {
        train: &train.set,
        test: test.as_ref().map(|test| &test.set),
        specs: requests,
        time_limit: arguments.time_limit,
        threads: arguments.threads.map(usize::from),
        times_simulations: true,
    };
    let listener = Listener { train: &train, test: test.as_ref(), count: request.specs.len() };
    let outcome = compare(&request, &listener)?;
    told(arguments.json, || Ok(outcome.printed()), || outcome.text())?;
    if let Some(page) = &page {
        let title = format!("Models compared: {}", train.source.tables[0].file);
        files::write_page(page, outcome.page(&title, request.train, request.test)?, &inputs)?;
        note(format_args!("page    {}", files::shown(page.path())));
    }
    Ok(if interrupt::requested() { Outcome::Interrupted } else { Outcome::Done })
}

/// Writes a line for each fit that has ended; Ctrl-C ends the others.
struct Listener<'a> {
    train: &'a Data,
    test: Option<&'a Data>,
    count: usize,
}

impl CompareObserver for Listener<'_> {
    fn is_to_stop(&self) -> bool {
        interrupt::requested()
    }

    fn ended(&self, _: usize, row: &CompareRow, count: usize) {
        note(format_args!("{count:>2}/{} {}", self.count, row.line()));
    }

    fn explain(&self, error: Error, data: ComparedData) -> String {
        let data = if data == ComparedData::Test { self.test.unwrap_or(self.train) } else { self.train };
        format!("{:#}", data.explain(error))
    }
}
