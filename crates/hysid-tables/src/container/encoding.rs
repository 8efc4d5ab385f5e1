//! The encoding of a text: from its mark, from zeros of UTF-16, or guessed from its letters.

use std::io::Read;

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding as Standard, UTF_8, UTF_16BE, UTF_16LE};
use encoding_rs_io::DecodeReaderBytesBuilder;

use crate::reading::Encoding;

/// The encoding that a byte order mark tells, or the zeros of UTF-16 without a mark.
pub fn of_marked_text(first: &[u8]) -> Option<&'static Standard> {
    if let Some((encoding, _)) = Standard::for_bom(first) {
        return Some(encoding);
    }
    // Digits and delimiters of UTF-16 have one zero each, always in the same place.
    let pairs = first.len() / 2;
    let zeros = |place: usize| first.chunks_exact(2).filter(|pair| pair[place] == 0).count();
    match pairs {
        0 => None,
        _ if 10 * zeros(1) > 7 * pairs && zeros(0) == 0 => Some(UTF_16LE),
        _ if 10 * zeros(0) > 7 * pairs && zeros(1) == 0 => Some(UTF_16BE),
        _ => None,
    }
}

/// The text in UTF-8 without a mark, and the name of its encoding. Text in UTF-8 is not looked through: a byte that is
/// no text is found where its row is read, which tells the line.
pub fn decoded(
    reader: Box<dyn Read>,
    first: &[u8],
    chosen: Option<Encoding>,
) -> (Box<dyn Read>, &'static str) {
    let encoding = match chosen {
        Some(Encoding(encoding)) => encoding,
        None => of_marked_text(first).unwrap_or_else(|| guessed(first)),
    };
    let mark = first.starts_with(b"\xef\xbb\xbf");
    if encoding == UTF_8 && !mark {
        return (reader, encoding.name());
    }
    let text = DecodeReaderBytesBuilder::new()
        .encoding(Some(encoding))
        // UTF-8 as it is, so that what is no text is found.
        .utf8_passthru(true)
        .strip_bom(true)
        .bom_override(chosen.is_none())
        .build(reader);
    (Box::new(text), encoding.name())
}

fn guessed(first: &[u8]) -> &'static Standard {
    // A letter may be cut at the end.
    let is_utf8 = match std::str::from_utf8(first) {
        Ok(_) => true,
        Err(error) => error.error_len().is_none(),
    };
    if is_utf8 {
        return UTF_8;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(first, true);
    detector.guess(None, Utf8Detection::Deny)
}
