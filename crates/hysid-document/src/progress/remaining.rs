//! The remaining time that is shown: an estimate that never rises.

/// Seconds before the first estimate: the first steps of a fit are no measure of the others.
const BEFORE_THE_FIRST: f64 = 2.0;

/// Less of the work than this gives no estimate.
const LEAST_SHARE: f64 = 0.01;

/// Seconds below which the remaining time is `a few seconds`.
const A_FEW: f64 = 5.0;

/// Share of work that is done, at least that of its time limit: work that a limit ends is over with it.
pub fn share_done(done: f64, elapsed: f64, limit: Option<f64>) -> f64 {
    limit.map_or(done, |limit| done.max((elapsed / limit).min(1.0)))
}

/// Remaining time of work whose speed changes.
///
/// The time that is shown is the smallest estimate so far. Where the work turns out slower, the time stays as it is until
/// the estimate has fallen below it; it never jumps up.
#[derive(Debug, Clone, Copy, Default)]
pub struct Remaining {
    shown: Option<f64>,
}

impl Remaining {
    /// Seconds to show after so many seconds, with a share of the work done (0 to 1) and at most `most` seconds left, if
    /// that is known; `None` as long as too little is done for an estimate.
    pub fn after(&mut self, elapsed: f64, done: f64, most: Option<f64>) -> Option<f64> {
        let of_the_work = (elapsed >= BEFORE_THE_FIRST && done >= LEAST_SHARE)
            .then(|| elapsed / done * (1.0 - done).max(0.0));
        let estimates = [of_the_work, most, self.shown].into_iter().flatten();
        self.shown = estimates.filter(|seconds| seconds.is_finite()).reduce(f64::min);
        self.shown
    }
}

/// A remaining time in words. A shorter time never reads as a longer one.
pub fn in_words(seconds: f64) -> String {
    if seconds <= A_FEW {
        return "a few seconds left".into();
    }
    // The ceiling of a smaller number is not larger.
    let whole = seconds.ceil();
    let minutes = (whole / 60.0).ceil();
    match whole {
        _ if whole <= 90.0 => format!("{whole} s left"),
        _ if minutes < 60.0 => format!("{minutes} min left"),
        _ => format!("{} h {} min left", (minutes / 60.0).floor(), minutes % 60.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds in the words.
    fn said(words: &str) -> f64 {
        if words == "a few seconds left" {
            return A_FEW;
        }
        let words: Vec<&str> = words.trim_end_matches(" left").split(' ').collect();
        words
            .chunks(2)
            .map(|pair| {
                let unit = match pair[1] {
                    "h" => 3600.0,
                    "min" => 60.0,
                    "s" => 1.0,
                    other => panic!("{other} is no unit"),
                };
                pair[0].parse::<f64>().unwrap() * unit
            })
            .sum()
    }

    #[test]
    fn work_with_a_time_limit_is_done_at_its_limit() {
        assert_eq!(share_done(0.01, 50.0, None), 0.01);
        assert_eq!(share_done(0.01, 50.0, Some(100.0)), 0.5);
        assert_eq!(share_done(0.7, 50.0, Some(100.0)), 0.7);
        assert_eq!(share_done(0.01, 103.0, Some(100.0)), 1.0);
    }

    #[test]
    fn the_time_that_is_shown_never_rises_however_the_speed_changes() {
        // Fast, then ten times slower, then stuck, then fast again.
        let speed = |second: usize| match second {
            0..20 => 0.01,
            20..100 => 0.001,
            100..200 => 0.0,
            _ => 0.004,
        };
        let (mut remaining, mut done) = (Remaining::default(), 0.0);
        let mut shown = Vec::new();
        for second in 0..380 {
            done = f64::min(done + speed(second), 1.0);
            if let Some(left) = remaining.after(second as f64, done, None) {
                shown.push(left);
                let truth = second as f64 * (1.0 - done) / done;
                assert!(left <= truth + 1e-9, "second {second}: {left} of {truth}");
            }
        }
        assert!(shown.len() > 370, "it is shown from the third second on: {}", shown.len());
        assert!(shown.is_sorted_by(|before, after| before >= after), "{shown:?}");
        let told: Vec<f64> = shown.iter().map(|&left| said(&in_words(left))).collect();
        assert!(told.is_sorted_by(|before, after| before >= after), "{told:?}");
        assert_eq!(done, 1.0);
        assert_eq!(shown.last(), Some(&0.0));
    }

    #[test]
    fn work_of_constant_speed_counts_down_to_the_end() {
        let mut remaining = Remaining::default();
        assert_eq!(remaining.after(1.0, 0.01, None), None);
        assert_eq!(remaining.after(10.0, 0.1, None).map(f64::round), Some(90.0));
        assert_eq!(remaining.after(50.0, 0.5, None).map(f64::round), Some(50.0));
        assert_eq!(remaining.after(100.0, 1.0, None), Some(0.0));
    }

    #[test]
    fn a_time_limit_bounds_the_time_from_the_beginning() {
        let mut remaining = Remaining::default();
        assert_eq!(remaining.after(0.0, 0.0, Some(30.0)), Some(30.0));
        assert_eq!(remaining.after(10.0, 0.02, Some(20.0)), Some(20.0));
        assert_eq!(remaining.after(29.0, 0.03, Some(1.0)), Some(1.0));
    }

    #[test]
    fn words_of_shorter_times_are_never_longer_times() {
        let told: Vec<f64> = (0..100_000).map(|tenth| said(&in_words(f64::from(tenth) / 10.0))).collect();
        assert!(told.is_sorted());
        let words = [0.0, 5.0, 5.1, 90.0, 90.5, 3540.0, 3541.0, 7200.0].map(in_words);
        assert_eq!(
            words,
            [
                "a few seconds left",
                "a few seconds left",
                "6 s left",
                "90 s left",
                "2 min left",
                "59 min left",
                "1 h 0 min left",
                "2 h 0 min left"
            ]
        );
    }
}
