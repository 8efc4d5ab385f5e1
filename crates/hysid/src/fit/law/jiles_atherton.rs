//! Identification of a Jiles-Atherton law: `a`, `k`, `α M_s` and `c` are searched, the saturation, the
//! offset and the share of the field follow.

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::search::{
    Columns, Effort, Family, Identified, Memory, SearchObserver, Variable, search, thinned,
};
use crate::law::Law;
use crate::law::series::Series;
use crate::options::classical::ClassicalOptions;
use crate::options::network::SEED;
use crate::stop_check::StopCheck;

use crate::fit::law::Identify;
use crate::law::jiles_atherton::{C_BOUNDS, JilesAtherton, JilesAthertonForm, JilesAthertonState};

/// How a Jiles-Atherton law is identified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JilesAthertonOptions {
    /// Which differential equation.
    pub form: JilesAthertonForm,
    /// Starts of the search.
    pub starts: usize,
    /// Iterations of each at most.
    pub epochs: usize,
    /// Seed of the random starts.
    pub seed: u64,
}

impl Default for JilesAthertonOptions {
    fn default() -> Self {
        Self { form: JilesAthertonForm::Original, starts: 8, epochs: 40, seed: SEED }
    }
}

impl TryFrom<&ClassicalOptions> for JilesAthertonOptions {
    type Error = Error;

    fn try_from(options: &ClassicalOptions) -> Result<Self> {
        let defaults = Self::default();
        Ok(Self {
            form: if options.differential_form {
                JilesAthertonForm::Differential
            } else {
                JilesAthertonForm::Original
            },
            starts: options.starts.unwrap_or(defaults.starts),
            epochs: options.epochs.unwrap_or(defaults.epochs),
            seed: options.seed,
        })
    }
}

impl Identify for JilesAtherton {
    type Options = JilesAthertonOptions;

    fn identify(
        data: &Dataset,
        options: &JilesAthertonOptions,
        observer: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<Identified<Self>> {
        data.check_identifiable(FEWEST_ROWS)?;
        let series = thinned(Series::all(data, None)?, Memory::TurningPoints);
        let (low, high) = data.input_range(0);
        let family = Materials::new(low.abs().max(high.abs()), options.form);
        let effort = Effort { starts: options.starts, epochs: options.epochs, seed: options.seed };
        let found = search(&family, &series, effort, observer, stop)?;
        let mut law = family.law(&found.parameters);
        (law.offset, law.permeability, law.saturation) =
            (found.weights[0], found.weights[1], found.weights[2]);
        Ok(found.identified(law.validated()?))
    }
}

/// Jiles-Atherton laws as the search sees them.
struct Materials {
    form: JilesAthertonForm,
    variables: [Variable; 4],
}

impl Materials {
    fn new(largest: f64, form: JilesAthertonForm) -> Self {
        let variables = [
            Variable::logarithmic(0.02 * largest, 3.0 * largest),
            Variable::logarithmic(0.02 * largest, 3.0 * largest),
            // α M_s as a share of 3a.
            Variable::linear(0.0, 0.98),
            Variable::linear(C_BOUNDS.0, C_BOUNDS.1),
        ];
        Self { form, variables }
    }

    /// The law of unit saturation.
    fn law(&self, parameters: &[f64]) -> JilesAtherton {
        let &[a, k, share, c] = parameters else { unreachable!("four variables are searched") };
        let coupling = share * 3.0 * a;
        JilesAtherton { offset: 0.0, permeability: 0.0, saturation: 1.0, a, k, coupling, c, form: self.form }
    }
}

impl Family for Materials {
    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn non_negative(&self) -> &[bool] {
        &[false; 3]
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut Columns<'_>) {
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
