//! Files that hold tables: spreadsheets, MATLAB and gzip files whose sizes, counts, offsets and nesting are changed, not
//! bits alone. What is read is a table, or one line says why not, in seconds and in little memory. The bytes of the fuzzer
//! are choices: which file, and what is changed in it.
//!
//! Memory is bounded by the process: `cargo test -p hysid-fuzz` and `attack` of the laboratory run this target under
//! `ulimit -v`.

mod archive;
mod samples;

use std::io::{Read as _, Write as _};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::read::{GzDecoder, ZlibDecoder};
use flate2::write::{GzEncoder, ZlibEncoder};

use crate::bytes::Bytes;
use crate::table;

/// A file may take so long, however little of the machine this process gets.
const LONGEST: Duration = Duration::from_secs(15);

/// Largest file that is made.
const MOST_BYTES: usize = 1 << 20;

/// Numbers at which sizes and counts are likely to fail.
const SIZES: [u64; 14] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0x7fff,
    0x8000,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_fffe,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// The same in texts, and others.
const TEXTS: [&str; 10] =
    ["0", "-1", "1", "65536", "1048577", "4294967295", "99999999999999999999", "1e308", "ZZZZZZZ9", ""];

/// A file as its parts.
#[derive(Clone)]
enum Sample {
    /// Parts of a zip archive: names and contents.
    Archive(Vec<(String, Vec<u8>)>),
    /// Any other, such as a MATLAB or a compound file.
    Binary(Vec<u8>),
    /// The content of a gzip file.
    Compressed(Vec<u8>),
    /// A header of 128 bytes and the content of an element that is compressed, as in MATLAB files.
    MatlabElement(Vec<u8>, Vec<u8>),
}

static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(samples::all);

pub fn run(choices: &[u8]) {
    let file = changed(&mut Bytes(choices));
    let began = Instant::now();
    table::run(&file);
    assert!(began.elapsed() < LONGEST, "{:?} for {} bytes", began.elapsed(), file.len());
}

pub fn seeds() -> Vec<Vec<u8>> {
    let of = |sample: usize, kind: usize| {
        let choice = |k: usize| (k * 31 + 7 * sample + 13 * kind) as u8;
        [sample as u8, kind as u8].into_iter().chain((0..60).map(choice)).collect()
    };
    (0..SAMPLES.len()).flat_map(|sample| (0..4).map(move |kind| of(sample, kind))).collect()
}

fn changed(bytes: &mut Bytes) -> Vec<u8> {
    let mut sample = SAMPLES[bytes.below(SAMPLES.len())].clone();
    let changes = bytes.below(4);
    for _ in 0..changes {
        match &mut sample {
            Sample::Archive(parts) => {
                let part = bytes.below(parts.len());
                match bytes.below(8) {
                    0 => _ = parts.remove(part),
                    1 => parts.push(parts[part].clone()),
                    _ => change_text(&mut parts[part].1, bytes),
                }
            }
            Sample::Compressed(content) => change_text(content, bytes),
            Sample::Binary(content) | Sample::MatlabElement(_, content) => change_numbers(content, bytes),
        }
        if matches!(&sample, Sample::Archive(parts) if parts.is_empty()) {
            break;
        }
    }
    let compressed = |content: &[u8]| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(content).and_then(|()| encoder.finish()).expect("memory takes all")
    };
    let mut file = match sample {
        Sample::Archive(parts) => archive::written(&parts),
        Sample::Binary(content) => content,
        Sample::Compressed(content) => {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(&content).and_then(|()| encoder.finish()).expect("memory takes all")
        }
        Sample::MatlabElement(header, content) => {
            let content = compressed(&content);
            let tag = [15_u32.to_le_bytes(), (content.len() as u32).to_le_bytes()].concat();
            [header, tag, content].concat()
        }
    };
    // Sizes and offsets of the file itself, such as those of an archive's directory.
    for _ in 0..bytes.below(3) {
        change_number(&mut file, bytes);
    }
    file
}

/// A place in some bytes.
fn place(length: usize, bytes: &mut Bytes) -> usize {
    (usize::from(bytes.byte()) << 16 | usize::from(bytes.byte()) << 8 | usize::from(bytes.byte()))
        % length.max(1)
}

/// Another number, deeper nesting, or much more of the same.
fn change_text(content: &mut Vec<u8>, bytes: &mut Bytes) {
    let at = place(content.len(), bytes);
    let repeats = 1 + 16 * usize::from(bytes.byte());
    match bytes.below(4) {
        0 | 1 => {
            let Some(from) = content[at..].iter().position(u8::is_ascii_digit).map(|offset| at + offset)
            else {
                return;
            };
            let end = content[from..].iter().position(|byte| !byte.is_ascii_digit());
            let end = end.map_or(content.len(), |length| from + length);
            content.splice(from..end, bytes.one_of(&TEXTS).bytes());
        }
        2 => {
            // An opening tag again and again, maybe with its closing one.
            let Some(from) = content[at..].iter().position(|byte| *byte == b'<').map(|offset| at + offset)
            else {
                return;
            };
            let end =
                content[from..].iter().position(|byte| *byte == b'>').map_or(content.len(), |e| from + e + 1);
            let tag = content[from..end].to_vec().repeat(repeats);
            content.splice(from..from, tag);
        }
        _ => {
            let end = (at + 1 + place(400, bytes)).min(content.len());
            let stretch = content[at..end].repeat(repeats);
            content.splice(at..at, stretch);
        }
    }
    content.truncate(MOST_BYTES);
}

fn change_numbers(content: &mut Vec<u8>, bytes: &mut Bytes) {
    match bytes.below(8) {
        0 => content.truncate(place(content.len(), bytes)),
        1 => {
            let at = place(content.len(), bytes);
            let end = (at + 1 + place(600, bytes)).min(content.len());
            let stretch = content[at..end].repeat(1 + usize::from(bytes.byte()) / 16);
            content.splice(at..at, stretch);
            content.truncate(MOST_BYTES);
        }
        _ => change_number(content, bytes),
    }
}

/// Puts a size, count or offset in the place of a number of 1, 2, 4 or 8 bytes.
fn change_number(content: &mut [u8], bytes: &mut Bytes) {
    let width = 1 << bytes.below(4);
    let at = place(content.len(), bytes) / width * width;
    let Some(place) = content.get_mut(at..at + width) else { return };
    let mut number = [0; 8];
    number[..width].copy_from_slice(place);
    let old = u64::from_le_bytes(number);
    let new = match bytes.below(4) {
        0 => old.wrapping_add(u64::from(bytes.byte())).wrapping_sub(8),
        1 => old << bytes.below(24),
        _ => bytes.one_of(&SIZES),
    };
    place.copy_from_slice(&new.to_le_bytes()[..width]);
}

/// The content of a gzip file, or of a compressed element.
fn unpacked(bytes: &[u8], is_gzip: bool) -> Vec<u8> {
    let mut content = Vec::new();
    let read = match is_gzip {
        true => GzDecoder::new(bytes).read_to_end(&mut content),
        false => ZlibDecoder::new(bytes).read_to_end(&mut content),
    };
    read.expect("a sample is sound");
    content
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Otherwise nothing behind the first check would be tried.
    #[test]
    fn every_sample_is_a_table_as_long_as_nothing_is_changed() {
        assert!(SAMPLES.len() >= 8);
        // The last one claims too much.
        for sample in 0..SAMPLES.len() - 1 {
            let file = changed(&mut Bytes(&[sample as u8, 0]));
            if let Err(error) = hysid_records::data_of_text(&file) {
                panic!("sample {sample}: {error:#}");
            }
        }
    }
}
