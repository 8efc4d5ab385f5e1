//! Time stamps as loggers write them: rounded, so that some are equal, and starting again for each record.

/// Share of a record's duration below which a time stamp starts again.
const BEGINNING: f64 = 0.02;

/// Spreads equal time stamps evenly up to the next one: a clock of few digits repeats what is measured more often. Those
/// at the end go on in the steps before them; `next` is the first stamp behind, if it is known, and `step` that of the
/// rows before, which it is kept for. Gives the number of rows that changed.
pub fn spread_equal(time: &mut [f64], next: Option<f64>, step: &mut Option<f64>) -> usize {
    let (mut changed, mut start) = (0, 0);
    while start < time.len() {
        let stamp = time[start];
        let rows = time[start..].iter().take_while(|&&time| time == stamp).count();
        let behind = time.get(start + rows).copied().or(next);
        let own = behind.filter(|&behind| behind > stamp).map(|behind| (behind - stamp) / rows as f64);
        // Stamps that fall, or that are all equal, stay as they are, for the check that refuses them.
        if let Some(own) = own.or(step.filter(|_| behind.is_none())) {
            for (row, time) in time[start..start + rows].iter_mut().enumerate().skip(1) {
                *time = stamp + row as f64 * own;
                changed += 1;
            }
            *step = Some(own);
        }
        start += rows;
    }
    changed
}

/// True for a time stamp with which another record begins: it falls back to where the record began. `first` and
/// `previous` are the first and the last stamp of the record, which has grown: what falls at once is no time.
pub fn starts_again(first: f64, previous: f64, stamp: f64) -> bool {
    previous > first && stamp < previous && stamp <= first + BEGINNING * (previous - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(mut time: Vec<f64>, next: Option<f64>) -> Vec<f64> {
        spread_equal(&mut time, next, &mut None);
        time
    }

    #[test]
    fn equal_time_stamps_are_spread_to_the_next() {
        assert_eq!(
            spread(vec![0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0], None),
            [0.0, 0.5, 1.0, 1.25, 1.5, 1.75, 2.0]
        );
        assert_eq!(spread(vec![0.0, 0.0, 1.0, 1.0], None), [0.0, 0.5, 1.0, 1.5]);
        assert_eq!(spread(vec![0.0, 0.0, 1.0, 1.0], Some(3.0)), [0.0, 0.5, 1.0, 2.0]);
        assert_eq!(spread(vec![0.0, 1.0, 2.0], None), [0.0, 1.0, 2.0]);
        // Nothing tells how long these last.
        assert_eq!(spread(vec![1.0, 1.0], None), [1.0, 1.0]);
        assert_eq!(spread(vec![1.0, 1.0, 0.5], None), [1.0, 1.0, 0.5]);
    }

    #[test]
    fn a_record_begins_where_time_starts_again() {
        assert!(starts_again(0.0, 10.0, 0.0));
        assert!(starts_again(0.1, 10.0, 0.0));
        assert!(starts_again(0.0, 10.0, 0.05));
        assert!(!starts_again(0.0, 10.0, 9.9));
        assert!(!starts_again(0.0, 10.0, 10.1));
        assert!(!starts_again(0.0, 0.0, 0.0));
        assert!(!starts_again(0.8, 0.8, 0.78), "a field that falls from its first value");
    }
}
