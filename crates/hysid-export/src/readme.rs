//! The page that goes with an export.

use crate::program::interpreter::Machine;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::Target;
use crate::text::in_markdown;
use crate::vectors::Action;

pub(crate) fn readme(subject: &ExportSubject<'_>, to: Target, files: &[ExportFile]) -> String {
    let facts: String = subject
        .facts()
        .iter()
        .map(|(fact, text)| format!("| {} | {} |\n", in_markdown(fact), in_markdown(text)))
        .collect();
    let list: String = files.iter().map(|file| format!("- `{}`\n", file.path)).collect();
    let (states, constants) = (subject.program().state_len(), subject.program().constants_len());
    let bytes = subject.bytes();
    let mut vectors = Vec::new();
    if files.iter().any(|file| file.path == "test_vectors.csv") {
        vectors.push(
            "`test_vectors.csv` lists actions, their arguments, and what they must give: steps, trials that are reverted or
committed, and a state that is saved and restored.",
        );
    }
    if subject.inverse().is_some() {
        vectors.push(
            "`inverse_vectors.csv` lists actions on the inverse, their arguments, and the input, the output and the reach that
they must give: steps, and a state that is saved and restored.",
        );
    }
    let usage = (to.back_end().usage)(subject);
    let band = subject.half_width().map_or(String::new(), |place| {
        format!(
            "\nHalf the width of the prediction band at the last row is number {} of the state. C and Python have a \
             function `half_width` for it.\n",
            place + 1
        )
    });
    format!(
        "# {name}

A model of hysteresis, written by Hysid from a model file.

| | |
|---|---|
{facts}| state | {states} numbers, {} bytes; a model has it twice, committed and trial |
| constants | {constants} numbers, {} bytes |
| operations | {} with real numbers in a step, on average over the test vectors |

## Use

{usage}{band}
## Files

{list}- `manifest.json`: every file with its SHA-256 checksum

{vectors}
",
        states * bytes,
        constants * bytes,
        operations(subject),
        name = subject.name(),
        vectors = vectors.join("\n\n"),
    )
}

fn operations(subject: &ExportSubject<'_>) -> u64 {
    let mut machine = Machine::new(subject.program());
    let steps = subject.vectors().iter().filter(|vector| vector.action == Action::Step);
    let mut count = 0;
    for vector in steps {
        machine.step(&vector.arguments);
        count += 1;
    }
    machine.operations() / count.max(1)
}
