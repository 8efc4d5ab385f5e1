//! Confidence intervals of the parameters of laws: how often they contain the parameters that made the data.

use crate::scaffold::*;
use hysid::Dataset;
use hysid::fit::intervals::{IntervalStatus, ParameterIntervals};
use hysid::law::Parameter;
use hysid::law::bouc_wen::BoucWen;
use hysid::law::jiles_atherton::{JilesAtherton, JilesAthertonForm};
use hysid::law::menegotto_pinto::MenegottoPinto;
use hysid::law::prandtl_ishlinskii::PrandtlIshlinskii;
use hysid::law::series::run;
use hysid_core::elementary::{cos, ln, sin, square};

const ROWS: usize = 1500;

/// Seeds of each count; `HYSID_SEEDS` sets another number, as for the table of docs/residuals.md.
fn seeds() -> u64 {
    std::env::var("HYSID_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(60)
}

/// Loops of growing and falling amplitude.
fn input() -> Vec<f64> {
    (0..ROWS)
        .map(|k| {
            let share = k as f64 / ROWS as f64;
            (0.3 + 0.7 * (3.0 * share).fract()) * sin(0.06 * k as f64)
        })
        .collect()
}

/// Noise of deviation 1 whose rows are correlated by `a`.
fn noise(seed: u64, a: f64) -> Vec<f64> {
    let mut generator = Generator::seed_from_u64(seed);
    let mut normal = || {
        let (u, v): (f64, f64) = (generator.random::<f64>().max(1e-300), generator.random());
        (-2.0 * ln(u)).sqrt() * cos(std::f64::consts::TAU * v)
    };
    let mut last = normal();
    let mut all = vec![last];
    for _ in 1..ROWS {
        last = a * last + (1.0 - a * a).sqrt() * normal();
        all.push(last);
    }
    all
}

struct Case<L> {
    law: L,
    options: ClassicalOptions,
    /// Deviation of the noise as a share of that of the output.
    share: f64,
}

/// How many of so many intervals contain the parameter, for each parameter.
type Coverage = Vec<(String, usize, usize)>;

impl<L: Law> Case<L> {
    fn intervals(&self, seed: u64, a: f64) -> (Vec<Parameter>, ParameterIntervals) {
        let x = input();
        let clean = run(&self.law, &samples_of(&x));
        let mean = clean.iter().sum::<f64>() / ROWS as f64;
        let deviation = (clean.iter().map(|y| square(y - mean)).sum::<f64>() / ROWS as f64).sqrt();
        let y: Vec<f64> =
            clean.iter().zip(noise(seed, a)).map(|(y, e)| y + self.share * deviation * e).collect();
        let data = Dataset::from_slices(&x, &y).unwrap();
        let spec = FitSpec::Classical(self.options.clone());
        let model = model_of(&data, &spec);
        (self.law.parameters(), ParameterIntervals::of(&model, &data).unwrap().unwrap())
    }

    fn coverage(&self, a: f64) -> Coverage {
        let mut counts: Coverage = Vec::new();
        for seed in 0..seeds() {
            let (truth, found) = self.intervals(seed, a);
            if counts.is_empty() {
                counts = truth.iter().map(|parameter| (parameter.symbol.clone(), 0, 0)).collect();
            }
            for ((parameter, interval), (_, inside, all)) in
                truth.iter().zip(&found.parameters).zip(&mut counts)
            {
                if let (Some(low), Some(high)) = (interval.low, interval.high) {
                    *all += 1;
                    *inside += usize::from((low..=high).contains(&parameter.value));
                }
            }
        }
        counts
    }
}

fn share(coverage: &Coverage) -> f64 {
    let (inside, all) = coverage.iter().fold((0, 0), |sum, one| (sum.0 + one.1, sum.1 + one.2));
    inside as f64 / all as f64
}

/// Counts the coverage with white and correlated noise. Single parameters may fall shorter where the noise is correlated:
/// then 1500 rows are as few as 80 independent ones, and the shape of the bends of Menegotto and Pinto is hardly seen.
fn check<L: Law>(name: &str, case: &Case<L>, least: [f64; 2]) {
    for ((a, slack), least) in [(0.0, 0.1), (0.9, 0.2)].into_iter().zip(least) {
        let coverage = case.coverage(a);
        println!("{name}, AR(1) {a}: {:.3} {coverage:?}", share(&coverage));
        assert!(share(&coverage) >= least, "{name}, AR(1) {a}: {coverage:?}");
        for (symbol, inside, all) in &coverage {
            let is_low = *all >= 30 && (*inside as f64) < (least - slack) * *all as f64;
            assert!(!is_low, "{name}, AR(1) {a}, {symbol}: {inside} of {all}");
        }
    }
}

fn searched(model: ClassicalModel, near: &[f64]) -> ClassicalOptions {
    ClassicalOptions { near: near.to_vec(), ..of(model) }
}

fn bouc_wen() -> Case<BoucWen> {
    let law = BoucWen {
        offset: 0.3,
        elastic_stiffness: 2.0,
        hysteretic_stiffness: 12.0,
        damping: 0.0,
        yield_displacement: 0.2,
        b: 0.6,
        n: 1.7,
        degradation: None,
    };
    Case { law, options: searched(ClassicalModel::BoucWen, &[0.2, 0.6, 1.7]), share: 0.05 }
}

fn jiles_atherton() -> Case<JilesAtherton> {
    let (saturation, a, k, alpha, c) = (1.5, 0.15, 0.2, 0.1, 0.2);
    let law = JilesAtherton {
        offset: 0.1,
        permeability: 0.2,
        saturation,
        a,
        k,
        alpha,
        c,
        form: JilesAthertonForm::Original,
    };
    let near = [a, k, alpha * saturation / (3.0 * a), c];
    Case { law, options: searched(ClassicalModel::JilesAtherton, &near), share: 0.05 }
}

fn menegotto_pinto() -> Case<MenegottoPinto> {
    let law = MenegottoPinto {
        offset: 0.0,
        hardening_stiffness: 5.0,
        strength: 20.0,
        yield_displacement: 0.1,
        roundness: 8.0,
        loss: 0.8,
        pace: 1.0,
        isotropic: 0.05,
        down: None,
    };
    let near = [0.1, 8.0, 0.8, 1.0, 0.05];
    Case { law, options: searched(ClassicalModel::MenegottoPinto, &near), share: 0.05 }
}

fn prandtl_ishlinskii() -> Case<PrandtlIshlinskii> {
    let thresholds = vec![0.1, 0.25, 0.45];
    let law = PrandtlIshlinskii::new(0.2, 1.0, thresholds.clone(), vec![0.8, 0.5, 0.4]).unwrap();
    let options = ClassicalOptions { thresholds: Some(thresholds), ..of(ClassicalModel::PrandtlIshlinskii) };
    Case { law, options, share: 0.05 }
}

#[test]
fn intervals_contain_the_parameters_as_often_as_stated() {
    check("bouc-wen", &bouc_wen(), [0.9, 0.85]);
    check("jiles-atherton", &jiles_atherton(), [0.9, 0.85]);
    check("menegotto-pinto", &menegotto_pinto(), [0.9, 0.83]);
    check("prandtl-ishlinskii", &prandtl_ishlinskii(), [0.9, 0.85]);
}

/// Weights at the bound 0 are marked, and what was given has no interval.
#[test]
fn parameters_at_their_bound_and_given_ones_are_marked() {
    let mut case = prandtl_ishlinskii();
    // A play of no weight: its estimate is 0 for every other seed.
    case.law = PrandtlIshlinskii::new(0.2, 1.0, vec![0.1, 0.25, 0.45], vec![0.8, 0.0, 0.4]).unwrap();
    case.options.sign = Some(hysid::options::classical::Sign::NonNegative);
    let of_seed = |seed| case.intervals(seed, 0.0).1.parameters;
    let marked = (0..20).map(of_seed).filter(|found| found[5].status == IntervalStatus::AtBound).count();
    assert!((3..18).contains(&marked), "{marked}");
    let found = of_seed(1);
    assert_eq!((found[2].symbol.as_str(), found[2].status), ("r_1", IntervalStatus::NotFitted));
    assert!(found[2].low.is_none() && found[0].low.is_some());
}

/// An element that never yields is another spring: the data determine neither its bend nor the shares of both.
#[test]
fn what_the_data_do_not_determine_is_marked() {
    let mut case = bouc_wen();
    case.law.yield_displacement = 50.0;
    case.options.near = vec![1.9, 0.6, 1.7];
    let marked = |seed| {
        let found = case.intervals(seed, 0.0).1.parameters;
        assert_eq!((found[0].symbol.as_str(), found[0].status), ("c0", IntervalStatus::Determined));
        assert_eq!((found[3].symbol.as_str(), found[3].status), ("c", IntervalStatus::NotFitted));
        let is_open =
            |at: usize| matches!(found[at].status, IntervalStatus::NotDetermined | IntervalStatus::AtBound);
        (is_open(5), is_open(6))
    };
    let all: Vec<(bool, bool)> = (0..20).map(marked).collect();
    let share = all.iter().filter(|(b, n)| *b || *n).count();
    assert!(share >= 19, "{all:?}");
}

/// Intervals follow from the model file and the training data, and from no other data.
#[test]
fn intervals_need_the_training_data_and_nothing_else() {
    let case = prandtl_ishlinskii();
    let x = input();
    let y = run(&case.law, &samples_of(&x));
    let noisy = |seed| -> Dataset {
        let y: Vec<f64> = y.iter().zip(noise(seed, 0.0)).map(|(y, e)| y + 0.01 * e).collect();
        Dataset::from_slices(&x, &y).unwrap()
    };
    let (data, other) = (noisy(1), noisy(2));
    let spec = FitSpec::Classical(case.options.clone());
    let model = model_of(&data, &spec);
    let found = ParameterIntervals::of(&model, &data).unwrap();
    let read = hysid::Model::from_json(&model.to_json()).unwrap();
    assert_eq!(ParameterIntervals::of(&read, &data).unwrap(), found);
    let error = ParameterIntervals::of(&model, &other).unwrap_err().to_string();
    assert!(error.contains("need the training data"), "{error}");
    let network = hysid::Fit::new().model("preisach").run(&data).unwrap();
    assert_eq!(ParameterIntervals::of(&network, &data).unwrap(), None);
}

/// Every law with intervals finds its own fit again: the residual about which it is linearised is that of the model.
#[test]
fn every_law_is_linearised_about_its_own_fit() {
    let x = input();
    let time: Vec<f64> = (0..ROWS).map(|k| 0.01 * k as f64).collect();
    let y: Vec<f64> =
        run(&bouc_wen().law, &samples_of(&x)).iter().zip(noise(4, 0.0)).map(|(y, e)| y + 0.05 * e).collect();
    let data = timed(time, x, y);
    let names = "masing prandtl-ishlinskii modified-prandtl-ishlinskii generalized-prandtl-ishlinskii \
                 rate-dependent-prandtl-ishlinskii bouc-wen peak-oriented menegotto-pinto ramberg-osgood \
                 jiles-atherton lugre";
    for name in names.split(' ') {
        let model = hysid::Fit::new().model(name).option("starts", 2).option("epochs", 5).run(&data).unwrap();
        let found = ParameterIntervals::of(&model, &data).unwrap().expect(name);
        assert_eq!(found.parameters.len(), model.law().unwrap().parameters().len(), "{name}");
        let errors: Vec<f64> =
            found.parameters.iter().filter_map(|parameter| parameter.standard_error).collect();
        assert!(
            !errors.is_empty() && errors.iter().all(|error| error.is_finite() && *error > 0.0),
            "{name}: {found:?}"
        );
        for parameter in &found.parameters {
            let inside = parameter.low.is_none_or(|low| low <= parameter.value)
                && parameter.high.is_none_or(|high| parameter.value <= high);
            assert!(inside, "{name}: {parameter:?}");
        }
        approx::assert_relative_eq!(found.residual_rms, model.provenance().train.rmse, max_relative = 1e-6);
    }
}
