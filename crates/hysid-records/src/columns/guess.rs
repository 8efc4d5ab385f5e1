//! Which of the columns that no option names are time, inputs and output: guessed from names, units and values. A guess
//! that is more likely wrong than right is refused.

use std::ops::Range;

use anyhow::{Result, bail};
use hysid_core::data::column::{Course, Domain, Part, one_signal};
use hysid_core::data::unit;

use hysid_document::visible::{clipped, listed};
use hysid_tables::{CellReader, ColumnReader, Table, starts_again};

/// More columns than this are not all inputs.
const MOST_INPUTS: usize = 4;

/// Values are not looked at in a table with more free columns than this.
const MOST_READ: usize = 200;

/// What is to be guessed, and from what.
pub struct Guess<'t> {
    pub table: &'t Table,
    /// Rows of each record.
    pub records: Vec<Range<usize>>,
    /// Columns without a role so far, in their order.
    pub free: Vec<&'t String>,
    /// Time stamps, if they are known.
    pub time: Option<String>,
    /// The output, if an option names it.
    pub output: Option<String>,
    /// An option names the inputs.
    pub has_inputs: bool,
    /// Columns that are left out, each with the reason.
    pub set_aside: Vec<(String, &'static str)>,
}

impl Guess<'_> {
    /// Guesses: time, output, and inputs where no option names them.
    ///
    /// # Errors
    /// Columns of which the names and values tell that the guess would be wrong.
    pub fn complete(&mut self) -> Result<()> {
        if self.free.len() > self.needed() && self.free.len() <= MOST_READ {
            self.set_aside_what_no_input_is()?;
        }
        if self.output.is_none() {
            self.output = self.last_that_may_be_output();
            self.refuse_the_inverse()?;
        }
        if !self.has_inputs {
            self.set_aside_velocity();
            self.refuse_many()?;
            self.refuse_alike()?;
        }
        Ok(())
    }

    /// The last column that is no temperature or the like.
    fn last_that_may_be_output(&mut self) -> Option<String> {
        let accompanies = |name: &&&String| Part::of(name) == Some(Part::Accompanies);
        let place =
            self.free.iter().rposition(|name| !accompanies(&name)).or(self.free.len().checked_sub(1))?;
        Some(self.free.remove(place).clone())
    }

    /// Columns that must be left.
    fn needed(&self) -> usize {
        usize::from(self.output.is_none()) + usize::from(!self.has_inputs)
    }

    /// Sets aside text, counters, constants and time stamps, as long as there is more than what is needed.
    fn set_aside_what_no_input_is(&mut self) -> Result<()> {
        let mut unclear = Vec::new();
        for name in self.free.clone() {
            let values = self.values(name);
            let parts = values.as_ref().map(|values| self.parts(values));
            let runs = parts.as_ref().map(|parts| Running::of(parts));
            let course = parts.map(Course::of);
            let is_time = match runs {
                Some(Running::Strictly) => unit::may_be_time(name) || self.is_first_nameless(name),
                Some(Running::WithEqualStamps) => unit::may_be_time(name),
                Some(Running::No) | None => false,
            };
            if is_time && (course != Some(Course::Counts) || unit::may_be_time(name)) {
                self.take_time(name);
                continue;
            }
            // Where nothing else is to be guessed, columns without a role need no reason.
            if self.has_inputs && self.output.is_some() {
                continue;
            }
            let reason = match course {
                None => "text",
                Some(Course::Counts) => "counts the rows",
                Some(Course::Constant) => "constant",
                Some(Course::Grows) => {
                    unclear.push((name, "grows from row to row: name it with --time"));
                    continue;
                }
                Some(Course::CountsInSteps) => {
                    unclear.push((name, "counts up in steps: name it with --record"));
                    continue;
                }
                Some(Course::Varies) => continue,
            };
            self.set_aside(name, reason);
        }
        // A column that only grows has no hysteresis; alone, it may still be what is wanted.
        match unclear.first() {
            Some((name, what)) if !self.has_inputs && self.free.len() > self.needed() => bail!(
                "{}: column \"{}\" {what}, or name input and output with --input and --output",
                self.table.file,
                clipped(name)
            ),
            _ => Ok(()),
        }
    }

    /// Sets aside the velocity beside a displacement and a force, as `hysid force` writes it: it is the rate of the input, and
    /// no second input.
    fn set_aside_velocity(&mut self) {
        if self.output.as_deref().and_then(Part::of) != Some(Part::Follows(Domain::Mechanics)) {
            return;
        }
        let is_velocity = |name: &str| unit::split(name).0 == "velocity";
        let drives = |name: &&&String| !is_velocity(name) && Part::of(name) != Some(Part::Accompanies);
        if !self.free.iter().any(|name| drives(&name)) {
            return;
        }
        let (velocities, others) = self.free.iter().partition(|name| is_velocity(name));
        self.free = others;
        let velocities: Vec<&String> = velocities;
        let reason = "a rate, not an input (use it with --rate)";
        self.set_aside.extend(velocities.into_iter().map(|name| (name.clone(), reason)));
    }

    fn is_first_nameless(&self, name: &str) -> bool {
        self.table.layout.header_lines.is_empty()
            && self.time.is_none()
            && self.table.header.first().is_some_and(|first| first == name)
    }

    /// The values of each record.
    fn parts<'v>(&self, values: &'v [f64]) -> Vec<&'v [f64]> {
        self.records.iter().map(|rows| &values[rows.clone()]).collect()
    }

    fn take_time(&mut self, name: &String) {
        if self.time.is_some() {
            return self.set_aside(name, "a second time");
        }
        self.time = Some(name.clone());
        self.free.retain(|other| *other != name);
    }

    fn set_aside(&mut self, name: &String, reason: &'static str) {
        if self.free.len() > self.needed() {
            self.free.retain(|other| *other != name);
            self.set_aside.push((name.clone(), reason));
        }
    }

    /// The numbers of a column, NaN where it is blank; `None` if its first cells are no numbers.
    fn values(&self, name: &str) -> Option<Vec<f64>> {
        let place = self.table.column(name)?;
        let mut cells = CellReader::new(self.table.numbers());
        let mut column = ColumnReader::new(self.table, place);
        let number = |(row, &line): (usize, &u64)| {
            column.number(self.table, &mut cells, self.table.cell(row, place), line).ok()
        };
        let numbers: Vec<Option<f64>> = self.table.lines.iter().enumerate().map(number).collect();
        // A single word among numbers is a mistake, which is told where the column is read for its numbers.
        let is_text = numbers.iter().all(|number| number.is_none_or(f64::is_nan));
        (!is_text).then(|| numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }

    fn refuse_the_inverse(&self) -> Result<()> {
        let Some(output) = self.output.as_deref().filter(|_| !self.has_inputs) else { return Ok(()) };
        let is_swapped = |input: &&&String| Part::are_swapped(Part::of(input), Part::of(output));
        match self.free.iter().find(is_swapped) {
            None => Ok(()),
            Some(input) => {
                let (input, output) = (clipped(input), clipped(output));
                bail!(
                    "{}: \"{output}\" is in the last column, but \"{input}\" looks more like the output: \
                     choose with --output {input} or --output {output}",
                    self.table.file
                )
            }
        }
    }

    fn refuse_many(&self) -> Result<()> {
        if self.free.len() <= MOST_INPUTS {
            return Ok(());
        }
        let names: Vec<String> = self.free.iter().map(|name| (*name).clone()).collect();
        bail!(
            "{}: {} columns could be inputs: name them with --input ({})",
            self.table.file,
            names.len(),
            listed(&names)
        )
    }

    fn refuse_alike(&self) -> Result<()> {
        let columns: Vec<(&&String, Vec<f64>)> =
            self.free.iter().filter_map(|name| Some((name, self.values(name)?))).collect();
        for (place, (name, values)) in columns.iter().enumerate() {
            for (other, other_values) in &columns[..place] {
                if let Some(correlation) = one_signal(other_values, values) {
                    bail!(
                        "{}: columns \"{}\" and \"{}\" are nearly the same signal (correlation {correlation:.4}), such as \
                         a command and its measurement: name the input with --input",
                        self.table.file,
                        clipped(other),
                        clipped(name)
                    );
                }
            }
        }
        Ok(())
    }
}

/// Whether values may be time stamps: they grow, and may start again where a record begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Running {
    Strictly,
    /// Some are equal to the one before, as of a clock of few digits.
    WithEqualStamps,
    No,
}

impl Running {
    fn of(records: &[&[f64]]) -> Self {
        let (mut equal, mut rises) = (0, 0);
        for values in records {
            let Some(&first) = values.first() else { continue };
            let mut first = first;
            for pair in values.windows(2) {
                match pair[1] - pair[0] {
                    step if step > 0.0 => rises += 1,
                    0.0 => equal += 1,
                    _ if starts_again(first, pair[0], pair[1]) => first = pair[1],
                    _ => return Self::No,
                }
            }
        }
        match (rises, equal) {
            (0, _) => Self::No,
            (_, 0) => Self::Strictly,
            _ => Self::WithEqualStamps,
        }
    }
}
