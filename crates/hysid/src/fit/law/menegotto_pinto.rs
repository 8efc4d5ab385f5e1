//! Identification of a Menegotto-Pinto law: yield displacement, roundness and isotropic hardening are found by search,
//! and for each of their values offset, hardening line and strength by least squares.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::SearchedLaw;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Law;
use crate::law::menegotto_pinto::{Downwards, LOSS_BOUNDS, MenegottoPinto};
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;

/// Elementary operations of a row, roughly.
const OPERATIONS_A_ROW: usize = 150;

impl SearchedLaw for MenegottoPinto {
    type Family = Steels;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(Steels, Vec<Series>)> {
        let series = thinned(Series::all(data, None)?, MemoryKind::TurningPoints);
        let (low, high) = data.input_range(0);
        // The material is virgin at 0.
        let range = (high.max(0.0) - low.min(0.0)).max(f64::MIN_POSITIVE);
        Ok((Steels::new(range, options.asymmetric), series))
    }
}

pub(crate) struct Steels {
    range: f64,
    asymmetric: bool,
    unknowns: Unknowns,
}

impl Steels {
    fn new(range: f64, asymmetric: bool) -> Self {
        let isotropic = SearchVariable::linear(-0.1, 0.4);
        let mut variables = vec![
            SearchVariable::logarithmic(0.002 * range, range),
            SearchVariable::logarithmic(0.7, 30.0),
            SearchVariable::linear(LOSS_BOUNDS.0, 0.97),
            SearchVariable::logarithmic(0.01, 30.0),
            isotropic,
        ];
        if asymmetric {
            variables.extend([SearchVariable::logarithmic(0.5, 2.0), isotropic]);
        }
        Self { range, asymmetric, unknowns: Unknowns { variables, non_negative: vec![false; 3] } }
    }

    /// The law of unit strength.
    fn law(&self, parameters: &[f64]) -> MenegottoPinto {
        let &[yield_displacement, roundness, loss, pace, isotropic] =
            parameters.first_chunk().expect("five parameters of every law");
        MenegottoPinto {
            offset: 0.0,
            hardening_stiffness: 0.0,
            strength: 1.0,
            yield_displacement,
            roundness,
            loss,
            pace,
            isotropic,
            down: self.asymmetric.then(|| Downwards { ratio: parameters[5], isotropic: parameters[6] }),
        }
    }
}

impl LawFamily for Steels {
    type Law = MenegottoPinto;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> MenegottoPinto {
        let law = self.law(searched);
        MenegottoPinto { offset: weights[0], hardening_stiffness: weights[1], strength: weights[2], ..law }
    }

    fn searched(&self, law: &MenegottoPinto) -> Vec<f64> {
        let upwards = [law.yield_displacement, law.roundness, law.loss, law.pace, law.isotropic];
        let downwards = law.down.iter().flat_map(|down| [down.ratio, down.isotropic]);
        upwards.into_iter().chain(downwards).collect()
    }
}

impl SearchFamily for Steels {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut state = law.virgin();
        columns.run(series, OPERATIONS_A_ROW, |sample| [1.0, sample.x, law.advance(&mut state, sample.x)]);
    }

    /// Steels that yield early and late, with sharp and round bends.
    fn suggestions(&self) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for share in [0.02, 0.06, 0.15] {
            for loss in [0.3, 0.6, 0.9] {
                let mut steel = vec![share * self.range, 10.0, loss, 1.0, 0.0];
                if self.asymmetric {
                    steel.extend([1.0, 0.0]);
                }
                all.push(steel);
            }
        }
        all
    }
}
