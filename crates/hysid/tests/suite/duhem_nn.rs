//! The Duhem neural network: its cell against closed forms, its derivatives against difference
//! quotients, and its identification.

use crate::scaffold::*;
use hysid::data::initial_state::InitialState;
use hysid::data::known_beginning::KnownBeginning;
use hysid::law::duhem_nn::{Cell, CellLayout, CellRun, CellShape, DuhemNn, FurtherInput, Input};
use hysid::law::series::run;
use hysid::options::input_options::InputOptions;
use hysid_core::elementary::{cos, exp, powf, sin};

/// A law without offset and scales, of one state that starts at `s_0` and is the output.
fn relaxation(c: f64, tau: f64, q: f64, s_0: f64) -> DuhemNn {
    let cell = Cell {
        stops: Vec::new(),
        hidden: vec![0.3, 0.5, -0.2, 0.7],
        targets: vec![0.0],
        rate_gains: vec![q],
        initial: vec![s_0],
        path_leaks: vec![c],
        relaxation_times: vec![tau],
        output: vec![0.0, 0.0, 0.0, 1.0, 0.0],
        ..Cell::default()
    };
    DuhemNn {
        input_centre: 0.0,
        input_scale: 1.0,
        rate_scale: Some(1.0),
        output_mean: 0.0,
        output_scale: 1.0,
        cell,
        further: Vec::new(),
        beginning: None,
    }
    .validated()
    .unwrap()
}

/// Random parameters of the magnitudes that a fit starts from, times `size`.
fn random_cell(shape: CellShape, size: f64, generator: &mut Generator) -> Cell {
    let layout = CellLayout::new(shape);
    let parameters: Vec<f64> = (0..layout.count())
        .map(|place| match layout.has_decay(place) {
            true => size * between(generator, -0.8, 0.8),
            false if layout.stops.contains(&place) => size * between(generator, -6.0, 6.0),
            false => between(generator, -2.0, 2.0),
        })
        .collect();
    let output = (0..shape.terms()).map(|_| size * between(generator, -1.0, 1.0)).collect();
    layout.cell(&parameters, output)
}

fn law_of(cell: Cell) -> DuhemNn {
    let shape = cell.shape();
    let rate_scale = (shape.channels == 2).then_some(2.0);
    let input = |is_direct| FurtherInput { centre: 0.1, scale: 2.0, is_direct, is_modulating: !is_direct };
    let (direct, modulating) = (vec![input(true); shape.direct], vec![input(false); shape.modulators]);
    let law = DuhemNn {
        further: [direct, modulating].concat(),
        beginning: None,
        input_centre: 0.2,
        input_scale: 1.5,
        rate_scale,
        output_mean: -1.0,
        output_scale: 4.0,
        cell,
    };
    law.validated().unwrap()
}

fn shapes() -> Vec<CellShape> {
    let full =
        CellShape { channels: 2, stops: 3, states: 3, neurons: 9, has_time: true, ..CellShape::default() };
    vec![
        full,
        CellShape { stops: 0, states: 1, neurons: 1, ..full },
        CellShape { stops: 0, ..full },
        CellShape { has_time: false, ..full },
        CellShape { channels: 1, has_time: false, neurons: 8, ..full },
        CellShape { channels: 1, has_time: false, stops: 0, states: 5, neurons: 3, ..full },
        CellShape { has_acceleration: true, is_odd: true, ..full },
        CellShape { direct: 2, modulators: 1, ..full },
        CellShape { has_acceleration: true, modulators: 2, is_odd: true, stops: 0, ..full },
    ]
}

/// With `W = 0` a state follows `ds/dt = (c |v| + 1/τ)(q v - s)`, which a constant rate solves in closed form
/// for any steps.
#[test]
fn a_state_without_neurons_relaxes_as_its_differential_equation() {
    let (c, tau, q, s_0) = (1.7, 0.6, 2.5, -3.0);
    let law = relaxation(c, tau, q, s_0);
    for rate in [0.0, 0.4, -1.3] {
        let mut state = law.virgin();
        let mut time = 0.0;
        for k in 0..40 {
            let step = if k == 0 { 0.0 } else { 0.01 * f64::from(k * k % 17 + 1) };
            time += step;
            let y = law.step(&mut state, Sample { x: 0.5 + rate * time, rate, step });
            let leak = c * f64::abs(rate) + 1.0 / tau;
            let exact = q * rate + (s_0 - q * rate) * exp(-leak * time);
            assert!((y - exact).abs() < 1e-12, "rate {rate}, row {k}: {y}, not {exact}");
        }
    }
}

/// Nothing moves a state while the input rests and no time passes, whatever the network.
#[test]
fn a_state_rests_with_its_input() {
    let mut generator = Generator::seed_from_u64(3);
    for shape in shapes() {
        let law = law_of(random_cell(shape, 1.0, &mut generator));
        let mut state = law.virgin();
        let resting = Sample { x: 0.7, rate: 0.0, step: 0.0 };
        law.step(&mut state, Sample { x: -0.4, rate: 1.0, step: 0.0 });
        let first = law.step(&mut state, Sample { step: 0.3, ..resting });
        // The neurons take the new states once more.
        let second = law.step(&mut state, resting);
        assert_eq!(second, law.step(&mut state, resting), "{shape:?}: {first}");
    }
}

#[test]
fn outputs_are_finite_for_any_parameters() {
    let mut generator = Generator::seed_from_u64(5);
    for trial in 0..60 {
        let shape = shapes()[trial % shapes().len()];
        let size = [1.0, 1e2, 1e5][trial % 3];
        let law = law_of(random_cell(shape, size, &mut generator));
        let largest = [1.0, 1e3, 1e90][trial / 3 % 3];
        let samples: Vec<Sample> = (0..300)
            .map(|_| Sample {
                x: largest * between(&mut generator, -1.0, 1.0),
                rate: largest * between(&mut generator, -1.0, 1.0),
                step: powf(10.0, between(&mut generator, -8.0, 8.0)),
            })
            .collect();
        assert!(run(&law, &samples).iter().all(|y| y.is_finite()), "{shape:?}");
    }
}

#[test]
fn parts_that_do_not_go_together_are_refused() {
    let mut generator = Generator::seed_from_u64(9);
    let law = law_of(random_cell(shapes()[0], 1.0, &mut generator));
    let text = serde_json::to_string(&law).unwrap();
    assert_eq!(serde_json::from_str::<DuhemNn>(&text).unwrap(), law);
    assert!(serde_json::from_str::<DuhemNn>(&text.replacen('{', "{\"colour\":1,", 1)).is_err());
    let refused = |change: &dyn Fn(&mut DuhemNn)| {
        let mut wrong = law.clone();
        change(&mut wrong);
        wrong.validated().unwrap_err().to_string()
    };
    for change in [
        &(|law: &mut DuhemNn| law.cell.hidden.truncate(4)) as &dyn Fn(&mut DuhemNn),
        &|law| law.cell.output.clear(),
        &|law| law.cell.stops.push(1.0),
        &|law| law.cell.initial.clear(),
        &|law| law.cell.rate_gains.clear(),
        &|law| law.cell.relaxation_times.truncate(1),
        &|law| law.rate_scale = None,
    ] {
        assert!(refused(change).contains("do not go together"));
    }
    assert!(refused(&|law| law.cell.path_leaks[1] = 0.0).contains("c_2"));
    assert!(refused(&|law| law.cell.relaxation_times[0] = -1.0).contains("τ_1"));
    assert!(refused(&|law| law.cell.output[0] = f64::NAN).contains("w_0"));
    assert!(refused(&|law| law.input_scale = 0.0).contains("not positive"));
    assert!(refused(&|law| law.output_mean = f64::INFINITY).contains("too large"));
}

fn drive(shape: CellShape, rows: usize, generator: &mut Generator) -> Vec<Input> {
    let mut x = 0.1;
    (0..rows)
        .map(|_| {
            x = (x + between(generator, -0.4, 0.4_f64)).clamp(-1.0, 1.0);
            let rate = if shape.channels == 2 { between(generator, -1.0, 1.0) } else { 0.0 };
            Input { x, from_origin: x + 0.3, rate, step: between(generator, 0.01, 0.5) }
        })
        .collect()
}

/// The outputs, and the columns of the Jacobian if asked for, of two records.
fn rows_of(cell: &Cell, drives: &[Vec<Input>], with_jacobian: bool) -> (Vec<f64>, Vec<Vec<f64>>) {
    let targets: Vec<Vec<f64>> = drives.iter().map(|drive| vec![0.0; drive.len()]).collect();
    let shape = cell.shape();
    let width = shape.direct + shape.modulators;
    let further = |drive: &Vec<Input>| (0..width * drive.len()).map(|k| sin(0.37 * k as f64)).collect();
    let further: Vec<Vec<f64>> = drives.iter().map(further).collect();
    let (initial, stop) = (&[][..], StopCheck::never());
    let run = CellRun { cell, drives, further: &further, initial, targets: &targets, with_jacobian, stop };
    let terms = cell.output.len();
    let rows = run.rows().unwrap();
    let output = |row: &Vec<f64>| row[..terms].iter().zip(&cell.output).map(|(term, w)| term * w).sum();
    (rows.iter().map(output).collect(), rows.iter().map(|row| row[terms + 1..].to_vec()).collect())
}

#[test]
fn derivatives_are_those_of_the_free_run() {
    let mut generator = Generator::seed_from_u64(11);
    for shape in shapes() {
        let layout = CellLayout::new(shape);
        let parameters: Vec<f64> = (0..layout.count())
            .map(|place| {
                let size = if layout.stops.contains(&place) { 4.0 } else { 0.8 };
                size * between(&mut generator, -1.0, 1.0)
            })
            .collect();
        let output: Vec<f64> = (0..shape.terms()).map(|_| between(&mut generator, -1.0, 1.0)).collect();
        let drives = [drive(shape, 60, &mut generator), drive(shape, 25, &mut generator)];
        let (_, jacobian) = rows_of(&layout.cell(&parameters, output.clone()), &drives, true);
        assert_eq!((jacobian.len(), jacobian[0].len()), (85, layout.count()));
        for place in 0..layout.count() {
            let by = 1e-6;
            let changed = |change: f64| {
                let mut parameters = parameters.clone();
                parameters[place] += change;
                rows_of(&layout.cell(&parameters, output.clone()), &drives, false).0
            };
            let (up, down) = (changed(by), changed(-by));
            for (row, (up, down)) in up.iter().zip(&down).enumerate() {
                let (quotient, exact) = ((up - down) / (2.0 * by), jacobian[row][place]);
                let tolerance = 1e-7 * (1.0 + exact.abs());
                assert!(
                    (quotient - exact).abs() < tolerance,
                    "{shape:?}, parameter {place}, row {row}: {exact}, not {quotient}"
                );
            }
        }
    }
}

/// The Gram matrix is that of the rows, in whatever groups they were gathered.
#[test]
fn the_gram_matrix_is_that_of_the_rows() {
    let mut generator = Generator::seed_from_u64(13);
    let shape = shapes()[0];
    let cell = random_cell(shape, 1.0, &mut generator);
    let drives = [drive(shape, 301, &mut generator), drive(shape, 30, &mut generator)];
    let blank = |k: usize| if k % 5 == 2 { f64::NAN } else { sin(k as f64) };
    let targets: Vec<Vec<f64>> = drives.iter().map(|drive| (0..drive.len()).map(blank).collect()).collect();
    for with_jacobian in [false, true] {
        let run = CellRun {
            cell: &cell,
            drives: &drives,
            further: &[],
            initial: &[],
            targets: &targets,
            with_jacobian,
            stop: StopCheck::never(),
        };
        let (gram, rows) = (run.gram().unwrap(), run.rows().unwrap());
        assert_eq!(rows.len(), targets.iter().flatten().filter(|y| !y.is_nan()).count());
        for i in 0..rows[0].len() {
            for j in 0..=i {
                let exact: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
                let size: f64 = rows.iter().map(|row| (row[i] * row[j]).abs()).sum();
                assert!((gram.at(i, j) - exact).abs() <= 1e-12 * size, "{i}, {j}");
            }
        }
        let stopped = CellRun { stop: StopCheck::new(&|| true), ..run };
        assert!(stopped.gram().is_none());
    }
}

fn timed(name: &str, rows: usize, pace: f64) -> Record {
    let time: Vec<f64> = (0..rows).map(|k| 0.02 * k as f64).collect();
    let tone = |t: f64, pace: f64, phase: f64| sin(pace * t + phase);
    let x = |&t: &f64| tone(t, pace, 0.0) + 0.5 * tone(t, 2.7 * pace, 1.0) + 0.7 * tone(t, 0.31 * pace, 2.0);
    let x = time.iter().map(x).collect();
    Record::new(name, vec![x], vec![0.0; rows]).unwrap().with_time(time).unwrap()
}

fn data(law: &DuhemNn, rate: Option<RateMethod>, records: Vec<Record>) -> Dataset {
    let answered = records.into_iter().map(|record| {
        let output = run(law, &Series::of(&record, rate).unwrap().samples);
        record.with_output(output).unwrap()
    });
    let names = ColumnNames { time: Some("t_s".into()), ..ColumnNames::plain(1) };
    Dataset::new(names, answered.collect()).unwrap()
}

fn options(rate: Option<RateMethod>) -> ClassicalOptions {
    ClassicalOptions { rate, ..of(ClassicalModel::DuhemNn) }
}

#[test]
fn it_learns_its_own_kind() {
    let rate = Some(RateMethod::Central);
    let mut generator = Generator::seed_from_u64(17);
    let shape =
        CellShape { channels: 2, stops: 2, states: 2, neurons: 4, has_time: true, ..CellShape::default() };
    let mut cell = random_cell(shape, 1.0, &mut generator);
    cell.stops = vec![1.5, 4.0, 0.2, -0.3];
    let law = law_of(cell);
    let seen =
        data(&law, rate, vec![timed("slow", 600, 1.0), timed("fast", 600, 2.2), timed("medium", 600, 1.5)]);
    let unseen = data(&law, rate, vec![timed("between", 600, 1.8)]);
    let options = ClassicalOptions { starts: Some(4), ..options(rate) };
    let found = DuhemNn::fit(&seen, &options, &mut go_on).unwrap();
    assert!(found.train_nrmse_percent < 1.0, "{}", found.train_nrmse_percent);
    let unseen = error_of(&found.law, &unseen, rate);
    assert!(unseen < 1.0, "{unseen}");
    assert!((error_of(&found.law, &seen, rate) - found.train_nrmse_percent).abs() < 1e-6);
}

#[test]
fn a_model_without_rate_or_time_has_only_what_its_data_have() {
    let rows = 300;
    let x: Vec<f64> = (0..rows).map(|k| sin(0.1 * k as f64) * (0.3 + 0.002 * k as f64)).collect();
    let y: Vec<f64> = (0..rows).map(|k| sin(0.1 * k as f64 - 0.4) * (0.3 + 0.002 * k as f64)).collect();
    let given: Vec<f64> = (0..rows).map(|k| cos(0.1 * k as f64)).collect();
    let plain = Record::new("r", vec![x], y).unwrap();
    let time = (0..rows).map(|k| 0.1 * k as f64).collect();
    let timed = plain.clone().with_time(time).unwrap();
    let rated = plain.clone().with_given_rate(given).unwrap();
    for (record, rate, has_rate, has_time) in [
        (plain, None, false, false),
        (timed.clone(), None, false, false),
        (timed, Some(RateMethod::Central), true, true),
        (rated, Some(RateMethod::Given), true, false),
    ] {
        let names = ColumnNames {
            time: record.time().map(|_| "t".into()),
            rate: record.given_rate().map(|_| "v".into()),
            ..ColumnNames::plain(1)
        };
        let data = Dataset::new(names, vec![record]).unwrap();
        let options = ClassicalOptions { starts: Some(2), epochs: Some(15), ..options(rate) };
        let fitted = identify(&data, &FitSpec::Classical(options), &mut |_| ControlFlow::Continue(()));
        let model = fitted.unwrap().model;
        assert_eq!(model.needs_time(), has_time, "{rate:?}");
        let text = model.to_json();
        let again = Model::from_json(&text).unwrap();
        assert_eq!((&again, again.to_json()), (&model, text));
        let hysid::model::Predictor::Law(hysid::law::Classical::DuhemNn(law)) = again.predictor() else {
            panic!("{:?}", again.predictor())
        };
        let CellShape { channels, has_time: relaxes, .. } = law.cell.shape();
        assert_eq!((channels == 2, relaxes), (has_rate, has_time), "{rate:?}");
        let error = again.evaluate(&data).unwrap().nrmse_std_percent.unwrap();
        assert!(error < 10.0, "{rate:?}: {error} %");
    }
}

#[test]
fn numbers_that_no_network_can_have_are_refused() {
    let law = relaxation(1.0, 0.5, 0.8, 0.0);
    let rate = Some(RateMethod::Central);
    let data = data(&law, rate, vec![timed("a", 100, 1.0)]);
    let none = options(rate);
    for (options, words) in [
        (ClassicalOptions { states: Some(0), ..none.clone() }, "states 0: choose 1 to 20"),
        (ClassicalOptions { states: Some(21), ..none.clone() }, "states 21"),
        (ClassicalOptions { hidden: Some(0), ..none.clone() }, "hidden 0: choose 1 to 100"),
        (ClassicalOptions { hidden: Some(101), ..none.clone() }, "hidden 101"),
        (ClassicalOptions { operators: Some(101), ..none.clone() }, "operators 101: choose 0 to 100"),
        (ClassicalOptions { starts: Some(0), ..none.clone() }, "starts 0"),
    ] {
        let error = DuhemNn::fit(&data, &options, &mut go_on).unwrap_err();
        assert!(matches!(error, Error::Option(_)) && error.to_string().contains(words), "{error}");
    }
}

/// The opposite inputs of an odd network, from its virgin state, give the opposite outputs.
#[test]
fn an_odd_network_answers_the_opposite_input_with_the_opposite_output() {
    let mut generator = Generator::seed_from_u64(19);
    for shape in shapes().into_iter().filter(|shape| shape.is_odd) {
        let mut cell = random_cell(shape, 1.0, &mut generator);
        cell.initial.fill(0.0);
        let drive = drive(shape, 80, &mut generator);
        let opposite: Vec<Input> = drive
            .iter()
            .map(|i| Input { x: -i.x, from_origin: -i.from_origin, rate: -i.rate, ..*i })
            .collect();
        let (outputs, _) = rows_of(&cell, &[drive], false);
        let (opposites, _) = rows_of(&cell, &[opposite], false);
        assert!(outputs.iter().zip(&opposites).all(|(a, b)| *a == -b), "{shape:?}");
    }
}

/// Records cut out of long runs of a network, whose states before them nobody knows: each begins `before` rows late.
fn cut_outs(law: &DuhemNn, rate: Option<RateMethod>, paces: &[f64], before: usize) -> Dataset {
    let rows = 240;
    let cut = |(index, &pace): (usize, &f64)| {
        let whole = timed("whole", before + rows, pace);
        let output = run(law, &Series::of(&whole, rate).unwrap().samples);
        let late = |values: &[f64]| values[before..].to_vec();
        let record = Record::new(format!("r{index}"), vec![late(&whole.inputs()[0])], late(&output)).unwrap();
        record.with_time(late(whole.time().unwrap())).unwrap()
    };
    let names = ColumnNames { time: Some("t_s".into()), ..ColumnNames::plain(1) };
    Dataset::new(names, paces.iter().enumerate().map(cut).collect()).unwrap()
}

/// A network of two slow states: what came before a record matters for most of it.
fn slow_law() -> DuhemNn {
    let mut generator = Generator::seed_from_u64(23);
    let shape = CellShape { channels: 2, states: 2, neurons: 3, has_time: true, ..CellShape::default() };
    let mut cell = random_cell(shape, 1.0, &mut generator);
    cell.path_leaks = vec![0.05, 0.1];
    cell.relaxation_times = vec![4.0, 9.0];
    cell.rate_gains = vec![1.5, -0.8];
    let states = shape.first_state()..shape.inputs();
    cell.output[states].fill(1.0);
    law_of(cell)
}

#[test]
fn free_states_find_what_came_before_the_records() {
    let rate = Some(RateMethod::Backward);
    let law = slow_law();
    let paces = [0.9, 1.3, 1.8, 2.2, 2.7, 1.1, 1.5, 2.0];
    let (seen, unseen) = (cut_outs(&law, rate, &paces, 150), cut_outs(&law, rate, &[1.2, 1.7, 2.4], 170));
    let of = |initial_state| ClassicalOptions {
        states: Some(2),
        operators: Some(0),
        hidden: Some(3),
        starts: Some(3),
        epochs: Some(40),
        shaping: InputOptions { initial_state, ..InputOptions::default() },
        ..options(rate)
    };
    let error = |initial_state, known| {
        let fitted =
            identify(&seen, &FitSpec::Classical(of(initial_state)), &mut |_| ControlFlow::Continue(()));
        let model = fitted.unwrap().model;
        assert!(Model::from_json(&model.to_json()).unwrap() == model);
        if known > 0 {
            runs_from_its_state(&model, &unseen.records()[0], known);
            let known = unseen.records()[0].clone().with_known_beginning(known);
            let found = model.find_state(&known.excitation()).unwrap().to_string();
            assert!(found.starts_with("states ") && found.contains("; residual "), "{found}");
        }
        let model = model.with_known_beginning(KnownBeginning::Rows(known));
        model.evaluate(&unseen).unwrap().nrmse_std_percent.unwrap()
    };
    let (virgin, free) = (error(None, 0), error(Some(InitialState::Free), 40));
    assert!(free < 3.0 && free < 0.6 * virgin, "free {free} %, virgin {virgin} %");
}

#[test]
fn states_are_found_from_the_known_beginning_of_a_record() {
    let rate = Some(RateMethod::Backward);
    let data = cut_outs(&slow_law(), rate, &[1.4], 200);
    let states = [[0.3, -0.2], [1.0, 0.4], [-0.7, 0.1], [0.2, 0.8], [-0.3, -0.9]].map(|state| state.to_vec());
    let beginning = hysid::law::duhem_nn::StatePrior::of(&states, &[0.0; 5], &[0.0, 0.0], 1e-6);
    let law = DuhemNn { beginning: Some(beginning), ..slow_law() };
    let series = Series::of(&data.records()[0], rate).unwrap();
    let known = 50;
    let found = law.found_states(&series.samples[..known], &[], &series.output[..known]).unwrap();
    let mut state = law.begun_with(&found);
    for (row, (&sample, y)) in series.samples.iter().zip(&series.output).enumerate() {
        // The rate of the first row of a cut-out is not known: it is 0 where it was not.
        let simulated = law.step(&mut state, sample);
        assert!(
            row == 0 || (simulated - y).abs() < 0.02 * law.output_scale,
            "row {row}: {simulated}, not {y}"
        );
    }
}
