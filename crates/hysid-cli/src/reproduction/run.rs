//! Experiments side by side, and the pages made of them.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use hysid_app::{date, page_text};
use hysid_document::{Page, Text, markdown, plain};
use hysid_files::{Destination, GENERATOR};
use hysid_paper::{Chapter, Content, Experiment, Observer, Settings};

use super::{Outputs, rendering};
use crate::messages::{note, results};
use crate::{Outcome, files, interrupt};

/// A finished experiment and how it was made.
struct Finished {
    /// The day it was made.
    date: String,
    /// How long it took, beside whatever ran at the same time.
    seconds: f64,
    chapter: Chapter,
}

/// Name of the files of all experiments together.
const TOGETHER: &str = "reproduction";

/// Runs all experiments and writes a page of all of them.
pub fn run(experiments: &[Experiment], settings: Settings, outputs: Outputs) -> Result<Outcome> {
    let everything = experiments.is_empty();
    let experiments: Vec<Experiment> =
        if everything { Experiment::all().collect() } else { experiments.to_vec() };
    let together = if everything { outputs.rendered(TOGETHER).to_vec() } else { Vec::new() };
    let mut destinations: Vec<_> = experiments.iter().flat_map(|&one| outputs.of(one)).collect();
    destinations.extend(together);
    files::check_outputs(&destinations, &files::NO_INPUTS)?;
    let finished = finished(&experiments, settings)?;
    for (experiment, one) in &finished {
        write_one(*experiment, one, settings, outputs)?;
    }
    let finished: Vec<Finished> = finished.into_iter().map(|(_, one)| one).collect();
    if everything && !finished.is_empty() {
        write_together(&finished, settings, outputs)?;
    } else {
        let texts: Vec<String> = finished
            .iter()
            .map(|one| {
                let page = outputs.page(&one.chapter.name);
                let text = plain::rendered(&rendering::summary(&one.chapter));
                format!("{text}\npage    {}\n", files::shown(page.path()))
            })
            .collect();
        results(&texts.join("\n"))?;
    }
    Ok(if interrupt::requested() { Outcome::Interrupted } else { Outcome::Done })
}

/// The program, to whoever runs an experiment.
struct Terminal {
    began: Instant,
}

impl Observer for Terminal {
    fn clock(&self) -> Duration {
        self.began.elapsed()
    }

    fn is_stopped(&self) -> bool {
        interrupt::requested()
    }

    fn say(&self, line: &str) {
        note(format_args!("{line}"));
    }
}

/// All that is finished in the end, in their order.
fn finished(experiments: &[Experiment], settings: Settings) -> Result<Vec<(Experiment, Finished)>> {
    let places: Mutex<Vec<Option<Finished>>> = Mutex::new(experiments.iter().map(|_| None).collect());
    let all = experiments.len();
    // The long ones come last on the page and first here, so that no thread waits for them.
    let left: VecDeque<(usize, Experiment)> = experiments.iter().copied().enumerate().rev().collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let workers = threads.min(all);
    let left = Mutex::new(left);
    let terminal = Terminal { began: Instant::now() };
    let work = || -> Result<()> {
        let pool = hysid::thread_pool(Some(threads / workers.max(1)));
        let pool = pool.context("cannot start a thread")?;
        while !interrupt::requested() {
            let next = left.lock().expect("no thread panics with the lock").pop_front();
            let Some((place, experiment)) = next else { break };
            let began = Instant::now();
            let chapter = match pool.install(|| experiment.chapter(settings, &terminal)) {
                Err(hysid::Error::Stopped) => break,
                chapter => chapter?,
            };
            let seconds = began.elapsed().as_secs_f64();
            let mut places = places.lock().expect("no thread panics with the lock");
            places[place] = Some(Finished { date: date::today(), seconds, chapter });
            let done = places.iter().flatten().count();
            note(format_args!("{done}/{all} {}: finished, {seconds:.0} s", experiment.name()));
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })?;
    let places = places.into_inner().expect("all threads are done").into_iter();
    Ok(experiments.iter().zip(places).filter_map(|(&experiment, one)| Some((experiment, one?))).collect())
}

fn made(finished: &[Finished], settings: Settings, further: &str) -> Text {
    let dates = || finished.iter().map(|one| one.date.as_str());
    let (first, last) = (dates().min().unwrap_or_default(), dates().max().unwrap_or_default());
    let dates = if first == last { first.to_string() } else { format!("{first} to {last}") };
    let seconds: f64 = finished.iter().map(|one| one.seconds).sum();
    let quick = if settings.quick { " A quick run, with a fraction of the effort." } else { "" };
    rendering::made(&format!(
        ", on {dates}, seed {}; {seconds:.0} s, the sum of the times of all experiments, of which several run at once. The measured data of the \
         paper are not public: synthetic specimens replace them.{quick}{further}",
        settings.seed
    ))
}

/// Page, Markdown, CSV and further files of an experiment.
fn write_one(experiment: Experiment, one: &Finished, settings: Settings, outputs: Outputs) -> Result<()> {
    let chapter = &one.chapter;
    let made = made(std::slice::from_ref(one), settings, "");
    let page = rendering::page(made, chapter);
    write_all(outputs.rendered(experiment.name()), &page, std::slice::from_ref(chapter))?;
    for (name, content) in &chapter.files {
        if let Some(destination) = outputs.further(experiment, name) {
            match content {
                Content::Text(text) => files::write(&destination, text.as_bytes())?,
                Content::Drawing(chart) => files::write(&destination, chart.file(GENERATOR).as_bytes())?,
            }
        }
    }
    Ok(())
}

/// The same of all experiments.
fn write_together(finished: &[Finished], settings: Settings, outputs: Outputs) -> Result<()> {
    let chapters: Vec<Chapter> = finished.iter().map(|one| one.chapter.clone()).collect();
    let (finished_ones, all) = (chapters.len(), Experiment::all().count());
    let further = match finished_ones < all {
        true => format!(" Interrupted: {finished_ones} of {all} experiments."),
        false => String::new(),
    };
    let made = made(finished, settings, &further);
    write_all(outputs.rendered(TOGETHER), &rendering::together(made, &chapters), &chapters)?;
    let targets = plain::rendered(&rendering::targets_list(&chapters));
    let page = files::shown(outputs.page(TOGETHER).path());
    results(&format!("{targets}\npage    {page}\n"))
}

fn write_all([html, text, tables]: [Destination; 3], page: &Page, chapters: &[Chapter]) -> Result<()> {
    files::write(&html, page_text(page).as_bytes())?;
    files::write(&text, markdown::page(page).as_bytes())?;
    files::write(&tables, rendering::csv(chapters)?.as_bytes())
}
