//! Search for the lead-in of each record: that with which a model that is linear in its weights has the lowest
//! error on all records together.
//!
//! ```text
//! J(l_1 .. l_R) = min_w [ ‖Φ(l) w - y‖²/N + λ ‖w‖² ]                       theory.md (11.11)
//! ```
//!
//! `l_r` is the lead-in of record `r`, one of those tried, and `Φ` has a row of features for each of the `N` rows
//! with an output, in scaled units: the relays of a Preisach plane of few cells, which represent the memory of
//! magnets and of friction alike, and a network of few random stops, which take rate, further inputs and
//! deterioration. The sums of each record with each lead-in are computed once; then `J` costs the solution of one
//! small system. `J` is lowered record by record, until no record changes or after four rounds, from several
//! beginnings: all records virgin, all after the upper end of the range, all after the lower end.

use crate::data::initial_state::lead_ins_tried;
use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Record};
use crate::error::{Error, Result};
use crate::fit::initial_state::quick;
use crate::fit::law::preisach::PreisachProblem;
use crate::fit::law::random_stops::DrawnStops;
use crate::fit::sums::{SumGatherer, Sums};
use crate::law::facts::Origin;
use crate::law::series::Series;
use crate::model::input_transform::TransformedData;
use crate::network::scaling::Scaling;
use crate::optimise::non_negative::Penalty;
use crate::optimise::parallel;
use crate::options::classical::ClassicalOptions;
use crate::options::input_options::InputOptions;
use crate::stop_check::StopCheck;
use crate::validation::RowFolds;

const ROUNDS: usize = 4;

/// Of the lead-ins tried, those from which the search begins with all records: virgin, and either end.
const BEGINNINGS: std::ops::Range<usize> = 0..3;

/// Random stops, and intervals of each axis of the Preisach plane.
const STOPS: usize = 30;
pub(super) const INTERVALS: usize = 12;

/// Penalty `λ`, in scaled units. Designed.
const RIDGE: f64 = 1e-5;

/// Share of the mean square error by which a lead-in in place of one tried before it, in one record, must lower
/// that of a record, on average over the records; and all of them together that of the virgin state. Features
/// that are not those of the specimen give gains of up to a quarter by chance. Designed.
const WORTH: f64 = 0.3;

/// Records whose lead-ins are searched together: their sums are kept.
const TOGETHER: usize = 64;

/// The lead-in of each record, those of records without an output virgin; `None` once stopped.
pub(super) fn lead_ins(
    data: &Dataset,
    rate: Option<RateMethod>,
    seed: u64,
    stop: StopCheck<'_>,
) -> Result<Option<Vec<Vec<f64>>>> {
    let tried = lead_ins_tried(data.input_range(0));
    let features = Features::of(data, rate, seed)?;
    let scored: Vec<usize> =
        (0..data.records().len()).filter(|&index| data.records()[index].scored() > 0).collect();
    let mut found = vec![Vec::new(); data.records().len()];
    let mut before: Option<EarlierRecords> = None;
    for records in scored.chunks(TOGETHER) {
        let part = data.partition(|index| records.binary_search(&index).is_ok()).0;
        let sums = match features.sums(&part, &tried, stop) {
            Err(Error::Stopped) => return Ok(None),
            sums => sums?,
        };
        let search = StateSearch { features: &features, sums: &sums, before: before.as_ref(), stop };
        let Some(chosen) = search.lowest() else { return Ok(None) };
        for (&record, &place) in records.iter().zip(&chosen) {
            found[record].clone_from(&tried[place]);
        }
        before = Some(EarlierRecords { total: search.total(&chosen), most_frequent: most_frequent(&chosen) });
    }
    Ok(Some(found))
}

struct EarlierRecords {
    total: Sums,
    /// Lead-in of most records of the last part.
    most_frequent: usize,
}

struct Features {
    rate: Option<RateMethod>,
    scaling: Scaling,
    drawn: DrawnStops,
    relays: PreisachProblem,
    penalty: Penalty,
}

impl Features {
    fn of(data: &Dataset, rate: Option<RateMethod>, seed: u64) -> Result<Self> {
        let seen = TransformedData::of(data, &InputOptions::default(), rate, Origin::OfData)?;
        let options = ClassicalOptions { rate: seen.rate, seed, operators: Some(STOPS), ..quick() };
        let drawn = DrawnStops::of(&seen.data, &options)?;
        let relays =
            PreisachProblem::of(&Series::all(&seen.data, None)?, seen.data.input_range(0), INTERVALS);
        let features = drawn.features() + relays.features() - 1;
        let penalty = Penalty::ridge((0..features).map(|i| f64::from(u8::from(i > 0))));
        Ok(Self { rate, scaling: Scaling::of(&seen.data, seen.rate)?, drawn, relays, penalty })
    }

    fn sums(&self, data: &Dataset, tried: &[Vec<f64>], stop: StopCheck<'_>) -> Result<Vec<Vec<Sums>>> {
        let with = |lead_in: &Vec<f64>| -> Result<Vec<Sums>> {
            let begun = data.clone().with_lead_ins(|_, _| lead_in.clone())?;
            let seen = TransformedData::of(&begun, &InputOptions::default(), self.rate, Origin::OfData)?;
            seen.data.records().iter().map(|record| self.sums_of(record, seen.rate, stop)).collect()
        };
        let by_lead_in: Vec<Vec<Sums>> = parallel::each(tried, with).into_iter().collect::<Result<_>>()?;
        let mut columns: Vec<_> = by_lead_in.into_iter().map(Vec::into_iter).collect();
        let records = 0..data.records().len();
        Ok(records.map(|_| columns.iter_mut().filter_map(Iterator::next).collect()).collect())
    }

    fn sums_of(&self, record: &Record, rate: Option<RateMethod>, stop: StopCheck<'_>) -> Result<Sums> {
        let stops = self.drawn.rows(record, &self.scaling, rate, stop)?;
        let relays = self.relays.rows(&Series::of(record, None)?, &self.scaling, stop)?;
        let features = self.drawn.features();
        let mut gatherer = SumGatherer::new(features + self.relays.features() - 1, &RowFolds::one(), stop);
        let mut both = vec![0.0; features + self.relays.features() - 1];
        for (row, of_relays) in relays.iter().enumerate() {
            both.iter_mut().zip(&stops[..features]).for_each(|(value, column)| *value = column[row]);
            // The first feature of the relays is the constant too.
            both[features..].copy_from_slice(&of_relays[1..]);
            gatherer.add(0, &both, stops[features][row]);
        }
        Ok(gatherer.finish()?.into_total())
    }

    /// `J`; `None` once stopped.
    fn objective(&self, total: &Sums, stop: StopCheck<'_>) -> Option<f64> {
        let mut penalised = total.quadratic();
        penalised.penalise(&self.penalty, RIDGE);
        let weights = penalised.minimum(stop)?;
        let squares: f64 = weights[1..].iter().map(|weight| weight * weight).sum();
        Some(total.mean_square_error(&weights) + RIDGE * squares)
    }
}

struct StateSearch<'s> {
    features: &'s Features,
    /// Of each record with each lead-in.
    sums: &'s [Vec<Sums>],
    before: Option<&'s EarlierRecords>,
    stop: StopCheck<'s>,
}

impl StateSearch<'_> {
    /// The places of the lead-ins with the lowest `J` of all beginnings; `None` once stopped.
    fn lowest(&self) -> Option<Vec<usize>> {
        let beginnings = match self.before {
            Some(before) => vec![before.most_frequent],
            None => BEGINNINGS.collect(),
        };
        let descended = |beginning| self.descended(vec![beginning; self.sums.len()]);
        let ends: Vec<(f64, Vec<usize>)> =
            parallel::each_taken(beginnings, descended).into_iter().collect::<Option<_>>()?;
        let (lowest, chosen) = ends.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let virgin = vec![0; self.sums.len()];
        let from_virgin = self.features.objective(&self.total(&virgin), self.stop)?;
        Some(if lowest < (1.0 - WORTH) * from_virgin { chosen } else { virgin })
    }

    fn descended(&self, mut chosen: Vec<usize>) -> Option<(f64, Vec<usize>)> {
        let worth = 1.0 - WORTH / self.sums.len() as f64;
        let mut objective = f64::INFINITY;
        for _ in 0..ROUNDS {
            let before = chosen.clone();
            for (record, sums) in self.sums.iter().enumerate() {
                let mut others = self.total(&chosen);
                others.add(&sums[chosen[record]], -1.0);
                objective = f64::INFINITY;
                for (place, sums) in sums.iter().enumerate() {
                    let mut total = others.clone();
                    total.add(sums, 1.0);
                    let tried = self.features.objective(&total, self.stop)?;
                    if tried < worth * objective {
                        (objective, chosen[record]) = (tried, place);
                    }
                }
            }
            if chosen == before {
                break;
            }
        }
        Some((objective, chosen))
    }

    fn total(&self, chosen: &[usize]) -> Sums {
        let mut chosen = self.sums.iter().zip(chosen).map(|(sums, &place)| &sums[place]);
        let first = self.before.map(|before| &before.total).or_else(|| chosen.next());
        let mut total = first.expect("at least one record has an output").clone();
        chosen.for_each(|sums| total.add(sums, 1.0));
        total
    }
}

/// The place that is chosen most often; of several as often, the first.
fn most_frequent(chosen: &[usize]) -> usize {
    let count = |place: usize| chosen.iter().filter(|one| **one == place).count();
    let most = chosen.iter().copied().max_by_key(|&place| (count(place), std::cmp::Reverse(place)));
    most.unwrap_or_default()
}
