//! Memory that this process may still take.

use std::fs;

/// Bytes assumed where the system reports none.
const ASSUMED: f64 = 8e9;

/// Bytes that are available: what Linux can give without swapping, at most what a control group leaves; elsewhere
/// 8 GB.
pub fn available_memory() -> f64 {
    let read = |path: &str| fs::read_to_string(path).ok();
    let system = read("/proc/meminfo").and_then(|text| of_meminfo(&text)).unwrap_or(ASSUMED);
    let limit = read("/sys/fs/cgroup/memory.max").and_then(|text| number(&text));
    let taken = read("/sys/fs/cgroup/memory.current").and_then(|text| number(&text));
    match (limit, taken) {
        (Some(limit), Some(taken)) => system.min((limit - taken).max(0.0)),
        _ => system,
    }
}

/// `MemAvailable` of `/proc/meminfo`, in bytes.
fn of_meminfo(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    number(line.trim().strip_suffix("kB")?).map(|kilobytes| 1024.0 * kilobytes)
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meminfo_is_read_in_bytes() {
        let text = "MemTotal:       24617344 kB\nMemFree: 12 kB\nMemAvailable:   19000000 kB\n";
        assert_eq!(of_meminfo(text), Some(19_000_000.0 * 1024.0));
        assert_eq!(of_meminfo("MemTotal: 1 kB\n"), None);
        assert_eq!(number("max\n"), None);
        assert!(available_memory() > 1e6);
    }
}
