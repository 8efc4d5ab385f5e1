//! A diagnosis of measured data as text.

use hysid::data::record::Dataset;
use hysid::data::unit;
use hysid::diagnosis::Diagnosis;
use hysid_core::significant::Significant;
use hysid_document::visible::clipped;
use hysid_document::{Face, count};

use super::{counsel, findings, loops, paragraph};
use crate::quantities::Quantities;

/// All of it within 80 columns; `fit` is what to type to fit a model to the data.
pub fn text(data: &Dataset, diagnosis: &Diagnosis, fit: &str, face: Face) -> String {
    let quantities = Quantities::of(data.names());
    let parts = [
        findings::text(&diagnosis.properties),
        loops::text(&diagnosis.cycles, &quantities) + &paragraph(&noise(data, diagnosis)),
        counsel::doctor_text(&diagnosis.doctor, face),
        counsel::advice_text(&diagnosis.advice, fit),
    ];
    parts.join("\n")
}

/// Noise below this share of the range, in percent, is that of rounded numbers.
const ROUNDING: f64 = 1e-6;

/// How often the input turns and how much noise was found, in words.
pub(super) fn noise(data: &Dataset, diagnosis: &Diagnosis) -> String {
    let of = |column: &str, deviation: f64, (low, high): (f64, f64)| {
        let unit = unit::suffix(unit::of_column(column).as_deref());
        let percent = 100.0 * deviation / (high - low);
        if percent < ROUNDING {
            return format!("{} none", clipped(column));
        }
        format!(
            "{} {:.2}{} ({} % of its range)",
            clipped(column),
            Significant(deviation),
            clipped(&unit),
            findings::shown(percent)
        )
    };
    let names = data.names();
    format!(
        "{}; standard deviation of the noise: {}, {}",
        count(diagnosis.turning_points, "turning point"),
        of(&names.inputs[0], diagnosis.input_noise, data.input_range(0)),
        of(&names.output, diagnosis.output_noise, data.output_range()),
    )
}
