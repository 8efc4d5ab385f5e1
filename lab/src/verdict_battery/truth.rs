//! The answers that count for a record.
//!
//! The answer is that of the law, however the record is disturbed: the user asks about the specimen. A drift of the
//! amplifier opens loops that the specimen closes, and a delay of the sensor makes a record, not a specimen, depend on
//! the speed. Some entries do not count:
//!
//! - The law has no clear answer.
//! - The law violates the property, and the undisturbed record compares what the property says to be equal, but the
//!   difference is below [`CLEARLY`] times the effect that matters: either answer is right then, or both are close. So
//!   a Bouc-Wen law counts as one without return points only where its gaps matter.
//! - The law violates a property of the memory, but the record shows so only between branches of different speed, where
//!   the rate could be the reason.
//! - The slope at the end, the direction of the loops or their area at rest is close to the limit on this path.
//! - The law neither wears nor depends on the rate, but its first loops shrink, lose force or move while it settles: the record
//!   shows what wear or an asymmetry would show.
//! - A law that depends on the rate was recorded without time: a verdict on loops at rest then assumes that the record
//!   was slow, and says so.
//! - The specimen was made to wear during the record: the law knows nothing of that wear, and its size is that of the
//!   effect that matters.
//!
//! A record with nothing to compare has no violation to show. The law's answer counts then: `yes` on a law without
//! wear after a single loop would be a guess, and so would `no` on a law with wear. `not testable` is never wrong.

use super::disturbances::Disturbance;
use super::evidence::Evidence;
use super::paths::Path;
use super::property::{
    Answers, CONGRUENCY, DETERIORATION, LOOP_CLOSURE, MASING, ODD_SYMMETRY, ORIENTATION, PINCHING,
    RATE_DEPENDENCE, SATURATION, STATIC_HYSTERESIS, STRENGTH_LOSS, WIPING_OUT,
};

/// A violation counts from this multiple of the effect that matters on.
const CLEARLY: f64 = 2.0;

/// Properties that a law violates, the answer of a law that does, and the effect that docs/diagnosis.md calls relevant.
const VIOLATIONS: [(usize, bool, f64); 8] = [
    (RATE_DEPENDENCE, true, 0.01),
    (WIPING_OUT, false, 0.01),
    (CONGRUENCY, false, 0.05),
    (MASING, false, 0.05),
    (ODD_SYMMETRY, false, 0.02),
    (DETERIORATION, true, 0.05),
    (LOOP_CLOSURE, false, 0.01),
    (STRENGTH_LOSS, true, 0.05),
];

/// Loops that fill less than this share of their box are none, if it is half of it; those that fill twice as much are.
const FULL: f64 = 0.02;

/// Loops are passed in one direction from this share of their area on: twice the limit.
const ONE_DIRECTION: f64 = 0.6;

/// A slope at the end below half of this share of the largest is saturated; above twice, it is not.
const SATURATED: f64 = 0.1;

/// Branches whose slope near zero load is below half of this share of the largest are pinched; above it, they are not.
const SOFT: f64 = 0.5;

/// The answers that count.
pub fn truth(law: Answers, evidence: &Evidence, path: &Path, disturbance: &Disturbance) -> Answers {
    let depends_on_rate = law[RATE_DEPENDENCE] == Some(true);
    let mut truth = law;
    for (property, violated, effect) in VIOLATIONS {
        let Some(index) = evidence[property] else { continue };
        let hardly_shows = law[property] == Some(violated) && index < CLEARLY * effect;
        let settles = law[property] == Some(!violated)
            && matches!(property, ODD_SYMMETRY | DETERIORATION | STRENGTH_LOSS)
            && !depends_on_rate
            && index > effect / CLEARLY;
        if hardly_shows || settles {
            truth[property] = None;
        }
    }
    let agrees =
        |property: usize, yes: &dyn Fn(f64) -> bool, no: &dyn Fn(f64) -> bool| match evidence[property] {
            Some(index) => law[property].filter(|answer| if *answer { yes(index) } else { no(index) }),
            None => law[property],
        };
    truth[STATIC_HYSTERESIS] = agrees(STATIC_HYSTERESIS, &|i| i > CLEARLY * FULL, &|i| i < FULL / CLEARLY);
    truth[ORIENTATION] = agrees(ORIENTATION, &|i| i > ONE_DIRECTION, &|i| i < -ONE_DIRECTION);
    truth[SATURATION] = agrees(SATURATION, &|i| i < SATURATED / CLEARLY, &|i| i > CLEARLY * SATURATED);
    truth[PINCHING] = agrees(PINCHING, &|i| i < SOFT / CLEARLY, &|i| i > SOFT);
    if depends_on_rate && !path.timed {
        truth[STATIC_HYSTERESIS] = None;
    }
    if disturbance.wears() {
        truth[DETERIORATION] = None;
        truth[STRENGTH_LOSS] = None;
    }
    truth
}

#[cfg(test)]
mod tests {
    use super::super::property::PROPERTIES;
    use super::super::run::Run;
    use super::super::{disturbances, laws, paths};
    use super::*;

    /// The evidence of a law on every undisturbed path, and the answers that count.
    fn survey(law: &laws::Law) -> Vec<(&'static str, Evidence, Answers)> {
        let none = &disturbances::all()[0];
        let on = |path: paths::Path| {
            let evidence = Run::of(law, &path).evidence(0);
            (path.name, evidence, truth(law.answers(), &evidence, &path, none))
        };
        paths::all().into_iter().map(on).collect()
    }

    #[test]
    fn every_answer_counts_on_some_path_and_none_is_contradicted() {
        for law in laws::all() {
            let survey = survey(&law);
            for (property, answer) in law.answers().into_iter().enumerate() {
                let counts = survey.iter().any(|(_, _, truth)| truth[property].is_some());
                assert_eq!(counts, answer.is_some(), "{}: {}", law.name, PROPERTIES[property]);
            }
            for (property, violated, effect) in VIOLATIONS {
                if law.answers()[property] == Some(violated) {
                    let clear = |e: &Evidence| e[property].is_some_and(|index| index >= CLEARLY * effect);
                    assert!(
                        survey.iter().any(|(_, e, _)| clear(e)),
                        "{}: {}",
                        law.name,
                        PROPERTIES[property]
                    );
                }
                let exact = law.answers()[RATE_DEPENDENCE] == Some(false)
                    && matches!(property, WIPING_OUT | CONGRUENCY | MASING | LOOP_CLOSURE)
                    && law.answers()[property] == Some(true);
                for (path, evidence, _) in survey.iter().filter(|_| exact) {
                    let index = evidence[property].unwrap_or(0.0);
                    assert!(index < effect, "{} on {path}: {} {index}", law.name, PROPERTIES[property]);
                }
            }
        }
    }
}
