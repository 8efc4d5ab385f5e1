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
    /// The example of the paper whose measured specimen it replaces; `None` for a further specimen.
    pub example: Option<&'static str>,
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
    pub(super) columns: SpecimenColumns,
    /// The training records of a seed. The seed draws what is random in the protocol.
    pub(super) train: fn(u64) -> Result<Vec<Record>>,
    /// The test records of a seed.
    pub(super) test: fn(u64) -> Result<Vec<Record>>,
}

/// Names of a specimen's columns, with their units.
#[derive(Debug)]
pub(super) struct SpecimenColumns {
    pub time: Option<&'static str>,
    pub input: &'static str,
    pub output: &'static str,
}

impl Specimen {
    /// Names of its columns, with their units.
    pub fn columns(&self) -> ColumnNames {
        ColumnNames::of(self.columns.time, &[self.columns.input], self.columns.output)
    }

    /// The training records of seed 1. Only a published benchmark whose training data contain noise has noise here;
    /// [`with_noise`](crate::with_noise) adds more.
    pub fn train(&self) -> Dataset {
        self.train_with_seed(1)
    }

    /// The test records of seed 1, without noise.
    pub fn test(&self) -> Dataset {
        self.test_with_seed(1)
    }

    /// The training records whose random excitation has this seed. Without random excitation all seeds give the same
    /// records.
    pub fn train_with_seed(&self, seed: u64) -> Dataset {
        self.dataset((self.train)(seed))
    }

    /// The test records whose random excitation has this seed. Their excitation differs from that of the training
    /// records of the same seed.
    pub fn test_with_seed(&self, seed: u64) -> Dataset {
        self.dataset((self.test)(seed))
    }

    fn dataset(&self, records: Result<Vec<Record>>) -> Dataset {
        records
            .and_then(|records| Dataset::new(self.columns(), records))
            .expect("a specimen's protocol gives records of its columns")
    }
}
