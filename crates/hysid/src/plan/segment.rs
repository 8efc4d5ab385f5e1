//! A segment of a drive: what is run and why.

use std::fmt;
use std::ops::Range;

use serde::{Serialize, Serializer};

/// Kind of a segment: how its input moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SegmentKind {
    /// A loop over the whole range, after which the memory is known.
    Conditioning,
    /// The same loop at two speeds.
    TwoSpeeds,
    /// The same loop several times.
    RepeatedLoop,
    /// The input stands still.
    Hold,
    /// Loops about the middle of the range.
    CentredLoop,
    /// Loops away from the middle.
    MinorLoop,
    /// From an end of the range to a reversal and back.
    ReversalCurve,
    /// Loops whose amplitude falls, each inside the one before.
    NestedLoops,
    /// Random turning points.
    RandomReversals,
    /// Loops whose amplitude rises.
    RisingLoops,
    /// Back to the input of the beginning.
    Return,
}

impl SegmentKind {
    /// Names the kind, in a few words.
    pub fn words(self) -> &'static str {
        self.texts().0
    }

    /// Purpose of the segment, in a few words.
    pub fn purpose(self) -> &'static str {
        self.texts().1
    }

    fn texts(self) -> (&'static str, &'static str) {
        match self {
            Self::Conditioning => ("full loop", "brings the memory into a known state"),
            Self::TwoSpeeds => ("loop at two speeds", "makes rate dependence testable"),
            Self::RepeatedLoop => ("repeated loop", "makes deterioration testable, and shows the noise"),
            Self::Hold => ("hold", "shows creep and relaxation"),
            Self::CentredLoop => ("centred loop", "amplitudes about the middle"),
            Self::MinorLoop => ("minor loop", "loops away from the middle"),
            Self::ReversalCurve => ("reversal curve", "reversals on the branches of the full loop"),
            Self::NestedLoops => ("nested loops", "loops inside loops: what the memory keeps"),
            Self::RandomReversals => ("random reversals", "many pairs of turning points in few rows"),
            Self::RisingLoops => ("rising loops", "each amplitude before a larger one changes the specimen"),
            Self::Return => ("return", "back to the beginning"),
        }
    }

    pub(super) fn reason(self, share: f64) -> String {
        let words = self.purpose();
        match share {
            _ if matches!(self, Self::TwoSpeeds | Self::Return | Self::Hold) => words.into(),
            share if share > 0.0 && share < 0.3 => format!("{words} at low speed"),
            share if share > 0.0 && share < 0.67 => format!("{words} at medium speed"),
            _ => words.into(),
        }
    }
}

impl fmt::Display for SegmentKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.words())
    }
}

/// A segment of a drive. Inputs and outputs are in the units of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Segment {
    /// Kind of the segment.
    pub kind: SegmentKind,
    /// Its rows in the drive, counted from 0.
    #[serde(serialize_with = "first_and_last")]
    pub rows: Range<usize>,
    /// Half the difference of the largest and the smallest input, behind the way to its first turning point.
    pub amplitude: f64,
    /// Half the sum of the largest and the smallest input there.
    pub mean: f64,
    /// Largest change of the input in a unit of time there, or from row to row without time.
    pub rate: f64,
    /// Turning points within it, the end included.
    pub turning_points: Vec<f64>,
    /// Why it is run.
    pub reason: String,
}

fn first_and_last<S: Serializer>(rows: &Range<usize>, serializer: S) -> Result<S::Ok, S::Error> {
    (rows.start, rows.end.saturating_sub(1)).serialize(serializer)
}
