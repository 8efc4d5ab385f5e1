//! A plan on a terminal.

use hysid_document::plain::{WIDTH, indented, rendered, wrapped};
use hysid_document::{Part, capitalised};

use super::{Planned, headline, on_disagreement, segments};

/// All of it within 80 columns.
pub fn text(planned: &Planned<'_>) -> String {
    let plan = planned.plan;
    let lines = |text: &str| wrapped(text, WIDTH).join("\n") + "\n";
    let list = |items: &mut dyn Iterator<Item = String>| -> String {
        items.map(|item| format!("- {}", indented(&item, 2).trim_start())).collect()
    };
    let mut blocks = vec![lines(&headline(plan)), rendered(&[Part::Table(segments(plan))])];
    let reasons = plan.segments.iter().enumerate();
    let reasons: String = reasons
        .map(|(index, segment)| format!("{:>2}  {}", index + 1, indented(&segment.reason, 4).trim_start()))
        .collect();
    blocks.push(format!("why\n{reasons}"));
    if !plan.gaps.is_empty() {
        let gaps = list(&mut plan.gaps.iter().map(|gap| format!("{}: {}", gap.what, gap.statement)));
        blocks.push(format!("what the data do not tell\n{gaps}"));
    }
    blocks.extend(on_disagreement(plan).map(|words| lines(&words)));
    if !plan.sources.is_empty() {
        let sources = list(&mut plan.sources.iter().map(|source| (*source).to_string()));
        blocks.push(format!("after\n{sources}"));
    }
    let step = capitalised("run the drive on a specimen like the first, save the results as NEW.csv, then");
    blocks.push(format!("next\n{}  {}\n", lines(&step), planned.next));
    blocks.join("\n")
}
