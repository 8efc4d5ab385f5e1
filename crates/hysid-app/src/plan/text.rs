//! A plan on a terminal.

use hysid::plan::{Plan, SegmentKind};
use hysid_document::plain::{WIDTH, indented, rendered, wrapped};
use hysid_document::{Part, capitalised};

use super::{Planned, headline, segments};

/// All of it within 80 columns.
pub fn text(planned: &Planned<'_>) -> String {
    let plan = planned.plan;
    let lines = |text: &str| wrapped(text, WIDTH).join("\n") + "\n";
    let list = |items: &mut dyn Iterator<Item = String>| -> String {
        items.map(|item| format!("- {}", indented(&item, 2).trim_start())).collect()
    };
    let mut blocks = vec![lines(&headline(plan)), rendered(&[Part::Table(segments(plan))])];
    blocks.push(format!("why\n{}", list(&mut purposes(plan).into_iter())));
    if !plan.gaps.is_empty() {
        let gaps = list(&mut plan.gaps.iter().map(|gap| format!("{}: {}", gap.what, gap.statement)));
        blocks.push(format!("what the data do not cover\n{gaps}"));
    }
    if !plan.sources.is_empty() {
        let sources = list(&mut plan.sources.iter().map(|source| (*source).to_string()));
        blocks.push(format!("sources\n{sources}"));
    }
    let step = capitalised("run the drive on a specimen like the first, save the results as NEW.csv, then");
    blocks.push(format!("next\n{}  {}\n", lines(&step), planned.next));
    blocks.join("\n")
}

/// Purpose of each kind of segment, in the order of the drive.
fn purposes(plan: &Plan) -> Vec<String> {
    let mut kinds: Vec<SegmentKind> = Vec::new();
    for segment in &plan.segments {
        if !kinds.contains(&segment.kind) {
            kinds.push(segment.kind);
        }
    }
    kinds.into_iter().map(|kind| format!("{kind}: {}", kind.purpose())).collect()
}
