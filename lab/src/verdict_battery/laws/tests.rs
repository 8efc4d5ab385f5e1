//! The laws against what is known of them exactly.

use std::f64::consts::PI;

use hysid_core::elementary::{exp, powi, sin, square};

use super::super::property::{OF_MEMBERS, PROPERTIES};
use super::*;

/// Runs a law through these inputs in short steps, half a unit of the input per second; the output at each of them.
fn visited(name: &str, turns: &[f64]) -> Vec<f64> {
    const STEPS: usize = 2000;
    let law = named(name);
    let mut specimen = (law.specimen)();
    let mut from = 0.0;
    specimen.advance(from, 0.0);
    let visit = |&to: &f64| {
        let (begin, seconds) = (from, 2.0 * (to - from).abs() / STEPS as f64);
        from = to;
        let step = |k| specimen.advance(begin + (to - begin) * k as f64 / STEPS as f64, seconds);
        (1..=STEPS).map(step).last().expect("there are steps")
    };
    turns.iter().map(visit).collect()
}

fn named(name: &str) -> Law {
    all().into_iter().find(|law| law.name == name).expect("the law is there")
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// Area of a loop between -1 and 1 at `cycles` sines per second, clockwise, after some loops.
fn area(law: &Law, cycles: f64) -> f64 {
    const ROWS: usize = 4000;
    let x = |k: usize| sin(2.0 * PI * k as f64 / ROWS as f64);
    let inputs: Vec<f64> = (0..=4 * ROWS).map(x).collect();
    let outputs = law.run(&inputs, (cycles * ROWS as f64).recip());
    let last = 3 * ROWS..4 * ROWS;
    last.map(|k| 0.5 * (outputs[k] + outputs[k + 1]) * (inputs[k + 1] - inputs[k])).sum()
}

#[test]
fn names_differ_and_answers_are_complete() {
    let laws = all();
    assert!(laws.len() >= 30, "{} laws", laws.len());
    for (k, law) in laws.iter().enumerate() {
        assert!(laws[..k].iter().all(|other| other.name != law.name), "{} twice", law.name);
        let letters: String = law.answers.chars().filter(|letter| *letter != ' ').collect();
        assert!([OF_MEMBERS, PROPERTIES.len()].contains(&letters.len()), "{}", law.name);
        assert!(letters.chars().all(|letter| "yn-".contains(letter)), "{}", law.name);
    }
}

#[test]
fn a_play_follows_at_its_half_width_and_a_stop_is_the_rest() {
    let turns = [1.0, 0.5, 0.2, -1.0, 0.4];
    let play = visited("play", &turns);
    let expected = [0.7, 0.7, 0.5, -0.7, 0.1];
    assert!(play.iter().zip(expected).all(|(a, b)| close(*a, b, 1e-12)), "{play:?}");
    let stop = visited("stop", &turns);
    for ((x, play), stop) in turns.iter().zip(&play).zip(&stop) {
        assert!(close(*stop, x - play, 1e-12));
    }
}

/// An excursion from 0.5 to 0 and back: `(before, after)`.
fn excursion(name: &str) -> (f64, f64) {
    let y = visited(name, &[1.0, -1.0, 0.5, 0.0, 0.5]);
    (y[2], y[4])
}

#[test]
fn memories_of_turning_points_close_an_excursion_and_differential_laws_leave_a_gap() {
    for name in
        ["play", "pi-stops", "gpi-asymmetric", "preisach-asymmetric", "preisach-moving", "ramberg-osgood"]
    {
        let (before, after) = excursion(name);
        assert!(close(before, after, 1e-9), "{name}: {before} {after}");
    }
    for name in ["bouc-wen-wide", "dahl", "coleman-hodgdon", "menegotto-pinto"] {
        let (before, after) = excursion(name);
        assert!(!close(before, after, 0.01), "{name}: {before} {after}");
    }
}

#[test]
fn bouc_wen_and_dahl_follow_their_exact_solutions() {
    // n = 1, loading from 0: z = z_u (1 - exp(-x/z_u)), with z_u = 1/3; beside it a spring of 0.1.
    let y = visited("bouc-wen-softening", &[0.4])[0];
    let exact = 0.04 + (1.0 - exp(-1.2)) / 3.0;
    assert!(close(y, exact, 1e-9), "{y} {exact}");
    let force = visited("dahl", &[0.3])[0];
    assert!(close(force, 1.0 - exp(-1.5), 1e-9), "{force}");
}

#[test]
fn friction_and_magnetization_follow_their_exact_solutions() {
    // Sliding at 0.5 per second: Stribeck's curve and the viscosity; no slope of the bristles is left.
    let force = visited("lugre", &[1.0])[0];
    let exact = 1.0 + 0.3 * exp(-1.0) + 0.15 * 0.5;
    assert!(close(force, exact, 1e-3), "{force} {exact}");
    // dy/dx = 3 (x - y) + 0.2 from 0.
    let y = visited("coleman-hodgdon", &[0.5])[0];
    let exact = 0.5 - 0.8 / 3.0 * (1.0 - exp(-1.5));
    assert!(close(y, exact, 1e-9), "{y} {exact}");
    // A settled loop is odd and stays below saturation.
    let m = visited("jiles-atherton", &[1.0, -1.0, 1.0, -1.0]);
    assert!(close(m[2], -m[3], 1e-3) && m[2] > 0.5 && m[2] < 1.0, "{m:?}");
}

#[test]
fn preisach_operators_span_the_same_whatever_came_before() {
    for name in ["preisach-symmetric", "preisach-asymmetric", "preisach-broad"] {
        let law = visited(name, &[1.0, -1.0, 0.2, -0.3, 0.2, 1.0, -0.3, 0.2, -0.3]);
        assert!(close(law[2] - law[3], law[7] - law[8], 1e-9), "{name}: {law:?}");
    }
    let y = visited("preisach-symmetric", &[1.0, -1.0]);
    assert!(close(y[0], -y[1], 1e-9) && y[0] > 0.95, "{y:?}");
}

#[test]
fn ramberg_osgoods_branches_are_its_curve_twice_as_large() {
    let y = visited("ramberg-osgood", &[0.3, 0.6, 0.0, 0.6]);
    let strain = |y: f64| y / 3.0 + powi(y, 4);
    assert!(close(strain(y[0]), 0.3, 1e-9) && close(strain(y[1]), 0.6, 1e-9), "{y:?}");
    assert!(close(y[1] - y[2], 2.0 * y[0], 1e-9), "{y:?}");
    assert!(close(y[3], y[1], 1e-9), "{y:?}");
}

#[test]
fn areas_of_viscous_loops_are_those_of_the_textbook() {
    for cycles in [0.05, 0.5] {
        let omega = 2.0 * PI * cycles;
        // π c ω, and π k ωτ/(1 + ω²τ²), for an amplitude of 1.
        let voigt = PI * 0.15 * omega;
        let relaxing = PI * omega * 0.15 / (1.0 + square(omega * 0.15));
        assert!(close(area(&named("kelvin-voigt"), cycles), voigt, 1e-3 * voigt));
        for name in ["maxwell", "standard-linear-solid"] {
            let area = area(&named(name), cycles);
            assert!(close(area, relaxing, 2e-3 * relaxing), "{name}: {area} {relaxing}");
        }
    }
}

#[test]
fn a_peak_oriented_law_aims_at_the_largest_deformation() {
    // Yields at 0.15 with 0.6, stiffness 4, hardening 0.15: the peak at 1 and its opposite at -1.
    let peak = 0.6 + 0.15 * 0.85;
    let y = visited("clough", &[1.0, -1.0, 1.0, 0.9, 1.0]);
    assert!(close(y[0], peak, 1e-9) && close(y[1], -peak, 1e-9) && close(y[2], peak, 1e-9), "{y:?}");
    assert!(close(y[3], peak - 0.4, 1e-9) && close(y[4], peak, 1e-9), "{y:?}");
}

#[test]
fn a_flag_has_two_plateaus_of_either_sign_and_no_remanence() {
    let y = visited("superelastic-flag", &[0.25, 1.0, 0.5, 0.0, -0.25, -1.0, 0.0]);
    let plateau = |start: f64, x: f64| start + 0.02 * (4.0 * x - start) / 4.02;
    assert!(close(y[0], 1.0, 1e-9) && close(y[1], plateau(1.2, 1.0), 1e-9), "{y:?}");
    assert!(close(y[2], plateau(0.5, 0.5), 1e-9) && close(y[3], 0.0, 1e-9), "{y:?}");
    assert!(close(y[4], -y[0], 1e-9) && close(y[5], -y[1], 1e-9) && close(y[6], 0.0, 1e-9), "{y:?}");
}

#[test]
fn worn_stops_lose_strength_and_sound_ones_do_not() {
    let loops = |name: &str| visited(name, &[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]);
    let worn = loops("deteriorating-stops");
    assert!(worn[6] < 0.9 * worn[0], "{worn:?}");
    let sound = loops("masing-iwan");
    assert!(close(sound[6], sound[0], 1e-12));
}
