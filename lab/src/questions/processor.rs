//! Processor time of this process, which does not depend on what else the machine does.

use std::fs;

use anyhow::{Context, Result};

/// Ticks of `/proc` in a second.
const TICKS: f64 = 100.0;

/// Seconds that all threads of this process have run so far.
pub fn seconds() -> Result<f64> {
    let stat =
        fs::read_to_string("/proc/self/stat").context("processor times are read from /proc, on Linux")?;
    ticks(&stat).map(|ticks| ticks / TICKS).context("/proc/self/stat has no times")
}

/// User and system time, the 14th and 15th field; the second is a name in brackets that may have blanks.
fn ticks(stat: &str) -> Option<f64> {
    let behind_name = stat.rsplit_once(") ")?.1;
    let mut times = behind_name.split(' ').skip(11).map(str::parse::<f64>);
    Some(times.next()?.ok()? + times.next()?.ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_follow_a_name_with_blanks() {
        let stat = "12 (a b) c) S 1 12 12 0 -1 4194304 99 0 0 0 250 50 7 8 20 0 1 0 100";
        assert_eq!(ticks(stat), Some(300.0));
        assert_eq!(ticks("12 (a"), None);
    }
}
