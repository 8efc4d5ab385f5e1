//! Files that are no text in UTF-8: other encodings, compressed files, spreadsheets, MATLAB files.

use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::GzEncoder;
use hdf5_pure::{AttrValue, FileBuilder};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::File;
use super::record::{COMMA, POINT, Row, lines, rows};

/// All of them.
pub fn all() -> Vec<File> {
    let file = |name, content| File { name, content };
    let german = format!("Zeit [s];Längung [µm];Kraft [kN]\n{}", lines(COMMA, ";"));
    let russian = format!("Время, с;Перемещение, мм;Сила, кН\n{}", lines(COMMA, ";"));
    let chinese = format!("时间(s);位移(mm);荷载(kN)\n{}", lines(COMMA, ";"));
    let japanese = format!("時間(s);変位(mm);荷重(kN)\n{}", lines(COMMA, ";"));
    let tabs = format!("Zeit [s]\tWeg [mm]\tKraft [kN]\n{}", lines(COMMA, "\t"));
    let plain = format!("t,x,y\n{}", lines(POINT, ","));
    vec![
        file("utf8-mark.csv", [b"\xef\xbb\xbf", german.as_bytes()].concat()),
        file("utf16-little.txt", utf16(&tabs, true, u16::to_le_bytes)),
        file("utf16-big.txt", utf16(&tabs, true, u16::to_be_bytes)),
        file("utf16-unmarked.txt", utf16(&tabs, false, u16::to_le_bytes)),
        file("latin1.csv", encoded(&german, "windows-1252")),
        file("cp1251.csv", encoded(&russian, "windows-1251")),
        file("gbk.csv", encoded(&chinese, "gbk")),
        file("shift-jis.csv", encoded(&japanese, "shift_jis")),
        file("compressed.csv.gz", gzip(plain.as_bytes())),
        file(
            "excel.xlsx",
            workbook(&[("Data", sheet(&[&["Time (s)", "Displacement (mm)", "Force (kN)"]], Cell::Seconds))]),
        ),
        file(
            "excel-preamble.xlsx",
            workbook(&[(
                "Test 3",
                sheet(
                    &[&["Sample", "A-17"], &[], &["Time", "Displacement", "Force"], &["s", "mm", "kN"]],
                    Cell::Seconds,
                ),
            )]),
        ),
        file(
            "excel-dates.xlsx",
            workbook(&[("Data", sheet(&[&["Time", "Displacement (mm)", "Force (kN)"]], Cell::Date))]),
        ),
        file(
            "excel-second-sheet.xlsx",
            workbook(&[
                ("Notes", notes()),
                ("Data", sheet(&[&["Time (s)", "Displacement (mm)", "Force (kN)"]], Cell::Seconds)),
            ]),
        ),
        file("matlab-5.mat", matlab_5(false)),
        file("matlab-structure.mat", matlab_5(true)),
        file("matlab-7.3.mat", matlab_7_3()),
    ]
}

fn utf16(text: &str, has_mark: bool, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = has_mark.then_some(0xfeff);
    mark.into_iter().chain(text.encode_utf16()).flat_map(bytes).collect()
}

fn encoded(text: &str, label: &str) -> Vec<u8> {
    let encoding = encoding_rs::Encoding::for_label(label.as_bytes()).expect("an encoding");
    encoding.encode(text).0.into_owned()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(bytes).expect("memory");
    packed.finish().expect("memory")
}

/// What the first column of a sheet has.
#[derive(Clone, Copy)]
enum Cell {
    Seconds,
    /// Days since 1900, with the format of a date.
    Date,
}

/// The rows of a sheet with lines of text above the record.
fn sheet(above: &[&[&str]], time: Cell) -> String {
    let text = |cells: &[&str]| {
        let cells: String =
            cells.iter().map(|cell| format!("<c t=\"inlineStr\"><is><t>{cell}</t></is></c>")).collect();
        format!("<row>{cells}</row>")
    };
    let row = |row: Row| {
        let time = match time {
            Cell::Seconds => format!("<c><v>{}</v></c>", POINT.time(row)),
            // 2024-03-01 12:00:00 and so many tenths of a second.
            Cell::Date => format!("<c s=\"1\"><v>{:.10}</v></c>", 45352.5 + row.t as f64 / 864_000.0),
        };
        format!("<row>{time}<c><v>{}</v></c><c><v>{}</v></c></row>", POINT.x(row), POINT.y(row))
    };
    above.iter().map(|cells| text(cells)).chain(rows().into_iter().map(row)).collect()
}

fn notes() -> String {
    "<row><c t=\"inlineStr\"><is><t>Notes of the operator</t></is></c></row>".into()
}

/// A workbook with these sheets, as little of one as spreadsheets need.
fn workbook(sheets: &[(&str, String)]) -> Vec<u8> {
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>";
    let numbered = |text: &dyn Fn(usize, &str) -> String| -> String {
        sheets.iter().enumerate().map(|(place, (name, _))| text(place + 1, name)).collect()
    };
    let parts = [
        (
            "[Content_Types].xml".to_string(),
            format!(
                "{HEAD}<Types xmlns=\"{PACKAGE}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.\
                 openxmlformats-package.relationships+xml\"/><Default Extension=\"xml\" ContentType=\"application/xml\"/>\
                 <Override PartName=\"/xl/workbook.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.\
                 spreadsheetml.sheet.main+xml\"/></Types>"
            ),
        ),
        (
            "_rels/.rels".into(),
            format!(
                "{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"rId1\" \
                 Type=\"{OFFICE}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml".into(),
            format!(
                "{HEAD}<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets>{}</sheets></workbook>",
                numbered(&|number, name| format!(
                    "<sheet name=\"{name}\" sheetId=\"{number}\" r:id=\"rId{number}\"/>"
                ))
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels".into(),
            format!(
                "{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\">{}<Relationship Id=\"rId99\" \
                 Type=\"{OFFICE}/styles\" Target=\"styles.xml\"/></Relationships>",
                numbered(&|number, _| format!(
                    "<Relationship Id=\"rId{number}\" Type=\"{OFFICE}/worksheet\" Target=\"worksheets/sheet{number}.xml\"/>"
                ))
            ),
        ),
        (
            "xl/styles.xml".into(),
            format!(
                "{HEAD}<styleSheet xmlns=\"{MAIN}\"><cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"22\" \
                 applyNumberFormat=\"1\"/></cellXfs></styleSheet>"
            ),
        ),
    ];
    let rows = sheets.iter().enumerate().map(|(place, (_, rows))| {
        let text = format!("{HEAD}<worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData></worksheet>");
        (format!("xl/worksheets/sheet{}.xml", place + 1), text)
    });
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, text) in parts.into_iter().chain(rows) {
        archive.start_file(name, stored).expect("memory");
        archive.write_all(text.as_bytes()).expect("memory");
    }
    archive.finish().expect("memory").into_inner()
}

/// Name and values of the three variables.
fn variables() -> [(&'static str, Vec<f64>); 3] {
    let column = |value: fn(Row) -> f64| rows().into_iter().map(value).collect();
    [
        ("t", column(|row| row.t as f64 / 10.0)),
        ("x", column(|row| row.x as f64 / 1000.0)),
        ("y", column(|row| row.y as f64 / 1000.0)),
    ]
}

/// A MATLAB file of version 5 with three variables, or with a structure of three fields.
fn matlab_5(is_structure: bool) -> Vec<u8> {
    let element = |kind: u32, bytes: &[u8]| {
        let mut all = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
        all.extend(bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    };
    let matrix = |class: u32, name: &str, rows: usize, rest: Vec<u8>| {
        let sizes = [(rows as u32).to_le_bytes(), 1_u32.to_le_bytes()].concat();
        let flags = [class.to_le_bytes(), [0; 4]].concat();
        element(14, &[element(6, &flags), element(5, &sizes), element(1, name.as_bytes()), rest].concat())
    };
    let vector = |name: &str, values: &[f64]| {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        matrix(6, name, values.len(), element(9, &bytes))
    };
    let mut file = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".to_vec();
    file.resize(124, b' ');
    file.extend([0, 1, b'I', b'M']);
    if is_structure {
        let length = [(4_u32 << 16 | 5).to_le_bytes(), 8_u32.to_le_bytes()].concat();
        let names: Vec<u8> =
            variables().iter().flat_map(|(name, _)| format!("{name:\0<8}").into_bytes()).collect();
        let fields: Vec<u8> = variables().iter().flat_map(|(_, values)| vector("", values)).collect();
        file.extend(matrix(2, "data", 1, [length, element(1, &names), fields].concat()));
    } else {
        variables().iter().for_each(|(name, values)| file.extend(vector(name, values)));
    }
    file
}

/// A MATLAB file of version 7.3, which is HDF5 behind a block of 512 bytes.
fn matlab_7_3() -> Vec<u8> {
    let mut builder = FileBuilder::new();
    for (name, values) in variables() {
        let dataset = builder.create_dataset(name);
        dataset.with_f64_data(&values).with_shape(&[1, values.len() as u64]);
        dataset.set_attr("MATLAB_class", AttrValue::AsciiString("double".into()));
    }
    builder.with_userblock(512);
    let mut file = builder.finish().expect("memory");
    let text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64";
    file[..text.len()].copy_from_slice(text);
    file
}
