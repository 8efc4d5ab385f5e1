//! The values of a column, shared between a record and its parts.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// Immutable values of a column; clones and parts from the first row on share one allocation.
#[derive(Clone)]
pub struct Values {
    all: Arc<[f64]>,
    len: usize,
}

impl Values {
    /// The values before the row `end`.
    pub(super) fn up_to(&self, end: usize) -> Self {
        Self { all: Arc::clone(&self.all), len: end.min(self.len) }
    }
}

impl From<Vec<f64>> for Values {
    fn from(values: Vec<f64>) -> Self {
        Self { len: values.len(), all: values.into() }
    }
}

impl Deref for Values {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.all[..self.len]
    }
}

impl<'a> IntoIterator for &'a Values {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Values {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self).finish()
    }
}
