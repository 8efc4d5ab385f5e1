//! Guarantees of every model: it is found by its name, its file holds it to the last bit,
//! stepping and simulating agree, its parameters are named.

use crate::scaffold::*;
use hysid::law::Dimension;
use hysid::law::lugre::Lugre;
use hysid::law::series::samples;
use hysid::model::Predictor;
use hysid_core::elementary::sin;

fn data() -> Dataset {
    let names = ColumnNames::of(Some("t_s"), &["current_A"], "displacement_um");
    Dataset::new(names, vec![record(180, "a"), record(120, "b")]).unwrap()
}

fn quietly(request: &FitSpec) -> Fitted {
    identify(&data(), request, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn names_are_found_and_are_different() {
    let mut names: Vec<&str> = ModelName::all().map(ModelName::name).collect();
    for name in &names {
        assert_eq!(name.parse::<ModelName>().unwrap().name(), *name);
        assert_eq!(
            serde_json::to_string(&name.parse::<ModelName>().unwrap()).unwrap(),
            format!("\"{name}\"")
        );
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Family::ALL.len() + ClassicalModel::ALL.len());
    let error = "presach".parse::<ModelName>().unwrap_err().to_string();
    assert!(error.contains("preisach") && error.contains("xpnn+"), "{error}");
}

#[test]
fn every_model_comes_back_from_its_file() {
    for name in ModelName::all() {
        let fitted = quietly(&small(name, Some(RateMethod::Central)));
        let model = &fitted.model;
        assert_eq!(model.name(), name);
        let text = model.to_json();
        let again = Model::from_json(&text).unwrap_or_else(|error| panic!("{name:?}: {error}"));
        assert_eq!((&again, again.to_json()), (model, text));
        let data = data();
        // Better than the mean, or it has learnt nothing.
        let error = error_percent(model, &data);
        assert!(error < 60.0, "{name:?}: {error} %");
        assert_eq!(error, model.provenance().train.nrmse_std_percent.unwrap());
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    for name in ModelName::all().chain([ModelName::AUTO]) {
        let request = small(name, Some(RateMethod::Central).filter(|_| name.uses_rate()));
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let fitted = pool.install(|| quietly(&request));
            (fitted.model.to_json(), fitted.evaluations)
        };
        assert_eq!(of(1), of(3), "{name:?}");
    }
}

/// A fit without rounds listens in its midst: it ends with what it has, and is otherwise not disturbed.
#[test]
fn fits_without_rounds_end_when_they_are_told_to() {
    for rival in
        [ClassicalModel::Preisach, ClassicalModel::ModifiedPrandtlIshlinskii, ClassicalModel::RandomStops]
    {
        let request = small(ModelName::Classical(rival), None);
        let mut asked = 0;
        let whole = identify(&data(), &request, &mut |progress| {
            assert_eq!((progress.model, progress.is_part), (ModelName::Classical(rival), false));
            asked += 1;
            ControlFlow::Continue(())
        });
        let whole = whole.unwrap().model;
        assert!(asked > 2, "{rival:?}: asked {asked} times");
        assert_eq!(whole.provenance().termination, Termination::Converged);

        let mut asked_again = 0;
        let mut stopped_at = |call: usize| {
            asked_again = 0;
            identify(&data(), &request, &mut |_| {
                asked_again += 1;
                if asked_again >= call { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        };
        // At the first call there may be no model yet.
        match stopped_at(1) {
            Ok(cut) => assert_eq!(cut.model.provenance().termination, Termination::Stopped),
            Err(error) => assert!(matches!(error, Error::Stopped), "{rival:?}: {error}"),
        }
        let cut = stopped_at(asked).unwrap().model;
        assert!(asked_again <= asked, "{rival:?}: who has said stop is not asked again");
        // Threads may ask less often the second time.
        let expected = if asked_again == asked { Termination::Stopped } else { Termination::Converged };
        assert_eq!(cut.provenance().termination, expected);
        let error = |model: &Model| model.evaluate(&data()).unwrap().nrmse_std_percent.unwrap();
        assert!(error(&cut) < 60.0, "{rival:?}: {} %, not {} %", error(&cut), error(&whole));
    }
}

#[test]
fn parameters_of_laws_are_named_within_bounds_and_in_units() {
    for &rival in ClassicalModel::ALL {
        let model = quietly(&small(ModelName::Classical(rival), Some(RateMethod::Central))).model;
        let Predictor::Law(law) = model.predictor() else {
            assert_eq!(rival, ClassicalModel::RandomStops);
            continue;
        };
        let parameters = law.parameters();
        assert_eq!(parameters.len(), model.parameters());
        let mut symbols: Vec<&str> = parameters.iter().map(|parameter| parameter.symbol.as_str()).collect();
        symbols.sort_unstable();
        symbols.dedup();
        assert_eq!(symbols.len(), parameters.len(), "{rival:?}: two parameters share a symbol");
        for parameter in &parameters {
            let (low, high) = parameter.bounds;
            assert!((low..=high).contains(&parameter.value), "{rival:?}: {parameter:?}");
            assert!(!parameter.meaning.is_empty());
        }
        // The weights of a neural network are pure numbers.
        let has_units = parameters.iter().any(|parameter| parameter.unit != Dimension::NONE);
        assert_eq!(has_units, rival != ClassicalModel::NeuroMadelung, "{rival:?}");
    }
}

#[test]
fn units_are_products_of_powers() {
    let unit = |input, output, time| {
        let dimension = Dimension { input, output, time };
        dimension.unit(Some("mm"), Some("kN"), Some("s"))
    };
    assert_eq!(unit(0, 0, 0), "");
    assert_eq!(unit(-1, 1, 0), "kN/mm");
    assert_eq!(unit(-1, 1, 1), "kN s/mm");
    assert_eq!(unit(2, 0, -1), "mm^2/s");
    assert_eq!(unit(-1, 0, 0), "1/mm");
    assert_eq!(Dimension::SLOPE.unit(Some("A/m"), Some("T"), None), "T/(A/m)");
    assert_eq!(Dimension::INPUT.unit(Some("A/m"), Some("T"), None), "A/m");
    assert_eq!(Dimension::SLOPE.unit(None, Some("T"), None), "");
}

#[test]
fn what_a_model_cannot_be_fitted_to_is_said() {
    let rival = ModelName::Classical(ClassicalModel::RateDependentPrandtlIshlinskii);
    assert_eq!(rival.check_data(&data(), None), Err(Error::RateNeeded(rival.name())));
    assert_eq!(rival.check_data(&data(), Some(RateMethod::Central)), Ok(()));
    let two = Record::new("r", vec![vec![0.0, 1.0], vec![1.0, 0.0]], vec![0.0, 1.0]).unwrap();
    let two = Dataset::new(ColumnNames::plain(2), vec![two]).unwrap();
    for name in ModelName::all() {
        let refused = name.check_data(&two, Some(RateMethod::Central)).is_err();
        assert_eq!(refused, !name.takes_further_inputs(), "{name:?}");
    }
    let refused =
        |request: &FitSpec| identify(&data(), request, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(refused(&FitSpec::of(rival, None, 1)), Error::RateNeeded(rival.name()));
    for (model, operators) in [
        (ClassicalModel::Preisach, 0),
        (ClassicalModel::PrandtlIshlinskii, 0),
        (ClassicalModel::GeneralizedPrandtlIshlinskii, 0),
    ] {
        let options = ClassicalOptions { operators: Some(operators), ..of(model) };
        let error = refused(&FitSpec::Classical(options));
        assert!(matches!(&error, Error::Option(error) if error.option == "operators"), "{error}");
    }
}

#[test]
fn the_friction_of_a_joint_is_found_again() {
    let law = Lugre {
        offset: 0.0,
        spring: 1.5,
        sliding: 2.0,
        presliding: 0.05,
        stribeck: 0.6,
        stribeck_velocity: 0.2,
        bristle_damping: 0.0,
        viscous: 0.4,
    };
    let time: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
    let x: Vec<f64> = time.iter().map(|t| 0.4 * sin(*t) + 0.1 * sin(3.1 * t)).collect();
    let blank = Record::new("joint", vec![x], vec![0.0; 2000]).unwrap().with_time(time).unwrap();
    let output = Classical::from(law).run(&samples(&blank.excitation(), Some(RateMethod::Central)).unwrap());
    let data = Dataset::new(ColumnNames::plain(1), vec![blank.with_output(output).unwrap()]).unwrap();
    let options =
        ClassicalOptions { starts: Some(4), rate: Some(RateMethod::Central), ..of(ClassicalModel::Lugre) };
    let found = Lugre::fit(&data, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    let close = |found: f64, true_value: f64| (found - true_value).abs() < 1e-3 * true_value;
    assert!(found.train_nrmse_percent < 1e-3, "{found:?}");
    let Lugre { spring, sliding, presliding, stribeck, stribeck_velocity, viscous, .. } = found.law;
    for (found, true_value) in [
        (spring, 1.5),
        (sliding, 2.0),
        (presliding, 0.05),
        (stribeck, 0.6),
        (stribeck_velocity, 0.2),
        (viscous, 0.4),
    ] {
        assert!(close(found, true_value), "{found} for {true_value}");
    }
}
