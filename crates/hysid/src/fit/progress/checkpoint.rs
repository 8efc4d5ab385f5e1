//! The state of an unfinished fit, as bytes.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::options::network::FitOptions;

/// First bytes of a checkpoint, with the version of its layout. Only a program with the same layout reads it.
const MAGIC: &[u8] = b"hysid checkpoint 1\n";

/// The state of an unfinished fit, without the data.
#[derive(Debug, Clone)]
pub struct Checkpoint {
    head: Head,
    /// The state of the runs, as bytes that only the trainer reads.
    state: Vec<u8>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Head {
    options: FitOptions,
    /// Checksum of the data.
    data: u32,
}

impl Checkpoint {
    pub(crate) fn of(options: &FitOptions, data: &Dataset, state: &impl Serialize) -> Self {
        Self { head: Head { options: options.clone(), data: checksum(data) }, state: packed(state) }
    }

    /// The options of the fit.
    pub fn options(&self) -> &FitOptions {
        &self.head.options
    }

    /// The bytes of a checkpoint file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let content = [packed(&self.head), self.state.clone()].concat();
        let sum = crc32fast::hash(&content).to_le_bytes();
        [MAGIC, &sum, &content].concat()
    }

    /// Reads the bytes of a checkpoint file.
    ///
    /// # Errors
    /// Bytes that are truncated, damaged, of another version, or no checkpoint.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        if bytes.is_empty() {
            return refused("the checkpoint is empty");
        }
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            return match bytes.starts_with(&MAGIC[..16]) {
                true => of_another_version(),
                false => refused("this is not a Hysid checkpoint"),
            };
        };
        let Some((sum, content)) = rest.split_first_chunk::<4>() else {
            return refused("the checkpoint is cut off");
        };
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return refused("the checkpoint is cut off or damaged");
        }
        let mut rest = content;
        match rmp_serde::from_read(&mut rest) {
            Ok(head) => Ok(Self { head, state: rest.to_vec() }),
            Err(_) => of_another_version(),
        }
    }

    /// Splits into options and state, for the same data.
    pub(crate) fn for_data<S: DeserializeOwned>(self, data: &Dataset) -> Result<(FitOptions, S)> {
        if self.head.data != checksum(data) {
            return Err(Error::Checkpoint(
                "the checkpoint belongs to other data: give the same files and columns as before".into(),
            ));
        }
        match rmp_serde::from_slice(&self.state) {
            Ok(state) => Ok((self.head.options, state)),
            Err(_) => of_another_version(),
        }
    }
}

fn packed(value: &impl Serialize) -> Vec<u8> {
    rmp_serde::to_vec_named(value).expect("a checkpoint is plain data")
}

fn refused<T>(text: &str) -> Result<T> {
    Err(Error::Checkpoint(format!("{text}: start a new fit")))
}

fn of_another_version<T>() -> Result<T> {
    refused("the checkpoint was written by another version of hysid")
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
