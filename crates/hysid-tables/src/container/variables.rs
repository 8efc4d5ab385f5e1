//! Numeric variables of a file as tables: vectors of equal length are the columns of one.

use hysid_core::words::{Hint, Words};
use hysid_document::visible::{clipped, listed};

use super::TextSheet;
use crate::number::shortest;

/// Rows of a matrix that are columns if the matrix is wider than that.
const MOST_LYING: usize = 20;

/// A numeric variable: its name and its columns.
#[derive(Debug)]
pub struct Variable {
    name: String,
    columns: Vec<Vec<f64>>,
}

impl Variable {
    /// From values row by row or column by column; `None` for what is no column of a table. A wide matrix of few rows lies:
    /// its rows are the columns.
    pub fn new(name: String, sizes: &[usize], values: &[f64], is_by_rows: bool) -> Option<Self> {
        let (mut rows, mut columns) = match *sizes {
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => return None,
        };
        let mut is_by_rows = is_by_rows;
        if rows == 1 || is_lying(rows, columns) {
            (rows, columns, is_by_rows) = (columns, rows, !is_by_rows);
        }
        if rows < 2 || columns == 0 || rows.checked_mul(columns) != Some(values.len()) {
            return None;
        }
        let column = |place: usize| match is_by_rows {
            true => values[place..].iter().step_by(columns).copied().collect(),
            false => values[place * rows..(place + 1) * rows].to_vec(),
        };
        Some(Self { name, columns: (0..columns).map(column).collect() })
    }

    fn rows(&self) -> usize {
        self.columns[0].len()
    }

    /// The structure that holds it; empty outside of one.
    fn structure(&self) -> &str {
        self.name.rsplit_once('.').map_or("", |(structure, _)| structure)
    }

    /// The last part of the name is the column's; a matrix has numbered columns, and none if it is alone.
    fn named_columns(&self) -> Vec<(String, &Vec<f64>)> {
        let name = self.name.rsplit('.').next().unwrap_or_default();
        match self.columns.as_slice() {
            [one] => vec![(name.to_string(), one)],
            several => {
                several.iter().enumerate().map(|(k, values)| (format!("{name}_{}", k + 1), values)).collect()
            }
        }
    }
}

/// True for a table whose rows are its columns.
pub fn is_lying(rows: usize, columns: usize) -> bool {
    (2..=MOST_LYING).contains(&rows) && columns > MOST_LYING
}

/// The tables of these variables. A choice names a variable or a structure.
pub fn sheets(mut variables: Vec<Variable>, chosen: Option<&str>) -> Result<Vec<TextSheet>, Words> {
    let names: Vec<String> = variables.iter().map(|variable| variable.name.clone()).collect();
    if let Some(chosen) = chosen {
        let inside = format!("{chosen}.");
        variables.retain(|variable| variable.name == chosen || variable.name.starts_with(&inside));
        if variables.is_empty() {
            let words = format!("there is no numeric variable \"{}\"", clipped(chosen));
            return Err(Words::from(words).advised(format!("variables: {}", listed(&names))));
        }
    }
    let mut groups: Vec<Vec<&Variable>> = Vec::new();
    let is_one =
        variables.iter().all(|variable| variable.rows() == variables[0].rows()) && !are_alike(&variables);
    for variable in &variables {
        let belongs = |group: &&mut Vec<&Variable>| {
            is_one || group[0].structure() == variable.structure() && group[0].rows() == variable.rows()
        };
        match groups.iter_mut().find(belongs) {
            Some(group) => group.push(variable),
            None => groups.push(vec![variable]),
        }
    }
    let columns = |group: &Vec<&Variable>| group.iter().map(|variable| variable.columns.len()).sum::<usize>();
    if groups.len() > 1 && groups.iter().all(|group| columns(group) < 2) {
        let lengths: Vec<String> =
            variables.iter().map(|variable| format!("{} of {}", variable.rows(), variable.name)).collect();
        let choice = Words::from("save columns of equal length, or choose a matrix or a structure with ");
        let words = Words::from(format!("its variables have different lengths: {}", listed(&lengths)));
        return Err(words.advised(choice + Hint::Option("sheet")));
    }
    Ok(groups.iter().map(|group| sheet(group)).collect())
}

/// True for several structures with the same fields: records.
fn are_alike(variables: &[Variable]) -> bool {
    let fields = |structure: &str| -> Vec<&str> {
        let within = variables.iter().filter(|variable| variable.structure() == structure);
        within.map(|variable| &variable.name[structure.len()..]).collect()
    };
    let Some(first) = variables.first() else { return false };
    let expected = fields(first.structure());
    expected.len() > 1
        && expected.len() < variables.len()
        && variables.iter().all(|variable| fields(variable.structure()) == expected)
}

fn sheet(variables: &[&Variable]) -> TextSheet {
    let structure = variables[0].structure();
    let is_whole = variables.iter().all(|variable| variable.structure() == structure);
    let (name, described) = match variables {
        [one] => (one.name.clone(), format!("variable {}", clipped(&one.name))),
        several if is_whole && !structure.is_empty() => {
            (structure.to_string(), format!("{} variables of {}", several.len(), clipped(structure)))
        }
        several => {
            let names: Vec<&String> = several.iter().map(|variable| &variable.name).collect();
            (listed(&names), format!("{} variables", several.len()))
        }
    };
    TextSheet { name, described, text: lines(variables) }
}

fn lines(variables: &[&Variable]) -> String {
    let mut text = String::new();
    let columns: Vec<(String, &Vec<f64>)> =
        variables.iter().flat_map(|variable| variable.named_columns()).collect();
    let is_named = variables.len() > 1 || columns.len() == 1;
    if is_named {
        let names = columns.iter().map(|(name, _)| name.replace(['\t', '\n', '\r', '"'], " "));
        text.push_str(&names.collect::<Vec<_>>().join("\t"));
        text.push('\n');
    }
    for row in 0..variables[0].rows() {
        for (place, (_, values)) in columns.iter().enumerate() {
            text.push_str(if place == 0 { "" } else { "\t" });
            if values[row].is_finite() {
                text.push_str(&shortest(values[row]));
            }
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(name: &str, rows: usize) -> Variable {
        let values: Vec<f64> = (0..rows).map(|row| row as f64).collect();
        Variable::new(name.into(), &[rows], &values, true).unwrap()
    }

    fn names(variables: Vec<Variable>) -> Vec<(String, String)> {
        let sheets = sheets(variables, None).unwrap();
        let header = |text: &str| text.lines().next().unwrap().replace('\t', " ");
        sheets.iter().map(|sheet| (sheet.name.clone(), header(&sheet.text))).collect()
    }

    #[test]
    fn a_lying_matrix_stands_up_whatever_its_order() {
        let by_rows: Vec<f64> =
            (0..3).flat_map(|k| (0..30).map(move |row| f64::from(100 * k + row))).collect();
        let by_columns: Vec<f64> =
            (0..30).flat_map(|row| (0..3).map(move |k| f64::from(100 * k + row))).collect();
        for (values, is_by_rows) in [(&by_rows, true), (&by_columns, false)] {
            let matrix = Variable::new("m".into(), &[3, 30], values, is_by_rows).unwrap();
            assert_eq!((matrix.columns.len(), matrix.rows()), (3, 30));
            assert_eq!((matrix.columns[2][0], matrix.columns[1][29]), (200.0, 129.0));
        }
        let standing = Variable::new("m".into(), &[30, 3], &by_columns, true).unwrap();
        assert_eq!(standing.columns[2][0], 200.0);
        assert!(Variable::new("m".into(), &[usize::MAX, 2], &by_rows, true).is_none());
    }

    #[test]
    fn vectors_of_equal_length_are_a_table() {
        let text = |name: &str, header: &str| (name.to_string(), header.to_string());
        assert_eq!(names(vec![vector("t", 5), vector("x", 5)]), [text("t, x", "t x")]);
        let mixed = vec![vector("data.t", 50), vector("calibration", 4), vector("data.x", 50)];
        assert_eq!(names(mixed), [text("data", "t x"), text("calibration", "calibration")]);
        let tests = ["a.x", "a.y", "b.x", "b.y"].map(|name| vector(name, 9)).into_iter().collect();
        assert_eq!(names(tests), [text("a", "x y"), text("b", "x y")]);
        let problem = sheets(vec![vector("t", 5), vector("x", 6)], None).unwrap_err();
        assert!(problem.helps());
    }
}
