//! The part of the self-test that runs the inverse.

use crate::inverse::ExportedInverse;
use crate::program::Precision;
use crate::subject::ExportSubject;
use crate::target::c::inverse::literal;
use crate::target::template::filled;

/// Code that prints the results of the self-test, in double and in single precision.
const SAID: &str = r#"    printf("%d of %d numbers of the inverse differ, its outputs by at most %.1e of half the trained range; "
           "%d endings differ; %d outputs are not those of the model\n",
           different, compared, (double)largest, reaches, wrong);
"#;
const SAID_SINGLE: &str = r#"    printf("the inverse in single precision: %d numbers, its outputs within %.1e of half the trained range of those in "
           "double precision (an input may differ, where several give one output); %d endings differ; "
           "%d outputs are not those of the model\n",
           compared, (double)largest, reaches, wrong);
"#;

/// The text of its function `test_inverse`.
pub(super) fn inverse_test(subject: &ExportSubject<'_>, inverse: &ExportedInverse) -> String {
    let precision = subject.precision();
    let number = |value: f64| literal(precision, value);
    let count = inverse.arguments.len() + 1;
    let upper = subject.name().to_uppercase();
    let rows: String = inverse
        .vectors
        .iter()
        .map(|vector| {
            let mut arguments: Vec<String> = vector.arguments.iter().map(|value| number(*value)).collect();
            arguments.resize(count, number(0.0));
            let (input, output, reach) = vector.given.map_or((0.0, 0.0, "REACHED".into()), |given| {
                (given.input, given.output, given.reach.word().replace('-', "_").to_uppercase())
            });
            format!(
                "    {{ {}, {{ {} }}, {}, {}, {upper}_{reach} }},\n",
                vector.action.name().to_uppercase(),
                arguments.join(", "),
                number(input),
                number(output)
            )
        })
        .collect();
    let (low, high) = subject.model().trained_ranges().output;
    // Where several inputs give an output, single precision may find another one: from there on the paths differ.
    let (said, agrees) = match precision {
        Precision::Double => (SAID, " && reaches == 0 && largest <= 1e-9"),
        Precision::Single => (SAID_SINGLE, ""),
    };
    let given = |count: usize| (1..count).map(|index| format!(", a[{index}]")).collect::<String>();
    filled(
        include_str!("inverse_test.c.txt"),
        &[
            ("NAME", subject.name()),
            ("UPPER", &upper),
            ("@count@", &count.to_string()),
            ("@rows@", &rows),
            ("@given@", &given(count)),
            ("@of_model@", &given(subject.argument_names().len())),
            ("@scale@", &number(0.5 * (high - low))),
            ("@said@", said),
            ("@agrees@", agrees),
        ],
    )
}
