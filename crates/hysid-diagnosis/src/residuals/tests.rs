use hysid_core::data::record::{ColumnNames, Record};
use hysid_core::data::turning_points::turning_points;
use hysid_core::elementary::{cos, ln, sin, square};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

const ROWS: usize = 2000;

/// Independent standard normal numbers.
fn noise(seed: u64, rows: usize) -> Vec<f64> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut uniform = || generator.random::<f64>().max(1e-300);
    let normal = |_| (-2.0 * ln(uniform())).sqrt() * cos(std::f64::consts::TAU * uniform());
    (0..rows).map(normal).collect()
}

/// An autoregression of first order of variance 1.
fn autoregression(seed: u64, rows: usize, a: f64) -> Vec<f64> {
    let shocks = noise(seed, rows);
    let mut last = shocks[0];
    let scale = (1.0 - a * a).sqrt();
    let mut next = |(row, shock): (usize, f64)| {
        last = if row == 0 { shock } else { a * last + scale * shock };
        last
    };
    shocks.into_iter().enumerate().map(&mut next).collect()
}

/// Loops of several amplitudes and speeds.
fn input(rows: usize) -> Vec<f64> {
    let mut phase = 0.0f64;
    (0..rows)
        .map(|k| {
            let share = k as f64 / rows as f64;
            phase += 0.04 + 0.05 * (7.0 * share).fract();
            (0.4 + 0.6 * (5.0 * share).fract()) * sin(phase)
        })
        .collect()
}

fn tested(x: &[f64], residual: &[f64]) -> Residuals {
    let data = Dataset::from_slices(x, residual).unwrap();
    Residuals::of(&data, &[vec![0.0; x.len()]], &ResidualOptions::default()).unwrap()
}

/// Shares of the seeds in which a p-value is below 5 %: of each test, and of any test after the correction.
fn false_alarms(seeds: u64, residual: impl Fn(u64) -> Vec<f64>) -> (Vec<(ResidualTest, f64)>, f64) {
    let x = input(ROWS);
    let (mut counts, mut any): (Vec<(ResidualTest, usize)>, usize) = (Vec::new(), 0);
    for seed in 0..seeds {
        let found = tested(&x, &residual(seed));
        if counts.is_empty() {
            counts = found.findings.iter().map(|finding| (finding.test, 0)).collect();
        }
        for (finding, (_, count)) in found.findings.iter().zip(&mut counts) {
            *count += usize::from(finding.p_value.is_some_and(|p| p < 0.05));
        }
        any += usize::from(found.found().next().is_some());
    }
    let share = |count: usize| count as f64 / seeds as f64;
    (counts.into_iter().map(|(test, count)| (test, share(count))).collect(), share(any))
}

/// Over 400 seeds, 95 % of the counts lie within 2.9 % to 7.1 % if the probability is 5 %.
#[test]
fn white_residuals_raise_false_alarms_as_often_as_stated() {
    let (of_tests, any) = false_alarms(400, |seed| noise(seed, ROWS));
    for (test, share) in of_tests {
        assert!((0.02..0.08).contains(&share), "{test:?}: {share}");
    }
    assert!((0.02..0.075).contains(&any), "{any}");
}

/// A residual that is correlated with itself, and with nothing else: the whiteness test finds it, the others do not take
/// its slow changes for structure.
#[test]
fn correlated_residuals_do_not_make_the_other_tests_lie() {
    for a in [0.6, 0.95] {
        let (of_tests, _) = false_alarms(300, |seed| autoregression(1000 + seed, ROWS, a));
        for (test, share) in of_tests {
            match test {
                ResidualTest::Whiteness => assert_eq!(share, 1.0),
                // Slow changes of a residual with some 50 independent rows look like a trend somewhat too often.
                ResidualTest::Time => assert!(share < 0.15, "{test:?} for {a}: {share}"),
                _ => assert!(share < 0.11, "{test:?} for {a}: {share}"),
            }
        }
    }
}

/// The share of 40 seeds in which a test finds structure beside noise of size 1.
fn found_share(test: ResidualTest, structure: impl Fn(usize, &[f64]) -> f64) -> f64 {
    let x = input(ROWS);
    let of_seed = |seed: u64| {
        let residual: Vec<f64> =
            noise(5000 + seed, ROWS).iter().enumerate().map(|(row, e)| e + structure(row, &x)).collect();
        usize::from(tested(&x, &residual).is_found(test))
    };
    (0..40).map(of_seed).sum::<usize>() as f64 / 40.0
}

fn rate(row: usize, x: &[f64]) -> f64 {
    let (before, after) = (row.saturating_sub(1), (row + 1).min(x.len() - 1));
    (x[after] - x[before]) / (after - before) as f64
}

/// All structures have a smaller root mean square than the noise.
#[test]
fn known_structure_is_found_and_named() {
    assert_eq!(found_share(ResidualTest::Rate, |row, x| 8.0 * rate(row, x)), 1.0);
    assert_eq!(found_share(ResidualTest::Direction, |row, x| 0.3 * rate(row, x).signum()), 1.0);
    assert_eq!(found_share(ResidualTest::Input, |row, x| 0.4 * x[row]), 1.0);
    assert!(found_share(ResidualTest::Input, |row, x| 0.5 * x[row.saturating_sub(13)]) > 0.95);
    assert_eq!(found_share(ResidualTest::Bias, |_, _| 0.15), 1.0);
    assert_eq!(found_share(ResidualTest::Time, |row, _| 0.6 * row as f64 / ROWS as f64), 1.0);
    assert_eq!(found_share(ResidualTest::Whiteness, |row, _| 0.7 * sin(0.3 * row as f64)), 1.0);
    let grows = |row: usize, x: &[f64], by: f64| sin(9.1 * (row * row) as f64) * by * x[row].abs();
    assert!(found_share(ResidualTest::Distance, |row, x| grows(row, x, 2.5)) > 0.9);
}

/// Structure that follows from the input is found however small the noise beside it, also in four cycles of one sine;
/// it is found by the test of its name only where the drive distinguishes both.
#[test]
fn structure_without_noise_is_found_too() {
    let sine: Vec<f64> = (0..1200).map(|row| sin(std::f64::consts::TAU * row as f64 / 300.0)).collect();
    for x in [input(ROWS), sine] {
        for noise_size in [0.0, 0.001, 0.1, 1.0] {
            let beside = |part: &dyn Fn(usize) -> f64| -> Residuals {
                let noise = noise(31, x.len());
                let residual: Vec<f64> =
                    (0..x.len()).map(|row| part(row) + noise_size * noise[row]).collect();
                tested(&x, &residual)
            };
            let of_rate = beside(&|row| 20.0 * rate(row, &x));
            assert!(of_rate.is_found(ResidualTest::Rate), "{noise_size}: {:?}", of_rate.findings);
            let of_input = beside(&|row| x[row]);
            assert!(of_input.is_found(ResidualTest::Input), "{noise_size}: {:?}", of_input.findings);
            assert!(!of_input.is_found(ResidualTest::Rate), "{noise_size}: {:?}", of_input.findings);
        }
    }
}

/// The advice is about what the data can show: of one speed a rate is not advised, and a sign of the direction is no rate.
#[test]
fn advice_is_of_what_was_planted() {
    let advice_with = |time: Option<Vec<f64>>, x: &[f64], uses_rate: bool, part: &dyn Fn(usize) -> f64| {
        let residual: Vec<f64> =
            noise(7, x.len()).iter().enumerate().map(|(row, e)| part(row) + 0.1 * e).collect();
        let record = Record::new("r", vec![x.to_vec()], residual).unwrap();
        let record = time.into_iter().fold(record, |record, time| record.with_time(time).unwrap());
        let names = ColumnNames {
            time: record.time().map(|_| "t".into()),
            inputs: vec!["x".into()],
            rate: None,
            output: "y".into(),
        };
        let data = Dataset::new(names, vec![record]).unwrap();
        let options = ResidualOptions { uses_rate, ..ResidualOptions::default() };
        let found = Residuals::of(&data, &[vec![0.0; x.len()]], &options).unwrap();
        found.findings.into_iter().find(|finding| finding.test == ResidualTest::Rate).unwrap().advice.unwrap()
    };
    let advice = |x: &[f64], uses_rate, part: &dyn Fn(usize) -> f64| advice_with(None, x, uses_rate, part);
    let several = input(ROWS);
    // With a rest in each step, every value is passed at the speed 1.
    let mut now = 0.0;
    let steps = several.windows(2).map(|pair| {
        now += (pair[1] - pair[0]).abs();
        now
    });
    let time: Vec<f64> = std::iter::once(0.0).chain(steps).collect();
    let told = advice_with(Some(time), &several, false, &|row| 20.0 * rate(row, &several));
    assert!(told.contains("measure at a second speed"), "{told}");
    let one: Vec<f64> = (0..1200).map(|row| sin(std::f64::consts::TAU * row as f64 / 300.0)).collect();
    assert!(advice(&several, false, &|row| 20.0 * rate(row, &several)).contains("give the model the rate"));
    assert!(advice(&several, true, &|row| 20.0 * rate(row, &several)).contains("too strong, too weak"));
    assert!(advice(&several, false, &|row| rate(row, &several).signum()).contains("too wide or too narrow"));
    assert!(advice(&one, true, &|row| 20.0 * rate(row, &one)).contains("measure at a second speed"));
}

/// An error only after reversals: the factor that is stated is the one that was made.
#[test]
fn an_error_after_reversals_is_found_with_its_factor() {
    let x = input(ROWS);
    let turns = turning_points(&x, 0.04);
    let mut residual = noise(3, ROWS);
    for (turn, next) in turns.iter().zip(turns[1..].iter().chain([&(ROWS - 1)])) {
        for row in *turn..*next {
            if (x[row] - x[*turn]) / (x[*next] - x[*turn]) <= 0.25 {
                residual[row] *= 2.0;
            }
        }
    }
    let found = tested(&x, &residual);
    let place = found.places.iter().find(|place| place.test == ResidualTest::TurningPoints).unwrap();
    let ratio = place.groups[0].rms / place.groups[1].rms;
    assert!((ratio - 2.0).abs() < 0.15, "{ratio}");
    let finding = found.findings.iter().find(|finding| finding.test == ResidualTest::TurningPoints).unwrap();
    assert_eq!(finding.verdict, ResidualVerdict::Found);
    assert!(
        finding.statement.contains("larger after turning points than elsewhere by a factor of"),
        "{}",
        finding.statement
    );
    assert!(finding.advice.is_some() && found.whiteness.p_value > 0.01);
}

/// The bound of the correlation is that of Bartlett: with both autocorrelations a^k it is wider by
/// `√((1 + a²)/(1 - a²))`.
#[test]
fn bounds_of_correlations_contain_the_autocorrelation_of_both() {
    let (rows, a) = (100_000, 0.7);
    let (x, e) = (autoregression(1, rows, a), autoregression(2, rows, a));
    let found = tested(&x, &e);
    let expected = 1.96 * ((1.0 + a * a) / (1.0 - a * a) / rows as f64).sqrt();
    approx::assert_relative_eq!(found.inputs[0].bounds[0], expected, max_relative = 0.1);
    let effective = rows as f64 * (1.0 - a * a) / (1.0 + a * a);
    approx::assert_relative_eq!(found.inputs[0].effective_rows[0], effective, max_relative = 0.2);
    approx::assert_relative_eq!(
        found.effective_rows,
        rows as f64 * (1.0 - a) / (1.0 + a),
        max_relative = 0.2
    );
}

#[test]
fn records_gaps_and_constant_columns_are_no_obstacle() {
    let record = |name: &str, rows: usize, seed: u64| {
        let x: Vec<f64> = (0..rows).map(|k| sin(0.05 * k as f64)).collect();
        let mut y = noise(seed, rows);
        y.iter_mut().step_by(7).for_each(|y| *y = f64::NAN);
        let time = (0..rows).map(|k| 0.01 * k as f64).collect();
        Record::new(name, vec![x, vec![3.0; rows]], y).unwrap().with_time(time).unwrap()
    };
    let records = vec![record("a", 900, 1), record("b", 5, 2), record("c", 400, 3)];
    let data = Dataset::new(ColumnNames::plain(2), records).unwrap();
    let simulated: Vec<Vec<f64>> = data.records().iter().map(|record| vec![0.0; record.len()]).collect();
    let found = Residuals::of(&data, &simulated, &ResidualOptions::default()).unwrap();
    assert_eq!(found.rows, data.scored());
    // The second input does not vary; the first and its rate do.
    assert_eq!(found.inputs.len(), 2);
    assert!((found.rms - 1.0).abs() < 0.1);
    let amplitude = found.findings.iter().find(|finding| finding.test == ResidualTest::Amplitude).unwrap();
    assert_eq!(amplitude.verdict, ResidualVerdict::NotTestable);

    let few = Dataset::from_slices(&[0.0, 1.0, 0.5], &[0.1, 0.2, 0.3]).unwrap();
    let error = Residuals::of(&few, &[vec![0.0; 3]], &ResidualOptions::default()).unwrap_err();
    assert!(error.to_string().contains("has only 3 rows"), "{error}");
}

/// A residual that is 0 or the same everywhere has no structure, and nothing divides by 0.
#[test]
fn a_residual_without_scatter_has_no_structure_but_its_mean() {
    let x = input(500);
    let none = tested(&x, &vec![0.0; 500]);
    assert!(none.found().next().is_none());
    let json = serde_json::to_string(&none).unwrap();
    assert!(!json.contains("null,null") && none.rms == 0.0);
    let constant = tested(&x, &vec![0.5; 500]);
    assert!(constant.findings.iter().all(|finding| !finding.statement.contains("NaN")));
}

/// A million rows cost no more than those that are tested.
#[test]
fn long_data_are_tested_in_stretches() {
    let rows = 1_000_000;
    let found = tested(&input(rows), &noise(9, rows));
    assert_eq!((found.scored, found.rows), (rows, MOST_ROWS));
    assert!(found.whiteness.p_value > 0.001);
}

/// Structure that returns in every cycle is as correlated in time as the input, and is found if there are many cycles. Of
/// a few cycles a caution says that little can be found.
#[test]
fn structure_that_returns_in_every_cycle_is_found() {
    let of_rows = |rows: usize| {
        let x = input(rows);
        let residual: Vec<f64> =
            (0..rows).map(|row| 0.3 * rate(row, &x).signum() + 0.2 * square(x[row])).collect();
        tested(&x, &residual)
    };
    let many = of_rows(10_000);
    for test in [ResidualTest::Direction, ResidualTest::Rate, ResidualTest::Distance, ResidualTest::Whiteness]
    {
        assert!(many.is_found(test), "{test:?}: {:?}", many.findings);
    }
    let few = of_rows(150);
    assert!(few.caution.is_some_and(|caution| caution.contains("does not mean that there is no structure")));
}
