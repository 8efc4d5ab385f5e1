//! Numbers of a JSON file: columns by name, rows with names, rows of numbers, or the forms of pandas, in any object.

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use super::budget::Budget;
use super::variables::Variable;

/// Longest nesting of objects that is looked into.
const DEEPEST: usize = 4;

/// True for the content of a file that begins like JSON.
pub fn is_json(first: &[u8]) -> bool {
    let first = first.strip_prefix(b"\xef\xbb\xbf").unwrap_or(first).trim_ascii_start();
    let inside = || first[1..].trim_ascii_start();
    first.starts_with(b"{") && matches!(inside().first(), Some(b'"' | b'}') | None)
        || first.starts_with(b"[") && matches!(inside().first(), Some(b'{' | b'['))
}

/// The numeric variables of a file.
pub fn variables(bytes: &[u8], budget: Budget) -> Result<Vec<Variable>, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not UTF-8 text")?.trim_start_matches('\u{feff}');
    // Python writes NaN, which is no JSON.
    let value = serde_json::from_str::<Value>(text)
        .or_else(|error| serde_json::from_str(&text.replace("NaN", "null")).map_err(|_| error));
    let value = value.map_err(|error| error.to_string())?;
    let mut search = Search { left: budget.numbers(), found: Vec::new() };
    search.collect("", &value, DEEPEST)?;
    Ok(search.found)
}

/// A value; objects keep their order.
enum Value {
    Number(f64),
    Text(String),
    /// A truth or nothing.
    Other,
    Array(Vec<Value>),
    Object(Vec<(String, Value)>),
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_bool<E>(self, _: bool) -> Result<Value, E> {
        Ok(Value::Other)
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_string()))
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Other)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Value, A::Error> {
        let mut all = Vec::new();
        while let Some(value) = values.next_element()? {
            all.push(value);
        }
        Ok(Value::Array(all))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Value, A::Error> {
        let mut all = Vec::new();
        while let Some(field) = fields.next_entry()? {
            all.push(field);
        }
        Ok(Value::Object(all))
    }
}

impl Value {
    /// The number; NaN for what is none.
    fn number(&self) -> f64 {
        if let Self::Number(number) = self { *number } else { f64::NAN }
    }
}

struct Search {
    /// How many numbers may follow.
    left: u64,
    found: Vec<Variable>,
}

impl Search {
    fn collect(&mut self, name: &str, value: &Value, depth: usize) -> Result<(), String> {
        let inner = |field: &str| match name {
            "" => field.to_string(),
            _ => format!("{name}.{field}"),
        };
        match value {
            Value::Array(rows) if matches!(rows.first(), Some(Value::Object(_))) => {
                for field in fields(rows) {
                    let cell = |row: &Value| match row {
                        Value::Object(cells) => {
                            let found = cells.iter().find(|(name, _)| *name == field);
                            found.map_or(f64::NAN, |(_, value)| value.number())
                        }
                        _ => f64::NAN,
                    };
                    self.add(inner(&field), 1, rows.iter().map(cell).collect())?;
                }
            }
            Value::Array(rows) if matches!(rows.first(), Some(Value::Array(_))) => {
                let width = |row: &Value| if let Value::Array(cells) = row { cells.len() } else { 0 };
                let columns = width(&rows[0]);
                if rows.iter().any(|row| width(row) != columns) {
                    return Err("its rows have different lengths".into());
                }
                let cells = rows.iter().flat_map(|row| match row {
                    Value::Array(cells) => cells.as_slice(),
                    _ => &[],
                });
                let name = if name.is_empty() { "array" } else { name };
                self.add(name.to_string(), columns, cells.map(Value::number).collect())?;
            }
            Value::Array(values) => {
                self.add(name.to_string(), 1, values.iter().map(Value::number).collect())?;
            }
            // A column of pandas is an object with a number for each row.
            Value::Object(cells)
                if cells.iter().enumerate().all(|(row, (key, value))| {
                    *key == row.to_string() && matches!(value, Value::Number(_) | Value::Other)
                }) =>
            {
                self.add(name.to_string(), 1, cells.iter().map(|(_, value)| value.number()).collect())?;
            }
            Value::Object(values) if depth > 0 => {
                let field =
                    |name: &str| values.iter().find(|(field, _)| field == name).map(|(_, value)| value);
                // The form `split` of pandas has the names of a matrix beside it.
                if let (Some(Value::Array(names)), Some(Value::Array(rows))) =
                    (field("columns"), field("data"))
                    && names.iter().all(|name| matches!(name, Value::Text(_)))
                {
                    return self.named(name, names, rows);
                }
                for (field, value) in values {
                    self.collect(&inner(field), value, depth - 1)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds the columns of rows whose names are known.
    fn named(&mut self, path: &str, names: &[Value], rows: &[Value]) -> Result<(), String> {
        for (place, name) in names.iter().enumerate() {
            let cell = |row: &Value| match row {
                Value::Array(cells) => cells.get(place).map_or(f64::NAN, Value::number),
                _ => f64::NAN,
            };
            let Value::Text(name) = name else { continue };
            let name = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            self.add(name, 1, rows.iter().map(cell).collect())?;
        }
        Ok(())
    }

    /// Adds a variable if it has numbers.
    fn add(&mut self, name: String, columns: usize, values: Vec<f64>) -> Result<(), String> {
        self.left = self.left.checked_sub(values.len() as u64).ok_or("it has too many numbers")?;
        if columns > 0 && values.iter().any(|value| value.is_finite()) {
            let sizes = [values.len() / columns, columns];
            self.found.extend(Variable::new(name, &sizes, &values, true));
        }
        Ok(())
    }
}

/// Names of the fields of all rows, in the order in which they come.
fn fields(rows: &[Value]) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let objects =
        rows.iter().filter_map(|row| if let Value::Object(cells) = row { Some(cells) } else { None });
    let names = objects.flatten().map(|(name, _)| name);
    names.filter(|name| seen.insert(name.as_str().to_string())).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(json: &str) -> String {
        let variables = variables(json.as_bytes(), Budget::of(json.len())).unwrap();
        super::super::variables::sheets(variables, None).unwrap()[0].text.replace('\t', " ")
    }

    #[test]
    fn columns_and_rows_are_read_in_their_order() {
        let expected = "t x\n0 1.5\n1 -2\n2 \n";
        for json in [
            r#"{"t": [0, 1, 2], "x": [1.5, -2, NaN], "operator": "N. N."}"#,
            r#"{"data": {"t": [0, 1, 2], "x": [1.5, -2, null]}, "gain": 3}"#,
            r#"[{"t": 0, "x": 1.5}, {"t": 1, "x": -2}, {"t": 2}]"#,
            r#"{"columns": ["t", "x"], "index": [0, 1, 2], "data": [[0, 1.5], [1, -2], [2, null]]}"#,
            r#"{"t": {"0": 0, "1": 1, "2": 2}, "x": {"0": 1.5, "1": -2, "2": null}}"#,
        ] {
            assert!(is_json(json.as_bytes()));
            assert_eq!(text(json), expected, "{json}");
        }
        assert_eq!(text("[[0, 1.5], [1, -2]]"), "0 1.5\n1 -2\n");
    }

    #[test]
    fn other_json_is_refused() {
        for json in ["{", "[[1, 2], [3]]", &"[".repeat(100_000)] {
            assert!(variables(json.as_bytes(), Budget::of(json.len())).is_err());
        }
        assert!(variables(b"{\"a\": 1}", Budget::of(8)).unwrap().is_empty());
        assert!(!is_json(b"[mm],[kN]") && !is_json(b"[Header]") && !is_json(b"{x},{y}"));
    }
}
