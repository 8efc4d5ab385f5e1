//! Objective of a start: the error of the free run over records, with a penalty on weights.

use std::ops::Range;

use hysid_core::elementary::ln;

use super::EXPECTED_SQUARE;
use crate::error::LARGEST_VALUE;
use crate::law::hysteretic_dynamics::{
    DAMPING_RATIOS, Dynamics, DynamicsDrive, DynamicsLayout, DynamicsRun, LARGEST_WEIGHT,
};
use crate::linear_algebra::{Gram, Symmetric};
use crate::optimise::levenberg_marquardt::{DescentSettings, LeastSquaresProblem, Slope, step_within};
use crate::optimise::parallel;
use crate::stop_check::StopCheck;

/// Bounds of the leak, in standard deviations of the displacement; slower states would drift over long records.
const PATH_LEAKS: (f64, f64) = (0.13, 1e3);

/// Records whose Gram matrices are computed side by side, so that many records need no more memory than a few.
pub(crate) const AT_ONCE: usize = 8;

/// A model may change its frequencies by this factor.
const LARGEST_SHIFT: f64 = 30.0;

/// Records and searched parameters: those of the model, then the first displacements and velocities of moving records.
#[derive(Clone, Copy)]
pub(super) struct DynamicsTask<'a> {
    pub layout: &'a DynamicsLayout,
    /// Model with all coefficients that are not searched.
    pub template: &'a Dynamics,
    pub records: &'a [DrivenRecord],
    /// `N`.
    pub rows: f64,
    /// Penalty on the square of each parameter; empty if there is none.
    penalties: &'a [f64],
    /// True while only the first mode moves: what excites the others is 0 and stays so.
    is_of_one_mode: bool,
    stop: StopCheck<'a>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrivenRecord {
    pub drive: DynamicsDrive,
    pub beginning: InitialMotion,
}

/// How the modes move at the first row of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum InitialMotion {
    AtRest,
    /// At rest, but an unknown input between the first rows adds displacements and velocities of these expected sizes.
    NearRest(Vec<f64>),
    /// A record in mid-motion: displacements and velocities may have any size.
    InMotion,
}

impl InitialMotion {
    /// Number of displacements and velocities that are searched.
    fn count(&self, modes: usize) -> usize {
        if *self == Self::AtRest { 0 } else { 2 * modes }
    }

    /// Shares of the penalty on weights that act on displacements and then on velocities, if these are searched.
    fn decays(&self, modes: usize) -> Vec<f64> {
        let of_mode: Vec<f64> = match self {
            Self::AtRest => Vec::new(),
            Self::NearRest(deviations) => {
                deviations.iter().map(|deviation| EXPECTED_SQUARE / (deviation * deviation)).collect()
            }
            Self::InMotion => vec![1.0; modes],
        };
        of_mode.repeat(2)
    }
}

/// The objective at a point; infinite if it was broken off.
#[derive(Debug, Clone, Copy)]
pub(super) struct DynamicsValue {
    pub objective: f64,
    pub mean_square: f64,
}

impl DynamicsValue {
    pub fn nrmse_percent(&self) -> f64 {
        100.0 * self.mean_square.sqrt()
    }
}

impl<'a> DynamicsTask<'a> {
    pub fn new(
        layout: &'a DynamicsLayout,
        template: &'a Dynamics,
        records: &'a [DrivenRecord],
        stop: StopCheck<'a>,
    ) -> Self {
        let rows = records.iter().map(|record| record.drive.rows()).sum::<f64>().max(1.0);
        Self { layout, template, records, rows, penalties: &[], is_of_one_mode: false, stop }
    }

    /// The same task with other penalties.
    pub fn with_penalties<'b>(self, penalties: &'b [f64]) -> DynamicsTask<'b>
    where
        'a: 'b,
    {
        DynamicsTask { penalties, ..self }
    }

    pub fn of_one_mode(self, is_of_one_mode: bool) -> Self {
        Self { is_of_one_mode, ..self }
    }

    /// The parameters of a model, with the modes at rest at the first row of each record.
    pub fn parameters(&self, dynamics: &Dynamics) -> Vec<f64> {
        let mut parameters = self.layout.parameters(dynamics);
        parameters.resize(self.count(), 0.0);
        parameters
    }

    /// Mean square of the scaled error; `None` once stopped.
    pub fn mean_square(&self, parameters: &[f64]) -> Option<f64> {
        let dynamics = self.layout.dynamics(parameters, self.template);
        let runs = self.runs(&dynamics, parameters);
        let halves: Vec<f64> =
            parallel::each_taken(runs, |(run, _)| run.half_square()).into_iter().collect::<Option<_>>()?;
        Some(2.0 * halves.iter().sum::<f64>() / self.rows)
    }

    /// A run over each record, and where its own parameters are.
    fn runs<'r>(
        &'r self,
        dynamics: &'r Dynamics,
        parameters: &'r [f64],
    ) -> Vec<(DynamicsRun<'r>, Range<usize>)> {
        let mut end = self.layout.count();
        let run = |record: &'r DrivenRecord| {
            let own = end..end + record.beginning.count(self.layout.modes.len());
            end = own.end;
            let run = DynamicsRun {
                dynamics,
                drives: std::slice::from_ref(&record.drive),
                beginnings: &parameters[own.clone()],
                is_in_motion: record.beginning == InitialMotion::InMotion,
                stop: self.stop,
            };
            (run, own)
        };
        self.records.iter().map(run).collect()
    }

    fn count(&self) -> usize {
        let modes = self.layout.modes.len();
        self.layout.count() + self.records.iter().map(|record| record.beginning.count(modes)).sum::<usize>()
    }

    /// The penalty on weights of elements, and on first displacements and velocities by their expected size.
    pub fn penalties(&self, penalty: f64) -> Vec<f64> {
        let of_model =
            (0..self.layout.count()).map(|index| f64::from(u8::from(self.layout.has_decay(index))));
        let of_records =
            self.records.iter().flat_map(|record| record.beginning.decays(self.layout.modes.len()));
        of_model.chain(of_records).map(|share| penalty * share).collect()
    }

    fn bounds(&self, index: usize) -> (f64, f64) {
        let of_ln = |(low, high): (f64, f64)| (ln(low), ln(high));
        if let Some(place) = self.layout.modes.iter().position(|mode| mode.ln_frequency == index) {
            let of_mode = ln(self.template.modes[place].frequency);
            return (of_mode - ln(LARGEST_SHIFT), of_mode + ln(LARGEST_SHIFT));
        }
        if self.layout.modes.iter().any(|mode| mode.ln_damping == index) {
            return of_ln(DAMPING_RATIOS);
        }
        if self.layout.elements.iter().any(|element| element.ln_path_leaks.contains(&index)) {
            return of_ln(PATH_LEAKS);
        }
        if self.layout.elements.iter().any(|element| element.strength_losses.contains(&index)) {
            return (0.0, LARGEST_WEIGHT);
        }
        if self.layout.is_logarithm(index) {
            return of_ln((1.0 / LARGEST_WEIGHT, LARGEST_WEIGHT));
        }
        (-LARGEST_WEIGHT, LARGEST_WEIGHT)
    }
}

impl LeastSquaresProblem for DynamicsTask<'_> {
    type Value = DynamicsValue;
    type Curvature = Symmetric;
    const RULES: DescentSettings = DescentSettings::SMOOTH;

    fn value(&self, parameters: &[f64]) -> DynamicsValue {
        let mean_square = self.mean_square(parameters).filter(|square| *square < LARGEST_VALUE);
        let mean_square = mean_square.unwrap_or(f64::INFINITY);
        let decay: f64 = parameters.iter().zip(self.penalties).map(|(p, penalty)| penalty * p * p).sum();
        DynamicsValue { objective: 0.5 * mean_square + 0.5 * decay, mean_square } // (15.15)
    }

    fn objective(value: &DynamicsValue) -> f64 {
        value.objective
    }

    fn slope(&self, parameters: &[f64], _: &DynamicsValue) -> Option<Slope<Symmetric>> {
        let dynamics = self.layout.dynamics(parameters, self.template);
        let in_motion = self.layout.with_beginning();
        let (of_model, count) = (self.layout.count(), self.count());
        let of_record = |(run, own): &(DynamicsRun<'_>, Range<usize>)| {
            let layout = if own.is_empty() { self.layout } else { &in_motion };
            run.gram(layout).map(|gram| (gram, own.clone()))
        };
        let mut gradient = vec![0.0; count];
        let mut curvature = Symmetric::from_fn(count, |_, _| 0.0);
        for runs in self.runs(&dynamics, parameters).chunks(AT_ONCE) {
            let grams: Vec<(Gram, Range<usize>)> =
                parallel::each(runs, of_record).into_iter().collect::<Option<_>>()?;
            for (gram, own) in grams {
                let places: Vec<usize> = (0..of_model).chain(own).collect();
                for (i, &place) in places.iter().enumerate() {
                    gradient[place] += gram.at(places.len(), i) / self.rows;
                    for (j, &other) in places[..=i].iter().enumerate() {
                        curvature.add_at(place, other, gram.at(i, j) / self.rows);
                    }
                }
            }
        }
        for (index, penalty) in self.penalties.iter().enumerate() {
            gradient[index] += penalty * parameters[index];
            curvature.add_to_diagonal(index, *penalty);
        }
        let diagonal = (0..count).map(|index| curvature.diagonal(index)).collect();
        Some(Slope { gradient, diagonal, curvature, evaluations: 1 })
    }

    fn step(&self, slope: &Slope<Symmetric>, parameters: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
        let leaves = |i: usize, by: f64| {
            if self.is_of_one_mode && self.layout.excites_later_modes(i) {
                return true;
            }
            let (low, high) = self.bounds(i);
            parameters[i] <= low && by < 0.0 || parameters[i] >= high && by > 0.0
        };
        step_within(&slope.curvature, &slope.gradient, damping, leaves, self.stop)
    }

    fn limit(&self, parameters: &mut [f64]) {
        for (index, parameter) in parameters.iter_mut().enumerate() {
            let (low, high) = self.bounds(index);
            *parameter = parameter.clamp(low, high);
        }
    }

    fn stop(&self) -> StopCheck<'_> {
        self.stop
    }
}
