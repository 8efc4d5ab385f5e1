//! Numeric variables of a MATLAB file, or of an HDF5 file of another program.

mod version_5;

use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use super::budget::Budget;
use super::variables::Variable;

/// Longest nesting of structures that is looked into.
const DEEPEST: usize = 4;

/// True for the beginning of a MATLAB or HDF5 file.
pub fn is_one(first: &[u8]) -> bool {
    first.starts_with(b"MATLAB 5.0 MAT-file") || first.starts_with(b"MATLAB 7.3 MAT-file") || is_hdf5(first)
}

fn is_hdf5(first: &[u8]) -> bool {
    let signature = b"\x89HDF\r\n\x1a\n";
    first.starts_with(signature) || first.get(512..520) == Some(signature)
}

/// The numeric variables of the file, and its kind.
pub fn variables(bytes: Vec<u8>, budget: Budget) -> Result<(Vec<Variable>, &'static str), String> {
    Ok(match is_hdf5(&bytes) {
        true if bytes.starts_with(b"MATLAB") => (of_hdf5(bytes, budget, true)?, "MATLAB file 7.3"),
        true => (of_hdf5(bytes, budget, false)?, "HDF5 file"),
        false => (version_5::variables(&bytes, budget)?, "MATLAB file 5"),
    })
}

const NUMBERS_PER_GROUP: u64 = 1000;

fn of_hdf5(bytes: Vec<u8>, budget: Budget, is_matlab: bool) -> Result<Vec<Variable>, String> {
    let most = usize::try_from(8 * budget.numbers()).unwrap_or(usize::MAX);
    let options = OpenOptions::default().with_max_read_bytes(most);
    let file = Hdf5File::from_vec_with_options(bytes, options).map_err(words)?;
    let mut found = Hdf5Search { is_matlab, left: budget.numbers(), variables: Vec::new() };
    found.collect("", &file.root_group().map_err(words)?, DEEPEST)?;
    Ok(found.variables)
}

fn words(error: hdf5_reader::error::Error) -> String {
    error.to_string()
}

/// Numeric datasets of the groups so far, and how many numbers may follow.
struct Hdf5Search {
    is_matlab: bool,
    left: u64,
    variables: Vec<Variable>,
}

impl Hdf5Search {
    fn collect(&mut self, path: &str, group: &Group, depth: usize) -> Result<(), String> {
        let (groups, datasets) = group.members().map_err(words)?;
        // Groups may lie in each other.
        let rest = self.left.checked_sub(NUMBERS_PER_GROUP);
        self.left = rest.ok_or("its groups go round in a circle, or are too many")?;
        for dataset in datasets {
            let size = dataset.shape().iter().fold(1_u64, |size, &length| size.saturating_mul(length));
            self.left = self.left.checked_sub(size).ok_or_else(|| {
                format!("{path}{} claims more numbers than the file can hold", dataset.name())
            })?;
            if let Some(values) = numbers(&dataset)? {
                let mut sizes: Vec<usize> = dataset.shape().iter().map(|&size| size as usize).collect();
                // MATLAB writes its columns as the rows of HDF5.
                if self.is_matlab {
                    sizes.reverse();
                }
                let name = format!("{path}{}", dataset.name());
                self.variables.extend(Variable::new(name, &sizes, &values, !self.is_matlab));
            }
        }
        // What MATLAB needs for itself begins with a number sign.
        for inner in groups.into_iter().filter(|group| !group.name().starts_with('#') && depth > 0) {
            self.collect(&format!("{path}{}.", inner.name()), &inner, depth - 1)?;
        }
        Ok(())
    }
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
