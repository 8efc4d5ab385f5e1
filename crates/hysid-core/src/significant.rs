//! Numbers rounded to significant digits.

use std::fmt;

/// A number with as many significant digits as the format precision, without trailing zeros.
pub struct Significant(pub f64);

impl fmt::Display for Significant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(4).max(1);
        let value = self.0;
        if value == 0.0 || !value.is_finite() {
            return write!(f, "{value}");
        }
        let scientific = format!("{value:.*e}", digits - 1);
        let (mantissa, exponent) = scientific.split_once('e').expect("the format has an exponent");
        let exponent: i32 = exponent.parse().expect("the exponent is a number");
        let trimmed = |text: &str| match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
            false => text.to_string(),
        };
        if (-4..digits.max(6) as i32).contains(&exponent) {
            let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
            write!(f, "{}", trimmed(&format!("{value:.decimals$}")))
        } else {
            write!(f, "{}e{exponent}", trimmed(mantissa))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        let shown = |value: f64, digits: usize| format!("{:.*}", digits, Significant(value));
        assert_eq!(shown(1234.5678, 3), "1235");
        assert_eq!(shown(0.00123456, 3), "0.00123");
        assert_eq!(shown(1.5e-7, 3), "1.5e-7");
        assert_eq!(shown(-2.5e9, 4), "-2.5e9");
        assert_eq!(shown(0.1 + 0.2, 4), "0.3");
        assert_eq!(shown(0.0, 4), "0");
        assert_eq!(shown(9.9999, 3), "10");
    }
}
