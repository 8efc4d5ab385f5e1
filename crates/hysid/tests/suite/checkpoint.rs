//! A fit that is cut short and taken up again comes to what it would have come to, to the last bit, for
//! every trainer and any number of threads.

use crate::scaffold::*;
use hysid::fit::network::{fit, resume};
use hysid::fit::progress::Checkpoint;
use hysid::options::network::{Method, Trainer};
use hysid_core::elementary::{powi, sin};

fn data() -> Dataset {
    let x: Vec<f64> = (0..160).map(|k| sin(0.21 * k as f64) * (0.4 + 0.6 * sin(0.013 * k as f64))).collect();
    let mut stop = Stop::new(0.2).unwrap();
    let y = x.iter().map(|x| 3.0 * stop.step(*x) + powi(*x, 3)).collect();
    let time = (0..160).map(|k| 0.1 * k as f64).collect();
    timed(time, x, y)
}

fn options(training: Trainer, starts: usize) -> FitOptions {
    let epochs = if training == Trainer::LevenbergMarquardt { 6 } else { 16 };
    FitOptions {
        model: Family::Xpnn,
        sizes: Sizes { stops: 3, hidden: 2, relaxation: 0 },
        rate: Some(RateMethod::Central),
        starts,
        epochs,
        population: 10,
        // Thinned, so that the last iterations see other rows than those before.
        thin: 100,
        ..FitOptions::of(training)
    }
}

fn all_options() -> impl Iterator<Item = FitOptions> {
    Trainer::ALL.into_iter().flat_map(|training| [1, 3].map(|starts| options(training, starts)))
}

fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn whole(options: &FitOptions) -> (Fitted, usize) {
    let mut calls = 0;
    let fitted = fit(&data(), options, &mut |_| {
        calls += 1;
        ControlFlow::Continue(())
    });
    (fitted.unwrap(), calls)
}

/// The checkpoint at a call of the observer, by way of its bytes, as a file would hold them.
fn cut_at(
    call: usize,
    fit: impl FnOnce(&mut (dyn FnMut(&Progress) -> ControlFlow<()> + Send)),
) -> Checkpoint {
    let (mut calls, mut bytes) = (0, None);
    fit(&mut |progress| {
        calls += 1;
        if calls < call {
            return ControlFlow::Continue(());
        }
        assert!(bytes.is_none(), "called again after it said stop");
        bytes = Some(progress.checkpoint().unwrap().to_bytes());
        ControlFlow::Break(())
    });
    Checkpoint::from_bytes(&bytes.unwrap_or_else(|| panic!("call {call} never came"))).unwrap()
}

fn resumed(checkpoint: Checkpoint) -> Fitted {
    resume(&data(), checkpoint, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_fit_taken_up_again_is_the_same_to_the_last_bit() {
    for options in all_options() {
        let (expected, calls) = whole(&options);
        assert!(calls >= 6, "{options:?}");
        for call in [1, 2, calls / 3, calls / 2, calls - 1, calls] {
            let checkpoint = cut_at(call, |observer| {
                let stopped = fit(&data(), &options, observer).unwrap();
                assert_eq!(stopped.model.provenance().termination, Termination::Stopped);
            });
            assert_eq!(checkpoint.options(), &options);
            let again = resumed(checkpoint);
            assert_eq!(
                again.model.to_json(),
                expected.model.to_json(),
                "{options:?}, cut at {call} of {calls}"
            );
            assert_eq!(again.evaluations, expected.evaluations);
        }
    }
}

#[test]
fn it_may_be_cut_again_and_again_with_other_threads_each_time() {
    for options in all_options() {
        let (expected, _) = whole(&options);
        let mut checkpoint = cut_at(2, |observer| {
            let _ = fit(&data(), &options, observer).unwrap();
        });
        for threads in [1, 3, 2] {
            let from = checkpoint.clone();
            checkpoint = on(threads, || {
                cut_at(2, |observer| {
                    let _ = resume(&data(), from, observer).unwrap();
                })
            });
        }
        assert_eq!(resumed(checkpoint).model, expected.model, "{options:?}");
    }
}

#[test]
fn threads_do_not_matter_and_seeds_do() {
    for options in all_options() {
        let one = on(1, || whole(&options).0);
        let two = on(2, || whole(&options).0);
        assert_eq!(one.model.to_json(), two.model.to_json(), "{options:?}");
        assert_eq!(one.evaluations, two.evaluations);
        let other = whole(&FitOptions { seed: 7, ..options }).0;
        assert_ne!(one.model.network().unwrap(), other.model.network().unwrap());
    }
}

#[test]
fn a_hybrid_is_a_genetic_algorithm_and_then_a_sub_gradient_method() {
    let options = FitOptions { epochs: 40, ..options(Trainer::Hybrid, 1) };
    let (hybrid, calls) = whole(&options);
    let runs = &hybrid.model.provenance().runs;
    assert_eq!(runs.iter().map(|run| run.method).collect::<Vec<_>>(), [Method::Genetic, Method::Subgradient]);
    let (genetic, subgradient) = (&runs[0].history, &runs[1].history);
    assert_eq!((genetic[0].epoch, genetic.last().unwrap().epoch), (0, 20));
    assert_eq!((subgradient[0].epoch, subgradient.last().unwrap().epoch), (20, 40));
    assert_eq!(calls, 40);
    // The second begins where the first ended, and no epoch is worse than the one before.
    assert_eq!(genetic.last().unwrap().train_nrmse_percent, subgradient[0].train_nrmse_percent);
    // The genetic algorithm alone with half of the epochs is the first half.
    let alone = whole(&FitOptions { epochs: 20, training: Trainer::Genetic, ..options }).0;
    assert_eq!(alone.model.provenance().runs[0].history, *genetic);
    assert!(subgradient.last().unwrap().train_nrmse_percent < genetic.last().unwrap().train_nrmse_percent);
    // 10 individuals, then 9 a generation; the best are evaluated once more for their error only.
    assert_eq!(genetic.last().unwrap().evaluations, 10 + 20 * 9);
}

#[test]
fn the_stall_rule_ends_a_phase_early() {
    for training in [Trainer::Genetic, Trainer::Subgradient, Trainer::Hybrid] {
        let patient = FitOptions { epochs: 2000, stall: 5, ..options(training, 1) };
        let stalled = whole(&patient).0;
        for run in &stalled.model.provenance().runs {
            assert_eq!(run.termination, Termination::Stalled, "{training:?}");
            let epochs = run.history.last().unwrap().epoch - run.history[0].epoch;
            assert!((5..1000).contains(&epochs), "{training:?}: {epochs} epochs");
        }
    }
    let never = FitOptions { epochs: 60, stall: 0, population: 4, ..options(Trainer::Genetic, 1) };
    let run = &whole(&never).0.model.provenance().runs[0].clone();
    assert_eq!((run.termination, run.history.last().unwrap().epoch), (Termination::EpochsUsed, 60));
}

/// A checkpoint with its checksum right and another number in the place of one of its own.
fn with_number(bytes: &[u8], key: &str, value: f64) -> Checkpoint {
    let magic = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let mut content = bytes[magic + 4..].to_vec();
    // MessagePack: a text of up to 31 bytes, then a number of eight bytes.
    let text = [&[0xa0 | key.len() as u8], key.as_bytes(), &[0xcb]].concat();
    let at = content.windows(text.len()).position(|window| window == text).expect("the key") + text.len();
    content[at..at + 8].copy_from_slice(&value.to_be_bytes());
    let sum = crc32fast::hash(&content).to_le_bytes();
    Checkpoint::from_bytes(&[&bytes[..magic], &sum, &content].concat()).unwrap()
}

/// They panicked, or went on for ever.
#[test]
fn contradictory_checkpoints_are_refused() {
    let keys: [(Trainer, &[&str]); 3] = [
        (Trainer::LevenbergMarquardt, &["mu", "growth", "objective", "mean_square"]),
        (Trainer::Genetic, &["cost", "objective"]),
        (Trainer::Subgradient, &["step", "value", "last_move", "coefficient"]),
    ];
    for (training, keys) in keys {
        let checkpoint = cut_at(3, |observer| {
            let _ = fit(&data(), &options(training, 1), observer).unwrap();
        });
        let bytes = checkpoint.to_bytes();
        for key in keys {
            let wrong = with_number(&bytes, key, f64::NAN);
            let error = resume(&data(), wrong, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
            assert!(error.contains("is inconsistent") && error.contains("start a new fit"), "{key}: {error}");
        }
        // A resumed fit wrote a model with this mean square, which could not be read.
        for key in ["mean_square", "train_nrmse_percent"] {
            let wrong = with_number(&bytes, key, -0.5);
            let error = resume(&data(), wrong, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
            assert!(error.contains("is inconsistent"), "{key} with {training:?}: {error}");
        }
    }
}

#[test]
fn damaged_checkpoints_and_other_data_are_refused() {
    let checkpoint = cut_at(4, |observer| {
        let _ = fit(&data(), &options(Trainer::Hybrid, 1), observer).unwrap();
    });
    let bytes = checkpoint.to_bytes();
    let refusal = |bytes: &[u8]| Checkpoint::from_bytes(bytes).unwrap_err().to_string();
    for length in (0..bytes.len()).step_by(97) {
        let said = refusal(&bytes[..length]);
        assert!(said.contains("start a new fit"), "{length}: {said}");
    }
    for place in (0..bytes.len()).step_by(61) {
        let mut bytes = bytes.clone();
        bytes[place] ^= 4;
        let said = refusal(&bytes);
        assert!(said.contains("start a new fit"), "{place}: {said}");
    }
    assert!(refusal(b"").contains("empty") && refusal(b"x,y\n1,2\n").contains("not a Hysid checkpoint"));
    assert!(refusal(b"hysid checkpoint 9\n....").contains("another version"));
    let whole = data();
    let record = &whole.records()[0];
    let mut y = record.output().to_vec();
    y[9] += 1e-9;
    let record = record.clone().with_output(y).unwrap();
    let other = Dataset::new(ColumnNames::plain(1), vec![record]).unwrap();
    let error = resume(&other, checkpoint, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert!(error.to_string().contains("other data"), "{error}");
}
