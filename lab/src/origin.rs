//! Where a page comes from: day, version and command.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::program::product;

/// Day, version and command, in Markdown. `version` is what the program says of itself.
/// `built` says that the program is the one built here.
pub fn origin(built: bool, version: &str) -> String {
    let typed: Vec<String> = std::env::args().skip(1).collect();
    of_command(&typed, built, version)
}

/// The same for these arguments of the laboratory.
fn of_command(typed: &[String], built: bool, version: &str) -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    // Of another program than the one built here the revision is unknown.
    let revision = built.then(revision).flatten();
    let revision = revision.map_or_else(String::new, |revision| format!(" ({revision})"));
    let typed: Vec<String> = typed.iter().map(|word| quoted(word)).collect();
    let typed = typed.join(" ");
    format!("{}, {version}{revision}:\n\n```sh\ncargo run --release -- {typed}\n```\n", date(seconds))
}

/// The revision of the working copy, if git knows it.
fn revision() -> Option<String> {
    let git = Command::new("git")
        .args(["describe", "--always", "--dirty"])
        .current_dir(product())
        .output()
        .ok()
        .filter(|git| git.status.success())?;
    Some(String::from_utf8_lossy(&git.stdout).trim().to_owned())
}

/// A word as an argument of a shell command.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The day (UTC) so many seconds after the beginning of 1970.
fn date(seconds: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    let (mut days, mut year) = (seconds / 86_400, 1970);
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_can_be_typed_again() {
        let typed = ["cases", "my data", "--models", "pnn,xpnn"].map(str::to_owned);
        let text = of_command(&typed, false, "hysid 9.8.7");
        assert!(
            text.contains(
                "hysid 9.8.7:\n\n```sh\ncargo run --release -- cases 'my data' --models pnn,xpnn\n"
            ),
            "{text}"
        );
    }

    /// Computed with `date -u -d @SECONDS +%F`.
    #[test]
    fn days_of_common_and_leap_years() {
        for (seconds, day) in [
            (0, "1970-01-01"),
            (951_782_399, "2000-02-28"),
            (951_782_400, "2000-02-29"),
            (1_735_689_599, "2024-12-31"),
            (1_735_689_600, "2025-01-01"),
            (1_795_219_200, "2026-11-21"),
        ] {
            assert_eq!(date(seconds), day);
        }
    }
}
