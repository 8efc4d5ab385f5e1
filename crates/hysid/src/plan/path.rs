//! Paths that a machine can run: swings between turning points, within range and rate.

use std::f64::consts::{FRAC_PI_2, PI};

use hysid_core::elementary::cos;
use hysid_core::named;
use serde::{Deserialize, Serialize};

use super::limits::Limits;

/// Fewest rows of a swing, so that a small loop is a loop.
const FEWEST_ROWS: usize = 4;

/// Shape of a swing between two turning points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wave {
    /// Half a cosine: the rate is 0 where the input turns.
    Smooth,
    /// A straight line: the rate is constant.
    Triangle,
}

named!(Wave, "wave": Smooth = "smooth", Triangle = "triangle");

impl Wave {
    /// Largest rate over mean rate of a swing.
    pub fn peak(self) -> f64 {
        match self {
            Self::Smooth => FRAC_PI_2,
            Self::Triangle => 1.0,
        }
    }
}

/// A leg of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leg {
    /// To an input, at this share of the largest rate.
    Swing {
        /// The input at its end.
        to: f64,
        /// Share of the largest rate.
        speed: f64,
    },
    /// So many rows at the same input.
    Hold(usize),
}

/// Makes the rows of legs, within the limits.
#[derive(Debug, Clone, Copy)]
pub struct DrivePath {
    /// Limits of the machine.
    pub limits: Limits,
    /// Shape of swings.
    pub wave: Wave,
}

impl DrivePath {
    /// Number of rows of a leg from an input.
    pub fn rows(&self, from: f64, leg: Leg) -> usize {
        match leg {
            Leg::Hold(rows) => rows,
            Leg::Swing { to, speed } => {
                let longest = speed * self.limits.max_rate * self.limits.time_step();
                // Rounding must not make a row too many.
                let rows = (self.wave.peak() * (to - from).abs() / longest * (1.0 - 1e-12)).ceil();
                (rows as usize).max(FEWEST_ROWS)
            }
        }
    }

    /// Number of rows of legs, one after the other.
    pub fn rows_of(&self, mut from: f64, legs: &[Leg]) -> usize {
        let mut rows = 0;
        for &leg in legs {
            rows += self.rows(from, leg);
            if let Leg::Swing { to, .. } = leg {
                from = to;
            }
        }
        rows
    }

    /// The inputs of a leg, without the one where it begins.
    pub fn leg(&self, from: f64, leg: Leg) -> Vec<f64> {
        let rows = self.rows(from, leg);
        let Leg::Swing { to, .. } = leg else { return vec![from; rows] };
        let (low, high) = self.limits.range;
        let share = |row: usize| {
            let place = row as f64 / rows as f64;
            match self.wave {
                Wave::Smooth => 0.5 * (1.0 - cos(PI * place)),
                Wave::Triangle => place,
            }
        };
        let at = |row: usize| if row == rows { to } else { from + (to - from) * share(row) };
        (1..=rows).map(|row| at(row).clamp(low, high)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_is_as_fast_as_allowed_and_no_faster() {
        let limits = Limits { range: (-1.0, 1.0), start: 0.0, step: Some(0.1), max_rate: 0.5, rows: 500 };
        for (wave, rows) in [(Wave::Smooth, 63), (Wave::Triangle, 40)] {
            let path = DrivePath { limits, wave };
            let leg = Leg::Swing { to: 1.0, speed: 1.0 };
            let x = path.leg(-1.0, leg);
            assert_eq!((x.len(), path.rows_of(-1.0, &[leg])), (rows, rows));
            assert_eq!(*x.last().unwrap(), 1.0);
            let largest = x.windows(2).map(|pair| (pair[1] - pair[0]).abs() / 0.1).fold(0.0, f64::max);
            assert!(largest <= 0.5 + 1e-12 && largest > 0.49, "{largest}");
        }
    }
}
