//! States of exported models that came from elsewhere: damaged, forged, or of another model.

use std::fs;
use std::path::Path;
use std::process::Command;

use hysid::Model;
use hysid_export::{InverseOptions, Options, Target};

use super::case::{Case, MODELS, NAME, write, written};
use super::tools::{at_length, gcc, succeeds};

/// Models whose states have counters, and those whose loops depend on the state.
const WITH_COUNTERS: [&str; 7] =
    ["masing", "preisach of", "neuro-madelung", "peak-oriented", "menegotto-pinto", "jiles-atherton", "auto"];

/// Those, or all kinds where the laboratory tests at length.
fn models() -> impl Iterator<Item = &'static (String, Model)> {
    let all = at_length();
    MODELS.iter().filter(move |(label, _)| all || WITH_COUNTERS.iter().any(|name| label.starts_with(name)))
}

fn run(folder: &Path, sources: &[&str]) {
    let Some(compiler) = gcc() else { return };
    let flags = ["-std=c99", "-O1", "-g", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"];
    let command = &mut Command::new(compiler);
    succeeds(command.current_dir(folder).args(flags).args(sources).args(["-lm", "-o", "states"]));
    succeeds(Command::new(folder.join("states")).current_dir(folder));
}

/// A program that restores a saved state with each of its bytes changed, which must be refused, and then makes steps from
/// states that have any numbers.
fn program(arguments: usize) -> String {
    let given = ", 0.5".repeat(arguments.saturating_sub(1));
    format!(
        "#include <math.h>
#include <stdio.h>
#include <string.h>
#include \"actuator.h\"
int main(void)
{{
    static const double wild[] = {{ -5, -1, 0.5, 2.5, 127, 128, 1e6, 1e300, -1e300, INFINITY, -INFINITY, NAN }};
    static actuator_model model, before;
    static unsigned char saved[ACTUATOR_STATE_BYTES];
    size_t i, k;
    actuator_reset(&model);
    actuator_step(&model, 1.5{given});
    actuator_step(&model, -0.5{given});
    actuator_save(&model, saved);
    before = model;
    for (i = 0; i < ACTUATOR_STATE_BYTES; i += 3) {{
        saved[i] ^= 0x40;
        if (actuator_restore(&model, saved) || memcmp(&model, &before, sizeof model) != 0)
            return printf(\"byte %d was not noticed\\n\", (int)i), 1;
        saved[i] ^= 0x40;
    }}
    if (!actuator_restore(&model, saved))
        return puts(\"a good state was refused\"), 1;
    for (i = 0; i < sizeof(actuator_state) / sizeof(double); i++)
        for (k = 0; k < sizeof wild / sizeof *wild; k++) {{
            model = before;
            memcpy((unsigned char *)&model.committed + i * sizeof(double), &wild[k], sizeof(double));
            actuator_step(&model, 0.1{given});
            actuator_step(&model, -0.3{given});
            actuator_step(&model, 40.0{given});
            if (i > 200)
                break;
        }}
    return 0;
}}
"
    )
}

#[test]
fn damaged_states_are_refused_and_forged_ones_write_nowhere_else() {
    let mut count = 0;
    for (label, model) in models() {
        let folder = written(model, Target::C, &Options::named(NAME));
        fs::write(folder.path().join("main.c"), program(Case::of(model, 1).arguments.len())).unwrap();
        run(folder.path(), &["actuator.c", "main.c"]);
        println!("{label}");
        count += 1;
    }
    assert!(count >= WITH_COUNTERS.len(), "{count} models");
}

#[test]
fn a_state_of_another_model_is_refused_and_an_inverse_keeps_its_limits() {
    let [first, second] = [0, 1].map(|place| models().nth(place).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let inverse = InverseOptions { limits: Some((-1.0, 1.0)), slew: Some(0.1) };
    for (name, model) in [("one", &first.1), ("two", &second.1)] {
        let options = Options { inverse: Some(inverse), ..Options::named(name) };
        write(model, Target::C, &options, folder.path());
    }
    let main = "#include <stdio.h>
#include <string.h>
#include \"one_inverse.h\"
#include \"two_inverse.h\"
int main(void)
{
    static one_inverse one;
    static two_inverse two;
    static unsigned char bytes[ONE_INVERSE_STATE_BYTES + TWO_INVERSE_STATE_BYTES];
    double input, output;
    size_t i;
    one_inverse_reset(&one);
    two_inverse_reset(&two);
    one_inverse_step(&one, 0.2, 1.0, &input, &output);
    one_inverse_save(&one, bytes);
    if (!one_inverse_restore(&one, bytes))
        return puts(\"a good state was refused\"), 1;
    if (two_inverse_restore(&two, bytes))
        return puts(\"a state of another model was taken\"), 1;
    for (i = 0; i < ONE_INVERSE_STATE_BYTES; i += 3) {
        bytes[i] ^= 0x40;
        if (one_inverse_restore(&one, bytes))
            return printf(\"byte %d was not noticed\\n\", (int)i), 1;
        bytes[i] ^= 0x40;
    }
    fwrite(bytes, 1, ONE_INVERSE_STATE_BYTES, fopen(\"state.bin\", \"wb\"));
    one.last_input = 1e9;
    one_inverse_step(&one, 0.2, 1.0, &input, &output);
    if (!(input >= -1.0 && input <= 1.0))
        return printf(\"the input is %g\\n\", input), 1;
    return 0;
}
";
    fs::write(folder.path().join("main.c"), main).unwrap();
    run(folder.path(), &["one.c", "one_inverse.c", "two.c", "two_inverse.c", "main.c"]);

    // Inverses of the same model under the same name, with other limits or another slew.
    let main = "#include <stdio.h>
#include \"one_inverse.h\"
int main(void)
{
    static one_inverse one;
    static unsigned char bytes[ONE_INVERSE_STATE_BYTES];
    return fread(bytes, 1, sizeof bytes, fopen(\"state.bin\", \"rb\")) != sizeof bytes
        || one_inverse_restore(&one, bytes) != IS_SAME;
}
";
    let others = [
        (inverse, 1),
        (InverseOptions { limits: Some((-1.0, 3.0)), ..inverse }, 0),
        (InverseOptions { slew: Some(0.2), ..inverse }, 0),
    ];
    for (other, is_same) in others {
        let options = Options { inverse: Some(other), ..Options::named("one") };
        let sibling = written(&first.1, Target::C, &options);
        fs::write(sibling.path().join("main.c"), format!("#define IS_SAME {is_same}\n{main}")).unwrap();
        fs::copy(folder.path().join("state.bin"), sibling.path().join("state.bin")).unwrap();
        run(sibling.path(), &["one.c", "one_inverse.c", "main.c"]);
    }
}
