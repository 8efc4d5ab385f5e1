//! The encoding of a text: from its mark, from zeros of UTF-16, or guessed from its letters.

use std::io::Read;

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding as Standard, UTF_8, UTF_16BE, UTF_16LE};
use encoding_rs_io::DecodeReaderBytesBuilder;

use crate::reading::TextEncoding;

/// The encoding by the byte order mark, or by the zeros of UTF-16 without a mark.
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
/// no text is found where its row is read, which gives the line.
pub fn decoded(
    reader: Box<dyn Read>,
    first: &[u8],
    chosen: Option<TextEncoding>,
) -> (Box<dyn Read>, &'static str) {
    let encoding = match chosen {
        Some(TextEncoding(encoding)) => encoding,
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

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn read(bytes: Vec<u8>, chosen: Option<&str>) -> (String, &'static str) {
        let first = bytes.clone();
        let chosen = chosen.map(|name| name.parse().unwrap());
        let (mut reader, name) = decoded(Box::new(Cursor::new(bytes)), &first, chosen);
        let mut text = String::new();
        reader.read_to_string(&mut text).unwrap();
        (text, name)
    }

    #[test]
    fn encodings_are_guessed_from_a_header() {
        let rows = "0,1;2,5;3,5\n".repeat(20);
        for (label, header) in [
            ("windows-1252", "Zeit [s];Längung [µm];Kraft [kN]\n"),
            ("windows-1252", "Temps (s);Déplacement (mm);Effort (kN)\n"),
            ("windows-1251", "Время, с;Перемещение, мм;Сила, кН\n"),
            ("gbk", "时间(s);位移(mm);力(kN)\n"),
            ("shift_jis", "時間(s);変位(mm);荷重(kN)\n"),
        ] {
            let text = format!("{header}{rows}");
            let encoding = Standard::for_label(label.as_bytes()).unwrap();
            let (bytes, _, is_lossy) = encoding.encode(&text);
            assert!(!is_lossy);
            assert_eq!(read(bytes.to_vec(), None).0, text, "{label}");
            assert_eq!(read(bytes.into_owned(), Some(label)).0, text, "{label}");
        }
    }

    #[test]
    fn utf_16_is_known_with_a_mark_and_without() {
        let text = "t\tx\n0\t1.5\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for (bytes, name) in [
            (little.clone(), "UTF-16LE"),
            ([vec![0xff, 0xfe], little].concat(), "UTF-16LE"),
            (big.clone(), "UTF-16BE"),
            ([vec![0xfe, 0xff], big].concat(), "UTF-16BE"),
        ] {
            assert_eq!(read(bytes, None), (text.to_string(), name));
        }
    }

    #[test]
    fn text_in_utf_8_stays_as_it_is() {
        assert_eq!(read(b"\xef\xbb\xbfx\n".to_vec(), None), ("x\n".into(), "UTF-8"));
        assert_eq!(read("µ\n".into(), None), ("µ\n".into(), "UTF-8"));
    }
}
