//! Identification of a LuGre law: presliding displacement, Stribeck effect and Stribeck velocity are found by
//! search, and for each of their values spring, friction, damping and offset by least squares.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::SearchedLaw;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Law;
use crate::law::lugre::{Lugre, STRIBECK_BOUNDS};
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;

/// Elementary operations of a row, roughly.
const OPERATIONS_A_ROW: usize = 60;

impl SearchedLaw for Lugre {
    type Family = Contacts;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(Contacts, Vec<Series>)> {
        let rate = options.rate.ok_or(Error::RateNeeded(Lugre::FACTS.name))?;
        let series = thinned(Series::all(data, Some(rate))?, MemoryKind::Path);
        let (low, high) = data.input_range(0);
        Ok((Contacts::new((high - low).max(f64::MIN_POSITIVE), &series), series))
    }
}

pub(crate) struct Contacts {
    unknowns: Unknowns,
}

impl Contacts {
    fn new(range: f64, series: &[Series]) -> Self {
        let rates = series.iter().flat_map(|series| &series.samples).map(|sample| sample.rate.abs());
        let fastest = rates.fold(f64::MIN_POSITIVE, f64::max);
        let variables = vec![
            SearchVariable::logarithmic(1e-4 * range, range),
            SearchVariable::linear(STRIBECK_BOUNDS.0, 3.0),
            SearchVariable::logarithmic(1e-3 * fastest, 2.0 * fastest),
        ];
        Self { unknowns: Unknowns { variables, non_negative: vec![false; 5] } }
    }

    /// The law of unit friction.
    fn law(&self, parameters: &[f64]) -> Lugre {
        let &[presliding, stribeck, stribeck_velocity] = parameters else {
            unreachable!("three variables are searched")
        };
        Lugre { presliding, stribeck, stribeck_velocity, ..Lugre::default() }
    }
}

impl LawFamily for Contacts {
    type Law = Lugre;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> Lugre {
        let &[offset, spring, sliding, bristle_damping, viscous] = weights else {
            unreachable!("five weights are found")
        };
        Lugre { offset, spring, sliding, bristle_damping, viscous, ..self.law(searched) }
    }

    fn searched(&self, law: &Lugre) -> Vec<f64> {
        vec![law.presliding, law.stribeck, law.stribeck_velocity]
    }
}

impl SearchFamily for Contacts {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut state = law.virgin();
        columns.run(series, OPERATIONS_A_ROW, |sample| {
            let bristles = law.advance(&mut state, *sample);
            [1.0, sample.x, bristles.deflection, bristles.rate, sample.rate]
        });
    }
}
