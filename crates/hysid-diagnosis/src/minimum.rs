//! Where a function of one variable is lowest.

/// Golden sections of the interval around the best place.
const SECTIONS: usize = 40;

/// Where a function is lowest within `centre ± reach`: the best of so many places on either side of the centre, then
/// golden sections between its neighbours, where the function should have one valley.
pub(crate) fn lowest(function: &impl Fn(f64) -> f64, centre: f64, reach: f64, places: i32) -> f64 {
    let place = |k: i32| centre + reach * f64::from(k) / f64::from(places);
    let mut best = (0, f64::INFINITY);
    for k in -places..=places {
        let value = function(place(k));
        if value < best.1 {
            best = (k, value);
        }
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (place(best.0 - 1), place(best.0 + 1));
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (function(a), function(b));
    for _ in 0..SECTIONS {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = function(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = function(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_of_several_valleys_is_found() {
        // Valleys at -2 and 1, the second deeper by 0.3.
        let function = |x: f64| ((x + 2.0) * (x - 1.0)).powi(2) - 0.1 * x;
        let found = lowest(&function, 0.5, 3.0, 4);
        assert!((found - 1.0055).abs() < 1e-3, "{found}");
        assert!(function(found) <= function(found + 1e-4) && function(found) <= function(found - 1e-4));
    }

    #[test]
    fn a_kink_is_found_as_well() {
        assert!((lowest(&|x| (x - 0.123).abs(), 0.0, 1.0, 20) - 0.123).abs() < 1e-7);
    }
}
