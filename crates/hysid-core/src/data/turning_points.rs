//! Turning points of an input: where it reverses.

/// Rows at which `x` reverses by at least `smallest`, in its unit, without the first and the last.
pub fn turning_points(x: &[f64], smallest: f64) -> Vec<usize> {
    let mut found = Vec::new();
    let (mut low, mut high) = (0, 0);
    let mut rising: Option<bool> = None;
    for (row, &value) in x.iter().enumerate() {
        if value > x[high] {
            high = row;
        }
        if value < x[low] {
            low = row;
        }
        let turned_down = rising != Some(false) && value <= x[high] - smallest && value < x[high];
        let turned_up = rising != Some(true) && value >= x[low] + smallest && value > x[low];
        if turned_down {
            if rising.is_some() {
                found.push(high);
            }
            (rising, low) = (Some(false), row);
        } else if turned_up {
            if rising.is_some() {
                found.push(low);
            }
            (rising, high) = (Some(true), row);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_is_no_turning_point() {
        let x = [0.0, 0.5, 0.45, 1.0, 0.98, 0.99, 0.2, 0.22, -1.0, 0.0];
        assert_eq!(turning_points(&x, 0.1), [3, 8]);
        assert_eq!(turning_points(&x, 0.0).len(), 8);
    }
}
