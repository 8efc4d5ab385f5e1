//! Which of the columns that no option names are time, inputs and output: guessed from names, units and values. What is
//! clear is taken, what accompanies a test is set aside with its reason, and what remains doubtful is a question that
//! names the options that decide it.

use std::ops::Range;

use hysid_core::data::column::{Course, one_signal};
use hysid_core::data::unit;
use hysid_core::data::usual_role::Domain;
use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};
use hysid_tables::{Problem, Result, Table, are_branches};

use super::NO_TIME;
use super::kind::{self, ColumnKind};
use super::values::{self, TimeCheck, ValueStatistics, numbers};

/// More columns than this are not all inputs.
const MOST_INPUTS: usize = 4;

/// Most columns that a question lists.
const MOST_CANDIDATES: usize = 5;

/// Values are not looked at in a table with more free columns than this.
const MOST_READ: usize = 200;

/// Largest drift of a temperature, in kelvins, that drives nothing.
const MOST_DRIFT: f64 = 15.0;

pub struct Guess<'t> {
    pub table: &'t Table,
    /// The column with the names of records.
    pub record: Option<String>,
    /// Rows of each record.
    pub records: Vec<Range<usize>>,
    /// Columns without a role so far, in their order.
    pub free: Vec<&'t String>,
    /// Time stamps, if they are known.
    pub time: Option<String>,
    /// Time is not looked for.
    pub no_time: bool,
    /// The output, if an option names it.
    pub output: Option<String>,
    /// Inputs that options name.
    pub inputs: Vec<String>,
    /// Columns that are left out, each with the reason.
    pub set_aside: Vec<(String, Words)>,
    /// A condition that divides the rows into records.
    pub condition: Option<String>,
    /// Roles that contradict the names, in a sentence.
    pub note: Option<Words>,
}

/// Why a column is set aside, the surest reason first. The last ones are by name alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Text,
    Constant,
    Counts,
    Held,
    CountsInSteps,
    Raw,
    Statistic,
    Counter,
    Integral,
    Kept,
    Derived,
    Condition,
}

/// A column that may be set aside.
struct DoubtfulColumn<'t> {
    name: &'t String,
    rank: Rank,
    reason: Words,
    /// Its values divide the rows into records.
    divides: bool,
}

impl<'t> Guess<'t> {
    /// Guesses: time, output, and inputs where no option names them.
    ///
    /// # Errors
    /// Columns whose names and values do not decide their roles.
    pub fn complete(&mut self) -> Result<()> {
        let before = self.free.len();
        let mut weakest = None;
        if self.free.len() > self.needed() && self.free.len() <= MOST_READ {
            let seen = self.see();
            self.find_time(&seen);
            if !self.has_inputs() || self.output.is_none() {
                weakest = self.set_aside_what_accompanies(&seen);
                self.refuse_growing(&seen)?;
            }
        }
        let follows_the_order = self.free.len() == 2 && before <= 3 && self.set_aside.is_empty();
        self.refuse_channels()?;
        if self.output.is_none() {
            self.guess_output(follows_the_order && self.time_is_first())?;
        }
        if !self.has_inputs() {
            self.set_aside_other_outputs();
            self.refuse_many()?;
            self.refuse_alike()?;
            self.refuse_unclear_inputs()?;
            self.refuse_branches()?;
            self.put_the_main_input_first();
            self.refuse_what_accompanies(weakest)?;
            self.refuse_other_drives()?;
        }
        Ok(())
    }

    fn has_inputs(&self) -> bool {
        !self.inputs.is_empty()
    }

    /// Columns that must be left.
    fn needed(&self) -> usize {
        usize::from(self.output.is_none()) + usize::from(!self.has_inputs())
    }

    fn see(&self) -> Vec<(&'t String, Option<ValueStatistics>)> {
        let see = |name: &&'t String| {
            let seen = numbers(self.table, name).map(|values| ValueStatistics::of(&values, &self.records));
            (*name, seen)
        };
        self.free.iter().map(see).collect()
    }

    fn find_time(&mut self, seen: &[(&'t String, Option<ValueStatistics>)]) {
        let stepped =
            seen.iter().filter(|(_, seen)| seen.is_some_and(|seen| !seen.never_falls)).map(|(name, _)| *name);
        let through = stepped.filter(|name| unit::may_be_time(name)).find_map(|name| {
            let others = seen.iter().map(|(other, _)| *other).filter(|other| *other != name);
            values::running_through(self.table, name, others)
        });
        let is_last = |(name, _): &&(&'t String, Option<ValueStatistics>)| {
            through.is_some_and(|through| through != *name)
        };
        for (name, seen) in seen.iter().filter(|entry| !is_last(entry)).chain(seen.iter().filter(is_last)) {
            let Some(seen) = seen else { continue };
            let is_named = unit::may_be_time(name);
            let is_time = match seen.running {
                TimeCheck::Strictly => {
                    is_named || self.is_first_nameless(name) && seen.course != Course::Counts
                }
                TimeCheck::WithEqualStamps => is_named,
                TimeCheck::Falls | TimeCheck::No => false,
            };
            let is_free = !self.no_time && self.time.is_none();
            match (is_time, is_free) {
                (false, _) => {}
                (true, true) => {
                    self.time = Some((*name).clone());
                    self.free.retain(|other| other != name);
                }
                (true, false) if is_named => {
                    let none = || Hint::Value("time", NO_TIME.into());
                    let reason = match self.no_time {
                        true => Words::from("time, which ") + none() + " leaves out",
                        false => "another time column is used".into(),
                    };
                    self.set_aside(name, reason);
                }
                (true, false) => {}
            }
        }
    }

    /// Sets aside, the surest first, what is no input and no output, as long as there is more than what is needed. Gives
    /// the weakest reason.
    fn set_aside_what_accompanies(&mut self, seen: &[(&'t String, Option<ValueStatistics>)]) -> Option<Rank> {
        let mut doubts: Vec<DoubtfulColumn<'t>> = Vec::new();
        for (name, seen) in seen.iter().filter(|(name, _)| self.free.contains(name)) {
            doubts.extend(self.doubt(name, *seen));
        }
        doubts.sort_by_key(|doubt| doubt.rank);
        let mut weakest = None;
        for doubt in doubts {
            let is_first = doubt.divides && self.condition.is_none();
            if self.set_aside(doubt.name, doubt.reason) {
                weakest = Some(doubt.rank);
                self.condition = self.condition.take().or(is_first.then(|| doubt.name.clone()));
            }
        }
        weakest
    }

    fn doubt(&self, name: &'t String, seen: Option<ValueStatistics>) -> Option<DoubtfulColumn<'t>> {
        let kind = ColumnKind::of(name);
        let doubtful =
            |rank: Rank, reason: Words| Some(DoubtfulColumn { name, rank, reason, divides: false });
        let doubt = |rank: Rank, reason: &str| doubtful(rank, reason.into());
        let by_name = |rank: Rank| doubt(rank, kind.accompanies().unwrap_or_default());
        let Some(seen) = seen else {
            let is_time = unit::may_be_time(name) && self.time.is_none() && !self.no_time;
            return doubt(
                Rank::Text,
                match is_time {
                    true => "text, and no time stamp that Hysid reads",
                    false if self.is_empty(name) => "empty",
                    false => "text",
                },
            );
        };
        if unit::may_be_time(name) && seen.running == TimeCheck::No && kind == ColumnKind::Unknown {
            return doubt(Rank::Text, "time that falls back from one row to the next");
        }
        match seen.course {
            Course::Constant => return doubt(Rank::Constant, "constant"),
            Course::Counts => return doubt(Rank::Counts, "counts the rows"),
            Course::CountsInSteps => {
                let record = Hint::Value("record", name.clone());
                let advice = Words::from("to divide the rows into records: ") + record;
                return doubtful(Rank::CountsInSteps, Words::from("counts up in steps").advised(advice));
            }
            Course::Grows | Course::Varies => {}
        }
        if seen.is_held {
            return doubt(Rank::Held, "held constant");
        }
        if let Some(made) = kind::made_of(name, &self.free) {
            return doubt(Rank::Raw, &format!("raw, and \"{}\" is made of it", clipped(made)));
        }
        match kind {
            ColumnKind::Statistic => by_name(Rank::Statistic),
            ColumnKind::Counter if seen.may_count() => by_name(Rank::Counter),
            ColumnKind::Integral => by_name(Rank::Integral),
            ColumnKind::Derived if kind::is_rate(name) => {
                let advice = Words::from("use it with ") + Hint::Option("rate");
                doubtful(Rank::Derived, Words::from("a rate, not an input").advised(advice))
            }
            ColumnKind::Derived => by_name(Rank::Derived),
            ColumnKind::Condition if seen.is_kept => self.condition_of_few_values(name),
            ColumnKind::Condition => by_name(Rank::Condition),
            ColumnKind::Unknown
                if seen.is_kept && self.free.iter().any(|other| ColumnKind::of(other).drives()) =>
            {
                doubt(Rank::Kept, "few values, each kept for many rows")
            }
            ColumnKind::Drives(Domain::Electricity)
                if seen.is_kept && self.has(ColumnKind::Drives(Domain::Mechanics)) =>
            {
                self.condition_of_few_values(name)
            }
            ColumnKind::Drives(Domain::Mechanics) | ColumnKind::Follows(Domain::Mechanics)
                if self.has(ColumnKind::Drives(Domain::Magnetism))
                    && self.free.iter().any(|name| kind::is_moment(name)) =>
            {
                doubt(Rank::Derived, "about the magnetometer, beside field and moment")
            }
            // The current of a ferroelectric tester is the rate of the charge.
            ColumnKind::Drives(Domain::Electricity)
                if kind::is_current(name)
                    && self.has(ColumnKind::Follows(Domain::Electricity))
                    && self
                        .free
                        .iter()
                        .any(|other| ColumnKind::of(other) == kind && !kind::is_current(other)) =>
            {
                doubt(Rank::Derived, "a current, the rate of the charge")
            }
            // Resistance is calculated where voltage and current are there.
            ColumnKind::Unknown if kind::words(name).iter().any(|word| word == "resistance") => {
                let drives =
                    |other: &&&String| ColumnKind::of(other) == ColumnKind::Drives(Domain::Electricity);
                if self.free.iter().filter(drives).count() < 2 {
                    return None;
                }
                doubt(Rank::Derived, "calculated from other columns")
            }
            ColumnKind::Drives(_)
            | ColumnKind::Follows(_)
            | ColumnKind::Excites
            | ColumnKind::Unknown
            | ColumnKind::Counter => None,
        }
    }

    fn condition_of_few_values(&self, name: &'t String) -> Option<DoubtfulColumn<'t>> {
        let divides = self.record.is_none() && self.records.len() == 1;
        let more = if divides { ", which divide the rows into records" } else { "" };
        let reason = format!("a condition of the test, with few values{more}");
        Some(DoubtfulColumn { name, rank: Rank::Kept, reason: reason.into(), divides })
    }

    fn is_empty(&self, name: &str) -> bool {
        let place = self.table.column(name).unwrap_or_default();
        (0..self.table.rows()).all(|row| self.table.cell(row, place).trim().is_empty())
    }

    fn has(&self, kind: ColumnKind) -> bool {
        self.free.iter().copied().chain(&self.inputs).any(|name| ColumnKind::of(name) == kind)
    }

    /// Refuses a column that only grows, which has no hysteresis, beside others; alone, it may be what is wanted.
    fn refuse_growing(&self, seen: &[(&'t String, Option<ValueStatistics>)]) -> Result<()> {
        if self.has_inputs() || self.free.len() <= self.needed() {
            return Ok(());
        }
        let grows = |seen: &ValueStatistics| seen.course == Course::Grows || seen.never_falls;
        let unclear =
            seen.iter().find(|(name, seen)| self.free.contains(name) && seen.as_ref().is_some_and(grows));
        let Some((name, _)) = unclear else { return Ok(()) };
        // A pure number, such as a water activity, may be the input.
        let pair = self.columns(Some(name.as_str()).filter(|name| !is_pure_number(name)));
        let words = Words::from(format!("column \"{}\" grows from row to row: ", clipped(name)));
        let words = words
            + match self.time {
                None if unit::of_column(name).is_none() && !is_pure_number(name) => {
                    let time = Words::from("if it is time, ") + Hint::Value("time", (*name).clone()) + " ";
                    time + pair + "; otherwise name input and output"
                }
                _ => Words::from("name input and output, for instance ") + pair,
            };
        Err(Problem::in_file(&self.table.file, words))
    }

    /// Refuses more than two columns that have no more than numbers for names.
    fn refuse_channels(&self) -> Result<()> {
        let is_unclear = self.needed() == 2 && (3..=MOST_INPUTS + 1).contains(&self.free.len());
        if is_unclear && self.free.iter().all(|name| kind::is_channel(name)) {
            return Err(self.question("the names of the columns do not tell input and output"));
        }
        Ok(())
    }

    /// Takes the last column; names that say otherwise are a question, or a note where the table is in the documented order.
    fn guess_output(&mut self, follows_the_order: bool) -> Result<()> {
        let Some(last) = self.free.last().copied() else { return Ok(()) };
        let follows = self.follows();
        let mut output = last;
        if self.free.len() > 1 {
            match (follows.as_slice(), ColumnKind::of(last)) {
                ([_, .., other], _)
                    if self.has_inputs() || self.free.iter().any(|name| ColumnKind::of(name).drives()) =>
                {
                    let words = format!(
                        "\"{}\" and \"{}\" could both be the output",
                        clipped(follows[0]),
                        clipped(other)
                    );
                    return Err(self.question(&words));
                }
                ([one], _) if self.has_inputs() => output = one,
                ([one], kind)
                    if *one != last
                        && (self.free.len() > 2 || ColumnKind::are_swapped(ColumnKind::of(one), kind)) =>
                {
                    if !follows_the_order {
                        return Err(self.against_the_order(one, last));
                    }
                    self.note = Some(self.order_believed(one, last));
                }
                // The other column may be anything.
                ([one], ColumnKind::Unknown) if *one != last && !kind::are_documented(&self.free) => {
                    self.note = Some(self.order_believed(one, last));
                }
                ([], kind) if !self.has_inputs() => {
                    let swapped =
                        self.free.iter().find(|name| ColumnKind::are_swapped(ColumnKind::of(name), kind));
                    match swapped {
                        Some(one) if follows_the_order => self.note = Some(self.order_believed(one, last)),
                        Some(one) => return Err(self.against_the_order(one, last)),
                        None => {}
                    }
                }
                _ => {}
            }
            let is_known = self.free.iter().any(|name| ColumnKind::of(name).drives());
            if output == last
                && self.free.len() > 2
                && !(self.has_inputs() || is_known || kind::are_documented(&self.free))
            {
                self.note = Some(self.taken_by_place(last));
            }
        }
        self.free.retain(|name| *name != output);
        self.output = Some(output.clone());
        Ok(())
    }

    /// Columns that are outputs by their names. A pressure beside field and moment is none: nothing of its branch of physics
    /// drives it.
    fn follows(&self) -> Vec<&'t String> {
        let all = self.free.iter().copied().filter(|name| ColumnKind::of(name).follows());
        let is_driven = |name: &&&String| match ColumnKind::of(name) {
            ColumnKind::Follows(domain) => self.has(ColumnKind::Drives(domain)),
            _ => false,
        };
        let all: Vec<&'t String> = all.collect();
        let driven: Vec<&'t String> = all.iter().filter(is_driven).copied().collect();
        if driven.is_empty() { all } else { driven }
    }

    fn against_the_order(&self, one: &str, last: &str) -> Problem {
        let words = Words::from(format!(
            "\"{}\" is the last column, but \"{}\" looks more like the output: choose with ",
            clipped(last),
            clipped(one),
        ));
        // Of more than two columns, the input must be named too.
        let choice = |output: &str| match self.input_of(output, None).filter(|_| self.free.len() > 2) {
            Some(input) => {
                Words::from(Hint::Value("input", input.clone())) + " " + Hint::Value("output", output.into())
            }
            None => Hint::Value("output", output.into()).into(),
        };
        Problem::in_file(&self.table.file, words + choice(one) + " or " + choice(last))
    }

    /// The likeliest input of an output: what drives its branch of physics, or anything, or another column.
    fn input_of(&self, output: &str, avoided: Option<&str>) -> Option<&String> {
        let is_avoided = |name: &String| avoided == Some(name.as_str());
        let is_other = |name: &&String| *name != output && !are_of_one_quantity(name, output);
        let others = || self.free.iter().copied().filter(is_other).filter(|name| !is_avoided(name));
        let is_condition = |name: &String| {
            ColumnKind::of(name) == ColumnKind::Condition
                && self.set_aside.iter().any(|(other, _)| other == name)
        };
        let rest = || self.table.header.iter().filter(is_other);
        let of_domain = |name: &&String| match ColumnKind::of(output) {
            ColumnKind::Follows(domain) => ColumnKind::of(name) == ColumnKind::Drives(domain),
            _ => false,
        };
        self.inputs
            .first()
            .or_else(|| alike(output, others().filter(of_domain)))
            .or_else(|| alike(output, others().filter(|name| ColumnKind::of(name).drives())))
            .or_else(|| others().find(|name| !ColumnKind::of(name).follows()))
            .or_else(|| others().next())
            .or_else(|| rest().find(|name| is_avoided(name)))
            .or_else(|| rest().find(|name| is_condition(name)))
    }

    fn order_believed(&self, one: &str, last: &str) -> Words {
        let words = Words::from(format!(
            "{}: output \"{}\", because it is the last column, although \"{}\" looks more like an output",
            self.table.file,
            clipped(last),
            clipped(one),
        ));
        words.advised(Words::from("to change it: ") + Hint::Value("output", one.into()))
    }

    fn taken_by_place(&self, last: &str) -> Words {
        let words = Words::from(format!(
            "{}: the names do not tell input and output: \"{}\" is taken for the output, because it is the last column, and \
             the others for inputs",
            self.table.file,
            clipped(last)
        ));
        let change = Words::from("to change it: ") + Hint::Option("input") + ", " + Hint::Option("output");
        words.advised(change)
    }

    /// Other outputs beside the one that is known are no inputs if another column is.
    fn set_aside_other_outputs(&mut self) {
        if self.output.as_deref().is_some_and(|output| ColumnKind::of(output).follows())
            && self.free.iter().any(|name| ColumnKind::of(name).drives())
        {
            for name in self.free.clone() {
                if ColumnKind::of(name).follows() {
                    self.set_aside(name, "another output".into());
                }
            }
        }
    }

    fn time_is_first(&self) -> bool {
        let place = |name: &str| self.table.column(name);
        let first = self.free.first().and_then(|name| place(name));
        self.time.as_deref().and_then(place).is_none_or(|time| first.is_some_and(|first| time < first))
    }

    fn is_first_nameless(&self, name: &str) -> bool {
        self.table.layout.header_lines.is_empty() && self.time.is_none() && name == "c1"
    }

    fn set_aside(&mut self, name: &str, reason: Words) -> bool {
        let is_more = self.free.len() > self.needed();
        if is_more {
            self.free.retain(|other| *other != name);
            self.set_aside.push((name.to_string(), reason));
        }
        is_more
    }

    fn refuse_many(&self) -> Result<()> {
        if self.free.len() <= MOST_INPUTS {
            return Ok(());
        }
        let words = Words::from(format!("{} columns could be inputs: name them with ", self.free.len()));
        Err(Problem::in_file(
            &self.table.file,
            words + Hint::Option("input") + ", for instance " + self.columns(None),
        ))
    }

    fn refuse_alike(&self) -> Result<()> {
        let columns: Vec<(&&String, Vec<f64>)> =
            self.free.iter().filter_map(|name| Some((name, numbers(self.table, name)?))).collect();
        for (place, (name, values)) in columns.iter().enumerate() {
            for (other, other_values) in &columns[..place] {
                if let Some(correlation) = one_signal(other_values, values) {
                    let words = Words::from(format!(
                        "columns \"{}\" and \"{}\" are nearly the same signal (correlation {correlation:.4}), such as \
                         a command and its measurement: name the input with ",
                        clipped(other),
                        clipped(name),
                    ));
                    let output = self.output.iter().map(|output| Hint::Value("output", output.clone()));
                    let input = |name: &str| {
                        let input = Words::from(Hint::Value("input", name.into()));
                        output.clone().fold(input, |words, output| words + " " + output)
                    };
                    let (first, second) = if kind::is_command(other) { (name, other) } else { (other, name) };
                    let words = words + input(first) + " or " + input(second);
                    return Err(Problem::in_file(&self.table.file, words));
                }
            }
        }
        Ok(())
    }

    /// Refuses several columns of one kind, and unknown ones beside a known one: they may be inputs, copies or neither.
    fn refuse_unclear_inputs(&self) -> Result<()> {
        let [first, others @ ..] = self.free.as_slice() else { return Ok(()) };
        let known: Vec<&&String> = self.free.iter().filter(|name| ColumnKind::of(name).drives()).collect();
        if others.is_empty() || known.is_empty() {
            return Ok(());
        }
        // A force over displacement and current, as of a damper with a magnetic liquid.
        let output = self.output.as_deref().map(ColumnKind::of);
        let is_damper = output == Some(ColumnKind::Follows(Domain::Mechanics))
            && self.has(ColumnKind::Drives(Domain::Mechanics))
            && self.has(ColumnKind::Drives(Domain::Electricity))
            && self.free.len() == 2;
        if is_damper {
            return Ok(());
        }
        let names = if others.len() == 1 {
            format!("\"{}\" and \"{}\" could both be inputs", clipped(first), clipped(others[0]))
        } else {
            format!("{} columns could be inputs", self.free.len())
        };
        Err(self.question(&names))
    }

    /// Refuses one branch of a quantity as the input of the other, as of sorption and desorption.
    fn refuse_branches(&self) -> Result<()> {
        if let ([input], Some(output)) = (self.free.as_slice(), &self.output)
            && are_branches(input, output)
            && self.input_of(output, None).is_some()
        {
            let words = "are two branches of one quantity";
            return Err(self.question(&format!(
                "\"{}\" and \"{}\" {words}",
                clipped(input),
                clipped(output)
            )));
        }
        Ok(())
    }

    /// The input of the output's own branch of physics is the hysteretic one.
    fn put_the_main_input_first(&mut self) {
        let Some(ColumnKind::Follows(domain)) = self.output.as_deref().map(ColumnKind::of) else { return };
        self.free.sort_by_key(|name| ColumnKind::of(name) != ColumnKind::Drives(domain));
    }

    /// Refuses an input or output that only accompanies by its name if others like it, or weaker ones, were set aside.
    fn refuse_what_accompanies(&self, weakest: Option<Rank>) -> Result<()> {
        if weakest.is_none_or(|rank| rank < Rank::Statistic) {
            return Ok(());
        }
        let used = self.free.iter().copied().chain(self.output.as_ref().filter(|_| self.needed() == 1));
        let doubtful = used.filter(|name| ColumnKind::of(name).accompanies().is_some()).collect::<Vec<_>>();
        if let Some(name) = doubtful.first() {
            return Err(self.question(&format!("\"{}\" is no sure input or output", clipped(name))));
        }
        // A field of few values beside a temperature that varies: which one drives?
        if let [input] = self.free.as_slice()
            && weakest == Some(Rank::Condition)
            && numbers(self.table, input)
                .is_some_and(|values| ValueStatistics::of(&values, &self.records).is_kept)
        {
            return Err(
                self.question(&format!("\"{}\" keeps few values, and a condition varies", clipped(input)))
            );
        }
        Ok(())
    }

    /// Refuses a battery whose current stands last, and a movement beside a temperature that changes much: it may drive.
    fn refuse_other_drives(&self) -> Result<()> {
        let ([input], Some(output)) = (self.free.as_slice(), &self.output) else { return Ok(()) };
        let set_aside = || self.set_aside.iter().map(|(name, _)| name);
        // A capacity, a temperature or hours beside voltage and current: a cell, which the current drives.
        let is_of_cell =
            |name: &String| matches!(ColumnKind::of(name), ColumnKind::Integral | ColumnKind::Condition);
        let takes_long = || {
            self.time
                .as_deref()
                .is_some_and(|time| matches!(unit::split(time).1.as_deref(), Some("h" | "hr" | "d")))
        };
        if kind::is_current(output)
            && ColumnKind::of(input) == ColumnKind::Drives(Domain::Electricity)
            && (set_aside().any(is_of_cell) || takes_long())
        {
            return Err(self.against_the_order(input, output));
        }
        let changes_much = |name: &&String| {
            ColumnKind::of(name) == ColumnKind::Condition
                && numbers(self.table, name).is_some_and(|values| values::span(&values) > MOST_DRIFT)
                && self.condition.as_ref() != Some(name)
        };
        if let (false, Some(name)) = (ColumnKind::of(output).follows(), set_aside().find(changes_much)) {
            return Err(self.question(&format!(
                "\"{}\" and \"{}\" could both be the input",
                clipped(name),
                clipped(input)
            )));
        }
        Ok(())
    }

    /// A question, with the options that decide it.
    fn question(&self, words: &str) -> Problem {
        let words =
            Words::from(format!("{words}: name input and output, for instance ")) + self.columns(None);
        Problem::in_file(&self.table.file, words)
    }

    /// Options that name the likeliest columns, ready to be pasted, and the others that may be meant.
    fn columns(&self, avoided: Option<&str>) -> Words {
        let mut free = self.free.clone();
        let is_meant = |name: &&String| avoided != Some(name.as_str());
        let follows = self.follows();
        let varies = |name: &&&String| {
            is_meant(name) && numbers(self.table, name).is_none_or(|values| !values::is_steady(&values))
        };
        let mut meant = follows.iter();
        let of_follows = meant.clone().rfind(varies).or_else(|| meant.rfind(|name| is_meant(name))).copied();
        let output = self.output.as_ref().or(of_follows).or(free.iter().copied().rfind(is_meant));
        let Some((input, output)) = output.and_then(|output| Some((self.input_of(output, avoided)?, output)))
        else {
            return Words::default();
        };
        let pair = Words::from(Hint::Value("input", input.clone())) + " ";
        let pair = pair + Hint::Value("output", output.clone());
        if ColumnKind::of(input).drives() && ColumnKind::of(output).follows() {
            return pair;
        }
        free.sort_by_key(|name| !ColumnKind::of(name).drives());
        let more = match free.len().saturating_sub(MOST_CANDIDATES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        free.truncate(MOST_CANDIDATES);
        pair.advised(format!("columns: {}{more}", listed(&free)))
    }
}

/// True for the name of a pure number, such as a water activity.
fn is_pure_number(name: &str) -> bool {
    name.ends_with("[-]")
        || name.ends_with("(-)")
        || kind::words(name).iter().any(|word| ["aw", "activity"].contains(&word.as_str()))
}

/// True for two branches of one quantity, or the same column of two tables side by side.
fn are_of_one_quantity(one: &str, other: &str) -> bool {
    let plain = |name: &'_ str| -> usize {
        let number =
            name.rsplit_once(" (").filter(|(_, number)| number.starts_with(|c: char| c.is_ascii_digit()));
        number.map_or(name.len(), |(name, _)| name.len())
    };
    let (one, other) = (&one[..plain(one)], &other[..plain(other)]);
    one == other || are_branches(one, other)
}

/// The name that has the most words in common with another, such as `Disp B` with `Force B`; the first of equals.
fn alike<'n>(name: &str, others: impl Iterator<Item = &'n String>) -> Option<&'n String> {
    let words = |name: &str| -> Vec<String> {
        let words = name.split(|letter: char| !letter.is_alphanumeric());
        words.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
    };
    let own = words(name);
    let common = |other: &str| words(other).iter().filter(|word| own.contains(word)).count();
    others.reduce(|best, other| if common(other) > common(best) { other } else { best })
}
