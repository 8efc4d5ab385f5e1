//! How a drawing looks.

/// Size and font of the text of a drawing and the width of its lines, from which all distances follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Appearance {
    /// Size of all text, in pixels.
    pub text: f64,
    /// Families of fonts, the preferred one first, as in a style sheet.
    pub family: String,
    /// Width of lines and dots, as a multiple of that of the curves.
    pub lines: f64,
    /// True for a drawing in the colours of a light page, without a style sheet.
    pub fixed_colours: bool,
    /// Room for the texts of the vertical axis, in letters, and for the lines of its label, at least.
    pub(super) tick_letters: usize,
    pub(super) label_lines: usize,
}

/// Pixels in a millimetre, as in a style sheet: 96 in an inch.
pub const PIXELS_PER_MILLIMETRE: f64 = 96.0 / 25.4;

pub const PIXELS_PER_POINT: f64 = 96.0 / 72.0;

/// Size of the text on a page, in pixels.
const TEXT: f64 = 13.0;

impl Appearance {
    pub fn of_page() -> Self {
        Self {
            text: TEXT,
            family: "system-ui".into(),
            lines: 1.0,
            fixed_colours: false,
            tick_letters: 0,
            label_lines: 1,
        }
    }

    /// As in a printed paper, with text of this size in points.
    pub fn of_print(family: impl Into<String>, points: f64) -> Self {
        let text = points * PIXELS_PER_POINT;
        let lines = (text / TEXT).min(1.0);
        Self { text, family: family.into(), lines, fixed_colours: true, tick_letters: 0, label_lines: 1 }
    }

    /// Room between the rows of a sheet, in pixels: a legend belongs to the chart below it.
    pub fn row_gap(&self) -> f64 {
        self.em(1.54).round()
    }

    /// Mean width of a letter, in pixels.
    pub(super) fn letter(&self) -> f64 {
        0.554 * self.text
    }

    /// So many times the size of the text, in pixels.
    pub(super) fn em(&self, times: f64) -> f64 {
        times * self.text
    }
}
