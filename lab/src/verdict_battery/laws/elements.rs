//! Plays and stops, of which many laws consist.

/// Play of half-width `r`: `p = max(x - r, min(x + r, p))`. Brokate & Sprekels, Hysteresis and Phase Transitions
/// (1996), section 2.3.
#[derive(Default)]
pub struct Play {
    pub value: f64,
}

impl Play {
    pub fn advance(&mut self, x: f64, r: f64) -> f64 {
        self.value = self.value.min(x + r).max(x - r);
        self.value
    }
}

/// Stop of yield force `r` and stiffness 1: `s = max(-r, min(r, s + Δx))`. Visintin, Differential Models of
/// Hysteresis (1994), section III.1.
#[derive(Default)]
pub struct Stop {
    pub value: f64,
    before: f64,
}

impl Stop {
    /// The new value, and the way that it slipped.
    pub fn advance(&mut self, x: f64, r: f64) -> (f64, f64) {
        let elastic = self.value + x - self.before;
        self.before = x;
        self.value = elastic.clamp(-r, r);
        (self.value, (elastic - self.value).abs())
    }
}

/// Plays with their thresholds and weights, beside a spring.
pub struct Plays {
    plays: Vec<(Play, f64, f64)>,
    spring: f64,
}

impl Plays {
    /// Plays with thresholds evenly spaced up to `widest`, of equal weights that sum to 1.
    pub fn even(count: usize, widest: f64, spring: f64) -> Self {
        let threshold = |k: usize| widest * (k + 1) as f64 / count as f64;
        Self {
            plays: (0..count).map(|k| (Play::default(), threshold(k), (count as f64).recip())).collect(),
            spring,
        }
    }

    /// The weighted sum, every threshold larger by the share `wider`.
    pub fn advance(&mut self, x: f64, wider: f64) -> f64 {
        let sum: f64 =
            self.plays.iter_mut().map(|(play, r, w)| *w * play.advance(x, *r * (1.0 + wider))).sum();
        self.spring * x + sum
    }
}
