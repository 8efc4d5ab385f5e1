//! Laws that are made of plays: their outputs lag behind the input.

use hysid_core::elementary::{exp, ln, tanh};

use super::elements::{Play, Plays};
use super::{Law, Specimen};

/// A single play with a transmission. Brokate & Sprekels (1996), section 2.3.
struct Backlash {
    play: Play,
    half_width: f64,
    ratio: f64,
}

impl Specimen for Backlash {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        self.ratio * self.play.advance(x, self.half_width)
    }
}

/// A function of a sum of plays of a function of the input. Kuhnen, European Journal of Control 9 (2003) 407, for the
/// function of the output; Al Janaideh, Rakheja & Su, IEEE/ASME Transactions on Mechatronics 16 (2011) 734, for that of
/// the input.
struct Superposition {
    plays: Plays,
    of_input: fn(f64) -> f64,
    of_output: fn(f64) -> f64,
}

impl Specimen for Superposition {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        (self.of_output)(self.plays.advance((self.of_input)(x), 0.0))
    }
}

/// Two generalized plays with envelopes of their own up and down:
/// `p = max(γ_up(x) - r, min(γ_down(x) + r, p))`. Brokate & Sprekels (1996), section 2.5; Al Janaideh et al. (2011).
struct Envelopes {
    values: [f64; 6],
}

impl Specimen for Envelopes {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let (up, down) = (tanh(3.5 * x - 0.9) - 0.1, 0.8 * tanh(3.0 * x + 0.3) + 0.2);
        let mut sum = 0.0;
        for (k, value) in self.values.iter_mut().enumerate() {
            let r = 0.05 * k as f64;
            // Where the envelopes touch, neither lets the output pass.
            *value = value.min(down.max(up) + r).max(up.min(down) - r);
            sum += *value;
        }
        sum / 6.0
    }
}

/// Plays whose thresholds grow with the logarithm of the speed, `r_i(v) = r_i [1 + β ln(1 + |v|/v_0)]`. Al Janaideh,
/// Rakheja & Su, Mechatronics 19 (2009) 656. Were all thresholds wider by the same multiple of
/// the speed, the output would only be late.
struct RateDependent {
    plays: Plays,
    before: f64,
}

impl Specimen for RateDependent {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        let speed = if seconds > 0.0 { (x - self.before).abs() / seconds } else { 0.0 };
        self.before = x;
        self.plays.advance(x, 0.9 * ln(1.0 + speed / 0.2))
    }
}

/// Plays followed by a lag of first order, `τ y' = P[x] - y`.
struct Lagged {
    plays: Plays,
    lag: f64,
    value: f64,
}

impl Specimen for Lagged {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        let target = self.plays.advance(x, 0.0);
        self.value = target + (self.value - target) * exp(-seconds / self.lag);
        self.value
    }
}

/// Plays beside states of creep with times spaced evenly in the logarithm, `τ_j s_j' = x - s_j`. Krejci & Kuhnen, IEE
/// Proceedings - Control Theory and Applications 148 (2001) 185.
struct Creeping {
    plays: Plays,
    states: [f64; 3],
}

impl Specimen for Creeping {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        for (state, time) in self.states.iter_mut().zip([0.3, 3.0, 30.0_f64]) {
            *state = x + (*state - x) * exp(-seconds / time);
        }
        self.plays.advance(x, 0.0) + 0.25 * self.states.iter().sum::<f64>()
    }
}

/// One-sided dead zones of both signs.
fn dead_zone(p: f64) -> f64 {
    p.signum() * (p.abs() - 0.2).max(0.0) + 0.1 * p
}

fn plays(count: usize, widest: f64, spring: f64) -> Plays {
    Plays::even(count, widest, spring)
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "play",
            answers: "y n n  y y y  y n  n y",
            why: "the elementary Preisach operator with odd memory: all its branches are one curve, and its slope is largest at \
                  the end of a branch",
            specimen: || Box::new(Backlash { play: Play::default(), half_width: 0.3, ratio: 1.0 }),
        },
        Law {
            name: "backlash",
            answers: "y n n  y y y  y n  n y",
            why: "a narrow play with a transmission",
            specimen: || Box::new(Backlash { play: Play::default(), half_width: 0.1, ratio: 1.5 }),
        },
        Law {
            name: "pi-plays",
            answers: "y n n  y y y  y n  n y",
            why: "a sum of plays with positive weights is convex, congruent and follows Masing's rule",
            specimen: || {
                Box::new(Superposition { plays: plays(10, 0.5, 0.5), of_input: |x| x, of_output: |p| p })
            },
        },
        Law {
            name: "pi-dead-zone",
            answers: "y n n  y n n  y n  n y",
            why: "a curved function of the sum keeps the memory but bends each minor loop according to its height",
            specimen: || {
                Box::new(Superposition { plays: plays(8, 0.4, 0.4), of_input: |x| x, of_output: dead_zone })
            },
        },
        Law {
            name: "gpi-saturating",
            answers: "y n n  y y n  y y  n y",
            why: "generalized plays with one odd saturating envelope: a Preisach operator whose branches depend on their place",
            specimen: || {
                Box::new(Superposition {
                    plays: plays(8, 0.4, 0.3),
                    of_input: |x| tanh(4.0 * x),
                    of_output: |p| p,
                })
            },
        },
        Law {
            name: "gpi-asymmetric",
            answers: "y n n  y y n  n y  n y",
            why: "generalized plays with two different saturating envelopes: a Preisach operator without symmetry",
            specimen: || Box::new(Envelopes { values: [0.0; 6] }),
        },
        Law {
            name: "rate-dependent-pi",
            answers: "y n y  - - -  y -  n y",
            why: "thresholds grow with the speed; conditions of the memory are stated for one speed only",
            specimen: || Box::new(RateDependent { plays: plays(8, 0.2, 0.3), before: 0.0 }),
        },
        Law {
            name: "pi-lag",
            answers: "y n y  - - -  y -  n y",
            why: "a lag of 0.2 s rounds the turning points by the speed; the plays remain at rest",
            specimen: || Box::new(Lagged { plays: plays(8, 0.4, 0.3), lag: 0.2, value: 0.0 }),
        },
        Law {
            name: "pi-creep",
            answers: "y n y  - - -  y -  n -",
            why: "creep adds to the output while time passes; the plays remain at rest",
            specimen: || Box::new(Creeping { plays: plays(8, 0.4, 0.3), states: [0.0; 3] }),
        },
        Law {
            name: "butterfly",
            answers: "y - n  y n n  n n  n y",
            why: "an even function of plays: its two wings are passed in opposite directions, the memory is that of the plays",
            specimen: || {
                Box::new(Superposition { plays: plays(6, 0.5, 0.3), of_input: |x| x, of_output: |p| p * p })
            },
        },
    ]
}
