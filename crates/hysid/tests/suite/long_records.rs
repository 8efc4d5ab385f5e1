//! Searches look at some of many rows. Whatever the rows of a cycle, what they find there holds for all rows.

use hysid_core::elementary::sin;

use crate::scaffold::*;

/// Growing cycles of so many rows each, of three plays in parallel.
fn cycles(rows: usize, period: usize) -> Dataset {
    let phase = |row: usize| std::f64::consts::TAU * row as f64 / period as f64;
    let x: Vec<f64> = (0..rows).map(|row| sin(phase(row)) * (0.6 + 1.4 * row as f64 / rows as f64)).collect();
    let mut y: Vec<f64> = x.iter().map(|x| 2.3 * x).collect();
    for (threshold, weight) in [(0.1, 0.5), (0.4, 0.8), (0.9, 0.3)] {
        let stop = Stop::new(threshold).unwrap().run(&x);
        y.iter_mut().zip(stop).for_each(|(y, z)| *y -= weight * z);
    }
    let time = (0..rows).map(|row| 0.01 * row as f64).collect();
    timed(time, x, y)
}

fn fitted(data: &Dataset, model: ClassicalModel) -> Model {
    let options = ClassicalOptions {
        starts: Some(2),
        epochs: Some(8),
        operators: Some(6),
        hidden: (model == ClassicalModel::NeuroMadelung).then_some(3),
        rate: model.needs_rate().then_some(RateMethod::Central),
        ..of(model)
    };
    model_of(data, &FitSpec::Classical(options))
}

/// A fixed distance between the rows that are looked at met the same two phases of every cycle of 20 or 40 rows.
#[test]
fn rows_of_a_cycle_do_not_matter() {
    for (period, every) in [(7, 7), (20, 20)] {
        let data = cycles(5000 * every, period);
        let found = error_percent(&fitted(&data, ClassicalModel::GeneralizedPrandtlIshlinskii), &data);
        assert!(found < 8.0, "{period} rows a cycle: {found} %");
    }
    let data = cycles(100_000, 20);
    let found = error_percent(&fitted(&data, ClassicalModel::BoucWen), &data);
    assert!(found < 12.0, "Bouc-Wen: {found} %");
}

/// The same for laws whose memory needs every row.
#[test]
fn rows_of_a_cycle_do_not_matter_to_laws_with_a_rate() {
    for period in [19, 20] {
        let data = cycles(20_000, period);
        let found = error_percent(&fitted(&data, ClassicalModel::RateDependentPrandtlIshlinskii), &data);
        assert!(found < 4.0, "{period} rows a cycle: {found} %");
    }
}
