//! Errors that fade after the beginning of a record: the memory of the model began in another state than the specimen.

use hysid::data::unit;
use hysid::model::Model;
use hysid_core::significant::Significant;
use hysid_document::count;
use hysid_document::shell::option;
use hysid_document::visible::clipped;

/// How much larger errors at the beginning are than later, and than the usual error of the model. Designed.
const LARGER: f64 = 3.0;

/// The beginning has at least so many rows with an output, and so has the rest.
const FEWEST: usize = 8;

/// Squared errors of a record, for rows 1, 2 to 3, 4 to 7 and so on: its length is not known before its end.
#[derive(Default)]
pub(crate) struct FadingErrors {
    octaves: Vec<(f64, usize)>,
    rows: usize,
}

/// RMS errors of the beginning of a record and of its larger part.
pub(crate) struct Fade {
    beginning: f64,
    later: f64,
}

impl FadingErrors {
    pub fn add(&mut self, measured: &[f64], simulated: &[f64]) {
        let (mut measured, mut simulated) = (measured, simulated);
        while !measured.is_empty() {
            let octave = (self.rows + 1).ilog2() as usize;
            if octave == self.octaves.len() {
                self.octaves.push((0.0, 0));
            }
            let rows = measured.len().min((2 << octave) - 1 - self.rows);
            let errors = measured[..rows].iter().zip(&simulated[..rows]).map(|(y, model)| y - model);
            let (sum, count) = &mut self.octaves[octave];
            for error in errors.filter(|error| !error.is_nan()) {
                *sum += error * error;
                *count += 1;
            }
            self.rows += rows;
            (measured, simulated) = (&measured[rows..], &simulated[rows..]);
        }
    }

    /// The errors, if those of the first quarter of the record or less are far above those of its later half, and above the usual
    /// error of the model. A model that takes a known beginning has none.
    pub fn fade(&self, model: &Model) -> Option<Fade> {
        let usual = model.provenance().validation.as_ref().unwrap_or(&model.provenance().train).rmse;
        self.beside(usual).filter(|_| model.known_beginning().is_none())
    }

    fn beside(&self, usual: f64) -> Option<Fade> {
        let last = self.octaves.len().checked_sub(1)?;
        let rms = |octaves: &[(f64, usize)]| {
            let (sum, count) =
                octaves.iter().fold((0.0, 0), |(sum, count), one| (sum + one.0, count + one.1));
            (count >= FEWEST).then(|| (sum / count as f64).sqrt())
        };
        let beginning = rms(&self.octaves[..last.saturating_sub(2)])?;
        let later = rms(&self.octaves[last.saturating_sub(1)..])?;
        (beginning > LARGER * later && beginning > LARGER * usual).then_some(Fade { beginning, later })
    }
}

impl Fade {
    pub fn words(&self, record: &str, output: &str) -> String {
        let unit = unit::suffix(unit::of_column(output).as_deref());
        format!(
            "record \"{}\": the error falls from {:.3}{unit} at the beginning to {:.3}{unit}: it may begin in the middle of a \
             longer past (to find its state from the first measured rows: {})",
            clipped(record),
            Significant(self.beginning),
            Significant(self.later),
            option("known", "100")
        )
    }
}

/// The first of several like statements, and how many more there are.
pub(crate) fn first_of(mut statements: impl Iterator<Item = String>) -> Option<String> {
    let first = statements.next()?;
    let more = statements.count();
    Some(if more > 0 { format!("{first}; {} alike", count(more, "more record")) } else { first })
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::powf;

    use super::*;

    fn fade(errors: impl Fn(usize) -> f64, rows: usize) -> Option<Fade> {
        let mut found = FadingErrors::default();
        // In blocks, as a table is read.
        for block in (0..rows).collect::<Vec<_>>().chunks(70) {
            let errors: Vec<f64> = block.iter().map(|&row| errors(row)).collect();
            found.add(&errors, &vec![0.0; errors.len()]);
        }
        found.beside(0.1)
    }

    #[test]
    fn only_errors_that_fade_are_told() {
        let found = fade(|row| 0.1 + 2.0 * powf(0.97, row as f64), 1000).unwrap();
        assert!(found.beginning > 0.7 && found.later < 0.11, "{} {}", found.beginning, found.later);
        assert!(fade(|_| 2.0, 1000).is_none(), "the same everywhere");
        assert!(fade(|row| if row < 60 { 0.2 } else { 0.02 }, 1000).is_none(), "small as usual");
        assert!(fade(|row| row as f64, 1000).is_none(), "they grow");
        assert!(fade(|_| 1.0, 20).is_none(), "too few rows");
        assert!(fade(|_| f64::NAN, 1000).is_none());
    }
}
