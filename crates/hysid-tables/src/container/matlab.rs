//! Variables of a MATLAB file as text: a header with their names, and a line for each row.

mod version_5;

use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use hysid_core::words::{Hint, Words};

use super::budget::Budget;
use crate::number::shortest;

/// Longest nesting of structures that is looked into.
const DEEPEST: usize = 4;

/// True for the beginning of a file that MATLAB wrote.
pub fn is_one(first: &[u8]) -> bool {
    first.starts_with(b"MATLAB 5.0 MAT-file") || first.starts_with(b"MATLAB 7.3 MAT-file") || is_hdf5(first)
}

fn is_hdf5(first: &[u8]) -> bool {
    let signature = b"\x89HDF\r\n\x1a\n";
    first.starts_with(signature) || first.get(512..520) == Some(signature)
}

/// A numeric variable: its name and its columns.
struct MatVariable {
    name: String,
    columns: Vec<Vec<f64>>,
}

impl MatVariable {
    /// From values column by column; `None` for what is no column of a table.
    fn new(name: String, sizes: &[usize], values: Vec<f64>) -> Option<Self> {
        let [rows, columns] = sizes else { return None };
        let (rows, columns) = if *rows == 1 { (*columns, 1) } else { (*rows, *columns) };
        if rows < 2 || columns == 0 || values.len() != rows * columns {
            return None;
        }
        Some(Self { name, columns: values.chunks(rows).map(<[f64]>::to_vec).collect() })
    }

    fn rows(&self) -> usize {
        self.columns[0].len()
    }
}

/// The variables of a MATLAB file as text, and what kind of file it is. Without a choice, all numeric variables of the
/// most common length are the columns.
pub fn text(bytes: Vec<u8>, chosen: Option<String>) -> Result<(String, String), Words> {
    let budget = Budget::of(bytes.len());
    budget.run(move || text_within(budget, bytes, chosen.as_deref()))
}

fn text_within(budget: Budget, bytes: Vec<u8>, chosen: Option<&str>) -> Result<(String, String), Words> {
    let (mut variables, kind) = match is_hdf5(&bytes) {
        true => (of_hdf5(bytes, budget)?, "MATLAB file 7.3"),
        false => (version_5::variables(&bytes, budget)?, "MATLAB file 5"),
    };
    let names: Vec<String> = variables.iter().map(|variable| variable.name.clone()).collect();
    if let Some(chosen) = chosen {
        let inside = format!("{chosen}.");
        variables.retain(|variable| variable.name == chosen || variable.name.starts_with(&inside));
        if variables.is_empty() {
            return Err(format!(
                "there is no numeric variable \"{chosen}\" (variables: {})",
                names.join(", ")
            )
            .into());
        }
    }
    if variables.is_empty() {
        return Err("there is no numeric variable with more than one row (tables and timetables: save their columns as \
                    vectors, or write a CSV file with writetable)"
            .into());
    }
    let length = variables[0].rows();
    if let Some(other) = variables.iter().find(|variable| variable.rows() != length) {
        let words = format!(
            "its variables have different lengths, such as {length} of {} and {} of {}",
            variables[0].name,
            other.rows(),
            other.name
        );
        let choice = Words::from("choose one, or a structure, with ") + Hint::Option("sheet");
        return Err(Words::from(words).advised(choice + format!("; variables: {}", names.join(", "))));
    }
    Ok((lines(&variables), format!("{kind}, {}", names_of(&variables))))
}

fn names_of(variables: &[MatVariable]) -> String {
    match variables {
        [one] => format!("variable {}", one.name),
        several => format!("{} variables", several.len()),
    }
}

fn lines(variables: &[MatVariable]) -> String {
    let mut text = String::new();
    let columns: Vec<(String, &Vec<f64>)> = variables.iter().flat_map(columns_of).collect();
    for (place, (name, _)) in columns.iter().enumerate() {
        text.push_str(if place == 0 { "" } else { "\t" });
        text.push_str(name);
    }
    for row in 0..variables[0].rows() {
        text.push('\n');
        for (place, (_, values)) in columns.iter().enumerate() {
            text.push_str(if place == 0 { "" } else { "\t" });
            if values[row].is_finite() {
                text.push_str(&shortest(values[row]));
            }
        }
    }
    text.push('\n');
    text
}

/// The last part of a name is the column's; a matrix has numbered columns.
fn columns_of(variable: &MatVariable) -> Vec<(String, &Vec<f64>)> {
    let name = variable.name.rsplit('.').next().unwrap_or_default();
    match variable.columns.as_slice() {
        [one] => vec![(name.to_string(), one)],
        several => {
            several.iter().enumerate().map(|(k, values)| (format!("{name}_{}", k + 1), values)).collect()
        }
    }
}

const NUMBERS_PER_GROUP: u64 = 1000;

fn of_hdf5(bytes: Vec<u8>, budget: Budget) -> Result<Vec<MatVariable>, String> {
    let most = usize::try_from(8 * budget.numbers()).unwrap_or(usize::MAX);
    let options = OpenOptions::default().with_max_read_bytes(most);
    let file = Hdf5File::from_vec_with_options(bytes, options).map_err(words)?;
    let mut variables = Vec::new();
    let mut left = budget.numbers();
    collect_group("", &file.root_group().map_err(words)?, DEEPEST, &mut left, &mut variables)?;
    Ok(variables)
}

fn words(error: hdf5_reader::error::Error) -> String {
    error.to_string()
}

fn collect_group(
    path: &str,
    group: &Group,
    depth: usize,
    left: &mut u64,
    found: &mut Vec<MatVariable>,
) -> Result<(), String> {
    let (groups, datasets) = group.members().map_err(words)?;
    // Groups may lie in each other.
    *left = left.checked_sub(NUMBERS_PER_GROUP).ok_or("its groups go round in a circle, or are too many")?;
    for dataset in datasets {
        let size = dataset.shape().iter().fold(1_u64, |size, &length| size.saturating_mul(length));
        *left = left
            .checked_sub(size)
            .ok_or_else(|| format!("{path}{} claims more numbers than the file can hold", dataset.name()))?;
        if let Some(values) = numbers(&dataset)? {
            // MATLAB writes its columns as the rows of HDF5.
            let mut sizes: Vec<usize> = dataset.shape().iter().map(|&size| size as usize).collect();
            sizes.reverse();
            found.extend(MatVariable::new(format!("{path}{}", dataset.name()), &sizes, values));
        }
    }
    // What MATLAB needs for itself begins with a number sign.
    for inner in groups.into_iter().filter(|group| !group.name().starts_with('#') && depth > 0) {
        collect_group(&format!("{path}{}.", inner.name()), &inner, depth - 1, left, found)?;
    }
    Ok(())
}

/// The values of a dataset as numbers; `None` for what holds none.
fn numbers(dataset: &Dataset) -> Result<Option<Vec<f64>>, String> {
    macro_rules! read {
        ($type:ty) => {
            dataset.read_array::<$type>().map(|all| all.iter().map(|&value| value as f64).collect())
        };
    }
    let values: Result<Vec<f64>, _> = match *dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => read!(f32),
        Datatype::FloatingPoint { size: 8, .. } => read!(f64),
        Datatype::FixedPoint { size: 1, signed: true, .. } => read!(i8),
        Datatype::FixedPoint { size: 1, signed: false, .. } => read!(u8),
        Datatype::FixedPoint { size: 2, signed: true, .. } => read!(i16),
        Datatype::FixedPoint { size: 2, signed: false, .. } => read!(u16),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read!(i32),
        Datatype::FixedPoint { size: 4, signed: false, .. } => read!(u32),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read!(i64),
        Datatype::FixedPoint { size: 8, signed: false, .. } => read!(u64),
        _ => return Ok(None),
    };
    values.map(Some).map_err(words)
}
