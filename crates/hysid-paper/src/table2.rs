//! The paper's table of which network can represent which property, measured: for each property a specimen that
//! has just that, every network trained on it, and its error on unseen data.

mod specimens;

use hysid::Result;
use hysid::data::record::Record;
use hysid::model::Model;
use hysid::options::network::Regularisation;
use hysid_core::network::Family;
use hysid_document::{Cell, Part, Table, number};

use crate::chapter::{Chapter, ChapterTarget, TargetSource, TargetVerdict};
use crate::conditions::{Observer, Settings};
use crate::fitting::{self, SEEDS, TrainingChoice};
use crate::spread::Spread;
use specimens::{SPECIMENS, SpecimenProperty};

/// Largest error on unseen data, in percent, of a network that represents a property. Designed.
const LEARNT: f64 = 3.0;

/// Random starts of each seed: these specimens are small.
const STARTS: usize = 4;

/// Iterations of each start, and of a quick run.
const ITERATIONS: (usize, usize) = (100, 25);

/// These laws are exact, without noise.
const PENALTIES: Regularisation = Regularisation { ridge: 1e-8, decay: 1e-9 };

/// A specimen, and the networks trained on it in the order of [`Family::ALL`].
struct SpecimenRow {
    property: &'static SpecimenProperty,
    /// Those of the first seed.
    models: Vec<Model>,
    /// Errors on unseen data in percent of the output's standard deviation.
    unseen: Vec<Spread>,
}

/// Runs the experiment.
pub fn chapter(settings: Settings, observer: &dyn Observer) -> Result<Chapter> {
    let rows = SPECIMENS.iter().map(|property| row(property, settings, observer));
    let rows: Vec<SpecimenRow> = rows.collect::<Result<_>>()?;
    let mixing = rows.iter().find(|row| row.property.is_mixing).expect("one of the specimens mixes");
    let incongruency = incongruency_table(mixing)?;
    let differences: Vec<String> = rows.iter().flat_map(SpecimenRow::differences).collect();
    Ok(Chapter {
        name: "table2".into(),
        title: "which network can learn which property".into(),
        verdict: verdict(&rows, &differences),
        parts: vec![
            Part::Table(verdicts(&rows)),
            Part::Table(errors(&rows)),
            Part::note(format!(
                "A network has learnt a property if the median of its errors on unseen records, from {SEEDS} seeds, is at most {LEARNT} % of std (designed). All have {} stops, those with a tanh layer {} tanh neurons. The input is the same for all specimens: two tones at three speeds to train on, other tones at two other speeds unseen. The paper's entries are as its abstract and conclusion have them; in the copy we have, one of its two tables is a misprint of the other.",
                fitting::ARCHITECTURE.stops,
                fitting::ARCHITECTURE.hidden
            )),
            Part::heading("Where our verdict differs from the paper"),
            Part::paragraph(if differences.is_empty() { "Nowhere.".into() } else { differences.join(" ") }),
            Part::paragraph(WHY),
            Part::paragraph(COUNT),
            Part::Table(incongruency),
            Part::heading("The specimens"),
            Part::Table(specimens_table()),
        ],
        targets: targets(&rows),
        files: Vec::new(),
    })
}

fn targets(rows: &[SpecimenRow]) -> Vec<ChapterTarget> {
    let target = |figure: &str, wanted: String, one: String| ChapterTarget {
        specimen: "all specimens".into(),
        figure: figure.into(),
        source: TargetSource::Paper,
        verdict: if one == wanted { TargetVerdict::Met } else { TargetVerdict::Missed },
        wanted,
        one,
        several: None,
    };
    let all = rows.iter().map(|row| row.property.paper.len()).sum::<usize>();
    let differing = rows.iter().flat_map(SpecimenRow::differences).count();
    let xpnn = place_of_xpnn();
    let learnt = rows.iter().filter(|row| row.has_learnt(xpnn)).count();
    let sizes = fitting::ARCHITECTURE;
    // Those with an output weight each: the tanh neurons and the constant.
    let output_weights = sizes.hidden + 1;
    let free = rows.first().map_or(0, |row| row.models[xpnn].parameters() - output_weights);
    vec![
        target(
            "properties that the XPNN learns",
            format!("{0} of {0}", rows.len()),
            format!("{learnt} of {}", rows.len()),
        ),
        target(
            "entries of the table that hold",
            format!("{all} of {all}"),
            format!("{} of {all}", all - differing),
        ),
        target(
            "free parameters of the XPNN, n_stop n_tanh + 2 (n_stop + n_tanh + 1)",
            (sizes.stops * sizes.hidden + 2 * (sizes.stops + sizes.hidden + 1)).to_string(),
            free.to_string(),
        ),
    ]
}

fn place_of_xpnn() -> usize {
    Family::ALL.iter().position(|&family| family == Family::Xpnn).unwrap_or_default()
}

/// Explains which parameters the paper's count leaves out.
const COUNT: &str = "The paper's count of free parameters is that of the weights between the layers, without the output weights, which follow by least squares. It leaves out the capacity β of each stop, which is trained as well.";

const WHY: &str = "On a minor loop the stops that slide run the same cycle whatever came before; those that do not slide differ by a constant that history has set. A linear readout adds that constant to the output, which shifts the loop and leaves its shape: such models are congruent. A tanh neuron over several stops moves with that constant along its own curve, so the loop changes its shape: the Preisach neural network wipes out, but it is not congruent, and no deterioration is needed for that. Deterioration is needed where loops do not close.";

fn row(
    property: &'static SpecimenProperty,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<SpecimenRow> {
    let (train, unseen) = (specimens::training(property)?, specimens::unseen(property)?);
    let mut row = SpecimenRow { property, models: Vec::new(), unseen: Vec::new() };
    for family in Family::ALL {
        let iterations = if settings.quick { ITERATIONS.1 } else { ITERATIONS.0 };
        let choice = TrainingChoice {
            has_rate: family.uses_rate(),
            deteriorates: family.deteriorates(),
            penalties: PENALTIES,
            iterations,
        };
        let began = observer.clock();
        let mut percents = Vec::new();
        for seed in fitting::seeds(settings) {
            let of_start = |start: u64| fitting::network(family, choice, seed, start);
            let model = fitting::networks(&train, of_start, STARTS, observer)?.swap_remove(0);
            percents.push(model.evaluate(&unseen)?.nrmse_std_percent.expect("the specimen's output varies"));
            if percents.len() == 1 {
                row.models.push(model);
            }
        }
        let spread = Spread::of(percents).expect("there are seeds");
        observer.say(&format!(
            "  table2, {}: {} {} % of std unseen, {:.1} s",
            property.name,
            family.name(),
            spread.shown(),
            (observer.clock() - began).as_secs_f64()
        ));
        row.unseen.push(spread);
    }
    Ok(row)
}

impl SpecimenRow {
    fn has_learnt(&self, network: usize) -> bool {
        self.unseen[network].median <= LEARNT
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
                    number(self.unseen[network].median, 2)
                )
            })
    }
}

fn learnt(has_learnt: bool) -> &'static str {
    if has_learnt { "learns it" } else { "does not" }
}

fn verdict(rows: &[SpecimenRow], differences: &[String]) -> String {
    let all = rows.iter().map(|row| row.property.paper.len()).sum::<usize>();
    let learnt = rows.iter().filter(|row| row.has_learnt(place_of_xpnn())).count();
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

fn verdicts(rows: &[SpecimenRow]) -> Table {
    let cells = |row: &SpecimenRow| {
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
    Table::new(columns())
        .headed(format!("{HEADING}: can the network learn it? xpnn+ is ours, the paper has no entry for it"))
        .with_rows(rows.iter().map(cells))
}

fn errors(rows: &[SpecimenRow]) -> Table {
    let cells = |row: &SpecimenRow| {
        let errors = row.unseen.iter().map(|&error| Cell::from(error.shown()));
        std::iter::once(row.property.name.into()).chain(errors).collect()
    };
    Table::new(columns())
        .headed(format!(
            "{HEADING}: error on unseen data, NRMSE in % of std, median and range of {SEEDS} seeds"
        ))
        .with_rows(rows.iter().map(cells))
}

/// Incongruency of minor loops, of the specimen that mixes and of the networks trained on it.
fn incongruency_table(row: &SpecimenRow) -> Result<Table> {
    let record = specimens::two_histories()?;
    let mut table = Table::new(["model", "difference, %"]).headed(format!(
        "{HEADING}: shape of a minor loop after two histories, largest difference in % of its height, {}",
        row.property.name
    ));
    table.push(["the specimen".into(), specimens::incongruency(&row.property.outputs(&record)).into()]);
    for (family, model) in Family::ALL.iter().zip(&row.models) {
        let outputs = model.simulate(&record)?;
        table.push([family.name().into(), specimens::incongruency(&outputs).into()]);
    }
    Ok(table)
}

fn specimens_table() -> Table {
    let row = |property: &SpecimenProperty| vec![property.name.into(), property.law.into()];
    Table::new(["property", "law"])
        .headed(format!(
            "{HEADING}: their laws, all designed; ε_r is the stop of threshold r, DS with capacity β"
        ))
        .with_rows(SPECIMENS.iter().map(row))
}

impl SpecimenProperty {
    fn outputs(&self, record: &Record) -> Vec<f64> {
        specimens::outputs(self, record.time().unwrap_or_default(), &record.inputs()[0])
    }
}
