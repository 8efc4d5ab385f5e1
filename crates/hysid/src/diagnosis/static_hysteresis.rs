//! Static hysteresis: is there a loop however slowly the input goes? Index: area of the loops over their box,
//! carried on to speed 0 where there are several speeds, theory.md (10.12).

use super::branch::Survey;
use super::orientation::piece;
use super::wiping_out::loops;
use super::{Cycle, Evidence, Finding, Property, Verdict, noise};

/// Loops fuller than this share of their box are loops.
const FULL: f64 = 0.02;

/// Speeds must differ by this factor for a loop of speed 0 to be told from that of the slowest.
const RANGE_OF_SPEEDS: f64 = 1.5;

/// A loop of speed 0 is at least this share of the slowest one; less may be the curvature of its growth.
const REMAINS: f64 = 0.3;

const EXPERIMENT: &str = "run the same loop at three speeds, the slowest ten times slower than the fastest";

/// Tests whether loops remain at speed 0.
pub(crate) fn test(survey: &Survey, cycles: &[Cycle]) -> Finding {
    let widest = cycles.iter().map(Cycle::swing).fold(0.0, f64::max);
    let large: Vec<&Cycle> = cycles.iter().filter(|cycle| cycle.swing() > 0.9 * widest).collect();
    if large.is_empty() {
        return Finding::not_testable(Property::StaticHysteresis, "no closed loop", EXPERIMENT);
    }
    let slowest = large.iter().filter_map(|cycle| cycle.speed).fold(f64::INFINITY, f64::min);
    let fastest = large.iter().filter_map(|cycle| cycle.speed).fold(0.0, f64::max);
    let timed = slowest.is_finite();
    let several = timed && fastest > RANGE_OF_SPEEDS * slowest;
    let slow: Vec<&Cycle> = large
        .iter()
        .filter(|cycle| cycle.speed.is_none_or(|speed| speed <= 1.1 * slowest))
        .copied()
        .collect();
    let fullness = |cycle: &Cycle| cycle.area / (cycle.swing() * cycle.height()).max(f64::MIN_POSITIVE);
    let mean = |cycles: &[&Cycle]| cycles.iter().map(|c| fullness(c)).sum::<f64>() / cycles.len() as f64;
    let slow_area = mean(&slow);
    let shown = slow[0];
    // The area of a line that is not quite one: what noise leaves between two smoothed branches.
    let noise = 0.8 * survey.output_noise / (survey.window as f64).sqrt() / shown.height();
    let index = if several {
        let next = large.iter().filter_map(|cycle| cycle.speed).filter(|speed| *speed > 1.2 * slowest);
        let next = next.fold(f64::INFINITY, f64::min);
        let faster: Vec<&Cycle> = large
            .iter()
            .filter(|cycle| cycle.speed.is_some_and(|speed| speed > 1.2 * slowest && speed <= 1.1 * next))
            .copied()
            .collect();
        let growth = (mean(&faster) - slow_area) / (next - slowest);
        slow_area - growth.max(0.0) * slowest
    } else {
        slow_area
    };
    let threshold = FULL + noise::critical_value(1) * noise;
    let percent = 100.0 * index;
    let (verdict, statement) = if slow_area < threshold {
        (
            Verdict::No,
            format!("the loops fill {percent:.1} % of their box: the output follows the input alone"),
        )
    } else if several && index < REMAINS * slow_area {
        (Verdict::No, "the loops vanish as the speed goes to 0".to_string())
    } else if several {
        (Verdict::Yes, format!("carried on to speed 0, loops still fill {percent:.0} % of their box"))
    } else if timed {
        (
            Verdict::NotTestable,
            format!("loops fill {percent:.0} % of their box, at one speed: a lag would look alike"),
        )
    } else {
        (Verdict::Yes, format!("loops fill {percent:.0} % of their box (without time stamps, taken as slow)"))
    };
    let (a, b) = shown.branches;
    Finding {
        property: Property::StaticHysteresis,
        verdict,
        index: Some(index),
        threshold: Some(threshold),
        noise: Some(noise),
        comparisons: large.len(),
        statement,
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: fullness(shown), pieces: vec![piece(shown)] }],
        picture: Some(loops(vec![
            survey.curve("there", &survey.branches[a]),
            survey.curve("back", &survey.branches[b]),
        ])),
    }
}
