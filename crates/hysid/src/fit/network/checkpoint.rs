//! The state of an unfinished fit, as bytes.

use serde::{Deserialize, Serialize};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::network::fitting::State;
use crate::options::network::FitOptions;

/// First bytes of a checkpoint, with the version of its layout. Only a program with the same layout reads it.
const MAGIC: &[u8] = b"hysid checkpoint 1\n";

/// The state of an unfinished fit, without the data.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    options: FitOptions,
    /// Checksum of the data.
    data: u32,
    state: State,
}

impl Checkpoint {
    pub(crate) fn of(options: &FitOptions, data: &Dataset, state: &State) -> Self {
        Self { options: options.clone(), data: checksum(data), state: state.clone() }
    }

    /// The options of the fit.
    pub fn options(&self) -> &FitOptions {
        &self.options
    }

    /// The bytes of a checkpoint file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let content = rmp_serde::to_vec_named(self).expect("a checkpoint is plain data");
        let sum = crc32fast::hash(&content).to_le_bytes();
        [MAGIC, &sum, &content].concat()
    }

    /// Reads the bytes of a checkpoint file.
    ///
    /// # Errors
    /// Bytes that are truncated, damaged, of another version, or no checkpoint.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let refused = |text: &str| Err(Error::Checkpoint(format!("{text}: start a new fit")));
        if bytes.is_empty() {
            return refused("the checkpoint is empty");
        }
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            return match bytes.starts_with(&MAGIC[..16]) {
                true => refused("the checkpoint was written by another version of hysid"),
                false => refused("this is not a Hysid checkpoint"),
            };
        };
        let Some((sum, content)) = rest.split_first_chunk::<4>() else {
            return refused("the checkpoint is cut off");
        };
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return refused("the checkpoint is cut off or damaged");
        }
        match rmp_serde::from_slice(content) {
            Ok(checkpoint) => Ok(checkpoint),
            Err(_) => refused("the checkpoint was written by another version of hysid"),
        }
    }

    /// Splits into options and state, for the same data.
    pub(crate) fn for_data(self, data: &Dataset) -> Result<(FitOptions, State)> {
        if self.data != checksum(data) {
            return Err(Error::Checkpoint(
                "the checkpoint belongs to other data: give the same files and columns as before".into(),
            ));
        }
        Ok((self.options, self.state))
    }
}

fn checksum(data: &Dataset) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let mut add = |values: &[f64]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        for value in values {
            hasher.update(&value.to_bits().to_le_bytes());
        }
    };
    for record in data.records() {
        record.inputs().iter().for_each(|input| add(input));
        add(record.output());
        add(record.time().unwrap_or(&[]));
        add(record.given_rate().unwrap_or(&[]));
        // Without a lead-in, as in a fit that knows of none.
        record.lead_in().filter(|lead_in| !lead_in.is_empty()).into_iter().for_each(&mut add);
    }
    hasher.finalize()
}
