//! Modified Prandtl-Ishlinskii model: a sum of plays, bent by one-sided dead zones.
//!
//! ```text
//! y = S(H[x]),   H[x] = c + w_0 x + Σ_i w_i p_{r_i}[x]                        theory.md (7.6)
//! S(z) = c_S + w_S0 z + Σ_j w_Sj S_{r_Sj}(z)
//! S_r(z) = max(z - r, 0) for r > 0,   min(z - r, 0) for r < 0
//! ```
//!
//! `x` is the input, `y` the output, `p_r` the [play](crate::operator::play) of threshold `r`, `H` the sum of
//! plays (a [`PrandtlIshlinskii`]) and `S` a rising polygon.
//!
//! Properties: loops can be asymmetric, unlike those of a Prandtl-Ishlinskii model, and wiping-out holds.
//! Source: Kuhnen, "Modeling, identification and compensation of complex hysteretic nonlinearities", European
//! Journal of Control (2003).

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::law::facts::{ErrorsInside, Facts};
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::properties::WIPES_OUT;
use crate::law::thresholds::{check_count, check_weights};
use crate::law::{Dimension, Law, Parameter, Sample, stored_as};
use crate::property::Property;

/// A modified Prandtl-Ishlinskii model `y = S(H[x])` (theory.md (7.6)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModifiedPrandtlIshlinskii {
    hysteresis: PrandtlIshlinskii,
    superposition: DeadZones,
}

/// A sum of one-sided dead zones, `S(z) = c_S + w_S0 z + Σ_j w_Sj S_{r_Sj}(z)`, which rises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "DeadZoneParts", into = "DeadZoneParts")]
pub struct DeadZones {
    parts: DeadZoneParts,
}

/// Parameters of a sum of dead zones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeadZoneParts {
    /// `c_S`, in the unit of the output.
    pub constant: f64,
    /// `w_S0`, the slope at 0.
    pub linear: f64,
    /// Thresholds `r_Sj`, rising, none of them 0; in the unit of the sum of plays.
    pub thresholds: Vec<f64>,
    /// Weights `w_Sj`: changes of the slope at each threshold, in the direction away from 0.
    pub weights: Vec<f64>,
}

stored_as!(DeadZoneParts of DeadZones in parts);

impl DeadZones {
    /// Dead zones from their parameters.
    ///
    /// # Errors
    /// Thresholds that are not finite and rising, or 0; a weight that is not usable; a slope that is not
    /// positive.
    pub fn new(parts: DeadZoneParts) -> Result<Self> {
        check_count(&parts.thresholds)?;
        check_weights(&parts.thresholds)?;
        check_weights(&parts.weights)?;
        check_weights(&[parts.constant, parts.linear])?;
        if parts.thresholds.contains(&0.0) || parts.thresholds.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(Error::Parts("thresholds of dead zones must rise, and none be 0".into()));
        }
        if parts.thresholds.len() != parts.weights.len() {
            return Err(Error::Parts(format!(
                "{} thresholds and {} weights of dead zones: there must be one for each",
                parts.thresholds.len(),
                parts.weights.len()
            )));
        }
        let zones = Self { parts };
        match zones.slopes().into_iter().find(|&slope| slope <= 0.0) {
            Some(slope) => {
                Err(Error::Parts(format!("dead zones with a slope of {slope}: it must be positive")))
            }
            None => Ok(zones),
        }
    }

    /// As [`DeadZones::new`], without checks, for parameters that a fit still changes.
    pub fn unchecked(parts: DeadZoneParts) -> Self {
        Self { parts }
    }

    /// The parameters.
    pub fn parts(&self) -> &DeadZoneParts {
        &self.parts
    }

    /// The value `S(z)`, in the unit of the output.
    #[inline]
    pub fn value(&self, z: f64) -> f64 {
        let parts = &self.parts;
        let zones = parts.thresholds.iter().zip(&parts.weights);
        // (7.6)
        parts.constant + parts.linear * z + zones.map(|(&r, w)| w * dead_zone(z, r)).sum::<f64>()
    }

    /// The sum of plays `z` with the value `S(z) = y`: `S` rises everywhere.
    pub fn argument(&self, y: f64) -> f64 {
        let parts = &self.parts;
        let (mut z, mut value, mut slope) = (0.0, parts.constant, parts.linear);
        let negative = parts.thresholds.partition_point(|&r| r < 0.0);
        // From zone to zone away from 0, up to the piece that has the value.
        let mut walk = |zones: &mut dyn Iterator<Item = usize>| {
            for zone in zones {
                let at = value + slope * (parts.thresholds[zone] - z);
                if (y - parts.constant).abs() <= (at - parts.constant).abs() {
                    break;
                }
                (z, value) = (parts.thresholds[zone], at);
                slope += parts.weights[zone];
            }
        };
        match y >= parts.constant {
            true => walk(&mut (negative..parts.thresholds.len())),
            false => walk(&mut (0..negative).rev()),
        }
        z + (y - value) / slope
    }

    /// Slopes of all pieces, from the lowest to the highest.
    pub fn slopes(&self) -> Vec<f64> {
        let parts = &self.parts;
        let negative = parts.thresholds.partition_point(|&r| r < 0.0);
        let mut slopes = vec![parts.linear; parts.thresholds.len() + 1];
        for j in (0..negative).rev() {
            slopes[j] = slopes[j + 1] + parts.weights[j];
        }
        for j in negative..parts.thresholds.len() {
            slopes[j + 1] = slopes[j] + parts.weights[j];
        }
        slopes
    }
}

/// A one-sided dead zone `S_r(z)`: `max(z - r, 0)` for `r > 0`, `min(z - r, 0)` for `r < 0`.
#[inline(always)]
pub fn dead_zone(z: f64, r: f64) -> f64 {
    if r > 0.0 { (z - r).max(0.0) } else { (z - r).min(0.0) }
}

impl ModifiedPrandtlIshlinskii {
    /// A model from its two parts.
    pub fn new(hysteresis: PrandtlIshlinskii, superposition: DeadZones) -> Self {
        Self { hysteresis, superposition }
    }

    /// `H`, the sum of plays.
    pub fn hysteresis(&self) -> &PrandtlIshlinskii {
        &self.hysteresis
    }

    /// `S`, the dead zones.
    pub fn superposition(&self) -> &DeadZones {
        &self.superposition
    }
}

impl Law for ModifiedPrandtlIshlinskii {
    type State = Vec<f64>;

    const FACTS: Facts = Facts::linear(
        "modified-prandtl-ishlinskii",
        "plays, then one-sided dead zones (Kuhnen)",
        &["operators", "thresholds", "sign", "dead_zones"],
        ErrorsInside { softening: 0.08, sigmoid: 0.4, other: 0.3 },
    )
    .with_defaults(&[("operators", 20), ("dead_zones", 6)]);

    fn virgin(&self) -> Vec<f64> {
        self.hysteresis.virgin()
    }

    fn step(&self, plays: &mut Vec<f64>, sample: Sample) -> f64 {
        self.superposition.value(self.hysteresis.step(plays, sample))
    }

    /// That of the sum of plays, after the inverse of the polygon (theory.md (12.2)).
    fn input_for(&self, plays: &Vec<f64>, output: f64) -> Option<f64> {
        self.hysteresis.input_for(plays, self.superposition.argument(output))
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let parameter =
            |symbol: String, meaning, value, unit| Parameter::new(symbol, meaning, value, any, unit);
        let parts = &self.superposition.parts;
        let mut all = self.hysteresis.parameters();
        all.push(parameter("c_S".into(), "output constant", parts.constant, Dimension::OUTPUT));
        all.push(parameter("w_S0".into(), "slope of the dead zones at 0", parts.linear, Dimension::NONE));
        for (j, (&r, &w)) in parts.thresholds.iter().zip(&parts.weights).enumerate() {
            all.push(parameter(format!("r_S{}", j + 1), "threshold of a dead zone", r, Dimension::OUTPUT));
            all.push(parameter(format!("w_S{}", j + 1), "weight of a dead zone", w, Dimension::NONE));
        }
        all
    }

    fn memory_properties(&self, _: bool) -> Vec<(Property, bool)> {
        WIPES_OUT.to_vec()
    }
}
