//! A real-coded genetic algorithm: tournament selection, simulated binary crossover, polynomial mutation,
//! elitism. It minimises any function within bounds of its variables.
//!
//! ```text
//! crossover  β = (2u)^{1/(η+1)} if u <= ½, else (2(1-u))^{-1/(η+1)};  child = ½[(1±β) a + (1∓β) b]
//! mutation   δ = (2u)^{1/(η+1)} - 1 if u < ½, else 1 - (2(1-u))^{1/(η+1)};  x += δ (high - low)
//!                                                                              theory.md (3.6)
//! ```
//!
//! `a` and `b` are the values of a gene in two parents, `x` its value in a child, `low` and `high` its
//! bounds, `u` a random number uniform on (0, 1), and `η = 20` the distribution index.
//!
//! Every individual has its own random generator, seeded by (seed, generation, index), so the result does not
//! depend on the number of threads.

use hysid_core::elementary::powf;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde::{Deserialize, Serialize};

use crate::error::{Error, OptionError, Result};
use crate::optimise::MOST_COUNTED;
use crate::optimise::parallel;
use crate::optimise::random::mix;
use crate::options::network::POPULATIONS;

/// Individuals that enter a tournament.
const TOURNAMENT: usize = 2;
/// Probability that a child has two parents.
const CROSSOVER: f64 = 0.9;
/// Probability that a gene takes part in a crossover.
const GENE_CROSSOVER: f64 = 0.5;
/// η of the crossover: larger keeps children nearer to their parents.
const CROSSOVER_INDEX: f64 = 20.0;
/// η of the mutation.
const MUTATION_INDEX: f64 = 20.0;
/// Best individuals that live on as they are.
const ELITE: usize = 1;

/// One point of the search and its cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Individual {
    /// Variables, within their bounds.
    pub genes: Vec<f64>,
    /// The function there.
    pub cost: f64,
}

/// A minimisation problem with bounds.
pub struct BoundedProblem<'a> {
    /// Lowest and highest value of each gene.
    pub bounds: &'a [(f64, f64)],
    /// Seed of all random numbers.
    pub seed: u64,
    /// The function to be minimised.
    pub cost: &'a (dyn Fn(&[f64]) -> f64 + Sync),
}

/// The state of a genetic search, which can be stored and resumed to the last bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Genetic {
    population: Vec<Individual>,
    generation: usize,
    evaluations: usize,
}

impl Genetic {
    /// A first population of `size` individuals, each drawn by `draw` from its own generator.
    ///
    /// # Errors
    /// A size outside [`POPULATIONS`], bounds that are empty or not in order.
    pub fn new(
        problem: &BoundedProblem,
        size: usize,
        draw: &(dyn Fn(&mut Xoshiro256PlusPlus) -> Vec<f64> + Sync),
    ) -> Result<Self> {
        if !POPULATIONS.contains(&size) {
            let (fewest, most) = (POPULATIONS.start(), POPULATIONS.end());
            return Err(OptionError::value("population", size, format!("choose {fewest} to {most}")).into());
        }
        let sound = |&(low, high): &(f64, f64)| low.is_finite() && high.is_finite() && low <= high;
        if problem.bounds.is_empty() || !problem.bounds.iter().all(sound) {
            return Err(Error::Parts("a genetic search needs finite bounds, the lower one first".into()));
        }
        let drawn = |index| problem.individual(draw(&mut generator(problem.seed, 0, index)));
        let population = parallel::numbered(size, drawn);
        Ok(Self { population, generation: 0, evaluations: size })
    }

    /// True if it is a population of this size within these bounds.
    pub(crate) fn is_sound(&self, bounds: &[(f64, f64)], size: usize) -> bool {
        let is_gene = |(gene, &(low, high)): (&f64, &(f64, f64))| (low..=high).contains(gene);
        let is_individual = |one: &Individual| {
            one.genes.len() == bounds.len() && one.genes.iter().zip(bounds).all(is_gene) && !one.cost.is_nan()
        };
        self.population.len() == size
            && self.population.iter().all(is_individual)
            && self.generation.max(self.evaluations) <= MOST_COUNTED
    }

    /// Computes the next generation.
    pub fn advance(&mut self, problem: &BoundedProblem) {
        self.generation += 1;
        let size = self.population.len();
        let mut order: Vec<usize> = (0..size).collect();
        // A stable sort: of equals the earlier is the better.
        order.sort_by(|&a, &b| self.population[a].cost.total_cmp(&self.population[b].cost));
        let elite: Vec<Individual> =
            order[..ELITE].iter().map(|&index| self.population[index].clone()).collect();
        let parents = &self.population;
        let children = parallel::numbered(size - ELITE, |child| {
            let mut generator = generator(problem.seed, self.generation, ELITE + child);
            problem.individual(problem.child(parents, &mut generator))
        });
        self.population = [elite, children].concat();
        self.evaluations += size - ELITE;
    }

    /// The best individual.
    pub fn best(&self) -> &Individual {
        let best = self.population.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        best.expect("a population has individuals")
    }

    /// All individuals of the present generation.
    pub fn population(&self) -> &[Individual] {
        &self.population
    }

    /// Number of generations so far.
    pub fn generation(&self) -> usize {
        self.generation
    }

    /// Evaluations of the function so far.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }
}

impl BoundedProblem<'_> {
    fn individual(&self, mut genes: Vec<f64>) -> Individual {
        for (gene, &(low, high)) in genes.iter_mut().zip(self.bounds) {
            *gene = gene.clamp(low, high);
        }
        let cost = (self.cost)(&genes);
        Individual { cost: if cost.is_nan() { f64::INFINITY } else { cost }, genes }
    }

    fn child(&self, parents: &[Individual], generator: &mut impl Rng) -> Vec<f64> {
        let (a, b) = (tournament(parents, generator), tournament(parents, generator));
        let mut genes = if generator.random::<f64>() < CROSSOVER {
            crossover(&a.genes, &b.genes, generator)
        } else {
            a.genes.clone()
        };
        let probability = 1.0 / genes.len() as f64;
        for (gene, &(low, high)) in genes.iter_mut().zip(self.bounds) {
            if generator.random::<f64>() < probability {
                *gene += mutation(generator.random()) * (high - low);
            }
        }
        genes
    }
}

fn generator(seed: u64, generation: usize, index: usize) -> Xoshiro256PlusPlus {
    let mixed = mix(mix(mix(seed) ^ generation as u64) ^ index as u64);
    Xoshiro256PlusPlus::seed_from_u64(mixed)
}

/// The best of a few drawn at random.
fn tournament<'p>(parents: &'p [Individual], generator: &mut impl Rng) -> &'p Individual {
    let drawn = (0..TOURNAMENT).map(|_| &parents[generator.random_range(0..parents.len())]);
    drawn.min_by(|a, b| a.cost.total_cmp(&b.cost)).expect("a tournament has entrants")
}

/// One of the two children of simulated binary crossover, either with the same probability.
fn crossover(a: &[f64], b: &[f64], generator: &mut impl Rng) -> Vec<f64> {
    let sign = if generator.random::<bool>() { 1.0 } else { -1.0 };
    let gene = |(&a, &b): (&f64, &f64)| {
        if generator.random::<f64>() >= GENE_CROSSOVER {
            return if sign > 0.0 { a } else { b };
        }
        let u: f64 = generator.random();
        let exponent = 1.0 / (CROSSOVER_INDEX + 1.0);
        let beta = if u <= 0.5 { powf(2.0 * u, exponent) } else { powf(1.0 / (2.0 * (1.0 - u)), exponent) };
        0.5 * (a + b + sign * beta * (a - b))
    };
    a.iter().zip(b).map(gene).collect()
}

/// Polynomial mutation, as a share of the range.
fn mutation(u: f64) -> f64 {
    let exponent = 1.0 / (MUTATION_INDEX + 1.0);
    if u < 0.5 { powf(2.0 * u, exponent) - 1.0 } else { 1.0 - powf(2.0 * (1.0 - u), exponent) }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::square;

    use super::*;

    /// Σ (x_i - i/10)² with its minimum inside the box but for one gene, which is held at its bound.
    fn sphere(genes: &[f64]) -> f64 {
        genes.iter().enumerate().map(|(i, x)| square(x - 0.1 * i as f64)).sum()
    }

    const BOUNDS: [(f64, f64); 8] = [
        (-1.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 1.0),
        (0.5, 1.0),
        (-1.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 1.0),
        (-3.0, 3.0),
    ];

    fn uniform(generator: &mut Xoshiro256PlusPlus) -> Vec<f64> {
        BOUNDS.iter().map(|(low, high)| low + (high - low) * generator.random::<f64>()).collect()
    }

    fn bred(seed: u64, generations: usize, threads: usize) -> Genetic {
        let problem = BoundedProblem { bounds: &BOUNDS, seed, cost: &sphere };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut search = Genetic::new(&problem, 40, &uniform).unwrap();
            for _ in 0..generations {
                search.advance(&problem);
            }
            search
        })
    }

    #[test]
    fn it_finds_the_lowest_point_of_the_box() {
        let search = bred(1, 300, 2);
        // The bound costs (0.5 - 0.3)²; random search of as many points is far off.
        assert!((search.best().cost - 0.04).abs() < 1e-4, "{}", search.best().cost);
        let mut generator = generator(1, 0, 0);
        let random = (0..search.evaluations()).map(|_| sphere(&uniform(&mut generator)));
        assert!(random.fold(f64::INFINITY, f64::min) > 0.1);
        let within = |individual: &Individual| {
            individual.genes.iter().zip(BOUNDS).all(|(gene, (low, high))| (low..=high).contains(gene))
        };
        assert!(search.population().iter().all(within));
        assert_eq!((search.generation(), search.evaluations()), (300, 40 + 300 * 39));
    }

    #[test]
    fn the_best_never_gets_worse_and_threads_do_not_matter() {
        let mut last = f64::INFINITY;
        for generations in [0, 1, 2, 5, 20, 60] {
            let search = bred(3, generations, 1);
            assert!(search.best().cost <= last);
            last = search.best().cost;
            assert_eq!(search, bred(3, generations, 2));
        }
        assert_ne!(bred(3, 20, 1), bred(4, 20, 1));
    }

    #[test]
    fn crossover_keeps_the_mean_and_spreads_about_the_parents() {
        let mut generator = generator(5, 0, 0);
        let (a, b) = ([1.0; 4000], [3.0; 4000]);
        let children: Vec<f64> = (0..10).flat_map(|_| crossover(&a, &b, &mut generator)).collect();
        let mean = children.iter().sum::<f64>() / children.len() as f64;
        // Of 10 children, each all from one side or the other where genes do not take part.
        assert!((1.0..3.0).contains(&mean), "{mean}");
        let distance = children.iter().map(|c| (c - 1.0).abs().min((c - 3.0).abs()));
        // Half of the genes are a parent's, the rest lie at |β - 1| from one: its mean for η = 20 is
        // (1/2)(1/22 + 1/20) by integration.
        let mean_distance = distance.sum::<f64>() / children.len() as f64;
        let expected = 0.5 * 0.5 * (1.0 / 22.0 + 1.0 / 20.0);
        assert!((mean_distance - expected).abs() < 0.05 * expected, "{mean_distance}, not {expected}");
    }

    #[test]
    fn mutation_has_the_distribution_of_its_law() {
        // P(|δ| <= d) = 1 - (1 - d)^{η+1}; its mean is 1/(η + 2).
        let n = 100_000;
        let deltas: Vec<f64> = (0..n).map(|k| mutation((k as f64 + 0.5) / n as f64)).collect();
        let mean = deltas.iter().sum::<f64>() / n as f64;
        let magnitude = deltas.iter().map(|d| d.abs()).sum::<f64>() / n as f64;
        assert!(mean.abs() < 1e-6 && (magnitude - 1.0 / 22.0).abs() < 1e-4, "{mean}, {magnitude}");
        assert!(deltas.iter().all(|d| d.abs() <= 1.0));
    }

    #[test]
    fn costs_that_are_no_number_are_the_worst_and_odd_settings_are_refused() {
        let cost = |genes: &[f64]| if genes[0] < 0.0 { f64::NAN } else { genes[0] };
        let problem = BoundedProblem { bounds: &[(-1.0, 1.0)], seed: 1, cost: &cost };
        let draw = |generator: &mut Xoshiro256PlusPlus| vec![2.0 * generator.random::<f64>() - 1.0];
        let mut search = Genetic::new(&problem, 20, &draw).unwrap();
        for _ in 0..50 {
            search.advance(&problem);
        }
        assert!((0.0..1e-2).contains(&search.best().cost), "{}", search.best().cost);
        assert!(Genetic::new(&problem, 3, &draw).is_err());
        let reversed = BoundedProblem { bounds: &[(1.0, -1.0)], ..problem };
        assert!(Genetic::new(&reversed, 20, &draw).is_err());
    }
}
