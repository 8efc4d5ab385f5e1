//! Zip archives whose parts are stored or compressed: reading the samples, and writing what was made of them.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;

/// The parts of a sound archive, by its central directory.
pub fn parts(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let number =
        |at: usize, width: usize| bytes[at..at + width].iter().rev().fold(0, |sum, b| sum << 8 | *b as usize);
    let end = bytes.windows(4).rposition(|window| window == b"PK\x05\x06").expect("an archive");
    let (count, mut at) = (number(end + 10, 2), number(end + 16, 4));
    let mut parts = Vec::new();
    for _ in 0..count {
        let [name, extra, comment] = [28, 30, 32].map(|offset| number(at + offset, 2));
        let (method, size, local) = (number(at + 10, 2), number(at + 20, 4), number(at + 42, 4));
        let from = local + 30 + number(local + 26, 2) + number(local + 28, 2);
        let stored = &bytes[from..from + size];
        let mut content = Vec::new();
        match method {
            0 => content.extend_from_slice(stored),
            _ => _ = DeflateDecoder::new(stored).read_to_end(&mut content).expect("a sample is sound"),
        }
        parts.push((String::from_utf8_lossy(&bytes[at + 46..at + 46 + name]).into_owned(), content));
        at += 46 + name + extra + comment;
    }
    parts
}

/// An archive of parts, compressed.
pub fn written(parts: &[(String, Vec<u8>)]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in parts {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        let packed = encoder.write_all(content).and_then(|()| encoder.finish()).expect("memory takes all");
        let local = bytes.len() as u32;
        let facts = [
            &[20, 0, 0, 0, 8, 0, 0, 0, 33, 0][..],
            &crc32fast::hash(content).to_le_bytes(),
            &(packed.len() as u32).to_le_bytes(),
            &(content.len() as u32).to_le_bytes(),
            &(name.len() as u16).to_le_bytes(),
            &[0, 0],
        ]
        .concat();
        bytes.extend([b"PK\x03\x04", &facts[..], name.as_bytes(), &packed].concat());
        directory.extend(
            [b"PK\x01\x02\x14\x00", &facts[..], &[0; 10], &local.to_le_bytes(), name.as_bytes()].concat(),
        );
    }
    let (count, length, start) = (parts.len() as u16, directory.len() as u32, bytes.len() as u32);
    let counts = [count.to_le_bytes(), count.to_le_bytes()].concat();
    bytes.extend(directory);
    bytes.extend(
        [b"PK\x05\x06\0\0\0\0", &counts[..], &length.to_le_bytes(), &start.to_le_bytes(), &[0, 0]].concat(),
    );
    bytes
}
