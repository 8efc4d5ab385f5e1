//! Two-storey shear building in an earthquake: storeys of the Bouc-Wen kind that lose stiffness and strength as they
//! dissipate energy.
//!
//! ```text
//! m_1 (y_1'' + a) = f_2 - f_1,   m_2 (y_2'' + a) = -f_2                      theory.md (6.45)
//! f_i = c_i d_i' + κ k_i d_i + (1 - κ) k_i z_i,   d_1 = y_1,   d_2 = y_2 - y_1   theory.md (6.46)
//! η_i z_i' = d_i' - ν_i |z_i/X_i|^n (β |d_i'| sgn z_i + (1 - β) d_i')          theory.md (6.47)
//! ν_i = 1 + δν e_i,   η_i = 1 + δη e_i,   e_i' = z_i d_i'/X_i²               theory.md (6.48)
//! ```
//!
//! `a` is the acceleration of the ground in m/s², `y_i` the displacement of floor `i` relative to the ground and `d_i`
//! the drift of storey `i`, in m. `f_i` is the force of a storey in N, `z_i` its hysteretic displacement in m, at most
//! the yield displacement `X_i`, and `e_i` the work of `z_i`, in units of `k_i X_i²`. Growth of `ν` is loss of strength,
//! growth of `η` loss of stiffness.
//!
//! *Published*: the equations (Wen; Baber and Wen). *Designed*: all values, and the earthquakes but for what
//! the module of earthquakes states as published. Between two rows the ground acceleration is a straight line. Every
//! record begins with the undamaged building at rest.

use hysid_core::data::record::Record;
use hysid_core::elementary::powf;
use hysid_core::error::Result;

use super::draw::Draw;
use super::earthquake::{TIME_STEP, ground_acceleration};
use super::specimen::{Specimen, SpecimenColumns};
use super::{path, runge_kutta};

/// A storey, with the floor above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Storey {
    /// `m` in kg: mass of the floor, above 0.
    pub mass: f64,
    /// `c` in N s/m.
    pub damping: f64,
    /// `k` in N/m: initial stiffness.
    pub stiffness: f64,
    /// `X` in m: yield displacement, above 0.
    pub yield_displacement: f64,
}

/// A two-storey shear building.
///
/// ```
/// use hysid_specimens::ShearBuilding;
/// let building = ShearBuilding::designed();
/// let ground = (0..500).map(|row| 2.0 * (0.1 * f64::from(row)).sin()); // m/s², a row every 0.01 s
/// let motion: Vec<_> = building.motion(ground, 0.01, 10).collect();
/// assert_eq!(motion[0].roof_displacement(), 0.0);
/// assert!(motion[499].work[0] > motion[250].work[0]); // the first storey yields again and again
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearBuilding {
    /// The storeys, the lower one first.
    pub storeys: [Storey; 2],
    /// `κ`: share of the elastic stiffness, from 0 to 1.
    pub elastic_share: f64,
    /// `β`: share of the softening that dissipates, from 0 to 1.
    pub beta: f64,
    /// `n`: sharpness of yielding, 1 or more.
    pub n: f64,
    /// `δν`: loss of strength with the work.
    pub strength_loss: f64,
    /// `δη`: loss of stiffness with the work.
    pub stiffness_loss: f64,
}

/// State of a [`ShearBuilding`] at one time, the lower storey first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BuildingMotion {
    /// `d` in m: drift of the storeys.
    pub drift: [f64; 2],
    /// `d'` in m/s.
    pub drift_rate: [f64; 2],
    /// `z` in m: hysteretic displacement of the storeys.
    pub hysteretic_displacement: [f64; 2],
    /// `e`: work of `z`, in units of `k X²`.
    pub work: [f64; 2],
}

impl BuildingMotion {
    /// Displacement of the roof relative to the ground, in m.
    pub fn roof_displacement(&self) -> f64 {
        self.drift[0] + self.drift[1]
    }
}

/// Drifts, their rates, hysteretic displacements and works.
type State = [f64; 8];

impl From<State> for BuildingMotion {
    fn from([d1, d2, v1, v2, z1, z2, e1, e2]: State) -> Self {
        Self { drift: [d1, d2], drift_rate: [v1, v2], hysteretic_displacement: [z1, z2], work: [e1, e2] }
    }
}

impl ShearBuilding {
    /// Floors of 25 t on storeys of 10.3 kN/mm that yield at 9 mm, with a first natural period of 0.5 s and 2 %
    /// of critical damping there. Designed.
    pub fn designed() -> Self {
        let storey = Storey { mass: 25e3, damping: 33e3, stiffness: 10.3e6, yield_displacement: 9e-3 };
        Self {
            storeys: [storey; 2],
            elastic_share: 0.05,
            beta: 0.6,
            n: 1.5,
            strength_loss: 0.01,
            stiffness_loss: 0.02,
        }
    }

    /// The motion at the times of the ground accelerations in m/s², `time_step` in s apart, from the undamaged building
    /// at rest. The way from row to row is integrated in `parts` steps. An acceleration that is not finite makes the
    /// motion NaN from there on.
    pub fn motion(
        self,
        ground: impl IntoIterator<Item = f64>,
        time_step: f64,
        parts: usize,
    ) -> impl Iterator<Item = BuildingMotion> {
        let (mut state, mut last) = (State::default(), None);
        ground.into_iter().map(move |acceleration| {
            if let Some(from) = last {
                for part in 0..parts {
                    let ground =
                        |share: f64| from + (acceleration - from) * (part as f64 + share) / parts as f64;
                    let slope = |share: f64, state: State| self.slope(state, ground(share));
                    state = runge_kutta::step(state, time_step / parts as f64, slope);
                }
            }
            last = Some(acceleration);
            BuildingMotion::from(state)
        })
    }

    /// Force of a storey in N.
    fn force(&self, storey: usize, motion: &BuildingMotion) -> f64 {
        let Storey { damping, stiffness, .. } = self.storeys[storey];
        let (elastic, hysteretic) = (motion.drift[storey], motion.hysteretic_displacement[storey]);
        let share = self.elastic_share;
        damping * motion.drift_rate[storey] + stiffness * (share * elastic + (1.0 - share) * hysteretic)
    }

    /// Rates of the hysteretic displacement and of the work of a storey.
    fn hysteresis(&self, storey: usize, motion: &BuildingMotion) -> (f64, f64) {
        let (v, z, e) =
            (motion.drift_rate[storey], motion.hysteretic_displacement[storey], motion.work[storey]);
        let scale = self.storeys[storey].yield_displacement;
        let softening =
            powf((z / scale).abs(), self.n) * (self.beta * v.abs() * z.signum() + (1.0 - self.beta) * v);
        let rate = (v - (1.0 + self.strength_loss * e) * softening) / (1.0 + self.stiffness_loss * e);
        (rate, z * v / (scale * scale))
    }

    fn slope(&self, state: State, ground: f64) -> State {
        let motion = BuildingMotion::from(state);
        let [first, second] = [0, 1].map(|storey| self.force(storey, &motion));
        let lower = (second - first) / self.storeys[0].mass - ground;
        let upper = -second / self.storeys[1].mass - ground;
        let [(z1, e1), (z2, e2)] = [0, 1].map(|storey| self.hysteresis(storey, &motion));
        [motion.drift_rate[0], motion.drift_rate[1], lower, upper - lower, z1, z2, e1, e2]
    }
}

pub(super) static SPECIMEN: Specimen = Specimen {
    name: "shear-building",
    example: None,
    summary: "two-storey shear building in earthquakes: storeys of the Bouc-Wen kind that lose stiffness and strength",
    published: "the equations (Wen; Baber and Wen), the filter of the soil (Kanai, Tajimi), the form of the envelope \
                (Jennings, Housner, Tsai)",
    designed: "all values of the building, and duration and peaks of the earthquakes; the seed draws the earthquakes",
    training: "three earthquakes of 30 s with peaks of 1.5, 3 and 5 m/s², each from the undamaged building at rest; 100 Hz",
    testing: "two other earthquakes, with peaks of 2.5 and 4 m/s², likewise",
    columns: SpecimenColumns {
        time: Some("t_s"),
        input: "ground_acceleration_m_per_s2",
        output: "roof_displacement_m",
    },
    train: |seed| (0..).zip([1.5, 3.0, 5.0]).map(|(index, peak)| record(seed, index, peak)).collect(),
    test: |seed| (3..).zip([2.5, 4.0]).map(|(index, peak)| record(seed, index, peak)).collect(),
};

const STEPS_PER_ROW: usize = 10;

/// An earthquake of a seed, with this number and this peak in m/s².
fn record(seed: u64, index: usize, peak: f64) -> Result<Record> {
    let ground = ground_acceleration(&mut Draw::new(seed, index), peak);
    let motion = ShearBuilding::designed().motion(ground.iter().copied(), TIME_STEP, STEPS_PER_ROW);
    let roof = motion.map(|motion| motion.roof_displacement()).collect();
    let time = path::every(TIME_STEP, ground.len());
    Record::new(format!("earthquake {}", index + 1), vec![ground], roof)?.with_time(time)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, exp, sin, square};

    use super::*;

    fn earthquake() -> Vec<f64> {
        ground_acceleration(&mut Draw::new(1, 2), 5.0)
    }

    /// With floors at the velocities `V_i`, the ground does the work `-∫ a Σ m_i V_i dt`.
    #[test]
    fn the_work_of_the_ground_becomes_energy_or_is_dissipated() {
        let building = ShearBuilding::designed();
        let [first, second] = building.storeys;
        let share = building.elastic_share;
        let ground = earthquake();
        let fine: Vec<f64> = (0..=10 * (ground.len() - 1))
            .map(|k| {
                ground[k / 10]
                    + (ground.get(k / 10 + 1).unwrap_or(&0.0) - ground[k / 10]) * (k % 10) as f64 / 10.0
            })
            .collect();
        let motion: Vec<BuildingMotion> = building.motion(fine.iter().copied(), 0.1 * TIME_STEP, 1).collect();
        let floors = |at: &BuildingMotion| [at.drift_rate[0], at.drift_rate[0] + at.drift_rate[1]];
        let power = |(at, ground): (&BuildingMotion, &f64)| {
            let [lower, upper] = floors(at);
            -ground * (first.mass * lower + second.mass * upper)
        };
        let loss = |(at, _): (&BuildingMotion, &f64)| -> f64 {
            building.storeys.iter().zip(at.drift_rate).map(|(storey, v)| storey.damping * v * v).sum()
        };
        let mean = |value: &dyn Fn((&BuildingMotion, &f64)) -> f64| -> f64 {
            let values: Vec<f64> = motion.iter().zip(&fine).map(value).collect();
            values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) * 0.1 * TIME_STEP).sum()
        };
        let end = motion.last().unwrap();
        let [lower, upper] = floors(end);
        let kinetic = 0.5 * (first.mass * lower * lower + second.mass * upper * upper);
        let storeys = building.storeys.iter().zip(end.drift.iter().zip(&end.work));
        let stored = storeys.map(|(storey, (drift, work))| {
            let hysteretic = work * square(storey.yield_displacement);
            storey.stiffness * (0.5 * share * drift * drift + (1.0 - share) * hysteretic)
        });
        let (work, accounted) = (mean(&power), kinetic + stored.sum::<f64>() + mean(&loss));
        assert!(work > 1000.0 && (accounted / work - 1.0).abs() < 1e-4, "{accounted} {work}");
    }

    /// Storeys that do not yield, with dampers like their springs, have modes; under a constant ground acceleration each
    /// swings by itself about its static displacement.
    #[test]
    fn the_elastic_building_has_the_response_of_its_modes() {
        let building = ShearBuilding { elastic_share: 1.0, ..ShearBuilding::designed() };
        let Storey { mass, damping, stiffness, .. } = building.storeys[0];
        let motion = building.motion((0..400).map(|_| 1.0), TIME_STEP, STEPS_PER_ROW);
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        // Of the chain of two equal masses: roof/floor ratio and ω² m/k.
        let modes = [(golden, 2.0 - golden), (1.0 - golden, 1.0 + golden)];
        for (row, motion) in motion.enumerate() {
            let t = row as f64 * TIME_STEP;
            let roof = modes.map(|(ratio, square)| {
                let omega = (square * stiffness / mass).sqrt();
                let decay = 0.5 * square * damping / mass;
                let damped = (omega * omega - decay * decay).sqrt();
                let swing = exp(-decay * t) * (cos(damped * t) + decay / damped * sin(damped * t));
                let participation = (1.0 + ratio) / (1.0 + ratio * ratio);
                -participation * ratio / (omega * omega) * (1.0 - swing)
            });
            let expected = roof[0] + roof[1];
            assert!((motion.roof_displacement() - expected).abs() < 1e-8, "{t}: {motion:?} {expected}");
        }
    }

    #[test]
    fn the_building_yields_and_degrades_in_its_earthquakes() {
        let end = ShearBuilding::designed().motion(earthquake(), TIME_STEP, STEPS_PER_ROW).last().unwrap();
        assert!(end.work[0] > 5.0, "{end:?}");
        let largest =
            SPECIMEN.train().records().iter().flat_map(|record| record.output().to_vec()).fold(0.0, f64::max);
        assert!((0.02..0.2).contains(&largest), "{largest}");
    }
}
