//! Laws that are differential equations of the input's way, `dy = f(x, y, sign x') dx`.

use hysid_core::elementary::{exp, powf, square, tanh};

use super::{Law, Specimen};

/// Longest step of the integration, in the unit of the input.
const STEP: f64 = 0.002;

/// A law of one state, integrated along the way of the input.
struct Along<F> {
    /// `dz/dx` at `x`, `z`, direction and dissipated energy.
    slope: F,
    output: fn(f64, f64) -> f64,
    x: f64,
    z: f64,
    /// `∫ z dx`.
    energy: f64,
}

impl<F: Fn(f64, f64, f64, f64) -> f64> Along<F> {
    fn law(slope: F, output: fn(f64, f64) -> f64) -> Self {
        Self { slope, output, x: 0.0, z: 0.0, energy: 0.0 }
    }

    /// A step of Runge and Kutta's classical method.
    fn step(&mut self, way: f64, direction: f64) {
        let f = |x: f64, z: f64| (self.slope)(x, z, direction, self.energy);
        let (x, z, half) = (self.x, self.z, 0.5 * way);
        let a = f(x, z);
        let b = f(x + half, z + half * a);
        let c = f(x + half, z + half * b);
        let d = f(x + way, z + way * c);
        self.z += way / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        self.energy += way * 0.5 * (z + self.z);
        self.x += way;
    }
}

impl<F: Fn(f64, f64, f64, f64) -> f64> Specimen for Along<F> {
    fn advance(&mut self, x: f64, _: f64) -> f64 {
        let way = x - self.x;
        let steps = (way.abs() / STEP).ceil() as usize;
        for _ in 0..steps {
            self.step(way / steps as f64, way.signum());
        }
        self.x = x;
        (self.output)(x, self.z)
    }
}

/// `dz/dx = [A - ν |z|^n (β sign(x' z) + γ)] / η`. Wen, Journal of the Engineering Mechanics Division 102 (1976) 249.
#[derive(Clone, Copy)]
struct BoucWen {
    a: f64,
    beta: f64,
    gamma: f64,
    n: f64,
}

impl BoucWen {
    fn slope(self, z: f64, direction: f64, nu: f64) -> f64 {
        self.a - nu * powf(z.abs(), self.n) * (self.beta * (direction * z).signum() + self.gamma)
    }

    fn ultimate(self) -> f64 {
        powf(self.a / (self.beta + self.gamma), self.n.recip())
    }
}

const SOFTENING: BoucWen = BoucWen { a: 1.0, beta: 4.0, gamma: -1.0, n: 1.0 };
const HARDENING: BoucWen = BoucWen { a: 1.0, beta: 0.8, gamma: -1.3, n: 1.0 };
const WIDE: BoucWen = BoucWen { a: 1.0, beta: 1.5, gamma: -0.3, n: 1.0 };
const SHARP: BoucWen = BoucWen { a: 1.0, beta: 9.0, gamma: -4.0, n: 2.0 };

fn bouc_wen<const HARD: usize>() -> Box<dyn Specimen> {
    let law = [SOFTENING, HARDENING, WIDE, SHARP][HARD];
    Box::new(Along::law(move |_, z, way, _| law.slope(z, way, 1.0), |x, z| 0.1 * x + z))
}

/// Strength and stiffness fall with the dissipated energy. Baber & Wen, Journal of the Engineering Mechanics Division
/// 107 (1981) 1069.
fn degrading() -> Box<dyn Specimen> {
    let law = |_: f64, z: f64, way: f64, energy: f64| {
        SOFTENING.slope(z, way, 1.0 + 0.5 * energy) / (1.0 + 0.1 * energy)
    };
    Box::new(Along::law(law, |x, z| 0.1 * x + z))
}

/// Slip about zero force, `dz/dx = h(z) ...`. Baber & Noori, Journal of Engineering Mechanics 111 (1985) 1010.
fn pinching() -> Box<dyn Specimen> {
    let law = |_: f64, z: f64, way: f64, _: f64| {
        let ultimate = SOFTENING.ultimate();
        let slip = 0.85 * exp(-square((z * way - 0.1 * ultimate) / (0.25 * ultimate)));
        (1.0 - slip) * SOFTENING.slope(z, way, 1.0)
    };
    Box::new(Along::law(law, |x, z| 0.1 * x + z))
}

/// `dF/dx = σ (1 - F sign(x') / F_c)`. Dahl, The Aerospace Corporation TOR-0158 (1968).
fn dahl() -> Box<dyn Specimen> {
    Box::new(Along::law(|_, f: f64, way, _| 5.0 * (1.0 - f * way), |_, f| f))
}

/// `dy/dx = a sign(x') (f(x) - y) + b` with a saturating curve. Macki, Nistri & Zecca, SIAM Review 35 (1993) 94.
fn duhem() -> Box<dyn Specimen> {
    Box::new(Along::law(|x: f64, y, way, _| 4.0 * way * (tanh(3.0 * x) - y) + 0.2, |_, y| y))
}

/// `dy/dx = a sign(x') (b x - y) + c`. Coleman & Hodgdon, International Journal of Engineering Science 24 (1986) 897.
fn coleman_hodgdon() -> Box<dyn Specimen> {
    Box::new(Along::law(|x, y, way, _| 3.0 * way * (x - y) + 0.2, |_, y| y))
}

/// Langevin's curve.
fn langevin(h: f64) -> f64 {
    if h.abs() < 1e-3 { h / 3.0 } else { tanh(h).recip() - h.recip() }
}

/// `dM/dH = [(1 - c) δ_M (M_an - M)/(δ k - α (M_an - M)) + c dM_an/dH] / (1 - α c)`. Jiles, Thoelke & Devine, IEEE
/// Transactions on Magnetics 28 (1992) 27.
fn jiles_atherton() -> Box<dyn Specimen> {
    const A: f64 = 0.12;
    const K: f64 = 0.3;
    const C: f64 = 0.1;
    const ALPHA: f64 = 0.1;
    let law = |h: f64, m: f64, way: f64, _: f64| {
        let field = (h + ALPHA * m) / A;
        let beyond = langevin(field) - m;
        let reversible = (langevin(field + 1e-4) - langevin(field - 1e-4)) / (2e-4 * A);
        let irreversible = if beyond * way > 0.0 { beyond / (way * K - ALPHA * beyond) } else { 0.0 };
        ((1.0 - C) * irreversible + C * reversible) / (1.0 - ALPHA * C)
    };
    Box::new(Along::law(law, |_, m| m))
}

/// Bristles with Stribeck's friction and viscosity, `z' = v - σ0 |v| z / g(v)`, `F = σ0 z + σ1 z' + σ2 v`. Canudas de
/// Wit, Olsson, Åström & Lischinsky, IEEE Transactions on Automatic Control 40 (1995) 419.
struct LuGre {
    x: f64,
    z: f64,
}

impl Specimen for LuGre {
    fn advance(&mut self, x: f64, seconds: f64) -> f64 {
        const STIFFNESS: f64 = 8.0;
        let speed = if seconds > 0.0 { (x - self.x) / seconds } else { 0.0 };
        self.x = x;
        let friction = 1.0 + 0.3 * exp(-square(speed / 0.5));
        // Exact while the speed is constant.
        let bound = speed.signum() * friction / STIFFNESS;
        let before = self.z;
        if speed != 0.0 {
            self.z = bound + (self.z - bound) * exp(-STIFFNESS * speed.abs() * seconds / friction);
        }
        let rate = if seconds > 0.0 { (self.z - before) / seconds } else { 0.0 };
        STIFFNESS * self.z + 0.05 * rate + 0.15 * speed
    }
}

pub fn laws() -> Vec<Law> {
    let law = |name, answers, why: &'static str, specimen| Law { name, answers, why, specimen };
    vec![
        law(
            "bouc-wen-softening",
            "y y n  n n n  y -  n -",
            "branches depend on the force alone: excursions leave gaps and minor loops drift until they have settled",
            bouc_wen::<0>,
        ),
        law(
            "bouc-wen-hardening",
            "y y n  n n n  y n  n -",
            "as Bouc-Wen with a stiffness that grows with the force",
            bouc_wen::<1>,
        ),
        law(
            "bouc-wen-wide",
            "y y n  n n n  y -  n -",
            "as Bouc-Wen with a long transition: large gaps",
            bouc_wen::<2>,
        ),
        law("bouc-wen-sharp", "y y n  n n n  y -  n -", "as Bouc-Wen with exponent 2", bouc_wen::<3>),
        law(
            "bouc-wen-degrading",
            "y y n  n n n  - -  y n",
            "strength and stiffness fall with the dissipated energy",
            degrading,
        ),
        law(
            "bouc-wen-pinching",
            "y y n  n n n  y -  n -",
            "as Bouc-Wen, slipping about zero force",
            pinching,
        ),
        law("dahl", "y y n  n n n  y y  n -", "an exponential approach to friction from any state", dahl),
        law(
            "lugre",
            "y y y  - - -  y -  n y",
            "viscosity and Stribeck's friction depend on the speed; presliding remains at rest",
            || Box::new(LuGre { x: 0.0, z: 0.0 }),
        ),
        law(
            "duhem",
            "y n n  n n n  y -  n -",
            "the branch depends on input and output alone, not on turning points",
            duhem,
        ),
        law(
            "coleman-hodgdon",
            "y n n  n n n  y n  n -",
            "an exponential approach to a line from any state",
            coleman_hodgdon,
        ),
        law(
            "jiles-atherton",
            "y n n  n n n  y -  n -",
            "the branch depends on field and magnetization alone; its gaps matter on some paths only",
            jiles_atherton,
        ),
    ]
}
