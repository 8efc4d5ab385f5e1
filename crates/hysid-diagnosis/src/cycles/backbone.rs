//! The backbone: the turning points of the first cycle of each amplitude, in both directions.
//!
//! A turning point belongs to it if it lies further from where the record began than those of the backbone before it in its
//! direction, by the 5 % that separate levels and twice the noise of the input: so of the cycles of a level only the first
//! counts (ASTM E2126, envelope curve of the first cycles; ASCE/SEI 41, section 7.6; FEMA 461).

use serde::Serialize;

use super::levels::ALIKE;
use super::reading::output_before_rest;
use crate::branch::BranchSet;

/// The side to which the input went before it turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Upwards: the turning point is a peak.
    Up,
    /// Downwards: it is a valley.
    Down,
}

/// A turning point on the backbone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BackbonePoint {
    /// Name of the record.
    pub record: String,
    /// Its row, counted from 0 at the beginning of the record.
    pub row: usize,
    /// The side of the record's beginning on which it is.
    pub direction: Direction,
    /// Input at the turning point.
    pub input: f64,
    /// Output at the turning point, before it relaxes.
    pub output: f64,
}

/// The backbone of a record, in the order of time. Turning points without output are left out.
pub(super) fn backbone(survey: &BranchSet, record: usize, level: f64) -> Vec<BackbonePoint> {
    let (branches, noise) = (survey.of_record(record), survey.output_noise.deviation());
    let mut furthest = [0.0, 0.0];
    let mut points = Vec::new();
    // The end of the last branch is the end of the record.
    for branch in &branches[..branches.len().saturating_sub(1)] {
        let (side, direction, away) = match branch.rises() {
            true => (0, Direction::Up, branch.to - level),
            false => (1, Direction::Down, level - branch.to),
        };
        if away <= furthest[side] * (1.0 + ALIKE) + 2.0 * survey.input_noise.deviation() {
            continue;
        }
        furthest[side] = away;
        points.extend(output_before_rest(branch, level, noise).map(|output| BackbonePoint {
            record: survey.data.records()[record].name().into(),
            row: branch.rows.end - 1,
            direction,
            input: branch.to,
            output,
        }));
    }
    points
}
