//! Figures of magnets, sensors, shape-memory alloys, batteries and rivers, of laws in closed form.

use hysid_core::elementary::{powf, square};

use super::records::{figure, value};
use super::*;

/// A loop from the upper end down and up again: two straight ways through points.
fn ways(falling: &[(f64, f64)], rising: &[(f64, f64)], names: (&str, &str)) -> Dataset {
    let (mut x, mut y) = (vec![falling[0].0], vec![falling[0].1]);
    let points: Vec<(f64, f64)> = falling.iter().chain(&rising[1..]).copied().collect();
    for pair in points.windows(2) {
        let count = ((pair[1].0 - pair[0].0).abs() / 0.05).round().max(1.0) as usize;
        let between = |k: usize, a: f64, b: f64| a + (b - a) * k as f64 / count as f64;
        x.extend((1..=count).map(|k| between(k, pair[0].0, pair[1].0)));
        y.extend((1..=count).map(|k| between(k, pair[0].1, pair[1].1)));
    }
    let record = Record::new("r", vec![x], y).unwrap();
    Dataset::new(ColumnNames::of(None, &[names.0], names.1), vec![record]).unwrap()
}

fn only(data: &Dataset, field: Field) -> CycleRow {
    let table = CycleTable::of(data, &CycleOptions::default()).unwrap();
    assert_eq!(table.field, field);
    table.complete().next().expect("a cycle").clone()
}

/// Sines of field with `B = B_0 sin(ωt - φ)`, whose loss is `π H_0 B_0 sin φ`: the phase gives each cycle its loss.
fn losses(points: &[(f64, f64, f64)]) -> Dataset {
    let names = ColumnNames::of(Some("t_s"), &["H_A_per_m"], "B_T");
    let record = |(number, (peak, frequency, energy)): (usize, &(f64, f64, f64))| {
        let field = 1000.0 * peak;
        let phase = asin(energy / (PI * field * peak));
        let time: Vec<f64> = (0..=1200).map(|row| 3.0 * f64::from(row) / 1200.0 / frequency).collect();
        let wave =
            |size: f64, phase: f64| time.iter().map(|t| size * sin(TAU * frequency * t - phase)).collect();
        let record = Record::new(format!("r{number}"), vec![wave(field, 0.0)], wave(*peak, phase)).unwrap();
        record.with_time(time.clone()).unwrap()
    };
    Dataset::new(names, points.iter().enumerate().map(record).collect()).unwrap()
}

fn grid(energy: impl Fn(f64, f64) -> f64) -> Vec<(f64, f64, f64)> {
    let of_peak =
        |peak: f64| [5.0, 20.0, 50.0, 100.0].map(|frequency| (peak, frequency, energy(peak, frequency)));
    [0.4, 0.8, 1.2].into_iter().flat_map(of_peak).collect()
}

#[test]
fn the_separation_of_losses_has_the_coefficients_that_made_them() {
    let (hysteresis, exponent, eddy, excess) = (60.0, 1.7, 0.3, 3.0);
    let energy = |peak: f64, frequency: f64| {
        hysteresis * powf(peak, exponent)
            + eddy * frequency * peak * peak
            + excess * frequency.sqrt() * powf(peak, 1.5)
    };
    let table = table_of(&losses(&grid(energy)), Field::Magnet);
    for (name, expected) in [
        ("hysteresis_coefficient", hysteresis),
        ("hysteresis_exponent", exponent),
        ("eddy_coefficient", eddy),
        ("excess_coefficient", excess),
    ] {
        assert_relative_eq!(value(&table, "", name), expected, max_relative = 0.02);
    }
    for loss in &table.losses {
        let parts = loss.hysteresis.unwrap() + loss.eddy.unwrap() + loss.excess.unwrap();
        assert_relative_eq!(parts, loss.energy, max_relative = 0.002);
        let own = eddy * loss.frequency * square(loss.output_amplitude);
        assert_relative_eq!(loss.eddy.unwrap(), own, max_relative = 0.02);
    }
    assert!(figure(&table, "", "eddy_coefficient").interval.is_some());
}

#[test]
fn the_steinmetz_equation_has_the_exponents_that_made_the_losses_and_its_interval_holds_them() {
    let (coefficient, alpha, beta) = (40.0, 1.3, 1.9);
    // A scatter of 1 %, which is no part of the law.
    let scatter = |peak: f64, frequency: f64| 1.0 + 0.01 * sin(1e3 * peak + 77.0 * frequency);
    let energy = |peak: f64, frequency: f64| {
        coefficient * powf(frequency, alpha - 1.0) * powf(peak, beta) * scatter(peak, frequency)
    };
    let table = table_of(&losses(&grid(energy)), Field::Magnet);
    for (name, expected) in [
        ("steinmetz_coefficient", coefficient),
        ("steinmetz_frequency_exponent", alpha),
        ("steinmetz_amplitude_exponent", beta),
    ] {
        let found = figure(&table, "", name);
        assert_relative_eq!(found.value.unwrap(), expected, max_relative = 0.02);
        let (low, high) = found.interval.unwrap();
        assert!(low < expected && expected < high, "{found:?}");
    }
    let error = value(&table, "", "steinmetz_error_percent");
    assert!((0.4..1.2).contains(&error), "{error}");
}

/// The law of sines gives sines their own loss; its parameters are those of the sines alone.
#[test]
fn cycles_of_sines_have_their_loss_by_igse_and_triangles_change_no_parameter() {
    let energy = |peak: f64, frequency: f64| 40.0 * powf(frequency, 0.3) * powf(peak, 1.9);
    let sines = losses(&grid(energy));
    let time: Vec<f64> = (0..=1200).map(|row| f64::from(row) / 400.0 / 50.0).collect();
    let wave = |shift: f64| {
        let triangle = |t: &f64| 4.0 * ((50.0 * t - shift) - (50.0 * t - shift + 0.5).floor()).abs() - 1.0;
        time.iter().map(triangle).collect::<Vec<f64>>()
    };
    let triangle =
        Record::new("triangle", vec![wave(0.0).iter().map(|h| 900.0 * h).collect()], wave(0.02)).unwrap();
    let records =
        sines.records().iter().cloned().chain([triangle.with_time(time.clone()).unwrap()]).collect();
    let table = table_of(&Dataset::new(sines.names().clone(), records).unwrap(), Field::Magnet);
    assert_relative_eq!(value(&table, "", "steinmetz_frequency_exponent"), 1.3, max_relative = 2e-3);
    for row in table.complete().filter(|row| row.record != "triangle") {
        assert_relative_eq!(row.igse_energy.unwrap(), row.energy.unwrap(), max_relative = 0.01);
    }
    // k_i (4 B f)^α (2 B)^(β-α) / f of a triangle.
    let cosines: f64 =
        (0..40_000).map(|k| powf(cos(TAU * f64::from(k) / 4e4).abs(), 1.3)).sum::<f64>() * TAU / 4e4;
    let expected =
        40.0 / (powf(TAU, 0.3) * powf(2.0, 0.6) * cosines) * powf(200.0, 1.3) * powf(2.0, 0.6) / 50.0;
    let triangle = table.complete().filter(|row| row.record == "triangle").nth(1).unwrap();
    assert_relative_eq!(triangle.igse_energy.unwrap(), expected, max_relative = 0.01);
}

#[test]
fn a_loss_that_is_absent_is_at_its_bound_and_few_frequencies_give_no_separation() {
    let table = table_of(
        &losses(&grid(|peak, frequency| 50.0 * square(peak) + 0.2 * frequency * square(peak))),
        Field::Magnet,
    );
    assert!(value(&table, "", "excess_coefficient") < 0.02);
    let few: Vec<_> = grid(|peak, _| 50.0 * peak).into_iter().filter(|point| point.1 < 30.0).collect();
    let table = table_of(&losses(&few), Field::Magnet);
    let absent = figure(&table, "", "hysteresis_coefficient");
    assert!(absent.value.is_none() && absent.note.as_ref().unwrap().contains("three frequencies"));
    assert_eq!(table.losses[0].eddy, None);
}

#[test]
fn losses_per_kilogram_are_those_per_volume_over_the_density_and_need_their_unit() {
    let data = losses(&[(1.0, 50.0, 100.0)]);
    let options = CycleOptions { density: Some(7650.0), ..CycleOptions::default() };
    let table = CycleTable::of(&data, &options).unwrap();
    let row = table.complete().nth(1).unwrap();
    assert_relative_eq!(row.power_per_mass.unwrap(), 100.0 * 50.0 / 7650.0, max_relative = 1e-3);
    assert_relative_eq!(row.energy_per_mass.unwrap(), 100.0 / 7650.0, max_relative = 1e-3);
    let q = Quantities::of(data.names());
    assert_eq!(q.as_figure("specific loss", FigureQuantity::PowerPerMass), "specific loss [W/kg]");
    let joint = ways(&[(2.0, 1.0), (-2.0, -1.0)], &[(-2.0, -1.0), (2.0, 1.0)], ("disp_mm", "force_kN"));
    let error = CycleTable::of(&joint, &options).unwrap_err().to_string();
    assert!(error.contains("per volume") && error.contains('J'), "{error}");
}

/// `M = ± M_s (1 - b/H²) + χ H` beyond a loop of straight lines.
#[test]
fn saturation_is_read_above_a_slope_and_not_where_the_loop_is_far_from_it() {
    let magnet = |slope: f64, approach: f64| {
        let h: Vec<f64> = path(&[10.0, -10.0, 10.0], 0.05);
        let half = h.len() / 2;
        let moment = |(row, h): (usize, &f64)| {
            let shifted = if row <= half { h + 0.5 } else { h - 0.5 };
            let own = if h.abs() > 3.0 {
                h.signum() * (1.0 - approach / (h * h))
            } else {
                (shifted / 3.0).clamp(-0.9, 0.9)
            };
            2.0 * own + slope * h
        };
        let y = h.iter().enumerate().map(moment).collect();
        data(h, y)
    };
    for slope in [0.0, -0.03, 0.05] {
        let table = table_of(&magnet(slope, 0.5), Field::Magnet);
        let found = figure(&table, "", "saturation_output");
        assert!((found.value.unwrap() - 2.0).abs() < 1e-6 + found.deviation.unwrap(), "{found:?}");
        assert_relative_eq!(found.value.unwrap(), 2.0, max_relative = 1e-6);
        assert_relative_eq!(value(&table, "", "high_field_slope"), slope, epsilon = 1e-6);
    }
    let far = data(
        path(&[10.0, -10.0, 10.0], 0.05),
        path(&[10.0, -10.0, 10.0], 0.05).iter().map(|h| tanh(h / 20.0)).collect(),
    );
    let found = figure(&table_of(&far, Field::Magnet), "", "saturation_output").clone();
    assert!(found.value.is_none() && found.note.unwrap().contains("still rises too much"));
}

/// One period from the middle, as testers of ferroelectrics write it: the output was at -0.4 at the beginning, and relaxed. The
/// rising branch passes zero in the first quarter, whether the loop closes or not; a virgin curve is no part of the loop.
#[test]
fn a_loop_that_almost_closes_has_the_coercive_field_of_its_beginning() {
    let period = |opening: f64| {
        let h = path(&[0.0, 10.0, -10.0, 0.0], 0.1);
        let (peak, valley) = (100, 300);
        let y = |(row, h): (usize, &f64)| {
            let way = |shift: f64| ((h + shift) / 5.0).clamp(-1.0, 1.0);
            match row {
                _ if row <= peak => way(-2.0),
                _ if row <= valley => way(2.0),
                _ => way(-2.0) + opening * (row - valley) as f64 / 100.0,
            }
        };
        let y = h.iter().enumerate().map(y).collect();
        let table = table_of(&data(h, y), Field::Magnet);
        table.complete().next().expect("a cycle").clone()
    };
    for opening in [0.0, 0.06, -0.12] {
        assert_relative_eq!(period(opening).coercive_input.unwrap(), 2.0, epsilon = 1e-9);
    }
    assert!(period(0.3).coercive_input.is_none());
}

#[test]
fn squareness_is_the_remanence_over_half_the_range() {
    let row = only(&losses(&[(1.0, 50.0, 100.0)]), Field::Magnet);
    let phase = asin(100.0 / (PI * 1000.0));
    assert_relative_eq!(row.squareness.unwrap(), sin(phase), max_relative = 2e-3);
}

/// `y = k x + c dx/dt`: storage modulus `k`, loss modulus `c ω`; with an offset and a third harmonic they stay.
#[test]
fn moduli_of_a_sine_are_those_of_its_first_harmonic_and_other_inputs_have_none() {
    let (k, c) = (4.0, 0.3);
    let of = |wave: fn(f64) -> f64| {
        let time: Vec<f64> = (0..=1200).map(|row| f64::from(row) / 400.0).collect();
        let x: Vec<f64> = time.iter().map(|t| wave(*t)).collect();
        let y = time
            .iter()
            .map(|t| 7.0 + k * wave(*t) + c * TAU * cos(TAU * t) + 0.2 * sin(3.0 * TAU * t))
            .collect();
        table_of(&timed(time, x, y), Field::Structure).complete().next().unwrap().clone()
    };
    let row = of(|t| sin(TAU * t));
    assert_relative_eq!(row.storage_modulus.unwrap(), k, max_relative = 1e-3);
    assert_relative_eq!(row.loss_modulus.unwrap(), c * TAU, max_relative = 1e-3);
    assert_relative_eq!(row.loss_angle.unwrap(), atan(c * TAU / k).to_degrees(), max_relative = 1e-3);
    let triangle = of(|t| 4.0 * (t - (t + 0.5).floor()).abs() - 1.0);
    assert_eq!((triangle.storage_modulus, triangle.loss_angle), (None, None));
}

/// A play under a slope that bends by 0.2 at its middle: the mean of both ways deviates by half of 0.1 from the best line.
#[test]
fn nonlinearity_is_the_deviation_of_the_mean_way_from_the_best_line() {
    let mean = |x: f64| x + 0.2 * (1.0 - x.abs() / 2.0);
    let way = |shift: f64, from: f64, to: f64| {
        [from, 0.0, to].map(|x| (x, mean(x) + shift * (1.0 - square(x / 2.0)).sqrt()))
    };
    let (down, up) = (way(0.3, 2.0, -2.0), way(-0.3, -2.0, 2.0));
    let row = only(&ways(&down, &up, ("u_V", "y_um")), Field::Actuator);
    assert_relative_eq!(row.nonlinearity_percent.unwrap(), 100.0 * 0.1 / 4.0, max_relative = 0.02);
    assert_relative_eq!(row.width_percent.unwrap(), 100.0 * 0.6 / 4.0, max_relative = 0.02);
}

/// Strain `k ∣E ± E_c∣` on the branches: minima at the coercive field, `k E_c` above them at the field 0.
#[test]
fn a_butterfly_has_its_coercive_field_at_the_extremes_and_other_loops_have_none() {
    let (slope, coercive, largest) = (0.4, 0.8, 2.0);
    let branch = |shift: f64, from: f64, to: f64| -> Vec<(f64, f64)> {
        let corners = [from, -shift, to];
        corners.map(|field| (field, slope * (field + shift).abs())).to_vec()
    };
    for sign in [1.0, -1.0] {
        let signed = |points: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
            points.into_iter().map(|(x, y)| (x, 7.0 + sign * y)).collect()
        };
        // Beyond its minimum, each branch ends where the other begins.
        let mut down = branch(coercive, largest, -largest);
        let mut up = branch(-coercive, -largest, largest);
        (down[2].1, up[0].1) = (up[0].1, up[0].1);
        up[2].1 = down[0].1;
        let row = only(&ways(&signed(down), &signed(up), ("E [kV/mm]", "Strain [%]")), Field::Actuator);
        assert_relative_eq!(row.butterfly_coercive_input.unwrap(), coercive, epsilon = 1e-9);
        assert_relative_eq!(row.butterfly_remanence.unwrap(), slope * coercive, epsilon = 1e-9);
        assert_relative_eq!(row.peak_to_peak.unwrap(), slope * (largest + coercive), epsilon = 1e-9);
        assert_eq!(row.nonlinearity_percent, None);
    }
    // Without a lag the minima are at the field 0; a play has none.
    let same = branch(0.0, largest, -largest);
    let back = same.iter().rev().copied().collect::<Vec<_>>();
    let play = [(2.0, 1.5), (-2.0, -1.5)];
    for (down, up) in [(same.as_slice(), back.as_slice()), (&play[..], &[(-2.0, -1.5), (2.0, 1.5)][..])] {
        let row = only(&ways(down, up, ("E [kV/mm]", "Strain [%]")), Field::Actuator);
        assert_eq!((row.peak_to_peak, row.butterfly_coercive_input), (None, None));
    }
}

/// Straight base lines and straight transitions: the tangents meet where they do.
#[test]
fn transitions_of_straight_lines_have_their_corners() {
    let down = [(10.0, 5.0), (4.0, 4.7), (2.0, 0.9), (-10.0, 0.3)];
    let up = [(-10.0, 0.3), (5.0, 1.05), (7.0, 4.85), (10.0, 5.0)];
    let row = only(&ways(&down, &up, ("Temperature (°C)", "Strain (%)")), Field::Thermal);
    for (found, expected) in [
        (row.heating_start, 5.0),
        (row.heating_finish, 7.0),
        (row.cooling_start, 4.0),
        (row.cooling_finish, 2.0),
        (row.thermal_width, 3.0),
    ] {
        assert_relative_eq!(found.unwrap(), expected, epsilon = 1e-6);
    }
    let flat = only(
        &ways(&[(10.0, 1.0), (-10.0, 0.0)], &[(-10.0, 0.0), (10.0, 1.0)], ("Temperature (°C)", "Strain (%)")),
        Field::Thermal,
    );
    assert_eq!(flat.thermal_width, None);
}

/// Charge at 3.6 + 0.1 q, discharge 0.2 V below: 0.2 V and 3.45 / 3.65.
#[test]
fn a_battery_has_the_gap_and_the_efficiency_of_parallel_branches() {
    let down = [(1.0, 3.5), (0.0, 3.4)];
    let up = [(0.0, 3.6), (1.0, 3.7)];
    let row = only(
        &ways(&[(1.0, 3.7), down[0], down[1], (0.0, 3.6)], &up, ("Capacity (Ah)", "Voltage (V)")),
        Field::Battery,
    );
    assert_relative_eq!(row.mean_gap.unwrap(), 0.2, epsilon = 1e-9);
    assert_relative_eq!(row.energy_efficiency_percent.unwrap(), 100.0 * 3.45 / 3.65, epsilon = 1e-9);
}

/// Charge and discharge as cyclers write them: counted from 0 in each half cycle, with or without rests, or in two records;
/// or the state of charge in two records.
#[test]
fn half_cycles_of_a_battery_are_one_loop_on_one_axis_of_charge() {
    let names = ColumnNames::of(None, &["Capacity (Ah)"], "Voltage (V)");
    let line = |from: (f64, f64), to: (f64, f64)| -> Vec<(f64, f64)> {
        let at = |k: i32| f64::from(k) / 50.0;
        (0..=50).map(|k| (from.0 + at(k) * (to.0 - from.0), from.1 + at(k) * (to.1 - from.1))).collect()
    };
    let set = |parts: &[(&str, Vec<(f64, f64)>)]| {
        let record = |(name, points): &(&str, Vec<(f64, f64)>)| {
            let (x, y) = points.iter().copied().unzip();
            Record::new(*name, vec![x], y).unwrap()
        };
        Dataset::new(names.clone(), parts.iter().map(record).collect()).unwrap()
    };
    let (charge, discharge) = (line((0.0, 3.6), (1.0, 3.7)), line((0.0, 3.5), (1.0, 3.4)));
    let state = line((1.0, 3.5), (0.0, 3.4));
    let rest = |voltage: f64| line((0.0, voltage), (0.0, voltage));
    let whole = |parts: &[&Vec<(f64, f64)>]| parts.iter().flat_map(|part| part.iter().copied()).collect();
    for (data, counted) in [
        (set(&[("r", whole(&[&charge, &discharge]))]), true),
        (set(&[("r", whole(&[&discharge, &charge]))]), true),
        (set(&[("r", whole(&[&charge, &rest(3.6), &discharge, &rest(3.5)]))]), true),
        (set(&[("charge", charge.clone()), ("discharge", discharge.clone())]), true),
        (set(&[("charge", charge.clone()), ("discharge", state.clone())]), false),
        (set(&[("charge", line((1.0, 3.6), (0.0, 3.7))), ("discharge", discharge.clone())]), false),
    ] {
        let (joined, note) = super::super::charge::counted_through(&data, None).unwrap();
        assert_eq!(note.contains("counted up while the voltage rises"), counted, "{note}");
        assert_eq!(joined.input_range(0), (0.0, 1.0));
        let table = CycleTable::of(&joined, &CycleOptions::default()).unwrap();
        let row = table.complete().next().expect("a cycle");
        assert_relative_eq!(row.mean_gap.unwrap(), 0.2, epsilon = 1e-9);
        assert_relative_eq!(row.width.unwrap(), 0.2, epsilon = 1e-6);
        assert_relative_eq!(row.energy_efficiency_percent.unwrap(), 100.0 * 3.45 / 3.65, epsilon = 1e-9);
    }
    // What is one axis already, and what has one direction alone, stays; a jump of the charge gives no figures.
    assert_eq!(super::super::charge::counted_through(&set(&[("r", whole(&[&charge, &state]))]), None), None);
    assert_eq!(
        super::super::charge::counted_through(&set(&[("a", charge.clone()), ("b", charge.clone())]), None),
        None
    );
    let jumps =
        CycleTable::of(&set(&[("r", whole(&[&charge, &discharge]))]), &CycleOptions::default()).unwrap();
    assert!(jumps.complete().all(|row| row.mean_gap.is_none() && row.energy.is_none()));
}

/// A parallelogram between (0, 0), (1, 1) and the opposite corners: the rising way lies above the falling one by `gap` of 1.
#[test]
fn a_storm_has_the_index_of_the_difference_of_its_limbs() {
    for (rising, expected) in [(1.0, 0.5), (-1.0, -0.5)] {
        let (first, second) = (0.5 + 0.25 * rising, 0.5 - 0.25 * rising);
        let up = [(0.0, 0.0), (1e-3, first), (1.0 - 1e-3, first), (1.0, 1.0)];
        let down = [(1.0, 1.0), (1.0 - 1e-3, second), (1e-3, second), (0.0, 0.0)];
        let scaled = |points: [(f64, f64); 4]| points.map(|(x, y)| (2.0 + 10.0 * x, 5.0 + 40.0 * y));
        let row = only(&ways(&scaled(down), &scaled(up), ("Q [m3/s]", "Turbidity [NTU]")), Field::Hydrology);
        assert_relative_eq!(row.hysteresis_index.unwrap(), expected, epsilon = 1e-6);
    }
}

/// The same magnet in A/m, T and s, and in Oe, kG and ms.
#[test]
fn losses_do_not_depend_on_the_system_of_units() {
    let si = losses(&grid(|peak, frequency| 40.0 * powf(frequency, 0.3) * powf(peak, 1.9)));
    let of = |data: &Dataset| {
        CycleTable::of(data, &CycleOptions { density: Some(7650.0), ..CycleOptions::default() }).unwrap()
    };
    let scaled = |values: &[f64], factor: f64| values.iter().map(|value| factor * value).collect::<Vec<_>>();
    let records = si.records().iter().map(|record| {
        let input = scaled(&record.inputs()[0], 4.0 * PI / 1000.0);
        let record_in = Record::new(record.name(), vec![input], scaled(record.output(), 10.0)).unwrap();
        record_in.with_time(scaled(record.time().unwrap(), 1000.0)).unwrap()
    });
    let names = ColumnNames::of(Some("t_ms"), &["H_Oe"], "B_kG");
    let (si, cgs) = (of(&si), of(&Dataset::new(names, records.collect()).unwrap()));
    assert_eq!((cgs.cycles.len(), cgs.losses.len()), (si.cycles.len(), si.losses.len()));
    let figures: [fn(&CycleRow) -> Option<f64>; 6] = [
        |row| row.energy,
        |row| row.frequency,
        |row| row.power,
        |row| row.igse_energy,
        |row| row.power_per_mass,
        |row| row.energy_per_mass,
    ];
    for (a, b) in si.complete().zip(cgs.complete()) {
        for of in figures {
            assert_relative_eq!(of(a).unwrap(), of(b).unwrap(), max_relative = 1e-6);
        }
    }
    // Exponents are pure numbers, the coefficient is that of a flux density in kG.
    for name in ["steinmetz_frequency_exponent", "steinmetz_amplitude_exponent"] {
        assert_relative_eq!(value(&si, "", name), value(&cgs, "", name), max_relative = 1e-6);
    }
}
