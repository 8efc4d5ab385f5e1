//! Menegotto-Pinto: steel in cyclic loading, by curves between two straight lines, with the isotropic hardening of
//! Filippou, Popov and Bertero.
//!
//! ```text
//! y = c0 + k x + F q,    d = x/x_y                                                   theory.md (8.47)
//! q = q_r + (q_a - q_r) z/(1 + |z|^R)^{1/R},    z = (d - d_r)/(q_a - q_r)            theory.md (8.48)
//! R = R_0 {1 - a_1 ξ/(a_2 + ξ)},    ξ = |d_m - (d_r + q_a - q_r)|                    theory.md (8.49)
//! upwards q_a = S,  downwards q_a = -ρ S,    S = max{0.1, 1 + a [(d_max - d_min)/2]^0.8}     theory.md (8.50)
//! ```
//!
//! `x` is the input, a strain or displacement, `y` the output, a stress or force. A branch begins at the turning
//! point `(d_r, q_r)` with the slope 1 of elastic loading and approaches the yield stress `q_a`. `d_m` is the
//! largest input so far in the direction of the branch, in yield displacements, and `d_max`, `d_min` are the
//! extremes, 1 and -1 at first: the larger the plastic excursion, the more rounded is the branch (the Bauschinger
//! effect). The virgin branch begins at 0 with `R_0` and `q_a = ±1` (`-ρ` downwards).
//!
//! The hardening line of the literature, of slope `b E`, is the spring: `k = b E` and `F = (1 - b) E x_y`. The law is
//! therefore linear in `k` and `F`.
//!
//! **Small loops.** In Steel02 of OpenSees, the branch after a short unloading runs above the branch that was left.
//! Here, as in steel, the output continues along the earlier branch from where the two meet (theory.md (8.51)), and
//! the later branch is deleted. Small reversals, such as noise of the input, therefore have no lasting effect. A
//! branch is also deleted when the input passes its beginning in the opposite direction, so in cycles of growing
//! amplitude the law is Steel02. Of nested loops, the outermost and the seven innermost branches of each direction
//! are stored.
//!
//! Properties: rate-independent, a closed form between turning points, so that the sampling does not matter.
//! Source: Menegotto and Pinto (1973); Filippou, Popov and Bertero, report EERC 83/19 (1983).

use serde::{Deserialize, Serialize};

use crate::elementary::powf;
use crate::error::{LARGEST_VALUE, Result};
use crate::law::facts::{ErrorsInside, Facts};
use crate::law::properties::ODD;
use crate::law::yield_curve::yielding;
use crate::law::{Dimension, Law, Parameter, Sample};
use crate::property::Property;

/// Bounds of `R_0`.
pub const ROUNDNESS_BOUNDS: (f64, f64) = (0.5, 50.0);

/// Bounds of `a_1`.
pub const LOSS_BOUNDS: (f64, f64) = (0.0, 0.99);

/// Bounds of `a_2`.
pub const PACE_BOUNDS: (f64, f64) = (1e-3, 100.0);

/// Bounds of `a`.
pub const ISOTROPIC_BOUNDS: (f64, f64) = (-1.0, 10.0);

/// Bounds of `ρ`.
pub const RATIO_BOUNDS: (f64, f64) = (0.01, 100.0);

/// Smallest exponent `R`.
const LEAST_ROUNDNESS: f64 = 0.3;

/// Smallest yield stress, as a share of the first one.
const LEAST_STRENGTH: f64 = 0.1;

/// Largest displacement, in yield displacements.
const LARGEST_DISPLACEMENT: f64 = 1e100;

/// Branches that are closer to each other than this, in yield stresses, have met.
const MET: f64 = 1e-12;

/// Length of the chords of branches that are nearly met, in steps of the input.
const STEPS_AHEAD: f64 = 8.0;

/// Branches of a direction that are stored at most, so that a step takes little time.
const MOST_BRANCHES: usize = 8;

/// Yield stress and isotropic hardening downwards, where they differ from those upwards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Downwards {
    /// `ρ > 0`: first yield stress downwards divided by that upwards.
    pub ratio: f64,
    /// `a-`: isotropic hardening of the yield stress downwards.
    pub isotropic: f64,
}

/// A Menegotto-Pinto law in the user's units: `y = c0 + k x + F q` (theory.md (8.47)), with `q` from the equations
/// of the [module page](self).
///
/// ```
/// use hysid_core::law::menegotto_pinto::MenegottoPinto;
/// use hysid_core::law::{Law, Sample};
/// let steel = MenegottoPinto::steel(200.0, 400.0, 0.01)?; // 200 GPa, 400 MPa, strain in mm/m
/// let mut state = steel.virgin();
/// let stress = steel.step(&mut state, Sample { x: 50.0, rate: 0.0, step: 0.0 });
/// assert!((stress - (400.0 + 0.01 * 200.0 * (50.0 - 2.0))).abs() < 1e-6); // far on the hardening line
/// # Ok::<(), hysid_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MenegottoPinto {
    /// `c0`, in the unit of the output.
    pub offset: f64,
    /// `k`: slope of the hardening lines, in the unit of the output divided by that of the input.
    pub hardening_stiffness: f64,
    /// `F`: yield stress upwards without the part of the hardening line, in the unit of the output; negative for an
    /// output that lags behind its input.
    pub strength: f64,
    /// `x_y > 0`: yield displacement, in the unit of the input.
    pub yield_displacement: f64,
    /// `R_0`, 0.5 to 50: sharpness of the bend of the virgin branch.
    pub roundness: f64,
    /// `a_1`, 0 to 0.99: loss of sharpness after large plastic excursions.
    pub loss: f64,
    /// `a_2`, 0.001 to 100: excursion, in yield displacements, after which half of that is lost.
    pub pace: f64,
    /// `a`, -1 to 10: isotropic hardening, negative for softening.
    pub isotropic: f64,
    /// The yield stress downwards; that upwards if `None`.
    pub down: Option<Downwards>,
}

/// A branch from a turning point, in the direction of its movement.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SteelBranch {
    /// `d_r`, with the sign of the direction.
    from: f64,
    /// `q_r`, likewise.
    start: f64,
    /// `q_a - q_r`, likewise; not negative.
    room: f64,
    /// `R`.
    roundness: f64,
    /// Two of its points, `d` and `q` with the sign of the direction.
    chord: [(f64, f64); 2],
}

impl SteelBranch {
    fn new(from: f64, start: f64, room: f64, roundness: f64) -> Self {
        Self { from, start, room, roundness, chord: [(from, start); 2] }
    }

    /// A lower bound of `q` at `d` beyond the first end of the chord: the branch is concave.
    fn least(&self, d: f64) -> f64 {
        let [from, to] = self.chord;
        if d >= to.0 || from.0 >= to.0 {
            return if d >= to.0 { from.1.max(to.1) } else { from.1 };
        }
        from.1 + (to.1 - from.1) * ((d - from.0) / (to.0 - from.0))
    }

    /// `q` at `d`, and a chord for the next few steps as long as this one, `by`.
    fn looked_at(&mut self, d: f64, by: f64) -> f64 {
        let q = self.at(d);
        let ahead = d + STEPS_AHEAD * by;
        let [_, to] = self.chord;
        let to = if to.0 > d && to.0 <= ahead { to } else { (ahead, self.at(ahead)) };
        self.chord = [(d, q), to];
        q
    }

    /// `q` at `d`, both with the sign of the direction (theory.md (8.48)).
    fn at(&self, d: f64) -> f64 {
        if self.room <= 0.0 {
            return self.start;
        }
        let z = ((d - self.from) / self.room).max(0.0);
        self.start + self.room * yielding(z, self.roundness) // (8.48)
    }
}

/// The state: the branches that can still be met, upwards and downwards, the present point and the extremes.
#[derive(Debug, Clone, PartialEq)]
pub struct MenegottoPintoState {
    /// Branches upwards and downwards, the oldest first.
    branches: [Vec<SteelBranch>; 2],
    /// 0 upwards, 1 downwards; `None` before the first movement.
    direction: Option<usize>,
    d: f64,
    q: f64,
    /// `d_max` and `-d_min`.
    extremes: [f64; 2],
}

impl MenegottoPinto {
    /// Steel of this elastic modulus, yield stress and hardening ratio `b`, with the constants that are usual for
    /// reinforcement: `R_0 = 20`, `a_1 = 0.925`, `a_2 = 0.15`, without isotropic hardening.
    ///
    /// # Errors
    /// As [`MenegottoPinto::validated`].
    pub fn steel(modulus: f64, yield_stress: f64, hardening: f64) -> Result<Self> {
        let law = Self {
            offset: 0.0,
            hardening_stiffness: hardening * modulus,
            strength: (1.0 - hardening) * yield_stress,
            yield_displacement: yield_stress / modulus,
            roundness: 20.0,
            loss: 0.925,
            pace: 0.15,
            isotropic: 0.0,
            down: None,
        };
        law.validated()
    }

    /// `S` or `ρ S` after these extremes (theory.md (8.50)).
    fn yield_stress(&self, direction: usize, extremes: [f64; 2]) -> f64 {
        let (ratio, isotropic) = match (direction, self.down) {
            (1, Some(down)) => (down.ratio, down.isotropic),
            _ => (1.0, self.isotropic),
        };
        let excursion = powf((0.5 * (extremes[0] + extremes[1])).max(0.0), 0.8);
        ratio * (1.0 + isotropic * excursion).max(LEAST_STRENGTH) // (8.50)
    }

    /// The branch of a virgin material.
    fn virgin_branch(&self, direction: usize) -> SteelBranch {
        let room = self.down.filter(|_| direction == 1).map_or(1.0, |down| down.ratio);
        SteelBranch::new(0.0, 0.0, room, self.roundness)
    }

    /// The branch from the present point in a direction.
    fn branch(&self, state: &MenegottoPintoState, direction: usize) -> SteelBranch {
        let sign = sign_of(direction);
        let (from, start) = (sign * state.d, sign * state.q);
        let room = (self.yield_stress(direction, state.extremes) - start).max(0.0);
        let excursion = (state.extremes[direction] - (from + room)).abs();
        // (8.49)
        let roundness = self.roundness * (1.0 - self.loss * excursion / (self.pace + excursion));
        SteelBranch::new(from, start, room, roundness.max(LEAST_ROUNDNESS))
    }

    /// Advances to the next input and returns `q`.
    pub fn advance(&self, state: &mut MenegottoPintoState, x: f64) -> f64 {
        let limited = |d: f64| d.clamp(-LARGEST_DISPLACEMENT, LARGEST_DISPLACEMENT);
        let d = limited(x / self.yield_displacement); // (8.47)
        if d == state.d {
            return state.q;
        }
        let direction = usize::from(d < state.d);
        let sign = sign_of(direction);
        if state.direction != Some(direction) {
            self.turn(state, direction);
        }
        let d_along = sign * d;
        // Branches the other way that begin on this path can not be met any more.
        let opposite = &mut state.branches[1 - direction];
        while opposite.last().is_some_and(|branch| -branch.from <= d_along) {
            opposite.pop();
        }
        // (8.51)
        let along = followed(&mut state.branches[direction], d_along, (d - state.d).abs());
        (state.d, state.q) = (d, sign * along);
        state.q
    }

    /// Leaves the present branch and begins one in another direction.
    fn turn(&self, state: &mut MenegottoPintoState, direction: usize) {
        let branch = match state.direction {
            None => self.virgin_branch(direction),
            Some(before) => {
                let sign = sign_of(before);
                if let Some(left) = state.branches[before].last_mut() {
                    left.chord[1] = (sign * state.d, sign * state.q);
                }
                state.extremes[before] = state.extremes[before].max(sign * state.d);
                self.branch(state, direction)
            }
        };
        let branches = &mut state.branches[direction];
        if branches.len() == MOST_BRANCHES {
            // The outermost loop matters most, and the innermost ones are met next.
            branches.remove(1);
        }
        for earlier in branches.iter_mut() {
            earlier.chord[0] = (branch.from, earlier.at(branch.from));
        }
        branches.push(branch);
        state.direction = Some(direction);
    }
}

/// The smallest `q` of the branches at `d` (theory.md (8.51)). Branches later than its own have met it and are
/// deleted. An earlier branch is only evaluated where the last one may have met it. `by` is the length of this step.
fn followed(branches: &mut Vec<SteelBranch>, d: f64, by: f64) -> f64 {
    let Some((last, earlier)) = branches.split_last_mut() else { return 0.0 };
    let (mut least, mut kept) = (last.at(d), earlier.len() + 1);
    for (index, branch) in earlier.iter_mut().enumerate().rev() {
        if least < branch.least(d) - 2.0 * MET {
            continue;
        }
        let q = branch.looked_at(d, by);
        if least >= q - MET {
            (least, kept) = (q, index + 1);
        }
    }
    branches.truncate(kept);
    least
}

/// 1 upwards, -1 downwards.
fn sign_of(direction: usize) -> f64 {
    if direction == 0 { 1.0 } else { -1.0 }
}

impl Law for MenegottoPinto {
    type State = MenegottoPintoState;

    const FACTS: Facts = Facts {
        variants: &["asymmetric"],
        ..Facts::searched(
            "menegotto-pinto",
            "steel: curves between two straight lines, with hardening",
            &["asymmetric", "starts", "epochs"],
            ErrorsInside { softening: 0.06, sigmoid: 0.3, other: 0.3 },
        )
        .with_defaults(&[("starts", 16)])
    };

    fn virgin(&self) -> MenegottoPintoState {
        MenegottoPintoState {
            branches: [Vec::new(), Vec::new()],
            direction: None,
            d: 0.0,
            q: 0.0,
            extremes: [1.0, 1.0],
        }
    }

    fn step(&self, state: &mut MenegottoPintoState, sample: Sample) -> f64 {
        let x = sample.limited().x;
        let q = self.advance(state, x);
        // (8.47)
        (self.offset + self.hardening_stiffness * x + self.strength * q).clamp(-f64::MAX, f64::MAX)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        let positive = (f64::MIN_POSITIVE, LARGEST_VALUE);
        let number = |symbol, meaning, value, bounds| (symbol, meaning, value, bounds, Dimension::NONE);
        let mut all = Parameter::table([
            ("c0", "output at rest", self.offset, any, Dimension::OUTPUT),
            ("k", "slope of the hardening lines", self.hardening_stiffness, any, Dimension::SLOPE),
            ("F", "yield stress without hardening", self.strength, any, Dimension::OUTPUT),
            ("x_y", "yield displacement", self.yield_displacement, positive, Dimension::INPUT),
            number("R_0", "sharpness of the virgin bend", self.roundness, ROUNDNESS_BOUNDS),
            number("a_1", "loss of sharpness", self.loss, LOSS_BOUNDS),
            number("a_2", "plastic excursion of half that loss", self.pace, PACE_BOUNDS),
            number("a", "isotropic hardening", self.isotropic, ISOTROPIC_BOUNDS),
        ]);
        all.extend(self.down.iter().flat_map(|down| {
            Parameter::table([
                number("ρ", "yield stress downwards by that upwards", down.ratio, RATIO_BOUNDS),
                number("a-", "isotropic hardening downwards", down.isotropic, ISOTROPIC_BOUNDS),
            ])
        }));
        all
    }

    fn validated(self) -> Result<Self> {
        Parameter::check_all(&self.parameters(), "Menegotto-Pinto")?;
        Ok(self)
    }

    fn memory_properties(&self, about_origin: bool) -> Vec<(Property, bool)> {
        (self.down.is_none() && about_origin).then_some(ODD).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::powi;
    use crate::law::test_paths::{assert_finite, numbers, refined, run};

    fn steel() -> MenegottoPinto {
        MenegottoPinto {
            offset: 3.0,
            isotropic: 0.03,
            down: Some(Downwards { ratio: 0.9, isotropic: 0.05 }),
            roundness: 15.0,
            ..MenegottoPinto::steel(200.0, 400.0, 0.015).unwrap()
        }
    }

    /// Steel02 as its reference describes it, without a memory of earlier branches.
    fn steel_02(path: &[f64]) -> Vec<f64> {
        let (modulus, strength, b, r_0, c_1, c_2, a_1, a_2) =
            (200.0, 400.0, 0.015, 15.0, 0.925, 0.15, 0.04, 1.7);
        let (yield_strain, hardening) = (strength / modulus, b * modulus);
        let (mut strain, mut stress) = (0.0, 0.0);
        let mut extremes = (-yield_strain, yield_strain);
        let (mut reversal, mut intersection) = ((0.0, 0.0), (0.0, 0.0));
        let (mut upwards, mut exponent) = (None, r_0);
        let mut all = Vec::new();
        for &next in path {
            let rises = next > strain;
            if upwards != Some(rises) {
                let sign = if rises { 1.0 } else { -1.0 };
                extremes = (f64::min(extremes.0, strain), f64::max(extremes.1, strain));
                reversal = (strain, stress);
                let shift = if upwards.is_none() {
                    1.0
                } else {
                    1.0 + a_1 * powf((extremes.1 - extremes.0) / (2.0 * a_2 * yield_strain), 0.8)
                };
                // Elastic line through the reversal, hardening line through the shifted yield point.
                let height = sign * strength * shift - hardening * sign * yield_strain * shift;
                let at = (height - stress + modulus * strain) / (modulus - hardening);
                intersection = (at, height + hardening * at);
                let excursion = (if rises { extremes.1 } else { extremes.0 } - at).abs() / yield_strain;
                if upwards.is_some() {
                    exponent = r_0 * (1.0 - c_1 * excursion / (c_2 + excursion));
                }
                upwards = Some(rises);
            }
            let share: f64 = (next - reversal.0) / (intersection.0 - reversal.0);
            let curve = b * share + (1.0 - b) * share / powf(1.0 + powf(share, exponent), 1.0 / exponent);
            stress = reversal.1 + curve * (intersection.1 - reversal.1);
            strain = next;
            all.push(stress);
        }
        all
    }

    #[test]
    fn growing_cycles_are_those_of_steel_02() {
        let law = MenegottoPinto {
            roundness: 15.0,
            isotropic: 0.04 / powf(1.7, 0.8),
            ..MenegottoPinto::steel(200.0, 400.0, 0.015).unwrap()
        };
        let path = refined(&[3.0, -4.0, 6.0, -9.0, 9.5, -15.0, 20.0, -20.5, 30.0], 40);
        for ((stress, expected), x) in run(&law, &path).iter().zip(steel_02(&path)).zip(&path) {
            assert!((stress - expected).abs() < 1e-9, "at {x}: {stress} and {expected}");
        }
    }

    #[test]
    fn a_small_loop_is_forgotten_where_it_meets_the_branch_that_was_left() {
        let law = steel();
        let whole = run(&law, &[10.0, -8.0, 3.0, 6.0, 12.0]);
        let looped = run(&law, &[10.0, -8.0, 3.0, 2.0, 2.7, 2.2, 6.0, 5.0, 12.0]);
        assert_eq!([whole[3], whole[4]], [looped[6], looped[8]]);
        // Steel02 runs above it.
        let [whole, looped] = [&[10.0, -8.0, 3.0, 6.0][..], &[10.0, -8.0, 3.0, 2.0, 6.0]].map(steel_02);
        assert!(looped[4] > whole[3] + 10.0, "{} and {}", looped[4], whole[3]);
    }

    #[test]
    fn outputs_stay_within_their_bound_however_wild() {
        let extremes = [1e-300, 1e-100, 1e-3, 1.0, 1e6, 1e99];
        for (index, u) in numbers(54_321, 300).into_iter().enumerate() {
            let pick = |by: usize| extremes[(index / by) % extremes.len()];
            let law = MenegottoPinto {
                strength: u.signum() * pick(1),
                yield_displacement: pick(6),
                roundness: if u > 0.5 { 50.0 } else { 0.5 },
                loss: u.abs().min(0.99),
                isotropic: 0.8 * u,
                ..steel()
            };
            let path: Vec<f64> = numbers(54_321, 60).iter().map(|v| v * pick(3)).collect();
            assert_finite(&law, &path);
        }
    }

    #[test]
    fn the_branch_that_is_followed_is_the_least_of_all() {
        let law = steel();
        let mut state = law.virgin();
        for to in refined(&numbers(54_321, 300).iter().map(|u| 10.0 * u).collect::<Vec<f64>>(), 11) {
            let before = state.clone();
            let q = law.advance(&mut state, to);
            let direction = state.direction.unwrap();
            if before.direction == Some(direction) {
                let sign = sign_of(direction);
                let all = before.branches[direction].iter().map(|branch| branch.at(sign * state.d));
                assert!((sign * q - all.fold(f64::INFINITY, f64::min)).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn few_branches_are_stored_and_those_behind_are_forgotten() {
        let (law, mut state) = (steel(), steel().virgin());
        for k in 0..200 {
            let x = 10.0 * powi(0.97, k) * if k % 2 == 0 { 1.0 } else { -1.0 };
            law.advance(&mut state, x);
            assert!(state.branches.iter().all(|branches| branches.len() <= MOST_BRANCHES));
        }
        law.advance(&mut state, -20.0);
        assert!(state.branches[0].is_empty());
        law.advance(&mut state, 20.0);
        assert!(state.branches[1].is_empty() && state.branches[0].len() == 1);
    }
}
