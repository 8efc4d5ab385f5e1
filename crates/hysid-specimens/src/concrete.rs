//! Concrete in cyclic compression: Popovics' envelope, the permanent strain of Karsan and Jirsa, curved
//! unloading, and straight reloading with a loss of stress.
//!
//! ```text
//! σ = f_c η r/(r - 1 + η^r),   η = ε/ε_c,   r = E_c/(E_c - f_c/ε_c)                    theory.md (6.24)
//! ε_p/ε_c = 0.145 η_u² + 0.13 η_u if η_u < 2, else 0.707 (η_u - 2) + 0.834             theory.md (6.25)
//! σ = σ_a [1 - x q/(q - 1 + x^q)],   x = (ε_a - ε)/(ε_a - ε_p),   q = E_u/(E_u - E_s)  theory.md (6.26)
//! σ = min(envelope, σ_b + E_r (ε - ε_b)),   E_r = (0.92 (σ_u - σ_b))/(ε_u - ε_b)       theory.md (6.27)
//! ```
//!
//! `ε` is the compressive strain in mm/m, `σ` the compressive stress in MPa. `f_c` is the strength, `ε_c` the
//! strain there and `E_c` the initial modulus. The point `u` is where unloading last began at the largest
//! strain, `a` where it began now, `b` where reloading began; `η_u = ε_u/ε_c`, and `ε_p` is the permanent
//! strain. `E_u = E_c min(1, √(ε_c/ε_u))` is the initial slope of unloading and `E_s = σ_a/(ε_a - ε_p)` that
//! of its chord.
//!
//! *Published*: the envelope and the permanent strain, in the form of Concrete04 of OpenSees; the shape of
//! unloading and the loss of stress by 8 % at the strain `ε_u` after Mander, Priestley and Park. *Designed*:
//! that reloading continues straight to the envelope (as Sinha, Gerstle and Tulin drew it), that partial
//! unloading keeps the permanent strain, the values of the concrete (typical ones) and the strain history.

use hysid_core::data::record::Record;
use hysid_core::elementary::powf;
use hysid_core::error::Result;

use super::path;
use super::specimen::{Specimen, SpecimenColumns};

/// Share of the unloaded stress that is back when reloading reaches the strain of unloading.
const RECOVERED: f64 = 0.92;

/// Parameters of a concrete. Compression is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConcreteParameters {
    /// `f_c`: strength in MPa.
    pub strength: f64,
    /// `ε_c`: strain at the strength, in mm/m.
    pub strain_at_strength: f64,
    /// Strain in mm/m beyond which it is crushed and has no stress.
    pub crushing_strain: f64,
    /// `E_c`: initial modulus in MPa per mm/m (that is, GPa); above `f_c/ε_c`.
    pub modulus: f64,
}

impl ConcreteParameters {
    /// Typical values: 27.6 MPa at 2 mm/m, crushed at 6 mm/m, 24.9 GPa. Designed.
    pub fn typical() -> Self {
        Self { strength: 27.6, strain_at_strength: 2.0, crushing_strain: 6.0, modulus: 24.9 }
    }

    /// Stress in MPa on the envelope, `f_c η r/(r - 1 + η^r)`, at a strain in mm/m (theory.md (6.24)).
    pub fn envelope(&self, strain: f64) -> f64 {
        if strain <= 0.0 || strain > self.crushing_strain {
            return 0.0;
        }
        let r = self.modulus / (self.modulus - self.strength / self.strain_at_strength);
        let eta = strain / self.strain_at_strength;
        self.strength * eta * r / (r - 1.0 + powf(eta, r))
    }

    /// Permanent strain `ε_p` in mm/m after unloading from a strain in mm/m on the envelope: `ε_c (0.145 η_u²
    /// + 0.13 η_u)` for `η_u < 2`, else `ε_c (0.707 (η_u - 2) + 0.834)` (theory.md (6.25)).
    pub fn permanent_strain(&self, strain: f64) -> f64 {
        let eta = strain / self.strain_at_strength;
        let ratio = if eta < 2.0 { 0.145 * eta * eta + 0.13 * eta } else { 0.707 * (eta - 2.0) + 0.834 };
        ratio * self.strain_at_strength
    }
}

/// A point of the stress-strain plane, in mm/m and MPa.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct StressPoint {
    strain: f64,
    stress: f64,
}

/// The branch that the present point is on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ConcreteBranch {
    Envelope,
    /// From this point down to the permanent strain, and open beyond it.
    Unloading(StressPoint),
    /// From this point up to the envelope.
    Reloading(StressPoint),
}

/// Concrete with its memory, initially undamaged.
///
/// ```
/// use hysid_specimens::{Concrete, ConcreteParameters};
/// let mut concrete = Concrete::new(ConcreteParameters::typical());
/// let stress = concrete.run(&[2.0, 0.2, 2.0]); // mm/m to MPa
/// assert!((stress[0] - 27.6).abs() < 1e-12);
/// assert_eq!(stress[1], 0.0); // the crack is open: 0.55 mm/m are permanent
/// assert!((stress[2] - 0.92 * 27.6).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Concrete {
    /// Parameters of the concrete.
    pub parameters: ConcreteParameters,
    branch: ConcreteBranch,
    now: StressPoint,
    /// Where unloading began at the largest strain so far.
    unloaded: StressPoint,
    permanent: f64,
}

impl Concrete {
    /// Undamaged concrete.
    pub fn new(parameters: ConcreteParameters) -> Self {
        let origin = StressPoint::default();
        Self { parameters, branch: ConcreteBranch::Envelope, now: origin, unloaded: origin, permanent: 0.0 }
    }

    /// Returns to the undamaged concrete.
    pub fn reset(&mut self) {
        *self = Self::new(self.parameters);
    }

    /// The compressive stress in MPa at the next compressive strain in mm/m, for any number of steps on the
    /// way. Tension, a negative strain, opens a crack and has no stress. A strain that is not finite gives
    /// NaN and leaves the memory unchanged.
    pub fn step(&mut self, strain: f64) -> f64 {
        if !strain.is_finite() {
            return f64::NAN;
        }
        let strain = strain.max(0.0);
        if strain > self.now.strain {
            self.load(strain);
        } else if strain < self.now.strain {
            self.unload(strain);
        }
        self.now.stress
    }

    /// The stresses in MPa at all strains in mm/m, from the undamaged concrete.
    pub fn run(&mut self, strain: &[f64]) -> Vec<f64> {
        self.reset();
        strain.iter().map(|&strain| self.step(strain)).collect()
    }

    /// The permanent strain in mm/m of the last unloading.
    pub fn permanent_strain(&self) -> f64 {
        self.permanent
    }

    fn load(&mut self, strain: f64) {
        if let ConcreteBranch::Unloading(_) = self.branch {
            // An open crack closes before it bears.
            let closed = StressPoint { strain: self.now.strain.max(self.permanent), ..self.now };
            let bears = closed.strain < self.unloaded.strain;
            self.branch = if bears { ConcreteBranch::Reloading(closed) } else { ConcreteBranch::Envelope };
        }
        let envelope = self.parameters.envelope(strain);
        let stress = match self.branch {
            ConcreteBranch::Reloading(from) => {
                let StressPoint { strain: end, stress: top } = self.unloaded;
                let slope = RECOVERED * (top - from.stress) / (end - from.strain);
                from.stress + slope * (strain - from.strain).max(0.0)
            }
            ConcreteBranch::Envelope | ConcreteBranch::Unloading(_) => envelope,
        };
        if stress >= envelope {
            self.branch = ConcreteBranch::Envelope;
        }
        self.now = StressPoint { strain, stress: stress.min(envelope) };
    }

    fn unload(&mut self, strain: f64) {
        let from = match self.branch {
            ConcreteBranch::Unloading(from) => from,
            ConcreteBranch::Envelope | ConcreteBranch::Reloading(_) => {
                let on_envelope = self.branch == ConcreteBranch::Envelope;
                if on_envelope || self.now.strain > self.unloaded.strain {
                    self.unloaded = self.now;
                    // No steeper than the untouched concrete.
                    let elastic = self.now.strain - self.now.stress / self.parameters.modulus;
                    let permanent = self.parameters.permanent_strain(self.now.strain).min(elastic);
                    self.permanent = self.permanent.max(permanent);
                }
                self.branch = ConcreteBranch::Unloading(self.now);
                self.now
            }
        };
        self.now = StressPoint { strain, stress: self.unloading(from, strain) };
    }

    /// Stress on unloading from a point to the permanent strain, `σ_a [1 - x q/(q - 1 + x^q)]` (theory.md
    /// (6.26)).
    fn unloading(&self, from: StressPoint, strain: f64) -> f64 {
        if strain <= self.permanent || from.stress <= 0.0 {
            return 0.0;
        }
        let reach = from.strain - self.permanent;
        let x = (from.strain - strain) / reach;
        let softening = (self.parameters.strain_at_strength / self.unloaded.strain).sqrt().min(1.0);
        let initial = softening * self.parameters.modulus;
        let secant = from.stress / reach;
        if secant >= initial {
            return from.stress * (1.0 - x); // the limit of q without end
        }
        let q = initial / (initial - secant);
        from.stress * (1.0 - x * q / (q - 1.0 + powf(x, q)))
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "concrete",
    example: Some("example 5"),
    summary: "concrete in cyclic compression: it softens, keeps permanent strain and loses stress with every cycle",
    published: "Popovics' envelope and Karsan and Jirsa's permanent strain (as in Concrete04 of OpenSees); the shape of \
                unloading and the stress lost after Mander, Priestley and Park",
    designed: "straight reloading up to the envelope, the rule for partial cycles, the values of the concrete and the \
               strain history",
    training: "cycles with growing largest strain, up to 4.4 mm/m, unloaded fully or in part, then 50 turning points \
               between 2 and 4.4 mm/m; a row a second",
    testing: "the strain goes on to 20 other turning points between 2 and 4.4 mm/m; the training part comes first, with \
              blank outputs, so that damage is carried over",
    columns: SpecimenColumns { time: Some("t_s"), input: "strain_mm_per_m", output: "stress_MPa" },
    train: |_| Ok(vec![parts()?.0]),
    test: |_| Ok(vec![parts()?.1]),
};

/// Turning points of the strain in mm/m to begin training with.
const TRAIN: [f64; 25] = [
    0.0, 0.8, 0.2, 1.2, 0.4, 1.6, 0.5, 2.0, 1.1, 1.7, 0.9, 2.4, 0.9, 2.9, 1.6, 2.5, 1.3, 3.4, 1.6, 3.9, 2.6,
    3.6, 2.0, 4.4, 2.2,
];

/// Range of the turning points that follow, in mm/m.
const RANGE: (f64, f64) = (2.0, 4.4);

/// Number of those in training, and of those in the test.
const FURTHER: (usize, usize) = (50, 20);

/// Largest step of the strain between two rows, in mm/m.
const STEP: f64 = 0.02;

fn parts() -> Result<(Record, Record)> {
    let (trained, tested) = FURTHER;
    let further = path::wandering(trained + tested, RANGE);
    let (train, test) = further.split_at(trained);
    let law = |strain: &[f64]| Concrete::new(ConcreteParameters::typical()).run(strain);
    path::continued("cyclic compression", &[&TRAIN[..], train].concat(), test, STEP, 1.0, law)
}
