//! Identification of a rate-dependent Prandtl-Ishlinskii model: the thresholds and their growth are found by
//! search, and for each of their values the weights by least squares.

use hysid_core::elementary::{ln, powf};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::law::SearchedLaw;
use crate::fit::law::grids::check_count;
use crate::fit::law::linearised::LawFamily;
use crate::fit::law::search::{FeatureColumns, MemoryKind, SearchFamily, SearchVariable, Unknowns, thinned};
use crate::law::Law;
use crate::law::play_weights::MOST_PLAYS;
use crate::law::rate_dependent_prandtl_ishlinskii::{
    PlayWeights, RateDependentPrandtlIshlinskii, Thresholds,
};
use crate::law::series::{Series, work};
use crate::options::classical::ClassicalOptions;

impl SearchedLaw for RateDependentPrandtlIshlinskii {
    type Family = RateDependentFamily;

    fn family(data: &Dataset, options: &ClassicalOptions) -> Result<(RateDependentFamily, Vec<Series>)> {
        check_count("operators", options.operators(), MOST_PLAYS)?;
        let rate = options.rate.ok_or(Error::RateNeeded(RateDependentPrandtlIshlinskii::FACTS.name))?;
        let series = Series::all(data, Some(rate))?;
        let family = RateDependentFamily::new(&series, options);
        Ok((family, thinned(series, MemoryKind::Path)))
    }
}

pub(crate) struct RateDependentFamily {
    /// Largest magnitudes of input and rate.
    input: f64,
    rate: f64,
    operators: usize,
    logarithmic: bool,
    free_weights: bool,
    unknowns: Unknowns,
}

impl RateDependentFamily {
    fn new(series: &[Series], options: &ClassicalOptions) -> Self {
        let operators = options.operators();
        let free_weights = options.free_weights.unwrap_or(true);
        let samples = || series.iter().flat_map(|series| &series.samples);
        let input = samples().map(|sample| sample.x.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let rate = samples().map(|sample| sample.rate.abs()).fold(1e-100, f64::max);
        // The largest threshold at rest, as a share of the largest input.
        let mut variables = vec![SearchVariable::logarithmic(0.01, 1.5)];
        let logarithmic = options.logarithmic_thresholds;
        if logarithmic {
            // β, λ|x'|^ε at the largest rate, ε.
            variables.extend([
                SearchVariable::logarithmic(1.02, 20.0),
                SearchVariable::logarithmic(1e-3, 1e4),
                SearchVariable::linear(0.2, 2.0),
            ]);
        } else {
            // Its growth at the largest rate.
            variables.push(SearchVariable::logarithmic(1e-4, 2.0));
        }
        let mut non_negative = vec![false, false];
        if free_weights {
            // Plays alone lag; a loop the other way round needs weights of both signs.
            non_negative.extend(vec![work(series) < 0.0; operators]);
        } else {
            // τ times the largest threshold.
            variables.push(SearchVariable::linear(-3.0, 12.0));
            non_negative.push(false);
        }
        let unknowns = Unknowns { variables, non_negative };
        Self { input, rate, operators, logarithmic, free_weights, unknowns }
    }

    /// The law of unit weights.
    fn law(&self, parameters: &[f64]) -> RateDependentPrandtlIshlinskii {
        let largest = parameters[0] * self.input;
        let steps = self.operators as f64;
        let (thresholds, spacing) = if self.logarithmic {
            let (beta, epsilon) = (parameters[1], parameters[3]);
            let lambda = parameters[2] / powf(self.rate, epsilon);
            (Thresholds::Logarithmic { beta, lambda, epsilon }, largest / (steps * ln(beta)))
        } else {
            (Thresholds::Linear { beta: parameters[1] * self.input / self.rate }, largest / steps)
        };
        let weights = if self.free_weights {
            PlayWeights::Free(vec![1.0; self.operators])
        } else {
            let tau = parameters[parameters.len() - 1] / (spacing * steps);
            PlayWeights::Exponential { plays: self.operators, rho: 1.0, tau }
        };
        RateDependentPrandtlIshlinskii { offset: 0.0, spring: 0.0, spacing, thresholds, weights }
    }
}

impl LawFamily for RateDependentFamily {
    type Law = RateDependentPrandtlIshlinskii;

    fn whole(&self, searched: &[f64], weights: &[f64]) -> RateDependentPrandtlIshlinskii {
        let mut law = self.law(searched);
        (law.offset, law.spring) = (weights[0], weights[1]);
        law.weights = match law.weights {
            PlayWeights::Exponential { plays, tau, .. } => {
                PlayWeights::Exponential { plays, rho: weights[2], tau }
            }
            PlayWeights::Free(_) => PlayWeights::Free(weights[2..].to_vec()),
        };
        law
    }

    fn searched(&self, law: &RateDependentPrandtlIshlinskii) -> Vec<f64> {
        let steps = self.operators as f64;
        let (largest, form) = match law.thresholds {
            Thresholds::Linear { beta } => (law.spacing * steps, vec![beta * self.rate / self.input]),
            Thresholds::Logarithmic { beta, lambda, epsilon } => {
                let growth = lambda * powf(self.rate, epsilon);
                (law.spacing * steps * ln(beta), vec![beta, growth, epsilon])
            }
        };
        let mut all = vec![largest / self.input];
        all.extend(form);
        if let PlayWeights::Exponential { tau, .. } = law.weights {
            all.push(tau * law.spacing * steps);
        }
        all
    }
}

impl SearchFamily for RateDependentFamily {
    fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    fn features(&self, parameters: &[f64], series: &Series, columns: &mut FeatureColumns<'_>) {
        let law = self.law(parameters);
        let weights = law.weights.values(law.spacing, 1);
        let mut plays = vec![0.0; self.operators];
        let mut row = vec![1.0; self.unknowns.non_negative.len()];
        for (&sample, y) in series.samples.iter().zip(&series.output) {
            if columns.is_over(8 * plays.len()) {
                return;
            }
            law.advance(&mut plays, sample); // (8.15)
            if y.is_nan() {
                continue;
            }
            row[1] = sample.x;
            if self.free_weights {
                row[2..].copy_from_slice(&plays);
            } else {
                row[2] = weights.iter().zip(&plays).map(|(weight, play)| weight * play).sum(); // (8.18)
            }
            columns.push(&row);
        }
    }
}
