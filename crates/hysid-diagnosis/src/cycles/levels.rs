//! Amplitude levels of a cyclic test: what is lost within a level, and from one to the next.

use serde::Serialize;

use super::reading::SURE;
use super::row::CycleRow;
use hysid_core::elementary::hypot;

/// Successive cycles whose amplitudes differ by less than this share are of one level.
pub(super) const ALIKE: f64 = 0.05;

/// Successive complete cycles of one amplitude. The output of a cycle is half the distance of the outputs at its peak and its valley.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelRow {
    /// Name of the record.
    pub record: String,
    /// Number of the level within its record, counted from 1.
    pub level: usize,
    /// Number of its cycles.
    pub cycles: usize,
    /// Amplitude of its first cycle.
    pub amplitude: Option<f64>,
    /// Amplitude of its first cycle in percent of the height of the structure.
    pub drift_percent: Option<f64>,
    /// Output of its first cycle.
    pub output_first: Option<f64>,
    /// Loss of output from its first to its last cycle, in percent of the first; `None` within noise.
    pub strength_loss_percent: Option<f64>,
    /// Output of its first cycle in percent of the largest so far.
    pub strength_percent: Option<f64>,
    /// Secant stiffness of its first cycle.
    pub stiffness_first: Option<f64>,
    /// Loss of secant stiffness from its first to its last cycle, in percent of the first; `None` within noise.
    pub stiffness_loss_percent: Option<f64>,
    /// Secant stiffness of its first cycle in percent of that of the first level.
    pub stiffness_percent: Option<f64>,
    /// Energy of its first cycle.
    pub energy_first: Option<f64>,
    /// Mean energy of its cycles.
    pub energy_mean: Option<f64>,
    /// Mean equivalent damping of its cycles.
    pub damping_percent: Option<f64>,
    /// Energy of all complete cycles of the record up to its end.
    pub cumulative_energy: Option<f64>,
    /// Amplitude over the yield input of the mean backbone.
    pub ductility: Option<f64>,
    /// Sum of the ductilities of all half cycles of the record up to its end.
    pub cumulative_ductility: Option<f64>,
}

/// The levels of the rows of one record. `yielding` is the yield input of its mean backbone, `height` that of the structure;
/// `noise` are the deviations of input and output.
pub(super) fn levels(
    rows: &[CycleRow],
    yielding: Option<f64>,
    height: Option<f64>,
    noise: (f64, f64),
) -> Vec<LevelRow> {
    let complete: Vec<&CycleRow> = rows.iter().filter(|row| row.complete).collect();
    let is_same = |a: &&CycleRow, b: &&CycleRow| {
        a.amplitude.zip(b.amplitude).is_some_and(|(a, b)| (a - b).abs() <= ALIKE * a.max(b))
    };
    let (mut travelled, mut strongest, mut stiffness) = (Some(0.0), 0.0, None);
    let groups = complete.chunk_by(is_same).enumerate();
    let of_group = |(number, group): (usize, &[&CycleRow])| {
        let (first, last) = (group[0], group[group.len() - 1]);
        // Noise of the input moves the output along the secant.
        let slope = first.secant_stiffness.unwrap_or_default();
        let deviation = hypot(noise.1, slope * noise.0);
        let least = output(first).map_or(0.0, |own| 100.0 * SURE * deviation / own);
        let of_all =
            |of: fn(&CycleRow) -> Option<f64>| group.iter().map(|row| of(row)).collect::<Option<Vec<f64>>>();
        let mean = |of| of_all(of).map(|values| values.iter().sum::<f64>() / values.len() as f64);
        let own = output(first);
        strongest = own.map_or(strongest, |own| f64::max(strongest, own));
        stiffness = stiffness.or(first.secant_stiffness);
        let amplitudes = of_all(|row| row.amplitude).map(|amplitudes| 2.0 * amplitudes.iter().sum::<f64>());
        travelled = travelled.zip(amplitudes).map(|(sum, amplitudes)| sum + amplitudes);
        let over_yield = |value: Option<f64>| value.zip(yielding).map(|(value, yielding)| value / yielding);
        LevelRow {
            record: first.record.clone(),
            level: number + 1,
            cycles: group.len(),
            amplitude: first.amplitude,
            drift_percent: first.amplitude.zip(height).and_then(|(own, height)| percent(own, height)),
            output_first: own,
            strength_loss_percent: loss(group, own, output(last), least),
            strength_percent: own.and_then(|own| percent(own, strongest)),
            stiffness_first: first.secant_stiffness,
            stiffness_loss_percent: loss(group, first.secant_stiffness, last.secant_stiffness, least),
            stiffness_percent: first
                .secant_stiffness
                .zip(stiffness)
                .and_then(|(own, first)| percent(own, first)),
            energy_first: first.energy,
            energy_mean: mean(|row| row.energy),
            damping_percent: mean(|row| row.damping_percent),
            cumulative_energy: last.cumulative_energy,
            ductility: over_yield(first.amplitude),
            cumulative_ductility: over_yield(travelled),
        }
    };
    groups.map(of_group).collect()
}

/// Half the range of the outputs of a cycle, which a force that relaxes at the turning points does not lower.
fn output(row: &CycleRow) -> Option<f64> {
    Some(0.5 * (row.output_max? - row.output_min?))
}

fn percent(part: f64, whole: f64) -> Option<f64> {
    (whole > 0.0).then(|| 100.0 * part / whole)
}

/// Loss in percent from the first to the last of several cycles, if it or the gain is not below `least`.
fn loss(group: &[&CycleRow], first: Option<f64>, last: Option<f64>, least: f64) -> Option<f64> {
    let (first, last) = first.zip(last).filter(|_| group.len() > 1)?;
    percent(first - last, first).filter(|loss| loss.abs() >= least)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cycles of amplitude 2 with these outputs.
    fn level(outputs: [f64; 2], noise: (f64, f64)) -> LevelRow {
        let row = |output: f64| CycleRow {
            complete: true,
            amplitude: Some(2.0),
            output_max: Some(output),
            output_min: Some(-output),
            secant_stiffness: Some(0.5 * output),
            ..CycleRow::default()
        };
        levels(&outputs.map(row), None, None, noise).remove(0)
    }

    #[test]
    fn a_loss_within_noise_is_absent() {
        let losses = |level: LevelRow| (level.strength_loss_percent, level.stiffness_loss_percent);
        assert_eq!(losses(level([10.0, 9.0], (0.0, 0.3))), (Some(10.0), Some(10.0)));
        // Three deviations of the difference of two halves of a range.
        assert_eq!(losses(level([10.0, 9.0], (0.0, 0.4))), (None, None));
        assert_eq!(losses(level([10.0, 11.0], (0.0, 0.4))), (None, None));
        // Noise of the input of 0.08 along a secant of 5.
        assert_eq!(losses(level([10.0, 9.0], (0.08, 0.0))), (None, None));
        assert_eq!(losses(level([10.0, 8.0], (0.08, 0.3))), (Some(20.0), Some(20.0)));
    }
}
