//! Which rows of long records a search looks at.

use crate::data::record::Thinning;
use crate::law::series::Series;

/// Rows compared with the measured output at most.
const MOST_COMPARED: usize = 5000;

/// Rows run through at most; of longer data the beginnings of the records are searched on.
const MOST_RUN: usize = 200_000;

/// What the memory of a law depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Memory {
    /// Only the turning points of the input: rows between them may be left out.
    TurningPoints,
    /// Every row, because the rate counts.
    EveryRow,
}

/// The records with so many outputs blanked, and rows that neither turn nor are compared left out,
/// that the cost of a search has a bound. Every turning point stays, so that the memory is the same.
pub(crate) fn thinned(series: Vec<Series>, memory: Memory) -> Vec<Series> {
    thinned_to(series, memory, MOST_COMPARED)
}

/// As [`thinned`], with at most `most` rows that are compared.
pub(crate) fn thinned_to(series: Vec<Series>, memory: Memory, most: usize) -> Vec<Series> {
    let scored = |series: &[Series]| -> usize {
        series.iter().map(|series| series.output.iter().filter(|y| !y.is_nan()).count()).sum()
    };
    let mut series = series;
    let thinning = Thinning::new(scored(&series), most);
    thinning.blank(series.iter_mut().flat_map(|series| &mut series.output));
    let series: Vec<Series> = match memory {
        Memory::TurningPoints => series.iter().map(condensed).collect(),
        Memory::EveryRow => series,
    };
    let rows: usize = series.iter().map(|series| series.samples.len()).sum();
    if rows <= MOST_RUN {
        return series;
    }
    let share = MOST_RUN as f64 / rows as f64;
    let mut begun: Vec<Series> = series.iter().map(|series| beginning(series, share)).collect();
    begun.retain(|series| series.output.iter().any(|y| !y.is_nan()));
    if scored(&begun) < scored(&series) / 20 { series } else { begun }
}

/// Without the rows that neither have an output nor turn.
fn condensed(series: &Series) -> Series {
    let x = |row: usize| series.samples[row].x;
    let last = series.samples.len() - 1;
    let stays = |row: usize| {
        row == 0
            || row == last
            || !series.output[row].is_nan()
            || (x(row) - x(row - 1)) * (x(row + 1) - x(row)) <= 0.0
    };
    let mut short = Series { samples: Vec::new(), output: Vec::new() };
    let mut elapsed = 0.0;
    for row in 0..series.samples.len() {
        elapsed += series.samples[row].step;
        if stays(row) {
            let mut sample = series.samples[row];
            sample.step = elapsed;
            elapsed = 0.0;
            short.samples.push(sample);
            short.output.push(series.output[row]);
        }
    }
    short
}

fn beginning(series: &Series, share: f64) -> Series {
    let rows = (share * series.samples.len() as f64).ceil() as usize;
    Series { samples: series.samples[..rows].to_vec(), output: series.output[..rows].to_vec() }
}

/// Mean and standard deviation.
pub(crate) fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / n;
    (mean, square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Sample;

    fn zigzag(rows: usize) -> Series {
        let x = |row: usize| ((row % 100) as f64 - 50.0).abs();
        let samples = (0..rows).map(|row| Sample { x: x(row), rate: 0.0, step: 1.0 }).collect();
        Series { samples, output: (0..rows).map(|row| row as f64).collect() }
    }

    #[test]
    fn short_records_stay_as_they_are() {
        assert_eq!(thinned(vec![zigzag(4000)], Memory::EveryRow), [zigzag(4000)]);
    }

    #[test]
    fn long_records_keep_their_turning_points_and_their_time() {
        let found = &thinned(vec![zigzag(100_000)], Memory::TurningPoints)[0];
        assert_eq!(found.output.iter().filter(|y| !y.is_nan()).count(), MOST_COMPARED);
        assert!(found.samples.len() <= MOST_COMPARED + 2001);
        let turns = found.samples.iter().filter(|sample| sample.x == 50.0 || sample.x == 0.0).count();
        assert_eq!(turns, 2000);
        let elapsed: f64 = found.samples.iter().map(|sample| sample.step).sum();
        assert_eq!(elapsed, 100_000.0);
        assert_eq!(thinned(vec![zigzag(1_000_000)], Memory::EveryRow)[0].samples.len(), MOST_RUN);
    }
}
