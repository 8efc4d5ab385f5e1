//! A compound file with a workbook (`.xls`), checked before a library reads it: chains of sectors that end, and sheets that
//! span no more cells than their records fill. Sources: \[MS-CFB\], \[MS-XLS\].

use std::collections::BTreeSet;

use super::super::budget::{Budget, DAMAGED, too_much};
use super::archive::CellArea;

/// Bytes of the header, which has 109 places of the table of sectors.
const HEADER: usize = 512;
const FIRST_TABLES: usize = 109;

/// Above these, numbers of sectors have other meanings.
const LAST_SECTOR: u32 = 0xffff_fffa;
const END: u32 = 0xffff_fffe;

/// Bytes of an entry of the directory.
const ENTRY: usize = 128;

const MOST_SHEETS: usize = 256;

/// Rejects a file that declares more than it holds.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let file = Compound::of(bytes)?;
    let directory = file.chain(file.number(48)?)?;
    let entries: Vec<&[u8]> = directory.chunks_exact(ENTRY).collect();
    let root = entries.first().ok_or(DAMAGED)?;
    let (start, length) = (number(root, 116)?, number(root, 120)?);
    let small = if length == 0 { Vec::new() } else { file.chain(start)? };
    let small_table = match file.number(64)? {
        0 => Vec::new(),
        _ => file.chain(file.number(60)?)?,
    };
    for entry in &entries {
        let (start, low, high) = (number(entry, 116)?, number(entry, 120)?, number(entry, 124)?);
        let is_long = file.sector > 512 && high > 0;
        let length = low as usize;
        if is_long || length > bytes.len() {
            return Err(DAMAGED.into());
        }
        let may_be_read = may_be_workbook(&entry[..64]);
        // Of all streams only one is needed, and the library may read any.
        if !may_be_read && !matches!(entry.get(66), Some(2)) {
            continue;
        }
        let mut stream = match length {
            0 => Vec::new(),
            1..4096 => small_chain(start, &small_table, &small)?,
            _ => file.chain(start)?,
        };
        if length > stream.len() {
            return Err(DAMAGED.into());
        }
        stream.truncate(length);
        if may_be_read {
            check_workbook(&stream, Budget::of(bytes.len()))?;
        }
    }
    Ok(())
}

/// True for names of the stream with the sheets, `Workbook` or `Book`, however the library reads the letters: with a mark of
/// the order of bytes, up to a zero, of an entry of any type.
fn may_be_workbook(name: &[u8]) -> bool {
    let letters: Vec<u8> =
        name.iter().filter(|byte| byte.is_ascii_alphabetic()).map(u8::to_ascii_lowercase).collect();
    letters.windows(4).any(|part| part == b"book")
}

fn number(bytes: &[u8], place: usize) -> Result<u32, String> {
    let four = bytes.get(place..place + 4).ok_or(DAMAGED)?;
    Ok(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

fn short(bytes: &[u8], place: usize) -> Option<u16> {
    Some(u16::from_le_bytes([*bytes.get(place)?, *bytes.get(place + 1)?]))
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

/// A file of sectors, and the sector that follows each.
struct Compound<'b> {
    bytes: &'b [u8],
    sector: usize,
    next: Vec<u32>,
}

impl<'b> Compound<'b> {
    fn of(bytes: &'b [u8]) -> Result<Self, String> {
        let sector = match short(bytes, 30) {
            Some(9) => 512,
            Some(12) => 4096,
            _ => return Err(DAMAGED.into()),
        };
        let mut file = Self { bytes, sector, next: Vec::new() };
        let mut tables: Vec<u32> =
            numbers(bytes.get(76..HEADER).ok_or(DAMAGED)?).take(FIRST_TABLES).collect();
        let mut more = file.number(68)?;
        let mut seen = BTreeSet::new();
        while more <= LAST_SECTOR {
            if !seen.insert(more) {
                return Err(DAMAGED.into());
            }
            let mut further: Vec<u32> = numbers(file.sector(more)?).collect();
            more = further.pop().unwrap_or(END);
            tables.extend(further);
        }
        let mut used = BTreeSet::new();
        for table in tables.into_iter().filter(|&table| table <= LAST_SECTOR) {
            if !used.insert(table) {
                return Err(DAMAGED.into());
            }
            let numbers: Vec<u32> = numbers(file.sector(table)?).collect();
            file.next.extend(numbers);
        }
        Ok(file)
    }

    fn number(&self, place: usize) -> Result<u32, String> {
        number(self.bytes, place)
    }

    /// A sector; the last may be cut off.
    fn sector(&self, place: u32) -> Result<&'b [u8], String> {
        let start = (place as usize + 1) * self.sector;
        let end = (start + self.sector).min(self.bytes.len());
        self.bytes.get(start..end).filter(|bytes| !bytes.is_empty()).ok_or_else(|| DAMAGED.into())
    }

    /// The content of sectors that follow each other.
    fn chain(&self, mut place: u32) -> Result<Vec<u8>, String> {
        let mut content = Vec::new();
        while place != END {
            content.extend_from_slice(self.sector(place)?);
            if content.len() > self.bytes.len() {
                return Err(DAMAGED.into());
            }
            place = *self.next.get(place as usize).ok_or(DAMAGED)?;
        }
        Ok(content)
    }
}

fn small_chain(mut place: u32, table: &[u8], stream: &[u8]) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    while place != END {
        let start = place as usize * 64;
        content.extend_from_slice(stream.get(start..start + 64).ok_or(DAMAGED)?);
        if content.len() > stream.len() {
            return Err(DAMAGED.into());
        }
        place = number(table, 4 * place as usize)?;
    }
    Ok(content)
}

/// Records: kind and content, until one is cut off.
fn records(stream: &[u8]) -> impl Iterator<Item = (u16, &[u8])> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (kind, length) = (short(rest, 0)?, usize::from(short(rest, 2)?));
        let content = rest.get(4..4 + length)?;
        rest = &rest[4 + length..];
        Some((kind, content))
    })
}

fn check_workbook(stream: &[u8], budget: Budget) -> Result<(), String> {
    let mut sheets = Vec::new();
    let mut strings: Vec<u64> = Vec::new();
    let mut is_of_strings = false;
    for (kind, content) in records(stream) {
        match kind {
            0x0085 => sheets.push(number(content, 0)? as usize),
            0x00fc => strings.push(content.len() as u64),
            0x003c if is_of_strings => strings.push(content.len() as u64),
            // The end of the globals.
            0x000a => break,
            _ => {}
        }
        is_of_strings = matches!((kind, is_of_strings), (0x00fc, _) | (0x003c, true));
    }
    if sheets.len() > MOST_SHEETS {
        return Err(format!("it has more than {MOST_SHEETS} sheets"));
    }
    // A text has at most 32,767 letters, and no more than the list of all.
    let longest = strings.iter().sum::<u64>().min(3 * 32_767);
    let (mut cells, mut texts) = (0_u64, 0_u64);
    for start in sheets {
        let of_sheet = check_sheet(stream.get(start..).ok_or(DAMAGED)?, budget)?;
        cells = cells.saturating_add(of_sheet.0);
        texts = texts.saturating_add(of_sheet.1);
    }
    if cells > budget.cells() {
        return Err(format!("its sheets span more than {} cells, which it cannot hold", budget.cells()));
    }
    if texts.saturating_mul(longest) > budget.bytes().saturating_mul(16) {
        return Err(too_much());
    }
    Ok(())
}

/// Cells that a sheet spans, and cells with a text of the list.
fn check_sheet(stream: &[u8], budget: Budget) -> Result<(u64, u64), String> {
    let mut within = CellArea::default();
    let (mut texts, mut claimed) = (0, 0_u64);
    let mut depth = 0_usize;
    for (kind, content) in records(stream) {
        match kind {
            0x0809 => depth += 1,
            0x000a => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    break;
                }
            }
            // The extent as the file claims it: rows and columns, the last one more than used.
            0x0200 => {
                let (top, bottom, left, right) = match content.len() {
                    10.. if content.len() >= 14 => (
                        number(content, 0)?,
                        number(content, 4)?,
                        short(content, 8).unwrap_or(0),
                        short(content, 10).unwrap_or(0),
                    ),
                    10.. => (
                        short(content, 0).unwrap_or(0).into(),
                        short(content, 2).unwrap_or(0).into(),
                        short(content, 4).unwrap_or(0),
                        short(content, 6).unwrap_or(0),
                    ),
                    _ => return Err(DAMAGED.into()),
                };
                let is_empty = top == bottom && left == right;
                if !is_empty && (bottom <= top || right <= left) {
                    return Err(DAMAGED.into());
                }
                let rows = u64::from(bottom - top);
                claimed = claimed.saturating_add(rows.saturating_mul(u64::from(right - left)));
                if claimed > budget.cells() {
                    return Err(format!("it claims {claimed} cells, which it cannot hold"));
                }
            }
            0x0203 | 0x0204 | 0x00d6 | 0x0205 | 0x027e | 0x00fd | 0x0006 | 0x00bd => {
                let (Some(row), Some(column)) = (short(content, 0), short(content, 2)) else {
                    return Err(DAMAGED.into());
                };
                within.add(u64::from(row) + 1, u64::from(column) + 1)?;
                if kind == 0x00bd {
                    let last = short(content, content.len().saturating_sub(2)).ok_or(DAMAGED)?;
                    within.add(u64::from(row) + 1, u64::from(last) + 1)?;
                }
                texts += u64::from(kind == 0x00fd);
            }
            _ => {}
        }
    }
    Ok((within.area(), texts))
}
