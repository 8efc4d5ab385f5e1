//! The line of progress, in any width.

/// Cells of the bar where there is room.
const BAR: usize = 24;

/// Cells of the bar in a narrow terminal.
const SHORT_BAR: usize = 10;

/// Content of a line of progress.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Line {
    /// Share of the work that is done, 0 to 1.
    pub done: f64,
    /// The fold that is fitted to, counted from 1, and how many there are; `None` without folds.
    pub fold: Option<(usize, usize)>,
    /// Current step of the work, such as `iteration 12`.
    pub part: String,
    /// Training error so far, in percent of the standard deviation of the output, in words without a unit.
    pub error: Option<String>,
    /// Remaining time in words; `None` as long as there is no estimate.
    pub left: Option<String>,
}

impl Line {
    /// The longest form that fits into this number of columns. All characters of it are one column wide if those of
    /// `part` are.
    ///
    /// Shortens the line, the least important first: cells of the bar, then the bar, words, the part and the error. The
    /// share that is done stays, and the remaining time as long as possible.
    pub fn in_columns(&self, columns: usize) -> String {
        let bars = [BAR, SHORT_BAR].map(|cells| format!("[{}] {}", self.bar(cells), self.longest()));
        let fitting = bars.into_iter().find(|form| form.chars().count() <= columns);
        fitting.unwrap_or_else(|| self.without_bar(columns))
    }

    /// The same without a bar, for a place where lines stay.
    pub fn without_bar(&self, columns: usize) -> String {
        let fold = || self.fold.map(|(place, of)| format!("fold {place}/{of}"));
        let error = || self.error.as_ref().map(|error| format!("error {error} %"));
        let part = || Some(self.part.clone());
        let left = || self.left.clone();
        let percent = self.percent();
        let forms = [
            self.longest(),
            format!("{percent} {}", words([fold(), part(), error(), left()])),
            format!("{percent} {}", words([fold(), error(), left()])),
            format!("{percent} {}", words([error(), left()])),
            format!("{percent} {}", words([left()])),
        ];
        let fitting = forms.into_iter().find(|form| form.trim_end().chars().count() <= columns);
        fitting.unwrap_or_else(|| percent.chars().take(columns).collect()).trim_end().to_string()
    }

    fn longest(&self) -> String {
        let fold = self.fold.map(|(place, of)| format!("fold {place} of {of}"));
        let error = self.error.as_ref().map(|error| format!("error {error} % of std"));
        let words = words([fold, Some(self.part.clone()), error, self.left.clone()]);
        format!("{} {words}", self.percent())
    }

    fn percent(&self) -> String {
        format!("{:3.0} %", 100.0 * self.done)
    }

    /// A bar such as `=====>    `.
    fn bar(&self, cells: usize) -> String {
        let full = ((self.done.clamp(0.0, 1.0) * cells as f64) as usize).min(cells);
        let head = if full < cells { ">" } else { "" };
        format!("{:<cells$}", "=".repeat(full) + head)
    }
}

/// Those that are there, separated by commas.
fn words<const N: usize>(words: [Option<String>; N]) -> String {
    words.into_iter().flatten().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines() -> Vec<Line> {
        let line = |done, fold, part: &str, error: Option<&str>, left: Option<&str>| Line {
            done,
            fold,
            part: part.into(),
            error: error.map(String::from),
            left: left.map(String::from),
        };
        vec![
            line(0.0, None, "first evaluations", None, None),
            line(0.45, Some((2, 5)), "sub-gradient 312", Some("12.3"), Some("1 h 25 min left")),
            line(1.0, Some((1000, 1000)), "generation 100000", Some("0.00123"), Some("a few seconds left")),
            line(0.3, None, "fitting rate-dependent-prandtl-ishlinskii", None, Some("45 s left")),
        ]
    }

    #[test]
    fn a_line_fits_into_every_width_and_says_how_much_is_done_and_left() {
        for line in lines() {
            for columns in 20..=200 {
                let text = line.in_columns(columns);
                assert!(text.chars().count() <= columns, "{columns}: {text:?}");
                assert!(text.contains(" %") && !text.contains('\n'), "{columns}: {text:?}");
                if let Some(left) = &line.left
                    && columns >= 25
                {
                    assert!(text.ends_with(left.as_str()), "{columns}: {text:?}");
                }
            }
        }
    }

    #[test]
    fn a_wider_terminal_never_shows_less() {
        for line in lines() {
            let lengths: Vec<usize> =
                (1..=200).map(|columns| line.in_columns(columns).chars().count()).collect();
            assert!(lengths.is_sorted(), "{lengths:?}");
        }
    }

    #[test]
    fn what_matters_least_is_left_out_first() {
        let line = &lines()[1];
        assert_eq!(
            line.in_columns(200),
            "[==========>             ]  45 % fold 2 of 5, sub-gradient 312, error 12.3 % of std, 1 h 25 min left"
        );
        assert_eq!(
            line.in_columns(80),
            " 45 % fold 2 of 5, sub-gradient 312, error 12.3 % of std, 1 h 25 min left"
        );
        assert_eq!(line.in_columns(40), " 45 % error 12.3 %, 1 h 25 min left");
        assert_eq!(line.in_columns(24), " 45 % 1 h 25 min left");
        assert_eq!(line.in_columns(20), " 45 %");
        assert_eq!(line.in_columns(3), " 45");
        assert_eq!(line.in_columns(0), "");
    }
}
