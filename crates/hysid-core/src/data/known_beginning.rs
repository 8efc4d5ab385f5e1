//! Known beginnings of records: how many of their first rows have a known output.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
use crate::data::record::{ColumnNames, Dataset, Record};
use crate::data::unit::of_column;
use crate::error::{Channel, DataProblem, Error, OptionError, Result};

/// The known beginning of records: how many of their first rows have a known output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KnownBeginning {
    /// Number of rows.
    Rows(usize),
    /// Duration from the first row, in the unit of time.
    Time(f64),
    /// Share of the rows.
    Share(f64),
}

impl Default for KnownBeginning {
    /// No known beginning.
    fn default() -> Self {
        Self::Rows(0)
    }
}

impl KnownBeginning {
    /// The beginning of each record with which a model with free initial states is judged: a tenth of its rows. Designed.
    pub const JUDGED: Self = Self::Share(0.1);

    /// The beginning with which models are judged on data with these columns: that which was asked for, or
    /// [`KnownBeginning::JUDGED`] for a model with free initial states.
    ///
    /// # Errors
    /// As [`KnownSpan::beginning`].
    pub fn judged(
        asked: Option<&KnownSpan>,
        state: Option<InitialState>,
        names: &ColumnNames,
    ) -> Result<Self> {
        match (asked, state) {
            (Some(asked), _) => asked.beginning(names),
            (None, Some(InitialState::Free)) => Ok(Self::JUDGED),
            (None, _) => Ok(Self::default()),
        }
    }

    /// True without a known beginning.
    pub fn is_none(self) -> bool {
        matches!(self, Self::Rows(0))
            || matches!(self, Self::Time(value) | Self::Share(value) if value <= 0.0)
    }

    /// Rows of a record; none for a time where the record has none.
    pub fn rows(self, record: &Record) -> usize {
        self.rows_of(record.len(), record.time())
    }

    /// As [`KnownBeginning::rows`], of so many rows with these time stamps.
    pub fn rows_of(self, rows: usize, time: Option<&[f64]>) -> usize {
        match (self, time) {
            (Self::Rows(known), _) => known.min(rows),
            (Self::Share(share), _) => (share * rows as f64) as usize,
            (Self::Time(duration), Some(time)) => time.partition_point(|t| t - time[0] <= duration),
            (Self::Time(_), None) => 0,
        }
    }

    /// The record with this known beginning, if it has none of its own.
    ///
    /// # Errors
    /// A beginning without any output.
    pub fn of<'r>(self, record: &'r Record) -> Result<Cow<'r, Record>> {
        let rows = self.rows(record);
        if rows == 0 || !record.known().is_empty() {
            return Ok(Cow::Borrowed(record));
        }
        if record.output()[..rows].iter().all(|y| y.is_nan()) {
            return Err(record.defect(Some(0), Some(Channel::Output), DataProblem::NothingKnown(rows)));
        }
        Ok(Cow::Owned(record.clone().with_known_beginning(rows)))
    }

    /// Checks that some record of the data has an output after this beginning.
    ///
    /// # Errors
    /// An output that is blank there.
    pub fn check_rest(self, data: &Dataset) -> Result<()> {
        let rest = |record: &Record| record.output().iter().skip(self.rows(record)).any(|y| !y.is_nan());
        match data.records().iter().any(rest) {
            true => Ok(()),
            false => {
                Err(data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingAfterBeginning))
            }
        }
    }
}

/// A known beginning as a user gives it: a number of rows, or a duration with its unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum KnownSpan {
    /// Number of rows.
    Rows(usize),
    /// Duration with its unit, such as `0.5s`.
    Time(String),
}

/// Valid values of a known beginning, in words.
pub const KNOWN_SPANS: &str = "give a number of rows, such as 100, or a time with its unit, such as 0.5s";

impl KnownSpan {
    /// The beginning in the unit of the time column.
    ///
    /// # Errors
    /// A duration in another unit, or without a unit of time to compare with.
    pub fn beginning(&self, names: &ColumnNames) -> Result<KnownBeginning> {
        let text = match self {
            Self::Rows(rows) => return Ok(KnownBeginning::Rows(*rows)),
            // A text may have a number of rows, too.
            Self::Time(text) => match text.parse() {
                Ok(rows) => return Ok(KnownBeginning::Rows(rows)),
                Err(_) => text,
            },
        };
        let refused = |needed: String| OptionError::value("known", text.as_str(), needed).into();
        let (duration, unit) = duration(text).ok_or_else(|| refused(KNOWN_SPANS.into()))?;
        match names.time.as_deref().and_then(of_column) {
            Some(of_time) if of_time == unit => Ok(KnownBeginning::Time(duration)),
            Some(of_time) => Err(refused(format!("the unit of time is {of_time}"))),
            None => Err(refused("no unit of time is known; give a number of rows".into())),
        }
    }
}

impl fmt::Display for KnownSpan {
    /// `100 rows`, or a duration as it was given.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Rows(rows) => &rows.to_string(),
            Self::Time(text) => text,
        };
        let rows = if text == "1" { " row" } else { " rows" };
        write!(to, "{text}{}", if text.parse::<usize>().is_ok() { rows } else { "" })
    }
}

impl FromStr for KnownSpan {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let rows = text.parse().ok().filter(|&rows: &usize| rows > 0).map(Self::Rows);
        let time = || duration(text).map(|_| Self::Time(text.into()));
        rows.or_else(time).ok_or_else(|| OptionError::value("known", text, KNOWN_SPANS).into())
    }
}

/// A positive duration and its unit.
fn duration(text: &str) -> Option<(f64, &str)> {
    let (number, unit) = text.split_at(text.find(char::is_alphabetic)?);
    let number: f64 = number.trim().parse().ok()?;
    (number > 0.0 && number.is_finite()).then_some((number, unit))
}
