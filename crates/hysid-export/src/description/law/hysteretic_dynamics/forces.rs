//! The forces of the elements at the end of a step, which follow from the displacements that they cause.

use super::{DynamicsElements, DynamicsParts};
use crate::program::expression::{Real, RealVariable, Whole};
use crate::program::{Builder, Precision};

// Numbers of the library's solver.
const MOST_TRIALS: usize = 40;
const TRIALS_IN_HASTE: usize = 6;
const LARGEST_SLOPE: f64 = 1e3;
const STEEPEST_SLOPE: f64 = 0.9;

/// Improvements of the derivatives of the forces by the input.
const PASSES: usize = 3;

/// Differences of forces, relative to the largest.
struct ForceDifferences {
    /// Least difference of two trials that determines the slope.
    least_difference: f64,
    /// Largest mismatch that is neglected.
    tolerance: f64,
    /// Distance of the trial that determines the slope for derivatives.
    probe: f64,
}

impl ForceDifferences {
    fn of(precision: Precision) -> Self {
        match precision {
            Precision::Double => Self { least_difference: 1e-9, tolerance: 1e-12, probe: 1e-6 },
            Precision::Single => Self { least_difference: 1e-4, tolerance: 1e-6, probe: 1e-2 },
        }
    }
}

impl DynamicsParts<'_> {
    /// Finds forces `r` with `R(r) = r`, where `R` follows from the displacements under `r` (theory.md (15.11)).
    pub(super) fn find_forces(&self, builder: &mut Builder, elements: &DynamicsElements<'_>, input: &Real) {
        let (count, sizes) = (elements.count(), ForceDifferences::of(builder.precision()));
        builder.each(0_usize, count, |builder, e| {
            let before = builder.value(elements.forces_before.at(&e));
            let here = builder.value(elements.forces.at(&e));
            builder.set(elements.forces_before, &e, &here);
            let ahead = builder.value(2.0 * here - before);
            let first = builder.value(elements.limited(&e, &ahead));
            builder.set(elements.forces, &e, &first);
            builder.set(elements.tried, &e, first);
            builder.set(elements.tried_following, &e, 0.0);
        });
        let enclosed = (count == 1).then(|| {
            let largest = builder.value(elements.largest.at(0_usize));
            (builder.variable(-&largest), builder.variable(&largest))
        });
        let trial = builder.whole_variable(0_usize);
        let is_even = builder.variable(1.0);
        let goes_on = builder.variable(1.0);
        builder.while_true(Real::from(goes_on).above(0.0), |builder| {
            builder.assign_whole(trial, Whole::from(trial) + 1_usize);
            builder.assign(is_even, 1.0 - Real::from(is_even));
            self.follow(builder, elements, input);
            builder.assign(goes_on, 0.0);
            builder.when(Whole::from(trial).below(MOST_TRIALS), |builder| {
                builder.each(0_usize, count, |builder, e| {
                    let mismatch = elements.following.at(&e) - elements.forces.at(&e);
                    let is_found = mismatch.abs().at_most(sizes.tolerance * elements.largest.at(&e));
                    builder.when(is_found.negated(), |builder| builder.assign(goes_on, 1.0));
                });
            });
            builder.when(Real::from(goes_on).above(0.0), |builder| {
                builder.each(0_usize, count, |builder, e| {
                    elements.assume_next(builder, &e, &sizes);
                });
                if let Some(enclosed) = enclosed {
                    elements.enclose(builder, enclosed, (&trial.into(), &is_even.into()));
                }
            });
        });
        builder.for_slope(|builder| self.derive_forces(builder, elements, input, &sizes));
    }

    /// The modes and the elements under the assumed forces.
    fn follow(&self, builder: &mut Builder, elements: &DynamicsElements<'_>, input: &Real) {
        self.move_modes(builder);
        for element in &elements.each {
            element.go(builder, (self.displacements, self.velocities), input);
        }
    }

    /// The derivatives of the forces by the input: each pass moves them by their mismatch over `1 - ∂R/∂r`, as trials
    /// move the forces themselves, which stay as they are. Before, a trial beside the forces gives `∂R/∂r`.
    fn derive_forces(
        &self,
        builder: &mut Builder,
        elements: &DynamicsElements<'_>,
        input: &Real,
        sizes: &ForceDifferences,
    ) {
        let count = elements.count();
        let [found, followed] = [elements.tried, elements.tried_following];
        let slopes = elements.probed;
        let by = |e: &Whole| sizes.probe * elements.largest.at(e);
        builder.each(0_usize, PASSES + 1, |builder, pass| {
            builder.when_else(
                pass.equals(0_usize),
                |builder| {
                    builder.each(0_usize, count, |builder, e| {
                        builder.set(found, &e, elements.forces.at(&e));
                        builder.set(followed, &e, elements.following.at(&e));
                        builder.set(elements.forces, &e, elements.forces.at(&e) + by(&e));
                    });
                },
                |builder| {
                    builder.when(pass.equals(1_usize), |builder| {
                        builder.each(0_usize, count, |builder, e| {
                            let by = builder.value(by(&e));
                            let difference = elements.following.at(&e) - followed.at(&e);
                            let slope = builder.value(by.above(0.0).choose(difference / by, 0.0).detached());
                            builder.set(slopes, &e, slope.clamp(-LARGEST_SLOPE, STEEPEST_SLOPE));
                            builder.set(elements.forces, &e, found.at(&e));
                            builder.set(elements.following, &e, followed.at(&e));
                        });
                    });
                    builder.each(0_usize, count, |builder, e| {
                        let force = builder.value(elements.forces.at(&e));
                        let mismatch = elements.following.at(&e) - &force;
                        let change = builder.value(mismatch / (1.0 - slopes.at(&e)));
                        builder.set(elements.forces, &e, force + (&change - change.detached()));
                    });
                },
            );
            self.follow(builder, elements, input);
        });
    }
}

impl DynamicsElements<'_> {
    fn limited(&self, e: &Whole, force: &Real) -> Real {
        let largest = self.largest.at(e);
        force.clamp(-&largest, largest)
    }

    /// Assumes the force next that the mismatch over `1 - ∂R/∂r` gives.
    fn assume_next(&self, builder: &mut Builder, e: &Whole, sizes: &ForceDifferences) {
        let assumed = builder.value(self.forces.at(e));
        let follows = builder.value(self.following.at(e));
        // The first trial is compared with itself, which tells nothing.
        let by = builder.value(&assumed - self.tried.at(e));
        let tells = by.abs().above(sizes.least_difference * self.largest.at(e));
        builder.when(tells, |builder| {
            let slope = builder.value((&follows - self.tried_following.at(e)) / &by);
            builder.set(self.slopes, e, slope.clamp(-LARGEST_SLOPE, STEEPEST_SLOPE).detached());
        });
        builder.set(self.tried, e, &assumed);
        builder.set(self.tried_following, e, &follows);
        let next = builder.value(&assumed + (&follows - &assumed) / (1.0 - self.slopes.at(e)));
        builder.set(self.forces, e, self.limited(e, &next));
    }

    /// Keeps a single force between bounds at which its mismatch has different signs.
    fn enclose(
        &self,
        builder: &mut Builder,
        (low, high): (RealVariable, RealVariable),
        (trial, is_even): (&Whole, &Real),
    ) {
        let assumed = builder.value(self.tried.at(0_usize));
        let mismatch = builder.value(self.tried_following.at(0_usize) - &assumed);
        builder.when_else(
            mismatch.above(0.0),
            |builder| builder.assign(low, &assumed),
            |builder| builder.assign(high, &assumed),
        );
        let next = builder.value(self.forces.at(0_usize));
        let is_inside = next.above(low).and(next.below(high));
        let is_late = trial.above(TRIALS_IN_HASTE).and(is_even.above(0.0));
        builder.when(is_inside.negated().or(is_late), |builder| {
            builder.set(self.forces, 0_usize, 0.5 * (Real::from(low) + high));
        });
    }
}
