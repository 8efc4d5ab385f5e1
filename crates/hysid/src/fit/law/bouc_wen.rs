//! Identification of a Bouc-Wen law: `z_u`, `b`, `n` and the degradation are found by search, and for each of
//! their values stiffnesses, offset and damping by least squares.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::SearchedLaw;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Sample;
use crate::law::bouc_wen::{B_BOUNDS, BoucWen, BoucWenState, Degradation};
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;

/// Elementary operations of a row, roughly: it may take some hundred steps.
const OPERATIONS_A_ROW: usize = 5000;

impl SearchedLaw for BoucWen {
    type Family = BoucWenFamily;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(BoucWenFamily, Vec<Series>)> {
        // The rate only adds to the output, so it is no part of the memory.
        let series = thinned(Series::all(data, options.rate)?, MemoryKind::TurningPoints);
        let (low, high) = data.input_range(0);
        // The element starts at 0: an input far from it is reached by yielding.
        let range = (high.max(0.0) - low.min(0.0)).max(f64::MIN_POSITIVE);
        Ok((BoucWenFamily::new(range, options), series))
    }
}

pub(crate) struct BoucWenFamily {
    degradation: bool,
    unknowns: Unknowns,
}

impl BoucWenFamily {
    fn new(range: f64, options: &ClassicalOptions) -> Self {
        let mut variables = vec![
            SearchVariable::logarithmic(0.005 * range, 2.0 * range),
            SearchVariable::linear(B_BOUNDS.0, 2.0),
            SearchVariable::logarithmic(1.0, 8.0),
        ];
        if options.degradation {
            variables.extend([
                SearchVariable::logarithmic(1e-6, 0.1),
                SearchVariable::logarithmic(1e-5, 1.0),
                SearchVariable::logarithmic(1e-5, 1.0),
                SearchVariable::linear(0.0, 0.99),
                SearchVariable::logarithmic(1e-3, 10.0),
                SearchVariable::linear(-0.5, 1.0),
                SearchVariable::logarithmic(0.03, 3.0),
                SearchVariable::logarithmic(1e-5, 0.1),
                SearchVariable::logarithmic(0.03, 3.0),
            ]);
        }
        let columns = if options.rate.is_some() { 4 } else { 3 };
        let unknowns = Unknowns { variables, non_negative: vec![false; columns] };
        Self { degradation: options.degradation, unknowns }
    }

    /// The law of unit stiffness.
    fn law(&self, parameters: &[f64]) -> BoucWen {
        let degradation = self
            .degradation
            .then(|| Degradation::from_values(std::array::from_fn(|index| parameters[3 + index])));
        BoucWen {
            offset: 0.0,
            elastic_stiffness: 0.0,
            hysteretic_stiffness: 1.0,
            damping: 0.0,
            yield_displacement: parameters[0],
            b: parameters[1],
            n: parameters[2],
            degradation,
        }
    }
}

impl LawFamily for BoucWenFamily {
    type Law = BoucWen;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> BoucWen {
        BoucWen {
            offset: weights[0],
            elastic_stiffness: weights[1],
            hysteretic_stiffness: weights[2],
            damping: weights.get(3).copied().unwrap_or(0.0),
            ..self.law(searched)
        }
    }

    fn searched(&self, law: &BoucWen) -> Vec<f64> {
        let shape = [law.yield_displacement, law.b, law.n];
        shape.into_iter().chain(law.degradation.iter().flat_map(Degradation::values)).collect()
    }
}

impl SearchFamily for BoucWenFamily {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut state = BoucWenState::default();
        columns.run(series, OPERATIONS_A_ROW, |&Sample { x, rate, .. }| {
            [1.0, x, law.yield_displacement * law.advance(&mut state, x), rate]
        });
    }
}
