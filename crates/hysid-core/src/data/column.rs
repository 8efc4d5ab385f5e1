//! Meaning of a column from its values and its name: a counter or time is no input, two columns may be one
//! signal, and a force is usually the output.

mod words;

use crate::data::unit;
use crate::data::usual_role::{Domain, UsualRole};

/// Least number of values from which a course is found.
const FEWEST: usize = 10;

/// Least correlation, in magnitude, of columns that are one signal: a tenth of a standard deviation apart.
const ONE_SIGNAL: f64 = 0.995;

/// How the values of a column change from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// Whole numbers, each one more than that before.
    Counts,
    /// Every value is larger than the one before.
    Grows,
    /// Whole numbers that stay for some rows, and then grow by one.
    CountsInSteps,
    /// One value throughout.
    Constant,
    /// Values rise and fall, or there are too few of them.
    Varies,
}

impl Course {
    /// The course of a column, from its values in each record.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a [f64]> + Clone) -> Self {
        if records.clone().into_iter().map(<[f64]>::len).sum::<usize>() < FEWEST {
            return Self::Varies;
        }
        let steps = || {
            let records = records.clone().into_iter();
            records.flat_map(|values| values.windows(2).map(|pair| (pair[0], pair[1] - pair[0])))
        };
        let is_whole = || records.clone().into_iter().flatten().all(|value| value.fract() == 0.0);
        let mut values = records.clone().into_iter().flatten();
        let first = values.next();
        if values.all(|value| Some(value) == first) {
            return Self::Constant;
        }
        if steps().all(|(_, step)| step > 0.0) {
            return if is_whole() && steps().all(|(_, step)| step == 1.0) {
                Self::Counts
            } else {
                Self::Grows
            };
        }
        let rises = steps().filter(|(_, step)| *step == 1.0).count();
        let is_stair = steps().all(|(_, step)| step == 0.0 || step == 1.0);
        // Of few rows to a step, and of a single step, it may be a measured one too.
        if is_stair && is_whole() && rises >= 2 && 3 * rises <= steps().count() {
            return Self::CountsInSteps;
        }
        Self::Varies
    }
}

/// The correlation of two columns if they are one signal; otherwise `None`.
pub fn one_signal(a: &[f64], b: &[f64]) -> Option<f64> {
    correlation(a, b).filter(|correlation| correlation.abs() >= ONE_SIGNAL)
}

/// The correlation of two columns over the rows that both have; `None` for few rows.
pub fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let rows = || a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite());
    let count = rows().count();
    if count < FEWEST {
        return None;
    }
    let (sum_a, sum_b) = rows().fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    let (mean_a, mean_b) = (sum_a / count as f64, sum_b / count as f64);
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in rows() {
        let (x, y) = (x - mean_a, y - mean_b);
        (aa, ab, bb) = (aa + x * x, ab + x * y, bb + y * y);
    }
    Some(ab / (aa * bb).sqrt())
}

impl UsualRole {
    /// The role that the name and unit of a column indicate; `None` if they indicate none.
    pub fn of(name: &str) -> Option<Self> {
        let (quantity, unit) = unit::split(name);
        if let Some(part) = words::part(quantity) {
            return Some(part);
        }
        match (quantity, &unit) {
            ("H", None) => Some(Self::Drives(Domain::Magnetism)),
            ("B", None) => Some(Self::Follows(Domain::Magnetism)),
            (_, Some(unit)) => unit::part(unit),
            _ => None,
        }
    }

    /// True if these roles of an input and an output are interchanged: a force in place of the input and a displacement
    /// in place of the output, or the voltage of an actuator in place of the output.
    pub fn are_swapped(input: Option<Self>, output: Option<Self>) -> bool {
        match (input, output) {
            (Some(Self::Follows(one)), Some(Self::Drives(other))) if one == other => true,
            (Some(input), Some(Self::Drives(Domain::Electricity))) => {
                input.domain() == Some(Domain::Mechanics)
            }
            (Some(input), Some(Self::Drives(Domain::Magnetism))) => input.domain() == Some(Domain::Mechanics),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};

    #[test]
    fn courses_are_told_apart() {
        let of = |value: &dyn Fn(f64) -> f64| -> Course {
            let values: Vec<f64> = (0..30).map(|k| value(f64::from(k))).collect();
            Course::of([values.as_slice()])
        };
        assert_eq!(of(&|k| k + 1.0), Course::Counts);
        assert_eq!(of(&|k| 0.1 * k), Course::Grows);
        assert_eq!(of(&|k| 2.0 * k), Course::Grows);
        assert_eq!(of(&|k| (k / 10.0).floor()), Course::CountsInSteps);
        assert_eq!(of(&|k| f64::from(k > 10.0)), Course::Varies);
        assert_eq!(of(&|_| 20.0), Course::Constant);
        assert_eq!(of(&|k| sin(k)), Course::Varies);
        // Every record begins anew.
        let count: Vec<f64> = (0..30).map(|k| f64::from(k % 10)).collect();
        assert_eq!(Course::of(count.chunks(10)), Course::Counts);
        assert_eq!(Course::of([count.as_slice()]), Course::Varies);
        assert_eq!(Course::of([&count[..9]]), Course::Varies, "too few");
    }

    #[test]
    fn one_signal_is_told_from_two() {
        let column = |value: &dyn Fn(f64) -> f64| (0..200).map(|k| value(0.1 * f64::from(k))).collect();
        let command: Vec<f64> = column(&sin);
        let measured: Vec<f64> = column(&|k| -2.0 * sin(k - 0.02) + 0.01 * cos(7.0 * k) + 5.0);
        let other: Vec<f64> = column(&|k| sin(k - 0.5));
        assert!(one_signal(&command, &measured).unwrap() < -0.99);
        assert_eq!(one_signal(&command, &other), None);
        assert_eq!(one_signal(&command, &[1.0; 200]), None);
    }

    #[test]
    fn forces_follow_displacements() {
        let swapped =
            |input: &str, output: &str| UsualRole::are_swapped(UsualRole::of(input), UsualRole::of(output));
        let pairs = |text: &'static str| text.split("; ").map(|pair| pair.split_once(" | ").unwrap());
        for (drives, follows) in pairs(
            "disp_mm | force_kN; x_mm | F_N; strain_true | stress_true_MPa; Weg [mm] | Kraft [kN]; \
             H_A_per_m | B_T; H | B; V_V | P_uC_per_cm2; theta_deg | M_kN_m",
        ) {
            assert!(swapped(follows, drives), "{follows} {drives}");
            assert!(!swapped(drives, follows), "{drives} {follows}");
        }
        for (input, output) in pairs(
            "Kraft | Weg; Effort (kN) | Déplacement (mm); Fuerza | Desplazamiento; \
             Сила | Перемещение; 荷重(kN) | 変位(mm); 恢复力 | 位移; 磁感应强度 | 磁场强度; \
             displacement_um | voltage_V; y_um | current_A",
        ) {
            assert!(swapped(input, output), "{input} {output}");
            assert!(!swapped(output, input), "{output} {input}");
        }
        assert_eq!(UsualRole::of("Temperature [°C]"), Some(UsualRole::Accompanies));
        assert_eq!(UsualRole::of("T_K"), Some(UsualRole::Accompanies));
        // The unit decides.
        assert_eq!(UsualRole::of("Spannung"), None);
        assert_eq!(UsualRole::of("Spannung [MPa]"), Some(UsualRole::Follows(Domain::Mechanics)));
        assert_eq!(UsualRole::of("Spannung [V]"), Some(UsualRole::Drives(Domain::Electricity)));
        for (input, output) in pairs(
            "u_V | y_um; x | y; H_fit_V | B_V_us; excitation_force_N | displacement_m; \
             Anregung [N] | Weg [mm]; 加振力(N) | 変位(mm); excitation [V] | current [A]",
        ) {
            assert!(!swapped(input, output), "{input} {output}");
        }
    }
}
