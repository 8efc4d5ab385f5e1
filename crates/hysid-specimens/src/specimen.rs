//! A specimen: the source of its law, and its training and test records.

use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::error::Result;

/// A synthetic specimen: the source of its law, and training and test records.
///
/// Test data are not part of the training data. If they begin with blank outputs, these rows only bring the
/// memory to the beginning of the test.
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
    /// Name on the command line.
    pub name: &'static str,
    /// The example of the paper that it replaces.
    pub example: &'static str,
    /// Description in one line.
    pub summary: &'static str,
    /// Published laws and values, with their sources.
    pub published: &'static str,
    /// Designed laws and values.
    pub designed: &'static str,
    /// Generation of the training data.
    pub training: &'static str,
    /// Generation of the test data.
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

    /// The training records, without noise.
    pub fn train(&self) -> Dataset {
        self.dataset((self.train)())
    }

    /// The test records, without noise.
    pub fn test(&self) -> Dataset {
        self.dataset((self.test)())
    }

    fn dataset(&self, records: Result<Vec<Record>>) -> Dataset {
        records
            .and_then(|records| Dataset::new(self.columns(), records))
            .expect("a specimen's protocol gives records of its columns")
    }
}
