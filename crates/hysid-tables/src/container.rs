//! Where the text of a table comes from: a file or standard input, compressed or not, in any encoding, a spreadsheet, a
//! file of MATLAB, HDF5 or NumPy, or JSON. Whatever it is, UTF-8 text comes out: a stream, or a sheet for each table.

mod budget;
mod encoding;
mod json;
mod matlab;
mod numpy;
mod spreadsheet;
mod variables;

use std::io::{self, Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use hysid_core::words::Words;
use hysid_files::unreadable;

use crate::reading::Reading;
pub use budget::THREAD;
use budget::{Budget, UnpackingReader};
use hysid_document::{Problem, Result};
use variables::Variable;
pub use variables::is_lying;

/// Bytes that identify the format of a file.
const FIRST: usize = 1 << 16;

pub struct DecodedText {
    /// The file, as the user named it.
    pub file: String,
    /// UTF-8, without a byte order mark.
    pub content: TextContent,
    /// How it is stored, in words, such as `text, UTF-8`.
    pub stored: String,
    /// All of it may be read beforehand: it is a small file, and no pipe.
    pub is_short: bool,
}

/// Bytes of a text that is looked through for several tables.
pub const LONGEST_TEXT: usize = 1 << 24;

pub enum TextContent {
    Stream(Box<dyn Read>),
    /// The sheets of a file, at least one.
    Sheets(Vec<TextSheet>),
}

/// A sheet of a spreadsheet, or variables of equal length, as text with tabs between its cells.
#[derive(Debug)]
pub struct TextSheet {
    pub name: String,
    /// Its kind and name.
    pub described: String,
    pub text: String,
}

impl DecodedText {
    /// Opens a file; standard input for `-`.
    pub fn open(path: &Path, reading: &Reading) -> Result<Self> {
        if path == Path::new("-") {
            return Self::new("standard input".into(), Box::new(io::stdin()), false, reading);
        }
        let file = path.display().to_string();
        let is_short =
            path.metadata().is_ok_and(|stored| stored.is_file() && stored.len() <= LONGEST_TEXT as u64);
        let reader = hysid_files::open(path).map_err(Problem::from)?;
        Self::new(file, Box::new(reader), is_short, reading)
    }

    /// The text that a reader gives, of a file of this name.
    pub fn new(file: String, reader: Box<dyn Read>, is_short: bool, reading: &Reading) -> Result<Self> {
        let (mut reader, mut first) = peeked(&file, reader)?;
        let mut packed = "";
        if first.starts_with(b"\x1f\x8b") {
            packed = ", gzip";
            (reader, first) = peeked(&file, Box::new(UnpackingReader::of(reader, MultiGzDecoder::new)))?;
        }
        let chosen = reading.sheet.clone();
        let sheets = |reader, kind: &str, of: fn(Vec<u8>, Option<String>) -> Result<BookOfSheets, Words>| {
            let budget = |bytes: Vec<u8>| Budget::of(bytes.len()).run(move || of(bytes, chosen));
            let failed = |words| {
                Problem::in_file(&file, Words::from(format!("is {kind} that cannot be read: ")) + words)
            };
            let (sheets, stored) = budget(all(&file, reader)?).map_err(failed)?;
            let stored = format!("{stored}{packed}");
            Ok(Self { file: file.clone(), content: TextContent::Sheets(sheets), stored, is_short })
        };
        if numpy::is_array(&first) || numpy::is_archive(&first) {
            return sheets(reader, "a NumPy file", |bytes, chosen| {
                let (variables, kind) = numpy::variables(&bytes, Budget::of(bytes.len()))?;
                of_variables(variables, kind, chosen)
            });
        }
        if first.starts_with(b"PK\x03\x04") || first.starts_with(spreadsheet::COMPOUND) {
            return sheets(reader, "a spreadsheet or an archive", |bytes, chosen| {
                Ok((spreadsheet::sheets(bytes, chosen)?, "spreadsheet"))
            });
        }
        if matlab::is_one(&first) {
            let kind = if first.starts_with(b"MATLAB") { "a MATLAB file" } else { "an HDF5 file" };
            return sheets(reader, kind, |bytes, chosen| {
                let budget = Budget::of(bytes.len());
                let (variables, kind) = matlab::variables(bytes, budget)?;
                of_variables(variables, kind, chosen)
            });
        }
        check_kind(&first).map_err(|what| Problem::in_file(&file, Words::from(what).helpful()))?;
        if json::is_json(&first) && !is_model(&first) {
            return sheets(reader, "a JSON file", |bytes, chosen| {
                of_variables(json::variables(&bytes, Budget::of(bytes.len()))?, "JSON", chosen)
            });
        }
        let (reader, encoding) = encoding::decoded(reader, &first, reading.encoding);
        let stored = format!("text, {encoding}{packed}");
        Ok(Self { file, content: TextContent::Stream(reader), stored, is_short })
    }
}

/// Sheets, and the kind of their file.
type BookOfSheets = (Vec<TextSheet>, &'static str);

fn of_variables(
    variables: Vec<Variable>,
    kind: &'static str,
    chosen: Option<String>,
) -> Result<BookOfSheets, Words> {
    if variables.is_empty() {
        let words = Words::from("there is no numeric variable with more than one row");
        return Err(words.advised(match kind {
            "HDF5 file" => {
                "a table of pandas? in Python, pandas.read_hdf(\"FILE\").to_csv(\"data.csv\") makes it CSV"
            }
            kind if kind.starts_with("MATLAB") => {
                "tables and timetables: save their columns as vectors, or write a CSV file with writetable"
            }
            _ => "save columns of numbers",
        }));
    }
    Ok((variables::sheets(variables, chosen.as_deref())?, kind))
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

/// A cell of a text with tabs, in quotation marks where it has a character that divides.
pub fn push_words(text: &mut String, words: &str) {
    if words.contains(['\t', '\n', '\r', '"']) {
        text.push('"');
        text.push_str(&words.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(words);
    }
}

/// True for the content of a file that begins like a model of Hysid.
pub fn is_model(bytes: &[u8]) -> bool {
    let inside = bytes.trim_ascii_start().strip_prefix(b"{");
    inside.is_some_and(|inside| inside.trim_ascii_start().starts_with(b"\"format\""))
}

/// Message on a file with a byte that no text has.
pub const BINARY: &str = "is a binary file, not a table of numbers";

/// Beginnings of files that are clearly no tables, and what they are.
const OTHER_KINDS: [(&[u8], &str); 17] = [
    (
        b"PAR1",
        "is a Parquet file (read it in Python with pandas or polars, which hysid.fit takes, or save it as CSV)",
    ),
    (b"ARROW1", FEATHER),
    (b"FEA1", FEATHER),
    (b"TDSm", "is a TDMS file of LabVIEW (save it as .lvm or .csv)"),
    (b"version https://git-lfs", "is a pointer of Git LFS in place of the data (get them with git lfs pull)"),
    (b"/annex/objects/", "is a pointer of git-annex in place of the data (get them with git annex get)"),
    (b"../.git/annex/", "is a pointer of git-annex in place of the data (get them with git annex get)"),
    (b"\x89PNG", PICTURE),
    (b"\xff\xd8\xff", PICTURE),
    (b"GIF8", PICTURE),
    (b"II*\0", PICTURE),
    (b"MM\0*", PICTURE),
    (b"<svg", PICTURE),
    (b"%PDF", "is a PDF document (its tables can be copied into a spreadsheet, its curves digitised)"),
    (b"<!DOCTYPE", PAGE),
    (b"<!doctype", PAGE),
    (b"<html", PAGE),
];

const FEATHER: &str = "is a Feather or Arrow file (read it in Python with pandas or polars, which hysid.fit takes, or save it as CSV)";
const PICTURE: &str = "is a picture (get the numbers that were drawn, or digitise its curves with a program such as WebPlotDigitizer)";
const PAGE: &str = "is a web page, perhaps one that asks for a login (download the file itself, such as the raw file of GitHub)";

/// Kind of a file that by its beginning is clearly no table, in words; `None` for all others.
pub fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let begins = |(beginning, _): &&(&[u8], &str)| bytes.trim_ascii_start().starts_with(beginning);
    // WebP; HEIC and AVIF; a bitmap; a drawing after its declaration.
    let is_at = |place: usize, mark: &[u8]| bytes.get(place..).is_some_and(|rest| rest.starts_with(mark));
    let is_picture = is_at(0, b"RIFF") && is_at(8, b"WEBP")
        || ["heic", "mif1", "avif"].iter().any(|kind| is_at(4, b"ftyp") && is_at(8, kind.as_bytes()))
        || is_at(0, b"BM") && is_at(6, &[0; 4])
        || is_at(0, b"<?xml") && bytes[..bytes.len().min(1000)].windows(4).any(|letters| letters == b"<svg");
    let known = OTHER_KINDS.iter().find(begins).map(|(_, kind)| *kind);
    known.or(is_picture.then_some(PICTURE))
}

/// Refuses what is clearly no table.
fn check_kind(bytes: &[u8]) -> Result<(), &'static str> {
    if let Some(kind) = other_kind(bytes) {
        Err(kind)
    } else if is_model(bytes) {
        Err("is a model of Hysid, not data (name the file with the measurement)")
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
        let text = DecodedText::new("f".into(), Box::new(Cursor::new(bytes)), true, &Reading::default())?;
        let mut all = String::new();
        let TextContent::Stream(mut reader) = text.content else { panic!("sheets") };
        reader.read_to_string(&mut all).unwrap();
        Ok((all, text.stored))
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
            (b"  {\"format\": 1}", "f: is a model of Hysid"),
            (
                b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 9\n",
                "f: is a pointer of Git LFS",
            ),
            (b"\x89PNG\r\n\x1a\n", "f: is a picture"),
            (b"RIFF\x24\0\0\0WEBPVP8 ", "f: is a picture"),
            (b"\0\0\0\x18ftypheic", "f: is a picture"),
            (b"<?xml version=\"1.0\"?>\n<svg width=\"9\">", "f: is a picture"),
            (b"\n<!DOCTYPE html>", "f: is a web page"),
            (b"[[1, 2], [3]]", "f: is a JSON file that cannot be read: its rows have different lengths"),
            (b"\x89HDF\r\n\x1a\n", "f: is an HDF5 file that cannot be read"),
            (b"\x93NUMPY", "f: is a NumPy file that cannot be read: it is damaged"),
            (b"\x7fELF\0\0\x01\0\x02\0\0", "f: is a binary file"),
            (b"PK\x03\x04 and nothing more", "f: is a spreadsheet or an archive that cannot be read"),
            (b"MATLAB 5.0 MAT-file", "f: is a MATLAB file that cannot be read"),
        ] {
            let error = text(bytes).unwrap_err().to_string();
            assert!(error.starts_with(problem), "{error}");
        }
    }
}
