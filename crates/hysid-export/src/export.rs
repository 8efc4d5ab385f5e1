//! An export: the files of a target, and those that every export has.

use hysid_core::model::Model;

use crate::error::Error;
use crate::manifest::{MANIFEST, manifest};
use crate::options::Options;
use crate::program::Precision;
use crate::readme::readme;
use crate::reserved;
use crate::subject::{ExportFile, ExportSubject};
use crate::target::{Target, TargetFiles};

/// Files of an exported model, with a note for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Export {
    /// The files that belong in one folder.
    pub files: Vec<ExportFile>,
    /// Note for the user.
    pub note: Option<String>,
}

impl Export {
    /// Path in the folder and content of each file.
    pub fn contents(&self) -> Vec<(&str, &[u8])> {
        self.files.iter().map(|file| (file.path.as_str(), file.content.as_slice())).collect()
    }
}

/// Exports a model.
///
/// # Errors
/// A name that is no identifier, or that the target has already; a precision or an inverse that the target does not
/// have; bounds of an inverse that cannot be used; a model that cannot be exported there.
pub fn export(model: &Model, to: Target, options: &Options) -> Result<Export, Error> {
    let back_end = to.back_end();
    if options.precision == Precision::Single && !back_end.has_single_precision {
        return Err(Error::Precision(back_end.name));
    }
    if options.inverse.is_some() && !back_end.has_inverse {
        return Err(Error::NoInverse(back_end.name));
    }
    reserved::check(&options.name, back_end.reserved, back_end.name)?;
    let subject = ExportSubject::of(model, options)?;
    reserved::check_arrays(&options.name, subject.tangent(), back_end.name)?;
    let TargetFiles { mut files, note } = (back_end.write)(&subject)?;
    // A unit of the inverse has no steps of the model itself.
    if subject.inverse().is_none() || to != Target::Fmu {
        files.push(ExportFile::new("test_vectors.csv", subject.vectors_csv()));
    }
    if let Some(inverse) = subject.inverse() {
        files.push(ExportFile::new("inverse_vectors.csv", inverse.vectors_csv()));
    }
    files.push(ExportFile::new("README.md", readme(&subject, to, &files)));
    files.push(ExportFile::new(MANIFEST, manifest(&subject, back_end.name, &files)));
    let note = note
        .into_iter()
        .chain(model.stepping_note().map(String::from))
        .reduce(|all, one| format!("{all}; {one}"));
    Ok(Export { files, note })
}
