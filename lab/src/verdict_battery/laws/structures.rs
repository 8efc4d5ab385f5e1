//! Laws of structural members: straight lines and curves that aim at points of the past.

use super::{Law, Specimen};

/// Peak-oriented: from zero force a straight line to the largest deformation of that side. Clough & Johnston,
/// Proceedings of the Japan Earthquake Engineering Symposium (1966) 227.
struct Clough {
    x: f64,
    force: f64,
    /// Largest deformation of either side and the force there.
    peaks: [(f64, f64); 2],
}

impl Clough {
    const STIFFNESS: f64 = 4.0;
    const HARDENING: f64 = 0.15;

    fn new() -> Self {
        Self { x: 0.0, force: 0.0, peaks: [(-0.15, -0.6), (0.15, 0.6)] }
    }
}

impl Specimen for Clough {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let sign = if x > self.x { 1.0 } else { -1.0 };
        let (mut left, mut force) = ((x - self.x).abs(), sign * self.force);
        let mut here = sign * self.x;
        let peak = &mut self.peaks[usize::from(sign > 0.0)];
        // Unloading to zero force.
        if force < 0.0 {
            let way = (-force / Self::STIFFNESS).min(left);
            (force, here, left) = (force + Self::STIFFNESS * way, here + way, left - way);
        }
        // Towards the peak.
        let target = (sign * peak.0, sign * peak.1);
        if left > 0.0 && here < target.0 {
            let slope = ((target.1 - force) / (target.0 - here)).min(Self::STIFFNESS);
            let way = left.min(target.0 - here);
            (force, here, left) = (force + slope * way, here + way, left - way);
        }
        if left > 0.0 {
            let on_envelope = target.1 + Self::HARDENING * (here + left - target.0);
            force = on_envelope.min(force + Self::STIFFNESS * left);
            here += left;
            *peak = (sign * here, sign * force);
        }
        self.x = x;
        self.force = sign * force;
        self.force
    }
}

/// Reinforcing steel: a curve between two asymptotes from every reversal. Menegotto & Pinto, IABSE Symposium Lisbon
/// (1973) 15; Filippou, Popov & Bertero, EERC 83-19 (1983) for the exponent.
struct MenegottoPinto {
    x: f64,
    y: f64,
    direction: f64,
    reversal: (f64, f64),
    meeting: (f64, f64),
    exponent: f64,
    extremes: (f64, f64),
}

impl MenegottoPinto {
    const YIELD: f64 = 0.15;
    const HARDENING: f64 = 0.02;

    fn new() -> Self {
        Self {
            x: 0.0,
            y: 0.0,
            direction: 0.0,
            reversal: (0.0, 0.0),
            meeting: (0.0, 0.0),
            exponent: 20.0,
            extremes: (-Self::YIELD, Self::YIELD),
        }
    }

    /// A new branch from here: its asymptotes meet on the line of yielding of that side.
    fn reverse(&mut self, direction: f64) {
        let begins = self.direction == 0.0;
        self.direction = direction;
        let (b, y) = (Self::HARDENING, direction * Self::YIELD);
        let offset = y * (1.0 - b);
        let meets = (offset - self.y + self.x) / (1.0 - b);
        self.reversal = (self.x, self.y);
        self.meeting = (meets, offset + b * meets);
        if begins {
            return;
        }
        self.extremes = (self.extremes.0.min(self.x), self.extremes.1.max(self.x));
        let extreme = if direction > 0.0 { self.extremes.1 } else { self.extremes.0 };
        let slip = ((extreme - meets) / Self::YIELD).abs();
        self.exponent = 20.0 - 18.5 * slip / (0.15 + slip);
    }
}

impl Specimen for MenegottoPinto {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        if x == self.x {
            return self.y;
        }
        let direction = (x - self.x).signum();
        if direction != self.direction {
            self.reverse(direction);
        }
        let ((x_r, y_r), (x_0, y_0)) = (self.reversal, self.meeting);
        let way = (x - x_r) / (x_0 - x_r);
        let b = Self::HARDENING;
        let r = self.exponent;
        let height = b * way + (1.0 - b) * way / (1.0 + way.abs().powf(r)).powf(r.recip());
        self.x = x;
        self.y = y_r + (y_0 - y_r) * height;
        self.y
    }
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "clough",
            answers: "y y n  n n n  - -  n -",
            why: "reloading aims at the largest deformation, not at where unloading began; loops of one amplitude are equal",
            specimen: || Box::new(Clough::new()),
        },
        Law {
            name: "menegotto-pinto",
            answers: "y y n  n - n  - y  n -",
            why: "after a short excursion the curve begins anew and overshoots",
            specimen: || Box::new(MenegottoPinto::new()),
        },
    ]
}
