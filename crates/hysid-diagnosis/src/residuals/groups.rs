//! Where is the residual large, and where is it biased?
//!
//! ```text
//! F = (R m)ᵀ (R C Rᵀ)⁻¹ (R m)/q · (ν - q + 1)/ν  ~  F_{q, ν-q+1}                theory.md (13.8)
//! ```
//!
//! `m` are the means of the residual (for its bias) or of its square (for its size) in the groups of rows, `R` their
//! `q` differences, `C` the covariance of the means by theory.md (13.1) and `ν` its degrees of freedom: the test of
//! Wald with the scaling of Hotelling for an estimated covariance. Rows that are correlated in time count as fewer.

use hysid_core::linear_algebra::Symmetric;
use hysid_core::stop_check::StopCheck;
use serde::Serialize;

use super::ResidualTest;
use super::rows::{AFTER_A_TURN, ResidualRow, ResidualRows};
use crate::distribution::f_tail;
use crate::serial::{SerialSum, correlation_lag};

const FEWEST_ROWS: usize = 20;

/// Least ratio of the upper to the lower decile of a quantity that is divided into classes.
const LEAST_RATIO: f64 = 1.2;

/// Fewest degrees of freedom with which groups are compared.
const FEWEST_DEGREES: f64 = 4.0;

/// Least ratio of the mean speeds of half cycles that have different speeds.
const SEVERAL_SPEEDS: f64 = 1.5;

/// Size and bias of the residual in groups of rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupedResiduals {
    /// The test.
    pub test: ResidualTest,
    /// The groups, in their order; empty if not testable.
    pub groups: Vec<ResidualGroup>,
    /// Probability of so different root mean squares if the residual is alike everywhere.
    pub size_p_value: Option<f64>,
    /// Probability of so different means.
    pub bias_p_value: Option<f64>,
    /// Why it is not testable.
    pub not_testable: Option<String>,
    /// Other causes that the groups may point to, beside their name.
    pub caution: Option<String>,
}

/// Rows of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualGroup {
    /// Common property of the rows.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Root mean square of the residual, in the unit of the output.
    pub rms: f64,
    /// Mean of the residual, in the unit of the output.
    pub bias: f64,
    /// Smallest and largest value of the quantity that divides the rows, in its unit, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
}

/// All places, in the order of [`ResidualTest`].
pub(super) fn places(rows: &ResidualRows) -> Vec<GroupedResiduals> {
    let divided = |test, names: &[&str], group: &dyn Fn(&ResidualRow) -> Option<usize>| {
        compared(test, names.iter().map(|name| ((*name).to_string(), None)).collect(), rows, group)
    };
    let after = format!("first {:.0} % of the way after a turning point", 100.0 * AFTER_A_TURN);
    let classes = |test, names, what, quantity| classes(test, names, what, rows, quantity);
    let mut by_speed =
        classes(ResidualTest::Speed, ["slow", "medium", "fast"], "the speed of the input", |row| {
            row.rate.abs()
        });
    if by_speed.not_testable.is_none() && !has_several_speeds(&rows.speeds) {
        by_speed.caution = Some(
            "all half cycles have about the same mean speed, so that slow and fast rows are also different places of \
             the half cycle"
                .into(),
        );
    }
    vec![
        divided(ResidualTest::TurningPoints, &[&after, "elsewhere"], &|row| {
            row.after_a_turn.map(|after| usize::from(!after))
        }),
        by_speed,
        classes(
            ResidualTest::Amplitude,
            ["small", "medium", "large"],
            "the amplitude of the half cycles",
            |row| row.amplitude,
        ),
        classes(
            ResidualTest::Distance,
            ["near", "medium", "far"],
            "the distance of the input from its mean",
            |row| row.distance,
        ),
        divided(ResidualTest::Direction, &["rising input", "falling input"], &|row| {
            Some(usize::from(!row.rises))
        }),
        divided(ResidualTest::Time, &["beginning", "middle", "end"], &|row| Some(row.third)),
    ]
}

/// True if half cycles were run at different speeds.
fn has_several_speeds(speeds: &[f64]) -> bool {
    let mut sorted = speeds.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or_default();
    sorted.len() > 1 && at(0.9) > SEVERAL_SPEEDS * at(0.1)
}

/// Thirds of the rows by a quantity.
fn classes(
    test: ResidualTest,
    names: [&str; 3],
    what: &str,
    rows: &ResidualRows,
    quantity: fn(&ResidualRow) -> f64,
) -> GroupedResiduals {
    let mut values: Vec<f64> = rows.records.iter().flatten().map(quantity).collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((share * values.len() as f64) as usize).min(values.len() - 1)];
    if at(0.9) <= LEAST_RATIO * at(0.1) {
        return untestable(test, format!("{what} hardly varies"));
    }
    let limits = [at(1.0 / 3.0), at(2.0 / 3.0)];
    let largest = values[values.len() - 1];
    // Where many rows have the largest value, they are a class of their own.
    let is_above = |value: f64, limit: f64| if limit == largest { value >= limit } else { value > limit };
    let class = |row: &ResidualRow| limits.iter().filter(|limit| is_above(quantity(row), **limit)).count();
    let ends = [values[0], limits[0], limits[1], largest];
    let named = names.iter().zip(ends.windows(2));
    let groups = named.map(|(name, ends)| ((*name).to_string(), Some((ends[0], ends[1])))).collect();
    compared(test, groups, rows, &|row| Some(class(row)))
}

fn untestable(test: ResidualTest, why: String) -> GroupedResiduals {
    GroupedResiduals {
        test,
        groups: Vec::new(),
        size_p_value: None,
        bias_p_value: None,
        not_testable: Some(why),
        caution: None,
    }
}

/// Name of a group, and the range of its quantity.
type Named = (String, Option<(f64, f64)>);

/// Compares groups of rows; rows of no group are left out.
fn compared(
    test: ResidualTest,
    names: Vec<Named>,
    rows: &ResidualRows,
    group: &dyn Fn(&ResidualRow) -> Option<usize>,
) -> GroupedResiduals {
    let count = names.len();
    let groups: Vec<Vec<Option<usize>>> =
        rows.records.iter().map(|rows| rows.iter().map(group).collect()).collect();
    let residual = rows.residual();
    let square: Vec<Vec<f64>> =
        residual.iter().map(|record| record.iter().map(|e| e * e).collect()).collect();
    let bias = Means::of(&residual, &groups, count);
    let size = Means::of(&square, &groups, count);
    let found: Vec<ResidualGroup> = names
        .into_iter()
        .enumerate()
        .map(|(at, (name, range))| ResidualGroup {
            name,
            range,
            rows: size.rows[at],
            rms: size.means[at].sqrt(),
            bias: bias.means[at],
        })
        .filter(|group| group.rows > 0)
        .collect();
    if found.len() < 2 || found.iter().any(|group| group.rows < FEWEST_ROWS) {
        let smallest = found.iter().map(|group| group.rows).min().unwrap_or_default();
        let why = match found.len() < 2 {
            true => "all rows are of one kind".to_string(),
            false => format!("one of the groups has only {smallest} rows"),
        };
        return untestable(test, why);
    }
    let (Some(bias_p_value), Some(size_p_value)) = (bias.p_value(&groups), size.p_value(&groups)) else {
        return untestable(
            test,
            "the residual is correlated over so many rows that too few independent ones are left".into(),
        );
    };
    GroupedResiduals {
        test,
        groups: found,
        size_p_value: Some(size_p_value),
        bias_p_value: Some(bias_p_value),
        not_testable: None,
        caution: None,
    }
}

/// Means of a quantity in groups of rows.
struct Means {
    rows: Vec<usize>,
    means: Vec<f64>,
    /// The quantity of each row about the mean of its group; 0 for a row of none.
    about: Vec<Vec<f64>>,
}

impl Means {
    fn of(values: &[Vec<f64>], groups: &[Vec<Option<usize>>], count: usize) -> Self {
        let (mut rows, mut sums) = (vec![0; count], vec![0.0; count]);
        for (value, group) in values.iter().flatten().zip(groups.iter().flatten()) {
            if let Some(group) = *group {
                rows[group] += 1;
                sums[group] += value;
            }
        }
        let means: Vec<f64> = sums.iter().zip(&rows).map(|(sum, &rows)| sum / (rows.max(1) as f64)).collect();
        let about = values
            .iter()
            .zip(groups)
            .map(|(values, groups)| {
                let about =
                    |(value, group): (&f64, &Option<usize>)| group.map_or(0.0, |group| value - means[group]);
                values.iter().zip(groups).map(about).collect()
            })
            .collect();
        Self { rows, means, about }
    }

    /// The probability of means as different; `None` if too few rows are independent.
    fn p_value(&self, groups: &[Vec<Option<usize>>]) -> Option<f64> {
        let kept: Vec<usize> = (0..self.rows.len()).filter(|&group| self.rows[group] > 0).collect();
        let width = kept.len();
        let scores: Vec<Vec<f64>> = self
            .about
            .iter()
            .zip(groups)
            .map(|(about, groups)| {
                let mut scores = vec![0.0; width * about.len()];
                for (row, (value, group)) in about.iter().zip(groups).enumerate() {
                    if let Some(at) = group.and_then(|group| kept.iter().position(|&kept| kept == group)) {
                        scores[row * width + at] = *value;
                    }
                }
                scores
            })
            .collect();
        let sums = SerialSum::of(&scores, width, correlation_lag(&self.about), width);
        let q = width - 1;
        let degrees = sums.degrees - q as f64 + 1.0;
        if degrees < FEWEST_DEGREES {
            return None;
        }
        // Covariances of the means, and of their differences from the last one.
        let of_means = |i: usize, j: usize| {
            sums.covariance.at(i, j) / (self.rows[kept[i]] as f64 * self.rows[kept[j]] as f64)
        };
        let of_differences =
            |i: usize, j: usize| of_means(i, j) - of_means(i, q) - of_means(j, q) + of_means(q, q);
        let differences: Vec<f64> = (0..q).map(|i| self.means[kept[i]] - self.means[kept[q]]).collect();
        // Without scatter there is no doubt: equal means, or different ones.
        let Some(factor) = Symmetric::from_fn(q, of_differences).cholesky(StopCheck::never()) else {
            return Some(if differences.iter().all(|d| *d == 0.0) { 1.0 } else { 0.0 });
        };
        let mut solved = differences.clone();
        factor.solve(&mut solved);
        let wald: f64 = solved.iter().zip(&differences).map(|(a, b)| a * b).sum();
        Some(f_tail(wald / q as f64 * degrees / sums.degrees, q as f64, degrees))
    }
}
