//! The network family against theory.md section 2: a scalar reference that is written here from the
//! equations, and laws that hold whatever the parameters.

use crate::gradient::run;
use crate::scaffold::*;
use hysid::operator::Relaxation;
use hysid_core::elementary::{exp, tanh};

/// Every family; one and three inputs, rate and time on and off where the family has them.
fn architectures(sizes: Sizes) -> Vec<Architecture> {
    let mut all = Vec::new();
    for family in Family::ALL {
        let inputs: &[usize] = if family.takes_further_inputs() { &[1, 3] } else { &[1] };
        for &inputs in inputs {
            for (rate, time) in [(false, false), (false, true), (true, true)] {
                let architecture = Architecture::new(family, sizes, inputs, rate, time).unwrap();
                if !all.contains(&architecture) {
                    all.push(architecture);
                }
            }
        }
    }
    all
}

fn odd_architectures() -> Vec<Architecture> {
    [(1, 1), (7, 2), (8, 5), (9, 1), (17, 5)]
        .into_iter()
        .flat_map(|(stops, hidden)| architectures(Sizes { stops, hidden, relaxation: 2 }))
        .collect()
}

/// Parameters of ordinary size; some stops slip, some die.
fn ordinary(a: Architecture, generator: &mut Generator) -> Network {
    let layout = ParameterLayout::new(a);
    let parameters = (0..layout.len())
        .map(|k| {
            if layout.ln_beta.contains(&k) {
                between(generator, 2.0, 6.0)
            } else if layout.ln_tau.contains(&k) {
                between(generator, -2.0, 3.0)
            } else if layout.stop_weights.contains(&k) {
                between(generator, -6.0, 6.0)
            } else {
                between(generator, -1.0, 1.0)
            }
        })
        .collect();
    let output = (0..a.output_weights()).map(|_| between(generator, -1.0, 1.0)).collect();
    Network::new(a, parameters, output).unwrap()
}

/// A path with many turning points that starts with a jump, and uneven time steps.
fn drive(a: &Architecture, rows: usize, generator: &mut Generator) -> NetworkDrive {
    let mut channel = || {
        let mut x = between(generator, 0.3, 0.9);
        let mut column = Vec::new();
        while column.len() < rows {
            let (to, steps) = (between(generator, -1.0, 1.0), 1 + (generator.random::<u64>() % 9) as usize);
            let from = x;
            for k in 1..=steps {
                column.push(x);
                x = from + (to - from) * k as f64 / steps as f64;
            }
        }
        column.truncate(rows);
        column
    };
    let channels = (0..a.channels()).map(|_| channel()).collect();
    let steps = (0..rows).map(|k| if k == 0 { 0.0 } else { between(generator, 0.01, 0.5) });
    NetworkDrive { channels, steps: if a.relaxation > 0 { steps.collect() } else { Vec::new() } }
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().chain(b).fold(1e-300, |most: f64, y| most.max(y.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// theory.md (2.2) to (2.6), one sample and one neuron at a time.
fn reference(network: &Network, drive: &NetworkDrive) -> Vec<f64> {
    let a = network.architecture();
    let mut parameters = network.parameters().iter().copied();
    let mut take = |count: usize| parameters.by_ref().take(count).collect::<Vec<f64>>();
    let weights: Vec<Vec<f64>> = (0..a.stops).map(|_| take(a.channels())).collect();
    let ln_beta = take(if a.deterioration { a.stops } else { 0 });
    let linear = take(if a.linear { a.channels() } else { 0 });
    let ln_tau = take(a.relaxation * a.inputs);
    let memory = usize::from(a.linear) + a.stops + a.relaxation * a.inputs;
    let hidden: Vec<Vec<f64>> = (0..a.hidden).map(|_| take(1 + memory)).collect();
    assert!(take(1).is_empty());

    let mut stops: Vec<DeterioratingStop> = (0..a.stops)
        .map(|j| {
            let beta = ln_beta.get(j).map_or(f64::INFINITY, |ln_beta| exp(*ln_beta));
            DeterioratingStop::new(1.0, beta).unwrap()
        })
        .collect();
    let mut relaxing: Vec<Relaxation> =
        ln_tau.iter().map(|ln_tau| Relaxation::new(exp(*ln_tau)).unwrap()).collect();

    (0..drive.len())
        .map(|k| {
            let u: Vec<f64> = drive.channels.iter().map(|channel| channel[k]).collect();
            let dot = |w: &[f64]| w.iter().zip(&u).map(|(w, u)| w * u).sum::<f64>();
            let mut z = Vec::new();
            if a.linear {
                z.push(dot(&linear));
            }
            z.extend(stops.iter_mut().zip(&weights).map(|(stop, w)| stop.step(dot(w))));
            for (m, element) in relaxing.iter_mut().enumerate() {
                let input = m / a.relaxation;
                let channel = if input > 0 && a.rate { input + 1 } else { input };
                z.push(element.step(u[channel], drive.steps[k]));
            }
            let h: Vec<f64> = hidden
                .iter()
                .map(|neuron| tanh(neuron[0] + neuron[1..].iter().zip(&z).map(|(u, z)| u * z).sum::<f64>()))
                .collect();
            let mut summed = if a.constant { vec![1.0] } else { Vec::new() };
            summed.extend(&h);
            if a.direct || a.hidden == 0 {
                summed.extend(&z);
            }
            network.output().iter().zip(&summed).map(|(c, value)| c * value).sum()
        })
        .collect()
}

#[test]
fn every_family_agrees_with_the_scalar_reference() {
    let mut generator = Generator::seed_from_u64(1);
    for a in odd_architectures() {
        let network = ordinary(a, &mut generator);
        let drive = drive(&a, 300, &mut generator);
        let error = difference(&run(&network, &drive), &reference(&network, &drive));
        assert!(error < 1e-12, "{error} for {a:?}");
    }
}

#[test]
fn steps_and_runs_however_split_agree_to_the_last_bit() {
    let mut generator = Generator::seed_from_u64(2);
    let (mut tried, mut remembering) = (0, 0);
    for a in odd_architectures() {
        let network = ordinary(a, &mut generator);
        let drive = drive(&a, 400, &mut generator);
        let whole = run(&network, &drive);

        let mut simulator = network.simulator();
        let stepped: Vec<f64> = (0..drive.len())
            .map(|k| {
                let u: Vec<f64> = drive.channels.iter().map(|channel| channel[k]).collect();
                simulator.step(&u, drive.steps.get(k).copied().unwrap_or(0.0))
            })
            .collect();
        assert_eq!(bits(&whole), bits(&stepped), "{a:?}");

        let random: Vec<usize> = (0..40).map(|_| (generator.random::<u64>() % 70) as usize).collect();
        for pieces in [vec![1], vec![63], vec![64], vec![65], vec![7, 0, 130, 64], random] {
            let mut pieced = Vec::new();
            let mut simulator = network.simulator();
            for &length in pieces.iter().cycle() {
                let start = pieced.len();
                let end = drive.len().min(start + length);
                let u: Vec<&[f64]> = drive.channels.iter().map(|channel| &channel[start..end]).collect();
                let steps = if a.relaxation > 0 { &drive.steps[start..end] } else { &[] };
                let mut y = vec![0.0; end - start];
                simulator.run(&u, steps, &mut y);
                pieced.extend(y);
                // A fresh simulator that takes the state over goes on as the old one would.
                let state = simulator.state().clone();
                simulator = network.simulator();
                simulator.set_state(state);
                if pieced.len() == drive.len() {
                    break;
                }
            }
            assert_eq!(bits(&whole), bits(&pieced), "{a:?} in pieces of {pieces:?}");
        }

        // The state matters: without it the second half is another one (unless all is wiped out).
        let half = NetworkDrive {
            channels: drive.channels.iter().map(|channel| channel[200..].to_vec()).collect(),
            steps: drive.steps.iter().skip(200).copied().collect(),
        };
        tried += 1;
        remembering += usize::from(difference(&run(&network, &half), &whole[200..]) > 1e-6);
        simulator.reset();
        assert_eq!(simulator.state(), network.simulator().state());
    }
    assert!(remembering > 3 * tried / 4, "{remembering} of {tried}");
}

#[test]
fn a_network_gives_its_parameters_back_and_refuses_others() {
    let mut generator = Generator::seed_from_u64(3);
    for a in odd_architectures() {
        let network = ordinary(a, &mut generator);
        let (parameters, output) = (network.parameters().to_vec(), network.output().to_vec());
        assert_eq!(Network::new(a, parameters.clone(), output.clone()).unwrap(), network);
        assert_eq!(parameters.len(), a.searched_parameters());

        let refused = |parameters: &[f64], output: &[f64]| {
            Network::new(a, parameters.to_vec(), output.to_vec()).is_err()
        };
        assert!(!refused(&parameters, &output));
        assert!(refused(&parameters[1..], &output));
        assert!(refused(&[&parameters[..], &[0.0]].concat(), &output));
        assert!(refused(&parameters, &output[1..]));
        assert!(refused(&parameters, &[&output[..], &[0.0]].concat()));
        let layout = ParameterLayout::new(a);
        for k in 0..layout.len() {
            let (low, high) = layout.bounds(k);
            let with = |value: f64| {
                let mut changed = parameters.clone();
                changed[k] = value;
                changed
            };
            for value in [f64::NAN, f64::INFINITY, -f64::INFINITY, low - 0.01 * low.abs(), high * 1.01] {
                assert!(refused(&with(value), &output), "{} = {value}", layout.names()[k]);
            }
            assert!(!refused(&with(low), &output) && !refused(&with(high), &output));
        }
        for k in 0..output.len() {
            for value in [f64::NAN, f64::INFINITY, -1.1e50, 1.1e50] {
                let mut changed = output.clone();
                changed[k] = value;
                assert!(refused(&parameters, &changed));
            }
        }
    }
}

/// Invariant 3. Most of these runs would overflow at the first stop if the input were not limited.
#[test]
fn a_free_run_is_finite_whatever_parameters_and_input() {
    let wild = [1e300, -1e300, 0.0, 1.0, f64::MAX, -f64::MAX, 1e-300, -1e50, 1e50, 1e17, -3.0, 5e-324];
    let mut generator = Generator::seed_from_u64(4);
    let (mut runs, mut overflows) = (0, 0);
    for a in odd_architectures() {
        let layout = ParameterLayout::new(a);
        for round in 0..6 {
            // In turn: at a bound, anywhere between, either.
            let mut place = || match round % 3 {
                0 => generator.random::<f64>().round(),
                1 => generator.random::<f64>(),
                _ => (3.0 * generator.random::<f64>() - 1.0).clamp(0.0, 1.0),
            };
            let parameters = (0..layout.len())
                .map(|k| {
                    let (low, high) = layout.bounds(k);
                    (low + (high - low) * place()).clamp(low, high)
                })
                .collect();
            let output = (0..a.output_weights()).map(|_| 1e50 * (2.0 * place() - 1.0)).collect();
            let network = Network::new(a, parameters, output).unwrap();
            let mut pick = || wild[(generator.random::<u64>() % wild.len() as u64) as usize];
            let column = |pick: &mut dyn FnMut() -> f64| {
                (0..200).map(|k| if k < 100 { pick() } else { wild[k % 2] }).collect::<Vec<f64>>()
            };
            let channels: Vec<Vec<f64>> = (0..a.channels()).map(|_| column(&mut pick)).collect();
            let steps: Vec<f64> = (0..200).map(|k| if k == 0 { 0.0 } else { pick().abs() }).collect();
            let drive = NetworkDrive { channels, steps: if a.relaxation > 0 { steps } else { Vec::new() } };
            let y = run(&network, &drive);
            assert!(y.iter().all(|y| y.is_finite()), "{a:?}, round {round}");
            runs += 1;
            let weights = &network.parameters()[..a.channels()];
            let v = |k: usize| weights.iter().zip(&drive.channels).map(|(w, u)| w * u[k]).sum::<f64>();
            overflows += usize::from((0..200).any(|k| !v(k).is_finite()));
        }
    }
    assert!(overflows > runs / 2, "{overflows} of {runs} inputs were wild");
}
