//! Where the text of a table comes from: a file or standard input, compressed or not, in any encoding, a spreadsheet, or
//! a MATLAB file. Whatever it is, a stream of UTF-8 text comes out.

mod budget;
mod encoding;
mod matlab;
mod spreadsheet;

use std::io::{self, Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use hysid_core::words::Words;
use hysid_files::unreadable;

use crate::reading::Reading;
pub use budget::THREAD;
use budget::UnpackingReader;
use hysid_document::{Problem, Result};

/// Bytes that identify the format of a file.
const FIRST: usize = 1 << 16;

pub struct DecodedText {
    /// The file, as the user named it.
    pub file: String,
    /// UTF-8, without a byte order mark.
    pub reader: Box<dyn Read>,
    /// How it is stored, in words, such as `text, UTF-8`.
    pub stored: String,
    pub other_sheets: Vec<String>,
}

impl DecodedText {
    /// Opens a file; standard input for `-`.
    pub fn open(path: &Path, reading: &Reading) -> Result<Self> {
        if path == Path::new("-") {
            return Self::new("standard input".into(), Box::new(io::stdin()), reading);
        }
        let file = path.display().to_string();
        let reader = hysid_files::open(path).map_err(Problem::from)?;
        Self::new(file, Box::new(reader), reading)
    }

    /// The text that a reader gives, of a file of this name.
    pub fn new(file: String, reader: Box<dyn Read>, reading: &Reading) -> Result<Self> {
        let (mut reader, mut first) = peeked(&file, reader)?;
        let mut packed = "";
        if first.starts_with(b"\x1f\x8b") {
            packed = ", gzip";
            (reader, first) = peeked(&file, Box::new(UnpackingReader::of(reader, MultiGzDecoder::new)))?;
        }
        let failed = |what: &str, problem: Words| {
            Problem::in_file(&file, Words::from(format!("is {what} that cannot be read: ")) + problem)
        };
        if first.starts_with(b"PK\x03\x04") || first.starts_with(spreadsheet::COMPOUND) {
            let bytes = all(&file, reader)?;
            let (text, sheet, other_sheets) = spreadsheet::text(bytes, reading.sheet.clone())
                .map_err(|problem| failed("a spreadsheet or an archive", problem.into()))?;
            let stored = format!("spreadsheet, sheet {sheet}{packed}");
            return Ok(Self { file, reader: Box::new(Cursor::new(text)), stored, other_sheets });
        }
        if matlab::is_one(&first) {
            let bytes = all(&file, reader)?;
            let (text, kind) = matlab::text(bytes, reading.sheet.clone())
                .map_err(|problem| failed("a MATLAB file", problem))?;
            let stored = format!("{kind}{packed}");
            return Ok(Self { file, reader: Box::new(Cursor::new(text)), stored, other_sheets: Vec::new() });
        }
        check_kind(&first).map_err(|what| Problem::in_file(&file, what))?;
        let (reader, encoding) = encoding::decoded(reader, &first, reading.encoding);
        Ok(Self { file, reader, stored: format!("text, {encoding}{packed}"), other_sheets: Vec::new() })
    }
}

/// The first bytes of a reader, and all of it.
fn peeked(file: &str, mut reader: Box<dyn Read>) -> Result<(Box<dyn Read>, Vec<u8>)> {
    let mut first = Vec::new();
    let mut beginning = reader.by_ref().take(FIRST as u64);
    beginning.read_to_end(&mut first).map_err(|error| unreadable(file, &error))?;
    Ok((Box::new(Cursor::new(first.clone()).chain(reader)), first))
}

fn all(file: &str, mut reader: Box<dyn Read>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| unreadable(file, &error))?;
    Ok(bytes)
}

/// True for the content of a file that begins like a JSON object, as model files do.
pub fn is_json(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"{")
}

/// Message on a file with a byte that no text has.
pub const BINARY: &str = "is a binary file, not a table of numbers";

/// Refuses what is clearly no table.
fn check_kind(bytes: &[u8]) -> Result<(), &'static str> {
    if bytes.starts_with(b"PAR1") {
        Err(
            "is a Parquet file (read it in Python with pandas or polars, which hysid.fit takes, or save it as CSV)",
        )
    } else if bytes.starts_with(b"ARROW1") || bytes.starts_with(b"FEA1") {
        Err(
            "is a Feather or Arrow file (read it in Python with pandas or polars, which hysid.fit takes, or save it \
             as CSV)",
        )
    } else if bytes.starts_with(b"TDSm") {
        Err("is a TDMS file of LabVIEW (save it as .lvm or .csv)")
    } else if is_json(bytes) {
        Err("is JSON, not CSV (a model file in the place of data?)")
    } else if bytes.contains(&0) && encoding::of_marked_text(bytes).is_none() {
        Err(BINARY)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn text(bytes: &[u8]) -> Result<(String, String)> {
        let bytes = bytes.to_vec();
        let mut text = DecodedText::new("f".into(), Box::new(Cursor::new(bytes)), &Reading::default())?;
        let mut content = String::new();
        text.reader.read_to_string(&mut content).unwrap();
        Ok((content, text.stored))
    }

    #[test]
    fn text_is_unpacked_and_decoded() {
        let utf16: Vec<u8> = "t;µ\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&[&[0xff, 0xfe], utf16.as_slice()].concat()).unwrap();
        let expected = ("t;µ\n".to_string(), "text, UTF-16LE, gzip".to_string());
        assert_eq!(text(&packed.finish().unwrap()).unwrap(), expected);
        assert_eq!(text(b"\xef\xbb\xbft;x\n").unwrap().0, "t;x\n");
    }

    #[test]
    fn other_files_are_named() {
        for (bytes, problem) in [
            (b"PAR1\x15\x04".as_slice(), "f: is a Parquet file"),
            (b"  {\"format\": 1}", "f: is JSON, not CSV"),
            (b"\x7fELF\0\0\x01\0\x02\0\0", "f: is a binary file"),
            (b"PK\x03\x04 and nothing more", "f: is a spreadsheet or an archive that cannot be read"),
            (b"MATLAB 5.0 MAT-file", "f: is a MATLAB file that cannot be read"),
        ] {
            let error = text(bytes).unwrap_err().to_string();
            assert!(error.starts_with(problem), "{error}");
        }
    }
}
