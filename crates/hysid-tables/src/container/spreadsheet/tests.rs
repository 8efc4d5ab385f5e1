//! Small files that declare much.

use std::io::Write as _;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::*;

fn archive(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, content) in parts {
        archive.start_file(*name, options).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A workbook with this sheet, and texts that its cells share.
fn excel(sheet: &str, strings: &str) -> Vec<u8> {
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    let workbook = format!(
        "<workbook xmlns=\"{main}\" xmlns:r=\"{office}\"><sheets><sheet name=\"S\" sheetId=\"1\" r:id=\"a\"/></sheets></workbook>"
    );
    let link = |id: &str, kind: &str, target: &str| {
        format!("<Relationship Id=\"{id}\" Type=\"{office}/{kind}\" Target=\"{target}\"/>")
    };
    let top = format!(
        "<Relationships xmlns=\"{package}\">{}</Relationships>",
        link("w", "officeDocument", "xl/workbook.xml")
    );
    let links =
        link("a", "worksheet", "worksheets/sheet1.xml") + &link("b", "sharedStrings", "sharedStrings.xml");
    let links = format!("<Relationships xmlns=\"{package}\">{links}</Relationships>");
    let sheet = format!("<worksheet xmlns=\"{main}\"><sheetData>{sheet}</sheetData></worksheet>");
    archive(&[
        ("_rels/.rels", &top),
        ("xl/workbook.xml", &workbook),
        ("xl/_rels/workbook.xml.rels", &links),
        ("xl/worksheets/sheet1.xml", &sheet),
        ("xl/sharedStrings.xml", strings),
    ])
}

fn open_document(table: &str) -> Vec<u8> {
    let content =
        format!("<d><office:body><table:table table:name=\"S\">{table}</table:table></office:body></d>");
    archive(&[
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet"),
        ("META-INF/manifest.xml", "<manifest/>"),
        ("content.xml", &content),
    ])
}

#[test]
fn every_sheet_that_is_not_empty_is_read() {
    let cell =
        |number: f64| format!("<table:table-cell office:value-type=\"float\" office:value=\"{number}\"/>");
    let row = |number: f64| format!("<table:table-row>{}</table:table-row>", cell(number));
    let others = format!(
        "</table:table><table:table table:name=\"Empty\"></table:table><table:table table:name=\"T\">{}",
        row(2.5)
    );
    let book = open_document(&format!("{}{others}", row(1.5)));
    let read: Vec<(String, String)> =
        sheets(book.clone(), None).unwrap().into_iter().map(|sheet| (sheet.name, sheet.text)).collect();
    assert_eq!(read, [("S".into(), "1.5\n".into()), ("T".into(), "2.5\n".into())]);
    assert_eq!(sheets(book, Some("3".into())).unwrap()[0].described, "sheet T");
}

fn problem(bytes: Vec<u8>) -> String {
    sheets(bytes, None).unwrap_err()
}

#[test]
fn sheets_are_read_as_before() {
    let strings = "<sst uniqueCount=\"2\"><si><t>t</t></si><si><t>x</t></si></sst>";
    let cells = "<row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\" t=\"s\"><v>1</v></c></row>\
                 <row r=\"2\"><c r=\"A2\"><v>0.5</v></c><c><v>7</v></c></row>";
    assert_eq!(sheets(excel(cells, strings), None).unwrap()[0].text, "t\tx\n0.5\t7\n");
    // Empty cells and rows up to the end of the sheet take no memory.
    let table = "<table:table-row><table:table-cell office:value=\"1.5\" table:number-columns-repeated=\"2\"/>\
                 <table:table-cell table:number-columns-repeated=\"16382\"/></table:table-row>\
                 <table:table-row table:number-rows-repeated=\"1048575\">\
                 <table:table-cell table:number-columns-repeated=\"16384\"/></table:table-row>";
    assert_eq!(sheets(open_document(table), None).unwrap()[0].text, "1.5\t1.5\n");
}

#[test]
fn what_a_number_asks_for_is_refused_before_it_is_made() {
    let none = "<sst/>";
    let one = |cell: &str| excel(&format!("<row r=\"1\"><c r=\"A1\"><v>1</v></c>{cell}</row>"), none);
    assert!(problem(one("<c r=\"XFD1048576\"><v>2</v></c>")).contains("cells, which it cannot hold"));
    for name in ["ZZZZZZZZZZZZ1", "ZZZ1", "A99999999", "A0", "1", ""] {
        let problem = problem(one(&format!("<c r=\"{name}\"><v>2</v></c>")));
        assert!(problem.contains("which no sheet has"), "{name}: {problem}");
    }
    for count in ["4294967295", "9223372036854775808", "99999999999999999999999"] {
        let strings = format!("<sst uniqueCount=\"{count}\"><si><t>a</t></si></sst>");
        let problem = problem(excel("<row r=\"1\"><c r=\"A1\"><v>1</v></c></row>", &strings));
        assert!(problem.contains("more texts than the 1 that it has"), "{count}: {problem}");
    }
    // A long text in many cells.
    let strings = format!("<sst><si><t>{}</t></si></sst>", "a".repeat(1_000_000));
    let cells: String =
        (1..2000).map(|row| format!("<row r=\"{row}\"><c r=\"A{row}\" t=\"s\"><v>0</v></c></row>")).collect();
    assert!(problem(excel(&cells, &strings)).contains("unpacks to more than"));
    // A part of zeros.
    let zeros = format!("<row r=\"1\"><c r=\"A1\"><v>{}1</v></c></row>", "0".repeat(20 << 20));
    assert!(problem(excel(&zeros, none)).contains("unpacks to more than"));
}

#[test]
fn open_documents_end_and_repeat_within_bounds() {
    assert_eq!(
        problem(archive(&[("content.xml", "<table:table table:name=\"\">")])),
        "it is damaged or cut off"
    );
    let value = |columns: &str, rows: &str| {
        format!(
            "<table:table-row table:number-rows-repeated=\"{rows}\"><table:table-cell office:value=\"1\" \
             table:number-columns-repeated=\"{columns}\"/></table:table-row>"
        )
    };
    for table in [
        value("16384", "1048576"),
        value("16384", "1") + &value("1", "1000000"),
        value("1", "18446744073709551615"),
    ] {
        let problem = problem(open_document(&table));
        assert!(problem.contains("cells, which it cannot hold"), "{problem}: {table}");
    }
    let blanks = "<table:table-row><table:table-cell office:value-type=\"string\"><text:p>a<text:s text:c=\"4000000000\"/></text:p>\
                  </table:table-cell></table:table-row>";
    assert!(problem(open_document(blanks)).contains("unpacks to more than"));
    let deep = "<a>".repeat(1000) + &"</a>".repeat(1000);
    assert!(problem(open_document(&deep)).contains("nested too deeply"));
}

/// A compound file with a workbook of these records, in sectors of 512 bytes: a table of sectors, the directory, the stream.
fn compound(records: &[(u16, Vec<u8>)]) -> Vec<u8> {
    let mut stream: Vec<u8> = records
        .iter()
        .flat_map(|(kind, content)| {
            [&kind.to_le_bytes()[..], &(content.len() as u16).to_le_bytes(), content].concat()
        })
        .collect();
    stream.resize(stream.len().next_multiple_of(512).max(4096), 0);
    let sectors = stream.len() / 512;
    let mut table = vec![0xffff_fffd_u32, 0xffff_fffe];
    table.extend(
        (0..sectors as u32).map(|place| if place as usize + 1 == sectors { 0xffff_fffe } else { place + 3 }),
    );
    table.resize(128, 0xffff_ffff);
    let mut header = vec![0_u8; 512];
    header[..8].copy_from_slice(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1");
    let mut set = |place: usize, bytes: &[u8]| header[place..place + bytes.len()].copy_from_slice(bytes);
    for (place, number) in [(24, 0x3e_u16), (26, 3), (28, 0xfffe), (30, 9), (32, 6)] {
        set(place, &number.to_le_bytes());
    }
    for (place, number) in [(44, 1_u32), (48, 1), (56, 4096), (60, 0xffff_fffe), (68, 0xffff_fffe), (76, 0)] {
        set(place, &number.to_le_bytes());
    }
    (1..109).for_each(|place| set(76 + 4 * place, &[0xff; 4]));
    let entry = |name: &str, kind: u8, start: u32, length: u32| {
        let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        entry.resize(128, 0);
        entry[64..66].copy_from_slice(&(2 * name.len() as u16 + 2).to_le_bytes());
        entry[66] = kind;
        entry[116..120].copy_from_slice(&start.to_le_bytes());
        entry[120..124].copy_from_slice(&length.to_le_bytes());
        entry
    };
    let directory =
        [entry("Root Entry", 5, 0xffff_fffe, 0), entry("Workbook", 2, 2, stream.len() as u32), vec![0; 256]]
            .concat();
    let table: Vec<u8> = table.into_iter().flat_map(u32::to_le_bytes).collect();
    [header, table, directory, stream].concat()
}

/// A workbook with a sheet that claims an extent and has cells in these places.
fn workbook(extent: [u32; 4], cells: &[[u16; 2]]) -> Vec<u8> {
    let begin = |kind: u16| (0x0809, [0x0600_u16, kind, 0, 0].iter().flat_map(|n| n.to_le_bytes()).collect());
    let end = || (0x000a, Vec::new());
    let start = (4 + 8) + (4 + 10) + 4;
    let name = [&(start as u32).to_le_bytes()[..], &[0, 0, 2, 0, b'S', b'1']].concat();
    let [top, bottom, left, right] = extent;
    let claimed = [
        &top.to_le_bytes()[..],
        &bottom.to_le_bytes(),
        &(left as u16).to_le_bytes(),
        &(right as u16).to_le_bytes(),
        &[0; 2],
    ];
    let mut records: Vec<(u16, Vec<u8>)> =
        vec![begin(5), (0x0085, name), end(), begin(16), (0x0200, claimed.concat())];
    for [row, column] in cells {
        let cell = [&row.to_le_bytes()[..], &column.to_le_bytes(), &[0; 2], &2.5_f64.to_le_bytes()];
        records.push((0x0203, cell.concat()));
    }
    records.push(end());
    compound(&records)
}

#[test]
fn compound_files_claim_no_more_than_they_hold() {
    assert_eq!(sheets(workbook([0, 2, 0, 1], &[[0, 0], [1, 0]]), None).unwrap()[0].text, "2.5\n2.5\n");
    let problem_of = |extent, cells: &[[u16; 2]]| problem(workbook(extent, cells));
    assert!(problem_of([0, u32::MAX, 0, 256], &[[0, 0]]).contains("which it cannot hold"));
    assert_eq!(problem_of([5, 2, 0, 1], &[[0, 0]]), "it is damaged or cut off");
    assert!(problem_of([0, 2, 0, 1], &[[0, 0], [65_535, 255]]).contains("which it cannot hold"));
    // Sectors that follow each other in a circle.
    let mut circle = workbook([0, 2, 0, 1], &[[0, 0]]);
    circle[512 + 4..512 + 8].copy_from_slice(&1_u32.to_le_bytes());
    assert_eq!(problem(circle), "it is damaged or cut off");
    let mut encrypted = workbook([0, 2, 0, 1], &[[0, 0]]);
    encrypted.extend("EncryptedPackage".encode_utf16().flat_map(u16::to_le_bytes));
    assert_eq!(problem(encrypted), "it is encrypted: save it without a password");
    // The library reads names up to a zero, with a mark of the order of bytes, and of entries of any type.
    let entry = 512 + 512 + 128;
    let name = |mark: &str, order: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("{mark}Workbook\0").encode_utf16().flat_map(order).collect()
    };
    let utf8 = [b"\xef\xbb\xbfWorkbook\0\0\0\0", &[0; 20][..]].concat();
    let names = [
        name("", u16::to_le_bytes),
        name("\u{feff}", u16::to_le_bytes),
        name("\u{feff}", u16::to_be_bytes),
        utf8,
    ];
    for name in names {
        for kind in [1, 2, 5] {
            let mut named = workbook([0, u32::MAX, 0, 256], &[[0, 0]]);
            named[entry..entry + name.len()].copy_from_slice(&name);
            (named[entry + 40], named[entry + 66]) = (0xff, kind);
            assert!(problem(named).contains("which it cannot hold"), "{name:?} {kind}");
        }
    }
    let whole = workbook([0, 2, 0, 1], &[[0, 0], [1, 0]]);
    for end in (0..whole.len()).step_by(61) {
        let _ = sheets(whole[..end].to_vec(), None);
    }
}
