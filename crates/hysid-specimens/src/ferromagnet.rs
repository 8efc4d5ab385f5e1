//! Ferromagnetic sheet: the Preisach model with an analytic Everett function.
//!
//! ```text
//! G(h)   = M r (2/π atan(q h) + 1) + 2 M (1 - r) / (1 + (e^{-p1 h} + e^{-p2 h}) / 2)    theory.md (6.1)
//! E(a,b) = G(-b - Hc) G(a - Hc) - G(-a - Hc) G(b - Hc)       a >= b, both within ±Hsat  theory.md (6.2)
//! J      = ± E(|h_0|, -|h_0|) / 2 + Σ_k ± E(max(h_k, h_{k-1}), min(h_k, h_{k-1}))       theory.md (6.3)
//! B      = J + K μ0 H
//! ```
//!
//! `H` is the field in A/m, `J` the polarisation and `B` the flux density in T, `μ0` the permeability of
//! vacuum. `h_0, h_1, ...` are the dominant extrema of the field since demagnetisation, each smaller swing
//! nested in the one before, the present field last. The sign of a term is `+` for a rising swing.
//!
//! The memory is a stack of these extrema: a swing beyond an earlier one deletes it.
//!
//! Parameters: *published*, the records of `Magnetic.FluxTubes.Material.HysteresisEverettParameter` in the
//! Modelica Standard Library, as documented by Wolfram System Modeler; the equations are those of its
//! `everett` function and `GenericHystPreisachEverett` component.

use std::f64::consts::FRAC_2_PI;

use hysid_core::data::record::Record;
use hysid_core::elementary::{atan, exp};
use hysid_core::error::Result;

use super::path;
use super::specimen::{Specimen, SpecimenColumns};

/// Permeability of vacuum in T m/A.
const MU_0: f64 = 4e-7 * std::f64::consts::PI;

/// Parameters of the analytic Everett function of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Everett {
    /// `Hsat`: the polarisation does not change beyond this field, in A/m.
    pub h_sat: f64,
    /// `M`: scale of the polarisation, in the square root of T.
    pub m: f64,
    /// `r`: share of the arctangent.
    pub r: f64,
    /// `q`: steepness of the arctangent, in m/A.
    pub q: f64,
    /// `p1`: steepness of the first exponential, in m/A.
    pub p1: f64,
    /// `p2`: steepness of the second exponential, in m/A.
    pub p2: f64,
    /// `Hc`: shift of the function in A/m, close to the coercivity but not equal to it.
    pub hc: f64,
    /// `K`: slope of `B` beyond saturation, in units of `μ0`.
    pub k: f64,
}

impl Everett {
    fn g(&self, h: f64) -> f64 {
        let step = 1.0 + 0.5 * (exp(-self.p1 * h) + exp(-self.p2 * h));
        let arctangent = FRAC_2_PI * atan(self.q * h) + 1.0;
        self.m * self.r * arctangent + 2.0 * self.m * (1.0 - self.r) / step
    }

    /// The Everett function `E(a, b)`: decrease of `J` in T from `a` to `b` within ±`h_sat`, in A/m.
    pub fn value(&self, a: f64, b: f64) -> f64 {
        self.g(-b - self.hc) * self.g(a - self.hc) - self.g(-a - self.hc) * self.g(b - self.hc)
    }

    /// Change of J on a swing from one field to another.
    fn swing(&self, from: f64, to: f64) -> f64 {
        if to >= from { self.value(to, from) } else { -self.value(from, to) }
    }
}

/// A ferromagnetic material with its memory, initially demagnetised.
///
/// ```
/// use hysid_specimens::Ferromagnet;
/// let mut sheet = Ferromagnet::m330_50a();
/// let remanence = sheet.run(&[0.0, 300.0, 0.0])[2];
/// assert!(remanence > 1.0); // tesla, with no field left
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ferromagnet {
    /// Parameters of the material.
    pub everett: Everett,
    /// Dominant extrema of the field, the present field last, each with the J there.
    extrema: Vec<Extremum>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Extremum {
    h: f64,
    j: f64,
}

impl Ferromagnet {
    /// A demagnetised material.
    pub fn new(everett: Everett) -> Self {
        Self { everett, extrema: Vec::new() }
    }

    /// A demagnetised material from `h_sat`, `m`, `r`, `q`, `p1`, `p2`, `hc` and `k` of its Everett function.
    fn published([h_sat, m, r, q, p1, p2, hc, k]: [f64; 8]) -> Self {
        Self::new(Everett { h_sat, m, r, q, p1, p2, hc, k })
    }

    /// Electrical steel M270-50A. Published.
    pub fn m270_50a() -> Self {
        Self::published([650.0, 0.980890, 0.429330, 0.027285, 0.48567, 0.000549, 24.4948, 50.0])
    }

    /// Electrical steel M330-50A. Published.
    pub fn m330_50a() -> Self {
        Self::published([650.0, 0.967, 0.502560, 0.039964, 0.188070, 0.000781, 42.2283, 50.0])
    }

    /// Electrical steel M400-50AP. Published.
    pub fn m400_50ap() -> Self {
        Self::published([600.0, 1.0013, 0.42687, 0.034302, 0.31794, 0.000759, 36.204, 50.0])
    }

    /// Electrical steel M800-65A. Published.
    pub fn m800_65a() -> Self {
        Self::published([700.0, 1.146100, 0.160700, 0.012965, 0.183490, 0.000425, 100.0602, 50.0])
    }

    /// Cobalt-iron alloy Vacoflux 17. Published.
    pub fn vacoflux17() -> Self {
        Self::published([1000.0, 0.919590, 0.728070, 0.015757, 0.016407, 0.001049, 98.0842, 110.0])
    }

    /// Returns to the demagnetised state, at field 0.
    pub fn reset(&mut self) {
        self.extrema.clear();
    }

    /// The flux density `B` in T at the next field `h` in A/m. A field that is not finite gives NaN and
    /// leaves the memory unchanged.
    pub fn step(&mut self, h: f64) -> f64 {
        if !h.is_finite() {
            return f64::NAN;
        }
        self.magnetise(h.clamp(-self.everett.h_sat, self.everett.h_sat));
        self.polarisation() + self.everett.k * MU_0 * h
    }

    /// The flux densities in T at all fields in A/m, from the demagnetised state.
    pub fn run(&mut self, h: &[f64]) -> Vec<f64> {
        self.reset();
        h.iter().map(|&h| self.step(h)).collect()
    }

    /// The present polarisation J in tesla.
    pub fn polarisation(&self) -> f64 {
        self.extrema.last().map_or(0.0, |last| last.j)
    }

    /// Moves the field to `h`, within saturation: wipes out what the swing exceeds, then swings from
    /// the last extremum that remains.
    fn magnetise(&mut self, h: f64) {
        let j = loop {
            match self.extrema[..] {
                [] => break h.signum() * 0.5 * self.everett.value(h.abs(), -h.abs()),
                // The virgin curve goes on as if from the mirror image of its end.
                [first] if h.abs() >= first.h.abs() => self.extrema.clear(),
                [first] => break first.j + self.everett.swing(first.h, h),
                [.., start, end] => {
                    let (low, high) = (start.h.min(end.h), start.h.max(end.h));
                    if low < h && h < high {
                        break end.j + self.everett.swing(end.h, h);
                    }
                    self.extrema.pop();
                    // Beyond the swing's start the whole swing is forgotten, else it has only grown.
                    let beyond_start = if start.h == low { h <= low } else { h >= high };
                    if beyond_start && self.extrema.len() > 1 {
                        self.extrema.pop();
                    }
                }
            }
        };
        self.extrema.push(Extremum { h, j });
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "ferromagnet",
    example: Some("example 1"),
    summary: "electrical steel sheet M330-50A: field and flux density, a Preisach model with minor loops",
    published: "the Everett function and its parameters for M330-50A (Modelica Standard Library, \
                HysteresisEverettParameter, in the copies of Wolfram System Modeler)",
    designed: "the path of the field",
    training: "growing amplitudes up to 400 A/m, minor loops on both branches, demagnetisation, then 25 pairs of turning points \
               all over the range",
    testing: "a demagnetised sheet on another path: other amplitudes and other minor loops within the same range",
    columns: SpecimenColumns { time: None, input: "H_A_per_m", output: "B_T" },
    train: |_| Ok(vec![magnetised("growing and minor loops", &trained(), TRAINED_ROWS)?]),
    test: |_| Ok(vec![magnetised("other loops", &TEST, ROWS)?]),
};

/// Rows of each record, about.
const ROWS: f64 = 1500.0;

/// The same of the training record, which is longer.
const TRAINED_ROWS: f64 = 3000.0;

/// Turning points of the field in the training record, in A/m.
const TRAIN: [f64; 38] = [
    0.0, 30.0, -30.0, 60.0, -60.0, 100.0, -100.0, 160.0, -160.0, 250.0, -250.0, 400.0, 50.0, 200.0, -40.0,
    90.0, -100.0, 0.0, -400.0, -30.0, -150.0, 60.0, -80.0, 120.0, 20.0, 400.0, -300.0, 300.0, -200.0, 200.0,
    -130.0, 130.0, -80.0, 80.0, -45.0, 45.0, -20.0, 0.0,
];

/// Turning points of training that follow, all over the range in A/m.
const FURTHER: (usize, (f64, f64)) = (25, (-400.0, 400.0));

fn trained() -> Vec<f64> {
    let (pairs, range) = FURTHER;
    [&TRAIN[..], &path::covering(pairs, range)].concat()
}

/// Turning points of the field in the test record, in A/m.
const TEST: [f64; 26] = [
    0.0, 45.0, -45.0, 130.0, -130.0, 330.0, 80.0, 150.0, -20.0, 40.0, -60.0, -10.0, -330.0, -90.0, -200.0,
    20.0, -50.0, 70.0, 40.0, 370.0, -180.0, 180.0, -110.0, 60.0, -30.0, 0.0,
];

/// The sheet along a path of the field, which is rounded to 0.01 A/m.
fn magnetised(name: &str, turning: &[f64], rows: f64) -> Result<Record> {
    let path = path::through(turning, path::travel(turning) / rows);
    let h: Vec<f64> = path.into_iter().map(|h| (100.0 * h).round() / 100.0).collect();
    let b = Ferromagnet::m330_50a().run(&h);
    Record::new(name, vec![h], b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn all() -> [Ferromagnet; 5] {
        [
            Ferromagnet::m270_50a(),
            Ferromagnet::m330_50a(),
            Ferromagnet::m400_50ap(),
            Ferromagnet::m800_65a(),
            Ferromagnet::vacoflux17(),
        ]
    }

    fn j_after(material: &Ferromagnet, fields: &[f64]) -> f64 {
        let mut material = material.clone();
        material.run(fields);
        material.polarisation()
    }

    /// Field on the descending branch of the outermost loop where J = 0, by bisection.
    fn coercivity(material: &Ferromagnet) -> f64 {
        let h_sat = material.everett.h_sat;
        let (mut low, mut high) = (0.0, h_sat);
        while high - low > 1e-6 {
            let middle = 0.5 * (low + high);
            let positive = j_after(material, &[h_sat, -middle]) > 0.0;
            *(if positive { &mut low } else { &mut high }) = middle;
        }
        low
    }

    /// Saturation polarisation, coercivity and remanence computed independently from the same
    /// published parameters (a numpy implementation of the Modelica equations).
    #[test]
    fn outermost_loops_have_their_published_shape() {
        let expected = [
            (Ferromagnet::m270_50a(), 1.3661, 22.75, 0.9348),
            (Ferromagnet::m330_50a(), 1.4331, 39.08, 1.1536),
            (Ferromagnet::m800_65a(), 1.5136, 94.97, 1.3805),
            (Ferromagnet::vacoflux17(), 1.4926, 91.26, 0.8655),
        ];
        for (material, saturation, coercive_field, remanence) in expected {
            let h_sat = material.everett.h_sat;
            assert_relative_eq!(j_after(&material, &[h_sat]), saturation, epsilon = 5.1e-5);
            assert_relative_eq!(coercivity(&material), coercive_field, epsilon = 5.1e-3);
            assert_relative_eq!(j_after(&material, &[h_sat, 0.0]), remanence, epsilon = 5.1e-5);
        }
    }

    /// Values of the same independent implementation.
    #[test]
    fn minor_loops_of_m330_return_to_their_start() {
        let fields = [300.0, -100.0, 100.0, -100.0, 300.0];
        let expected = [1.319871, -1.110440, 1.125961, -1.110440, 1.319871];
        for (end, expected) in (1..=5).zip(expected) {
            let j = j_after(&Ferromagnet::m330_50a(), &fields[..end]);
            assert_relative_eq!(j, expected, epsilon = 5.1e-7);
        }
    }

    #[test]
    fn larger_swings_wipe_smaller_ones_out() {
        for material in all() {
            let inner = [400.0, -200.0, 150.0, -80.0, 20.0, -80.0, 150.0, -10.0, -200.0, -250.0];
            let wiped = j_after(&material, &inner);
            assert_relative_eq!(wiped, j_after(&material, &[400.0, -250.0]), epsilon = 1e-12);
            let outer = [inner.as_slice(), &[-400.0, 300.0]].concat();
            assert_relative_eq!(
                j_after(&material, &outer),
                j_after(&material, &[-400.0, 300.0]),
                epsilon = 1e-12
            );
        }
    }

    #[test]
    fn beyond_saturation_only_the_vacuum_term_grows() {
        let mut material = Ferromagnet::m330_50a();
        let b = material.run(&[650.0, 1650.0, f64::NAN, 1650.0]);
        assert_relative_eq!(b[1] - b[0], 50.0 * MU_0 * 1000.0, epsilon = 1e-12);
        assert!(b[2].is_nan() && b[3] == b[1]);
        assert_eq!(Ferromagnet::m330_50a().step(0.0), 0.0);
    }
}
