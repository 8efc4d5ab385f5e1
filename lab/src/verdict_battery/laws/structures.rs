//! Laws of structural members: straight lines and curves that aim at points of the past.

use hysid_core::elementary::powf;

use super::{Law, Specimen};

/// Peak-oriented: from zero force a straight line to the largest deformation of that side. Clough & Johnston,
/// Proceedings of the Japan Earthquake Engineering Symposium (1966) 227.
///
/// Reloading may first aim at a pinch point, at half the largest deformation and a share of the force there.
struct Clough {
    x: f64,
    force: f64,
    /// Largest deformation of either side and the force there.
    peaks: [(f64, f64); 2],
    /// The force of a first loading, by the deformation.
    envelope: fn(f64) -> f64,
    /// Share of the force at the pinch point.
    pinch: Option<f64>,
}

impl Clough {
    const STIFFNESS: f64 = 4.0;

    fn new(envelope: fn(f64) -> f64, pinch: Option<f64>) -> Self {
        Self { x: 0.0, force: 0.0, peaks: [(-0.15, -0.6), (0.15, 0.6)], envelope, pinch }
    }

    fn hardening(deformation: f64) -> f64 {
        0.6 + 0.15 * (deformation - 0.15)
    }

    /// Softens beyond 0.45 to a fifth.
    fn softening(deformation: f64) -> f64 {
        Self::hardening(deformation.min(0.45)) * (1.0 - 1.6 * (deformation - 0.45).clamp(0.0, 0.5))
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
        let target = (sign * peak.0, sign * peak.1);
        // Towards the pinch point.
        let pinch = self.pinch.map_or((0.0, 0.0), |share| (0.5 * target.0, share * target.1));
        if left > 0.0 && here < pinch.0 && force < pinch.1 {
            let way = left.min(pinch.0 - here);
            let slope = (pinch.1 - force) / (pinch.0 - here);
            (force, here, left) = (force + slope * way, here + way, left - way);
        }
        // Towards the peak.
        if left > 0.0 && here < target.0 {
            let slope = ((target.1 - force) / (target.0 - here)).min(Self::STIFFNESS);
            let way = left.min(target.0 - here);
            (force, here, left) = (force + slope * way, here + way, left - way);
        }
        if left > 0.0 {
            let on_envelope = (self.envelope)(here + left);
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
        let height = b * way + (1.0 - b) * way / powf(1.0 + powf(way.abs(), r), r.recip());
        self.x = x;
        self.y = y_r + (y_0 - y_r) * height;
        self.y
    }
}

/// Elastic-plastic, until a part of it breaks at a deformation of 0.7: the rest has two fifths of stiffness and strength.
struct Fracturing {
    x: f64,
    slider: f64,
    is_broken: bool,
}

impl Specimen for Fracturing {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        self.slider = (self.slider + x - self.x).clamp(-0.15, 0.15);
        self.x = x;
        self.is_broken |= x.abs() > 0.7;
        (if self.is_broken { 1.6 } else { 4.0 }) * self.slider
    }
}

pub fn laws() -> Vec<Law> {
    vec![
        Law {
            name: "clough",
            answers: "y y n  n n n  - -  n -  n -",
            why: "reloading aims at the largest deformation, not at where unloading began; loops of one amplitude are equal",
            specimen: || Box::new(Clough::new(Clough::hardening, None)),
        },
        Law {
            name: "softening-member",
            answers: "y y n  - - -  - -  - -  y -",
            why: "the force falls beyond a deformation of 0.45",
            specimen: || Box::new(Clough::new(Clough::softening, None)),
        },
        Law {
            name: "pinching-member",
            answers: "y y n  - - -  - -  n -  n y",
            why: "reloading first goes to a tenth of the force at half the largest deformation",
            specimen: || Box::new(Clough::new(Clough::hardening, Some(0.1))),
        },
        Law {
            name: "fracturing-member",
            answers: "y y n  - - -  - -  - -  y n",
            why: "at a deformation of 0.7 three fifths of stiffness and strength are lost",
            specimen: || Box::new(Fracturing { x: 0.0, slider: 0.0, is_broken: false }),
        },
        Law {
            name: "menegotto-pinto",
            answers: "y y n  n - n  - y  n -  n n",
            why: "after a short excursion the curve begins anew and overshoots",
            specimen: || Box::new(MenegottoPinto::new()),
        },
    ]
}
