//! A program that runs the test vectors.

use crate::program::Precision;
use crate::subject::Subject;
use crate::target::c::inverse_test::inverse_test;
use crate::vectors::Action;

/// The text of the program.
pub(super) fn self_test(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let count = subject.argument_names().len();
    let (suffix, tolerance) = match subject.precision() {
        Precision::Double => ("", "1e-9"),
        Precision::Single => ("f", "1e-4"),
    };
    let number = |value: f64| match subject.precision() {
        Precision::Double => format!("{value:?}"),
        Precision::Single => format!("{:?}f", value as f32),
    };
    let rows: String = subject
        .vectors()
        .iter()
        .map(|vector| {
            let mut arguments: Vec<String> = vector.arguments.iter().map(|value| number(*value)).collect();
            arguments.resize(count, format!("0.0{suffix}"));
            let (output, tangent) = (number(vector.output), number(vector.tangent));
            let action = vector.action.name().to_uppercase();
            format!("    {{ {action}, {{ {} }}, {output}, {tangent} }},\n", arguments.join(", "))
        })
        .collect();
    let actions = [
        Action::Reset,
        Action::Trial,
        Action::Commit,
        Action::Revert,
        Action::Step,
        Action::Save,
        Action::Restore,
    ];
    let names = actions.map(|action| action.name().to_uppercase()).join(", ");
    let given: String = (0..count).map(|index| format!(", v->arguments[{index}]")).collect();
    let (low, high) = subject.model().trained_ranges().output;
    let scale = number(0.5 * (high - low));
    let (include, test, and_inverse) = match subject.inverse() {
        Some(inverse) => (
            format!("#include \"{name}_inverse.h\"\n"),
            inverse_test(subject, inverse),
            "    is_good = test_inverse() && is_good;\n",
        ),
        None => Default::default(),
    };
    format!(
        "/* {name}_test.c: compares {name}.c with the test vectors. Exit status 0 if all agree. */

#include <stdio.h>

#include \"{name}.h\"
{include}
typedef enum {{ {names} }} action;

typedef struct {{
    action action;
    {name}_real arguments[{count}];
    {name}_real output;
    {name}_real tangent;
}} vector;

static const vector vectors[] = {{
{rows}}};

static {name}_real largest = 0;
static int different = 0;

/* Compares with what is expected, relative to the scale. */
static void compare({name}_real found, {name}_real expected, {name}_real scale)
{{
    {name}_real difference = found < expected ? expected - found : found - expected;
    if (found < expected || found > expected)
        different++;
    if (!(difference / scale <= largest))
        largest = difference / scale;
}}

{test}int main(void)
{{
    static {name}_model model;
    static unsigned char saved[{upper}_STATE_BYTES];
    const {name}_real scale = {scale};
    const size_t count = sizeof(vectors) / sizeof(vectors[0]);
    int is_good, off = 0;
    size_t i;

    {name}_reset(&model);
    for (i = 0; i < count; i++) {{
        const vector *v = &vectors[i];
        {name}_real tangent;
        const int before = different;
        switch (v->action) {{
        case RESET: {name}_reset(&model); break;
        case COMMIT: {name}_commit(&model); break;
        case REVERT: {name}_revert(&model); break;
        case SAVE: {name}_save(&model, saved); break;
        case RESTORE: {name}_restore(&model, saved); break;
        case STEP: compare({name}_step(&model{given}), v->output, scale); break;
        case TRIAL:
            compare({name}_trial_tangent(&model{given}, &tangent), v->output, scale);
            compare(tangent, v->tangent, scale + (v->tangent < 0 ? -v->tangent : v->tangent));
            compare({name}_trial(&model{given}), v->output, scale);
            break;
        }}
        off += different > before;
    }}
    printf(\"%d of %d test vectors differ, by at most %.1e of half the trained range\\n\", off, (int)count,
           (double)largest);
    is_good = largest <= ({name}_real){tolerance};
{and_inverse}    return is_good ? 0 : 1;
}}
"
    )
}
