//! The header file: types, functions, and what the model is.

use crate::program::Precision;
use crate::subject::Subject;

/// The text of the header file.
pub(super) fn header(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let real = match subject.precision() {
        Precision::Double => "double",
        Precision::Single => "float",
    };
    let facts: String = subject.facts().iter().map(|(fact, text)| format!(" * {fact}: {text}\n")).collect();
    let state: String = subject
        .program()
        .states()
        .map(|(_, array, values)| format!("    {name}_real {array}[{}];\n", values.len()))
        .collect();
    let parameters: String =
        subject.argument_names().iter().map(|argument| format!(", {name}_real {argument}")).collect();
    let half_width = match subject.half_width() {
        Some(_) => format!(
            "/* Half the width of the prediction band at the last trial or step, in the unit of the output. */
{name}_real {name}_half_width(const {name}_model *model);

"
        ),
        None => String::new(),
    };
    format!(
        "/* {name}.h: a model of hysteresis, written by Hysid.
 *
{facts} *
 * Values are in the units of the columns above. Inputs must be finite.
 */
#ifndef {upper}_H
#define {upper}_H

#include <stddef.h>

#ifdef __cplusplus
extern \"C\" {{
#endif

typedef {real} {name}_real;

/* What the model remembers. */
typedef struct {{
{state}}} {name}_state;

typedef struct {{
    {name}_state committed;
    {name}_state trial;
    int has_trial;
}} {name}_model;

/* Bytes of a saved state: the state, what tells it from those of other models, and a checksum. */
#define {upper}_STATE_BYTES (sizeof({name}_state) + 2 * sizeof(double))

/* To the initial state. Call it once before anything else. */
void {name}_reset({name}_model *model);

/* The output at a new input, from the committed state, which stays as it is. */
{name}_real {name}_trial({name}_model *model{parameters});

/* The same, and the slope of the output by x; at a kink that of the branch taken. */
{name}_real {name}_trial_tangent({name}_model *model{parameters}, {name}_real *tangent);

/* The state of the last trial becomes the committed one. Without a trial, nothing changes. */
void {name}_commit({name}_model *model);

/* Forgets the last trial. */
void {name}_revert({name}_model *model);

/* A trial that is committed at once, without a copy of the state. */
{name}_real {name}_step({name}_model *model{parameters});

{half_width}/* Saves the committed state as {upper}_STATE_BYTES bytes, for the same program on the same kind of machine. */
void {name}_save(const {name}_model *model, unsigned char *bytes);

/* Restores a saved state and returns 1. Bytes that are no saved state of this model change nothing and give 0. */
int {name}_restore({name}_model *model, const unsigned char *bytes);

#ifdef __cplusplus
}}
#endif

#endif
"
    )
}
