use std::f64::consts::TAU;

use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::elementary::{atan2, cos, exp, hypot, sin, sin_cos, square};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

mod of_model;

/// Time between rows: 500 Hz.
const STEP: f64 = 0.002;

/// 20 Hz, 4 % of critical damping.
fn oscillator() -> LinearOscillator {
    LinearOscillator {
        natural_frequency: 20.0,
        damping_ratio: 0.04,
        gain: 3.0,
        direct: 0.2,
        offset: 1.5,
        compared: ComparedSignal::Output,
        residual: 0.0,
    }
}

/// `K (1 - q² + 2 ζ q i)^-1`, real and imaginary part, worked out apart from the code under test.
fn through(frequency: f64) -> (f64, f64) {
    let (q, zeta) = (frequency / 20.0, 0.04);
    let (a, b) = (1.0 - q * q, 2.0 * zeta * q);
    let (amplification, lag) = (3.0 / (a * a + b * b).sqrt(), atan2(b, a));
    (amplification * cos(lag), -amplification * sin(lag))
}

/// Magnitude and phase for samples with straight lines between them: sines of amplitude `sinc²(f T)` at the frequency, and
/// at those that differ from it by multiples of the sampling rate, which samples cannot distinguish.
fn exact(frequency: f64) -> (f64, f64) {
    let (mut real, mut imaginary) = (0.2, 0.0);
    for multiple in -30..=30 {
        let image = frequency + f64::from(multiple) / STEP;
        let angle = std::f64::consts::PI * image * STEP;
        let line = square(sin(angle) / angle);
        let (of_real, of_imaginary) = through(image);
        real += line * of_real;
        imaginary += line * of_imaginary;
    }
    (hypot(real, imaginary), atan2(imaginary, real).to_degrees())
}

/// The output of the oscillator for an input that is a straight line between rows, from rest at the first: the exact
/// solution, row by row, through the matrix exponential of the linear system as a power series.
fn motion(input: &[f64]) -> Vec<f64> {
    let LinearOscillator { natural_frequency, damping_ratio, gain, direct, offset, .. } = oscillator();
    let omega = TAU * natural_frequency;
    // z'' + 2 ζ ω z' + ω² z = ω² u with u' constant: the states z, z', u, u'.
    let system = [
        [0.0, 1.0, 0.0, 0.0],
        [-omega * omega, -2.0 * damping_ratio * omega, omega * omega, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 0.0],
    ];
    let step = exponential(system.map(|row| row.map(|value| STEP * value)));
    let (mut z, mut v) = (input[0], 0.0);
    let mut output = Vec::with_capacity(input.len());
    for row in 0..input.len() {
        output.push(gain * z + direct * input[row] + offset);
        let next = input.get(row + 1).copied().unwrap_or(input[row]);
        let state = [z, v, input[row], (next - input[row]) / STEP];
        let product = |row: [f64; 4]| row.iter().zip(state).map(|(a, b)| a * b).sum::<f64>();
        (z, v) = (product(step[0]), product(step[1]));
    }
    output
}

fn exponential(matrix: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let one: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    let (mut sum, mut term) = (one, one);
    for k in 1..30 {
        term = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..4).map(|l| term[i][l] * matrix[l][j]).sum::<f64>() / f64::from(k))
        });
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    sum
}

fn noise(rows: usize, seed: u64) -> Vec<f64> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    // Twelve even numbers are as good as normal.
    (0..rows).map(|_| (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0).collect()
}

/// Noise of some Hertz: white noise through two first-order lags of 40 Hz.
fn coloured(rows: usize, seed: u64) -> Vec<f64> {
    let share = 1.0 - exp(-TAU * 40.0 * STEP);
    let (mut first, mut second) = (0.0, 0.0);
    let follow = |x: f64| {
        first += share * (x - first);
        second += share * (first - second);
        second
    };
    noise(rows, seed).into_iter().map(follow).collect()
}

/// Sines from 2 to 80 Hz, one each 0.5 Hz: a period of 1000 rows.
fn multisine(rows: usize) -> Vec<f64> {
    let sine = |line: f64, row: usize| cos(TAU * line * (row % 1000) as f64 / 1000.0 + 2.4 * line * line);
    (0..rows).map(|row| (4..=160).map(|line| sine(f64::from(line), row)).sum::<f64>()).collect()
}

fn dataset(records: Vec<(Vec<f64>, Vec<f64>)>) -> Dataset {
    let names = ColumnNames::of(Some("t_s"), &["F_N"], "y_m");
    let record = |(number, (input, output)): (usize, (Vec<f64>, Vec<f64>))| {
        let time = (0..input.len()).map(|row| 3.0 + STEP * row as f64).collect();
        Record::new(format!("r{number}"), vec![input], output).unwrap().with_time(time).unwrap()
    };
    Dataset::new(names, records.into_iter().enumerate().map(record).collect()).unwrap()
}

fn moved(input: &[f64]) -> (Vec<f64>, Vec<f64>) {
    (input.to_vec(), motion(input))
}

#[test]
fn a_multisine_gives_the_exact_response_at_its_lines() {
    // The transient fades by e^(-ζ ω t): to 4e-5 after the first period of 2 s.
    let data = dataset(vec![moved(&multisine(4300))]);
    let segments = Segments::of(&data, None).unwrap();
    assert_eq!((segments.window(), segments.length(), segments.count()), (Window::WholePeriods, 1000, 3));
    assert!((segments.distance() - 0.5).abs() < 1e-9);
    let response = segments.measured(&data, 0.0);
    assert_eq!(response.points.len(), 157);
    for (point, line) in response.points.iter().zip(4..) {
        assert!((point.frequency - 0.5 * f64::from(line)).abs() < 1e-9, "{point:?}");
        let (magnitude, phase) = exact(point.frequency);
        let (real, imaginary) = (magnitude * cos(phase.to_radians()), magnitude * sin(phase.to_radians()));
        let distance = hypot(point.real - real, point.imaginary - imaginary);
        assert!(distance < 1e-4 * magnitude + 1e-5, "{point:?} {magnitude} {phase}");
        assert!(point.coherence.unwrap() > 1.0 - 1e-6, "{point:?}");
    }
}

#[test]
fn the_response_of_an_oscillator_is_its_closed_form() {
    let frequencies = [0.0, 1.0, 19.9, 20.0, 20.1, 300.0];
    let response = FrequencyResponse::of_oscillator(&oscillator(), frequencies.into_iter());
    for (point, frequency) in response.points.iter().zip(frequencies) {
        let (real, imaginary) = through(frequency);
        assert!(hypot(point.real - 0.2 - real, point.imaginary - imaginary) < 1e-12, "{point:?}");
    }
    assert!((response.points[3].imaginary + 3.0 / 0.08).abs() < 1e-9, "K/(2 ζ) at the natural frequency");
}

#[test]
fn noise_gives_the_response_within_its_resolution() {
    let data = dataset(vec![moved(&coloured(30_000, 1)), moved(&coloured(20_000, 2))]);
    let segments = Segments::of(&data, Some(resolution(&oscillator()))).unwrap();
    // The bandwidth is 1.6 Hz, an eighth of it 0.2 Hz: 2500 rows, rounded up.
    assert_eq!((segments.window(), segments.length()), (Window::Hann, 4096));
    let response = segments.measured(&data, resolution(&oscillator()));
    let peak = response.peak(ComparedSignal::Output).unwrap();
    assert!((peak.frequency - 20.0).abs() < 0.3, "{peak:?}");
    let mut compared = 0;
    for point in response.points.iter().filter(|point| (1.0..60.0).contains(&point.frequency)) {
        let (magnitude, phase) = exact(point.frequency);
        // Leakage: less than 1 % where the response changes little; a resolution of 0.18 Hz lowers a peak with a bandwidth
        // of 1.6 Hz.
        let tolerance = if (point.frequency - 20.0).abs() < 2.0 { 0.05 } else { 0.02 };
        assert!((point.magnitude() / magnitude - 1.0).abs() < tolerance, "{point:?} {magnitude}");
        assert!((point.phase() - phase).abs() < 4.0, "{point:?} {phase}");
        assert!(point.coherence.unwrap() > 0.97, "{point:?}");
        compared += 1;
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn noise_of_the_output_lowers_the_coherence_by_its_share() {
    let (input, output) = moved(&coloured(50_000, 3));
    let disturbed: Vec<f64> = output.iter().zip(noise(50_000, 4)).map(|(y, e)| y + 0.1 * e).collect();
    let [clean, disturbed] = [output, disturbed].map(|output| {
        let data = dataset(vec![(input.clone(), output)]);
        Segments::of(&data, Some(resolution(&oscillator()))).unwrap().measured(&data, 0.2)
    });
    // Above the resonance the noise is not much smaller than the motion. With the power spectra S of the input and E of the
    // noise, both per row, the coherence is |H|² S/(|H|² S + E).
    let band = |point: &&ResponsePoint| (40.0..60.0).contains(&point.frequency);
    let mean = |response: &FrequencyResponse| {
        let coherences: Vec<f64> =
            response.points.iter().filter(band).map(|point| point.coherence.unwrap()).collect();
        coherences.iter().sum::<f64>() / coherences.len() as f64
    };
    let share = 1.0 - exp(-TAU * 40.0 * STEP);
    let expected = |point: &ResponsePoint| {
        let (sine, cosine) = sin_cos(TAU * point.frequency * STEP);
        let filter = share * share / (square(1.0 - (1.0 - share) * cosine) + square((1.0 - share) * sine));
        let (real, imaginary) = (point.real, point.imaginary);
        let power = (real * real + imaginary * imaginary) * filter * filter;
        power / (power + 0.01)
    };
    let exact: Vec<f64> = clean.points.iter().filter(band).map(expected).collect();
    let exact = exact.iter().sum::<f64>() / exact.len() as f64;
    assert!(mean(&clean) > 0.99, "{}", mean(&clean));
    // 24 segments raise a coherence by (1 - γ²)²/24 on average.
    assert!((mean(&disturbed) - exact).abs() < 0.05 && exact < 0.8, "{} {exact}", mean(&disturbed));
}

#[test]
fn a_delay_turns_the_phase_and_nothing_else() {
    // Five rows, under noise and under a multisine.
    let late = |input: &[f64]| [&input[input.len() - 5..], &input[..input.len() - 5]].concat();
    for (input, tolerance) in [(multisine(3000), 1e-9), (coloured(40_000, 5), 0.01)] {
        let data = dataset(vec![(input.clone(), late(&input))]);
        let response = Segments::of(&data, None).unwrap().measured(&data, 0.0);
        let phases = response.phases(None);
        assert!(response.points.len() > 100);
        for (point, phase) in response.points.iter().zip(phases) {
            let exact = -360.0 * point.frequency * 5.0 * STEP;
            assert!((point.magnitude() - 1.0).abs() < 2.0 * tolerance, "{point:?}");
            assert!((phase - exact).abs() < 360.0 * tolerance, "{point:?} {phase} {exact}");
        }
    }
}

#[test]
fn phases_do_not_jump_where_an_oscillator_turns() {
    for gain in [3.0, -3.0] {
        let oscillator = LinearOscillator { gain, direct: 0.0, damping_ratio: 1e-4, ..oscillator() };
        let frequencies = (1..400).map(|k| 0.1 * f64::from(k));
        let mut response = FrequencyResponse::of_oscillator(&oscillator, frequencies);
        // Rounding and noise make the phase beyond the resonance 180 degrees as often as -180.
        for (k, point) in response.points.iter_mut().enumerate() {
            point.imaginary += if k % 2 == 0 { 1e-3 } else { -1e-3 };
        }
        let first = if gain > 0.0 { 0.0 } else { 180.0 };
        for (point, phase) in response.points.iter().zip(response.phases(Some(&oscillator))) {
            let exact = if point.frequency < 20.0 { first } else { first - 180.0 };
            let at_resonance = (point.frequency - 20.0).abs() < 0.2;
            assert!(at_resonance || (phase - exact).abs() < 2.0, "{point:?} {phase} {exact}");
        }
    }
}

#[test]
fn segments_without_output_are_left_out() {
    let (input, mut output) = moved(&multisine(6000));
    let whole = dataset(vec![(input.clone(), output.clone())]);
    let expected = Segments::of(&whole, None).unwrap().measured(&whole, 0.0);
    // One of the periods 1 to 5 has a row without output; what is there would change everything.
    output[2500] = f64::NAN;
    output[..300].fill(f64::NAN);
    let data = dataset(vec![(input.clone(), output.clone())]);
    let segments = Segments::of(&data, None).unwrap();
    assert_eq!(segments.count(), 4);
    let response = segments.measured(&data, 0.0);
    assert_eq!(response.points.len(), expected.points.len());
    for (a, b) in response.points.iter().zip(&expected.points) {
        assert!(hypot(a.real - b.real, a.imaginary - b.imaginary) < 1e-4 * b.magnitude(), "{a:?} {b:?}");
    }
    // Every second row has none: no segment is left.
    output.iter_mut().step_by(2).for_each(|y| *y = f64::NAN);
    assert_eq!(Segments::of(&dataset(vec![(input, output)]), None), Err(NoResponse::TooFewRows));
}

#[test]
fn frequencies_without_input_are_left_out() {
    let sines = |row: usize| sin(TAU * 0.05 * row as f64) + cos(TAU * 0.1 * row as f64);
    let input: Vec<f64> = (0..4000).map(sines).collect();
    let output: Vec<f64> = input.iter().zip(noise(4000, 6)).map(|(x, e)| 2.0 * x + 0.01 * e).collect();
    let data = dataset(vec![(input, output)]);
    let response = Segments::of(&data, None).unwrap().measured(&data, 0.0);
    let found: Vec<f64> = response.points.iter().map(|point| point.frequency).collect();
    assert!(
        found.len() == 2 && (found[0] - 25.0).abs() < 1e-9 && (found[1] - 50.0).abs() < 1e-9,
        "{found:?}"
    );
    assert!(response.peak(ComparedSignal::Output).is_none());
}

/// Steps such as those of a structure that yields, each much larger than the motion at the resonance.
#[test]
fn the_resonance_of_an_output_that_drifts_is_that_of_its_changes() {
    let input = coloured(30_000, 8);
    let mut drift = 0.0;
    let steps = noise(30_000, 9).into_iter().map(|e| {
        drift += if e > 3.3 { 30.0 } else { 0.0 };
        drift
    });
    let output: Vec<f64> = motion(&input).iter().zip(steps).map(|(y, drift)| y + drift).collect();
    let data = dataset(vec![(input, output)]);
    let response = Segments::of(&data, Some(resolution(&oscillator()))).unwrap().measured(&data, 0.2);
    let largest = response.points.iter().map(ResponsePoint::magnitude).fold(0.0, f64::max);
    let peak = response.peak(ComparedSignal::Changes).unwrap();
    assert!((peak.frequency - 20.0).abs() < 0.5 && peak.magnitude() < largest, "{peak:?} {largest}");
}

#[test]
fn data_without_a_response_say_why() {
    let (input, output) = moved(&coloured(4000, 7));
    let of = |data: &Dataset| Segments::of(data, None).unwrap_err();
    assert_eq!(of(&dataset(vec![(vec![2.0; 4000], output.clone())])), NoResponse::Constant);
    assert_eq!(of(&dataset(vec![(input.clone(), vec![0.0; 4000])])), NoResponse::Constant);
    assert_eq!(of(&dataset(vec![(input.clone(), vec![f64::NAN; 4000])])), NoResponse::TooFewRows);
    assert_eq!(of(&dataset(vec![(vec![1.0], vec![1.0])])), NoResponse::TooFewRows);
    assert_eq!(of(&dataset(vec![(input[..200].to_vec(), output[..200].to_vec())])), NoResponse::TooFewRows);
    assert_eq!(of(&Dataset::from_slices(&input, &output).unwrap()), NoResponse::NoTime);
    let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(2) };
    let two = Record::new("r", vec![input.clone(), output.clone()], output.clone()).unwrap();
    let two = two.with_time((0..4000).map(f64::from).collect()).unwrap();
    assert_eq!(of(&Dataset::new(names, vec![two]).unwrap()), NoResponse::SeveralInputs);
    let timed = |step: f64, late: f64| {
        let time = (0..4000).map(|row| step * f64::from(row) + if row == 700 { late } else { 0.0 });
        Record::new("slow", vec![input.clone()], output.clone()).unwrap().with_time(time.collect()).unwrap()
    };
    let names = || ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
    let with = |records: Vec<Record>| Dataset::new(names(), records).unwrap();
    assert_eq!(of(&with(vec![timed(1.0, 0.002)])), NoResponse::UnevenTime("slow".into()));
    assert_eq!(of(&with(vec![timed(1.0, 0.0), timed(1.1, 0.0)])), NoResponse::OtherStep("slow".into()));
    // Time stamps that were rounded.
    assert!(Segments::of(&with(vec![timed(1.0, 0.0005), timed(1.0, 0.0)]), None).is_ok());
}

#[test]
fn large_and_small_values_have_a_response() {
    let (input, output) = moved(&multisine(3000));
    for scale in [1e90, 1e-90] {
        let of = |values: &[f64]| values.iter().map(|value| scale * value).collect::<Vec<f64>>();
        let data = dataset(vec![(of(&input), output.clone())]);
        let peak =
            Segments::of(&data, None).unwrap().measured(&data, 0.0).peak(ComparedSignal::Output).unwrap();
        assert!(
            (peak.frequency - 20.0).abs() < 0.6 && (peak.magnitude() * scale / 37.0 - 1.0).abs() < 0.1,
            "{peak:?}"
        );
    }
}
