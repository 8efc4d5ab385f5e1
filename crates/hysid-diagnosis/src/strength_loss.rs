//! Strength loss: the force that a member bears at its largest deformation falls. Index: `1 - S_j/S_i`, the largest over
//! the cycles that reach both furthest inputs so far, with the strength `S = (y_peak - y_valley)/2` of a cycle and `i`
//! before `j`, theory.md (10.50). Loops that shrink when they are repeated are another property, deterioration.

use hysid_core::data::record::Record;
use hysid_core::significant::Significant;

use super::branch::BranchSet;
use super::cycles::{CLOSED, CycleRow};
use super::{Evidence, Finding, Picture, PictureCurve, Piece, Property, Verdict, significance};

/// A loss of strength that matters.
const EFFECT: f64 = 0.05;

/// Fewest cycles that are compared.
const FEWEST: usize = 3;

/// A member keeps its strength only where the largest amplitude is so many times the first one: a record of equal cycles
/// may begin after the loss. Designed.
const GROWTH: f64 = 1.5;

const EXPERIMENT: &str =
    "run cycles of growing amplitude up to the largest deformation that matters, two of each";

/// A cycle on the envelope.
struct EnvelopeTip<'r> {
    row: &'r CycleRow,
    amplitude: f64,
    strength: f64,
}

/// Tests for strength loss; `rate` says whether the output depends on the speed.
pub(crate) fn verdict(survey: &BranchSet, cycles: &[CycleRow], rate: Verdict) -> Finding {
    let not_testable = |why: String| Finding::not_testable(Property::StrengthLoss, why, EXPERIMENT);
    if rate == Verdict::Yes {
        return not_testable(
            "the output depends on the speed, and cycles of different speed differ for that".into(),
        );
    }
    let mut records: Vec<&str> = cycles.iter().map(|row| row.record.as_str()).collect();
    records.dedup();
    let tips: Vec<Vec<EnvelopeTip>> = records
        .into_iter()
        .filter_map(|name| survey.data.records().iter().find(|record| record.name() == name))
        .map(|record| {
            envelope(record, cycles.iter().filter(|row| row.complete && row.record == record.name()))
        })
        .filter(|tips| !tips.is_empty())
        .collect();
    let count: usize = tips.iter().map(Vec::len).sum();
    if count < FEWEST {
        return not_testable(format!("{count} cycles reach the furthest inputs so far; {FEWEST} are needed"));
    }
    let mut worst: Option<(f64, &EnvelopeTip, &EnvelopeTip)> = None;
    for tips in &tips {
        let mut strongest = &tips[0];
        for tip in tips {
            let loss = 1.0 - tip.strength / strongest.strength;
            if worst.is_none_or(|(most, _, _)| loss > most) {
                worst = Some((loss, strongest, tip));
            }
            if tip.strength > strongest.strength {
                strongest = tip;
            }
        }
    }
    let Some((loss, before, after)) = worst else { return not_testable("no cycle has a strength".into()) };
    // Half the difference of two readings, against another such.
    let deviation = survey.output_noise.deviation().max(survey.slow_noise) / before.strength;
    let limit = EFFECT.max(significance::critical_value(count) * deviation);
    let percent = 100.0 * loss;
    let (verdict, statement) = if loss > limit {
        let text = format!(
            "the force at the tips of the cycles falls by {percent:.0} %, from {:.3} at an amplitude of {:.3} to {:.3} at \
             {:.3}",
            Significant(before.strength),
            Significant(before.amplitude),
            Significant(after.strength),
            Significant(after.amplitude)
        );
        (Verdict::Yes, text)
    } else if !tips.iter().any(grows) {
        let text = "all cycles that reach the furthest inputs have nearly the same amplitude";
        (Verdict::NotTestable, text.into())
    } else if limit > significance::HIDDEN * EFFECT {
        (Verdict::NotTestable, format!("the noise hides losses of up to {:.0} % of the force", 100.0 * limit))
    } else {
        let most = if limit > EFFECT { 100.0 * limit } else { percent.max(0.0) };
        (Verdict::No, format!("the force at the tips of the cycles never falls by more than {most:.1} %"))
    };
    let piece = |tip: &EnvelopeTip| Piece { record: tip.row.record.clone(), rows: tip.row.rows };
    let curve = |tips: &Vec<EnvelopeTip>| PictureCurve {
        label: tips.first().map_or_else(String::new, |tip| tip.row.record.clone()),
        points: tips.iter().map(|tip| (tip.amplitude, tip.strength)).collect(),
    };
    Finding {
        property: Property::StrengthLoss,
        verdict,
        index: Some(loss),
        threshold: Some(limit),
        noise: Some(deviation * significance::typical_largest(count)),
        comparisons: count,
        statement,
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence { index: loss, pieces: vec![piece(before), piece(after)] }],
        picture: Some(Picture {
            x_label: "amplitude of the cycle".into(),
            y_label: "half the range of the force at its tips".into(),
            curves: tips.iter().map(curve).collect(),
        }),
    }
}

/// True for cycles that end at a much larger amplitude than they begin with.
fn grows(tips: &Vec<EnvelopeTip>) -> bool {
    tips.last().is_some_and(|last| last.amplitude >= GROWTH * tips[0].amplitude)
}

/// The cycles that reach both furthest inputs so far, in the order of time.
fn envelope<'r>(record: &Record, cycles: impl Iterator<Item = &'r CycleRow>) -> Vec<EnvelopeTip<'r>> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut tips = Vec::new();
    for row in cycles {
        let Some((valley, peak)) = row.valley_input.zip(row.peak_input) else { continue };
        let (below, above) = (-force_at_tip(record, row, -1.0), force_at_tip(record, row, 1.0));
        let reach = CLOSED * (peak - valley);
        if peak >= high - reach && valley <= low + reach && above > below {
            tips.push(EnvelopeTip { row, amplitude: 0.5 * (peak - valley), strength: 0.5 * (above - below) });
        }
        (low, high) = (low.min(valley), high.max(peak));
    }
    tips
}

/// The largest force in this direction of the row at the tip of a cycle and of the rows beside it: where rows are far apart,
/// the row at the tip may be on the way back already. Negative infinity where none is measured.
fn force_at_tip(record: &Record, cycle: &CycleRow, direction: f64) -> f64 {
    let (x, y) = (&record.inputs()[0], record.output());
    let last = record.len() - 1;
    let rows = cycle.rows.0..=cycle.rows.1.min(last);
    let tip = rows.max_by(|&a, &b| (direction * x[a]).total_cmp(&(direction * x[b]))).unwrap_or(0);
    let beside = &y[tip.saturating_sub(1)..=(tip + 1).min(last)];
    beside.iter().map(|y| direction * y).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
pub(crate) mod tests {
    use hysid_core::data::record::{ColumnNames, Dataset, Record};
    use hysid_core::elementary::{exp, powf, square};

    use crate::{Diagnosis, DiagnosisOptions, Property, Verdict};

    /// A member on three cycles of each of seven amplitudes up to 25 mm. `law` gives the force at an input that came by a
    /// small step; noise is a share of the range of the force.
    pub(crate) fn member(noise: f64, mut law: impl FnMut(f64, f64) -> f64) -> Dataset {
        let mut x = vec![0.0];
        let ends = [3.0, 6.0, 9.0, 12.0, 15.0, 20.0, 25.0].into_iter().flat_map(|a| [a, -a, a, -a, a, -a]);
        for end in ends.chain([0.0]) {
            let from: f64 = x[x.len() - 1];
            let rows = ((end - from).abs() / 0.25).ceil() as usize;
            x.extend((1..=rows).map(|row| from + (end - from) * row as f64 / rows as f64));
        }
        const PARTS: usize = 20;
        let mut y = vec![0.0];
        for pair in x.windows(2) {
            let step = (pair[1] - pair[0]) / PARTS as f64;
            y.push((1..=PARTS).map(|part| law(pair[0] + step * part as f64, step)).last().unwrap());
        }
        let largest = y.iter().fold(0.0f64, |largest, y| largest.max(y.abs()));
        let uniform = |row: usize| {
            f64::from((hysid_core::random::mix(row as u64) >> 40) as u32) / f64::from(1u32 << 24) - 0.5
        };
        y.iter_mut()
            .enumerate()
            .for_each(|(row, y)| *y += 2.0 * largest * noise * 12f64.sqrt() * uniform(row));
        let names = ColumnNames::of(Some("t"), &["Displacement (mm)"], "Force (kN)");
        Dataset::new(names, vec![Record::new("member", vec![x], y).unwrap()]).unwrap()
    }

    pub(crate) fn diagnosed(data: &Dataset) -> Diagnosis {
        Diagnosis::of(data, &DiagnosisOptions::default()).unwrap()
    }

    /// Elastic-plastic members: whole, softening with the largest deformation by a known share, broken at once, worn by 1 %
    /// a millimetre of travel in hundred, each with and without noise.
    #[test]
    fn lost_strength_is_found_with_its_share_and_kept_strength_is_not_lost() {
        /// The strength after a largest deformation and a travel.
        type Strength = fn(f64, f64) -> f64;
        let strength: [(&str, Verdict, Option<f64>, Strength); 4] = [
            ("whole", Verdict::No, None, |_, _| 10.0),
            ("soft", Verdict::Yes, Some(0.30), |largest, _| 10.0 * (1.0 - 0.02 * (largest - 10.0).max(0.0))),
            ("broken", Verdict::Yes, Some(0.70), |_, travel| if travel < 400.0 { 10.0 } else { 3.0 }),
            ("worn", Verdict::Yes, None, |_, travel| 10.0 * exp(-travel / 2000.0)),
        ];
        for (name, expected, loss, strength) in strength {
            // The last hides a loss of more than the one that matters.
            for noise in [0.0, 0.004, 0.03] {
                let (mut force, mut largest, mut travel) = (0.0f64, 0.0f64, 0.0);
                let data = member(noise, |x, dx| {
                    (largest, travel) = (largest.max(x.abs()), travel + dx.abs());
                    let most = strength(largest, travel);
                    force = (force + 5.0 * dx).clamp(-most, most);
                    force
                });
                let diagnosis = diagnosed(&data);
                let finding = diagnosis.finding(Property::StrengthLoss);
                if noise > 0.01 && finding.verdict == Verdict::NotTestable {
                    assert!(finding.statement.starts_with("the noise hides losses of up to"));
                    continue;
                }
                assert_eq!(finding.verdict, expected, "{name}, {noise}: {}", finding.statement);
                if let Some(loss) = loss {
                    assert!(
                        (finding.index.unwrap() - loss).abs() < 0.01 + 5.0 * noise,
                        "{name}: {:?}",
                        finding.index
                    );
                }
                let advised = diagnosis.advice.model.map(hysid_core::options::ModelName::name);
                assert_eq!(
                    diagnosis.advice.needs_deterioration == Verdict::Yes,
                    expected == Verdict::Yes,
                    "{name}"
                );
                assert!(expected == Verdict::No || advised == Some("gpnn"), "{name}: {advised:?}");
            }
        }
    }

    /// An elastic-plastic member in 12 rows from tip to tip, which miss the tips: their rows are on the way back in part.
    #[test]
    fn rows_that_miss_the_tips_lose_no_strength() {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        let (mut last, mut force, mut step) = (0.0f64, 0.0f64, 0);
        for end in [5.0, 8.0, 10.0, 15.0, 20.0, 25.0].into_iter().flat_map(|a| [a, -a, a, -a]) {
            let from = last;
            for part in 1..=100 {
                let now = from + (end - from) * f64::from(part) / 100.0;
                force = (force + 5.0 * (now - last)).clamp(-10.0, 10.0);
                last = now;
                step += 1;
                if step % 8 == 5 {
                    x.push(now);
                    y.push(force);
                }
            }
        }
        let names = ColumnNames::of(Some("t"), &["disp_mm"], "force_kN");
        let data = Dataset::new(names, vec![Record::new("coarse", vec![x], y).unwrap()]).unwrap();
        let diagnosis = diagnosed(&data);
        let finding = diagnosis.finding(Property::StrengthLoss);
        assert_ne!(finding.verdict, Verdict::Yes, "{}", finding.statement);
        assert!(finding.index.is_none_or(|loss| loss < 0.03), "{:?}", finding.index);
    }

    /// Three loops of each amplitude that lose 9 % from one to the next wear, and a force without loops has no strength to
    /// lose.
    #[test]
    fn loops_that_lose_nine_percent_a_cycle_deteriorate() {
        let (mut force, mut worn) = (0.0f64, 0.0);
        let data = member(0.004, |x, dx| {
            // 9 % over a cycle of the largest amplitude, less in small ones.
            worn += dx.abs() * square(x.abs() / 25.0) / 33.0;
            let most = 10.0 * powf(1.0f64 - 0.09, worn);
            force = (force + 5.0 * dx).clamp(-most, most);
            force
        });
        let diagnosis = diagnosed(&data);
        let finding = diagnosis.finding(Property::Deterioration);
        assert_eq!(finding.verdict, Verdict::Yes, "{:?} {}", finding.index, finding.statement);
        assert!(finding.index.unwrap() > finding.threshold.unwrap());
    }
}
