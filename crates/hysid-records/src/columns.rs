//! Which column is what: found from the names, from options, or from a model.

mod guess;
pub(crate) mod kind;
mod other_table;
pub mod values;

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;

use hysid_core::data::rate::RateMethod;
use hysid_core::data::record::{ColumnNames, Dataset};
use hysid_core::model::Model;
use hysid_core::options::FitSpec;
use hysid_core::options::chosen::{NamedOptions, RateChoice};
use hysid_core::words::{Hint, Words};

use self::guess::Guess;
use self::values::{TimeCheck, ValueStatistics, numbers, plateaus, running_through};
use hysid_core::data::unit::{self, Conversion};
use hysid_document::shell::option;
use hysid_document::visible::{clipped, listed};
use hysid_tables::{Head, Problem, Result, Table, is_record};

/// Value of the choice of a time column for a table without one.
pub const NO_TIME: &str = "none";

/// Roles of columns that the user chose; all others are guessed.
#[derive(Debug, Clone, Default)]
pub struct ColumnChoice {
    /// Column with the name of each row's record.
    pub record: Option<String>,
    /// Time stamps; [`NO_TIME`] if no column has them.
    pub time: Option<String>,
    pub input: Vec<String>,
    pub output: Option<String>,
    /// Rate of the first input.
    pub rate: RateOption,
}

impl ColumnChoice {
    /// True if the choice is that a table has no time stamps.
    fn has_no_time(&self, table: &Head) -> bool {
        self.time.as_deref() == Some(NO_TIME) && table.column(NO_TIME).is_none()
    }

    /// The columns that options name.
    fn names(&self) -> impl Iterator<Item = &String> {
        self.record.iter().chain(&self.time).chain(&self.input).chain(&self.output)
    }

    /// The options that give a command the same columns, for a shell.
    pub fn options(&self) -> Vec<String> {
        let rate = match &self.rate {
            RateOption::Column(name) => Some(name),
            RateOption::Choice(_) => None,
        };
        let named = [("record", &self.record), ("time", &self.time), ("output", &self.output)];
        let named = named.into_iter().filter_map(|(of, name)| Some((of, name.as_ref()?)));
        let named = named.chain(self.input.iter().map(|name| ("input", name)));
        let named = named.chain(rate.map(|name| ("rate", name)));
        named.map(|(of, name)| option(of, name)).collect()
    }
}

/// Where the rate of the first input comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RateOption {
    /// None, computed from the time stamps, or as suits the model.
    Choice(RateChoice),
    Column(String),
}

impl Default for RateOption {
    fn default() -> Self {
        Self::Choice(RateChoice::default())
    }
}

impl RateOption {
    /// Fit specification from the options, for these data.
    pub fn request(&self, chosen: &NamedOptions, data: &Dataset) -> Result<FitSpec> {
        match self {
            Self::Column(_) => Ok(chosen.request(Some(RateMethod::Given), true)),
            Self::Choice(RateChoice::Method(_)) if !data.has_time() => {
                let words = Words::from("there is no time column to compute the rate from");
                Err(Problem::Other(words.advised(time_or_no_rate())))
            }
            Self::Choice(choice) => Ok(chosen.request_for(*choice, data)),
        }
    }
}

/// The columns of each role, by name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Roles {
    /// Column with the name of each row's record.
    pub record: Option<String>,
    pub time: Option<String>,
    pub inputs: Vec<String>,
    /// Given rate of the first input.
    pub rate: Option<String>,
    pub output: String,
    /// Roles that no option decided, in words; `None` if there are none.
    pub guessed: Option<Words>,
    /// Columns that have no role although no option excludes them, each with the reason.
    pub set_aside: Vec<(String, Words)>,
    /// A condition of the test with few values, which divide the rows of each table into records.
    pub condition: Option<String>,
    /// Columns that have the role of a model's column by their units, in a sentence each.
    pub taken: Vec<String>,
    /// Roles that contradict the names of the columns, in a sentence.
    pub note: Option<Words>,
}

impl Roles {
    /// Finds the roles in a table from options and names.
    pub fn detect(table: &Table, options: &ColumnChoice) -> Result<Self> {
        table.require_columns()?;
        let options = &with_full_names(options, table);
        let no_time = options.has_no_time(table);
        let time = options.time.clone().filter(|_| !no_time);
        let rate = match &options.rate {
            RateOption::Column(name) => Some(name.clone()),
            _ => None,
        };
        let mut taken: HashMap<&str, &'static str> = HashMap::new();
        let named =
            [("record", &options.record), ("time", &time), ("rate", &rate), ("output", &options.output)];
        let named = named.into_iter().filter_map(|(option, name)| name.as_ref().map(|name| (option, name)));
        for (option, name) in named.chain(options.input.iter().map(|name| ("input", name))) {
            require(table, name, option)?;
            if let Some(other) = taken.insert(name, option) {
                let words = Words::from(format!("column \"{}\" is named twice, by ", clipped(name)));
                return Err(Problem::Request(words + Hint::Option(other) + " and " + Hint::Option(option)));
            }
        }
        let mut free: Vec<&String> =
            table.header.iter().filter(|name| !taken.contains_key(name.as_str())).collect();
        let claim = |free: &mut Vec<&String>, suits: &dyn Fn(&str) -> bool| {
            let place = free.iter().position(|name| suits(name))?;
            Some(free.remove(place).clone())
        };
        let record = options.record.clone().or_else(|| claim(&mut free, &is_record));
        let records = rows_of_records(table, record.as_deref());
        let named_time = match (no_time, time) {
            (true, _) | (false, Some(_)) => None,
            (false, None) => time_by_name(table, &free, &records)?,
        };
        free.retain(|name| named_time.as_ref() != Some(name));
        let time = options.time.clone().filter(|_| !no_time).or(named_time);
        let mut guess = Guess {
            table,
            record: record.clone(),
            records,
            free,
            time,
            no_time,
            output: options.output.clone(),
            inputs: options.input.clone(),
            set_aside: Vec::new(),
            condition: None,
            note: None,
        };
        guess.complete()?;
        let Guess { free, time, output, set_aside, condition, note, .. } = guess;
        let inputs: Vec<String> = if options.input.is_empty() {
            free.into_iter().cloned().collect()
        } else {
            options.input.clone()
        };
        let from_names = |what: &str, change: Words| {
            let words = Words::from(format!("{what}, from names and values"));
            words.advised(Words::from("change: ") + change)
        };
        let (input, output_hint) = (Words::from(Hint::Option("input")), Hint::Option("output"));
        let guessed = match (options.input.is_empty(), options.output.is_none()) {
            (true, true) => Some(from_names("input and output", input + ", " + output_hint)),
            (true, false) => Some(from_names("input", input)),
            (false, true) => Some(from_names("output", output_hint.into())),
            (false, false) => None,
        };
        match output {
            Some(output) if !inputs.is_empty() => {
                let named = Self { record, time, inputs, rate, output, ..Self::default() };
                Ok(Self { guessed, set_aside, condition, note, ..named })
            }
            output => {
                let output = output.unwrap_or_default();
                let words =
                    format!("no column is left for the input besides output \"{}\"", clipped(&output));
                let columns = format!("columns: {}", listed(&table.header));
                let join =
                    "; input and output in two files? hysid look FILE FILE --join -o both.csv joins them";
                Err(Problem::in_file(&table.file, Words::from(words).advised(columns + join)))
            }
        }
    }

    /// Finds the columns that a model needs, by the names it was trained on or those of options.
    /// `scored` is true if the output is needed too.
    pub fn of_model(model: &Model, table: &Head, options: &ColumnChoice, scored: bool) -> Result<Self> {
        Self::of_inputs(model, &model.names().inputs, model.needs_time(), table, options, scored)
    }

    /// The same with a column of time if the table has one, for a model that needs none.
    pub fn with_time(self, table: &Head, options: &ColumnChoice) -> Result<Self> {
        let time = match (&self.time, &options.time) {
            (Some(_), _) => return Ok(self),
            (None, Some(_)) if options.has_no_time(table) => None,
            (None, Some(name)) => require(table, name, "time").map(|()| Some(full_name(table, name)))?,
            (None, None) => table.header.iter().find(|name| unit::is_time(name)).cloned(),
        };
        let is_used = |name: &String| self.inputs.contains(name) || *name == self.output;
        Ok(Self { time: time.filter(|name| !is_used(name)), ..self })
    }

    /// Finds the columns that the inverse of a model needs: the wanted output, and all inputs but the first.
    pub fn of_inverse(model: &Model, needs_time: bool, table: &Head, options: &ColumnChoice) -> Result<Self> {
        Self::of_inputs(model, &model.names().inputs[1..], needs_time, table, options, true)
    }

    fn of_inputs(
        model: &Model,
        needed: &[String],
        needs_time: bool,
        table: &Head,
        options: &ColumnChoice,
        scored: bool,
    ) -> Result<Self> {
        let names = model.names();
        let taken = RefCell::new(Vec::new());
        let trained = || names.inputs.iter().chain(&names.time).chain(&names.rate).chain([&names.output]);
        // Where several columns of the model have this quantity, the unit does not tell which one is meant.
        let by_unit = |name: &str| {
            let is_free = |other: &&String| !options.names().any(|named| named == *other);
            let is_only = trained().filter(|other| is_of_unit(other, name)).count() == 1;
            only(table.header.iter().filter(is_free), |other| is_of_unit(other, name)).filter(|_| is_only)
        };
        let find = |given: &Option<String>, trained: &str, what: &str, option: &'static str| {
            if let Some(name) = given {
                return require(table, name, option).map(|()| full_name(table, name));
            }
            if table.column(trained).is_some() {
                return Ok(full_name(table, trained));
            }
            if let Some(name) = in_another_unit(table, trained) {
                return Ok(name.clone());
            }
            if let Some(name) = by_unit(trained) {
                let words = "the only column with a unit of this quantity, for the model's";
                taken.borrow_mut().push(format!("taken: {}, {words} {}", clipped(name), clipped(trained)));
                return Ok(name.clone());
            }
            table.require_columns()?;
            let words =
                Words::from(format!("there is no column \"{}\", the model's {what}", clipped(trained)));
            let columns = format!("columns: {}; name another with ", listed(&table.header));
            Err(Problem::in_file(&table.file, words.advised(Words::from(columns) + Hint::Option(option))))
        };
        let given_rate = rate_of_model(model, options)?;
        let inputs: Vec<String> = if options.input.is_empty() {
            let find = |name: &String| find(&None, name, "input", "input");
            needed.iter().map(find).collect::<Result<_>>()?
        } else {
            let (expected, found) = (needed.len(), options.input.len());
            if expected != found {
                if expected == 0 {
                    let words =
                        Words::from("the model has no further inputs; leave ") + Hint::Option("input");
                    return Err(Problem::Request(
                        words + " away: the drive is named after the model's input",
                    ));
                }
                let what = if expected < names.inputs.len() { "further inputs" } else { "inputs" };
                let inputs = listed(needed);
                let words =
                    format!(" names {found} columns, but the model's {what} are {expected}: {inputs}");
                return Err(Problem::Request(Words::from(Hint::Option("input")) + words));
            }
            options
                .input
                .iter()
                .map(|name| require(table, name, "input").map(|()| full_name(table, name)))
                .collect::<Result<_>>()?
        };
        let time = match (needs_time, &names.time) {
            (false, _) => None,
            (true, Some(trained)) => Some(find(&options.time, trained, "time", "time")?),
            (true, None) if options.time.is_some() => Some(find(&options.time, "t", "time", "time")?),
            // Trained without time: a slew limit or a preview needs it.
            (true, None) => match table.header.iter().find(|name| unit::is_time(name)) {
                Some(name) => Some(name.clone()),
                None => {
                    let words = "there is no column of time, which the rate, a slew limit or a preview needs";
                    let columns = Words::from(format!("columns: {}; name one with ", listed(&table.header)));
                    let words = Words::from(words).advised(columns + Hint::Option("time"));
                    return Err(Problem::in_file(&table.file, words));
                }
            },
        };
        // The inverse forms the rate from the inputs that it finds.
        let is_inverse = needed.len() < names.inputs.len();
        let rate = match &names.rate {
            Some(trained) if model.rate() == Some(RateMethod::Given) && !is_inverse => {
                Some(find(&given_rate, trained, "rate", "rate")?)
            }
            _ => None,
        };
        let output = match scored {
            true => find(&options.output, &names.output, "output", "output")?,
            false => options.output.clone().unwrap_or_else(|| names.output.clone()),
        };
        let used =
            |name: &str| inputs.iter().chain(&time).chain(&rate).any(|used| used == name) || output == name;
        let record = match &options.record {
            Some(name) => require(table, name, "record").map(|()| Some(full_name(table, name)))?,
            None => table.header.iter().find(|name| is_record(name) && !used(name)).cloned(),
        };
        Ok(Self { record, time, inputs, rate, output, taken: taken.take(), ..Self::default() })
    }

    pub fn names(&self) -> ColumnNames {
        ColumnNames {
            time: self.time.clone(),
            inputs: self.inputs.clone(),
            rate: self.rate.clone(),
            output: self.output.clone(),
        }
    }

    /// Refuses a further table that lacks a column of the first.
    pub fn check_against(&self, table: &Head, first: &str) -> Result<()> {
        let all = self.record.iter().chain(&self.time).chain(&self.inputs).chain(&self.rate);
        for name in all.chain([&self.output]) {
            if table.column(name).is_none() {
                let columns = listed(&table.header);
                let words =
                    format!("there is no column \"{}\", as in {first} (columns: {columns})", clipped(name));
                return Err(Problem::in_file(&table.file, words));
            }
        }
        Ok(())
    }
}

/// The column that is named like time. If it falls as a field or a temperature does, the user must name it.
fn time_by_name(table: &Table, free: &[&String], records: &[Range<usize>]) -> Result<Option<String>> {
    for name in free.iter().filter(|name| unit::is_time(name)) {
        let running = numbers(table, name).map(|values| ValueStatistics::of(&values, records).running);
        // A single T is a temperature as often.
        let is_temperature =
            name.trim() == "T" && !matches!(running, Some(TimeCheck::Strictly | TimeCheck::WithEqualStamps));
        if is_temperature {
            continue;
        }
        if running == Some(TimeCheck::Falls) {
            let words = format!("column \"{}\" falls, as no time does: name another with ", clipped(name));
            let none = Hint::Value("time", NO_TIME.into());
            let words = Words::from(words) + Hint::Option("time") + ", or use " + none;
            return Err(Problem::in_file(&table.file, words));
        }
        let through = running_through(table, name, free.iter().copied().filter(|other| other != name));
        return Ok(Some(through.unwrap_or(name).clone()));
    }
    Ok(None)
}

/// Rows of each record of a table, where its name or the plateau of its condition changes.
fn rows_of_records(table: &Table, record: Option<&str>) -> Vec<Range<usize>> {
    let Some(place) = record.and_then(|name| table.column(name)) else {
        return std::iter::once(0..table.rows()).collect();
    };
    if let Some(plateaus) = record.and_then(|name| plateaus(table, name)) {
        return plateaus;
    }
    let name = |row: usize| table.cell(row, place).trim();
    let begins = (1..table.rows()).filter(|&row| name(row) != name(row - 1));
    let begins: Vec<usize> = std::iter::once(0).chain(begins).chain([table.rows()]).collect();
    begins.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// The name of a column with the unit that the file gives elsewhere.
fn full_name(table: &Head, name: &str) -> String {
    table.full_name(name).unwrap_or(name).to_string()
}

fn with_full_names(options: &ColumnChoice, table: &Head) -> ColumnChoice {
    let full = |name: &Option<String>| name.as_ref().map(|name| full_name(table, name));
    ColumnChoice {
        record: full(&options.record),
        time: full(&options.time),
        input: options.input.iter().map(|name| full_name(table, name)).collect(),
        output: full(&options.output),
        rate: match &options.rate {
            RateOption::Column(name) => RateOption::Column(full_name(table, name)),
            other => other.clone(),
        },
    }
}

/// Advice on a rate that has no time stamps to be computed from.
pub fn time_or_no_rate() -> Words {
    let none = Hint::Value("rate", "none".into());
    Words::from("name it with ") + Hint::Option("time") + ", or use " + none
}

/// Refuses a table without a column that an option names.
pub fn require(table: &Head, name: &str, option: &'static str) -> Result<()> {
    if table.column(name).is_some() {
        return Ok(());
    }
    let words = Words::from(format!("there is no column \"{}\" for ", clipped(name))) + Hint::Option(option);
    let columns = format!("columns: {}", listed(&table.header));
    Err(Problem::in_file(&table.file, words.advised(columns)))
}

/// The one column of the same quantity in another unit that can be converted, such as `x_m` for `x_mm`.
fn in_another_unit<'t>(table: &'t Head, trained: &str) -> Option<&'t String> {
    let suits = |name: &String| {
        unit::split(name).0 == unit::split(trained).0
            && unit::of_column(name).is_some()
            && Conversion::between(name, trained) != Conversion::Impossible
    };
    only(table.header.iter(), suits)
}

/// True for columns with units of one quantity.
fn is_of_unit(name: &str, trained: &str) -> bool {
    [name, trained].iter().all(|name| unit::of_column(name).is_some())
        && Conversion::between(name, trained) != Conversion::Impossible
}

/// The only one that suits.
fn only<'t>(names: impl Iterator<Item = &'t String>, suits: impl Fn(&String) -> bool) -> Option<&'t String> {
    let mut suitable = names.filter(|name| suits(name));
    suitable.next().filter(|_| suitable.next().is_none())
}

/// The column that `--rate` names for a model with a given rate; a model's method cannot be changed.
fn rate_of_model(model: &Model, options: &ColumnChoice) -> Result<Option<String>> {
    match (&options.rate, model.rate()) {
        (RateOption::Choice(RateChoice::Auto), _) | (RateOption::Choice(RateChoice::None), None) => Ok(None),
        (RateOption::Column(name), Some(RateMethod::Given)) => Ok(Some(name.clone())),
        (RateOption::Choice(RateChoice::Method(asked)), Some(trained)) if *asked == trained => Ok(None),
        _ => {
            let words = Words::from("the rate is part of the model and cannot be changed here: leave out ");
            Err(Problem::Request(words + Hint::Option("rate")))
        }
    }
}
