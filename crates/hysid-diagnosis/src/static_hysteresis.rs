//! Static hysteresis: is there a loop however slowly the input goes? Index: area of the loops over their box,
//! carried on to speed 0 where there are several speeds, theory.md (10.12).

use super::branch::BranchSet;
use super::wiping_out::loops;
use super::{Evidence, Finding, Property, Verdict, noise};
use crate::branch::Opening;

/// Loops fuller than this share of their box are loops.
pub(super) const FULL: f64 = 0.02;

/// Speeds must differ by this factor for a loop of speed 0 to be told from that of the slowest.
const RANGE_OF_SPEEDS: f64 = 1.5;

/// A loop this many times as wide as a lag makes it is not only the lag's.
const BEYOND_A_LAG: f64 = 3.0;

/// Speeds within this factor are taken together.
const TOGETHER: f64 = 1.15;

/// Openings over less than this share of the widest do not count.
const WIDE: f64 = 0.7;

/// Mean magnitude of the difference of two numbers with noise of deviation 1.
const OF_A_LINE: f64 = 1.13;

/// A loop of speed 0 is at least this share of the slowest one; less may be the curvature of its growth.
const REMAINS: f64 = 0.3;

const EXPERIMENT: &str = "run the same loop at three speeds, the slowest ten times slower than the fastest";

/// Tests whether loops remain at speed 0. At a single speed, `longest_lag` is the time by which the output may be
/// late at the turning points: a lag `τ` makes a loop of the width `2 τ |x'|`.
pub(crate) fn test(survey: &BranchSet, longest_lag: impl FnOnce() -> Option<f64>) -> Finding {
    let widest = survey.openings.iter().map(|opening| opening.swing).fold(0.0, f64::max);
    let mut large: Vec<&Opening> =
        survey.openings.iter().filter(|opening| opening.swing > WIDE * widest).collect();
    if large.is_empty() {
        return Finding::not_testable(Property::StaticHysteresis, "the input never turns", EXPERIMENT);
    }
    large.sort_by(|a, b| a.speed.unwrap_or(0.0).total_cmp(&b.speed.unwrap_or(0.0)));
    let at_speed = |speed: f64| -> Vec<&Opening> {
        let within =
            |opening: &&Opening| opening.speed.is_none_or(|own| own >= speed && own <= TOGETHER * speed);
        large.iter().copied().filter(within).collect()
    };
    let mean =
        |set: &[&Opening]| set.iter().map(|opening| opening.fullness()).sum::<f64>() / set.len() as f64;
    let slowest = large[0].speed;
    let slow = at_speed(slowest.unwrap_or(0.0));
    let area = mean(&slow);
    let next = slowest.and_then(|slowest| {
        let faster = large.iter().filter_map(|opening| opening.speed);
        let next = faster.filter(|speed| *speed > RANGE_OF_SPEEDS * slowest).fold(f64::INFINITY, f64::min);
        next.is_finite().then_some((slowest, next))
    });
    let index = match next {
        Some((slowest, next)) => {
            let growth = (mean(&at_speed(next)) - area) / (next - slowest);
            area - growth.max(0.0) * slowest
        }
        None => area,
    };
    // What noise leaves between two branches that are one line.
    let shown = slow.iter().max_by(|a, b| a.area.total_cmp(&b.area)).expect("the slowest is among them");
    let noise = OF_A_LINE * survey.output_noise / (survey.window as f64).sqrt() / shown.height;
    let threshold = FULL + noise::critical_value(1) * noise;
    let percent = 100.0 * index;
    let (verdict, statement) = if area < threshold && threshold > 2.0 * FULL && area > FULL {
        (Verdict::NotTestable, "the noise is too large to detect loops that matter".to_string())
    } else if area < threshold {
        (
            Verdict::No,
            format!(
                "the loops fill {percent:.1} % of their bounding box: the output is a function of the \
                     input"
            ),
        )
    } else if next.is_some() && index < REMAINS * area {
        (Verdict::No, "the loops vanish as the speed goes to 0".to_string())
    } else if next.is_some() {
        (
            Verdict::Yes,
            format!(
                "extrapolated to speed 0, loops still fill {percent:.0} % of their bounding \
                                box"
            ),
        )
    } else if let Some(speed) = slowest
        && longest_lag().is_some_and(|lag| area * shown.swing > BEYOND_A_LAG * 2.0 * lag * speed)
    {
        (
            Verdict::Yes,
            format!(
                "loops fill {percent:.0} % of their bounding box, more than a lag that fits their tips \
                     explains"
            ),
        )
    } else if slowest.is_some() {
        (
            Verdict::NotTestable,
            format!(
                "loops fill {percent:.0} % of their bounding box, at one speed: a lag would look the \
                     same"
            ),
        )
    } else {
        (
            Verdict::Yes,
            format!(
                "loops fill {percent:.0} % of their bounding box (no time stamps: assumed \
                                slow)"
            ),
        )
    };
    Finding {
        property: Property::StaticHysteresis,
        verdict,
        index: Some(index),
        threshold: Some(threshold),
        noise: Some(noise),
        comparisons: large.len(),
        statement,
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: shown.fullness(), pieces: shown.pieces(survey) }],
        picture: Some(loops(shown.curves(survey))),
    }
}
