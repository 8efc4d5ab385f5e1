//! Bounds of the input of an inverse on the command line.

/// How far an inverse looks ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preview {
    /// As far as suits the model and the reference.
    Auto,
    /// This time.
    Time(f64),
}

/// Lowest and highest input.
///
/// # Errors
/// What is needed, in words.
pub fn limits(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str| text.trim().parse().ok().filter(|value: &f64| value.is_finite());
    let both = text.split_once(':').and_then(|(low, high)| Some((number(low)?, number(high)?)));
    match both {
        Some((low, high)) if low < high => Ok((low, high)),
        Some(_) => Err("the first number must be the lower one".into()),
        None => Err("two numbers with a colon between them are needed, such as 0:150".into()),
    }
}

/// Largest change of the input in a unit of time.
///
/// # Errors
/// As of [`limits`].
pub fn slew(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|&rate: &f64| rate > 0.0 && rate.is_finite());
    rate.ok_or_else(|| "a number above 0 is needed".into())
}

/// How far the inverse looks ahead.
///
/// # Errors
/// As of [`limits`].
pub fn preview(text: &str) -> Result<Preview, String> {
    if text == "auto" {
        return Ok(Preview::Auto);
    }
    let time = text.parse().ok().filter(|&time: &f64| time >= 0.0 && time.is_finite());
    time.map(Preview::Time).ok_or_else(|| "`auto` or a time of 0 or more is needed".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_two_numbers() {
        assert_eq!(limits("0:150"), Ok((0.0, 150.0)));
        assert_eq!(limits("-1.5 : -1e-1"), Ok((-1.5, -0.1)));
        assert!(limits("3:1").unwrap_err().contains("lower"));
        assert!(limits("1:1").unwrap_err().contains("lower"));
        for text in ["", "1", "1:", "a:b", "0:inf", "NaN:1", "1:2:3"] {
            assert!(limits(text).unwrap_err().contains("0:150"), "{text}");
        }
    }

    #[test]
    fn slew_and_preview_are_numbers() {
        assert_eq!(slew("2e3"), Ok(2000.0));
        for text in ["0", "-1", "inf", "NaN", "fast"] {
            assert!(slew(text).is_err(), "{text}");
        }
        assert_eq!(preview("auto"), Ok(Preview::Auto));
        assert_eq!(preview("0"), Ok(Preview::Time(0.0)));
        for text in ["-1", "inf", "NaN", "long"] {
            assert!(preview(text).is_err(), "{text}");
        }
    }
}
