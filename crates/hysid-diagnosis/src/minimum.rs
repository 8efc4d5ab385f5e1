//! Where a function of one variable is lowest.

/// Places on either side of the best so far, once a first search has found it.
const PLACES: i32 = 4;

/// Searches, each of which narrows the interval.
const ROUNDS: usize = 8;

/// Distances between places that an interval extends around the best of them.
const WIDER: f64 = 1.2;

/// Where a function is lowest within `centre ± reach`: the best of so many places on either side of the centre, then
/// again and again of a few around it. No golden sections: valleys of measured data have others in them.
pub(crate) fn lowest(function: &impl Fn(f64) -> f64, mut centre: f64, mut reach: f64, places: i32) -> f64 {
    let mut places = places;
    for _ in 0..ROUNDS {
        let place = |k: i32| centre + reach * f64::from(k) / f64::from(places);
        let values: Vec<(f64, f64)> = (-places..=places).map(|k| (place(k), function(place(k)))).collect();
        centre = values.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(centre, |best| best.0);
        reach *= WIDER / f64::from(places);
        places = PLACES;
    }
    centre
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::square;

    use super::*;

    #[test]
    fn the_lowest_of_several_valleys_is_found() {
        // Valleys at -2 and 1, the second deeper by 0.3.
        let function = |x: f64| square((x + 2.0) * (x - 1.0)) - 0.1 * x;
        let found = lowest(&function, 0.5, 3.0, 4);
        assert!((found - 1.0055).abs() < 1e-3, "{found}");
        assert!(function(found) <= function(found + 1e-3) && function(found) <= function(found - 1e-3));
    }

    #[test]
    fn a_kink_is_found_as_well() {
        assert!((lowest(&|x| (x - 0.123).abs(), 0.0, 1.0, 20) - 0.123).abs() < 1e-5);
    }
}
