//! Identification of a dynamic Prandtl-Ishlinskii model: time constants, shares and resonance are found by search, and
//! for each of their values the weights by least squares (theory.md (8.58)).
//!
//! All dynamics are linear, so they are applied to each play and dead zone by itself, and the weights stay linear.

use hysid_core::elementary::ln;

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::SearchedLaw;
use crate::fit::law::grids::check_count;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Sample;
use crate::law::dynamic_prandtl_ishlinskii::{
    DeadZone, DynamicPrandtlIshlinskii, MOST_RELAXATIONS, Relaxation, Resonance,
};
use crate::law::hysteretic_dynamics::Propagation;
use crate::law::modified_prandtl_ishlinskii::dead_zone;
use crate::law::play_weights::MOST_PLAYS;
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::series::{Series, work};
use crate::operator::play;
use crate::operator::relaxation::{advance, decay};
use crate::options::classical::ClassicalOptions;

/// Bounds of time constants: shares of the median time step and of the longest record. A lag of many records is an
/// integral.
const SHORTEST_OF_STEP: f64 = 0.3;
const LONGEST_OF_RECORD: f64 = 3.0;
const LONGEST_LAG_OF_RECORD: f64 = 100.0;

/// Bounds of the share of a relaxation element: from a lag to high frequencies that are three times as strong.
const SHARES: (f64, f64) = (-1.0, 2.0);

/// Bounds of the damping ratio of a resonance.
const DAMPINGS: (f64, f64) = (0.02, 20.0);

/// Places of the time constant of the lag, of which the range of the lagged input is known.
const PLACES: usize = 33;

/// Time steps this close to each other share their factors.
const SAME_STEP: f64 = 1e-9;

/// Largest magnitude of `u` beyond the last threshold, as a share of the spacing of the thresholds.
const BEYOND: f64 = 0.5;

impl SearchedLaw for DynamicPrandtlIshlinskii {
    type Family = Dynamic;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(Dynamic, Vec<Series>)> {
        check_count("operators", options.operators(), MOST_PLAYS)?;
        if !data.has_time() {
            return Err(Error::TimeNeeded(options.model.name()));
        }
        let series = Series::all(data, None)?;
        let family = Dynamic::new(&series, options);
        Ok((family, thinned(series, MemoryKind::Path)))
    }
}

pub(crate) struct Dynamic {
    operators: usize,
    dead_zones: usize,
    relaxations: usize,
    has_resonance: bool,
    /// Sign of the weights of the plays: positive where the output lags.
    sign: f64,
    /// The logarithm of the time constant of the lag and the largest magnitude of the lagged input, place by place; one
    /// place without a lag.
    ranges: Vec<(f64, f64)>,
    has_lag: bool,
    unknowns: Unknowns,
}

/// The law of some searched parameters, without weights.
struct UnweightedLaw {
    lag: Option<f64>,
    relaxations: Vec<(f64, f64)>,
    resonance: Option<Resonance>,
    /// Thresholds of plays and dead zones.
    plays: Vec<f64>,
    dead_zones: Vec<f64>,
}

/// The factors of a time step, without allocation: the rows of a thinned record have steps of many lengths.
struct StepFactors {
    time_step: f64,
    lag: (f64, f64),
    relaxations: [(f64, f64); MOST_RELAXATIONS],
    resonance: Option<Propagation>,
}

impl StepFactors {
    fn of(frame: &UnweightedLaw, time_step: f64) -> Self {
        let mut relaxations = [(1.0, 1.0); MOST_RELAXATIONS];
        for (factors, &(tau, _)) in relaxations.iter_mut().zip(&frame.relaxations) {
            *factors = decay(time_step, tau);
        }
        Self {
            time_step,
            lag: frame.lag.map_or((1.0, 1.0), |tau| decay(time_step, tau)),
            relaxations,
            resonance: frame.resonance.map(|of| Propagation::new(of.frequency, of.damping, time_step)),
        }
    }

    fn are_of(&self, time_step: f64) -> bool {
        let difference = (self.time_step - time_step).abs();
        self.time_step == time_step || difference.is_finite() && difference <= SAME_STEP * time_step
    }
}

impl Dynamic {
    fn new(series: &[Series], options: &ClassicalOptions) -> Self {
        let (operators, dead_zones) = (options.operators(), options.dead_zones());
        let relaxations = options.relaxation().min(MOST_RELAXATIONS);
        let (has_lag, has_resonance) = (options.lagged_input, options.resonance);
        let (step, record) = times(series);
        let time_constant = |longest: f64| {
            let shortest = SHORTEST_OF_STEP * step;
            SearchVariable::logarithmic(shortest, (longest * record).max(3.0 * shortest))
        };
        let mut variables = Vec::new();
        let mut ranges = vec![(0.0, largest(series, None))];
        if has_lag {
            let lag = time_constant(LONGEST_LAG_OF_RECORD);
            let place = |index: usize| lag.value(index as f64 / (PLACES - 1) as f64);
            ranges = (0..PLACES).map(place).map(|tau| (ln(tau), largest(series, Some(tau)))).collect();
            variables.push(lag);
        }
        for _ in 0..relaxations {
            variables.extend([time_constant(LONGEST_OF_RECORD), SearchVariable::linear(SHARES.0, SHARES.1)]);
        }
        if has_resonance {
            let (slowest, fastest) = (1.0 / record, 3.0 / step);
            variables.extend([
                SearchVariable::logarithmic(slowest, fastest.max(3.0 * slowest)),
                SearchVariable::logarithmic(DAMPINGS.0, DAMPINGS.1),
            ]);
        }
        let sign = if work(series) < 0.0 { 1.0 } else { -1.0 };
        let mut non_negative = vec![false; 2 + 2 * dead_zones];
        non_negative.extend(vec![true; operators]);
        non_negative.extend(vec![false; if has_lag { 1 + relaxations } else { 0 }]);
        Self {
            operators,
            dead_zones,
            relaxations,
            has_resonance,
            sign,
            ranges,
            has_lag,
            unknowns: Unknowns { variables, non_negative },
        }
    }

    fn frame(&self, searched: &[f64]) -> UnweightedLaw {
        let (lag, rest) = searched.split_at(usize::from(self.has_lag));
        let (relaxations, resonance) = rest.split_at(2 * self.relaxations);
        let lag = lag.first().copied();
        let range = self.range(lag);
        let spacing = range / (self.operators as f64 + BEYOND);
        let bend = |place: usize| range * place as f64 / (self.dead_zones + 1) as f64;
        UnweightedLaw {
            lag,
            relaxations: relaxations.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect(),
            resonance: self
                .has_resonance
                .then(|| Resonance { frequency: resonance[0], damping: resonance[1] }),
            plays: (1..=self.operators).map(|place| spacing * place as f64).collect(),
            dead_zones: (1..=self.dead_zones).flat_map(|place| [bend(place), -bend(place)]).collect(),
        }
    }

    /// The largest magnitude of the input of the plays.
    fn range(&self, lag: Option<f64>) -> f64 {
        let Some(tau) = lag else { return self.ranges[0].1 };
        let at = ln(tau);
        let after = self.ranges.partition_point(|range| range.0 < at).clamp(1, PLACES - 1);
        let ((low, below), (high, above)) = (self.ranges[after - 1], self.ranges[after]);
        let share = ((at - low) / (high - low)).clamp(0.0, 1.0);
        below + share * (above - below)
    }
}

/// Median time step and time of the longest record.
fn times(series: &[Series]) -> (f64, f64) {
    let finite = |sample: &&Sample| sample.step > 0.0 && sample.step.is_finite();
    let of =
        |series: &Series| -> f64 { series.samples.iter().filter(finite).map(|sample| sample.step).sum() };
    let record = series.iter().map(of).fold(0.0, f64::max);
    let mut steps: Vec<f64> = series
        .iter()
        .flat_map(|series| series.samples.iter().filter(finite))
        .map(|sample| sample.step)
        .collect();
    if steps.is_empty() {
        return (1.0, 1.0);
    }
    let middle = steps.len() / 2;
    (*steps.select_nth_unstable_by(middle, f64::total_cmp).1, record)
}

/// Largest magnitude of the input behind a lag of this time constant.
fn largest(series: &[Series], lag: Option<f64>) -> f64 {
    let mut largest = f64::MIN_POSITIVE;
    for series in series {
        let mut stress = 0.0;
        let mut before = series.samples.first().map_or(0.0, |sample| sample.x);
        for sample in &series.samples {
            if let Some(tau) = lag {
                stress = advance(stress, sample.x - before, decay(sample.step, tau));
                before = sample.x;
            }
            largest = largest.max((sample.x - stress).abs());
        }
    }
    largest
}

impl LawFamily for Dynamic {
    type Law = DynamicPrandtlIshlinskii;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> DynamicPrandtlIshlinskii {
        let frame = self.frame(searched);
        let (memory, beside) = weights.split_at(2 + 2 * self.dead_zones + self.operators);
        let (curve, plays) = memory.split_at(2 + 2 * self.dead_zones);
        let input_weight = |k: usize| beside.get(1 + k).copied().unwrap_or(0.0);
        let plays = plays.iter().map(|weight| self.sign * weight).collect();
        let zones = frame.dead_zones.iter().zip(&curve[2..]);
        let relaxations = frame.relaxations.iter().enumerate();
        DynamicPrandtlIshlinskii {
            lag: frame.lag,
            plays: PrandtlIshlinskii::unchecked(curve[0], curve[1], frame.plays, plays),
            dead_zones: zones.map(|(&threshold, &weight)| DeadZone { threshold, weight }).collect(),
            relaxations: relaxations
                .map(|(k, &(time_constant, share))| Relaxation {
                    time_constant,
                    share,
                    input_weight: input_weight(k),
                })
                .collect(),
            resonance: frame.resonance,
            direct: beside.first().copied().unwrap_or(0.0),
        }
    }

    fn searched(&self, law: &DynamicPrandtlIshlinskii) -> Vec<f64> {
        let mut all: Vec<f64> = law.lag.into_iter().collect();
        all.extend(law.relaxations.iter().flat_map(|part| [part.time_constant, part.share]));
        all.extend(law.resonance.iter().flat_map(|part| [part.frequency, part.damping]));
        all
    }
}

impl SearchFamily for Dynamic {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, searched: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let frame = self.frame(searched);
        let of_memory = 1 + frame.dead_zones.len() + frame.plays.len();
        let operations = of_memory * (4 + 4 * self.relaxations + if self.has_resonance { 16 } else { 0 });
        let mut plays = vec![0.0; frame.plays.len()];
        // The memory's features at this sample and the one before, and what drove the resonance before.
        let mut features = vec![0.0; of_memory];
        let mut before = features.clone();
        let mut forces_before = features.clone();
        let mut stresses = vec![vec![0.0; of_memory]; self.relaxations];
        let mut motions = vec![[0.0; 2]; if self.has_resonance { of_memory } else { 0 }];
        let (mut lag, mut x_before, mut input_stresses) = (0.0, 0.0, vec![0.0; self.relaxations]);
        let mut row = vec![1.0; self.unknowns.non_negative.len()];
        let mut factors = StepFactors::of(&frame, 0.0);
        for (index, (sample, y)) in series.samples.iter().zip(&series.output).enumerate() {
            if columns.is_over(operations) {
                return;
            }
            if !factors.are_of(sample.step) {
                factors = StepFactors::of(&frame, sample.step);
            }
            let risen = if index > 0 { sample.x - x_before } else { 0.0 };
            x_before = sample.x;
            let mut u = sample.x;
            if frame.lag.is_some() {
                lag = advance(lag, risen, factors.lag);
                u -= lag; // (8.53)
            }
            std::mem::swap(&mut before, &mut features);
            features[0] = u;
            let (curve, of_plays) = features[1..].split_at_mut(frame.dead_zones.len());
            for (feature, &threshold) in curve.iter_mut().zip(&frame.dead_zones) {
                *feature = dead_zone(u, threshold); // (8.54): S_d
            }
            for ((feature, play), &r) in of_plays.iter_mut().zip(&mut plays).zip(&frame.plays) {
                *play = play::follow(*play, u, r); // (8.54): p_r
                *feature = self.sign * *play;
            }
            if index == 0 {
                before.copy_from_slice(&features);
            }
            let of_row = &mut row[1..=of_memory];
            of_row.copy_from_slice(&features);
            for ((stresses, &factors), &(_, share)) in
                stresses.iter_mut().zip(&factors.relaxations).zip(&frame.relaxations)
            {
                let changes = features.iter().zip(&before);
                for ((stress, (&now, &before)), relaxed) in stresses.iter_mut().zip(changes).zip(&mut *of_row)
                {
                    *stress = advance(*stress, now - before, factors); // (1.11)
                    *relaxed += share * *stress; // (8.55)
                }
            }
            if let Some(step) = &factors.resonance {
                for ((motion, before), feature) in motions.iter_mut().zip(&mut forces_before).zip(of_row) {
                    let force = *feature;
                    // (8.56)
                    *motion = if index > 0 { step.moved(*motion, [*before, force]) } else { [force, 0.0] };
                    *before = force;
                    *feature = motion[0];
                }
            }
            if self.has_lag {
                let beside = &mut row[1 + of_memory..];
                beside[0] = sample.x;
                let each = input_stresses.iter_mut().zip(&factors.relaxations).zip(&mut beside[1..]);
                for ((stress, &factors), feature) in each {
                    *stress = advance(*stress, risen, factors); // (1.11)
                    *feature = *stress;
                }
            }
            if !y.is_nan() {
                columns.push(&row); // (8.58)
            }
        }
    }
}
