//! The page that goes with an export.

use crate::export::{File, Subject, Target};
use crate::program::interpreter::Machine;
use crate::vectors::Action;

/// The text of `README.md`.
pub(crate) fn readme(subject: &Subject<'_>, to: Target, files: &[File]) -> String {
    let facts: String = subject
        .facts()
        .iter()
        .map(|(fact, text)| format!("| {fact} | {} |\n", text.replace('|', "\\|")))
        .collect();
    let list: String = files.iter().map(|file| format!("- `{}`\n", file.path)).collect();
    let (states, constants) = (subject.program().state_len(), subject.program().constants_len());
    let bytes = subject.bytes();
    let use_it = match to {
        Target::C => c(subject.name()),
    };
    format!(
        "# {name}

A model of hysteresis, written by Hysid from a model file.

| | |
|---|---|
{facts}| state | {states} numbers, {} bytes; a model has it twice, committed and trial |
| constants | {constants} numbers, {} bytes |
| operations | {} with real numbers in a step, on average over the test vectors |

{use_it}
## Files

{list}- `manifest.json`: every file with its SHA-256 checksum

`test_vectors.csv` lists actions, their arguments, and what they must give: steps, trials that are reverted or
committed, and a state that is saved and restored.
",
        states * bytes,
        constants * bytes,
        operations(subject),
        name = subject.name(),
    )
}

fn operations(subject: &Subject<'_>) -> u64 {
    let mut machine = Machine::new(subject.program());
    let steps = subject.vectors().iter().filter(|vector| vector.action == Action::Step);
    let mut count = 0;
    for vector in steps {
        machine.step(&vector.arguments);
        count += 1;
    }
    machine.operations() / count.max(1)
}

fn c(name: &str) -> String {
    format!(
        "## Use

```c
#include \"{name}.h\"

{name}_model model;
{name}_reset(&model);
y = {name}_step(&model, x);      /* further arguments: see {name}.h */
```

A solver that iterates calls `{name}_trial` or `{name}_trial_tangent` as often as it needs, each time from the committed
state, and `{name}_commit` once it accepts.

Compile with `-ffp-contract=off` where the machine fuses products and sums: the outputs then equal those of Hysid to
the last bit, if the C library computes `exp` and its like as that of Hysid does. `-ffast-math` is refused.

```
cc -std=c99 -O3 -ffp-contract=off -o {name}_test {name}_test.c {name}.c -lm && ./{name}_test
```

"
    )
}
