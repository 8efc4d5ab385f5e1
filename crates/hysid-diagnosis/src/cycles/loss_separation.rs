//! Losses of magnets over peak flux density and frequency.
//!
//! ```text
//! W = k f^(α-1) B^β                              C. P. Steinmetz 1892: P = k f^α B^β
//! W = k_h B^β + k_e f B² + k_x √f B^1.5          G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630
//! ```
//!
//! `W` is the loss of a cycle, `B` half the range of the output in it. Both fits are of relative errors. The coefficients of
//! the second are not negative; its exponent is searched, and 2 where there is one amplitude.

use hysid_core::data::record::Dataset;
use hysid_core::elementary::{exp, ln, powf};

use super::igse::{Steinmetz, Waveform};
use super::least_squares::{LinearFit, fit};
use super::record_figure::{RecordFigure, RecordFigureKind, record_figures};
use super::row::CycleRow;

/// Ratio from which two amplitudes or frequencies are different.
const DIFFERENT: f64 = 1.05;

/// Exponents of the hysteresis loss that are searched, and the one of a single amplitude.
const EXPONENTS: (f64, f64) = (1.0, 4.0);
const OF_ONE_AMPLITUDE: f64 = 2.0;

/// An exponent this close to the end of those that are searched is at its bound.
const AT_BOUND: f64 = 1e-3;

/// Largest RMS error of a law that describes the losses.
const DESCRIBES: f64 = 0.1;

/// Halvings of the search of the exponent by golden section.
const STEPS: usize = 60;

record_figures! {
    COEFFICIENT: "steinmetz_coefficient", "Steinmetz coefficient", "k", Ratio, "C. P. Steinmetz, Trans. AIEE 9, 1892, 1-64";
    FREQUENCY: "steinmetz_frequency_exponent", "exponent of frequency", "α", Ratio, "C. P. Steinmetz, Trans. AIEE 9, 1892, 1-64";
    AMPLITUDE: "steinmetz_amplitude_exponent", "exponent of amplitude", "β", Ratio, "C. P. Steinmetz, Trans. AIEE 9, 1892, 1-64";
    STEINMETZ_ERROR: "steinmetz_error_percent", "RMS error of Steinmetz", "e_S", Percent, "C. P. Steinmetz, Trans. AIEE 9, 1892, 1-64";
    HYSTERESIS: "hysteresis_coefficient", "hysteresis loss, coefficient", "k_h", Ratio, "G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630";
    EXPONENT: "hysteresis_exponent", "hysteresis loss, exponent", "β_h", Ratio, "G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630";
    EDDY: "eddy_coefficient", "eddy-current loss, coefficient", "k_e", Ratio, "G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630";
    EXCESS: "excess_coefficient", "excess loss, coefficient", "k_x", Ratio, "G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630";
    SEPARATION_ERROR: "separation_error_percent", "RMS error of the separation", "e_B", Percent, "G. Bertotti, IEEE Trans. Magn. 24, 1988, 621-630";
}

/// Loss of a cycle.
#[derive(Debug, Clone, Copy)]
struct CycleLoss {
    amplitude: f64,
    frequency: f64,
    energy: f64,
}

/// The separated loss of a cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Separation {
    exponent: f64,
    coefficients: [f64; 3],
}

impl Separation {
    /// Hysteresis, eddy-current and excess loss of a cycle.
    pub fn parts(&self, amplitude: f64, frequency: f64) -> [f64; 3] {
        let terms = terms(self.exponent, amplitude, frequency);
        std::array::from_fn(|j| self.coefficients[j] * terms[j])
    }
}

fn terms(exponent: f64, amplitude: f64, frequency: f64) -> [f64; 3] {
    [powf(amplitude, exponent), frequency * amplitude * amplitude, frequency.sqrt() * powf(amplitude, 1.5)]
}

/// Laws of the losses.
#[derive(Debug, Default)]
pub(super) struct LossLaws {
    pub figures: Vec<RecordFigure>,
    pub steinmetz: Option<Steinmetz>,
    pub separation: Option<Separation>,
}

impl LossLaws {
    /// Finds the laws and gives each cycle the loss that they have for its waveform. `rate` is the number of units of time
    /// in that of the frequencies.
    pub fn read(data: &Dataset, cycles: &mut [CycleRow], rate: f64) -> Self {
        let record = |row: &CycleRow| data.records().iter().find(|record| record.name() == row.record);
        let waveforms: Vec<Option<Waveform>> =
            cycles.iter().map(|row| Waveform::of(record(row)?, row, rate)).collect();
        let laws = laws(cycles, &waveforms);
        for (row, waveform) in cycles.iter_mut().zip(&waveforms) {
            row.igse_energy =
                laws.steinmetz.as_ref().zip(waveform.as_ref()).map(|(law, wave)| wave.energy(law));
        }
        laws
    }
}

/// The laws of the losses of all records. `waveforms` are those of the cycles; if cycles of sines suffice for the Steinmetz
/// equation, it is theirs alone.
fn laws(rows: &[CycleRow], waveforms: &[Option<Waveform>]) -> LossLaws {
    let loss = |row: &CycleRow| {
        let (low, high) = row.output_min.zip(row.output_max)?;
        let loss =
            CycleLoss { amplitude: 0.5 * (high - low), frequency: row.frequency?, energy: row.energy? };
        (row.complete && loss.energy > 0.0 && loss.amplitude > 0.0 && loss.frequency > 0.0).then_some(loss)
    };
    let all: Vec<(CycleLoss, bool)> = rows
        .iter()
        .zip(waveforms)
        .filter_map(|(row, wave)| Some((loss(row)?, wave.as_ref().is_some_and(Waveform::is_sine))))
        .collect();
    let sines: Vec<CycleLoss> = all.iter().filter(|(_, is_sine)| *is_sine).map(|(loss, _)| *loss).collect();
    let of_sines = frequencies(&sines) > 1;
    let losses = if of_sines { sines } else { all.iter().map(|(loss, _)| *loss).collect() };
    if frequencies(&losses) < 2 {
        return LossLaws::default();
    }
    let amplitudes = different(losses.iter().map(|loss| loss.amplitude));
    let (mut figures, law) = steinmetz(&losses, amplitudes);
    let separated = match frequencies(&losses) {
        ..3 => Err("a separation needs three frequencies at least".to_string()),
        _ => separation(&losses, amplitudes),
    };
    let separation = match separated {
        Ok((own, separation)) => {
            figures.extend(own);
            Some(separation)
        }
        Err(why) => {
            figures.push(absent(HYSTERESIS, &why));
            None
        }
    };
    let is_first = |figure: &&mut RecordFigure| figure.kind == COEFFICIENT || figure.kind == HYSTERESIS;
    for figure in figures.iter_mut().filter(is_first).filter(|figure| !of_sines && figure.note.is_none()) {
        figure.note = Some("the flux density is no sine, which the law assumes".into());
    }
    LossLaws { figures, steinmetz: law.filter(|_| of_sines), separation }
}

/// Number of different frequencies.
fn frequencies(losses: &[CycleLoss]) -> usize {
    different(losses.iter().map(|loss| loss.frequency))
}

fn absent(kind: &'static RecordFigureKind, why: &str) -> RecordFigure {
    RecordFigure::new(("", ""), kind, None).with_note(why)
}

/// Number of different values.
fn different(values: impl Iterator<Item = f64>) -> usize {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let mut last = 0.0;
    sorted
        .into_iter()
        .filter(|value| {
            *value > DIFFERENT * last && {
                last = *value;
                true
            }
        })
        .count()
}

fn steinmetz(losses: &[CycleLoss], amplitudes: usize) -> (Vec<RecordFigure>, Option<Steinmetz>) {
    if amplitudes < 2 {
        return (vec![absent(COEFFICIENT, "the Steinmetz equation needs two amplitudes at least")], None);
    }
    let rows: Vec<[f64; 3]> =
        losses.iter().map(|loss| [1.0, ln(loss.frequency), ln(loss.amplitude)]).collect();
    let energies: Vec<f64> = losses.iter().map(|loss| ln(loss.energy)).collect();
    let Some(found) = fit(&rows, &energies) else {
        return (vec![absent(COEFFICIENT, "too few cycles for the Steinmetz equation")], None);
    };
    if found.rms > DESCRIBES {
        return (vec![absent(COEFFICIENT, &not_described(found.rms))], None);
    }
    let ([level, frequency, amplitude], deviations) = (found.coefficients, found.deviations);
    let of = |kind, value, deviation| {
        RecordFigure::new(("", ""), kind, value).with_interval(deviation, found.degrees)
    };
    let figures = vec![
        of(COEFFICIENT, exp(level), exp(level) * deviations[0]),
        of(FREQUENCY, frequency + 1.0, deviations[1]),
        of(AMPLITUDE, amplitude, deviations[2]),
        RecordFigure::new(("", ""), STEINMETZ_ERROR, 100.0 * found.rms),
    ];
    (figures, Some(Steinmetz::of_sine(exp(level), frequency + 1.0, amplitude)))
}

fn not_described(rms: f64) -> String {
    format!("the law does not describe the losses: its RMS error is {:.0} %", 100.0 * rms)
}

/// Relative terms of the losses in columns that are chosen.
fn relative<const N: usize>(losses: &[CycleLoss], exponent: f64, chosen: [usize; N]) -> Option<LinearFit<N>> {
    let row = |loss: &CycleLoss| {
        let terms = terms(exponent, loss.amplitude, loss.frequency);
        chosen.map(|j| terms[j] / loss.energy)
    };
    fit(&losses.iter().map(row).collect::<Vec<_>>(), &vec![1.0; losses.len()])
}

/// The coefficients of least squares that are not negative, and their RMS error.
fn not_negative(losses: &[CycleLoss], exponent: f64) -> Option<([f64; 3], f64)> {
    let mut found: Vec<([f64; 3], f64)> = Vec::new();
    let mut take = |chosen: &[usize], coefficients: &[f64], rms: f64| {
        if coefficients.iter().all(|value| *value >= 0.0) {
            let mut all = [0.0; 3];
            chosen.iter().zip(coefficients).for_each(|(&j, value)| all[j] = *value);
            found.push((all, rms));
        }
    };
    if let Some(fit) = relative(losses, exponent, [0, 1, 2]) {
        take(&[0, 1, 2], &fit.coefficients, fit.rms);
    }
    for chosen in [[0, 1], [0, 2], [1, 2]] {
        if let Some(fit) = relative(losses, exponent, chosen) {
            take(&chosen, &fit.coefficients, fit.rms);
        }
    }
    for chosen in 0..3 {
        if let Some(fit) = relative(losses, exponent, [chosen]) {
            take(&[chosen], &fit.coefficients, fit.rms);
        }
    }
    found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The separation and its figures, or why there is none.
fn separation(losses: &[CycleLoss], amplitudes: usize) -> Result<(Vec<RecordFigure>, Separation), String> {
    let is_searched = amplitudes > 1;
    let exponent = if is_searched { best_exponent(losses) } else { OF_ONE_AMPLITUDE };
    let found = not_negative(losses, exponent);
    let (coefficients, rms) = found.ok_or("too few cycles for a separation")?;
    if rms > DESCRIBES {
        return Err(not_described(rms));
    }
    let is_at_bound = [EXPONENTS.0, EXPONENTS.1].iter().any(|bound| (exponent - bound).abs() < AT_BOUND);
    if is_at_bound && coefficients[0] > 0.0 {
        return Err(format!("the exponent of the hysteresis loss is at its bound {exponent:.0}"));
    }
    // Derivatives for the deviations: the three terms and that of the exponent.
    let row = |loss: &CycleLoss| {
        let [h, e, x] = terms(exponent, loss.amplitude, loss.frequency);
        [h, e, x, coefficients[0] * h * ln(loss.amplitude)].map(|term| term / loss.energy)
    };
    let rows: Vec<[f64; 4]> = losses.iter().map(row).collect();
    let explained = |row: &[f64; 4]| 1.0 - (0..3).map(|j| coefficients[j] * row[j]).sum::<f64>();
    let rest: Vec<f64> = rows.iter().map(explained).collect();
    let spread = match is_searched {
        true => fit(&rows, &rest).map(|fit| (fit.deviations.to_vec(), fit.degrees)),
        false => {
            let three: Vec<[f64; 3]> = rows.iter().map(|[h, e, x, _]| [*h, *e, *x]).collect();
            fit(&three, &rest).map(|fit| (fit.deviations.to_vec(), fit.degrees))
        }
    };
    let of = |kind, place: usize, value: f64| {
        let figure = RecordFigure::new(("", ""), kind, value);
        match &spread {
            _ if value == 0.0 => figure.with_note("0 is its bound: the losses do not show it"),
            Some((deviations, degrees)) if place < deviations.len() => {
                figure.with_interval(deviations[place], *degrees)
            }
            _ => figure,
        }
    };
    let mut hysteresis = of(EXPONENT, 3, exponent);
    if !is_searched {
        hysteresis = hysteresis.with_note("assumed, because there is one amplitude");
    }
    let figures = vec![
        of(HYSTERESIS, 0, coefficients[0]),
        hysteresis,
        of(EDDY, 1, coefficients[1]),
        of(EXCESS, 2, coefficients[2]),
        RecordFigure::new(("", ""), SEPARATION_ERROR, 100.0 * rms),
    ];
    Ok((figures, Separation { exponent, coefficients }))
}

/// The exponent with the smallest error, by golden section.
fn best_exponent(losses: &[CycleLoss]) -> f64 {
    let error = |exponent| not_negative(losses, exponent).map_or(f64::INFINITY, |(_, rms)| rms);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = EXPONENTS;
    for _ in 0..STEPS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if error(a) <= error(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}
