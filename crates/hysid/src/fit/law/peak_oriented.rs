//! Identification of a peak-oriented law: yield displacements, shapes and degradation are found by search, and for
//! each of their values offset and strengths by least squares.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::SearchedLaw;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Law;
use crate::law::peak_oriented::{Degradation, PINCH_BOUNDS, PeakOriented, Side};
use crate::law::series::{Series, work};
use crate::options::classical::ClassicalOptions;

/// Elementary operations of a row, roughly.
const OPERATIONS_A_ROW: usize = 100;

impl SearchedLaw for PeakOriented {
    type Family = PeakOrientedFamily;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(PeakOrientedFamily, Vec<Series>)> {
        let series = thinned(Series::all(data, None)?, MemoryKind::TurningPoints);
        let (low, high) = data.input_range(0);
        // The member is virgin at 0.
        let range = high.max(-low).max(f64::MIN_POSITIVE);
        Ok((PeakOrientedFamily::new(range, work(&series) < 0.0, options), series))
    }
}

pub(crate) struct PeakOrientedFamily {
    range: f64,
    asymmetric: bool,
    degradation: bool,
    unknowns: Unknowns,
}

/// Searched parameters of the shape: `x+`, `n`, `h`, `u`, `c`, `τ_b`, `φ_b`, `w` and `k x+/F+`.
const SHAPE: usize = 9;

/// Bounds of `k x+/F+`. A spring that is free by least squares takes the place of the envelope: with its slope far
/// below 0 and as much hardening the error of the training data is less, and that of larger displacements more.
const SPRING: (f64, f64) = (-0.05, 0.3);

/// The same for an output that lags behind its input: a spring less a member, whose yield force is negative.
const SPRING_OF_A_LAG: (f64, f64) = (-20.0, 0.0);

impl PeakOrientedFamily {
    /// Members for displacements in this range; `lags` for an output that lags behind its input.
    fn new(range: f64, lags: bool, options: &ClassicalOptions) -> Self {
        let (low, high) = if lags { SPRING_OF_A_LAG } else { SPRING };
        let (asymmetric, degradation) = (options.asymmetric, options.degradation);
        let mut variables = vec![
            SearchVariable::logarithmic(0.003 * range, 1.5 * range),
            SearchVariable::logarithmic(0.7, 12.0),
            SearchVariable::linear(0.0, 0.6),
            SearchVariable::linear(0.0, 1.0),
            SearchVariable::linear(0.0, 10.0),
            SearchVariable::linear(PINCH_BOUNDS.0, PINCH_BOUNDS.1),
            SearchVariable::linear(PINCH_BOUNDS.0, PINCH_BOUNDS.1),
            SearchVariable::logarithmic(0.3, 10.0),
            SearchVariable::linear(low, high),
        ];
        if asymmetric {
            variables.push(SearchVariable::logarithmic(0.2, 5.0));
        }
        if degradation {
            variables.extend([
                SearchVariable::logarithmic(0.5, 100.0),
                SearchVariable::logarithmic(0.7, 30.0),
                SearchVariable::linear(0.0, 1.0),
                SearchVariable::logarithmic(1.0, 3000.0),
                SearchVariable::logarithmic(0.3, 2.0),
                SearchVariable::linear(0.0, 1.0),
                SearchVariable::linear(0.0, 2.0),
                SearchVariable::linear(0.0, 1.0),
            ]);
        }
        let features = if asymmetric { 3 } else { 2 };
        let unknowns = Unknowns { variables, non_negative: vec![false; features] };
        Self { range, asymmetric, degradation, unknowns }
    }

    /// The law of unit strength.
    fn law(&self, parameters: &[f64]) -> PeakOriented {
        let &[x, n, hardening, unloading, curvature, pinch_place, pinch_height, pinch_weight, spring] =
            parameters.first_chunk::<SHAPE>().expect("the shape is searched");
        let side = |yield_displacement| Side { strength: 1.0, yield_displacement };
        let degraded = SHAPE + usize::from(self.asymmetric);
        let degradation = self
            .degradation
            .then(|| Degradation::from_values(std::array::from_fn(|index| parameters[degraded + index])));
        PeakOriented {
            offset: 0.0,
            spring: spring / x,
            up: side(x),
            down: self.asymmetric.then(|| side(x * parameters[SHAPE])),
            n,
            hardening,
            unloading,
            curvature,
            pinch_place,
            pinch_height,
            pinch_weight,
            degradation,
        }
    }
}

impl LawFamily for PeakOrientedFamily {
    type Law = PeakOriented;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> PeakOriented {
        let mut law = self.law(searched);
        law.offset = weights[0];
        law.up.strength = weights[1];
        law.spring *= law.up.strength;
        if let Some(down) = &mut law.down {
            down.strength = weights[2];
        }
        law
    }

    fn searched(&self, law: &PeakOriented) -> Vec<f64> {
        let x = law.up.yield_displacement;
        let spring = law.spring * x / law.up.strength;
        let shape = [law.n, law.hardening, law.unloading, law.curvature];
        let pinch = [law.pinch_place, law.pinch_height, law.pinch_weight];
        let down = law.down.iter().map(|down| down.yield_displacement / x);
        let degradation = law.degradation.iter().flat_map(Degradation::values);
        let all = std::iter::once(x).chain(shape).chain(pinch).chain([spring]);
        all.chain(down).chain(degradation).collect()
    }
}

impl SearchFamily for PeakOrientedFamily {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut state = law.virgin();
        columns.run(series, OPERATIONS_A_ROW, |sample| {
            let [up, down] = law.advance(&mut state, sample.x);
            match self.asymmetric {
                true => [1.0, up + law.spring * sample.x, down],
                false => [1.0, up + down + law.spring * sample.x, 0.0],
            }
        });
    }

    /// Members that yield early and late, pinched and full.
    fn suggestions(&self) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for share in [0.02, 0.05, 0.12, 0.3] {
            for height in [0.2, 0.5, 0.8] {
                let mut member = vec![share * self.range, 2.0, 0.03, 0.3, 2.0, 0.5, height, 1.0, 0.0];
                if self.asymmetric {
                    member.push(1.0);
                }
                if self.degradation {
                    member.extend([0.6 / share, 1.5, 0.3, 10.0 / share, 1.0, 0.3, 0.2, 0.2]);
                }
                all.push(member);
            }
        }
        all
    }
}
