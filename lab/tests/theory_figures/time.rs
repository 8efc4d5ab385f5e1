//! Rate dependence, and what a prediction band means.

use hysid_core::data::record::Record;
use hysid_core::elementary::sin;
use hysid_core::model::Model;
use hysid_core::operator::Relaxation;
use hysid_document::chart::{Chart, Colour, Curve};

use super::{Points, chart, line, loops, path, sum_of_stops};

/// A spring beside a relaxation element, at three frequencies, in the steady state.
pub fn rate() -> Vec<Chart> {
    let tau = 1.0;
    let rows = 120;
    let periods = 8;
    let curves = [0.1, 1.0, 10.0].iter().enumerate().map(|(series, omega)| {
        let phase = |k: usize| std::f64::consts::TAU * k as f64 / rows as f64;
        let time: Vec<f64> = (0..=periods * rows).map(|k| phase(k) / omega).collect();
        let x: Vec<f64> = (0..=periods * rows).map(|k| sin(phase(k))).collect();
        let stress = Relaxation::new(tau).unwrap().run(&time, &x).unwrap();
        let y: Vec<f64> = x.iter().zip(stress).map(|(x, stress)| 0.5 * x + stress).collect();
        line(&loops(&x, &y)[(periods - 1) * rows..], Colour::Series(series))
    });
    let legend = [(0, "ωτ = 0.1"), (1, "ωτ = 1"), (2, "ωτ = 10")];
    let legend = legend.map(|(series, name)| (Colour::Series(series), name));
    let relaxing = chart("relaxation", "input x", "output y", curves.collect());
    let x = path(&[1.0, -1.0, 1.0]);
    let same = line(&loops(&x, &sum_of_stops(&x))[path(&[1.0]).len() - 1..], Colour::Simulated);
    vec![
        relaxing.with_legend(legend),
        chart("sum of stops, at any frequency", "input x", "output y", vec![same]),
    ]
}

/// An ensemble of three laws that agree within the trained range and differ outside it, with a band of its file.
pub fn band() -> Vec<Chart> {
    let model = Model::from_json(include_str!("ensemble.json")).unwrap();
    let rows = 400;
    let x: Vec<f64> = (0..rows)
        .map(|k| {
            let phase = f64::from(k) / 30.0;
            (0.4 + 1.2 * f64::from(k) / f64::from(rows)) * sin(phase)
        })
        .collect();
    let record = Record::new("drive", vec![x.clone()], vec![f64::NAN; x.len()]).unwrap();
    let prediction = model.predict(&record.excitation(), 0.9).unwrap();
    let over_rows = |y: &[f64]| -> Points { y.iter().enumerate().map(|(k, y)| (k as f64, *y)).collect() };
    let mut outline = over_rows(&prediction.high);
    outline.extend(over_rows(&prediction.low).into_iter().rev());
    let area = || Curve::new(outline.clone(), Colour::Band, 0.0);
    let legend = [(Colour::Simulated, "output"), (Colour::Band, "band of 90 %")];
    let output = || Curve::new(over_rows(&prediction.output), Colour::Simulated, 1.6);
    let half: Points = prediction
        .high
        .iter()
        .zip(&prediction.low)
        .enumerate()
        .map(|(k, (h, l))| (k as f64, (h - l) / 2.0))
        .collect();
    vec![
        chart("output and band", "row k", "output y", vec![area(), output()]).with_legend(legend),
        chart(
            "half width of the band",
            "row k",
            "q(p) √(f² + d²)",
            vec![Curve::new(half, Colour::Error, 1.6)],
        ),
    ]
}
