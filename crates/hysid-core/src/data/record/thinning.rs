//! Selection of scored rows, so that the cost of a fit is bounded.

use crate::random::mix;

/// A selection of `most` of `rows` rows: one from each of `most` intervals of equal length, at a position
/// given by a fixed hash. Rows at constant distances would always hit the same few phases of a periodic
/// record.
#[derive(Debug, Clone, Copy)]
pub struct Thinning {
    rows: u128,
    most: u128,
}

impl Thinning {
    /// A selection of at most `most` of `rows` rows.
    pub fn new(rows: usize, most: usize) -> Self {
        Self { rows: rows as u128, most: most.max(1) as u128 }
    }

    /// True if row `place`, counted from 0, is selected.
    pub fn keeps(&self, place: usize) -> bool {
        if self.rows <= self.most {
            return true;
        }
        let interval = place as u128 * self.most / self.rows;
        let first = (interval * self.rows).div_ceil(self.most);
        let end = ((interval + 1) * self.rows).div_ceil(self.most);
        let picked = u128::from(mix(interval as u64) >> 33) % (end - first);
        place as u128 == first + picked
    }

    /// Blanks the outputs that are not selected and returns the number of those that are.
    pub fn blank<'y>(&self, outputs: impl Iterator<Item = &'y mut f64>) -> usize {
        let mut kept = 0;
        for (place, y) in outputs.filter(|y| !y.is_nan()).enumerate() {
            if self.keeps(place) { kept += 1 } else { *y = f64::NAN }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_as_many_rows_are_kept_as_asked_for() {
        for (rows, most) in [(10, 10), (9, 10), (11, 10), (12_345, 5000), (100_000, 777), (7, 1)] {
            let kept = (0..rows).filter(|&row| Thinning::new(rows, most).keeps(row)).count();
            assert_eq!(kept, most.min(rows), "{rows} rows");
        }
    }

    /// Whatever the period of a record, all phases of its cycle are compared about equally often.
    #[test]
    fn no_period_is_favoured() {
        for period in 2..=64 {
            for rows in [20_000, 100_000] {
                let thinning = Thinning::new(rows, 5000);
                let mut of_phase = vec![0; period];
                (0..rows).filter(|&row| thinning.keeps(row)).for_each(|row| of_phase[row % period] += 1);
                let expected = 5000 / period;
                let (least, most) = (of_phase.iter().min().unwrap(), of_phase.iter().max().unwrap());
                assert!(*least > expected / 3 && *most < 3 * expected, "period {period}: {least} to {most}");
            }
        }
    }
}
