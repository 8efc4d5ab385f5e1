//! The operators against exact laws: identities, theorems and closed solutions that hold whatever
//! the input. Numbers as (1.2) are equations of docs/theory.md.

use crate::scaffold::*;
use std::f64::consts::TAU;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use hysid::operator::{Play, Relaxation, relaxation};
use hysid_core::elementary::{acos, exp, sin};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn few_repeatable_cases() -> ProptestConfig {
    ProptestConfig {
        cases: 200,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}

/// Turning points, in units of which thresholds are a fraction.
fn path() -> impl Strategy<Value = Vec<f64>> {
    vec(-3.0..3.0, 2..30)
}

fn threshold() -> impl Strategy<Value = f64> {
    0.05..2.5
}

/// For each piece between two points of a path: where on it (0 to 1) further points go.
fn refinement() -> impl Strategy<Value = Vec<Vec<f64>>> {
    vec(vec(0.0..=1.0, 0..5), 30)
}

/// `path` with further points on its straight pieces, and the places of the original points; 0 and 1 repeat one.
fn refine(path: &[f64], fractions: &[Vec<f64>]) -> (Vec<f64>, Vec<usize>) {
    let (mut refined, mut kept) = (vec![path[0]], vec![0]);
    for (ends, fractions) in path.windows(2).zip(fractions) {
        let (from, to) = (ends[0], ends[1]);
        let mut fractions = fractions.clone();
        fractions.sort_by(f64::total_cmp);
        for fraction in fractions {
            // Rounding may carry the sum beyond `to`, so clip.
            let inside = (from + fraction * (to - from)).clamp(from.min(to), from.max(to));
            refined.push(inside);
        }
        kept.push(refined.len());
        refined.push(to);
    }
    (refined, kept)
}

fn pick(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter().map(|&row| values[row]).collect()
}

fn play(r: f64) -> Play {
    Play::new(r).unwrap()
}

fn stop(r: f64) -> Stop {
    Stop::new(r).unwrap()
}

fn deteriorating(r: f64, beta: f64) -> DeterioratingStop {
    DeterioratingStop::new(r, beta).unwrap()
}

fn relay(r: f64, s: f64) -> Relay {
    Relay::new(r, s).unwrap()
}

/// Operators whose memory is turning points, without rounding: laws of memory hold to the last bit.
fn exact_operators(r: f64, s: f64) -> [(&'static str, Box<dyn Operator>); 3] {
    [("play", Box::new(play(r))), ("stop", Box::new(stop(r))), ("relay", Box::new(relay(r, s)))]
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// `cycles` cycles of `amplitude sin`, from 0; with 4 dividing `samples`, peaks are hit exactly.
fn sine(amplitude: f64, samples: usize, cycles: usize) -> Vec<f64> {
    let phase = |k: usize| TAU * ((k % samples) as f64 / samples as f64);
    (0..=samples * cycles).map(|k| amplitude * sin(phase(k))).collect()
}

/// Area of the last cycle of `samples` samples, positive if work is done on the element.
fn loop_area(x: &[f64], y: &[f64], samples: usize) -> f64 {
    (x.len() - samples..x.len()).map(|k| (y[k] + y[k - 1]) / 2.0 * (x[k] - x[k - 1])).sum()
}

proptest! {
    #![proptest_config(few_repeatable_cases())]

    /// The stop from the play is the stop of the definition (1.3), which adds increments, within [-r, r].
    #[test]
    fn stop_follows_its_definition(x in path(), r in threshold()) {
        let output = stop(r).run(&x);
        let mut elongation = x[0].clamp(-r, r);
        assert_abs_diff_eq!(output[0], elongation, epsilon = 1e-15);
        for k in 1..x.len() {
            elongation = (elongation + x[k] - x[k - 1]).clamp(-r, r);
            assert_abs_diff_eq!(output[k], elongation, epsilon = 1e-13);
        }
        prop_assert!(output.iter().all(|y| y.abs() <= r + 1e-15));
    }

    /// Play and stop add up to the input (1.4), within rounding; a worn stop does not give its part back.
    #[test]
    fn play_and_stop_add_up_to_the_input(x in path(), r in threshold()) {
        let (p, e) = (play(r).run(&x), stop(r).run(&x));
        for k in 0..x.len() {
            let sum = p[k] + e[k];
            let rounding = f64::EPSILON / 2.0 * (e[k].abs() + sum.abs());
            prop_assert!((sum - x[k]).abs() <= rounding);
        }

        let mut worn = deteriorating(r, 5.0);
        let y = worn.run(&x);
        let slid_in_sight = worn.slip() > 0.01 && e[x.len() - 1].abs() > 0.01;
        prop_assert!(!slid_in_sight || largest_difference(&y, &e) > 1e-6);
    }

    /// `R_{s-r,s+r} = +1` if and only if `P_r > s`.
    #[test]
    fn relay_tells_on_which_side_of_it_the_play_is(
        x in path(), r in threshold(), s in -2.0..2.0f64,
    ) {
        let (outputs, plays) = (relay(r, s).run(&x), play(r).run(&x));
        for (output, p) in outputs.iter().zip(&plays) {
            // On the curve itself either answer would be right.
            if (p - s).abs() > 1e-12 {
                prop_assert_eq!(*output, (p - s).signum());
            }
        }
    }

    /// A stop of threshold r is a scaled stop of threshold 1 (1.12) that wears equally fast with the same β.
    #[test]
    fn scaling_of_input_and_threshold(
        x in path(), w in prop_oneof![-4.0..-0.3f64, 0.3..4.0f64], beta in 2.0..100.0f64,
    ) {
        let r: f64 = 1.0 / w.abs();
        let scaled: Vec<f64> = x.iter().map(|x| w * x).collect();
        let back = |y: Vec<f64>| y.iter().map(|y| y / w).collect::<Vec<_>>();
        prop_assert!(largest_difference(&play(r).run(&x), &back(play(1.0).run(&scaled))) < 1e-13);
        prop_assert!(largest_difference(&stop(r).run(&x), &back(stop(1.0).run(&scaled))) < 1e-13);

        let (mut of_x, mut of_scaled) = (deteriorating(r, beta), deteriorating(1.0, beta));
        let (y, y_scaled) = (of_x.run(&x), back(of_scaled.run(&scaled)));
        prop_assert!(largest_difference(&y, &y_scaled) < 1e-12);
        assert_abs_diff_eq!(of_x.slip(), of_scaled.slip() / w.abs(), epsilon = 1e-12);

        // With the capacity r β, a length, in place of β it would be wrong.
        let wrong = back(deteriorating(1.0, r * beta).run(&scaled));
        let alive_and_slid = !of_x.is_dead() && of_x.slip() > 0.1 && y[x.len() - 1].abs() > 0.01;
        let differs_in_scale = (r - 1.0).abs() > 0.1;
        prop_assert!(
            !(alive_and_slid && differs_in_scale) || largest_difference(&y, &wrong) > 1e-8
        );
    }

    /// Without deterioration a deteriorating stop is a stop, to the last bit.
    #[test]
    fn stop_that_never_deteriorates_is_a_stop(x in path(), r in threshold()) {
        let y = stop(r).run(&x);
        prop_assert_eq!(bits(&deteriorating(r, f64::INFINITY).run(&x)), bits(&y));

        let mut worn = deteriorating(r, 1e6);
        let differs = bits(&worn.run(&x)) != bits(&y);
        prop_assert!(differs || worn.slip() < 1e-3);
    }

    /// A record in two parts, with the state carried over, gives exactly the whole.
    #[test]
    fn splitting_changes_nothing(x in path(), r in threshold(), s in -2.0..2.0, at in 0usize..30) {
        let at = at.min(x.len());
        let worn = ("worn", Box::new(deteriorating(r, 5.0)) as Box<dyn Operator>);
        for (name, mut operator) in exact_operators(r, s).into_iter().chain([worn]) {
            let whole = operator.run(&x);
            let mut parts = operator.run(&x[..at]);
            parts.extend(x[at..].iter().map(|&x| operator.step(x)));
            prop_assert_eq!(bits(&parts), bits(&whole), "{}", name);
        }
    }
}

#[test]
fn virgin_relays_lie_above_and_below_the_demagnetised_curve() {
    assert_eq!(relay(1.0, 0.1).step(0.0), -1.0);
    assert_eq!(relay(1.0, -0.1).step(0.0), 1.0);
    assert_eq!(relay(1.0, 0.0).step(0.0), 1.0);
}

/// The record starts where it starts: the way there from 0 is not slid.
#[test]
fn jump_to_the_first_sample_costs_no_strength() {
    let mut worn = deteriorating(1.0, 10.0);
    assert_eq!(worn.step(5.0), 1.0);
    assert_eq!(worn.slip(), 0.0);
    worn.step(6.0);
    assert_eq!(worn.slip(), 1.0);

    worn.reset();
    assert_eq!((worn.step(-3.0), worn.slip()), (-1.0, 0.0));
}

proptest! {
    #![proptest_config(few_repeatable_cases())]

    /// Further points on monotone pieces and repeated points change no output at the original points.
    #[test]
    fn only_turning_points_count(
        x in path(), fractions in refinement(), waits in refinement(),
        r in threshold(), s in -2.0..2.0,
    ) {
        let (refined, kept) = refine(&x, &fractions);
        // Waiting: every point as often as the second refinement happens to say.
        let mut warped = Vec::new();
        let mut kept_in_warped = Vec::new();
        for (row, &x) in refined.iter().enumerate() {
            if kept.contains(&row) {
                kept_in_warped.push(warped.len());
            }
            warped.extend(vec![x; 1 + waits[row % waits.len()].len()]);
        }
        for (name, mut operator) in exact_operators(r, s) {
            let y = operator.run(&x);
            prop_assert_eq!(&pick(&operator.run(&refined), &kept), &y, "refined, {}", name);
            prop_assert_eq!(&pick(&operator.run(&warped), &kept_in_warped), &y, "warped, {}", name);
        }
        let mut worn = deteriorating(r, 5.0);
        let y = worn.run(&x);
        prop_assert!(largest_difference(&pick(&worn.run(&refined), &kept), &y) < 1e-13);
        prop_assert!(largest_difference(&pick(&worn.run(&warped), &kept_in_warped), &y) < 1e-13);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..few_repeatable_cases() })]

    /// A cycle of amplitude V > r encloses `4 r (V - r)` (1.7) and slips as much over r (1.8), `V - r` at first.
    #[test]
    fn area_and_slip_of_a_cycle(r in 0.1..2.0f64, excess in 0.01..1.5f64) {
        let (amplitude, samples) = (r + excess, 4000);
        let x = sine(amplitude, samples, 2);
        let mut element = deteriorating(r, f64::INFINITY);
        let mut slip_after = |samples: usize| {
            element.run(&x[..=samples]);
            element.slip()
        };
        let (peak, next_peak) = (samples / 4, samples / 4 + samples);
        assert_abs_diff_eq!(slip_after(peak), excess, epsilon = 1e-12);
        let of_a_cycle = slip_after(next_peak) - slip_after(peak);
        assert_abs_diff_eq!(of_a_cycle, 4.0 * excess, epsilon = 1e-11);

        // The trapezoidal rule cuts the two corners of the loop, each within one step.
        let step = TAU * amplitude / samples as f64;
        let area = loop_area(&x, &element.run(&x), samples);
        assert_abs_diff_eq!(area, 4.0 * r * excess, epsilon = step * step);
        assert_abs_diff_eq!(area, r * of_a_cycle, epsilon = step * step);
        prop_assert!(step * step < 0.02 * area, "tolerance {} for {}", step * step, area);
    }
}

/// A triangular wave of amplitude 2 from 0, `samples` samples a cycle.
fn triangle(samples: usize, cycles: usize) -> Vec<f64> {
    // Up to 1, down to -1 and back again, in quarters of a cycle.
    let wave = |quarters: f64| match quarters {
        ..=1.0 => quarters,
        ..=3.0 => 2.0 - quarters,
        _ => quarters - 4.0,
    };
    let sample = |k: usize| 2.0 * wave(4.0 * (k % samples) as f64 / samples as f64);
    (0..=samples * cycles).map(sample).collect()
}

/// The first sample at which the element is dead.
fn death(element: &mut DeterioratingStop, x: &[f64]) -> Option<usize> {
    element.reset();
    x.iter().position(|&x| {
        element.step(x);
        element.is_dead()
    })
}

/// The life under a sine of V = 1.42, r = 1, against (1.9) and against the exact instant of death.
#[test]
fn life_of_a_deteriorating_stop() {
    let (amplitude, r, samples) = (1.42, 1.0, 10_000);
    let excess = amplitude - r;
    let x = sine(amplitude, samples, 40);
    let mut lives = Vec::new();
    for beta in [25.0, 50.0] {
        let dead_at = death(&mut deteriorating(r, beta), &x).unwrap();
        let life = dead_at as f64 / samples as f64;
        let formula = 0.25 + (r * beta - excess) / (4.0 * excess);
        assert!((life - formula).abs() < 0.5, "{life}, by formula {formula}");

        // Peaks at 1/4, 3/4, ...: until the n-th (from 0), V - r (1 + 2 n) is slid. From a peak the
        // input runs back by 2 r without sliding; what is then missing is slid directly.
        let peaks = ((r * beta / excess - 1.0) / 2.0).floor();
        let missing = r * beta - excess * (1.0 + 2.0 * peaks);
        let phase = acos((amplitude - 2.0 * r - missing) / amplitude) / TAU;
        let exact = 0.25 + peaks / 2.0 + phase;
        assert_abs_diff_eq!(life, exact, epsilon = 1.1 / samples as f64);
        lives.push(life);
    }
    assert_abs_diff_eq!(lives[0], 15.1, epsilon = 0.05); // as simulated elsewhere, theory.md (1.9)
    let without_sliding = sine(0.99, samples, 40);
    assert_eq!(death(&mut deteriorating(r, 25.0), &without_sliding), None);
}

/// Where all arithmetic is exact, so is death. V = 2, r = 1, β = 16, steps of 1/4: slip 1 at the
/// first peak, 2 more at each following; 15 at the seventh after it (sample 8 + 7 · 16); then 2
/// without sliding and 1 with, 12 samples later.
#[test]
fn exact_death_under_a_triangular_wave() {
    let x = triangle(32, 6);
    let mut element = deteriorating(1.0, 16.0);
    assert_eq!(death(&mut element, &x), Some(132));
    assert_eq!(element.slip(), 16.0);

    let y = element.run(&x);
    assert_eq!(y[131].abs(), 1.0 / 64.0);
    assert!(y[132..].iter().all(|&y| y == 0.0));
    assert!(element.slip() > 16.0, "it goes on sliding");
    assert_eq!(death(&mut deteriorating(1.0, 16.25), &x), Some(133));
}

/// Non-uniform time steps, some of them 0.
fn time_steps() -> impl Strategy<Value = Vec<f64>> {
    vec(prop_oneof![9 => 1e-3..0.5, 1 => Just(0.0)], 1..100)
}

fn times(steps: &[f64]) -> Vec<f64> {
    let mut time = vec![0.0];
    for step in steps {
        time.push(time[time.len() - 1] + step);
    }
    time
}

/// The closed solution of (1.10) for an input that starts at `x0` and has slope `slopes[i].1` from
/// time `slopes[i].0` on: each change of slope `v` adds `v τ (1 - e^{-(t - t_i)/τ})`.
fn closed_solution(tau: f64, x0: f64, slopes: &[(f64, f64)], t: f64) -> f64 {
    let (mut stress, mut slope_before) = (x0 * exp(-t / tau), 0.0);
    for &(from, slope) in slopes.iter().filter(|(from, _)| *from <= t) {
        stress += (slope - slope_before) * tau * (1.0 - exp(-(t - from) / tau));
        slope_before = slope;
    }
    stress
}

/// The input of [`closed_solution`].
fn input(x0: f64, slopes: &[(f64, f64)], t: f64) -> f64 {
    let ends = slopes.iter().skip(1).map(|s| s.0).chain([f64::INFINITY]);
    let moved = |(&(from, slope), end): (&(f64, f64), f64)| slope * (t.min(end) - from).max(0.0);
    x0 + slopes.iter().zip(ends).map(moved).sum::<f64>()
}

proptest! {
    #![proptest_config(few_repeatable_cases())]

    /// Exact stepping (1.11) of a ramp, of a jump and hold, and of a triangle, at whatever times.
    #[test]
    fn relaxation_steps_exactly(
        steps in time_steps(), tau in 0.05..20.0f64, x0 in -2.0..2.0f64, slope in -3.0..3.0f64,
    ) {
        let mut element = Relaxation::new(tau).unwrap();
        let time = times(&steps);
        let corner = time[time.len() / 2];
        let inputs = [
            vec![(0.0, slope)],                     // ramp
            vec![(0.0, 0.0)],                       // jump to x0 and hold
            vec![(0.0, slope), (corner, -slope)],   // triangle
        ];
        for slopes in inputs {
            let x: Vec<f64> = time.iter().map(|&t| input(x0, &slopes, t)).collect();
            let stress = element.run(&time, &x).unwrap();
            for (stress, &t) in stress.iter().zip(&time) {
                let exact = closed_solution(tau, x0, &slopes, t);
                assert_abs_diff_eq!(*stress, exact, epsilon = 1e-12);
            }
        }
    }

    /// Further times on straight pieces change nothing.
    #[test]
    fn refining_the_time_grid_changes_nothing(
        x in path(), steps in vec(1e-3..0.5, 30), fractions in refinement(), tau in 0.05..20.0f64,
    ) {
        let time = times(&steps[..x.len() - 1]);
        let (fine_time, kept) = refine(&time, &fractions);
        let (fine_x, _) = refine(&x, &fractions);
        let mut element = Relaxation::new(tau).unwrap();
        let coarse = element.run(&time, &x).unwrap();
        let fine = element.run(&fine_time, &fine_x).unwrap();
        // `refine` clips input and time at the ends of a piece; between them rounding is all.
        prop_assert!(largest_difference(&pick(&fine, &kept), &coarse) < 1e-12);
    }

    /// `τ -> ∞` is a spring, `τ -> 0` a dashpot that feels the slope of the present piece.
    #[test]
    fn limits_of_the_relaxation_time(x in path(), steps in vec(0.1..0.5, 30)) {
        let time = times(&steps[..x.len() - 1]);
        let stress = |tau: f64| Relaxation::new(tau).unwrap().run(&time, &x).unwrap();
        prop_assert!(largest_difference(&stress(f64::INFINITY), &x) < 1e-13);
        prop_assert!(largest_difference(&stress(1e12), &x) < 1e-9);
        let small = x.iter().all(|x| x.abs() < 0.1);
        prop_assert!(small || largest_difference(&stress(10.0), &x) > 1e-4);

        let tau = 1e-3; // a hundredth of the shortest step, or less
        let stress = stress(tau);
        for k in 1..x.len() {
            let slope = (x[k] - x[k - 1]) / (time[k] - time[k - 1]);
            assert_abs_diff_eq!(stress[k], tau * slope, epsilon = 1e-12);
        }
    }
}

#[test]
fn decay_is_exact_at_zero_and_does_not_cancel() {
    assert_eq!(relaxation::decay(0.0, 1.0), (1.0, 1.0));
    assert_eq!(relaxation::decay(1.0, f64::INFINITY), (1.0, 1.0));
    assert_eq!(relaxation::decay(1e300, 1e-300), (0.0, 0.0));
    assert_eq!(relaxation::decay(f64::MIN_POSITIVE, 1e3), (1.0, 1.0));
    // Steps that are no durations are taken as jumps.
    assert_eq!(relaxation::decay(-1.0, 1.0), (1.0, 1.0));
    assert_eq!(relaxation::decay(f64::NAN, 1.0), (1.0, 1.0));

    let z: f64 = 1e-9;
    let series = 1.0 - z / 2.0 + z * z / 6.0;
    let (_, g) = relaxation::decay(z, 1.0);
    assert_relative_eq!(g, series, max_relative = 2.0 * f64::EPSILON);
    let naive = (1.0 - exp(-z)) / z;
    assert!((naive - series).abs() > 1e-9, "the naive form cancels");
    // Far out e^{-h/τ} keeps its digits, which 1 + (e^{-h/τ} - 1) would lose.
    let (e, g) = relaxation::decay(40.0, 1.0);
    assert_relative_eq!(e, 4.248354255291589e-18, max_relative = 1e-14);
    assert_relative_eq!(g, 1.0 / 40.0, max_relative = 1e-15);
}

#[test]
fn first_sample_of_a_relaxation_is_an_instantaneous_load() {
    let mut element = Relaxation::new(0.1).unwrap();
    assert_eq!(element.step(3.0, 123.0), 3.0);
    let jump = element.run(&[50.0, 50.0], &[2.0, -1.0]).unwrap();
    assert_eq!(jump, [2.0, -1.0]);
    assert!(element.run(&[], &[]).unwrap().is_empty());
    element.reset();
    assert_eq!(element, Relaxation::new(0.1).unwrap());
}

#[test]
fn times_that_are_none_are_refused_with_their_row() {
    let mut element = Relaxation::new(1.0).unwrap();
    element.run(&[0.0, 1.0], &[1.0, 2.0]).unwrap();
    let before = element.clone();
    for (time, message) in [
        (&[0.0, 1.0, 0.5, 0.2][..], "row 2: time 0.5 follows 1: times must not decrease"),
        (&[0.0, 1.0, f64::INFINITY, 2.0], "row 2: time inf: times must be finite"),
        (&[f64::NAN, 1.0, 2.0, 3.0], "row 0: time NaN: times must be finite"),
        (&[0.0], "1 times for 4 inputs: there must be one time for each input"),
    ] {
        let refusal = element.run(time, &[0.0; 4]).unwrap_err();
        assert_eq!(refusal.to_string(), message);
    }
    assert_eq!(element, before, "a refused run leaves the state alone");
}

#[test]
fn parameters_are_checked_and_the_message_has_value_and_rule() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let (zero, infinite) = (value == 0.0, value == f64::INFINITY);
        assert!(Stop::new(value).is_err(), "{value}");
        assert!(Relay::new(value, 0.0).is_err(), "{value}");
        assert!(DeterioratingStop::new(value, 1.0).is_err(), "{value}");
        assert_eq!(Play::new(value).is_ok(), zero, "{value}");
        assert_eq!(DeterioratingStop::new(1.0, value).is_ok(), infinite, "{value}");
        assert_eq!(Relaxation::new(value).is_ok(), infinite, "{value}");
        assert_eq!(Relay::new(1.0, value).is_ok(), value.is_finite(), "{value}");
    }
    assert_eq!(
        Stop::new(-2.5).unwrap_err().to_string(),
        "threshold r = -2.5: it must be finite and greater than 0"
    );
    assert_eq!(
        DeterioratingStop::new(1.0, 0.0).unwrap_err().to_string(),
        "capacity beta = 0: it must be greater than 0 (infinity: never deteriorates)"
    );
}

/// A sample that is no number: found in debug builds, without later consequences in release builds.
#[test]
#[cfg(not(debug_assertions))]
fn bad_samples_leave_no_trace() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let worn = ("worn", Box::new(deteriorating(0.5, 5.0)) as Box<dyn Operator>);
        for (name, mut operator) in exact_operators(0.5, 0.7).into_iter().chain([worn]) {
            let y = operator.run(&[0.0, 2.0, 1.0]);
            let disturbed = operator.run(&[bad, 0.0, 2.0, bad, 1.0]);
            assert!(disturbed[0].is_nan() && disturbed[3].is_nan(), "{name}");
            assert_eq!(pick(&disturbed, &[1, 2, 4]), y, "{name}, {bad}");
        }
        let mut element = Relaxation::new(1.0).unwrap();
        element.step(1.0, 0.0);
        let before = element.clone();
        assert!(element.step(bad, 1.0).is_nan());
        assert_eq!(element, before);
    }
}

#[test]
#[cfg(debug_assertions)]
#[should_panic(expected = "must be finite")]
fn bad_samples_are_found_in_debug_builds() {
    play(1.0).step(f64::NAN);
}
