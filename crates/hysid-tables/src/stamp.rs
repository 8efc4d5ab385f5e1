//! Time stamps that are no plain numbers: a clock, or a date with a clock.

use jiff::civil;

pub const DAY: f64 = 86_400.0;

/// Fewest characters of a time stamp.
const SHORTEST: usize = 7;

/// Beginnings of the names of months in English, German, French, Spanish, Italian and Portuguese, lower case.
const MONTHS: [&str; 12] = [
    "jan janv ene gen",
    "feb fév fev",
    "mar mär mrz mars",
    "apr avr abr",
    "may mai mag",
    "jun juin giu",
    "jul juil lug",
    "aug août aou ago",
    "sep set",
    "oct okt ott out",
    "nov",
    "dec dez déc dic",
];

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamp {
    date: Option<Date>,
    /// Seconds since midnight.
    seconds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Date {
    Day(i64),
    /// Two numbers of which one is the day and one the month, and the year.
    Slashed(i16, i16, i16),
}

impl Stamp {
    /// The time stamp in a cell: `12:30:05.25`, `2024-03-01T12:30:05Z`, `1.3.2024 12:30:05,25`, `3/1/2024 0:30 PM`,
    /// `01-Mar-2024 12:30`, `Mar 1, 2024`; `None` for anything else. A clock alone needs its seconds: `12:30` may be hours
    /// and minutes or minutes and seconds.
    pub fn of(cell: &str) -> Option<Self> {
        let cell = cell.trim();
        // Most cells are numbers.
        if cell.len() < SHORTEST {
            return None;
        }
        let Some(colon) = cell.find(':') else {
            // A date without a clock needs a year of four digits: 1.2.3 is a version or an address.
            let has_year = cell.split(|c: char| !c.is_ascii_digit()).any(|part| part.len() == 4);
            return Some(Self { date: Some(date_of(cell).filter(|_| has_year)?), seconds: 0.0 });
        };
        let hours = cell[..colon].trim_end_matches(|c: char| c.is_ascii_digit());
        let clock = &cell[hours.len()..];
        match hours.strip_suffix(['T', ' ']).map(str::trim_end) {
            None if hours.is_empty() => Some(Self { date: None, seconds: clock_of(clock, true)? }),
            Some(date) => Some(Self { date: Some(date_of(date)?), seconds: clock_of(clock, false)? }),
            None => None,
        }
    }
}

/// Seconds since midnight of a clock with or without seconds; `None` for a date or anything else.
pub fn clock(cell: &str) -> Option<f64> {
    let cell = cell.trim();
    (cell.contains(':') && cell.starts_with(|c: char| c.is_ascii_digit())).then(|| clock_of(cell, false))?
}

/// True for a date without a clock.
pub fn is_date(cell: &str) -> bool {
    !cell.contains(':') && Stamp::of(cell).is_some()
}

/// The seconds of a clock, with an offset from universal time subtracted. Behind a date, the seconds may be missing.
fn clock_of(text: &str, needs_seconds: bool) -> Option<f64> {
    let (text, half_day) = match text.char_indices().rev().find(|(_, c)| c.is_ascii_digit()) {
        Some((last, _)) => match text[last + 1..].trim().to_ascii_uppercase().as_str() {
            "" | "Z" => (&text[..=last], None),
            "AM" | "A.M." => (&text[..=last], Some(0.0)),
            "PM" | "P.M." => (&text[..=last], Some(0.5 * DAY)),
            _ => return None,
        },
        None => return None,
    };
    let (clock, offset) = match text.rfind(['+', '-']) {
        Some(place) => (text[..place].trim_end(), offset_of(&text[place..])?),
        None => (text, 0.0),
    };
    let mut parts = clock.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next());
    let seconds = seconds.or((!needs_seconds).then_some("0"))?;
    if parts.next().is_some() || [hours, minutes].iter().any(|part| part.is_empty() || part.len() > 2) {
        return None;
    }
    let is_plain = seconds.starts_with(|c: char| c.is_ascii_digit())
        && seconds.chars().all(|c| c.is_ascii_digit() || c == '.' || c == ',');
    let (hours, minutes): (u32, u32) = (hours.parse().ok()?, minutes.parse().ok()?);
    let seconds: f64 = seconds.replace(',', ".").parse().ok().filter(|_| is_plain)?;
    if minutes > 59 || seconds >= 61.0 {
        return None;
    }
    let hours = match half_day {
        Some(half) if (1..=12).contains(&hours) => f64::from(hours % 12) * 3600.0 + half,
        Some(_) => return None,
        None => f64::from(hours) * 3600.0,
    };
    Some(hours + f64::from(minutes) * 60.0 + seconds - offset)
}

/// `+01:00`, `-0530` or `+02` in seconds.
fn offset_of(text: &str) -> Option<f64> {
    let (sign, digits) = text.split_at(1);
    let digits: String = digits.chars().filter(|&c| c != ':').collect();
    if !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let number = |part: &str| part.parse::<u32>().ok().map(f64::from);
    let seconds = match digits.len() {
        2 => 3600.0 * number(&digits)?,
        4 => 3600.0 * number(&digits[..2])? + 60.0 * number(&digits[2..])?,
        _ => return None,
    };
    Some(if sign == "-" { -seconds } else { seconds })
}

fn date_of(text: &str) -> Option<Date> {
    if text.contains(char::is_alphabetic) {
        return date_with_name(text).map(Date::Day);
    }
    let separator = text.chars().find(|c| !c.is_ascii_digit())?;
    let parts: Vec<i16> =
        text.split(separator).map(|part| part.parse().ok()).collect::<Option<Vec<i16>>>()?;
    let [first, second, third] = parts[..] else { return None };
    let long = |year: i16| if year < 100 { year + 2000 } else { year };
    match separator {
        '-' | '/' | '.' if first > 31 => day_of(first, second, third).map(Date::Day),
        '.' => day_of(long(third), second, first).map(Date::Day),
        '/' | '-' => {
            let date = (day_of(long(third), first, second), day_of(long(third), second, first));
            match date {
                (None, None) => None,
                (Some(day), None) | (None, Some(day)) => Some(Date::Day(day)),
                _ => Some(Date::Slashed(first, second, long(third))),
            }
        }
        _ => None,
    }
}

/// Days since 1970 of a date with the name of its month: `01-Mar-2024`, `1. März 2024`, `Fri, Mar 1, 2024`, `2024-Mar-01`.
fn date_with_name(text: &str) -> Option<i64> {
    let is_word = |part: &&str| part.starts_with(char::is_alphabetic);
    let parts = text.split([' ', '-', '/', '.', ',']).filter(|part| !part.is_empty());
    let (words, numbers): (Vec<&str>, Vec<&str>) = parts.partition(is_word);
    let month = match words[..] {
        [month] => month,
        // The day of the week stands first.
        [_, month] if text.starts_with(char::is_alphabetic) => month,
        _ => return None,
    };
    let lower = month.to_lowercase();
    let is_named = |names: &&str| names.split(' ').any(|name| lower.starts_with(name));
    let month = MONTHS.iter().rposition(is_named).filter(|_| lower.chars().all(char::is_alphabetic))?;
    let [first, second] = numbers[..] else { return None };
    let (day, year) = if first.len() == 4 { (second, first) } else { (first, second) };
    let year: i16 = year.parse().ok().filter(|_| matches!(year.len(), 2 | 4))?;
    day_of(if year < 100 { year + 2000 } else { year }, month as i16 + 1, day.parse().ok()?)
}

fn day_of(year: i16, month: i16, day: i16) -> Option<i64> {
    let date = civil::Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()?;
    let since = date.since((jiff::Unit::Day, civil::date(1970, 1, 1))).ok()?;
    Some(i64::from(since.get_days()))
}

/// Reads the time stamps of a column: seconds since the first one.
#[derive(Debug, Clone, Default)]
pub struct StampReader {
    /// Day and seconds of the first stamp.
    first: Option<(i64, f64)>,
    /// Day of the stamp before, and its date as it is written.
    day: i64,
    date: Option<Date>,
    seconds: f64,
    /// Order of day and month, once two dates have shown it.
    order: Option<DateOrder>,
}

/// The order of day and month in dates such as 3/4/2024.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DateOrder {
    MonthFirst,
    DayFirst,
}

impl StampReader {
    /// Seconds since the first stamp. A clock without a date that falls by more than half a day has passed midnight.
    pub fn seconds(&mut self, stamp: Stamp) -> f64 {
        let day = match stamp.date {
            Some(date) if self.date == Some(date) => self.day,
            Some(date) => match self.date {
                Some(before) => self.day + self.days_between(before, date),
                None => date.days().0,
            },
            None if self.first.is_some() && stamp.seconds < self.seconds - 0.5 * DAY => self.day + 1,
            None => self.day,
        };
        (self.day, self.date, self.seconds) = (day, stamp.date, stamp.seconds);
        let (first_day, first_seconds) = *self.first.get_or_insert((day, stamp.seconds));
        (day - first_day) as f64 * DAY + (stamp.seconds - first_seconds)
    }

    /// Days from one date to another. The first two dates between which both orders of day and month give different
    /// numbers of days decide for that with fewer.
    fn days_between(&mut self, before: Date, now: Date) -> i64 {
        let (before, now) = (before.days(), now.days());
        let (month_first, day_first) = (now.0 - before.0, now.1 - before.1);
        if month_first == day_first {
            return month_first;
        }
        let order = *self.order.get_or_insert(match month_first.abs() < day_first.abs() {
            true => DateOrder::MonthFirst,
            false => DateOrder::DayFirst,
        });
        match order {
            DateOrder::MonthFirst => month_first,
            DateOrder::DayFirst => day_first,
        }
    }
}

impl Date {
    /// The days since 1970 that the date may be: with the month first, and with the day first.
    fn days(self) -> (i64, i64) {
        match self {
            Self::Day(day) => (day, day),
            Self::Slashed(one, other, year) => {
                (day_of(year, one, other).unwrap_or(0), day_of(year, other, one).unwrap_or(0))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(cells: &[&str]) -> Vec<f64> {
        let mut reader = StampReader::default();
        cells.iter().map(|cell| reader.seconds(Stamp::of(cell).unwrap_or_else(|| panic!("{cell}")))).collect()
    }

    #[test]
    fn letters_in_the_place_of_digits_are_no_clock() {
        for cell in ["12:00:09+€1", "12:00:09-é1", "2024-02-29 23:59:59+µ:1", "12:00:0€"] {
            assert!(Stamp::of(cell).is_none(), "{cell}");
        }
    }

    #[test]
    fn clocks_run_over_midnight() {
        assert_eq!(seconds(&["23:59:59.5", "0:00:00.25", "00:00:01,0"]), [0.0, 0.75, 1.5]);
        assert_eq!(seconds(&["11:59:59 AM", "12:00:01 PM", "1:00:00 PM"]), [0.0, 2.0, 3601.0]);
    }

    #[test]
    fn dates_are_read_as_countries_write_them() {
        for cells in [
            ["2024-02-29T23:59:59.900Z", "2024-03-01T00:00:00.100Z"],
            ["2024-02-29 23:59:59.900", "2024-03-01 00:00:00.100"],
            ["29.02.2024 23:59:59,900", "01.03.2024 00:00:00,100"],
            ["2/29/2024 11:59:59.900 PM", "3/1/2024 12:00:00.100 AM"],
            ["29/02/24 23:59:59.900", "01/03/24 00:00:00.100"],
            ["2024-02-29T23:59:59.900+01:00", "2024-03-01T01:00:00.100+02:00"],
        ] {
            let found = seconds(&cells);
            assert!((found[1] - 0.2).abs() < 1e-9, "{cells:?} {found:?}");
        }
        // Either order of day and month: the next day, and no month later.
        assert_eq!(seconds(&["3/4/2024 00:00:00", "3/5/2024 00:00:00", "3/6/2024 00:00:00"])[2], 2.0 * DAY);
        assert_eq!(seconds(&["12/4/2024 00:00:00", "13/4/2024 00:00:00"])[1], DAY);
        // The order that was found holds for later dates.
        let days = ["1/8/2024 00:00:00", "1/9/2024 00:00:00", "1/1/2024 00:00:00", "2/3/2024 00:00:00"];
        assert_eq!(seconds(&days)[3], 26.0 * DAY);
        assert_eq!(seconds(&["3/4/2024 00:00:00", "4/4/2024 00:00:00", "5/4/2024 00:00:00"])[2], 2.0 * DAY);
    }

    #[test]
    fn dates_may_lack_seconds_or_a_clock_and_may_name_their_month() {
        for (first, second, expected) in [
            ("2023-03-01 00:00", "2023-03-01 00:15", 900.0),
            ("2023-03-01T23:45Z", "2023-03-02T00:00Z", 900.0),
            ("28.02.2023 23:45", "01.03.2023 0:15", 1800.0),
            ("3/1/2023 11:45 AM", "3/1/2023 12:15 PM", 1800.0),
            ("28-Feb-2024 23:59:59.5", "29-Feb-2024 00:00:00.5", 1.0),
            ("1 Mar 2023 00:00", "1 March 2023 00:15", 900.0),
            ("1. März 2023 00:00:00", "2. Mai 2023 00:00:00", 62.0 * DAY),
            ("Mar 1, 2023 12:00 AM", "Mar 1, 2023 1:00 PM", 46_800.0),
            ("Wed, 01 Mar 2023 00:00:00", "Thu, 02 Mar 2023 00:00:01", DAY + 1.0),
            ("31 déc. 2022 23:00", "1 janv. 2023 00:00", 3600.0),
            ("30 juin 2023 12:00", "1 juil. 2023 12:00", DAY),
            ("2024-02-28", "2024-03-01", 2.0 * DAY),
            ("28.02.2024", "01.03.2024", 2.0 * DAY),
            ("2023-Dec-31 23:00:00", "2024-Jan-01 00:00:00", 3600.0),
        ] {
            assert_eq!(seconds(&[first, second])[1], expected, "{first} {second}");
        }
        for month in ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"]
            .iter()
            .enumerate()
        {
            let named = Stamp::of(&format!("7-{}-2023 01:02", month.1)).unwrap();
            assert_eq!(Some(named), Stamp::of(&format!("2023-{}-07 01:02", month.0 + 1)), "{}", month.1);
        }
    }

    #[test]
    fn other_text_is_no_time_stamp() {
        for cell in [
            "1.5",
            "12:30",
            "25",
            "a:b:c",
            "1:75:00",
            "2024-13-01 00:00:00",
            "::",
            "1:2:3:4",
            "1.2.3",
            "127.0.0.1",
            "2023-02-30",
            "Mar 2023",
            "May 1 at 12:30",
            "Sample 1 2023",
            "run 3: 12:30",
            "1.234.567",
            "12345678",
            "1.0e-05",
            "1.5 mm 2023",
            "2024-03",
            "-2024-03-01",
            "12-34-5678",
        ] {
            assert_eq!(Stamp::of(cell), None, "{cell}");
        }
    }
}
