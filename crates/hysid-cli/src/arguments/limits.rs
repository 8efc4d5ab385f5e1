//! Bounds of an input on the command line.

use hysid_app::inversion::Preview;

/// Lowest and highest value, as LOW:HIGH.
pub fn limits(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let pair = text.split_once(':').and_then(|(low, high)| Some((number(low)?, number(high)?)));
    match pair {
        Some((low, high)) if low < high => Ok((low, high)),
        Some((low, high)) => Err(format!("the low limit {low} is not below the high one, {high}")),
        None => Err("two numbers are needed, the low limit and the high one, as -1:2.5".into()),
    }
}

/// Largest change of an input in a unit of time.
pub fn slew(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| *rate > 0.0 && rate.is_finite());
    rate.ok_or_else(|| "a number above 0 is needed".into())
}

/// How far an inverse looks ahead.
pub fn preview(text: &str) -> Result<Preview, String> {
    if text == "auto" {
        return Ok(Preview::Auto);
    }
    let time = text.parse().ok().filter(|time: &f64| *time >= 0.0 && time.is_finite());
    time.map(Preview::Time).ok_or_else(|| "`auto` or a time of 0 or more is needed".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_are_limits() {
        for (text, expected) in [
            ("0:1", (0.0, 1.0)),
            ("-1:1", (-1.0, 1.0)),
            ("-3.5:-2e-1", (-3.5, -0.2)),
            (" 1 : 2 ", (1.0, 2.0)),
        ] {
            assert_eq!(limits(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_with_limits_is_said() {
        assert_eq!(limits("3:1").unwrap_err(), "the low limit 3 is not below the high one, 1");
        assert_eq!(limits("1:1").unwrap_err(), "the low limit 1 is not below the high one, 1");
        for text in ["", "1", "1:", ":1", "1:2:3", "a:b", "nan:1", "0:inf", "1,2"] {
            assert!(limits(text).unwrap_err().starts_with("two numbers are needed"), "{text}");
        }
    }

    #[test]
    fn a_slew_limit_is_positive() {
        assert_eq!(slew("2e3"), Ok(2000.0));
        for text in ["0", "-1", "inf", "nan", "fast", ""] {
            assert_eq!(slew(text).unwrap_err(), "a number above 0 is needed", "{text}");
        }
    }

    #[test]
    fn a_preview_is_a_time_or_auto() {
        assert_eq!(preview("auto"), Ok(Preview::Auto));
        assert_eq!(preview("0"), Ok(Preview::Time(0.0)));
        for text in ["-1", "inf", "nan", "long"] {
            assert!(preview(text).is_err(), "{text}");
        }
    }
}
