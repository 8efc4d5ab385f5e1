//! Bounds of an input on the command line.

/// How far an inverse looks ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preview {
    /// As far as suits the model and the reference.
    Auto,
    /// This time.
    Time(f64),
}

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
