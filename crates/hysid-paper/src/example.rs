//! The engine that runs any of the paper's examples: fits, errors, figures, targets.

mod beginning;
pub mod catalogue;
mod figures;
mod tables;

use hysid::Result;
use hysid::data::metrics::{ErrorSums, Errors};
use hysid::data::record::{Dataset, Record};
use hysid::model::{Model, history};
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid::options::{FitSpec, ModelName};
use hysid::specimens::Specimen;
use hysid_core::network::Family;
use hysid_document::{Part, capitalised, convergence, number};

use crate::chapter::{Chapter, ChapterTarget, TargetVerdict};
use crate::conditions::{Observer, Settings};
use crate::fitting::{self, ChoiceResult, FoldKind, MEMBERS, TrainingChoice, medians};
use crate::spread::Spread;
use catalogue::{CaseFigure, Example, ExampleCase, FigureLimit, Opponent};

/// A model with an error above this, in percent of the output's standard deviation, is worse than a constant.
const DIVERGED: f64 = 100.0;

struct SeedRun {
    /// Outputs of each record.
    simulated: Vec<Vec<f64>>,
    errors: Errors,
}

/// A model on both sets of a specimen, from each seed.
struct Contestant {
    name: String,
    parameters: usize,
    train: Vec<SeedRun>,
    unseen: Vec<SeedRun>,
    /// Training of the first seed's model.
    history: Vec<history::Run>,
}

struct PlayedCase<'a> {
    case: &'a ExampleCase,
    specimen: &'static Specimen,
    train: Dataset,
    unseen: Dataset,
    /// Rows at the beginning of the training data whose outputs no model is fitted to.
    blanked: usize,
    contestants: Vec<TrainedModels>,
    /// How the networks were trained, with their names.
    chosen: Vec<(String, ChoiceResult)>,
}

/// A kind of model as one model, and as the median of several if it begins at random.
struct TrainedModels {
    one: Contestant,
    several: Option<Contestant>,
}

/// Runs an example.
pub fn chapter(example: &Example, settings: Settings, observer: &dyn Observer) -> Result<Chapter> {
    let played = example.cases.iter().map(|case| play(example, case, settings, observer));
    let played: Vec<PlayedCase> = played.collect::<Result<_>>()?;
    let mut parts = vec![Part::paragraph(format!("The paper reports {}", example.paper))];
    parts.extend(played.iter().flat_map(|played| played.parts(example)));
    parts.extend(example.causes.iter().map(|&cause| Part::paragraph(cause)));
    parts.push(Part::Note(fitting::words(settings)));
    Ok(Chapter {
        name: example.name.into(),
        title: format!("the paper's {}: {}", spaced(example.name), example.title),
        verdict: played.iter().map(PlayedCase::verdict).collect::<Vec<String>>().join(" "),
        parts,
        targets: played.iter().flat_map(PlayedCase::targets).collect(),
        files: Vec::new(),
    })
}

/// `example 3` for `example3`.
fn spaced(name: &str) -> String {
    name.replace("example", "example ")
}

struct ExampleBench<'a> {
    what: String,
    train: &'a Dataset,
    unseen: &'a Dataset,
    settings: Settings,
    observer: &'a dyn Observer,
}

fn play<'a>(
    example: &Example,
    case: &'a ExampleCase,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<PlayedCase<'a>> {
    let specimen = Specimen::named(case.specimen).expect("the specimen is in the catalogue");
    let whole = specimen.train();
    let (train, blanked) = beginning::trained_on(whole.clone())?;
    let unseen = specimen.test();
    let what = format!("{}, {}", example.name, case.specimen);
    let bench = ExampleBench { what, train: &train, unseen: &unseen, settings, observer };
    let xpnn = bench.choose(Family::Xpnn, case.folds)?;
    let mut contestants = vec![bench.networks("XPNN", Family::Xpnn, xpnn.choice, &train)?];
    let mut chosen = vec![("XPNN".to_string(), xpnn)];
    for opponent in case.opponents {
        let contestant = match *opponent {
            Opponent::WithoutRate => {
                let choice = TrainingChoice { has_rate: false, ..chosen[0].1.choice };
                bench.networks("XPNN without x'", Family::Xpnn, choice, &train)?
            }
            Opponent::WithUnseen => {
                let all = with_unseen(&train, &unseen)?;
                bench.networks("XPNN, fitted to unseen rows too", Family::Xpnn, chosen[0].1.choice, &all)?
            }
            Opponent::Network(family) => {
                let name = family.name().to_uppercase();
                let of_family = bench.choose(family, case.folds)?;
                let trained = bench.networks(&name, family, of_family.choice, &train)?;
                chosen.push((name, of_family));
                trained
            }
            Opponent::GeneralizedPrandtlIshlinskii => {
                let model = ModelName::Classical(ClassicalModel::GeneralizedPrandtlIshlinskii);
                bench.law("GPIM", |seed| FitSpec::of(model, None, seed))?
            }
            Opponent::DegradingBoucWen => bench.law("Bouc-Wen with degradation", |seed| {
                let law = ClassicalOptions::of(ClassicalModel::BoucWen);
                FitSpec::Classical(ClassicalOptions { degradation: true, seed, ..law })
            })?,
        };
        contestants.push(contestant);
    }
    if blanked > 0 {
        let choice = chosen[0].1.choice;
        contestants.push(bench.networks("XPNN, all rows", Family::Xpnn, choice, &whole)?);
    }
    Ok(PlayedCase { case, specimen, contestants, chosen, train, unseen, blanked })
}

/// The training records with the outputs of the unseen ones, which are the same records with other rows blank.
fn with_unseen(train: &Dataset, unseen: &Dataset) -> Result<Dataset> {
    let both = |(train, unseen): (&Record, &Record)| {
        let outputs = train.output().iter().zip(unseen.output());
        let outputs = outputs.map(|(&trained, &unseen)| if trained.is_nan() { unseen } else { trained });
        train.clone().with_output(outputs.collect())
    };
    let records = train.records().iter().zip(unseen.records()).map(both).collect::<Result<_>>()?;
    Dataset::new(train.names().clone(), records)
}

impl ExampleBench<'_> {
    fn choose(&self, family: Family, kind: FoldKind) -> Result<ChoiceResult> {
        let what = format!("{}, {}", self.what, family.name());
        fitting::choose(&what, self.train, family, kind, self.settings, self.observer)
    }

    /// One network of each seed, and the median of several, fitted to these data.
    fn networks(
        &self,
        name: &str,
        family: Family,
        choice: TrainingChoice,
        fitted_to: &Dataset,
    ) -> Result<TrainedModels> {
        let starts = fitting::effort(self.settings).starts;
        let members = MEMBERS.min(starts);
        let mut one = Contestant::new(name);
        let mut several = Contestant::new(&format!("{name}, median of {members}"));
        for seed in fitting::seeds(self.settings) {
            let of_start = |start: u64| fitting::network(family, choice, seed, start);
            let models =
                self.timed(name, seed, || fitting::networks(fitted_to, of_start, starts, self.observer))?;
            let best = &models[..members];
            one.parameters = best[0].parameters();
            several.parameters = best.iter().map(Model::parameters).sum();
            if one.history.is_empty() {
                one.history.clone_from(&best[0].provenance().runs);
            }
            for (data, is_train) in [(self.train, true), (self.unseen, false)] {
                let runs: Vec<SeedRun> = best.iter().map(|model| run(model, data)).collect::<Result<_>>()?;
                let together = median_of(&runs, data);
                several.add(is_train, together);
                one.add(is_train, runs.into_iter().next().expect("there is at least one start"));
            }
        }
        Ok(TrainedModels { one, several: Some(several) })
    }

    fn law(&self, name: &str, request: impl Fn(u64) -> FitSpec) -> Result<TrainedModels> {
        let mut one = Contestant::new(name);
        for seed in fitting::seeds(self.settings) {
            let request = fitting::rival(request(seed), self.settings);
            let models =
                self.timed(name, seed, || Ok(vec![fitting::fit(self.train, &request, self.observer)?]))?;
            one.parameters = models[0].parameters();
            one.add(true, run(&models[0], self.train)?);
            one.add(false, run(&models[0], self.unseen)?);
        }
        Ok(TrainedModels { one, several: None })
    }

    fn timed(&self, name: &str, seed: u64, fit: impl FnOnce() -> Result<Vec<Model>>) -> Result<Vec<Model>> {
        let began = self.observer.clock();
        let models = fit()?;
        self.observer.say(&format!(
            "  {}, seed {seed}: {name} {} % of std, {:.1} s",
            self.what,
            number(fitting::training_error(&models[0]), 3),
            (self.observer.clock() - began).as_secs_f64()
        ));
        Ok(models)
    }
}

impl Contestant {
    fn new(name: &str) -> Self {
        let name = name.to_string();
        Self { name, parameters: 0, train: Vec::new(), unseen: Vec::new(), history: Vec::new() }
    }

    fn add(&mut self, is_train: bool, run: SeedRun) {
        if is_train { self.train.push(run) } else { self.unseen.push(run) }
    }
}

fn run(model: &Model, data: &Dataset) -> Result<SeedRun> {
    let simulated: Vec<Vec<f64>> =
        data.records().iter().map(|record| model.simulate(record)).collect::<Result<_>>()?;
    let errors = errors(data, &simulated, |_| true).expect("specimens have outputs");
    Ok(SeedRun { simulated, errors })
}

/// The medians, row by row, of several runs.
fn median_of(runs: &[SeedRun], data: &Dataset) -> SeedRun {
    let of_record = |record: usize| {
        let outputs: Vec<Vec<f64>> = runs.iter().map(|run| run.simulated[record].clone()).collect();
        medians(&outputs)
    };
    let simulated: Vec<Vec<f64>> = (0..data.records().len()).map(of_record).collect();
    let errors = errors(data, &simulated, |_| true).expect("specimens have outputs");
    SeedRun { simulated, errors }
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

fn largest(data: &Dataset) -> f64 {
    let (low, high) = data.output_range();
    low.abs().max(high.abs())
}

/// How many times another model's error is above that of the XPNN; infinite if the other is worse than a constant.
fn ratio(other: &Errors, xpnn: &Errors) -> f64 {
    let has_diverged = !other.nrmse_std_percent.is_some_and(|percent| percent <= DIVERGED);
    if has_diverged { f64::INFINITY } else { other.mse / xpnn.mse }
}

impl PlayedCase<'_> {
    fn xpnn(&self) -> &TrainedModels {
        &self.contestants[0]
    }

    /// A figure of a contestant over the seeds, and of the rival for a ratio; `None` if it does not exist.
    fn figure(&self, figure: CaseFigure, of: &Contestant, rival: Option<&Contestant>) -> Option<Spread> {
        let percent = |errors: Option<Errors>| errors.and_then(|errors| errors.nrmse_std_percent);
        let value = |seed: usize| -> Option<f64> {
            let (train, unseen) = (&of.train[seed], &of.unseen[seed]);
            match figure {
                CaseFigure::Training => train.errors.nrmse_std_percent,
                CaseFigure::Unseen => unseen.errors.nrmse_std_percent,
                CaseFigure::UnseenMse => Some(unseen.errors.mse),
                CaseFigure::UnseenRecords(names) => {
                    percent(errors(&self.unseen, &unseen.simulated, |name| names.contains(&name)))
                }
                CaseFigure::LargestUnseen => {
                    Some(100.0 * unseen.errors.max_abs_error / largest(&self.unseen))
                }
                CaseFigure::LargestUnseenBetween => self.largest_between(unseen),
                CaseFigure::TimesBelowTraining => Some(ratio(&rival?.train[seed].errors, &train.errors)),
                CaseFigure::TimesBelowUnseen => Some(ratio(&rival?.unseen[seed].errors, &unseen.errors)),
            }
        };
        let values: Option<Vec<f64>> = (0..of.train.len()).map(value).collect();
        Spread::of(values?)
    }

    /// Largest error in percent before the last training row; `None` unless both are rows of one record.
    fn largest_between(&self, unseen: &SeedRun) -> Option<f64> {
        let ([trained], [measured]) = (self.train.records(), self.unseen.records()) else { return None };
        let end = trained.output().iter().rposition(|y| !y.is_nan())?;
        let mut sums = ErrorSums::default();
        sums.add(&measured.output()[..end], &unseen.simulated[0][..end]);
        Some(100.0 * sums.errors(&self.unseen.names().output)?.max_abs_error / largest(&self.unseen))
    }

    fn target(&self, wanted: &FigureLimit) -> ChapterTarget {
        let rival = self.contestants.get(1);
        let xpnn = self.xpnn();
        let one = self.figure(wanted.figure, &xpnn.one, rival.map(|rival| &rival.one));
        let several = xpnn.several.as_ref().and_then(|several| {
            let rival = rival.map(|rival| rival.several.as_ref().unwrap_or(&rival.one));
            self.figure(wanted.figure, several, rival)
        });
        let is_met = |spread: Option<Spread>| spread.is_some_and(|spread| wanted.is_met_by(spread.median));
        let has_diverged = wanted.figure.is_ratio() && one.is_some_and(|spread| spread.median.is_infinite());
        ChapterTarget {
            specimen: self.specimen.name.into(),
            figure: wanted.figure.words(self.contestants.get(1).map(|rival| rival.one.name.as_str())),
            source: wanted.source,
            wanted: wanted.words(),
            one: one.map_or_else(|| "–".into(), Spread::shown),
            several: several.map(Spread::shown),
            verdict: match (has_diverged, is_met(one), is_met(several)) {
                (true, _, _) => TargetVerdict::OtherDiverged,
                (_, true, _) => TargetVerdict::Met,
                (_, false, true) => TargetVerdict::MetBySeveral,
                (_, false, false) => TargetVerdict::Missed,
            },
        }
    }

    fn targets(&self) -> Vec<ChapterTarget> {
        self.case.wanted.iter().map(|wanted| self.target(wanted)).collect()
    }

    fn verdict(&self) -> String {
        let percent = |figure: CaseFigure, of: &Contestant| {
            self.figure(figure, of, None).map_or("–".to_string(), |spread| number(spread.median, 2))
        };
        let xpnn = &self.xpnn().one;
        let mut text = format!(
            "{}: the XPNN's error is {} % of std in training and {} % on unseen data",
            self.specimen.name,
            percent(CaseFigure::Training, xpnn),
            percent(CaseFigure::Unseen, xpnn)
        );
        let records: Vec<&str> = self.unseen.records().iter().map(Record::name).collect();
        if records.len() > 1 {
            text += &format!(" ({})", records.join(", "));
        }
        if let Some(several) = &self.xpnn().several {
            text +=
                &format!("; the median of several networks has {} %", percent(CaseFigure::Unseen, several));
        }
        for TrainedModels { one: rival, .. } in &self.contestants[1..] {
            text += &format!(
                ", {} {} % and {} %",
                rival.name,
                percent(CaseFigure::Training, rival),
                percent(CaseFigure::Unseen, rival)
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
        for (name, chosen) in &self.chosen {
            parts.push(Part::note(chosen.words(name)));
        }
        parts.extend((self.blanked > 0).then(|| Part::note(beginning::words(self.blanked))));
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
        parts.extend(convergence::chart(&self.xpnn().one.history).map(Part::chart));
        let tables = self.chosen.iter().filter_map(|(name, chosen)| {
            chosen.table(&self.heading(example, &format!("choice for {name}"))).map(Part::Table)
        });
        let tables: Vec<Part> = tables.collect();
        if !tables.is_empty() {
            parts.push(Part::Folded(format!("What was tried for {}", specimen.name), tables));
        }
        parts
    }

    /// Outputs of the XPNN and its rival from the first seed on a set, with their names.
    fn lines<'p>(&'p self, set: impl Fn(&'p Contestant) -> &'p Vec<SeedRun>) -> Vec<figures::FigureLine<'p>> {
        let line = |trained: &'p TrainedModels| figures::FigureLine {
            name: &trained.one.name,
            simulated: &set(&trained.one)[0].simulated,
        };
        self.contestants.iter().take(2).map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of this percentage of the standard deviation.
    fn errors_of(percent: f64) -> Errors {
        let mut sums = ErrorSums::default();
        let error = percent / 100.0;
        sums.add(&[1.0, -1.0, 1.0, -1.0], &[1.0 + error, -1.0 + error, 1.0 - error, -1.0 - error]);
        sums.errors("y").unwrap()
    }

    #[test]
    fn a_rival_that_is_worse_than_a_constant_has_no_ratio() {
        let xpnn = errors_of(2.0);
        assert!((ratio(&errors_of(20.0), &xpnn) - 100.0).abs() < 1e-9);
        assert_eq!(ratio(&errors_of(150.0), &xpnn), f64::INFINITY);
    }
}
