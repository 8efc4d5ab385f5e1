//! Models fitted to generated cases: how often bands contain what they say, and a Duhem neural network of a damper.

use std::ops::ControlFlow;

use hysid::data::rate::RateMethod;
use hysid::data::record::{Dataset, Record};
use hysid::fit::identify;
use hysid::law::series::Series;
use hysid::model::{BandLevel, Model};
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid::options::fit_spec::AutoOptions;
use hysid::options::{FitSpec, ModelName};
use hysid_core::elementary::square;
use hysid_lab::generated::generated;

fn fitted(data: &Dataset, spec: &FitSpec) -> Model {
    identify(data, spec, &mut |_| ControlFlow::Continue(())).unwrap().model
}

fn small_auto() -> AutoOptions {
    let FitSpec::Auto(options) = FitSpec::of(ModelName::AUTO, None, 3) else {
        unreachable!("auto was asked for")
    };
    AutoOptions { epochs: Some(3), operators: Some(8), ..options }
}

/// By count on generated cases: a band contains nine rows of ten in about half of them, one for nine of ten
/// data sets in nearly all.
#[test]
fn a_band_contains_its_share_in_as_many_data_sets_as_it_is_for() {
    const CASES: usize = 20;
    let (mut in_band, mut in_wide_band, mut shares) = (0, 0, 0.0);
    for case in generated(CASES, 5).unwrap() {
        let only = FitSpec::Classical(ClassicalOptions {
            operators: Some(60),
            hidden: Some(0),
            deterioration: Some(true),
            ..ClassicalOptions::of(ClassicalModel::RandomStops)
        });
        let ensemble = AutoOptions { only: Some(Box::new(only)), members: 3, starts: 3, ..small_auto() };
        let model = fitted(&case.train.thinned(600), &FitSpec::Auto(ensemble));
        let share = |level: BandLevel| {
            let of_record = |record: &Record| {
                model.predict(&record.excitation(), level).unwrap().covered(record.output())
            };
            let counts = case.test.records().iter().map(of_record);
            let (covered, all) = counts.fold((0, 0), |sum, next| (sum.0 + next.0, sum.1 + next.1));
            covered as f64 / all as f64
        };
        let (narrow, wide) = (share(0.9.into()), share(BandLevel { probability: 0.9, of_ten: 9 }));
        assert!(wide >= narrow, "{}", case.name);
        shares += narrow / CASES as f64;
        in_band += usize::from(narrow >= 0.9);
        in_wide_band += usize::from(wide >= 0.9);
    }
    assert!((CASES / 4..=3 * CASES / 4).contains(&in_band), "{in_band} of {CASES}");
    assert!(in_wide_band * 10 >= 8 * CASES, "{in_wide_band} of {CASES}");
    assert!((0.8..0.97).contains(&shares), "{shares}");
}

/// Least squares of the output on input and rate in `train`, and the error in percent on `test`.
fn linear_error(train: &Dataset, test: &Dataset, rate: RateMethod) -> f64 {
    let rows = |data: &Dataset| -> Vec<[f64; 3]> {
        let all = Series::all(data, Some(rate)).unwrap();
        let rows = all.into_iter().flat_map(|series| series.samples.into_iter().zip(series.output));
        rows.filter(|(_, y)| !y.is_nan()).map(|(sample, y)| [sample.x, sample.rate, y]).collect()
    };
    let mean = |rows: &[[f64; 3]], of: &dyn Fn(&[f64; 3]) -> f64| {
        rows.iter().map(of).sum::<f64>() / rows.len() as f64
    };
    let seen = rows(train);
    let [x, v, y] = [0, 1, 2].map(|column| mean(&seen, &|row| row[column]));
    let product = |a: usize, b: usize| mean(&seen, &|row| (row[a] - [x, v, y][a]) * (row[b] - [x, v, y][b]));
    let determinant = product(0, 0) * product(1, 1) - square(product(0, 1));
    let of_x = (product(0, 2) * product(1, 1) - product(1, 2) * product(0, 1)) / determinant;
    let of_rate = (product(1, 2) * product(0, 0) - product(0, 2) * product(0, 1)) / determinant;
    let unseen = rows(test);
    let middle = mean(&unseen, &|row| row[2]);
    let residual = |row: &[f64; 3]| row[2] - y - of_x * (row[0] - x) - of_rate * (row[1] - v);
    100.0
        * (mean(&unseen, &|row| square(residual(row))) / mean(&unseen, &|row| square(row[2] - middle))).sqrt()
}

#[test]
fn it_predicts_a_damper_better_than_a_spring_with_a_dashpot() {
    let case = generated(5, 5).unwrap().remove(4);
    assert!(case.name.contains("damper-random"), "{}", case.name);
    let rate = RateMethod::Central;
    let options = ClassicalOptions {
        starts: Some(2),
        epochs: Some(25),
        rate: Some(rate),
        ..ClassicalOptions::of(ClassicalModel::DuhemNn)
    };
    let network = fitted(&case.train, &FitSpec::Classical(options))
        .evaluate(&case.test)
        .unwrap()
        .nrmse_std_percent
        .unwrap();
    let linear = linear_error(&case.train, &case.test, rate);
    assert!(network < 4.0 && network < 0.2 * linear, "{network} and {linear}");
}
