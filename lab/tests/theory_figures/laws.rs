//! Classical laws: a play between envelopes, and degradation with pinching.

use hysid_core::law::bouc_wen::BoucWen;
use hysid_core::law::bouc_wen::Degradation;
use hysid_core::law::generalized_prandtl_ishlinskii::{Envelope, follow};
use hysid_core::law::{Law, Sample};
use hysid_document::chart::{Chart, Colour, Curve};

use super::{chart, label, line, loops, path};

pub fn generalized_play() -> Vec<Chart> {
    let (left, right, r) = (Envelope::new([1.0, 1.6, -0.9, 0.0]), Envelope::new([0.8, 1.1, 0.7, 0.25]), 0.1);
    let x = path(&[2.0, -2.0, 0.9, -0.4, 2.0, -2.0]);
    let mut play = left.value(-2.0) - r;
    let y: Vec<f64> = x
        .iter()
        .map(|x| {
            play = follow(play, left.value(*x), right.value(*x), r);
            play
        })
        .collect();
    // From the first large turning point on.
    let first = path(&[2.0]).len() - 1;
    let span: Vec<f64> = (-100..=100).map(|k| 0.02 * f64::from(k)).collect();
    let edge = |envelope: &Envelope, shift: f64, colour: Colour| {
        let points: Vec<_> = span.iter().map(|x| (*x, envelope.value(*x) + shift)).collect();
        Curve { width: 5.0, ..line(&points, colour) }
    };
    let curves = vec![
        edge(&left, -r, Colour::Faint),
        edge(&right, r, Colour::Faint),
        line(&loops(&x, &y)[first..], Colour::Simulated),
    ];
    let chart = chart("generalized play", "input x", "play S", curves);
    let labels =
        vec![label((0.55, -0.25), 0.0, "γ_l(x) - r, up"), label((-1.95, 0.75), 0.0, "γ_r(x) + r, down")];
    vec![Chart { labels, ..chart }]
}

/// The same cycles of a Bouc-Wen law without and with degradation.
pub fn pinching() -> Vec<Chart> {
    let x = path(&[1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 3.0, -3.0, 3.0, -3.0]);
    let plain = BoucWen::new(0.06, 1.0, 0.8).unwrap();
    let degradation = Degradation::from_values([0.0, 0.015, 0.05, 0.92, 0.25, 0.05, 0.35, 0.006, 0.2]);
    let drawn = |title: &str, law: BoucWen| {
        let mut state = law.virgin();
        let step = |&x: &f64| law.step(&mut state, Sample { x, rate: 0.0, step: 0.0 });
        let y: Vec<f64> = x.iter().map(step).collect();
        let curve = Curve { width: 1.6, ..line(&loops(&x, &y), Colour::Simulated) };
        chart(title, "displacement x", "force y", vec![curve])
    };
    vec![
        drawn("Bouc-Wen", plain),
        drawn("with degradation and pinching", BoucWen { degradation: Some(degradation), ..plain }),
    ]
}
