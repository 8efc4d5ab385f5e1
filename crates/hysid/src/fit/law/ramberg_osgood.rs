//! Identification of a Ramberg-Osgood law: yield displacement and exponent are found by search, and for each of their
//! values offset and strength by least squares.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::SearchedLaw;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Law;
use crate::law::ramberg_osgood::RambergOsgood;
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;

/// Elementary operations of a row, roughly.
const OPERATIONS_A_ROW: usize = 400;

impl SearchedLaw for RambergOsgood {
    type Family = PowerCurves;

    fn family(data: &Dataset, _: &ClassicalOptions) -> Result<(PowerCurves, Vec<Series>)> {
        let series = thinned(Series::all(data, None)?, MemoryKind::TurningPoints);
        let (low, high) = data.input_range(0);
        // The law is virgin at 0.
        let range = (high.max(0.0) - low.min(0.0)).max(f64::MIN_POSITIVE);
        Ok((PowerCurves::new(range), series))
    }
}

pub(crate) struct PowerCurves {
    range: f64,
    unknowns: Unknowns,
}

impl PowerCurves {
    fn new(range: f64) -> Self {
        let variables = vec![
            SearchVariable::logarithmic(0.001 * range, 10.0 * range),
            SearchVariable::logarithmic(1.1, 50.0),
        ];
        Self { range, unknowns: Unknowns { variables, non_negative: vec![false; 2] } }
    }

    /// The law of unit strength.
    fn law(&self, parameters: &[f64]) -> RambergOsgood {
        let &[yield_displacement, exponent] = parameters else { unreachable!("two variables are searched") };
        RambergOsgood { offset: 0.0, strength: 1.0, yield_displacement, exponent }
    }
}

impl LawFamily for PowerCurves {
    type Law = RambergOsgood;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> RambergOsgood {
        let &[offset, strength] = weights else { unreachable!("two weights are found") };
        RambergOsgood { offset, strength, ..self.law(searched) }
    }

    fn searched(&self, law: &RambergOsgood) -> Vec<f64> {
        vec![law.yield_displacement, law.exponent]
    }
}

impl SearchFamily for PowerCurves {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut stack = law.virgin();
        columns.run(series, OPERATIONS_A_ROW, |sample| [1.0, law.advance(&mut stack, sample.x)]);
    }

    /// Curves that yield early and late, with sharp and round bends.
    fn suggestions(&self) -> Vec<Vec<f64>> {
        let shares = [0.03, 0.1, 0.3, 1.0].into_iter();
        shares.flat_map(|share| [3.0, 10.0].map(|exponent| vec![share * self.range, exponent])).collect()
    }
}
