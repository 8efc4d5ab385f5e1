//! MATLAB files of version 5, the default of MATLAB, as far as they have real numbers, in variables
//! and in structures. Source: "MAT-File Format", The MathWorks.
//!
//! A file is a header of 128 bytes and elements: type, size, data. A matrix is an element of elements: flags, sizes,
//! name, and the values, or the fields of a structure. A compressed element holds another.

use flate2::read::ZlibDecoder;

use super::super::budget::{Budget, DAMAGED, too_much};
use super::super::variables::Variable;
use super::DEEPEST;

const HEADER: usize = 128;

/// Types of elements.
const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

/// Classes of matrices.
const STRUCTURE: u32 = 2;
const CHARACTERS: u32 = 4;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;

/// A flag of matrices.
const COMPLEX: u32 = 1 << 11;

/// All numeric variables of a file.
pub fn variables(bytes: &[u8], budget: Budget) -> Result<Vec<Variable>, String> {
    let order = match bytes.get(126..HEADER) {
        Some(b"IM") => Order::Little,
        Some(b"MI") => Order::Big,
        _ => return Err(DAMAGED.into()),
    };
    let mut elements = MatElements { bytes: &bytes[HEADER..], order };
    let mut found = Vec::new();
    let (mut unpacked, mut left) = (0, budget.numbers());
    while let Some(element) = elements.next()? {
        if element.kind == COMPRESSED {
            let plain = budget.unpacked(ZlibDecoder::new(element.bytes))?;
            unpacked += plain.len() as u64;
            if unpacked > budget.bytes() {
                return Err(too_much());
            }
            let mut inner = MatElements { bytes: &plain, order };
            if let Some(element) = inner.next()? {
                collect(&element, order, None, DEEPEST, &mut left, &mut found)?;
            }
        } else {
            collect(&element, order, None, DEEPEST, &mut left, &mut found)?;
        }
    }
    Ok(found)
}

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy)]
enum Order {
    Little,
    Big,
}

impl Order {
    fn array<const N: usize>(self, bytes: &[u8]) -> [u8; N] {
        let mut array = [0; N];
        array.copy_from_slice(&bytes[..N]);
        if matches!(self, Self::Big) {
            array.reverse();
        }
        array
    }

    fn u32(self, bytes: &[u8]) -> u32 {
        u32::from_le_bytes(self.array(bytes))
    }
}

struct MatElement<'b> {
    kind: u32,
    bytes: &'b [u8],
}

struct MatElements<'b> {
    bytes: &'b [u8],
    order: Order,
}

impl<'b> MatElements<'b> {
    fn next(&mut self) -> Result<Option<MatElement<'b>>, String> {
        if self.bytes.is_empty() {
            return Ok(None);
        }
        let Some(tag) = self.bytes.get(..4) else { return Err(DAMAGED.into()) };
        let first = self.order.u32(tag);
        // A small element has its size in the upper half of its type, and its data in place of a size.
        let (kind, start, size, padded): (u32, usize, usize, usize) = match first >> 16 {
            0 => {
                let size = self.bytes.get(4..8).ok_or(DAMAGED)?;
                let size = self.order.u32(size) as usize;
                let padding = if first == COMPRESSED { 0 } else { size.wrapping_neg() % 8 };
                (first, 8, size, size.checked_add(padding).ok_or(DAMAGED)?)
            }
            size => (first & 0xffff, 4, size as usize, 4),
        };
        let end = start.checked_add(size).ok_or(DAMAGED)?;
        let bytes = self.bytes.get(start..end).ok_or(DAMAGED)?;
        // The last element may lack its padding.
        self.bytes = self.bytes.get(start.saturating_add(padded)..).unwrap_or_default();
        Ok(Some(MatElement { kind, bytes }))
    }

    fn required(&mut self) -> Result<MatElement<'b>, String> {
        self.next()?.ok_or_else(|| DAMAGED.into())
    }
}

/// Collects the numbers of a matrix, or of the fields of a structure. `field` is the name of a field, which has none
/// of its own.
fn collect(
    element: &MatElement<'_>,
    order: Order,
    field: Option<&str>,
    depth: usize,
    left: &mut u64,
    found: &mut Vec<Variable>,
) -> Result<(), String> {
    if element.kind != MATRIX || element.bytes.is_empty() {
        return Ok(());
    }
    let mut parts = MatElements { bytes: element.bytes, order };
    let flags = parts.required()?;
    if flags.bytes.len() < 4 {
        return Err(DAMAGED.into());
    }
    let flags = order.u32(flags.bytes);
    let class = flags & 0xff;
    let is_numeric = NUMBERS.contains(&class) && flags & COMPLEX == 0;
    if !(is_numeric || class == STRUCTURE && depth > 0) || class == CHARACTERS {
        return Ok(());
    }
    let sizes = parts.required()?;
    let sizes: Vec<usize> = sizes.bytes.chunks_exact(4).map(|size| order.u32(size) as usize).collect();
    let own = String::from_utf8_lossy(parts.required()?.bytes).into_owned();
    let name = field.map_or(own, String::from);
    if is_numeric {
        let stored = parts.required()?;
        let size = if stored.kind < 3 { 1 } else { 2 };
        let count = (stored.bytes.len() / size) as u64;
        *left = left.checked_sub(count).ok_or("it has more numbers than a file of its size should")?;
        let values = numbers(&stored, order)?;
        found.extend(Variable::new(name, &sizes, &values, false));
        return Ok(());
    }
    // An array of structures has no columns.
    if sizes.iter().any(|&size| size != 1) {
        return Ok(());
    }
    let length = parts.required()?;
    if length.bytes.len() < 4 {
        return Err(DAMAGED.into());
    }
    let length = (order.u32(length.bytes) as usize).max(1);
    for field in parts.required()?.bytes.chunks(length) {
        let end = field.iter().position(|&byte| byte == 0).unwrap_or(field.len());
        let inner = format!("{name}.{}", String::from_utf8_lossy(&field[..end]));
        collect(&parts.required()?, order, Some(&inner), depth - 1, left, found)?;
    }
    Ok(())
}

/// Numbers are stored in the smallest type that holds them.
fn numbers(element: &MatElement<'_>, order: Order) -> Result<Vec<f64>, String> {
    let of =
        |size: usize, number: &dyn Fn(&[u8]) -> f64| element.bytes.chunks_exact(size).map(number).collect();
    Ok(match element.kind {
        1 => of(1, &|bytes| f64::from(bytes[0] as i8)),
        2 => of(1, &|bytes| f64::from(bytes[0])),
        3 => of(2, &|bytes| f64::from(i16::from_le_bytes(order.array(bytes)))),
        4 => of(2, &|bytes| f64::from(u16::from_le_bytes(order.array(bytes)))),
        5 => of(4, &|bytes| f64::from(i32::from_le_bytes(order.array(bytes)))),
        6 => of(4, &|bytes| f64::from(order.u32(bytes))),
        7 => of(4, &|bytes| f64::from(f32::from_le_bytes(order.array(bytes)))),
        9 => of(8, &|bytes| f64::from_le_bytes(order.array(bytes))),
        12 => of(8, &|bytes| i64::from_le_bytes(order.array(bytes)) as f64),
        13 => of(8, &|bytes| u64::from_le_bytes(order.array(bytes)) as f64),
        _ => return Err(DAMAGED.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
        let mut all = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
        all.extend(bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    }

    fn matrix(class: u32, name: &str, rows: u32, rest: &[Vec<u8>]) -> Vec<u8> {
        let sizes = [rows.to_le_bytes(), 1_u32.to_le_bytes()].concat();
        let flags = [class.to_le_bytes(), [0; 4]].concat();
        let head = [element(6, &flags), element(5, &sizes), element(1, name.as_bytes())].concat();
        element(MATRIX, &[head, rest.concat()].concat())
    }

    /// A vector of numbers and a structure with one of small whole numbers.
    fn file() -> Vec<u8> {
        let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
        bytes.resize(HEADER - 4, b' ');
        bytes.extend([0, 1, b'I', b'M']);
        let values: Vec<u8> = [0.5, -1.5, 2.5].iter().flat_map(|value: &f64| value.to_le_bytes()).collect();
        bytes.extend(matrix(6, "x", 3, &[element(9, &values)]));
        let field = matrix(6, "", 3, &[element(1, &[1, 255, 3])]);
        // Length of names and the names, both in small elements.
        let length = [(4_u32 << 16 | 5).to_le_bytes(), 8_u32.to_le_bytes()].concat();
        bytes.extend(matrix(STRUCTURE, "data", 1, &[length, element(1, b"force\0\0\0"), field]));
        bytes
    }

    #[test]
    fn damaged_files_are_refused_and_nothing_else_happens() {
        let whole = file();
        for end in 0..whole.len() {
            let _ = variables(&whole[..end], Budget::of(whole.len()));
        }
        for place in 0..whole.len() {
            for byte in [0, 1, 15, 0x7f, 0xff] {
                let mut damaged = whole.clone();
                damaged[place] = byte;
                let _ = variables(&damaged, Budget::of(whole.len()));
            }
        }
        assert!(variables(&whole[..300], Budget::of(whole.len())).is_err());
    }
}
