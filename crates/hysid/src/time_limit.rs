//! The time after which a fit ends, as users give it.

use std::time::Duration;

/// The time after which a fit ends, from a number of seconds.
///
/// # Errors
/// Time limit of a fit; an error states the requirement if the number is not above 0 and below 1e9.
pub fn time_limit(seconds: f64) -> Result<Duration, &'static str> {
    match seconds > 0.0 && seconds < 1e9 {
        true => Ok(Duration::from_secs_f64(seconds)),
        false => Err("a number of seconds above 0, below 1e9, is needed"),
    }
}
