//! Diagnosis of measured data.

use hysid::diagnosis::{Diagnosis, DiagnosisOptions};
use hysid_core::significant::Significant;
use hysid_document::{Face, Page, Part, Result, count, object};
use hysid_records::Data;

use super::cards::{EXPLANATION, cards, verdicts};
use super::overview::Overview;
use super::{counsel, findings, loops, paragraph};
use crate::quantities::Quantities;
use hysid_document::visible::clipped;

/// A diagnosis of measured data, and the text around it.
pub struct DataDiagnosis<'a> {
    data: &'a Data,
    diagnosis: Diagnosis,
    quantities: Quantities,
    understood: &'a [(String, String)],
    fit: String,
    face: Face,
}

impl<'a> DataDiagnosis<'a> {
    /// Diagnoses data. `understood` is what was understood of them, `fit` the command that fits a model to them.
    pub fn of(
        data: &'a Data,
        options: &DiagnosisOptions,
        understood: &'a [(String, String)],
        fit: String,
        face: Face,
    ) -> Result<Self> {
        let diagnosis = Diagnosis::of(&data.set, options).map_err(|error| data.explain(error))?;
        let quantities = Quantities::of(data.set.names());
        Ok(Self { data, diagnosis, quantities, understood, fit, face })
    }

    /// All of it within 80 columns.
    pub fn text(&self) -> String {
        let parts = [
            findings::text(&self.diagnosis.properties),
            loops::text(&self.diagnosis.cycles, &self.quantities) + &paragraph(&self.noise()),
            counsel::doctor_text(&self.diagnosis.doctor, self.face),
            counsel::advice_text(&self.diagnosis.advice, &self.fit),
        ];
        parts.join("\n")
    }

    /// How often the input turns and how much noise was found, in words.
    fn noise(&self) -> String {
        let names = self.data.set.names();
        let of = |column: &str, deviation: f64, (low, high): (f64, f64)| {
            let unit = hysid::data::unit::suffix(hysid::data::unit::of_column(column).as_deref());
            let percent = 100.0 * deviation / (high - low);
            format!(
                "{} {:.2}{} ({} % of its range)",
                clipped(column),
                Significant(deviation),
                clipped(&unit),
                findings::shown(percent)
            )
        };
        format!(
            "{}; standard deviation of the noise: {}, {}",
            count(self.diagnosis.turning_points, "turning point"),
            of(&names.inputs[0], self.diagnosis.input_noise, self.data.set.input_range(0)),
            of(&names.output, self.diagnosis.output_noise, self.data.set.output_range()),
        )
    }

    pub fn json(&self) -> Result<String> {
        let printed = object! {
            input: &self.quantities.input,
            output: &self.quantities.output,
            samples: self.data.set.scored(),
            records: self.data.set.records().len(),
            #[serde(flatten)]
            diagnosis: &self.diagnosis,
        };
        Ok(hysid_document::json(&printed)?)
    }

    /// The page: verdicts at a glance, the data, each property with its picture, and the loops in numbers.
    pub fn page(&self) -> Page {
        let Self { data, diagnosis, quantities, understood, .. } = self;
        let several = data.set.records().len() > 1;
        let found = &diagnosis.properties;
        let overview = Overview::new(&data.set, diagnosis, quantities);
        let cards = cards(found, quantities, |finding| findings::place(&finding.evidence, several));
        let mut parts = counsel::verdict(&diagnosis.advice).to_vec();
        parts.extend([
            Part::section("Verdicts", [verdicts(found)]),
            counsel::doctor_section(&diagnosis.doctor, self.face),
            overview.section(),
            Part::section("Property by property", [Part::Cards(cards), Part::note(EXPLANATION)]),
        ]);
        parts.extend(loops::cycles_section(&diagnosis.cycles, quantities, several));
        let understood = [Part::Definitions(understood.to_vec()), Part::paragraph(self.noise())];
        parts.push(Part::section("How the data were read", understood));
        Page { title: format!("Diagnosis: {}", data.source.tables[0].file), parts }
    }
}
