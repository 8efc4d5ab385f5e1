//! Identification of a generalized Prandtl-Ishlinskii model: envelopes and thresholds are found by search,
//! and for each of their values weights and offset by least squares.
//!
//! The law does not change if both envelopes and the thresholds are multiplied by one factor and the weights
//! divided by it, or if both envelopes are raised and `c` is lowered. The search therefore fixes `γ_l` at 0
//! and 1 at the ends of the input range.

use hysid_core::elementary::tanh;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::SearchedLaw;
use crate::fit::law::grids::check_count;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::generalized_prandtl_ishlinskii::{
    Envelope, GeneralizedPrandtlIshlinskii, PlayWeights, follow,
};
use crate::law::play_weights::MOST_PLAYS;
use crate::law::series::{Series, slope, work};
use crate::options::classical::ClassicalOptions;

/// Least rise of an envelope over the input range, as a share of its height: otherwise it would leap outside.
const SMALLEST_SHARE: f64 = 0.1;

impl SearchedLaw for GeneralizedPrandtlIshlinskii {
    type Family = GeneralizedFamily;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(GeneralizedFamily, Vec<Series>)> {
        check_count("operators", options.operators(), MOST_PLAYS)?;
        let series = Series::all(data, None)?;
        let sign = if slope(&series) < 0.0 { -1.0 } else { 1.0 };
        let lags = sign * work(&series) < 0.0;
        let series = thinned(series, MemoryKind::TurningPoints);
        Ok((GeneralizedFamily::new(data.input_range(0), sign, lags, options), series))
    }
}

pub(crate) struct GeneralizedFamily {
    low: f64,
    high: f64,
    /// 1 if the output rises with the input, else -1.
    sign: f64,
    operators: usize,
    free_weights: bool,
    unknowns: Unknowns,
}

impl GeneralizedFamily {
    fn new((low, high): (f64, f64), sign: f64, lags: bool, options: &ClassicalOptions) -> Self {
        let range = high - low;
        let centre = SearchVariable::linear(low - 0.5 * range, high + 0.5 * range);
        let width = SearchVariable::logarithmic(0.02 * range, 5.0 * range);
        let mut variables = vec![
            centre,
            width,
            centre,
            width,
            // γ_r at the lower end of the range, and its rise from there to the upper end.
            SearchVariable::linear(-0.1, 1.0),
            SearchVariable::logarithmic(0.3, 10.0),
            // The largest threshold.
            SearchVariable::logarithmic(0.02, 3.0),
            // Where the plays are at first: 0 virgin, 1 as after a large input, -1 as after a low one.
            SearchVariable::linear(-1.0, 1.0),
        ];
        let mut non_negative = vec![false];
        let operators = options.operators();
        let free_weights = options.free_weights.unwrap_or(true);
        if free_weights {
            // Plays alone lag; a loop the other way round needs weights of both signs.
            non_negative.extend(vec![lags; operators]);
        } else {
            // τ times the largest threshold.
            variables.push(SearchVariable::linear(-2.0, 12.0));
            non_negative.push(true);
        }
        let unknowns = Unknowns { variables, non_negative };
        Self { low, high, sign, operators, free_weights, unknowns }
    }

    /// The envelope with the value `from` at the lower end of the range, rising by `rise` to the upper end.
    fn envelope(&self, centre: f64, width: f64, from: f64, rise: f64) -> Envelope {
        let (a1, a2) = (1.0 / width, -centre / width);
        let shape = |x: f64| tanh(a1 * x + a2);
        let share = (shape(self.high) - shape(self.low)).max(SMALLEST_SHARE);
        let a0 = rise / share;
        Envelope { a0, a1, a2, a3: from - a0 * shape(self.low) } // (8.13)
    }

    fn law(&self, parameters: &[f64]) -> GeneralizedPrandtlIshlinskii {
        let mut left = self.envelope(parameters[0], parameters[1], 0.0, 1.0);
        let mut right = self.envelope(parameters[2], parameters[3], parameters[4], parameters[5]);
        // Virgin plays are at 0, in the middle between the envelopes at input 0.
        let middle = 0.5 * (left.value(0.0) + right.value(0.0));
        left.a3 -= middle;
        right.a3 -= middle;
        let largest = parameters[6];
        let initial = parameters[7] * (0.5 * (right.value(0.0) - left.value(0.0)).abs() + largest);
        let spacing = largest / (self.operators - 1).max(1) as f64;
        let weights = match parameters.get(8) {
            Some(decline) => {
                PlayWeights::Exponential { plays: self.operators, rho: self.sign, tau: decline / largest }
            }
            None => PlayWeights::Free(vec![self.sign; self.operators]),
        };
        GeneralizedPrandtlIshlinskii { offset: 0.0, left, right, initial, spacing, weights }
    }
}

impl LawFamily for GeneralizedFamily {
    type Law = GeneralizedPrandtlIshlinskii;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> GeneralizedPrandtlIshlinskii {
        let mut law = self.law(searched);
        law.offset = weights[0];
        law.weights = match law.weights {
            PlayWeights::Exponential { plays, rho, tau } => {
                PlayWeights::Exponential { plays, rho: rho * weights[1], tau }
            }
            PlayWeights::Free(_) => {
                PlayWeights::Free(weights[1..].iter().map(|weight| self.sign * weight).collect())
            }
        };
        law
    }

    fn searched(&self, law: &GeneralizedPrandtlIshlinskii) -> Vec<f64> {
        let (left, right) = (law.left, law.right);
        let from = right.value(self.low) - left.value(self.low);
        let shape = |x: f64| tanh(right.a1 * x + right.a2);
        let rise = right.a0 * (shape(self.high) - shape(self.low)).max(SMALLEST_SHARE);
        let largest = law.spacing * (self.operators - 1).max(1) as f64;
        let initial = law.initial / (0.5 * (right.value(0.0) - left.value(0.0)).abs() + largest);
        let place = |envelope: Envelope| [-envelope.a2 / envelope.a1, 1.0 / envelope.a1];
        let mut all = [place(left), place(right)].concat();
        all.extend([from, rise, largest, initial]);
        if let PlayWeights::Exponential { tau, .. } = law.weights {
            all.push(tau * largest);
        }
        all
    }
}

impl SearchFamily for GeneralizedFamily {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let weights = law.weights.values(law.spacing, 0);
        let mut plays = vec![law.initial; self.operators];
        let mut row = vec![1.0; self.unknowns.non_negative.len()];
        for (sample, y) in series.samples.iter().zip(&series.output) {
            if columns.is_over(8 * plays.len()) {
                return;
            }
            let (left, right) = (law.left.value(sample.x), law.right.value(sample.x));
            for (index, play) in plays.iter_mut().enumerate() {
                let r = law.spacing * index as f64;
                *play = follow(*play, left, right, r); // (8.12)
            }
            if y.is_nan() {
                continue;
            }
            if self.free_weights {
                row[1..].iter_mut().zip(&plays).for_each(|(feature, play)| *feature = self.sign * play);
            } else {
                row[1] = weights.iter().zip(&plays).map(|(weight, play)| weight * play).sum(); // (8.14)
            }
            columns.push(&row);
        }
    }
}
