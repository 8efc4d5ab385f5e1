//! Deterioration: loops shrink when they are repeated. Index: `1 - E_last/E_first` over the cycles between the
//! same inputs, with the sum of all rises against all falls of the energy (Mann and Kendall) and the median
//! slope (Theil and Sen), theory.md (10.11).

use super::branch::BranchSet;
use super::cycles::{self, repeated};
use super::significance;
use super::{Cycle, Evidence, Finding, Picture, PictureCurve, Property, Verdict};
use hysid_core::elementary::hypot;
use hysid_core::significant::Significant;

/// A loss of energy that matters, as a share of the first cycle's.
const EFFECT: f64 = cycles::LOSS;

/// Fewest repeated cycles, all kinds together.
const FEWEST: usize = 3;

/// Cycles of one kind that are compared at most.
const MOST: usize = 200;

/// Loops with less than this share of the largest repeated area say little: they settle, and noise hides what they lose.
const SMALLEST: f64 = 0.1;

/// Loops of this share of the largest repeated area are the largest.
const NEARLY_LARGEST: f64 = 0.95;

/// Repetitions that show whether a loss goes on.
const ENOUGH: usize = 5;

const EXPERIMENT: &str = "repeat a large loop five times or more, without changing its ends";

/// Loss of energy over the cycles between two inputs.
struct CycleTrend<'c> {
    cycles: Vec<&'c Cycle>,
    /// All of them, with a first one that is left out.
    repetitions: usize,
    /// `1 - E_last/E_first` along the median slope.
    loss: f64,
    deviation: f64,
    /// Falls less rises among all pairs, and how many pairs there are.
    falls: f64,
    variance: f64,
}

pub(crate) fn verdict(survey: &BranchSet, cycles: &[Cycle]) -> Finding {
    let groups = repeated(survey, cycles);
    let largest = groups.iter().flatten().map(|cycle| cycle.area).fold(0.0, f64::max);
    let trends: Vec<CycleTrend> = groups.iter().filter_map(|group| trend(survey, group, largest)).collect();
    let count: usize = trends.iter().map(|trend| trend.repetitions).sum();
    if count < FEWEST {
        let statement = format!("{count} loops are repeated between the same inputs; {FEWEST} are needed");
        return Finding::not_testable(Property::Deterioration, statement, EXPERIMENT);
    }
    let critical = significance::critical_value(trends.len());
    let excess = |trend: &CycleTrend| trend.loss / EFFECT.max(critical * trend.deviation);
    let strongest = trends.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))).expect("there are trends");
    // Loops that were run twice may shrink while they settle: the largest must, or most.
    let decides =
        |trend: &CycleTrend| trend.repetitions > 2 || trend.cycles[0].area > NEARLY_LARGEST * largest;
    let energy = |trend: &CycleTrend| trend.cycles.len() as f64 * trend.cycles[0].area;
    let shrinking: Vec<&CycleTrend> =
        trends.iter().filter(|trend| excess(trend) > 1.0 && trend.falls > 0.0).collect();
    let sum = |trends: &[&CycleTrend]| trends.iter().map(|trend| energy(trend)).sum::<f64>();
    let falls: f64 = trends.iter().map(|trend| trend.falls).sum();
    let variance: f64 = trends.iter().map(|trend| trend.variance).sum();
    let trend_score = falls / variance.sqrt().max(1.0);
    let limit = EFFECT.max(critical * strongest.deviation);
    // Steady losses of a few loops that would matter after more.
    let may_go_on = |trend: &CycleTrend| {
        let steps = (trend.cycles.len() - 1) as f64;
        let is_sure = trend.falls > 0.0 && trend.loss > critical * trend.deviation;
        is_sure && trend.loss * ((ENOUGH - 1) as f64 / steps).max(1.0) > EFFECT
    };
    let (verdict, statement) = if shrinking.iter().any(|trend| decides(trend))
        || !shrinking.is_empty() && 2.0 * sum(&shrinking) >= trends.iter().map(energy).sum()
    {
        let text = format!(
            "the energy of repeated loops falls by up to {:.0} % (in {} of {} groups of equal loops; trend score {trend_score:.1})",
            100.0 * strongest.loss,
            shrinking.len(),
            trends.len()
        );
        (Verdict::Yes, text)
    } else if limit > significance::HIDDEN * EFFECT {
        (
            Verdict::NotTestable,
            format!("the noise hides losses of up to {:.0} % of the energy", 100.0 * limit),
        )
    } else if let Some(trend) = trends
        .iter()
        .filter(|trend| decides(trend) && may_go_on(trend))
        .max_by(|a, b| a.loss.total_cmp(&b.loss))
    {
        let (lost, loops) = (100.0 * trend.loss, trend.cycles.len());
        (
            Verdict::NotTestable,
            format!(
                "the energy falls by {lost:.1} % over {loops} loops: more loops would show whether the loss goes on"
            ),
        )
    } else if strongest.loss > limit {
        (
            Verdict::NotTestable,
            format!(
                "the energy of some repeated loops falls by up to {:.0} %, that of most does not: they may only settle",
                100.0 * strongest.loss
            ),
        )
    } else if strongest.loss < -limit {
        let grows = -100.0 * strongest.loss;
        (Verdict::No, format!("the energy of repeated loops does not fall: it grows by {grows:.0} % or more"))
    } else {
        let within = 100.0 * if limit > EFFECT { limit } else { strongest.loss.abs() };
        (Verdict::No, format!("repeated loops keep their energy, within {:.2} %", Significant(within)))
    };
    Finding {
        property: Property::Deterioration,
        verdict,
        index: Some(strongest.loss),
        threshold: Some(limit),
        noise: Some(strongest.deviation * significance::typical_largest(trends.len())),
        comparisons: trends.len(),
        statement,
        experiment: (verdict == Verdict::NotTestable).then(|| EXPERIMENT.into()),
        evidence: vec![Evidence {
            index: strongest.loss,
            pieces: [strongest.cycles.first(), strongest.cycles.last()]
                .into_iter()
                .flatten()
                .map(|cycle| cycle.piece())
                .collect(),
        }],
        picture: Some(energies(&trends)),
    }
}

fn trend<'c>(survey: &BranchSet, group: &[&'c Cycle], largest: f64) -> Option<CycleTrend<'c>> {
    // Loops of different speed differ for other reasons.
    let branch = |cycle: &Cycle| &survey.branches[cycle.branches.0];
    let alike: Vec<&Cycle> =
        group.iter().filter(|cycle| survey.similar_speed(branch(group[0]), branch(cycle))).copied().collect();
    let repetitions = alike.len();
    // The first cycle still remembers what was before; of two, it is all there is to compare with.
    let alike = if alike.len() > 2 { &alike[1..] } else { &alike[..] };
    let step = alike.len().div_ceil(MOST).max(1);
    let cycles: Vec<&Cycle> = alike.iter().copied().step_by(step).collect();
    let n = cycles.len();
    let first = cycles.first()?;
    if n < 2 || first.area < SMALLEST * largest {
        return None;
    }
    // Loops that cross themselves lose no energy on the whole, but have an area.
    let crosses = first.energy.abs() < 0.3 * first.area;
    let energy = |cycle: &Cycle| if crosses { cycle.area } else { cycle.energy.abs() };
    // A line that noise or drift opens has nothing to lose.
    let (slope, falls) = if first.is_open() { slope_and_falls(&cycles, energy) } else { (0.0, 0.0) };
    let scale = energy(first);
    let deviation = hypot(first.energy_deviation, cycles[n - 1].energy_deviation) / scale;
    let size = n as f64;
    Some(CycleTrend {
        loss: -slope * (size - 1.0) / scale,
        deviation,
        falls,
        variance: size * (size - 1.0) * (2.0 * size + 5.0) / 18.0,
        cycles,
        repetitions,
    })
}

/// Median slope of the energies over the number of the cycle, and falls less rises, over all pairs.
fn slope_and_falls(cycles: &[&Cycle], energy: impl Fn(&Cycle) -> f64) -> (f64, f64) {
    let n = cycles.len();
    let mut slopes = Vec::with_capacity(n * (n - 1) / 2);
    let mut falls = 0.0;
    for i in 0..n {
        for j in i + 1..n {
            let change = energy(cycles[j]) - energy(cycles[i]);
            slopes.push(change / (j - i) as f64);
            falls -= if change.abs() > 0.0 { change.signum() } else { 0.0 };
        }
    }
    (significance::median(&mut slopes), falls)
}

/// Energy over the number of the cycle, each kind of loop by itself.
fn energies(trends: &[CycleTrend]) -> Picture {
    const SHOWN: usize = 6;
    let mut kinds: Vec<&CycleTrend> = trends.iter().collect();
    kinds.sort_by(|a, b| b.cycles[0].area.total_cmp(&a.cycles[0].area));
    let curve = |trend: &&CycleTrend| PictureCurve {
        label: format!(
            "{:.3} to {:.3}",
            Significant(trend.cycles[0].input.0),
            Significant(trend.cycles[0].input.1)
        ),
        points: trend.cycles.iter().enumerate().map(|(k, cycle)| ((k + 1) as f64, cycle.area)).collect(),
    };
    Picture {
        x_label: "cycle between the same inputs".into(),
        y_label: "energy of the loop".into(),
        curves: kinds.iter().take(SHOWN).map(curve).collect(),
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::data::record::{ColumnNames, Dataset, Record};
    use hysid_core::elementary::powf;

    use crate::{Diagnosis, DiagnosisOptions, Finding, Property, Verdict};

    /// Findings on wear and on symmetry for a member of four elastic-plastic springs on two cycles of each of six amplitudes,
    /// the last of which is left after half a cycle. All forces lose a share in each cycle, evenly; noise is a share of the
    /// range.
    fn findings(loss: f64, noise: f64, seed: u64) -> [Finding; 2] {
        findings_of(2, loss, noise, seed)
    }

    /// The same with another number of cycles of each amplitude.
    fn findings_of(cycles: usize, loss: f64, noise: f64, seed: u64) -> [Finding; 2] {
        const ROWS: usize = 60;
        let ends = [5.0, 8.0, 12.0, 18.0, 27.0]
            .into_iter()
            .flat_map(|a| std::iter::repeat_n([a, -a], cycles).flatten())
            .chain([40.0, -40.0]);
        let (mut x, mut y, mut last, mut halves) = (vec![0.0], vec![0.0], 0.0, 0.0);
        let mut forces = [0.0; 4];
        for end in ends {
            let step = (end - last) / ROWS as f64;
            for row in 1..=ROWS {
                for (place, force) in (1..).zip(&mut forces) {
                    let most = 4.0 * f64::from(place);
                    *force = (*force + step).clamp(-most, most);
                }
                let strength = powf(1.0 - loss, 0.5 * (halves + row as f64 / ROWS as f64));
                x.push(last + step * row as f64);
                y.push(strength * forces.iter().sum::<f64>());
            }
            (last, halves) = (end, halves + 1.0);
        }
        let range = y.iter().copied().fold(0.0, f64::max) - y.iter().copied().fold(0.0, f64::min);
        for (row, y) in (0u64..).zip(&mut y) {
            let even = |part: u64| {
                let bits = hysid_core::random::mix(seed * 1_000_003 + 16 * row + part) >> 40;
                f64::from(bits as u32) / f64::from(1u32 << 24) - 0.5
            };
            // Twelve even numbers together are nearly normal.
            *y += noise * range * (0..12).map(even).sum::<f64>();
        }
        let names = ColumnNames::of(None, &["disp_mm"], "force_kN");
        let data = Dataset::new(names, vec![Record::new("member", vec![x], y).unwrap()]).unwrap();
        let diagnosis = Diagnosis::of(&data, &DiagnosisOptions::default()).unwrap();
        [Property::Deterioration, Property::OddSymmetry].map(|property| diagnosis.finding(property).clone())
    }

    /// The last cycle of each level goes on to the next: two loops of a level are one closed loop and one that is passed.
    #[test]
    fn two_cycles_a_level_show_wear() {
        for loss in [0.1, 0.2] {
            for noise in [0.0, 0.003, 0.01] {
                let [wear, _] = findings(loss, noise, 1);
                assert_eq!(wear.verdict, Verdict::Yes, "{loss} {noise}: {}", wear.statement);
                let found = wear.index.unwrap();
                assert!((found - loss).abs() < 0.02 + 8.0 * noise, "{loss} {noise}: {found}");
            }
        }
    }

    /// Two of them remain beside the first, which remembers the level before, and the last, which goes on.
    #[test]
    fn four_cycles_that_lose_a_little_are_not_said_to_keep_their_energy() {
        let [wear, _] = findings_of(4, 0.03, 0.0005, 1);
        assert_eq!(wear.verdict, Verdict::NotTestable, "{}", wear.statement);
        assert!(wear.statement.contains("whether the loss goes on"), "{}", wear.statement);
        let [wear, _] = findings_of(4, 0.0, 0.0005, 1);
        assert_eq!(wear.verdict, Verdict::No, "{}", wear.statement);
        let [wear, _] = findings_of(4, -0.1, 0.0005, 1);
        assert!(
            wear.verdict == Verdict::No && wear.statement.contains("it grows by 1"),
            "{}",
            wear.statement
        );
    }

    #[test]
    fn two_cycles_a_level_of_a_sound_member_show_none() {
        for seed in 0..6 {
            for noise in [0.0, 0.003, 0.01, 0.03] {
                let [wear, _] = findings(0.0, noise, seed);
                assert_ne!(wear.verdict, Verdict::Yes, "{noise} {seed}: {}", wear.statement);
                assert!(noise > 0.003 || wear.verdict == Verdict::No, "{noise} {seed}: {}", wear.statement);
            }
        }
    }

    /// No three branches in succession go to the last tips: the level before decides.
    #[test]
    fn the_largest_level_with_three_branches_shows_symmetry() {
        for noise in [0.0, 0.003] {
            let [_, symmetry] = findings(0.0, noise, 1);
            assert_eq!(symmetry.verdict, Verdict::Yes, "{noise}: {}", symmetry.statement);
        }
    }
}
