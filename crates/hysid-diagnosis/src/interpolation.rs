//! Values of a column between its rows, and of a curve between its points.

/// The value of a column at a row that need not be whole, on the line between its neighbours; the first or the last value
/// beyond the ends. `column` is not empty.
pub(crate) fn at_row(column: &[f64], row: f64) -> f64 {
    let last = column.len() - 1;
    let place = row.clamp(0.0, last as f64);
    let below = (place as usize).min(last.saturating_sub(1));
    let above = (below + 1).min(last);
    column[below] + (place - below as f64) * (column[above] - column[below])
}

/// The value at `x` of a curve through points in the order of their first coordinate; `None` beyond its ends.
pub(crate) fn at_place(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let above = points.partition_point(|point| point.0 < x);
    let (a, b) = (points.get(above.checked_sub(1)?)?, points.get(above)?);
    let width = b.0 - a.0;
    Some(if width > 0.0 { a.1 + (b.1 - a.1) * (x - a.0) / width } else { a.1 })
}

#[cfg(test)]
mod tests {
    use super::at_row;

    #[test]
    fn a_straight_line_is_met_between_rows_and_kept_beyond_its_ends() {
        let line = [1.0, 3.0, 5.0];
        let at = [-2.0, 0.0, 0.25, 1.5, 2.0, 7.0].map(|row| at_row(&line, row));
        assert_eq!(at, [1.0, 1.0, 1.5, 4.0, 5.0, 5.0]);
        assert_eq!(at_row(&[4.0], 0.5), 4.0);
    }
}
