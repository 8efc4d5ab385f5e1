//! The turning points of a cycle.

/// A turning point of a cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct CycleTip {
    pub input: f64,
    pub output: Option<f64>,
    /// Number of the branch that begins there.
    pub leaves: usize,
}

/// The highest peak and the deepest valley of a cycle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tips {
    pub peak: Option<CycleTip>,
    pub valley: Option<CycleTip>,
}

impl Tips {
    pub fn take(&mut self, tip: CycleTip, is_peak: bool) {
        let side = if is_peak { &mut self.peak } else { &mut self.valley };
        let further =
            |known: &CycleTip| if is_peak { tip.input > known.input } else { tip.input < known.input };
        if side.as_ref().is_none_or(further) {
            *side = Some(tip);
        }
    }
}
