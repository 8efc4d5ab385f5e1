//! Dates.

use std::time::SystemTime;

use jiff::Timestamp;

/// Today in UTC, such as `2026-03-01`.
pub fn today() -> String {
    day(Timestamp::now())
}

/// The date of a time, in UTC.
pub fn of(time: SystemTime) -> String {
    Timestamp::try_from(time).map_or_else(|_| "unknown".into(), day)
}

/// Date and time of day in UTC, such as `2026-03-01 14:05`.
pub fn now() -> String {
    Timestamp::now().strftime("%Y-%m-%d %H:%M").to_string()
}

fn day(time: Timestamp) -> String {
    time.strftime("%Y-%m-%d").to_string()
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, UNIX_EPOCH};

    use super::of;

    #[test]
    fn dates_of_known_days() {
        // Days since 1970-01-01 by `date -d ... +%s`.
        for (days, date) in
            [(0, "1970-01-01"), (11_016, "2000-02-29"), (19_782, "2024-02-29"), (20_787, "2026-11-30")]
        {
            assert_eq!(of(UNIX_EPOCH + Duration::from_secs(86_400 * days)), date);
        }
    }
}
