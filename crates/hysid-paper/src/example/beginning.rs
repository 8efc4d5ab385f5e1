//! The beginning of a training record that is not that of a virgin specimen.

use hysid::Result;
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::DataIssueKind;

/// The training data as all models are fitted to them, and the rows at their beginning whose outputs are blank.
///
/// If the diagnosis says that a single record does not begin as a virgin specimen does, it advises to blank the output
/// of the first cycle. A virgin curve outside all later loops occurs once, and a model that is fitted to it explains it
/// by something that returns.
pub fn trained_on(data: Dataset) -> Result<(Dataset, usize)> {
    let [record] = data.records() else { return Ok((data, 0)) };
    let is_not_virgin =
        hysid::diagnose(&data)?.doctor.iter().any(|issue| issue.kind == DataIssueKind::NotVirgin);
    if !is_not_virgin {
        return Ok((data, 0));
    }
    let end = first_visit_of_both_ends(record);
    let record = record.clone().scored_where(|row| row >= end);
    Ok((Dataset::new(data.names().clone(), vec![record])?, end))
}

/// The row from which on both ends of the range have been visited, so that the beginning is wiped out.
fn first_visit_of_both_ends(record: &Record) -> usize {
    let x = &record.inputs()[0];
    let first = |is_before: fn(f64, f64) -> bool| {
        let rows = 0..x.len();
        rows.fold(0, |best, row| if is_before(x[row], x[best]) { row } else { best })
    };
    first(|a, b| a < b).max(first(|a, b| a > b))
}

/// Explains which rows were blanked, and why.
pub fn words(rows: usize) -> String {
    format!(
        "The outputs of the first {rows} rows are blank for all models but the last: hysid diagnose warns that the \
         record does not begin as a virgin specimen does and advises that. By then the input has visited both ends of \
         its range. The virgin curve lies outside all later loops and occurs once; an XPNN that is fitted to it, as the \
         last one, takes it for something that returns."
    )
}

#[cfg(test)]
mod tests {
    use hysid::specimens::Specimen;

    use super::*;

    #[test]
    fn only_the_rod_under_its_bias_does_not_begin_virgin() {
        for (name, rows) in [("terfenol-rod", 194), ("terfenol-actuator", 0), ("two-wire-actuator", 0)] {
            let whole = Specimen::named(name).unwrap().train();
            let (data, blanked) = trained_on(whole.clone()).unwrap();
            assert_eq!(blanked, rows, "{name}");
            assert_eq!(data.scored() + blanked, whole.scored(), "{name}");
        }
    }
}
