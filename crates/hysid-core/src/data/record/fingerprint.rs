//! Fingerprints by which records are recognized.

/// A hash of the scored rows of a record: bits of inputs and output, independent of names and time stamps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fingerprint {
    /// FNV-1a, <https://datatracker.ietf.org/doc/html/rfc9923>: the same on every machine.
    hash: u64,
    rows: usize,
}

impl Default for Fingerprint {
    fn default() -> Self {
        Self { hash: 0xcbf2_9ce4_8422_2325, rows: 0 }
    }
}

/// Least number of rows: fewer may be equal by chance.
const FEWEST: usize = 10;

impl Fingerprint {
    /// Adds the next row; a row with a blank output (NaN) is skipped.
    pub fn add(&mut self, inputs: impl IntoIterator<Item = f64>, output: f64) {
        if output.is_nan() {
            return;
        }
        self.rows += 1;
        for value in inputs.into_iter().chain([output]) {
            // 0 and -0 are one number.
            for byte in (value + 0.0).to_bits().to_le_bytes() {
                self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }

    /// The hash as sixteen hexadecimal digits; `None` for too few rows.
    pub fn text(&self) -> Option<String> {
        (self.rows >= FEWEST).then(|| format!("{:016x}", self.hash))
    }
}
