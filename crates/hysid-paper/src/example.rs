//! The engine that runs any of the paper's examples: fits, errors, figures, targets.

pub mod catalogue;
mod figures;

use hysid::Result;
use hysid::data::metrics::{ErrorSums, Errors};
use hysid::data::record::{Dataset, Record};
use hysid::model::Model;
use hysid::network::Family;
use hysid::options::network::FitOptions;
use hysid::options::{FitSpec, ModelName};
use hysid::specimens::Specimen;
use hysid_document::{Cell, Part, Table, capitalised, convergence, count, number, unit};

use crate::chapter::{Chapter, Target, stands_in};
use crate::conditions::{Observer, Settings};
use crate::fitting;
use catalogue::{Case, Example, Figure, Opponent};

/// What a model makes of a set of data.
struct Run {
    /// Outputs of each record.
    simulated: Vec<Vec<f64>>,
    errors: Errors,
}

/// A model on both sets of a specimen.
struct Contestant {
    name: String,
    model: Model,
    train: Run,
    unseen: Run,
}

/// A case that has been run.
struct Played<'a> {
    case: &'a Case,
    specimen: &'static Specimen,
    train: Dataset,
    unseen: Dataset,
    /// The XPNN, then its rival, if there is one.
    contestants: Vec<Contestant>,
    /// Error on data held out of the training data, without the rate and, if there is time, with it.
    validation: Vec<f64>,
    /// The XPNN has the rate as an input.
    has_rate: bool,
}

/// Runs an example.
pub fn chapter(example: &Example, settings: Settings, observer: &dyn Observer) -> Result<Chapter> {
    let played = example.cases.iter().map(|case| play(example, case, settings, observer));
    let played: Vec<Played> = played.collect::<Result<_>>()?;
    let mut parts = vec![Part::paragraph(format!("The paper reports {}", example.paper))];
    parts.extend(played.iter().flat_map(|played| played.parts(example)));
    parts.push(Part::Note(fitting::words(settings)));
    Ok(Chapter {
        name: example.name.into(),
        title: format!("the paper's {}: {}", spaced(example.name), example.title),
        verdict: played.iter().map(Played::verdict).collect::<Vec<String>>().join(" "),
        parts,
        targets: played.iter().flat_map(Played::targets).collect(),
        files: Vec::new(),
    })
}

/// `example 3` for `example3`.
fn spaced(name: &str) -> String {
    name.replace("example", "example ")
}

fn play<'a>(
    example: &Example,
    case: &'a Case,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<Played<'a>> {
    let specimen = Specimen::named(case.specimen).expect("the specimen is in the catalogue");
    let (train, unseen) = (specimen.train(), specimen.test());
    let what = format!("{}, {}", example.name, case.specimen);
    let fit =
        |request: FitSpec| -> Result<Model> { Ok(fitting::fit(&what, &train, &request, observer)?.model) };
    let xpnn = fitting::network(Family::Xpnn, &train, settings);
    let mut candidates = vec![fit(FitSpec::Network(FitOptions { rate: None, ..xpnn.clone() }))?];
    if xpnn.rate.is_some() {
        candidates.push(fit(FitSpec::Network(xpnn))?);
    }
    let validation: Vec<f64> = candidates.iter().map(validation).collect();
    // Records at several rates need the rate; within one slow record it tells no more than the direction.
    let is_better = |validation: &[f64]| validation[1] < validation[0];
    let has_rate = validation.len() > 1 && (train.records().len() > 1 || is_better(&validation));
    let mut models = vec![("XPNN".to_string(), candidates[usize::from(has_rate)].clone())];
    let rival = match case.opponent {
        Opponent::Nobody => None,
        Opponent::WithoutRate => Some(("XPNN without x'".to_string(), candidates.swap_remove(0))),
        Opponent::Network(family) => {
            let model = fit(FitSpec::Network(fitting::network(family, &train, settings)))?;
            Some((family.name().to_uppercase(), model))
        }
        Opponent::Law(law) => {
            let request = FitSpec::of(ModelName::Classical(law), None, settings.seed);
            Some(("GPIM".to_string(), fit(fitting::rival(request, settings))?))
        }
    };
    models.extend(rival);
    let contestant = |(name, model): (String, Model)| {
        Ok(Contestant { train: run(&model, &train)?, unseen: run(&model, &unseen)?, name, model })
    };
    let contestants = models.into_iter().map(contestant).collect::<Result<_>>()?;
    Ok(Played { case, specimen, train, unseen, contestants, validation, has_rate })
}

/// Error on what was held out of the training data, in % of std.
fn validation(model: &Model) -> f64 {
    let errors = model.provenance().validation.as_ref();
    errors.and_then(|errors| errors.nrmse_std_percent).unwrap_or(f64::INFINITY)
}

fn run(model: &Model, data: &Dataset) -> Result<Run> {
    let simulated: Vec<Vec<f64>> =
        data.records().iter().map(|record| model.simulate(record)).collect::<Result<_>>()?;
    let errors = errors(data, &simulated, |_| true).expect("specimens have outputs");
    Ok(Run { simulated, errors })
}

/// Errors over the records of these names.
fn errors(data: &Dataset, simulated: &[Vec<f64>], is_wanted: impl Fn(&str) -> bool) -> Option<Errors> {
    let mut sums = ErrorSums::default();
    for (record, simulated) in
        data.records().iter().zip(simulated).filter(|(record, _)| is_wanted(record.name()))
    {
        sums.add(record.output(), simulated);
    }
    sums.errors(&data.names().output)
}

/// Largest magnitude of the output.
fn largest(data: &Dataset) -> f64 {
    let (low, high) = data.output_range();
    low.abs().max(high.abs())
}

impl Played<'_> {
    fn xpnn(&self) -> &Contestant {
        &self.contestants[0]
    }

    fn rival(&self) -> Option<&Contestant> {
        self.contestants.get(1)
    }

    /// The value of a figure; `None` if there is nothing that it could be of.
    fn figure(&self, figure: Figure) -> Option<f64> {
        let xpnn = self.xpnn();
        match figure {
            Figure::Training => xpnn.train.errors.nrmse_std_percent,
            Figure::Unseen => xpnn.unseen.errors.nrmse_std_percent,
            Figure::UnseenRecords(names) => {
                errors(&self.unseen, &xpnn.unseen.simulated, |name| names.contains(&name))?.nrmse_std_percent
            }
            Figure::LargestUnseen => Some(100.0 * xpnn.unseen.errors.max_abs_error / largest(&self.unseen)),
            Figure::TimesBelowTraining => Some(self.rival()?.train.errors.mse / xpnn.train.errors.mse),
            Figure::TimesBelowUnseen => Some(self.rival()?.unseen.errors.mse / xpnn.unseen.errors.mse),
        }
    }

    fn targets(&self) -> Vec<Target> {
        let target = |wanted: &catalogue::Wanted| {
            let measured = self.figure(wanted.figure);
            let (bound, is_met) = match wanted.figure.is_ratio() {
                true => ("at least", measured.is_some_and(|measured| measured >= wanted.limit)),
                false => ("at most", measured.is_some_and(|measured| measured <= wanted.limit)),
            };
            Target {
                specimen: self.specimen.name.into(),
                figure: wanted.figure.words(),
                wanted: format!("{bound} {}", wanted.limit),
                measured: measured.into(),
                is_met,
            }
        };
        self.case.wanted.iter().map(target).collect()
    }

    /// The case in a sentence.
    fn verdict(&self) -> String {
        let percent =
            |run: &Run| run.errors.nrmse_std_percent.map_or("–".to_string(), |percent| number(percent, 2));
        let xpnn = self.xpnn();
        let mut text = format!(
            "{}: the XPNN's error is {} % of std in training and {} % on unseen data",
            self.specimen.name,
            percent(&xpnn.train),
            percent(&xpnn.unseen)
        );
        let records: Vec<&str> = self.unseen.records().iter().map(Record::name).collect();
        if records.len() > 1 {
            text += &format!(" ({})", records.join(", "));
        }
        if let Some(rival) = self.rival() {
            text += &format!(
                ", that of {} {} % and {} %",
                rival.name,
                percent(&rival.train),
                percent(&rival.unseen)
            );
        }
        text + "."
    }

    fn parts(&self, example: &Example) -> Vec<Part> {
        let specimen = self.specimen;
        let mut parts = vec![
            Part::heading(specimen.name),
            Part::paragraph(format!("{}. {}.", capitalised(specimen.summary), capitalised(self.case.shows))),
            Part::Table(self.errors_table(example)),
        ];
        parts.extend(self.records_table(example).map(Part::Table));
        parts.push(Part::note(self.choice_of_rate()));
        parts.push(Part::note(format!(
            "Training: {}. Unseen: {}. Published: {}. Designed: {}.",
            specimen.training, specimen.testing, specimen.published, specimen.designed
        )));
        parts.push(Part::Charts(vec![
            figures::loops("training", &self.train, &self.lines(|contestant| &contestant.train)),
            figures::loops("unseen", &self.unseen, &self.lines(|contestant| &contestant.unseen)),
        ]));
        parts.push(Part::chart(figures::history(&self.unseen, &self.lines(|contestant| &contestant.unseen))));
        let sets = [
            (&self.train, self.lines(|contestant| &contestant.train)),
            (&self.unseen, self.lines(|contestant| &contestant.unseen)),
        ];
        parts.push(Part::chart(figures::relative_errors(&sets)));
        parts.extend(convergence::chart(&self.xpnn().model.provenance().runs).map(Part::chart));
        parts
    }

    /// Outputs of all contestants on a set, with their names.
    fn lines<'p>(&'p self, set: impl Fn(&'p Contestant) -> &'p Run) -> Vec<figures::Line<'p>> {
        let line = |contestant: &'p Contestant| figures::Line {
            name: &contestant.name,
            simulated: &set(contestant).simulated,
        };
        self.contestants.iter().map(line).collect()
    }

    /// Why the XPNN has the rate, or has not.
    fn choice_of_rate(&self) -> String {
        let [without, with] = self.validation.as_slice() else {
            return "The record has no time, so the XPNN's input is x alone.".into();
        };
        if self.train.records().len() > 1 {
            return "The records differ in rate, so the XPNN has x and x' as inputs.".into();
        }
        format!(
            "The XPNN has {}: on data held out of the training data its error was {} % of std without x' and {} % with it.",
            if self.has_rate { "x and x' as inputs" } else { "x alone as input" },
            number(*without, 3),
            number(*with, 3)
        )
    }

    fn heading(&self, example: &Example, of: &str) -> String {
        format!("{}: {of}", stands_in(self.specimen.name, &spaced(example.name)))
    }

    fn errors_table(&self, example: &Example) -> Table {
        let unit = unit::of(&self.train.names().output);
        let columns = [
            "model".to_string(),
            "parameters".into(),
            "data".into(),
            format!("MSE ({unit})²"),
            "NRMSE (% of std)".into(),
            "largest error (% of largest output)".into(),
        ];
        let mut table = Table::new(columns).headed(self.heading(example, "errors of free runs"));
        for contestant in &self.contestants {
            for (set, data, run) in
                [("training", &self.train, &contestant.train), ("unseen", &self.unseen, &contestant.unseen)]
            {
                table.push([
                    format!("{}, {set}", contestant.name).into(),
                    contestant.model.parameters().into(),
                    format!(
                        "{} in {}",
                        count(run.errors.samples, "sample"),
                        count(run.errors.records, "record")
                    )
                    .into(),
                    run.errors.mse.into(),
                    run.errors.nrmse_std_percent.into(),
                    (100.0 * run.errors.max_abs_error / largest(data)).into(),
                ]);
            }
        }
        table
    }

    /// Errors on each unseen record, if there are several.
    fn records_table(&self, example: &Example) -> Option<Table> {
        let records = self.unseen.records();
        if records.len() < 2 {
            return None;
        }
        let names =
            self.contestants.iter().map(|contestant| format!("{}, NRMSE (% of std)", contestant.name));
        let row = |name: &str| {
            let of = |contestant: &Contestant| {
                let errors = errors(&self.unseen, &contestant.unseen.simulated, |other| other == name);
                Cell::from(errors.and_then(|errors| errors.nrmse_std_percent))
            };
            std::iter::once(name.into()).chain(self.contestants.iter().map(of)).collect()
        };
        let table = Table::new(std::iter::once("unseen record".to_string()).chain(names))
            .headed(self.heading(example, "unseen records one by one"))
            .with_rows(records.iter().map(|record| row(record.name())));
        Some(table)
    }
}
