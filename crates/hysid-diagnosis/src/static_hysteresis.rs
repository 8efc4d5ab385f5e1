//! Static hysteresis: is there a loop however slowly the input goes? Index: area of the loops over their box,
//! carried on to speed 0 where there are several speeds, theory.md (10.12).

mod shifted;
mod viscous;

use hysid_core::elementary::{hypot, ln};

use super::branch::BranchSet;
use super::wiping_out::loops;
use super::{Evidence, Finding, Property, Verdict, significance};
use crate::branch::Opening;

/// Hysteresis is present if a loop fills more than this share of its bounding box.
pub(super) const FULL: f64 = 0.02;

/// Factor by which speeds must differ to distinguish a loop of speed 0 from that of the slowest.
const RANGE_OF_SPEEDS: f64 = 1.5;

/// A loop this many times as wide as a lag makes it is not only the lag's.
const BEYOND_A_LAG: f64 = 3.0;

/// Speeds within this factor are taken together.
const TOGETHER: f64 = 1.15;

/// Rows of a lag that may explain a loop of the same width, without time stamps.
const FEW_ROWS: f64 = 3.0;

/// Openings over less than this share of the widest do not count.
const WIDE: f64 = 0.7;

/// Mean magnitude of the difference of two numbers with noise of deviation 1.
const OF_A_LINE: f64 = 1.13;

/// A loop of speed 0 is at least this share of the slowest one; less may be the curvature of its growth.
const REMAINS: f64 = 0.3;

/// Speeds that show how loops grow.
const SPEEDS: usize = 3;

/// Loops this much smaller at a faster speed shrink.
const SHRINKS: f64 = 0.97;

/// Loops that grow with a power of the speed below this one are not those of a relaxation.
const SLOW_GROWTH: f64 = 0.5;

/// A lag explains no loops whose widths require lags that differ by this factor.
const UNLIKE_A_LAG: f64 = 2.0;

/// Largest lag that closes loops, relative to the largest that their widths require.
const FURTHER: f64 = 2.0;

/// Loops over less than this share of the widest say nothing about a lag.
const SMALL_SWING: f64 = 0.2;

/// Loops that are fuller than so many times what noise leaves say something about it.
const CLEAR: f64 = 10.0;

const EXPERIMENT: &str = "run the same loop at three speeds, the slowest ten times slower than the fastest";

/// Tests whether loops remain at speed 0. At a single speed, `longest_lag` is the time by which the output may be
/// late at the turning points: a lag `τ` makes a loop of the width `2 τ |x'|`. `rate` says whether the output depends on
/// the speed: if so, what loops do at speed 0 is known only where they grow with the speed, and not in proportion.
pub(crate) fn verdict(
    survey: &BranchSet,
    rate: Verdict,
    longest_lag: impl FnOnce() -> Option<f64>,
) -> Finding {
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
    if shown.height.is_nan() || shown.height <= 0.0 {
        let statement = "the output does not change within the largest loop of the input";
        return Finding::not_testable(Property::StaticHysteresis, statement, EXPERIMENT);
    }
    let rows: usize = shown.rows(survey);
    let between =
        hypot(survey.output_noise.of_mean(survey.window), survey.output_noise.wander(0.5 * rows as f64));
    let noise = OF_A_LINE * between / shown.height;
    let threshold = FULL + significance::critical_value(1) * noise;
    // Loops that tell of a lag: not small, and far fuller than noise makes them.
    let small = FULL.max(CLEAR * noise);
    let is_clear = |opening: &&Opening| opening.swing > SMALL_SWING * widest && opening.fullness() > small;
    let clear: Vec<&Opening> = survey.openings.iter().filter(is_clear).collect();
    let percent = 100.0 * index;
    let fullest = large.iter().map(|opening| opening.fullness()).fold(0.0, f64::max);
    let known = rate != Verdict::Yes || growth_is_known(&large);
    let (verdict, statement) = if area < threshold && threshold > 2.0 * FULL && area > FULL {
        (Verdict::NotTestable, "the noise is too large to detect loops that matter".to_string())
    } else if area < threshold && next.is_none() && fullest > 2.0 * threshold {
        (
            Verdict::NotTestable,
            format!(
                "loops fill {percent:.1} % to {:.1} % of their bounding boxes: some show hysteresis, others do not",
                100.0 * fullest
            ),
        )
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
    } else if next.is_some() && (!known || index < threshold) {
        (
            Verdict::NotTestable,
            format!(
                "loops fill {percent:.0} % of their bounding box and depend on the speed; whether they vanish at \
                 speed 0 is not shown by these speeds"
            ),
        )
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
                "loops fill {percent:.0} % of their bounding box, more than a pure lag with the same tips \
                     would"
            ),
        )
    } else if !may_be_a_lag(survey, &clear, small) {
        (
            Verdict::Yes,
            format!(
                "loops fill {percent:.0} % of their bounding box; a lag that explains some of them does not explain others"
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
    } else if area < 2.0 * lag_of_few_rows(rows) || shifted::closes(survey, &clear, FEW_ROWS, small) {
        (
            Verdict::NotTestable,
            format!(
                "loops fill {percent:.1} % of their bounding box: a lag of {FEW_ROWS} rows would look the same"
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

/// Share of its box that a lag of a few rows fills on a line of so many rows, there and back.
fn lag_of_few_rows(rows: usize) -> f64 {
    2.0 * FEW_ROWS / (0.5 * rows as f64)
}

/// True if one lag may explain these loops: the rows by which the output would be late are then the same for all of them,
/// whatever their amplitude, within a factor that also allows for the shape of the curve; or the loops close, to less than
/// `small`, where the output is read some rows later or earlier.
fn may_be_a_lag(survey: &BranchSet, loops: &[&Opening], small: f64) -> bool {
    let lag = |opening: &&Opening| 0.25 * opening.fullness() * opening.rows(survey) as f64;
    let least = loops.iter().map(lag).fold(f64::INFINITY, f64::min);
    let most = loops.iter().map(lag).fold(0.0, f64::max);
    most < UNLIKE_A_LAG * least || shifted::closes(survey, loops, FURTHER * most, small)
}

/// [`verdict`] for a measured record: withholds a "yes" if a law without loops at speed 0 also explains the record.
pub(crate) fn test_of_measured(
    survey: &BranchSet,
    rate: Verdict,
    longest_lag: impl FnOnce() -> Option<f64>,
) -> Finding {
    let mut finding = verdict(survey, rate, longest_lag);
    if finding.verdict == Verdict::Yes && survey.data.has_time() && viscous::may_be_viscous(survey) {
        finding.verdict = Verdict::NotTestable;
        finding.statement +=
            ", but a spring with a dashpot, whose loops vanish at speed 0, also explains the record";
        finding.experiment = Some(EXPERIMENT.into());
    }
    finding
}

/// True if loops grow from speed to speed (at three or more), and from the slowest to the next by much less than the
/// speed does. Loops of a relaxation grow in proportion to a slow speed and shrink at fast ones.
fn growth_is_known(large: &[&Opening]) -> bool {
    let mut groups: Vec<(f64, Vec<f64>)> = Vec::new();
    for opening in large {
        let Some(speed) = opening.speed else {
            return false;
        };
        match groups.last_mut() {
            Some((slowest, areas)) if speed <= RANGE_OF_SPEEDS * *slowest => areas.push(opening.fullness()),
            _ => groups.push((speed, vec![opening.fullness()])),
        }
    }
    let mean = |areas: &Vec<f64>| areas.iter().sum::<f64>() / areas.len() as f64;
    let grows = groups.windows(2).all(|pair| mean(&pair[1].1) >= SHRINKS * mean(&pair[0].1));
    let power = |a: &(f64, Vec<f64>), b: &(f64, Vec<f64>)| ln(mean(&b.1) / mean(&a.1)) / ln(b.0 / a.0);
    groups.len() >= SPEEDS && grows && power(&groups[0], &groups[1]) < SLOW_GROWTH
}

#[cfg(test)]
mod tests {
    use hysid_core::data::record::Dataset;
    use hysid_core::elementary::{sin, tanh};
    use hysid_core::operator::{Operator, Play};

    use crate::{Diagnosis, DiagnosisOptions, Property, Verdict};

    /// A narrow magnet on cycles of three amplitudes, 200 rows each: one lag does not explain the loops of all of them; a
    /// function of the input that is read three rows late is explained by one.
    #[test]
    fn loops_that_no_single_lag_explains_are_static() {
        let x: Vec<f64> = (0..1200)
            .map(|row| [0.3, 0.6, 1.0][row / 400] * sin(std::f64::consts::TAU * row as f64 / 200.0))
            .collect();
        let play = Play::new(0.05).unwrap().run(&x);
        let magnet: Vec<f64> = play.iter().map(|x| tanh(2.0 * x)).collect();
        let late = |function: fn(f64) -> f64| -> Vec<f64> {
            (0..1200).map(|row: usize| function(x[row.saturating_sub(3)])).collect()
        };
        for (y, expected) in [
            (magnet, Verdict::Yes),
            (late(|x| tanh(2.0 * x)), Verdict::NotTestable),
            // Their loops are not equally wide at equal lags.
            (late(|x| x * x * x), Verdict::NotTestable),
            (late(|x| (x - 0.25).abs()), Verdict::NotTestable),
        ] {
            let data = Dataset::from_slices(&x, &y).unwrap();
            let diagnosis = Diagnosis::of(&data, &DiagnosisOptions::default()).unwrap();
            let finding = diagnosis.finding(Property::StaticHysteresis);
            assert_eq!(finding.verdict, expected, "{}", finding.statement);
        }
    }
}
