//! Bounds of a model's output for bounded inputs, from its parameters alone, theory.md (10.42).

use crate::law::Classical;
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::model::{Body, Model};
use crate::network::scaling::Scaling;
use crate::network::{Layout, Network};

/// What rounding may add to a bound, as a share of its magnitude.
const ROUNDING: f64 = 1e-9;

/// All numbers from the first to the second; either may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval(pub f64, pub f64);

const ALL: Interval = Interval(f64::NEG_INFINITY, f64::INFINITY);

impl Interval {
    fn about(value: f64, by: f64) -> Self {
        Self(value - by, value + by)
    }

    fn point(value: f64) -> Self {
        Self(value, value)
    }

    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    /// Nothing is left of infinity times 0.
    fn times(self, factor: f64) -> Self {
        if factor == 0.0 {
            return Self::point(0.0);
        }
        let (a, b) = (factor * self.0, factor * self.1);
        Self(a.min(b), a.max(b))
    }

    fn with_zero(self) -> Self {
        Self(self.0.min(0.0), self.1.max(0.0))
    }

    fn common(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.min(other.1))
    }

    fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self(function(self.0), function(self.1))
    }

    /// A play of threshold `r` that was virgin once.
    fn play(self, r: f64) -> Self {
        Self((self.0 + r).min(0.0), (self.1 - r).max(0.0))
    }

    /// The stop that belongs to it.
    fn stop(self, r: f64) -> Self {
        let play = self.play(r);
        Self((self.0 - play.1).max(-r), (self.1 - play.0).min(r))
    }

    /// A relaxation element: what it holds is the input less a mean of earlier ones and of 0.
    fn relaxation(self) -> Self {
        let earlier = self.with_zero();
        Self(self.0 - earlier.1, self.1 - earlier.0)
    }

    fn sum(terms: impl IntoIterator<Item = Self>) -> Self {
        terms.into_iter().fold(Self::point(0.0), Self::plus)
    }
}

/// Outputs that are possible while inputs and the rate of the first stay within the trained ranges.
pub(super) fn within_trained_ranges(model: &Model) -> Interval {
    let trained = model.trained_ranges();
    let inputs: Vec<Interval> = trained.inputs.iter().map(|&(low, high)| Interval(low, high)).collect();
    // A model may be run at rest, whatever the rates in training.
    let rate = trained.rate.map_or(Interval::point(0.0), |(low, high)| Interval(low, high).with_zero());
    possible(model, &inputs, rate)
}

/// Outputs that are possible at all; `None` if there is no bound.
pub(super) fn whatever_the_input(model: &Model) -> Option<Interval> {
    let all = possible(model, &vec![ALL; model.trained_ranges().inputs.len()], ALL);
    (all.0.is_finite() && all.1.is_finite()).then_some(all)
}

fn possible(model: &Model, inputs: &[Interval], rate: Interval) -> Interval {
    let preprocessing = model.preprocessing();
    let seen = inputs.iter().enumerate();
    let mut seen: Vec<Interval> =
        seen.map(|(input, range)| range.rising(|value| preprocessing.input_as_seen(input, value))).collect();
    if let Some((largest, _)) = preprocessing.history {
        let from_origin = inputs[0].rising(|x| x - preprocessing.origin(0));
        let farthest = from_origin.0.abs().max(from_origin.1.abs());
        // The path has no end.
        seen.extend([Interval(0.0, farthest / largest), Interval(0.0, f64::INFINITY)]);
    }
    let seen_rate = rate.rising(|rate| preprocessing.rate(rate));
    let exact = match model.body() {
        Body::Network { network, scaling } => network_output(network, scaling, &seen, seen_rate),
        Body::Law(law) => law_output(law, seen[0], seen_rate),
        // A median lies among the values it is taken of.
        Body::Ensemble(ensemble) => ensemble
            .members()
            .iter()
            .map(|member| possible(member, inputs, rate))
            .reduce(|a, b| Interval(a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or(ALL),
    };
    let slack = ROUNDING * exact.0.abs().max(exact.1.abs());
    Interval(exact.0 - slack, exact.1 + slack)
}

fn network_output(network: &Network, scaling: &Scaling, inputs: &[Interval], rate: Interval) -> Interval {
    let a = network.architecture();
    let layout = Layout::new(*a);
    let parameters = network.parameters();
    let scaled: Vec<Interval> =
        inputs.iter().zip(&scaling.inputs).map(|(input, scale)| input.times(1.0 / scale)).collect();
    let mut u = scaled.clone();
    if a.rate {
        u.insert(1, rate.times(1.0 / scaling.rate.unwrap_or(1.0)));
    }
    let weighted =
        |weights: &[f64], of: &[Interval]| Interval::sum(weights.iter().zip(of).map(|(w, z)| z.times(*w)));
    let mut z = Vec::with_capacity(a.memory_neurons());
    z.extend(a.linear.then(|| weighted(&parameters[layout.linear.clone()], &u)));
    z.extend(parameters[layout.stop_weights.clone()].chunks_exact(a.channels()).map(|weights| {
        let stop = weighted(weights, &u).stop(1.0);
        if a.deterioration { stop.with_zero() } else { stop }
    }));
    z.extend((0..a.relaxation_neurons()).map(|m| scaled[m / a.relaxation].relaxation()));
    let hidden = parameters[layout.hidden.clone()].chunks_exact(1 + a.memory_neurons());
    let hidden = hidden.map(|run| weighted(&run[1..], &z).plus(Interval::point(run[0])).rising(f64::tanh));
    let features: Vec<Interval> = a
        .constant
        .then_some(Interval::point(1.0))
        .into_iter()
        .chain(hidden)
        .chain(if a.has_direct_path() { z.clone() } else { Vec::new() })
        .collect();
    weighted(network.output(), &features).rising(|y| scaling.output(y))
}

fn law_output(law: &Classical, x: Interval, rate: Interval) -> Interval {
    match law {
        Classical::Masing(law) => {
            let parts = law.parts();
            let stops = parts.thresholds.iter().zip(parts.slopes.windows(2));
            let stops = stops.map(|(&r, slopes)| x.stop(r).times(slopes[0] - slopes[1]));
            let last = parts.slopes.last().copied().unwrap_or(0.0);
            Interval::sum(stops).plus(x.times(last)).plus(Interval::point(parts.constant))
        }
        Classical::PrandtlIshlinskii(law) => sum_of_plays(law, x),
        Classical::ModifiedPrandtlIshlinskii(law) => {
            let plays = sum_of_plays(law.hysteresis(), x);
            // Far out the polygon is a line, which goes to infinity.
            if plays.0.is_finite() && plays.1.is_finite() {
                plays.rising(|z| law.superposition().value(z))
            } else {
                ALL
            }
        }
        Classical::Preisach(law) => {
            let weights = law.weights();
            let relays: f64 = weights.reversible.iter().chain(&weights.cells).map(|w| w.abs()).sum();
            Interval::about(weights.constant, relays).plus(x.times(weights.slope))
        }
        Classical::GeneralizedPrandtlIshlinskii(law) => {
            let left = x.rising(|x| law.left.value(x)).1;
            let right = x.rising(|x| law.right.value(x)).0;
            let play = |(index, weight): (usize, f64)| {
                let r = law.spacing * index as f64;
                Interval(law.initial.min(right + r), law.initial.max(left - r)).times(weight)
            };
            let weights = law.weights.values(law.spacing, 0);
            Interval::sum(weights.into_iter().enumerate().map(play)).plus(Interval::point(law.offset))
        }
        Classical::RateDependentPrandtlIshlinskii(law) => {
            // Whatever the rate, thresholds are not negative.
            let plays =
                law.weights.values(law.spacing, 1).into_iter().map(|weight| x.play(0.0).times(weight));
            Interval::sum(plays).plus(x.times(law.spring)).plus(Interval::point(law.offset))
        }
        Classical::NeuroMadelung(law) => {
            // theory.md (8.20): its own limit.
            let (low, high) = law.output_range;
            Interval(low - (high - low), high + (high - low))
        }
        Classical::BoucWen(law) => {
            let yielded = (law.hysteretic_stiffness * law.yield_displacement).abs();
            let spring = x.times(law.elastic_stiffness).plus(rate.times(law.damping));
            Interval::about(law.offset, yielded).plus(spring)
        }
        Classical::JilesAtherton(law) => {
            Interval::about(law.offset, law.saturation.abs()).plus(x.times(law.permeability))
        }
    }
}

/// As plays and as stops; what both allow.
fn sum_of_plays(law: &PrandtlIshlinskii, x: Interval) -> Interval {
    let each = || law.thresholds().iter().zip(law.weights());
    let plays = Interval::sum(each().map(|(&r, &w)| x.play(r).times(w))).plus(x.times(law.linear()));
    let stops = Interval::sum(each().map(|(&r, &w)| x.stop(r).times(-w)));
    let slope = law.linear() + law.weights().iter().sum::<f64>();
    plays.common(stops.plus(x.times(slope))).plus(Interval::point(law.constant()))
}
