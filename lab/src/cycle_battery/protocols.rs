//! Protocols, as their standards write them: the amplitudes of the cycles in order, as shares of the largest.

use std::f64::consts::TAU;

use hysid_core::elementary::sin;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::laws::Law;

/// Order of the cycles of a test.
pub struct Protocol {
    pub name: &'static str,
    /// Amplitude and number of cycles.
    pub steps: &'static [(f64, usize)],
    pub wave: Wave,
    /// True if each cycle repeats the one before and the record begins in the middle of such cycles.
    pub is_steady: bool,
    /// Where in its first cycle the record begins: 0 at rest, 0.25 at the peak.
    pub phase: f64,
    /// Load about which the cycles are, as a share of the largest amplitude: the record first goes there.
    pub load: f64,
}

/// Course of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wave {
    /// A sine: all cycles have as many rows.
    Sine,
    /// Straight lines at one speed: a cycle has rows in proportion to its amplitude, twelve at least.
    Lines,
    /// A sine and a fifth of its fifth harmonic.
    Rippled,
}

const fn growing(name: &'static str, wave: Wave, steps: &'static [(f64, usize)]) -> Protocol {
    Protocol { name, steps, wave, is_steady: false, phase: 0.0, load: 0.0 }
}

const fn steady(name: &'static str, wave: Wave, cycles: &'static [(f64, usize)], phase: f64) -> Protocol {
    Protocol { name, steps: cycles, wave, is_steady: true, phase, load: 0.0 }
}

const fn loaded(name: &'static str, wave: Wave, steps: &'static [(f64, usize)]) -> Protocol {
    Protocol { name, steps, wave, is_steady: false, phase: 0.0, load: 0.4 }
}

const ISO: &[(f64, usize)] = &[
    (0.0125, 1),
    (0.025, 1),
    (0.05, 1),
    (0.075, 1),
    (0.1, 1),
    (0.2, 3),
    (0.4, 3),
    (0.6, 3),
    (0.8, 3),
    (1.0, 3),
];
const ACI: &[(f64, usize)] = &[
    (0.057, 3),
    (0.02, 1),
    (0.071, 3),
    (0.024, 1),
    (0.1, 3),
    (0.033, 1),
    (0.143, 3),
    (0.05, 1),
    (0.21, 3),
    (0.07, 1),
    (0.286, 3),
    (0.1, 1),
    (0.4, 3),
    (0.13, 1),
    (0.5, 3),
    (0.17, 1),
    (0.63, 3),
    (0.21, 1),
    (0.79, 3),
    (0.26, 1),
    (1.0, 3),
];
const ATC: &[(f64, usize)] = &[
    (0.02, 6),
    (0.03, 3),
    (0.04, 3),
    (0.05, 3),
    (0.1, 3),
    (0.15, 3),
    (0.2, 3),
    (0.3, 2),
    (0.4, 2),
    (0.6, 2),
    (1.0, 2),
];
const CUREE: &[(f64, usize)] = &[
    (0.025, 6),
    (0.0375, 1),
    (0.028, 6),
    (0.05, 1),
    (0.0375, 6),
    (0.1, 1),
    (0.075, 3),
    (0.15, 1),
    (0.1125, 3),
    (0.2, 1),
    (0.15, 2),
    (0.35, 1),
    (0.2625, 2),
    (0.5, 1),
    (0.375, 2),
    (0.75, 1),
    (0.5625, 2),
    (1.0, 1),
    (0.75, 2),
];
const FEMA: &[(f64, usize)] = &[
    (0.048, 2),
    (0.068, 2),
    (0.095, 2),
    (0.133, 2),
    (0.186, 2),
    (0.26, 2),
    (0.364, 2),
    (0.51, 2),
    (0.714, 2),
    (1.0, 2),
];
const ASTM: &[(f64, usize)] = &[
    (0.0625, 3),
    (0.125, 3),
    (0.1875, 3),
    (0.25, 1),
    (0.1875, 1),
    (0.125, 1),
    (0.0625, 1),
    (0.25, 3),
    (0.5, 1),
    (0.375, 1),
    (0.25, 1),
    (0.125, 1),
    (0.5, 3),
    (0.75, 1),
    (0.5625, 1),
    (0.375, 1),
    (0.1875, 1),
    (0.75, 3),
    (1.0, 1),
    (0.75, 1),
    (0.5, 1),
    (0.25, 1),
    (1.0, 3),
];
const SPIRAL: &[(f64, usize)] =
    &[(1.0, 1), (0.9, 1), (0.8, 1), (0.7, 1), (0.6, 1), (0.5, 1), (0.4, 1), (0.3, 1), (0.2, 1), (0.1, 1)];
const EACH: &[(f64, usize)] = &[(0.2, 1), (0.4, 1), (0.6, 1), (0.8, 1), (1.0, 1)];
const THRICE: &[(f64, usize)] = &[(0.25, 3), (0.5, 3), (1.0, 3)];
const NESTED: &[(f64, usize)] = &[(1.0, 1), (0.5, 2), (0.25, 2), (1.0, 1), (0.1, 3)];

/// All protocols.
pub const PROTOCOLS: &[Protocol] = &[
    growing("ISO 16670", Wave::Lines, ISO),
    growing("ISO 16670, sine", Wave::Sine, ISO),
    growing("ACI 374.1", Wave::Lines, ACI),
    growing("ATC-24", Wave::Lines, ATC),
    growing("CUREE", Wave::Lines, CUREE),
    growing("CUREE, sine", Wave::Sine, CUREE),
    growing("FEMA 461", Wave::Lines, FEMA),
    growing("ASTM E2126", Wave::Lines, ASTM),
    growing("spiral inwards", Wave::Lines, SPIRAL),
    growing("nested loops", Wave::Sine, NESTED),
    loaded("about a static load", Wave::Lines, EACH),
    loaded("about a static load, sine", Wave::Sine, THRICE),
    growing("one cycle from rest", Wave::Lines, &[(1.0, 1)]),
    steady("one loop from its tip", Wave::Lines, &[(1.0, 1)], 0.25),
    steady("one loop from its other tip", Wave::Sine, &[(1.0, 1)], 0.75),
    steady("one period from 0", Wave::Sine, &[(1.0, 1)], 0.0),
    steady("one period from a tenth", Wave::Sine, &[(1.0, 1)], 0.1),
    steady("one period from four tenths", Wave::Sine, &[(1.0, 1)], 0.4),
    steady("one period from nine tenths", Wave::Lines, &[(1.0, 1)], 0.9),
    steady("two periods from 0", Wave::Sine, &[(1.0, 2)], 0.0),
    steady("five periods from two tenths", Wave::Sine, &[(1.0, 5)], 0.2),
    steady("three periods from the tip", Wave::Lines, &[(1.0, 3)], 0.25),
    steady("ripples, one period", Wave::Rippled, &[(1.0, 1)], 0.0),
    steady("ripples, three periods", Wave::Rippled, &[(1.0, 3)], 0.0),
];

/// What a measurement adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    None,
    OutputNoise1,
    OutputNoise3,
    BothNoise1,
    BothNoise3,
    Drift,
    Offset,
    Holds,
}

impl Disturbance {
    /// All disturbances.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::OutputNoise1,
        Self::OutputNoise3,
        Self::BothNoise1,
        Self::BothNoise3,
        Self::Drift,
        Self::Offset,
        Self::Holds,
    ];

    /// In a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::OutputNoise1 => "noise 1 %",
            Self::OutputNoise3 => "noise 3 %",
            Self::BothNoise1 => "noise 1 % in both",
            Self::BothNoise3 => "noise 3 % in both",
            Self::Drift => "drift 2 %",
            Self::Offset => "offset 2 %",
            Self::Holds => "holds with wobble",
        }
    }

    /// Noise of input and output, as shares of half their ranges.
    fn noise(self) -> (f64, f64) {
        match self {
            Self::OutputNoise1 => (0.0, 0.01),
            Self::OutputNoise3 => (0.0, 0.03),
            Self::BothNoise1 => (0.01, 0.01),
            Self::BothNoise3 => (0.03, 0.03),
            _ => (0.0, 0.0),
        }
    }
}

/// A cycle of the protocol and the figures of its loop.
#[derive(Debug, Clone)]
pub struct TrueCycle {
    pub amplitude: f64,
    pub energy: f64,
    pub coercive: Option<f64>,
    /// Area of the box around the loop.
    pub box_area: f64,
}

/// A record and what is true of it.
pub struct Trial {
    pub names: [&'static str; 2],
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub cycles: Vec<TrueCycle>,
    /// Deviations of the noise of input and output, in their units.
    pub noise: (f64, f64),
    /// Rows of the shortest cycle.
    pub fewest_rows: usize,
}

/// Scale of the input.
const UNIT: f64 = 100.0;

impl Trial {
    /// Runs a law through a protocol.
    pub fn new(protocol: &Protocol, law: Law, rows: usize, disturbance: Disturbance) -> Self {
        let amplitudes: Vec<f64> =
            protocol.steps.iter().flat_map(|&(amplitude, count)| vec![amplitude; count]).collect();
        let wave = |phase: f64| match protocol.wave {
            Wave::Sine => sin(TAU * phase),
            Wave::Lines => {
                let phase = phase.rem_euclid(1.0);
                if phase < 0.25 {
                    4.0 * phase
                } else if phase < 0.75 {
                    2.0 - 4.0 * phase
                } else {
                    4.0 * phase - 4.0
                }
            }
            Wave::Rippled => (sin(TAU * phase) + 0.25 * sin(5.0 * TAU * phase)) / 1.037,
        };
        let mut state = law.begin();
        if protocol.is_steady {
            // Two periods and the part before the first row.
            let before = 2000.0 * (2.0 + protocol.phase);
            (0..before as usize).for_each(|row| {
                state.to(wave(row as f64 / 2000.0));
            });
        }
        let load = protocol.load;
        let way = (load * rows as f64 / 4.0).ceil() as usize;
        let mut x: Vec<f64> = Vec::new();
        if load > 0.0 {
            x.extend((0..=way).map(|row| load * row as f64 / way as f64));
        }
        let mut bounds = vec![x.len().saturating_sub(1)];
        for &amplitude in &amplitudes {
            let count = match protocol.wave {
                Wave::Lines => ((rows as f64 * amplitude / 4.0).ceil() as usize * 4).max(12),
                _ => rows,
            };
            let begin = if x.is_empty() { 0 } else { 1 };
            x.extend(
                (begin..=count)
                    .map(|row| load + amplitude * wave(protocol.phase + row as f64 / count as f64)),
            );
            bounds.push(x.len() - 1);
        }
        let y: Vec<f64> = x.iter().map(|x| state.to(*x)).collect();
        let x: Vec<f64> = x.into_iter().map(|x| UNIT * x).collect();
        let is_magnet = law == Law::Magnet;
        let cycles =
            bounds.windows(2).map(|pair| of_loop(&x[pair[0]..=pair[1]], &y[pair[0]..=pair[1]], is_magnet));
        let cycles: Vec<TrueCycle> = cycles.collect();
        let fewest_rows = bounds.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(0);
        let height = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let (share_x, share_y) = disturbance.noise();
        let noise = (share_x * UNIT, share_y * height);
        let mut trial = Self { names: law.names(), x, y, cycles, noise, fewest_rows };
        trial.disturb(disturbance, height);
        trial
    }

    fn disturb(&mut self, disturbance: Disturbance, height: f64) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(self.x.len() as u64);
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let count = self.x.len() as f64;
        match disturbance {
            Disturbance::Drift => {
                let moved = |(row, y): (usize, &mut f64)| *y += 0.02 * height * row as f64 / count;
                self.y.iter_mut().enumerate().for_each(moved);
            }
            Disturbance::Offset => self.y.iter_mut().for_each(|y| *y += 0.02 * height),
            Disturbance::Holds => {
                // The actuator holds at each fifth row near a peak, and wanders by 0.3 % of the amplitude there.
                let (mut x, mut y) = (Vec::new(), Vec::new());
                for row in 0..self.x.len() {
                    x.push(self.x[row]);
                    y.push(self.y[row]);
                    let turns = row > 0
                        && row + 1 < self.x.len()
                        && (self.x[row] - self.x[row - 1]) * (self.x[row + 1] - self.x[row]) < 0.0;
                    if turns {
                        x.extend([0.997, 0.999, 0.998].map(|share| share * self.x[row]));
                        y.extend([self.y[row]; 3]);
                    }
                }
                (self.x, self.y) = (x, y);
            }
            _ => {
                let (of_x, of_y) = self.noise;
                self.x.iter_mut().for_each(|x| *x += of_x * normal());
                self.y.iter_mut().for_each(|y| *y += of_y * normal());
            }
        }
    }
}

/// Figures of the rows of a cycle: the area by the trapezoidal rule, closed by a straight line.
fn of_loop(x: &[f64], y: &[f64], is_magnet: bool) -> TrueCycle {
    let mut area = 0.0;
    for row in 0..x.len() {
        let next = (row + 1) % x.len();
        area += 0.5 * (y[row] + y[next]) * (x[next] - x[row]);
    }
    let ends = |values: &[f64]| values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    let ((low, high), (bottom, top)) = (ends(x), ends(y));
    // Both branches around the loop: passings of 0 between the furthest inputs.
    let row_of = |value: f64| x.iter().position(|x| *x == value).unwrap_or(0);
    let passing = |from: usize, to: usize| {
        let count = x.len() - 1;
        let way = (0..=(to + count - from) % count).map(|step| (from + step) % count);
        let rows: Vec<usize> = way.collect();
        rows.windows(2).find(|pair| y[pair[0]] * y[pair[1]] <= 0.0).map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            x[a] + (x[b] - x[a]) * y[a] / (y[a] - y[b])
        })
    };
    let (peak, valley) = (row_of(high), row_of(low));
    let coercive = passing(peak, valley).zip(passing(valley, peak)).map(|(down, up)| 0.5 * (up - down).abs());
    TrueCycle {
        amplitude: 0.5 * (high - low),
        energy: if is_magnet { -area } else { area },
        coercive: coercive.filter(|_| is_magnet),
        box_area: (high - low) * (top - bottom),
    }
}
