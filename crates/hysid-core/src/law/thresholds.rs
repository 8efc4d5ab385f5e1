//! Checks of thresholds and weights.

use crate::error::{Error, LARGEST_VALUE, Result};

/// Most thresholds of a law, and most operators that a fit takes.
pub const MOST_THRESHOLDS: usize = 10_000;

/// Largest magnitude of a weight, which keeps a free run finite.
const LARGEST_WEIGHT: f64 = 1e100;

/// Rejects thresholds that are not positive, finite and rising, or more than [`MOST_THRESHOLDS`].
pub fn check_thresholds(thresholds: &[f64]) -> Result<()> {
    check_count(thresholds)?;
    let sound = |r: f64| r.is_finite() && r > 0.0;
    if let Some(r) = thresholds.iter().find(|&&r| !sound(r)) {
        return Err(Error::Parts(format!("threshold {r}: it must be finite and greater than 0")));
    }
    match thresholds.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => {
            Err(Error::Parts(format!("threshold {} after {}: thresholds must rise", pair[1], pair[0])))
        }
        None => Ok(()),
    }
}

pub(crate) fn check_count(thresholds: &[f64]) -> Result<()> {
    match thresholds.len() {
        0..=MOST_THRESHOLDS => Ok(()),
        count => Err(Error::Parts(format!("{count} thresholds are too many: at most {MOST_THRESHOLDS}"))),
    }
}

/// Rejects weights that are not finite, or so large that an output could overflow.
pub(crate) fn check_weights(weights: &[f64]) -> Result<()> {
    match weights.iter().find(|weight| weight.is_nan() || weight.abs() > LARGEST_WEIGHT) {
        Some(weight) => Err(Error::Parts(format!("weight {weight} is not a usable number"))),
        None => Ok(()),
    }
}

/// An input limited to the magnitude [`LARGEST_VALUE`], so that nothing overflows.
#[inline(always)]
pub(crate) fn limited(x: f64) -> f64 {
    x.clamp(-LARGEST_VALUE, LARGEST_VALUE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_thresholds_than_a_law_may_have_are_refused() {
        let rising = |count: usize| (1..=count).map(|r| r as f64).collect::<Vec<f64>>();
        assert!(check_thresholds(&rising(MOST_THRESHOLDS)).is_ok());
        let error = check_thresholds(&rising(MOST_THRESHOLDS + 1)).unwrap_err().to_string();
        assert!(error.contains("10001 thresholds are too many: at most 10000"), "{error}");
    }
}
