//! Units of acceleration.

use hysid::data::unit;

/// Units of acceleration that mean other things elsewhere, and their factors to m/s². Standard gravity is exact (ISO
/// 80000-3).
const ACCELERATIONS: [(&str, f64); 6] =
    [("g", 9.806_65), ("G", 9.806_65), ("gn", 9.806_65), ("g0", 9.806_65), ("Gal", 1e-2), ("gal", 1e-2)];

/// The factor from a unit of acceleration to m/s².
pub fn of_acceleration(unit: &str) -> Option<f64> {
    let own = ACCELERATIONS.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor);
    own.or_else(|| unit::factor(unit, "m/s2"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_a_unit_of_acceleration() {
        assert_eq!(of_acceleration("g"), Some(9.80665));
        assert_eq!(of_acceleration("mm/s²"), Some(1e-3));
        assert_eq!(of_acceleration("kg"), None);
    }
}
