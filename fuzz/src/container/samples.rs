//! One file of each container: those of the program's tests, and an OpenDocument and a workbook of Excel 97 made here.

use super::{Sample, archive, unpacked};

/// Rows of the tables that are made here.
const ROWS: u16 = 14;

pub fn all() -> Vec<Sample> {
    macro_rules! file {
        ($name:literal) => {
            include_bytes!(concat!("../../../crates/hysid-cli/tests/files/", $name))
        };
    }
    let spreadsheets = [&file!("excel.xlsx")[..], file!("excel-dates.xlsx"), file!("excel-preamble.xlsx")];
    let matlab = [&file!("matlab-5.mat")[..], file!("matlab-structure.mat"), file!("matlab-7.3.mat")];
    let mut all: Vec<Sample> = spreadsheets.map(|bytes| Sample::Archive(archive::parts(bytes))).into();
    all.extend(matlab.map(|bytes| Sample::Binary(bytes.to_vec())));
    all.push(Sample::Compressed(unpacked(file!("compressed.csv.gz"), true)));
    all.extend(compressed_element(file!("matlab-5.mat")));
    all.push(Sample::Archive(open_document()));
    all.push(Sample::Binary(workbook(u32::from(ROWS) + 1)));
    // Refused as it is: what makes the check miss it would take all memory.
    all.push(Sample::Binary(workbook(u32::MAX)));
    all
}

/// The first element of a MATLAB file, if it is compressed: several are what `Binary` is for.
fn compressed_element(bytes: &[u8]) -> Option<Sample> {
    let (header, rest) = bytes.split_at_checked(128)?;
    let number = |at: usize| u32::from_le_bytes(rest[at..at + 4].try_into().expect("four bytes"));
    if number(0) != 15 {
        return None;
    }
    let mut content = Vec::new();
    let mut at = 0;
    while at + 8 <= rest.len() {
        let length = number(at + 4) as usize;
        content.extend(unpacked(&rest[at + 8..at + 8 + length], false));
        at += 8 + length;
    }
    // All elements in one: the reader takes the first.
    Some(Sample::MatlabElement(header.to_vec(), content))
}

fn open_document() -> Vec<(String, Vec<u8>)> {
    let cell = |value: f64| {
        format!(
            "<table:table-cell office:value-type=\"float\" office:value=\"{value}\"><text:p>{value}</text:p></table:table-cell>"
        )
    };
    let word = |word: &str| {
        format!("<table:table-cell office:value-type=\"string\"><text:p>{word}</text:p></table:table-cell>")
    };
    let row = |cells: String| {
        format!("<table:table-row table:number-rows-repeated=\"1\">{cells}</table:table-row>")
    };
    let rows =
        (0..ROWS).map(|k| row(cell(f64::from(k)) + &cell(f64::from(k % 5)) + &cell(0.5 * f64::from(k % 4))));
    let table = row(["t", "x", "y"].map(word).concat()) + &rows.collect::<String>();
    let content =
        format!("<d><office:body><table:table table:name=\"S\">{table}</table:table></office:body></d>");
    let parts = [
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet"),
        ("META-INF/manifest.xml", "<manifest/>"),
        ("content.xml", &content),
    ];
    parts.map(|(name, text)| (name.to_string(), text.as_bytes().to_vec())).into()
}

/// A workbook of Excel 97 that claims so many rows: records in a stream of a compound file.
fn workbook(claimed: u32) -> Vec<u8> {
    let begin = |kind: u16| (0x0809, numbers(&[0x0600, kind, 0, 0]));
    let start = 12_u32 + 14 + 4;
    let name = [&start.to_le_bytes()[..], &[0, 0, 2, 0, b'S', b'1']].concat();
    let extent = [&0_u32.to_le_bytes()[..], &claimed.to_le_bytes(), &numbers(&[0, 3, 0])].concat();
    let mut records = vec![begin(5), (0x0085, name), (0x000a, Vec::new()), begin(16), (0x0200, extent)];
    for (column, word) in (0..).zip([b"t", b"x", b"y"]) {
        records.push((0x0204, [&numbers(&[0, column, 0, 1])[..], &[0], word].concat()));
    }
    for row in 1..=ROWS {
        for (column, value) in (0..).zip([row, row % 5, row % 4]) {
            let value = f64::from(value).to_le_bytes();
            records.push((0x0203, [&numbers(&[row, column, 0])[..], &value].concat()));
        }
    }
    records.push((0x000a, Vec::new()));
    let stream = records
        .iter()
        .flat_map(|(kind, content)| [&numbers(&[*kind, content.len() as u16])[..], content].concat());
    compound(stream.collect())
}

fn numbers(all: &[u16]) -> Vec<u8> {
    all.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A compound file with a stream in sectors of 512 bytes: header, table of sectors, directory, stream.
fn compound(mut stream: Vec<u8>) -> Vec<u8> {
    const END: u32 = 0xffff_fffe;
    stream.resize(stream.len().next_multiple_of(512).max(4096), 0);
    let sectors = stream.len() as u32 / 512;
    let next = |place: u32| if place + 1 == sectors { END } else { place + 3 };
    let mut table: Vec<u32> = [0xffff_fffd, END].into_iter().chain((0..sectors).map(next)).collect();
    table.resize(128, u32::MAX);
    let mut header = vec![0_u8; 512];
    let mut set = |place: usize, bytes: &[u8]| header[place..place + bytes.len()].copy_from_slice(bytes);
    set(0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1");
    set(24, &numbers(&[0x3e, 3, 0xfffe, 9, 6]));
    for (place, number) in [(44, 1_u32), (48, 1), (56, 4096), (60, END), (68, END)] {
        set(place, &number.to_le_bytes());
    }
    set(80, &[0xff; 432]);
    let entry = |name: &str, kind: u8, start: u32, length: u32| {
        let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        entry.resize(128, 0);
        entry[64] = 2 * name.len() as u8 + 2;
        entry[66] = kind;
        entry[116..120].copy_from_slice(&start.to_le_bytes());
        entry[120..124].copy_from_slice(&length.to_le_bytes());
        entry
    };
    let directory =
        [entry("Root Entry", 5, END, 0), entry("Workbook", 2, 2, stream.len() as u32), vec![0; 256]];
    let table: Vec<u8> = table.into_iter().flat_map(u32::to_le_bytes).collect();
    [header, table, directory.concat(), stream].concat()
}
