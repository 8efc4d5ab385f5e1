//! A specimen: what is known about it and how it is tested.

use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::error::Result;

/// A synthetic specimen: where its law comes from, and records to train and to test on.
///
/// The test data are never trained on. Where they begin with blank outputs, the input of those rows
/// only brings the memory to where the test begins.
///
/// ```
/// use hysid_specimens::Specimen;
/// let joint = Specimen::named("reinforced-concrete-joint").unwrap();
/// let (train, test) = (joint.train(), joint.test());
/// assert_eq!(train.names().inputs, ["displacement_mm"]);
/// assert_eq!(train.scored() + test.scored(), test.rows());
/// ```
#[derive(Debug)]
pub struct Specimen {
    /// Name as typed on a command line.
    pub name: &'static str,
    /// The example of the paper that it stands for.
    pub example: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Which laws and values are published, and where.
    pub published: &'static str,
    /// Which laws and values are ours, chosen so that the specimen shows what it is meant to show.
    pub designed: &'static str,
    /// How the training data are made.
    pub training: &'static str,
    /// How the test data are made.
    pub testing: &'static str,
    pub(super) columns: Columns,
    pub(super) train: fn() -> Result<Vec<Record>>,
    pub(super) test: fn() -> Result<Vec<Record>>,
}

/// Names of a specimen's columns, with their units.
#[derive(Debug)]
pub(super) struct Columns {
    pub time: Option<&'static str>,
    pub input: &'static str,
    pub output: &'static str,
}

impl Specimen {
    /// Names of its columns, with their units.
    pub fn columns(&self) -> ColumnNames {
        ColumnNames {
            time: self.columns.time.map(str::to_owned),
            inputs: vec![self.columns.input.to_owned()],
            rate: None,
            output: self.columns.output.to_owned(),
        }
    }

    /// The records to train on, without noise.
    pub fn train(&self) -> Dataset {
        self.dataset((self.train)())
    }

    /// The records to test on, without noise.
    pub fn test(&self) -> Dataset {
        self.dataset((self.test)())
    }

    fn dataset(&self, records: Result<Vec<Record>>) -> Dataset {
        records
            .and_then(|records| Dataset::new(self.columns(), records))
            .expect("a specimen's protocol gives records of its columns")
    }
}
