//! Examples in the help of each command.

pub(super) const FIT_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid fit data.csv                     model data.json, report data.html
  hysid fit data.csv --members 1         one small model instead of an ensemble
  hysid fit data.csv --model bouc-wen    one named model
  hysid fit a.csv b.csv --input i --output flux -o core.json

All options: hysid fit --help options; their ranges:
",
    page!("options.md")
);

pub(super) const DEMO_EXAMPLES: &str = "\
Examples:
  hysid demo                     writes into the folder hysid-demo
  hysid demo -o DIR              writes into another folder";

pub(super) const SIMULATE_EXAMPLES: &str = "\
Examples:
  hysid simulate model.json data.csv -o simulated.csv
  hysid simulate model.json data.csv --band 0.9 -o simulated.csv
  hysid simulate model.json data.csv > simulated.csv";

pub(super) const EVALUATE_EXAMPLES: &str = "\
Examples:
  hysid evaluate model.json test.csv
  hysid evaluate model.json test-1.csv test-2.csv
  hysid evaluate model.json test.csv --band 0.9
  hysid evaluate model.json test.csv --residuals
  hysid evaluate model.json test.csv --json";

pub(super) const INVERT_EXAMPLES: &str = "\
Examples:
  hysid invert model.json reference.csv -o drive.csv    report drive.html
  hysid invert model.json reference.csv --limits 0:150 --slew 2000 -o drive.csv
  hysid simulate model.json drive.csv -o check.csv      the output of that input";

pub(super) const VALIDATE_EXAMPLES: &str = "\
Examples:
  hysid validate data.csv --model xpnn+
  hysid validate a.csv b.csv c.csv --model preisach --folds 3
  hysid validate data.csv                the default model, auto";

pub(super) const COMPARE_EXAMPLES: &str = "\
Examples:
  hysid compare train.csv --test test.csv
  hysid compare train.csv --test test.csv --models xpnn,preisach,bouc-wen
  hysid compare train.csv --test test.csv --time-limit 60";

pub(super) const LOOK_EXAMPLES: &str = concat!(
    "\
Examples:
  hysid look data.csv
  hysid look test.xlsx --sheet 2 -o clean.csv
  hysid look log.txt --skip 12 --decimal comma --missing -999

Options for files that are not read as you expect: hysid look --help options,
",
    page!("files.md")
);

pub(super) const DIAGNOSE_EXAMPLES: &str = "\
Examples:
  hysid diagnose data.csv
  hysid diagnose data.csv --time t --input x --output f
  hysid diagnose model.json";

pub(super) const REPRODUCE_EXAMPLES: &str = "\
Examples:
  hysid reproduce --quick nds example1   two experiments, with less effort
  hysid reproduce                        all experiments
  hysid reproduce example5 -o DIR        one experiment, into another folder";

pub(super) const GENERATE_EXAMPLES: &str = "\
Examples:
  hysid generate --list
  hysid generate terfenol-rod -o train.csv --test test.csv
  hysid generate ferromagnet -o train.csv --noise 1 --seed 2";

pub(super) const EXPORT_EXAMPLES: &str = "\
Examples:
  hysid export model.json --to c                      the folder model_c
  hysid export model.json --to c --name piezo -o src/piezo --precision f32
  hysid export model.json --to fmu --fmi 2            for tools with FMI 2.0
  hysid export model.json --to c --inverse --limits 0:150 --slew 2000";
