//! The page of a diagnosis: verdicts at a glance, the data, and each property with its picture.

use super::DataDiagnosis;
use super::cards::{cards, verdicts};
use super::loops::cycles_section;
use super::overview::Overview;
use crate::page::{definitions, note, paragraph, section, whole};

/// The page of data.
pub fn of_data(told: &DataDiagnosis) -> String {
    let DataDiagnosis { data, diagnosis, quantities, understood, smallest_reversal } = told;
    let several = data.set.records().len() > 1;
    let findings = &diagnosis.properties;
    let overview = Overview::new(&data.set, diagnosis, quantities, *smallest_reversal);
    let content = [
        section("Verdicts", &verdicts(findings)),
        overview.section(),
        section("Property by property", &(cards(findings, quantities, several) + &note(EXPLANATION))),
        cycles_section(&diagnosis.cycles, quantities, several),
        section("What was understood of the data", &(definitions(understood) + &paragraph(&told.noise()))),
    ];
    whole(&format!("Diagnosis: {}", data.source.tables[0].file), &content.concat())
}

const EXPLANATION: &str = "The index measures how far what should coincide does not, as a share; beyond the threshold the verdict turns. \
     A threshold is the difference that matters in practice, or what noise may give by chance in that many comparisons, whichever is larger.";
