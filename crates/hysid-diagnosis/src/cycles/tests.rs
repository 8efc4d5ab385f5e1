//! Figures of laws whose loops are known in closed form.

use std::f64::consts::{PI, TAU};

use approx::assert_relative_eq;
use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::{asin, atan, cos, exp, log10, sin, tanh};
use hysid_core::operator::{Operator, Play, Stop};
use hysid_core::random::{mix, uniform};

use super::*;

mod fields;
mod records;

/// A path through turning points in equal steps.
fn path(turning: &[f64], step: f64) -> Vec<f64> {
    let mut x = vec![turning[0]];
    for pair in turning.windows(2) {
        let count = ((pair[1] - pair[0]).abs() / step).round() as usize;
        x.extend((1..=count).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64));
    }
    x
}

fn data(x: Vec<f64>, y: Vec<f64>) -> Dataset {
    Dataset::from_slices(&x, &y).unwrap()
}

fn timed(time: Vec<f64>, x: Vec<f64>, y: Vec<f64>) -> Dataset {
    let record = Record::new("r", vec![x], y).unwrap().with_time(time).unwrap();
    let names = ColumnNames { time: Some("t_s".into()), ..ColumnNames::plain(1) };
    Dataset::new(names, vec![record]).unwrap()
}

fn table_of(data: &Dataset, field: Field) -> CycleTable {
    CycleTable::of(data, &CycleOptions { field: Some(field), ..CycleOptions::default() }).unwrap()
}

fn divided(data: &Dataset, field: Field, division: Division) -> CycleTable {
    let (field, division) = (Some(field), Some(division));
    CycleTable::of(data, &CycleOptions { field, division, ..CycleOptions::default() }).unwrap()
}

fn stop(turning: &[f64]) -> Dataset {
    let x = path(turning, 0.05);
    let y = Stop::new(1.0).unwrap().run(&x);
    data(x, y)
}

/// Stiffness and strength 1. In the first cycle the first quarter begins without force: `∮ y dx` has the energy that is stored
/// at its end, 1/2.
#[test]
fn an_elastic_plastic_stop_has_its_exact_figures() {
    let table = table_of(&stop(&[0.0, 3.0, -3.0, 3.0, -3.0, 0.0]), Field::Structure);
    assert_eq!((table.division, table.cycles.len()), (Division::Zero, 2));
    for (row, energy) in table.cycles.iter().zip([7.5, 8.0]) {
        assert!(row.complete);
        assert_relative_eq!(row.energy.unwrap(), energy, epsilon = 1e-9);
        assert_relative_eq!(row.secant_stiffness.unwrap(), 1.0 / 3.0, epsilon = 1e-9);
        let damping = 2.0 * energy / (PI / 3.0 * 36.0);
        assert_relative_eq!(row.damping_percent.unwrap(), 100.0 * damping, epsilon = 1e-9);
        assert_relative_eq!(row.residual_after_peak.unwrap(), 2.0, epsilon = 1e-9);
        assert_relative_eq!(row.residual_after_valley.unwrap(), -2.0, epsilon = 1e-9);
        assert_eq!((row.peak_input, row.valley_input), (Some(3.0), Some(-3.0)));
        assert_eq!((row.amplitude, row.mean_input), (Some(3.0), Some(0.0)));
        assert_eq!((row.period, row.creep), (None, None));
    }
    assert_relative_eq!(table.cycles[1].cumulative_energy.unwrap(), 15.5, epsilon = 1e-9);
    assert!(table.cycles[0].backbone_peak && table.cycles[0].backbone_valley);
    assert!(!table.cycles[1].backbone_peak && !table.cycles[1].backbone_valley);
}

#[test]
fn a_growing_protocol_gives_one_backbone_point_for_each_amplitude_and_direction() {
    let turning = [0.0, 0.5, -0.5, 0.5, -0.5, 2.0, -2.0, 2.0, -2.0, 4.0, -4.0, 4.0, -4.0, 0.0];
    let table = table_of(&stop(&turning), Field::Structure);
    let amplitudes: Vec<f64> = table.cycles.iter().map(|row| row.amplitude.unwrap()).collect();
    assert_eq!(amplitudes, [0.5, 0.5, 2.0, 2.0, 4.0, 4.0]);
    assert!(table.complete().count() == 6);
    let points: Vec<(f64, f64)> = table.backbone.iter().map(|point| (point.input, point.output)).collect();
    let expected = [(0.5, 0.5), (-0.5, -0.5), (2.0, 1.0), (-2.0, -1.0), (4.0, 1.0), (-4.0, -1.0)];
    for (point, expected) in points.iter().zip(expected) {
        assert_relative_eq!(point.0, expected.0, epsilon = 1e-9);
        assert_relative_eq!(point.1, expected.1, epsilon = 1e-9);
    }
    assert_eq!(points.len(), 6);
    // Elastic cycles lose nothing; of the plastic ones 4 (d - 1).
    for (row, energy) in table.cycles.iter().zip([0.0, 0.0]) {
        assert_relative_eq!(row.energy.unwrap(), energy, epsilon = 1e-9);
    }
    assert_relative_eq!(table.cycles[3].energy.unwrap(), 4.0, epsilon = 1e-9);
    assert_relative_eq!(table.cycles[5].energy.unwrap(), 12.0, epsilon = 1e-9);
}

/// A machine that goes further in the third cycle of a level does not put this cycle on the backbone.
#[test]
fn of_a_level_only_the_first_cycle_is_on_the_backbone() {
    let turning = [0.0, 2.0, -2.0, 2.02, -2.02, 2.05, -2.05, 4.0, -4.0, 4.0, -4.0, 4.09, -4.09, 0.0];
    let table = table_of(&stop(&turning), Field::Structure);
    let inputs: Vec<f64> = table.backbone.iter().map(|point| point.input).collect();
    assert_eq!(inputs, [2.0, -2.0, 4.0, -4.0]);
    assert_eq!(table.levels.iter().map(|level| level.cycles).collect::<Vec<_>>(), [3, 3]);
}

/// `dz/dx = 1 - z` while a force grows and 1 while it falls: Bouc-Wen with `A = n = 1`, `β = γ = 1/2`. The loop of amplitude
/// `a` has the tip `z_a = 1 - exp(-(2a - z_a))` and the area `2 (2a - 2 z_a - z_a²/2)`.
#[test]
fn a_bouc_wen_loop_has_its_exact_energy_and_residual_displacement() {
    let amplitude = 1.5;
    let x = path(&[0.0, amplitude, -amplitude, amplitude, -amplitude, amplitude, -amplitude, 0.0], 2e-3);
    let mut z: f64 = 0.0;
    let mut y = vec![0.0];
    for pair in x.windows(2) {
        let (mut left, sense) = ((pair[1] - pair[0]).abs(), (pair[1] - pair[0]).signum());
        let mut along = sense * z;
        if along < 0.0 {
            let linear = left.min(-along);
            along += linear;
            left -= linear;
        }
        along = 1.0 - (1.0 - along) * exp(-left);
        if left == 0.0 {
            along = along.min(0.0);
        }
        z = sense * along;
        y.push(z);
    }
    let mut tip: f64 = 0.9;
    for _ in 0..200 {
        tip = 1.0 - exp(-(2.0 * amplitude - tip));
    }
    let table = table_of(&data(x, y), Field::Structure);
    let row = table.cycles.last().unwrap();
    let energy = 2.0 * (2.0 * amplitude - 2.0 * tip - 0.5 * tip * tip);
    assert_relative_eq!(row.energy.unwrap(), energy, max_relative = 1e-4);
    assert_relative_eq!(row.residual_after_peak.unwrap(), amplitude - tip, epsilon = 1e-3);
    assert_relative_eq!(row.secant_stiffness.unwrap(), tip / amplitude, max_relative = 1e-3);
}

/// `y = k x + c dx/dt`: an ellipse of the area `π c ω a²`, and the damping ratio `c ω/(2k)`.
#[test]
fn a_kelvin_voigt_ellipse_has_its_exact_damping_and_loss_at_each_frequency() {
    let (stiffness, viscosity, amplitude) = (4.0, 0.3, 2.0);
    let (mut time, mut x, mut y) = (vec![], vec![], vec![]);
    let mut begin = 0.0;
    for frequency in [0.5, 1.0, 2.0] {
        let omega = TAU * frequency;
        let rows = 3 * 400;
        for row in 0..rows {
            let t = 3.0 * row as f64 / rows as f64 / frequency;
            time.push(begin + t);
            x.push(amplitude * sin(omega * t));
            y.push(stiffness * x[x.len() - 1] + viscosity * amplitude * omega * cos(omega * t));
        }
        begin += 3.0 / frequency;
    }
    let table = table_of(&timed(time, x, y), Field::General);
    assert_eq!(table.losses.len(), 3, "{:?}", table.losses);
    for (loss, frequency) in table.losses.iter().zip([0.5, 1.0, 2.0]) {
        assert_relative_eq!(loss.frequency, frequency, max_relative = 1e-3);
        let energy = PI * viscosity * TAU * frequency * amplitude * amplitude;
        // Where the frequency changes, a cycle has rows of both.
        assert_relative_eq!(loss.energy, energy, max_relative = 5e-3);
        assert_relative_eq!(loss.power, energy * frequency, max_relative = 5e-3);
    }
    let row = &table.cycles[1];
    assert_relative_eq!(row.secant_stiffness.unwrap(), stiffness, max_relative = 2e-3);
    let damping = 100.0 * viscosity * TAU * 0.5 / (2.0 * stiffness);
    assert_relative_eq!(row.damping_percent.unwrap(), damping, max_relative = 3e-3);
    // The output is 0 at x = -a sin φ, tan φ = c ω/k.
    let zero = sin(atan(viscosity * PI / stiffness)) * amplitude;
    assert_relative_eq!(row.residual_after_peak.unwrap(), zero, max_relative = 2e-3);
}

/// Branches `tanh(x ∓ 0.4)`: coercive field 0.4, remanence tanh 0.4.
#[test]
fn a_magnet_has_its_exact_coercive_field_and_remanence_from_tip_to_tip() {
    let x = path(&[0.0, 6.0, -6.0, 6.0, -6.0, 6.0], 0.02);
    let falling = |k: usize| k + 1 < x.len() && x[k + 1] < x[k];
    let y = (0..x.len()).map(|k| tanh(x[k] + if falling(k) { 0.4 } else { -0.4 })).collect();
    let table = table_of(&data(x.clone(), y), Field::Magnet);
    assert_eq!(table.division, Division::Reversals);
    let complete: Vec<bool> = table.cycles.iter().map(|row| row.complete).collect();
    assert_eq!(complete, [false, true, true], "the virgin curve is marked");
    assert!(table.cycles[0].notes[0].starts_with("incomplete"), "{:?}", table.cycles[0].notes);
    for row in table.complete() {
        assert_relative_eq!(row.coercive_input.unwrap(), 0.4, max_relative = 1e-3);
        assert_relative_eq!(row.remanent_output.unwrap(), tanh(0.4), max_relative = 1e-3);
        // The area between two shifted curves: the shift times the height.
        assert_relative_eq!(row.energy.unwrap(), 0.8 * 2.0, max_relative = 1e-3);
    }
}

/// Play of threshold 1/2 under 0 to 4: width 1, range of the output 3.
#[test]
fn a_play_has_its_exact_width_and_its_loop_is_passed_anticlockwise() {
    let x = path(&[0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0], 0.05);
    let y = Play::new(0.5).unwrap().run(&x);
    let data = data(x, y);
    let table = table_of(&data, Field::Actuator);
    assert_eq!(table.complete().count(), 3);
    let row = table.cycles.last().unwrap();
    assert_relative_eq!(row.width.unwrap(), 1.0, epsilon = 1e-9);
    assert_relative_eq!(row.width_percent.unwrap(), 100.0 / 3.0, epsilon = 1e-6);
    assert_eq!((row.energy, row.residual_after_peak, row.coercive_input), (None, None, None));
    let general = table_of(&data, Field::General);
    let row = general.cycles.last().unwrap();
    assert_relative_eq!(row.energy.unwrap(), -3.0, epsilon = 1e-9);
    assert_relative_eq!(row.width.unwrap(), 1.0, epsilon = 1e-9);
    assert_eq!(row.damping_percent, None);
    assert!(row.notes.iter().any(|note| note.contains("anticlockwise")), "{:?}", row.notes);
}

/// Twenty rows a period, and the record ends a row before the third one is complete.
#[test]
fn a_record_of_whole_periods_has_whole_cycles_and_the_true_period() {
    let time: Vec<f64> = (0..60).map(|row| 0.1 * f64::from(row)).collect();
    let x = time.iter().map(|t| 5.0 + sin(PI * t)).collect();
    let y = time.iter().map(|t| sin(PI * t - 0.3)).collect();
    let table = table_of(&timed(time, x, y), Field::General);
    assert_eq!((table.division, table.cycles.len()), (Division::Mean, 3));
    for row in &table.cycles {
        assert!(row.complete);
        assert_relative_eq!(row.period.unwrap(), 2.0, max_relative = 2e-3);
        // The polygon of twenty corners in the ellipse.
        let share = sin(TAU / 20.0) / (TAU / 20.0);
        assert_relative_eq!(row.energy.unwrap(), -PI * sin(0.3) * share, max_relative = 1e-2);
    }
}

/// The play from 2 up to 4, down to 0 and back to 2, and no further: its width is read from all three parts; without outputs
/// in the first of them there is none.
#[test]
fn a_width_needs_both_branches_over_the_whole_swing() {
    let x = path(&[2.0, 4.0, 0.0, 2.0], 0.05);
    let y = Play::new(0.5).unwrap().run(&x);
    let table = divided(&data(x.clone(), y.clone()), Field::Actuator, Division::Mean);
    assert_relative_eq!(table.cycles[0].width.unwrap(), 1.0, epsilon = 1e-9);
    let mut blank = y;
    blank[..36].fill(f64::NAN);
    let table = divided(&data(x, blank), Field::Actuator, Division::Mean);
    assert_eq!((table.cycles[0].complete, table.cycles[0].width), (true, None));
    assert!(
        table.cycles[0].notes.iter().any(|note| note.starts_with("no width")),
        "{:?}",
        table.cycles[0].notes
    );
}

#[test]
fn steps_of_the_input_give_no_width() {
    let x: Vec<f64> = [0.0, 1.0, 2.0, 0.0].repeat(4).into_iter().flat_map(|level| vec![level; 20]).collect();
    let y = x.iter().enumerate().map(|(row, x)| 2.0 * x + 0.01 * (row % 20) as f64).collect();
    let table = table_of(&data(x, y), Field::Actuator);
    for row in table.complete() {
        assert_eq!(row.width, None);
        assert!(row.notes.iter().any(|note| note.contains("too far apart")), "{:?}", row.notes);
    }
    assert!(table.complete().count() > 1);
}

/// After a step to 1 the output creeps by 0.3 in a decade of time.
#[test]
fn logarithmic_creep_has_its_exact_slope_where_the_hold_is_long_enough() {
    let creeping = |rows: usize| {
        let mut x = path(&[0.0, 1.0], 0.1);
        let begin = x.len() - 1;
        x.extend(vec![1.0; rows]);
        x.extend(&path(&[1.0, 0.0], 0.1)[1..]);
        let time: Vec<f64> = (0..x.len()).map(|k| 0.01 * k as f64).collect();
        let since = |k: usize| 0.01 * (k.clamp(begin + 1, begin + rows) - begin) as f64;
        let y = (0..x.len()).map(|k| 2.0 * x[k] + 0.3 * log10(since(k) / 0.01)).collect();
        table_of(&timed(time, x, y), Field::Actuator)
    };
    let table = creeping(1000);
    let row = &table.cycles[0];
    assert_relative_eq!(row.creep_per_decade.unwrap(), 0.3, epsilon = 1e-9);
    assert_relative_eq!(row.creep.unwrap(), 0.9, epsilon = 1e-9);
    assert_relative_eq!(row.hold_duration.unwrap(), 10.0, epsilon = 1e-9);
    let short = creeping(24);
    assert_eq!(short.cycles[0].creep_per_decade, None);
    assert!(short.cycles[0].creep.is_some());
    assert!(short.cycles[0].notes.iter().any(|note| note.contains("decade")), "{:?}", short.cycles[0].notes);
}

#[test]
fn a_sine_has_no_holds_however_finely_it_is_sampled() {
    for rows in [200, 20_000] {
        let phase = |row: usize| TAU * 4.0 * row as f64 / rows as f64;
        let time = (0..rows).map(|row| row as f64 * 1e-3).collect();
        let x: Vec<f64> = (0..rows).map(|row| sin(phase(row))).collect();
        let y = (0..rows).map(|row| sin(phase(row) - 0.2)).collect();
        let table = table_of(&timed(time, x, y), Field::Actuator);
        assert!(table.cycles.iter().all(|row| row.creep.is_none()), "{rows}");
        assert!(table.notes.iter().any(|note| note.contains("rests nowhere")), "{:?}", table.notes);
    }
}

#[test]
fn parts_that_are_no_cycle_are_marked_at_both_ends() {
    // From half way up, two cycles, and a quarter.
    let table = table_of(&stop(&[1.5, 3.0, -3.0, 3.0, -3.0, 3.0, -2.0]), Field::Structure);
    let rows: Vec<(usize, usize)> = table.cycles.iter().map(|row| row.rows).collect();
    let complete: Vec<bool> = table.cycles.iter().map(|row| row.complete).collect();
    assert_eq!(complete, [false, true, true, false]);
    assert_eq!(rows[0].0, 0);
    assert_eq!(rows[3].1, 30 + 4 * 120 + 100);
    assert!(rows.windows(2).all(|pair| pair[1].0.abs_diff(pair[0].1) <= 1), "{rows:?}");
    let last = &table.cycles[3];
    assert!(last.notes[0].contains("ends within"), "{:?}", last.notes);
    assert_eq!((last.energy, last.amplitude, last.damping_percent), (None, None, None));
    // A record without a whole cycle has one row and a note.
    let table = table_of(&stop(&[0.0, 3.0, 1.0]), Field::Structure);
    assert_eq!((table.cycles.len(), table.complete().count()), (1, 0));
    assert!(table.notes[0].starts_with("no whole cycle"), "{:?}", table.notes);
}

/// The mean grows by 0.4 in each cycle: every loop is read where the input comes back.
#[test]
fn a_drifting_mean_gives_loops_where_the_input_comes_back() {
    let turning: Vec<f64> =
        (0..12).map(|k| 10.0 + 0.2 * f64::from(k) + if k % 2 == 0 { 0.0 } else { 4.0 }).collect();
    let table = table_of(&stop(&turning), Field::Structure);
    assert_eq!(table.division, Division::Reversals);
    let rows: Vec<&CycleRow> = table.complete().collect();
    assert!(rows.len() >= 4, "{}", rows.len());
    for row in &rows[1..] {
        // From valley to valley or from peak to peak, the shorter branch is 3.8 long, cut where the longer one began.
        let swing = 3.8;
        assert_relative_eq!(row.energy.unwrap(), 2.0 * (swing - 2.0), max_relative = 0.06);
        assert_relative_eq!(row.residual_after_peak.unwrap(), row.peak_input.unwrap() - 1.0, epsilon = 1e-6);
    }
    let means: Vec<f64> = rows.iter().map(|row| row.mean_input.unwrap()).collect();
    assert!(means.windows(2).all(|pair| (pair[1] - pair[0] - 0.4).abs() < 1e-6), "{means:?}");
}

/// A static load first: the cycles about it would be few, from zero to zero.
#[test]
fn cycles_about_a_static_load_are_found() {
    let table =
        table_of(&stop(&[0.0, 3.0, 1.0, 4.0, 0.0, 5.0, -1.0, 6.0, -2.0, 7.0, -3.0, 2.0]), Field::Structure);
    assert_eq!(table.division, Division::Mean);
    let rows: Vec<&CycleRow> = table.complete().collect();
    assert_eq!(rows.len(), 5);
    for (row, amplitude) in rows.iter().zip(1..) {
        let amplitude = f64::from(amplitude);
        assert_relative_eq!(row.amplitude.unwrap(), amplitude, epsilon = 1e-9);
        // From the third on, the cycle before ends on the yielding branch.
        if amplitude > 2.5 {
            assert_relative_eq!(row.energy.unwrap(), 4.0 * (amplitude - 1.0), epsilon = 1e-9);
        }
    }
    // The second cycle is three times as large, and passes zero.
    let jump = table_of(&stop(&[0.0, 3.5, 0.5, 3.5, 0.5, 6.5, -2.5, 6.5, -2.5, 2.0]), Field::Structure);
    let amplitudes: Vec<f64> = jump.complete().filter_map(|row| row.amplitude).collect();
    assert_eq!(jump.division, Division::Mean);
    approx::assert_abs_diff_eq!(amplitudes[..], [1.5, 1.5, 4.5, 4.5], epsilon = 1e-9);
    // One-sided tests that begin at their end keep their cycles.
    let one_sided = table_of(&stop(&[0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0]), Field::Structure);
    assert_eq!((one_sided.division, one_sided.complete().count()), (Division::Reversals, 3));
}

/// Cycles that dwell at their turning points, and a rest behind the last one.
#[test]
fn a_dwell_and_a_rest_do_not_change_the_amplitude() {
    let (mut time, mut x) = (Vec::new(), Vec::new());
    for (from, to, dwell) in
        [(0.0, 2.0, 15), (2.0, -2.0, 15), (-2.0, 2.0, 15), (2.0, -2.0, 15), (-2.0, 0.0, 120)]
    {
        for row in 0..40 + dwell {
            let value: f64 = from + (to - from) * f64::min(row as f64 / 40.0, 1.0);
            x.push(value + 0.004 * (uniform(mix(x.len() as u64)) - 0.5));
            time.push(0.5 * time.len() as f64);
        }
    }
    let y = Stop::new(1.0).unwrap().run(&x);
    for row in table_of(&timed(time, x, y), Field::Structure).complete() {
        assert_relative_eq!(row.amplitude.unwrap(), 2.0, epsilon = 0.01);
    }
}

/// A viscous damper beside a spring, with the turning point between two equal rows.
#[test]
fn a_force_that_is_steep_at_the_tip_is_said() {
    for (rows, is_steep) in [(40, true), (2000, false)] {
        let phase = |row: usize| TAU * (row as f64 + 0.5) / rows as f64;
        let x: Vec<f64> = (0..=3 * rows).map(|row| (1e5 * sin(phase(row))).round() / 1e5).collect();
        let y = (0..=3 * rows).map(|row| 10.0 * sin(phase(row)) + 7.85 * cos(phase(row))).collect();
        let table = table_of(&data(x, y), Field::Structure);
        assert!(table.complete().count() >= 2);
        for row in table.complete() {
            assert_eq!(
                row.notes.iter().any(|note| note.contains("from row to row")),
                is_steep,
                "{:?}",
                row.notes
            );
            let error = (row.secant_stiffness.unwrap() - 10.0).abs();
            assert_eq!(error > 0.2, is_steep, "{error}");
        }
    }
}

/// A loop of amplitude 2 on the way to amplitude 4: `4 (2 - 1)`, and not that of the tips 2 and 4.
#[test]
fn a_growing_cycle_from_tip_to_tip_is_the_loop_that_closes() {
    let table = divided(&stop(&[0.0, 2.0, -2.0, 4.0, -4.0, 4.0]), Field::Structure, Division::Reversals);
    let row = &table.cycles[1];
    assert_eq!((row.complete, row.amplitude, row.peak_input), (true, Some(2.0), Some(2.0)));
    assert_relative_eq!(row.energy.unwrap(), 4.0, epsilon = 1e-9);
    assert_relative_eq!(
        row.damping_percent.unwrap(),
        100.0 * 4.0 / (4.0 * PI * 0.5 * 0.5 * 4.0),
        epsilon = 1e-9
    );
    assert_eq!(row.input_max, Some(4.0));
    assert!(row.notes.iter().any(|note| note.contains("the part before")), "{:?}", row.notes);
}

/// From 4 down to -1 and back to 1: the way down through 1 and the way up to 1 have different outputs there.
#[test]
fn a_shrinking_cycle_that_does_not_close_has_no_loop() {
    let table = divided(&stop(&[0.0, 4.0, -1.0, 1.0, -3.0, 0.5]), Field::General, Division::Reversals);
    let row = &table.cycles[1];
    assert!(row.complete && row.notes.iter().any(|note| note.starts_with("no loop")), "{:?}", row.notes);
    assert_eq!((row.energy, row.damping_percent, row.width, row.coercive_input), (None, None, None, None));
    assert_relative_eq!(row.residual_after_peak.unwrap(), 3.0, epsilon = 1e-9);
}

#[test]
fn blank_outputs_leave_figures_empty_and_say_so() {
    let mut rows: Vec<f64> = stop(&[0.0, 3.0, -3.0, 3.0, -3.0, 0.0]).records()[0].output().to_vec();
    let x = stop(&[0.0, 3.0, -3.0, 3.0, -3.0, 0.0]).records()[0].inputs()[0].to_vec();
    rows[100..110].fill(f64::NAN);
    let table = table_of(&data(x, rows), Field::Structure);
    let (first, second) = (&table.cycles[0], &table.cycles[1]);
    assert_eq!(first.energy, None);
    assert!(first.notes.iter().any(|note| note.contains("10 rows")), "{:?}", first.notes);
    assert_relative_eq!(second.energy.unwrap(), 8.0, epsilon = 1e-9);
    assert_eq!(second.cumulative_energy, None, "the first cycle's energy is not known");
}

#[test]
fn noise_makes_no_cycles_and_its_deviation_of_the_energy_is_what_it_is() {
    let x = path(&[0.0, 3.0, -3.0, 3.0, -3.0, 3.0, -3.0, 3.0, -3.0, 0.0], 0.02);
    let exact = Stop::new(1.0).unwrap().run(&x);
    let uniform = |seed: u64| uniform(seed) - 0.5;
    let normal =
        |row: usize, of: u64| (0..12).map(|k| uniform(12 * row as u64 + k + (of << 40))).sum::<f64>();
    let noisy_x: Vec<f64> = x.iter().enumerate().map(|(row, x)| x + 0.01 * normal(row, 1)).collect();
    let noisy_y: Vec<f64> = exact.iter().enumerate().map(|(row, y)| y + 0.03 * normal(row, 2)).collect();
    let table = table_of(&data(noisy_x, noisy_y.clone()), Field::Structure);
    let rows: Vec<&CycleRow> = table.complete().collect();
    assert_eq!(rows.len(), 4);
    for row in &rows[1..] {
        let deviation = row.energy_deviation.unwrap();
        assert!((0.005..0.05).contains(&deviation), "{deviation}");
        assert!((row.energy.unwrap() - 8.0).abs() < 5.0 * deviation + 0.02, "{:?}", row.energy);
        assert_relative_eq!(row.residual_after_peak.unwrap(), 2.0, epsilon = 0.08);
        assert_relative_eq!(row.secant_stiffness.unwrap(), 1.0 / 3.0, max_relative = 0.03);
    }
    assert_eq!(table.backbone.len(), 2, "{:?}", table.backbone);
    let widths = table_of(&data(x, noisy_y), Field::Actuator);
    for row in widths.complete().skip(1) {
        let (width, deviation) = (row.width.unwrap(), row.width_deviation.unwrap());
        assert!((1e-3..0.03).contains(&deviation), "{deviation}");
        assert!((width - 2.0).abs() < 4.0 * deviation, "{width} with a deviation of {deviation}");
    }
}

#[test]
fn every_figure_is_a_field_of_the_serialized_row() {
    let table = table_of(&stop(&[0.0, 3.0, -3.0, 0.0]), Field::General);
    let row = serde_json::to_value(&table.cycles[0]).unwrap();
    for figure in FIGURES {
        assert!(figure.fields.iter().any(|field| figure.is_of(*field)));
        assert_eq!(row[figure.name].as_f64(), (figure.of)(&table.cycles[0]), "{}", figure.name);
    }
    for field in [Field::Structure, Field::Magnet, Field::Actuator] {
        let names: Vec<&str> =
            FIGURES.iter().filter(|figure| figure.is_of(field)).map(|figure| figure.name).collect();
        assert!(names.contains(&"amplitude") && names.len() < FIGURES.len(), "{field}");
    }
}

/// Cycles about 0 through all amplitudes, in steps of a twelfth of the smallest one.
fn protocol(amplitudes: &[f64]) -> Vec<f64> {
    let mut turning = vec![0.0];
    turning.extend(amplitudes.iter().flat_map(|amplitude| [*amplitude, -amplitude]));
    turning.push(0.0);
    path(&turning, amplitudes.iter().copied().fold(f64::INFINITY, f64::min) / 12.0)
}

/// `4 (a - 1)` above the yield displacement 1 of a stop, less 1/2 where the cycle begins elastic.
#[test]
fn amplitudes_of_a_hundredth_of_the_largest_are_cycles_of_their_own() {
    let amplitudes = [0.2, 0.4, 0.8, 1.2, 1.6, 3.2, 3.2, 9.6, 9.6, 16.0, 16.0, 0.16, 0.16];
    let x = protocol(&amplitudes);
    let y = Stop::new(1.0).unwrap().run(&x);
    let names =
        ColumnNames { output: "force_kN".into(), inputs: vec!["disp_mm".into()], ..ColumnNames::plain(1) };
    let data = Dataset::new(names, vec![Record::new("r", vec![x.clone()], y.clone()).unwrap()]).unwrap();
    let table = CycleTable::of(&data, &CycleOptions::default()).unwrap();
    assert_eq!((table.field, table.division), (Field::Structure, Division::Zero));
    let found: Vec<f64> = table.complete().map(|row| row.amplitude.unwrap()).collect();
    assert_eq!(found.len(), amplitudes.len(), "{found:?}");
    let mut begin = 0;
    for (row, amplitude) in table.cycles.iter().zip(amplitudes) {
        assert_relative_eq!(row.amplitude.unwrap(), amplitude, max_relative = 1e-9);
        assert_relative_eq!(row.peak_input.unwrap(), amplitude, max_relative = 1e-9);
        assert!(row.rows.0.abs_diff(begin) <= 1, "each begins where the one before ends");
        begin = row.rows.1;
        // The trapezoidal rule over its rows, back to its beginning by a straight line.
        let rows: Vec<usize> = (row.rows.0..=row.rows.1).chain([row.rows.0]).collect();
        let area: f64 = rows.windows(2).map(|k| 0.5 * (y[k[0]] + y[k[1]]) * (x[k[1]] - x[k[0]])).sum();
        assert_relative_eq!(row.energy.unwrap(), area, epsilon = 0.02 * amplitude);
    }
    // The diagnosis has the same cycles.
    let diagnosis = crate::Diagnosis::of(&data, &DiagnosisOptions::default()).unwrap();
    assert_eq!(diagnosis.cycles, table);
}

/// One loop of `tanh(x ∓ 0.4)` from either tip, and one period of it from the middle of a branch and from 0.
#[test]
fn a_single_loop_is_one_cycle_wherever_it_begins() {
    let branches = |turning: &[f64], first_falls: bool| {
        let x = path(turning, 0.02);
        let mut falls = first_falls;
        let y = (0..x.len()).map(|k| {
            if k > 0 && x[k] != x[k - 1] {
                falls = x[k] < x[k - 1];
            }
            tanh(x[k] + if falls { 0.4 } else { -0.4 })
        });
        data(x.clone(), y.collect())
    };
    for (turning, falls) in [
        (vec![6.0, -6.0, 6.0], true),
        (vec![-6.0, 6.0, -6.0], false),
        (vec![0.0, 6.0, -6.0, 0.0], false),
        (vec![1.0, -6.0, 6.0, 1.0], true),
        (vec![-3.0, 6.0, -6.0, -3.0], false),
        (vec![5.0, -6.0, 6.0, 5.0], true),
    ] {
        for field in [Field::Magnet, Field::General] {
            let table = table_of(&branches(&turning, falls), field);
            assert_eq!(
                (table.cycles.len(), table.complete().count()),
                (1, 1),
                "{turning:?} {:?}",
                table.notes
            );
            let row = &table.cycles[0];
            assert_relative_eq!(row.coercive_input.unwrap(), 0.4, max_relative = 2e-3);
            assert_relative_eq!(row.remanent_output.unwrap(), tanh(0.4), max_relative = 2e-3);
            assert_relative_eq!(row.energy.unwrap().abs(), 1.6, max_relative = 2e-3);
        }
    }
}

/// Without the middle of the outputs at 0, with a straight background and with a drift: said, and read as it can be.
#[test]
fn backgrounds_offsets_and_drifts_under_a_loop_are_said() {
    let x = path(&[6.0, -6.0, 6.0], 0.02);
    let middle = x.iter().position(|x| *x == -6.0).unwrap();
    let with = |add: &dyn Fn(usize) -> f64| {
        let branch = |row: usize| tanh((x[row] + if row <= middle { 0.4 } else { -0.4 }) / 0.3);
        let table = table_of(
            &data(x.clone(), (0..x.len()).map(|row| branch(row) + add(row)).collect()),
            Field::Magnet,
        );
        (table.cycles[0].coercive_input, table.cycles[0].notes.join("; "))
    };
    let (coercive, notes) = with(&|row| -0.4 * x[row]);
    assert!(notes.contains("pass the output 0 3 times"), "{notes}");
    assert!((coercive.unwrap() - 0.4).abs() < 0.08, "the innermost passings: {coercive:?}");
    let (coercive, notes) = with(&|_| 0.3);
    assert!(notes.contains("middle of the outputs is 0.3,") && coercive.is_some(), "{notes}");
    let (_, notes) = with(&|row| 0.2 * row as f64 / x.len() as f64);
    assert!(notes.contains("open by 0.2"), "{notes}");
    assert_eq!(with(&|_| 0.0).1, "");
}

/// A fifth harmonic that turns within each branch.
#[test]
fn a_rippled_loop_has_its_coercive_field() {
    let phase = |row: usize| TAU * row as f64 / 400.0;
    let x: Vec<f64> = (0..=1200).map(|row| sin(phase(row)) + 0.3 * sin(5.0 * phase(row))).collect();
    let y = Play::new(0.2).unwrap().run(&x);
    let table = divided(&data(x, y), Field::Magnet, Division::Mean);
    assert_eq!(table.complete().count(), 3);
    for row in table.complete() {
        assert_relative_eq!(row.coercive_input.unwrap(), 0.2, max_relative = 0.01);
        assert!(row.remanent_output.is_some(), "{:?}", row.notes);
    }
}

/// A phase that lags behind the field at 1, 5 and 20 Hz, three periods each: no cycle is of 3 or of 12 Hz, and all close.
#[test]
fn a_cycle_of_two_frequencies_has_none_and_round_tips_are_closed() {
    let (mut t, mut x, mut y) = (vec![0.0], vec![0.0], vec![-(sin(0.3))]);
    for frequency in [1.0, 5.0, 20.0] {
        let begin = t[t.len() - 1];
        for row in 1..=600 {
            let phase = TAU * f64::from(row) / 200.0;
            t.push(begin + phase / (TAU * frequency));
            x.push(sin(phase));
            y.push(sin(phase - 0.3));
        }
    }
    let table = divided(&timed(t, x, y), Field::Magnet, Division::Reversals);
    let found: Vec<f64> = table.losses.iter().map(|loss| loss.frequency.round()).collect();
    assert_eq!(found, [1.0, 5.0, 20.0]);
    let mixed: Vec<&CycleRow> = table.complete().filter(|row| row.frequency.is_none()).collect();
    assert_eq!(mixed.len(), 2);
    assert!(mixed.iter().all(|row| row.notes.iter().any(|note| note.contains("last unequally"))));
    for row in table.complete() {
        assert!(!row.notes.iter().any(|note| note.contains("open by")), "{:?}", row.notes);
        assert_relative_eq!(row.energy.unwrap(), PI * sin(0.3), max_relative = 1e-3);
    }
}

/// Steady ellipses one after the other that begin within a cycle, as above: where one ends and the next begins, a cycle has
/// no figures.
#[test]
fn a_cycle_with_a_joint_has_no_coercive_field() {
    for (begins, amplitude) in [(1.0, 1.0), (1.0, 3.0), (0.5 * PI, 1.0), (0.5 * PI, 2.5), (0.8 * PI, 1.2)] {
        let row = |(a, lag): (f64, f64), row: usize| {
            let phase = begins + TAU * row as f64 / 100.0;
            (a * sin(phase), a * sin(phase - lag))
        };
        let loops = [(2.0, 0.3), (amplitude, 0.5)];
        let (x, y) = loops.into_iter().flat_map(|of| (0..300).map(move |number| row(of, number))).unzip();
        for cycle in divided(&data(x, y), Field::Magnet, Division::Zero).complete() {
            let found = (cycle.coercive_input, cycle.remanent_output);
            let (a, lag) = loops[usize::from(cycle.rows.0 >= 300)];
            match cycle.rows.0 < 299 && cycle.rows.1 > 300 {
                true => assert_eq!(found, (None, None), "{begins} {amplitude}: {:?}", cycle.notes),
                false => {
                    assert_relative_eq!(found.0.unwrap(), a * sin(lag), max_relative = 0.01);
                    assert_relative_eq!(found.1.unwrap(), a * sin(lag), max_relative = 0.01);
                }
            }
        }
    }
}

/// `x = a sin φ`, `y = a sin(φ - δ)`: coercive field and remanence `a sin δ`. Steady loops one after the other.
#[test]
fn smaller_loops_and_jumps_behind_a_cycle_are_not_in_its_figures() {
    let after = |lag: f64| {
        let loops = [(2.0, 0.3), (1.0, lag)];
        let row = |(a, lag): (f64, f64), row: usize| {
            let phase = TAU * row as f64 / 100.0;
            (a * sin(phase), a * sin(phase - lag))
        };
        let rows = loops.into_iter().flat_map(|of| (0..300).map(move |number| row(of, number)));
        let (x, y) = rows.unzip();
        divided(&data(x, y), Field::Magnet, Division::Zero)
    };
    let least: f64 = 2.0 * sin(0.3);
    let table = after(asin(least));
    assert_eq!(table.cycles.len(), 6);
    for row in &table.cycles {
        assert_relative_eq!(row.coercive_input.unwrap(), least, max_relative = 0.01);
        assert_relative_eq!(row.remanent_output.unwrap(), least, max_relative = 0.01);
    }
    // The output of the second loop begins elsewhere.
    let table = after(0.3);
    for (number, row) in table.cycles.iter().enumerate() {
        let expected = if number < 3 { least } else { 0.5 * least };
        let found = (row.coercive_input, row.remanent_output);
        match number {
            2 => {
                assert_eq!(found, (None, None));
                assert!(row.notes[0].contains("jumps by 0.3"), "{:?}", row.notes);
            }
            _ => {
                assert_relative_eq!(found.0.unwrap(), expected, max_relative = 0.01);
                assert_relative_eq!(found.1.unwrap(), expected, max_relative = 0.01);
            }
        }
    }
}

/// A logger that is faster than its sensor writes some values twice.
#[test]
fn repeated_rows_hide_no_cycles() {
    let amplitudes = [0.4, 0.8, 10.0, 10.0, 20.0, 20.0];
    let mut turning = vec![0.0];
    turning.extend(amplitudes.iter().flat_map(|amplitude| [*amplitude, -amplitude]));
    turning.push(0.0);
    let repeated = |row: usize| 1 + usize::from(mix(row as u64).is_multiple_of(2));
    let x: Vec<f64> = path(&turning, 0.2)
        .into_iter()
        .enumerate()
        .flat_map(|(row, x)| std::iter::repeat_n(x, repeated(row)))
        .collect();
    let y = Stop::new(5.0).unwrap().run(&x);
    let found: Vec<f64> =
        table_of(&data(x, y), Field::Structure).complete().map(|row| row.amplitude.unwrap()).collect();
    assert_eq!(found.len(), amplitudes.len(), "{found:?}");
    found.iter().zip(amplitudes).for_each(|(a, b)| assert_relative_eq!(a, &b, max_relative = 2e-3));
}

/// Viscous forces are 0 at the tips: what noise leaves there is no stiffness, and damps nothing.
#[test]
fn noise_at_the_tips_is_no_stiffness() {
    let noise = |row: usize| 0.04 * (uniform(row as u64) - 0.5);
    let phase = |row: usize| TAU * row as f64 / 200.0;
    let x: Vec<f64> = (0..=1000).map(|row| sin(phase(row))).collect();
    for size in [0.0, 1.0] {
        let y = (0..=1000).map(|row| cos(phase(row)) + size * noise(row)).collect();
        let table = table_of(&data(x.clone(), y), Field::Structure);
        assert!(table.complete().count() >= 4);
        for row in table.complete() {
            assert_eq!((row.secant_stiffness, row.damping_percent), (None, None));
            assert!(row.notes.iter().any(|note| note.starts_with("no secant stiffness")), "{:?}", row.notes);
            assert_relative_eq!(row.energy.unwrap(), PI, max_relative = 0.01);
        }
    }
}

/// A memristor's loop passes through the origin: its lobes are of opposite sense.
#[test]
fn a_loop_that_crosses_itself_says_so() {
    let phase = |row: usize| TAU * row as f64 / 400.0;
    let x: Vec<f64> = (0..=1600).map(|row| sin(phase(row))).collect();
    let y = (0..=1600).map(|row| sin(phase(row)) * (1.0 + 0.3 * cos(phase(row)))).collect();
    for row in table_of(&data(x, y), Field::General).complete() {
        assert!(
            row.notes.iter().any(|note| note.contains("crosses itself: the energy is")),
            "{:?}",
            row.notes
        );
        assert!(row.energy.unwrap().abs() < 1e-3 && row.coercive_input.unwrap() < 1e-9, "{row:?}");
    }
}
