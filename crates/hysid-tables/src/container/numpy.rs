//! Arrays of NumPy, `.npy`, and archives of them, `.npz`. Source: "NEP 1: A Simple File Format for NumPy Arrays".

use super::budget::{Budget, DAMAGED};
use super::variables::Variable;

const SIGNATURE: &[u8] = b"\x93NUMPY";

/// Longest description of an array, and most arrays of an archive.
const LONGEST_HEADER: usize = 1 << 16;
const MOST_ARRAYS: usize = 10_000;

/// True for the beginning of an array.
pub fn is_array(first: &[u8]) -> bool {
    first.starts_with(SIGNATURE)
}

/// True for the beginning of an archive of arrays.
pub fn is_archive(first: &[u8]) -> bool {
    let length = first.get(26..28).map_or(0, |bytes| usize::from(u16::from_le_bytes([bytes[0], bytes[1]])));
    first.starts_with(b"PK\x03\x04") && first.get(30..30 + length).is_some_and(|name| name.ends_with(b".npy"))
}

/// The arrays of a file, and its kind.
pub fn variables(bytes: &[u8], budget: Budget) -> Result<(Vec<Variable>, &'static str), String> {
    let mut left = budget.numbers();
    if is_array(bytes) {
        return Ok((array("array", bytes, &mut left)?, "NumPy array"));
    }
    let mut found = Vec::new();
    for (name, content) in budget.parts(bytes, MOST_ARRAYS, |_| Ok(true))? {
        if is_array(&content) {
            found.extend(array(name.trim_end_matches(".npy"), &content, &mut left)?);
        }
    }
    Ok((found, "NumPy archive"))
}

/// The numbers of an array: one variable, or one for each field of a structured array.
fn array(name: &str, bytes: &[u8], left: &mut u64) -> Result<Vec<Variable>, String> {
    let (start, length) = match (bytes.get(6), bytes.get(8..12)) {
        (Some(1), Some(size)) => (10, usize::from(u16::from_le_bytes([size[0], size[1]]))),
        (Some(2 | 3), Some(size)) => (12, u32::from_le_bytes([size[0], size[1], size[2], size[3]]) as usize),
        _ => return Err(DAMAGED.into()),
    };
    let header = bytes.get(start..start + length.min(LONGEST_HEADER)).ok_or(DAMAGED)?;
    let header = String::from_utf8_lossy(header);
    let data = bytes.get(start + length..).ok_or(DAMAGED)?;
    let behind = |key: &str| header.split_once(key).map(|(_, rest)| rest.trim_start_matches([':', ' ']));
    let described = behind("'descr'").ok_or(DAMAGED)?;
    let is_by_rows = behind("'fortran_order'").ok_or(DAMAGED)?.starts_with("False");
    let shape = behind("'shape'").and_then(|rest| rest.strip_prefix('(')?.split_once(')')).ok_or(DAMAGED)?.0;
    let sizes = shape.split(',').map(str::trim).filter(|size| !size.is_empty());
    let sizes: Vec<usize> = sizes.map(|size| size.parse().map_err(|_| DAMAGED)).collect::<Result<_, _>>()?;
    let fields = fields(described).ok_or(DAMAGED)?;
    let kinds: Vec<NumberKind> =
        fields.iter().map(|(_, kind)| NumberKind::of(kind)).collect::<Result<_, _>>()?;
    let row: usize = kinds.iter().map(|kind| kind.size).sum();
    let count = sizes.iter().try_fold(1_usize, |count, &size| count.checked_mul(size)).ok_or(DAMAGED)?;
    if count.checked_mul(row) != Some(data.len()) {
        return Err(format!("array {name} does not have the {count} values that it claims"));
    }
    let numbers = (count as u64).checked_mul(kinds.len() as u64);
    *left = numbers
        .and_then(|numbers| left.checked_sub(numbers))
        .ok_or("it has more numbers than a file of its size should")?;
    let mut place = 0;
    let mut found = Vec::new();
    for ((field, _), kind) in fields.iter().zip(&kinds) {
        let values: Vec<f64> = data.chunks_exact(row).map(|cells| kind.number(&cells[place..])).collect();
        place += kind.size;
        let name = if field.is_empty() { name.to_string() } else { format!("{name}.{field}") };
        found.extend(Variable::new(name, &sizes, &values, is_by_rows));
    }
    Ok(found)
}

/// Names and types of the fields; one without a name for an array of plain numbers.
fn fields(described: &str) -> Option<Vec<(String, String)>> {
    let Some(list) = described.strip_prefix('[') else {
        let kind = described.strip_prefix('\'')?.split_once('\'')?.0;
        return Some(vec![(String::new(), kind.to_string())]);
    };
    let quoted: Vec<&str> = list.split_once(']')?.0.split('\'').skip(1).step_by(2).collect();
    let pairs = quoted.chunks_exact(2).map(|pair| (pair[0].to_string(), pair[1].to_string()));
    (!quoted.is_empty() && quoted.len().is_multiple_of(2)).then(|| pairs.collect())
}

/// Type of a number: its letter, its bytes, and their order.
struct NumberKind {
    letter: char,
    size: usize,
    is_big: bool,
}

impl NumberKind {
    fn of(text: &str) -> Result<Self, String> {
        let plain = text.trim_start_matches(['<', '>', '|', '=']);
        let letter = plain.chars().next().unwrap_or_default();
        let size = plain.get(letter.len_utf8()..).and_then(|size| size.parse().ok()).unwrap_or(0);
        match (letter, size) {
            ('f', 4 | 8) | ('i' | 'u', 1 | 2 | 4 | 8) | ('b', 1) => {
                Ok(Self { letter, size, is_big: text.starts_with('>') })
            }
            _ => Err(format!("it has values of type {text:.20}: save numbers, such as with astype(float)")),
        }
    }

    fn number(&self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        word[..self.size].copy_from_slice(&bytes[..self.size]);
        if self.is_big {
            word[..self.size].reverse();
        }
        let whole = u64::from_le_bytes(word);
        let unused = 64 - 8 * self.size as u32;
        match (self.letter, self.size) {
            ('f', 4) => f64::from(f32::from_bits(whole as u32)),
            ('f', _) => f64::from_bits(whole),
            ('i', _) => (((whole << unused) as i64) >> unused) as f64,
            _ => whole as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(description: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{{description}, }}\n");
        let length = (header.len() as u16).to_le_bytes();
        [SIGNATURE, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    fn text(bytes: &[u8]) -> String {
        let (variables, _) = variables(bytes, Budget::of(bytes.len())).unwrap();
        super::super::variables::sheets(variables, None).unwrap()[0].text.replace('\t', " ")
    }

    #[test]
    fn arrays_of_any_type_and_order_are_read() {
        let floats: Vec<u8> = [0.5, -1.5, 2.5, 3.0].iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
        let by_rows = "'descr': '<f8', 'fortran_order': False, 'shape': (2, 2)";
        assert_eq!(text(&file(by_rows, &floats)), "0.5 -1.5\n2.5 3\n");
        let by_columns = by_rows.replace("False", "True");
        assert_eq!(text(&file(&by_columns, &floats)), "0.5 2.5\n-1.5 3\n");
        let big = "'descr': '>i2', 'fortran_order': False, 'shape': (3,)";
        assert_eq!(text(&file(big, &[255, 254, 0, 3, 1, 0])), "array\n-2\n3\n256\n");
        let fields = "'descr': [('x', '<i1'), ('y', '|u1')], 'fortran_order': False, 'shape': (2,)";
        assert_eq!(text(&file(fields, &[255, 255, 2, 3])), "x y\n-1 255\n2 3\n");
    }

    #[test]
    fn damaged_arrays_are_refused_and_nothing_else_happens() {
        let whole = file("'descr': '<f8', 'fortran_order': False, 'shape': (2, 2)", &[0; 32]);
        let budget = Budget::of(whole.len());
        for place in 0..whole.len() {
            let _ = variables(&whole[..place], budget);
            for byte in [0, b'(', b'9', b'\'', 0xff] {
                let mut damaged = whole.clone();
                damaged[place] = byte;
                let _ = variables(&damaged, budget);
            }
        }
        let claims =
            file("'descr': '<f8', 'fortran_order': False, 'shape': (9999999999, 9999999999)", &[0; 32]);
        assert!(variables(&claims, budget).is_err());
        assert!(
            variables(&file("'descr': '|O', 'fortran_order': False, 'shape': (1,)", &[0; 8]), budget)
                .is_err()
        );
    }
}
