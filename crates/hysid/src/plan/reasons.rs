//! Why segments are run, in words.

use super::Disagreement;
use super::limits::Limits;
use super::segment::{Kind, Segment};
use crate::data::record::ColumnNames;
use crate::data::unit;
use crate::significant::Significant;

/// Gives every segment its reason.
pub(super) fn give(
    segments: &mut [Segment],
    names: &ColumnNames,
    limits: Limits,
    disagreement: Option<Disagreement>,
) {
    let unit = unit::of_column(&names.output).map_or_else(String::new, |unit| format!(" {unit}"));
    for segment in segments {
        segment.reason = purpose(segment, limits);
        if segment.kind == Kind::Return {
            continue;
        }
        if let Some(share) = segment.new_share.filter(|share| *share > 0.0) {
            segment.reason += &format!("; {:.0} % of it on branches that were not run", 100.0 * share);
        }
        if let Some((members, all)) = segment.disagreement.zip(disagreement) {
            let (members, repeat) = (Significant(members), Significant(all.repeat));
            segment.reason += &format!("; members differ by {members:.2}{unit} (data: {repeat:.2}{unit})");
        }
    }
}

/// What a segment adds.
fn purpose(segment: &Segment, limits: Limits) -> String {
    let slow = match segment.rate / limits.max_rate {
        share if share < 0.3 && share > 0.0 => " at low speed",
        share if share < 0.67 && share > 0.0 => " at medium speed",
        _ => "",
    };
    let words = segment.kind.purpose();
    let said = !matches!(segment.kind, Kind::TwoSpeeds | Kind::Return | Kind::Hold);
    if said { format!("{words}{slow}") } else { words.to_string() }
}
