//! Identification of a Jiles-Atherton law: `a`, `k`, `α M_s/(3a)` and `c` are found by search, and for each of
//! their values saturation, offset and the share of the field by least squares.

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::data::summary::Summary;
use crate::error::{Channel, DataProblem, Error, Result};
use crate::fit::law::Identify;
use crate::fit::law::linearised::{self, LawFamily, LinearisedLaw};
use crate::fit::law::search::{
    FeatureColumns, IdentifiedLaw, MemoryKind, SearchFamily, SearchVariable, Unknowns, search, thinned,
};
use crate::fit::progress::SearchObserver;
use crate::law::jiles_atherton::{C_BOUNDS, JilesAtherton, JilesAthertonForm, JilesAthertonState};
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;
use crate::stop_check::StopCheck;

impl Identify for JilesAtherton {
    const TAKES_WEIGHTS: bool = true;

    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let first = &data.records()[0];
        if Summary::of(data).turning_points() == 0 {
            let problem = DataProblem::NeverTurns("jiles-atherton");
            return Err(first.defect(None, Some(Channel::Input(0)), problem));
        }
        let (family, series) = posed(data, options)?;
        let output = |problem| first.defect(None, Some(Channel::Output), problem);
        let found = search(&family, &series, options, observer, stop).map_err(|error| match error {
            // All that a search can leave invalid is M_s = 0.
            Error::Parts(_) => output(DataProblem::NoMagnetisation),
            other => other,
        })?;
        // A line that falls faster than the anhysteretic curve rises anywhere: a law that falls with the field.
        let JilesAtherton { permeability, saturation, a, .. } = found.law;
        if -permeability > saturation / (3.0 * a) {
            return Err(output(DataProblem::NoMagnetisation));
        }
        Ok(found)
    }

    fn linearised(&self, data: &Dataset, options: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let (family, series) = posed(data, options)?;
        Ok(Some(linearised::of_search(&family, &series, self)))
    }
}

/// Search variables and the rows to fit.
fn posed(data: &Dataset, options: &ClassicalOptions) -> Result<(Materials, Vec<Series>)> {
    let series = thinned(Series::all(data, None)?, MemoryKind::TurningPoints);
    let (low, high) = data.input_range(0);
    let form = match options.differential_form {
        true => JilesAthertonForm::Differential,
        false => JilesAthertonForm::Original,
    };
    Ok((Materials::new(low.abs().max(high.abs()), form), series))
}

struct Materials {
    form: JilesAthertonForm,
    unknowns: Unknowns,
}

impl Materials {
    fn new(largest: f64, form: JilesAthertonForm) -> Self {
        let variables = vec![
            SearchVariable::logarithmic(0.02 * largest, 3.0 * largest),
            SearchVariable::logarithmic(0.02 * largest, 3.0 * largest),
            // α M_s as a share of 3a.
            SearchVariable::linear(0.0, 0.98),
            SearchVariable::linear(C_BOUNDS.0, C_BOUNDS.1),
        ];
        Self { form, unknowns: Unknowns { variables, non_negative: vec![false, false, true] } }
    }

    /// The law of unit saturation.
    fn law(&self, parameters: &[f64]) -> JilesAtherton {
        let &[a, k, share, c] = parameters else { unreachable!("four variables are searched") };
        let alpha = share * 3.0 * a;
        JilesAtherton { offset: 0.0, permeability: 0.0, saturation: 1.0, a, k, alpha, c, form: self.form }
    }
}

impl LawFamily for Materials {
    type Law = JilesAtherton;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> JilesAtherton {
        let law = self.law(searched);
        let (offset, permeability, saturation) = (weights[0], weights[1], weights[2]);
        JilesAtherton { offset, permeability, saturation, alpha: law.alpha / saturation, ..law }
    }

    fn searched(&self, law: &JilesAtherton) -> Vec<f64> {
        vec![law.a, law.k, law.coupling() / (3.0 * law.a), law.c]
    }
}

impl SearchFamily for Materials {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features_side_by_side(
        &self,
        points: &[Vec<f64>],
        series: &Series,
        columns: &mut [FeatureColumns<'_>],
    ) {
        let laws: Vec<JilesAtherton> = points.iter().map(|parameters| self.law(parameters)).collect();
        let mut states = vec![JilesAthertonState::default(); laws.len()];
        for (sample, y) in series.samples.iter().zip(&series.output) {
            let works = laws.iter().zip(&states).map(|(law, state)| law.operations(state, sample.x));
            if columns.iter_mut().zip(works).any(|(columns, operations)| columns.is_over(operations)) {
                return;
            }
            JilesAtherton::advance_side_by_side(&laws, &mut states, sample.x);
            if !y.is_nan() {
                for (columns, state) in columns.iter_mut().zip(&states) {
                    columns.push(&[1.0, sample.x, state.share()]);
                }
            }
        }
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let mut state = JilesAthertonState::default();
        for (sample, y) in series.samples.iter().zip(&series.output) {
            if columns.is_over(law.operations(&state, sample.x)) {
                return;
            }
            let m = law.advance(&mut state, sample.x);
            if !y.is_nan() {
                columns.push(&[1.0, sample.x, m]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;
    use crate::fit::law::search::tests::assert_side_by_side;

    fn series_of(x: Vec<f64>) -> Series {
        let y = x.clone();
        Series::all(&Dataset::from_slices(&x, &y).unwrap(), None).unwrap().remove(0)
    }

    #[test]
    fn laws_side_by_side_are_as_alone() {
        for form in [JilesAthertonForm::Original, JilesAthertonForm::Differential] {
            // From steps below a part to steps of many, and a rest.
            let x = (0..300).map(|k| f64::from(k / 3) * sin(0.3 * f64::from(k)));
            assert_side_by_side(&Materials::new(100.0, form), &[series_of(x.collect())]);
        }
    }
}
