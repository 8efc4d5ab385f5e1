//! The paper's table of which network can learn which property, measured: for each property a specimen that
//! has just that, every network trained on it, and its error on unseen data.

mod specimens;

use anyhow::{Context, Result};
use hysid::data::record::Record;
use hysid::model::Model;
use hysid::network::Family;
use hysid::options::Request;
use hysid::options::network::FitOptions;

use super::chapter::{Cell, Chapter, Part, Table};
use super::{Settings, fitting};
use crate::page::number;
use specimens::{Property, SPECIMENS};

/// A network has learnt a property if its error on unseen data of the specimen, in percent of the output's
/// standard deviation, is at most this. Designed.
const LEARNT: f64 = 3.0;

/// Shares of the effort of an example: these specimens are small.
const STARTS: usize = 4;

/// Iterations of each start.
const EPOCHS: usize = 100;

/// A specimen, and the networks trained on it in the order of [`Family::ALL`].
struct Row {
    property: &'static Property,
    models: Vec<Model>,
    /// Errors on unseen data in percent of the output's standard deviation.
    unseen: Vec<f64>,
}

/// Runs the experiment; `None` if interrupted.
pub fn chapter(settings: Settings) -> Result<Option<Chapter>> {
    let mut rows = Vec::new();
    for property in &SPECIMENS {
        let Some(row) = row(property, settings)? else { return Ok(None) };
        rows.push(row);
    }
    let mixing = rows.iter().find(|row| row.property.is_mixing).context("one of the specimens mixes")?;
    let incongruency = incongruency_table(mixing)?;
    let differences: Vec<String> = rows.iter().flat_map(Row::differences).collect();
    Ok(Some(Chapter {
        name: "table2".into(),
        title: "which network can learn which property".into(),
        verdict: verdict(&rows, &differences),
        parts: vec![
            Part::Table(verdicts(&rows)),
            Part::Table(errors(&rows)),
            Part::Note(format!(
                "A network has learnt a property if its error on unseen records is at most {LEARNT} % of std (designed). All have {} stops, those with a tanh layer {} tanh neurons. The input is the same for all specimens: two tones at three speeds to train on, other tones at two other speeds unseen. The paper's entries are as its abstract and conclusion have them; in the copy we have, one of its two tables is a misprint of the other.",
                fitting::ARCHITECTURE.stops,
                fitting::ARCHITECTURE.hidden
            )),
            Part::Heading("Where our verdict differs from the paper's".into()),
            Part::Paragraph(match differences.is_empty() {
                true => "Nowhere.".into(),
                false => differences.join(" "),
            }),
            Part::Paragraph(WHY.into()),
            Part::Table(incongruency),
            Part::Heading("The specimens".into()),
            Part::Table(specimens_table()),
        ],
        targets: Vec::new(),
        files: Vec::new(),
    }))
}

/// Why a Preisach network is not congruent.
const WHY: &str = "On a minor loop the stops that slide run the same cycle whatever came before; those that do not slide differ by a constant that history has set. A linear readout adds that constant to the output, which shifts the loop and leaves its shape: such models are congruent. A tanh neuron over several stops moves with that constant along its own curve, so the loop changes its shape: the Preisach neural network wipes out, but it is not congruent, and no deterioration is needed for that. Deterioration is needed where loops do not close.";

fn row(property: &'static Property, settings: Settings) -> Result<Option<Row>> {
    let (train, unseen) = (specimens::training(property)?, specimens::unseen(property)?);
    let mut row = Row { property, models: Vec::new(), unseen: Vec::new() };
    for family in Family::ALL {
        let options = fitting::network(family, &train, settings);
        let (starts, epochs) = (options.starts.min(STARTS), options.epochs.min(EPOCHS));
        let request = Request::Network(FitOptions { starts, epochs, ..options });
        let Some(fit) = fitting::fit(&format!("table2, {}", property.name), &train, &request)? else {
            return Ok(None);
        };
        let errors = fit.model.evaluate(&unseen)?;
        row.unseen.push(errors.nrmse_std_percent.context("the specimen's output varies")?);
        row.models.push(fit.model);
    }
    Ok(Some(row))
}

impl Row {
    fn has_learnt(&self, network: usize) -> bool {
        self.unseen[network] <= LEARNT
    }

    /// Sentences on networks of the paper that do otherwise here than there.
    fn differences(&self) -> impl Iterator<Item = String> {
        self.property
            .paper
            .iter()
            .enumerate()
            .filter(|(network, paper)| self.has_learnt(*network) != **paper)
            .map(|(network, paper)| {
                format!(
                    "{}, {}: {} by the paper, {} here ({} % of std).",
                    Family::ALL[network].name(),
                    self.property.name,
                    learnt(*paper),
                    learnt(!*paper),
                    number(self.unseen[network], 2)
                )
            })
    }
}

fn learnt(has_learnt: bool) -> &'static str {
    if has_learnt { "learns it" } else { "does not" }
}

fn verdict(rows: &[Row], differences: &[String]) -> String {
    let all = rows.iter().map(|row| row.property.paper.len()).sum::<usize>();
    let xpnn = Family::ALL.iter().position(|&family| family == Family::Xpnn).unwrap_or_default();
    let learnt = rows.iter().filter(|row| row.has_learnt(xpnn)).count();
    format!(
        "The XPNN learns {learnt} of the {} properties; of the paper's {all} entries {} hold here and {} do not.",
        rows.len(),
        all - differences.len(),
        differences.len()
    )
}

const HEADING: &str = "Synthetic specimens with one property each; nothing measured is needed";

fn columns() -> Vec<String> {
    let names = Family::ALL.iter().map(|family| family.name().to_string());
    std::iter::once("property".to_string()).chain(names).collect()
}

fn verdicts(rows: &[Row]) -> Table {
    let cells = |row: &Row| {
        let cell = |network: usize| -> Cell {
            let here = if row.has_learnt(network) { "yes" } else { "no" };
            match row.property.paper.get(network) {
                Some(paper) if *paper == row.has_learnt(network) => here.into(),
                Some(_) => format!("{here} (paper: {})", if here == "yes" { "no" } else { "yes" }).into(),
                None => here.into(),
            }
        };
        std::iter::once(row.property.name.into()).chain((0..Family::ALL.len()).map(cell)).collect()
    };
    Table {
        heading: format!("{HEADING}: can the network learn it? xpnn+ is ours, the paper has no entry for it"),
        columns: columns(),
        rows: rows.iter().map(cells).collect(),
    }
}

fn errors(rows: &[Row]) -> Table {
    let cells = |row: &Row| {
        let errors = row.unseen.iter().map(|&error| Cell::from(error));
        std::iter::once(row.property.name.into()).chain(errors).collect()
    };
    Table {
        heading: format!("{HEADING}: error on unseen data, NRMSE in % of std"),
        columns: columns(),
        rows: rows.iter().map(cells).collect(),
    }
}

/// How far minor loops between the same two inputs are from congruent, for the specimen that mixes and the
/// networks trained on it.
fn incongruency_table(row: &Row) -> Result<Table> {
    let record = specimens::two_histories()?;
    let mut rows =
        vec![vec!["the specimen".into(), specimens::incongruency(&row.property.outputs(&record)).into()]];
    for (family, model) in Family::ALL.iter().zip(&row.models) {
        let outputs = model.simulate(&record)?;
        rows.push(vec![family.name().into(), specimens::incongruency(&outputs).into()]);
    }
    Ok(Table {
        heading: format!(
            "{HEADING}: shape of a minor loop after two histories, largest difference in % of its height, {}",
            row.property.name
        ),
        columns: vec!["model".into(), "difference, %".into()],
        rows,
    })
}

fn specimens_table() -> Table {
    let row = |property: &Property| vec![property.name.into(), property.law.into()];
    Table {
        heading: format!(
            "{HEADING}: their laws, all designed; ε_r is the stop of threshold r, DS with capacity β"
        ),
        columns: vec!["property".into(), "law".into()],
        rows: SPECIMENS.iter().map(row).collect(),
    }
}

impl Property {
    /// The specimen's outputs along a record.
    fn outputs(&self, record: &Record) -> Vec<f64> {
        specimens::outputs(self, record.time().unwrap_or_default(), &record.inputs()[0])
    }
}
