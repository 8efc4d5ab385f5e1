//! Figures of records and levels, of backbones and loops in closed form.

use super::*;

pub(super) fn figure<'t>(table: &'t CycleTable, of: &str, name: &str) -> &'t RecordFigure {
    let is_it = |figure: &&RecordFigure| figure.of == of && figure.kind.name == name;
    table.figures.iter().find(is_it).unwrap_or_else(|| panic!("{of} {name}: {:?}", table.figures))
}

pub(super) fn value(table: &CycleTable, of: &str, name: &str) -> f64 {
    figure(table, of, name).value.unwrap_or_else(|| panic!("{of} {name}"))
}

/// Straight lines from (0, 0) to each tip and its mirror image, whose output is `negative` times as large.
fn lines(tips: &[(f64, f64)], negative: f64) -> Dataset {
    let (mut x, mut y) = (vec![0.0], vec![0.0]);
    for (amplitude, force) in tips {
        for (x_to, y_to) in [(*amplitude, *force), (0.0, 0.0), (-amplitude, -force * negative), (0.0, 0.0)] {
            let (from_x, from_y) = (x[x.len() - 1], y[y.len() - 1]);
            x.extend((1..=20).map(|k| from_x + (x_to - from_x) * f64::from(k) / 20.0));
            y.extend((1..=20).map(|k| from_y + (y_to - from_y) * f64::from(k) / 20.0));
        }
    }
    data(x, y)
}

/// Both sides have the ductility 3. Their mean ends with the shorter one, at 3, after the other has begun to yield.
#[test]
fn a_ductility_of_the_mean_outside_both_sides_is_left_out() {
    let point = |direction, input: f64, output: f64| BackbonePoint {
        record: "r".into(),
        row: 0,
        direction,
        input,
        output,
    };
    let (up, down) = (Direction::Up, Direction::Down);
    let backbone =
        [point(up, 1.0, 1.0), point(up, 3.0, 1.0), point(down, -3.0, -1.0), point(down, -9.0, -1.0)];
    let figures = elastic_plastic::figures("r", &backbone, 0.0);
    let ductilities: Vec<_> = figures.iter().filter(|figure| figure.kind.name == "ductility").collect();
    assert_relative_eq!(ductilities[0].value.unwrap(), 3.0, epsilon = 1e-9);
    assert_relative_eq!(ductilities[1].value.unwrap(), 3.0, epsilon = 1e-9);
    assert!(ductilities[2].value.is_none() && ductilities[2].note.as_ref().unwrap().contains("shorter side"));
}

#[test]
fn an_elastic_plastic_backbone_is_its_own_equivalent() {
    let x = path(&[0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0, 0.0], 0.05);
    let y = Stop::new(1.0).unwrap().run(&x).into_iter().map(|y| 2.0 * y).collect();
    let table = table_of(&data(x, y), Field::Structure);
    for (of, sign) in [("positive side", 1.0), ("negative side", -1.0), ("mean backbone", 1.0)] {
        for (name, expected) in
            [("peak_output", 2.0), ("yield_output", 2.0), ("yield_input", 1.0), ("ultimate_input", 4.0)]
        {
            assert_relative_eq!(value(&table, of, name), sign * expected, epsilon = 1e-9);
        }
        assert_relative_eq!(value(&table, of, "elastic_stiffness"), 2.0, epsilon = 1e-9);
        assert_relative_eq!(value(&table, of, "ductility"), 4.0, epsilon = 1e-9);
        assert!(figure(&table, of, "ultimate_input").note.as_ref().unwrap().contains("last point"));
    }
}

/// The force of each half cycle relaxes to 0.8 of its peak on the last twentieth of the way, as where a machine stops: the
/// backbone has the peaks, behind a rise or a plateau. A force that falls over half of the way has no peak near the turning point, and stays.
#[test]
fn a_force_that_relaxes_at_the_turning_points_has_its_peak_on_the_backbone() {
    let members = |rise: f64, from: f64| {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for amplitude in [1.0, 2.0, 3.0, 4.0] {
            for sign in [1.0, -1.0] {
                let way: Vec<f64> = (0..=80).map(|k| f64::from(k) / 80.0).collect();
                let out = way.iter().map(|&w| {
                    (w, if w <= from { (w / rise).min(1.0) } else { 1.0 - 0.2 * (w - from) / (1.0 - from) })
                });
                let back = way.iter().rev().skip(1).map(|&w| (w, 0.8 * w));
                for (w, force) in out.chain(back) {
                    x.push(sign * amplitude * w);
                    y.push(sign * 10.0 * force * f64::sqrt(amplitude));
                }
            }
        }
        let table = table_of(&data(x, y), Field::Structure);
        (table.backbone.iter().map(|point| point.output.abs()).collect::<Vec<_>>(), table.levels)
    };
    for (rise, from, share) in [(0.95, 0.95, 1.0), (0.4, 0.96, 1.0), (0.5, 0.5, 0.8)] {
        let (backbone, levels) = members(rise, from);
        let expected = [1.0, 2.0, 3.0, 4.0].map(|amplitude: f64| 10.0 * share * amplitude.sqrt());
        assert_eq!(backbone.len(), 8);
        for (found, expected) in backbone.chunks(2).zip(expected) {
            assert_relative_eq!(found[0], expected, max_relative = 0.01);
            assert_relative_eq!(found[1], expected, max_relative = 0.01);
        }
        assert_relative_eq!(levels[2].output_first.unwrap(), 10.0 * f64::sqrt(3.0), max_relative = 0.01);
    }
}

/// Points (1, 2), (2, 2), (4, 1): `Δ_u = 2.8` where the output is 1.6, and the area up to there is 1 + 2 + 1.44.
#[test]
fn a_falling_backbone_fails_at_eight_tenths_and_both_sides_have_a_mean() {
    let table = table_of(&lines(&[(1.0, 2.0), (2.0, 2.0), (4.0, 1.0)], 0.5), Field::Structure);
    let yielding =
        |stiffness: f64, area: f64| stiffness * (2.8 - (2.8 * 2.8 - 2.0 * area / stiffness).sqrt());
    for (of, sign, share) in
        [("positive side", 1.0, 1.0), ("negative side", -1.0, 0.5), ("mean backbone", 1.0, 0.75)]
    {
        let (stiffness, strength) = (2.0 * share, yielding(2.0 * share, 4.44 * share));
        assert_relative_eq!(value(&table, of, "elastic_stiffness"), stiffness, epsilon = 1e-9);
        assert_relative_eq!(value(&table, of, "yield_output"), sign * strength, epsilon = 1e-9);
        assert_relative_eq!(value(&table, of, "ultimate_input"), sign * 2.8, epsilon = 1e-9);
        assert_relative_eq!(value(&table, of, "ductility"), 2.8 * stiffness / strength, epsilon = 1e-9);
        assert_eq!(figure(&table, of, "ultimate_input").note, None);
    }
}

#[test]
fn a_side_without_a_backbone_says_why_it_has_no_yield_point() {
    let table = table_of(&stop(&[0.0, 3.0, -3.0, 3.0, -3.0, 0.0]), Field::Structure);
    let yielding = figure(&table, "positive side", "yield_output");
    assert_eq!(
        (yielding.value, yielding.note.as_deref()),
        (None, Some("fewer than two points of the backbone"))
    );
    assert!(table_of(&stop(&[0.0, 3.0, -3.0, 3.0, -3.0, 0.0]), Field::Actuator).figures.is_empty());
}

#[test]
fn levels_have_the_losses_within_them_and_from_one_to_the_next() {
    let tips = [(0.5, 1.0), (1.0, 2.0), (1.0, 1.8), (1.0, 1.6), (2.0, 1.5), (2.0, 1.2)];
    let table = table_of(&lines(&tips, 1.0), Field::Structure);
    let of = |of: fn(&LevelRow) -> Option<f64>| table.levels.iter().map(of).collect::<Vec<_>>();
    let near = |found: Vec<Option<f64>>, expected: [Option<f64>; 3]| {
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(found.is_some(), expected.is_some());
            assert_relative_eq!(found.unwrap_or(0.0), expected.unwrap_or(0.0), epsilon = 1e-9);
        }
    };
    assert_eq!(table.levels.iter().map(|level| level.cycles).collect::<Vec<_>>(), [1, 3, 2]);
    near(of(|level| level.amplitude), [Some(0.5), Some(1.0), Some(2.0)]);
    near(of(|level| level.strength_loss_percent), [None, Some(20.0), Some(20.0)]);
    near(of(|level| level.stiffness_loss_percent), [None, Some(20.0), Some(20.0)]);
    near(of(|level| level.strength_percent), [Some(100.0), Some(100.0), Some(75.0)]);
    near(of(|level| level.stiffness_percent), [Some(100.0), Some(100.0), Some(37.5)]);
    // Each cycle has two half cycles; their sums are 1, 7 and 15.
    let yielding = value(&table, "mean backbone", "yield_input");
    near(of(|level| level.cumulative_ductility), [1.0, 7.0, 15.0].map(|sum| Some(sum / yielding)));
    near(of(|level| level.ductility), [0.5, 1.0, 2.0].map(|amplitude| Some(amplitude / yielding)));
    near(of(|level| level.drift_percent.or(Some(0.0))), [Some(0.0); 3]);
    // With a height, of structures alone.
    let with = |field| CycleOptions { height: Some(250.0), field: Some(field), ..CycleOptions::default() };
    let table = CycleTable::of(&lines(&tips, 1.0), &with(Field::Structure)).unwrap();
    let drifts = table.levels.iter().map(|level| level.drift_percent).collect::<Vec<_>>();
    near(drifts, [Some(0.2), Some(0.4), Some(0.8)]);
    assert!(CycleTable::of(&lines(&tips, 1.0), &with(Field::Actuator)).is_err());
}

#[test]
fn the_energies_of_levels_are_those_of_their_cycles() {
    let table = table_of(&stop(&[0.0, 2.0, -2.0, 2.0, -2.0, 4.0, -4.0, 4.0, -4.0, 0.0]), Field::Structure);
    let level = &table.levels[1];
    // 4 (d - 1) each.
    assert_relative_eq!(level.energy_first.unwrap(), 12.0, epsilon = 1e-9);
    assert_relative_eq!(level.energy_mean.unwrap(), 12.0, epsilon = 1e-9);
    assert_eq!(level.cumulative_energy, table.cycles[3].cumulative_energy);
}
