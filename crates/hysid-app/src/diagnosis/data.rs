//! Diagnosis of measured data.

use hysid::diagnosis::{Diagnosis, DiagnosisOptions};
use hysid_document::{Face, Page, Part, Result, object};
use hysid_records::Data;

use super::cards::{EXPLANATION, cards, verdicts};
use super::overview::Overview;
use super::text::{noise, text};
use super::{counsel, findings, loops};
use crate::quantities::Quantities;

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
        text(&self.data.set, &self.diagnosis, &self.fit, self.face)
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
        let understood =
            [Part::Definitions(understood.to_vec()), Part::paragraph(noise(&data.set, diagnosis))];
        parts.push(Part::section("How the data were read", understood));
        Page { title: format!("Diagnosis: {}", data.source.files()), parts }
    }
}
