//! `docs/options.md` and the options in the Python package are made from the table of options:
//! `HYSID_WRITE=1 cargo test -p hysid-core --test options_page` writes them.

mod python;

use std::fmt::Write as _;
use std::path::PathBuf;

use hysid_core::options::ModelName;
use hysid_core::options::table::{FitOption, OPTIONS, OptionGroup, OptionValues};

const HEAD: &str = "\
# Options of a fit

Each option has one name: `--no-deterioration` of `hysid fit` and `hysid validate` is the keyword `no_deterioration` of
`hysid.fit`, of `HysteresisRegressor` and of the library's `NamedOptions`. A model ignores options that it does
not use, with a warning. This page is generated from the table of options in `crates/hysid-core/src/options/table.rs`.
";

const TAIL: &str = "
## Only on the command line

These are options of `hysid fit` that say where data come from and results go to, and the rate. In Python and in the
library they are arguments of `fit`.

| option | meaning | default |
|---|---|---|
| `--out` (`-o`) | model file; the report has the same name with `.html` | name of the first table with `.json` |
| `--force` | replace files even if Hysid did not write them; each is kept as `NAME.bak` | off |
| `--no-report` | write no report | off |
| `--title` | title of the report | the quantities and the model |
| `--json` | print the result as one JSON object | off |
| `--quiet` (`-q`) | only warnings and errors on stderr | off |
| `--time` | column of time stamps | a column that is named like time |
| `--record` | column with the record of each row | a column `record`; otherwise each table is a record |
| `--input` | column of an input; repeat for several | from names and values |
| `--output` | column of the output | from names and values; where they tell nothing, the last column |
| `--rate` | rate of the first input: `auto`, `none`, `central`, `backward`, `savitzky-golay` or a column with the rate | `auto`: `backward` if the model uses a rate and the data pass each place at several speeds; else `none` |
| `--inverse` | exchange the first input and the output, to fit a model of the inverse | off |
| `--threads` | number of threads; the model does not depend on it | one for each processor |
| `--time-limit` | seconds after which the best model so far is used | none |
| `--checkpoint` | file in which the state of the fit of a single network is saved every few seconds | none |
| `--resume` | file of such a fit to resume | none |

`--model` and other options above take the same values here. [files.md](files.md#options-for-reading) lists the options
for reading tables.
";

fn values(option: &FitOption) -> String {
    match option.values {
        OptionValues::Count(low, high) => format!("{low} to {high}"),
        OptionValues::Whole => "0 or more".into(),
        OptionValues::Fraction => "between 0 and 1".into(),
        OptionValues::ZeroOr(low, high) => format!("0, or {low:e} to {high:e}"),
        OptionValues::Number(low, high) => format!("{low} to {high:e}"),
        OptionValues::Positive => "numbers above 0".into(),
        OptionValues::Flag => "a flag".into(),
        OptionValues::Truth => "true or false".into(),
        OptionValues::Span => "rows, or a time with its unit".into(),
        OptionValues::Names(names) => format!("`{}`", names().join("`, `")),
    }
}

fn users(option: &FitOption) -> String {
    let (all, users) = (1 + ModelName::all().count(), option.users());
    if users.len() == all {
        return "all".into();
    }
    let names: Vec<&str> = users.into_iter().map(ModelName::name).collect();
    names.join(", ")
}

fn page() -> String {
    let mut page = HEAD.to_string();
    for group in OptionGroup::ALL {
        let _ = write!(page, "\n## {}\n", group.heading());
        for option in OPTIONS.iter().filter(|option| option.group == group) {
            let _ = write!(
                page,
                "\n### `{}`\n\n{}.\n\n- Values: {}\n- Default: {}\n- Models: {}\n",
                option.name,
                option.meaning,
                values(option),
                option.default_in_words(),
                users(option)
            );
        }
    }
    page + TAIL
}

fn path(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn read(file: &str) -> String {
    std::fs::read_to_string(path(file)).unwrap_or_default().replace("\r\n", "\n")
}

/// Compares a file with its text as generated; writes it if `HYSID_WRITE` is set.
fn assert_generated(file: &str, text: &str) {
    if std::env::var_os("HYSID_WRITE").is_some() {
        std::fs::write(path(file), text).unwrap();
    }
    assert_eq!(read(file), text, "HYSID_WRITE=1 cargo test writes {file} anew");
}

#[test]
fn the_page_of_options_is_that_of_the_table() {
    assert_generated("docs/options.md", &page());
}

#[test]
fn the_python_package_has_the_options_of_the_table() {
    for (file, generate) in python::GENERATED {
        let file = format!("crates/hysid-python/python/hysid/{file}");
        assert_generated(&file, &generate(&read(&file)));
    }
}
