//! Laws that are made of stops: forces of friction and plasticity.

use hysid_core::elementary::exp;

use super::elements::Stop;
use super::{Law, Specimen};

/// Parallel stops beside a spring and a dashpot, each of the stops worn by its slip: `y = k x + c x' + Σ k_i s_i`.
/// Iwan, Journal of Applied Mechanics 33 (1966) 893.
struct Parallel {
    /// Stops with their thresholds, stiffnesses and slips.
    stops: Vec<(Stop, f64, f64, f64)>,
    spring: f64,
    dashpot: f64,
    /// Slip after which the loss of strength is 1/e of what can be lost; none without wear.
    wear: Option<f64>,
    before: f64,
}

/// What wear leaves of the strength in the end.
const WORN: f64 = 0.3;

impl Parallel {
    /// Stops with thresholds evenly spaced up to `widest` and equal stiffnesses that sum to 1.
    fn even(count: usize, widest: f64) -> Self {
        let threshold = |k: usize| widest * (k + 1) as f64 / count as f64;
        let stop = |k: usize| (Stop::default(), threshold(k), (count as f64).recip(), 0.0);
        Self { stops: (0..count).map(stop).collect(), spring: 0.0, dashpot: 0.0, wear: None, before: 0.0 }
    }
}

impl Specimen for Parallel {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        let mut force = self.spring * x;
        if seconds > 0.0 {
            force += self.dashpot * (x - self.before) / seconds;
        }
        self.before = x;
        for (stop, threshold, stiffness, slip) in &mut self.stops {
            let left = self.wear.map_or(1.0, |wear| WORN + (1.0 - WORN) * exp(-*slip / wear));
            let (value, slipped) = stop.advance(x, *threshold * left);
            *slip += slipped;
            force += *stiffness * value;
        }
        force
    }
}

/// A stop in series with a spring: the spring takes `F/c` of the way. The stop has stiffness 1.
struct Series {
    slider: f64,
    spring: f64,
    strength: f64,
}

impl Specimen for Series {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let stiffness = self.spring / (1.0 + self.spring);
        let force = (stiffness * (x - self.slider)).clamp(-self.strength, self.strength);
        self.slider = x - force / stiffness;
        force
    }
}

/// Superelastic shape-memory alloy in one dimension: `y = E (x - e)`, transformation strain `e` between the plateaus
/// `u + h e` and `l + h e` of either sign. Auricchio & Sacco, International Journal of Non-Linear Mechanics 32
/// (1997) 1101.
struct Flag {
    strain: f64,
}

impl Flag {
    const STIFFNESS: f64 = 4.0;
    const UPPER: f64 = 1.2;
    const LOWER: f64 = 0.5;
    const HARDENING: f64 = 0.02;
}

impl Specimen for Flag {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let (e, k) = (Self::STIFFNESS, Self::STIFFNESS + Self::HARDENING);
        let sign = if x < 0.0 { -1.0 } else { 1.0 };
        let way = sign * x;
        // Between what the upper plateau enforces and what the lower one leaves.
        let least = ((e * way - Self::UPPER) / k).max(0.0);
        let most = ((e * way - Self::LOWER) / k).max(0.0);
        self.strain = sign * (sign * self.strain).clamp(least, most);
        e * (x - self.strain)
    }
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "stop",
            answers: "y y n  y y y  y y  n y  n n",
            why: "elastic and perfectly plastic: x minus a play",
            specimen: || Box::new(Parallel::even(1, 0.3)),
        },
        Law {
            name: "stop-and-spring-in-series",
            answers: "y y n  y y y  y y  n y",
            why: "equal to a softer stop",
            specimen: || Box::new(Series { slider: 0.0, spring: 2.0, strength: 0.25 }),
        },
        Law {
            name: "pi-stops",
            answers: "y y n  y y y  y n  n y",
            why: "stops beside a spring that carries a third of the stiffness to the end",
            specimen: || Box::new(Parallel { spring: 0.5, ..Parallel::even(10, 0.6) }),
        },
        Law {
            name: "masing-iwan",
            answers: "y y n  y y y  y y  n y  n n",
            why: "forty stops, all of which slip before a large branch ends",
            specimen: || Box::new(Parallel::even(40, 0.7)),
        },
        Law {
            name: "deteriorating-stops",
            answers: "y y n  n n n  - -  y n",
            why: "the strength falls with the slip, so nothing is repeated exactly",
            specimen: || Box::new(Parallel { wear: Some(12.0), ..Parallel::even(6, 0.4) }),
        },
        Law {
            name: "pi-dashpot",
            answers: "y y y  - - -  y -  n y",
            why: "a dashpot adds a force that grows with the speed; the stops remain at rest",
            specimen: || Box::new(Parallel { spring: 0.3, dashpot: 0.06, ..Parallel::even(8, 0.4) }),
        },
        Law {
            name: "superelastic-flag",
            answers: "y y n  y y n  y y  n y",
            why: "two generalized plays, one of either sign: a Preisach operator with two different envelopes",
            specimen: || Box::new(Flag { strain: 0.0 }),
        },
    ]
}
